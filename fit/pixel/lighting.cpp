#include "fit/pixel/lighting.h"

#include <algorithm>
#include <cmath>

#include "capture/stack/survey.h"

namespace tangi {

void illuminate(const Lighting& lighting, const Vec3& point_mm, int channels, PixelSamples& samples) {
    samples.resize(static_cast<int>(lighting.lights.size()), channels);
    samples.view = view_direction(lighting.rig, point_mm);
    std::size_t at = 0;
    for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
        const Incidence in = incidence(lighting.lights[i], point_mm, lighting.rig);
        samples.light[i] = in.direction;
        samples.ambient[i] = lighting.rig.ambient;
        for (int c = 0; c < channels; ++c) samples.irradiance[at++] = lighting.white_level * in.irradiance[c];
    }
}

NoiseModel::NoiseModel(const Transfer& transfer, double noise, bool clips, std::optional<float> clipped)
    : stored_(noise) {
    const float step = static_cast<float>(noise);
    for (int i = 0; i < kEntries; ++i) {
        const float encoded = transfer.encode(static_cast<float>(i) / (kEntries - 1));
        sigma_[static_cast<std::size_t>(i)] =
            (transfer.decode(encoded + step) - transfer.decode(std::max(encoded - step, 0.0f))) / 2;
    }
    if (clips) clipped_ = clipped.value_or(transfer.decode(kClipped));
}

double NoiseModel::sigma(float linear) const {
    if (std::isnan(linear)) return 0;
    const float position = std::clamp(linear, 0.0f, 1.0f) * (kEntries - 1);
    const auto i = static_cast<std::size_t>(position);
    const float t = position - static_cast<float>(i);
    const float sigma = sigma_[i] + t * (sigma_[std::min<std::size_t>(i + 1, kEntries - 1)] - sigma_[i]);
    return linear < clipped_ ? sigma : -sigma;
}

}  // namespace tangi
