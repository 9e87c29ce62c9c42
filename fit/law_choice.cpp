#include "fit/law_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace tangi {

namespace {

constexpr std::size_t kFewestPhotos = 12;
constexpr int kFolds = 4;  // trials, each with every fourth photograph left out
constexpr std::array kHazes = {0.3, 0.6, 0.85};
constexpr std::array kRoughnesses = {0.15, 0.3, 0.5, 0.8};
// [sigma] Most varnish and oil paint has haze. Diffuse roughness is rarer, and a little of it also takes up
// what one pixel's lobe leaves open, which the second pass of the fit knows better.
constexpr double kSureOfHaze = 1, kSureOfRoughness = 2, kSureOfColours = 2;
constexpr double kFewestColoured = 0.01;  // [1] of the sample: a few pixels are noise
constexpr double kWorth = 0.1;  // [dB] of gain at least: as with lamps, what gains less is left as it is
constexpr double kTrials = 1 + kHazes.size() + kRoughnesses.size();

Lighting subset(const Lighting& lighting, const std::vector<int>& photos) {
    Lighting result{{}, lighting.rig, lighting.white_level};
    for (const int i : photos) result.lights.push_back(lighting.lights[static_cast<std::size_t>(i)]);
    return result;
}

// [dB] of each photograph, predicted from the others.
std::vector<double> left_out_db(const LightSample& sample, const Lighting& lighting,
                                const ReflectanceLaw& law) {
    const int photos = static_cast<int>(lighting.lights.size());
    std::vector<double> db(lighting.lights.size());
    for (int fold = 0; fold < kFolds; ++fold) {
        std::vector<int> used;
        for (int i = 0; i < photos; ++i)
            if (i % kFolds != fold) used.push_back(i);
        const std::vector<WardEstimate> estimates = sample.fit(used, subset(lighting, used), law);
        for (int i = fold; i < photos; i += kFolds)
            db[static_cast<std::size_t>(i)] = sample.psnr_db(estimates, i, subset(lighting, {i}), 0, 1, law);
    }
    return db;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

bool is_better(const std::vector<double>& db, const std::vector<double>& than, double sigmas) {
    std::vector<double> gained;
    for (std::size_t i = 0; i < db.size(); ++i) gained.push_back(db[i] - than[i]);
    const double middle = mean(gained), count = static_cast<double>(gained.size());
    double squares = 0;
    for (const double gain : gained) squares += (gain - middle) * (gain - middle);
    return middle > kWorth + sigmas * std::sqrt(squares / (count * (count - 1)));
}

// Deviations below the noise to expect of stored values are no evidence: rounding, compression and a tone
// curve that is slightly off make them, too. With synth_canvas/uniform_1, predicted to half a code of 8
// bits, roughness predicts still better, and normals get worse by half.
struct WithNoise {
    double noise;
    WithNoise(const LightSample& sample, const Lighting& lighting)
        : noise(std::pow(10, -sample.noise_db(lighting.white_level) / 10)) {}
    double operator()(double db) const { return -10 * std::log10(std::pow(10, -db / 10) + noise); }
};

// [dB] of photographs, white lobes and coloured ones, and how many pixels have such.
struct ColourTrial {
    std::vector<double> white_db, coloured_db;
    double part = 0;
};

// Photographs left out in turn; in each turn, at the pixels to which the others give a coloured lobe.
ColourTrial try_colours(const LightSample& sample, const Lighting& lighting, const ReflectanceLaw& law) {
    const int photos = static_cast<int>(lighting.lights.size());
    ColourTrial trial;
    for (int fold = 0; fold < kFolds; ++fold) {
        std::vector<int> used;
        for (int i = 0; i < photos; ++i)
            if (i % kFolds != fold) used.push_back(i);
        const Lighting lamps = subset(lighting, used);
        const std::vector<WardEstimate> white = sample.fit(used, lamps, law);
        const std::vector<Rgb> colours = sample.lobe_colours(white, used, lamps, law);
        std::vector<bool> marked;
        for (const Rgb& colour : colours) marked.push_back(colour != Rgb(1));
        const double part =
            static_cast<double>(std::count(marked.begin(), marked.end(), true)) / std::max(sample.size(), 1);
        trial.part += part / kFolds;
        if (part < kFewestColoured) continue;
        const std::vector<WardEstimate> coloured = sample.fit(used, lamps, law, colours);
        for (int i = fold; i < photos; i += kFolds) {
            trial.white_db.push_back(sample.psnr_db(white, i, subset(lighting, {i}), law, marked));
            trial.coloured_db.push_back(sample.psnr_db(coloured, i, subset(lighting, {i}), law, marked));
        }
    }
    return trial;
}

}  // namespace

LawChoice choose_law(const LightSample& sample, const Lighting& lighting, const Progress& progress,
                     const std::optional<double>& diffuse_roughness) {
    LawChoice choice;
    choice.law.diffuse_roughness = diffuse_roughness.value_or(0);
    if (lighting.lights.size() < kFewestPhotos) return choice;
    const WithNoise with_noise{sample, lighting};
    const auto attempt = [&](const ReflectanceLaw& law) {
        report(progress, "reflectance", static_cast<double>(choice.trials.size()) / kTrials);
        std::vector<double> db = left_out_db(sample, lighting, law);
        choice.trials.push_back({law, mean(db)});
        for (double& value : db) value = with_noise(value);
        return db;
    };
    std::vector<double> best = attempt(choice.law);
    // Along one number of the law: upwards as long as photographs are predicted better.
    const auto search = [&](double ReflectanceLaw::*number, const auto& values, double sigmas) {
        ReflectanceLaw law = choice.law, found = choice.law;
        std::vector<double> found_db = best;
        for (const double value : values) {
            law.*number = value;
            std::vector<double> db = attempt(law);
            if (mean(db) <= mean(found_db)) break;
            found_db = std::move(db);
            found = law;
        }
        if (!is_better(found_db, best, sigmas)) return;
        best = std::move(found_db);
        choice.law = found;
    };
    search(&ReflectanceLaw::haze, kHazes, kSureOfHaze);
    if (!diffuse_roughness) search(&ReflectanceLaw::diffuse_roughness, kRoughnesses, kSureOfRoughness);
    report(progress, "reflectance", 1);
    return choice;
}

LawChoice::Colours choose_lobe_colours(const LightSample& sample, const Lighting& lighting,
                                       const ReflectanceLaw& law) {
    LawChoice::Colours colours;
    if (lighting.lights.size() < kFewestPhotos) return colours;
    ColourTrial trial = try_colours(sample, lighting, law);
    colours.part = trial.part;
    if (trial.part < kFewestColoured || trial.white_db.size() < 2) return colours;
    colours.white_db = mean(trial.white_db);
    colours.coloured_db = mean(trial.coloured_db);
    const WithNoise with_noise{sample, lighting};
    for (std::vector<double>* db : {&trial.white_db, &trial.coloured_db})
        for (double& value : *db) value = with_noise(value);
    colours.chosen = is_better(trial.coloured_db, trial.white_db, kSureOfColours);
    return colours;
}

nlohmann::json to_json(const LawChoice& choice) {
    nlohmann::json trials = nlohmann::json::array();
    for (const LawChoice::Trial& trial : choice.trials)
        trials.push_back({{"diffuse_roughness", trial.law.diffuse_roughness},
                          {"haze", trial.law.haze},
                          {"psnr_db", trial.left_out_db}});
    return {{"diffuse_roughness", choice.law.diffuse_roughness},
            {"haze", choice.law.haze},
            {"left_out_db", trials},
            {"coloured_lobes",
             {{"chosen", choice.colours.chosen},
              {"part", choice.colours.part},
              {"white_db", choice.colours.white_db},
              {"coloured_db", choice.colours.coloured_db}}}};
}

}  // namespace tangi
