// bagit_test.cpp: bags are as they were packed, or their faults are told.
#include "surface/publish/bagit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "surface/file/atomic_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Bags, AreReadAgainAlsoWithStrangeNames) {
    const TestDir dir;
    make_folder(dir / "photos" / "of 50%\nthe canvas");
    write_bytes(dir / "photos" / "a.txt", "a");
    write_bytes(dir / "photos" / "of 50%\nthe canvas" / "b.txt", "bb");
    write_bytes(dir / "photos" / ".hidden", "not packed");
    const BagReport packed = fill_bag(dir / "bag", {dir / "photos"}, {{"External-Description", "A bag"}});
    EXPECT_EQ(packed.files, 2u);
    EXPECT_EQ(packed.bytes, 3u);
    EXPECT_THAT(read_text_file(dir / "bag" / "manifest-sha256.txt"),
                HasSubstr("data/photos/of 50%25%0Athe canvas/b.txt\n"));
    const BagReport checked = check_bag(dir / "bag");
    EXPECT_THAT(checked.faults, IsEmpty());
    EXPECT_EQ(checked.files, 2u);
}

TEST(Bags, DoNotReachOutsideOfThemselves) {
    const TestDir dir;
    write_bytes(dir / "a.txt", "a");
    fill_bag(dir / "bag", {dir / "a.txt"}, {});
    const fs::path manifest = dir / "bag" / "manifest-sha256.txt";
    write_bytes(manifest, read_text_file(manifest) + std::string(64, '0') + "  ../a.txt\n");
    EXPECT_THAT(check_bag(dir / "bag").faults, testing::Contains(HasSubstr("outside of the bag")));
}

TEST(Bags, WithTwoFilesOfOneNameAreRefused) {
    const TestDir dir;
    make_folder(dir / "b");
    write_bytes(dir / "a.txt", "a");
    write_bytes(dir / "b" / "a.txt", "b");
    EXPECT_THAT(error_of([&] {
                    fill_bag(dir / "bag", {dir / "a.txt", dir / "b" / "a.txt"}, {});
                }),
                HasSubstr("the same name"));
    EXPECT_THAT(error_of([&] { check_bag(dir / "b"); }), HasSubstr("no bagit.txt"));
}

}  // namespace
}  // namespace tangi
