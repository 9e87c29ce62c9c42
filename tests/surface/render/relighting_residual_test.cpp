#include "surface/render/relighting_residual.h"

#include <gmock/gmock.h>

#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 5, kHeight = 4;

Surface example_surface() {
    Surface s(kWidth, kHeight);
    for (std::size_t i = 0; i < s.diffuse.size(); ++i) {
        s.diffuse.pixels()[i] = Rgb(0.1f + 0.04f * static_cast<float>(i), 0.5f, 0.3f);
        s.confidence.pixels()[i] = 1;
    }
    return s;
}

RelightingResidual example_residual(const Surface& dry) {
    RelightingResidual r;
    r.kernel = RelightingResidual::Kernel::matern;
    r.reach = 0.4;
    r.directions = {Vec3(0, 0, 1), Vec3(0.6f, 0, 0.8f), Vec3(0, -0.6f, 0.8f)};
    r.brightness_weights = {{1, 0.25, -0.5}, {0.1, 0.2, 0.3}};
    r.colour_weights = {{0, 1, 0}};
    Random random(3);
    for (int t = 0; t < 4; ++t) {
        Image<float> map(kWidth, kHeight);
        for (float& v : map.pixels()) v = random.real(-0.2, 0.2);
        (t < 2 ? r.brightness : r.colour).push_back(map);
    }
    r.dry_hash = hash_of(dry);
    return r;
}

Image<Rgb> added(const RelightingResidual& r, const Surface& dry, const std::vector<Light>& lights,
                 const Image<float>& bare = {}) {
    Image<Rgb> picture(kWidth, kHeight, Rgb(2));
    add_residual(r, dry, lights, bare, picture);
    return picture;
}

TEST(RelightingResidual, ColourFramesAreOrthonormalAlongTheColour) {
    for (const Rgb& colour : {Rgb(0), Rgb(1, 0, 0), Rgb(0, 1, 0), Rgb(0, 0, 1), Rgb(0.2f, 0.5f, 0.9f)}) {
        const glm::mat3 frame = colour_frame(colour), product = glm::transpose(frame) * frame;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j, 1e-6);
        EXPECT_NEAR(glm::dot(frame[0], colour), glm::length(colour), 1e-6);
    }
}

TEST(RelightingResidual, AddsWhatTheFormulaSays) {
    const Surface dry = example_surface();
    const RelightingResidual r = example_residual(dry);
    Light light = distant_light({0.3f, 0.1f, 0.9f});
    light.gain = Rgb(0.5f, 1, 2);
    const Image<Rgb> picture = added(r, dry, {light});
    std::array<double, 3> sums{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double k = kernel_at(r.kernel, r.reach, glm::length(light.direction - r.directions[i]));
        sums[0] += r.brightness_weights[0][i] * k;
        sums[1] += r.brightness_weights[1][i] * k;
        sums[2] += r.colour_weights[0][i] * k;
    }
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const double along = sums[0] * r.brightness[0].pixels()[i] + sums[1] * r.brightness[1].pixels()[i];
        const Vec3 inside(along, sums[2] * r.colour[0].pixels()[i], sums[2] * r.colour[1].pixels()[i]);
        const Rgb expected = Rgb(2) + light.gain * (colour_frame(dry.diffuse.pixels()[i]) * inside);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.pixels()[i][c], expected[c], 1e-5);
    }
}

TEST(RelightingResidual, LightsAddUpPaintHidesItAndItFadesAwayFromThePhotographs) {
    const Surface dry = example_surface();
    const RelightingResidual r = example_residual(dry);
    const Light a = distant_light({0.3f, 0.1f, 0.9f}), b = distant_light({-0.2f, -0.4f, 0.9f});
    const Image<Rgb> one = added(r, dry, {a}), other = added(r, dry, {b}), both = added(r, dry, {a, b});
    for (std::size_t i = 0; i < both.size(); ++i)
        EXPECT_NEAR(both.pixels()[i].r, one.pixels()[i].r + other.pixels()[i].r - 2, 1e-5);
    EXPECT_FALSE(images_near(one, Image<Rgb>(kWidth, kHeight, Rgb(2)), 1e-3));
    EXPECT_TRUE(images_identical(added(r, dry, {a}, Image<float>(kWidth, kHeight, 0.0f)),
                                 Image<Rgb>(kWidth, kHeight, Rgb(2))));
    RelightingResidual narrow = r;
    narrow.reach = 0.05;
    EXPECT_TRUE(images_near(added(narrow, dry, {distant_light({-1, 1, 0.2f})}),
                            Image<Rgb>(kWidth, kHeight, Rgb(2)), 1e-6));
    RelightingResidual dark = r;
    for (float& v : dark.brightness[0].pixels()) v = -1000;
    const Image<Rgb> clamped = added(dark, dry, {distant_light({0, 0, 1})});
    for (const Rgb& value : clamped.pixels()) EXPECT_GE(std::min({value.r, value.g, value.b}), 0);
}

// Between the middles of two blocks it is between their values, and beyond the outermost ones the same.
TEST(RelightingResidual, OfBlocksIsInterpolatedBetweenThem) {
    Surface dry(6, 5);
    for (std::size_t i = 0; i < dry.diffuse.size(); ++i) {
        dry.diffuse.pixels()[i] = Rgb(0.5f);
        dry.confidence.pixels()[i] = 1;
    }
    dry.confidence(5, 0) = 0;
    RelightingResidual r = example_residual(dry);
    r.reduction = 3;
    for (auto* maps : {&r.brightness, &r.colour})
        for (Image<float>& map : *maps) map = Image<float>(2, 2, 0.0f);
    r.brightness[0](1, 0) = r.brightness[0](1, 1) = 0.3f;
    Image<Rgb> picture(6, 5, Rgb(0));
    add_residual(r, dry, {{distant_light({0, 0, 1})}}, {}, picture);
    for (int y = 1; y < 5; ++y) {
        for (const int x : {0, 1}) EXPECT_EQ(picture(x, y).r, 0);
        EXPECT_NEAR(picture(2, y).r, picture(4, y).r / 3, 1e-6);
        EXPECT_NEAR(picture(3, y).r, picture(4, y).r * 2 / 3, 1e-6);
        EXPECT_EQ(picture(5, y).r, picture(4, y).r);
    }
    EXPECT_GT(picture(4, 2).r, 0.01f);
    EXPECT_EQ(picture(5, 0).r, 0) << "was not measured";

    const TestDir dir;
    AtomicFile file(dir / "a.exr");
    write_painting(file, dry, std::array{part_of(r)});
    const RelightingResidual back = read_residual(dir / "a.exr", dry);
    EXPECT_EQ(back.reduction, 3);
    EXPECT_TRUE(images_near(back.brightness[0], r.brightness[0], 0.2 / 2048));
    for (const char* wrong : {"0", "1e30", "2147483647", "\"3\""}) {
        PartToWrite part = part_of(r);
        std::string& model = part.info.attributes["model"];
        const std::string right = "\"reduction\":3";
        ASSERT_NE(model.find(right), std::string::npos) << model;
        model.replace(model.find(right), right.size(), std::string("\"reduction\":") + wrong);
        AtomicFile other(dir / "b.exr");
        write_painting(other, dry, std::array{part});
        EXPECT_THAT(error_of([&] { read_residual(dir / "b.exr", dry); }),
                    testing::AllOf(HasSubstr("attribute 'model'"), HasSubstr("--no-residual")));
    }
}

TEST(RelightingResidual, PartsComeBackAndBelongToOneDryLayer) {
    const TestDir dir;
    const Surface dry = example_surface();
    const RelightingResidual r = example_residual(dry);
    const auto write = [&](const std::string& name, const Surface& s, const PartToWrite& part) {
        AtomicFile file(dir / name);
        const std::array parts{part};
        write_painting(file, s, parts);
    };
    write("a.exr", dry, part_of(r));
    const RelightingResidual back = read_residual(dir / "a.exr", read_painting(dir / "a.exr"));
    EXPECT_EQ(back.kernel, r.kernel);
    EXPECT_EQ(back.directions, r.directions);
    EXPECT_EQ(back.brightness_weights, r.brightness_weights);
    EXPECT_EQ(back.colour_weights, r.colour_weights);
    ASSERT_EQ(back.brightness.size(), 2u);
    ASSERT_EQ(back.colour.size(), 2u);
    for (std::size_t t = 0; t < 2; ++t) {  // half floats have 11 bits
        EXPECT_TRUE(images_near(back.brightness[t], r.brightness[t], 0.2 / 2048));
        EXPECT_TRUE(images_near(back.colour[t], r.colour[t], 0.2 / 2048));
    }
    EXPECT_TRUE(painting_parts(dir / "a.exr").front().half);

    write_painting(dir / "none.exr", dry);
    EXPECT_TRUE(read_residual(dir / "none.exr", dry).empty());
    Surface other = dry;
    other.diffuse(1, 1) = Rgb(0.9f);
    EXPECT_THAT(error_of([&] { read_residual(dir / "a.exr", other); }),
                HasSubstr("belongs to another dry layer"));
    PartToWrite part = part_of(r);
    part.info.attributes["model"] = "{\"kernel\": \"cubic\"}";
    write("b.exr", dry, part);
    EXPECT_THAT(
        error_of([&] { read_residual(dir / "b.exr", dry); }),
        testing::AllOf(HasSubstr("b.exr: part 'residual'"), HasSubstr("cubic"), HasSubstr("fit again")));
    RelightingResidual broken = r;
    broken.brightness[1](2, 3) = std::numeric_limits<float>::infinity();
    write("c.exr", dry, part_of(broken));
    EXPECT_THAT(error_of([&] { read_residual(dir / "c.exr", dry); }),
                HasSubstr("brightness.001' holds inf at pixel (2, 3)"));
    broken = r;
    broken.brightness.pop_back();
    write("d.exr", dry, part_of(broken));
    EXPECT_THAT(error_of([&] { read_residual(dir / "d.exr", dry); }), HasSubstr("channels"));
}

}  // namespace
}  // namespace tangi
