// viewer_renderer_test.cpp: OpenGL draws what the reference renderer computes, near and from afar.
#include "viewer/renderer.h"

#include "surface/parallel.h"
#include "viewer_support.h"

namespace tangi {
namespace {

class RendererTest : public Drawing {
protected:
    Image<Rgb> by_gl(const Surface& s, const std::vector<Light>& lights, const RelightOptions& options) {
        show(s);
        return relight_with(*renderer_, s, lights, options);
    }
};

std::vector<Light> some_lights() {
    Light warm = distant_light({-0.8f, 0.3f, 0.5f});
    warm.gain = {1.1f, 0.9f, 0.7f};
    Light lamp = near_light({12, 9, 20});
    lamp.gain = Rgb(0.4f);
    return {warm, lamp, distant_light({0.2f, -0.9f, 0.25f})};
}

TEST_F(RendererTest, EqualsTheReferenceInAllModels) {
    const Surface s = painted_surface(150, 170);
    for (const WardModel model : {WardModel::ward1992, WardModel::duer, WardModel::bounded}) {
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

TEST_F(RendererTest, EqualsTheReferenceUnderARoughAndHazyLaw) {
    Surface s = painted_surface(140, 90);
    s.law = {.diffuse_roughness = 0.6, .haze = 0.3};
    for (const WardModel model : {WardModel::ward1992, WardModel::bounded}) {
        const auto gl = by_gl(s, some_lights(), {.model = model});
        EXPECT_GE(part_within(gl, relight(s, some_lights(), {.model = model}), 1), 0.999) << name_of(model);
        for (const ReflectanceLaw& other :
             {ReflectanceLaw{.haze = 0.3}, ReflectanceLaw{.diffuse_roughness = 0.6}}) {
            Surface differs = s;
            differs.law = other;
            EXPECT_LT(part_within(gl, relight(differs, some_lights(), {.model = model}), 1), 0.95)
                << "both numbers matter here";
        }
    }
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
    EXPECT_GT(tile_bits_for(2050, 300, 2048), 6);
    EXPECT_GE(part_within(by_gl(s, some_lights(), {}), relight(s, some_lights(), {}), 1), 0.999);
    EXPECT_GT(tiles_.count(), 8);
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
    const std::size_t before = renderer_->uploaded_bytes();
    const Region spot{130, 60, 150, 80};
    for (int y = spot.y0; y < spot.y1; ++y)
        for (int x = spot.x0; x < spot.x1; ++x) s.diffuse(x, y) = {0.9f, 0.1f, 0.1f};
    tiles_.update(s, spot);
    for (const TexelPatch& patch : patches_of(tiles_, spot)) renderer_->upload(patch);
    const auto bytes = renderer_->uploaded_bytes() - before;
    EXPECT_GE(bytes, 20u * 20u * sizeof(Texel));
    EXPECT_LE(bytes, 20u * 20u * sizeof(Texel) * 2);
    EXPECT_GE(part_within(relight_with(*renderer_, s, some_lights(), {}), relight(s, some_lights(), {}), 1),
              0.999);
    // Levels of detail, too: as those of a surface that is packed anew.
    const TexelTiles anew(s, tiles_.range(), tiles_.tile_bits());
    for (int level = 0; level <= anew.tile_bits(); ++level)
        for (int tile = 0; tile < anew.count(); ++tile)
            EXPECT_TRUE(std::ranges::equal(anew.level(tile, level), tiles_.level(tile, level))) << level;
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

TEST_F(RendererTest, EveryWayToLookGivesAPictureOfItsOwn) {
    const Surface s = painted_surface(64, 64);
    show(s);
    std::vector<Image<Rgb>> pictures;
    for (const LookName& look : kLooks) {
        Scene scene{.lights = {distant_light({-0.5f, 0.5f, 0.7f})}, .mode = look.mode};
        if (look.mode == LookMode::unsharp_normals) scene.sharpness = 3;
        if (look.mode == LookMode::diffuse_gain) scene.strength = 2.5f;
        const auto picture = drawn(scene, pixel_by_pixel(s), false);
        for (const Rgb& c : picture.pixels())
            ASSERT_TRUE(c.r >= 0 && c.r <= 1 && c.g >= 0 && c.g <= 1 && c.b >= 0 && c.b <= 1) << look.name;
        for (const auto& other : pictures) EXPECT_LT(part_within(picture, other, 2), 0.9) << look.name;
        pictures.push_back(picture);
    }
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
