// cli_faults_test.cpp: commands of which a call that changes a file fails, or which are killed there: what
// was is there as a whole, or what is to be, and the next command leaves nothing behind.
//
// A sample of the calls; all of them with TP_FAULTS=all (before a release).
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <set>

#include "cli_program.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using State = std::map<std::string, std::string>;

constexpr const char* kTime = "1700000000";  // [s] so that what tells when it was made is the same each time

// What other programs see: names that are hidden are looked at elsewhere.
State visible(const fs::path& folder) {
    State all;
    for (const std::string& path : everything_in(folder))
        if (!path.starts_with('.') && path.find("/.") == std::string::npos)
            all[path] = path.ends_with('/') ? "" : bytes_of(folder / path);
    return all;
}

Words left_in(const fs::path& folder) {
    Words left;
    for (const std::string& path : everything_in(folder))
        if (path.starts_with('.') || path.find("/.") != std::string::npos ||
            path.find("/pending/") != std::string::npos)
            left.push_back(path);
    return left;
}

Words names_that_differ(const State& one, const State& other) {
    Words names;
    for (const auto& [name, bytes] : one)
        if (const auto found = other.find(name); found == other.end() || found->second != bytes)
            names.push_back(name);
    for (const auto& [name, bytes] : other)
        if (!one.contains(name)) names.push_back(name);
    return names;
}

struct Scene {
    std::string name;
    std::vector<Words> before;   // commands that make what is there before
    Words command;               // what is tried
    Words reads;                 // a command that reads some of what it writes
    std::vector<Words> again{};  // what is done after it; the command itself where nothing is given
};

struct Fault {
    long at = 0;
    int reason = EIO;  // 0: killed
    bool stays = false;
};

class CliFaults : public testing::Test {
protected:
    CliFaults() : stack_([](GeneratorOptions& options) { options.lights = 8; }, 24) {
        fs::create_directory(root());
        fs::create_directory(given());
        fs::copy(stack_.folder(), given() / "photos", fs::copy_options::recursive);
        fs::copy_file(stack_.truth(), given() / "p.exr");
    }
    fs::path root() const { return fs::canonical(stack_.root()) / "run"; }
    fs::path given() const { return fs::canonical(stack_.root()) / "given"; }

    void start_from(const fs::path& folder) const {
        fs::remove_all(root());
        fs::copy(folder, root(), fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    }

    Finished run(const Words& command, const std::map<std::string, std::string>& faults = {}) const {
        Conditions conditions;
        conditions.cwd = root();
        conditions.environment = {{"LD_PRELOAD", TP_FAULT_INJECTOR},
                                  {"TP_FAULT_UNDER", root().string()},
                                  {"TP_FAULT_TIME", kTime},
                                  {"USER", "A. Restorer"}};
        for (const auto& [name, value] : faults) conditions.environment[name] = value;
        Words words = command;
        words.insert(words.end(), {"--threads", "1"});  // so that calls come in one order
        return tangipaint(words, conditions);
    }

    static bool is_done(const Finished& run) { return run.code == 0 || run.code == 3; }

    void try_scene(const Scene& scene) {
        SCOPED_TRACE(scene.name);
        start_from(given());
        for (const Words& command : scene.before) {
            const Finished made = run(command);
            ASSERT_TRUE(is_done(made)) << testing::PrintToString(command) << made.err;
        }
        const fs::path prepared = fs::path(stack_.root()) / ("before-" + scene.name),
                       trace = fs::path(stack_.root()) / "trace";
        fs::copy(root(), prepared, fs::copy_options::recursive);
        before_ = visible(root());
        ASSERT_TRUE(is_done(run(scene.command, {{"TP_FAULT_TRACE", trace.string()}})));
        after_ = visible(root());
        ASSERT_NE(before_, after_);
        ASSERT_EQ(left_in(root()), Words());
        calls_.clear();
        std::istringstream lines(bytes_of(trace));
        for (std::string line; std::getline(lines, line);) calls_.push_back(line);
        fs::remove(trace);
        ASSERT_GT(calls_.size(), 3u) << "is the injector loaded?";
        start_from(prepared);
        ASSERT_TRUE(is_done(run(scene.command)));
        ASSERT_EQ(names_that_differ(visible(root()), after_), Words()) << "not the same each time";
        int tried = 0;
        for (const Fault& fault : chosen()) {
            start_from(prepared);
            try_fault(scene, fault);
            ++tried;
        }
        std::cout << fmt::format("{}: {} calls, {} faults\n", scene.name, calls_.size(), tried);
    }

    // Of many writes to one file, neither the first nor the last, nor each 32nd.
    bool is_one_of_many(long at) const {
        const auto call = [&](long place) {
            return place >= 1 && place <= static_cast<long>(calls_.size())
                       ? calls_[static_cast<std::size_t>(place - 1)]
                       : std::string();
        };
        return call(at - 1) == call(at) && call(at + 1) == call(at) && at % 32 != 0;
    }

    // Faults at all calls or, in a small part of the time, at some from the first to the last, and at those
    // where names are changed.
    std::vector<Fault> chosen() const {
        const char* text = std::getenv("TP_FAULTS");
        const bool all = text && std::string(text) == "all";
        const long count = static_cast<long>(calls_.size());
        std::set<long> places;
        for (long at = 1; at <= count; ++at) {
            const std::string& call = calls_[static_cast<std::size_t>(at - 1)];
            const bool commits = call.find(".outputs.") != std::string::npos ||
                                 (call.starts_with("rename") && call.find(".tmp") == std::string::npos) ||
                                 call.find("log.jsonl") != std::string::npos;
            if ((all && !is_one_of_many(at)) || commits) places.insert(at);
        }
        constexpr std::size_t kSampled = 7;  // of each scene: with the fixture's some twenty a minute
        if (!all) {
            std::vector<long> some(places.begin(), places.end());
            places.clear();
            for (std::size_t i = 0; i < kSampled && !some.empty(); ++i)
                places.insert(some[(i * some.size() + some.size() / 2) / kSampled % some.size()]);
            for (long i = 0; i < 3; ++i) places.insert(1 + (2 * i + 1) * count / 6);
        }
        std::vector<Fault> faults;
        long turn = 0;
        for (const long at : places) {
            const std::vector<Fault> kinds = {{at, 0}, {at, EIO}, {at, ENOSPC, true}};
            if (all)
                faults.insert(faults.end(), kinds.begin(), kinds.end());
            else
                faults.push_back(kinds[static_cast<std::size_t>(turn++ % 3)]);
        }
        return faults;
    }

    void try_fault(const Scene& scene, const Fault& fault) const {
        SCOPED_TRACE(fmt::format("call {} ({}) {}", fault.at, calls_[static_cast<std::size_t>(fault.at - 1)],
                                 fault.reason == 0 ? "killed"
                                                   : fmt::format("{}{}", std::strerror(fault.reason),
                                                                 fault.stays ? " from there on" : "")));
        const Finished ended = run(scene.command, {{"TP_FAULT_AT", std::to_string(fault.at)},
                                                   {"TP_FAULT_ERRNO", std::to_string(fault.reason)},
                                                   {"TP_FAULT_STAYS", fault.stays ? "1" : "0"}});
        if (fault.reason != 0) expect_told(ended, fault);
        if (fault.reason == 0) {
            EXPECT_EQ(ended.code, 128 + SIGKILL) << ended.err;
        } else if (is_done(ended)) {
            EXPECT_EQ(names_that_differ(visible(root()), after_), Words());
        }
        // Whoever reads it by this program finds the one or the other.
        const Finished read = run(scene.reads);
        const State now = visible(root());
        EXPECT_TRUE(now == before_ || now == after_)
            << "neither, by " << testing::PrintToString(names_that_differ(now, before_)) << "\nnor "
            << testing::PrintToString(names_that_differ(now, after_)) << "\n"
            << ended.err << read.err;
        for (const Words& next : scene.again) {
            const Finished done = run(next);
            EXPECT_TRUE(is_done(done)) << testing::PrintToString(next) << "\n" << ended.err << done.err;
        }
        if (scene.again.empty()) {
            const Finished done = run(scene.command);
            EXPECT_TRUE(is_done(done)) << ended.err << done.err;
            EXPECT_EQ(names_that_differ(visible(root()), after_), Words());
        }
        EXPECT_EQ(left_in(root()), Words()) << ended.err;
    }

    static void expect_told(const Finished& ended, const Fault& fault) {
        if (is_done(ended)) return;
        EXPECT_EQ(ended.code, 1) << ended.err;
        EXPECT_EQ(ended.out, "");
        EXPECT_THAT(ended.err, testing::HasSubstr(std::strerror(fault.reason)));
        EXPECT_THAT(ended.err, testing::Not(testing::HasSubstr(".tmp")));
        EXPECT_THAT(ended.err, testing::Not(testing::HasSubstr(".outputs.")));
        EXPECT_LT(ended.err.size(), 700u) << ended.err;
    }

    TinyStack stack_;
    State before_, after_;
    Words calls_;
};

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
