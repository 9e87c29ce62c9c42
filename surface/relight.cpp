#include "surface/relight.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "surface/anisotropy.h"
#include "surface/cast_shadows.h"
#include "surface/diffuse.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

Rgb reflected(const Surface& s, int x, int y, const Vec3& light, const Vec3& view, WardModel model) {
    const Vec3& n = s.normal(x, y);
    const WardAngles<float> angles = ward_angles(n, light, view);
    if (!(angles.n_l > 0)) return Rgb(0);
    const auto haze = static_cast<float>(s.law.haze);
    const float lobe = s.lobe_axes.empty() ? hazy_lobe(model, angles, s.roughness(x, y), haze)
                                           : drawn_out_lobe(model, angles, n, light + view, s.roughness(x, y),
                                                            s.lobe_axes(x, y), haze);
    const auto diffuse_roughness = static_cast<float>(s.law.diffuse_roughness);
    const float matt =
        angles.n_v > 0 ? rough_diffuse(angles.n_l, angles.n_v, angles.h_h / 2 - 1, diffuse_roughness).value
                       : angles.n_l;
    const float gloss = kPi * s.specular(x, y) * lobe * angles.n_l;
    if (s.lobe_colour.empty()) return s.diffuse(x, y) * matt + gloss;
    return s.diffuse(x, y) * matt + gloss * s.lobe_colour(x, y);
}

namespace {

Image<float> visibility(const CastShadows& shadows, const Surface& s, const Light& light) {
    Image<float> visible(s.width(), s.height(), 1.0f);
    parallel_for(0, s.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            for (int x = 0; x < s.width(); ++x) {
                const Vec3 l = incidence(light, s.point_mm(x, y), s.photography.rig).direction;
                visible(x, y) = shadows.visible_part(x, y, l);
            }
        }
    });
    return visible;
}

}  // namespace

Image<float> visibility(const Surface& s, const Light& light, double light_radius_deg) {
    return visibility(CastShadows(s.height_mm, s.mm_per_pixel, light_radius_deg), s, light);
}

Image<Rgb> relight(const Surface& s, std::span<const Light> lights, const RelightOptions& options,
                   const Progress& progress) {
    require_consistent(s);
    validate(options);
    Image<Rgb> picture(s.width(), s.height());
    const float ambient = static_cast<float>(options.ambient);
    for (std::size_t i = 0; i < picture.size(); ++i) picture.pixels()[i] = ambient * s.diffuse.pixels()[i];

    const Rig& rig = s.photography.rig;
    std::optional<CastShadows> shadows;
    if (options.cast_shadows) shadows.emplace(s.height_mm, s.mm_per_pixel, options.light_radius_deg);
    int done = 0;
    for (const Light& light : lights) {
        const Image<float> visible = shadows ? visibility(*shadows, s, light) : Image<float>();
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
