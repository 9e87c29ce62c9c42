// photo_file_errors_test.cpp: what is no photograph, or a part of one, is an error that names it.
#include <gmock/gmock.h>

#include "capture/photo/photo_metadata.h"
#include "tests/support/capture/photo_files.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(PhotoFile, IsToldByItsExtension) {
    for (const char* name : {"a.jpg", "a.JPEG", "b/c.png", "x.Tif", "x.tiff", "x.exr", "x.TGA", "x.bmp"})
        EXPECT_TRUE(is_photo_name(name)) << name;
    for (const char* name : {"a.lp", "a.txt", "jpg", "a.jpg.bak", "", "a.cr2x"})
        EXPECT_FALSE(is_photo_name(name)) << name;
}

TEST(PhotoFile, ThatIsMissingOrAFolderIsAnError) {
    const TestDir dir;
    fs::create_directory(dir / "a.jpg");
    EXPECT_EQ(error_of([] { PhotoFile("/nowhere/a.jpg"); }), "/nowhere/a.jpg: no such photograph");
    EXPECT_EQ(error_of([&] { PhotoFile(dir / "a.jpg"); }),
              (dir / "a.jpg").string() + ": is a folder, not a photograph");
}

TEST(PhotoFile, ThatIsTextIsAnError) {
    const TestDir dir;
    for (const char* name : {"a.jpg", "a.png", "a.tif", "a.exr", "a.tga"})
        for (const std::string text :
             {"", "this is no picture, whatever its name says; it is a text file\n"}) {
            write_bytes(dir / name, text);
            EXPECT_THAT(error_of([&] { PhotoFile(dir / name); }),
                        StartsWith((dir / name).string() + ": is not a picture that can be read: "));
        }
}

TEST(PhotoFile, OfJpegTruncatedIsAnError) {
    const TestDir dir;
    write(dir / "a.jpg", spec_of(TypeDesc::UINT8), random_codes(3, 8));
    const std::string whole = bytes_of(dir / "a.jpg");
    for (const double part : {0.5, 0.7, 0.99}) {
        write_bytes(dir / "cut.jpg",
                    whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
        EXPECT_EQ(
            error_of([&] { PhotoFile(dir / "cut.jpg"); }),
            (dir / "cut.jpg").string() + ": the JPEG file is truncated; copy it again from where it came");
    }
    write_bytes(dir / "padded.jpg", whole + std::string(1000, '\0'));  // as some cameras write them
    EXPECT_NO_THROW(PhotoFile(dir / "padded.jpg"));
    // The film of a motion photograph.
    write_bytes(dir / "film.jpg", whole +
                                      std::string("\0\0\0\x18"
                                                  "ftypmp42",
                                                  12) +
                                      std::string(120000, '\0'));
    EXPECT_EQ(read_in_bands(dir / "film.jpg", 8), read_in_bands(dir / "a.jpg", 8));
}

TEST(PhotoFile, OfJpegTruncatedIsFoundBehindACompleteThumbnail) {
    const TestDir dir;
    write(dir / "a.jpg", spec_of(TypeDesc::UINT8), random_codes(3, 8));
    const std::string whole = bytes_of(dir / "a.jpg");
    const std::string thumbnail = whole;  // a whole JPEG with its own end, in a segment of the file
    std::string segment = "\xFF\xE1";     // APP1
    segment += static_cast<char>((thumbnail.size() + 2) >> 8);
    segment += static_cast<char>((thumbnail.size() + 2) & 255);
    const std::string with_thumbnail = whole.substr(0, 2) + segment + thumbnail + whole.substr(2);
    write_bytes(dir / "b.jpg", with_thumbnail);
    EXPECT_NO_THROW(PhotoFile(dir / "b.jpg"));
    write_bytes(dir / "b.jpg", with_thumbnail.substr(0, with_thumbnail.size() * 7 / 10));
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "b.jpg"); }),
                StartsWith((dir / "b.jpg").string() + ": the JPEG file is truncated"));
}

// At once, not when its last rows are wanted.
TEST(PhotoFile, OfPngTruncatedIsAnError) {
    const TestDir dir;
    write(dir / "a.png", spec_of(TypeDesc::UINT16), random_codes(3, 16));
    const std::string whole = bytes_of(dir / "a.png");
    for (const std::size_t kept : {whole.size() - 1, whole.size() / 2, std::size_t{40}, std::size_t{8}}) {
        write_bytes(dir / "b.png", whole.substr(0, kept));
        EXPECT_EQ(error_of([&] { PhotoFile(dir / "b.png"); }),
                  (dir / "b.png").string() + ": the PNG file is truncated; copy it again from where it came")
            << kept;
    }
    std::string damaged = whole;
    damaged[33] = '\x60';  // the length of its second chunk: 1.6 GB, which libpng would ask for
    write_bytes(dir / "b.png", damaged);
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "b.png"); }), HasSubstr("the PNG file is truncated"));
    EXPECT_THAT(error_of([&] { read_photo_metadata(dir / "b.png"); }), HasSubstr("cut off, or damaged"));
    write_bytes(dir / "b.png", whole + std::string(1000, '\0'));  // padding does no harm
    EXPECT_EQ(PhotoFile(dir / "b.png").header().width, kPhotoWidth);
}

// OpenImageIO would take what follows for arguments, as in an address of the web.
TEST(PhotoFile, MayHaveAQuestionMarkInItsPath) {
    const TestDir dir;
    const fs::path folder = dir / "which? folder&x=1";
    fs::create_directory(folder);
    for (const char* extension : {".png", ".tif", ".exr", ".TIFF"}) {
        const std::vector<float> values = random_codes(3, 8);
        const fs::path plain = dir / (std::string("plain") + extension);
        write(plain, spec_of(TypeDesc::UINT8), values);
        fs::copy_file(plain, folder / (std::string("img 1?") + extension));
        EXPECT_EQ(read_in_bands(folder / (std::string("img 1?") + extension), 16), read_in_bands(plain, 16))
            << extension;
    }
    write_bytes(folder / "text.png", "this is no picture");
    EXPECT_THAT(error_of([&] { PhotoFile(folder / "text.png"); }),
                StartsWith((folder / "text.png").string() + ": is not a picture that can be read: "));
    EXPECT_THAT(error_of([&] { PhotoFile(folder / "text.png?x"); }), HasSubstr("no such photograph"));
}

TEST(PhotoFile, TruncatedIsAnErrorAtTheLatestWhereItsRowsAreRead) {
    const TestDir dir;
    const struct {
        const char* name;
        OIIO::ImageSpec spec;
    } formats[] = {{"a.png", spec_of(TypeDesc::UINT8)},
                   {"a.exr", spec_of(TypeDesc::HALF)},
                   {"tiled.exr", tiled(spec_of(TypeDesc::HALF), 8)},
                   {"a.tga", spec_of(TypeDesc::UINT8)},
                   {"a.bmp", spec_of(TypeDesc::UINT8)},
                   {"a.tif", spec_of(TypeDesc::UINT8)}};
    for (const auto& [name, spec] : formats) {
        write(dir / name, spec, random_codes(3, 8));
        const std::string whole = bytes_of(dir / name);
        write_bytes(dir / name, whole.substr(0, whole.size() * 6 / 10));
        EXPECT_THAT(error_of([&, &name = name] { read_in_bands(dir / name, 8); }),
                    StartsWith((dir / name).string() + ": "))
            << name;
    }
    write(dir / "a.png", formats[0].spec, random_codes(3, 8));
    std::string damaged = bytes_of(dir / "a.png");
    const std::size_t hole = damaged.size() * 6 / 10;
    std::fill(damaged.begin() + static_cast<std::ptrdiff_t>(hole), damaged.end() - 40, '\0');
    write_bytes(dir / "a.png", damaged);
    EXPECT_THAT(error_of([&] { read_in_bands(dir / "a.png", kPhotoHeight); }),
                StartsWith((dir / "a.png").string() + ": cannot be decoded at rows 0 to 36: "));
    // Its last chunk is there, but the one before does not lead to it.
    write_bytes(dir / "a.png", damaged.substr(0, hole) + std::string("\0\0\0\0IEND\xAE\x42\x60\x82", 12));
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "a.png"); }), HasSubstr("the PNG file is truncated"));
}

TEST(PhotoFile, ReadOutsideItsRowsOrIntoTooLittleBreaksTheContract) {
    const TestDir dir;
    write(dir / "a.png", spec_of(TypeDesc::UINT8), random_codes(3, 8));
    PhotoFile file(dir / "a.png");
    std::vector<float> row(kPhotoWidth * 3);
    EXPECT_THROW(file.read_rows(-1, 0, row), ContractError);
    EXPECT_THROW(file.read_rows(kPhotoHeight, kPhotoHeight + 1, row), ContractError);
    EXPECT_THROW(file.read_rows(3, 3, row), ContractError);
    EXPECT_THROW(file.read_rows(0, 2, row), ContractError);
    EXPECT_NO_THROW(file.read_rows(kPhotoHeight - 1, kPhotoHeight, row));
}

}  // namespace
}  // namespace tangi
