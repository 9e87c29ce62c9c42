#include "viewer/model/user_settings.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostRecent = 10;

}  // namespace

fs::path settings_folder() {
    const char* config = std::getenv("XDG_CONFIG_HOME");
    if (config && fs::path(config).is_absolute()) return fs::path(config) / "tangipaint";
    const char* home = std::getenv("HOME");
    if (home && fs::path(home).is_absolute()) return fs::path(home) / ".config" / "tangipaint";
    return {};
}

std::string SettingsFile::make_way() {
    const auto there = stamp_of(file_);
    if (!there || (!is_bad_ && there == stamp_)) return {};
    fs::path aside = file_;
    aside.replace_extension((is_bad_ ? ".wrong" : ".other") + file_.extension().string());
    std::error_code failed;
    fs::rename(file_, aside, failed);
    if (failed)
        fail("{}: cannot be renamed to {}: {}", file_.string(), aside.filename().string(), failed.message());
    return fmt::format("{} {}, and is kept as {}", file_.string(),
                       is_bad_ ? "could not be read" : "was changed by another program",
                       aside.filename().string());
}

void SettingsFile::is_written() {
    stamp_ = stamp_of(file_);
    is_bad_ = false;
}

fs::path untitled(const fs::path& folder) {
    for (int i = 1;; ++i) {
        fs::path path = folder / ("untitled-" + std::to_string(i) + ".exr");
        std::error_code unknown;  // a folder that cannot be looked into: writing there says so
        if (!fs::exists(path, unknown)) return path;
    }
}

std::vector<fs::path> recent_paintings(const fs::path& folder) {
    std::vector<fs::path> recent;
    std::error_code gone;
    if (folder.empty() || !fs::exists(folder / "recent.json", gone)) return recent;
    nlohmann::json list;
    try {
        list = json_or_discarded(read_text_file(folder / "recent.json"));
    } catch (const Error&) {
        return recent;
    }
    if (!list.is_array()) return recent;
    for (const nlohmann::json& entry : list)
        if (entry.is_string() && fs::is_regular_file(entry.get<std::string>(), gone))
            recent.emplace_back(entry.get<std::string>());
    return recent;
}

void remember_painting(const fs::path& folder, const fs::path& painting) {
    if (folder.empty()) return;
    std::vector<fs::path> recent = recent_paintings(folder);
    const fs::path path = fs::absolute(painting).lexically_normal();
    std::erase(recent, path);
    recent.insert(recent.begin(), path);
    if (recent.size() > kMostRecent) recent.resize(kMostRecent);
    nlohmann::json list = nlohmann::json::array();
    for (const fs::path& one : recent) list.push_back(one.string());
    make_folder(folder);
    write_text_file(folder / "recent.json", json_lines(list, 1));
}

}  // namespace tangi
