// file_kind_test.cpp: what is no picture is called by its name, whatever the file is called.
#include "surface/image_file/file_kind.h"

#include <gmock/gmock.h>

#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

TEST(FileKind, IsToldOfWhatIsNoPicture) {
    const TestDir dir;
    const std::pair<std::string, const char*> files[] = {
        {std::string("\0\0\0\x24"
                     "ftypheic\0\0\0\0mif1heic",
                     24) +
             std::string(4000, 'x'),
         "is a HEIC photograph"},
        {std::string("\0\0\0\x1c"
                     "ftypmif1\0\0\0\0",
                     16),
         "is a HEIF photograph"},
        {std::string("\0\0\0\x1c"
                     "ftypavif\0\0\0\0",
                     16),
         "is an AVIF picture"},
        {std::string("\0\0\0\x18"
                     "ftypcrx \0\0\0\1",
                     16),
         "is a camera raw (CR3)"},
        {std::string("\0\0\0\x18"
                     "ftypmp42\0\0\0\0",
                     16),
         "is a film (MP4)"},
        {std::string("RIFF\x10\0\0\0WEBPVP8 ", 16), "is a WebP picture"},
        {std::string("RIFF\x10\0\0\0WAVEfmt ", 16), "is a sound or a film"},
        {"GIF89a\1", "is a GIF picture"},
        {std::string("\xFF\x0A\0", 3), "is a JPEG XL picture"},
        {std::string("\0\0\0\x0CjP  \r\n", 10), "is a JPEG 2000 picture"},
        {"8BPS\0\1", "is a Photoshop file"},
        {"FUJIFILMCCD-RAW 0201", "is a camera raw (RAF)"},
        {"%PDF-1.7", "is a PDF document"},
        {std::string("PK\3\4\x14\0", 6), "is a ZIP archive"},
        {"<!DOCTYPE html><html>not found</html>", "is a web page (HTML)"},
        {"\n <HTML><body>", "is a web page (HTML)"},
        {"<?xml version=\"1.0\"?><svg>", "is an SVG drawing"},
        {"Error 404", "is a text"},
        {std::string("\0\5\x16\7\0\2\0\0Mac OS X", 16), "is what macOS keeps beside a file"},
        {"", "is empty (0 bytes)"},
        {std::string(5000, '\0'), "is nothing but zeros"},
        {"P6 1 1 255\nabc", "is a PPM picture"},
        {"SIMPLE  =                    T", "is a FITS picture"},
        {"\x01\x02\x03\xF0 nothing known", "is no PNG, JPEG, TIFF, EXR, TGA or BMP file"}};
    for (const auto& [bytes, words] : files) {
        write_bytes(dir / "photo.jpg", bytes);
        EXPECT_THAT(error_of([&] { read_picture(dir / "photo.jpg"); }),
                    HasSubstr(std::string("photo.jpg: is not a picture that can be read: it ") + words));
    }
}

}  // namespace
}  // namespace tangi
