// viewer_support.h: what tests of the viewer share: a context without a window, painted surfaces.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/support/test_support.h"
#include "viewer/render/headless.h"
#include "viewer/render/renderer.h"

namespace tangi {

// Tests that draw; skipped aloud where nothing here draws OpenGL.
class Drawing : public testing::Test {
protected:
    void SetUp() override {
        try {
            context_.emplace();
        } catch (const Error& error) {
            GTEST_SKIP() << "no OpenGL here: " << error.what();
        }
        renderer_.emplace();
    }

    void show(const Surface& surface, float paint_mm = 0) {
        tiles_ = std::make_shared<TexelTiles>(surface, range_of(surface, paint_mm));
        renderer_->set_painting(tiles_, surface.mm_per_pixel);
    }

    Image<Rgb> drawn(const Scene& scene, const Shot& shot, bool linear = true) {
        const gl::Target target(shot.width, shot.height, true);
        renderer_->fetch(scene, shot);
        renderer_->draw(scene, shot, target.framebuffer(), linear);
        return renderer_->read(target);
    }

    std::optional<gl::HeadlessContext> context_;
    std::optional<Renderer> renderer_;
    std::shared_ptr<TexelTiles> tiles_;
};

// Ridges and grains, paints of all colours, gloss from mirror-like to matt.
inline Surface painted_surface(int width, int height, std::uint64_t seed = 1) {
    Random random(seed);
    Surface s(width, height);
    s.mm_per_pixel = 0.1;
    s.scale_known = true;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            s.height_mm(x, y) =
                0.3f * std::sin(0.21f * static_cast<float>(x)) * std::cos(0.17f * static_cast<float>(y)) +
                static_cast<float>(random.real(0, 0.03));
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    for (Rgb& c : s.diffuse.pixels())
        c = {random.real(0.02, 0.9), random.real(0.02, 0.9), random.real(0.02, 0.9)};
    for (float& v : s.specular.pixels()) v = static_cast<float>(random.real(0, 0.1));
    for (float& v : s.roughness.pixels()) v = static_cast<float>(random.real(0.05, 0.5));
    for (float& v : s.confidence.pixels()) v = static_cast<float>(random.real(0, 1));
    return s;
}

// With lobes of all colours on it.
inline Surface gilded_surface(int width, int height, std::uint64_t seed = 1) {
    Surface s = painted_surface(width, height, seed);
    Random random(seed + 1);
    s.specular_colour = Image<Rgb>(width, height, Rgb(1));
    for (int y = 0; y < height; ++y)
        for (int x = width / 4; x < width; ++x) {
            Rgb& colour = s.specular_colour(x, y);
            colour = {random.real(0.1, 1), random.real(0.1, 1), random.real(0.1, 1)};
            colour /= std::max({colour.r, colour.g, colour.b});
        }
    return s;
}

// And anisotropic in all directions.
inline Surface brushed_surface(int width, int height, std::uint64_t seed = 1) {
    Surface s = gilded_surface(width, height, seed);
    Random random(seed + 2);
    s.lobe_axes = Image<LobeAxes>(width, height);
    for (std::size_t i = 0; i < s.lobe_axes.size(); ++i) {
        const float stretch = static_cast<float>(random.real(0, 0.7)),
                    angle = static_cast<float>(random.real(-3, 3));
        const float alpha = s.roughness.pixels()[i];
        s.lobe_axes.pixels()[i] = axes_of(stretch * Stretch(std::cos(angle), std::sin(angle)), alpha);
    }
    return s;
}

// Part of the pixels whose encoded values differ by no more than `steps` of 255.
inline double part_within(const Image<Rgb>& a, const Image<Rgb>& b, double steps) {
    if (a.region() != b.region()) return 0;
    const Transfer srgb{Transfer::Kind::srgb};
    std::size_t good = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Rgb p = glm::clamp(srgb.encode(a.pixels()[i]), 0.0f, 1.0f),
                  q = glm::clamp(srgb.encode(b.pixels()[i]), 0.0f, 1.0f);
        const float worst = std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
        good += worst <= steps / 255;
    }
    return static_cast<double>(good) / static_cast<double>(a.size());
}

inline double mean_luminance(const Image<Rgb>& picture) {
    double sum = 0;
    for (const Rgb& c : picture.pixels()) sum += luminance(c);
    return sum / static_cast<double>(picture.size());
}

}  // namespace tangi
