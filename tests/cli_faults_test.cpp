// cli_faults_test.cpp: the commands that write, in scenes of what is there before; see fault_scene.h.
#include "fault_scene.h"

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
}

TEST_F(CliFaults, TreatmentReport) {
    try_scene({"report",
               {kBegin, kDamage, {"treatment", "report", "T", "--out", "report.html"}, kVarnish},
               {"treatment", "report", "T", "--out", "report.html"},
               {"info", "p.exr"}});
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
               {"calibrate", "photos", "--no-balls", "--chart", "off", "--ppi", "300", "--out",
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
