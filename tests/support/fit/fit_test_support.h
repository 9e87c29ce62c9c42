// fit_test_support.h: a small generated stack to fit, and how far its normals are from the truth.
#pragma once

#include <cmath>
#include <numbers>

#include "capture/stack/stack.h"
#include "datasets/generator.h"
#include "fit/evaluate/compare.h"
#include "surface/maps/surface.h"
#include "tests/support/test_support.h"

namespace tangi {

inline constexpr double kMmPerPixel = 0.4, kDegree = std::numbers::pi / 180;

inline PaintingTruth painting(int width, int height) {
    return procedural_painting({.seed = 3, .width = width, .height = height, .mm_per_pixel = kMmPerPixel});
}

// Brushed or gilded metal on the left half, blue paint on the right; nothing is measured in one column.
inline Surface metal_beside_paint(int width, int height, int unmeasured) {
    Surface s(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool metal = x < width / 2;
            s.confidence(x, y) = x == unmeasured ? 0.0f : 1.0f;
            s.diffuse(x, y) = metal ? Rgb(0.1f, 0.07f, 0.03f) : Rgb(0.2f, 0.3f, 0.6f);
            s.specular(x, y) = metal ? 0.3f : 0.04f;
        }
    return s;
}

// Mean angle between the normals where the truth has one surface a pixel.
inline double mean_normal_error_deg(const Surface& surface, const PaintingTruth& truth) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < truth.normal.size(); ++i) {
        if (!truth.valid.pixels()[i]) continue;
        const glm::dvec3 a(surface.normal.pixels()[i]), b(truth.normal.pixels()[i]);
        sum += std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
        ++count;
    }
    return sum / count;
}

// Held-out photographs of a generated stack are compared through a stack of their own.
inline double held_out_psnr_db(const Surface& surface, const std::filesystem::path& folder,
                               Transfer transfer) {
    return compare(surface, open_stack(folder / "heldout", {.transfer = transfer})).held_out.psnr_db;
}

inline double rms_difference(const Image<float>& a, const Image<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a.pixels()[i] - b.pixels()[i], 2);
    return std::sqrt(sum / static_cast<double>(a.size()));
}

// The small stack that most tests use: 16 lights, linear 16 bit.
inline constexpr int kWidth = 41, kHeight = 31;
struct SmallStack {
    TestDir folder;
    PaintingTruth truth = painting(kWidth, kHeight);
    SmallStack() { write_stack(folder.path(), truth, {.lights = 16, .held_out = 0}); }
    Stack open(const StackOptions& options = {.transfer = Transfer{}}) const {
        return open_stack(folder.path(), options);
    }
};

}  // namespace tangi
