// tangipaint palette, run as a user would run it.
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;

TEST(CliPalette, DescribesThePaintsAndDrawsThem) {
    const TestDir dir;
    const Finished run = tangipaint({"palette", "--out", (dir / "cards.png").string(), "--save",
                                     (dir / "p.json").string(), "--card-px", "120", "--illuminant", "a"});
    ASSERT_TRUE(ended(run, 0));
    const nlohmann::json said = run.json();
    EXPECT_EQ(said["illuminant"], "A");
    ASSERT_EQ(said["paints"].size(), 19u);
    EXPECT_EQ(said["paints"][0]["name"], "Titanium White");
    EXPECT_FALSE(said["paints"][0]["approximate"].get<bool>());
    EXPECT_GT(said["paints"][0]["lab"][0].get<double>(), 95);
    EXPECT_EQ(read_picture(dir / "cards.png").width(), 4 * 123 + 3);
    // What was saved is the same palette.
    const Finished again = tangipaint({"palette", (dir / "p.json").string(), "--illuminant", "A"});
    ASSERT_TRUE(ended(again, 0));
    EXPECT_EQ(again.json()["paints"], said["paints"]);
}

TEST(CliPalette, AClearMediumIsNoBlackPaint) {
    const TestDir dir;
    const std::string file = (dir / "m.json").string(), none = "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]";
    write_bytes(file, R"({"format": "tangipaint palette", "version": 1, "name": "mine", "paints": [
        {"name": "Medium", "k_per_mm": )" +
                          none + R"(, "s_per_mm": )" + none + R"(},
        {"name": "Sky", "srgb": "#80c0ff"}]})");
    const Finished run = tangipaint({"palette", file});
    ASSERT_TRUE(ended(run, 0));
    const nlohmann::json medium = run.json()["paints"][0], sky = run.json()["paints"][1];
    EXPECT_EQ(medium["clear"], true);
    EXPECT_EQ(medium["srgb"], "#ffffff");
    EXPECT_TRUE(medium["hides_at_mm"].is_null());
    EXPECT_EQ(sky["clear"], false);
    // It matches nothing: white is not made of it.
    const Finished match = tangipaint({"match", "--srgb", "#ffffff", "--palette", file});
    EXPECT_TRUE(match.code == 0 || match.code == 3) << match.err;
    const nlohmann::json found = match.json();
    EXPECT_EQ(found["media"], (nlohmann::json{"Medium"}));
    EXPECT_EQ(found["recipes"].dump().find("Medium"), std::string::npos) << match.out;
}

TEST(CliPalette, SaysWhatIsWrong) {
    const TestDir dir;
    const std::string bad = (dir / "bad.json").string();
    write_bytes(
        bad,
        R"({"format": "tangipaint palette", "version": 1, "name": "x", "paints": [{"name": "y", "srgb": "red"}]})");
    EXPECT_TRUE(ended(tangipaint({"palette", bad}), 1, {bad, "/paints/0/srgb", "'red' is no colour"}));
    EXPECT_TRUE(ended(tangipaint({"palette", (dir / "none.json").string()}), 1, {"none.json"}));
    EXPECT_TRUE(ended(tangipaint({"palette", "--illuminant", "moon"}), 2, {"--illuminant moon", "D65"}));
    EXPECT_TRUE(ended(tangipaint({"palette", "--out", (dir / "cards.gif").string()}), 2, {"cards.gif"}));
    EXPECT_TRUE(
        ended(tangipaint({"palette", bad, "--save", bad}), 1, {"--save", bad, "the palette that is read"}));
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{"bad.json"});
}

}  // namespace
}  // namespace tangi
