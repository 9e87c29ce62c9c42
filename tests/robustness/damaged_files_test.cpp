// damaged_files_test.cpp: every kind of file that the program reads, with bytes changed, cut off, put in or
// taken out: it is read, or there is an Error that names it in one line. Nothing hangs, nothing asks for
// memory that the file cannot fill.
//
// Short here. TP_RANDOM_S=3600 lets it go on for an hour, TP_RANDOM_SEED=7 damages otherwise,
// TP_RANDOM_FILE=a.exr damages one kind only; what is named as wrong is kept in $TP_RANDOM_KEEP.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "tests/support/damaged_bytes.h"
#include "tests/support/file_kinds.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kLongest_s = 10;                    // for files of some kilobytes, on any machine
constexpr long kMostGrowth_kib = 512 * 1024;         // of the process, by one file
constexpr std::size_t kLongestMessage_bytes = 1500;  // as the program cuts them

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
std::string objection(const FileKind& kind, const fs::path& path) {
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
        // "[json.exception…" is among them; "[json" alone may be a name that a file gives.
        for (const char* innards : {"exception", "std::", "basic_", "Imf", "EXR_", "stoi", "stod", "nlohmann",
                                    "cv::", "libpng", "OpenImageIO could"})
            if (said.find(innards) != std::string::npos) return "speaks of innards: " + said;
        if (said.find('\n') != std::string::npos || said.size() > kLongestMessage_bytes)
            return "is long: " + said;
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
    const std::vector<FileKind> all = file_kinds(dir);
    for (const FileKind& kind : all) {
        write_bytes(dir / kind.name, kind.whole);
        EXPECT_NO_THROW(kind.read(dir / kind.name)) << kind.name;
    }
    long files = 0;
    for (int round = 0; round < rounds && (seconds == 0 || Clock::now() < end); ++round)
        for (const FileKind& kind : all) {
            if (only && kind.name != only) continue;
            Random random(seed * 1'000'003 + static_cast<std::uint64_t>(round));
            // Under its own name, since some have to have it.
            const fs::path folder = dir / "damaged", path = folder / kind.name;
            fs::create_directories(folder);
            const std::string bytes = damaged(kind.whole, random);
            write_bytes(path, bytes);
            const std::string wrong = objection(kind, path);
            ++files;
            fs::remove(path);
            if (wrong.empty()) continue;
            if (const char* keep = std::getenv("TP_RANDOM_KEEP"))
                write_bytes(fs::path(keep) / kind.name, bytes);
            ADD_FAILURE() << kind.name << ", seed " << seed << ", round " << round << ": " << wrong;
        }
    if (seconds > 0)
        fmt::print("{} files, {} of each kind\n", files, files / static_cast<long>(only ? 1 : all.size()));
}

}  // namespace
}  // namespace tangi
