// painting_parts_test.cpp: parts beside `dry` come back as they were.
#include "surface/painting_file/painting_parts.h"

#include <gmock/gmock.h>

#include "surface/painting_file/exr_pixel_reader.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kPartWidth = 70, kPartHeight = 150;  // more than two bands of rows

float value_at(int channel, int x, int y) { return static_cast<float>(channel * 100000 + y * 100 + x) / 7; }

void write_two_parts(const std::filesystem::path& path) {
    std::vector<PartToWrite> parts(2);
    parts[0].info = {"one", kPartWidth, kPartHeight, {"a", "b.x"}, {{"said", "some \"text\""}}};
    parts[0].fill = [](int y0, int y1, std::span<float* const> planes) {
        for (int c = 0; c < 2; ++c)
            for (int y = y0; y < y1; ++y)
                for (int x = 0; x < kPartWidth; ++x)
                    planes[static_cast<std::size_t>(c)][(y - y0) * kPartWidth + x] = value_at(c, x, y);
    };
    parts[1].info = {"two", kPartWidth, kPartHeight, {"c"}, {}};
    parts[1].fill = [](int, int, std::span<float* const>) {};  // 0 everywhere
    AtomicFile file(path);
    write_painting(file, Surface(kPartWidth, kPartHeight), parts);
}

TEST(PaintingParts, ComeBackBitForBit) {
    const TestDir dir;
    write_two_parts(dir / "a.exr");
    const auto parts = painting_parts(dir / "a.exr");
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].name, "one");
    EXPECT_THAT(parts[0].channels, ElementsAre("a", "b.x"));
    EXPECT_EQ(parts[0].attributes.at("said"), "some \"text\"");
    EXPECT_EQ(parts[1].width, kPartWidth);
    int next = 0;
    read_painting_part(dir / "a.exr", parts[0], [&](int y0, int y1, std::span<const float* const> planes) {
        EXPECT_EQ(y0, next);
        next = y1;
        for (int c = 0; c < 2; ++c)
            for (int y = y0; y < y1; ++y)
                for (int x = 0; x < kPartWidth; ++x)
                    ASSERT_EQ(planes[static_cast<std::size_t>(c)][(y - y0) * kPartWidth + x],
                              value_at(c, x, y))
                        << x << ' ' << y;
    });
    EXPECT_EQ(next, kPartHeight);
    read_painting_part(dir / "a.exr", parts[1],
                       [&](int, int, std::span<const float* const> planes) { EXPECT_EQ(planes[0][5], 0); });
    EXPECT_EQ(read_painting(dir / "a.exr").width(), kPartWidth);  // the dry part is what it always was
}

TEST(PaintingParts, PixelsAreReadWhereTheyAreAskedFor) {
    const TestDir dir;
    write_two_parts(dir / "a.exr");
    const PartInfo one = painting_parts(dir / "a.exr")[0];
    PartPixels pixels(dir / "a.exr", one);
    write_painting(dir / "a.exr", Surface(kPartWidth, kPartHeight));  // takes its place
    for (const auto& [x, y] : {std::pair(0, 0), {69, 149}, {3, 15}, {4, 16}, {68, 148}, {5, 16}})
        for (int c = 0; c < 2; ++c)
            EXPECT_EQ(pixels.at(x, y)[static_cast<std::size_t>(c)], value_at(c, x, y)) << x << ' ' << y;
    EXPECT_THAT(error_of([&] { PartPixels(dir / "a.exr", one); }),
                AllOf(HasSubstr("a.exr"), HasSubstr("'one'")));
}

TEST(PaintingParts, APaintingWithoutThemHasNone) {
    const TestDir dir;
    write_painting(dir / "a.exr", Surface(8, 6));
    EXPECT_TRUE(painting_parts(dir / "a.exr").empty());
}

TEST(PaintingParts, ErrorsNameTheFile) {
    const TestDir dir;
    write_two_parts(dir / "a.exr");
    const auto ignore = [](int, int, std::span<const float* const>) {};
    EXPECT_THAT(error_of([&] { painting_parts(dir / "none.exr"); }), HasSubstr("none.exr: no such file"));
    EXPECT_THAT(error_of([&] {
                    read_painting_part(dir / "a.exr", {"three", 1, 1, {}, {}}, ignore);
                }),
                AllOf(HasSubstr("a.exr"), HasSubstr("'three'")));
    write_bytes(dir / "text.exr", "hello");
    EXPECT_THAT(error_of([&] { painting_parts(dir / "text.exr"); }),
                HasSubstr("text.exr: is not a painting file"));
    const std::string bytes = bytes_of(dir / "a.exr");
    write_bytes(dir / "cut.exr", bytes.substr(0, bytes.size() - 40));
    const PartInfo last = painting_parts(dir / "a.exr").at(1);
    EXPECT_THAT(error_of([&] { read_painting_part(dir / "cut.exr", last, ignore); }), HasSubstr("cut.exr"));
    EXPECT_THROW(
        read_painting_part(dir / "a.exr", last, ignore, [](std::string_view, double) { return false; }),
        Cancelled);
}

}  // namespace
}  // namespace tangi
