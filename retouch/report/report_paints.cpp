// report_paints.cpp: of a treatment's report: what layers are made of, in words.
#include <algorithm>

#include "retouch/report/report_content.h"

namespace tangi {

namespace {

// Of fills and varnishes, which are called by their numbers (fill.cpp): "fill, ρd 0.8 0.75 0.6".
std::string material_in_words(std::string name) {
    const auto put = [&](const std::string& from, const std::string& to) {
        if (const auto at = name.find(from); at != std::string::npos) name.replace(at, from.size(), to);
    };
    const bool fill = name.starts_with("fill ("), varnish = name.starts_with("varnish (");
    if ((!fill && !varnish) || !name.ends_with(')')) return name;
    name.pop_back();
    put(" (", fill ? ", ρd " : ", ");
    put("rho_s", "ρs");
    put("alpha", "α");
    if (fill)
        for (auto at = name.find(',', 5); at != std::string::npos; at = name.find(',', at)) name.erase(at, 1);
    return name;
}

}  // namespace

std::string paints_in_words(const std::map<std::string, double>& volumes_mm3, bool scale_known) {
    double all = 0;
    std::vector<std::pair<double, std::string>> paints;
    for (const auto& [name, mm3] : volumes_mm3) paints.emplace_back(mm3, name), all += mm3;
    std::sort(paints.rbegin(), paints.rend());
    std::string words;
    for (const auto& [mm3, name] : paints) {
        words += words.empty() ? "" : "; ";
        words += material_in_words(name);
        if (paints.size() > 1) words += fmt::format(" {:.3g} %", 100 * mm3 / all);
        if (scale_known) words += fmt::format(" ({:.3g} mm³)", mm3);
    }
    return words;
}

}  // namespace tangi
