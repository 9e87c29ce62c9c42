// mosaic_test.cpp: tangipaint mosaic: of stacks and of paintings, and what is not taken for a position's fit.
#include <gmock/gmock.h>

#include "surface/painting_file/painting_reader.h"
#include "tests/programs/support/cli_program.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Two overlapping positions of a painting of this seed.
void photograph(const fs::path& folder, int seed) {
    ASSERT_TRUE(ended(tangipaint({"generate", "--out", folder.string(), "--positions", "2x1", "--width",
                                  "420", "--height", "200", "--mm-per-pixel", "0.06", "--lights", "6",
                                  "--held-out", "0", "--seed", std::to_string(seed)}),
                      0));
}

std::string hash_of_wall(const fs::path& wall) { return open_painting(wall)->header().dry_hash; }

TP_LONG TEST(CliMosaic, FitsStacksOnceAndAnewWhereTheyChanged) {
    const TestDir dir;
    photograph(dir / "a", 1);
    photograph(dir / "b", 2);
    const auto join = [&](const std::string& of, const std::string& out) {
        return tangipaint({"mosaic", (dir / of / "r0_c0").string() + "/", (dir / of / "r0_c1").string(),
                           "--out", (dir / out).string()});
    };
    const Finished joined = join("a", "a.exr");
    ASSERT_TRUE(ended(joined, 0, {"r0_c0 in row 0, column 0; r0_c1 in row 0, column 1", "--layout FILE"}));
    EXPECT_EQ(joined.json()["layout_hint"], "names");
    EXPECT_EQ(joined.json()["layout"][1], nlohmann::json({{"name", "r0_c1"}, {"column", 1}, {"row", 0}}));
    EXPECT_THAT(names_in(dir.path()), testing::ElementsAre("a", "a.exr", "a.fits", "b"));
    const std::string wall = hash_of_wall(dir / "a.exr");
    const Finished again = join("a", "a.exr");
    EXPECT_THAT(again.err, HasSubstr("was fitted before"));
    EXPECT_EQ(hash_of_wall(dir / "a.exr"), wall);
    // Positions of another wall have the same names.
    fs::copy(dir / "a.fits", dir / "b.fits", fs::copy_options::recursive);
    const Finished other = join("b", "b.tangi");
    EXPECT_THAT(other.err, testing::Not(HasSubstr("was fitted before")));
    EXPECT_NE(hash_of_wall(dir / "b.tangi"), wall);
}

TEST(CliMosaic, SaysWhatIsWrong) {
    const TinyStack stack;
    const std::string painting = stack.truth(), out = stack.out("wall.exr");
    EXPECT_TRUE(ended(tangipaint({"mosaic", painting, "--out", out}), 2, {"two positions or more"}));
    EXPECT_TRUE(
        ended(tangipaint({"mosaic", painting, painting, "--out", "m.png"}), 2, {"--out m.png: a painting"}));
    EXPECT_TRUE(ended(tangipaint({"mosaic", painting, painting, "--out", out, "--report", "m.png"}), 2,
                      {"--report m.png: a page"}));
    EXPECT_TRUE(ended(tangipaint({"mosaic", painting, stack.out("none.exr"), "--out", out}), 1,
                      {"none.exr", "no such file or folder"}));
    EXPECT_TRUE(ended(tangipaint({"mosaic", painting, stack.out("b.exr"), "--out", painting}), 1,
                      {"would overwrite"}));
    fs::copy(painting, stack.out("same.exr"));
    EXPECT_TRUE(ended(tangipaint({"mosaic", painting, stack.out("same.exr"), "--out", out}), 1,
                      {"give two that are not the same"}));
    EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace tangi
