#include "fit/calibration/reflectance_model_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "fit/pixel/validation_scores.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

constexpr std::size_t kFewestForModel = 12;
constexpr std::size_t kFewestTypical = 100;  // [pixels] with a lobe
constexpr int kFolds = 4;                    // trials, each with every fourth photograph left out
constexpr std::array kHazes = {0.3, 0.6, 0.85};
constexpr std::array kRoughnesses = {0.15, 0.3, 0.5, 0.8};
constexpr double kFewestMarked = 0.01;  // [1] of the sample: a few pixels are noise
constexpr double kTrials = 1 + kHazes.size() + kRoughnesses.size();

Lighting lights_alone(const Lighting& lighting, const std::vector<int>& photos) {
    Lighting result{{}, lighting.rig, lighting.white_level};
    for (const int i : photos) result.lights.push_back(lighting.lights[static_cast<std::size_t>(i)]);
    return result;
}

// The sample with lobes that are, before any photograph, as wide as its own are on the whole under this law.
// What a pixel's few lights leave open is the prior's: where that is narrower than the paint's lobes are,
// second lobe would stand in for it (generated Ward lobes of 0.32 under 12 lights, prior 0.2: 0.85).
LightSample of_typical_lobes(const LightSample& sample, const Lighting& lighting,
                             const ReflectanceModel& reflectance_model) {
    constexpr int kSteps = 2;            // what is found is drawn to where it starts
    constexpr double kSeenSpecular = 2;  // [sigma] of rho_s from which on there is a lobe
    std::vector<int> all(lighting.lights.size());
    std::iota(all.begin(), all.end(), 0);
    std::optional<double> typical;
    const auto as_now = [&] { return typical ? sample.with_ln_alpha(*typical) : sample; };
    for (int step = 0; step < kSteps; ++step) {
        std::vector<double> widths;
        for (const WardEstimate& e : as_now().fit(all, lighting, reflectance_model))
            if (e.valid && e.specular > kSeenSpecular * e.specular_error)
                widths.push_back(std::log(e.roughness));
        if (widths.size() < kFewestTypical) break;
        typical = median(std::move(widths));
    }
    return as_now();
}

// Photographs, each predicted from others.
struct Prediction {
    double db = 0;  // on average
    ValidationScores scores;
};
Prediction validation(const LightSample& any, const Lighting& lighting,
                      const ReflectanceModel& reflectance_model) {
    const LightSample sample = of_typical_lobes(any, lighting, reflectance_model);
    const int photos = static_cast<int>(lighting.lights.size());
    const double noise = sample.squared_noise(lighting.white_level);
    Prediction result;
    for (int fold = 0; fold < kFolds; ++fold) {
        std::vector<int> used;
        for (int i = 0; i < photos; ++i)
            if (i % kFolds != fold) used.push_back(i);
        const std::vector<WardEstimate> estimates =
            sample.fit(used, lights_alone(lighting, used), reflectance_model);
        for (int i = fold; i < photos; i += kFolds) {
            const auto errors =
                sample.squared_errors(estimates, i, lights_alone(lighting, {i}), reflectance_model);
            result.db += sample.psnr_db(errors, lighting.white_level) / photos;
            result.scores.add(errors, noise);
        }
    }
    return result;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// [dB] of photographs, with lobes as they are and as something is known of them, and how many pixels have it.
struct LobeTrial {
    std::vector<double> plain_db, known_db;
    ValidationScores plain, known;
    ValidationScores whole;  // of all pixels, with what is known
    double part = 0;
};

// Estimates of the sample without that knowledge and with it, and the pixels to which it makes a difference.
struct LobeFits {
    std::vector<WardEstimate> plain, known;
    std::vector<bool> marked;

    template <class Known>
    void mark(const std::vector<Known>& values, const Known& none) {
        for (const Known& value : values) marked.push_back(value != none);
    }
    double part() const {
        return static_cast<double>(std::count(marked.begin(), marked.end(), true)) /
               std::max(static_cast<double>(marked.size()), 1.0);
    }
};

// Photographs left out in turn; in each turn, at the pixels that the others mark. `fit` gives fits of these
// photographs.
template <class Fit>
LobeTrial try_lobes(const LightSample& sample, const Lighting& lighting,
                    const ReflectanceModel& reflectance_model, const Fit& fit) {
    const int photos = static_cast<int>(lighting.lights.size());
    const double noise = sample.squared_noise(lighting.white_level);
    LobeTrial trial;
    for (int fold = 0; fold < kFolds; ++fold) {
        std::vector<int> used;
        for (int i = 0; i < photos; ++i)
            if (i % kFolds != fold) used.push_back(i);
        const LobeFits fits = fit(used, lights_alone(lighting, used));
        trial.part += fits.part() / kFolds;
        for (int i = fold; i < photos && !fits.known.empty(); i += kFolds) {
            const Lighting light = lights_alone(lighting, {i});
            const auto plain = sample.squared_errors(fits.plain, i, light, reflectance_model),
                       known = sample.squared_errors(fits.known, i, light, reflectance_model);
            trial.plain_db.push_back(sample.psnr_db(plain, lighting.white_level, fits.marked));
            trial.known_db.push_back(sample.psnr_db(known, lighting.white_level, fits.marked));
            trial.plain.add(plain, noise, fits.marked);
            trial.known.add(known, noise, fits.marked);
            trial.whole.add(known, noise);
        }
    }
    return trial;
}

// [dB] on average, and whether what is known of lobes predicts photographs better for sure.
struct LobeVerdict {
    bool chosen = false;
    double part = 0, plain_db = 0, known_db = 0;  // dB are 0 where too few pixels are marked
};
LobeVerdict verdict_of(const LobeTrial& trial) {
    LobeVerdict verdict{.part = trial.part};
    if (trial.part < kFewestMarked || trial.plain_db.size() < 2) return verdict;
    verdict.plain_db = mean(trial.plain_db);
    verdict.known_db = mean(trial.known_db);
    verdict.chosen = select_model(std::array{&trial.plain, &trial.known}) == 1;
    return verdict;
}

}  // namespace

ReflectanceModelSelection select_reflectance_model(const LightSample& sample, const Lighting& lighting,
                                                   const Progress& progress,
                                                   const std::optional<double>& diffuse_roughness) {
    ReflectanceModelSelection choice;
    choice.reflectance_model.diffuse_roughness = diffuse_roughness.value_or(0);
    if (lighting.lights.size() < kFewestForModel) return choice;
    const auto attempt = [&](const ReflectanceModel& reflectance_model) {
        report(progress, "reflectance", static_cast<double>(choice.trials.size()) / kTrials);
        Prediction prediction = validation(sample, lighting, reflectance_model);
        choice.trials.push_back({reflectance_model, prediction.db});
        return std::move(prediction.scores);
    };
    ValidationScores best = attempt(choice.reflectance_model);
    // Along one number of the model, upwards as long as photographs are predicted better.
    const auto search = [&](double ReflectanceModel::*number, const auto& values) {
        std::vector<std::pair<ReflectanceModel, ValidationScores>> tried;
        tried.emplace_back(choice.reflectance_model, std::move(best));
        for (const double value : values) {
            ReflectanceModel reflectance_model = choice.reflectance_model;
            reflectance_model.*number = value;
            ValidationScores scores = attempt(reflectance_model);
            if (scores.over(tried.back().second).mean <= 0) break;
            tried.emplace_back(reflectance_model, std::move(scores));
        }
        std::vector<const ValidationScores*> from_simplest;
        for (const auto& one : tried) from_simplest.push_back(&one.second);
        auto& chosen = tried[select_model(from_simplest)];
        choice.reflectance_model = chosen.first;
        best = std::move(chosen.second);
    };
    search(&ReflectanceModel::second_lobe_weight, kHazes);
    if (!diffuse_roughness) search(&ReflectanceModel::diffuse_roughness, kRoughnesses);
    report(progress, "reflectance", 1);
    return choice;
}

ReflectanceModelSelection::Colours choose_specular_colours(const LightSample& sample,
                                                           const Lighting& lighting,
                                                           const ReflectanceModel& reflectance_model,
                                                           bool anisotropic) {
    if (lighting.lights.size() < kFewestForModel) return {};
    const LobeTrial trial = try_lobes(
        sample, lighting, reflectance_model, [&](const std::vector<int>& used, const Lighting& lights) {
            LobeFits fits{.plain = sample.fit(used, lights, reflectance_model), .known = {}, .marked = {}};
            std::vector<Stretch> stretches;
            if (anisotropic) {
                stretches = sample.stretches(fits.plain, used, lights, reflectance_model);
                fits.plain = sample.fit(used, lights, reflectance_model, {}, stretches);
            }
            const std::vector<Rgb> found =
                sample.specular_colours(fits.plain, used, lights, reflectance_model);
            fits.mark(found, Rgb(1));
            if (fits.part() >= kFewestMarked)
                fits.known = sample.fit(used, lights, reflectance_model, found, stretches);
            return fits;
        });
    const LobeVerdict verdict = verdict_of(trial);
    return {.chosen = verdict.chosen,
            .part = verdict.part,
            .white_db = verdict.plain_db,
            .coloured_db = verdict.known_db};
}

namespace {

LobeTrial try_stretches(const LightSample& sample, const Lighting& lighting,
                        const ReflectanceModel& reflectance_model) {
    return try_lobes(
        sample, lighting, reflectance_model, [&](const std::vector<int>& used, const Lighting& lights) {
            LobeFits fits{.plain = sample.fit(used, lights, reflectance_model), .known = {}, .marked = {}};
            const std::vector<Stretch> found = sample.stretches(fits.plain, used, lights, reflectance_model);
            fits.mark(found, Stretch(0));
            if (fits.part() >= kFewestMarked)
                fits.known = sample.fit(used, lights, reflectance_model, {}, found);
            return fits;
        });
}

ReflectanceModelSelection::Stretches summary_of(const LobeTrial& trial) {
    const LobeVerdict verdict = verdict_of(trial);
    return {.chosen = verdict.chosen,
            .part = verdict.part,
            .isotropic_db = verdict.plain_db,
            .anisotropic_db = verdict.known_db};
}

}  // namespace

void choose_stretches(const LightSample& sample, const Lighting& lighting, bool second_lobe_is_open,
                      ReflectanceModelSelection& choice) {
    if (lighting.lights.size() < kFewestForModel) return;
    const LobeTrial trial = try_stretches(sample, lighting, choice.reflectance_model);
    choice.stretches = summary_of(trial);
    if (!choice.stretches.chosen || !second_lobe_is_open ||
        !(choice.reflectance_model.second_lobe_weight > 0))
        return;
    ReflectanceModel sharp = choice.reflectance_model;
    sharp.second_lobe_weight = 0;
    const LobeTrial without = try_stretches(sample, lighting, sharp);
    const ReflectanceModelSelection::Stretches stretches = summary_of(without);
    const bool has_second_lobe = select_model(std::array{&without.whole, &trial.whole}) == 1;
    if (!stretches.chosen || has_second_lobe) return;
    choice.stretches = stretches;
    choice.reflectance_model = sharp;
}

nlohmann::json to_json(const ReflectanceModelSelection& choice) {
    nlohmann::json trials = nlohmann::json::array();
    for (const ReflectanceModelSelection::Trial& trial : choice.trials)
        trials.push_back({{"diffuse_roughness", trial.reflectance_model.diffuse_roughness},
                          {"second_lobe_weight", trial.reflectance_model.second_lobe_weight},
                          {"psnr_db", trial.cv_psnr_db}});
    return {{"diffuse_roughness", choice.reflectance_model.diffuse_roughness},
            {"second_lobe_weight", choice.reflectance_model.second_lobe_weight},
            {"cv_psnr_db", trials},
            {"specular_colour",
             {{"chosen", choice.colours.chosen},
              {"part", choice.colours.part},
              {"white_db", choice.colours.white_db},
              {"specular_colour_db", choice.colours.coloured_db}}},
            {"anisotropic_specular",
             {{"chosen", choice.stretches.chosen},
              {"part", choice.stretches.part},
              {"isotropic_db", choice.stretches.isotropic_db},
              {"anisotropic_db", choice.stretches.anisotropic_db}}}};
}

}  // namespace tangi
