// focal_evidence.h: what tells how wide the camera sees, whether it agrees, and what each number would have
// to be.
//
// The quantity is 1 / focal length [1/px]: 0 is a camera that is far away, and errors are even about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/spheres/sphere_geometry.h"

namespace tangi {

// What the user measured. Spheres that lie on the painting's plane are as high as their radius: taken to be
// so, to a radius, where the height was not given.
struct MeasuredLengths {
    std::optional<double> focal_px{};
    static constexpr double kDistanceSigma = 0.003;  // [1] relative, of the camera's distance
    double focal_sigma = 0.003;                      // [1] relative
    std::optional<double> sphere_radius_mm{}, camera_distance_mm{}, sphere_height_mm{};

    // [mm] Of the spheres' centres above the painting's plane; without sphere_radius_mm in radii.
    Known height() const;
    // [mm] Of the spheres' centres below the camera; nothing without distance and radius. Throws Error where
    // that is not below.
    std::optional<Known> depth() const;
};

enum class FocalSource { given, lengths, highlights, outlines };

struct FocalEvidence {
    FocalSource source = FocalSource::given;
    Known inverse_focal;  // [1/px]
};

// focal length = radius in pixels * depth / radius.
std::optional<FocalEvidence> evidence_of_lengths(const MeasuredLengths& lengths, const Known& radius_px);

// A sphere seen at an angle t from the middle is 1 / cos t as long as wide. `elongation` is that less 1,
// found at `offset_px` from the principal point. Nothing where it leaves every lens possible.
std::optional<FocalEvidence> evidence_of_outline(const Known& elongation, double offset_px,
                                                 double diagonal_px);

// Before anything is known: far away, as a picture of `diagonal_px` is taken through a lens of about 48 mm
// (35-mm equivalent) or longer.
Known any_lens(double diagonal_px);

struct FocalVerdict {
    Known inverse_focal;                         // [1/px] of what agrees, and any_lens()
    std::vector<FocalEvidence> agree, disagree;  // what contradicts most is left out first
    double disagreement = 0;                     // [standard errors] the largest between two of all

    bool uses(FocalSource source) const;
    // [1/px] What else may be right: not what two others contradict, or what was measured in the photographs
    // does.
    std::vector<Known> alternatives() const;
    // Whether camera distance, sphere height and radius contradict the rest, be it a little.
    bool doubts_lengths() const {
        return disagree.empty() ? uses(FocalSource::lengths) : !uses(FocalSource::lengths);
    }
    // 0 where all agree, 1 where they contradict each other: how much the differences between what the
    // evidence says count as errors.
    double doubt() const;
};

FocalVerdict judge(const std::vector<FocalEvidence>& evidence, double diagonal_px);

// For the user, where numbers contradict each other: which, and what each would have to be to agree with the
// rest. Empty where they agree.
std::string contradiction_of(const FocalVerdict& verdict, const MeasuredLengths& lengths,
                             const Known& radius_px);

}  // namespace tangi
