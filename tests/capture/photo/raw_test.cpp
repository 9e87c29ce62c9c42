// raw_test.cpp: camera raw comes back as the linear light that the sensor measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/photo/photo_metadata.h"
#include "capture/photo/raw_file.h"
#include "capture/photo/rejected_photo.h"
#include "capture/radiometry/develop_stack.h"
#include "capture/stack/grey_photos.h"
#include "capture/stack/survey.h"
#include "tests/support/capture/dng_writer.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
namespace fs = std::filesystem;

constexpr int kSide = 64;  // four areas of 32 x 32
const Rgb kAreas[4] = {{0.1f, 0.3f, 0.2f}, {0.4f, 0.7f, 0.5f}, {0.02f, 0.01f, 0.03f}, {0.6f, 1.5f, 0.9f}};

Image<Rgb> areas(float scale = 1) {
    Image<Rgb> picture(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) picture(x, y) = scale * kAreas[(y / 32) * 2 + x / 32];
    return picture;
}

// A pixel in the middle of an area, as 0..1.
Rgb at(const std::vector<std::uint16_t>& values, int area) {
    const int x = 32 * (area % 2) + 16, y = 32 * (area / 2) + 16;
    Rgb pixel;
    for (int c = 0; c < 3; ++c)
        pixel[c] = values[static_cast<std::size_t>((y * kSide + x) * 3 + c)] / 65535.0f;
    return pixel;
}

void expect_near(const Rgb& actual, const Rgb& expected, double tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], tolerance) << "channel " << c;
}

TEST(Raw, GivesTheSensorsLinearValuesBack) {
    const TestDir dir;
    write_dng(dir / "a.dng", areas());
    for (const std::string& method : demosaic_methods()) {
        SCOPED_TRACE(method);
        const auto values = develop_raw(dir / "a.dng", method);
        ASSERT_EQ(values.size(), static_cast<std::size_t>(kSide * kSide * 3));
        // Half a code of the sensor is 3e-5; LibRaw scales by multipliers near 1, and cuts fractions off.
        for (int area = 0; area < 3; ++area) expect_near(at(values, area), kAreas[area], 1e-4);
    }
}

TEST(Raw, ClipsWhereTheSensorDoes) {
    const TestDir dir;
    write_dng(dir / "a.dng", areas());
    const Rgb clipped = at(develop_raw(dir / "a.dng", "AHD"), 3);
    EXPECT_EQ(clipped.g, 1.0f);
    // The others are not: white balance must not have pushed them to the limit.
    EXPECT_NEAR(clipped.r, 0.6, 1e-4);
    EXPECT_NEAR(clipped.b, 0.9, 1e-4);
}

TEST(Raw, HonoursTheBlackLevel) {
    const TestDir dir;
    write_dng(dir / "a.dng", areas(), {.black = 2000, .white = 4000});
    write_dng(dir / "below.dng", areas(-0.5f), {.black = 2000});
    expect_near(at(develop_raw(dir / "a.dng", "AHD"), 0), kAreas[0], 4e-4);  // coarser codes
    expect_near(at(develop_raw(dir / "below.dng", "AHD"), 1), Rgb(0), 0);
}

TEST(Raw, IsReadInBandsAsAPhotograph) {
    const TestDir dir;
    write_dng(dir / "a.dng", areas(), {.orientation = 6});
    PhotoFile file(dir / "a.dng");
    EXPECT_EQ(file.header().width, kSide);
    EXPECT_EQ(file.header().bits, 16);
    EXPECT_TRUE(file.header().is_raw);
    EXPECT_EQ(file.header().orientation, 6);
    const auto whole = develop_raw(dir / "a.dng", "AHD");
    std::vector<float> rows(kSide * 3 * 10);
    for (const int y : {0, 10, 54, 20}) {
        file.read_rows(y, y + 10, rows);
        for (std::size_t i = 0; i < rows.size(); ++i)
            ASSERT_EQ(rows[i],
                      static_cast<float>(whole[static_cast<std::size_t>(y * kSide * 3) + i]) / 65535);
    }
    std::vector<std::string> warnings;
    const std::vector<fs::path> paths = pictures_in(dir.path(), warnings);
    EXPECT_EQ(read_grey_photos(paths).width, kSide);
}

TEST(Raw, TellsItsExposure) {
    const TestDir dir;
    write_dng(dir / "a.dng", areas(), {.exposure_s = 0.5, .f_number = 4, .iso = 200});
    EXPECT_NEAR(exposure_of(read_photo_metadata(dir / "a.dng")).value(), 0.5 * 2 / 16, 1e-6);
}

struct RawStack {
    TestDir dir;
    std::vector<Light> lights = dome_lights(5);

    explicit RawStack(const DngOptions& options = {}) {
        for (std::size_t i = 0; i < lights.size(); ++i) {
            lights[i].name = fmt::format("photo_{}.dng", i);
            write_dng(dir / lights[i].name, areas(1 - 0.1f * static_cast<float>(i)), options);
        }
        write_lights(dir / "lights.lp", lights);
    }
};

TEST(Raw, StackIsLinearRec709WithoutAnyFlag) {
    const RawStack raws;
    Stack stack = open_stack(raws.dir.path());
    EXPECT_TRUE(stack.is_raw);
    const DevelopReport report = develop_stack(stack);
    EXPECT_THAT(stack.warnings, IsEmpty());
    EXPECT_EQ(report.encoding.source, "camera raw");
    EXPECT_EQ(report.camera, "TestCam");
    EXPECT_EQ(report.scratch_bytes, 5u * kSide * kSide * 6);
    const Band band = StackReader(stack).read(0, kSide, Transfer{});
    const float balance[3] = {2, 1, 1 / 0.7f};  // the camera's primaries are those of Rec. 709
    for (int i = 0; i < 5; ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(band.row(i, c, 16)[16],
                        (1 - 0.1f * static_cast<float>(i)) * kAreas[0][c] * balance[c], 1e-3);
}

TEST(Raw, PixelThatIsClippedInOneChannelIsClippedInAllOnceConverted) {
    const RawStack raws;
    Stack stack = open_stack(raws.dir.path());
    develop_stack(stack);
    const float clipped = stack.development->clipped;
    Band band = StackReader(stack).read(0, kSide, Transfer{});
    for (int c = 0; c < 3; ++c) {
        EXPECT_GE(band.row(0, c, 48)[48], clipped) << c;
        EXPECT_LT(band.row(0, c, 16)[48], clipped) << c;
    }
    stack = open_stack(raws.dir.path(), {.develop = {.raw_colour = RawColour::camera}});
    develop_stack(stack);
    band = StackReader(stack).read(0, kSide, Transfer{});
    EXPECT_NEAR(band.row(0, 0, 48)[48], 0.6, 1e-4);  // in the camera's own colours each channel is by itself
    EXPECT_GE(band.row(0, 1, 48)[48], stack.development->clipped);
    EXPECT_NEAR(band.row(0, 2, 16)[16], 0.2, 1e-4);
}

TEST(Raw, StackKeepsRawsOrReadsThemAnewWithTheSameResult) {
    const RawStack raws;
    Stack kept = open_stack(raws.dir.path()), read = open_stack(raws.dir.path());
    develop_stack(kept);
    EXPECT_EQ(develop_stack(read, {.keep_raws = false}).scratch_bytes, 0u);
    for (const StackPhoto& photo : kept.photos) fs::remove(photo.path);
    // Headers are read again from the files, pixels are not.
    for (const StackPhoto& photo : kept.photos) write_dng(photo.path, Image<Rgb>(kSide, kSide, Rgb(0.5f)));
    const Band first = StackReader(kept).read(10, 20, Transfer{});
    EXPECT_NEAR(StackReader(read).read(10, 20, Transfer{}).row(0, 1, 12)[3], 0.5, 1e-3);
    EXPECT_NEAR(first.row(0, 1, 12)[3], 0.3, 1e-3);
}

TEST(Raw, FramesOfAnotherExposureAreToldOfAndAmbientIsScaled) {
    const RawStack raws;
    fs::create_directory(raws.dir / "frames");
    write_dng(raws.dir / "frames/dark.dng", areas(0), {.exposure_s = 0.04});
    write_dng(raws.dir / "frames/ambient.dng", areas(0.2f), {.exposure_s = 0.04});
    Stack stack = open_stack(raws.dir.path(), {.develop = {.dark = raws.dir / "frames/dark.dng",
                                                           .ambient = raws.dir / "frames/ambient.dng",
                                                           .raw_colour = RawColour::camera}});
    develop_stack(stack);
    ASSERT_EQ(stack.warnings.size(), 2u);
    EXPECT_THAT(stack.warnings[0], AllOf(HasSubstr("dark.dng"), HasSubstr("2 times")));
    EXPECT_THAT(stack.warnings[1],
                AllOf(HasSubstr("ambient.dng"), HasSubstr("2 times"), HasSubstr("scaled")));
    const Band band = StackReader(stack).read(0, kSide, Transfer{});
    EXPECT_NEAR(band.row(0, 1, 16)[16], 0.3 * 0.9, 1e-3);  // a tenth of the light was ambient
    for (const char* frame : {"dark.dng", "ambient.dng"}) write_dng(raws.dir / "frames" / frame, areas(0.1f));
    stack = open_stack(raws.dir.path(), {.develop = {.ambient = raws.dir / "frames/ambient.dng"}});
    develop_stack(stack);
    EXPECT_THAT(stack.warnings, IsEmpty());
}

TEST(Raw, IsTakenBeforeTheJpegThatTheCameraStoredBesideIt) {
    RawStack raws;
    for (Light& light : raws.lights) {
        light.name = fs::path(light.name).stem().string();
        write_picture_8bit(raws.dir / (light.name + ".jpg"), Image<Rgb>(32, 32));
    }
    write_lights(raws.dir / "lights.lp", raws.lights);
    EXPECT_TRUE(open_stack(raws.dir.path()).is_raw);
}

TEST(Raw, ThatCannotBeReadNamesTheFileAndTheRemedy) {
    const TestDir dir;
    write_bytes(dir / "text.cr2", "this is not a raw");
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "text.cr2"); }),
                AllOf(HasSubstr("text.cr2"), HasSubstr("DNG")));
    write_dng(dir / "a.dng", areas());
    const std::string bytes = bytes_of(dir / "a.dng");
    write_bytes(dir / "cut.dng", bytes.substr(0, bytes.size() / 2));
    EXPECT_THAT(error_of([&] { develop_raw(dir / "cut.dng", "AHD"); }),
                AllOf(HasSubstr("cut.dng"), HasSubstr("damaged")));
    EXPECT_THAT(error_of([&] { develop_raw(dir / "a.dng", "magic"); }),
                AllOf(HasSubstr("magic"), HasSubstr("VNG")));
}

// Even light comes back even, to a thousandth, up to the picture's border (but for AAHD), whatever fills the
// mosaic in.
TEST(Raw, OfAnEvenFieldIsEven) {
    const TestDir dir;
    const Rgb level(0.2f, 0.45f, 0.3f);
    write_dng(dir / "a.dng", Image<Rgb>(kSide, kSide, level), {.black = 1024, .white = 15000});
    for (const std::string& method : demosaic_methods()) {
        const auto values = develop_raw(dir / "a.dng", method);
        const int border = method == "AAHD" ? 8 : 0;  // where LibRaw's is off
        double worst = 0;
        for (int y = border; y < kSide - border; ++y)
            for (int x = border; x < kSide - border; ++x)
                for (int c = 0; c < 3; ++c) {
                    const double value = values[static_cast<std::size_t>((y * kSide + x) * 3 + c)] / 65535.0;
                    worst = std::max(worst, std::abs(value / double(level[c]) - 1));
                }
        EXPECT_LT(worst, 1e-3) << method;
    }
}

// Through the program's own path: a stack in the sensor's colours, black level off, clipped where the sensor
// is.
TEST(Raw, StackOfAnEvenFieldIsEvenAndClippedAtWhite) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(5);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].name = fmt::format("photo_{}.dng", i);
        const float level = 0.15f * static_cast<float>(i + 1);
        write_dng(dir / lights[i].name, Image<Rgb>(kSide, kSide, i == 4 ? Rgb(1) : Rgb(level)),
                  {.black = 700, .white = 12000, .orientation = 6});
    }
    write_lights(dir / "lights.lp", lights);
    Stack stack = open_stack(dir.path(), {.develop = {.raw_colour = RawColour::camera}});
    EXPECT_THAT(stack.warnings, testing::ElementsAre(HasSubstr("the EXIF orientation (6) is not applied")));
    EXPECT_EQ(stack.width(), kSide);
    develop_stack(stack);
    const Band band = StackReader(stack).read(0, kSide, Transfer{});
    for (int i = 0; i < 5; ++i)
        for (int c = 0; c < 3; ++c)
            for (int y = 0; y < kSide; ++y)
                for (int x = 0; x < kSide; ++x) {
                    const float value = band.row(i, c, y)[x];
                    if (i == 4)
                        ASSERT_GE(value, stack.development->clipped);
                    else
                        ASSERT_NEAR(value / (0.15 * (i + 1)), 1, 1e-3) << i << " " << c;
                }
}

// The whole file, byte by byte damaged or cut: an error that names it, or pixels; never a crash.
TEST(Raw, OfAnUnknownCameraOrDamagedSaysSo) {
    const TestDir dir;
    write_dng(dir / "good.dng", areas());
    const std::string bytes = bytes_of(dir / "good.dng");
    const auto told = [&](const std::string& changed) -> std::string {
        write_bytes(dir / "bad.dng", changed);
        try {
            (void)develop_raw(dir / "bad.dng", "AHD");
        } catch (const PhotoError& error) {
            EXPECT_EQ(error.path(), dir / "bad.dng");
            return error.what();
        }
        return {};
    };
    const auto with_tag = [&](int tag, const std::string& value) {  // the value of a short directory entry
        std::string changed = bytes;
        for (std::size_t at = 10; at + 12 < 512; at += 12)
            if (static_cast<unsigned char>(changed[at]) + 256 * static_cast<unsigned char>(changed[at + 1]) ==
                tag)
                changed.replace(at + 8, value.size(), value);
        return changed;
    };
    for (const std::size_t kept : {std::size_t{4}, std::size_t{60}, std::size_t{400}, bytes.size() * 2 / 3})
        EXPECT_THAT(told(bytes.substr(0, kept)),
                    AllOf(HasSubstr("bad.dng: "), AnyOf(HasSubstr("DNG"), HasSubstr("cannot hold"))))
            << kept;
    // A compression that no camera has.
    EXPECT_THAT(told(with_tag(259, std::string("\x39\x30", 2))),
                AllOf(HasSubstr("bad.dng: "), HasSubstr("DNG")));
    Random random(3);
    for (int i = 0; i < 60; ++i) {
        std::string changed = bytes;
        for (int k = 0; k < 4; ++k)
            changed[static_cast<std::size_t>(random.below(600))] = static_cast<char>(random.below(256));
        (void)told(changed);
    }
}

TEST(Raw, MixedWithOtherPicturesIsAnError) {
    RawStack raws;
    raws.lights[2].name = "photo_2.png";
    fs::remove(raws.dir / "photo_2.dng");
    write_picture(raws.dir / "photo_2.png", areas(), {}, {.bits = 16});
    write_lights(raws.dir / "lights.lp", raws.lights);
    EXPECT_THAT(error_of([&] { open_stack(raws.dir.path()); }),
                AllOf(HasSubstr("photo_2.png"), HasSubstr("(raw)")));
}

TEST(Raw, NeedsRoomOnDiskAndSaysSo) {
    const RawStack raws;
    Stack stack = open_stack(raws.dir.path());
    const FullDisk full(10000);
    EXPECT_THAT(error_of([&] { develop_stack(stack); }),
                AllOf(HasSubstr("5 developed camera raws"), HasSubstr("TMPDIR")));
}

TEST(Raw, ThatClaimsMoreThanItCanHoldIsAnErrorAtOnce) {
    const TestDir dir;
    write_dng(dir / "a.dng", Image<Rgb>(64, 48, Rgb(0.3f)));
    std::string damaged = bytes_of(dir / "a.dng");
    const std::string width = std::string("\x00\x01\x04\x00\x01\x00\x00\x00", 8);  // its entry
    const std::size_t at = damaged.find(width);
    ASSERT_NE(at, std::string::npos);
    damaged.replace(at + 8, 4, std::string("\x60\xea\0\0", 4));  // 60,000
    write_bytes(dir / "b.dng", damaged);
    EXPECT_THAT(
        error_of([&] { read_raw_header(dir / "b.dng"); }),
        AllOf(StartsWith((dir / "b.dng").string()),
              HasSubstr("is damaged: it says that it has 60000 x 48 pixels"), HasSubstr("copy it again")));
}

}  // namespace
}  // namespace tangi
