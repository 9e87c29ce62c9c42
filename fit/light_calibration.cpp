#include "fit/light_calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <numeric>

#include "fit/light_sample.h"
#include "surface/median.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

// Each model is tried with some photographs left out at a time.
struct LeftOutPhotos {
    int trials;
    int step;  // in each trial every photograph of so many

    bool has(int photo, int trial) const { return photo % step == step / trials * trial; }
};
constexpr LeftOutPhotos kHalfOfThem = {3, 6};
// Fewer photographs say nothing of a surface when one of them is left out.
constexpr int kFewestForRig = 5;
// [deg] Turns that are less than this in rms are not worth trying.
constexpr double kSmallTurn_deg = 0.5;
constexpr double kDoubtful_deg = 5;  // [deg] a correction that the user is told of
// A smooth correction is believed where lamps turned by so many standard errors: less, and it takes up what
// the model leaves out (synth_canvas, whose directions are right: 2.6; leaf: 4.7).
constexpr double kSureTurns = 3;
// [dB] By which directions of their own must explain photographs better: two unknowns a lamp take up some of
// what the model leaves out, and lamps that no photograph had don't share them (real/canvas lost 3.7 dB at
// 0.1).
constexpr double kOwnWorth_db = 1.5;
// [dB] Likewise by strengths of their own: one unknown a lamp. They are looked at last, since lamps of wrong
// direction seem to be of wrong strength.
constexpr double kGainsWorth_db = 0.75;
// Fewer photographs don't tell a lamp's direction from what the model leaves out: of 16 lamps whose
// directions were right, some were "corrected" by 5 degrees.
constexpr std::size_t kFewestForDirections = 24;
// [rad] By which a lamp's direction, or the painting as a whole, may be tilted where directions are taken as
// listed, and which relief that no pixel resolves amounts to. Light that falls at an elevation e changes by
// so much times cot e.
constexpr double kTilt = 0.01;
constexpr double kFar = 0.01;  // [1/width] nearness from which on a distance says something

double mean(const std::vector<double>& values) {
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

JointFreedom freedom_of(const LightModel& model) {
    return {.rig = model.lamps != LightFreedom::none,
            .gains = model.lamps == LightFreedom::rig_and_gains,
            .directions = model.directions};
}

void apply_directions(const JointLights& joint, LightCalibration& result) {
    result.field = joint.field;
    result.coefficients = joint.coefficients;
    for (std::size_t i = 0; i < joint.turns.size(); ++i) {
        Light& light = result.lighting.lights[i];
        light.direction = Vec3(turned(joint.directions[i], joint.turns[i]));
        if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
        result.turns.push_back(
            {.changed_deg = std::atan(glm::length(joint.turns[i])) * 180 / std::numbers::pi, .sigma_deg = 0});
    }
}

// The lighting that a solved joint problem means.
LightCalibration calibration_of(const LightSample& sample, const JointLights& joint, const Lighting& given,
                                const LightModel& model) {
    LightCalibration result{.lighting = given, .model = model};
    Rig& rig = result.lighting.rig;
    const auto distance = [&](double nearness) {
        return nearness > kFar ? std::optional(static_cast<float>(sample.width_mm() / nearness))
                               : std::nullopt;
    };
    if (model.lamps != LightFreedom::none) {
        rig.ambient = static_cast<float>(joint.rig.ambient);
        if (!joint.lamps_known) {
            rig.lamp_distance_mm = distance(joint.rig.lamp_nearness);
            rig.bend_per_mm = static_cast<float>(joint.rig.bend / sample.width_mm());
        }
        if (!joint.camera_known) rig.camera_distance_mm = distance(joint.rig.camera_nearness);
    }
    if (model.directions != DirectionFreedom::listed) apply_directions(joint, result);
    if (model.directions == DirectionFreedom::measured) result.diffuse_roughness = joint.rig.roughness;
    const double middle = median(joint.log_gains);
    for (std::size_t i = 0; i < joint.log_gains.size(); ++i) {
        Light& light = result.lighting.lights[i];
        light.gain *= static_cast<float>(std::exp(joint.log_gains[i] - middle));
        if (rig.lamp_distance_mm) light.position_mm = light.direction * *rig.lamp_distance_mm;
    }
    // One lamp that was carried around is as strong elsewhere as it was given.
    if (model.lamps == LightFreedom::rig_and_gains && !joint.lamps_known)
        result.lamps = fit_lamp_model(result.lighting.lights);
    return result;
}

// The joint problem of all photographs, solved under one model; nothing where there is nothing to solve, or
// where directions turn out to be right.
std::optional<JointLights> solved(const LightSample& sample, const std::vector<int>& photos,
                                  const Lighting& given, const LightModel& model) {
    if (model == LightModel{}) return {};
    JointLights joint = sample.joint_problem(photos, given);
    if (joint.pixels.empty() || !joint.solve(freedom_of(model), JointStart::far)) return {};
    double squares = 0;
    for (const glm::dvec2& turn : joint.turns) squares += glm::dot(turn, turn);
    const double rms_deg = std::sqrt(squares / static_cast<double>(photos.size())) * 180 / std::numbers::pi;
    const bool found =
        model.directions == DirectionFreedom::smooth || model.directions == DirectionFreedom::own;
    if (found && rms_deg < kSmallTurn_deg) return {};
    return joint;
}

struct FoldResult {
    std::vector<double> photos_db, located_db;  // as in Trial
};

// The photographs of one trial, predicted from all others. `all` is the solution with all photographs: where
// to start, so that the trial's own solution is a few steps away. Lamps are located with the gains of
// `model`, and with directions if it has own ones.
FoldResult left_out(const LightSample& sample, const Lighting& given, const LightModel& model,
                    const std::optional<JointLights>& all, const LeftOutPhotos& out, int trial) {
    std::vector<int> used, left;
    for (int i = 0; i < static_cast<int>(given.lights.size()); ++i)
        (out.has(i, trial) ? left : used).push_back(i);
    LightCalibration c{.lighting = subset(given, used)};
    if (all) {
        JointLights joint = sample.joint_problem(used, c.lighting, *all);
        if (joint.solve(freedom_of(model), JointStart::near))
            c = calibration_of(sample, joint, c.lighting, model);
    }
    const std::vector<WardEstimate> estimates = sample.fit(used, c.lighting);
    FoldResult result;
    for (const int i : left) {
        Lighting one = subset(given, {i});
        one.rig = c.lighting.rig;
        Light& light = one.lights.front();
        light.direction = corrected_direction(c, light.direction);
        if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
        if (c.lamps)
            light.gain *= static_cast<float>(predicted_gain(*c.lamps, c.lighting.lights, light.direction));
        if (one.rig.lamp_distance_mm) light.position_mm = light.direction * *one.rig.lamp_distance_mm;
        result.photos_db.push_back(sample.psnr_db(estimates, i, one));
        const Lighting located = sample.located(estimates, i, one, freedom_of(model));
        result.located_db.push_back(sample.psnr_db(estimates, i, located, 1, 2));
    }
    return result;
}

// A model, solved with all photographs, and how it predicts those left out.
struct Tried {
    std::optional<JointLights> solution;
    LightCalibration::Trial trial;
};

std::vector<Tried> tried(const LightSample& sample, const std::vector<int>& photos, const Lighting& given,
                         const std::vector<LightModel>& models, const LeftOutPhotos& out,
                         const std::function<void()>& step_done) {
    const int count = static_cast<int>(models.size());
    std::vector<Tried> result(models.size());
    parallel_for(0, count, 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto at = static_cast<std::size_t>(i);
            result[at].trial.model = models[at];
            result[at].solution = solved(sample, photos, given, models[at]);
            step_done();
        }
    });
    std::vector<std::vector<FoldResult>> folds(models.size(),
                                               std::vector<FoldResult>(static_cast<std::size_t>(out.trials)));
    parallel_for(0, out.trials * count, 1, [&](int begin, int end) {
        for (int task = begin; task < end; ++task) {
            step_done();
            const auto at = static_cast<std::size_t>(task / out.trials);
            if (!result[at].solution && models[at] != LightModel{}) continue;
            const int fold = task % out.trials;
            folds[at][static_cast<std::size_t>(fold)] =
                left_out(sample, given, models[at], result[at].solution, out, fold);
        }
    });
    for (std::size_t i = 0; i < models.size(); ++i) {
        LightCalibration::Trial& trial = result[i].trial;
        for (const FoldResult& fold : folds[i]) {
            trial.photos_db.insert(trial.photos_db.end(), fold.photos_db.begin(), fold.photos_db.end());
            trial.located_db.insert(trial.located_db.end(), fold.located_db.begin(), fold.located_db.end());
        }
        trial.left_out_db = mean(trial.photos_db);
    }
    return result;
}

// [dB] The median by which `a` exceeds `b`, as one photograph whose lamp moved is no reason for or against,
// and its standard error (that of a median of normal values; their spread by the median absolute deviation).
struct Gain {
    double median_db, sigma_db;
};
Gain gain(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> gained;
    for (std::size_t i = 0; i < a.size(); ++i) gained.push_back(a[i] - b[i]);
    const double middle = median(gained), count = static_cast<double>(gained.size());
    for (double& db : gained) db = std::abs(db - middle);
    return {middle, 1.2533 * 1.4826 * median(std::move(gained)) / std::sqrt(count)};
}

// Whether `a`, which gives each lamp something of its own that those left out don't share in, explains
// photographs better than `b` once their lamps are located, and predicts them no worse than by `loss_db`, or
// than chance does.
bool explains_better(const LightCalibration::Trial& a, const LightCalibration::Trial& b, double explained_db,
                     double loss_db) {
    const Gain predicted = gain(a.photos_db, b.photos_db), located = gain(a.located_db, b.located_db);
    return located.median_db - located.sigma_db > explained_db &&
           predicted.median_db > -std::min(predicted.sigma_db, loss_db);
}

// Whether `a` predicts photographs better than `b` for sure; directions of their own need only explain them.
// Where listed directions are far off, so is that of the lamp that was left out: predictions are then poor
// with any surface, and only a sure loss speaks against a better one.
bool is_better(const LightCalibration::Trial& a, const LightCalibration::Trial& b, double worth_db) {
    const Gain predicted = gain(a.photos_db, b.photos_db);
    if (predicted.median_db - predicted.sigma_db > worth_db) return true;
    return a.model.directions == DirectionFreedom::own &&
           explains_better(a, b, kOwnWorth_db, std::numeric_limits<double>::infinity());
}

// Root mean square over the lamps of how far they turned, in standard errors.
double turns_in_sigmas(const LightCalibration& calibration) {
    double squares = 0, count = 0;
    for (const LightCalibration::Turn& turn : calibration.turns) {
        if (!(turn.sigma_deg > 0)) continue;
        squares += turn.changed_deg * turn.changed_deg / (turn.sigma_deg * turn.sigma_deg);
        ++count;
    }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

void add_errors(const JointLights& solution, LightCalibration& c) {
    const JointLights::Errors errors = solution.errors(freedom_of(c.model));
    for (std::size_t i = 0; i < errors.direction_deg.size(); ++i)
        c.turns[i].sigma_deg = errors.direction_deg[i];
    c.gain_sigma = errors.log_gains;
    for (std::size_t i = 0; i < c.gain_sigma.size(); ++i) {
        const Vec3& l = c.lighting.lights[i].direction;
        c.gain_sigma[i] = std::hypot(c.gain_sigma[i], kTilt * std::hypot(l.x, l.y) / std::max(l.z, 0.05f));
    }
    if (!errors.rig) return;
    const auto relative = [](double sigma, double nearness) {
        return nearness > kFar ? sigma / nearness : 0;
    };
    c.rig_sigma = {errors.rig->ambient, errors.rig->roughness,
                   relative(errors.rig->lamp_nearness, solution.rig.lamp_nearness),
                   relative(errors.rig->camera_nearness, solution.rig.camera_nearness)};
}

std::vector<int> all_of(const Stack& stack) {
    std::vector<int> all(stack.photos.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

}  // namespace

std::string name_of(const LightModel& model) {
    constexpr std::array lamps = {"as given", "rig", "rig and gains"};
    const std::string name = lamps[static_cast<std::size_t>(model.lamps)];
    if (model.directions == DirectionFreedom::listed) return name;
    constexpr std::array directions = {"", ", smooth directions", ", own directions",
                                       ", measured directions"};
    return name + directions[static_cast<std::size_t>(model.directions)];
}

std::string warning_of(const LightCalibration& calibration, const std::string& folder) {
    std::string names;
    for (std::size_t i = 0; i < calibration.turns.size(); ++i) {
        const LightCalibration::Turn& turn = calibration.turns[i];
        if (turn.changed_deg <= kDoubtful_deg) continue;
        names += fmt::format("{}{} by {:.1f} ± {:.1f}", names.empty() ? "" : ", ",
                             calibration.lighting.lights[i].name, turn.changed_deg, turn.sigma_deg);
    }
    if (names.empty()) return {};
    return fmt::format(
        "{}: the photographs contradict the listed directions of lamps by more than {} degrees: {}; "
        "corrected, --lights-as-given keeps them",
        folder, kDoubtful_deg, names);
}

Vec3 corrected_direction(const LightCalibration& calibration, const Vec3& listed) {
    if (calibration.coefficients.empty()) return listed;
    const glm::dvec3 direction(listed);
    return Vec3(turned(direction, calibration.field.turn(calibration.coefficients, direction)));
}

nlohmann::json to_json(const LightCalibration& calibration) {
    using nlohmann::json;
    const Rig& rig = calibration.lighting.rig;
    const auto distance = [](const std::optional<float>& mm) { return mm ? json(*mm) : json(nullptr); };
    json trials = json::object(), gains = json::object(), turns = json::object(), sigmas = json::object();
    for (std::size_t i = 0; i < calibration.gain_sigma.size(); ++i)
        sigmas[calibration.lighting.lights[i].name] = calibration.gain_sigma[i];
    // A relative error of a distance, in mm.
    const auto error = [](const std::optional<float>& mm, double relative) {
        return mm && relative > 0 ? json(*mm * relative) : json(nullptr);
    };
    for (const LightCalibration::Trial& trial : calibration.trials)
        trials[name_of(trial.model)] = trial.left_out_db;
    if (calibration.lamps)
        for (const Light& light : calibration.lighting.lights) gains[light.name] = light.gain.g;
    for (std::size_t i = 0; i < calibration.turns.size(); ++i)
        turns[calibration.lighting.lights[i].name] = {{"changed_deg", calibration.turns[i].changed_deg},
                                                      {"sigma_deg", calibration.turns[i].sigma_deg}};
    return {{"calibrated", name_of(calibration.model)},
            {"left_out_db", trials},
            {"ambient", rig.ambient},
            {"lamp_distance_mm", distance(rig.lamp_distance_mm)},
            {"camera_distance_mm", distance(rig.camera_distance_mm)},
            {"bend_per_mm", rig.bend_per_mm},
            {"diffuse_roughness",
             calibration.diffuse_roughness ? json(*calibration.diffuse_roughness) : json(nullptr)},
            {"sigma",
             {{"ambient",
               calibration.rig_sigma.ambient > 0 ? json(calibration.rig_sigma.ambient) : json(nullptr)},
              {"diffuse_roughness",
               calibration.diffuse_roughness ? json(calibration.rig_sigma.diffuse_roughness) : json(nullptr)},
              {"lamp_distance_mm", error(rig.lamp_distance_mm, calibration.rig_sigma.lamp_distance)},
              {"camera_distance_mm", error(rig.camera_distance_mm, calibration.rig_sigma.camera_distance)},
              {"gains", sigmas}}},
            {"gains", gains},
            {"directions", turns}};
}

LightCalibration calibrate_lights(const Stack& stack, const Survey& survey, const Transfer& transfer,
                                  const NoiseModel& noise, const Lighting& given, double mm_per_pixel,
                                  const WardFitOptions& ward, const LightCalibrationOptions& options,
                                  const Progress& progress) {
    validate(options);
    const int photos = static_cast<int>(stack.photos.size());
    if (photos < kFewestForRig) return {.lighting = given};
    // Few photographs tell what all lamps share, but not each lamp's strength: one more unknown a photograph.
    const bool few = photos < options.fewest_photos;
    const LeftOutPhotos out = few ? LeftOutPhotos{photos, photos} : kHalfOfThem;
    const LightSample sample(stack, survey, transfer, noise, mm_per_pixel, ward, options.samples);
    std::mutex mutex;
    int done = 0;
    const int steps = (few ? 2 : 6) * (1 + out.trials);  // at most
    const auto step_done = [&] {
        const std::lock_guard lock(mutex);
        report(progress, "lights", ++done / static_cast<double>(steps));
    };
    std::vector<Tried> all;
    std::size_t best = 0;
    const auto attempt = [&](const std::vector<LightModel>& models) {
        for (Tried& one : tried(sample, all_of(stack), given, models, out, step_done)) {
            all.push_back(std::move(one));
            if (!all.back().solution && all.size() > 1) {
                all.pop_back();
                continue;
            }
            if (is_better(all.back().trial, all[best].trial, options.worth_db)) best = all.size() - 1;
        }
    };
    std::vector<LightModel> models = {{LightFreedom::none}, {LightFreedom::rig}};
    if (!few) models.push_back({LightFreedom::rig_and_gains});
    attempt(models);
    const std::size_t listed = best;
    const LightFreedom lamps = all[best].trial.model.lamps;
    // A lamp that was left out has no part in directions of each lamp's own: with few photographs leaving
    // some out says nothing of them, and it is up to the user.
    const bool measured = !given.direction_sigma_deg.empty();
    const DirectionFreedom refined = measured ? DirectionFreedom::measured : DirectionFreedom::own;
    const bool refines = !few && (options.refine_directions || measured);
    if (refines)
        attempt({{lamps, refined}});
    else if (!few && stack.photos.size() >= kFewestForDirections)
        attempt({{lamps, DirectionFreedom::smooth}, {lamps, DirectionFreedom::own}});
    if (refines && all.back().trial.model.directions == refined) best = all.size() - 1;
    const auto calibrated = [&](const Tried& one) {
        if (!one.solution) return LightCalibration{.lighting = given};
        LightCalibration c = calibration_of(sample, *one.solution, given, one.trial.model);
        add_errors(*one.solution, c);
        return c;
    };
    if (all[best].trial.model.directions == DirectionFreedom::smooth &&
        turns_in_sigmas(calibrated(all[best])) < kSureTurns)
        best = listed;
    if (!few && all[best].trial.model.lamps != LightFreedom::rig_and_gains) {
        const LightModel wanted{LightFreedom::rig_and_gains, all[best].trial.model.directions};
        const auto is_wanted = [&](const Tried& one) { return one.trial.model == wanted; };
        const std::size_t before = best;
        if (std::none_of(all.begin(), all.end(), is_wanted)) attempt({wanted});
        const auto found = std::find_if(all.begin(), all.end(), is_wanted);
        if (best == before && found != all.end() &&
            explains_better(found->trial, all[best].trial, kGainsWorth_db, options.worth_db))
            best = static_cast<std::size_t>(found - all.begin());
    }
    LightCalibration result = calibrated(all[best]);
    for (Tried& one : all) result.trials.push_back(std::move(one.trial));
    return result;
}

}  // namespace tangi
