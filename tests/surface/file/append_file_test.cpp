// append_file_test.cpp: records that are appended whole or not at all, also after a write that broke
// off.
#include "surface/file/append_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include "tests/support/test_support.h"

namespace {
// A disk that fails a sync and drops what it was to keep: of `lost_of`, all beyond `kept` bytes reads as
// zeros.
struct FailingDisk {
    const char* lost_of = nullptr;
    off_t kept = 0;
} failing_disk;
}  // namespace

// In place of the C library's.
extern "C" int fdatasync(int file) {
    if (!failing_disk.lost_of) return ::fsync(file);
    const int same = ::open(failing_disk.lost_of, O_WRONLY);
    struct stat status = {};
    ::fstat(same, &status);
    const off_t length = status.st_size;
    if (::ftruncate(same, failing_disk.kept) != 0 || ::ftruncate(same, length) != 0) std::abort();
    ::close(same);
    failing_disk.lost_of = nullptr;
    errno = EIO;
    return -1;
}

namespace tangi {
namespace {

TEST(AppendFile, WhatAFailedSyncDroppedIsWrittenAgain) {
    const TestDir dir;
    const auto path = dir / "a.jsonl";
    AppendFile file(path);
    file.append("first\n");
    file.sync();
    file.append("second\n");
    failing_disk = {path.c_str(), 6};
    EXPECT_THAT(error_of([&] { file.sync(); }), testing::HasSubstr("a.jsonl: cannot be written"));
    EXPECT_EQ(bytes_of(path), "first\n" + std::string(7, '\0'));
    file.append("third\n");
    file.sync();
    EXPECT_EQ(bytes_of(path), "first\nsecond\nthird\n");
    // A record that was to be on the disk is not in the file, and those before it are.
    file.append("4th\n");
    failing_disk = {path.c_str(), 19};
    EXPECT_THAT(error_of([&] { file.append_synced("fifth\n"); }), testing::HasSubstr("cannot be written"));
    file.append_synced("sixth\n");
    EXPECT_EQ(bytes_of(path), "first\nsecond\nthird\n4th\nsixth\n");
}

TEST(AppendFile, AWriteThatBreaksOffLeavesNothing) {
    const TestDir dir;
    const auto path = dir / "a.jsonl";
    write_bytes(path, "first\n");
    AppendFile file(path);
    EXPECT_EQ(file.length(), 6u);
    file.append("second\n");
    {
        const FullDisk full(20);
        EXPECT_THAT(
            error_of([&] { file.append("third, which is longer\n"); }),
            testing::AllOf(testing::HasSubstr(path.string()), testing::HasSubstr("cannot be written")));
        EXPECT_EQ(bytes_of(path), "first\nsecond\n") << "though there was room for a part of it";
        file.append("4th\n");
        EXPECT_THAT(error_of([&] { file.append_synced("fifth\n"); }),
                    testing::HasSubstr("cannot be written"));
    }
    file.append_synced("sixth\n");
    file.sync();
    EXPECT_EQ(bytes_of(path), "first\nsecond\n4th\nsixth\n");
    EXPECT_EQ(file.length(), 23u);
}

TEST(AppendFile, CutsOffWhatDoesNotCount) {
    const TestDir dir;
    write_bytes(dir / "a", "whole\nto");
    AppendFile file(dir / "a", AppendFile::Open::existing);
    file.cut(6);
    file.append("next\n");
    EXPECT_EQ(bytes_of(dir / "a"), "whole\nnext\n");
    EXPECT_THAT(error_of([&] { AppendFile(dir / "b", AppendFile::Open::existing); }),
                testing::HasSubstr("b: cannot be written"));
}

TEST(AppendFile, LeavesAloneWhatAnotherProgramWrote) {
    const TestDir dir;
    AppendFile file(dir / "a");
    file.append("ours\n");
    for (const std::string theirs : {"ours\ntheirs\n", ""}) {
        write_bytes(dir / "a", theirs);
        EXPECT_THAT(error_of([&] { file.append("more\n"); }),
                    testing::HasSubstr("changed by another program"));
        EXPECT_EQ(bytes_of(dir / "a"), theirs);
    }
    std::filesystem::remove(dir / "a");
    EXPECT_THAT(error_of([&] { file.append("more\n"); }), testing::HasSubstr("removed by another program"));
}

}  // namespace
}  // namespace tangi
