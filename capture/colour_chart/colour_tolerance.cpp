// colour_tolerance.cpp: tables of limits, and which are kept.
#include "capture/colour_chart/colour_tolerance.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr double kNone = -1;  // no limit was found

struct Level {
    const char* name;
    double neutral, mean, maximum, percentile_90;
};

struct Standard {
    const char* name;
    const char* source;
    bool inclusive;             // "at most" rather than "less than"
    bool flat_lightness;        // CIEDE2000 with S_L = 1
    std::vector<Level> levels;  // best first
};

// All limits are differences in CIEDE2000; neutral is that without lightness.
const std::vector<Standard>& standards() {
    // A comparison of FADGI, ISO and Metamorfoze at skandalski.pl/tabela-fadgi-iso-metamorfoze: a secondary
    // source. Its FADGI column is that of bound collections; other materials may have other limits.
    static const char* const kTable = "comparison at skandalski.pl/tabela-fadgi-iso-metamorfoze (secondary)";
    static const std::vector<Standard> all = {
        {"FADGI 2023, bound general collections",
         kTable,
         false,
         false,
         {{"4 stars", 2, 2, kNone, 4},
          {"3 stars", 4, 3.5, kNone, 7},
          {"2 stars", 6, 5, kNone, 10},
          {"1 star", 8, 6.5, kNone, 13}}},
        // Version 2.0, draft of June 2023: "CIE2000 SL=1"; the same limits as in the table above. For Extra
        // Light no limit on colours other than greys is given.
        {"Metamorfoze 2.0 (draft of 2023)",
         "preservationimaging.com/version-2",
         true,
         true,
         {{"Full", 3, 3, 7, kNone}, {"Light", 3, 4, 14, kNone}, {"Extra Light", 5, kNone, kNone, kNone}}},
        {"ISO 19264-1:2021",
         kTable,
         true,
         false,
         {{"A", 3, 4, 10, kNone}, {"B", 4, 5, 15, kNone}, {"C", 5, 5, 15, kNone}}},
    };
    return all;
}

std::vector<ToleranceCheck> checks_of(const Standard& standard, const Level& level,
                                      const ColourCorrection& c) {
    // The worst of the photographs, each by itself: on average over them, casts of opposite colours vanish.
    ColourErrors errors = standard.flat_lightness ? c.after_flat : c.after;
    double neutral = c.neutral_error;
    for (const ColourCorrection::OfPhoto& photo : c.of_photos) {
        const ColourErrors& here = standard.flat_lightness ? photo.after_flat : photo.after;
        if (!(here.mean >= 0)) continue;  // its light is not known
        errors.mean = std::max(errors.mean, here.mean);
        errors.maximum = std::max(errors.maximum, here.maximum);
        errors.percentile_90 = std::max(errors.percentile_90, here.percentile_90);
        neutral = std::max(neutral, photo.neutral_error);
    }
    std::vector<ToleranceCheck> checks;
    const auto add = [&](const char* quantity, double limit, double value) {
        if (limit != kNone) checks.push_back({quantity, limit, value, standard.inclusive});
    };
    add("neutral", level.neutral, neutral);
    add("mean", level.mean, errors.mean);
    add("maximum", level.maximum, errors.maximum);
    add("90th percentile", level.percentile_90, errors.percentile_90);
    return checks;
}

bool all_kept(const std::vector<ToleranceCheck>& checks) {
    return std::all_of(checks.begin(), checks.end(), [](const auto& check) { return check.kept(); });
}

json json_of(const std::vector<ToleranceCheck>& checks) {
    json list = json::array();
    for (const ToleranceCheck& c : checks)
        list.push_back(
            {{"quantity", c.quantity}, {"limit", c.limit}, {"value", c.value}, {"kept", c.kept()}});
    return list;
}

}  // namespace

std::vector<ToleranceResult> judge_colours(const ColourCorrection& correction) {
    std::vector<ToleranceResult> results;
    for (const Standard& standard : standards()) {
        ToleranceResult result{standard.name, standard.source, {}, {}, {}, {}};
        for (const Level& level : standard.levels) {
            std::vector<ToleranceCheck> checks = checks_of(standard, level, correction);
            if (all_kept(checks)) {
                result.level = level.name;
                result.checks = std::move(checks);
                break;
            }
            result.next_level = level.name;
            result.missed = std::move(checks);
        }
        if (result.level.empty()) result.checks = result.missed;
        results.push_back(std::move(result));
    }
    return results;
}

json to_json(const std::vector<ToleranceResult>& results) {
    json list = json::array();
    for (const ToleranceResult& r : results)
        list.push_back({{"standard", r.standard},
                        {"source", r.source},
                        {"level", r.level.empty() ? json(nullptr) : json(r.level)},
                        {"checks", json_of(r.checks)},
                        {"next_level", r.next_level.empty() ? json(nullptr) : json(r.next_level)},
                        {"missed", json_of(r.missed)}});
    return list;
}

}  // namespace tangi
