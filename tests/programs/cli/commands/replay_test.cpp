// replay, run as a user would run it.
#include "surface/base/json_reading.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;

const std::string kHeader = "{\"format\": \"tangipaint strokes\", \"version\": 1}\n";
const std::string kStroke =
    "{\"event\": \"stroke\", \"brush\": {\"preset\": \"flat\", \"size_mm\": 4}, \"paint\": {\"Pyrrole Red\": "
    "1}, \"seed\": 3}\n"
    "{\"event\": \"point\", \"t\": 0, \"x\": -6, \"y\": 0}\n{\"event\": \"point\", \"t\": 0.1, \"x\": 6, "
    "\"y\": 1}\n"
    "{\"event\": \"end\"}\n";

struct Folder {
    TestDir dir;
    std::string path(const std::string& name) const { return (dir / name).string(); }
    std::string journal(const std::string& text, const std::string& name = "a.jsonl") const {
        write_bytes(dir / name, text);
        return path(name);
    }
    // Paints the text of a journal on a piece of linen of 20 x 15 mm.
    Finished replay(const std::string& text, std::vector<std::string> flags = {}) const {
        std::vector<std::string> arguments = {"replay", "--substrate", "linen", "--width-mm",
                                              "20",     "--height-mm", "15",    "--pixel-mm",
                                              "0.25",   journal(text), "--out", path("a.exr")};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        return tangipaint(arguments);
    }
};

double redness(const Image<Rgb>& picture) {
    double sum = 0;
    for (int y = 28; y < 32; ++y)
        for (int x = 30; x < 50; ++x) sum += picture(x, y).r / (picture(x, y).g + 0.01) / 80;
    return sum;
}

TEST(CliReplay, PaintsOnASubstrateThatInfoAndRelightShow) {
    const Folder f;
    const Finished run = f.replay(kHeader + kStroke);
    ASSERT_TRUE(ended(run, 0));
    const nlohmann::json said = run.json();
    EXPECT_EQ(said["width"], 80);
    EXPECT_EQ(said["height"], 60);
    EXPECT_EQ(said["strokes"], 1);
    EXPECT_EQ(said["points"], 2);
    EXPECT_GT(said["volumes_mm3"]["Pyrrole Red"], 1);

    const Finished info = tangipaint({"info", f.path("a.exr")});
    ASSERT_TRUE(ended(info, 0));
    const nlohmann::json paint = info.json()["paint"];
    ASSERT_EQ(paint.size(), 1u);
    EXPECT_EQ(paint[0]["layer"], "wet");
    EXPECT_NEAR(paint[0]["volumes_mm3"]["Pyrrole Red"].get<double>(),
                said["volumes_mm3"]["Pyrrole Red"].get<double>(), 1e-3);
    EXPECT_EQ(info.json()["dry_hash"], said["dry_hash"]);
    EXPECT_TRUE(info.json()["palette"].is_null());
    EXPECT_EQ(info.json()["brush"]["size_mm"], 4);
    EXPECT_GT(info.json()["brush"]["volumes_mm3"]["Pyrrole Red"], 1);

    // Lit from aside: under a light beside the eye, wet paint mirrors it.
    ASSERT_TRUE(
        ended(tangipaint({"relight", f.path("a.exr"), "--light=-1,1,1", "--out", f.path("a.png")}), 0));
    ASSERT_TRUE(ended(f.replay(kHeader), 0));  // no stroke
    ASSERT_TRUE(
        ended(tangipaint({"relight", f.path("a.exr"), "--light=-1,1,1", "--out", f.path("b.png")}), 0));
    EXPECT_GT(redness(read_picture(f.path("a.png"))), 2 * redness(read_picture(f.path("b.png"))));
}

TEST(CliReplay, ADamagedBrushIsRefusedByInfoToo) {
    const Folder f;
    ASSERT_TRUE(ended(f.replay(kHeader + kStroke), 0));
    std::string bytes = bytes_of(f.path("a.exr"));
    const std::string size = "\"size_mm\":4.0";
    ASSERT_NE(bytes.find(size), std::string::npos);
    bytes.replace(bytes.find(size), size.size(), "\"size_mm\":9e9");
    write_bytes(f.path("bad.exr"), bytes);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"info", f.path("bad.exr")},
          {"replay", f.path("bad.exr"), f.path("a.jsonl"), "--out", f.path("b.exr")}})
        EXPECT_TRUE(ended(tangipaint(command), 1, {"bad.exr: attribute 'brush' of part 'brush'", "size_mm"}));
}

TEST(CliReplay, ATintOutOfRangeIsNamedWithItsOption) {
    const Folder f;
    for (const std::string tint : {"2,0.5,0.1", "0,0,-1", "nan,0,0"})
        EXPECT_TRUE(ended(f.replay(kHeader, {"--tint", tint}), 2, {"--tint " + tint}));
    EXPECT_TRUE(ended(f.replay(kHeader, {"--tint", "1,0.5,0"}), 0));
}

TEST(CliReplay, PaintsOnAPaintingAndGoesOn) {
    const Folder f;
    ASSERT_TRUE(ended(f.replay(kHeader), 0));
    const PartToWrite errors{
        {"errors", 80, 60, {"a"}, {}, false},
        [](int y0, int y1, std::span<float* const> planes) { std::fill_n(planes[0], (y1 - y0) * 80, 2.0f); }};
    {
        const Surface ground = read_painting(f.path("a.exr"));
        AtomicFile file(f.path("a.exr"));
        write_painting(file, ground, {&errors, 1});
    }
    const std::string strokes =
        f.journal(kHeader + kStroke + "{\"event\": \"dry\", \"layer\": \"one\"}\n" + kStroke);
    const Finished first = tangipaint({"replay", f.path("a.exr"), strokes, "--out", f.path("b.exr")});
    ASSERT_TRUE(ended(first, 0));
    EXPECT_TRUE(first.json()["warnings"].empty());
    const Finished second = tangipaint({"replay", f.path("b.exr"), strokes, "--out", f.path("c.exr")});
    ASSERT_TRUE(ended(second, 0));
    EXPECT_EQ(first.json()["dry_hash"], second.json()["dry_hash"]);
    EXPECT_GT(second.json()["volumes_mm3"]["Pyrrole Red"].get<double>(),
              1.5 * first.json()["volumes_mm3"]["Pyrrole Red"].get<double>());
    const auto parts = painting_parts(f.path("c.exr"));
    EXPECT_TRUE(std::any_of(parts.begin(), parts.end(), [](const auto& part) {
        return part.name == "errors";
    })) << "what the fit says of the dry layer stays";
    Surface unscaled(80, 60);
    write_painting(f.path("u.exr"), unscaled);
    const std::vector<std::string> on_it = {"replay", f.path("u.exr"), strokes, "--out", f.path("v.exr")};
    EXPECT_TRUE(ended(tangipaint(on_it), 0, {"u.exr: its scale is unknown", "--mm-per-pixel"}));
    // The same strokes on the same painting are the same file.
    ASSERT_TRUE(ended(tangipaint({"replay", f.path("a.exr"), strokes, "--out", f.path("d.exr")}), 0));
    EXPECT_EQ(bytes_of(f.path("b.exr")), bytes_of(f.path("d.exr")));
}

TEST(CliReplay, TakesBrushesOfTheUsers) {
    const Folder f;
    write_bytes(f.dir / "b.json",
                R"({"format": "tangipaint brushes", "version": 1, "brushes": {"broom": {"size_mm": 7}}})");
    const std::string stroke =
        "{\"event\": \"stroke\", \"brush\": {\"preset\": \"broom\"}, \"paint\": {\"Bone Black\": 1}}\n"
        "{\"event\": \"point\", \"x\": 0, \"y\": 0}\n";
    EXPECT_TRUE(ended(f.replay(kHeader + stroke, {"--brushes", f.path("b.json")}), 0));
    EXPECT_TRUE(ended(f.replay(kHeader + stroke), 1, {"a.jsonl:2", "broom", "filbert"}));
    write_bytes(f.dir / "b.json", "{}");
    EXPECT_TRUE(ended(f.replay(kHeader + stroke, {"--brushes", f.path("b.json")}), 1,
                      {"b.json", "tangipaint brushes"}));
}

TEST(CliReplay, TornJournalsArePaintedWithAWarning) {
    const Folder f;
    const Finished run = f.replay(kHeader + kStroke + "{\"event\": \"stro");
    ASSERT_TRUE(ended(run, 0, {"a.jsonl:6", "cut short"}));
    EXPECT_EQ(run.json()["strokes"], 1);
}

TEST(CliReplay, RefusesWhatIsWrongAndLeavesNothing) {
    const Folder f;
    const auto refused = [&](const Finished& run, int code, const std::vector<std::string>& words) {
        EXPECT_TRUE(ended(run, code, words));
        EXPECT_EQ(names_in(f.dir.path()), std::vector<std::string>{"a.jsonl"});
    };
    refused(f.replay("nonsense\n"), 1, {"a.jsonl:1", "not a journal"});
    refused(f.replay(kHeader + "{\"event\": \"fly\"}\n"), 1, {"a.jsonl:2", "\"fly\""});
    refused(f.replay(kHeader + "{\"event\": \"stroke\", \"paint\": {\"Mauve\": 1}}\n"), 1,
            {"a.jsonl:2", "Mauve"});
    refused(f.replay(kHeader, {"--palette", f.path("none.json")}), 1, {"none.json"});
    const std::string journal = f.journal(kHeader);
    refused(tangipaint({"replay", journal, "--out", f.path("a.exr")}), 2, {"--substrate"});
    refused(tangipaint({"replay", "--substrate", "silk", journal, "--out", f.path("a.exr")}), 2,
            {"silk", "burlap"});
    refused(tangipaint({"replay", "--substrate", "linen", "x.exr", journal, "--out", f.path("a.exr")}), 2,
            {"journal only"});
    refused(tangipaint({"replay", f.path("gone.exr"), journal, "--out", f.path("a.exr")}), 1,
            {"gone.exr: no such file"});
    refused(tangipaint({"replay", "--substrate", "linen", journal, "--out", journal}), 1,
            {"--out", "a.jsonl", "overwrite"});
    for (const char* flag : {"--board", "--video"})
        refused(
            tangipaint({"replay", "--substrate", "linen", journal, "--out", f.path("a.exr"), flag, journal}),
            1, {std::string(flag) + " " + journal, "overwrite"});
    refused(
        tangipaint({"replay", "--substrate", "linen", "--pixel-mm", "0", journal, "--out", f.path("a.exr")}),
        2, {"--pixel-mm"});
    EXPECT_EQ(bytes_of(journal), kHeader);
}

TEST(CliReplay, PaintsOnAPictureAndKeepsItUnderAName) {
    const Folder f;
    Image<Rgb> stripes(60, 40);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 60; ++x) stripes(x, y) = Rgb(x / 10 % 2 ? 0.6f : 0.2f);
    write_picture(f.dir / "cloth.png", stripes, {Transfer::Kind::srgb});
    const Conditions home{.environment = {{"XDG_DATA_HOME", f.path("data")}}};
    const auto replay = [&](std::vector<std::string> flags) {
        std::vector<std::string> all = {"replay", f.journal(kHeader + kStroke), "--out", f.path("a.exr")};
        all.insert(all.end(), flags.begin(), flags.end());
        return tangipaint(all, home);
    };
    ASSERT_TRUE(ended(replay({"--substrate", f.path("cloth.png"), "--pixel-mm", "0.5", "--relief-mm", "0.3",
                              "--keep-substrate", "my cloth"}),
                      0));
    const Surface dry = read_painting(f.path("a.exr"));
    EXPECT_EQ(dry.mm_per_pixel, 0.5);
    EXPECT_NEAR(dry.diffuse(15, 20).g, 0.6, 0.001);
    EXPECT_NEAR(dry.height_mm(15, 20) - dry.height_mm(5, 20), 0.3, 1e-4);
    ASSERT_TRUE(ended(replay({"--substrate", "my cloth"}), 0));
    EXPECT_TRUE(images_near(read_painting(f.path("a.exr")).height_mm, dry.height_mm, 0));
    EXPECT_TRUE(dry.scale_known);
    const auto made_of = read_json(dry.provenance, "JSON");
    EXPECT_EQ(made_of["substrate"], "cloth.png");
    EXPECT_EQ(made_of["height_from"], "luminance");
    EXPECT_EQ(made_of["relief_mm"], 0.3);
    const Finished assumed = replay({"--substrate", f.path("cloth.png"), "--height-from", "none"});
    ASSERT_TRUE(ended(assumed, 0, {"cloth.png: a picture does not say how large it is", "0.2 mm"}));
    EXPECT_EQ(assumed.json()["warnings"].size(), 1u);
    const Surface unknown = read_painting(f.path("a.exr"));
    EXPECT_EQ(unknown.height_mm(15, 20), 0);
    EXPECT_FALSE(unknown.scale_known);
    EXPECT_EQ(unknown.mm_per_pixel, 0.2);
    const Finished info = tangipaint({"info", f.path("a.exr")});
    EXPECT_EQ(info.json()["scale_from"], "assumed");
    EXPECT_FALSE(info.json()["paint"].empty()) << "painted on, with brushes of 0.2 mm a pixel";
    EXPECT_TRUE(ended(replay({"--substrate", "velvet"}), 2, {"velvet", "linen", "my cloth"}));
    EXPECT_TRUE(ended(replay({"--substrate", f.path("none.png")}), 1, {"none.png"}));
    EXPECT_TRUE(
        ended(replay({"--substrate", f.path("cloth.png"), "--keep-substrate", "linen"}), 1, {"linen"}));
}

TEST(CliReplay, MixesOnThePaletteAndShowsHowItCameIntoBeing) {
    const Folder f;
    const std::string points =
        "{\"event\": \"point\", \"t\": 0, \"x\": -6, \"y\": 0}\n{\"event\": \"point\", \"t\": 3, \"x\": 6, "
        "\"y\": 1}\n";
    const std::string mixing =
        kHeader +
        "{\"event\": \"pile\", \"paint\": {\"Pyrrole Red\": 1}, \"x\": 0, \"y\": 0, \"size_mm\": 8}\n"
        "{\"event\": \"stroke\", \"on\": \"palette\", \"brush\": {\"size_mm\": 4}}\n" +
        points + "{\"event\": \"stroke\", \"brush\": {\"size_mm\": 4}, \"start\": \"same\"}\n" + points;
    const Finished run = f.replay(mixing, {"--frames", f.path("frames"), "--every", "1"});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_GT(run.json()["volumes_mm3"]["Pyrrole Red"], 0.1);  // what came to the painting
    EXPECT_LT(run.json()["volumes_mm3"]["Pyrrole Red"], 20);
    EXPECT_EQ(run.json()["frames"], 4);  // bare, after 1 s and 2 s of the stroke, finished after 3 s
    EXPECT_EQ(read_picture(f.dir / "frames" / "frame-00001.png").width(), 80);
    ASSERT_TRUE(ended(f.replay(mixing, {"--board", f.path("board.exr")}), 0));
    const double all = std::numbers::pi / 8 * 8 * 8 * 1.5, painted = run.json()["volumes_mm3"]["Pyrrole Red"];
    const Finished board = tangipaint({"info", f.path("board.exr")});
    EXPECT_LT(board.json()["paint"][0]["volumes_mm3"]["Pyrrole Red"], all - painted + 0.1);
    const std::filesystem::path painting = f.path("a.exr");
    std::filesystem::remove(painting);
    const Finished without = f.replay(kHeader + kStroke, {"--board", f.path("b.exr")});
    EXPECT_TRUE(ended(without, 0, {"--board", "is not written: nothing was done on the palette"}));
    EXPECT_EQ(without.json()["warnings"].size(), 1u);
    EXPECT_TRUE(std::filesystem::exists(painting)) << "the painting is not lost";
    EXPECT_FALSE(std::filesystem::exists(f.path("b.exr")));
    std::filesystem::remove(painting);
    EXPECT_TRUE(ended(f.replay(kHeader + kStroke, {"--board", painting.string()}), 2, {"another name"}));
    EXPECT_TRUE(ended(f.replay(kHeader + kStroke, {"--board", f.path("b.png")}), 2, {"b.png", ".exr"}));
    EXPECT_TRUE(ended(tangipaint({"replay", f.path("a.jsonl"), f.path("p.exr"), "--out", painting.string()}),
                      2, {"p.exr: is a painting; the journal of strokes comes last"}));
    EXPECT_FALSE(std::filesystem::exists(painting)) << "nothing is replaced where something is wrong";
    EXPECT_GT(redness(read_picture(f.dir / "frames" / "frame-00004.png")),
              1.5 * redness(read_picture(f.dir / "frames" / "frame-00001.png")));
    EXPECT_TRUE(ended(f.replay(mixing, {"--frames", f.path("frames")}), 1, {"frames: has frames already"}));
    EXPECT_TRUE(ended(f.replay(mixing, {"--frames", "a.mp4"}), 2, {"--frames a.mp4", "--video"}));
    EXPECT_TRUE(ended(f.replay(mixing, {"--video", "film"}), 2, {"--video film", ".mp4"}));
    const Finished video = f.replay(mixing, {"--video", f.path("film.mp4"), "--every", "1"});
    ASSERT_TRUE(ended(video, 0));
    EXPECT_EQ(video.json()["frames"], 4);
    EXPECT_EQ(bytes_of(f.dir / "film.mp4").substr(4, 4), "ftyp");
}

TEST(CliReplay, FilmsShowEachStrokeOnItsWay) {
    const Folder f;
    const Finished run = f.replay(kHeader +
                                      "{\"event\": \"stroke\", \"brush\": {\"size_mm\": 4}, \"paint\": "
                                      "{\"Pyrrole Red\": 1}}\n{\"event\": \"point\", \"t\": 0, \"x\": -8, "
                                      "\"y\": 0}\n{\"event\": \"point\", \"t\": 4, \"x\": 8, \"y\": 0}\n",
                                  {"--frames", f.path("frames"), "--every", "1"});
    ASSERT_TRUE(ended(run, 0));
    ASSERT_EQ(run.json()["frames"], 5);
    double before = 0;
    for (int i = 1; i <= 5; ++i) {
        const Image<Rgb> picture = read_picture(f.dir / "frames" / fmt::format("frame-{:05}.png", i));
        double red = 0;
        for (const Rgb& c : picture.pixels()) red += c.r > 2 * c.g ? 1 : 0;
        EXPECT_GE(red, before + (i == 1 ? 0 : 50)) << i;
        before = red;
    }
    EXPECT_TRUE(ended(f.replay(kHeader + "{\"event\": \"stroke\"}\n{\"event\": \"point\", \"x\": 0, \"y\": "
                                         "0}\n{\"event\": \"point\", \"t\": 1e6, \"x\": 1, \"y\": 0}\n",
                               {"--frames", f.path("more"), "--every", "0.01"}),
                      2, {"--every 0.01", "100000000 pictures", "99999"}));
    EXPECT_FALSE(std::filesystem::exists(f.path("more")));
}

TEST(CliReplay, SaysWhatHadNoEffectAndWhichLayersThereAre) {
    const Folder f;
    const std::string dry = "{\"event\": \"dry\", \"layer\": \"retouch\"}\n";
    const Finished run = f.replay(kHeader + kStroke + dry + kStroke + dry);
    ASSERT_TRUE(ended(run, 0, {"a.jsonl:11", "'retouch 2'"}));
    EXPECT_EQ(run.json()["layers"], (nlohmann::json{"retouch", "retouch 2"}));
    EXPECT_EQ(run.json()["warnings"].size(), 1u);
    const Finished info = tangipaint({"info", f.path("a.exr")});
    EXPECT_NE(info.out.find("\"retouch 2\""), std::string::npos);
}

TEST(CliReplay, FlagsWithoutEffectAreRefused) {
    const Folder f;
    const std::string journal = f.journal(kHeader + kStroke);
    ASSERT_TRUE(ended(f.replay(kHeader + kStroke), 0));
    write_picture(f.dir / "cloth.png", Image<Rgb>(40, 30, Rgb(0.5f)), {Transfer::Kind::srgb});
    const auto refused = [&](std::vector<std::string> ground, std::vector<std::string> flags) {
        std::vector<std::string> words = {"replay", journal, "--out", f.path("b.exr")};
        words.insert(ground.front() == "--substrate" ? words.end() : words.begin() + 1, ground.begin(),
                     ground.end());
        words.insert(words.end(), flags.begin(), flags.end());
        EXPECT_TRUE(ended(tangipaint(words), 2, {flags.front() + ": "})) << ground.back() << flags.front();
    };
    for (const auto& flags : std::vector<std::vector<std::string>>{{"--width-mm", "20"},
                                                                   {"--height-mm", "20"},
                                                                   {"--pixel-mm", "0.25"},
                                                                   {"--seed", "1"},
                                                                   {"--height-from", "none"},
                                                                   {"--relief-mm", "1"}}) {
        refused({f.path("a.exr")}, flags);
    }
    refused({f.path("a.exr")}, {"--keep-substrate", "mine"});
    refused({"--substrate", f.path("a.exr")}, {"--seed", "1"});
    refused({"--substrate", "linen"}, {"--height-from", "luminance"});
    refused({"--substrate", "linen"}, {"--relief-mm", "1"});
    refused({"--substrate", f.path("cloth.png")}, {"--width-mm", "10"});
    refused({"--substrate", f.path("cloth.png")}, {"--relief-mm", "1", "--height-from", "none"});
    for (const std::string flag : {"--every", "--frames-width", "--frame-rate"})
        refused({f.path("a.exr")}, {flag, "30"});
    refused({f.path("a.exr")}, {"--frames-light", "0,0,1"});
    refused({f.path("a.exr")}, {"--frame-rate", "30", "--frames", f.path("frames")});
    EXPECT_TRUE(ended(tangipaint({"paint", f.path("a.exr"), "--seed", "2"}), 2, {"--seed: "}));
    EXPECT_TRUE(ended(tangipaint({"paint", f.path("a.exr"), "--monitor", "srgb", "--intent", "relative"}), 2,
                      {"--intent: "}));
    EXPECT_TRUE(
        ended(tangipaint({"paint", "--substrate", "linen", "--out", f.path("a.png")}), 2, {"a.png", ".exr"}));
    EXPECT_FALSE(std::filesystem::exists(f.path("b.exr")));
}

TEST(CliReplay, PaintIsSeenUnderLightsAndByTheModelOfTheThesis) {
    const Folder f;
    ASSERT_TRUE(ended(f.replay(kHeader + kStroke), 0));
    const auto relit = [&](std::vector<std::string> flags) {
        std::vector<std::string> arguments = {"relight", f.path("a.exr"), "--light",
                                              "0,0,1",   "--out",         f.path("a.png")};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        return tangipaint(arguments);
    };
    ASSERT_TRUE(ended(relit({}), 0));
    const double daylight = redness(read_picture(f.path("a.png")));
    ASSERT_TRUE(ended(relit({"--illuminant", "a"}), 0));
    EXPECT_GT(redness(read_picture(f.path("a.png"))), 1.03 * daylight);
    ASSERT_TRUE(ended(relit({"--paint-model", "thesis"}), 0));
    EXPECT_GT(std::abs(redness(read_picture(f.path("a.png"))) / daylight - 1), 0.02);
    EXPECT_TRUE(ended(relit({"--illuminant", "C"}), 2, {"--illuminant C", "F11"}));
    EXPECT_TRUE(ended(relit({"--paint-model", "rgb"}), 2, {"--paint-model rgb", "thesis"}));
}

// Of a disk that was full for a moment, as earlier versions left it.
TEST(CliReplay, ADamagedLineIsLeftOutWhereThatIsAskedFor) {
    const Folder f;
    const std::string damaged =
        kHeader + kStroke + "{\"event\": \"po{\"event\": \"end\"}\n{\"event\": \"undo\"}\n" + kStroke;
    EXPECT_TRUE(ended(f.replay(damaged), 1, {"a.jsonl:6", "not JSON"}));
    const Finished run = f.replay(damaged, {"--recover"});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(run.json()["strokes"], 2);
    ASSERT_EQ(run.json()["warnings"].size(), 2u);
    EXPECT_THAT(run.json()["warnings"][0].get<std::string>(),
                HasSubstr("a.jsonl:6: cannot be read, and is left out"));
}

// What a journal says of itself is not overruled without a word.
TEST(CliReplay, OfAnotherPaintingOrPaletteThanTheJournalSaysIsTold) {
    const Folder f;
    const std::string strokes = "{\"event\": \"paints\"}\n" + kStroke;
    write_bytes(
        f.dir / "p.json",
        "{\"format\": \"tangipaint palette\", \"version\": 1, \"name\": \"mine\", \"paints\": [{\"name\": "
        "\"Pyrrole Red\", \"srgb\": \"#b02018\"}]}");
    EXPECT_TRUE(ended(f.replay(kHeader + strokes, {"--palette", f.path("p.json")}), 2,
                      {"--palette", "a.jsonl:2", "leave the flag out"}));
    ASSERT_TRUE(ended(f.replay(kHeader + kStroke, {"--palette", f.path("p.json")}), 0));
    const std::string other = f.journal(
        "{\"format\": \"tangipaint strokes\", \"version\": 1, \"on\": \"0123456789abcdef\"}\n" + strokes,
        "b.jsonl");
    const Finished told = tangipaint({"replay", f.path("a.exr"), other, "--out", f.path("b.exr")});
    ASSERT_TRUE(ended(told, 0));
    EXPECT_THAT(told.json()["warnings"].dump(), testing::HasSubstr("another painting"));
    EXPECT_TRUE(
        ended(f.replay(kHeader + strokes + kHeader + strokes), 1, {"a.jsonl:", "another journal begins"}));
}

}  // namespace
}  // namespace tangi
