// relight, run as a user would run it, against what the library says.
#include <gmock/gmock.h>

#include "capture/formats/lights_file.h"
#include "capture/photo/photo_file.h"
#include "surface/render/relight.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

void use_srgb(GeneratorOptions& options) { options.transfer = Transfer{Transfer::Kind::srgb}; }

// What the picture of a painting must hold: relit, exposed and encoded as its photographs were.
Image<Rgb> expected_picture(const Surface& s, const std::vector<Light>& lights, const Transfer& transfer,
                            RelightOptions options = {}) {
    options.cast_shadows = true;  // the command's default
    Image<Rgb> picture = relight(s, lights, options);
    for (Rgb& pixel : picture.pixels())
        for (int c = 0; c < 3; ++c) {
            const float value = transfer.encode(pixel[c] * static_cast<float>(s.photography.white_level));
            pixel[c] = transfer == Transfer{} ? value : std::min(value, 1.0f);
        }
    return picture;
}

TEST(CliRelight, WritesEachFormatAsThePhotographsWereEncoded) {
    const TinyStack stack(use_srgb);
    const Surface s = read_painting(stack.truth());
    const Transfer srgb{Transfer::Kind::srgb};
    const std::vector<Light> light = {distant_light(Vec3(-0.3f, 0.4f, 1))};
    const auto relit = [&](const std::string& name, std::vector<std::string> flags = {}) {
        flags.insert(flags.begin(),
                     {"relight", stack.truth(), "--light=-0.3,0.4,1", "--out", stack.out(name)});
        const Finished run = tangipaint(flags);
        EXPECT_TRUE(ended(run, 0)) << name;
        EXPECT_EQ(run.json()["pictures"], nlohmann::json::array({stack.out(name)}));
        return read_picture(stack.out(name));
    };
    const Image<Rgb> encoded = expected_picture(s, light, srgb),
                     linear = expected_picture(s, light, Transfer{});
    EXPECT_TRUE(images_near(relit("a.png"), encoded, 1.0 / 65535));
    EXPECT_TRUE(images_near(relit("a.tif"), encoded, 1.0 / 65535));
    EXPECT_TRUE(images_near(relit("a.exr"), linear, 1e-6));
    EXPECT_EQ(PhotoFile(stack.out("a.png")).header().bits, 16);
    EXPECT_EQ(PhotoFile(stack.out("a.tif")).header().bits, 16);
    EXPECT_TRUE(PhotoFile(stack.out("a.exr")).header().is_float);
    EXPECT_TRUE(images_near(relit("B.Exr"), linear, 1e-6));
    EXPECT_TRUE(images_near(relit("B.PNG"), encoded, 1.0 / 65535));

    const Image<Rgb> jpeg = relit("a.jpg");  // lossy: right on average
    double difference = 0;
    for (std::size_t i = 0; i < jpeg.size(); ++i)
        difference += std::abs(jpeg.pixels()[i].g - encoded.pixels()[i].g);
    EXPECT_LT(difference / static_cast<double>(jpeg.size()), 0.02);
    EXPECT_EQ(PhotoFile(stack.out("a.jpg")).header().bits, 8);

    EXPECT_TRUE(images_near(relit("b.png", {"--encoding", "linear"}), linear, 1.0 / 65535));
    EXPECT_TRUE(images_near(relit("c.png", {"--encoding", "1.8"}),
                            expected_picture(s, light, Transfer{Transfer::Kind::gamma, 1.8}), 1.0 / 65535));
    EXPECT_TRUE(images_near(relit("d.exr", {"--encoding", "linear"}), linear, 1e-6));
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
}

TEST(CliRelight, AddsUpLightsNearAndFar) {
    const TinyStack stack;
    const Surface s = read_painting(stack.truth());
    const Finished run = tangipaint({"relight", stack.truth(), "--light", "1,0,1", "--light=-1,0.5,1",
                                     "--point-light", "4,-3,20", "--gain", "0.5", "--model", "ward1992",
                                     "--ambient", "0.1", "--out", stack.out("a.exr")});
    ASSERT_TRUE(ended(run, 0));
    std::vector<Light> lights = {distant_light({1, 0, 1}), distant_light({-1, 0.5f, 1}),
                                 near_light({4, -3, 20})};
    for (Light& light : lights) light.gain = Rgb(0.5f);
    RelightOptions options;
    options.model = WardModel::ward1992;
    options.ambient = 0.1;
    const Image<Rgb> expected = expected_picture(s, lights, Transfer{}, options);
    EXPECT_TRUE(images_near(read_picture(stack.out("a.exr")), expected, 1e-5));
    // and the near light is not just another far one
    lights[2] = distant_light({4, -3, 20});
    EXPECT_FALSE(images_near(expected_picture(s, lights, Transfer{}, options), expected, 1e-3));
}

TEST(CliRelight, OnlyTheDirectionOfADistantLightCounts) {
    const TinyStack stack;
    const auto relit = [&](const std::string& light) {
        EXPECT_TRUE(ended(
            tangipaint({"relight", stack.truth(), "--light=" + light, "--out", stack.out("a.exr")}), 0));
        return read_picture(stack.out("a.exr"));
    };
    const Image<Rgb> expected = relit("-1,0,1");
    for (const char* light : {"-1e300,0,1e300", "-3e38,0,3e38", "-1e-300,0,1e-300", "-2, 0 ,2"})
        EXPECT_TRUE(images_near(relit(light), expected, 1e-6)) << light;
}

TEST(CliRelight, ALightFromBehindIsNamed) {
    const TinyStack stack;
    const auto warnings = [&](const std::string& light) {
        const Finished run =
            tangipaint({"relight", stack.truth(), "--light=" + light, "--out", stack.out("behind.png")});
        EXPECT_TRUE(ended(run, 0)) << light;
        return run.json()["warnings"];
    };
    ASSERT_EQ(warnings("0.3,0,-1").size(), 1u);
    EXPECT_THAT(warnings("0.3,0,-1")[0].get<std::string>(), HasSubstr("--light 0.3,0,-1: comes from behind"));
    EXPECT_TRUE(warnings("1,0,0").empty());
}

TEST(CliRelight, NearLightsGiveNumbersAnywhereInFrontOfThePainting) {
    const TinyStack stack;
    Surface flat = read_painting(stack.truth());
    for (float& height_mm : flat.height_mm.pixels()) height_mm = 0;
    write_painting(stack.truth(), flat);
    for (const char* position : {"0,0,0.001", "1e6,-1e6,0.001", "0,0,1e6"}) {
        ASSERT_TRUE(ended(tangipaint({"relight", stack.truth(), "--point-light", position, "--gain", "10000",
                                      "--out", stack.out("a.exr")}),
                          0));
        const Image<Rgb> relit = read_picture(stack.out("a.exr"));
        for (const Rgb& pixel : relit.pixels())
            ASSERT_TRUE(std::isfinite(pixel.r) && std::isfinite(pixel.g) && std::isfinite(pixel.b))
                << position;
    }
}

TEST(CliRelight, CastShadowsCanBeTurnedOff) {
    const TinyStack stack;
    const auto relit = [&](const std::string& name, const std::string& flag) {
        EXPECT_TRUE(ended(
            tangipaint({"relight", stack.truth(), "--light", "1,0.2,0.15", "--out", stack.out(name), flag}),
            0));
        return read_picture(stack.out(name));
    };
    const Image<Rgb> with = relit("a.exr", "--cast-shadows"), without = relit("b.exr", "--no-cast-shadows");
    int darker = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
        EXPECT_LE(with.pixels()[i].g, without.pixels()[i].g + 1e-6f);
        darker += with.pixels()[i].g < without.pixels()[i].g - 1e-3f;
    }
    EXPECT_GT(darker, 20);
}

// relight and info read what fit reads; who names no photographs gives pictures no names.
TEST(CliRelight, ReadsLightsOfEveryFormat) {
    const TinyStack stack;
    const nlohmann::json directions = {{{"x", 0.6}, {"y", 0}, {"z", 0.8}},
                                       {{"x", 0}, {"y", 0.6}, {"z", 0.8}}};
    const nlohmann::json images = {{{"filename", "a.png"}}, {{"filename", "b.png"}}};
    const std::string project = stack.out("of.relight"), dome = stack.out("of.dome"),
                      out = stack.out("relit");
    write_bytes(project, nlohmann::json{{"images", images}, {"dome", {{"directions", directions}}}}.dump());
    write_bytes(dome, nlohmann::json{{"directions", directions}}.dump());
    ASSERT_TRUE(ended(tangipaint({"relight", stack.truth(), "--lights", project, "--out", out}), 0));
    EXPECT_THAT(everything_in(out), testing::ElementsAre("a.png", "b.png"));
    EXPECT_TRUE(ended(tangipaint({"relight", stack.truth(), "--lights", dome, "--out", stack.out("none")}), 1,
                      {"of.dome: does not name the photographs"}));
    for (const std::string& file : {project, dome}) {
        const nlohmann::json said = tangipaint({"info", file}).json();
        EXPECT_EQ(said["kind"], "lights") << file;
        EXPECT_EQ(said["lights"].size(), 2u) << file;
    }
}

TEST(CliRelight, ALightsFileGivesAPictureForEachPhotograph) {
    const TinyStack stack([](GeneratorOptions& o) {
        use_srgb(o);
        o.gain_min = 0.5;
        o.gain_max = 1.5;
    });
    const Surface s = read_painting(stack.truth());
    const std::string lights = stack.held_out() + "/heldout.lp", out = stack.out("new/relit");
    const Finished run = tangipaint({"relight", stack.truth(), "--lights", lights, "--out", out});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_THAT(everything_in(out), testing::ElementsAre("heldout_000.png", "heldout_001.png"));
    EXPECT_EQ(run.json()["pictures"].size(), 2u);
    for (int i = 0; i < 2; ++i) {
        const fs::path picture = fs::path(out) / fmt::format("heldout_00{}.png", i);
        EXPECT_EQ(PhotoFile(picture).header().bits, 16);
        // The light's direction is the file's, its strength that which the painting knows by the name.
        Light light = read_lights_file(lights).lights[static_cast<std::size_t>(i)];
        light.gain = s.photography.photos[static_cast<std::size_t>(12 + i)].light.gain;
        EXPECT_NE(light.gain.r, 1);
        EXPECT_TRUE(images_near(read_picture(picture), expected_picture(s, {light}, s.photography.transfer),
                                1.0 / 65535));
    }
    // What the fit would give at best, beside the photograph itself: only noise is between them.
    const Image<Rgb> photo = read_picture(stack.held_out() + "/heldout_000.png");
    const Image<Rgb> relit = read_picture(fs::path(out) / "heldout_000.png");
    double difference = 0;
    for (std::size_t i = 0; i < photo.size(); ++i)
        difference += std::abs(photo.pixels()[i].g - relit.pixels()[i].g);
    EXPECT_LT(difference / static_cast<double>(photo.size()), 0.02);
}

TEST(CliRelight, GainMakesTheLightsOfAFileStronger) {
    const TinyStack stack([](GeneratorOptions& o) {
        o.gain_min = 0.2;
        o.gain_max = 0.4;
    });
    const auto relit = [&](const std::string& gain) {
        const std::string out = stack.out("d" + gain);
        EXPECT_TRUE(ended(tangipaint({"relight", stack.truth(), "--lights", stack.held_out() + "/heldout.lp",
                                      "--out", out, "--gain", gain}),
                          0));
        return read_picture(out + "/heldout_001.png");
    };
    Image<Rgb> halved = relit("1");
    for (Rgb& pixel : halved.pixels()) {
        ASSERT_LT(std::max({pixel.r, pixel.g, pixel.b}), 1);  // or it would be cut off, not halved
        pixel *= 0.5f;
    }
    EXPECT_TRUE(images_near(relit("0.5"), halved, 1.0 / 65535));
}

TEST(CliRelight, NamesOfALightsFileMayHoldFoldersAndSpaces) {
    const TinyStack stack;
    write_bytes(stack.out("a.lp"), "2\nC:\\Photos\\my door.JPG 0 0 1\nset b/img 2.tif 1 0 1\n");
    ASSERT_TRUE(ended(
        tangipaint({"relight", stack.truth(), "--lights", stack.out("a.lp"), "--out", stack.out("d")}), 0));
    EXPECT_THAT(everything_in(stack.out("d")), testing::ElementsAre("img 2.png", "my door.png"));
    write_bytes(stack.out("b.lp"), "2\na/img.png 0 0 1\nb/img.tif 1 0 1\n");
    EXPECT_TRUE(
        ended(tangipaint({"relight", stack.truth(), "--lights", stack.out("b.lp"), "--out", stack.out("e")}),
              1, {"b.lp", "two photographs have the stem 'img'"}));
    EXPECT_FALSE(fs::exists(stack.out("e")));
}

TEST(CliRelight, ASweepIsAFilmOfALampThatMoves) {
    const TinyStack stack(use_srgb);
    const Surface s = read_painting(stack.truth());
    const auto sweep = [&](const std::string& out, std::vector<std::string> flags) {
        flags.insert(flags.begin(),
                     {"relight", stack.truth(), "--out", stack.out(out), "--frame-rate", "10"});
        return tangipaint(flags);
    };
    const Finished run = sweep("frames", {"--sweep=0,30", "--sweep=90,30", "--seconds", "0.5"});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(run.json()["frames"], 5);
    EXPECT_EQ(names_in(stack.out("frames")).size(), 5u);
    const float up = std::tan(30 * std::numbers::pi_v<float> / 180);
    const std::vector<Light> last = {distant_light(Vec3(0, 1, up))};
    EXPECT_TRUE(images_near(read_picture(stack.out("frames/frame-00005.png")),
                            expected_picture(s, last, Transfer{Transfer::Kind::srgb}), 0.51 / 255));
    ASSERT_TRUE(ended(sweep("round.mp4", {"--sweep=0,30", "--seconds", "0.4", "--light=0,0,1"}), 0));
    EXPECT_EQ(bytes_of(stack.out("round.mp4")).substr(4, 4), "ftyp");
    ASSERT_TRUE(ended(sweep("small", {"--sweep=0,30", "--seconds", "0.1", "--frames-width", "16"}), 0));
    EXPECT_LE(read_picture(stack.out("small/frame-00001.png")).width(), 16);

    EXPECT_TRUE(ended(sweep("x.mp4", {"--sweep=0,-5"}), 2, {"--sweep 0,-5", "elevation"}));
    EXPECT_TRUE(ended(sweep("x.mp4", {"--sweep=north"}), 2, {"--sweep north", "AZIMUTH,ELEVATION"}));
    EXPECT_TRUE(ended(sweep("x.mp4", {"--sweep=0,9", "--lights", "a.lp"}), 2, {"--sweep"}));
    EXPECT_TRUE(ended(sweep("x.mp4", {"--sweep=0,9", "--encoding", "linear"}), 2, {"--encoding", "sRGB"}));
    EXPECT_TRUE(ended(sweep("none/x.mp4", {"--sweep=0,9"}), 1, {"none/x.mp4"}));
    EXPECT_TRUE(ended(sweep("frames", {"--sweep=0,9"}), 1, {"has frames already"}));
    EXPECT_FALSE(fs::exists(stack.out("x.mp4")));
}

TEST(CliRelight, WhatCannotBeWrittenIsSaidAndNothingIsLeft) {
    const TinyStack stack;
    const auto refused = [&](const std::string& out, const std::vector<std::string>& said,
                             std::vector<std::string> flags = {}, int code = 1) {
        flags.insert(flags.begin(), {"relight", stack.truth(), "--light", "0,0,1", "--out", out});
        EXPECT_TRUE(ended(tangipaint(flags), code, said)) << out;
        EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
        EXPECT_FALSE(fs::is_regular_file(out));
    };
    refused(stack.out("a.gif"), {"a.gif", ".png, .tif, .jpg or .exr"}, {}, 2);
    refused(stack.out("a"), {".png, .tif, .jpg or .exr"}, {}, 2);
    refused(stack.out("a.exr"), {"a.exr", "linear light", "--encoding linear"}, {"--encoding", "srgb"});
    refused(stack.out("none/a.png"), {"a.png", "there is no folder"});
    refused(stack.truth() + "/a.png", {"a.png", "there is no folder"});
    EXPECT_TRUE(ended(tangipaint({"relight", stack.truth(), "--light", "0,0,1", "--out", stack.out("a.png"),
                                  "--encoding", "log"}),
                      2, {"--encoding log", "[0.2, 5]"}));
}

TEST(CliRelight, AResidualThatGainsNothingIsNotStoredAndThePictureIsTheSurfaces) {
    const TinyStack stack;
    const auto relit = [&](const std::string& painting, bool with_residual, const std::string& name) {
        std::vector<std::string> words = {"relight",     painting, "--light",
                                          "0.5,0.3,0.8", "--out",  stack.out(name)};
        if (with_residual) words.emplace_back("--residual");
        return tangipaint(words);
    };
    EXPECT_TRUE(ended(relit(stack.truth(), true, "never.png"), 1, {"has no part 'residual'"}));
    // Bounds that no residual meets.
    const std::string tried = stack.out("tried.exr");
    const Finished fit =
        tangipaint({"fit", stack.path(), "--residual", "--residual-min-gain-db", "20", "--transfer", "linear",
                    "--register", "off", "--lights-as-given", "--out", tried});
    ASSERT_TRUE(fit.code == 0 || fit.code == 3) << fit.err;
    ASSERT_EQ(fit.json()["residual"]["used"], false) << fit.out;
    const Finished run = relit(tried, true, "a.png");
    ASSERT_TRUE(ended(run, 0, {"the fit found none"}));
    EXPECT_EQ(run.json()["warnings"].size(), 1u);
    ASSERT_TRUE(ended(relit(tried, false, "b.png"), 0));
    EXPECT_EQ(bytes_of(stack.out("a.png")), bytes_of(stack.out("b.png")));
}

TEST(CliRelight, ALightWhoseHeightIsLostIsRefused) {
    const TinyStack stack;
    const auto run = [&](const std::string& light) {
        return tangipaint({"relight", stack.truth(), "--light", light, "--out", stack.out("a.png")});
    };
    EXPECT_TRUE(ended(run("1e300,0,1"), 2, {"--light 1e300,0,1", "too far apart"}));
    EXPECT_TRUE(ended(run("1e300,0,1e300"), 0));
    EXPECT_TRUE(ended(run("1e-300,0,1"), 0));
}

}  // namespace
}  // namespace tangi
