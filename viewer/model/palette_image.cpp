#include "viewer/model/palette_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "paint/optics/kubelka_munk.h"
#include "surface/base/parallel.h"
#include "surface/image/colour.h"
#include "surface/render/relight.h"

namespace tangi {

namespace {

constexpr float kAround = 0.15f;  // part of the light that comes from all around

// [sRGB, 0..1]
Rgb seen(const Surface& surface, int x, int y, const Vec3& light) {
    const Rgb lit = reflected(surface, x, y, light, {0, 0, 1}, WardModel::bounded);
    return glm::clamp(Transfer{Transfer::Kind::srgb}.encode(lit + kAround * surface.diffuse(x, y)), 0.0f,
                      1.0f);
}

constexpr float kThick_mm = 1;

}  // namespace

Rgb thick_film(std::span<const Pigment> paints, std::span<const float> parts, Illuminant illuminant) {
    const float sum = std::accumulate(parts.begin(), parts.end(), 0.0f);
    std::vector<float> volumes;
    for (const float part : parts) volumes.push_back(kThick_mm * part / sum);
    std::vector<std::span<const float>> planes;
    for (const float& volume : volumes) planes.emplace_back(&volume, 1);
    const Rgb below(0.5f);
    Rgb colour;
    FilmBatch(std::vector(paints.begin(), paints.end()), illuminant)
        .look(planes, std::span<const Rgb>(&below, 1), std::span<Rgb>(&colour, 1));
    return glm::clamp(colour, 0.0f, 1.0f);
}

BoardPatch board_patch(const Surface& board, const Region& region, const Vec3& light) {
    BoardPatch patch{board.width(), board.height(), region, {}};
    const auto width = static_cast<std::size_t>(region.width());
    patch.srgb.resize(width * static_cast<std::size_t>(region.height()));
    parallel_for(region.y0, region.y1, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = region.x0; x < region.x1; ++x)
                patch.srgb[static_cast<std::size_t>(y - region.y0) * width +
                           static_cast<std::size_t>(x - region.x0)] =
                    glm::u8vec3(glm::round(255.0f * seen(board, x, y, light)));
    });
    return patch;
}

std::vector<Rgb> gloss_strip(const Rgb& diffuse, double specular, double roughness, int count) {
    Surface strip(count, 1);
    std::vector<Rgb> colours;
    for (int i = 0; i < count; ++i) {
        const double angle = (2.0 * (i + 0.5) / count - 1) * 60 * std::numbers::pi / 180;
        // Bent towards the light and away from it.
        strip.normal(i, 0) = {static_cast<float>(std::sin(angle) / std::numbers::sqrt2),
                              static_cast<float>(-std::sin(angle) / std::numbers::sqrt2),
                              static_cast<float>(std::cos(angle))};
        strip.diffuse(i, 0) = diffuse;
        strip.specular(i, 0) = static_cast<float>(specular);
        strip.roughness(i, 0) = static_cast<float>(roughness);
        colours.push_back(seen(strip, i, 0, kBoardLight));
    }
    return colours;
}

}  // namespace tangi
