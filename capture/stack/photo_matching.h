// photo_matching.h: which pictures of a folder are the photographs that a lights file means.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "capture/photo/rejected_photo.h"
#include "capture/stack/stack.h"
#include "capture/stack/stack_calibration.h"

namespace tangi {

struct PhotoMatch {
    std::vector<StackPhoto> photos;
    std::vector<RejectedPhoto> rejected;       // lights without a photograph, photographs with two lights
    std::vector<std::filesystem::path> masks;  // take_masks(), but for those that a light names
    bool by_order = false;  // no name is that of a photograph: lights were taken in the order of file names
    std::vector<std::string> warnings;
};

// Matches by name (photo_names.h) among the photographs of the folder; those that the lights file lists
// elsewhere are only used where the folder holds none. By order with a warning where no name at all matches
// and the numbers agree. Throws Error naming the lights file and the remedy where nothing is matched;
// `all_or_none`: also where a light has no photograph, or a photograph two lights.
PhotoMatch match_photos(const std::filesystem::path& folder, const DevelopOptions& develop,
                        const StackCalibration& calibration, bool all_or_none);

}  // namespace tangi
