// match, retouch and quality, run as a user would run them.
#include <gmock/gmock.h>

#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;

TEST(CliMatch, FindsARecipeForAMeasuredSpectrum) {
    const TestDir dir;
    const std::string spectrum = (dir / "ochre.csv").string();
    write_bytes(spectrum,
                "nm,R\n400,0.05\n450,0.07\n500,0.12\n550,0.25\n580,0.36\n600,0.4\n650,0.43\n700,0.45\n");
    const Finished run = tangipaint(
        {"match", "--spectrum", spectrum, "--max-paints", "3", "--swatch", (dir / "s.png").string()});
    ASSERT_TRUE(ended(run, 0, {"recipe"}));
    const nlohmann::json said = run.json();
    ASSERT_EQ(said["recipes"].size(), 3u);
    const nlohmann::json& best = said["recipes"][0];
    EXPECT_LE(best["parts_by_volume"].size(), 3u);
    double worst = 0, volume = 0;
    for (const char* light : {"D65", "A", "F11"})
        worst = std::max(worst, best["delta_e_2000"][light].get<double>());
    EXPECT_NEAR(best["error"].get<double>(), worst, 1e-9);
    EXPECT_LT(worst, 4);
    for (const auto& [name, part] : best["parts_by_volume"].items()) volume += part.get<double>();
    EXPECT_NEAR(volume, 1, 1e-9);
    EXPECT_EQ(best["metamerism_index"]["D65"].get<double>(), 0);
    EXPECT_LE(said["fewer_paints"].back()["error"].get<double>(), worst + 1e-9);
    EXPECT_GT(read_picture(dir / "s.png").width(), 400);
}

TEST(CliMatch, TakesAColourAndSaysWhatItsSpectrumMayBe) {
    const Finished run = tangipaint({"match", "--lab", "52,18,30", "--under", "A", "--illuminants", "A"});
    ASSERT_TRUE(ended(run, 0));
    const nlohmann::json said = run.json();
    EXPECT_EQ(said["target"]["seen_under"], "A");
    EXPECT_GT(said["target"]["mixtures"], 2);
    EXPECT_LT(said["recipes"][0]["delta_e_2000"]["A"], 1.2);
}

TEST(CliMatch, WarnsOfPairsThatItsListKeepsApart) {
    const TestDir dir;
    const std::string pairs = (dir / "pairs.json").string();
    ASSERT_TRUE(ended(tangipaint({"match", "--save-pairs", pairs}), 0));
    ASSERT_TRUE(ended(tangipaint({"match", "--srgb", "#a08050", "--pairs", pairs}), 0));
    // Kept apart here: white and everything that a light grey could be mixed from.
    write_bytes(pairs, R"({"format": "tangipaint pigment pairs", "version": 1, "pairs": [
        {"first": ["titanium"], "second": ["bone black"], "why": "for this test", "source": "nobody"}]})");
    const std::vector<std::string> grey = {"match", "--lab", "60,0,0", "--max-paints", "2", "--pairs", pairs};
    const Finished warned = tangipaint(grey);
    ASSERT_TRUE(ended(warned, 0));
    EXPECT_THAT(warned.json()["recipes"][0]["warnings"].dump(), HasSubstr("for this test"));
    std::vector<std::string> avoiding = grey;
    avoiding.push_back("--avoid-pairs");
    const nlohmann::json said = tangipaint(avoiding).json();
    EXPECT_THAT(said["recipes"].dump(), testing::Not(HasSubstr("for this test")));
}

// By its K/S, a cloudy gel is the whitest of whites, but no film of it is.
TEST(CliMatch, MakesNoRecipesOfMedia) {
    const TestDir dir;
    const std::string palette = (dir / "p.json").string();
    const auto write = [&](const std::string& white) {
        write_bytes(palette, R"({"format": "tangipaint palette", "version": 1, "name": "p", "paints": [)" +
                                 white +
                                 R"({"name": "Gel", "wavelengths_nm": [400, 450, 500, 550, 600, 650, 700],
            "k_per_mm": [0.001, 0.001, 0.001, 0.001, 0.001, 0.001, 0.001], "s_per_mm": [1, 1, 1, 1, 1, 1, 1]}]})");
    };
    write(R"({"name": "White", "srgb": "#eeeeea"}, {"name": "Ochre", "srgb": "#b08040"},)");
    const Finished run = tangipaint({"match", "--srgb", "#f4f4f2", "--palette", palette});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(run.json()["media"], (nlohmann::json{"Gel"}));
    EXPECT_EQ(run.json()["recipes"].dump().find("Gel"), std::string::npos);
    write("");
    EXPECT_TRUE(ended(tangipaint({"match", "--srgb", "#f4f4f2", "--palette", palette}), 1,
                      {"p.json", "media only (Gel)", "no paint that colours"}));
}

TEST(CliMatch, SaysWhatIsWrong) {
    const TestDir dir;
    const std::string bad = (dir / "bad.csv").string();
    write_bytes(bad, "400,0.1\n450,30\n");
    EXPECT_TRUE(ended(tangipaint({"match"}), 2, {"--spectrum", "--mask"}));
    EXPECT_TRUE(ended(tangipaint({"match", "--lab", "1,2"}), 2, {"--lab 1,2", "three numbers"}));
    EXPECT_TRUE(ended(tangipaint({"match", "--srgb", "red"}), 2, {"#rrggbb"}));
    EXPECT_TRUE(ended(tangipaint({"match", "--lab", "50,0,0", "--illuminants", "D65,sun"}), 2, {"'sun'"}));
    EXPECT_TRUE(ended(tangipaint({"match", "--spectrum", bad}), 1, {bad, "line 2", "reflects 30"}));
    EXPECT_TRUE(ended(tangipaint({"match", "--lab", "60,120,-120"}), 1, {"no surface has it"}));
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{"bad.csv"});
}

// A piece of a painting with a white loss, and its mask.
struct Loss {
    TestDir dir;
    Loss() {
        Surface s(96, 80);
        s.mm_per_pixel = 0.25, s.scale_known = true;
        Image<float> mask(96, 80);
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 96; ++x) {
                const bool lost = std::hypot(x - 48.0, y - 40.0) < 18;
                s.diffuse(x, y) = lost ? Rgb(0.75f, 0.72f, 0.65f) : Rgb(0.32f, 0.2f, 0.1f);
                s.specular(x, y) = 0.04f, s.roughness(x, y) = 0.15f, s.confidence(x, y) = 1;
                mask(x, y) = lost ? 1.0f : 0.0f;
            }
        write_painting(dir / "p.exr", s);
        write_map(dir / "m.png", mask, {.bits = 8});
    }
    std::string path(const char* name) const { return (dir / name).string(); }
};

TEST(CliRetouch, LaysARetouchThatQualityJudges) {
    const Loss loss;
    const Finished before = tangipaint(
        {"quality", loss.path("p.exr"), "--mask", loss.path("m.png"), "--out", loss.path("before")});
    ASSERT_TRUE(ended(before, 0));
    EXPECT_GT(before.json()["delta_e_2000"]["D65"], 20);
    const Finished run = tangipaint(
        {"retouch", loss.path("p.exr"), "--mask", loss.path("m.png"), "--out", loss.path("r.exr")});
    ASSERT_TRUE(ended(run, 0));
    const nlohmann::json said = run.json();
    EXPECT_EQ(said["layer"], "retouch mimetic 1");
    EXPECT_EQ(said["on_original"]["pixels"], 0);
    EXPECT_GE(said["piles"].size(), 1u);
    const Finished after = tangipaint(
        {"quality", loss.path("r.exr"), "--mask", loss.path("m.png"), "--out", loss.path("after")});
    ASSERT_TRUE(ended(after, 0));
    for (const char* light : {"D65", "A", "F11"}) EXPECT_LT(after.json()["delta_e_2000"][light], 3) << light;
    EXPECT_NEAR(after.json()["regions"][0]["height_step_mm"]["mean"].get<double>(), 0.05, 0.005);
    EXPECT_EQ(names_in(loss.dir / "after"),
              (std::vector<std::string>{"delta_e_2000.exr", "delta_e_2000.png", "gloss.exr", "height_mm.exr",
                                        "raking_bottom.png", "raking_left.png", "raking_right.png",
                                        "raking_top.png"}));
    // Lines say from where they fuse, and proposals what they are.
    const Finished lines =
        tangipaint({"retouch", loss.path("p.exr"), "--mask", loss.path("m.png"), "--mode", "tratteggio",
                    "--out", loss.path("t.exr"), "--preview", loss.path("t.png"), "--inpainting", "telea"});
    ASSERT_TRUE(ended(lines, 0));
    EXPECT_EQ(lines.json()["layer"], "proposal telea tratteggio 1");
    EXPECT_GT(lines.json()["lines"]["distance_m"], 0.5);
    EXPECT_LT(lines.json()["lines"]["delta_e_2000_there"], lines.json()["lines"]["delta_e_2000_at_0.3_m"]);
    EXPECT_GT(read_picture(loss.dir / "t.png").width(), 36);
}

TEST(CliRetouch, OfATreatmentIsLogged) {
    const Loss loss;
    const std::string treatment = loss.path("p.treatment");
    ASSERT_TRUE(ended(tangipaint({"damage", loss.path("p.exr"), "--treatment", treatment, "--class",
                                  "loss_to_ground", "--mask", loss.path("m.png")}),
                      0));
    EXPECT_TRUE(ended(tangipaint({"quality", "--treatment", treatment}), 1, {"no retouch"}));
    const std::vector<std::string> where = {"--treatment", treatment, "--class", "loss_to_ground"};
    const auto run = [&](std::vector<std::string> words, const std::vector<std::string>& more) {
        words.insert(words.end(), more.begin(), more.end());
        return tangipaint(words);
    };
    ASSERT_TRUE(ended(run({"match", "--film-mm", "0.05"}, where), 0));
    // The painting is flat: there is room for a fill above it only.
    const std::vector<std::string> fill = {"fill",           treatment,   "--class",
                                           "loss_to_ground", "--texture", "patches"};
    EXPECT_TRUE(ended(tangipaint(fill), 1, {"nothing to fill", "--offset-mm"}));
    ASSERT_TRUE(ended(tangipaint({"fill", treatment, "--class", "loss_to_ground", "--texture", "patches",
                                  "--offset-mm", "0.05"}),
                      0));
    ASSERT_TRUE(ended(run({"retouch", "--inpainting", "patches"}, where), 0));
    ASSERT_TRUE(ended(tangipaint({"quality", "--treatment", treatment}), 0));
    EXPECT_EQ(names_in(loss.dir / "p.treatment" / "quality" / "1").size(), 8u);
    // A name that something has would write over it.
    const std::string before = bytes_of(treatment + "/masks/loss_to_ground.png");
    for (const char* name : {"proposal fill 1", "loss_to_ground", "abrasion", "../../evil", ".", "a\nb"})
        EXPECT_TRUE(ended(run({"retouch", "--layer", name}, where), 2, {"--layer"})) << name;
    EXPECT_TRUE(ended(run({"retouch", "--layer", std::string(300, 'x')}, where), 2, {"--layer"}));
    EXPECT_EQ(bytes_of(treatment + "/masks/loss_to_ground.png"), before);
    ASSERT_TRUE(ended(tangipaint({"treatment", "check", treatment}), 0));
    // What was made up is never silent.
    const nlohmann::json status = tangipaint({"treatment", "status", treatment}).json();
    EXPECT_EQ(status["layers"][0]["name"], "proposal fill 1");
    EXPECT_EQ(status["layers"][1]["name"], "proposal retouch 1");
    const std::string log = bytes_of(loss.dir / "p.treatment" / "log.jsonl");
    for (const char* action : {"match", "propose", "quality"})
        EXPECT_NE(log.find("\"action\":\"" + std::string(action) + "\""), std::string::npos) << action;
    // A map that was changed afterwards is noticed.
    ASSERT_TRUE(ended(tangipaint({"treatment", "check", treatment}), 0));
    write_bytes(loss.dir / "p.treatment" / "quality" / "1" / "gloss.exr", "edited");
    EXPECT_TRUE(ended(tangipaint({"treatment", "check", treatment}), 1, {"gloss.exr"}));
    EXPECT_TRUE(ended(tangipaint({"match", "--treatment", treatment}), 2, {"--class"}));
    EXPECT_TRUE(
        ended(tangipaint({"quality", "--treatment", treatment, "--out", loss.path("q")}), 2, {"--out"}));
}

TEST(CliRetouch, SaysWhatIsWrong) {
    const Loss loss;
    const std::string p = loss.path("p.exr"), m = loss.path("m.png"), out = loss.path("r.exr");
    EXPECT_TRUE(ended(tangipaint({"retouch", "--mask", m}), 2, {"retouch PAINTING.exr --out"}));
    EXPECT_TRUE(ended(tangipaint({"retouch", p, "--mask", m, "--out", p}), 1, {"--out"}));
    EXPECT_TRUE(
        ended(tangipaint({"retouch", p, "--mask", m, "--out", out, "--mode", "dotting", "--width-mm", "0.1"}),
              1, {"finer than the painting's pixels", "--width-mm 0.25"}));
    EXPECT_TRUE(
        ended(tangipaint({"retouch", p, "--mask", m, "--out", out, "--mode", "magic"}), 2, {"magic"}));
    EXPECT_EQ(names_in(loss.dir.path()), (std::vector<std::string>{"m.png", "p.exr"}));
}

}  // namespace
}  // namespace tangi
