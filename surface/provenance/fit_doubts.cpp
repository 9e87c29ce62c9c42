#include "surface/provenance/fit_doubts.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"

namespace tangi {

using nlohmann::json;

std::string with_doubts(const std::string& provenance, const std::vector<std::string>& poor,
                        const std::vector<std::string>& warnings) {
    json all = json_or_discarded(provenance);
    if (!all.is_object()) all = {{"made_of", provenance}};
    all["poor"] = poor;
    all["warnings"] = warnings;
    return json_line(all);
}

namespace {

std::vector<std::string> said_in(const Surface& surface, std::initializer_list<const char*> fields) {
    const json all = json_or_discarded(surface.provenance);
    std::vector<std::string> doubts;
    if (!all.is_object()) return doubts;
    for (const char* field : fields) {
        const json list = all.value(field, json());
        if (!list.is_array()) continue;
        for (const json& text : list)
            if (text.is_string() && std::ranges::find(doubts, text.get<std::string>()) == doubts.end())
                doubts.push_back(text.get<std::string>());
    }
    return doubts;
}

}  // namespace

std::vector<std::string> poor_of(const Surface& surface) { return said_in(surface, {"poor"}); }

std::vector<std::string> doubts_of(const Surface& surface) { return said_in(surface, {"poor", "warnings"}); }

}  // namespace tangi
