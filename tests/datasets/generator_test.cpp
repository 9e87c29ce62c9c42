// generator_test.cpp: stacks on disk hold what was rendered, and say under which lights.
#include "datasets/generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capture/formats/lights_file.h"
#include "capture/stack/stack.h"
#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/painting_file.h"
#include "surface/reflectance/anisotropy.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

PaintingTruth small_painting() {
    return procedural_painting({.width = 48, .height = 40, .brush_width_mm = 2, .crack_distance_mm = 3});
}

double angle_deg(const Vec3& a, const Vec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

std::vector<Light> lights_of(const Photography& photography, bool fitted) {
    std::vector<Light> lights;
    for (const auto& photo : photography.photos)
        if (photo.fitted == fitted) lights.push_back(photo.light);
    return lights;
}

TEST(PhotographyOf, SpreadsTheLightsBetweenTheElevationsAllAround) {
    const PaintingTruth white(4, 4);
    for (const Arrangement arrangement : {Arrangement::dome, Arrangement::spiral})
        for (const int count : {1, 7, 48, 100}) {
            const GeneratorOptions options{.lights = count,
                                           .held_out = 5,
                                           .arrangement = arrangement,
                                           .min_elevation_deg = 20,
                                           .max_elevation_deg = 70};
            const Photography photography = photography_of(white, options);
            const std::vector<Light> lights = lights_of(photography, true),
                                     held = lights_of(photography, false);
            ASSERT_EQ(lights.size(), static_cast<std::size_t>(count));
            ASSERT_EQ(held.size(), 5u);
            glm::dvec3 sum(0);
            for (const Photography::Photo& photo : photography.photos) {
                const Light& light = photo.light;
                EXPECT_NEAR(glm::length(light.direction), 1, 1e-6);
                EXPECT_GE(light.direction.z, std::sin(20 * std::numbers::pi / 180) - 1e-6);
                EXPECT_LE(light.direction.z, std::sin(70 * std::numbers::pi / 180) + 1e-6);
                if (photo.fitted) sum += light.direction;
            }
            sum /= static_cast<double>(count);
            if (count >= 48) {
                EXPECT_LT(std::hypot(sum.x, sum.y), 0.05) << name_of(arrangement) << ' ' << count;
            }
            for (std::size_t i = 0; i < lights.size(); ++i)
                for (std::size_t j = 0; j < i; ++j)
                    EXPECT_GT(angle_deg(lights[i].direction, lights[j].direction), 4) << i << ' ' << j;
        }
}

TEST(PhotographyOf, DrawsGainsLogUniformlyBetweenTheirBounds) {
    const Photography photography =
        photography_of(PaintingTruth(4, 4), {.lights = 400, .held_out = 0, .gain_min = 0.25, .gain_max = 4});
    double sum = 0;
    for (const auto& photo : photography.photos) {
        EXPECT_GE(photo.light.gain.g, 0.25f * (1 - 1e-6f));
        EXPECT_LE(photo.light.gain.g, 4 * (1 + 1e-6f));
        sum += std::log2(photo.light.gain.g);
    }
    // log2 of the gain is uniform in [-2, 2]: variance 16 / 12.
    EXPECT_NEAR(sum / 400, 0, 4 * std::sqrt(16.0 / 12 / 400));
}

TEST(PhotographyOf, PutsNearLightsAtTheirDistanceInPictureWidths) {
    const Photography photography = photography_of(PaintingTruth(50, 20, 0.5), {.distance = 2});
    for (const auto& photo : photography.photos) {
        ASSERT_TRUE(photo.light.position_mm);
        EXPECT_NEAR(glm::length(*photo.light.position_mm), 50, 1e-3);
        EXPECT_LT(angle_deg(*photo.light.position_mm, photo.light.direction), 1e-3);
    }
}

struct Storage {
    GeneratorFormat format;
    Transfer transfer;
    double error;  // of an encoded value
};

class WrittenStack : public testing::TestWithParam<Storage> {};

TEST_P(WrittenStack, HoldsThePhotographsThatWereRendered) {
    const auto& [format, transfer, error] = GetParam();
    const TestDir folder;
    const PaintingTruth truth = small_painting();
    const GeneratorOptions options{.lights = 5,
                                   .held_out = 2,
                                   .gain_min = 0.5,
                                   .gain_max = 1.2,
                                   .sensor_noise = false,
                                   .transfer = transfer,
                                   .format = format,
                                   .jpeg_quality = 100};
    const Photography photography = write_stack(folder.path(), truth, options);
    const Stack stack = open_stack(folder.path());
    EXPECT_TRUE(stack.warnings.empty());
    ASSERT_EQ(stack.photos.size(), 5u);
    const Band band = StackReader(stack).read(0, stack.height(), Transfer{});
    double worst = 0, sum = 0;
    for (int i = 0; i < 5; ++i) {
        const Light& light = photography.photos[static_cast<std::size_t>(i)].light;
        EXPECT_EQ(stack.photos[static_cast<std::size_t>(i)].light.name, light.name);
        const Image<Rgb> photo = render_photo(truth, light, options);
        for (int y = 0; y < photo.height(); ++y)
            for (int x = 0; x < photo.width(); ++x)
                for (int c = 0; c < 3; ++c) {
                    const float encoded = transfer.encode(photo(x, y)[c]);
                    const float expected = format == GeneratorFormat::exr ? encoded : std::min(encoded, 1.0f);
                    const double off = std::abs(band.row(i, c, y)[x] - expected);
                    worst = std::max(worst, off);
                    sum += off;
                }
    }
    // JPEG halves the resolution of colour: only its mean error is small.
    EXPECT_LE(format == GeneratorFormat::jpg ? sum / (5.0 * 3 * 48 * 40) : worst, error);
}

// Half a step of the integers, and the rounding of floats.
INSTANTIATE_TEST_SUITE_P(
    Formats, WrittenStack,
    testing::Values(Storage{GeneratorFormat::png16, {}, 0.5 / 65535 + 1e-6},
                    Storage{GeneratorFormat::tif, {Transfer::Kind::gamma, 2.2}, 0.5 / 65535 + 1e-6},
                    Storage{GeneratorFormat::png8, {Transfer::Kind::srgb}, 0.5 / 255 + 1e-6},
                    Storage{GeneratorFormat::jpg, {Transfer::Kind::srgb}, 0.03},
                    Storage{GeneratorFormat::exr, {}, 1e-6}),
    [](const auto& test) { return std::string(name_of(test.param.format)); });

TEST(WriteStack, KeepsTheTruthBesideThePhotographs) {
    const TestDir folder;
    const PaintingTruth truth = small_painting();
    const GeneratorOptions options{
        .lights = 4, .held_out = 2, .distance = 1.5, .reflectance = Reflectance::ward_bounded};
    const Photography photography = write_stack(folder / "new" / "stack", truth, options);
    const fs::path gt = folder / "new" / "stack" / "gt";
    EXPECT_EQ(names_in(folder / "new" / "stack"),
              (std::vector<std::string>{"gt", "heldout", "img_000.png", "img_001.png", "img_002.png",
                                        "img_003.png", "lights.lp"}));
    EXPECT_EQ(names_in(folder / "new" / "stack" / "heldout"),
              (std::vector<std::string>{"heldout.lp", "heldout_000.png", "heldout_001.png"}));
    EXPECT_EQ(open_stack(folder / "new" / "stack" / "heldout").photos.size(), 2u);

    const Image<Rgb> height = read_picture(gt / "height.exr"), normal = read_picture(gt / "normal.exr"),
                     albedo = read_picture(gt / "albedo.exr"), loss = read_picture(gt / "loss.png");
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < truth.width(); ++x) {
            ASSERT_EQ(height(x, y).r, truth.height_mm(x, y));
            ASSERT_EQ(normal(x, y), truth.normal(x, y));
            ASSERT_EQ(albedo(x, y), truth.diffuse(x, y));
            ASSERT_EQ(loss(x, y).r, truth.loss(x, y) ? 1.0f : 0.0f);
        }
    const Photography read = photography_from_json(read_json(read_text_file(gt / "lights.json"), "JSON"));
    ASSERT_EQ(read.photos.size(), 6u);
    EXPECT_EQ(read.white_level, 0.75);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(read.photos[i].light.position_mm, photography.photos[i].light.position_mm);
        EXPECT_EQ(read.photos[i].fitted, i < 4);
    }
    const auto meta = read_json(read_text_file(gt / "meta.json"), "JSON");
    EXPECT_EQ(meta.at("mm_per_pixel"), truth.mm_per_pixel);
    EXPECT_EQ(meta.at("generator").at("reflectance"), "ward_bounded");
}

TEST(WriteStack, GoldLeafHasALobeOfItsColour) {
    const PaintingTruth plain = small_painting();
    EXPECT_TRUE(plain.specular_colour.empty());
    const PaintingTruth truth = procedural_painting(
        {.width = 48, .height = 40, .brush_width_mm = 2, .crack_distance_mm = 3, .gilding = true});
    ASSERT_EQ(truth.specular_colour.region(), truth.height_mm.region());
    EXPECT_EQ(truth.specular_colour(24, 20), Rgb(1)) << "paint in the middle";
    EXPECT_EQ(truth.diffuse(24, 20), plain.diffuse(24, 20));
    const Rgb gold = truth.specular_colour(1, 20);
    EXPECT_LT(gold.b, 0.5f);
    EXPECT_LT(gold.b, gold.g);
    EXPECT_GT(truth.specular(1, 20), 0.2f);

    const TestDir folder;
    const GeneratorOptions options{.lights = 4, .held_out = 0, .reflectance = Reflectance::ward_bounded};
    write_stack(folder / "stack", truth, options);
    EXPECT_EQ(read_picture(folder / "stack" / "gt" / "lobe.exr")(1, 20), gold);
    EXPECT_TRUE(images_identical(read_painting(folder / "stack" / "gt" / "truth.exr").specular_colour,
                                 truth.specular_colour));
    // What gold shows beyond its matt part, in a mirror's direction, has its colour; as Ward's lobe and as
    // GGX.
    PaintingTruth flat(2, 1);
    flat.specular_colour = Image<Rgb>(2, 1, gold);
    flat.specular_colour(1, 0) = Rgb(1);
    std::fill(flat.diffuse.pixels().begin(), flat.diffuse.pixels().end(), Rgb(0));
    std::fill(flat.specular.pixels().begin(), flat.specular.pixels().end(), 0.3f);
    for (const Reflectance reflectance : {Reflectance::ward_bounded, Reflectance::ggx}) {
        const Image<Rgb> photo =
            render_photo(flat, distant_light({0, 0, 1}), {.reflectance = reflectance, .cast_shadows = false});
        EXPECT_NEAR(photo(0, 0).b / photo(0, 0).r, gold.b / gold.r, 1e-3);
        EXPECT_NEAR(photo(1, 0).b / photo(1, 0).r, 1, 1e-6);
    }
    write_stack(folder / "stack", plain, options);
    EXPECT_FALSE(fs::exists(folder / "stack" / "gt" / "lobe.exr")) << "of another stack";
}

TEST(WriteStack, RubbedGoldLeafShinesWideAcrossTheBorder) {
    PaintingOptions options{
        .width = 48, .height = 40, .brush_width_mm = 2, .crack_distance_mm = 3, .gilding = true};
    EXPECT_TRUE(procedural_painting(options).lobe_axes.empty());
    options.brushed = 0.5;
    const PaintingTruth truth = procedural_painting(options);
    const auto stretch_at = [&](int x, int y) {
        return stretch_of(truth.lobe_axes(x, y), truth.roughness(x, y));
    };
    EXPECT_LT(glm::length(stretch_at(1, 20) - Stretch(0.5f, 0)), 1e-3f) << "left";
    EXPECT_LT(glm::length(stretch_at(24, 1) - Stretch(-0.5f, 0)), 1e-3f) << "above";
    EXPECT_EQ(stretch_at(24, 20), Stretch(0)) << "paint";
    const TestDir folder;
    write_stack(folder / "stack", truth,
                {.lights = 4, .held_out = 0, .reflectance = Reflectance::ward_bounded});
    EXPECT_EQ(read_painting(folder / "stack" / "gt" / "truth.exr").lobe_axes(1, 20), truth.lobe_axes(1, 20));
    EXPECT_TRUE(fs::exists(folder / "stack" / "gt" / "roughness_v.exr"));
    // Under a light off to the side and one as far above, as Ward's lobe and as GGX.
    PaintingTruth flat(1, 1);
    flat.specular(0, 0) = 0.3f;
    flat.lobe_axes = Image<LobeAxes>(1, 1, axes_of({0.5f, 0}, flat.roughness(0, 0)));
    flat.diffuse(0, 0) = Rgb(0);
    for (const Reflectance reflectance : {Reflectance::ward_bounded, Reflectance::ggx}) {
        const auto shine = [&](const Vec3& to) {
            return render_photo(flat, distant_light(to), {.reflectance = reflectance, .cast_shadows = false})(
                       0, 0)
                .g;
        };
        EXPECT_GT(shine({0.8f, 0, 1}), 2 * shine({0, 0.8f, 1}));
    }
    // Without a stretch, GGX is what it is without axes.
    flat.lobe_axes(0, 0) = {flat.roughness(0, 0), 0};
    PaintingTruth round = flat;
    round.lobe_axes = {};
    const GeneratorOptions ggx{.cast_shadows = false};
    const Light light = distant_light({0.3f, 0.4f, 1});
    EXPECT_NEAR(render_photo(flat, light, ggx)(0, 0).g / render_photo(round, light, ggx)(0, 0).g, 1, 1e-4);
}

TEST(WriteStack, WritesThePaintingThatAPerfectFitWouldFind) {
    const TestDir folder;
    const PaintingTruth truth = small_painting();
    write_stack(folder / "ward", truth,
                {.lights = 2, .held_out = 0, .reflectance = Reflectance::ward_bounded});
    const Surface ward = read_painting(folder / "ward" / "gt" / "truth.exr");
    EXPECT_TRUE(images_identical(ward.height_mm, truth.height_mm));
    EXPECT_TRUE(images_identical(ward.specular, truth.specular));
    EXPECT_EQ(ward.photography.photos.size(), 2u);

    write_stack(folder / "lambert", truth, {.lights = 2, .held_out = 0, .reflectance = Reflectance::lambert});
    const Surface lambert = read_painting(folder / "lambert" / "gt" / "truth.exr");
    EXPECT_TRUE(images_identical(lambert.specular, Image<float>(truth.width(), truth.height())));

    write_stack(folder / "ggx", truth, {.lights = 2, .held_out = 0});
    EXPECT_FALSE(fs::exists(folder / "ggx" / "gt" / "truth.exr"));
    EXPECT_FALSE(fs::exists(folder / "ggx" / "heldout"));
}

// 60 directions with two normally distributed errors each: the mean square is known to a part of sqrt(1 /
// 60).
TEST(WriteStack, DisturbsOnlyTheDirectionsThatItPublishes) {
    const TestDir folder;
    const GeneratorOptions options{
        .lights = 60, .held_out = 1, .min_elevation_deg = 25, .nominal_direction_error_deg = 3};
    const Photography photography = write_stack(folder.path(), PaintingTruth(2, 2), options);
    const LightsFile nominal = read_lights_file(folder / "lights.lp");
    double squares = 0;
    for (std::size_t i = 0; i < 60; ++i)
        squares += std::pow(angle_deg(nominal.lights[i].direction, photography.photos[i].light.direction), 2);
    EXPECT_NEAR(squares / 60 / 9, 1, 4 / std::sqrt(60.0));
    const LightsFile held_out = read_lights_file(folder / "heldout" / "heldout.lp");
    EXPECT_LT(angle_deg(held_out.lights[0].direction, photography.photos[60].light.direction), 1e-3);

    GeneratorOptions exact = options;
    exact.nominal_direction_error_deg = 0;
    const Photography same = photography_of(PaintingTruth(2, 2), exact);
    for (std::size_t i = 0; i < 60; ++i)
        EXPECT_EQ(same.photos[i].light.direction, photography.photos[i].light.direction);
}

TEST(WriteStack, LeavesNoLightsFileWhenStopped) {
    const TestDir folder;
    int calls = 0;
    const auto stop_at_second = [&](std::string_view, double) { return ++calls < 2; };
    EXPECT_THROW(write_stack(folder.path(), PaintingTruth(4, 4), {.lights = 4}, stop_at_second), Cancelled);
    EXPECT_FALSE(fs::exists(folder / "lights.lp"));
    EXPECT_THAT(error_of([&] { open_stack(folder.path()); }), testing::HasSubstr("no lights file"));
}

TEST(GeneratorOptions, NamesWhatIsWrong) {
    EXPECT_EQ(error_of([] { require_valid({.lights = 0}); }), "generator.lights = 0 is outside [1, 10000]");
    EXPECT_EQ(error_of([] { require_valid({.gain_min = 2}); }),
              "generator.gain_max = 1 is below gain_min = 2");
    EXPECT_EQ(error_of([] { require_valid({.min_elevation_deg = 50, .max_elevation_deg = 40}); }),
              "generator.max_elevation_deg = 40 is below min_elevation_deg = 50");
    EXPECT_EQ(
        error_of([] { require_valid({.transfer = {Transfer::Kind::srgb}, .format = GeneratorFormat::exr}); }),
        "generator.format = exr holds linear light; the transfer curve cannot be srgb");
}

TEST(GeneratorOptions, KnowsItsChoicesByName) {
    for (const Arrangement value : {Arrangement::dome, Arrangement::spiral})
        EXPECT_EQ(arrangement_named(name_of(value)), value);
    for (const Reflectance value : {Reflectance::ggx, Reflectance::ward_bounded, Reflectance::lambert})
        EXPECT_EQ(reflectance_named(name_of(value)), value);
    for (const GeneratorFormat value : {GeneratorFormat::png16, GeneratorFormat::png8, GeneratorFormat::jpg,
                                        GeneratorFormat::exr, GeneratorFormat::tif})
        EXPECT_EQ(generator_format_named(name_of(value)), value);
    EXPECT_FALSE(reflectance_named("phong"));
}

}  // namespace
}  // namespace tangi
