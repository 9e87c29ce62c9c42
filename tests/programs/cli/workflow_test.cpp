// workflow_test.cpp: workflow/Snakefile takes stacks to pages and a table, and goes on where it was stopped.
#include <gmock/gmock.h>

#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_reader.h"
#include "tests/programs/support/cli_program.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kSnakemake = "/usr/bin/snakemake";

Finished snakemake(const fs::path& folder, const std::vector<std::string>& more = {}) {
    const fs::path workflow = fs::path(TP_SOURCE_DIR) / "workflow";
    std::vector<std::string> words = {"-s",
                                      (workflow / "Snakefile").string(),
                                      "--profile",
                                      (workflow / "profiles/machine").string(),
                                      "--cores",
                                      "2",
                                      "--config",
                                      std::string("program=") + TP_PROGRAM,
                                      "stacks=stacks",
                                      "out=out",
                                      "megapixels={\"wall\": 400}"};
    words.insert(words.end(), more.begin(), more.end());
    Conditions conditions{.cwd = folder};
    conditions.timeout = std::chrono::minutes(10);
    Program program(words, conditions, kSnakemake);
    return program.wait();
}

TP_LONG TEST(Workflow, MakesPagesAndATable) {
    if (!fs::exists(kSnakemake)) GTEST_SKIP() << "snakemake is not installed";
    const TestDir folder;
    const TinyStack small, wall({}, 128);
    fs::create_directories(folder.path() / "stacks");
    fs::copy(small.path(), folder.path() / "stacks/coin", fs::copy_options::recursive);
    fs::copy(wall.path(), folder.path() / "stacks/wall", fs::copy_options::recursive);
    const Finished first = snakemake(folder.path());
    ASSERT_EQ(first.code, 0) << first.err;
    const fs::path out = folder.path() / "out";
    for (const char* name : {"pages/coin/index.html", "pages/wall/index.html", "whole/coin.exr",
                             "steps/wall.exr", "summary.html"})
        EXPECT_TRUE(fs::exists(out / name)) << name;
    const std::string table = read_text_file(out / "summary.csv");
    EXPECT_THAT(table, HasSubstr("coin,"));
    EXPECT_THAT(table, HasSubstr("wall,"));
    const std::string painting = read_text_file(out / "steps/wall.exr");

    EXPECT_THAT(snakemake(folder.path()).err, HasSubstr("Nothing to be done"));
    fs::remove(out / "steps/wall.exr");
    fs::remove(out / "pages/wall/index.html");
    ASSERT_EQ(snakemake(folder.path()).code, 0);
    EXPECT_EQ(read_text_file(out / "steps/wall.exr"), painting);
}

// One of which nothing can be made: the others have their pages, and the table says what failed and why.
TP_LONG TEST(Workflow, TellsOfAStackThatCannotBeFitted) {
    if (!fs::exists(kSnakemake)) GTEST_SKIP() << "snakemake is not installed";
    const TestDir folder;
    const TinyStack sound, torn;
    fs::create_directories(folder.path() / "stacks");
    fs::copy(sound.path(), folder.path() / "stacks/sound", fs::copy_options::recursive);
    fs::copy(torn.path(), folder.path() / "stacks/torn", fs::copy_options::recursive);
    const fs::path lights = folder.path() / "stacks/torn/lights.lp", out = folder.path() / "out";
    const std::string words = read_text_file(lights);
    write_bytes(lights, "");
    const Finished run = snakemake(folder.path());
    EXPECT_NE(run.code, 0);
    EXPECT_THAT(run.err, HasSubstr("lights.lp"));
    EXPECT_TRUE(fs::exists(out / "pages/sound/index.html"));
    const std::string table = read_text_file(out / "summary.csv");
    EXPECT_THAT(table, HasSubstr("\ntorn,failed,"));
    EXPECT_THAT(table, HasSubstr("tangipaint fit: "));
    EXPECT_THAT(table, HasSubstr("lights.lp"));
    EXPECT_THAT(table, HasSubstr("\nsound,"));
    EXPECT_THAT(read_text_file(out / "summary.html"), HasSubstr("2 paintings, of which 1 failed"));
    // Mended, it goes on with that one alone.
    write_bytes(lights, words);
    const Finished again = snakemake(folder.path());
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_THAT(read_text_file(out / "summary.csv"), testing::Not(HasSubstr("failed")));
}

// From the photographs of two positions to one painting in tiles, and its page.
TP_LONG TEST(Workflow, JoinsTheWallOfTwoPositions) {
    if (!fs::exists(kSnakemake)) GTEST_SKIP() << "snakemake is not installed";
    const TestDir folder;
    ASSERT_TRUE(ended(
        tangipaint({"generate", "--out", (folder.path() / "stacks").string(), "--positions", "2x1", "--width",
                    "420", "--height", "200", "--mm-per-pixel", "0.06", "--lights", "8", "--held-out", "0"}),
        0));
    fs::remove_all(folder.path() / "stacks/gt");
    const Finished done = snakemake(folder.path(), {"walls={\"wall\": [\"r0_c0\", \"r0_c1\"]}"});
    ASSERT_EQ(done.code, 0) << done.err;
    const fs::path out = folder.path() / "out";
    EXPECT_TRUE(fs::exists(out / "pages/wall/index.html"));
    EXPECT_TRUE(fs::exists(out / "walls/wall.report.html"));
    const auto wall = open_painting(out / "walls/wall.tangi"), part = open_painting(out / "whole/r0_c0.exr");
    EXPECT_GT(wall->width(), 1.5 * part->width());
    EXPECT_LT(wall->height(), 1.1 * part->height());
}

}  // namespace
}  // namespace tangi
