#include "cli/named_inputs.h"

#include <algorithm>
#include <exception>
#include <set>
#include <string_view>

#include "surface/painting_file/painting_tiles.h"
#include "surface/provenance/provenance.h"

namespace tangi {

namespace fs = std::filesystem;

NamedInputs::NamedInputs(std::span<char* const> words) {
    std::set<fs::path> paths;
    for (const std::string_view word : words) {
        fs::path path = word.starts_with('-') ? word.substr(word.find('=') + 1) : word;
        if (!path.has_filename()) path = path.parent_path();  // as shells complete names of folders
        std::error_code unreadable;
        if (fs::is_regular_file(path, unreadable) || is_tiled_painting(path))
            paths.insert(path);
        else if (fs::is_directory(path, unreadable))
            for (const auto& entry : fs::directory_iterator(path, unreadable))
                if (entry.is_regular_file(unreadable) && !entry.path().filename().string().starts_with('.'))
                    paths.insert(entry.path());
    }
    for (const fs::path& path : paths)
        if (const auto stamp = stamp_of(main_file_of(path))) files_.emplace_back(path, *stamp);
}

nlohmann::json NamedInputs::records() const {
    nlohmann::json records = nlohmann::json::array();
    for (const auto& [path, stamp] : files_)
        if (stamp_of(main_file_of(path)) == stamp) try {
                records.push_back(records_of({path}).front());
            } catch (
                const std::exception&) {  // the work is done: no reason to lose it, nor is lack of memory
            }
    return records;
}

}  // namespace tangi
