#include "fit/joint_lights.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "fit/joint_priors.h"
#include "fit/joint_residual.h"
#include "surface/median.h"

namespace tangi {

namespace {

// What is known before any photograph. Model errors are shared by neighbouring samples, so that the priors on
// a lamp's own gain and direction weigh as if one sample in kDependent were independent. The priors on what
// the whole stack shares (the trends, the camera) stand as they are: all photographs speak against them.
constexpr double kDependent = 10;  // [1] samples
constexpr double kSparse = 500;    // [pixels] of which that was found
// What is known of one number from a measurement, with its standard error, stands against samples of which
// one in kDependent is independent.
const double kKnownWeight = std::sqrt(kDependent);
constexpr double kStartScale = 20;    // [sigma] at first, so that a lamp three times too strong is no outlier
constexpr double kRobustScale = 2;    // [sigma] as the pixel fit's
constexpr double kGainSigma = 0.05;   // [1] ln gain, about its smooth trend, at least
constexpr double kBiweight = 4.685;   // [sigma] Beaton & Tukey 1974: 95 % efficient on normal values
constexpr double kTrendSigma = 0.2;   // [1] ln gain
constexpr double kFieldSigma = 0.05;  // [rad] rms of each mode of a smooth field of turns
constexpr double kTurnSigma = 0.1;    // [rad] of a lamp's own turn
constexpr double kBeamSigma = 0.3;    // [1] ln irradiance at the border, of a term of a beam
constexpr double kNoTurn = 0.001;     // [rad] what stands for none of its own
constexpr double kCameraSigma = 0.5;  // [1/width]
constexpr double kRoughSigma = 0.3;   // [1] of diffuse roughness, from 0
constexpr int kIterations = 40;

constexpr int kPixel = kJointPixel, kRig = kJointRig, kTurn = kJointTurn, kBeam = kJointBeam;

template <int residuals, int... blocks, class Functor>
ceres::CostFunction* cost(Functor functor) {
    return new ceres::AutoDiffCostFunction<Functor, residuals, blocks...>(new Functor(functor));
}

// Products of beam_terms(), in mean over the pixels: what carries the terms of a beam to its mean square.
using BeamMoments = std::array<double, kBeam * kBeam>;
BeamMoments beam_moments(const std::vector<JointLights::Pixel>& pixels) {
    BeamMoments moments{};
    for (const JointLights::Pixel& pixel : pixels) {
        const std::array<double, kBeam> terms = beam_terms(pixel.position);
        for (std::size_t i = 0; i < moments.size(); ++i)
            moments[i] += terms[i / kBeam] * terms[i % kBeam] / static_cast<double>(pixels.size());
    }
    return moments;
}

// The parameters, as Ceres takes them, and the problem they are in. They lie side by side, as Ceres orders
// blocks by their address, and so its sums.
class Blocks {
public:
    Blocks(const JointLights& joint, const JointFreedom& freedom)
        : freedom_(freedom),
          prior_weight_(std::sqrt(std::max(1.0, static_cast<double>(joint.pixels.size()) / kDependent))),
          photos_(joint.directions.size()),
          moments_(beam_moments(joint.pixels)) {
        if (freedom.directions != DirectionFreedom::listed && freedom.pixels)
            directions = DirectionField(joint.directions, !freedom.gains);
        pixels_ = joint.pixels.size();
        values_.reserve(kPixel * pixels_ + (1 + kTurn + kBeam) * photos_ + kJointTrend + kRig + field_size());
        for (const JointLights::Pixel& p : joint.pixels)
            values_.insert(values_.end(), {p.slope.x, p.slope.y, p.ln_alpha, p.specular, p.diffuse});
        values_.insert(values_.end(), joint.log_gains.begin(), joint.log_gains.end());
        for (const glm::dvec2& turn : joint.turns) values_.insert(values_.end(), {turn.x, turn.y});
        for (const std::array<double, kBeam>& beam : joint.beams)
            values_.insert(values_.end(), beam.begin(), beam.end());
        values_.resize(values_.size() + kJointTrend);
        values_.insert(values_.end(), {joint.rig.lamp_nearness, joint.rig.ambient, joint.rig.camera_nearness,
                                       joint.rig.bend, joint.rig.roughness});
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
    std::size_t field_size() const { return static_cast<std::size_t>(directions.modes()); }
    double* pixel(std::size_t i) { return &values_[kPixel * i]; }
    double* log_gain(std::size_t i) { return &values_[kPixel * pixels_ + i]; }
    double* turn(std::size_t i) { return log_gain(photos_) + kTurn * i; }
    double* beam(std::size_t i) { return turn(photos_) + kBeam * i; }
    double* trend() { return beam(photos_); }
    double* rig() { return trend() + kJointTrend; }
    double* field() { return rig() + kRig; }

    bool solve(JointStart start) {
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_SCHUR;  // pixels are eliminated first
        options.linear_solver_ordering = ordering_;
        options.num_threads = 1;  // sums in a fixed order; callers run several problems at once
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        if (start == JointStart::far && freedom_.gains) {
            options.max_num_iterations = kIterations / 2;
            options.function_tolerance = 1e-3;
            ceres::Solve(options, &problem_, &summary);
        }
        robust_->Reset(new ceres::CauchyLoss(kRobustScale), ceres::TAKE_OWNERSHIP);
        options.max_num_iterations = start == JointStart::far ? kIterations : kIterations / 4;
        options.function_tolerance = start == JointStart::far ? 1e-5 : 1e-4;
        ceres::Solve(options, &problem_, &summary);
        final_cost = summary.final_cost;
        if (start == JointStart::there) {
            robust_->Reset(new ceres::TukeyLoss(kBiweight), ceres::TAKE_OWNERSHIP);
            ceres::Solve(options, &problem_, &summary);
        }
        return summary.IsSolutionUsable();
    }

    JointLights::Errors errors() {
        robust_->Reset(new ceres::CauchyLoss(kRobustScale), ceres::TAKE_OWNERSHIP);
        // Only ratios of gains are known, and where all are far from the trend nothing else holds the whole.
        if (freedom_.gains) problem_.SetParameterBlockConstant(log_gain(0));
        std::vector<std::pair<const double*, const double*>> wanted;
        const bool directed = freedom_.directions != DirectionFreedom::listed;
        for (std::size_t i = 0; i < photos_; ++i) {
            if (directed) wanted.emplace_back(turn(i), turn(i));
            if (freedom_.beams) wanted.emplace_back(beam(i), beam(i));
            for (std::size_t j = i; freedom_.gains && j < photos_; ++j)
                wanted.emplace_back(log_gain(i), log_gain(j));
        }
        const bool rig_moves = freedom_.rig || measured();
        if (rig_moves) wanted.emplace_back(rig(), rig());
        ceres::Covariance::Options options;
        options.num_threads = 1;
        ceres::Covariance covariance(options);
        JointLights::Errors errors;
        if (wanted.empty() || !covariance.Compute(wanted, &problem_)) return errors;
        // The denser the samples are, the more of them share an error.
        const double dependent =
            kDependent * std::sqrt(std::max(1.0, static_cast<double>(pixels_) / kSparse));
        const auto sigma = [dependent](double variance) {
            return std::sqrt(std::max(dependent * variance, 0.0));
        };
        for (std::size_t i = 0; directed && i < photos_; ++i) {
            std::array<double, kTurn * kTurn> c{};
            covariance.GetCovarianceBlock(turn(i), turn(i), c.data());
            errors.direction_deg.push_back(sigma((c[0] + c[3]) / 2) * 180 / std::numbers::pi);
        }
        for (std::size_t i = 0; freedom_.beams && i < photos_; ++i) {
            std::array<double, kBeam * kBeam> c{};
            covariance.GetCovarianceBlock(beam(i), beam(i), c.data());
            errors.beams.push_back(sigma(std::inner_product(c.begin(), c.end(), moments_.begin(), 0.0)));
        }
        if (freedom_.gains) errors.log_gains = gain_errors(covariance, sigma);
        if (rig_moves) {
            std::array<double, kRig * kRig> c{};
            covariance.GetCovarianceBlock(rig(), rig(), c.data());
            const auto of = [&](std::size_t i) { return sigma(c[i * kRig + i]); };
            errors.rig = {of(0), of(1), of(2), of(3), of(4)};
        }
        return errors;
    }

private:
    bool measured() const { return freedom_.directions == DirectionFreedom::measured; }

    template <class Sigma>
    std::vector<double> gain_errors(const ceres::Covariance& covariance, const Sigma& sigma) {
        std::vector<double> c(photos_ * photos_), row_means(photos_);
        double mean = 0;
        const auto n = static_cast<double>(photos_);
        for (std::size_t i = 0; i < photos_; ++i)
            for (std::size_t j = i; j < photos_; ++j) {
                double value = 0;
                covariance.GetCovarianceBlock(log_gain(i), log_gain(j), &value);
                c[i * photos_ + j] = c[j * photos_ + i] = value;
            }
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

    void add_observations(const JointLights& joint) {
        for (const JointLights::Observation& o : joint.observations) {
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
            ordering_->AddElementToGroup(block, 0);
        }
    }

    void add_gains(const JointLights& joint) {
        // A lamp far from the trend must not be drawn to it at all: with Cauchy's loss, which never lets go,
        // a weak lamp at 15 degrees came out 4 % too strong. Nor must one that is near it by chance where the
        // others are not: 3 %.
        auto* outlying = new ceres::TukeyLoss(kBiweight * prior_weight_);
        const double weight = prior_weight_ / std::max(joint.gain_scatter, kGainSigma);
        for (std::size_t i = 0; i < photos_; ++i) {
            problem_.AddResidualBlock(cost<1, 1, kJointTrend>(GainPrior{joint.directions[i], weight}),
                                      outlying, log_gain(i), trend());
            if (!freedom_.gains) problem_.SetParameterBlockConstant(log_gain(i));
            ordering_->AddElementToGroup(log_gain(i), 1);
        }
        // The trend's constant only follows the albedo: strength is relative.
        const double t = 1 / kTrendSigma;
        problem_.AddResidualBlock(cost<kJointTrend, kJointTrend>(Weighted<kJointTrend>{{1e4, t, t, t, t, t}}),
                                  nullptr, trend());
        ordering_->AddElementToGroup(trend(), 1);
    }

    void add_turns(const JointLights& joint) {
        for (std::size_t i = 0; i < photos_; ++i) {
            ordering_->AddElementToGroup(turn(i), 1);
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
        const bool own = freedom_.directions != DirectionFreedom::smooth;
        auto* outlying =
            own ? new ceres::CauchyLoss(2 * (measured() ? kKnownWeight : prior_weight_)) : nullptr;
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
        ordering_->AddElementToGroup(field(), 1);
    }

    // What all lamps have in common is left to the albedo, and what goes with their directions to a bulge:
    // where photographs can't tell, few uneven beams are likelier than many.
    void add_beams() {
        auto* outlying = freedom_.beams ? new ceres::CauchyLoss(prior_weight_) : nullptr;
        for (std::size_t i = 0; i < photos_; ++i) {
            ordering_->AddElementToGroup(beam(i), 1);
            if (freedom_.beams)
                problem_.AddResidualBlock(new PullToZero(kBeam, prior_weight_ / kBeamSigma), outlying,
                                          beam(i));
            else
                problem_.SetParameterBlockConstant(beam(i));
        }
    }

    double turn_weight(const JointLights& joint, std::size_t photo) const {
        switch (freedom_.directions) {
            case DirectionFreedom::measured:
                return kKnownWeight / std::max(joint.direction_sigma[photo], kNoTurn);
            case DirectionFreedom::own:
                return prior_weight_ / kTurnSigma;
            default:
                return prior_weight_ / (freedom_.pixels ? kNoTurn : kTurnSigma);
        }
    }

    // What is measured with one ball is off alike for lamps that are near each other: as a whole by as much
    // as each by itself.
    double field_weight(const JointLights& joint) const {
        if (!measured()) return 1 / kFieldSigma;
        double squares = 0;
        for (const double sigma : joint.direction_sigma)
            squares += 2 * sigma * sigma / static_cast<double>(photos_);
        return kKnownWeight * std::sqrt(directions.modes() / std::max(squares, kNoTurn * kNoTurn));
    }

    void add_rig(const JointLights& joint) {
        const double rough = measured() ? kKnownWeight / kRoughSigma : 0;
        problem_.AddResidualBlock(cost<kRig, kRig>(Weighted<kRig>{{0, 0, 1 / kCameraSigma, 0, rough}}),
                                  nullptr, rig());
        ordering_->AddElementToGroup(rig(), 1);
        const std::array<std::array<double, 2>, kRig> bounds = {
            {{0, 1.2}, {0, 0.6}, {0, 1.2}, {-0.5, 0.5}, {0, 1}}};
        for (int i = 0; i < kRig; ++i) {
            const bool known = i == 2 ? joint.camera_known : (i == 0 || i == 3) && joint.lamps_known;
            if (known) continue;  // may lie outside, and stays
            problem_.SetParameterLowerBound(rig(), i, bounds[static_cast<std::size_t>(i)][0]);
            problem_.SetParameterUpperBound(rig(), i, bounds[static_cast<std::size_t>(i)][1]);
        }
        std::vector<int> known;
        if (joint.lamps_known || !freedom_.rig) known = {0, 3};
        if (joint.camera_known || !freedom_.rig) known.push_back(2);
        if (!freedom_.rig) known.push_back(1);
        if (!measured()) known.push_back(4);
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
    std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ =
        std::make_shared<ceres::ParameterBlockOrdering>();
};

}  // namespace

bool JointLights::solve(const JointFreedom& freedom, JointStart start) {
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
    const double* r = blocks.rig();
    rig = {r[0], r[1], r[2], r[3], r[4]};
    field = blocks.directions;
    cost = blocks.final_cost;
    coefficients.assign(blocks.field(), blocks.field() + blocks.field_size());
    return true;
}

double JointLights::unevenness(std::size_t lamp) const {
    const BeamMoments moments = beam_moments(pixels);
    double squares = 0;
    for (std::size_t i = 0; i < moments.size(); ++i)
        squares += moments[i] * beams[lamp][i / kBeam] * beams[lamp][i % kBeam];
    return std::sqrt(std::max(squares, 0.0));
}

JointLights::Errors JointLights::errors(const JointFreedom& freedom) const {
    return Blocks(*this, freedom).errors();
}

}  // namespace tangi
