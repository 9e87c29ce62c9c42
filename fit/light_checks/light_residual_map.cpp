#include "fit/light_checks/light_residual_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "surface/base/median.h"

namespace tangi {

LightMisfit::Typical LightMisfit::typical(std::size_t photo) const {
    std::vector<float> known;
    for (const float ratio : log_ratios.at(photo))
        if (!std::isnan(ratio)) known.push_back(ratio);
    if (known.empty()) return {};
    const float offset = median(known);
    for (float& ratio : known) ratio = std::abs(ratio - offset);
    return {offset, 1.4826 * median(std::move(known))};
}

Image<float> LightMisfit::map(std::size_t photo, int longest) const {
    const double shrink = std::min(1.0, longest / static_cast<double>(std::max({width, height, 1})));
    const auto side = [&](int pixels) { return std::max(1, static_cast<int>(std::lround(pixels * shrink))); };
    Image<float> picture(side(width), side(height), std::numeric_limits<float>::quiet_NaN());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const glm::dvec2 place((x + 0.5) / shrink, (y + 0.5) / shrink);
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i < places.size(); ++i) {
                const glm::dvec2 off = glm::dvec2(places[i]) - place;
                const double distance2 = off.x * off.x + off.y * off.y;
                if (distance2 >= nearest) continue;
                nearest = distance2;
                picture(x, y) = log_ratios.at(photo)[i];
            }
        }
    return picture;
}

namespace {

double best_explained(const std::vector<WardEstimate>& estimates) {
    std::vector<double> residuals;
    for (const WardEstimate& e : estimates)
        if (e.valid) residuals.push_back(e.rms_residual);
    return quantile_of(std::move(residuals), 10);
}

}  // namespace

LightMisfit light_misfit(const SurveyedStack& surveyed, const Lighting& lighting, const WardFitOptions& ward,
                         const ReflectanceModel& reflectance_model, int wanted) {
    const Stack& stack = surveyed.stack;
    const LightSample sample(surveyed, ward, wanted);
    std::vector<int> photos(stack.photos.size());
    std::iota(photos.begin(), photos.end(), 0);
    const std::vector<WardEstimate> estimates = sample.fit(photos, lighting, reflectance_model);
    LightMisfit misfit{stack.width(), stack.height(), {}, {}, best_explained(estimates)};
    for (int k = 0; k < sample.size(); ++k) misfit.places.push_back(sample.place_px(k));
    for (const int photo : photos) {
        const Lighting one{
            {lighting.lights[static_cast<std::size_t>(photo)]}, lighting.rig, lighting.white_level};
        misfit.log_ratios.push_back(sample.log_ratios(estimates, photo, one, reflectance_model));
    }
    return misfit;
}

}  // namespace tangi
