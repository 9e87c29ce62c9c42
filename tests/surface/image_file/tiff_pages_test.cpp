// tiff_pages_test.cpp: of several pictures in a TIFF file, the one that is meant.
#include "surface/image_file/tiff_pages.h"

#include <gtest/gtest.h>

#include "surface/image_file/image_io.h"
#include "tests/support/capture/tiff_writer.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

const std::string kRed("\xFF\x00\x00", 3), kGreen("\x00\xFF\x00", 3);

TiffPages pages_of(const TestDir& dir, const std::vector<TiffPicture>& pictures) {
    write_bytes(dir / "a.tif", tiff_of(pictures));
    const auto pages = tiff_pages(dir / "a.tif");
    EXPECT_TRUE(pages);
    return pages.value_or(TiffPages{{TiffPage{}}, {}});
}

TEST(TiffPages, AreCountedAndTheLargestIsThePicture) {
    const TestDir dir;
    const TiffPages one = pages_of(dir, {even_tiff(5, 4, kRed)});
    EXPECT_EQ(one.pages.size(), 1u);
    EXPECT_EQ(one.picture().width, 5u);
    EXPECT_EQ(one.picture().height, 4u);
    EXPECT_EQ(one.picture().samples, 3);
    EXPECT_EQ(one.picture().photometric, 2);
    EXPECT_EQ(one.alike, 1u);
    // A preview first, whether it is called so or not.
    for (const int type : {0, 1}) {
        const TiffPages two = pages_of(dir, {even_tiff(4, 3, kRed, type), even_tiff(16, 12, kGreen)});
        EXPECT_EQ(two.chosen, 1u);
        EXPECT_EQ(two.alike, 1u);
        EXPECT_EQ(read_picture(dir / "a.tif").width(), 16);
        EXPECT_EQ(read_picture(dir / "a.tif")(3, 3), Rgb(0, 1, 0));
    }
}

TEST(TiffPages, ThatAreReducedOrMasksAreNotThePicture) {
    const TestDir dir;
    EXPECT_EQ(pages_of(dir, {even_tiff(8, 8, kRed, 1), even_tiff(8, 8, kGreen)}).chosen, 1u);
    EXPECT_EQ(pages_of(dir, {even_tiff(16, 16, kRed, 4), even_tiff(8, 8, kGreen)}).chosen, 1u);
    EXPECT_EQ(pages_of(dir, {even_tiff(4, 4, kRed, 1), even_tiff(8, 8, kGreen, 1)}).chosen, 1u);
}

TEST(TiffPages, OfOneSizeAreCounted) {
    const TestDir dir;
    const TiffPages pages = pages_of(dir, {even_tiff(4, 4, kRed), even_tiff(8, 8, kGreen),
                                           even_tiff(8, 8, kRed), even_tiff(8, 8, kRed, 1)});
    EXPECT_EQ(pages.chosen, 1u);
    EXPECT_EQ(pages.alike, 2u);
}

TEST(TiffPages, BelowOthersAreFound) {
    const TestDir dir;
    TiffPicture preview = even_tiff(4, 3, kRed);
    preview.below = {even_tiff(16, 12, kGreen)};
    const TiffPages hidden = pages_of(dir, {preview});
    ASSERT_NE(hidden.larger_hidden(), nullptr);
    EXPECT_EQ(hidden.larger_hidden()->width, 16u);
    // The reduced copies of a pyramid lie below the picture itself.
    TiffPicture whole = even_tiff(16, 12, kGreen);
    whole.below = {even_tiff(8, 6, kRed, 1), even_tiff(4, 3, kRed, 1)};
    EXPECT_EQ(pages_of(dir, {whole}).larger_hidden(), nullptr);
}

TEST(TiffPages, OfDamagedFilesComeToAnEnd) {
    const TestDir dir;
    const std::string whole = tiff_of({even_tiff(4, 3, kRed), even_tiff(5, 3, kRed)});
    for (std::size_t kept = 0; kept < whole.size(); ++kept) {
        write_bytes(dir / "b.tif", whole.substr(0, kept));
        (void)tiff_pages(dir / "b.tif");
    }
    Random random(4);
    for (int run = 0; run < 300; ++run) {
        std::string damaged = whole;
        for (int i = 0; i < 4; ++i)
            damaged[static_cast<std::size_t>(random.below(static_cast<int>(whole.size())))] =
                static_cast<char>(random.below(256));
        write_bytes(dir / "b.tif", damaged);
        (void)tiff_pages(dir / "b.tif");
    }
    std::string loop = whole;  // its second directory is followed by the first
    std::copy_n(loop.begin() + 4, 4, loop.end() - 4);
    write_bytes(dir / "b.tif", loop);
    EXPECT_EQ(tiff_pages(dir / "b.tif")->pages.size(), 2u);
    write_bytes(dir / "b.tif", "no picture at all");
    EXPECT_FALSE(tiff_pages(dir / "b.tif"));
    EXPECT_FALSE(tiff_pages(dir / "missing.tif"));
}

}  // namespace
}  // namespace tangi
