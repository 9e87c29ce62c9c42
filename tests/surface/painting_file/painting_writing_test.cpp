// painting_writing_test.cpp: what cannot be written leaves what was there, and says why.
#include <gmock/gmock.h>

#include "surface/painting_file/painting_file.h"
#include "tests/support/surface/painting_file_support.h"

namespace tangi {
namespace {

using testing::StartsWith;

TEST(PaintingWriting, OnAFullDiskLeavesTheOldFileAndNoTemporary) {
    const TestDir dir;
    write_painting(dir / "a.exr", random_surface(30, 40));
    const std::string old = bytes_of(dir / "a.exr");
    const Surface next = random_surface(30, 40, 2);
    write_painting(dir / "b.exr", next);
    const std::size_t size = std::filesystem::file_size(dir / "b.exr");
    std::filesystem::remove(dir / "b.exr");
    for (const std::size_t room : {std::size_t{0}, std::size_t{100}, size / 2, size - 100, size - 1}) {
        std::string message;
        {
            const FullDisk full(room);
            message = error_of([&] { write_painting(dir / "a.exr", next); });
        }
        EXPECT_THAT(message, StartsWith((dir / "a.exr").string() + ": cannot be written: ")) << room;
        EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{"a.exr"}) << room;
        EXPECT_TRUE(bytes_of(dir / "a.exr") == old) << room;
    }
    const FullDisk just_enough(size);
    EXPECT_NO_THROW(write_painting(dir / "a.exr", next));
}

TEST(PaintingWriting, CannotGoToAMissingFolderOrOntoAFolder) {
    const TestDir dir;
    const std::string target = (dir / "no").string() + "/a.exr";
    EXPECT_EQ(
        error_of([&] { write_painting(target, Surface(2, 2)); }),
        target + ": there is no folder " + (dir / "no").string() + "; make it, or choose another place");
    EXPECT_EQ(error_of([&] { write_painting(dir.path(), Surface(2, 2)); }),
              dir.path().string() + ": is a folder; give the name of a file");
}

TEST(PaintingWriting, CancelledInTheMiddleLeavesNothing) {
    const TestDir dir;
    const Surface s = random_surface(4, 1000);
    const auto until_half = [](std::string_view, double fraction) { return fraction < 0.5; };
    EXPECT_THROW(write_painting(dir / "a.exr", s, until_half), Cancelled);
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{});
    write_painting(dir / "a.exr", s);
    EXPECT_THROW(read_painting(dir / "a.exr", until_half), Cancelled);
}

TEST(PaintingWriting, OfNoPixelsBreaksTheContract) {
    const TestDir dir;
    EXPECT_THROW(write_painting(dir / "a.exr", Surface()), ContractError);
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{});
}

}  // namespace
}  // namespace tangi
