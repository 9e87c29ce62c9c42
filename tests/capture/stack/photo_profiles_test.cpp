// photo_profiles_test.cpp: photographs with several ICC profiles mean the same colours.
#include "capture/stack/photo_profiles.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcms2.h>

#include "capture/radiometry/transfer_decision.h"
#include "capture/stack/profile_colours.h"
#include "capture/stack/survey.h"
#include "surface/image_file/icc_profile.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr int kProfileSide = 9;

std::string rgb_profile(const cmsCIExyYTRIPLE& primaries, double gamma) {
    const cmsCIExyY white = {0.3127, 0.3290, 1};
    cmsToneCurve* curve = cmsBuildGamma(nullptr, gamma);
    cmsToneCurve* const curves[3] = {curve, curve, curve};
    const cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, curves);
    cmsUInt32Number size = 0;
    cmsSaveProfileToMem(profile, nullptr, &size);
    std::string bytes(size, '\0');
    cmsSaveProfileToMem(profile, bytes.data(), &size);
    cmsCloseProfile(profile);
    cmsFreeToneCurve(curve);
    return bytes;
}
constexpr cmsCIExyYTRIPLE kAdobe = {{0.64, 0.33, 1}, {0.21, 0.71, 1}, {0.15, 0.06, 1}},
                          kRec709 = {{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}};

// Encoded values of linear Rec. 709 in a profile.
Rgb encoded(const Rgb& linear, const std::string& profile) {
    static const std::string from = rgb_profile(kRec709, 1);
    const ProfileConversion conversion(from, profile, 3, false);
    std::array<float, 3> values = {linear.r, linear.g, linear.b};
    conversion.convert(values);
    return Rgb(values[0], values[1], values[2]);
}

void write_photo(const fs::path& path, const Image<Rgb>& linear, const std::string& encoding,
                 const std::string& tag, int exif_colour = 0) {
    OIIO::ImageSpec spec(linear.width(), linear.height(), 3, OIIO::TypeDesc::UINT16);
    if (!tag.empty())
        spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(tag.size())),
                       tag.data());
    if (exif_colour) spec.attribute("Exif:ColorSpace", exif_colour);
    std::vector<float> values;
    for (const Rgb& pixel : linear.pixels()) {
        const Rgb stored = encoded(pixel, encoding);
        values.insert(values.end(), {stored.r, stored.g, stored.b});
    }
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output && output->open(path.string(), spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
}

Image<Rgb> colours() {
    Image<Rgb> picture(kProfileSide, kProfileSide);
    Random random(8);
    for (Rgb& pixel : picture.pixels())
        pixel = Rgb(random.real(0.05, 0.6), random.real(0.05, 0.6), random.real(0.05, 0.6));
    return picture;
}

struct ProfileStack {
    TestDir dir;
    const std::string adobe = rgb_profile(kAdobe, 563 / 256.0), plain = rgb_profile(kRec709, 563 / 256.0);
    std::vector<Light> lights = dome_lights(6);
    Image<Rgb> picture = colours();

    // Photograph i, in the colours of a profile, says that it has another one.
    void put(int i, const std::string& encoding, const std::string& tag, int exif_colour = 0) {
        Light& light = lights[static_cast<std::size_t>(i)];
        light.name = fs::path(light.name).replace_extension(".tif").string();
        write_photo(dir / light.name, picture, encoding, tag, exif_colour);
    }
    Stack open() {
        write_lights(dir / "lights.lp", lights);
        return open_stack(dir.path());
    }
};

// All photographs as those of the first are stored, within what 16 bits and a whole pixel make of it.
void expect_same_values(const Stack& stack) {
    StackReader reader(stack);
    const Band band = reader.read(0, kProfileSide, Transfer{});
    for (int i = 1; i < band.photos(); ++i)
        for (int c = 0; c < 3; ++c)
            for (int y = 0; y < kProfileSide; ++y)
                for (int x = 0; x < kProfileSide; ++x)
                    ASSERT_NEAR(band.row(i, c, y)[x], band.row(0, c, y)[x], 2e-4)
                        << stack.photos[static_cast<std::size_t>(i)].light.name;
}

TEST(PhotoProfiles, ThatAreTheSameAreLeftAlone) {
    ProfileStack set;
    for (int i = 0; i < 6; ++i) set.put(i, set.adobe, set.adobe);
    const Stack stack = set.open();
    EXPECT_EQ(stack.profiles, nullptr);
    EXPECT_THAT(stack.warnings, IsEmpty());
    for (int i = 0; i < 6; ++i) set.put(i, set.plain, {});
    EXPECT_EQ(set.open().profiles, nullptr);
}

// Whose first tag lies outside of it.
std::string damaged(std::string profile) {
    profile.replace(136, 4, "\xF0\0\0\0", 4);
    return profile;
}

TEST(PhotoProfiles, ThatAreDamagedAreToldAndTakenForNone) {
    ProfileStack set;
    for (int i = 0; i < 6; ++i) set.put(i, set.adobe, i == 2 ? damaged(set.adobe) : set.adobe);
    const Stack one = set.open();
    const std::string name = set.lights[2].name;
    EXPECT_THAT(one.warnings,
                ElementsAre(AllOf(HasSubstr(name + ": its colour profile (ICC) is damaged (its tag '"),
                                  HasSubstr("read as if it had none")),
                            AllOf(HasSubstr("1 photograph has no ICC profile that can be used, and is taken "
                                            "to have that of the others"),
                                  HasSubstr(name))));
    expect_same_values(one);
    for (int i = 0; i < 6; ++i) set.put(i, set.adobe, damaged(set.adobe), 1);
    const Stack all = set.open();
    EXPECT_EQ(all.profiles, nullptr);
    EXPECT_THAT(all.warnings, ElementsAre(AllOf(HasSubstr("colour profile (ICC) is damaged"),
                                                HasSubstr("(so 6 of the photographs)"))));
    EXPECT_EQ(metadata_in(all, all.photos.front().path).icc_profile, "");
}

TEST(PhotoProfiles, ThatDifferAreConvertedToTheMostFrequentOne) {
    ProfileStack set;
    for (int i = 0; i < 6; ++i) set.put(i, i < 4 ? set.adobe : set.plain, i < 4 ? set.adobe : set.plain);
    Stack stack = set.open();
    ASSERT_NE(stack.profiles, nullptr);
    EXPECT_THAT(stack.warnings,
                ElementsAre(AllOf(HasSubstr("2 photographs have another ICC profile than the others"),
                                  HasSubstr("photo_004.tif, photo_005.tif"))));
    expect_same_values(stack);
    const auto colour = colour_of_profiles(stack);
    ASSERT_TRUE(colour);  // Adobe RGB, of all
    EXPECT_NEAR(colour->to_camera[0][0], 0.715, 0.01);
    const TransferEstimate transfer = decide_transfer(stack, survey(stack));
    EXPECT_EQ(transfer.source, "ICC profile");
    EXPECT_NEAR(transfer.transfer.gamma, 2.2, 0.01);
}

// Other tone curves, too.
TEST(PhotoProfiles, OfOtherCurvesAreConverted) {
    ProfileStack set;
    for (int i = 0; i < 6; ++i) {
        const std::string own = i < 5 ? srgb_icc_profile() : rgb_profile(kAdobe, 1.8);
        set.put(i, own, own);
    }
    const Stack stack = set.open();
    expect_same_values(stack);
    EXPECT_FALSE(colour_of_profiles(stack));  // Rec. 709
    EXPECT_EQ(decide_transfer(stack, survey(stack)).transfer.kind, Transfer::Kind::srgb);
}

TEST(PhotoProfiles, ThatAreMissingInAFewAreThoseOfTheOthers) {
    ProfileStack set;
    for (int i = 0; i < 6; ++i) set.put(i, set.adobe, i == 3 ? std::string() : set.adobe);
    Stack stack = set.open();
    EXPECT_THAT(stack.warnings,
                ElementsAre(AllOf(HasSubstr("1 photograph has no ICC profile that can be used"),
                                  HasSubstr("that of the others: photo_003.tif"))));
    expect_same_values(stack);
    EXPECT_TRUE(colour_of_profiles(stack));
    EXPECT_EQ(decide_transfer(stack, survey(stack)).source, "ICC profile");
    // A damaged one is none.
    set.put(3, set.adobe, "this is no profile, though it is called one");
    stack = set.open();
    EXPECT_THAT(stack.warnings, ElementsAre(HasSubstr("photo_003.tif")));
    expect_same_values(stack);
    // One that says that it is sRGB is.
    set.put(3, srgb_icc_profile(), {}, 1);
    stack = set.open();
    EXPECT_THAT(stack.warnings,
                ElementsAre(AllOf(HasSubstr("says that it is sRGB"), HasSubstr("photo_003.tif"))));
    expect_same_values(stack);
    // Where most have none, nothing is known of them.
    for (int i = 0; i < 4; ++i) set.put(i, set.adobe, {});
    EXPECT_EQ(set.open().profiles, nullptr);
}

TEST(PhotoProfiles, OfClippedColoursAreNotGuessed) {
    const std::string adobe = rgb_profile(kAdobe, 2.2), plain = rgb_profile(kRec709, 2.2);
    const ProfileConversion conversion(plain, adobe, 3, true);
    std::vector<float> values = {1, 0.5f, 0.2f, 1, 1, 1, 0.5f, 0.5f, 0.5f};
    conversion.convert(values);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_TRUE(std::isnan(values[c]));
        EXPECT_EQ(values[3 + c], 1.0f);
        EXPECT_NEAR(values[6 + c], 0.5f, 1e-3);  // grey is grey
    }
    EXPECT_GT(conversion.largest_change(), 0.05);
    EXPECT_LT(ProfileConversion(adobe, adobe, 3, true).largest_change(), 1e-3);
    EXPECT_FALSE(ProfileConversion("none", adobe, 3, true).known());
    EXPECT_FALSE(ProfileConversion(adobe, adobe, 1, true).known());  // of colour, for grey
}

}  // namespace
}  // namespace tangi
