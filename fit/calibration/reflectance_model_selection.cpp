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
// [sigma] Most varnish and oil paint has a second lobe, all else is rarer.
constexpr double kSureOfSecondLobe = 1, kSureOfRarer = 2;
// A second lobe must also explain more of the samples: it stands in for lobes that are anisotropic
// (half brushed metal, half paint without second lobe: 0.3, 0.06 where single pixels tell how they are
// anisotropic; impasto, whose paint is hazy: 0.78 and 0.76). Rough reflection need not: of coin it serves the
// relief only, 0.43 of the pixels, but held-out photographs gain 2 dB by it.
constexpr double kFewestMarked = 0.01;  // [1] of the sample: a few pixels are noise
constexpr double kWorth = 0.1;  // [dB] of gain at least: as with lights, what gains less is left as it is
// [dB] Diffuse roughness is rarer than second lobe, and a little of it also takes up what one pixel's lobe
// leaves open, which the second pass of the fit knows better: impasto, whose paint is Lambert's, gains 0.37,
// with which its height is off by 0.045 mm instead of 0.034.
constexpr double kWorthOfRoughness = 0.5;
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
    std::vector<double> db;  // of each photograph
    ValidationScores pixels;
};
Prediction validation(const LightSample& any, const Lighting& lighting,
                      const ReflectanceModel& reflectance_model) {
    const LightSample sample = of_typical_lobes(any, lighting, reflectance_model);
    const int photos = static_cast<int>(lighting.lights.size());
    const double noise = sample.squared_noise(lighting.white_level);
    Prediction result;
    result.db.resize(lighting.lights.size());
    for (int fold = 0; fold < kFolds; ++fold) {
        std::vector<int> used;
        for (int i = 0; i < photos; ++i)
            if (i % kFolds != fold) used.push_back(i);
        const std::vector<WardEstimate> estimates =
            sample.fit(used, lights_alone(lighting, used), reflectance_model);
        for (int i = fold; i < photos; i += kFolds) {
            const auto errors =
                sample.squared_errors(estimates, i, lights_alone(lighting, {i}), reflectance_model);
            result.db[static_cast<std::size_t>(i)] = sample.psnr_db(errors, lighting.white_level);
            result.pixels.add(errors, noise);
        }
    }
    return result;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// [dB] What one gains over the other on average over the photographs, and its standard error.
struct Gain {
    double mean = 0, sigma = 0;
};
Gain gain_of(const std::vector<double>& db, const std::vector<double>& than) {
    std::vector<double> gained;
    for (std::size_t i = 0; i < db.size(); ++i) gained.push_back(db[i] - than[i]);
    const double middle = mean(gained), count = static_cast<double>(gained.size());
    double squares = 0;
    for (const double gain : gained) squares += (gain - middle) * (gain - middle);
    return {middle, std::sqrt(squares / (count * (count - 1)))};
}

// Whether it gains for sure, and as much as it is worth.
bool is_surely_better(const std::vector<double>& db, const std::vector<double>& than, double sigmas,
                      double worth) {
    const Gain gain = gain_of(db, than);
    return gain.mean > std::max(worth, sigmas * gain.sigma);
}

// Deviations below the noise to expect of stored values are no evidence: rounding, compression and a tone
// curve that is slightly off make them, too. With synth_canvas/uniform_1, predicted to half a code of 8
// bits, roughness predicts still better, and normals get worse by half.
struct WithNoise {
    double noise;
    WithNoise(const LightSample& sample, const Lighting& lighting)
        : noise(sample.squared_noise(lighting.white_level)) {}
    double operator()(double db) const { return -10 * std::log10(std::pow(10, -db / 10) + noise); }
    bool is_better(std::vector<double> db, std::vector<double> than, double sigmas = kSureOfRarer) const {
        for (std::vector<double>* values : {&db, &than})
            for (double& value : *values) value = (*this)(value);
        return is_surely_better(db, than, sigmas, kWorth);
    }
};

// [dB] of photographs, with lobes as they are and as something is known of them, and how many pixels have it.
struct LobeTrial {
    std::vector<double> plain_db, known_db;
    std::vector<double> whole_db;  // of all pixels, with what is known
    ValidationScores pixels;       // likewise
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
            trial.whole_db.push_back(sample.psnr_db(known, lighting.white_level));
            trial.pixels.add(known, noise);
        }
    }
    return trial;
}

// [dB] on average, and whether what is known of lobes predicts photographs better for sure.
struct LobeVerdict {
    bool chosen = false;
    double part = 0, plain_db = 0, known_db = 0;  // dB are 0 where too few pixels are marked
};
LobeVerdict verdict_of(const LightSample& sample, const Lighting& lighting, const LobeTrial& trial) {
    LobeVerdict verdict{.part = trial.part};
    if (trial.part < kFewestMarked || trial.plain_db.size() < 2) return verdict;
    verdict.plain_db = mean(trial.plain_db);
    verdict.known_db = mean(trial.known_db);
    verdict.chosen = WithNoise{sample, lighting}.is_better(trial.known_db, trial.plain_db);
    return verdict;
}

}  // namespace

ReflectanceModelSelection select_reflectance_model(const LightSample& sample, const Lighting& lighting,
                                                   const Progress& progress,
                                                   const std::optional<double>& diffuse_roughness) {
    ReflectanceModelSelection choice;
    choice.reflectance_model.diffuse_roughness = diffuse_roughness.value_or(0);
    if (lighting.lights.size() < kFewestForModel) return choice;
    const WithNoise with_noise{sample, lighting};
    const auto attempt = [&](const ReflectanceModel& reflectance_model) {
        report(progress, "reflectance", static_cast<double>(choice.trials.size()) / kTrials);
        Prediction prediction = validation(sample, lighting, reflectance_model);
        choice.trials.push_back({reflectance_model, mean(prediction.db)});
        for (double& value : prediction.db) value = with_noise(value);
        return prediction;
    };
    Prediction best = attempt(choice.reflectance_model);
    // Along one number of the law: upwards as long as photographs are predicted better. Of those tried, the
    // least that is not worse for sure: beyond it chance decides, and it would for another sample of pixels
    // otherwise (one-standard-error rule: Breiman, Friedman, Olshen, Stone 1984, ch. 3).
    const auto search = [&](double ReflectanceModel::*number, const auto& values, double sigmas, double worth,
                            bool of_samples) {
        std::vector<std::pair<ReflectanceModel, Prediction>> tried;
        ReflectanceModel reflectance_model = choice.reflectance_model;
        for (const double value : values) {
            reflectance_model.*number = value;
            Prediction prediction = attempt(reflectance_model);
            if (mean(prediction.db) <= mean((tried.empty() ? best : tried.back().second).db)) break;
            tried.emplace_back(reflectance_model, std::move(prediction));
        }
        if (tried.empty() || !is_surely_better(tried.back().second.db, best.db, sigmas, worth) ||
            (of_samples && tried.back().second.pixels.over(best.pixels).mean <= 0))
            return;
        const auto least = std::find_if(tried.begin(), tried.end(), [&](const auto& one) {
            const Gain gain = gain_of(tried.back().second.db, one.second.db);
            return gain.mean <= gain.sigma;
        });
        best = std::move(least->second);
        choice.reflectance_model = least->first;
    };
    search(&ReflectanceModel::second_lobe_weight, kHazes, kSureOfSecondLobe, kWorth, true);
    if (!diffuse_roughness)
        search(&ReflectanceModel::diffuse_roughness, kRoughnesses, kSureOfRarer, kWorthOfRoughness, false);
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
    const LobeVerdict verdict = verdict_of(sample, lighting, trial);
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

ReflectanceModelSelection::Stretches summary_of(const LightSample& sample, const Lighting& lighting,
                                                const LobeTrial& trial) {
    const LobeVerdict verdict = verdict_of(sample, lighting, trial);
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
    choice.stretches = summary_of(sample, lighting, trial);
    if (!choice.stretches.chosen || !second_lobe_is_open ||
        !(choice.reflectance_model.second_lobe_weight > 0))
        return;
    ReflectanceModel sharp = choice.reflectance_model;
    sharp.second_lobe_weight = 0;
    const LobeTrial without = try_stretches(sample, lighting, sharp);
    const ReflectanceModelSelection::Stretches stretches = summary_of(sample, lighting, without);
    const WithNoise with_noise{sample, lighting};
    const bool has_second_lobe = with_noise.is_better(trial.whole_db, without.whole_db, kSureOfSecondLobe) &&
                                 trial.pixels.over(without.pixels).mean > 0;
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
