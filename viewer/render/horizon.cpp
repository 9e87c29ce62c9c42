#include "viewer/render/horizon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr double kPi = std::numbers::pi;
// [tangent] Horizons below a third of a degree are no horizons: less than a code.
constexpr float kLowest = 0.006f;

std::uint8_t code_of(float tangent) {
    const double part = std::sqrt(std::atan(static_cast<double>(tangent)) / (kPi / 2));
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
}

float between(const Image<float>& z, float x, float y) {
    const int x0 = std::min(static_cast<int>(x), z.width() - 2),
              y0 = std::min(static_cast<int>(y), z.height() - 2);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const float top = z(x0, y0) + fx * (z(x0 + 1, y0) - z(x0, y0));
    const float bottom = z(x0, y0 + 1) + fx * (z(x0 + 1, y0 + 1) - z(x0, y0 + 1));
    return top + fy * (bottom - top);
}

struct Relief {
    const Image<float>& height_mm;
    float highest_mm, mm_per_texel;
};

// Tangent of the horizon's elevation at (x, y) towards (dx, dy) [unit, texels, y down]. Steps grow with the
// distance: far relief is seen under small angles.
float horizon(const Relief& relief, int x, int y, float dx, float dy) {
    const Image<float>& z = relief.height_mm;
    const float here = z(x, y), right = static_cast<float>(z.width() - 1),
                bottom = static_cast<float>(z.height() - 1);
    const float mm = relief.mm_per_texel;
    float best = kLowest;
    for (float t = 1; relief.highest_mm - here > best * t * mm; t += std::max(1.0f, t / 16)) {
        const float px = static_cast<float>(x) + t * dx, py = static_cast<float>(y) + t * dy;
        if (!(px >= 0 && py >= 0 && px <= right && py <= bottom)) break;
        best = std::max(best, (between(z, px, py) - here) / (t * mm));
    }
    return best > kLowest ? best : 0;
}

}  // namespace

double HorizonMap::elevation_deg(int x, int y, int azimuth) const {
    const std::size_t at =
        (static_cast<std::size_t>(azimuth) * static_cast<std::size_t>(height) + static_cast<std::size_t>(y)) *
            static_cast<std::size_t>(width) +
        static_cast<std::size_t>(x);
    const double part = values[at] / 255.0;
    return part * part * 90;
}

CoarseHeights coarse_heights(const Image<float>& z, double mm_per_pixel, int largest_side) {
    const int factor = std::max(1, (std::max(z.width(), z.height()) + largest_side - 1) / largest_side);
    if (factor == 1) return {z, mm_per_pixel};
    CoarseHeights coarse{Image<float>((z.width() + factor - 1) / factor, (z.height() + factor - 1) / factor),
                         mm_per_pixel * factor};
    parallel_for(0, coarse.height_mm.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < coarse.height_mm.width(); ++x) {
                float sum = 0, count = 0;
                for (int j = y * factor; j < std::min((y + 1) * factor, z.height()); ++j)
                    for (int i = x * factor; i < std::min((x + 1) * factor, z.width()); ++i) {
                        sum += z(i, j);
                        ++count;
                    }
                coarse.height_mm(x, y) = sum / count;
            }
    });
    return coarse;
}

HorizonMap horizon_map(const CoarseHeights& heights, const Progress& progress) {
    const Image<float>& z = heights.height_mm;
    HorizonMap map{z.width(), z.height(), {}};
    map.values.assign(z.size() * HorizonMap::kAzimuths, 0);
    if (z.width() < 2 || z.height() < 2) return map;
    const Relief relief{z, *std::max_element(z.pixels().begin(), z.pixels().end()),
                        static_cast<float>(heights.mm_per_texel)};
    for (int azimuth = 0; azimuth < HorizonMap::kAzimuths; ++azimuth) {
        report(progress, "shadows", azimuth / static_cast<double>(HorizonMap::kAzimuths));
        const double angle = 2 * kPi * azimuth / HorizonMap::kAzimuths;
        const auto dx = static_cast<float>(std::cos(angle)), dy = static_cast<float>(-std::sin(angle));
        std::uint8_t* const slice = map.values.data() + static_cast<std::size_t>(azimuth) * z.size();
        parallel_for(0, z.height(), 8, [&](int begin, int end) {
            for (int y = begin; y < end; ++y)
                for (int x = 0; x < z.width(); ++x)
                    slice[static_cast<std::size_t>(y) * static_cast<std::size_t>(z.width()) +
                          static_cast<std::size_t>(x)] = code_of(horizon(relief, x, y, dx, dy));
        });
    }
    report(progress, "shadows", 1);
    return map;
}

void horizon_towards(const HorizonMap& map, double azimuth_deg, std::span<std::uint16_t> roots) {
    const auto size = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
    TP_REQUIRE(roots.size() == size && map.values.size() == size * HorizonMap::kAzimuths,
               "there is a root for each place");
    const double turn = azimuth_deg / 360 * HorizonMap::kAzimuths, before = std::floor(turn);
    const int first = static_cast<int>(
        std::lround(before - std::floor(before / HorizonMap::kAzimuths) * HorizonMap::kAzimuths));
    // 257 parts of 255 are 65535.
    const auto part = static_cast<std::uint16_t>(std::lround(257 * (turn - before)));
    const auto rest = static_cast<std::uint16_t>(257 - part);
    const std::uint8_t* const a = &map.values[static_cast<std::size_t>(first % HorizonMap::kAzimuths) * size];
    const std::uint8_t* const b =
        &map.values[static_cast<std::size_t>((first + 1) % HorizonMap::kAzimuths) * size];
    for (std::size_t i = 0; i < size; ++i) roots[i] = static_cast<std::uint16_t>(rest * a[i] + part * b[i]);
}

}  // namespace tangi
