// chart_pictures.h: pictures of colour charts, drawn for tests.
#pragma once

#include <glm/matrix.hpp>

#include "capture/colour_chart/chart_order.h"
#include "tests/support/test_support.h"

namespace tangi {

// A camera whose primaries overlap, with a blue channel that is weak.
inline const glm::dmat3 kTestCamera(0.62, 0.22, 0.04, 0.30, 0.66, 0.16, 0.08, 0.12, 0.50);

// The map of a chart whose outer patches have these outer corners: top left, and so on, of the upright chart.
inline Homography chart_map(const ChartCorners& corners) {
    constexpr double m = 0.065;
    return homography_between(
        {glm::dvec2(m, m), glm::dvec2(6 - m, m), glm::dvec2(6 - m, 4 - m), glm::dvec2(m, 4 - m)}, corners);
}

// Patches on a black card, each pixel the mean of 3 x 3 samples; what is outside of the card stays.
inline void draw_chart(Image<Rgb>& picture, const Homography& chart_to_picture,
                       const ChartReference& reference, const glm::dmat3& camera = kTestCamera) {
    const Homography inverse = glm::inverse(chart_to_picture);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            Rgb sum(0);
            for (int s = 0; s < 9; ++s) {
                const int column = s % 3, row = s / 3;
                const glm::dvec2 p = mapped(inverse, glm::dvec2(x + (column - 1) / 3.0, y + (row - 1) / 3.0));
                Rgb colour = picture(x, y);
                if (p.x > -0.2 && p.y > -0.2 && p.x < 6.2 && p.y < 4.2) {
                    colour = Rgb(0.015f);
                    const glm::dvec2 cell = glm::floor(p), part = p - cell;
                    const bool on_patch = p.x > 0 && p.y > 0 && p.x < 6 && p.y < 4 && part.x > 0.065 &&
                                          part.x < 0.935 && part.y > 0.065 && part.y < 0.935;
                    if (on_patch) {
                        const auto i = static_cast<std::size_t>(cell.y * 6 + cell.x);
                        colour = Rgb(camera * glm::dvec3(reference.patches[i].linear));
                    }
                }
                sum += colour / 9.0f;
            }
            picture(x, y) = sum;
        }
}

// Something like a table and a painting: large soft shapes, and many small rectangles.
inline Image<Rgb> busy_background(int width, int height, std::uint64_t seed) {
    Random random(seed);
    Image<Rgb> picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            picture(x, y) = Rgb(0.25f, 0.2f, 0.15f) *
                            static_cast<float>(1 + 0.2 * std::sin(0.05 * x) * std::cos(0.07 * y));
    for (int i = 0; i < 60; ++i) {
        const int x0 = random.below(width), y0 = random.below(height), w = 4 + random.below(25),
                  h = 4 + random.below(25);
        const Rgb colour(random.real(0.02, 0.6), random.real(0.02, 0.6), random.real(0.02, 0.6));
        for (int y = y0; y < std::min(height, y0 + h); ++y)
            for (int x = x0; x < std::min(width, x0 + w); ++x) picture(x, y) = colour;
    }
    return picture;
}

inline void add_noise(Image<Rgb>& picture, double relative, double absolute, std::uint64_t seed) {
    Random random(seed);
    for (Rgb& c : picture.pixels())
        for (int k = 0; k < 3; ++k)
            c[k] += static_cast<float>(random.normal() * std::hypot(relative * c[k], absolute));
}

// Corners of a chart of width `size_px` turned by `turn_deg` about `centre`, and tilted: the far side is
// smaller.
inline ChartCorners turned_corners(const glm::dvec2& centre, double size_px, double turn_deg,
                                   double tilt = 0) {
    const double turn = turn_deg * std::numbers::pi / 180;
    ChartCorners corners = {glm::dvec2(-0.5, -1.0 / 3), glm::dvec2(0.5, -1.0 / 3), glm::dvec2(0.5, 1.0 / 3),
                            glm::dvec2(-0.5, 1.0 / 3)};
    for (glm::dvec2& c : corners) {
        const glm::dvec2 t(std::cos(turn) * c.x - std::sin(turn) * c.y,
                           std::sin(turn) * c.x + std::cos(turn) * c.y);
        c = centre + size_px * t / (1 - tilt * t.y);
    }
    return corners;
}

}  // namespace tangi
