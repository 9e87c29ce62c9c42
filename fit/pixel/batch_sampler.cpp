#include "fit/pixel/batch_sampler.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "surface/base/error.h"

#include "surface/base/vector_targets.h"  // before Highway

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fit/pixel/batch_sampler.cpp"
#include <hwy/foreach_target.h>

#include "fit/pixel/ward_vector-inl.h"

#ifndef TANGI_BATCH_SAMPLER_ONCE
#define TANGI_BATCH_SAMPLER_ONCE
namespace tangi {

// Where the lanes' pixels are, and what the lights are like.
struct BatchScene {
    const std::vector<BatchLight>* lights;
    const Rig* rig;
    WardLane x, y, z;  // [mm]
};

}  // namespace tangi
#endif

HWY_BEFORE_NAMESPACE();
namespace tangi {
namespace HWY_NAMESPACE {

// As bent() of surface/maps/light.cpp.
HWY_INLINE void bend(V rx, V ry, V length2, V& x, V& y, V& z) {
    const V turned_x = fma(rx, z, x), turned_y = fma(ry, z, y), turned_z = fnma(rx, x, fnma(ry, y, z));
    const V turned2 = fma(turned_x, turned_x, fma(turned_y, turned_y, hn::Mul(turned_z, turned_z)));
    const V scale = hn::Sqrt(hn::Div(length2, turned2));
    x = hn::Mul(turned_x, scale);
    y = hn::Mul(turned_y, scale);
    z = hn::Mul(turned_z, scale);
}

HWY_INLINE V exp_of(V x) {
    const V small = exp_negative(hn::Neg(hn::Abs(x)));
    return choose(hn::Gt(x, hn::Zero(Floats())), hn::Div(all(1), small), small);
}

// Where lanes are: [mm], and how directions bend there.
struct LanePlaces {
    V x, y, z, bend_x, bend_y;
};

HWY_INLINE void look_from(const Rig& rig, const LanePlaces& p, int at, WardBatch& b) {
    V vx = hn::Zero(Floats()), vy = vx, vz = all(1);
    if (rig.camera_distance_mm) {
        vx = hn::Sub(all(rig.camera_axis_mm.x), p.x);
        vy = hn::Sub(all(rig.camera_axis_mm.y), p.y);
        vz = hn::Sub(all(*rig.camera_distance_mm), p.z);
        const V inverse = hn::Div(all(1), hn::Sqrt(fma(vx, vx, fma(vy, vy, hn::Mul(vz, vz)))));
        vx = hn::Mul(vx, inverse);
        vy = hn::Mul(vy, inverse);
        vz = hn::Mul(vz, inverse);
    }
    store(vx, b.view[0], at);
    store(vy, b.view[1], at);
    store(vz, b.view[2], at);
}

// Stores the direction of light i; returns its falloff [1], with its beam.
HWY_INLINE V light_from(const BatchLight& light, const Rig& rig, const LanePlaces& p, int at,
                        std::array<WardLane, 3>& direction) {
    V lx = all(light.at.x), ly = all(light.at.y), lz = all(light.at.z), falloff = all(1);
    if (rig.bend_per_mm != 0) bend(p.bend_x, p.bend_y, all(light.length2), lx, ly, lz);
    if (light.near) {
        lx = hn::Sub(lx, p.x);
        ly = hn::Sub(ly, p.y);
        lz = hn::Sub(lz, p.z);
        const V distance2 = fma(lx, lx, fma(ly, ly, hn::Mul(lz, lz)));
        falloff = hn::Div(all(light.length2), distance2);
        const V inverse = hn::Div(all(1), hn::Sqrt(distance2));
        lx = hn::Mul(lx, inverse);
        ly = hn::Mul(ly, inverse);
        lz = hn::Mul(lz, inverse);
    }
    if (light.uneven) {
        V log_part = hn::Mul(all(light.beam[4]), hn::Mul(p.y, p.y));
        log_part = fma(hn::Mul(all(light.beam[3]), p.x), p.y, log_part);
        log_part = fma(hn::Mul(all(light.beam[2]), p.x), p.x, log_part);
        log_part = fma(all(light.beam[0]), p.x, fma(all(light.beam[1]), p.y, log_part));
        falloff = hn::Mul(falloff, exp_of(log_part));
    }
    store(lx, direction[0], at);
    store(ly, direction[1], at);
    store(lz, direction[2], at);
    return falloff;
}

void Illuminate(const BatchScene& scene, WardBatch& b) {
    const Rig& rig = *scene.rig;
    const auto channels = static_cast<std::size_t>(b.channels);
    for (int at = 0; at < kWardLanes; at += static_cast<int>(hn::Lanes(Floats()))) {
        LanePlaces p;
        p.x = load(scene.x, at), p.y = load(scene.y, at), p.z = load(scene.z, at);
        p.bend_x = hn::Mul(all(rig.bend_per_mm), p.x), p.bend_y = hn::Mul(all(rig.bend_per_mm), p.y);
        look_from(rig, p, at, b);
        for (std::size_t i = 0; i < scene.lights->size(); ++i) {
            const BatchLight& light = (*scene.lights)[i];
            const V falloff = light_from(light, rig, p, at, b.light[i]);
            store(all(rig.ambient), b.ambient[i], at);
            store(all(1), b.visible[i], at);
            for (std::size_t c = 0; c < channels; ++c)
                store(hn::Mul(falloff, all(light.irradiance[static_cast<int>(c)])),
                      b.irradiance[i * channels + c], at);
        }
    }
}

// NoiseModel::sigma() of all values; 0 in lanes from `count` on.
void Doubt(const NoiseModel& noise, int count, WardBatch& b) {
    const std::span<const float> table = noise.table();
    const float* entries = table.data();
    const int last = static_cast<int>(table.size()) - 1;
    const V zero = hn::Zero(Floats()), top = all(static_cast<float>(last)), clipped = all(noise.clipped());
    const Ints ints;
    for (int at = 0; at < kWardLanes; at += static_cast<int>(hn::Lanes(Floats()))) {
        const M used = hn::Lt(hn::Iota(Floats(), static_cast<float>(at)), all(static_cast<float>(count)));
        for (std::size_t k = 0; k < b.value.size(); ++k) {
            const V value = load(b.value[k], at);
            const M known = hn::And(used, hn::Eq(value, value));
            const V position = hn::Mul(hn::Min(hn::Max(keep(known, value), zero), all(1)), top);
            const auto i = hn::ConvertTo(ints, position);
            const V t = hn::Sub(position, hn::ConvertTo(Floats(), i));
            const V low = hn::GatherIndex(Floats(), entries, i);
            const V high = hn::GatherIndex(Floats(), entries,
                                           hn::Min(hn::Add(i, hn::Set(ints, 1)), hn::Set(ints, last)));
            const V sigma = fma(t, hn::Sub(high, low), low);
            store(keep(known, choose(hn::Lt(value, clipped), sigma, hn::Neg(sigma))), b.sigma[k], at);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace tangi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tangi {

HWY_EXPORT(Illuminate);
HWY_EXPORT(Doubt);

BatchSampler::BatchSampler(const Lighting& lighting, const NoiseModel& noise, const WardPrior& prior,
                           int channels)
    : rig_(lighting.rig), noise_(noise), prior_(prior), channels_(channels) {
    for (const Light& light : lighting.lights) {
        BatchLight lane{.irradiance = light.gain * static_cast<float>(lighting.white_level)};
        lane.near = light.position_mm.has_value();
        lane.uneven = !light.beam.even();
        lane.beam = light.beam.terms;
        lane.at = lane.near ? *light.position_mm : light.direction;
        lane.length2 = glm::dot(lane.at, lane.at);
        lights_.push_back(lane);
    }
}

void BatchSampler::fill(const Band& band, const Surface& surface, int x0, int y, int count, int first_name,
                        WardBatch& batch) const {
    TP_REQUIRE(count > 0 && count <= kWardLanes && x0 + count <= band.width(), "pixels of the band");
    TP_REQUIRE(band.photos() == static_cast<int>(lights_.size()) && band.channels() == channels_,
               "a band of the photographs that have these lights");
    if (batch.photos != band.photos() || batch.channels != channels_ || batch.value.empty())
        batch.resize(band.photos(), channels_, prior_);
    BatchScene scene{&lights_, &rig_, {}, {}, {}};
    for (int lane = 0; lane < kWardLanes; ++lane) {
        const Vec3 point = surface.point_mm(x0 + std::min(lane, count - 1), y);
        scene.x[lane] = point.x;
        scene.y[lane] = point.y;
        scene.z[lane] = point.z;
        batch.pixel[static_cast<std::size_t>(lane)] = lane < count ? first_name + lane : -1;
        batch.set_prior(lane, prior_);
    }
    HWY_DYNAMIC_DISPATCH(Illuminate)(scene, batch);
    std::size_t k = 0;
    for (int i = 0; i < band.photos(); ++i)
        for (int c = 0; c < channels_; ++c, ++k) {
            const float* row = band.row(i, c, y) + x0;
            float* lanes = batch.value[k].data();
            if (count == kWardLanes) {  // a copy of known size takes no call
                std::memcpy(lanes, row, sizeof(WardLane));
                continue;
            }
            std::copy(row, row + count, lanes);
            std::fill(lanes + count, lanes + kWardLanes, 0.0f);
        }
    HWY_DYNAMIC_DISPATCH(Doubt)(noise_, count, batch);
}

}  // namespace tangi
#endif
