// photo_format_test.cpp: laws of the table of photograph formats: what its rows say of a file is what its
// reader finds.
#include "capture/photo/photo_format.h"

#include <gmock/gmock.h>

#include <set>

#include "capture/photo/photo_file.h"
#include "capture/photo/photo_folder.h"
#include "capture/photo/raw_file.h"
#include "tests/support/capture/photo_files.h"

namespace tangi {
namespace {

TEST(PhotoFormats, HaveNamesAndExtensionsOfTheirOwn) {
    std::set<std::string_view> names, extensions;
    for (const PhotoFormat& format : photo_formats()) {
        EXPECT_TRUE(names.insert(format.name).second) << format.name;
        EXPECT_FALSE(format.extensions.empty()) << format.name;
        for (const std::string_view extension : format.extensions) {
            EXPECT_TRUE(extensions.insert(extension).second) << extension;
            const std::string file = "A" + std::string(extension);
            EXPECT_EQ(photo_format_named(file), &format);
            EXPECT_TRUE(is_photo_name(file));
            EXPECT_FALSE(is_unread_picture_name(file)) << extension;
            EXPECT_EQ(is_raw_name(file), format.kind == PhotoKind::camera_raw) << extension;
        }
    }
    EXPECT_EQ(photo_format_named("A.JPEG"), photo_format_named("b/a.jpg"));
    EXPECT_EQ(photo_format_named("a.lp"), nullptr);
    EXPECT_TRUE(is_unread_picture_name("a.HEIC"));
}

// Camera raws are not written here: raw_test.cpp has those.
TEST(PhotoFormats, AreReadAsTheirRowsSay) {
    const TestDir dir;
    for (const PhotoFormat& format : photo_formats()) {
        if (format.kind == PhotoKind::camera_raw) continue;
        const fs::path path = dir / ("a" + std::string(format.extensions.front()));
        write(path, spec_of(format.kind == PhotoKind::linear ? TypeDesc::HALF : TypeDesc::UINT8),
              random_codes(3, 8));
        const PhotoHeader header = PhotoFile(path).header();
        EXPECT_EQ(header.width, kPhotoWidth) << format.name;
        if (format.kind != PhotoKind::any) {
            EXPECT_EQ(header.says_linear, format.kind == PhotoKind::linear) << format.name;
            EXPECT_EQ(header.is_float, format.kind == PhotoKind::linear) << format.name;
        }
    }
    EXPECT_EQ(photos_in(dir.path()).size(), photo_formats().size() - 1);
}

TEST(PhotoFormats, AreListedInMessages) {
    EXPECT_EQ(photo_formats_in_words(), "JPEG, PNG, TIFF, EXR, TGA, BMP or camera raw");
}

}  // namespace
}  // namespace tangi
