#include "fit/law_choice.h"

#include <array>
#include <cmath>
#include <numeric>

namespace tangi {

namespace {

constexpr std::size_t kFewestPhotos = 12;
constexpr int kFolds = 4;  // trials, each with every fourth photograph left out
constexpr std::array kHazes = {0.3, 0.6};
constexpr std::array kRoughnesses = {0.15, 0.3, 0.5, 0.8};
constexpr double kSure = 2;  // [sigma]
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

bool is_surely_better(const std::vector<double>& db, const std::vector<double>& than) {
    std::vector<double> gained;
    for (std::size_t i = 0; i < db.size(); ++i) gained.push_back(db[i] - than[i]);
    const double middle = mean(gained), count = static_cast<double>(gained.size());
    double squares = 0;
    for (const double gain : gained) squares += (gain - middle) * (gain - middle);
    return middle > kSure * std::sqrt(squares / (count * (count - 1)));
}

}  // namespace

LawChoice choose_law(const LightSample& sample, const Lighting& lighting, const Progress& progress) {
    LawChoice choice;
    if (lighting.lights.size() < kFewestPhotos) return choice;
    const auto attempt = [&](const ReflectanceLaw& law) {
        report(progress, "reflectance", static_cast<double>(choice.trials.size()) / kTrials);
        std::vector<double> db = left_out_db(sample, lighting, law);
        choice.trials.push_back({law, mean(db)});
        return db;
    };
    std::vector<double> best = attempt({});
    // Along one number of the law: upwards as long as photographs are predicted better.
    const auto search = [&](double ReflectanceLaw::*number, const auto& values) {
        ReflectanceLaw law = choice.law, found = choice.law;
        std::vector<double> found_db = best;
        for (const double value : values) {
            law.*number = value;
            std::vector<double> db = attempt(law);
            if (mean(db) <= mean(found_db)) break;
            found_db = std::move(db);
            found = law;
        }
        if (!is_surely_better(found_db, best)) return;
        best = std::move(found_db);
        choice.law = found;
    };
    search(&ReflectanceLaw::haze, kHazes);
    search(&ReflectanceLaw::diffuse_roughness, kRoughnesses);
    return choice;
}

}  // namespace tangi
