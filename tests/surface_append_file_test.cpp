// surface_append_file_test.cpp: records that are appended whole or not at all, also after a write that broke
// off.
#include "surface/append_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/test_support.h"

namespace tangi {
namespace {

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
