// icc_profile_test.cpp: the profile means what a colour management system takes for sRGB.
#include "surface/image_file/icc_profile.h"

#include <gtest/gtest.h>
#include <lcms2.h>

#include <array>

#include "surface/image/colour.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(IccProfile, IsSrgbToLittleCms) {
    const std::string bytes = srgb_icc_profile();
    EXPECT_LT(bytes.size(), 1000u);
    const cmsHPROFILE ours = cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size()));
    ASSERT_NE(ours, nullptr);
    EXPECT_NEAR(cmsGetProfileVersion(ours), 4.3, 1e-6);
    const cmsHPROFILE srgb = cmsCreate_sRGBProfile();
    const cmsHTRANSFORM there = cmsCreateTransform(ours, TYPE_RGB_DBL, srgb, TYPE_RGB_DBL,
                                                   INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOOPTIMIZE);
    ASSERT_NE(there, nullptr);
    for (int r = 0; r <= 4; ++r)
        for (int g = 0; g <= 4; ++g)
            for (int b = 0; b <= 4; ++b) {
                const std::array<double, 3> in = {r / 4.0, g / 4.0, b / 4.0};
                std::array<double, 3> out{};
                cmsDoTransform(there, in.data(), out.data(), 1);
                for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(out[c], in[c], 0.002) << r << g << b;
            }
    cmsDeleteTransform(there);
    cmsCloseProfile(ours);
    cmsCloseProfile(srgb);
}

TEST(IccProfile, IsInPicturesThatAreSrgbAndInNoOthers) {
    const TestDir dir;
    const Image<Rgb> grey(16, 8, Rgb(0.2f));
    const std::string profile = srgb_icc_profile();
    for (const char* name : {"a.png", "a.tif", "a.jpg"}) {
        write_picture(dir / name, grey, {Transfer::Kind::srgb});
        write_picture(dir / (std::string("linear-") + name), grey, {Transfer::Kind::linear});
    }
    // TIFF and JPEG hold it as it is; PNG compresses it.
    EXPECT_NE(bytes_of(dir / "a.tif").find(profile), std::string::npos);
    EXPECT_NE(bytes_of(dir / "a.jpg").find(profile), std::string::npos);
    EXPECT_NE(bytes_of(dir / "a.png").find("iCCP"), std::string::npos);
    EXPECT_EQ(bytes_of(dir / "linear-a.tif").find("acsp"), std::string::npos);
    EXPECT_EQ(bytes_of(dir / "linear-a.png").find("iCCP"), std::string::npos);
    EXPECT_NEAR(read_picture(dir / "a.png")(3, 3).r, read_picture(dir / "a.tif")(3, 3).r, 1e-6);
}

}  // namespace
}  // namespace tangi
