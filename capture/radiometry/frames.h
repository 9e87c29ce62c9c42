// frames.h: dark frames, flat fields and ambient light: averaged in linear light, checked, and kept on disk.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "capture/photo/development.h"
#include "capture/photo/photo_file.h"

namespace tangi {

// What frames must be like, and how to read them.
struct FrameContext {
    PhotoHeader like;                 // of the photographs: size and channels
    std::filesystem::path like_path;  // one of them, for messages
    Transfer encoding;                // of integer files that are not raw
    std::string demosaic = "AHD";
    double full_scale = 1;     // as Stack::full_scale
    bool float_codes = false;  // as Stack::float_codes
};

struct FrameSummary {
    std::vector<std::filesystem::path> files;
    double mean = 0;          // [1] linear, of all channels
    double clipped = 0;       // [1] part of the values, in any of the files
    double darkest = 1;       // [1] of a flat field, of its mean: the lowest value that is used
    double unusable = 0;      // [1] part of a flat field's values that are too dark to divide by
    long without_number = 0;  // pixels of all files together that held none (PhotoFile::without_number())
};

struct AveragedFrame {
    std::shared_ptr<Frame> frame;
    FrameSummary summary;
};

// The mean of the pictures at `path` (one, or a folder of them), linear; NaN where one of them has no sample.
// `role` is the word for messages
// ("dark frame"). Throws Error naming the file: no such file or folder, no picture in it, another size or
// number of channels than the photographs.
AveragedFrame average_frame(const std::filesystem::path& path, const std::string& role,
                            const FrameContext& context);

// frame <- (frame - dark) / exposure; `dark` may be empty. For ambient light.
void subtract_dark(AveragedFrame& frame, const Frame* dark, double exposure, const FrameContext& context);

// What to multiply photographs by: the flat field's mean over its value less the dark frame's, for each
// channel by itself, so that colour and brightness of the picture as a whole stay as they are. NaN where the
// flat field has less than a tenth of its mean: dust, a lens hood, the edge of the board. Throws Error where
// it is clipped in more than 1 % of its values, or too dark in more than 5 %.
std::shared_ptr<Frame> gain_of_flat(AveragedFrame& flat, const Frame* dark, const FrameContext& context);

}  // namespace tangi
