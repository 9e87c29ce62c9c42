// file_name_test.cpp: names that are too long, and places that cannot be looked into, in plain words.
#include "surface/file/file_name.h"

#include <gmock/gmock.h>

#include "surface/base/memory_error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/error_message.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string times(std::size_t count, const std::string& text) {
    std::string all;
    while (count-- > 0) all += text;
    return all;
}

// How many characters it says to take away.
std::size_t told_less(const std::string& told) {
    const std::string before = "make it ";
    const auto at = told.find(before);
    return at == std::string::npos ? 0 : std::stoul(told.substr(at + before.size()));
}

TEST(FileName, FitsOnceItIsAsMuchShorterAsIsSaid) {
    const TestDir dir;
    EXPECT_EQ(told_of_length(dir / "a.exr"), "");
    for (const char* character : {"a", "ö", "油", "🎨"})
        for (const std::size_t beside : {std::size_t(0), kBesideName}) {
            const std::string told = told_of_length(dir / (times(300, character) + ".exr"), beside);
            const std::size_t less = told_less(told);
            ASSERT_GT(less, 0u) << told;
            const fs::path fits = dir / (times(300 - less, character) + ".exr");
            EXPECT_EQ(told_of_length(fits, beside), "") << character;
            EXPECT_NE(told_of_length(dir / (times(301 - less, character) + ".exr"), beside), "") << character;
            EXPECT_NO_THROW(write_text_file(fits, "x")) << character;
        }
}

TEST(FileName, ThatIsTooLongIsToldInPlainWords) {
    const TestDir dir;
    for (const std::size_t length : {236, 251, 255, 256, 1000}) {
        const std::string told = error_of([&] { write_text_file(dir / (times(length, "n") + ".exr"), "x"); });
        EXPECT_THAT(told,
                    AllOf(HasSubstr("the name is too long: make it"), Not(HasSubstr("filesystem error"))))
            << length;
        EXPECT_LT(told.size(), 200u) << told;
    }
}

// Whatever threw it, no words of a library.
TEST(FileName, WhatTheFileSystemSaysIsToldWithTheFile) {
    const TestDir dir;
    const auto told = [](const auto& body) -> std::string {
        try {
            body();
        } catch (const std::exception& error) {
            return message_of(error);
        }
        return "";
    };
    EXPECT_THAT(told([&] { (void)fs::exists(dir / times(300, "n")); }),
                AllOf(HasSubstr("the name is too long: 255 bytes"), Not(HasSubstr("filesystem error"))));
    EXPECT_EQ(told([&] { (void)fs::file_size(dir / "gone"); }),
              (dir / "gone").string() + ": No such file or directory");
    EXPECT_EQ(told([&] { fail("as it is"); }), "as it is");
    EXPECT_EQ(told([&] { throw std::bad_alloc(); }), kNoMemory);
}

}  // namespace
}  // namespace tangi
