// lab_colour_test.cpp: L*a*b* becomes the linear light that lcms2 makes of it.
#include "capture/photo/lab_colour.h"

#include <gtest/gtest.h>
#include <lcms2.h>

#include "capture/photo/photo_file.h"
#include "tests/support/capture/tiff_writer.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

struct Lab {
    double lightness, a, b;
};
const std::vector<Lab> kColours = {{50, 0, 0}, {30.5, 25.25, -12.5}, {80, -20, 40},
                                   {1, 0, 0},  {65, 40, 30},         {97, -1, 2}};

Rgb by_lcms(const Lab& lab) {
    const cmsHPROFILE from = cmsCreateLab4Profile(nullptr);
    const cmsCIExyY white = {0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE rec709 = {{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}};
    cmsToneCurve* linear = cmsBuildGamma(nullptr, 1);
    cmsToneCurve* const curves[3] = {linear, linear, linear};
    const cmsHPROFILE to = cmsCreateRGBProfile(&white, &rec709, curves);
    const cmsHTRANSFORM transform = cmsCreateTransform(from, TYPE_Lab_DBL, to, TYPE_RGB_DBL,
                                                       INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOOPTIMIZE);
    double rgb[3] = {};
    cmsDoTransform(transform, &lab, rgb, 1);
    cmsDeleteTransform(transform);
    cmsCloseProfile(from), cmsCloseProfile(to), cmsFreeToneCurve(linear);
    return Rgb(static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2]));
}

std::string stored(const Lab& lab, LabKind kind, int bits) {
    const double top = bits == 8 ? 255 : 65535, unit = bits == 8 ? 1 : 256;
    const double white = kind == LabKind::icc_lab && bits == 16 ? 65280 : top;
    const double shift = kind == LabKind::icc_lab ? (top + 1) / 2 : 0;
    std::string bytes;
    for (const double code : {lab.lightness / 100 * white, lab.a * unit + shift, lab.b * unit + shift})
        for (int byte = 0; byte < bits / 8; ++byte)
            bytes += static_cast<char>(
                static_cast<unsigned>(static_cast<int>(std::lround(code))) >> (8 * byte) & 255);
    return bytes;
}

// A file of a row of these colours, read as any photograph.
TEST(LabColour, OfATiffIsReadInAllItsDepth) {
    for (const LabKind kind : {LabKind::cielab, LabKind::icc_lab})
        for (const int bits : {8, 16}) {
            const TestDir dir;
            TiffPicture picture{.width = static_cast<int>(kColours.size()),
                                .height = 1,
                                .bits = bits,
                                .photometric = kind == LabKind::cielab ? 8 : 9,
                                .bytes = {}};
            for (const Lab& lab : kColours) picture.bytes += stored(lab, kind, bits);
            write_bytes(dir / "a.tif", tiff_of({picture}));
            PhotoFile file(dir / "a.tif");
            EXPECT_TRUE(file.header().is_float);
            EXPECT_EQ(file.header().bits, 32);
            EXPECT_EQ(file.header().channels, 3);
            std::vector<float> values(3 * kColours.size());
            file.read_rows(0, 1, values);
            const double tolerance =
                bits == 8 ? 0.03 : 3e-4;  // half a code of a* is a hundredth of white in blue
            for (std::size_t i = 0; i < kColours.size(); ++i) {
                const Rgb expected = by_lcms(kColours[i]);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(values[3 * i + static_cast<std::size_t>(c)], std::max(expected[c], 0.0f),
                                tolerance)
                        << bits << " bits, colour " << i << ", channel " << c;
            }
        }
}

TEST(LabColour, OfFullScaleIsSaturated) {
    std::vector<float> values = {1, 0, 0, 0.5f, 0, 0};
    linear_of_lab(LabKind::cielab, 16, values);
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isnan(values[static_cast<std::size_t>(c)]));
    EXPECT_NEAR(values[3], 0.1842, 1e-3);  // L* 50
}

}  // namespace
}  // namespace tangi
