// faults_test.cpp: the commands that write, in scenes of what is there before; see fault_scene.h.
#include "tests/robustness/fault_scene.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

const Words kBegin = {"treatment", "begin", "T", "--painting", "p.exr"},
            kDamage = {"damage",  "p.exr", "--treatment", "T",
                       "--class", "stain", "--polygon",   "-1,-1;1,-1;1,1"},
            kVarnish = {"varnish", "T"}, kCheck = {"treatment", "check", "T"};

// After a step that happened or not: others, and what the log says is so.
const std::vector<Words> kFurther = {kDamage, kVarnish, kCheck};

TEST_F(CliFaults, TreatmentBegin) { try_scene({"begin", {}, kBegin, {"info", "p.exr"}, {kDamage, kCheck}}); }

TEST_F(CliFaults, TreatmentSteps) {
    try_scene({"damage",
               {kBegin, kDamage},
               {"damage", "p.exr", "--treatment", "T", "--class", "stain", "--polygon", "-2,-2;0,-2;0,0"},
               kCheck,
               kFurther});
    try_scene({"varnish", {kBegin, kVarnish}, kVarnish, kCheck, kFurther});
    try_scene({"undo", {kBegin, kDamage, kVarnish}, {"treatment", "undo", "T"}, kCheck, kFurther});
    try_scene(
        {"remove", {kBegin, kVarnish, kVarnish}, {"treatment", "remove", "T", "--all"}, kCheck, kFurther});
    try_scene({"undo of a removal",
               {kBegin, kVarnish, kVarnish, {"treatment", "remove", "T", "--all"}},
               {"treatment", "undo", "T"},
               kCheck,
               kFurther});
}

TEST_F(CliFaults, TreatmentReport) {
    try_scene({"report",
               {kBegin, kDamage, {"treatment", "report", "T", "--out", "report.html"}, kVarnish},
               {"treatment", "report", "T", "--out", "report.html"},
               {"info", "p.exr"}});
}

// Its maps wait where nobody sees them, and where the next command looks.
TEST_F(CliFaults, QualityOfATreatmentThatIsKilled) {
    const Words loss = {"--polygon", "-2,-2;2,-2;2,2"};
    const auto with_loss = [&](Words command) {
        command.insert(command.end(), loss.begin(), loss.end());
        return command;
    };
    start_from(given());
    for (const Words& command : {kBegin, with_loss({"retouch", "--treatment", "T"})})
        ASSERT_TRUE(is_done(run(command)));
    const State before = visible(root());
    const Words quality = {"quality", "--treatment", "T"};
    const Finished killed = run(quality, {{"TP_FAULT_AT", "20"}, {"TP_FAULT_ERRNO", "0"}});
    ASSERT_EQ(killed.code, 128 + SIGKILL) << killed.err;
    EXPECT_EQ(names_that_differ(visible(root()), before), Words());
    EXPECT_NE(left_in(root()), Words());
    ASSERT_TRUE(is_done(run(quality)));
    EXPECT_EQ(left_in(root()), Words());
    EXPECT_TRUE(visible(root()).contains("T/quality/1/gloss.exr"));
}

// What was written is read back before it is put in place: a disk that fails is no lack of memory.
TEST_F(CliFaults, MapsThatTheDiskDoesNotGiveBack) {
    start_from(given());
    const Words command = {"export", "p.exr", "--to", "maps", "--out", "e"};
    const Words reads = traced(command, {{"TP_FAULT_READS", "1"}});
    const auto first = std::ranges::find_if(reads, [](const std::string& call) {
        return call.starts_with("read") && call.ends_with(".exr") && call.find(".tmp") != std::string::npos;
    });
    ASSERT_NE(first, reads.end());
    start_from(given());
    const Finished failed =
        run(command, {{"TP_FAULT_READS", "1"}, {"TP_FAULT_AT", std::to_string(first - reads.begin() + 1)}});
    EXPECT_EQ(failed.code, 1);
    EXPECT_THAT(failed.err, testing::HasSubstr("cannot be read: Input/output error"));
    EXPECT_THAT(failed.err, testing::Not(testing::HasSubstr(".tmp")));
    EXPECT_FALSE(fs::exists(root() / "e"));
}

// A picture that cannot be put in its place: nothing has happened, to a treatment as little as beside it.
TEST_F(CliFaults, PicturesThatBelongToAStep) {
    start_from(given());
    ASSERT_TRUE(is_done(run(kBegin)));
    const fs::path begun = given() / "begun";
    fs::copy(root(), begun, fs::copy_options::recursive);
    const State before = visible(root());
    for (const Words& command :
         {Words{"match", "--srgb", "#406080", "--max-paints", "1", "--swatch", "s.png", "--save-pairs",
                "pairs.json"},
          Words{"match", "--treatment", "T", "--polygon", "-2,-2;2,-2;2,2", "--max-paints", "1", "--swatch",
                "s.png"},
          Words{"retouch", "--treatment", "T", "--polygon", "-2,-2;2,-2;2,2", "--preview", "s.png"}}) {
        SCOPED_TRACE(testing::PrintToString(command));
        start_from(begun);
        const Words calls = traced(command, {});
        const auto named = std::ranges::find_if(
            calls, [](const auto& call) { return call.starts_with("rename") && call.ends_with("/s.png"); });
        ASSERT_NE(named, calls.end());
        start_from(begun);
        const Finished failed = run(command, {{"TP_FAULT_AT", std::to_string(named - calls.begin() + 1)}});
        EXPECT_EQ(failed.code, 1);
        EXPECT_THAT(failed.err, testing::HasSubstr("s.png"));
        EXPECT_EQ(names_that_differ(visible(root()), before), Words()) << failed.err;
        EXPECT_EQ(left_in(root()), Words());
    }
}

// Libraries that pack say in words of their own that there is no memory.
TEST_F(CliFaults, PackedExportsWithoutMemory) {
    start_from(given());
    for (const char* out : {"e.html", "e.ora"}) {
        const Words command = {"export", "p.exr", "--to", fs::path(out) == "e.ora" ? "ora" : "web",
                               "--out",  out};
        const auto count = static_cast<long>(traced(command, {{"TP_FAULT_MEMORY_AT", "0"}}).size());
        fs::remove(root() / out);
        for (long at = std::max(1L, count - 3); at <= count; ++at) {
            SCOPED_TRACE(fmt::format("{}: allocation {} of {} fails", out, at, count));
            const Finished ended = run(command, {{"TP_FAULT_MEMORY_AT", std::to_string(at)}});
            EXPECT_TRUE(is_done(ended) || ended.code == 1) << ended.err;
            if (!is_done(ended)) {
                EXPECT_THAT(ended.err, testing::HasSubstr("not enough memory"));
                EXPECT_FALSE(fs::exists(root() / out));
            }
            fs::remove(root() / out);
        }
    }
}

TEST_F(CliFaults, Fit) {
    const Words fit = {"fit", "photos", "--out", "a.exr", "--report", "a.html"};
    Words other = fit;
    other.insert(other.end(), {"--mm-per-pixel", "0.3"});
    try_scene({"fit", {other}, fit, {"info", "a.exr"}});
}

TEST_F(CliFaults, Compare) {
    const Words compare = {"compare", "p.exr", "photos", "--out", "c"};
    Words other = compare;
    other.insert(other.end(), {"--error-range", "0.4"});
    try_scene({"compare", {other}, compare, {"info", "c/compare.json"}});
    try_scene({"compare to nothing", {}, compare, {"info", "c/compare.json"}});
}

TEST_F(CliFaults, Calibrate) {
    try_scene({"calibrate",
               {},
               {"calibrate", "photos", "--no-spheres", "--chart", "off", "--ppi", "300", "--out",
                "photos/lights.lp", "--force"},
               {"info", "photos"}});
}

TEST_F(CliFaults, Replay) {
    const auto journal = [](const char* paint) {
        return fmt::format(
            R"({{"format": "tangipaint strokes", "version": 1}}
{{"event": "pile", "paint": {{"{}": 1}}, "x": 0, "y": 0, "size_mm": 4}}
{{"event": "stroke", "on": "palette", "brush": {{"size_mm": 2}}}}
{{"event": "point", "t": 0, "x": -1, "y": 0}}
{{"event": "point", "t": 1, "x": 1, "y": 0}}
{{"event": "stroke", "brush": {{"size_mm": 2}}, "start": "same"}}
{{"event": "point", "t": 2, "x": -1, "y": 0}}
{{"event": "point", "t": 3, "x": 1, "y": 0}}
)",
            paint);
    };
    write_bytes(given() / "a.jsonl", journal("Pyrrole Red"));
    write_bytes(given() / "b.jsonl", journal("Bone Black"));
    fs::create_directory(given() / "sub");
    const auto replay = [](const char* strokes) {
        return Words{"replay", "p.exr", strokes, "--out", "out.exr", "--board", "sub/board.exr"};
    };
    try_scene({"replay", {replay("b.jsonl")}, replay("a.jsonl"), {"info", "sub/board.exr"}});
}

TEST_F(CliFaults, Relight) {
    const Words relight = {"relight", "p.exr", "--lights", "photos/lights.lp", "--out", "r"};
    Words other = relight;
    other.insert(other.end(), {"--gain", "0.5"});
    try_scene({"relight", {other}, relight, {"info", "r/img_000.png"}});
}

TEST_F(CliFaults, Generate) {
    const Words generate = {"generate",        "--out", "s",        "--width", "16",         "--height", "16",
                            "--supersampling", "1",     "--lights", "4",       "--held-out", "0"};
    Words other = generate;
    other[10] = "6";
    other.back() = "1";
    other.insert(other.end(), {"--reflectance", "ward_bounded"});
    try_scene({"generate", {other}, generate, {"info", "s"}});
}

TEST_F(CliFaults, Export) {
    Words again = {"fit", "photos", "--out", "q.exr"};
    for (const auto& [format, out] : {std::pair("maps", "e"), {"ora", "e.ora"}, {"web", "w"}})
        try_scene({std::string("export ") + format,
                   {again, {"export", "q.exr", "--to", format, "--out", out}},
                   {"export", "p.exr", "--to", format, "--out", out},
                   {"info", "p.exr"}});
}

}  // namespace
}  // namespace tangi
