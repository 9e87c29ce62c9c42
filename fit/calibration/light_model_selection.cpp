#include "fit/calibration/light_model_selection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

// [rad] By which a light's direction, or the painting as a whole, may be tilted where directions are taken as
// listed, and which relief that no pixel resolves amounts to. Light that falls at an elevation e changes by
// so much times cot e.
constexpr double kTilt = 0.01;
constexpr double kFar = 0.01;  // [1/width] nearness from which on a distance says something

double mean_or_zero(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

Lighting subset(const Lighting& lighting, const std::vector<int>& photos) {
    Lighting result{{}, lighting.rig, lighting.white_level};
    for (const int i : photos) {
        result.lights.push_back(lighting.lights[static_cast<std::size_t>(i)]);
        if (!lighting.direction_sigma_deg.empty())
            result.direction_sigma_deg.push_back(lighting.direction_sigma_deg[static_cast<std::size_t>(i)]);
    }
    return result;
}

JointFreedom freedom_of(const LightingModel& model) {
    return {.rig = model.lights != LightFreedom::none,
            .gains = model.lights == LightFreedom::rig_and_gains,
            .directions = model.directions,
            .beams = model.beams};
}

void apply_directions(const LightBundleAdjustment& joint, LightCalibration& result) {
    std::vector<Vec3> listed;
    for (std::size_t i = 0; i < joint.turns.size(); ++i) {
        Light& light = result.lighting.lights[i];
        listed.push_back(light.direction);
        light.direction = Vec3(turned(joint.directions[i], joint.turns[i]));
        if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
        result.turns.push_back(
            {.changed_deg = std::atan(glm::length(joint.turns[i])) * 180 / std::numbers::pi, .sigma_deg = 0});
    }
    result.directions = fit_direction_model(listed, result.lighting.lights);
}

// The lighting that a solved joint problem means.
LightCalibration calibration_of(const LightSample& sample, const LightBundleAdjustment& joint,
                                const Lighting& given, const LightingModel& model) {
    LightCalibration result;
    result.lighting = given;
    result.model = model;
    Rig& rig = result.lighting.rig;
    const auto distance = [&](double inverse_distance) {
        return inverse_distance > kFar
                   ? std::optional(static_cast<float>(sample.width_mm() / inverse_distance))
                   : std::nullopt;
    };
    if (model.lights != LightFreedom::none) {
        rig.ambient = static_cast<float>(joint.rig.ambient);
        if (!joint.lights_known) {
            rig.light_distance_mm = distance(joint.rig.light_inverse_distance);
            if (rig.light_distance_mm)
                rig.surface_above_mm = static_cast<float>(joint.rig.height * sample.width_mm());
            rig.bend_per_mm = static_cast<float>(joint.rig.bend / sample.width_mm());
            result.bent_most = std::abs(joint.rig.bend) > 0.98 * kMostBend;
        }
        if (!joint.camera_known) rig.camera_distance_mm = distance(joint.rig.camera_inverse_distance);
    }
    if (model.directions != DirectionFreedom::listed) apply_directions(joint, result);
    if (model.directions == DirectionFreedom::measured) result.diffuse_roughness = joint.rig.roughness;
    const double middle = median(joint.log_gains);
    for (std::size_t i = 0; i < joint.log_gains.size(); ++i) {
        Light& light = result.lighting.lights[i];
        light.gain *= static_cast<float>(std::exp(joint.log_gains[i] - middle));
        place(light, rig);
        if (model.beams) light.beam = beam_of(joint.beams[i], sample.width_mm());
    }
    if (model.beams) {
        result.beams = fit_beam_model(result.lighting.lights, sample.width_mm() / 2);
        for (std::size_t i = 0; i < joint.beams.size(); ++i)
            result.unevenness.push_back({.rms = joint.unevenness(i), .sigma = 0});
    }
    // One light that was carried around is as strong elsewhere as it was given.
    if (model.lights == LightFreedom::rig_and_gains && !joint.lights_known)
        result.light_model = fit_light_model(result.lighting.lights);
    return result;
}

// The joint problem of all photographs, solved under one model; nothing where there is nothing to solve.
std::optional<LightBundleAdjustment> solved(const LightSample& sample, const Lighting& given,
                                            const LightingModel& model,
                                            const std::optional<LightBundleAdjustment>& from) {
    if (model == LightingModel{}) return {};
    std::vector<int> photos(given.lights.size());
    std::iota(photos.begin(), photos.end(), 0);
    LightBundleAdjustment joint =
        from ? sample.joint_problem(photos, given, *from) : sample.joint_problem(photos, given);
    const JointStart start = from ? JointStart::near : JointStart::far;
    if (joint.pixels.empty() || !joint.solve(freedom_of(model), start)) return {};
    return joint;
}

struct FoldResult {
    std::vector<double> photos_db;  // as in Trial
    ValidationScores scores;
};

// The photographs of one trial, predicted from all others. `all` is the solution with all photographs: where
// to start, so that the trial's own solution is a few steps away. Lights are located with the gains of
// `model`, and with directions and beams if it has own ones.
FoldResult validation(const LightSample& sample, const Lighting& given, const LightingModel& model,
                      const std::optional<LightBundleAdjustment>& all, const LeftOutPhotos& out, int trial) {
    std::vector<int> used, left;
    std::vector<Vec3> listed;
    for (int i = 0; i < static_cast<int>(given.lights.size()); ++i)
        (out.has(i, trial) ? left : used).push_back(i);
    for (const int i : used) listed.push_back(given.lights[static_cast<std::size_t>(i)].direction);
    LightCalibration c{.lighting = subset(given, used)};
    if (all) {
        LightBundleAdjustment joint = sample.joint_problem(used, c.lighting, *all);
        if (joint.solve(freedom_of(model), JointStart::near))
            c = calibration_of(sample, joint, c.lighting, model);
    }
    const std::vector<WardEstimate> estimates = sample.fit(used, c.lighting);
    FoldResult result;
    const double noise = sample.squared_noise(given.white_level);
    for (const int i : left) {
        Lighting one = subset(given, {i});
        one.rig = c.lighting.rig;
        Light& light = one.lights.front();
        if (c.directions) light.direction = predicted_direction(*c.directions, listed, light.direction);
        if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
        place(light, one.rig);
        if (c.light_model)
            light.gain *=
                static_cast<float>(predicted_gain(*c.light_model, c.lighting.lights, light.direction));
        if (c.beams) light.beam = predicted_beam(*c.beams, c.lighting.lights, light.direction);
        std::vector<double> predicted = sample.squared_errors(estimates, i, one);
        result.photos_db.push_back(sample.psnr_db(predicted, given.white_level));
        const Lighting located = sample.located(estimates, i, one, freedom_of(model));
        result.scores.add_mean({std::move(predicted), sample.squared_errors(estimates, i, located)}, noise,
                               sample.others());
    }
    return result;
}

void add_errors(const LightBundleAdjustment& solution, double width_mm, LightCalibration& c) {
    const LightBundleAdjustment::Errors errors = solution.errors(freedom_of(c.model));
    for (std::size_t i = 0; i < errors.direction_deg.size(); ++i)
        c.turns[i].sigma_deg = errors.direction_deg[i];
    for (std::size_t i = 0; i < errors.beams.size(); ++i) c.unevenness[i].sigma = errors.beams[i];
    c.gain_sigma = errors.log_gains;
    for (std::size_t i = 0; i < c.gain_sigma.size(); ++i) {
        const Vec3& l = c.lighting.lights[i].direction;
        c.gain_sigma[i] = std::hypot(c.gain_sigma[i], kTilt * std::hypot(l.x, l.y) / std::max(l.z, 0.05f));
    }
    if (!errors.rig) return;
    const auto relative = [](double sigma, double inverse_distance) {
        return inverse_distance > kFar ? sigma / inverse_distance : 0;
    };
    c.rig_sigma = {errors.rig->ambient, errors.rig->roughness,
                   relative(errors.rig->light_inverse_distance, solution.rig.light_inverse_distance),
                   relative(errors.rig->camera_inverse_distance, solution.rig.camera_inverse_distance),
                   errors.rig->height * width_mm};
}

}  // namespace

std::vector<TriedModel> tried(const LightSample& sample, const Lighting& given,
                              const std::vector<LightingModel>& models, const LeftOutPhotos& out,
                              const std::function<void()>& step_done,
                              const std::optional<LightBundleAdjustment>& from) {
    const int count = static_cast<int>(models.size());
    std::vector<TriedModel> result(models.size());
    parallel_for(0, count, 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto at = static_cast<std::size_t>(i);
            result[at].trial.model = models[at];
            result[at].solution = solved(sample, given, models[at], from);
            step_done();
        }
    });
    std::vector<std::vector<FoldResult>> folds(models.size(),
                                               std::vector<FoldResult>(static_cast<std::size_t>(out.trials)));
    parallel_for(0, out.trials * count, 1, [&](int begin, int end) {
        for (int task = begin; task < end; ++task) {
            step_done();
            const auto at = static_cast<std::size_t>(task / out.trials);
            if (!result[at].solution && models[at] != LightingModel{}) continue;
            const int fold = task % out.trials;
            folds[at][static_cast<std::size_t>(fold)] =
                validation(sample, given, models[at], result[at].solution, out, fold);
        }
    });
    for (std::size_t i = 0; i < models.size(); ++i) {
        LightCalibration::Trial& trial = result[i].trial;
        for (const FoldResult& fold : folds[i]) {
            trial.photos_db.insert(trial.photos_db.end(), fold.photos_db.begin(), fold.photos_db.end());
            trial.scores.add(fold.scores);
        }
        trial.cv_psnr_db = mean_or_zero(trial.photos_db);
    }
    return result;
}

LightCalibration calibrated(const LightSample& sample, const LightBundleAdjustment& solution,
                            const Lighting& given, const LightingModel& model) {
    LightCalibration c = calibration_of(sample, solution, given, model);
    add_errors(solution, sample.width_mm(), c);
    return c;
}

LightBundleAdjustment solved_finer(const LightSample& fine, const LightBundleAdjustment& solution,
                                   const Lighting& given, const LightingModel& model) {
    std::vector<int> photos(given.lights.size());
    std::iota(photos.begin(), photos.end(), 0);
    const LightCalibration coarse = calibration_of(fine, solution, given, model);
    LightBundleAdjustment joint =
        fine.joint_problem(photos, given, solution, fine.fit(photos, coarse.lighting));
    const bool better = !joint.pixels.empty() && joint.solve(freedom_of(model), JointStart::there);
    return better ? joint : solution;
}

}  // namespace tangi
