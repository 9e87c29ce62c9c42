// full_scale_test.cpp: what is full scale of photographs whose files do not say, by their values.
#include "capture/radiometry/full_scale.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include "capture/radiometry/transfer_estimate.h"
#include "datasets/generator.h"
#include "surface/image_file/icc_profile.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

constexpr int kScaleSide = 48;
constexpr Transfer kScaleSrgb{Transfer::Kind::srgb};

// How photographs are stored: encoded, times `top`, in numbers of this type.
struct StoredAs {
    OIIO::TypeDesc type = OIIO::TypeDesc::UINT16;
    double top = 1;  // of the file's own full scale, or of 1
    Transfer transfer{};
    double exposure = 1;
    bool whole = false;  // numbers without a fraction
    std::string profile{};
};

// Photographs of matt bumps of all colours, a tenth of them bright enough to be clipped at exposure 1.
void write_scaled_stack(const TestDir& dir, const StoredAs& as, const char* extension = ".tif") {
    Random random(1);
    Image<Vec3> normal(kScaleSide, kScaleSide);
    Image<Rgb> diffuse(kScaleSide, kScaleSide);
    for (Vec3& n : normal.pixels()) n = random.direction(0.85);
    for (Rgb& c : diffuse.pixels())
        c = {random.real(0.05, 1.2), random.real(0.05, 1.2), random.real(0.05, 1.2)};
    std::vector<Light> lights = dome_lights(20, 25);
    for (Light& light : lights) {
        light.name.replace(light.name.find(".png"), 4, extension);
        OIIO::ImageSpec spec(kScaleSide, kScaleSide, 3, as.type);
        if (!as.profile.empty())
            spec.attribute("ICCProfile",
                           OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(as.profile.size())),
                           as.profile.data());
        std::vector<float> values;
        for (std::size_t i = 0; i < normal.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const float shade = std::max(0.0f, glm::dot(normal.pixels()[i], light.direction));
                const float linear =
                    std::min(static_cast<float>(as.exposure) * diffuse.pixels()[i][c] * shade, 1.0f);
                const double stored = static_cast<double>(as.transfer.encode(linear)) * as.top;
                values.push_back(static_cast<float>(as.whole ? std::round(stored) : stored));
            }
        const auto output = OIIO::ImageOutput::create((dir / light.name).string());
        ASSERT_TRUE(output && output->open((dir / light.name).string(), spec));
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
    }
    write_lights(dir / "lights.lp", lights);
}

// The largest value of any photograph, and how much of them is clipped.
std::pair<double, double> largest_and_clipped(const Stack& stack) {
    std::pair<double, double> result{0, 0};
    for (const Survey::Photo& photo : survey(stack).photos) {
        result.first = std::max(result.first, photo.maximum);
        result.second = std::max(result.second, photo.clipped);
    }
    return result;
}

TEST(FullScale, OfFewerBitsThanTheFileHasIsTheirLargestNumber) {
    for (const int bits : {8, 10, 12, 14, 15}) {
        const TestDir dir;
        write_scaled_stack(dir, {.top = (std::exp2(bits) - 1) / 65535});
        Stack stack = open_stack(dir.path());
        ASSERT_TRUE(take_full_scale(stack, survey(stack))) << bits;
        EXPECT_NEAR(stack.full_scale, (std::exp2(bits) - 1) / 65535, 1e-9);
        EXPECT_THAT(stack.warnings, testing::Contains(HasSubstr(fmt::format("as of {} bits", bits))));
        const auto [largest, clipped] = largest_and_clipped(stack);
        EXPECT_NEAR(largest, 1, 1e-4);
        EXPECT_GT(clipped, 0.001);
        EXPECT_FALSE(take_full_scale(stack, survey(stack)));  // once
    }
}

// Black levels taken off, or values scaled by somebody: where several photographs end at the same number.
TEST(FullScale, IsWhereSeveralPhotographsAreClipped) {
    for (const double code : {15871.0, 3583.0, 60000.0}) {
        const TestDir dir;
        write_scaled_stack(dir, {.top = code / 65535});
        Stack stack = open_stack(dir.path());
        ASSERT_TRUE(take_full_scale(stack, survey(stack))) << code;
        EXPECT_NEAR(stack.full_scale, code / 65535, 1e-9);
        EXPECT_GT(largest_and_clipped(stack).second, 0.001);
    }
}

TEST(FullScale, IsThatOfTheFileWhereNothingIsClippedBelowIt) {
    for (const double exposure : {0.2, 0.6, 0.8, 1.0})
        for (const double top : {1.0, 0.7, 0.5}) {
            if (exposure == 1 && top < 1) continue;
            const TestDir dir;
            write_scaled_stack(dir, {.top = top, .exposure = exposure});
            Stack stack = open_stack(dir.path());
            EXPECT_FALSE(take_full_scale(stack, survey(stack))) << exposure << ", " << top;
            EXPECT_EQ(stack.full_scale, 1);
        }
}

// As programs write that make floats of codes, and others that encode floats.
TP_LONG TEST(FullScale, OfFloatsThatAreCodesIsFound) {
    const StoredAs kinds[] = {{OIIO::TypeDesc::FLOAT, 255, kScaleSrgb, 1, true},
                              {OIIO::TypeDesc::FLOAT, 4095, {}, 1, true},
                              {OIIO::TypeDesc::FLOAT, 65535, kScaleSrgb, 0.8, true},
                              {OIIO::TypeDesc::FLOAT, 255, kScaleSrgb, 1, false},
                              {OIIO::TypeDesc::FLOAT, 1, kScaleSrgb, 1, false}};
    for (const StoredAs& as : kinds) {
        const TestDir dir;
        write_scaled_stack(dir, as);
        Stack stack = open_stack(dir.path());
        EXPECT_FALSE(stack.says_linear);
        ASSERT_TRUE(take_full_scale(stack, survey(stack))) << as.top << as.whole;
        EXPECT_EQ(stack.full_scale, as.top);
        EXPECT_EQ(stack.bits, 16);
        EXPECT_THAT(stack.warnings, testing::Contains(HasSubstr("--transfer linear")));
        const Survey surveyed = survey(stack);
        EXPECT_EQ(estimate_transfer(stack, surveyed).transfer.kind, as.transfer.kind) << as.top;
        EXPECT_LE(largest_and_clipped(stack).first, 1);
    }
}

TEST(FullScale, OfFloatsThatAreLightIsNotTouched) {
    for (const double top : {1.0, 3.0, 200.0}) {
        const TestDir dir;
        write_scaled_stack(dir, {OIIO::TypeDesc::FLOAT, top, {}, 1, false});
        Stack stack = open_stack(dir.path());
        EXPECT_FALSE(take_full_scale(stack, survey(stack))) << top;
        EXPECT_EQ(stack.bits, 32);
    }
    const TestDir dir;  // EXR is linear by definition, and what the user says counts
    write_scaled_stack(dir, {OIIO::TypeDesc::FLOAT, 1, kScaleSrgb, 1, false}, ".exr");
    Stack exr = open_stack(dir.path());
    EXPECT_TRUE(exr.says_linear);
    EXPECT_FALSE(take_full_scale(exr, survey(exr)));
    const TestDir other;
    write_scaled_stack(other, {OIIO::TypeDesc::FLOAT, 255, kScaleSrgb, 1, true});
    Stack linear = open_stack(other.path(), {.transfer = Transfer{}});
    EXPECT_FALSE(take_full_scale(linear, survey(linear)));
    Stack srgb = open_stack(other.path(), {.transfer = kScaleSrgb});
    EXPECT_TRUE(take_full_scale(srgb, survey(srgb)));
}

// A profile says what values are, whatever they are stored as.
TEST(FullScale, OfFloatsWithAProfileIsThatOfTheProfile) {
    const TestDir plain, tagged;
    write_scaled_stack(plain, {OIIO::TypeDesc::FLOAT, 1, {}, 0.8, false});
    write_scaled_stack(tagged, {OIIO::TypeDesc::FLOAT, 1, kScaleSrgb, 0.8, false, srgb_icc_profile()});
    Stack linear = open_stack(plain.path()), encoded = open_stack(tagged.path());
    EXPECT_TRUE(encoded.says_linear);
    EXPECT_EQ(encoded.bits, 32);
    EXPECT_THAT(encoded.warnings, testing::Contains(HasSubstr("stored as srgb by its colour profile")));
    EXPECT_THAT(linear.warnings, SizeIs(0));
    const Survey a = survey(linear), b = survey(encoded);
    EXPECT_FALSE(take_full_scale(encoded, b));
    ASSERT_EQ(a.values.size(), b.values.size());
    for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 2e-3);
    // What is clipped has no sample.
    const TestDir bright;
    write_scaled_stack(bright, {OIIO::TypeDesc::FLOAT, 1, kScaleSrgb, 1, false, srgb_icc_profile()});
    const Stack stack = open_stack(bright.path());
    const Survey surveyed = survey(stack);
    double least = 1;
    for (const Survey::Photo& photo : surveyed.photos) {
        least = std::min(least, photo.present);
        EXPECT_LT(photo.maximum, 1);
    }
    EXPECT_LT(least, 0.999);
}

}  // namespace
}  // namespace tangi
