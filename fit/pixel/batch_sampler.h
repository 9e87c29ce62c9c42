// batch_sampler.h: what lights, photographs and noise say about runs of pixels, in lanes: illuminate() and
// NoiseModel::sigma() for the batched fit.
#pragma once

#include <vector>

#include "capture/stack/stack.h"
#include "fit/pixel/lighting.h"
#include "fit/pixel/ward_batch.h"
#include "surface/maps/surface.h"

namespace tangi {

// A light as the lanes take it.
struct BatchLight {
    Vec3 at{0};  // [mm] position, or the unit vector to a distant light
    bool near = false;
    float length2 = 1;  // [mm^2] of the position
    Rgb irradiance{1};  // [1] white level * gain: at the origin
    bool uneven = false;
    std::array<float, 5> beam{};  // as Beam::terms
};

class BatchSampler {
public:
    // Keeps a reference to the noise.
    BatchSampler(const Lighting& lighting, const NoiseModel& noise, const WardPrior& prior, int channels);

    // Fills the batch with pixels (x0, y) … (x0 + count - 1, y), count <= kWardLanes; their names are
    // first_name and on. The band has the photographs of the lighting, in its order.
    void fill(const Band& band, const Surface& surface, int x0, int y, int count, int first_name,
              WardBatch& batch) const;

private:
    Rig rig_;
    std::vector<BatchLight> lights_;
    const NoiseModel& noise_;
    WardPrior prior_;
    int channels_;
};

}  // namespace tangi
