#include "fit/exchange/import_maps.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "fit/exchange/export_maps.h"
#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"
#include "tests/support/fit/fit_test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A wavy surface, of which one corner was not measured.
Surface example_surface() {
    Surface s(48, 40);
    s.mm_per_pixel = 0.5;
    s.scale_known = true;
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            s.height_mm(x, y) =
                0.4f * std::sin(0.4f * static_cast<float>(x)) * std::cos(0.3f * static_cast<float>(y));
            s.diffuse(x, y) = Rgb(0.2f + 0.01f * static_cast<float>(x), 0.5f, 0.7f);
            s.specular(x, y) = 0.1f;
            s.roughness(x, y) = 0.1f + 0.01f * static_cast<float>(y);
            s.confidence(x, y) = 1;
        }
    subtract(best_plane(s.height_mm, s.confidence), s.height_mm);
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    return s;
}

TEST(ImportMaps, ExportedMapsComeBack) {
    const TestDir dir;
    const Surface s = example_surface();
    EXPECT_EQ(write_maps(dir.path(), s).size(), 7u);
    ImportReport report;
    const Surface back = import_maps(find_maps(dir.path()), {.mm_per_pixel = 0.5}, report);
    EXPECT_EQ(report.measured, 48 * 40);
    EXPECT_TRUE(back.scale_known);
    EXPECT_TRUE(images_near(back.height_mm, s.height_mm, 1e-5));
    EXPECT_TRUE(images_near(back.normal, s.normal, 1e-5));
    EXPECT_TRUE(images_near(back.diffuse, s.diffuse, 1e-6));
    EXPECT_TRUE(images_near(back.specular, s.specular, 1e-6));
    EXPECT_TRUE(images_near(back.roughness, s.roughness, 1e-6));
}

TEST(ImportMaps, ColoursOfLobesComeBack) {
    const TestDir dir;
    Surface s = example_surface();
    s.specular_colour = Image<Rgb>(s.width(), s.height(), Rgb(1, 0.77f, 0.34f));
    EXPECT_EQ(write_maps(dir.path(), s).size(), 8u);
    ImportReport report;
    EXPECT_TRUE(
        images_identical(import_maps(find_maps(dir.path()), {}, report).specular_colour, s.specular_colour));
    write_openlime(dir / "openlime", s);
    const Rgb ks = read_picture(dir / "openlime" / "ks.png")(3, 3),
              expected = s.specular(3, 3) * s.specular_colour(3, 3);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ks[c], expected[c], 0.5 / 255 + 1e-6);
}

TEST(ImportMaps, AxesOfLobesComeBack) {
    const TestDir dir;
    Surface s = example_surface();
    s.lobe_axes = Image<LobeAxes>(s.width(), s.height(), {0.05f, -0.7f});
    EXPECT_EQ(write_maps(dir.path(), s).size(), 9u);
    ImportReport report;
    const Surface back = import_maps(find_maps(dir.path()), {}, report);
    ASSERT_EQ(back.lobe_axes.region(), s.lobe_axes.region());
    EXPECT_EQ(back.lobe_axes(3, 3), s.lobe_axes(3, 3));
    std::filesystem::remove(dir / "tangent.exr");
    EXPECT_THAT(
        error_of([&] { import_maps(find_maps(dir.path()), {}, report); }),
        testing::AllOf(testing::HasSubstr("roughness_v.exr"), testing::HasSubstr("tangent is missing")));
}

// With everything that a surface can have of reflectance, a corner that was not measured, and a height that
// is tilted, as that of a painting with much paint on one side.
TEST(ImportMaps, WhatComesBackLooksAlikeUnderEveryLight) {
    const TestDir dir;
    for (const bool scale_known : {true, false}) {
        Surface s = example_surface();
        s.reflectance_model = {.diffuse_roughness = 0.7, .second_lobe_weight = 0.6};
        s.scale_known = scale_known;
        s.photography.white_level = 0.4;
        s.photography.rig = {.ambient = 0.1f, .camera_distance_mm = 40.0f};
        s.lobe_axes = Image<LobeAxes>(s.width(), s.height(), {0.05f, -0.7f});
        s.specular_colour = Image<Rgb>(s.width(), s.height(), Rgb(1, 0.77f, 0.34f));
        for (int y = 0; y < s.height(); ++y)
            for (int x = 0; x < s.width(); ++x) s.height_mm(x, y) += 0.05f * static_cast<float>(x);
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 5; ++x) {
                s.confidence(x, y) = s.specular(x, y) = 0;
                s.normal(x, y) = Vec3(0, 0, 1);
                s.diffuse(x, y) = Rgb(0);
            }
        write_maps(dir.path(), s);
        ImportReport report;
        const Surface back = import_maps(find_maps(dir.path()), as_described(dir.path(), {}), report);
        EXPECT_EQ(report.measured, 48 * 40 - 25);
        EXPECT_EQ(back.reflectance_model, s.reflectance_model);
        EXPECT_EQ(back.scale_known, scale_known);
        EXPECT_EQ(back.photography.white_level, 0.4);
        EXPECT_EQ(back.mm_per_pixel, 0.5);
        EXPECT_TRUE(images_near(back.height_mm, s.height_mm, 1e-6));
        EXPECT_TRUE(images_identical(back.confidence, s.confidence));
        for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(-1, 0.3f, 0.4f), Vec3(0.5f, 0.6f, 0.2f)}) {
            const std::array lights = {distant_light(direction)};
            EXPECT_TRUE(images_near(relight(back, lights, {.cast_shadows = true}),
                                    relight(s, lights, {.cast_shadows = true}), 1e-4));
        }
    }
    const ImportOptions own = as_described(dir.path(), {.mm_per_pixel = 2, .second_lobe_weight = 0});
    EXPECT_EQ(own.mm_per_pixel, 2);
    EXPECT_TRUE(own.scale_known);
    EXPECT_EQ(own.second_lobe_weight, 0);
    write_text_file(dir / "maps.json", "{\"scale_known\": false, \"photography\": 7}");
    EXPECT_THAT(error_of([&] { as_described(dir.path(), {}); }), HasSubstr("maps.json"));
    write_text_file(dir / "maps.json", "{\"second_lobe_weight\": 0.5}");  // of another program
    EXPECT_FALSE(as_described(dir.path(), {}).second_lobe_weight);
    for (const auto& [text, named] :
         {std::pair("{", "not JSON"),
          std::pair("{\"scale_known\": true, \"second_lobe_weight\": 7}", "second_lobe_weight = 7"),
          std::pair("{\"scale_known\": true, \"mm_per_pixel\": -3}", "mm_per_pixel = -3"),
          std::pair("{\"scale_known\": true, \"second_lobe_weight\": \"x\"}",
                    "second_lobe_weight = \"x\"")}) {
        write_text_file(dir / "maps.json", text);
        EXPECT_THAT(error_of([&] { as_described(dir.path(), {}); }), HasSubstr("maps.json: ")) << text;
        EXPECT_THAT(error_of([&] { as_described(dir.path(), {}); }), HasSubstr(named)) << text;
    }
    fs::remove(dir / "maps.json");
    for (const char* text : {"junk", "{\"alphaLimits\": \"x\"}", "{\"alphaLimits\": [0.7, 0.1]}",
                             "{\"alphaLimits\": [0.1, 7]}"}) {
        write_text_file(dir / "brdf.json", text);
        EXPECT_THAT(error_of([&] { as_described(dir.path(), {}); }), HasSubstr("brdf.json: ")) << text;
    }
}

TEST(ImportMaps, ValuesThatAreNoneOfTheMapAreTold) {
    const TestDir dir;
    Surface s = example_surface();
    for (float& specular : s.specular.pixels()) specular *= 100;
    for (float& roughness : s.roughness.pixels()) roughness = 0;
    write_maps(dir.path(), s);
    ImportReport report;
    import_maps(find_maps(dir.path()), as_described(dir.path(), {}), report);
    EXPECT_THAT(report.warnings,
                testing::Contains(testing::AllOf(HasSubstr("specular.exr: "), HasSubstr("outside 0 to 1"))));
    EXPECT_THAT(report.warnings,
                testing::Contains(testing::AllOf(HasSubstr("roughness.exr: "), HasSubstr("a mirror's"))));
}

TEST(ImportMaps, HeightIsIntegratedFromNormals) {
    const TestDir dir;
    const Surface s = example_surface();
    write_maps(dir.path(), s);
    fs::remove(dir / "height.exr");
    ImportReport report;
    const Surface back = import_maps(find_maps(dir.path()), {.mm_per_pixel = 0.5}, report);
    EXPECT_TRUE(report.height.converged);
    EXPECT_LT(rms_difference(back.height_mm, s.height_mm), 0.03 * 0.4);
    EXPECT_TRUE(images_near(back.normal, s.normal, 1e-5));
}

// Relief in a flat frame. Its slopes are no gradient: each goes with a wave of its own. As a JPEG, blocks of
// 16 pixels have slopes of their own besides.
TEST(ImportMaps, SlopesThatAreNoGradientLeaveAFlatFrameWithoutSteps) {
    const TestDir dir;
    constexpr int kWhole = 288, kFrame = 80;
    Image<Rgb> normals(kWhole, kWhole);
    Random random(5);
    for (int y = 0; y < kWhole; ++y)
        for (int x = 0; x < kWhole; ++x) {
            const bool relief = std::min({x, y, kWhole - 1 - x, kWhole - 1 - y}) >= kFrame;
            const auto u = static_cast<float>(x), v = static_cast<float>(y);
            const Slope s =
                relief ? Slope{std::sin(0.31f * v + 0.1f * u) + 0.3f * static_cast<float>(random.normal()),
                               std::sin(0.27f * u) + 0.3f * static_cast<float>(random.normal())}
                       : Slope{0.008f * std::sin(0.05f * v), 0.008f * std::sin(0.05f * u)};
            normals(x, y) = 0.5f * normal_of(s) + 0.5f;
        }
    write_picture(dir / "normal.jpg", normals, Transfer{});
    write_picture(dir / "kd.png", Image<Rgb>(kWhole, kWhole, Rgb(0.5f)), Transfer{});
    ImportReport report;
    const Surface s = import_maps(find_maps(dir.path()), {}, report);
    float step = 0;
    for (int y = 0; y < kFrame - 16; ++y)
        for (int x = 1; x < kWhole; ++x)
            step = std::max(step, std::abs(s.height_mm(x, y) - s.height_mm(x - 1, y)));
    std::cout << fmt::format(
        "[  FIGURE  ] a flat frame around slopes that are no gradient: steps of {:.3f} px at most, {} "
        "cycles, residual {}\n",
        step, report.height.cycles, report.height.residual);
    EXPECT_TRUE(report.height.converged);
    EXPECT_LT(step, 0.1);
}

TEST(ImportMaps, OpenLimeMapsComeBackToEightBits) {
    const TestDir dir;
    Surface s = example_surface();
    s.confidence(3, 2) = 0;
    write_openlime(dir.path(), s);
    const auto brdf = read_json(read_text_file(dir / "brdf.json"), "JSON");
    EXPECT_NEAR(brdf["alphaLimits"][0].get<double>(), 0.1, 1e-6);
    EXPECT_NEAR(brdf["alphaLimits"][1].get<double>(), 0.49, 1e-6);
    EXPECT_EQ(brdf["colorspaces"]["kd"], "srgb");
    ImportReport report;
    // The file says how they are to be read, unless somebody else does.
    const Surface back = import_maps(find_maps(dir.path()), as_described(dir.path(), {}), report);
    EXPECT_EQ(back.mm_per_pixel, s.mm_per_pixel);
    EXPECT_EQ(back.scale_known, s.scale_known);
    const ImportOptions said =
        as_described(dir.path(), {.mm_per_pixel = 2, .alpha_max = 0.3, .diffuse_srgb = false});
    EXPECT_EQ(said.mm_per_pixel, 2);
    EXPECT_EQ(said.alpha_max, 0.3);
    EXPECT_EQ(least_alpha(said), 0.01);
    EXPECT_EQ(said.diffuse_srgb, false);
    EXPECT_EQ(report.measured, 48 * 40 - 1);
    EXPECT_EQ(back.confidence(3, 2), 0);
    EXPECT_TRUE(images_near(back.diffuse, s.diffuse, 0.006));
    EXPECT_TRUE(images_near(back.specular, s.specular, 0.003));
    EXPECT_TRUE(images_near(back.roughness, s.roughness, 0.004));
    for (std::size_t i = 0; i < s.normal.size(); ++i)
        if (back.confidence.pixels()[i] > 0) {
            EXPECT_GT(glm::dot(back.normal.pixels()[i], s.normal.pixels()[i]), std::cos(0.01f));
        }
    EXPECT_LT(rms_difference(back.height_mm, s.height_mm), 0.05 * 0.4);
}

TEST(ImportMaps, NamesAreFoundAndConventionsAreFollowed) {
    const TestDir dir;
    const Surface s = example_surface();
    Image<Rgb> flipped = s.normal, lighter = s.diffuse;
    for (Rgb& n : flipped.pixels()) n = Rgb(n.x, -n.y, n.z) * 0.5f + 0.5f;
    write_picture(dir / "Still Life-NoMap.png", flipped, Transfer{});
    write_picture(dir / "Still Life-Albedo.tif", lighter, {Transfer::Kind::srgb});
    write_text_file(dir / "notes.txt", "x");
    const MapFiles files = find_maps(dir.path());
    EXPECT_EQ(files.normals, dir / "Still Life-NoMap.png");
    EXPECT_EQ(files.diffuse, dir / "Still Life-Albedo.tif");
    EXPECT_FALSE(files.gloss || files.specular || files.height || files.roughness);
    ImportReport report;
    const Surface back =
        import_maps(files, {.mm_per_pixel = 0.5, .normals_y_down = true, .diffuse_srgb = true}, report);
    EXPECT_TRUE(images_near(back.normal, s.normal, 2e-4));
    EXPECT_TRUE(images_near(back.diffuse, s.diffuse, 2e-4));
    EXPECT_EQ(back.specular(1, 1), 0);

    write_map(dir / "bump_height.png", Image<float>(48, 40, 0.5f));
    MapFiles heights = find_maps(dir.path());
    heights.normals.reset();
    const Surface flat = import_maps(heights, {}, report);
    EXPECT_TRUE(images_near(flat.normal, Image<Vec3>(48, 40, Vec3(0, 0, 1)), 1e-6));
}

TEST(ImportMaps, NormalsThatPointAwayAreCountedAndRefusedWhereTheyAreMost) {
    const TestDir dir;
    Surface s = example_surface();
    for (int x = 0; x < 48; ++x) s.normal(x, 7).z = -s.normal(x, 7).z;
    write_maps(dir.path(), s);
    std::filesystem::remove(dir / "height.exr");
    ImportReport report;
    EXPECT_NO_THROW(import_maps(find_maps(dir.path()), {.mm_per_pixel = 0.5}, report));
    EXPECT_EQ(report.facing_away, 48);
    ASSERT_FALSE(report.warnings.empty());
    EXPECT_THAT(report.warnings[0],
                testing::HasSubstr("normal.exr: 48 of its 1920 normals (2.5 %) point away"));
    for (Vec3& n : s.normal.pixels()) n.z = -n.z;
    write_maps(dir.path(), s);
    report = {};
    EXPECT_THAT(error_of([&] { import_maps(find_maps(dir.path()), {.mm_per_pixel = 0.5}, report); }),
                testing::AllOf(testing::HasSubstr("normal.exr: 1872 of its 1920 normals point away"),
                               testing::HasSubstr("z towards the viewer")));
}

TEST(ImportMaps, BadMapsAreErrors) {
    const TestDir dir;
    const Surface s = example_surface();
    write_maps(dir.path(), s);
    ImportReport report;
    const auto error = [&](const MapFiles& files) {
        return error_of([&] { import_maps(files, {}, report); });
    };
    MapFiles files = find_maps(dir.path());
    files.diffuse.reset();
    EXPECT_THAT(error(files), HasSubstr("no diffuse map"));
    files = find_maps(dir.path());
    files.normals.reset();
    files.height.reset();
    EXPECT_THAT(error(files), HasSubstr("neither normals nor height"));
    files = find_maps(dir.path());
    write_map(dir / "small.png", Image<float>(4, 4));
    files.roughness = dir / "small.png";
    EXPECT_THAT(error(files), HasSubstr("small.png: is 4 x 4 pixels"));
    files = find_maps(dir.path());
    write_picture(dir / "grey.png", Image<Rgb>(48, 40, Rgb(0.5f)), Transfer{});
    files.normals = dir / "grey.png";
    EXPECT_THAT(error(files), HasSubstr("holds no normal"));
    Image<float> broken = s.height_mm;
    broken(7, 9) = std::numeric_limits<float>::quiet_NaN();
    write_map(dir / "height.exr", broken);
    EXPECT_THAT(error(find_maps(dir.path())),
                HasSubstr("height.exr: holds a value that is no number, at pixel (7, 9)"));
    write_map(dir / "gloss.png", Image<float>(48, 40));
    write_map(dir / "a_gl.png", Image<float>(48, 40));
    EXPECT_THAT(error_of([&] { find_maps(dir.path()); }), HasSubstr("the same map"));
    MapFiles named;
    named.gloss = dir / "a_gl.png";  // as the message says: one is named, and taken
    EXPECT_EQ(find_maps(dir.path(), named).gloss, dir / "a_gl.png");
    EXPECT_THAT(error_of([&] { find_maps(dir / "none"); }), HasSubstr("no such folder"));
}

}  // namespace
}  // namespace tangi
