#include "fit/light_checks/light_outlier_vote.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "fit/pixel/validation_scores.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

constexpr std::size_t kFewestVotes = 20;  // that show a photograph

// How the pixels predict the photograph under a light from this direction; nothing where too few do.
std::optional<ValidationScores> scores_of(const LightSample& sample,
                                          const std::vector<WardEstimate>& estimates, std::size_t photo,
                                          const Vec3& direction, const Lighting& lighting,
                                          const ReflectanceModel& reflectance_model) {
    Lighting one{{lighting.lights[photo]}, lighting.rig, lighting.white_level};
    Light& light = one.lights.front();
    light.direction = direction;
    light.gain /= light.gain.g;  // under a wrong direction what was found of it is wrong, too
    if (light.position_mm) light.position_mm = direction * glm::length(*light.position_mm);
    const int at = static_cast<int>(photo);
    std::vector<float> ratios = sample.log_ratios(estimates, at, one, reflectance_model);
    std::erase_if(ratios, [](float ratio) { return std::isnan(ratio); });
    if (ratios.size() < kFewestVotes) return {};
    light.gain *= std::exp(median(std::move(ratios)));
    ValidationScores scores;
    scores.add(sample.squared_errors(estimates, at, one, reflectance_model),
               sample.squared_noise(one.white_level));
    return scores;
}

}  // namespace

void take_vote(LightOutliers& outliers, const LightSample& sample, const std::vector<Light>& listed,
               const Lighting& lighting, const ReflectanceModel& reflectance_model) {
    if (outliers.odd.empty()) return;
    Lighting others{{}, lighting.rig, lighting.white_level};
    std::vector<int> photos;
    for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
        if (std::ranges::any_of(outliers.odd, [&](const LightOutlier& odd) { return odd.photo == i; }))
            continue;
        photos.push_back(static_cast<int>(i));
        others.lights.push_back(lighting.lights[i]);
    }
    const std::vector<WardEstimate> estimates = sample.fit(photos, others, reflectance_model);
    const auto outvoted = [&](const LightOutlier& odd) {
        const auto scores = [&](const Vec3& direction) {
            return scores_of(sample, estimates, odd.photo, direction, lighting, reflectance_model);
        };
        const auto as_listed = scores(listed[odd.photo].direction), as_shown = scores(odd.shown);
        return as_listed && as_shown && as_shown->over(*as_listed).mean <= 0;
    };
    std::erase_if(outliers.odd, outvoted);
    // An exchange takes two.
    for (LightOutlier& odd : outliers.odd)
        if (odd.exchanged_with && std::ranges::none_of(outliers.odd, [&](const LightOutlier& other) {
                return other.photo == *odd.exchanged_with;
            }))
            odd.exchanged_with.reset();
}

}  // namespace tangi
