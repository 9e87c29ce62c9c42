// substrate_choice_test.cpp: what a new painting is painted on, toned and varnished as was asked for.
#include "paint/substrate/substrate_choice.h"

#include <gmock/gmock.h>

#include "surface/base/json_reading.h"
#include "surface/maps/light.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

SubstrateChoice small(const std::string& which) {
    SubstrateChoice choice{.which = which};
    choice.piece = {.width_mm = 10, .height_mm = 8, .pixel_mm = 0.25};
    return choice;
}

double mean(const Image<float>& map) {
    double sum = 0;
    for (const float v : map.pixels()) sum += static_cast<double>(v);
    return sum / static_cast<double>(map.size());
}

TEST(SubstrateChoice, FinishChangesTheWholeAndKeepsWhatVaries) {
    const Surface plain = make_substrate(small("linen"));
    SubstrateChoice choice = small("linen");
    choice.finish = {.tint = {0.5f, 0.25f, 1}, .specular = 0.08, .roughness = 0.2};
    const Surface toned = make_substrate(choice);
    EXPECT_NEAR(mean(toned.specular), 0.08, 1e-4);
    EXPECT_NEAR(mean(toned.roughness), 0.2, 1e-4);
    EXPECT_TRUE(images_near(toned.height_mm, plain.height_mm, 0)) << "the relief is the linen's";
    const auto ratio = [&](const Image<float>& map, std::size_t i) {
        return map.pixels()[i] / map.pixels()[0];
    };
    for (const std::size_t i : {7u, 311u, 1000u}) {
        EXPECT_LT(glm::length(toned.diffuse.pixels()[i] - plain.diffuse.pixels()[i] * choice.finish.tint),
                  1e-6f);
        EXPECT_NEAR(ratio(toned.specular, i), ratio(plain.specular, i), 1e-4f);
        EXPECT_NEAR(ratio(toned.roughness, i), ratio(plain.roughness, i), 1e-4f);
    }
    Surface anisotropic = plain;
    anisotropic.lobe_axes = Image<LobeAxes>(plain.width(), plain.height(), {0.5f, 0.3f});
    apply(choice.finish, anisotropic);
    EXPECT_NEAR(anisotropic.lobe_axes.pixels()[9].roughness_v / anisotropic.roughness.pixels()[9],
                0.5f / plain.roughness.pixels()[9], 1e-4f)
        << "as anisotropic as it was";
}

// What is cut off at 1 is made up for by the rest; what was not measured neither counts nor changes.
TEST(SubstrateChoice, TheMeanIsOfWhatWasMeasured) {
    Surface s(20, 10);
    std::ranges::fill(s.confidence.pixels(), 1.0f);
    for (std::size_t i = 0; i < s.specular.size(); ++i)
        s.specular.pixels()[i] = s.roughness.pixels()[i] = i % 10 == 0 ? 0.9f : 0.05f;
    s.confidence.pixels()[7] = 0;
    apply({.specular = 0.5, .roughness = 0.5}, s);
    double sum = 0;
    for (std::size_t i = 0; i < s.specular.size(); ++i)
        if (i != 7) sum += static_cast<double>(s.specular.pixels()[i]);
    EXPECT_NEAR(sum / 199, 0.5, 1e-4);
    EXPECT_EQ(s.specular.pixels()[0], 1);
    EXPECT_EQ(s.roughness.pixels()[7], 0.05f);
}

TEST(SubstrateChoice, AFinishIsInItsProvenanceAndItIsNoPhotographsAnyMore) {
    TestDir dir;
    Surface painting = make_substrate(small("linen"));
    painting.photography.photos.push_back({.light = distant_light({0, 0, 1}, "a.png")});
    painting.provenance = R"({"command": "fit"})";
    write_painting(dir / "p.exr", painting);
    SubstrateChoice choice{.which = (dir / "p.exr").string()};
    EXPECT_EQ(make_substrate(choice).photography.photos.size(), 1u);
    choice.finish.roughness = 0.3;
    const Surface matt = make_substrate(choice);
    EXPECT_TRUE(matt.photography.photos.empty());
    const auto json = read_json(matt.provenance, "JSON");
    EXPECT_EQ(json["finish"]["roughness"], 0.3);
    EXPECT_EQ(json["made_of"]["command"], "fit");
}

TEST(SubstrateChoice, NumbersOutOfRangeAreErrors) {
    const auto error = [](const SubstrateFinish& finish) {
        SubstrateChoice choice = small("panel");
        choice.finish = finish;
        return error_of([&] { make_substrate(choice); });
    };
    EXPECT_THAT(error({.tint = {1, 1.5f, 1}}), HasSubstr("1.5"));
    EXPECT_THAT(error({.specular = -0.1}), HasSubstr("-0.1"));
    EXPECT_THAT(error({.roughness = 0}), HasSubstr("0.001 to 1"));
    EXPECT_THAT(error_of([] { make_substrate(small("velvet")); }),
                testing::AllOf(HasSubstr("velvet"), HasSubstr("linen")));
    EXPECT_THAT(error_of([] { make_substrate(small("none.png")); }), HasSubstr("none.png"));
    const TestDir dir;
    SubstrateChoice picture{.which = (dir / "a.png").string()};
    write_picture_8bit(picture.which, Image<Rgb>(20, 10, Rgb(0.5f)));
    picture.height_from = (dir / "b.png").string();
    write_picture_8bit(picture.height_from, Image<Rgb>(10, 10, Rgb(0.5f)));
    EXPECT_THAT(error_of([&] { make_substrate(picture); }),
                testing::AllOf(HasSubstr("a.png"), HasSubstr("b.png"), HasSubstr("10 x 10")));
    SubstrateChoice kept = small("panel");
    kept.keep_as = "mine.PNG";
    EXPECT_THAT(error_of([&] { make_substrate(kept); }), HasSubstr("leave its ending out"));
}

TEST(SubstrateChoice, APaintingsDryLayerIsTakenAsItIs) {
    TestDir dir;
    const Surface linen = make_substrate(small("linen"));
    write_painting(dir / "linen.exr", linen);
    EXPECT_EQ(hash_of(make_substrate(SubstrateChoice{.which = (dir / "linen.exr").string()})),
              hash_of(linen));
}

}  // namespace
}  // namespace tangi
