#include "surface/relight.h"

#include <cmath>
#include <numbers>

#include "surface/diffuse.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float bilinear(const Image<float>& image, float x, float y) {
    const int x0 = std::min(static_cast<int>(x), image.width() - 2);
    const int y0 = std::min(static_cast<int>(y), image.height() - 2);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const float top = image(x0, y0) + fx * (image(x0 + 1, y0) - image(x0, y0));
    const float bottom = image(x0, y0 + 1) + fx * (image(x0 + 1, y0 + 1) - image(x0, y0 + 1));
    return top + fy * (bottom - top);
}

// Tangent of the horizon's elevation in direction (dx, dy) [unit, pixels, y down] as seen from a pixel,
// as far as it matters: marching stops where even the highest point could not rise above `ceiling`.
float horizon(const Surface& s, int x, int y, float dx, float dy, float highest, float floor) {
    const float scale = static_cast<float>(s.mm_per_pixel);
    const float z0 = s.height_mm(x, y);
    const float right = static_cast<float>(s.width() - 1), bottom = static_cast<float>(s.height() - 1);
    float best = floor;
    for (float t = 1;; t += 1) {
        const float px = static_cast<float>(x) + t * dx, py = static_cast<float>(y) + t * dy;
        if (!(px >= 0 && py >= 0 && px <= right && py <= bottom)) break;  // NaN leaves, too
        if (highest - z0 <= best * t * scale) break;
        best = std::max(best, (bilinear(s.height_mm, px, py) - z0) / (t * scale));
    }
    return best;
}

}  // namespace

Rgb reflected(const Surface& s, int x, int y, const Vec3& light, const Vec3& view, WardModel model) {
    const Vec3& n = s.normal(x, y);
    const WardAngles<float> angles = ward_angles(n, light, view);
    if (!(angles.n_l > 0)) return Rgb(0);
    const float lobe = hazy_lobe(model, angles, s.roughness(x, y), static_cast<float>(s.law.haze));
    const auto diffuse_roughness = static_cast<float>(s.law.diffuse_roughness);
    const float matt =
        angles.n_v > 0 ? rough_diffuse(angles.n_l, angles.n_v, angles.h_h / 2 - 1, diffuse_roughness).value
                       : angles.n_l;
    return s.diffuse(x, y) * matt + kPi * s.specular(x, y) * lobe * angles.n_l;
}

float visible_part(const Surface& s, int x, int y, const Vec3& l, float highest_mm, float light_radius_rad) {
    const float across = std::hypot(l.x, l.y);
    if (across < 1e-6f) return 1;  // straight from above: nothing can stand in the way
    const float elevation = std::atan2(l.z, across);
    const float floor = std::tan(std::max(elevation - light_radius_rad, -1.5f));
    const float tangent = horizon(s, x, y, l.x / across, -l.y / across, highest_mm, floor);
    if (tangent <= floor) return 1;
    // At least -1: rounding can put a horizon that touches the light's lower rim below it.
    const float covered =
        light_radius_rad > 0 ? std::max((std::atan(tangent) - elevation) / light_radius_rad, -1.0f) : 1.0f;
    if (covered >= 1) return 0;
    // Area of the part of a unit disc above the line at height `covered`.
    const float area = std::acos(covered) - covered * std::sqrt(1 - covered * covered);
    return std::clamp(area / kPi, 0.0f, 1.0f);
}

Image<float> visibility(const Surface& s, const Light& light, double light_radius_deg) {
    Image<float> visible(s.width(), s.height(), 1.0f);
    if (s.width() < 2 || s.height() < 2) return visible;
    const auto heights = s.height_mm.pixels();
    const float highest = *std::max_element(heights.begin(), heights.end());
    const float radius = static_cast<float>(light_radius_deg) * kPi / 180;
    parallel_for(0, s.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            for (int x = 0; x < s.width(); ++x) {
                const Vec3 l = incidence(light, s.point_mm(x, y), s.photography.rig).direction;
                visible(x, y) = visible_part(s, x, y, l, highest, radius);
            }
        }
    });
    return visible;
}

Image<Rgb> relight(const Surface& s, std::span<const Light> lights, const RelightOptions& options,
                   const Progress& progress) {
    require_consistent(s);
    validate(options);
    Image<Rgb> picture(s.width(), s.height());
    const float ambient = static_cast<float>(options.ambient);
    for (std::size_t i = 0; i < picture.size(); ++i) picture.pixels()[i] = ambient * s.diffuse.pixels()[i];

    const Rig& rig = s.photography.rig;
    int done = 0;
    for (const Light& light : lights) {
        const Image<float> visible =
            options.cast_shadows ? visibility(s, light, options.light_radius_deg) : Image<float>();
        parallel_for(0, s.height(), 16, [&](int begin, int end) {
            for (int y = begin; y < end; ++y) {
                for (int x = 0; x < s.width(); ++x) {
                    const Vec3 point = s.point_mm(x, y);
                    const Incidence in = incidence(light, point, rig);
                    const float seen = visible.empty() ? 1.0f : visible(x, y);
                    picture(x, y) +=
                        in.irradiance *
                        (seen * reflected(s, x, y, in.direction, view_direction(rig, point), options.model) +
                         rig.ambient * s.diffuse(x, y));
                }
            }
        });
        report(progress, "relight", ++done / static_cast<double>(lights.size()));
    }
    return picture;
}

}  // namespace tangi
