#include "capture/spheres/sphere_highlight.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "capture/spheres/highlight_clusters.h"
#include "capture/spheres/highlight_lobe.h"
#include "capture/stack/survey.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr float kAbsent = 0.2f;     // of the median photograph's highlight
constexpr float kFaintest = 0.05f;  // of the brightest one, where a sphere shows the light in few photographs
constexpr double kLargestRadius = 0.25;  // [1] of a highlight / radius of the sphere
constexpr double kRival =
    0.15;  // a clipped spot of so much of the largest one's weight may be the light, too
constexpr double kBrighter = 1.5;                      // by which the light must be brighter than its rivals
constexpr float kGlows = 0.5f;                         // [1] what is brighter is no glow, but a spot
constexpr double kGlowNoise = 0.002, kMostByGlow = 4;  // [1] stored; what is around may be mirrored
constexpr double kFarLarger = 3;                       // [1] by area: whatever glow says, that is the light
constexpr double kLargestShift =
    0.5;  // [1] of the spot's radius, by which a lobe's middle may differ from the spot's
constexpr double kLargestResidual = 0.3;  // [1] of a lobe that is one
constexpr int kFewPhotos = 5;             // whose median may hold a highlight itself

// Connected pixels at least as bright as a threshold, with their weighted middle.
struct Spot {
    dvec2 middle{0, 0};
    double area = 0, weight = 0;
    bool at_border = false, reaches_outside = false;
};

class Photo {
public:
    Photo(const SphereCrops& crops, std::size_t photo, const Image<float>& stays, const SphereImage& sphere,
          const SphereCamera& camera)
        : crops_(crops),
          photo_(photo),
          sphere_(sphere),
          camera_(camera),
          light_(crops.photos[photo]),
          outside_(light_.width(), light_.height()) {
        const Image<float>& values = crops.photos[photo];
        for (int y = 0; y < light_.height(); ++y)
            for (int x = 0; x < light_.width(); ++x) {
                // What stays is taken off, but not from a clipped pixel that it leaves no doubt about.
                light_(x, y) =
                    std::max(0.0f, values(x, y) - (stays(x, y) < 0.5f * values(x, y) ? 0 : stays(x, y)));
                const dvec2 place = crops.to_common(photo, dvec2(x + crops.region.x0, y + crops.region.y0));
                outside_(x, y) = static_cast<float>(outside_px(sphere, camera, place));
            }
    }

    float outside(int x, int y) const { return outside_(x, y); }
    float light(int x, int y) const { return light_(x, y); }

    // Whether what is mirrored there lies above the plane of the picture: a light may, the table does not.
    bool is_from_above(const Spot& spot) const {
        const auto point = sphere_point(sphere_, camera_, crops_.to_common(photo_, spot.middle));
        return point && point->mirrored().z > 0;
    }

    // The brightest pixel between two distances from the outline; (-1, -1) where all is black.
    glm::ivec2 brightest(double from, double to) const {
        glm::ivec2 at(-1);
        float most = 0;
        for (int y = 0; y < light_.height(); ++y)
            for (int x = 0; x < light_.width(); ++x)
                if (outside_(x, y) >= from && outside_(x, y) < to && light_(x, y) > most) {
                    most = light_(x, y);
                    at = {x, y};
                }
        return at;
    }

    Spot spot_at(const glm::ivec2& seed, float threshold, Image<unsigned char>& seen) const {
        Spot spot;
        std::vector<glm::ivec2> open = {seed};
        seen(seed.x, seed.y) = 1;
        dvec2 sum(0);
        while (!open.empty()) {
            const glm::ivec2 at = open.back();
            open.pop_back();
            // The weight rises from 0 at the threshold, so that the middle does not jump where a pixel joins.
            const double weight = std::min(light_(at.x, at.y), kClipped) - threshold + 1e-6;
            sum += weight * dvec2(at);
            spot.weight += weight;
            spot.area += 1;
            spot.at_border = spot.at_border || at.x == 0 || at.y == 0 || at.x == light_.width() - 1 ||
                             at.y == light_.height() - 1;
            spot.reaches_outside = spot.reaches_outside || outside_(at.x, at.y) > 0.5f;
            for (int k = 0; k < 9; ++k) {
                const int x = at.x + k % 3 - 1, y = at.y + k / 3 - 1;
                if (x < 0 || y < 0 || x >= light_.width() || y >= light_.height() || seen(x, y)) continue;
                if (light_(x, y) < threshold) continue;
                seen(x, y) = 1;
                open.push_back({x, y});
            }
        }
        spot.middle = sum / spot.weight + dvec2(crops_.region.x0, crops_.region.y0);
        return spot;
    }

    // All clipped spots on the sphere, largest first.
    std::vector<Spot> clipped_spots(float threshold) const {
        std::vector<Spot> spots;
        Image<unsigned char> seen(light_.width(), light_.height());
        for (int y = 0; y < light_.height(); ++y)
            for (int x = 0; x < light_.width(); ++x)
                if (light_(x, y) >= kClipped && outside_(x, y) < 0 && !seen(x, y))
                    spots.push_back(spot_at({x, y}, threshold, seen));
        std::stable_sort(spots.begin(), spots.end(),
                         [](const Spot& a, const Spot& b) { return a.weight > b.weight; });
        return spots;
    }

    // The lobe around a spot, from what is on the sphere around it; its centre in the common frame. It is
    // fitted to the normals: they turn faster towards the outline, which makes the lobe lopsided in the
    // picture.
    std::optional<HighlightLobe> lobe_of(const Spot& spot) const {
        const double radius = std::sqrt(spot.area / std::numbers::pi), reach = 2.2 * radius + 1.5;
        const dvec2 corner(crops_.region.x0, crops_.region.y0), middle = spot.middle - corner;
        const auto start = sphere_point(sphere_, camera_, crops_.to_common(photo_, spot.middle));
        if (!start) return std::nullopt;
        const dvec3 across = glm::normalize(glm::cross(dvec3(0, 1, 0.01), start->normal)),
                    up = glm::cross(start->normal, across);
        std::vector<LobeSample> samples;
        for (int y = std::max(0, static_cast<int>(middle.y - reach));
             y <= std::min(light_.height() - 1.0, middle.y + reach); ++y)
            for (int x = std::max(0, static_cast<int>(middle.x - reach));
                 x <= std::min(light_.width() - 1.0, middle.x + reach); ++x) {
                if (outside_(x, y) > -1 || glm::length(dvec2(x, y) - middle) > reach) continue;
                const auto point =
                    sphere_point(sphere_, camera_, crops_.to_common(photo_, dvec2(x, y) + corner));
                if (!point) continue;
                const double scale = sphere_.radius_px / glm::dot(point->normal, start->normal);
                samples.push_back(
                    {scale * dvec2(glm::dot(point->normal, across), glm::dot(point->normal, up)),
                     light_(x, y)});
            }
        auto lobe = fit_lobe(samples, {0, 0}, std::max(radius, 1.0), kClipped, 2.0 * crops_.step);
        if (!lobe || lobe->residual > kLargestResidual) return std::nullopt;
        const dvec2 centre = lobe->centre_px / sphere_.radius_px;
        const auto pixel = pixel_of_normal(sphere_, camera_,
                                           glm::normalize(start->normal + centre.x * across + centre.y * up));
        if (!pixel || glm::length(*pixel - crops_.to_common(photo_, spot.middle)) >
                          std::max(kLargestShift * radius, 0.5))
            return std::nullopt;
        lobe->centre_px = *pixel;
        return lobe;
    }

    // What is around a spot on the sphere: light, cut off where it is clipped, within `near` pixels of its
    // middle, as seen face on; and the mean [1] between `near` and `far`.
    struct Around {
        double cut_off = 0, glow = 0;
    };
    Around around(const Spot& spot, double near, double far) const {
        const dvec2 middle = spot.middle - dvec2(crops_.region.x0, crops_.region.y0);
        Around sum;
        int count = 0;
        for (int y = std::max(0, static_cast<int>(middle.y - far));
             y <= std::min(light_.height() - 1.0, middle.y + far); ++y)
            for (int x = std::max(0, static_cast<int>(middle.x - far));
                 x <= std::min(light_.width() - 1.0, middle.x + far); ++x) {
                const double distance = glm::length(dvec2(x, y) - middle);
                if (outside_(x, y) > -1 || distance > far) continue;
                if (distance <= near) sum.cut_off += std::min(light_(x, y), kClipped);
                if (distance > near && light_(x, y) < kGlows) sum.glow += light_(x, y), ++count;
            }
        if (count > 0) sum.glow /= count;
        if (const auto point = sphere_point(sphere_, camera_, crops_.to_common(photo_, spot.middle)))
            sum.cut_off /= std::max(point->normal.z, 0.1);
        return sum;
    }

private:
    const SphereCrops& crops_;
    std::size_t photo_;
    const SphereImage& sphere_;
    const SphereCamera& camera_;
    Image<float> light_, outside_;
};

struct Chosen {
    Spot spot;
    std::optional<HighlightLobe> lobe;
    bool sure = true;
    int weaker = 0;
};

// How much brighter the first is than the second, as far as that is known. Lobes tell of their middles what
// is cut off. Else a brighter one is cut off over more of its flanks, and has more of a glow around it.
double brighter_by(const Photo& photo, const Chosen& first, const Chosen& second) {
    if (first.lobe && second.lobe) return first.lobe->peak / second.lobe->peak;
    const double radius = std::sqrt(std::max(first.spot.area, second.spot.area) / std::numbers::pi);
    const double between = glm::length(first.spot.middle - second.spot.middle) / 2;
    const double near = std::min(radius + 1.5, between), far = std::min(2.2 * radius + 3, between + 1);
    const Photo::Around a = photo.around(first.spot, near, far), b = photo.around(second.spot, near, far);
    const double glow =
        std::clamp((a.glow + kGlowNoise) / (b.glow + kGlowNoise), 1 / kMostByGlow, kMostByGlow);
    return a.cut_off / std::max(b.cut_off, 1e-9) * glow;
}

// Of several clipped spots the one with the brightest middle; a reflection of something bright is clipped,
// too, but hardly by much. What is mirrored of the table or the painting counts only where nothing else does.
Chosen chosen_of(const Photo& photo, std::vector<Spot> spots) {
    const auto below = std::stable_partition(spots.begin(), spots.end(),
                                             [&](const Spot& spot) { return photo.is_from_above(spot); });
    if (below != spots.begin()) spots.erase(below, spots.end());
    std::vector<Chosen> rivals;
    for (const Spot& spot : spots)
        if (spot.weight > kRival * spots.front().weight && rivals.size() < 4)
            rivals.push_back({spot, photo.lobe_of(spot)});
    // The one that beats all others by most.
    std::vector<double> least(rivals.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < rivals.size(); ++i)
        for (std::size_t k = 0; k < rivals.size(); ++k)
            if (i != k) {
                const bool far_larger = rivals[i].spot.weight > kFarLarger * rivals[k].spot.weight;
                const double by = brighter_by(photo, rivals[i], rivals[k]);
                least[i] = std::min(least[i], far_larger ? std::max(by, 2 * kBrighter) : by);
            }
    const auto best = static_cast<std::size_t>(std::max_element(least.begin(), least.end()) - least.begin());
    Chosen chosen = rivals[best];
    chosen.sure = least[best] > kBrighter;
    chosen.weaker = chosen.sure ? static_cast<int>(rivals.size()) - 1 : 0;
    return chosen;
}

Highlight measured(const Photo& photo, const SphereCrops& crops, std::size_t number,
                   const SphereImage& sphere, float least) {
    Highlight highlight;
    const glm::ivec2 seed = photo.brightest(-1e9, 0);
    highlight.peak = seed.x < 0 ? 0 : photo.light(seed.x, seed.y);
    if (seed.x < 0 || highlight.peak < least) {
        const glm::ivec2 beside = photo.brightest(0, 0.25 * sphere.radius_px);
        if (beside.x >= 0 && photo.light(beside.x, beside.y) > 2 * least)
            highlight.state = HighlightState::off_sphere;
        return highlight;
    }
    Image<unsigned char> seen(crops.region.width(), crops.region.height());
    highlight.clipped = highlight.peak >= kClipped;
    Chosen chosen;
    if (highlight.clipped) {
        chosen = chosen_of(photo, photo.clipped_spots(0.7f * kClipped));
    } else {
        chosen.spot = photo.spot_at(seed, 0.5f * highlight.peak, seen);
        chosen.lobe = photo.lobe_of(chosen.spot);
    }
    const Spot& spot = chosen.spot;
    const double radius = std::sqrt(spot.area / std::numbers::pi);
    highlight.area_px = spot.area;
    highlight.weaker = chosen.weaker;
    highlight.place_px = chosen.lobe ? chosen.lobe->centre_px : crops.to_common(number, spot.middle);
    // Without a lobe, a tenth of the spot's radius for its shape, which a light need not have symmetric; more
    // where the top is cut off. With one, a thirtieth.
    highlight.sigma_px = chosen.lobe ? std::max(chosen.lobe->sigma_px, 0.03 * radius)
                                     : std::hypot(0.05, (highlight.clipped ? 0.12 : 0.08) * radius);
    highlight.sigma_px = std::hypot(highlight.sigma_px, crops.drift[number].sigma_px);
    if (radius > std::max(kLargestRadius * sphere.radius_px, 2.0))
        highlight.state = HighlightState::smeared;
    else if (spot.at_border)
        highlight.state = HighlightState::off_picture;
    else if (spot.reaches_outside)
        highlight.state = HighlightState::off_sphere;
    else
        highlight.state = chosen.sure ? HighlightState::found : HighlightState::ambiguous;
    return highlight;
}

}  // namespace

std::string reason_of(const Highlight& highlight) {
    switch (highlight.state) {
        case HighlightState::found:
            return "";
        case HighlightState::absent:
            return "no highlight on it";
        case HighlightState::off_sphere:
            return "the highlight lies off the sphere or across its outline";
        case HighlightState::ambiguous:
            return "two highlights of about the same brightness and size";
        case HighlightState::smeared:
            return highlight.clipped ? "the highlight is clipped over too large a part of the sphere"
                                     : "the highlight is too large a part of the sphere";
        case HighlightState::off_picture:
            return "the highlight lies at the picture's border";
    }
    TP_REQUIRE(false, "every state is named");
}

std::vector<Highlight> find_highlights(const SphereCrops& crops, const SphereImage& sphere,
                                       const SphereCamera& camera) {
    Image<float> stays(crops.region.width(), crops.region.height());
    if (static_cast<int>(crops.photos.size()) >= kFewPhotos) stays = median_of(crops.photos);
    std::vector<Photo> photos;
    std::vector<float> peaks;
    for (std::size_t i = 0; i < crops.photos.size(); ++i) {
        photos.emplace_back(crops, i, stays, sphere, camera);
        const glm::ivec2 at = photos.back().brightest(-1e9, 0);
        peaks.push_back(at.x < 0 ? 0 : photos.back().light(at.x, at.y));
    }
    std::vector<float> sorted = peaks;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const float brightest = *std::max_element(peaks.begin(), peaks.end());
    const float least = std::max({kAbsent * *middle, kFaintest * brightest, 8 * crops.step});
    std::vector<Highlight> highlights;
    for (std::size_t i = 0; i < photos.size(); ++i)
        highlights.push_back(measured(photos[i], crops, i, sphere, least));
    return highlights;
}

}  // namespace tangi
