#include "surface/publish/bagit.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>
#include <sstream>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDeclaration = "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n";
constexpr const char* kManifest = "manifest-sha256.txt";
constexpr const char* kTagManifest = "tagmanifest-sha256.txt";

using Hashes = std::map<std::string, std::string>;  // path in the bag, with / -> SHA-256

// Line ends and percent signs of names, as RFC 8493 (2.1.3) writes them in manifests.
std::string in_manifest(const std::string& path) {
    std::string text;
    for (const char c : path)
        text += c == '\n' ? "%0A" : c == '\r' ? "%0D" : c == '%' ? "%25" : std::string(1, c);
    return text;
}

std::string from_manifest(std::string text) {
    for (const auto& [code, character] : {std::pair("%0A", "\n"), {"%0D", "\r"}, {"%25", "%"}})
        for (std::size_t at = 0; (at = text.find(code, at)) != std::string::npos; ++at)
            text.replace(at, 3, character);
    return text;
}

std::string lines_of(const Hashes& hashes) {
    std::string text;
    for (const auto& [path, hash] : hashes) text += hash + "  " + in_manifest(path) + "\n";
    return text;
}

Hashes read_manifest(const fs::path& file) {
    Hashes hashes;
    std::istringstream lines(read_text_file(file));
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        const auto gap = line.find_first_of(" \t");
        const auto name = gap == std::string::npos ? gap : line.find_first_not_of(" \t*", gap);
        if (name == std::string::npos)
            fail("{}:{}: is no line of a manifest: a hash and a file", file.string(), number);
        hashes[from_manifest(line.substr(name))] = line.substr(0, gap);
    }
    return hashes;
}

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

// All files below a folder, those in hidden folders excepted.
std::vector<fs::path> files_below(const fs::path& folder) {
    std::vector<fs::path> files;
    for (fs::recursive_directory_iterator at(folder), end; at != end; ++at) {
        if (is_hidden(at->path())) {
            if (at->is_directory()) at.disable_recursion_pending();
            continue;
        }
        if (at->is_regular_file()) files.push_back(at->path());
    }
    std::ranges::sort(files);
    return files;
}

// From -> to, below data/.
std::vector<std::pair<fs::path, fs::path>> payload_of(const std::vector<fs::path>& given) {
    std::vector<std::pair<fs::path, fs::path>> payload;
    std::map<std::string, fs::path> names;
    for (fs::path path : given) {
        if (!path.has_filename()) path = path.parent_path();  // "photos/"
        if (!fs::exists(path)) fail("{}: no such file or folder", path.string());
        const auto [first, is_new] = names.emplace(fs::weakly_canonical(path).filename().string(), path);
        if (!is_new)
            fail("{} and {}: have the same name, and would be one in the bag; rename one",
                 first->second.string(), path.string());
        if (fs::is_directory(path))
            for (const fs::path& file : files_below(path))
                payload.emplace_back(file, fs::path(first->first) / file.lexically_relative(path));
        else
            payload.emplace_back(path, first->first);
    }
    if (payload.empty()) fail("{}: holds no file for the bag", given.empty() ? "." : given.front().string());
    return payload;
}

std::string today() {
    const char* given = std::getenv("SOURCE_DATE_EPOCH");
    const std::time_t now =
        given && *given ? static_cast<std::time_t>(std::strtoll(given, nullptr, 10)) : std::time(nullptr);
    return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

// What a manifest says of files, and what they are. `found`: those that are there.
void compare(const fs::path& bag, const char* manifest, BagReport& report, const Progress& progress) {
    const Hashes hashes = read_manifest(bag / manifest);
    std::size_t done = 0;
    for (const auto& [path, hash] : hashes) {
        tangi::report(progress, "check", static_cast<double>(done++) / static_cast<double>(hashes.size()));
        const fs::path file = bag / path;
        const fs::path inside = file.lexically_normal().lexically_relative(bag.lexically_normal());
        if (inside.empty() || inside.begin()->string() == "..")
            report.faults.push_back(
                fmt::format("{}: names {}, which lies outside of the bag", manifest, path));
        else if (!fs::is_regular_file(file))
            report.faults.push_back(fmt::format("{}: is missing", path));
        else if (sha256_of_file(file) != hash)
            report.faults.push_back(
                fmt::format("{}: has changed: its SHA-256 is not that of {}", path, manifest));
    }
}

// "Payload-Oxum: 1234.5" of bag-info.txt; empty where it is not there.
std::string oxum_of(const fs::path& bag) {
    if (!fs::is_regular_file(bag / "bag-info.txt")) return "";
    std::istringstream lines(read_text_file(bag / "bag-info.txt"));
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with("Payload-Oxum:")) return line.substr(line.find_first_not_of(" \t", 13));
    return "";
}

}  // namespace

BagReport fill_bag(const fs::path& folder, const std::vector<fs::path>& files, const BagInfo& info,
                   const Progress& progress) {
    const auto payload = payload_of(files);
    BagReport report;
    Hashes hashes, tags;
    for (const auto& [from, to] : payload) {
        tangi::report(progress, "copy",
                      static_cast<double>(report.files) / static_cast<double>(payload.size()));
        const fs::path target = folder / "data" / to;
        make_folder(target.parent_path());
        AtomicFile copy(target);
        copy.copy_from(from);
        copy.commit();
        hashes[(fs::path("data") / to).generic_string()] = sha256_of_file(target);
        ++report.files;
        report.bytes += fs::file_size(target);
    }
    const auto write = [&](const char* name, const std::string& text) {
        write_text_file(folder / name, text);
        tags[name] = sha256_of(text);
    };
    write("bagit.txt", kDeclaration);
    std::string about;
    for (const auto& [label, value] : info)
        if (!value.empty()) about += fmt::format("{}: {}\n", label, value);
    about += fmt::format("Bag-Software-Agent: {}\nBagging-Date: {}\nPayload-Oxum: {}.{}\n", program_name(),
                         today(), report.bytes, report.files);
    write("bag-info.txt", about);
    write(kManifest, lines_of(hashes));
    write_text_file(folder / kTagManifest, lines_of(tags));
    return report;
}

BagReport check_bag(const fs::path& bag, const Progress& progress) {
    if (!fs::is_regular_file(bag / "bagit.txt")) fail("{}: is no bag: it has no bagit.txt", bag.string());
    if (!fs::is_regular_file(bag / kManifest))
        fail("{}: has no {}; other kinds of hashes are not read", bag.string(), kManifest);
    BagReport report;
    compare(bag, kManifest, report, progress);
    if (fs::is_regular_file(bag / kTagManifest)) compare(bag, kTagManifest, report, progress);
    const Hashes listed = read_manifest(bag / kManifest);
    if (fs::is_directory(bag / "data"))
        for (const auto& entry : fs::recursive_directory_iterator(bag / "data")) {
            if (!entry.is_regular_file()) continue;
            ++report.files;
            report.bytes += entry.file_size();
            const std::string path = entry.path().lexically_relative(bag).generic_string();
            if (!listed.contains(path)) report.faults.push_back(fmt::format("{}: is in no manifest", path));
        }
    const std::string oxum = oxum_of(bag), found = fmt::format("{}.{}", report.bytes, report.files);
    if (!oxum.empty() && oxum != found)
        report.faults.push_back(
            fmt::format("bag-info.txt: says {} bytes.files, and {} are there", oxum, found));
    return report;
}

}  // namespace tangi
