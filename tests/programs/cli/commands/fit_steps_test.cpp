// fit --plan, --tiles and --finish, run as a user would run them.
#include <gmock/gmock.h>

#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(CliFitSteps, MakeAPaintingOfAPlanAndItsTiles) {
    const TinyStack stack({}, 128);
    const std::string plan = stack.out("plan.json"), out = stack.out("a.exr");
    const Finished planned = tangipaint(
        {"fit", stack.path(), "--plan", plan, "--mm-per-pixel", "0.3", "--report", stack.out("plan.html")});
    ASSERT_TRUE(planned.code == 0 || planned.code == 3) << planned.err;
    const nlohmann::json said = planned.json();
    EXPECT_EQ(said["plan"], plan);
    EXPECT_EQ(said["tiles"]["all"], 1);
    EXPECT_EQ(said["width"], 128);
    EXPECT_FALSE(said.contains("painting"));
    EXPECT_TRUE(fs::exists(stack.out("plan.maps")) && fs::exists(stack.out("plan.html")));

    const Finished early = tangipaint({"fit", stack.path(), "--plan", plan, "--finish", "--out", out});
    EXPECT_TRUE(ended(early, 1, {"1 of 1 tiles are missing", "--tiles all"}));
    const Finished tiles = tangipaint({"fit", stack.path(), "--plan", plan, "--tiles", "0"});
    ASSERT_TRUE(ended(tiles, 0));
    EXPECT_EQ(tiles.json()["tiles"]["fitted"], 1);
    EXPECT_EQ(
        tangipaint({"fit", stack.path(), "--plan", plan, "--tiles", "all"}).json()["tiles"]["there_before"],
        1);

    const Finished finished = tangipaint({"fit", stack.path(), "--plan", plan, "--finish", "--out", out});
    ASSERT_TRUE(finished.code == planned.code || finished.code == 3) << finished.err;
    const nlohmann::json result = finished.json();
    EXPECT_EQ(result["painting"], out);
    EXPECT_EQ(result["mm_per_pixel"], 0.3);
    EXPECT_EQ(result["lights"], said["lights"]);
    EXPECT_EQ(result["inputs"], said["inputs"]);
    EXPECT_EQ(result["pixels"]["all"], result["width"].get<int>() * result["height"].get<int>());
    const Surface painting = read_painting(out);
    EXPECT_EQ(painting.width(), 128);
    EXPECT_EQ(hash_of(painting), result["dry_hash"]);
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
}

TEST(CliFitSteps, RefuseWhatDoesNotGoTogether) {
    const TinyStack stack;
    const std::string plan = stack.out("plan.json"), out = stack.out("a.exr");
    const auto fit = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"fit", stack.path()});
        return tangipaint(words);
    };
    EXPECT_TRUE(ended(fit({}), 2, {"--out"}));
    EXPECT_TRUE(ended(fit({"--tiles", "0"}), 2, {"--plan"}));
    EXPECT_TRUE(ended(fit({"--finish", "--out", out}), 2, {"--plan"}));
    EXPECT_TRUE(ended(fit({"--plan", plan, "--out", out}), 2, {"--out", "--finish"}));
    EXPECT_TRUE(ended(fit({"--plan", plan, "--preview"}), 2, {"--preview"}));
    EXPECT_TRUE(ended(fit({"--plan", plan, "--tiles", "0", "--finish"}), 2, {"two steps"}));
    EXPECT_TRUE(ended(fit({"--plan", plan, "--tiles", "0", "--noise", "0.1"}), 2, {"--noise", "plan"}));
    EXPECT_TRUE(ended(fit({"--plan", plan, "--tiles", "0"}), 1, {"plan.json"}));
    for (const std::string wrong : {"", "abc", "1,,2", "1-"})
        EXPECT_TRUE(ended(fit({"--plan", plan, "--tiles", wrong}), 2, {"is no number of a tile", "0-15"}));
    EXPECT_TRUE(ended(fit({"--plan", plan, "--tiles", "7-3"}), 2, {"7 comes after 3; give 3-7"}));
    EXPECT_FALSE(fs::exists(plan));
    EXPECT_TRUE(ended(fit({"--plan", stack.out("plan.txt")}), 2, {"plan.txt", ".json"}));
}

TEST(CliFitSteps, GoOnWithTheirOwnPhotographsAndPlanOnly) {
    const TinyStack stack;
    const std::string plan = stack.out("plan.json");
    const auto tiles = [&] { return tangipaint({"fit", stack.path(), "--plan", plan, "--tiles", "all"}); };
    ASSERT_EQ(tangipaint({"fit", stack.path(), "--plan", plan}).code % 3, 0);
    EXPECT_TRUE(ended(tangipaint({"fit", stack.path(), "--plan", plan, "--tiles", "0-9"}), 2,
                      {"there is no tile 9; the plan has 0 to 0"}));
    const std::string words = read_text_file(plan);
    std::string edited = words;
    edited.replace(edited.find("\"tile_pixels\": 1024"), 19, "\"tile_pixels\": 2048");
    write_bytes(plan, edited);
    EXPECT_TRUE(ended(tiles(), 1, {"plan.json", "damaged, or was changed"}));
    write_bytes(plan, words.substr(0, words.size() / 2));
    EXPECT_TRUE(
        ended(tiles(), 1, {"plan.json: line ", "as if cut off; copy the file again, or make it anew"}));
    write_bytes(plan, words);
    const fs::path photos = stack.path(), first = photos / "img_000.png";
    fs::remove(first);
    fs::copy(photos / "img_001.png", first);
    EXPECT_TRUE(ended(tiles(), 1, {"img_000.png", "is no longer what it was", "make the plan again"}));
    EXPECT_FALSE(fs::exists(stack.out("plan.tiles") + "/0_0.fitted"));
}

}  // namespace
}  // namespace tangi
