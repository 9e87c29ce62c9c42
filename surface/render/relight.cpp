#include "surface/render/relight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "surface/base/parallel.h"
#include "surface/reflectance/anisotropy.h"
#include "surface/reflectance/oren_nayar.h"
#include "surface/render/relighter.h"

namespace tangi {

namespace {

constexpr int kManyLights =
    4;  // the steepest horizons take a quarter of the time that marching for one light does

// Directions to the light from pixels that are marched together, and which of them are to be.
struct Marched {
    std::array<float, kMarchLanes> x{}, y{}, z{}, part;
    std::uint32_t which = 0;

    Marched() { part.fill(1); }
    void ask(int lane, const Vec3& direction) {
        const auto i = static_cast<std::size_t>(lane);
        x[i] = direction.x;
        y[i] = direction.y;
        z[i] = direction.z;
        which |= std::uint32_t{1} << lane;
    }
    // Finds the part of the light that reaches each that was asked for; all of it reaches the others.
    void march(const CastShadows& shadows, int x0, int row) {
        if (which != 0) shadows.visible_parts(x0, row, {x.data(), y.data(), z.data()}, which, part.data());
    }
};

}  // namespace

Rgb reflected(const Surface& s, int x, int y, const Vec3& light, const Vec3& view, WardModel model) {
    const Vec3& n = s.normal(x, y);
    const WardAngles<float> angles = ward_angles(n, light, view);
    if (!(angles.n_l > 0)) return Rgb(0);
    const auto second_lobe_weight = static_cast<float>(s.reflectance_model.second_lobe_weight);
    const float lobe = s.lobe_axes.empty()
                           ? hazy_lobe(model, angles, s.roughness(x, y), second_lobe_weight)
                           : anisotropic_lobe(model, angles, n, light + view,
                                              {s.roughness(x, y), s.lobe_axes(x, y), second_lobe_weight});
    const auto diffuse_roughness = static_cast<float>(s.reflectance_model.diffuse_roughness);
    const float matt =
        angles.n_v > 0 ? rough_diffuse(angles.n_l, angles.n_v, angles.h_h / 2 - 1, diffuse_roughness).value
                       : angles.n_l;
    const float gloss = std::numbers::pi_v<float> * s.specular(x, y) * lobe * angles.n_l;
    if (s.specular_colour.empty()) return s.diffuse(x, y) * matt + gloss;
    return s.diffuse(x, y) * matt + gloss * s.specular_colour(x, y);
}

double light_radius_deg(const Surface& s, const RelightOptions& options) {
    return options.light_radius_deg.value_or(static_cast<double>(s.photography.rig.light_radius_deg));
}

Image<float> visibility(const Surface& s, const Light& light, double light_radius_deg) {
    const CastShadows shadows(s.height_mm, s.mm_per_pixel, light_radius_deg);
    Image<float> visible(s.width(), s.height(), 1.0f);
    parallel_for(0, s.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            for (int x0 = 0; x0 < s.width(); x0 += kMarchLanes) {
                const int count = std::min(kMarchLanes, s.width() - x0);
                Marched marched;
                for (int i = 0; i < count; ++i)
                    marched.ask(i, incidence(light, s.point_mm(x0 + i, y), s.photography.rig).direction);
                marched.march(shadows, x0, y);
                std::copy_n(marched.part.begin(), count, visible.row(y).begin() + x0);
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

Relighter::Relighter(const Surface& s, const RelightOptions& options, const Surroundings& around)
    : surface_(s), options_(options), left_(around.left), top_(around.top) {
    if (options.cast_shadows)
        shadows_ =
            std::make_unique<CastShadows>(around.height_mm, s.mm_per_pixel, light_radius_deg(s, options));
}

Relighter::~Relighter() = default;

bool Relighter::clears(int x, int y, const Vec3& l) const {
    return !horizon_.empty() && shadows_->clears(horizon_(x, y), std::sqrt(l.x * l.x + l.y * l.y), l.z);
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
    for (int x0 = 0; x0 < s.width(); x0 += kMarchLanes) {
        const int count = std::min(kMarchLanes, s.width() - x0);
        std::array<Rgb, kMarchLanes> direct, irradiance;
        Marched marched;
        for (int i = 0; i < count; ++i) {
            const auto lane = static_cast<std::size_t>(i);
            const Vec3 point = s.point_mm(x0 + i, y);
            const Incidence in = incidence(light, point, rig);
            direct[lane] = reflected(s, x0 + i, y, in.direction, view_direction(rig, point), options_.model);
            irradiance[lane] = in.irradiance;
            // What the light does not meet needs no march.
            if (shadows_ && direct[lane] != Rgb(0) && !clears(x0 + i, y, in.direction))
                marched.ask(i, in.direction);
        }
        if (shadows_) marched.march(*shadows_, x0 + left_, y + top_);
        for (int i = 0; i < count; ++i) {
            const auto lane = static_cast<std::size_t>(i);
            row[static_cast<std::size_t>(x0 + i)] +=
                irradiance[lane] * (marched.part[lane] * direct[lane] + rig.ambient * s.diffuse(x0 + i, y));
        }
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
