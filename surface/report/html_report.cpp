#include "surface/report/html_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/base/error.h"
#include "surface/base/html_escape.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/base64.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace {

constexpr const char* kStyle =
    R"(:root{color-scheme:light dark;--paper:#f6f5f2;--card:#fff;--ink:#22211f;--soft:#65625c;
--line:#dcd9d2;--accent:#0b6b6b;--ring:#c2410c}@media(prefers-color-scheme:dark){:root{--paper:#191918;--card:#232322;
--ink:#eceae5;--soft:#a5a29a;--line:#3a3936;--accent:#6fc7c3;--ring:#fb923c}}*{box-sizing:border-box}body{margin:0;
background:var(--paper);color:var(--ink);font:15px/1.5 system-ui,"Segoe UI",Roboto,sans-serif}main{max-width:1180px;
margin:0 auto;padding:28px}h1{font-size:26px;margin:0 0 4px}h2{font-size:18px;margin:32px 0 10px}.soft{color:var(--soft)}
.row{display:flex;flex-wrap:wrap;gap:18px}.card{background:var(--card);border:1px solid var(--line);border-radius:10px;
padding:16px}figure{margin:0}figcaption{font-size:13px;color:var(--soft);max-width:360px}.notes{border-left:3px solid
var(--ring);padding:2px 0 2px 30px}.notes li{margin:2px 0}.wide{overflow-x:auto}table{border-collapse:collapse;
font-variant-numeric:tabular-nums}th,td{text-align:right;padding:4px 12px;border-bottom:1px solid var(--line);white-space:nowrap}
th:first-child,td:first-child{text-align:left}td.why{text-align:left;white-space:normal;color:var(--ring)}th{font-size:13px;
color:var(--soft);font-weight:600}svg text{fill:var(--ink);font-size:11px})";

std::string begin_of_page(const std::string& title) {
    return fmt::format(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\"><title>{}</title>",
        escaped(title));
}

}  // namespace

std::string page_head(const std::string& title) {
    return fmt::format(
        "{0}<meta name=\"generator\" content=\"{1}\"><style>{2}</style></head><body><main><h1>{3}</h1>",
        begin_of_page(title), program_name(), kStyle, escaped(title));
}

bool begins_as_page(std::string_view text, const std::string& title) {
    return text.starts_with(begin_of_page(title));
}

std::string hemisphere(const std::vector<HemisphereLight>& lights) {
    constexpr double middle = 190, radius = 165;
    std::string svg =
        "<svg width=\"380\" height=\"380\" viewBox=\"0 0 380 380\" role=\"img\" aria-label=\"directions of "
        "the lights\">";
    for (const int elevation : {0, 30, 60}) {
        const double r = radius * std::cos(elevation * std::numbers::pi / 180);
        svg += fmt::format(
            "<circle cx=\"{0}\" cy=\"{0}\" r=\"{1:.1f}\" fill=\"none\" stroke=\"var(--line)\"/>"
            "<text x=\"{0}\" y=\"{2:.1f}\" text-anchor=\"middle\" opacity=\".6\">{3}°</text>",
            middle, r, middle + r + 12, elevation);
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const HemisphereLight& light = lights[i];
        if (!light.direction) continue;
        const double x = middle + radius * light.direction->x, y = middle - radius * light.direction->y;
        const double error = std::max(1.0, radius * light.sigma_deg * std::numbers::pi / 180);
        if (light.listed)
            svg += fmt::format(
                "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"var(--ring)\"/>"
                "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"none\" stroke=\"var(--ring)\"/>",
                middle + radius * light.listed->x, middle - radius * light.listed->y, x, y,
                middle + radius * light.listed->x, middle - radius * light.listed->y);
        svg += fmt::format(
            "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2:.1f}\" fill=\"var(--accent)\" opacity=\"{9:.2f}\"/>"
            "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"2.5\" {10}><title>{3}: elevation {4:.1f}°"
            "{5}{11}</title></circle><text x=\"{6:.1f}\" y=\"{7:.1f}\">{8}</text>",
            x, y, error, escaped(light.name), std::asin(light.direction->z) * 180 / std::numbers::pi,
            light.sigma_deg > 0 ? plus_minus(light.sigma_deg, 2) + "°" : "", x + 5, y - 4, i + 1,
            0.25 * std::min(1.0, 8 / error),  // large ones hide the rest
            light.held_out ? "fill=\"var(--card)\" stroke=\"var(--accent)\"" : "fill=\"var(--accent)\"",
            light.held_out ? ", held out" : "");
    }
    return svg + "</svg>";
}

std::string with_error(double value, double sigma) {
    // As many digits as the error has two of.
    const int digits = sigma > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9) : 4;
    return fmt::format("{:.{}f} ± {:.{}f}", value, digits, sigma, digits);
}

std::string plus_minus(double sigma, int digits) {
    if (!(sigma > 0)) return {};
    const int needed = static_cast<int>(std::ceil(-std::log10(sigma)));
    return fmt::format(" ± {:.{}f}", sigma, std::clamp(needed, digits, 12));
}

std::string picture_url(const Image<Rgb>& picture, const std::filesystem::path& scratch) {
    const AtomicFile file(scratch.parent_path() / "page-picture.jpg");  // never committed: it vanishes
    // Nobody asked for a file of that name.
    told_of(file.temporary(), scratch, [&] { write_picture_8bit(file.temporary(), picture); });
    return "data:image/jpeg;base64," + base64(read_text_file(file.temporary()));
}

}  // namespace tangi
