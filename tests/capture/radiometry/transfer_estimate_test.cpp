// transfer_estimate_test.cpp: the curve that rendered stacks were stored with is recognised.
#include "capture/radiometry/transfer_estimate.h"

#include <gtest/gtest.h>

#include <iostream>

#include "datasets/generator.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Photographs of matt bumps of all colours, with noise, stored with `transfer`.
void write_matt_stack(const TestDir& dir, const Transfer& transfer, double noise,
                      const PictureStorage& storage) {
    constexpr int size = 40;
    Random random(1);
    Image<Vec3> normal(size, size);
    Image<Rgb> diffuse(size, size);
    for (Vec3& n : normal.pixels()) n = random.direction(0.85);
    for (Rgb& c : diffuse.pixels()) c = {random.real(0.1, 0.8), random.real(0.1, 0.8), random.real(0.1, 0.8)};
    const std::vector<Light> lights = dome_lights(24, 25);
    for (const Light& light : lights) {
        Image<Rgb> photo(size, size);
        for (std::size_t i = 0; i < photo.size(); ++i)
            for (int c = 0; c < 3; ++c)
                photo.pixels()[i][c] =
                    diffuse.pixels()[i][c] * std::max(0.0f, glm::dot(normal.pixels()[i], light.direction)) +
                    static_cast<float>(noise * random.normal());
        write_picture(dir / light.name, photo, transfer, storage);
    }
    write_lights(dir / "lights.lp", lights);
}

Transfer::Kind estimated_kind(const Transfer& transfer, double noise, const PictureStorage& storage) {
    const TestDir dir;
    write_matt_stack(dir, transfer, noise, storage);
    const Stack stack = open_stack(dir.path());
    const TransferEstimate e = estimate_transfer(stack, survey(stack));
    EXPECT_EQ(e.source, "estimated");
    EXPECT_GE(e.candidates.size(), 7u);
    EXPECT_EQ(e.candidates[0].transfer, Transfer{});
    for (const auto& candidate : e.candidates) {
        EXPECT_TRUE(candidate.residual >= 0) << candidate.transfer.name();
        if (candidate.transfer == e.transfer) {
            // Noise and quantisation are all that the right curve leaves: half a code, and noise times the
            // largest slope of the encoder where the stack has values (5 at 0.02).
            EXPECT_LE(candidate.residual, 5 * noise + 0.5 / 255);
        } else {
            EXPECT_GT(candidate.residual, 0) << candidate.transfer.name();
        }
    }
    return e.transfer.kind;
}

TEST(TransferEstimate, RecognisesLinearLight) {
    EXPECT_EQ(estimated_kind({Transfer::Kind::linear}, 0.003, {.bits = 16}), Transfer::Kind::linear);
    EXPECT_EQ(estimated_kind({Transfer::Kind::linear}, 0.003, {.bits = 8}), Transfer::Kind::linear);
}

TEST(TransferEstimate, RecognisesSrgb) {
    EXPECT_EQ(estimated_kind({Transfer::Kind::srgb}, 0.001, {.bits = 16}), Transfer::Kind::srgb);
    // At 8 bits and more noise it may be taken for its neighbour, gamma 2.2, but not for linear light.
    EXPECT_NE(estimated_kind({Transfer::Kind::srgb}, 0.003, {.bits = 8}), Transfer::Kind::linear);
}

TEST(TransferEstimate, RecognisesGamma) {
    EXPECT_EQ(estimated_kind({Transfer::Kind::gamma, 2.2}, 0.001, {.bits = 16}), Transfer::Kind::gamma);
    EXPECT_NE(estimated_kind({Transfer::Kind::gamma, 2.2}, 0.003, {.bits = 8}), Transfer::Kind::linear);
}

TEST(TransferEstimate, TakesTheCurveThatIsGiven) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4));
    const Transfer given{Transfer::Kind::gamma, 1.8};
    const Stack stack = open_stack(dir.path(), {.transfer = given});
    const TransferEstimate e = estimate_transfer(stack, survey(stack));
    EXPECT_EQ(e.transfer, given);
    EXPECT_EQ(e.source, "given");
    EXPECT_TRUE(e.candidates.empty());
}

TEST(TransferEstimate, TakesFilesOfFloatsForLinear) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(4);
    for (Light& light : lights) {
        light.name.replace(light.name.find(".png"), 4, ".exr");
        write_picture(dir / light.name, Image<Rgb>(5, 5, Rgb(0.5f)), Transfer{});
    }
    write_lights(dir / "lights.lp", lights);
    const Stack stack = open_stack(dir.path());
    const TransferEstimate e = estimate_transfer(stack, survey(stack));
    EXPECT_EQ(e.transfer.kind, Transfer::Kind::linear);
    EXPECT_EQ(e.source, "float file");
}

TEST(DataTransferEstimate, AgreesWithWhatIsKnownOfTheStacks) {
    TP_DATA(data, "real");
    // What shared/data/README.md says of them.
    const std::pair<const char*, bool> stacks[] = {{"icon", false}, {"fresco", true}, {"canvas", true}};
    for (const auto& [name, is_linear] : stacks) {
        const Stack stack = open_stack(data / name);
        const TransferEstimate e = estimate_transfer(stack, survey(stack));
        EXPECT_EQ(e.transfer.kind == Transfer::Kind::linear, is_linear) << name << ": " << e.transfer.name();
    }
}

TP_LONG TEST(TransferEstimate, FindsAGammaThatIsNoneOfTheUsual) {
    for (const double gamma : {1.4, 1.8, 2.8}) {
        const TestDir dir;
        write_matt_stack(dir, {Transfer::Kind::gamma, gamma}, 0.002, {.bits = 16});
        const Stack stack = open_stack(dir.path());
        const TransferEstimate e = estimate_transfer(stack, survey(stack));
        EXPECT_EQ(e.transfer.kind, Transfer::Kind::gamma);
        EXPECT_NEAR(e.transfer.gamma, gamma, 0.04 * gamma);
        EXPECT_EQ(e.warning, "");
    }
}

// Largest difference of decoded values after the best common factor, which light strength takes up.
double difference_up_to_scale(const Transfer& a, const Transfer& b) {
    double ab = 0, bb = 0, largest = 0;
    for (int i = 1; i <= 100; ++i) {
        const double x = a.decode(i / 100.0f), y = b.decode(i / 100.0f);
        ab += x * y;
        bb += y * y;
    }
    for (int i = 1; i <= 100; ++i)
        largest = std::max(largest, std::abs(a.decode(i / 100.0f) - ab / bb * b.decode(i / 100.0f)));
    return largest;
}

TP_LONG TEST(TransferEstimate, FindsAToneCurve) {
    for (const Transfer& truth :
         {Transfer{Transfer::Kind::curve, 1.4, 0, 3.4}, Transfer{Transfer::Kind::curve, 0.8, 2.5, 0}}) {
        const TestDir dir;
        write_matt_stack(dir, truth, 0.002, {.bits = 16});
        const Stack stack = open_stack(dir.path());
        const TransferEstimate e = estimate_transfer(stack, survey(stack));
        EXPECT_EQ(e.transfer.kind, Transfer::Kind::curve)
            << truth.name() << ": " << e.transfer.name() << " " << e.candidates.back().residual;
        EXPECT_LT(difference_up_to_scale(truth, e.transfer), 0.03) << e.transfer.name();
        EXPECT_NE(e.warning.find("tone curve"), std::string::npos);
    }
}

TEST(TransferEstimate, WarnsWhereLinearAndEncodedFitAlike) {
    // One grey level: whatever the curve, a flat surface under lights of one elevation looks the same.
    const TestDir dir;
    std::vector<Light> lights;
    for (int i = 0; i < 8; ++i)
        lights.push_back(distant_light(
            {static_cast<float>(std::cos(i * 0.785)), static_cast<float>(std::sin(i * 0.785)), 1.0f},
            fmt::format("{}.png", i)));
    Random random(4);
    for (const Light& light : lights) {
        Image<Rgb> photo(24, 24);
        for (Rgb& pixel : photo.pixels()) pixel = Rgb(0.4f + 0.002f * random.real(-1, 1));
        write_picture(dir / light.name, photo, {}, {.bits = 16});
    }
    write_lights(dir / "lights.lp", lights);
    const Stack stack = open_stack(dir.path());
    const TransferEstimate e = estimate_transfer(stack, survey(stack));
    EXPECT_NE(e.warning.find("--transfer"), std::string::npos)
        << e.candidates[0].residual << " " << e.candidates[1].residual;
}

// Lights at one and a half picture widths, of unequal strength, and light between relief: seen as if they
// were equal, sRGB looks like a gamma of about 1.5.
TP_LONG TEST(TransferEstimate, NearLightsDoNotContradictWhatFilesState) {
    const TestDir dir;
    const PaintingTruth truth =
        procedural_painting({.seed = 3198, .width = 220, .height = 160, .mm_per_pixel = 0.4, .impasto = 0.3});
    GeneratorOptions options{.seed = 3198, .lights = 12, .held_out = 0, .format = GeneratorFormat::jpg};
    options.transfer = Transfer{Transfer::Kind::srgb};
    options.distance = 1.5;
    options.gain_min = 0.7, options.gain_max = 1.42;
    options.interreflection = 0.3, options.white_level = 0.5;
    write_stack(dir.path(), truth, options);
    const Stack stack = open_stack(dir.path());
    const Survey samples = survey(stack);
    const TransferEstimate e = estimate_transfer(stack, samples);
    EXPECT_EQ(e.transfer, options.transfer) << e.transfer.name();
    const TransferEstimate another{{Transfer::Kind::gamma, 1.5}, "estimated", {}, {}};
    EXPECT_FALSE(speaks_against(options.transfer, another, stack, samples));
}

// Four photographs have one number a pixel more than a matt pixel has: gloss and shadows decide then.
TP_LONG TEST(TransferEstimate, IsOpenWhereFourPhotographsHardlyTell) {
    const auto of = [](int lights, const auto& use) {
        const TestDir dir;
        const PaintingTruth truth = procedural_painting({.seed = 3, .width = 160, .height = 120});
        write_stack(
            dir.path(), truth,
            {.seed = 3, .lights = lights, .held_out = 0, .format = GeneratorFormat::jpg, .jpeg_quality = 60});
        const Stack stack = open_stack(dir.path());
        const Survey samples = survey(stack);
        use(stack, samples, estimate_transfer(stack, samples));
    };
    of(4, [](const Stack& stack, const Survey& samples, const TransferEstimate& e) {
        EXPECT_FALSE(speaks_against(Transfer{}, e, stack, samples));
        EXPECT_FALSE(speaks_against(Transfer{Transfer::Kind::srgb}, e, stack, samples));
        EXPECT_NE(e.warning.find("--transfer"), std::string::npos) << e.warning;
    });
    of(24, [](const Stack& stack, const Survey& samples, const TransferEstimate& e) {
        EXPECT_EQ(e.transfer, Transfer{});
        EXPECT_TRUE(speaks_against(Transfer{Transfer::Kind::srgb}, e, stack, samples));
        EXPECT_EQ(e.warning, "");
    });
}

TEST(DataTransferEstimate, CallsTheRealStacksAsTheyAre) {
    TP_DATA(folder, "real");
    for (const char* name : {"door", "fresco", "icon", "canvas", "leaf", "coin"}) {
        Stack stack = open_stack(folder / name);
        Survey surveyed = survey(stack);
        leave_out_black_photos(stack, surveyed);
        const TransferEstimate e = estimate_transfer(stack, surveyed);
        EXPECT_EQ(e.transfer.name(), std::string(name) == "icon" ? "gamma 2.2" : "linear") << name;
    }
}

TEST(DataTransferEstimate, FindsTheGammaThatAPaintingWasEncodedWith) {
    TP_DATA(folder, "impasto/png16");
    const Stack original = open_stack(folder, {.lights_file = folder / "lights.lp"});
    for (const Transfer& truth : {Transfer{Transfer::Kind::gamma, 1.0}, Transfer{Transfer::Kind::gamma, 1.4},
                                  Transfer{Transfer::Kind::gamma, 1.8}, Transfer{Transfer::Kind::gamma, 2.2},
                                  Transfer{Transfer::Kind::srgb}}) {
        const TestDir dir;
        std::vector<Light> lights;
        for (const StackPhoto& photo : original.photos) {
            lights.push_back(photo.light);
            lights.back().name = photo.path.stem().string() + ".jpg";
            write_picture(dir / lights.back().name, read_picture(photo.path), truth, {});
        }
        write_lights(dir / "lights.lp", lights);
        const Stack stack = open_stack(dir.path());
        const TransferEstimate e = estimate_transfer(stack, survey(stack));
        std::cout << "[  FIGURE  ] encoded as " << truth.name() << ", found " << e.transfer.name() << "\n";
        if (truth.kind == Transfer::Kind::srgb) {
            EXPECT_EQ(e.transfer.kind, truth.kind);
            continue;
        }
        const double gamma = e.transfer.kind == Transfer::Kind::linear ? 1.0 : e.transfer.gamma;
        EXPECT_NE(e.transfer.kind, Transfer::Kind::srgb);
        EXPECT_NEAR(gamma, truth.gamma, 0.04 * truth.gamma);
    }
}

}  // namespace
}  // namespace tangi
