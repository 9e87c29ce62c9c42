#include "paint/substrate/substrate_finish.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr float kSmoothest = 0.001f;  // [1] alpha

// All that was measured in proportion, so that its mean is this as far as the map's range allows.
void scale_to(double mean, float least, const Image<float>& confidence, Image<float>& map) {
    constexpr int kMost = 50;  // what was cut off at the range's end is made up for by the rest
    for (int i = 0; i < kMost; ++i) {
        double sum = 0, count = 0;
        for (std::size_t k = 0; k < map.size(); ++k) {
            if (!(confidence.pixels()[k] > 0)) continue;
            sum += static_cast<double>(map.pixels()[k]);
            ++count;
        }
        const double is = count > 0 ? sum / count : mean;
        if (std::abs(is - mean) <= 1e-5 * mean) return;
        for (std::size_t k = 0; k < map.size(); ++k) {
            float& v = map.pixels()[k];
            if (!(confidence.pixels()[k] > 0)) continue;
            v = std::clamp(is > 0 ? static_cast<float>(v * mean / is) : static_cast<float>(mean), least,
                           1.0f);
        }
    }
}

}  // namespace

void apply(const SubstrateFinish& finish, Surface& surface) {
    const auto within = [](double v, double low, double high) { return v >= low && v <= high; };
    if (!within(finish.tint.r, 0, 1) || !within(finish.tint.g, 0, 1) || !within(finish.tint.b, 0, 1))
        fail("a tint of {:g}, {:g}, {:g}: each is 0 to 1", finish.tint.r, finish.tint.g, finish.tint.b);
    if (finish.specular && !within(*finish.specular, 0, 1))
        fail("a gloss (rho_s) of {:g}: it is 0 to 1", *finish.specular);
    if (finish.roughness && !within(*finish.roughness, static_cast<double>(kSmoothest), 1))
        fail("a roughness (alpha) of {:g}: it is {:g} to 1", *finish.roughness, kSmoothest);
    if (finish.tint != Rgb(1))
        for (Rgb& c : surface.diffuse.pixels()) c *= finish.tint;
    if (finish.specular) scale_to(*finish.specular, 0, surface.confidence, surface.specular);
    if (!finish.roughness) return;
    const Image<float> before = surface.roughness;
    scale_to(*finish.roughness, kSmoothest, surface.confidence, surface.roughness);
    for (std::size_t i = 0; i < surface.lobe_axes.size(); ++i)  // as anisotropic as they were
        surface.lobe_axes.pixels()[i].roughness_v *= surface.roughness.pixels()[i] / before.pixels()[i];
}

}  // namespace tangi
