// mirrored_painting.h: a mirror sphere that lies on a painting and mirrors it: its outline hardly shows.
#pragma once

#include "tests/support/capture/sphere_pictures.h"

namespace tangi {

// A light, or what reflects one: a disc with a soft border and a glow around it.
struct MirroredLight {
    glm::dvec3 direction{0, 0, 1};
    double strength = 40;  // 1 is clipped
};

struct MirroredPainting {
    int width = 110, height = 110;
    std::vector<SphereImage> spheres = {{{54.3, 55.6}, 26, 0, 0}};
    double plain_from = 1e9;  // [pixels] x from which on the painting is an even grey board
    double table = 0.25;      // [1] reflectance around the painting
    double contrast = 0.5;    // [1] of ln reflectance
    int finest = 2;           // [pixels] of the pattern
    double light_deg = 4;     // radius
    double noise = 0.0015;
    std::uint64_t seed = 1;

    // Reflectance of the painting: noise of several sizes, some of it with hard edges.
    Image<float> painting() const {
        Image<float> result(width, height, 0.0f);
        Random random(seed);
        double weight = 0;
        for (int size = finest; size < 40; size *= 2) {
            const int across = width / size + 3, down = height / size + 3;
            std::vector<double> grid(static_cast<std::size_t>(across * down));
            for (double& value : grid) value = random.normal();
            const bool hard = random.uniform(0, 1) < 0.4;
            weight += 1;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const double px = static_cast<double>(x) / size, py = static_cast<double>(y) / size;
                    const int ix = static_cast<int>(px), iy = static_cast<int>(py);
                    const auto at = [&](int i, int j) {
                        return grid[static_cast<std::size_t>(j * across + i)];
                    };
                    const double u = px - ix, v = py - iy;
                    double value = (1 - v) * ((1 - u) * at(ix, iy) + u * at(ix + 1, iy)) +
                                   v * ((1 - u) * at(ix, iy + 1) + u * at(ix + 1, iy + 1));
                    if (hard) value = value > 0 ? 0.8 : -0.8;
                    result(x, y) += static_cast<float>(value);
                }
        }
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                result(x, y) =
                    x >= plain_from
                        ? 0.13f
                        : static_cast<float>(std::clamp(
                              0.35 * std::exp(contrast * result(x, y) / std::sqrt(weight)), 0.02, 0.95));
        return result;
    }

    // Under a light, and what else shines; the first is the light that lights the painting.
    Image<float> picture(const std::vector<MirroredLight>& lights, const Image<float>& reflectance) const {
        const double lit = 0.75 * lights[0].direction.z;
        Random random(seed * 7919 + static_cast<std::uint64_t>(std::abs(lights[0].direction.x * 1e6)));
        Image<float> image(width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                double sum = 0;
                for (int s = 0; s < 16; ++s) {
                    const int column = s % 4, row = s / 4;
                    sum += seen({x + (column - 1.5) / 4, y + (row - 1.5) / 4}, lights, reflectance, lit) / 16;
                }
                image(x, y) = static_cast<float>(std::clamp(sum + noise * random.normal(), 0.0, 1.0));
            }
        return image;
    }

private:
    double seen(const glm::dvec2& at, const std::vector<MirroredLight>& lights,
                const Image<float>& reflectance, double lit) const {
        for (const SphereImage& sphere : spheres) {
            const auto point = sphere_point(sphere, {}, at);
            if (!point) continue;
            const glm::dvec3 to = point->mirrored(), n = point->normal;
            double value = 0.01;
            if (to.z < -1e-3) {
                const double way = sphere.radius_px * (n.z + 1) / -to.z;  // to the painting that it lies on
                const glm::dvec2 hit =
                    sphere.centre_px +
                    glm::dvec2(1, -1) * (sphere.radius_px * glm::dvec2(n) + way * glm::dvec2(to));
                value = glm::length(hit - sphere.centre_px) < 6 * width ? of_painting(hit, reflectance, lit)
                                                                        : 0.01;
            }
            for (const MirroredLight& light : lights) {
                const double off = degrees_between(to, light.direction);
                value += light.strength / (1 + std::exp((off - light_deg) / 0.3)) +
                         0.001 * light.strength * std::exp(-off * off / 64);
            }
            return std::min(1.0, 0.85 * value);
        }
        return of_painting(at, reflectance, lit);
    }

    double of_painting(const glm::dvec2& at, const Image<float>& reflectance, double lit) const {
        if (at.x < 0 || at.y < 0 || at.x > width - 1 || at.y > height - 1) return table * lit;
        const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
        const float u = static_cast<float>(at.x - x), v = static_cast<float>(at.y - y);
        const float value =
            (1 - v) * ((1 - u) * reflectance(x, y) + u * reflectance.clamped(x + 1, y)) +
            v * ((1 - u) * reflectance.clamped(x, y + 1) + u * reflectance.clamped(x + 1, y + 1));
        return lit * static_cast<double>(value);
    }
};

// Lights all around from 20 to 70 degrees above the painting.
inline std::vector<glm::dvec3> lights_above(int count) {
    std::vector<glm::dvec3> lights;
    for (int i = 0; i < count; ++i) {
        const double up = (20 + 50.0 * ((i * 7) % count) / count) * std::numbers::pi / 180, around = 2.4 * i;
        lights.emplace_back(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
    }
    return lights;
}

inline std::vector<std::filesystem::path> write_mirrored(
    const std::filesystem::path& folder, const MirroredPainting& scene,
    const std::vector<std::vector<MirroredLight>>& photos) {
    const Image<float> reflectance = scene.painting();
    std::vector<std::filesystem::path> paths;
    for (std::size_t i = 0; i < photos.size(); ++i) {
        paths.push_back(folder / sphere_photo_name(static_cast<int>(i)));
        write_map(paths.back(), scene.picture(photos[i], reflectance));
    }
    return paths;
}

}  // namespace tangi
