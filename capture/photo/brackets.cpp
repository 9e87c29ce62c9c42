#include "capture/photo/brackets.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "capture/photo/photo_folder.h"
#include "capture/photo/photo_metadata.h"
#include "capture/photo/photo_names.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/words.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr std::size_t kLongestPath = 300;  // [bytes] in a message
// In the folder that was named, as names of a lights file are (photo_names.h); else where it is said to be.
fs::path file_named(const std::string& name, const fs::path& folder) {
    return photo_named(name, folder, photos_in(folder)).photo.value_or(folder / portable(name));
}

BracketFile entry_of(const json& entry, const fs::path& folder, const std::string& where) {
    BracketFile file;
    if (entry.is_string()) {
        file.path = file_named(entry.get<std::string>(), folder);
    } else if (entry.is_object() && entry.contains("file") && entry["file"].is_string()) {
        file.path = file_named(entry["file"].get<std::string>(), folder);
        if (entry.contains("exposure")) {
            const double exposure = entry["exposure"].is_number() ? entry["exposure"].get<double>() : 0;
            if (!(exposure > 0 && std::isfinite(exposure)))
                fail("{}: the exposure of {} is not a positive number", where, file.path.filename().string());
            file.exposure = exposure;
        }
    } else {
        fail("{}: '{}' is neither a file name nor {{\"file\": …, \"exposure\": …}}", where, shown(entry));
    }
    std::error_code unknown;  // names that are too long, folders that nobody may look into
    if (!fs::is_regular_file(file.path, unknown))
        fail("{}: there is no photograph {}", where, shortened(file.path.string(), kLongestPath));
    return file;
}

}  // namespace

Brackets read_brackets(const fs::path& file, const fs::path& folder) {
    if (!fs::is_regular_file(file)) fail("{}: no such file of brackets", file.string());
    const json parsed = read_json(read_text_file(file), file.string());
    if (!parsed.is_object()) fail("{}: is not a JSON object {{\"LIGHT\": [\"FILE\", …], …}}", file.string());
    Brackets brackets;
    for (const auto& [light, list] : parsed.items()) {
        const std::string where = fmt::format("{}: '{}'", file.string(), shortened(light));
        if (!list.is_array() || list.empty()) fail("{}: is not a list of photographs", where);
        for (const json& entry : list) brackets[light].push_back(entry_of(entry, folder, where));
    }
    return brackets;
}

Brackets find_brackets(const std::vector<fs::path>& photos, const std::vector<std::string>& lights) {
    Brackets brackets;
    std::map<std::string, std::vector<fs::path>> by_stem;
    for (const fs::path& photo : photos) {
        const std::string stem = lower_case(photo.stem().string());
        const std::size_t digits = stem.find_last_not_of("0123456789");
        if (digits == std::string::npos || digits + 1 == stem.size() || digits == 0) continue;
        if (stem[digits] == '_' || stem[digits] == '-') by_stem[stem.substr(0, digits)].push_back(photo);
    }
    for (const std::string& light : lights) {
        const auto found = by_stem.find(lower_case(fs::path(light).stem().string()));
        if (found == by_stem.end() || found->second.size() < 2) continue;
        for (const fs::path& photo : found->second) brackets[light].push_back({photo, {}});
    }
    return brackets;
}

std::vector<Exposure> exposures_of(const std::string& light, const std::vector<BracketFile>& files) {
    std::vector<Exposure> exposures;
    const bool given =
        std::any_of(files.begin(), files.end(), [](const auto& f) { return f.exposure.has_value(); });
    for (const BracketFile& file : files) {
        const auto exposure = given ? file.exposure : exposure_of(read_photo_metadata(file.path));
        if (!exposure)
            fail(
                "{}: its exposure is not known{}, but '{}' has {} photographs; give it in a file of brackets "
                "as "
                "{{\"file\": \"{}\", \"exposure\": SECONDS}}",
                file.path.string(), given ? "" : " (EXIF has none)", light, files.size(),
                file.path.filename().string());
        exposures.push_back({file.path, *exposure});
    }
    std::sort(exposures.begin(), exposures.end(),
              [](const Exposure& a, const Exposure& b) { return a.relative < b.relative; });
    for (std::size_t k = 1; k < exposures.size(); ++k)
        if (exposures[k].relative < exposures[k - 1].relative * 1.01)
            fail("{}: has the same exposure as {}; a bracket of '{}' needs different ones",
                 exposures[k].path.string(), exposures[k - 1].path.filename().string(), light);
    return exposures;
}

}  // namespace tangi
