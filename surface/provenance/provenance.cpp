#include "surface/provenance/provenance.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <chrono>

#include "surface/base/parallel.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::string time_of(const fs::path& file) {
    const auto time = std::chrono::time_point_cast<std::chrono::seconds>(
        std::chrono::file_clock::to_sys(fs::last_write_time(file)));
    return fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

}  // namespace

nlohmann::json records_of(const std::vector<fs::path>& files) {
    std::vector<std::string> hashes(files.size());
    parallel_for(0, static_cast<int>(files.size()), 1, [&](int first, int last) {
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i)
            hashes[i] = sha256_of_file(main_file_of(files[i]));
    });
    nlohmann::json records = nlohmann::json::array();
    for (std::size_t i = 0; i < files.size(); ++i)
        records.push_back({{"file", files[i].filename().string()},
                           {"bytes", fs::file_size(main_file_of(files[i]))},
                           {"sha256", hashes[i]},
                           {"modified", time_of(main_file_of(files[i]))}});
    return records;
}

std::optional<fs::path> changed_since(const nlohmann::json& records, const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
        const fs::path main = main_file_of(file);
        if (!fs::exists(main)) return file;
        const auto is_same = [&](const nlohmann::json& record) {
            if (record.value("file", "") != file.filename().string() ||
                record.value("bytes", std::uintmax_t{0}) != fs::file_size(main))
                return false;
            return record.value("modified", "") == time_of(main) ||
                   record.value("sha256", "") == sha256_of_file(main);
        };
        if (!records.is_array() || std::ranges::none_of(records, is_same)) return file;
    }
    return {};
}

nlohmann::json provenance_of(const char* command, nlohmann::json options, nlohmann::json inputs) {
    return {{"program", program_name()},
            {"command", command},
            {"options", std::move(options)},
            {"inputs", std::move(inputs)}};
}

std::string portable_path(const fs::path& file, const fs::path& given_folder) {
    if (file.empty()) return "";
    const fs::path folder = given_folder.empty() ? fs::path(".") : given_folder;
    const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(
        fs::absolute(folder / "").lexically_normal());
    const auto up = std::ranges::count(relative, fs::path(".."));
    return relative.empty() || up > 2 ? file.filename().string() : relative.generic_string();
}

}  // namespace tangi
