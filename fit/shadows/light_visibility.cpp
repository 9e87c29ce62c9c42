#include "fit/shadows/light_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/vector_clones.h"
#include "surface/maps/surface_part.h"

namespace tangi {

namespace {

static_assert(kWardLanes == kMarchLanes);

constexpr std::uint8_t kForgotten = 255;        // a run
constexpr float kLit = 0.7f, kInShadow = 0.3f;  // [1] of what the light would show by itself
constexpr float kGrazing = 0.1f;                // [1] n.l: below it slopes that are a little off tell more
constexpr float kVisible = 5;                   // [sigma]
constexpr float kSlopeKnown = 0.04f;            // [1] confidence: a standard error of 0.5
constexpr float kMetal = 0.5f;                  // [1] rho_s over rho_d: beside its lobe it looks hidden
constexpr float kMoreRelief = 0.1f;             // [1] tangent of the horizon; with 0.2 as well

// Pixels in lanes, as the surface has them.
struct Lanes {
    std::array<WardLane, 3> normal, diffuse;
    WardLane horizon, known;  // tangent that hides what is below; 1 where a matt surface and its slope are
};

bool is_matt(const Surface& surface, int x, int y) {
    const Rgb& diffuse = surface.diffuse(x, y);
    return 3 * surface.specular(x, y) < kMetal * (diffuse.r + diffuse.g + diffuse.b);
}

Lanes lanes_of(const Surface& surface, const CastShadows& shadows, int x0, int y, int count) {
    Lanes lanes;
    for (int lane = 0; lane < count; ++lane) {
        const int x = x0 + lane;
        for (int c = 0; c < 3; ++c) {
            const auto at = static_cast<std::size_t>(c);
            lanes.normal[at][lane] = surface.normal(x, y)[c];
            lanes.diffuse[at][lane] = surface.diffuse(x, y)[c];
        }
        const glm::ivec2 at_relief = in_painting(surface, x, y);
        lanes.horizon[lane] = shadows.steepest_horizon(at_relief.x, at_relief.y);
        lanes.known[lane] = surface.confidence(x, y) > kSlopeKnown && is_matt(surface, x, y) ? 1.0f : 0.0f;
    }
    return lanes;
}

// Of a photograph, 1 where it shows the light hidden; where it shows it lit, and a horizon that were higher
// might hide it; and the direction that counts then.
struct Shown {
    WardLane hidden, lit;
    std::array<WardLane, 3> lower;
};

TP_VECTOR_CLONES
void find_shown(const WardBatch& batch, const Lanes& lanes, const CastShadows& shadows, std::size_t photo,
                Shown& shown) {
    const float *lx = batch.light[photo][0].data(), *ly = batch.light[photo][1].data(),
                *lz = batch.light[photo][2].data(), *ambient = batch.ambient[photo].data();
    float n_l[kWardLanes], full[kWardLanes] = {}, value[kWardLanes] = {}, noise[kWardLanes] = {},
                           missing[kWardLanes], clipped[kWardLanes] = {};
    for (int i = 0; i < kWardLanes; ++i) {
        n_l[i] = lanes.normal[0].data()[i] * lx[i] + lanes.normal[1].data()[i] * ly[i] +
                 lanes.normal[2].data()[i] * lz[i];
        missing[i] = n_l[i] > kGrazing ? 1 - lanes.known.data()[i] : 1.0f;
    }
    const auto channels = static_cast<std::size_t>(batch.channels);
    for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t at = photo * channels + c;
        const float *irradiance = batch.irradiance[at].data(), *measured = batch.value[at].data(),
                    *sigma = batch.sigma[at].data(), *diffuse = lanes.diffuse[c].data();
        for (int i = 0; i < kWardLanes; ++i) {
            const float matt = irradiance[i] * diffuse[i];
            full[i] += matt * n_l[i];
            value[i] += measured[i] - matt * ambient[i];
            noise[i] += std::abs(sigma[i]);
            missing[i] = sigma[i] == 0 ? 1.0f : missing[i];
            clipped[i] = sigma[i] < 0 ? 1.0f : clipped[i];
        }
    }
    const float* horizon = lanes.horizon.data();
    float *hidden = shown.hidden.data(), *lit = shown.lit.data(), *to_x = shown.lower[0].data(),
          *to_y = shown.lower[1].data(), *to_z = shown.lower[2].data();
    for (int i = 0; i < kWardLanes; ++i) {
        const bool told = missing[i] == 0 && full[i] > kVisible * noise[i];
        const bool dark = value[i] < kInShadow * full[i];  // what is clipped is at least as bright
        hidden[i] = told && dark && clipped[i] == 0 ? 1.0f : 0.0f;
        const float across = std::sqrt(lx[i] * lx[i] + ly[i] * ly[i]), z = lz[i] - kMoreRelief * across;
        const bool bright = told && !dark && value[i] > kLit * full[i];
        lit[i] = bright && !shadows.clears(horizon[i], across, z) ? 1.0f : 0.0f;
        const float scale = 1 / std::sqrt(across * across + z * z);
        to_x[i] = scale * lx[i], to_y[i] = scale * ly[i], to_z[i] = scale * z;
    }
}

// Bit i: whether lane i < count is not 0.
std::uint32_t bits_of(const WardLane& lanes, int count) {
    std::uint32_t bits = 0;
    for (int lane = 0; lane < count; ++lane) bits |= std::uint32_t{lanes[lane] != 0} << lane;
    return bits;
}

}  // namespace

LightVisibility::LightVisibility(int width, int height, int photos)
    : width_(width), photos_(photos), rows_(static_cast<std::size_t>(height)) {
    TP_REQUIRE(photos <= std::numeric_limits<std::uint16_t>::max(), "as many photographs as can be named");
}

void LightVisibility::add(int y, std::span<const SeenLight> lights, int x0) {
    std::vector<SeenLight>& row = rows_[static_cast<std::size_t>(y)];
    for (SeenLight light : lights) {
        light.x += static_cast<std::uint32_t>(x0);
        row.push_back(light);
    }
}

bool LightVisibility::empty() const {
    return std::all_of(rows_.begin(), rows_.end(), [](const auto& row) { return row.empty(); });
}

double LightVisibility::hidden_part() const {
    std::size_t hidden = 0;
    for (const std::vector<SeenLight>& row : rows_)
        hidden += static_cast<std::size_t>(std::ranges::count(row, false, &SeenLight::lit));
    const double all = static_cast<double>(width_) * static_cast<double>(rows_.size()) * photos_;
    return all > 0 ? static_cast<double>(hidden) / all : 0;
}

void LightVisibility::look(const WardBatch& batch, const Surface& surface, const CastShadows& shadows, int x0,
                           int y, int count) {
    const Lanes lanes = lanes_of(surface, shadows, x0, y, count);
    const glm::ivec2 at_relief = in_painting(surface, x0, y);
    std::vector<SeenLight>& row = rows_[static_cast<std::size_t>(y)];
    Shown shown;
    for (std::size_t photo = 0; photo < batch.light.size(); ++photo) {
        find_shown(batch, lanes, shadows, photo, shown);
        const std::uint32_t hidden = bits_of(shown.hidden, count);
        std::uint32_t lit = bits_of(shown.lit, count);
        if (lit != 0) {
            WardLane parts;
            const auto& [to_x, to_y, to_z] = shown.lower;
            shadows.visible_parts(at_relief.x, at_relief.y, {to_x.data(), to_y.data(), to_z.data()}, lit,
                                  parts.data());
            for (int lane = 0; lane < count; ++lane)
                if ((lit >> lane & 1) && parts[lane] == 1) lit &= ~(std::uint32_t{1} << lane);
        }
        for (int lane = 0; lane < count; ++lane)
            if ((hidden | lit) >> lane & 1)
                row.push_back({static_cast<std::uint32_t>(x0 + lane), static_cast<std::uint16_t>(photo), 0,
                               (lit >> lane & 1) != 0});
    }
}

void LightVisibility::find_runs_of(std::size_t photo, const Surface& surface, const Lighting& lighting) {
    const auto width = static_cast<std::size_t>(width_);
    std::vector<bool> hidden(width * rows_.size());
    const auto for_hidden = [&](const auto& act) {
        for (std::size_t y = 0; y < rows_.size(); ++y) {
            const auto first = std::ranges::lower_bound(rows_[y], photo, {}, &SeenLight::photo);
            for (auto light = first; light != rows_[y].end() && light->photo == photo; ++light)
                if (!light->lit) act(*light, static_cast<int>(light->x), static_cast<int>(y));
        }
    };
    for_hidden([&](const SeenLight& light, int, int y) {
        hidden[static_cast<std::size_t>(y) * width + light.x] = true;
    });
    for_hidden([&](SeenLight& light, int x, int y) {
        const Vec3 l = incidence(lighting.lights[photo], surface.point_mm(x, y), lighting.rig).direction;
        const float across = std::hypot(l.x, l.y);
        for (int run = 0; run < kShadowReach && across > 0; ++run) {
            const float t = static_cast<float>(run + 1) / across;
            const auto u = static_cast<int>(std::lround(static_cast<float>(x) + t * l.x)),
                       v = static_cast<int>(std::lround(static_cast<float>(y) - t * l.y));
            if (u < 0 || v < 0 || u >= width_ || v >= height()) {
                light.run = kForgotten;
                return;
            }
            if (!hidden[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)]) return;
            light.run = static_cast<std::uint8_t>(run + 1);
        }
    });
}

void LightVisibility::find_runs(const Surface& surface, const Lighting& lighting) {
    parallel_for(0, height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            std::ranges::stable_sort(rows_[static_cast<std::size_t>(y)], {}, &SeenLight::photo);
    });
    parallel_for(0, photos_, 1, [&](int begin, int end) {
        for (int photo = begin; photo < end; ++photo)
            find_runs_of(static_cast<std::size_t>(photo), surface, lighting);
    });
    for (std::vector<SeenLight>& row : rows_) {
        std::erase_if(row, [](const SeenLight& light) { return light.run == kForgotten; });
        row.shrink_to_fit();
    }
}

}  // namespace tangi
