// renderer_colours_test.cpp: the colours that OpenGL draws are those of their definitions.
#include "viewer/render/renderer.h"

#include "tests/support/viewer/viewer_support.h"
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

// A map that goes along its scale from one end to the other: the legend of the window (value_at) and the
// shader agree.
TEST_F(RendererColours, FalseColoursAreThoseOfTheirScale) {
    for (const auto& [mode, map] : {std::pair(ViewMode::height, &Surface::height_mm),
                                    {ViewMode::roughness, &Surface::roughness},
                                    {ViewMode::specular, &Surface::specular},
                                    {ViewMode::confidence, &Surface::confidence}}) {
        Surface s = painted_surface(64, 16);
        const Scene scene{.lights = {distant_light({-0.8f, 0.3f, 0.5f})},
                          .mode = mode,
                          .lowest_mm = -0.3f,
                          .highest_mm = 0.5f};
        const ViewModeTraits& traits = traits_of(mode);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 64; ++x)
                (s.*map)(x, y) = static_cast<float>(value_at(traits.scale, scale_ends(scene), x / 63.0));
        show(s);
        const Image<Rgb> picture = drawn(scene, pixel_by_pixel(s));
        for (int x = 0; x < 64; ++x) {
            if (s.roughness(x, 8) > 1) continue;  // no surface has such a lobe, and no texel holds it
            const Rgb off = glm::abs(picture(x, 8) - false_colour(static_cast<float>(x) / 63));
            EXPECT_LT(std::max({off.r, off.g, off.b}), 0.02f) << traits.name << " " << x;
        }
    }
}

}  // namespace
}  // namespace tangi
