// light_residual_map.h: where and by how much photographs differ from what the fit makes of them, on a
// sample.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "fit/calibration/light_sample.h"
#include "surface/image/image.h"

namespace tangi {

struct LightMisfit {
    int width = 0, height = 0;      // of the picture
    std::vector<glm::vec2> places;  // [pixels] of the sample
    // [1] ln(measured / predicted) of green, or grey, one row a photograph; NaN where clipped, hardly lit or
    // not measurable.
    std::vector<std::vector<float>> log_ratios;
    double best_explained = 0;  // [sigma] robust residual that the best tenth of the sample is below

    // [1] of one photograph: median, and median absolute deviation from it times 1.4826; 0 where nothing is
    // known.
    struct Typical {
        double offset = 0, scatter = 0;
    };
    Typical typical(std::size_t photo) const;

    // One photograph's ratios as a map, no side longer than `longest`: each pixel has the nearest sample's.
    Image<float> map(std::size_t photo, int longest) const;
};

// Fits about `wanted` pixels of the survey to all photographs and predicts these. The lighting is in the
// order of stack.photos.
LightMisfit light_misfit(const SurveyedStack& surveyed, const Lighting& lighting, const WardFitOptions& ward,
                         const ReflectanceModel& reflectance_model = {}, int wanted = 1500);

}  // namespace tangi
