// pixel_samples.h: what the photographs say about one pixel, as the per-pixel fits take it.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace tangi {

// One pixel under all lights. Vectors are in the surface frame.
struct PixelSamples {
    int channels = 3;
    glm::dvec3 view{0, 0, 1};       // [unit vector] to the camera
    std::vector<glm::dvec3> light;  // [unit vector] to each light, from this pixel
    std::vector<double>
        irradiance;  // [photo * channels + channel] white_level * gain: what a matt white would read
    std::vector<double> ambient;  // [1] of each photo: light from all around, as a part of the light's
    // [1] of each photo: part of the light that reaches the pixel past the relief, as far as is known; what
    // is in shadow is the less certain the more of the light it lacks. 1 where nothing is known.
    std::vector<double> visible;
    std::vector<double> value;  // [photo * channels + channel] linear pixel value
    std::vector<double> sigma;  // same layout: [1] standard deviation expected of value; 0 = leave it
                                // out; < 0: the value is clipped, a lower bound of this deviation

    int photos() const { return static_cast<int>(light.size()); }
    void resize(int photo_count, int channel_count) {
        channels = channel_count;
        const auto n = static_cast<std::size_t>(photo_count);
        light.resize(n);
        ambient.resize(n);
        visible.assign(n, 1);
        irradiance.resize(n * static_cast<std::size_t>(channel_count));
        value.resize(irradiance.size());
        sigma.resize(irradiance.size());
    }
};

}  // namespace tangi
