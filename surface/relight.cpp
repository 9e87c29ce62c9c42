#include "surface/relight.h"

#include <cmath>
#include <numbers>

#include "surface/anisotropy.h"
#include "surface/diffuse.h"
#include "surface/parallel.h"
#include "surface/relighter.h"

namespace tangi {

namespace {

constexpr int kManyLights =
    4;  // the steepest horizons take a quarter of the time that marching for one light does

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
    const float gloss = std::numbers::pi_v<float> * s.specular(x, y) * lobe * angles.n_l;
    if (s.lobe_colour.empty()) return s.diffuse(x, y) * matt + gloss;
    return s.diffuse(x, y) * matt + gloss * s.lobe_colour(x, y);
}

double light_radius_deg(const Surface& s, const RelightOptions& options) {
    return options.light_radius_deg.value_or(static_cast<double>(s.photography.rig.lamp_radius_deg));
}

Image<float> visibility(const Surface& s, const Light& light, double light_radius_deg) {
    const CastShadows shadows(s.height_mm, s.mm_per_pixel, light_radius_deg);
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

Relighter::Relighter(const Surface& s, const RelightOptions& options, int lights)
    : surface_(s), options_(options) {
    if (!options.cast_shadows) return;
    shadows_ = std::make_unique<CastShadows>(s.height_mm, s.mm_per_pixel, light_radius_deg(s, options));
    if (lights < kManyLights) return;
    horizon_ = Image<float>(s.width(), s.height());
    parallel_for(0, s.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width(); ++x) horizon_(x, y) = shadows_->steepest_horizon(x, y);
    });
}

Relighter::~Relighter() = default;

float Relighter::visible_part(int x, int y, const Vec3& l) const {
    if (!horizon_.empty() && shadows_->clears(horizon_(x, y), std::sqrt(l.x * l.x + l.y * l.y), l.z))
        return 1;
    return shadows_->visible_part(x, y, l);
}

void Relighter::draw_row(const Light& light, int y, std::span<Rgb> row) const {
    const float ambient = static_cast<float>(options_.ambient);
    for (int x = 0; x < surface_.width(); ++x)
        row[static_cast<std::size_t>(x)] = ambient * surface_.diffuse(x, y);
    add_row(light, y, row);
}

void Relighter::add_row(const Light& light, int y, std::span<Rgb> row) const {
    const Surface& s = surface_;
    const Rig& rig = s.photography.rig;
    for (int x = 0; x < s.width(); ++x) {
        const Vec3 point = s.point_mm(x, y);
        const Incidence in = incidence(light, point, rig);
        Rgb direct = reflected(s, x, y, in.direction, view_direction(rig, point), options_.model);
        // What the light does not meet needs no march.
        if (shadows_ && direct != Rgb(0)) direct *= visible_part(x, y, in.direction);
        row[static_cast<std::size_t>(x)] += in.irradiance * (direct + rig.ambient * s.diffuse(x, y));
    }
}

Image<Rgb> relight(const Surface& s, std::span<const Light> lights, const RelightOptions& options,
                   const Progress& progress) {
    require_consistent(s);
    validate(options);
    Image<Rgb> picture(s.width(), s.height());
    const float ambient = static_cast<float>(options.ambient);
    for (std::size_t i = 0; i < picture.size(); ++i) picture.pixels()[i] = ambient * s.diffuse.pixels()[i];

    const Relighter relighter(s, options, static_cast<int>(lights.size()));
    int done = 0;
    for (const Light& light : lights) {
        parallel_for(0, s.height(), 16, [&](int begin, int end) {
            for (int y = begin; y < end; ++y) relighter.add_row(light, y, picture.row(y));
        });
        report(progress, "relight", ++done / static_cast<double>(lights.size()));
    }
    return picture;
}

}  // namespace tangi
