// atomic_file_test.cpp: files that appear whole or not at all.
#include "surface/file/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::StartsWith;
using Names = std::vector<std::string>;

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
    const TestDir dir;
    {
        AtomicFile file(dir / "a.txt");
        write_bytes(file.temporary(), "new");
        EXPECT_FALSE(std::filesystem::exists(dir / "a.txt"));
        file.commit();
        EXPECT_EQ(bytes_of(dir / "a.txt"), "new");
    }
    EXPECT_EQ(names_in(dir.path()), Names{"a.txt"});
}

TEST(AtomicFile, LeavesWhatWasThereWhenNotCommitted) {
    const TestDir dir;
    write_bytes(dir / "a.txt", "old");
    {
        AtomicFile file(dir / "a.txt");
        write_bytes(file.temporary(), "half of the n");
    }
    EXPECT_EQ(bytes_of(dir / "a.txt"), "old");
    EXPECT_EQ(names_in(dir.path()), Names{"a.txt"});
}

TEST(AtomicFile, ReplacesWhatWasThereWhenCommitted) {
    const TestDir dir;
    write_bytes(dir / "a.txt", "old and longer");
    write_text_file(dir / "a.txt", "new");
    EXPECT_EQ(bytes_of(dir / "a.txt"), "new");
}

TEST(AtomicFile, WritesWhereALinkLeads) {
    namespace fs = std::filesystem;
    const TestDir dir;
    fs::create_directory(dir / "disk");
    write_bytes(dir / "disk/real.txt", "old");
    fs::create_symlink("disk/real.txt", dir / "link.txt");
    fs::create_symlink("link.txt", dir / "second.txt");
    fs::create_symlink(dir / "disk/new.txt", dir / "dangling.txt");
    fs::create_symlink("loop.txt", dir / "loop.txt");
    write_text_file(dir / "second.txt", "new");
    write_text_file(dir / "dangling.txt", "first");
    EXPECT_EQ(bytes_of(dir / "disk/real.txt"), "new");
    EXPECT_EQ(bytes_of(dir / "disk/new.txt"), "first");
    for (const char* link : {"link.txt", "second.txt", "dangling.txt"})
        EXPECT_TRUE(fs::is_symlink(dir / link)) << link;
    EXPECT_EQ(names_in(dir / "disk"), (Names{"new.txt", "real.txt"}));
    EXPECT_THAT(error_of([&] { write_text_file(dir / "loop.txt", ""); }), testing::HasSubstr("in a circle"));
}

TEST(AtomicFile, KeepsTheExtensionAndTheFolderOfItsTarget) {
    const TestDir dir;
    const AtomicFile file(dir / "my painting.v2.exr");
    EXPECT_EQ(file.temporary().extension(), ".exr");
    EXPECT_EQ(file.temporary().parent_path(), dir.path());
    EXPECT_EQ(file.target(), dir / "my painting.v2.exr");
    EXPECT_TRUE(file.temporary().filename().string().starts_with('.'));  // hidden from lists of photographs
}

TEST(AtomicFile, RefusesPlacesWhereNoFileCanBe) {
    const TestDir dir;
    const std::string folder = dir.path().string();
    write_bytes(dir / "file", "");
    EXPECT_EQ(error_of([&] { AtomicFile(dir.path()); }), folder + ": is a folder; give the name of a file");
    EXPECT_EQ(error_of([&] { AtomicFile(dir.path() / ""); }), folder + "/: is not a file name");
    EXPECT_EQ(error_of([&] { AtomicFile(dir / "no/a.txt"); }),
              folder + "/no/a.txt: there is no folder " + folder + "/no; make it, or choose another place");
    EXPECT_EQ(
        error_of([&] { AtomicFile(dir / "file/a.txt"); }),
        folder + "/file/a.txt: there is no folder " + folder + "/file; make it, or choose another place");
    EXPECT_THAT(error_of([&] { AtomicFile("/proc/tangi.txt"); }),
                StartsWith("/proc/tangi.txt: cannot be written: "));
    EXPECT_EQ(error_of([&] { AtomicFile(""); }), ": is not a file name");
    EXPECT_EQ(names_in(dir.path()), Names{"file"});
}

TEST(AtomicFile, SaysSoWhenTheTargetBecameAFolder) {
    const TestDir dir;
    AtomicFile file(dir / "a");
    std::filesystem::create_directories(dir / "a/b");
    EXPECT_THAT(error_of([&] { file.commit(); }),
                StartsWith((dir / "a").string() + ": cannot be put in place: "));
}

TEST(TextFile, RoundTripsAnyBytes) {
    const TestDir dir;
    std::string text = "first\r\nsecond \xEF\xBB\xBF ";
    text.push_back('\0');
    text += "third";
    write_text_file(dir / "a", text);
    EXPECT_EQ(read_text_file(dir / "a"), text);
    write_text_file(dir / "a", "");
    EXPECT_EQ(read_text_file(dir / "a"), "");
}

TEST(TextFile, OnAFullDiskLeavesTheOldOne) {
    const TestDir dir;
    write_text_file(dir / "a.txt", "old");
    std::string message;
    {
        const FullDisk full(1000);
        message = error_of([&] { write_text_file(dir / "a.txt", std::string(100000, 'x')); });
    }
    EXPECT_THAT(message, StartsWith((dir / "a.txt").string() + ": cannot be written: "));
    EXPECT_EQ(bytes_of(dir / "a.txt"), "old");
    EXPECT_EQ(names_in(dir.path()), Names{"a.txt"});
}

TEST(TextFile, ThatCannotBeReadIsAnError) {
    const TestDir dir;
    EXPECT_EQ(error_of([&] { read_text_file(dir / "a"); }),
              (dir / "a").string() + ": cannot be read: No such file or directory");
    EXPECT_EQ(error_of([&] { read_text_file(dir.path()); }),
              dir.path().string() + ": is a folder; give the name of a file");
}

// The system gives no bytes of /proc/self/mem at its beginning (EIO), as of a disk that fails.
TEST(TextFile, OfADiskThatFailsIsAnErrorThatSaysSo) {
    EXPECT_EQ(error_of([] { read_text_file("/proc/self/mem"); }),
              "/proc/self/mem: cannot be read: Input/output error");
}

TEST(MakeFolder, MakesParentsAndIsFineWithWhatIsThere) {
    const TestDir dir;
    make_folder(dir / "a/b/c");
    EXPECT_TRUE(std::filesystem::is_directory(dir / "a/b/c"));
    EXPECT_NO_THROW(make_folder(dir / "a/b/c"));
}

TEST(MakeFolder, RefusesWhereAFileHasItsName) {
    const TestDir dir;
    write_bytes(dir / "a", "");
    EXPECT_THAT(error_of([&] { make_folder(dir / "a"); }),
                StartsWith((dir / "a").string() + ": cannot be made a folder: "));
    EXPECT_THAT(error_of([&] { make_folder(dir / "a/b"); }),
                StartsWith((dir / "a/b").string() + ": cannot be made a folder: "));
}

// The folder is there: it is not said to be missing.
TEST(AtomicFile, AFolderThatTakesNoFilesIsToldAsSuch) {
    EXPECT_EQ(error_of([] { AtomicFile("/proc/a.exr"); }),
              "/proc/a.exr: cannot be written: /proc takes no files; choose another folder");
}

}  // namespace
}  // namespace tangi
