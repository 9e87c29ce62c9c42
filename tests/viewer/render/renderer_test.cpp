// renderer_test.cpp: OpenGL draws what the reference renderer computes, near and from afar.
#include <gmock/gmock.h>

#include "viewer/render/renderer.h"

#include "surface/base/parallel.h"
#include "tests/support/viewer/viewer_support.h"
#include "viewer/render/cpu_render.h"
#include "viewer/render/view.h"

namespace tangi {
namespace {

class RendererTest : public Drawing {
protected:
    Image<Rgb> by_gl(const Surface& s, const std::vector<Light>& lights, const RelightOptions& options) {
        show(s);
        return relight_with(*renderer_, s, lights, options);
    }
    void expect_equals_the_reference(Surface s, Surface without, const char* why_it_differs);
};

std::vector<Light> some_lights() {
    Light warm = distant_light({-0.8f, 0.3f, 0.5f});
    warm.gain = {1.1f, 0.9f, 0.7f};
    Light light = near_light({12, 9, 20});
    light.gain = Rgb(0.4f);
    return {warm, light, distant_light({0.2f, -0.9f, 0.25f})};
}

// In two models, and with shadows under a rough and hazy law, where the same surface `without` something
// looks otherwise.
void RendererTest::expect_equals_the_reference(Surface s, Surface without, const char* why_it_differs) {
    for (const WardModel model : {WardModel::ward1992, WardModel::bounded}) {
        const auto gl = by_gl(s, some_lights(), {.model = model});
        EXPECT_GE(part_within(gl, relight(s, some_lights(), {.model = model}), 1), 0.999) << name_of(model);
    }
    s.reflectance_model = without.reflectance_model = {.diffuse_roughness = 0.6, .second_lobe_weight = 0.3};
    const RelightOptions shadows{.cast_shadows = true, .light_radius_deg = 2};
    const auto gl = by_gl(s, some_lights(), shadows);
    EXPECT_GE(part_within(gl, relight(s, some_lights(), shadows), 1), 0.999);
    EXPECT_LT(part_within(gl, relight(without, some_lights(), shadows), 1), 0.8) << why_it_differs;
}

TEST_F(RendererTest, EqualsTheReferenceInAllModels) {
    const Surface s = painted_surface(150, 170);
    for (const auto& [model, name, label] : kWardModels) {
        RelightOptions options{.model = model, .ambient = 0.05};
        EXPECT_GE(part_within(by_gl(s, some_lights(), options), relight(s, some_lights(), options), 1), 0.999)
            << name_of(model);
    }
}

TEST_F(RendererTest, EqualsTheReferenceWithTheRigOfThePhotographs) {
    Surface s = painted_surface(140, 90);
    s.photography.rig = {
        .ambient = 0.15f, .camera_distance_mm = 30.0f, .camera_axis_mm = {2, -1}, .bend_per_mm = 0.004f};
    const auto gl = by_gl(s, some_lights(), {});
    EXPECT_GE(part_within(gl, relight(s, some_lights(), {}), 1), 0.999);
    s.photography.rig = {};
    EXPECT_LT(part_within(gl, relight(s, some_lights(), {}), 1), 0.5) << "the rig matters here";
}

TEST_F(RendererTest, EqualsTheReferenceUnderUnevenLights) {
    const Surface s = painted_surface(140, 90);
    std::vector<Light> lights = some_lights();
    for (std::size_t i = 0; i < lights.size(); ++i)
        lights[i].beam.terms = {0.02f, i % 2 ? 0.01f : -0.03f, 1e-4f, -2e-4f, -3e-4f};
    const auto gl = by_gl(s, lights, {});
    EXPECT_GE(part_within(gl, relight(s, lights, {}), 1), 0.999);
    EXPECT_LT(part_within(gl, relight(s, some_lights(), {}), 1), 0.5) << "beams matter here";
}

TEST_F(RendererTest, EqualsTheReferenceUnderARoughAndHazyLaw) {
    Surface s = painted_surface(140, 90);
    s.reflectance_model = {.diffuse_roughness = 0.6, .second_lobe_weight = 0.3};
    for (const WardModel model : {WardModel::ward1992, WardModel::bounded}) {
        const auto gl = by_gl(s, some_lights(), {.model = model});
        EXPECT_GE(part_within(gl, relight(s, some_lights(), {.model = model}), 1), 0.999) << name_of(model);
        for (const ReflectanceModel& other :
             {ReflectanceModel{.second_lobe_weight = 0.3}, ReflectanceModel{.diffuse_roughness = 0.6}}) {
            Surface differs = s;
            differs.reflectance_model = other;
            EXPECT_LT(part_within(gl, relight(differs, some_lights(), {.model = model}), 1), 0.95)
                << "both numbers matter here";
        }
    }
}

TEST_F(RendererTest, EqualsTheReferenceWithColouredLobes) {
    const Surface s = gilded_surface(150, 170);
    Surface white = s;
    white.specular_colour = {};
    expect_equals_the_reference(s, white, "colours matter here");
}

TEST_F(RendererTest, EqualsTheReferenceWithLobesThatAreDrawnOut) {
    const Surface s = brushed_surface(150, 170);
    Surface round = s;
    round.lobe_axes = {};
    expect_equals_the_reference(s, round, "stretches matter here");
}

TEST_F(RendererTest, EqualsTheReferenceWithCastShadows) {
    const Surface s = painted_surface(130, 100);
    RelightOptions options{.cast_shadows = true, .light_radius_deg = 2};
    const std::vector<Light> low = {distant_light({-0.9f, 0.2f, 0.25f})};
    const auto reference = relight(s, low, options);
    EXPECT_GE(part_within(by_gl(s, low, options), reference, 1), 0.999);
    options.cast_shadows = false;
    EXPECT_LT(part_within(by_gl(s, low, options), reference, 1), 0.95) << "shadows are seen here";
}

TEST_F(RendererTest, PicturesOfManyTilesAreWhole) {
    const Surface s = painted_surface(2050, 300);
    EXPECT_GE(part_within(by_gl(s, some_lights(), {}), relight(s, some_lights(), {}), 1), 0.999);
    EXPECT_GT(renderer_->cache().resident(), 18);
}

TEST_F(RendererTest, TakesNoMoreLightsThanTheShader) {
    const Surface s = painted_surface(16, 16);
    show(s);
    const std::vector<Light> crowd(kMostLights + 1, distant_light({0, 0, 1}));
    EXPECT_THAT(error_of([&] { relight_with(*renderer_, s, crowd, {}); }), testing::HasSubstr("9 lights"));
}

// A painting seen from afar shines as it does from near.
TEST_F(RendererTest, LevelsOfDetailKeepGloss) {
    Surface s(512, 512);
    s.mm_per_pixel = 0.1;
    Random random(3);
    for (float& z : s.height_mm.pixels()) z = static_cast<float>(random.real(0, 0.03));
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    for (Rgb& c : s.diffuse.pixels()) c = Rgb(0.02f);
    for (float& v : s.specular.pixels()) v = 0.08f;
    for (float& v : s.roughness.pixels()) v = 0.08f;
    show(s);
    double most_without = 0;
    for (const Vec3 direction : {Vec3(0.05f, 0, 1), Vec3(-0.5f, 0.1f, 1), Vec3(0.9f, 0.5f, 1)}) {
        const Scene scene{.lights = {distant_light(direction)}};
        const double near = mean_luminance(drawn(scene, pixel_by_pixel(s)));
        for (const int level : {1, 3, 5}) {
            Shot shot = pixel_by_pixel(s);
            shot.level = level;
            EXPECT_NEAR(mean_luminance(drawn(scene, shot)) / near, 1, 0.12) << "level " << level;
        }
        Surface flat = s;
        for (Vec3& n : flat.normal.pixels()) n = {0, 0, 1};
        most_without =
            std::max(most_without, std::abs(mean_luminance(relight(flat, scene.lights)) / near - 1));
    }
    EXPECT_GT(most_without, 0.4) << "without the spread of the normals in the lobe it would not";
}

TEST_F(RendererTest, UploadsWhatChangedAndNothingElse) {
    Surface s = painted_surface(300, 200);
    show(s);
    EXPECT_GE(part_within(relight_with(*renderer_, s, some_lights(), {}), relight(s, some_lights(), {}), 1),
              0.999);
    const UploadedBytes before = renderer_->uploaded();
    EXPECT_EQ(before.tiles, 4 * kTileTexels * sizeof(Texel)) << "two tiles of pixels, two that stand in";
    const Region spot{130, 60, 150, 80};
    for (int y = spot.y0; y < spot.y1; ++y)
        for (int x = spot.x0; x < spot.x1; ++x) s.diffuse(x, y) = {0.9f, 0.1f, 0.1f};
    tiles_->update(s, spot);
    renderer_->upload(spot);
    EXPECT_EQ(renderer_->uploaded().changes, (20u * 20 + 6 * 5 + 1 * 2) * sizeof(Texel))
        << "in the three levels that are there";
    EXPECT_GE(part_within(relight_with(*renderer_, s, some_lights(), {}), relight(s, some_lights(), {}), 1),
              0.999);
    EXPECT_EQ(renderer_->uploaded().tiles, before.tiles) << "they were there";
    // Levels of detail, too: as those of a surface that is packed anew.
    const TexelTiles anew(s, tiles_->range());
    for (const TileName& tile : {TileName{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {5, 0, 0}})
        EXPECT_TRUE(std::ranges::equal(anew.tile(tile), tiles_->tile(tile))) << tile.level;
}

// A part of a picture that is seen from straight ahead, `zoom` pixels for one of the painting.
Shot part(const glm::dvec2& corner, Extent size, double zoom = 1) {
    Shot shot{.width = size.width, .height = size.height};
    const auto step = static_cast<float>(1 / zoom);
    shot.to_painting = glm::mat3(Vec3(step, 0, 0), Vec3(0, -step, 0),
                                 Vec3(static_cast<float>(corner.x) - 0.5f,
                                      static_cast<float>(corner.y + size.height / zoom) - 0.5f, 1));
    shot.level = std::max(0, static_cast<int>(std::lround(-std::log2(zoom))));
    return shot;
}

TEST_F(RendererTest, DrawsMoreThanTheDeviceHolds) {
    const Surface s = painted_surface(1500, 1100);
    renderer_.emplace(std::size_t(20) << 20);
    show(s);
    EXPECT_EQ(renderer_->cache().layers(), 20);
    EXPECT_GT(renderer_->cache().all(), 40);
    const auto reference = relight(s, some_lights(), {});
    EXPECT_GE(part_within(relight_with(*renderer_, s, some_lights(), {}), reference, 1), 0.999);
    // Panned over, and back.
    const Scene scene{.lights = some_lights()};
    for (const glm::ivec2 at : {glm::ivec2(0, 0), {700, 300}, {1100, 700}, {700, 300}, {0, 0}}) {
        const Shot shot = part(at, {400, 400});
        EXPECT_TRUE(renderer_->fetch(scene, shot).exact);
        Image<Rgb> crop(400, 400);
        for (int y = 0; y < 400; ++y)
            for (int x = 0; x < 400; ++x) crop(x, y) = reference(at.x + x, at.y + y);
        EXPECT_GE(part_within(drawn(scene, shot), crop, 1), 0.999) << at.x;
        EXPECT_LE(renderer_->cache().resident(), 20);
    }
    // All of it at once does not fit: coarser then, and not black or broken.
    EXPECT_FALSE(renderer_->fetch(scene, pixel_by_pixel(s)).exact);
    EXPECT_NEAR(mean_luminance(drawn(scene, pixel_by_pixel(s))) / mean_luminance(reference), 1, 0.1);
    EXPECT_THAT(error_of([&] { relight_with(*renderer_, s, some_lights(), {.cast_shadows = true}); }),
                testing::HasSubstr("cast shadows on a painting of 1500 x 1100 pixels need"));
}

// Colour that runs evenly over the painting runs evenly over the picture: at the borders of tiles, too, at
// any zoom, and where some tiles are not there yet.
TEST_F(RendererTest, HasNoSeams) {
    Surface s(1100, 600);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            s.diffuse(x, y) = Rgb(0.2f + 0.0004f * static_cast<float>(x) + 0.0004f * static_cast<float>(y));
            s.confidence(x, y) = 1;
        }
    show(s);
    const Scene scene{.lights = {distant_light({0, 0, 1})}};
    for (const double zoom : {0.27, 0.83, 1.0, 1.7}) {
        Shot shot = part({200, 100}, {static_cast<int>(500 * zoom), static_cast<int>(450 * zoom)}, zoom);
        shot.smooth = true;
        const double step = 0.0004 / zoom + 0.0012;  // and rounding of 11 bits
        renderer_->set_painting(tiles_, s.mm_per_pixel);
        for (bool complete = false; !complete;) {
            complete = renderer_->fetch(scene, shot, 1).complete;
            const gl::Target target(shot.width, shot.height, true);
            renderer_->draw(scene, shot, target.framebuffer(), true);
            const Image<Rgb> picture = renderer_->read(target);
            const double most = complete ? step : step + 129 * 0.0004;  // the coarsest texels have 128 pixels
            float worst = 0;
            for (int y = 1; y < picture.height(); ++y)
                for (int x = 1; x < picture.width(); ++x)
                    worst = std::max({worst, std::abs(picture(x, y).g - picture(x - 1, y).g),
                                      std::abs(picture(x, y).g - picture(x, y - 1).g)});
            ASSERT_LT(worst, most) << zoom;
        }
    }
}

// Wherever the painting lies on the picture, in every encoding: it is whole, and beside it is background.
TEST_F(RendererTest, ThePaintingIsWholeWhereverItLies) {
    constexpr Extent kPainting{90, 60}, kSmallScreen{160, 120};
    Surface s(kPainting.width, kPainting.height);
    for (Rgb& c : s.diffuse.pixels()) c = Rgb(0.8f);
    show(s);
    const Scene scene{.lights = {distant_light({0, 0, 1})}, .ambient = 1, .background = {0.1f, 0.2f, 0.05f}};
    const gl::Target bytes(kSmallScreen.width, kSmallScreen.height, false);
    for (const View& view : {View{{45, 30}, 1.2, 0}, View{{45, 30}, 1.2, 33}, View{{5, 70}, 2, 0},
                             View{{45, 30}, 9, 0}, View{{400, 30}, 1, 0}})
        for (const glm::dvec2 tilt_deg : {glm::dvec2(0, 0), glm::dvec2(50, 0), glm::dvec2(-70, 60)}) {
            const Placement placement(view, {{.angle_deg = tilt_deg}}, kPainting, kSmallScreen,
                                      s.mm_per_pixel);
            const Shot shot = placement.shot(1, false);
            const Image<Rgb> linear = drawn(scene, shot), encoded = drawn(scene, shot, false);
            renderer_->draw(scene, shot, bytes.framebuffer());
            const Image<Rgb> by_device = renderer_->read(bytes);
            const Rgb beside = Transfer{Transfer::Kind::srgb}.encode(scene.background);
            for (int y = 0; y < kSmallScreen.height; ++y)
                for (int x = 0; x < kSmallScreen.width; ++x) {
                    glm::dvec2 at;
                    const bool hit = placement.to_painting({x + 0.5, y + 0.5}, at);
                    const double rim = std::max({-0.5 - at.x, -0.5 - at.y, at.x - 89.5, at.y - 59.5});
                    if (hit && std::abs(rim) < 0.01) continue;  // rounding decides
                    if (hit && rim < 0) {
                        ASSERT_GT(linear(x, y).b, 0.5f)
                            << x << ' ' << y << ' ' << view.zoom << ' ' << tilt_deg.x;
                    } else {
                        ASSERT_EQ(linear(x, y), scene.background) << x << ' ' << y;
                        ASSERT_LT(glm::distance(encoded(x, y), beside), 1.0f / 255);
                        ASSERT_LT(glm::distance(by_device(x, y), beside), 1.5f / 255);
                    }
                }
        }
}

TEST_F(RendererTest, ShadowsFromHorizonsAreNearThoseMarched) {
    const Surface s = painted_surface(200, 160, 5);
    show(s);
    renderer_->set_horizon(horizon_map(coarse_heights(s.height_mm, s.mm_per_pixel)));
    for (const float azimuth : {0.0f, 0.6f, 2.0f, 4.1f}) {
        const Light low = distant_light({std::cos(azimuth), std::sin(azimuth), 0.35f});
        Scene scene{.lights = {low}, .shadows = Shadows::horizon, .light_radius_deg = 3};
        const auto fast = drawn(scene, pixel_by_pixel(s));
        scene.shadows = Shadows::marched;
        const auto exact = drawn(scene, pixel_by_pixel(s));
        scene.shadows = Shadows::none;
        const auto without = drawn(scene, pixel_by_pixel(s));
        EXPECT_GT(part_within(fast, exact, 25), 0.85) << azimuth;
        EXPECT_LT(part_within(without, exact, 25), part_within(fast, exact, 25) - 0.05) << azimuth;
        EXPECT_NEAR(mean_luminance(fast) / mean_luminance(exact), 1, 0.06) << azimuth;
    }
}

// Far lights have one direction everywhere, and a map of their own of it; beside a near one, each pixel looks
// its direction up in the whole map.
TEST_F(RendererTest, BothWaysToLookHorizonsUpAgree) {
    Surface s = painted_surface(120, 100);
    show(s);
    renderer_->set_horizon(horizon_map(coarse_heights(s.height_mm, s.mm_per_pixel)));
    for (const float azimuth : {0.0f, 0.9f, 3.1f, -0.01f}) {
        const Light low = distant_light({std::cos(azimuth), std::sin(azimuth), 0.35f});
        const Light other = distant_light({std::sin(azimuth), -std::cos(azimuth), 0.3f});
        Light dark = near_light({0, 0, 50});
        dark.gain = Rgb(0);
        Scene scene{.lights = {low, other}, .shadows = Shadows::horizon, .light_radius_deg = 4};
        const auto own = drawn(scene, pixel_by_pixel(s));
        scene.lights.push_back(dark);
        const auto looked_up = drawn(scene, pixel_by_pixel(s));
        // Samplers of three dimensions may mix with weights of 8 bits: 0.035 of a penumbra this wide.
        EXPECT_GE(part_within(own, looked_up, 9), 0.995) << azimuth;
        scene.shadows = Shadows::none;
        EXPECT_LT(part_within(own, drawn(scene, pixel_by_pixel(s)), 9), 0.9) << "there are shadows";
    }
}

TEST_F(RendererTest, TheDeviceEncodesAsTheShaderDoes) {
    const Surface s = painted_surface(150, 120);
    show(s);
    const Scene scene{.lights = some_lights(), .shoulder = 0.15f};
    const Shot shot = pixel_by_pixel(s);
    const gl::Target bytes(shot.width, shot.height, false);
    renderer_->fetch(scene, shot);
    renderer_->draw(scene, shot, bytes.framebuffer());
    const Image<Rgb> by_device = renderer_->read(bytes), by_shader = drawn(scene, shot, false);
    std::size_t good = 0;
    for (std::size_t i = 0; i < by_device.size(); ++i) {
        const Rgb off = glm::abs(by_device.pixels()[i] - by_shader.pixels()[i]);
        good += std::max({off.r, off.g, off.b}) <= 1.0f / 255;
    }
    EXPECT_GE(static_cast<double>(good) / static_cast<double>(by_device.size()), 0.999);
}

TEST_F(RendererTest, AgreesWithThePictureOfASceneOnTheProcessor) {
    const Surface s = painted_surface(150, 120);
    show(s);
    Scene scene{.lights = some_lights(), .ambient = 0.05, .exposure = glm::mat3(1.4f), .shoulder = 0.15f};
    const Image<Rgb> by_gl = drawn(scene, pixel_by_pixel(s), false), by_cpu = scene_picture(s, scene);
    std::size_t good = 0;
    for (std::size_t i = 0; i < by_gl.size(); ++i) {
        const Rgb off = glm::abs(by_gl.pixels()[i] - by_cpu.pixels()[i]);
        good += std::max({off.r, off.g, off.b}) <= 1.0f / 255;
    }
    EXPECT_GE(static_cast<double>(good) / static_cast<double>(by_gl.size()), 0.999);
}

// Where texels' centres are hit, what lies between them has no weight.
TEST_F(RendererTest, SmoothAndNearestAgreeAtCentres) {
    const Surface s = painted_surface(64, 64);
    show(s);
    const Scene scene{.lights = {distant_light({-0.5f, 0.5f, 0.7f})}};
    Shot shot = pixel_by_pixel(s);
    const auto nearest = drawn(scene, shot);
    shot.smooth = true;
    EXPECT_GT(part_within(drawn(scene, shot), nearest, 0.5), 0.999);
}

TEST_F(RendererTest, ExtremeGlossGivesNumbers) {
    Surface s = painted_surface(32, 32);
    for (float& v : s.roughness.pixels()) v = 1e-4f;
    const auto picture = by_gl(s, {distant_light({0, 0, 1}), distant_light({0.999f, 0, 0.02f})}, {});
    for (const Rgb& c : picture.pixels())
        ASSERT_TRUE(std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b) && c.r >= 0);
}

}  // namespace
}  // namespace tangi
