// jpeg_segments_test.cpp: a JPEG file is whole where its picture is, whatever follows.
#include "surface/image_file/jpeg_segments.h"

#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

std::string jpeg(const TestDir& dir, int side) {
    Image<Rgb> picture(side, side);
    Random random(3);
    for (Rgb& pixel : picture.pixels()) pixel = Rgb(random.real(), random.real(), random.real());
    write_picture_8bit(dir / "a.jpg", picture);
    return bytes_of(dir / "a.jpg");
}

TEST(JpegMarkers, TellAWholePictureWhateverFollows) {
    const TestDir dir;
    const std::string whole = jpeg(dir, 40);
    const std::string film = std::string(
                                 "\0\0\0\x18"
                                 "ftypmp42",
                                 12) +
                             std::string(200000, '\0');
    for (const std::string& behind : {std::string(), std::string(1000, '\0'), film, whole,
                                      whole.substr(0, 500), std::string("\xFF\xFF\xFF")}) {
        write_bytes(dir / "b.jpg", whole + behind);
        EXPECT_TRUE(is_whole_jpeg(dir / "b.jpg")) << behind.size();
    }
}

TEST(JpegMarkers, TellATruncatedOneWhateverFollows) {
    const TestDir dir;
    const std::string whole = jpeg(dir, 40);
    for (std::size_t kept = 2; kept < whole.size(); kept += kept < 200 ? 1 : 37) {
        write_bytes(dir / "b.jpg", whole.substr(0, kept));
        EXPECT_FALSE(is_whole_jpeg(dir / "b.jpg")) << kept;
    }
    write_bytes(dir / "b.jpg", whole.substr(0, whole.size() * 3 / 4) + std::string(100000, '\0'));
    EXPECT_FALSE(is_whole_jpeg(dir / "b.jpg"));
}

// Longer than what is read at once, with an end of another picture in a segment.
TEST(JpegMarkers, AreFollowedThroughLongFiles) {
    const TestDir dir;
    const std::string small = jpeg(dir, 8), large = jpeg(dir, 900);
    ASSERT_GT(large.size(), std::size_t{1} << 19);
    std::string segment = "\xFF\xE1";
    segment += static_cast<char>((small.size() + 2) >> 8);
    segment += static_cast<char>((small.size() + 2) & 255);
    const std::string with_preview = large.substr(0, 2) + segment + small + large.substr(2);
    write_bytes(dir / "b.jpg", with_preview);
    EXPECT_TRUE(is_whole_jpeg(dir / "b.jpg"));
    write_bytes(dir / "b.jpg", with_preview.substr(0, with_preview.size() - 2));
    EXPECT_FALSE(is_whole_jpeg(dir / "b.jpg"));
}

TEST(JpegMarkers, AreNotLookedForInOtherFiles) {
    const TestDir dir;
    for (const std::string& text : {std::string(), std::string("text"), std::string("\x89PNG\r\n")}) {
        write_bytes(dir / "b.jpg", text);
        EXPECT_TRUE(is_whole_jpeg(dir / "b.jpg"));
    }
    EXPECT_TRUE(is_whole_jpeg(dir / "missing.jpg"));
}

}  // namespace
}  // namespace tangi
