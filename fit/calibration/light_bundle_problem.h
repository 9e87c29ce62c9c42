// light_bundle_problem.h: the least squares of the bundle adjustment of lights: its parameters, and what
// pulls at them. How they are solved: light_bundle_adjustment.cpp.
#pragma once

#include <ceres/ceres.h>

#include <cstddef>
#include <vector>

#include "fit/calibration/light_bundle_adjustment.h"
#include "fit/calibration/light_priors.h"
#include "fit/calibration/light_residual.h"

namespace tangi {

// The parameters, as Ceres takes them, and the problem they are in. They lie side by side, as schur_system.h
// orders blocks by their address, and so its sums. Lengths are in picture widths.
class LightBundleProblem {
public:
    // What is known before any photograph. Model errors are shared by neighbouring samples, so that the
    // priors on a light's own gain and direction weigh as if one sample in kDependent were independent. The
    // priors on what the whole stack shares (the trends, the camera) stand as they are: all photographs speak
    // against them.
    static constexpr double kDependent = 10;  // [1] samples
    // [sigma] At first, so that a light three times too strong is no outlier.
    static constexpr double kStartScale = 20;
    // [sigma] Beaton & Tukey 1974: 95 % efficient on normal values.
    static constexpr double kBiweight = 4.685;

    LightBundleProblem(const LightBundleAdjustment& joint, const JointFreedom& freedom);

    std::size_t pixels() const { return pixels_; }
    std::size_t photos() const { return photos_; }
    std::size_t field_size() const { return static_cast<std::size_t>(directions_.modes()); }
    double* pixel(std::size_t i) { return &values_[kJointPixel * i]; }  // slope x, y, ln α, specular, diffuse
    double* log_gain(std::size_t i) { return &values_[kJointPixel * pixels_ + i]; }
    double* turn(std::size_t i) { return log_gain(photos_) + kJointTurn * i; }
    double* beam(std::size_t i) { return turn(photos_) + kJointBeam * i; }
    double* trend() { return beam(photos_); }
    double* rig() { return trend() + kJointTrend; }  // as LightBundleAdjustment::RigParameters
    double* field() { return rig() + kJointRig; }

    // Pixels are many and meet only in the lights and the rig.
    std::vector<double*> eliminated();
    ceres::Problem& problem() { return problem_; }
    const JointFreedom& freedom() const { return freedom_; }
    bool measured() const { return freedom_.directions == DirectionFreedom::measured; }

    // Of the observations; owned from here on.
    void set_loss(ceres::LossFunction* loss) { robust_->Reset(loss, ceres::TAKE_OWNERSHIP); }
    // [sigma] Of the observations, by their median.
    double spread_of_residuals();

private:
    void add_observations(const LightBundleAdjustment& joint);
    void add_pixels(bool flat);
    void add_gains(const LightBundleAdjustment& joint);
    void add_turns(const LightBundleAdjustment& joint);
    void add_beams();
    void add_rig(const LightBundleAdjustment& joint);
    double turn_weight(const LightBundleAdjustment& joint, std::size_t photo) const;
    double field_weight(const LightBundleAdjustment& joint) const;

    DirectionField directions_;
    JointFreedom freedom_;
    double prior_weight_;
    std::size_t photos_, pixels_ = 0;
    std::vector<double> values_;
    ceres::Problem problem_;  // owns costs and losses; a loss may be shared
    ceres::LossFunctionWrapper* robust_ =
        new ceres::LossFunctionWrapper(new ceres::CauchyLoss(kStartScale), ceres::TAKE_OWNERSHIP);
};

}  // namespace tangi
