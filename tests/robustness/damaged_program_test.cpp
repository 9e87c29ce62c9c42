// damaged_program_test.cpp: the program itself, given damaged files of every kind: it ends with 0, 1, 2 or 3
// and a short message of its own; no signal, no bug of ours, nothing that hangs or takes gigabytes, and what
// it says on standard output is JSON.
//
// Short here. TP_RANDOM_S=3600 lets it go on for an hour, TP_RANDOM_SEED=7 damages otherwise,
// TP_RANDOM_FILE=a.exr damages one kind only; what is named as wrong is kept in $TP_RANDOM_KEEP.
#include <gmock/gmock.h>

#include <chrono>

#include "surface/base/json_reading.h"
#include "tests/programs/support/cli_program.h"
#include "tests/support/damaged_bytes.h"
#include "tests/support/file_kinds.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Words = std::vector<std::string>;

constexpr std::chrono::seconds kLongest{10};
constexpr long kMostMemory_kib = 500 * 1024;      // of which 150 MB are libraries
constexpr std::size_t kLongestLine = 1500 + 100;  // [bytes] kMostOfMessage of the program, and who speaks

// A kind of file, and the command that is given one.
struct Use {
    std::string kind;
    std::function<Words(const std::string& file)> command;
};

class CommandsOfEachKind {
public:
    CommandsOfEachKind() {
        write_bytes(out("palette.json"), kinds_.at("palette.json").whole);
        write_bytes(out("whole.exr"), kinds_.at("a.exr").whole);
    }

    std::string out(const std::string& name) const { return (dir_ / name).string(); }
    const FileKind& kind(const std::string& name) const { return kinds_.at(name); }

    std::vector<Use> uses() const {
        const std::string photos = stack_.path(), lights = stack_.lights(), out_exr = out("o.exr");
        const auto fit_with = [=](const std::string& flag, const std::string& file) {
            return Words{"fit", photos, flag, file, "--out", out_exr};
        };
        const auto info = [](const std::string& file) { return Words{"info", file}; };
        std::vector<Use> all;
        for (const char* name : {"a.exr", "photo.png", "photo.jpg", "photo.tif", "photo.exr", "photo.tga",
                                 "a.ptm", "a.rti", "a.lp", "a.relight", "a.dome"})
            all.push_back({name, info});
        all.push_back({"a.exr", [=](const std::string& file) {
                           return Words{"relight", file, "--light", "0,0,1", "--out", out_exr};
                       }});
        all.push_back({"a.jsonl", [=, this](const std::string& file) {
                           return Words{"replay", out("whole.exr"), file, "--out", out_exr};
                       }});
        for (const char* name : {"a.lp", "a.dome", "a.relight", "spheres.relight", "capture.json"})
            all.push_back({name, [=](const std::string& file) { return fit_with("--lights", file); }});
        all.push_back(
            {"brackets.json", [=](const std::string& file) { return fit_with("--brackets", file); }});
        for (const char* name : {"lens.yml", "lens.xml"})
            all.push_back({name, [=, this](const std::string& file) {
                               return Words{"calibrate", photos, "--lens", file, "--out", out("o.lp")};
                           }});
        all.push_back({"palette.json", [=, this](const std::string& file) {
                           return Words{"palette", file, "--save", out("saved.json")};
                       }});
        all.push_back({"palette.json", [](const std::string& file) {
                           return Words{"match", "--srgb", "#406080", "--palette", file};
                       }});
        all.push_back({"pairs.json", [](const std::string& file) {
                           return Words{"match", "--srgb", "#406080", "--pairs", file};
                       }});
        for (const char* name : {"photo.png", "photo.jpg", "photo.tif", "photo.exr"})
            all.push_back({name, [=](const std::string& file) {
                               return Words{"import", "--diffuse", file, "--height", file, "--out", out_exr};
                           }});
        return all;
    }

private:
    static std::map<std::string, FileKind> by_name(const TestDir& dir) {
        std::map<std::string, FileKind> kinds;
        for (FileKind& kind : file_kinds(dir)) kinds.emplace(kind.name, std::move(kind));
        return kinds;
    }

    TestDir dir_;
    TinyStack stack_;
    std::map<std::string, FileKind> kinds_ = by_name(dir_);
};

std::string objection_to_words(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.size() > kLongestLine) return fmt::format("says {} bytes in a line", line.size());
        for (const char* innards : {"exception", "libpng", "std::", "Imf", "json.", "cv::", "OpenCV(",
                                    "TIFFRead", "OpenImageIO could", "internal error"})
            if (line.find(innards) != std::string::npos) return "speaks of innards: " + line;
    }
    return {};
}

// What is wrong with how the program met a file; empty where nothing is.
std::string objection_to(const Finished& run) {
    if (run.timed_out) return "hangs";
    if (run.code != 0 && run.code != 1 && run.code != 2 && run.code != 3)
        return fmt::format("ends with {}: {}", run.code, run.err);
    if (run.peak_kib > kMostMemory_kib) return fmt::format("takes {} MB", run.peak_kib / 1024);
    const bool speaks = run.code == 0 || run.code == 3;
    if (speaks ? json_or_discarded(run.out).is_discarded() : !run.out.empty())
        return "says what is no JSON: " + run.out;
    if (run.code == 1 && run.err.empty()) return "says nothing";
    return objection_to_words(run.err);
}

double number_given(const char* variable, double otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atof(text) : otherwise;
}

TEST(DamagedFiles, MakeTheProgramNeitherCrashNorHangNorSpeakNonsense) {
    const CommandsOfEachKind controller;
    const double seconds = number_given("TP_RANDOM_S", 25);
    const auto seed = static_cast<std::uint64_t>(number_given("TP_RANDOM_SEED", 1));
    const char* only = std::getenv("TP_RANDOM_FILE");
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    const std::vector<Use> uses = controller.uses();
    const fs::path folder = controller.out("damaged");
    fs::create_directories(folder);
    long files = 0;
    for (int round = 0; Clock::now() < end; ++round)
        for (const Use& use : uses) {
            if ((only && use.kind != only) || Clock::now() >= end) continue;
            Random random(seed * 1'000'003 + static_cast<std::uint64_t>(round) * 101 + use.kind.size());
            const std::string bytes = round == 0 ? controller.kind(use.kind).whole
                                                 : damaged(controller.kind(use.kind).whole, random);
            const std::string file = (folder / use.kind).string();
            write_bytes(file, bytes);
            const std::string wrong = objection_to(tangipaint(use.command(file), {.timeout = kLongest}));
            ++files;
            if (wrong.empty()) continue;
            if (const char* keep = std::getenv("TP_RANDOM_KEEP"))
                write_bytes(fs::path(keep) / fmt::format("{}_{}_{}", seed, round, use.kind), bytes);
            ADD_FAILURE() << fmt::format("{}", fmt::join(use.command(file), " ")) << ", seed " << seed
                          << ", round " << round << ": " << wrong;
        }
    EXPECT_GT(files, static_cast<long>(only ? 1 : 10));
    fmt::print("{} runs\n", files);
}

}  // namespace
}  // namespace tangi
