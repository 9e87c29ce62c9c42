#include "fit/calibration/light_bundle_adjustment.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <numbers>

#include "fit/calibration/light_priors.h"
#include "fit/calibration/light_residual.h"
#include "fit/calibration/schur_solver.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

// What is known before any photograph. Model errors are shared by neighbouring samples, so that the priors on
// a light's own gain and direction weigh as if one sample in kDependent were independent. The priors on what
// the whole stack shares (the trends, the camera) stand as they are: all photographs speak against them.
constexpr double kDependent = 10;  // [1] samples
constexpr double kSparse = 500;    // [pixels] of which that was found
// What is known of one number from a measurement, with its standard error, stands against samples of which
// one in kDependent is independent.
const double kKnownWeight = std::sqrt(kDependent);
constexpr double kStartScale = 20;  // [sigma] at first, so that a light three times too strong is no outlier
constexpr double kRobustScale = 2;  // [sigma] as the pixel fit's, at least
// [sigma] Where the residuals spread by more than sigma: then what is an outlier is not known, and most of
// metal would be one: at 2 sigma coin's minimum is that of a few pixels, and photographs left out are
// predicted 0.8 dB worse (at 4 sigma 0.5, at 5 sigma 0.3).
constexpr double kWideScale = 10;
constexpr double kGainSigma = 0.05;    // [1] ln gain, about its smooth trend, at least
constexpr double kBiweight = 4.685;    // [sigma] Beaton & Tukey 1974: 95 % efficient on normal values
constexpr double kTrendSigma = 0.2;    // [1] ln gain
constexpr double kFieldSigma = 0.05;   // [rad] rms of each mode of a smooth field of turns
constexpr double kTurnSigma = 0.1;     // [rad] of a light's own turn
constexpr double kBeamSigma = 0.3;     // [1] ln irradiance at the border, of a term of a beam
constexpr double kNoTurn = 0.001;      // [rad] what stands for none of its own
constexpr double kSurest = 1e-4;       // [rad] of a direction that was measured
constexpr double kCameraSigma = 0.5;   // [1/width]
constexpr double kRoughSigma = 0.3;    // [1] of diffuse roughness, from 0
constexpr double kHeightSigma = 0.02;  // [width] of the surface above where directions are from
// Enough for every minimum to be reached (real stacks need 12 to 113 steps): where the search was cut short
// at 40, homographies 1e-5 pixels apart gave lights 10 % and held-out photographs 0.6 dB apart.
constexpr int kIterations = 400;

constexpr int kPixel = kJointPixel, kRig = kJointRig, kTurn = kJointTurn, kBeam = kJointBeam;

template <int residuals, int... blocks, class Functor>
ceres::CostFunction* cost(Functor functor) {
    return new ceres::AutoDiffCostFunction<Functor, residuals, blocks...>(new Functor(functor));
}

// Products of beam_terms(), in mean over the pixels: what carries the terms of a beam to its mean square.
using BeamMoments = std::array<double, kBeam * kBeam>;
BeamMoments beam_moments(const std::vector<LightBundleAdjustment::Pixel>& pixels) {
    BeamMoments moments{};
    for (const LightBundleAdjustment::Pixel& pixel : pixels) {
        const std::array<double, kBeam> terms = beam_terms(pixel.position);
        for (std::size_t i = 0; i < moments.size(); ++i)
            moments[i] += terms[i / kBeam] * terms[i % kBeam] / static_cast<double>(pixels.size());
    }
    return moments;
}

// The parameters, as Ceres takes them, and the problem they are in. They lie side by side, as schur_system.h
// orders blocks by their address, and so its sums.
class Blocks {
public:
    Blocks(const LightBundleAdjustment& joint, const JointFreedom& freedom)
        : robust_scale(joint.robust_scale),
          freedom_(freedom),
          prior_weight_(std::sqrt(std::max(1.0, static_cast<double>(joint.pixels.size()) / kDependent))),
          photos_(joint.directions.size()),
          moments_(beam_moments(joint.pixels)) {
        if (freedom.directions != DirectionFreedom::listed && freedom.pixels)
            directions = DirectionField(joint.directions, !freedom.gains);
        pixels_ = joint.pixels.size();
        values_.reserve(kPixel * pixels_ + (1 + kTurn + kBeam) * photos_ + kJointTrend + kRig + field_size());
        for (const LightBundleAdjustment::Pixel& p : joint.pixels)
            values_.insert(values_.end(), {p.slope.x, p.slope.y, p.ln_alpha, p.specular, p.diffuse});
        values_.insert(values_.end(), joint.log_gains.begin(), joint.log_gains.end());
        for (const glm::dvec2& turn : joint.turns) values_.insert(values_.end(), {turn.x, turn.y});
        for (const std::array<double, kBeam>& beam : joint.beams)
            values_.insert(values_.end(), beam.begin(), beam.end());
        values_.resize(values_.size() + kJointTrend);
        values_.insert(values_.end(), {joint.rig.light_inverse_distance, joint.rig.ambient,
                                       joint.rig.camera_inverse_distance, joint.rig.bend, joint.rig.roughness,
                                       joint.rig.height});
        values_.resize(values_.size() + field_size());
        add_observations(joint);
        add_pixels();
        add_gains(joint);
        add_turns(joint);
        add_beams();
        add_rig(joint);
    }

    DirectionField directions;
    double final_cost = 0;
    double robust_scale;  // [sigma]
    std::size_t field_size() const { return static_cast<std::size_t>(directions.modes()); }
    double* pixel(std::size_t i) { return &values_[kPixel * i]; }
    double* log_gain(std::size_t i) { return &values_[kPixel * pixels_ + i]; }
    double* turn(std::size_t i) { return log_gain(photos_) + kTurn * i; }
    double* beam(std::size_t i) { return turn(photos_) + kBeam * i; }
    double* trend() { return beam(photos_); }
    double* rig() { return trend() + kJointTrend; }
    double* field() { return rig() + kRig; }

    bool solve(JointStart start) {
        const auto minimise = [&](double tolerance) {
            return solve_by_schur(problem_, eliminated(),
                                  {.max_iterations = kIterations, .function_tolerance = tolerance});
        };
        const bool far = start == JointStart::far;
        if (far) {
            robust_->Reset(new ceres::CauchyLoss(kStartScale), ceres::TAKE_OWNERSHIP);
            minimise(1e-3);
            robust_scale = spread_of_residuals() > 1 ? kWideScale : kRobustScale;
        }
        // A start near the minimum is that of a trial, which is one of many.
        const double tolerance = start == JointStart::near ? 1e-4 : 1e-5;
        robust_->Reset(new ceres::CauchyLoss(robust_scale), ceres::TAKE_OWNERSHIP);
        SchurSummary summary = minimise(tolerance);
        final_cost = summary.final_cost;
        if (start == JointStart::there) {
            // Also after a wide loss: what the lights' model explains from that minimum on is what tells
            // them. What lies far off is so by the spread that is left there (MM-estimates, Yohai 1987): by
            // sigma alone, most of metal that is no Ward lobe would be.
            const double spread = std::max(1.0, spread_of_residuals());
            robust_->Reset(new ceres::TukeyLoss(kBiweight * spread), ceres::TAKE_OWNERSHIP);
            summary = minimise(tolerance);
        }
        return summary.usable;
    }

    LightBundleAdjustment::Errors errors() {
        robust_->Reset(new ceres::CauchyLoss(robust_scale), ceres::TAKE_OWNERSHIP);
        // Only ratios of gains are known, and where all are far from the trend nothing else holds the whole.
        if (freedom_.gains) problem_.SetParameterBlockConstant(log_gain(0));
        const bool directed = freedom_.directions != DirectionFreedom::listed;
        const bool rig_moves = freedom_.rig || measured();
        LightBundleAdjustment::Errors errors;
        if (!directed && !freedom_.beams && !freedom_.gains && !rig_moves) return errors;
        const auto covariance = SharedCovariance::of(problem_, eliminated());
        if (!covariance) return errors;
        // The denser the samples are, the more of them share an error.
        const double dependent =
            kDependent * std::sqrt(std::max(1.0, static_cast<double>(pixels_) / kSparse));
        const auto sigma = [dependent](double variance) {
            return std::sqrt(std::max(dependent * variance, 0.0));
        };
        for (std::size_t i = 0; i < photos_; ++i) {
            const auto variance = [&](const double* block, int k) {
                return covariance->at(block, k, block, k);
            };
            if (directed)
                errors.direction_deg.push_back(sigma((variance(turn(i), 0) + variance(turn(i), 1)) / 2) *
                                               180 / std::numbers::pi);
            double squares = 0;
            for (int k = 0; k < kBeam * kBeam; ++k)
                squares += covariance->at(beam(i), k / kBeam, beam(i), k % kBeam) *
                           moments_[static_cast<std::size_t>(k)];
            if (freedom_.beams) errors.beams.push_back(sigma(squares));
        }
        if (freedom_.gains) errors.log_gains = gain_errors(*covariance, sigma);
        if (rig_moves) {
            const auto of = [&](int i) { return sigma(covariance->at(rig(), i, rig(), i)); };
            errors.rig = {of(0), of(1), of(2), of(3), of(4), of(5)};
        }
        return errors;
    }

private:
    // [sigma] Of the observations, by their median.
    double spread_of_residuals() {
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

    // Pixels are many and meet only in the lights and the rig.
    std::vector<double*> eliminated() {
        std::vector<double*> blocks;
        for (std::size_t i = 0; i < pixels_; ++i) blocks.push_back(pixel(i));
        return blocks;
    }
    bool measured() const { return freedom_.directions == DirectionFreedom::measured; }

    template <class Sigma>
    std::vector<double> gain_errors(const SharedCovariance& covariance, const Sigma& sigma) {
        std::vector<double> c(photos_ * photos_), row_means(photos_);
        double mean = 0;
        const auto n = static_cast<double>(photos_);
        for (std::size_t i = 0; i < photos_; ++i)
            for (std::size_t j = 0; j < photos_; ++j)
                c[i * photos_ + j] = covariance.at(log_gain(i), 0, log_gain(j), 0);
        for (std::size_t i = 0; i < photos_; ++i)
            for (std::size_t j = 0; j < photos_; ++j) {
                row_means[i] += c[i * photos_ + j] / n;
                mean += c[i * photos_ + j] / (n * n);
            }
        std::vector<double> errors;
        for (std::size_t i = 0; i < photos_; ++i)
            errors.push_back(sigma(c[i * photos_ + i] - 2 * row_means[i] + mean));
        return errors;
    }

    void add_observations(const LightBundleAdjustment& joint) {
        for (const LightBundleAdjustment::Observation& o : joint.observations) {
            const auto at = static_cast<std::size_t>(o.pixel), photo = static_cast<std::size_t>(o.photo);
            problem_.AddResidualBlock(
                new JointResidual({joint.directions[photo], joint.nearer[photo], joint.pixels[at].position,
                                   joint.camera_axis, o.value, o.sigma}),
                robust_, pixel(at), log_gain(photo), rig(), turn(photo), beam(photo));
        }
    }

    void add_pixels() {
        auto* flat = new ceres::CauchyLoss(1);
        for (std::size_t i = 0; i < pixels_; ++i) {
            double* block = pixel(i);
            problem_.AddResidualBlock(cost<2, kPixel>(LobePrior{}), nullptr, block);
            problem_.AddResidualBlock(cost<2, kPixel>(FlatnessPrior{}), flat, block);
            problem_.SetParameterLowerBound(block, 2, std::log(0.03));
            problem_.SetParameterUpperBound(block, 2, std::log(0.7));
            problem_.SetParameterLowerBound(block, 3, 0);
            problem_.SetParameterLowerBound(block, 4, 0);
            if (!freedom_.pixels) problem_.SetParameterBlockConstant(block);
        }
    }

    void add_gains(const LightBundleAdjustment& joint) {
        // A light far from the trend must not be drawn to it at all: with Cauchy's loss, which never lets go,
        // a weak light at 15 degrees came out 4 % too strong. Nor must one that is near it by chance where
        // the others are not: 3 %.
        auto* outlying = new ceres::TukeyLoss(kBiweight * prior_weight_);
        const double weight = prior_weight_ / std::max(joint.gain_scatter, kGainSigma);
        for (std::size_t i = 0; i < photos_; ++i) {
            problem_.AddResidualBlock(cost<1, 1, kJointTrend>(GainPrior{joint.directions[i], weight}),
                                      outlying, log_gain(i), trend());
            if (!freedom_.gains) problem_.SetParameterBlockConstant(log_gain(i));
        }
        // The trend's constant only follows the albedo: strength is relative.
        const double t = 1 / kTrendSigma;
        problem_.AddResidualBlock(cost<kJointTrend, kJointTrend>(Weighted<kJointTrend>{{1e4, t, t, t, t, t}}),
                                  nullptr, trend());
    }

    void add_turns(const LightBundleAdjustment& joint) {
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
            problem_.AddResidualBlock(
                new TurnPrior(directions.at(joint.directions[i]), turn_weight(joint, i)), outlying, turn(i),
                field());
            untold.push_back(directions.untold(joint.directions[i]));
            all.push_back(turn(i));
        }
        if (own) problem_.AddResidualBlock(new MotionPrior(std::move(untold)), nullptr, all);
        problem_.AddResidualBlock(new PullToZero(directions.modes(), field_weight(joint)), nullptr, field());
    }

    // What all lights have in common is left to the albedo, and what goes with their directions to a bulge:
    // where photographs can't tell, few uneven beams are likelier than many.
    void add_beams() {
        auto* outlying = freedom_.beams ? new ceres::CauchyLoss(prior_weight_) : nullptr;
        for (std::size_t i = 0; i < photos_; ++i) {
            if (freedom_.beams)
                problem_.AddResidualBlock(new PullToZero(kBeam, prior_weight_ / kBeamSigma), outlying,
                                          beam(i));
            else
                problem_.SetParameterBlockConstant(beam(i));
        }
    }

    double turn_weight(const LightBundleAdjustment& joint, std::size_t photo) const {
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
    double field_weight(const LightBundleAdjustment& joint) const {
        if (!measured()) return 1 / kFieldSigma;
        double squares = 0;
        for (const double sigma : joint.direction_sigma)
            squares += 2 * sigma * sigma / static_cast<double>(photos_);
        return kKnownWeight * std::sqrt(directions.modes() / std::max(squares, kSurest * kSurest));
    }

    void add_rig(const LightBundleAdjustment& joint) {
        const double rough = measured() ? kKnownWeight / kRoughSigma : 0;
        problem_.AddResidualBlock(
            cost<kRig, kRig>(Weighted<kRig>{{0, 0, 1 / kCameraSigma, 0, rough, 1 / kHeightSigma}}), nullptr,
            rig());
        const std::array<std::array<double, 2>, kRig> bounds = {
            {{0, 1.2}, {0, 0.6}, {0, 1.2}, {-0.5, 0.5}, {0, 1}, {-0.2, 0.2}}};
        for (int i = 0; i < kRig; ++i) {
            const bool known =
                i == 2 ? joint.camera_known : (i == 0 || i == 3 || i == 5) && joint.lights_known;
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

    JointFreedom freedom_;
    double prior_weight_;
    std::size_t photos_, pixels_ = 0;
    BeamMoments moments_;
    std::vector<double> values_;
    ceres::Problem problem_;  // owns costs and losses; a loss may be shared
    ceres::LossFunctionWrapper* robust_ =
        new ceres::LossFunctionWrapper(new ceres::CauchyLoss(kStartScale), ceres::TAKE_OWNERSHIP);
};

}  // namespace

bool LightBundleAdjustment::solve(const JointFreedom& freedom, JointStart start) {
    Blocks blocks(*this, freedom);
    if (!blocks.solve(start)) return false;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const double* x = blocks.pixel(i);
        pixels[i].slope = {x[0], x[1]};
        pixels[i].ln_alpha = x[2];
        pixels[i].specular = x[3];
        pixels[i].diffuse = x[4];
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
        log_gains[i] = *blocks.log_gain(i);
        turns[i] = {blocks.turn(i)[0], blocks.turn(i)[1]};
        std::copy_n(blocks.beam(i), kBeam, beams[i].begin());
    }
    std::vector<double> off_trend;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        double off = 0;
        GainPrior{directions[i], 1}(&log_gains[i], blocks.trend(), &off);
        off_trend.push_back(std::abs(off));
    }
    gain_scatter = 1.4826 * median(std::move(off_trend));
    robust_scale = blocks.robust_scale;
    const double* r = blocks.rig();
    rig = {r[0], r[1], r[2], r[3], r[4], r[5]};
    field = blocks.directions;
    cost = blocks.final_cost;
    coefficients.assign(blocks.field(), blocks.field() + blocks.field_size());
    return true;
}

double LightBundleAdjustment::unevenness(std::size_t light) const {
    const BeamMoments moments = beam_moments(pixels);
    double squares = 0;
    for (std::size_t i = 0; i < moments.size(); ++i)
        squares += moments[i] * beams[light][i / kBeam] * beams[light][i % kBeam];
    return std::sqrt(std::max(squares, 0.0));
}

LightBundleAdjustment::Errors LightBundleAdjustment::errors(const JointFreedom& freedom) const {
    return Blocks(*this, freedom).errors();
}

}  // namespace tangi
