#include "paint/retouch/treatment_strokes.h"

#include <set>

#include "paint/journal.h"
#include "surface/error.h"

namespace tangi {

namespace fs = std::filesystem;

std::vector<std::string> strokes_that_cannot_be_repeated(const Treatment& treatment) {
    std::set<std::string> journals;
    for (const LogEntry& entry : treatment.log().entries())
        if (const auto outputs = entry.content.find("outputs"); outputs != entry.content.end())
            for (const auto& [name, hash] : outputs->items())
                if (name.starts_with("strokes/")) journals.insert(name);
    std::vector<std::string> faults;
    for (const std::string& name : journals) {
        const fs::path path = treatment.folder() / name;
        std::error_code unknown;
        if (!fs::exists(path, unknown)) continue;
        try {
            require_in_order(read_journal(path));
        } catch (const Error& error) {
            faults.emplace_back(error.what());
        }
    }
    return faults;
}

}  // namespace tangi
