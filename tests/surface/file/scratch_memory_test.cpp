// scratch_memory_test.cpp: memory that may lie on disk is memory all the same.
#include "surface/file/scratch_memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <span>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(ScratchMemory, HoldsWhatIsWrittenWhereverItIs) {
    constexpr std::size_t kCount = 100'000;
    const TestDir folder;
    for (const std::size_t most_held : {std::size_t(1) << 30, std::size_t(1) << 10}) {
        ScratchMemory memory(kCount * sizeof(std::uint32_t), most_held, folder.path().string());
        EXPECT_EQ(memory.on_disk(), most_held < kCount);
        const std::span<std::uint32_t> words(static_cast<std::uint32_t*>(memory.data()), kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            ASSERT_EQ(words[i], 0u);
            words[i] = static_cast<std::uint32_t>(i * 2654435761u);
        }
        const ScratchMemory moved = std::move(memory);
        EXPECT_EQ(moved.data(), words.data());
        for (std::size_t i = 0; i < kCount; ++i)
            ASSERT_EQ(words[i], static_cast<std::uint32_t>(i * 2654435761u));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file has no name";
}

TEST(ScratchMemory, IsOrdinaryWhereThereIsNoDisk) {
    const ScratchMemory memory(1 << 20, 0, "/nowhere");
    EXPECT_FALSE(memory.on_disk());
    static_cast<char*>(memory.data())[(1 << 20) - 1] = 1;
    EXPECT_EQ(ScratchMemory().data(), nullptr);
    EXPECT_EQ(ScratchMemory(0).data(), nullptr);
}

}  // namespace
}  // namespace tangi
