// result_summary.h: what a person at a terminal is told after a result's JSON, which is too long to be read
// there.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tangi {

// "1 photograph", "2 photographs"
inline std::string counted(std::size_t count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

// Whether the result is poor, and how many warnings came with it. The reasons themselves are told as warnings
// before, since they are where nobody is at a terminal, too.
inline std::string verdict_in_words(const nlohmann::json& result) {
    const std::size_t poor = result.at("poor").size(), warnings = result.at("warnings").size();
    std::string text = poor == 0   ? "good"
                       : poor == 1 ? "poor, for the reason above"
                                   : fmt::format("poor, for the {} reasons above", poor);
    if (warnings > 0)
        text += fmt::format(", with {} (\"warnings\" in the result)", counted(warnings, "warning"));
    return text;
}

// Lines of a result of `fit`: what was made of what, how good it is, and what comes next.
inline std::vector<std::string> fit_in_words(const nlohmann::json& result) {
    const nlohmann::json& photos = result.at("photographs");
    std::string aside;
    for (const auto& [count, why] : {std::pair(photos.at("held_out").get<std::size_t>(), "more held out"),
                                     std::pair(photos.at("rejected").size(), "rejected")})
        if (count > 0) aside += fmt::format("{}{} {}", aside.empty() ? " (" : ", ", count, why);
    const auto painting = result.at("painting").get<std::string>();
    const double seconds = result.at("seconds").get<double>();
    return {fmt::format("{}: {} × {} pixels{}, from {}{}{}, in {:.{}f} s", painting,
                        result.at("width").get<int>(), result.at("height").get<int>(),
                        result.at("scale_known").get<bool>()
                            ? fmt::format(" of {:.3g} mm", result.at("mm_per_pixel").get<double>())
                            : ", scale unknown",
                        counted(photos.at("fitted").get<std::size_t>(), "photograph"), aside,
                        aside.empty() ? "" : ")", seconds, seconds < 10 ? 1 : 0),
            fmt::format("median confidence {:.2f}: {}", result.at("median_confidence").get<double>(),
                        verdict_in_words(result)),
            fmt::format("next: tangipaint compare {} PHOTOS --out report", painting)};
}

// Lines of a result of `compare`: how near the relit pictures come, and where to look.
inline std::vector<std::string> compare_in_words(const nlohmann::json& result) {
    std::vector<std::string> lines;
    const nlohmann::json& means = result.at("mean");
    for (const auto& [group, name] : {std::pair("held_out", "held out"), std::pair("fitted", "fitted")}) {
        const nlohmann::json& mean = means.at(group);
        const auto count = mean.at("count").get<std::size_t>();
        if (count > 0)
            lines.push_back(fmt::format("{}: {}, {:.1f} dB PSNR, SSIM {:.3f}, ΔE2000 {:.1f} on average", name,
                                        counted(count, "photograph"), mean.at("psnr_db").get<double>(),
                                        mean.at("ssim").get<double>(),
                                        mean.at("delta_e_2000").get<double>()));
    }
    if (!result.at("poor").empty() || !result.at("warnings").empty())
        lines.push_back("the result is " + verdict_in_words(result));
    lines.push_back("look at " + result.at("page").get<std::string>());
    return lines;
}

}  // namespace tangi
