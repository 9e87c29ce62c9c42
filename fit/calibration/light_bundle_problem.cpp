// light_bundle_problem.cpp: observations and priors of the bundle adjustment of lights.
#include "fit/calibration/light_bundle_problem.h"

#include <array>
#include <cmath>

#include "surface/base/median.h"

namespace tangi {

namespace {

// What is known of one number from a measurement, with its standard error, stands against samples of which
// one in kDependent is independent.
const double kKnownWeight = std::sqrt(LightBundleProblem::kDependent);
constexpr double kGainSigma = 0.05;    // [1] ln gain, about its smooth trend, at least
constexpr double kTrendSigma = 0.2;    // [1] ln gain
constexpr double kFieldSigma = 0.05;   // [rad] rms of each mode of a smooth field of turns
constexpr double kTurnSigma = 0.1;     // [rad] of a light's own turn
constexpr double kBeamSigma = 0.3;     // [1] ln irradiance at the border, of a term of a beam
constexpr double kNoTurn = 0.001;      // [rad] what stands for none of its own
constexpr double kSurest = 1e-4;       // [rad] of a direction that was measured
constexpr double kCameraSigma = 0.5;   // [1/width]
constexpr double kBendSigma = 0.05;    // [1/width] of a rig over an object that is not flat
constexpr double kRoughSigma = 0.3;    // [1] of diffuse roughness, from 0
constexpr double kHeightSigma = 0.02;  // [width] of the surface above where directions are from

constexpr int kPixel = kJointPixel, kRig = kJointRig, kTurn = kJointTurn, kBeam = kJointBeam;

template <int residuals, int... blocks, class Functor>
ceres::CostFunction* cost(Functor functor) {
    return new ceres::AutoDiffCostFunction<Functor, residuals, blocks...>(new Functor(functor));
}

}  // namespace

LightBundleProblem::LightBundleProblem(const LightBundleAdjustment& joint, const JointFreedom& freedom)
    : freedom_(freedom),
      prior_weight_(std::sqrt(std::max(1.0, static_cast<double>(joint.pixels.size()) / kDependent))),
      photos_(joint.directions.size()) {
    if (freedom.directions != DirectionFreedom::listed && freedom.pixels)
        directions_ = DirectionField(joint.directions, !freedom.gains);
    pixels_ = joint.pixels.size();
    values_.reserve(kPixel * pixels_ + (1 + kTurn + kBeam) * photos_ + kJointTrend + kRig + field_size());
    for (const LightBundleAdjustment::Pixel& p : joint.pixels)
        values_.insert(values_.end(), {p.slope.x, p.slope.y, p.ln_alpha, p.specular, p.diffuse});
    values_.insert(values_.end(), joint.log_gains.begin(), joint.log_gains.end());
    for (const glm::dvec2& turn : joint.turns) values_.insert(values_.end(), {turn.x, turn.y});
    for (const std::array<double, kBeam>& beam : joint.beams)
        values_.insert(values_.end(), beam.begin(), beam.end());
    values_.resize(values_.size() + kJointTrend);
    values_.insert(values_.end(),
                   {joint.rig.light_inverse_distance, joint.rig.ambient, joint.rig.camera_inverse_distance,
                    joint.rig.bend, joint.rig.roughness, joint.rig.height});
    values_.resize(values_.size() + field_size());
    add_observations(joint);
    add_pixels(joint.flat);
    add_gains(joint);
    add_turns(joint);
    add_beams();
    add_rig(joint);
}

double LightBundleProblem::spread_of_residuals() {
    std::vector<ceres::ResidualBlockId> ids;
    problem_.GetResidualBlocks(&ids);
    std::vector<double> sizes;
    for (const ceres::ResidualBlockId id : ids) {
        if (problem_.GetLossFunctionForResidualBlock(id) != robust_) continue;
        double cost = 0, residual = 0;
        problem_.EvaluateResidualBlock(id, false, &cost, &residual, nullptr);
        sizes.push_back(std::abs(residual));
    }
    return 1.4826 * median(std::move(sizes));
}

std::vector<double*> LightBundleProblem::eliminated() {
    std::vector<double*> blocks;
    for (std::size_t i = 0; i < pixels_; ++i) blocks.push_back(pixel(i));
    return blocks;
}

void LightBundleProblem::add_observations(const LightBundleAdjustment& joint) {
    for (const LightBundleAdjustment::Observation& o : joint.observations) {
        const auto at = static_cast<std::size_t>(o.pixel), photo = static_cast<std::size_t>(o.photo);
        problem_.AddResidualBlock(
            new JointResidual({joint.directions[photo], joint.nearer[photo], joint.pixels[at].position,
                               joint.camera_axis, o.value, o.sigma}),
            robust_, pixel(at), log_gain(photo), rig(), turn(photo), beam(photo));
    }
}

void LightBundleProblem::add_pixels(bool flat_as_a_whole) {
    auto* flat = flat_as_a_whole ? new ceres::CauchyLoss(1) : nullptr;
    for (std::size_t i = 0; i < pixels_; ++i) {
        double* block = pixel(i);
        problem_.AddResidualBlock(cost<2, kPixel>(LobePrior{}), nullptr, block);
        if (flat_as_a_whole) problem_.AddResidualBlock(cost<2, kPixel>(FlatnessPrior{}), flat, block);
        problem_.SetParameterLowerBound(block, 2, std::log(0.03));
        problem_.SetParameterUpperBound(block, 2, std::log(0.7));
        problem_.SetParameterLowerBound(block, 3, 0);
        problem_.SetParameterLowerBound(block, 4, 0);
        if (!freedom_.pixels) problem_.SetParameterBlockConstant(block);
    }
}

void LightBundleProblem::add_gains(const LightBundleAdjustment& joint) {
    // A light far from the trend must not be drawn to it at all: with Cauchy's loss, which never lets go,
    // a weak light at 15 degrees came out 4 % too strong. Nor must one that is near it by chance where
    // the others are not: 3 %.
    auto* outlying = new ceres::TukeyLoss(kBiweight * prior_weight_);
    const double weight = prior_weight_ / std::max(joint.gain_scatter, kGainSigma);
    for (std::size_t i = 0; i < photos_; ++i) {
        problem_.AddResidualBlock(cost<1, 1, kJointTrend>(GainPrior{joint.directions[i], weight}), outlying,
                                  log_gain(i), trend());
        if (!freedom_.gains) problem_.SetParameterBlockConstant(log_gain(i));
    }
    // The trend's constant only follows the albedo: strength is relative.
    const double t = 1 / kTrendSigma;
    problem_.AddResidualBlock(cost<kJointTrend, kJointTrend>(Weighted<kJointTrend>{{1e4, t, t, t, t, t}}),
                              nullptr, trend());
}

void LightBundleProblem::add_turns(const LightBundleAdjustment& joint) {
    for (std::size_t i = 0; i < photos_; ++i) {
        if (freedom_.directions == DirectionFreedom::listed ||
            (measured() && !(joint.direction_sigma[i] > 0)))
            problem_.SetParameterBlockConstant(turn(i));
    }
    if (freedom_.directions == DirectionFreedom::listed) return;
    if (!freedom_.pixels) {
        for (std::size_t i = 0; i < photos_; ++i)
            problem_.AddResidualBlock(new PullToZero(kTurn, turn_weight(joint, i)), nullptr, turn(i));
        return;
    }
    // A listed direction may be any number of degrees off, a measured one is off by what is said of it.
    const bool own = freedom_.directions != DirectionFreedom::smooth;
    auto* outlying = own && !measured() ? new ceres::CauchyLoss(2 * prior_weight_) : nullptr;
    std::vector<std::vector<glm::dvec2>> untold;
    std::vector<double*> all;
    for (std::size_t i = 0; i < photos_; ++i) {
        problem_.AddResidualBlock(new TurnPrior(directions_.at(joint.directions[i]), turn_weight(joint, i)),
                                  outlying, turn(i), field());
        untold.push_back(directions_.untold(joint.directions[i]));
        all.push_back(turn(i));
    }
    if (own) problem_.AddResidualBlock(new MotionPrior(std::move(untold)), nullptr, all);
    problem_.AddResidualBlock(new PullToZero(directions_.modes(), field_weight(joint)), nullptr, field());
}

// What all lights have in common is left to the albedo, and what goes with their directions to a bulge:
// where photographs can't tell, few uneven beams are likelier than many.
void LightBundleProblem::add_beams() {
    auto* outlying = freedom_.beams ? new ceres::CauchyLoss(prior_weight_) : nullptr;
    for (std::size_t i = 0; i < photos_; ++i) {
        if (freedom_.beams)
            problem_.AddResidualBlock(new PullToZero(kBeam, prior_weight_ / kBeamSigma), outlying, beam(i));
        else
            problem_.SetParameterBlockConstant(beam(i));
    }
}

double LightBundleProblem::turn_weight(const LightBundleAdjustment& joint, std::size_t photo) const {
    switch (freedom_.directions) {
        case DirectionFreedom::measured:
            return kKnownWeight / std::max(joint.direction_sigma[photo], kSurest);
        case DirectionFreedom::own:
            return prior_weight_ / kTurnSigma;
        default:
            return prior_weight_ / (freedom_.pixels ? kNoTurn : kTurnSigma);
    }
}

// What is measured with one sphere is off alike for lights that are near each other: as a whole by as
// much as each by itself.
double LightBundleProblem::field_weight(const LightBundleAdjustment& joint) const {
    if (!measured()) return 1 / kFieldSigma;
    double squares = 0;
    for (const double sigma : joint.direction_sigma)
        squares += 2 * sigma * sigma / static_cast<double>(photos_);
    return kKnownWeight * std::sqrt(directions_.modes() / std::max(squares, kSurest * kSurest));
}

void LightBundleProblem::add_rig(const LightBundleAdjustment& joint) {
    const double rough = measured() ? kKnownWeight / kRoughSigma : 0;
    const double bend = joint.flat ? 0 : prior_weight_ / kBendSigma;
    problem_.AddResidualBlock(
        cost<kRig, kRig>(Weighted<kRig>{{0, 0, 1 / kCameraSigma, bend, rough, 1 / kHeightSigma}}), nullptr,
        rig());
    const std::array<std::array<double, 2>, kRig> bounds = {
        {{0, 1.2}, {0, 0.6}, {0, 1.2}, {-kMostBend, kMostBend}, {0, 1}, {-0.2, 0.2}}};
    for (int i = 0; i < kRig; ++i) {
        const bool known = i == 2 ? joint.camera_known : (i == 0 || i == 3 || i == 5) && joint.lights_known;
        if (known) continue;  // may lie outside, and stays
        problem_.SetParameterLowerBound(rig(), i, bounds[static_cast<std::size_t>(i)][0]);
        problem_.SetParameterUpperBound(rig(), i, bounds[static_cast<std::size_t>(i)][1]);
    }
    // Strengths of their own take up what the surface's height makes of the light, and of directions
    // alone it would be whatever is wrong with them.
    const bool lights = joint.lights_known || !freedom_.rig, height = lights || freedom_.gains;
    const std::array<bool, kRig> holds = {lights, !freedom_.rig, joint.camera_known || !freedom_.rig,
                                          lights, !measured(),   height};
    std::vector<int> known;
    for (int i = 0; i < kRig; ++i)
        if (holds[static_cast<std::size_t>(i)]) known.push_back(i);
    if (known.size() == kRig)
        problem_.SetParameterBlockConstant(rig());
    else if (!known.empty())
        problem_.SetManifold(rig(), new ceres::SubsetManifold(kRig, known));
}

}  // namespace tangi
