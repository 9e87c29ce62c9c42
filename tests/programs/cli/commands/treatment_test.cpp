// treatment_test.cpp: a treatment step by step by commands, and what they refuse.
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

constexpr const char* kSquare = "-2,-2;2,-2;2,2;-2,2";  // [mm], of a painting of 8 x 8 mm

class CliTreatment : public testing::Test {
protected:
    std::string treatment() const { return stack_.out("p.treatment"); }
    Finished damage(std::vector<std::string> more) const {
        std::vector<std::string> all = {"damage", stack_.truth(), "--treatment", treatment()};
        all.insert(all.end(), more.begin(), more.end());
        return tangipaint(all);
    }
    void draw() const { ASSERT_TRUE(ended(damage({"--class", "loss_to_ground", "--polygon", kSquare}), 0)); }

    TinyStack stack_;
};

TEST_F(CliTreatment, GoesFromDamageToReportAndBack) {
    const Finished drawn = damage({"--class", "loss_to_ground", "--polygon", kSquare, "--by", "A. B."});
    ASSERT_TRUE(ended(drawn, 0));
    EXPECT_EQ(drawn.json()["damage"][0]["class"], "loss_to_ground");
    EXPECT_EQ(drawn.json()["damage"][0]["count"], 1);
    ASSERT_TRUE(ended(
        damage({"--class", "loss_to_ground", "--edit", "remove", "--polygon", "-2,-2;0,-2;0,2;-2,2"}), 0));
    const nlohmann::json half = tangipaint({"treatment", "status", treatment()}).json();
    EXPECT_NEAR(half["damage"][0]["area_cm2"].get<double>(),
                drawn.json()["damage"][0]["area_cm2"].get<double>() / 2, 1e-6);

    ASSERT_TRUE(ended(tangipaint({"fill", treatment(), "--class", "loss_to_ground", "--offset-mm=0.2"}), 0));
    ASSERT_TRUE(ended(tangipaint({"varnish", treatment(), "--isolating"}), 0));
    write_text_file(stack_.out("s.jsonl"),
                    "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
                    "{\"event\": \"stroke\", \"brush\": {\"preset\": \"flat\", \"size_mm\": 2}, \"paint\": "
                    "{\"Titanium White\": 1}}\n"
                    "{\"event\": \"point\", \"t\": 0, \"x\": -3.5, \"y\": 0}\n"
                    "{\"event\": \"point\", \"t\": 1, \"x\": 3.5, \"y\": 0}\n{\"event\": \"end\"}\n");
    const Finished retouched = tangipaint({"treatment", "retouch", treatment(), "--strokes",
                                           stack_.out("s.jsonl"), "--class", "loss_to_ground"});
    ASSERT_TRUE(ended(retouched, 0));
    EXPECT_EQ(retouched.json()["retouches"][0]["on_original"]["pixels"], 0);
    EXPECT_GT(retouched.json()["retouches"][0]["area_cm2"].get<double>(), 0);
    ASSERT_TRUE(ended(tangipaint({"varnish", treatment()}), 0));
    EXPECT_TRUE(ended(tangipaint({"treatment", "show", treatment(), "--out", stack_.out("after.png")}), 0));
    EXPECT_TRUE(ended(tangipaint({"treatment", "additions", treatment(), "--out", stack_.out("a.png")}), 0));
    EXPECT_TRUE(ended(tangipaint({"treatment", "report", treatment(), "--out", stack_.out("r.pdf")}), 0));
    EXPECT_TRUE(std::filesystem::exists(stack_.out("r.pdf")) &&
                std::filesystem::exists(stack_.out("r.html")));
    const nlohmann::json checked = tangipaint({"treatment", "check", treatment()}).json();
    EXPECT_EQ(checked["layers"].size(), 4u);
    EXPECT_EQ(checked["log_lines"], 7);

    EXPECT_TRUE(ended(tangipaint({"treatment", "remove", treatment(), "--layer", "fill 9"}), 1,
                      {"no dried layer 'fill 9'", "fill 1"}));
    const Finished removed = tangipaint({"treatment", "remove", treatment(), "--all"});
    ASSERT_TRUE(ended(removed, 0));
    EXPECT_EQ(removed.json()["identical_to_original"], true);
    const Finished back = tangipaint({"treatment", "undo", treatment()});
    ASSERT_TRUE(ended(back, 0));
    EXPECT_EQ(back.json()["undone"]["action"], "remove");
    EXPECT_EQ(back.json()["layers"], checked["layers"]) << "in their order, bit for bit";
    EXPECT_TRUE(ended(tangipaint({"treatment", "check", treatment()}), 0));
}

// Step by step backwards, masks as well; the log only grows.
TEST_F(CliTreatment, StepsAreUndoneAndStayInTheLog) {
    draw();
    ASSERT_TRUE(ended(tangipaint({"fill", treatment(), "--class", "loss_to_ground"}), 0));
    ASSERT_TRUE(ended(tangipaint({"varnish", treatment(), "--isolating"}), 0));
    ASSERT_TRUE(ended(damage({"--class", "stain", "--polygon", kSquare}), 0));
    const Finished stain = tangipaint({"treatment", "undo", treatment(), "--by", "A. B."});
    ASSERT_TRUE(ended(stain, 0));
    EXPECT_EQ(stain.json()["undone"]["line"], 5);
    EXPECT_EQ(stain.json()["restored"], nlohmann::json({"stain"}));
    EXPECT_EQ(stain.json()["layers"].size(), 2u) << "nothing was taken off";
    const Finished varnish = tangipaint({"treatment", "undo", treatment()});
    EXPECT_EQ(varnish.json()["undone"]["line"], 4);
    EXPECT_EQ(varnish.json()["layers"].size(), 1u) << "the fill is still there";
    ASSERT_TRUE(ended(tangipaint({"varnish", treatment(), "--isolating"}), 0));
    for (const int line : {8, 3, 2}) {
        const Finished undone = tangipaint({"treatment", "undo", treatment()});
        ASSERT_TRUE(ended(undone, 0));
        EXPECT_EQ(undone.json()["undone"]["line"], line);
    }
    EXPECT_TRUE(ended(tangipaint({"treatment", "undo", treatment()}), 1, {"no step to undo"}));
    const nlohmann::json checked = tangipaint({"treatment", "check", treatment()}).json();
    EXPECT_EQ(checked["log_lines"], 11);
    EXPECT_TRUE(checked["layers"].empty());
    for (const nlohmann::json& row : checked["damage"]) EXPECT_EQ(row["count"], 0) << row["class"];
}

TEST_F(CliTreatment, MasksThatMeanNothingAreTold) {
    draw();
    const nlohmann::json size = tangipaint({"treatment", "status", treatment()}).json();
    const auto with = [&](float level, std::vector<std::string> more) {
        write_picture_8bit(stack_.out("m.png"),
                           Image<Rgb>(size["width"].get<int>(), size["height"].get<int>(), Rgb(level)));
        std::vector<std::string> arguments = {"--class", "stain", "--mask", stack_.out("m.png")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return damage(arguments);
    };
    EXPECT_TRUE(ended(with(0.4f, {}), 1, {"m.png", "nothing lighter than 40 % grey"}));
    EXPECT_TRUE(ended(with(0, {}), 2, {"nothing is inside", "--edit replace"}));
    EXPECT_TRUE(ended(with(1, {}), 0));
    const Finished emptied = with(0, {"--edit", "replace"});
    ASSERT_TRUE(ended(emptied, 0));
    EXPECT_EQ(emptied.json()["damage"].back()["area_cm2"], 0);
}

TEST_F(CliTreatment, AClassIsEmptiedByNothing) {
    draw();
    EXPECT_TRUE(ended(damage({"--class", "loss_to_ground", "--edit", "replace"}), 0));
    EXPECT_TRUE(ended(tangipaint({"fill", treatment(), "--class", "loss_to_ground"}), 1));
}

TEST_F(CliTreatment, AreasAreSuggestedByClassAndMayBeNone) {
    const Finished found = damage({"--suggest", "abrasion"});
    ASSERT_TRUE(ended(found, 0));
    EXPECT_EQ(found.json()["suggested"]["abrasion"]["count"], 0);
    EXPECT_TRUE(found.json()["suggested"]["areas"].empty());
    EXPECT_TRUE(ended(damage({"--suggest", "old_fill", "--as", "overpaint"}), 0));
    EXPECT_TRUE(ended(damage({"--suggest", "old_fill", "--area-confidence", "2"}), 2, {"--area-confidence"}));
    EXPECT_TRUE(ended(damage({"--suggest", "flaking"}), 0));
    EXPECT_TRUE(ended(damage({"--suggest", "rust"}), 2, {"--suggest"}));
}

TEST_F(CliTreatment, PaintThatTheWindowLeftBecomesARetouch) {
    draw();
    EXPECT_TRUE(ended(tangipaint({"treatment", "retouch", treatment()}), 1, {"nothing was painted"}));
    // As the window saves it: on the treatment's painting, without a mask, one sitting dried, one wet.
    write_text_file(stack_.out("s.jsonl"),
                    "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
                    "{\"event\": \"stroke\", \"brush\": {\"preset\": \"flat\", \"size_mm\": 1}, \"paint\": "
                    "{\"Titanium White\": 1}}\n"
                    "{\"event\": \"point\", \"t\": 0, \"x\": -3.5, \"y\": 0}\n"
                    "{\"event\": \"point\", \"t\": 1, \"x\": 3.5, \"y\": 0}\n{\"event\": \"end\"}\n"
                    "{\"event\": \"dry\", \"layer\": \"Monday\"}\n"
                    "{\"event\": \"stroke\", \"brush\": {\"preset\": \"flat\", \"size_mm\": 1}, \"paint\": "
                    "{\"Titanium White\": 1}}\n"
                    "{\"event\": \"point\", \"t\": 0, \"x\": -1.5, \"y\": 1}\n"
                    "{\"event\": \"point\", \"t\": 1, \"x\": 1.5, \"y\": 1}\n{\"event\": \"end\"}\n");
    const std::string painting = treatment() + "/painting.exr", painted = stack_.out("painted.exr");
    ASSERT_TRUE(ended(tangipaint({"replay", painting, stack_.out("s.jsonl"), "--out", painted}), 0));
    std::filesystem::rename(painted, painting);
    EXPECT_TRUE(
        ended(tangipaint({"varnish", treatment()}), 1, {"'Monday' that the log does not know", "retouch"}));
    const Finished run = tangipaint({"treatment", "retouch", treatment(), "--class", "loss_to_ground"});
    ASSERT_TRUE(ended(run, 0));
    ASSERT_EQ(run.json()["retouches"].size(), 2u);
    EXPECT_GT(run.json()["retouches"][0]["on_original"]["pixels"].get<int>(), 20);
    EXPECT_EQ(run.json()["retouches"][1]["layer"], "retouch 1");
    EXPECT_TRUE(ended(tangipaint({"treatment", "check", treatment()}), 0));
}

TEST_F(CliTreatment, AnEditedLogStopsEveryCommand) {
    draw();
    const std::filesystem::path log = treatment() + "/log.jsonl";
    std::string text = read_text_file(log);
    text.replace(text.find("draw damage"), 4, "DREW");
    write_bytes(log, text);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"treatment", "check", treatment()},
          {"fill", treatment(), "--class", "loss_to_ground"},
          {"varnish", treatment()},
          {"treatment", "report", treatment(), "--out", stack_.out("r.html")}})
        EXPECT_TRUE(ended(tangipaint(command), 1, {"log.jsonl:2: was edited"}));
    EXPECT_FALSE(std::filesystem::exists(stack_.out("r.html")));
}

TEST_F(CliTreatment, EmptyMasksAndFoldersWithoutANameAreRefused) {
    draw();
    ASSERT_TRUE(ended(damage({"--class", "loss_to_ground", "--edit", "remove", "--polygon", kSquare}), 0));
    EXPECT_TRUE(ended(tangipaint({"fill", treatment(), "--class", "loss_to_ground"}), 1, {"mask is empty"}));
    EXPECT_TRUE(ended(tangipaint({"varnish", treatment(), "--isolating", "--class", "loss_to_ground"}), 1,
                      {"mask is empty"}));
    EXPECT_TRUE(ended(tangipaint({"match", "--treatment", treatment(), "--class", "loss_to_ground"}), 1,
                      {"mask is empty"}));
    EXPECT_TRUE(ended(tangipaint({"damage", stack_.truth(), "--treatment", ""}), 2, {"--treatment"}));
    EXPECT_EQ(tangipaint({"treatment", "status", treatment()}).json()["log_lines"], 3);
}

TEST_F(CliTreatment, StrokesOfAJournalArePaintedAgainByCheck) {
    draw();
    const std::string journal = stack_.out("strokes.jsonl");
    write_bytes(journal,
                R"({"format": "tangipaint strokes", "version": 1}
{"event": "stroke", "paint": {"Titanium White": 1}}
{"event": "point", "t": 0, "x": -3, "y": 0}
{"event": "point", "t": 1, "x": 3, "y": 0}
{"event": "end"}
)");
    ASSERT_TRUE(ended(tangipaint({"treatment", "retouch", treatment(), "--strokes", journal, "--class",
                                  "loss_to_ground", "--feather-mm", "0.5"}),
                      0));
    const Finished check = tangipaint({"treatment", "check", treatment()});
    ASSERT_TRUE(ended(check, 0));
    EXPECT_EQ(check.json()["strokes"]["painted_again"], 1);
    EXPECT_EQ(check.json()["strokes"]["not_painted_again"], 0);
}

// What a sitting in the window left is of the painting as it is: a step would take its ground away.
TEST_F(CliTreatment, NoStepIsDoneUnderStrokesThatAreNotSaved) {
    draw();
    const std::string unsaved = treatment() + "/painting.unsaved.jsonl";
    write_bytes(unsaved, "{\"format\": \"tangipaint strokes\", \"version\": 1}\n{\"event\": \"paints\"}\n");
    ASSERT_TRUE(ended(tangipaint({"varnish", treatment()}), 0)) << "there is no stroke in it";
    write_bytes(unsaved, bytes_of(unsaved) + "{\"event\": \"dry\", \"layer\": \"a\"}\n");
    const std::string log = bytes_of(treatment() + "/log.jsonl");
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"fill", treatment(), "--class", "loss_to_ground"},
             {"varnish", treatment()},
             {"retouch", "--treatment", treatment(), "--class", "loss_to_ground", "--mode", "mimetic"},
             {"treatment", "retouch", treatment()},
             {"treatment", "remove", treatment(), "--all"},
             {"treatment", "undo", treatment()},
             {"treatment", "report", treatment(), "--out", stack_.out("report.html")}})
        EXPECT_TRUE(ended(tangipaint(command), 1, {"painting.unsaved.jsonl", "recover"})) << command[0];
    EXPECT_EQ(bytes_of(treatment() + "/log.jsonl"), log);
    EXPECT_TRUE(ended(tangipaint({"treatment", "status", treatment()}), 0));
}

// The legend is drawn before the step is done, and shows the map as the step makes it.
TEST_F(CliTreatment, ALegendComesAboutWithItsStep) {
    draw();
    const std::string legend = stack_.out("legend.png"), other = stack_.out("other.png");
    ASSERT_TRUE(ended(damage({"--class", "abrasion", "--polygon", kSquare, "--legend", legend}), 0));
    ASSERT_TRUE(ended(damage({"--legend", other}), 0));
    EXPECT_TRUE(bytes_of(legend) == bytes_of(other));
    EXPECT_TRUE(ended(tangipaint({"treatment", "check", treatment()}), 0));
}

TEST_F(CliTreatment, ItsOwnFilesAreNoOutputs) {
    draw();
    const std::string painting = treatment() + "/painting.exr",
                      mask = treatment() + "/masks/loss_to_ground.png";
    const std::string before = read_text_file(painting), masked = read_text_file(mask);
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"treatment", "show", treatment(), "--out", mask},
             {"treatment", "additions", treatment(), "--out", treatment() + "/masks/new.png"},
             {"damage", stack_.truth(), "--treatment", treatment(), "--legend", mask},
             {"retouch", stack_.truth(), "--mask", mask, "--out", painting},
             {"match", stack_.truth(), "--mask", mask, "--swatch", treatment() + "/quality/s.png"},
             {"quality", stack_.truth(), "--mask", mask, "--out", treatment() + "/quality"},
             {"relight", stack_.truth(), "--out", treatment() + "/strokes/r.png", "--light", "0,0,1"}})
        EXPECT_TRUE(ended(tangipaint(command), 1, {"keeps by its log", "choose another"})) << command[0];
    EXPECT_TRUE(read_text_file(painting) == before && read_text_file(mask) == masked);
    EXPECT_TRUE(ended(tangipaint({"treatment", "check", treatment()}), 0));
    EXPECT_TRUE(
        ended(tangipaint({"treatment", "show", treatment(), "--out", treatment() + "/picture.png"}), 0));
}

TEST_F(CliTreatment, FlagsOfOtherActionsAndWrongAddressesAreRefused) {
    draw();
    const auto treat = [&](std::vector<std::string> words) {
        words.insert(words.begin(), "treatment"), words.insert(words.begin() + 2, treatment());
        return tangipaint(words);
    };
    EXPECT_TRUE(ended(treat({"check", "--state", "before"}), 2, {"--state", "is of show"}));
    EXPECT_TRUE(ended(treat({"status", "--out", "x.png"}), 2, {"--out", "status"}));
    EXPECT_TRUE(ended(treat({"remove", "--all", "--mask", "m.png"}), 2, {"--mask", "is of retouch"}));
    EXPECT_TRUE(ended(treat({"show", "--light", "0,0,-1", "--out", stack_.out("x.png")}), 2,
                      {"--light", "behind the painting"}));
    for (const char* address : {"museum.example", "ftp://museum.example/", "https://", "https:///a/",
                                "https://museum.example/?a=1", "https://museum.example/a b/"})
        EXPECT_TRUE(ended(treat({"report", "--out", stack_.out("r.html"), "--published-at", address}), 2,
                          {"--published-at", "museum.example/42/"}));
    EXPECT_TRUE(ended(
        treat({"report", "--out", stack_.out("r.html"), "--published-at", "HTTPS://museum.example/42"}), 0));
    EXPECT_NE(read_text_file(stack_.out("r.manifest.json")).find("\"https://museum.example/42/"),
              std::string::npos);
}

TEST_F(CliTreatment, KeepsItsScale) {
    draw();
    EXPECT_TRUE(ended(damage({"--mm-per-pixel", "0.9"}), 2, {"--mm-per-pixel 0.9", "begin another"}));
    EXPECT_TRUE(ended(tangipaint({"retouch", "--treatment", treatment(), "--class", "loss_to_ground",
                                  "--mm-per-pixel", "0.9"}),
                      2, {"--mm-per-pixel 0.9"}));
    EXPECT_TRUE(ended(tangipaint({"quality", "--treatment", treatment(), "--class", "loss_to_ground",
                                  "--mm-per-pixel", "0.9"}),
                      2, {"--mm-per-pixel 0.9"}));
}

TEST_F(CliTreatment, WhatMakesNoSenseIsRefused) {
    draw();
    EXPECT_TRUE(ended(tangipaint({"fill", treatment()}), 2, {"say what is filled"}));
    EXPECT_TRUE(ended(tangipaint({"fill", treatment(), "--class", "hole"}), 2, {"--class hole", "stain"}));
    EXPECT_TRUE(ended(tangipaint({"fill", treatment(), "--class", "stain"}), 1, {"no such damage"}));
    EXPECT_TRUE(ended(tangipaint({"fill", stack_.out("none"), "--class", "stain"}), 1, {"is no treatment"}));
    std::filesystem::copy_file(stack_.truth(), stack_.out("p.exr"));
    EXPECT_TRUE(ended(tangipaint({"fill", stack_.out("p.exr"), "--class", "stain"}), 1,
                      {"p.exr: is a file, and a treatment is a folder",
                       "damage " + stack_.out("p.exr") + " --treatment " + treatment() + " begins one"}));
    EXPECT_TRUE(ended(tangipaint({"damage", stack_.truth(), "--treatment", stack_.out("p.exr")}), 1,
                      {"p.exr: is a file, and a treatment is a folder", "such as " + treatment()}));
    EXPECT_TRUE(ended(tangipaint({"treatment", "report", treatment(), "--out", stack_.out("r.txt")}), 2,
                      {"--out", ".pdf"}));
    EXPECT_TRUE(ended(tangipaint({"treatment", "dance", treatment()}), 2, {"dance"}));
    EXPECT_TRUE(ended(damage({"--polygon", kSquare}), 2, {"--class"}));
    EXPECT_TRUE(ended(damage({"--class", "stain", "--polygon", "1,2;3"}), 2, {"--polygon"}));
    EXPECT_TRUE(ended(damage({"--class", "stain", "--polygon", "90,90;91,90;91,91"}), 1,
                      {"nothing of the polygon lies in the picture"}));
    EXPECT_TRUE(ended(damage({"--suggest", "rot"}), 2, {"--suggest"}));
    EXPECT_TRUE(ended(damage({"--class", "stain"}), 2, {"--class", "nothing is drawn"}));
    EXPECT_TRUE(ended(damage({"--edit", "remove"}), 2, {"--edit"}));
    EXPECT_TRUE(ended(damage({"--suggest", "gloss", "--grow-mm", "3"}), 2, {"--grow-mm"}));
    EXPECT_TRUE(ended(damage({"--class", "stain", "--polygon", kSquare, "--tolerance", "5"}), 2,
                      {"--tolerance", "--wand"}));
    for (const char* name : {"Loss_To_Ground", "loss_to_ground.confidence", "Glossier", "matter.confidence"})
        EXPECT_TRUE(ended(
            tangipaint({"retouch", "--treatment", treatment(), "--class", "loss_to_ground", "--layer", name}),
            2, {"--layer", "give another"}));
    EXPECT_TRUE(ended(damage({"--class", "stain", "--mask", stack_.photo(0) + ".none"}), 1, {".none"}));
}

}  // namespace
}  // namespace tangi
