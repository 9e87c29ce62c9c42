// frames_test.cpp: dark frames, flat fields and ambient light come off in linear light; clipped stays
// clipped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "capture/radiometry/develop_stack.h"
#include "capture/stack/survey.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
namespace fs = std::filesystem;

constexpr int kFrameWidth = 40, kFrameHeight = 150;  // more rows than are read at a time

using PixelFunction = std::function<double(int x, int y, int channel)>;

Image<Rgb> picture_of(const PixelFunction& scene) {
    Image<Rgb> picture(kFrameWidth, kFrameHeight);
    for (int y = 0; y < kFrameHeight; ++y)
        for (int x = 0; x < kFrameWidth; ++x)
            for (int c = 0; c < 3; ++c) picture(x, y)[c] = static_cast<float>(scene(x, y, c));
    return picture;
}

double vignette(int x, int y, int c) {
    const double u = (x - kFrameWidth / 2.0) / kFrameWidth, v = (y - kFrameHeight / 2.0) / kFrameHeight;
    return 0.8 - 0.9 * (u * u + v * v) + 0.03 * c;
}
double dark(int x, int, int c) { return 0.01 + 0.002 * c + (x == 7 ? 0.05 : 0); }
double ambient(int x, int, int) { return 0.02 + 0.0005 * x; }
double truth(int photo, int x, int y, int c) {
    return 0.1 + 0.1 * photo + 0.002 * y + 0.1 * c * x / kFrameWidth;
}

// Photographs as a sensor with a dark signal, behind a lens that vignettes, stores them.
struct Scenes {
    TestDir dir;
    std::vector<Light> lights = dome_lights(4);
    Transfer transfer;

    explicit Scenes(Transfer encoding = {}) : transfer(encoding) {
        for (int i = 0; i < 4; ++i)
            save(lights[static_cast<std::size_t>(i)].name, [&](int x, int y, int c) {
                return dark(x, y, c) + vignette(x, y, c) * (truth(i, x, y, c) + ambient(x, y, c));
            });
        write_lights(dir / "lights.lp", lights);
        fs::create_directory(dir / "frames");
        save("frames/dark.png", dark);
        save("frames/flat.png", [](int x, int y, int c) { return dark(x, y, c) + 0.7 * vignette(x, y, c); });
        save("frames/ambient.png",
             [](int x, int y, int c) { return dark(x, y, c) + vignette(x, y, c) * ambient(x, y, c); });
    }
    void save(const std::string& name, const PixelFunction& scene) const {
        write_picture(dir / name, picture_of(scene), transfer, {.bits = 16});
    }
    DevelopOptions frames() const {
        return {.dark = dir / "frames/dark.png",
                .flat = dir / "frames/flat.png",
                .ambient = dir / "frames/ambient.png"};
    }
    Stack open(const DevelopOptions& options) const {
        return open_stack(dir.path(), {.transfer = transfer, .develop = options});
    }
};

// The mean of the vignette: what development keeps of it.
double mean_vignette(int c) {
    double sum = 0;
    for (int y = 0; y < kFrameHeight; ++y)
        for (int x = 0; x < kFrameWidth; ++x) sum += vignette(x, y, c);
    return sum / (kFrameWidth * kFrameHeight);
}

void expect_truth(const Stack& stack, double tolerance) {
    const double mean[3] = {mean_vignette(0), mean_vignette(1), mean_vignette(2)};
    StackReader reader(stack);
    for (int y0 = 0; y0 < kFrameHeight; y0 += 37) {
        const Band band = reader.read(y0, std::min(y0 + 37, kFrameHeight), Transfer{});
        double worst = 0;
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c)
                for (int y = y0; y < band.y1(); ++y)
                    for (int x = 0; x < kFrameWidth; ++x)
                        worst = std::max(
                            worst, std::abs(double(band.row(i, c, y)[x]) - mean[c] * truth(i, x, y, c)));
        EXPECT_LT(worst, tolerance) << "from row " << y0;
    }
}

TEST(Frames, GiveLinearLightBackUpToTheRoundingOfTheFiles) {
    const Scenes scenes;
    Stack stack = scenes.open(scenes.frames());
    EXPECT_FALSE(stack.development);
    const DevelopReport report = develop_stack(stack);
    EXPECT_TRUE(report.developed);
    EXPECT_EQ(stack.bits, 32);
    EXPECT_EQ(stack.transfer, Transfer{});
    EXPECT_THAT(stack.warnings, IsEmpty());
    expect_truth(stack, 1.5e-4);  // a few codes of 16 bits, divided by down to 0.5
    EXPECT_NEAR(report.dark->mean, 0.012 + 0.05 / kFrameWidth, 1e-4);
    EXPECT_EQ(report.flat->unusable, 0);
    EXPECT_GT(report.flat->darkest, 0.4);
    EXPECT_GT(report.ambient->mean, 0.01);
    EXPECT_EQ(report.scratch_bytes, 3u * kFrameWidth * kFrameHeight * 3 * sizeof(float));
}

TEST(Frames, AreTakenInLinearLightOfEncodedFilesToo) {
    const Scenes scenes({Transfer::Kind::srgb});
    Stack stack = scenes.open(scenes.frames());
    const DevelopReport report = develop_stack(stack);
    EXPECT_EQ(report.encoding.transfer.name(), "srgb");
    expect_truth(stack, 3e-4);
}

TEST(Frames, AreDoneInBandsOfAnyHeightAndBackwards) {
    const Scenes scenes;
    Stack stack = scenes.open(scenes.frames());
    develop_stack(stack);
    const Band whole = StackReader(stack).read(0, kFrameHeight, Transfer{});
    StackReader reader(stack);
    for (const int y : {90, 3, 149, 64, 0})
        for (int i = 0; i < 4; ++i)
            EXPECT_EQ(*reader.read(y, y + 1, Transfer{}).row(i, 1, y), *whole.row(i, 1, y)) << y;
}

TEST(Frames, OfAFolderAreAveraged) {
    const Scenes scenes;
    fs::create_directory(scenes.dir / "darks");
    scenes.save("darks/a.png", [](int x, int y, int c) { return dark(x, y, c) + 0.005; });
    scenes.save("darks/b.png", [](int x, int y, int c) { return dark(x, y, c) - 0.005; });
    DevelopOptions options = scenes.frames();
    options.dark = scenes.dir / "darks";
    Stack stack = scenes.open(options);
    EXPECT_EQ(develop_stack(stack).dark->files.size(), 2u);
    expect_truth(stack, 1.5e-4);
}

TEST(Frames, KeepClippedValuesApartFromAllOthers) {
    const Scenes scenes;
    // In photograph 0, one value at the sensor's limit in the bright middle and one in the dim corner; beside
    // each a value just below the limit.
    const int mx = kFrameWidth / 2, my = kFrameHeight / 2;
    scenes.save(scenes.lights[0].name, [&](int x, int y, int c) {
        if ((x == mx && y == my) || (x == 0 && y == 0)) return 1.0;
        if ((x == mx + 1 && y == my) || (x == 1 && y == 0)) return 0.985;
        return dark(x, y, c) + vignette(x, y, c) * 0.3;
    });
    Stack stack = scenes.open({.dark = scenes.frames().dark, .flat = scenes.frames().flat});
    develop_stack(stack);
    const float clipped = stack.development->clipped;
    const Band band = StackReader(stack).read(0, kFrameHeight, Transfer{});
    EXPECT_GE(band.row(0, 1, my)[mx], clipped);
    EXPECT_GE(band.row(0, 1, 0)[0], clipped);
    EXPECT_LT(band.row(0, 1, my)[mx + 1], clipped);
    EXPECT_LT(band.row(0, 1, 0)[1], clipped);
    EXPECT_GT(band.row(0, 1, 0)[1], 1.2f);  // the corner is brighter than full scale now, and yet not clipped
    EXPECT_NEAR(survey(stack).photos[0].clipped, 2.0 / (kFrameWidth * kFrameHeight), 1e-9);
    EXPECT_EQ(survey(stack).photos[1].clipped, 0);
}

TEST(Frames, OfFloatsDoNotClip) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(4);
    for (Light& light : lights) {
        light.name = fs::path(light.name).stem().string() + ".exr";
        write_picture(dir / light.name, Image<Rgb>(8, 8, Rgb(3.0f)), {});
    }
    write_lights(dir / "lights.lp", lights);
    fs::create_directory(dir / "frames");
    write_picture(dir / "frames/dark.exr", Image<Rgb>(8, 8, Rgb(0.5f)), {});
    Stack stack = open_stack(dir.path(), {.develop = {.dark = dir / "frames/dark.exr"}});
    develop_stack(stack);
    EXPECT_EQ(stack.development->clipped, std::numeric_limits<float>::infinity());
    EXPECT_EQ(StackReader(stack).read(0, 8, Transfer{}).row(2, 1, 3)[3], 2.5f);
}

TEST(Frames, DustInTheFlatFieldIsNotMeasured) {
    const Scenes scenes;
    scenes.save("frames/flat.png", [](int x, int y, int c) {
        return x == 5 && y == 5 ? 0.0 : dark(x, y, c) + 0.7 * vignette(x, y, c);
    });
    Stack stack = scenes.open(scenes.frames());
    develop_stack(stack);
    const Band band = StackReader(stack).read(0, 10, Transfer{});
    EXPECT_TRUE(std::isnan(band.row(0, 0, 5)[5]));
    EXPECT_FALSE(std::isnan(band.row(0, 0, 5)[6]));
    ASSERT_EQ(stack.warnings.size(), 1u);
    EXPECT_THAT(stack.warnings[0], HasSubstr("flat.png"));
}

TEST(Frames, NotAskedForChangeNothing) {
    const Scenes scenes;
    Stack stack = scenes.open({});
    EXPECT_FALSE(develop_stack(stack).developed);
    EXPECT_FALSE(stack.development);
    EXPECT_EQ(stack.bits, 16);
    EXPECT_TRUE(to_json(DevelopReport{}).is_null());
}

TEST(Frames, ThatDoNotFitAreErrorsThatNameTheFile) {
    const Scenes scenes;
    const auto trouble = [&](const DevelopOptions& options) {
        Stack stack = scenes.open(options);
        return error_of([&] { develop_stack(stack); });
    };
    const auto file = [&](const char* name) { return scenes.dir / "frames" / name; };
    EXPECT_THAT(trouble({.dark = file("none.png")}),
                AllOf(HasSubstr("none.png"), HasSubstr("no such dark frame")));
    fs::create_directory(scenes.dir / "empty");
    EXPECT_THAT(trouble({.flat = scenes.dir / "empty"}), AllOf(HasSubstr("empty"), HasSubstr("no picture")));

    write_picture(file("small.png"), Image<Rgb>(20, 10, Rgb(0.5f)), {});
    EXPECT_THAT(trouble({.flat = file("small.png")}),
                AllOf(HasSubstr("small.png"), HasSubstr("20 x 10"), HasSubstr("40 x 150")));
    write_map(file("grey.png"), Image<float>(kFrameWidth, kFrameHeight, 0.5f));
    EXPECT_THAT(trouble({.flat = file("grey.png")}), AllOf(HasSubstr("grey.png"), HasSubstr("grey")));

    scenes.save("frames/black.png", [](int, int, int) { return 0.0; });
    EXPECT_THAT(trouble({.flat = file("black.png")}), AllOf(HasSubstr("black.png"), HasSubstr("is black")));
    EXPECT_THAT(trouble({.dark = file("dark.png"), .flat = file("dark.png")}),
                HasSubstr("dark frame is taken off"));
    scenes.save("frames/half.png", [](int x, int, int) { return x < 10 ? 0.0 : 0.5; });
    EXPECT_THAT(trouble({.flat = file("half.png")}), AllOf(HasSubstr("half.png"), HasSubstr("25 %")));
    scenes.save("frames/bright.png", [](int x, int, int) { return x < 10 ? 1.0 : 0.5; });
    EXPECT_THAT(trouble({.flat = file("bright.png")}),
                AllOf(HasSubstr("bright.png"), HasSubstr("25 %"), HasSubstr("clipped")));

    EXPECT_THAT(trouble({.dark = file("flat.png")}), AllOf(HasSubstr("flat.png"), HasSubstr("lens covered")));
    EXPECT_THAT(trouble({.ambient = scenes.dir / scenes.lights[3].name}),
                AllOf(HasSubstr(scenes.lights[3].name), HasSubstr("light must be off")));
}

TEST(Frames, ThatAreDoubtfulAreWarnedOf) {
    const Scenes scenes;
    scenes.save("frames/bright.png", [](int, int, int) { return 0.3; });
    Stack stack = scenes.open({.dark = scenes.dir / "frames/bright.png"});
    develop_stack(stack);
    ASSERT_EQ(stack.warnings.size(), 1u);
    EXPECT_THAT(stack.warnings[0], AllOf(HasSubstr("bright.png"), HasSubstr("lens covered")));
    scenes.save("frames/lit.png", [](int, int, int) { return 0.2; });
    stack = scenes.open({.ambient = scenes.dir / "frames/lit.png"});
    develop_stack(stack);
    ASSERT_EQ(stack.warnings.size(), 1u);
    EXPECT_THAT(stack.warnings[0], AllOf(HasSubstr("lit.png"), HasSubstr("ambient")));
}

TEST(ScratchFile, LeavesNoNameBehindAndSaysWhenTheDiskIsFull) {
    const TestDir dir;
    const char* before = std::getenv("TMPDIR");
    const std::string old = before ? before : "";
    ::setenv("TMPDIR", dir.path().c_str(), 1);
    {
        ScratchFile file(1000, "tests");
        const std::vector<std::byte> bytes(10, std::byte{42});
        file.write(990, bytes);
        std::vector<std::byte> back(10);
        file.read(990, back);
        EXPECT_EQ(back, bytes);
        file.read(0, back);
        EXPECT_EQ(back, std::vector<std::byte>(10));  // new room is zero
        EXPECT_THAT(names_in(dir.path()), IsEmpty());
        EXPECT_THROW(file.write(995, bytes), ContractError);
    }
    {
        const FullDisk full(1 << 20);
        EXPECT_THAT(
            error_of([] { ScratchFile(2 << 20, "60 raws"); }),
            AllOf(StartsWith(dir.path().string()), HasSubstr("60 raws need 2.1 MB"), HasSubstr("TMPDIR")));
    }
    ::setenv("TMPDIR", (dir / "missing").c_str(), 1);
    EXPECT_THAT(error_of([] { ScratchFile(10, "x"); }), HasSubstr("no temporary file"));
    before ? ::setenv("TMPDIR", old.c_str(), 1) : ::unsetenv("TMPDIR");
}

}  // namespace
}  // namespace tangi
