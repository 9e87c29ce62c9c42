// damaged_files_test.cpp: every kind of file that the program reads, with bytes changed, cut off, put in or
// taken out: it is read, or there is an Error that names it in one line. Nothing hangs, nothing asks for
// memory that the file cannot fill.
//
// Short here. TP_RANDOM_S=3600 lets it go on for an hour, TP_RANDOM_SEED=7 damages otherwise,
// TP_RANDOM_FILE=a.exr damages one kind only; what is named as wrong is kept in $TP_RANDOM_KEEP.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>

#include "capture/capture_file.h"
#include "capture/chart_reference.h"
#include "capture/dome_file.h"
#include "capture/lens_file.h"
#include "capture/lights_file.h"
#include "capture/relight_file.h"
#include "fit/rti_file.h"
#include "paint/canvas_file.h"
#include "paint/retouch/mask.h"
#include "paint/retouch/treatment_log.h"
#include "paint/session.h"
#include "paint/tools_file.h"
#include "surface/overview.h"
#include "tests/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kLongest_s = 10;             // for files of some kilobytes, on any machine
constexpr long kMostGrowth_kib = 512 * 1024;  // of the process, by one file

struct Kind {
    std::string name;  // of a file
    std::string whole;
    std::function<void(const fs::path&)> read;
};

const char* const kJournal =
    "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
    "{\"event\": \"palette\", \"paints\": [\"Titanium White\", \"Bone Black\"]}\n"
    "{\"event\": \"pile\", \"on\": \"painting\", \"paint\": {\"Pyrrole Red\": 1, \"Bone Black\": 2}, \"x\": "
    "1, "
    "\"y\": -1, \"size_mm\": 5, \"medium\": 0.5}\n"
    "{\"event\": \"dry\", \"layer\": \"first\", \"part\": 0.5, \"circle\": {\"x\": 0, \"y\": 0, "
    "\"radius_mm\": "
    "4}}\n"
    "{\"event\": \"stroke\", \"brush\": {\"preset\": \"flat\", \"size_mm\": 4}, \"paint\": {\"Hansa Yellow "
    "Opaque\": "
    "1}, \"load\": 0.5, \"start\": \"clean\", \"seed\": 3}\n"
    "{\"event\": \"point\", \"t\": 0, \"x\": -4, \"y\": 0, \"p\": 0.7, \"tx\": 0.1, \"r\": 20}\n"
    "{\"event\": \"point\", \"t\": 0.5, \"x\": 3.5, \"y\": 1}\n{\"event\": \"end\"}\n{\"event\": \"undo\"}\n"
    "{\"event\": \"redo\"}\n{\"event\": \"dry\", \"layer\": \"second\", \"polygon\": [[-5, -5], [5, -5], [0, "
    "5]]}\n{\"event\": \"lift\", \"layer\": \"first\"}\n";

std::shared_ptr<Surface> bare() {
    auto dry = std::make_shared<Surface>(24, 18);
    dry->mm_per_pixel = 0.5;
    dry->scale_known = true;
    std::fill(dry->diffuse.pixels().begin(), dry->diffuse.pixels().end(), Rgb(0.5f, 0.4f, 0.3f));
    std::fill(dry->roughness.pixels().begin(), dry->roughness.pixels().end(), 0.2f);
    std::fill(dry->confidence.pixels().begin(), dry->confidence.pixels().end(), 1.0f);
    return dry;
}

void play(const fs::path& journal) {
    const Journal events = read_journal(journal);
    Session session(bare(), artist_acrylics());
    replay(session, events);
}

std::string painting_bytes(const TestDir& dir) {
    write_bytes(dir / "j.jsonl", kJournal);
    Session session(bare(), artist_acrylics());
    Journal events = read_journal(dir / "j.jsonl");
    events.entries.resize(events.entries.size() - 2);
    replay(session, events);
    AtomicFile file(dir / "p.exr");
    write_canvas(file, session.canvas(), {}, with_tools({}, session));
    return bytes_of(dir / "p.exr");
}

void read_all_of_painting(const fs::path& path) {
    Session session(read_canvas(path), artist_acrylics());
    read_tools(path, session);
    parts_beside_paint(path);
    read_overview(path);
}

std::string picture_bytes(const TestDir& dir, const std::string& name) {
    write_picture(dir / name, Image<Rgb>(24, 18, Rgb(0.5f, 0.3f, 1.0f)), Transfer{});
    return bytes_of(dir / name);
}

std::string rti_bytes(const TestDir& dir, RtiBasis basis, const std::string& name) {
    AtomicFile file(dir / name);
    write_rti_file(file, rti_of(*bare(), basis, false, {Transfer::Kind::srgb}, {.directions = 20}));
    return bytes_of(dir / name);
}

nlohmann::json vectors() {
    nlohmann::json list = nlohmann::json::array();
    for (const Light& l : dome_lights(5))
        list.push_back({{"x", l.direction.x}, {"y", l.direction.y}, {"z", l.direction.z}});
    return list;
}

nlohmann::json dome() {
    return {{"imageWidth", 200},       {"domeDiameter", 1000},
            {"verticalOffset", 5},     {"lightConfiguration", "spherical"},
            {"directions", vectors()}, {"positionsSphere", vectors()}};
}

std::vector<Kind> text_kinds() {
    std::string lights = "5\n", chart = "name,R,G,B\n";
    for (int i = 0; i < kChartPatches; ++i) chart += fmt::format("p{},0.{},0.2,0.3\n", i, 1 + i % 9);
    nlohmann::json images = nlohmann::json::array();
    for (const Light& l : dome_lights(5)) {
        lights += fmt::format("{} {} {} {}\n", l.name, l.direction.x, l.direction.y, l.direction.z);
        images.push_back({{"filename", l.name}, {"skip", false}});
    }
    const nlohmann::json project = {{"images", images}, {"dome", dome()}, {"pixelSize", 0.1}};
    const std::string reflectances = "[0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.4, 0.5, 0.5, 0.6, 0.6, 0.7]";
    return {
        {"a.jsonl", kJournal, play},
        {"a.lp", lights, [](const fs::path& path) { read_lights_file(path); }},
        {"a.dome", dome().dump(1), [](const fs::path& path) { read_dome_file(path); }},
        {"a.relight", project.dump(1), [](const fs::path& path) { read_relight_file(path); }},
        {"palette.json",
         "{\"format\": \"tangipaint palette\", \"version\": 1, \"name\": \"mine\", \"paints\": [\n"
         "{\"name\": \"White\", \"k_per_mm\": " +
             reflectances + ", \"s_per_mm\": " + reflectances +
             "},\n{\"name\": \"Ochre\", \"masstone\": " + reflectances +
             ", \"hiding_mm\": 0.08},\n{\"name\": \"Sky\", \"srgb\": \"#80c0ff\", \"roughness\": 0.2}]}",
         [](const fs::path& path) { read_palette(path); }},
        {"brushes.json",
         "{\"format\": \"tangipaint brushes\", \"version\": 1, \"brushes\": {\n\"broom\": {\"preset\": "
         "\"fan\", \"size_mm\": 60}, \"nib\": {\"shape\": \"knife\", \"follow\": true}}}",
         [](const fs::path& path) { read_brush_presets(path); }},
        {"capture.json",
         "{\"format\": \"tangipaint capture 1\", \"photographs\": {\"count\": 1, \"width\": 41, \"height\": "
         "31},\n\"camera\": {\"position_mm\": [2, 3, 600], \"mm_per_pixel\": 0.5}, \"frame\": "
         "{\"origin_px\": "
         "[20, 15]},\n\"lights\": [{\"name\": \"a.png\", \"direction\": [0.6, 0, 0.8], \"position_mm\": "
         "[300, 0, "
         "400]}]}",
         [](const fs::path& path) { read_capture_file(path); }},
        {"chart.csv", chart, [](const fs::path& path) { read_chart_reference(path); }},
        {"lens.yml",
         "%YAML:1.0\n---\nimage_width: 100\nimage_height: 80\ncamera_matrix: !!opencv-matrix\n   rows: 3\n"
         "   cols: 3\n   dt: d\n   data: [ 90., 0., 50., 0., 90., 40., 0., 0., 1. ]\n"
         "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0.1, 0., "
         "0., 0., 0. ]\n",
         [](const fs::path& path) { read_lens(path); }}};
}

std::vector<Kind> kinds(const TestDir& dir) {
    std::vector<Kind> all = text_kinds();
    all.push_back({"a.exr", painting_bytes(dir), read_all_of_painting});
    all.push_back(
        {"a.ptm", rti_bytes(dir, RtiBasis::ptm, "b.ptm"), [](const fs::path& path) { read_rti_file(path); }});
    all.push_back({"a.rti", rti_bytes(dir, RtiBasis::hsh9, "b.rti"),
                   [](const fs::path& path) { read_rti_file(path); }});
    for (const char* name : {"a.png", "a.tif", "a.jpg"})
        all.push_back(
            {name, picture_bytes(dir, name), [](const fs::path& path) { read_mask(path, 24, 18); }});
    return all;
}

// One of the ways in which copies, disks and editors damage files.
std::string damaged(std::string bytes, Random& random) {
    const auto place = [&] {
        // The beginning says what the rest is: it is hit as often.
        const int end = static_cast<int>(bytes.size());
        return static_cast<std::size_t>(random.below(random.uniform() < 0.5 ? std::min(end, 2000) : end));
    };
    const auto any = [&] { return static_cast<char>(random.below(256)); };
    for (int times = 1 + random.below(3); times > 0 && !bytes.empty(); --times) {
        const std::size_t at = place(), length = 1 + static_cast<std::size_t>(random.below(8));
        switch (random.below(7)) {
            case 0:
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
                break;
            case 1:
                bytes[at] = any();
                break;
            case 2:
                bytes.resize(at);
                break;
            case 3:
                bytes.erase(at, length);
                break;
            case 4:
                bytes.insert(at, bytes.substr(place(), length));
                break;
            case 5:
                bytes.replace(at, std::min(length, bytes.size() - at), length,
                              "\0\xff"
                              "9-e"[random.below(5)]);
                break;
            default:
                bytes.insert(at, 1, any());
        }
    }
    return bytes;
}

bool is_utf8(const std::string& text) {
    try {
        (void)nlohmann::json(text).dump();
        return true;
    } catch (const nlohmann::json::exception&) {
        return false;
    }
}

long resident_kib() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

// What is wrong with the way in which a damaged file was met; empty where nothing is.
std::string objection(const Kind& kind, const fs::path& path) {
    const auto begin = Clock::now();
    const long before = resident_kib();
    std::string said;
    try {
        kind.read(path);
    } catch (const Error& error) {
        said = error.what();
        if (said.find(path.filename().string()) == std::string::npos)
            return "does not name the file: " + said;
        if (!is_utf8(said)) return "is no UTF-8: " + said;
        for (const char* innards :
             {"exception", "std::", "basic_", "Imf", "EXR_", "stoi", "stod", "nlohmann", "[json"})
            if (said.find(innards) != std::string::npos) return "speaks of innards: " + said;
        if (said.find('\n') != std::string::npos || said.size() > 1500) return "is long: " + said;
    } catch (const std::exception& error) {
        return std::string("is no Error: ") + error.what();
    }
    const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
    if (took_s > kLongest_s) return fmt::format("took {} s: {}", took_s, said);
    if (const long grown = resident_kib() - before; grown > kMostGrowth_kib)
        return fmt::format("took {} MiB: {}", grown / 1024, said);
    return {};
}

double number_of(const char* variable, double otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atof(text) : otherwise;
}

TEST(DamagedFiles, AreReadOrRefusedInOneLine) {
    const TestDir dir;
    const double seconds = number_of("TP_RANDOM_S", 0);
    const auto seed = static_cast<std::uint64_t>(number_of("TP_RANDOM_SEED", 1));
    const char* only = std::getenv("TP_RANDOM_FILE");
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    const int rounds = seconds > 0 ? 1'000'000'000 : 60;
    const std::vector<Kind> all = kinds(dir);
    for (const Kind& kind : all) {
        write_bytes(dir / kind.name, kind.whole);
        EXPECT_NO_THROW(kind.read(dir / kind.name)) << kind.name;
    }
    for (int round = 0; round < rounds && (seconds == 0 || Clock::now() < end); ++round)
        for (const Kind& kind : all) {
            if (only && kind.name != only) continue;
            Random random(seed * 1'000'003 + static_cast<std::uint64_t>(round));
            const fs::path path = dir / ("x" + kind.name);
            const std::string bytes = damaged(kind.whole, random);
            write_bytes(path, bytes);
            const std::string wrong = objection(kind, path);
            if (wrong.empty()) continue;
            if (const char* keep = std::getenv("TP_RANDOM_KEEP"))
                write_bytes(fs::path(keep) / kind.name, bytes);
            ADD_FAILURE() << kind.name << ", seed " << seed << ", round " << round << ": " << wrong;
        }
}

}  // namespace
}  // namespace tangi
