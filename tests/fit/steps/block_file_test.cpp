// block_file_test.cpp: arrays come back as they were written, and damage is named.
#include "fit/steps/block_file.h"

#include <gmock/gmock.h>

#include <fstream>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

void write_blocks(const std::filesystem::path& path) {
    const std::vector<float> heights = {1.5f, -2, 0};
    const std::vector<std::uint16_t> none;
    BlocksToWrite blocks;
    blocks.add("heights", std::span(heights));
    blocks.add("none", std::span(none));
    AtomicFile file(path);
    blocks.write({{"tile", 7}}, file);
    file.commit();
}

std::string error_of_reading(const std::filesystem::path& path) {
    try {
        const BlockFile blocks(path);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(BlockFile, GivesBackWhatWasWritten) {
    const TestDir folder;
    const auto path = folder.path() / "a.maps";
    write_blocks(path);
    const BlockFile blocks(path);
    EXPECT_EQ(blocks.of().at("tile"), 7);
    EXPECT_THAT(blocks.get<float>("heights"), ElementsAre(1.5f, -2, 0));
    EXPECT_TRUE(blocks.has("none"));
    EXPECT_FALSE(blocks.has("normals"));
    EXPECT_THAT(blocks.get<std::uint16_t>("none"), ElementsAre());
    std::vector<float> two(2);
    EXPECT_THROW(blocks.copy("heights", std::span(two)), Error);
    EXPECT_THROW(blocks.get<float>("normals"), Error);
}

TEST(BlockFile, NamesWhatIsDamaged) {
    const TestDir folder;
    const auto path = folder.path() / "a.maps";
    write_blocks(path);
    const std::string whole = read_text_file(path);
    std::string flipped = whole;
    flipped[flipped.size() - 3] ^= 1;
    for (const auto& [text, why] :
         {std::pair(flipped, "checksum"), std::pair(whole.substr(0, whole.size() - 1), "cut off"),
          std::pair(whole.substr(0, 25), "cut off"), std::pair(std::string("{}"), "no file of blocks")}) {
        std::ofstream(path, std::ios::binary) << text;
        const std::string error = error_of_reading(path);
        EXPECT_THAT(error, HasSubstr(path.string()));
        EXPECT_THAT(error, HasSubstr(why));
    }
}

}  // namespace
}  // namespace tangi
