// relight_test.cpp: the laws of the reference renderer: linear in the lights, symmetric, finite.
#include "surface/render/relight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surface/base/parallel.h"
#include "tests/support/surface/reflectance_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A surface with relief and paints of all kinds.
Surface bumpy(int width, int height, std::uint64_t seed = 1) {
    Random random(seed);
    Surface s(width, height);
    s.mm_per_pixel = 0.1;
    for (float& z : s.height_mm.pixels()) z = random.real(0, 0.2);
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    for (Rgb& c : s.diffuse.pixels())
        c = {random.real(0.1, 0.9), random.real(0.1, 0.9), random.real(0.1, 0.9)};
    for (float& v : s.specular.pixels()) v = random.real(0, 0.1);
    for (float& v : s.roughness.pixels()) v = random.real(0.1, 0.5);
    for (float& v : s.confidence.pixels()) v = 1;
    return s;
}

Surface matt_white(int width, int height) {
    Surface s(width, height);
    for (Rgb& c : s.diffuse.pixels()) c = Rgb(1);
    return s;
}

Light lit_from(const Vec3& direction, const Rgb& gain = Rgb(1)) {
    Light light = distant_light(direction);
    light.gain = gain;
    return light;
}

Image<Rgb> sum(const Image<Rgb>& a, const Image<Rgb>& b) {
    Image<Rgb> result = a;
    for (std::size_t i = 0; i < a.size(); ++i) result.pixels()[i] += b.pixels()[i];
    return result;
}

// Turns a picture by 90 degrees against the clock: what was at the right comes to the top.
template <class T>
Image<T> turned(const Image<T>& image) {
    Image<T> result(image.height(), image.width());
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) result(y, image.width() - 1 - x) = image(x, y);
    return result;
}

template <class T>
Image<T> mirrored(const Image<T>& image) {
    Image<T> result(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) result(image.width() - 1 - x, y) = image(x, y);
    return result;
}

Vec3 turned(const Vec3& v) { return {-v.y, v.x, v.z}; }
Vec3 mirrored(const Vec3& v) { return {-v.x, v.y, v.z}; }

template <class Change>
Surface changed(const Surface& s, Change&& change) {
    Surface t = s;
    t.height_mm = change(s.height_mm);
    t.normal = change(s.normal);
    for (Vec3& n : t.normal.pixels()) n = change(n);
    t.diffuse = change(s.diffuse);
    t.specular = change(s.specular);
    t.roughness = change(s.roughness);
    t.confidence = change(s.confidence);
    return t;
}

TEST(Relight, ShowsAMattWhiteThatFacesTheLightAsOne) {
    const Light light = lit_from({0, 0, 1});
    EXPECT_TRUE(images_near(relight(matt_white(4, 3), {{light}}), Image<Rgb>(4, 3, Rgb(1)), 1e-6));
}

TEST(Relight, FollowsTheCosineOfAMattSurface) {
    const Light light = lit_from({std::sin(1.0f), 0, std::cos(1.0f)}, {1, 2, 0.5f});
    const Rgb expected = std::cos(1.0f) * light.gain;
    EXPECT_TRUE(images_near(relight(matt_white(3, 3), {{light}}), Image<Rgb>(3, 3, expected), 1e-6));
}

TEST(Relight, AddsPiTimesTheLobeOfASmoothSurface) {
    Surface s = matt_white(1, 1);
    s.specular(0, 0) = 0.05f;
    s.roughness(0, 0) = 0.2f;
    // Facing the light the lobe is 1 / (4 pi alpha^2) in all models: 1 + pi 0.05 / (4 pi 0.04).
    for (const WardModel model : kModels)
        EXPECT_NEAR(relight(s, {{lit_from({0, 0, 1})}}, {.model = model})(0, 0).g, 1 + 0.05 / 0.16, 1e-5)
            << name_of(model);
}

TEST(Relight, IsLinearInTheLights) {
    const Surface s = bumpy(24, 17);
    Light near = near_light({3, 2, 5});
    near.gain = {0.3f, 0.2f, 0.1f};
    const Light a = lit_from({1, 0.5f, 0.6f}, {0.5f, 1, 2}), b = near;
    for (const bool cast_shadows : {false, true}) {
        const RelightOptions options{.cast_shadows = cast_shadows};
        const Image<Rgb> together = relight(s, {{a, b}}, options);
        // Each picture is a float sum of numbers up to about 10.
        EXPECT_TRUE(images_near(together, sum(relight(s, {{a}}, options), relight(s, {{b}}, options)), 1e-5));
        Light twice = a;
        twice.gain *= 2;
        const Image<Rgb> single = relight(s, {{a}}, options);
        EXPECT_TRUE(images_near(relight(s, {{twice}}, options), sum(single, single), 1e-5));
    }
}

TEST(Relight, WithoutLightsShowsTheAmbientOnly) {
    const Surface s = bumpy(5, 4);
    EXPECT_TRUE(images_near(relight(s, {}), Image<Rgb>(5, 4, Rgb(0)), 0));
    Image<Rgb> expected = s.diffuse;
    for (Rgb& c : expected.pixels()) c *= 0.25f;
    EXPECT_TRUE(images_near(relight(s, {}, {.ambient = 0.25}), expected, 1e-7));
    const Light light = lit_from({1, 1, 1});
    EXPECT_TRUE(
        images_near(relight(s, {{light}}, {.ambient = 0.25}), sum(relight(s, {{light}}), expected), 1e-5));
}

TEST(Relight, IsDarkWhereTheSurfaceTurnsAway) {
    Surface s = matt_white(1, 1);
    s.specular(0, 0) = 0.1f;
    s.normal(0, 0) = glm::normalize(Vec3(1, 0, 0.5f));
    EXPECT_EQ(relight(s, {{lit_from({-1, 0, 0.4f})}})(0, 0), Rgb(0));
}

TEST(Relight, OfATurnedSceneIsTheTurnedPicture) {
    const Surface s = bumpy(19, 12);
    const auto turn = [](const auto& x) { return turned(x); };
    for (const bool cast_shadows : {false, true}) {
        const RelightOptions options{.cast_shadows = cast_shadows, .light_radius_deg = 5};
        for (const Vec3& l : {Vec3(1, 0, 0.5f), Vec3(0.3f, -0.8f, 0.4f), Vec3(0, 0, 1)}) {
            // Roundings of the marching, 1e-6 of the tangent, cross a penumbra of 5 degrees: 1e-4 at most.
            EXPECT_TRUE(images_near(relight(changed(s, turn), {{lit_from(turned(l))}}, options),
                                    turned(relight(s, {{lit_from(l)}}, options)), 2e-4));
            EXPECT_TRUE(images_near(relight(changed(s, turn), {{near_light(turned(2.0f * l))}}, options),
                                    turned(relight(s, {{near_light(2.0f * l)}}, options)), 2e-4));
        }
    }
}

TEST(Relight, OfAMirroredSceneIsTheMirroredPicture) {
    const Surface s = bumpy(19, 12);
    const auto mirror = [](const auto& x) { return mirrored(x); };
    for (const bool cast_shadows : {false, true}) {
        const RelightOptions options{.cast_shadows = cast_shadows, .light_radius_deg = 5};
        for (const Vec3& l : {Vec3(1, 0, 0.5f), Vec3(0.3f, -0.8f, 0.4f)})
            EXPECT_TRUE(images_near(relight(changed(s, mirror), {{lit_from(mirrored(l))}}, options),
                                    mirrored(relight(s, {{lit_from(l)}}, options)), 2e-4));
    }
}

TEST(Relight, GivesTheSameBitsOnAnyNumberOfThreads) {
    const Surface s = bumpy(150, 130);
    const std::vector<Light> lights = {lit_from({1, 0.2f, 0.3f}), near_light({2, -3, 4})};
    const RelightOptions options{.cast_shadows = true, .light_radius_deg = 2, .ambient = 0.1};
    set_thread_count(1);
    const Image<Rgb> alone = relight(s, lights, options);
    set_thread_count(2);
    const Image<Rgb> together = relight(s, lights, options);
    set_thread_count(0);
    EXPECT_TRUE(images_identical(alone, together));
}

TEST(Relight, IsFiniteForEveryParameterOfTheThesis) {
    Random random(5);
    Surface s(64, 64);
    for (std::size_t i = 0; i < s.normal.size(); ++i) {
        s.normal.pixels()[i] = random.direction(0.01);
        s.diffuse.pixels()[i] = Rgb(random.real(0, 1));
        s.specular.pixels()[i] = i % 5 ? random.real(0, 0.1) : 0;
        s.roughness.pixels()[i] = std::pow(10.0f, random.real(-4, 0));
        s.height_mm.pixels()[i] = i % 7 ? random.real(-1, 1) : 1000;
    }
    std::vector<Light> lights;
    for (int i = 0; i < 40; ++i) lights.push_back(lit_from(random.direction(-0.2)));
    for (const Vec3& l : {Vec3(1, 0, 0), Vec3(0, 1, 1e-6f), Vec3(1e-6f, 0, 1), Vec3(0, 0, -1)})
        lights.push_back(lit_from(l));
    for (int i = 0; i < 20; ++i) lights.push_back(near_light(random.direction(0.1) * random.real(0.1, 1000)));
    for (const WardModel model : kModels)
        for (const double radius : {0.0, 1e-6, 0.25, 45.0}) {
            const Image<Rgb> picture =
                relight(s, lights, {.model = model, .cast_shadows = true, .light_radius_deg = radius});
            for (const Rgb& c : picture.pixels())
                ASSERT_TRUE(std::isfinite(c.r) && c.r >= 0) << name_of(model) << ", radius " << radius;
        }
}

TEST(Relight, RefusesOptionsOutsideTheirRange) {
    EXPECT_EQ(error_of([] { relight(matt_white(2, 2), {}, {.ambient = 2}); }),
              "relight.ambient = 2 is outside [0, 1]");
    EXPECT_EQ(error_of([] { relight(matt_white(2, 2), {}, {.light_radius_deg = -1}); }),
              "relight.light_radius_deg = -1 is outside [0, 45] deg");
}

TEST(Relight, StopsWhenAsked) {
    const Light light = lit_from({0, 0, 1});
    EXPECT_THROW(relight(matt_white(2, 2), {{light}}, {}, [](auto, double) { return false; }), Cancelled);
}

}  // namespace
}  // namespace tangi
