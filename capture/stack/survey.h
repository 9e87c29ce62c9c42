// survey.h: one look at all photographs of a stack before the fit: samples, exposure, what is unusable.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "capture/stack/stack.h"

namespace tangi {

struct SurveyOptions {
    int samples = 4000;  // pixels to sample, spread evenly over the picture
};

// Values as stored (encoded, 0..1) of a sample of pixels under every light.
struct Survey {
    struct Photo {
        double mean = 0;      // [1] of all channels, encoded
        double maximum = 0;   // [1]
        long at_maximum = 0;  // values that are just that
        double clipped = 0;   // [1] part of the values that are clipped
        double present = 1;   // [1] part of the values that are there: not NaN
        // Pixels of its rows that held no number (PhotoFile::without_number())
        long without_number = 0;
        long transparent = 0;  // pixels of its rows that were (PhotoFile::transparent())
    };
    std::vector<Photo> photos;
    int channels = 3;
    std::vector<glm::ivec2> positions;  // [pixels of the stack] of the samples
    std::vector<float> values;          // [sample][photo][channel]
    // Of each sample: those of the lowest ranks are spread evenly, too. Samples that change places where the
    // picture is mirrored or turned by a quarter have one rank. Empty: whatever their order says.
    std::vector<std::uint32_t> ranks{};

    int sample_count() const { return static_cast<int>(positions.size()); }
    // Samples, in their order, of which there are at least `wanted` (or all) and a few more, spread evenly.
    std::vector<int> spread(int wanted) const;
    const float* sample(int index) const {
        return &values[static_cast<std::size_t>(index) * photos.size() * static_cast<std::size_t>(channels)];
    }
};

// An encoded value from which on a photograph is taken for clipped: two codes of 8 bits below full scale,
// since JPEG smears the edge of a clipped area.
constexpr float kClipped = 253.0f / 255;

// Decodes every photograph once, from top to bottom: so truncated and damaged files are found before the fit.
// `seen`, where given, gets every band as well, as stored. Where a registered photograph does not reach, its
// values are NaN, and do not count. Throws Error naming the file.
Survey survey(const Stack& stack, const SurveyOptions& options = {}, const Progress& progress = {},
              const std::function<void(const Band&)>& seen = {});

// Warns of photographs in which pixels held no number, or were transparent, naming each, and how many pixels.
void tell_pixels_without_number(Stack& stack, const Survey& survey);

// Takes photographs without light out of the stack and the survey, with a warning that names them: brighter
// than 2 % nowhere, or without a single value. Throws Error where too few remain.
void leave_out_black_photos(Stack& stack, Survey& survey, std::size_t fewest = 4);

}  // namespace tangi
