// renderer_colours_test.cpp: the colours that OpenGL draws are those of their definitions.
#include "viewer/render/renderer.h"

#include "tests/support/viewer_support.h"
#include "viewer/render/view.h"

namespace tangi {
namespace {

using RendererColours = Drawing;

// What the window shows, against the definition of sRGB.
TEST_F(RendererColours, EncodesAsSrgb) {
    Surface s(256, 4);
    for (int x = 0; x < 256; ++x)
        for (int y = 0; y < 4; ++y) {
            const auto v = static_cast<float>(x) / 255;
            s.diffuse(x, y) = Rgb(v * v * v);
            s.confidence(x, y) = 1;
        }
    show(s);
    const Scene scene{.lights = {distant_light({0, 0, 1})}};
    const auto linear = drawn(scene, pixel_by_pixel(s)), encoded = drawn(scene, pixel_by_pixel(s), false);
    const Transfer srgb{Transfer::Kind::srgb};
    for (int x = 0; x < 256; ++x)
        EXPECT_NEAR(encoded(x, 2).g, srgb.encode(linear(x, 2)).g, 0.05 / 255) << linear(x, 2).g;
}

TEST_F(RendererColours, FalseColoursAreThoseOfTheirScale) {
    Surface s = painted_surface(64, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 64; ++x) s.confidence(x, y) = static_cast<float>(x) / 63;
    show(s);
    Scene scene{.lights = {distant_light({-0.8f, 0.3f, 0.5f})}};
    scene.mode = ViewMode::confidence;
    const Image<Rgb> picture = drawn(scene, pixel_by_pixel(s));
    for (int x = 0; x < 64; ++x) {
        const Rgb off = glm::abs(picture(x, 8) - false_colour(s.confidence(x, 8)));
        EXPECT_LT(std::max({off.r, off.g, off.b}), 0.02f) << x;
    }
}

}  // namespace
}  // namespace tangi
