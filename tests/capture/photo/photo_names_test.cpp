// photo_names_test.cpp: the folder that was named wins over the folders that a lights file lists.
#include "capture/photo/photo_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/photo/brackets.h"
#include "capture/photo/photo_folder.h"
#include "capture/stack/open_screened.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr int kNamedPhotos = 5;

void write_photos(const fs::path& folder, const std::string& extension, float level = 0.5f) {
    fs::create_directories(folder);
    for (int i = 0; i < kNamedPhotos; ++i)
        write_picture_8bit(folder / fmt::format("photo_{:03}{}", i, extension), Image<Rgb>(8, 6, Rgb(level)));
}

// Lights that are listed by these names, in `folder`.
void list(const fs::path& folder, const std::function<std::string(int)>& name) {
    std::vector<Light> lights = dome_lights(kNamedPhotos);
    for (int i = 0; i < kNamedPhotos; ++i) lights[static_cast<std::size_t>(i)].name = name(i);
    write_lights(folder / "lights.lp", lights);
}

std::vector<fs::path> folders_of(const Stack& stack) {
    std::vector<fs::path> folders;
    for (const StackPhoto& photo : stack.photos)
        if (folders.empty() || folders.back() != photo.path.parent_path())
            folders.push_back(photo.path.parent_path());
    return folders;
}

TEST(PhotoNames, OfAnotherFolderMeanThoseOfTheFolderThatIsNamed) {
    const TestDir dir;
    write_photos(dir / "old", ".png");
    write_photos(dir / "new", ".png");
    for (const std::string& old :
         {(dir / "old").string() + "/", std::string("../old/"), std::string("..\\old\\")}) {
        list(dir / "new", [&](int i) { return fmt::format("{}photo_{:03}.png", old, i); });
        const Stack stack = open_stack(dir / "new");
        EXPECT_THAT(folders_of(stack), ElementsAre(dir / "new")) << old;
        EXPECT_THAT(stack.warnings,
                    ElementsAre(AllOf(HasSubstr("lists 5 of 5 photographs in another folder"),
                                      HasSubstr("/old)"), HasSubstr("as that folder was named"))))
            << old;
    }
    // A lights file beside them that names them alone, or where they are, is nothing to tell.
    for (const std::string& here : {std::string(), std::string("./"), (dir / "new").string() + "/"}) {
        list(dir / "new", [&](int i) { return fmt::format("{}photo_{:03}.png", here, i); });
        EXPECT_THAT(open_stack(dir / "new").warnings, IsEmpty()) << here;
    }
    list(dir / "old", [](int i) { return fmt::format("photo_{:03}.png", i); });
    const Stack stack = open_stack(dir / "new", {.lights_file = dir / "old/lights.lp"});
    EXPECT_THAT(folders_of(stack), ElementsAre(dir / "new"));
    EXPECT_THAT(stack.warnings, IsEmpty());
}

// Whatever kind of file lists them.
TEST(PhotoNames, OfAnotherFolderInProjectsAndBracketsMeanThoseOfTheFolderThatIsNamed) {
    const TestDir dir;
    write_photos(dir / "old", ".png");
    write_photos(dir / "new", ".png");
    std::string images, directions;
    for (int i = 0; i < kNamedPhotos; ++i) {
        images += fmt::format("{}{{\"filename\": \"{}/photo_{:03}.png\"}}", i ? ", " : "",
                              (dir / "old").string(), i);
        directions += fmt::format("{}{{\"x\": {}, \"y\": 0.3, \"z\": 0.8}}", i ? ", " : "", 0.1 * i);
    }
    write_bytes(dir / "new/project.relight",
                fmt::format("{{\"images\": [{}], \"dome\": {{\"directions\": [{}]}}}}", images, directions));
    const Stack stack = open_stack(dir / "new");
    EXPECT_THAT(folders_of(stack), ElementsAre(dir / "new"));
    EXPECT_THAT(stack.warnings, ElementsAre(HasSubstr("lists 5 of 5 photographs in another folder")));
    write_bytes(dir / "brackets.json",
                fmt::format("{{\"a\": [\"{}/photo_001.png\"]}}", (dir / "old").string()));
    EXPECT_EQ(read_brackets(dir / "brackets.json", dir / "new").at("a").front().path,
              dir / "new/photo_001.png");
}

// What is missing in the folder is not taken from another one beside its own photographs.
TEST(PhotoNames, AreMissingWhereOnlyAnotherFolderHasThem) {
    const TestDir dir;
    write_photos(dir / "old", ".png");
    write_photos(dir / "new", ".png");
    fs::remove(dir / "new/photo_002.png");
    list(dir / "new", [&](int i) { return fmt::format("{}/photo_{:03}.png", (dir / "old").string(), i); });
    EXPECT_THAT(error_of([&] { open_stack(dir / "new"); }),
                AllOf(HasSubstr("1 of 5 listed photographs are not in "), HasSubstr("photo_002.png")));
}

TEST(PhotoNames, AreFollowedFromAFolderWithoutPhotographs) {
    const TestDir dir;
    write_photos(dir / "photographs", ".png");
    fs::create_directory(dir / "lights");
    list(dir / "lights", [](int i) { return fmt::format("../photographs/photo_{:03}.png", i); });
    const Stack stack = open_stack(dir / "lights");
    EXPECT_THAT(folders_of(stack), ElementsAre(dir / "photographs"));
    EXPECT_THAT(stack.warnings,
                ElementsAre(AllOf(HasSubstr("holds no photographs"), HasSubstr("photographs"))));
}

TEST(PhotoNames, OfAnotherExtensionMeanTheOneFileOfTheStem) {
    for (const auto& [there, listed] :
         {std::pair(".bmp", ".jpg"), {".png", ".DNG"}, {".jpg", ".tif"}, {".tif", ".cr2"}}) {
        const TestDir dir;
        if (there == std::string(".bmp")) {
            write_photos(dir.path(), ".png");
            for (int i = 0; i < kNamedPhotos; ++i)
                fs::rename(dir / fmt::format("photo_{:03}.png", i), dir / fmt::format("photo_{:03}.bmp", i));
            list(dir.path(), [](int i) { return fmt::format("PHOTO_{:03}.jpg", i); });
            EXPECT_EQ(photo_named("PHOTO_001.jpg", dir.path(), photos_in(dir.path())).photo,
                      dir / "photo_001.bmp");
            continue;
        }
        write_photos(dir.path(), there);
        list(dir.path(), [&, &listed = listed](int i) { return fmt::format("PHOTO_{:03}{}", i, listed); });
        const Stack stack = open_stack(dir.path());
        EXPECT_EQ(stack.photos.size(), static_cast<std::size_t>(kNamedPhotos));
        EXPECT_EQ(stack.photos[1].path, dir / fmt::format("photo_001{}", there));
        EXPECT_THAT(stack.warnings, IsEmpty());
    }
}

TEST(PhotoNames, OfSeveralFilesMeanTheOneThatIsNoJpeg) {
    const TestDir dir;
    write_photos(dir.path(), ".jpg");
    write_photos(dir.path(), ".tif");
    list(dir.path(), [](int i) { return fmt::format("photo_{:03}.dng", i); });
    const Stack stack = open_stack(dir.path());
    ASSERT_EQ(stack.photos.size(), static_cast<std::size_t>(kNamedPhotos));
    EXPECT_EQ(stack.photos[1].path, dir / "photo_001.tif");
    EXPECT_THAT(stack.warnings, ElementsAre(AllOf(HasSubstr("photo_000.tif, photo_001.tif"),
                                                  HasSubstr("and not the JPEG files beside them"))));
    // By the letter, there is nothing to choose.
    list(dir.path(), [](int i) { return fmt::format("photo_{:03}.jpg", i); });
    EXPECT_EQ(open_stack(dir.path()).photos[1].path, dir / "photo_001.jpg");
}

TEST(PhotoNames, ThatSeveralFilesHaveAreToldWithThem) {
    const TestDir dir;
    write_photos(dir.path(), ".png");
    write_photos(dir.path(), ".tif");
    list(dir.path(), [](int i) { return fmt::format("photo_{:03}.dng", i); });
    EXPECT_THAT(
        error_of([&] { open_stack(dir.path()); }),
        AllOf(HasSubstr("5 of 5 listed photographs may be one of several files"),
              HasSubstr("'photo_000.dng' photo_000.png, photo_000.tif"), HasSubstr("with its extension")));
    EXPECT_THAT(error_of([&] { open_usable_stack(dir.path(), {}); }),
                HasSubstr("may be one of several files"));
}

TEST(PhotoNames, OfPicturesThatAreNotReadAreToldWithThem) {
    const TestDir dir;
    write_photos(dir.path(), ".png");
    list(dir.path(), [](int i) { return fmt::format("photo_{:03}.png", i); });
    fs::rename(dir / "photo_003.png", dir / "photo_003.HEIC");
    EXPECT_THAT(
        error_of([&] { open_stack(dir.path()); }),
        AllOf(HasSubstr("photo_003.HEIC is there, but .heic files are not read"), HasSubstr("TIFF or PNG")));
}

}  // namespace
}  // namespace tangi
