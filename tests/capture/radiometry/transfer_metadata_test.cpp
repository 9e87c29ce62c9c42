// transfer_metadata_test.cpp: what files say about their transfer curve, and when it is believed.
#include "capture/photo/stated_transfer.h"
#include "capture/radiometry/transfer_decision.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcms2.h>

#include "capture/radiometry/develop_stack.h"
#include "capture/stack/profile_colours.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

std::string profile_of(const std::array<cmsToneCurve*, 3>& curves, const cmsCIExyY& white,
                       const cmsCIExyYTRIPLE& primaries) {
    const cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, curves.data());
    cmsUInt32Number size = 0;
    cmsSaveProfileToMem(profile, nullptr, &size);
    std::string bytes(size, '\0');
    cmsSaveProfileToMem(profile, bytes.data(), &size);
    cmsCloseProfile(profile);
    return bytes;
}
// An ICC profile with Rec. 709 primaries and this tone curve.
std::string profile_of(cmsToneCurve* red, cmsToneCurve* green, cmsToneCurve* blue) {
    return profile_of({red, green, blue}, {0.3127, 0.3290, 1},
                      {{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}});
}
std::string profile_of(cmsToneCurve* curve) {
    std::string bytes = profile_of(curve, curve, curve);
    cmsFreeToneCurve(curve);
    return bytes;
}
cmsToneCurve* gamma_curve(double gamma) { return cmsBuildGamma(nullptr, gamma); }
cmsToneCurve* srgb_curve() {
    const double parameters[5] = {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
    return cmsBuildParametricToneCurve(nullptr, 4, parameters);
}
cmsToneCurve* table_curve(int entries, double (*value)(double)) {
    std::vector<cmsUInt16Number> table;
    for (int i = 0; i < entries; ++i)
        table.push_back(static_cast<cmsUInt16Number>(std::lround(65535 * value(double(i) / (entries - 1)))));
    return cmsBuildTabulatedToneCurve16(nullptr, static_cast<cmsUInt32Number>(entries), table.data());
}

TEST(IccProfile, TellsLinearSrgbAndGammaInAllItsForms) {
    EXPECT_EQ(transfer_of_icc(profile_of(gamma_curve(1)))->name(), "linear");
    EXPECT_EQ(transfer_of_icc(profile_of(gamma_curve(1.8)))->name(), "gamma 1.8");
    EXPECT_NEAR(transfer_of_icc(profile_of(gamma_curve(563 / 256.0)))->gamma, 2.199, 0.002);  // Adobe RGB
    EXPECT_EQ(transfer_of_icc(profile_of(srgb_curve()))->name(), "srgb");
    EXPECT_EQ(transfer_of_icc(
                  profile_of(table_curve(1024, [](double v) { return double(kSrgb.decode(float(v))); })))
                  ->name(),
              "srgb");
    EXPECT_EQ(transfer_of_icc(profile_of(table_curve(2, [](double v) { return v; })))->name(), "linear");
    const auto tabulated = transfer_of_icc(profile_of(table_curve(4096, [](double v) { return v * v; })));
    EXPECT_NEAR(tabulated->gamma, 2, 0.002);
}

// CIE L*, as eciRGB v2 and Metamorfoze's profiles have it.
TEST(IccProfile, OfAnotherSmoothCurveTellsThat) {
    const auto lightness = [](double v) { return v > 0.08 ? std::pow((v + 0.16) / 1.16, 3) : v / 9.0329; };
    const auto curve = transfer_of_icc(profile_of(table_curve(4096, lightness)));
    ASSERT_TRUE(curve);
    EXPECT_EQ(curve->kind, Transfer::Kind::curve);
    for (double v = 0; v <= 1; v += 0.01)
        EXPECT_NEAR(static_cast<double>(curve->decode(static_cast<float>(v))), lightness(v), 0.004) << v;
}

TEST(IccProfile, TellsItsPrimaries) {
    EXPECT_FALSE(to_camera_of_icc(profile_of(srgb_curve())));
    EXPECT_FALSE(to_camera_of_icc("no profile"));
    const cmsCIExyY white = {0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE adobe = {{0.64, 0.33, 1}, {0.21, 0.71, 1}, {0.15, 0.06, 1}};
    cmsToneCurve* curve = gamma_curve(2.2);
    const auto matrix = to_camera_of_icc(profile_of({curve, curve, curve}, white, adobe));
    cmsFreeToneCurve(curve);
    ASSERT_TRUE(matrix);
    // Rec. 709 from Adobe RGB (1998): R = 1.3984 R' - 0.3984 G'; green is itself, blue -0.0429 G' + 1.0429
    // B'.
    const glm::dmat3 back = glm::inverse(*matrix);
    EXPECT_NEAR(back[0][0], 1.398, 0.003);
    EXPECT_NEAR(back[1][0], -0.398, 0.003);
    EXPECT_NEAR(back[1][1], 1, 0.003);
    EXPECT_NEAR(back[1][2], -0.043, 0.003);
    for (int row = 0; row < 3; ++row)
        EXPECT_NEAR((*matrix)[0][row] + (*matrix)[1][row] + (*matrix)[2][row], 1, 1e-9);
}

TEST(IccProfile, IsRefusedWhereItIsNoneOfThese) {
    EXPECT_FALSE(transfer_of_icc("no profile"));
    EXPECT_FALSE(transfer_of_icc(""));
    EXPECT_FALSE(transfer_of_icc(
        profile_of(table_curve(256, [](double v) { return v < 0.5 ? 0.2 * v : 0.1 + 1.8 * (v - 0.5); }))));
    cmsToneCurve *linear = gamma_curve(1), *other = gamma_curve(2.2);
    EXPECT_FALSE(transfer_of_icc(profile_of(linear, linear, other)));
    cmsFreeToneCurve(linear);
    cmsFreeToneCurve(other);
}

TEST(StatedTransfer, BindsOnlyWhereSomebodyMeantIt) {
    EXPECT_FALSE(transfer_of_metadata({}));
    EXPECT_FALSE(transfer_of_metadata({.exif_colour = 65535}));
    const auto exif = transfer_of_metadata({.exif_colour = 1});
    EXPECT_EQ(exif->transfer, kSrgb);
    EXPECT_FALSE(exif->binding);
    EXPECT_FALSE(transfer_of_metadata({.png_srgb = true})->binding);
    EXPECT_FALSE(transfer_of_metadata({.png_gamma = 0.45455})->binding);
    const auto linear = transfer_of_metadata({.png_gamma = 1.0});
    EXPECT_EQ(linear->transfer, Transfer{});
    EXPECT_TRUE(linear->binding);
    EXPECT_NEAR(transfer_of_metadata({.png_gamma = 0.5})->transfer->gamma, 2, 1e-9);
    const auto icc = transfer_of_metadata({.icc_profile = profile_of(gamma_curve(1)), .exif_colour = 1});
    EXPECT_EQ(icc->transfer, Transfer{});
    EXPECT_TRUE(icc->binding);
}

// A matt relief under lights, stored with `transfer`, in files that say what `attributes` puts into them.
struct SaidStack {
    TestDir dir;
    std::vector<Light> lights = dome_lights(16, 30);
    std::string extension;

    SaidStack(const Transfer& transfer, std::string ending,
              const std::function<void(int, OIIO::ImageSpec&)>& attributes)
        : extension(std::move(ending)) {
        constexpr int side = 40;
        Random random(5);
        std::vector<Vec3> normals;
        std::vector<float> albedos;
        for (int i = 0; i < side * side; ++i) {
            normals.push_back(random.direction(0.85));
            albedos.push_back(random.real(0.2, 0.9));
        }
        for (std::size_t i = 0; i < lights.size(); ++i) {
            lights[i].name = fmt::format("photo_{:02}{}", i, extension);
            std::vector<float> values;
            for (std::size_t p = 0; p < normals.size(); ++p)
                for (int c = 0; c < 3; ++c)
                    values.push_back(transfer.encode(
                        albedos[p] * std::max(glm::dot(normals[p], lights[i].direction), 0.0f)));
            OIIO::ImageSpec spec(side, side, 3, OIIO::TypeDesc::UINT8);
            spec.attribute("CompressionQuality", 100);
            attributes(static_cast<int>(i), spec);
            const auto output = OIIO::ImageOutput::create((dir / lights[i].name).string());
            EXPECT_TRUE(output->open((dir / lights[i].name).string(), spec));
            EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
        }
        write_lights(dir / "lights.lp", lights);
    }
    TransferEstimate decided() const {
        const Stack stack = open_stack(dir.path());
        return decide_transfer(stack, survey(stack));
    }
};

void set_icc(OIIO::ImageSpec& spec, const std::string& profile) {
    spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size())),
                   profile.data());
}

TEST(DecidedTransfer, IsEstimatedWhereTheFilesSayNothing) {
    const TransferEstimate d = SaidStack({}, ".tif", [](int, OIIO::ImageSpec&) {}).decided();
    EXPECT_EQ(d.source, "estimated");
    EXPECT_EQ(d.transfer, Transfer{});
    EXPECT_THAT(d.warning, IsEmpty());
}

TP_LONG TEST(DecidedTransfer, IsTheProfilesInEveryFormatThatHasOne) {
    for (const char* extension : {".jpg", ".png", ".tif"}) {
        const TransferEstimate d =
            SaidStack({Transfer::Kind::gamma, 1.8}, extension, [](int, OIIO::ImageSpec& spec) {
                set_icc(spec, profile_of(gamma_curve(1.8)));
            }).decided();
        EXPECT_EQ(d.source, "ICC profile") << extension;
        EXPECT_EQ(d.transfer.name(), "gamma 1.8") << extension;
        EXPECT_THAT(d.warning, IsEmpty()) << extension;
    }
}

TEST(DecidedTransfer, IsTheProfilesEvenWherePhotographsLookOtherwiseButSaysSo) {
    const TransferEstimate d = SaidStack({}, ".tif", [](int, OIIO::ImageSpec& spec) {
                                   set_icc(spec, profile_of(srgb_curve()));
                               }).decided();
    EXPECT_EQ(d.transfer, kSrgb);
    EXPECT_THAT(d.warning, AllOf(HasSubstr("ICC profile"), HasSubstr("look like linear"),
                                 HasSubstr("--transfer linear")));
}

// A pixel's albedo and normal explain three photographs of any curve.
TEST(DecidedTransfer, AFewPhotographsDoNotDoubtAProfile) {
    SaidStack said({}, ".tif", [](int, OIIO::ImageSpec& spec) { set_icc(spec, profile_of(srgb_curve())); });
    said.lights = {said.lights[0], said.lights[4], said.lights[8], said.lights[11], said.lights[15]};
    write_lights(said.dir / "lights.lp", said.lights);
    EXPECT_EQ(said.decided().transfer, kSrgb);
    EXPECT_THAT(said.decided().warning, IsEmpty());
}

TEST(DecidedTransfer, ThatIsGivenWinsAndAContradictionIsTold) {
    const SaidStack said({}, ".tif",
                         [](int, OIIO::ImageSpec& spec) { set_icc(spec, profile_of(gamma_curve(1))); });
    const auto given = [&](double gamma) {
        const Stack stack = open_stack(said.dir.path(), {.transfer = Transfer{Transfer::Kind::gamma, gamma}});
        return decide_transfer(stack, survey(stack));
    };
    EXPECT_EQ(given(2.2).source, "given");
    EXPECT_THAT(given(2.2).warning,
                AllOf(HasSubstr("linear by the photographs' ICC profile"), HasSubstr("gamma 2.2 is given")));
    EXPECT_THAT(given(1.05).warning, IsEmpty());
}

TEST(DecidedTransfer, IsNotWhatExifSaysBlindly) {
    const TransferEstimate d = SaidStack({}, ".jpg", [](int, OIIO::ImageSpec& spec) {
                                   spec.attribute("Exif:ColorSpace", 1);
                               }).decided();
    EXPECT_EQ(d.source, "estimated");
    EXPECT_EQ(d.transfer, Transfer{});
    EXPECT_THAT(d.warning, AllOf(HasSubstr("EXIF ColorSpace says srgb"), HasSubstr("--transfer srgb")));
    const TransferEstimate right = SaidStack(kSrgb, ".jpg", [](int, OIIO::ImageSpec& spec) {
                                       spec.attribute("Exif:ColorSpace", 1);
                                   }).decided();
    EXPECT_NE(right.transfer, Transfer{});
    EXPECT_THAT(right.warning, IsEmpty());
}

TEST(DecidedTransfer, IsThatOfPngChunks) {
    const TransferEstimate linear = SaidStack({}, ".png", [](int, OIIO::ImageSpec& spec) {
                                        spec.attribute("oiio:ColorSpace", "Linear");
                                    }).decided();
    EXPECT_EQ(linear.source, "PNG gAMA chunk");
    EXPECT_EQ(linear.transfer, Transfer{});
    const TransferEstimate blind = SaidStack({}, ".png", [](int, OIIO::ImageSpec& spec) {
                                       spec.attribute("oiio:ColorSpace", "sRGB");
                                   }).decided();
    EXPECT_EQ(blind.transfer, Transfer{});
    EXPECT_THAT(blind.warning, HasSubstr("PNG sRGB chunk"));
}

TEST(DecidedTransfer, TellsOfPhotographsThatContradictEachOtherAndOfCurvesThatAreNotOurs) {
    const TransferEstimate mixed = SaidStack({}, ".tif", [](int i, OIIO::ImageSpec& spec) {
                                       if (i == 3) set_icc(spec, profile_of(srgb_curve()));
                                   }).decided();
    EXPECT_EQ(mixed.source, "estimated");
    EXPECT_THAT(mixed.warning, AllOf(HasSubstr("photo_03.tif"), HasSubstr("srgb"), HasSubstr("nothing")));
    const TransferEstimate odd = SaidStack({}, ".tif", [](int, OIIO::ImageSpec& spec) {
                                     set_icc(spec, profile_of(table_curve(256, [](double v) {
                                                 return v < 0.5 ? 0.2 * v : 0.1 + 1.8 * (v - 0.5);
                                             })));
                                 }).decided();
    EXPECT_EQ(odd.source, "estimated");
    EXPECT_THAT(odd.warning, HasSubstr("neither linear, nor sRGB"));
}

TEST(DecidedTransfer, GoesForDevelopedStacksToo) {
    const SaidStack said({Transfer::Kind::gamma, 1.8}, ".tif",
                         [](int, OIIO::ImageSpec& spec) { set_icc(spec, profile_of(gamma_curve(1.8))); });
    fs::create_directory(said.dir / "frames");
    write_picture(said.dir / "frames/dark.tif", Image<Rgb>(40, 40, Rgb(0)), {});
    Stack stack = open_stack(said.dir.path(), {.develop = {.dark = said.dir / "frames/dark.tif"}});
    const DevelopReport report = develop_stack(stack);
    EXPECT_EQ(report.encoding.transfer.name(), "gamma 1.8");
    EXPECT_EQ(report.encoding.source, "ICC profile");
    EXPECT_THAT(estimate_transfer(stack, Survey{}).source, HasSubstr("ICC profile"));
}

}  // namespace
}  // namespace tangi
