// report_page.cpp: a report as one web page.
#include <algorithm>
#include <cmath>

#include "retouch/report/report_document.h"
#include "surface/base/error.h"
#include "surface/base/html_escape.h"

namespace tangi {

namespace {

constexpr const char* kPrintStyle =
    "<style>@page{size:A4;margin:16mm}@media print{:root{--paper:#fff;--card:#fff;--ink:#000;--soft:#444;"
    "--line:#bbb}body{font-size:10pt}main{padding:0;max-width:none}h2{break-after:avoid}figure,tr{"
    "break-inside:avoid}.wide{overflow:visible}td{white-space:normal;overflow-wrap:anywhere}}figure img{"
    "max-width:100%;height:auto}td.text,th.text{text-align:left;"
    "white-space:normal;overflow-wrap:anywhere;vertical-align:top}table.laid{table-layout:fixed;width:100%;"
    "min-width:640px}</style>";

std::string row(const std::vector<std::string>& cells, const char* tag, const std::string& key = "") {
    std::string text = "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i)
        text += fmt::format("<{0} class=\"text\">{2}{1}</{0}>", tag, escaped(cells[i]), i == 0 ? key : "");
    return text + "</tr>";
}

// A patch of colour that is printed too.
std::string key_of(const Rgb& srgb) {
    const auto byte = [](float v) { return std::lround(255 * std::clamp(v, 0.0f, 1.0f)); };
    return fmt::format(
        "<span class=\"key\" style=\"background:rgb({},{},{});print-color-adjust:exact;"
        "-webkit-print-color-adjust:exact;display:inline-block;width:1em;height:.7em;margin-right:.5em\"></"
        "span>",
        byte(srgb.r), byte(srgb.g), byte(srgb.b));
}

struct Writer {
    const std::filesystem::path& scratch;

    std::string operator()(const ReportHeading& h) const { return "<h2>" + escaped(h.text) + "</h2>"; }
    std::string operator()(const ReportText& t) const {
        return (t.soft ? "<p class=\"soft\">" : "<p>") + escaped(t.text) + "</p>";
    }
    std::string operator()(const ReportTable& t) const {
        if (t.rows.empty()) return "";
        // Widths are the document's: left to itself a browser breaks the words of narrow columns letter by
        // letter.
        double all = 0;
        for (const double width : t.widths) all += width;
        std::string html =
            all > 0 ? "<div class=\"wide\"><table class=\"laid\"><colgroup>" : "<div class=\"wide\"><table>";
        for (const double width : t.widths)
            html += fmt::format("<col style=\"width:{:.1f}%\">", 100 * width / all);
        if (all > 0) html += "</colgroup>";
        if (!t.head.empty()) html += row(t.head, "th");
        for (std::size_t i = 0; i < t.rows.size(); ++i)
            html += row(t.rows[i], "td", i < t.keys.size() ? key_of(t.keys[i]) : "");
        return html + "</table></div>";
    }
    std::string operator()(const ReportPictures& p) const {
        const int columns = std::max(static_cast<int>(p.pictures.size()), 2), most = 1100 / columns;
        std::string html = fmt::format(
            "<div class=\"row\" style=\"display:grid;grid-template-columns:repeat({},minmax(0,1fr))\">",
            columns);
        for (const auto& [picture, caption] : p.pictures)
            html += fmt::format(
                "<figure class=\"card\"><img alt=\"{0}\" width=\"{1}\" src=\"{2}\"><figcaption>{0}"
                "</figcaption></figure>",
                escaped(caption), std::min(picture.width(), most), picture_url(picture, scratch));
        return html + "</div>";
    }
    std::string operator()(const ReportLights& l) const {
        return fmt::format(
            "<div class=\"row\"><figure class=\"card\">{}<figcaption>{}</figcaption></figure></div>",
            hemisphere(l.lights), escaped(l.caption));
    }
    std::string operator()(const ReportPlan&) const { return ""; }
};

}  // namespace

std::string html_of(const ReportDocument& document, const std::filesystem::path& scratch) {
    std::string page = page_head(document.title) + kPrintStyle;
    for (const ReportBlock& block : document.blocks) page += std::visit(Writer{scratch}, block);
    return page + "</main></body></html>\n";
}

}  // namespace tangi
