// bad_inputs_test.cpp: stacks that cannot be opened: each Error names the file and the remedy.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/stack/stack.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

// A good stack of five photographs, to be spoilt.
class BadStack : public testing::Test {
protected:
    BadStack() { write_test_stack(dir, lights); }

    std::string error(const StackOptions& options = {}) const {
        return error_of([&] { open_stack(dir.path(), options); });
    }
    std::string path(const std::string& name) const { return (dir / name).string(); }

    TestDir dir;
    const std::string folder = dir.path().string();
    std::vector<Light> lights = dome_lights(5);
};

// A photograph stored in another way than the others.
void write_with(const fs::path& path, int channels, OIIO::TypeDesc type, int orientation = 1) {
    OIIO::ImageSpec spec(8, 6, channels, type);
    spec.attribute("Orientation", orientation);
    const std::vector<float> values(static_cast<std::size_t>(48 * channels), 0.5f);
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output->open(path.string(), spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
}

TEST_F(BadStack, IsGoodBeforeItIsSpoilt) { EXPECT_NO_THROW(open_stack(dir.path())); }

TEST_F(BadStack, WithoutAFolder) {
    EXPECT_EQ(error_of([] { open_stack("/nowhere/at/all"); }), "/nowhere/at/all: no such folder");
    EXPECT_EQ(error_of([&] { open_stack(path("lights.lp")); }),
              path("lights.lp") + ": is not a folder; give the folder that holds the photographs");
}

TEST_F(BadStack, WithoutALightsFile) {
    fs::remove(dir / "lights.lp");
    EXPECT_THAT(error(),
                testing::StartsWith(folder + ": no lights file (.lp, .dome or .relight) in this folder; "
                                             "name one with --lights FILE.lp"));
    EXPECT_THAT(error(), testing::HasSubstr(": tangipaint calibrate " + folder + " --out " + folder +
                                            "/lights.lp --uncalibrated ("));
    EXPECT_EQ(error({.lights_file = dir / "lights.lp"}), path("lights.lp") + ": no such lights file");
}

TEST_F(BadStack, WithTwoLightsFiles) {
    write_lights(dir / "Again.LP", lights);
    EXPECT_EQ(
        error(),
        folder + ": 2 lights files in this folder (Again.LP, lights.lp); choose one with --lights FILE.lp");
    EXPECT_NO_THROW(open_stack(dir.path(), {.lights_file = dir / "Again.LP"}));
}

TEST_F(BadStack, WithAListedPhotographMissing) {
    fs::remove(dir / "photo_003.png");
    EXPECT_EQ(error(), path("lights.lp") + ": 1 of 5 listed photographs are not in " + folder +
                           ": photo_003.png. Put them there, or remove their lines");
}

TEST_F(BadStack, WithSevenListedPhotographsMissing) {
    lights = dome_lights(12);
    write_lights(dir / "lights.lp", lights);
    EXPECT_THAT(error(),
                HasSubstr("7 of 12 listed photographs are not in " + folder +
                          ": photo_005.png, photo_006.png, photo_007.png, photo_008.png, photo_009.png and 2 "
                          "more."));
}

TEST_F(BadStack, WithNamesThatMatchNothingAndAnotherNumberOfPhotographs) {
    for (Light& light : lights) light.name = "x" + light.name;
    lights.pop_back();
    write_lights(dir / "lights.lp", lights);
    EXPECT_THAT(error(), HasSubstr("4 of 4 listed photographs are not in " + folder));
}

TEST_F(BadStack, WithTwoLightsForOnePhotograph) {
    lights[1].name = "./photo_000.png";
    write_lights(dir / "lights.lp", lights);
    EXPECT_THAT(error(),
                AllOf(StartsWith(path("lights.lp") + ": 'photo_000.png' and './photo_000.png' both mean the "
                                                     "photograph "),
                      HasSubstr("photo_000.png")));
}

TEST_F(BadStack, WithAStemThatFitsTwoPhotographs) {
    lights[0].name = "photo_000.cr2";
    write_lights(dir / "lights.lp", lights);
    EXPECT_NO_THROW(open_stack(dir.path()));
    write_picture_8bit(dir / "photo_000.tif", Image<Rgb>(8, 6));
    EXPECT_THAT(error(), AllOf(HasSubstr("1 of 5 listed photographs may be one of several files"),
                               HasSubstr("'photo_000.cr2' photo_000.png, photo_000.tif")));
}

TEST_F(BadStack, WithMostLightsFromBelow) {
    for (std::size_t i = 0; i < 3; ++i) lights[i].direction.z *= -1;
    write_lights(dir / "lights.lp", lights);
    EXPECT_THAT(error(),
                AllOf(StartsWith(path("lights.lp") + ": 3 of 5 lights come from below the painting (z < 0): "
                                                     "photo_000.png (z = -"),
                      HasSubstr("z must point towards the camera")));
}

TEST_F(BadStack, WithPhotographsOfTwoSizes) {
    write_picture_8bit(dir / "photo_002.png", Image<Rgb>(6, 8));
    EXPECT_EQ(error(), path("photo_002.png") +
                           ": is 6 x 8, colour, but photo_000.png is 8 x 6, colour; all photographs "
                           "of a stack must have the same size");
}

TEST_F(BadStack, WithGreyAmongColour) {
    write_with(dir / "photo_004.png", 1, OIIO::TypeDesc::UINT8);
    EXPECT_EQ(error(), path("photo_004.png") +
                           ": is 8 x 6, grey, but photo_000.png is 8 x 6, colour; convert it, or "
                           "remove it from the lights file");
}

TEST_F(BadStack, WithSixteenBitsAmongEight) {
    write_with(dir / "photo_001.png", 3, OIIO::TypeDesc::UINT16);
    EXPECT_EQ(error(), path("photo_001.png") +
                           ": has 16 bits a sample, but photo_000.png has 8; all photographs of a "
                           "stack must be stored alike");
}

TEST_F(BadStack, WithPhotographsTurnedDifferently) {
    std::vector<Light> jpegs = lights;
    for (std::size_t i = 0; i < 5; ++i) {
        fs::remove(dir / lights[i].name);
        jpegs[i].name = fmt::format("photo_{:03}.jpg", i);
        write_with(dir / jpegs[i].name, 3, OIIO::TypeDesc::UINT8, 6);
    }
    write_lights(dir / "lights.lp", jpegs);
    EXPECT_THAT(
        open_stack(dir.path()).warnings,
        ElementsAre(folder +
                    ": the EXIF orientation (6) is not applied; lights and maps are in the frame of the "
                    "stored pixels"));
    write_with(dir / "photo_003.jpg", 3, OIIO::TypeDesc::UINT8, 1);
    EXPECT_EQ(error(), path("photo_003.jpg") +
                           ": its EXIF orientation is 1, that of photo_000.jpg is 6; turn the "
                           "photographs alike first");
}

TEST_F(BadStack, WithATextFileForAPhotograph) {
    write_bytes(dir / "photo_001.png", "this is a text file\n");
    EXPECT_THAT(error(), StartsWith(path("photo_001.png") + ": is not a picture that can be read: "));
}

TEST_F(BadStack, WithAPhotographThatIsAFolder) {
    fs::remove(dir / "photo_001.png");
    fs::create_directory(dir / "photo_001.png");
    EXPECT_THAT(error(), HasSubstr("1 of 5 listed photographs are not in " + folder + ": photo_001.png."));
}

TEST_F(BadStack, WithACropOutside) {
    const Region outside[] = {{-1, 0, 4, 4}, {0, -1, 4, 4}, {0, 0, 9, 4},
                              {0, 0, 4, 7},  {3, 3, 3, 5},  {5, 0, 4, 4}};
    for (const Region& r : outside)
        EXPECT_EQ(
            error({.crop = r}),
            fmt::format("the crop {},{} to {},{} does not lie in the photographs of {}, which are 8 x 6",
                        r.x0, r.y0, r.x1, r.y1, folder));
    EXPECT_NO_THROW(open_stack(dir.path(), {.crop = Region{0, 0, 8, 6}}));
}

TEST_F(BadStack, WithAMaskThatDoesNotFit) {
    fs::create_directory(dir / "masks");
    const fs::path mask = dir / "masks/mask.png";
    EXPECT_THAT(error({.mask_file = mask}), StartsWith(mask.string() + ": cannot be read: "));
    write_picture_8bit(mask, Image<Rgb>(6, 8, Rgb(1)));
    EXPECT_EQ(error({.mask_file = mask}), mask.string() + ": the mask is 6 x 8, the photographs are 8 x 6");
    Image<Rgb> picture(8, 6);
    picture(7, 5) = Rgb(1);
    write_picture_8bit(mask, picture);
    EXPECT_NO_THROW(open_stack(dir.path(), {.mask_file = mask}));
    const std::string nothing =
        mask.string() + ": the mask leaves nothing of the picture; white marks what is to be fitted";
    EXPECT_EQ(error({.crop = Region{0, 0, 4, 4}, .mask_file = mask}), nothing);
    write_picture_8bit(mask, Image<Rgb>(8, 6));
    EXPECT_EQ(error({.mask_file = mask}), nothing);
}

// A real photograph cut at 70 %, among whole ones.
TEST(DataBadStack, WithATruncatedJpeg) {
    TP_DATA(icon, "real/icon");
    const TestDir dir;
    std::vector<Light> lights = dome_lights(5);
    for (std::size_t i = 0; i < 5; ++i) {
        lights[i].name = fmt::format("image{:02}.jpg", i);
        fs::copy(icon / lights[i].name, dir / lights[i].name);
    }
    write_lights(dir / "lights.lp", lights);
    EXPECT_NO_THROW(open_stack(dir.path()));
    const std::string whole = bytes_of(dir / "image03.jpg");
    write_bytes(dir / "image03.jpg", whole.substr(0, whole.size() * 7 / 10));
    EXPECT_EQ(
        error_of([&] { open_stack(dir.path()); }),
        (dir / "image03.jpg").string() + ": the JPEG file is truncated; copy it again from where it came");
}

}  // namespace
}  // namespace tangi
