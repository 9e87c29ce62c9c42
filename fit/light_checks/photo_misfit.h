// photo_misfit.h: how each photograph differs from what the fitted surface predicts of it, and which cause
// explains that: another focus, light of the room, a light that did not fire, a veil.
//
// In linear light, a photograph is taken for
//   measured = (1 + gain) predicted + room W rho_d + c + blur / 2 laplacian(predicted),
// W the white level: a light of another strength, light from all around, a constant, and to first order a
// Gaussian blur (the heat equation: Koenderink 1984, "The structure of images"). Beside these, for blurs too
// wide for a first order, (mean of 9 x 9 pixels - predicted), whichever explains more; and what is not of
// interest here: the shading of a light that is a little aside or uneven, and the Laplacian of the Laplacian,
// which interpolation (of a mosaic, or by registration) takes of the shortest waves. Room light and blur are
// then taken against the middling photograph's: what all have alike is none of one photograph.
//
// All are found by weighted least squares on blocks of the picture's matt pixels. Pixels that are more than 6
// robust standard deviations off (shadows that are a little elsewhere, hands), and blocks that differ by more
// than 6 times as much as most, have no say. Standard errors are from the scatter of the blocks (White 1980,
// "A heteroskedasticity-consistent covariance matrix estimator"). Of pictures with few blocks nothing is
// said.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capture/stack/stack.h"
#include "fit/pixel/lighting.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

struct MisfitTerm {
    double value = 0, error = 0;
    double effect = 0;  // [sigma] rms of what it explains, as PhotoMisfit::rms
};

struct PhotoMisfit {
    double rms = 0;         // [sigma] of measured - predicted, in units of what the fit expects
    MisfitTerm gain{};      // [1]
    MisfitTerm room{};      // [1] of W, beside what the rig and the middling photograph have
    MisfitTerm constant{};  // [1] linear
    MisfitTerm blur{};      // [pixels^2] > 0: softer than the middling one; effect of both terms
    double strength = 0;    // [1] of its light, as calibrated, gain included, over the middling photograph's
};

struct PhotoMisfits {
    struct Kind {
        double rms = 0;   // [sigma] robust deviation of the middling photograph
        double part = 0;  // [1] of all that was compared
    };
    std::vector<PhotoMisfit> photos{};  // of stack.photos; empty where nothing could be compared
    // Of pixels. Glossy: rho_s above rho_d, or mostly the lobe's light. Causes are looked for in matt ones
    // alone, since lobes differ from the model by more than paint does.
    Kind matt{}, glossy{};
    int judged = 0;  // photographs whose causes can be told apart; those of small pictures cannot
    // [1] Linear light on everything, black as white, in all photographs: what places that no light reaches
    // have beyond what is in proportion to their rho_d. `effect`: over the brightness of the middling place.
    MisfitTerm veil{};
};

// The surface is as fitted, with a height, before colours are corrected. `model_error` as WardFitOptions.
// Reads the photographs once more. Deterministic for any number of threads.
PhotoMisfits photo_misfits(const CalibratedStack& input, const Surface& surface, double model_error,
                           const Progress& progress = {});

// What is to be done about it, for people; empty where nothing stands out. `names` of the photographs.
std::vector<std::string> doubts_of(const PhotoMisfits& misfits, const std::vector<std::string>& names);

// Whether matt paint differs by more than is expected; whether what is glossy does so far more than matt
// paint.
bool is_in_matt_paint(const PhotoMisfits& misfits);
bool is_in_gloss(const PhotoMisfits& misfits);

// What could be judged and is not the cause: "focus, light of the room and a veil"; empty where nothing
// could.
std::string ruled_out(const PhotoMisfits& misfits);

// The photographs that differ most, where few stand out; empty else: "img_003.tif 5.1 times, ...".
std::string worst_of(const PhotoMisfits& misfits, const std::vector<std::string>& names);

nlohmann::json to_json(const PhotoMisfits& misfits, const std::vector<std::string>& names);

}  // namespace tangi
