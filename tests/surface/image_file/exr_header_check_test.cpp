// exr_header_check_test.cpp: what headers and tables of EXR files promise is compared with their length,
// before memory is asked for and whichever part is read.
#include "surface/image_file/exr_header_check.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;

// Part `dry` and one behind it, which only those read who look for it.
std::string painting_of_two_parts(const TestDir& dir) {
    const PartToWrite further{{"more", 40, 50, {"a"}, {}, false},
                              [](int y0, int y1, std::span<float* const> planes) {
                                  for (int i = 0; i < 40 * (y1 - y0); ++i)
                                      planes[0][i] = static_cast<float>((y0 * 40 + i) % 97);
                              }};
    AtomicFile file(dir / "whole.exr");
    write_painting(file, Surface(40, 50), {&further, 1});
    return bytes_of(dir / "whole.exr");
}

// By OpenImageIO: a single part, of 150 x 130 pixels; tiles of 64 x 64 where wanted.
void write_picture_of(const std::filesystem::path& path, const std::string& compression, bool tiled) {
    OIIO::ImageSpec spec(150, 130, 3, OIIO::TypeDesc::HALF);
    spec.attribute("compression", compression);
    if (tiled) spec.tile_width = spec.tile_height = 64;
    std::vector<float> values(150 * 130 * 3);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i * i % 101);
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output->open(path.string(), spec));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    ASSERT_TRUE(output->close());
}

// Memory for it is never asked for: OpenEXR has a table with a row for each.
TEST(ExrClaim, OfASizeThatTheFileCannotHoldIsAnError) {
    const TestDir dir;
    write_painting(dir / "a.exr", Surface(6, 5));
    const std::string whole = bytes_of(dir / "a.exr");
    std::string first("dataWindow\0box2i\0\x10\0\0\0", 21);
    const auto window = whole.find(first) + first.size();
    ASSERT_LT(window, whole.size());
    for (const std::size_t side : {8u, 12u}) {  // the last column, the last row
        std::string damaged = whole;
        damaged[window + side + 3] = '\x3f';
        write_bytes(dir / "b.exr", damaged);
        EXPECT_EQ(
            error_of([&] { read_painting(dir / "b.exr"); }),
            fmt::format("{}: is damaged: it is too short for the {} pixels that its header speaks of; copy "
                        "it again, or take a copy from before",
                        (dir / "b.exr").string(), side == 8 ? "1056964614 x 5" : "6 x 1056964613"));
        EXPECT_TRUE(is_painting(dir / "b.exr"));
    }
}

// A picture of one colour is as small as ZIP makes it.
TEST(ExrClaim, OfOneColourIsNotTooShort) {
    const TestDir dir;
    Surface s(1500, 1200);
    write_painting(dir / "a.exr", s);
    EXPECT_TRUE(images_identical(read_painting(dir / "a.exr").diffuse, s.diffuse));
}

TEST(ExrClaim, WithoutItsLastByteIsAnErrorWhateverPartIsRead) {
    const TestDir dir;
    const std::string whole = painting_of_two_parts(dir);
    const auto claim = exr_claim(dir / "whole.exr");
    ASSERT_TRUE(claim);
    EXPECT_THAT(claim->parts, ElementsAre("dry", "more"));
    EXPECT_FALSE(claim->cut_off);
    const auto cut = dir / "cut.exr";
    const std::string message =
        cut.string() +
        ": is damaged: it ends before the last of its pixels; copy it again, or take a copy from before";
    for (const std::size_t missing : {1u, 2u, 100u}) {
        write_bytes(cut, whole.substr(0, whole.size() - missing));
        EXPECT_TRUE(exr_claim(cut)->cut_off) << missing;
        EXPECT_TRUE(is_painting(cut));
        EXPECT_EQ(error_of([&] { read_painting(cut); }), message) << "of its whole part";
        EXPECT_EQ(error_of([&] { painting_parts(cut); }), message) << "of its headers";
    }
}

// OpenEXR would ask for memory for all of it.
TEST(ExrClaim, AnAttributeLongerThanTheFileIsAnError) {
    const TestDir dir;
    std::string bytes = painting_of_two_parts(dir);
    using namespace std::string_literals;
    const std::string attribute = "photography\0string\0"s;
    const std::size_t at = bytes.find(attribute);
    ASSERT_NE(at, std::string::npos);
    bytes[at + attribute.size() + 3] = 0x5b;  // 1.5 GB
    write_bytes(dir / "b.exr", bytes);
    const auto claim = exr_claim(dir / "b.exr");
    ASSERT_TRUE(claim);
    EXPECT_TRUE(claim->cut_off);
    EXPECT_TRUE(is_painting(dir / "b.exr"));
    EXPECT_THAT(error_of([&] { read_painting(dir / "b.exr"); }), testing::HasSubstr("ends before the last"));

    // Also behind a header that lacks its size.
    const std::size_t window = bytes.find("dataWindow");
    ASSERT_LT(window, at);
    bytes[window] = 'D';
    bytes[at + attribute.size() + 3] = 0;
    const std::size_t later = bytes.rfind("screenWindowWidth\0float\0"s);
    ASSERT_GT(later, at);
    bytes[later + 24 + 3] = 0x5b;
    write_bytes(dir / "b.exr", bytes);
    const auto unsized = exr_claim(dir / "b.exr");
    ASSERT_TRUE(unsized);
    EXPECT_TRUE(unsized->cut_off);
}

// As a program that dies while it writes leaves them: tables come first, and are filled in last.
TEST(ExrClaim, WithoutAPlaceForABlockIsAnError) {
    const TestDir dir;
    std::string bytes = painting_of_two_parts(dir);
    // Of `more`, the last of 4 blocks: its table is right before the first block, which starts with its
    // part's number, 0, its first row, 0, and its size.
    std::uint64_t first = 0;
    for (std::size_t at = 8; at + 8 * 8 < bytes.size() && first == 0; ++at) {
        std::uint64_t offset = 0;
        std::memcpy(&offset, bytes.data() + at, sizeof offset);
        if (offset == at + 8 * 8) first = offset;
    }
    ASSERT_GT(first, 0u);
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(first) - 8, 8, '\0');
    write_bytes(dir / "b.exr", bytes);
    EXPECT_TRUE(exr_claim(dir / "b.exr")->cut_off);
    EXPECT_THAT(error_of([&] { read_painting(dir / "b.exr"); }), testing::HasSubstr("ends before the last"));
}

// OpenEXR reads a list of channels to its end, whatever length is stated, and takes what follows for an
// attribute: of any name, and of gigabytes.
TEST(ExrClaim, AnAttributeOfAnotherLengthThanItsKindIsAnError) {
    using namespace std::string_literals;
    const TestDir dir;
    const std::string whole = painting_of_two_parts(dir);
    for (const std::string& attribute :
         {"channels\0chlist\0"s, "dataWindow\0box2i\0"s, "mm_per_pixel\0float\0"s}) {
        const std::size_t at = whole.find(attribute);
        ASSERT_NE(at, std::string::npos) << attribute;
        for (const int more : {-3, 1}) {
            std::string bytes = whole;
            bytes[at + attribute.size()] = static_cast<char>(bytes[at + attribute.size()] + more);
            write_bytes(dir / "b.exr", bytes);
            ASSERT_TRUE(exr_claim(dir / "b.exr"));
            EXPECT_TRUE(exr_claim(dir / "b.exr")->malformed) << attribute << more;
            EXPECT_EQ(
                error_of([&] { read_painting(dir / "b.exr"); }),
                (dir / "b.exr").string() +
                    ": is damaged: its header makes no sense; copy it again, or take a copy from before");
        }
    }
    EXPECT_FALSE(exr_claim(dir / "whole.exr")->malformed);
}

TEST(ExrClaim, FollowsTheTablesOfOtherPrograms) {
    const TestDir dir;
    for (const std::string compression :
         {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "dwaa", "dwab"})
        for (const bool tiled : {false, true}) {
            write_picture_of(dir / "a.exr", compression, tiled);
            const std::string whole = bytes_of(dir / "a.exr");
            ASSERT_TRUE(exr_claim(dir / "a.exr"));
            EXPECT_FALSE(exr_claim(dir / "a.exr")->cut_off) << compression << tiled;
            EXPECT_FALSE(exr_claim(dir / "a.exr")->malformed || exr_claim(dir / "a.exr")->impossible);
            write_bytes(dir / "b.exr", whole.substr(0, whole.size() - 1));
            EXPECT_TRUE(exr_claim(dir / "b.exr")->cut_off) << compression << tiled;
        }
}

}  // namespace
}  // namespace tangi
