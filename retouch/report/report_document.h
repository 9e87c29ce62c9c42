// report_document.h: the content of a report, once, and how it becomes a web page or a PDF.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "retouch/mask/mask.h"
#include "surface/report/html_report.h"

namespace tangi {

// Texts are plain UTF-8.
struct ReportHeading {
    std::string text;
};
struct ReportText {
    std::string text;
    bool soft = false;  // an explanation: smaller and paler
};
struct ReportTable {
    std::vector<std::string> head;               // may be empty
    std::vector<std::vector<std::string>> rows;  // as many cells as `widths`
    std::vector<double> widths;                  // of the columns, relative
    std::vector<Rgb> keys{};                     // sRGB-encoded, shown before each row; may be empty
};
struct ReportPicture {
    Image<Rgb> picture;  // sRGB-encoded, 0..1
    std::string caption;
};
// Side by side, of one width.
struct ReportPictures {
    std::vector<ReportPicture> pictures;
};
// Directions of illuminants, seen from the camera.
struct ReportLights {
    std::vector<HemisphereLight> lights;
    std::string caption;
};
// Something of a known size, printed at it: at 1:1 where that fits on the page, else at 1:2, 1:5, 1:10, …,
// with its scale and a scale bar. In a PDF on a page of its own; a web page has no size and leaves it out.
struct ReportPlan {
    Image<Rgb> picture;             // sRGB-encoded, over the whole area; or empty, and
    std::vector<Polygon> outlines;  // in mm from the top left corner, even-odd: white on black
    double width_mm = 0, height_mm = 0;
    bool scale_known = true;  // else it fills the width of a page, and no scale or bar is told
    std::string caption;
};
using ReportBlock =
    std::variant<ReportHeading, ReportText, ReportTable, ReportPictures, ReportLights, ReportPlan>;

struct ReportDocument {
    std::string title;
    std::vector<ReportBlock> blocks;
};

// One page without scripts or network; its style sheet prints it on A4. `scratch` is beside which file
// pictures may be written for a moment.
std::string html_of(const ReportDocument& document, const std::filesystem::path& scratch);

// A4 pages with their numbers, the headings as bookmarks, text as text, in the fonts of the system that have
// its letters; pictures as JPEG, as they are: about 300 dots an inch where report_picture_px() made them.
// Throws Error naming the file where it can't be written, or where there is no font at all.
void write_pdf(const std::filesystem::path& path, const ReportDocument& document);
// A plan alone, at 1:1, on a page as large as it needs, with its caption and scale bar.
void write_pdf(const std::filesystem::path& path, const ReportPlan& plan);

// How many pixels across a picture wants, of `side_by_side`, for 300 dots an inch.
int report_picture_px(int side_by_side);

}  // namespace tangi
