// pdf_file.h: pages of a PDF as they are drawn, by Pango and Cairo, whose headers stay in pdf_file.cpp; for
// sources of this module only.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "retouch/mask/mask.h"
#include "surface/image/colour.h"

// As their libraries declare them.
using cairo_t = struct _cairo;                    // NOLINT(bugprone-reserved-identifier)
using cairo_surface_t = struct _cairo_surface;    // NOLINT(bugprone-reserved-identifier)
using PangoLayout = struct _PangoLayout;          // NOLINT(bugprone-reserved-identifier)
using PangoLayoutLine = struct _PangoLayoutLine;  // NOLINT(bugprone-reserved-identifier)

namespace tangi {

constexpr double kPoint_mm = 25.4 / 72;
constexpr double kInk = 0, kSoft = 0.35, kLine = 0.75;  // greys

struct DestroyPdf {
    void operator()(cairo_t* drawing) const;
    void operator()(cairo_surface_t* surface) const;
    void operator()(PangoLayout* layout) const;
};
using PdfLayout = std::unique_ptr<PangoLayout, DestroyPdf>;

// A line of laid out text; heights in mm from the top of its layout.
struct PdfLine {
    PangoLayoutLine* line;
    double top_mm, bottom_mm, baseline_mm;
};
std::vector<PdfLine> lines_of(PangoLayout* layout);
double width_mm_of(PangoLayout* layout);

// A PDF in the making: mm from the top left corner of the page, drawn into memory.
class Pdf {
public:
    Pdf(double width_mm, double height_mm, const std::string& title);

    void end_page();
    void bookmark(const std::string& text, int page);

    // Text broken into lines of a width. Throws Error where the system has no font.
    PdfLayout layout(const std::string& text, double size_pt, double width_mm, bool bold = false,
                     bool to_the_right = false);
    void draw(const PdfLine& line, double x_mm, double baseline_mm, double grey = kInk);
    // All of a text; gives its height.
    double write(const std::string& text, double x_mm, double y_mm, double width_mm, double size_pt,
                 double grey = kInk);

    void rectangle(double x_mm, double y_mm, double width_mm, double height_mm, double grey);
    void patch(double x_mm, double y_mm, double width_mm, double height_mm, const Rgb& srgb);
    void frame(double x_mm, double y_mm, double width_mm, double height_mm, double line_mm, double grey);
    void circle(double x_mm, double y_mm, double radius_mm, double line_mm, double grey);
    void disc(double x_mm, double y_mm, double radius_mm, double grey);
    // Filled, even-odd; corners are scaled, then moved.
    void polygons(const std::vector<Polygon>& outlines, double x_mm, double y_mm, double scale, double grey);
    // The file of a JPEG goes into the PDF as it is: Cairo never looks at the pixels.
    void picture(int width_px, int height_px, const std::string& jpeg, double x_mm, double y_mm,
                 double width_mm);

    // The bytes; nothing can be drawn any more. Throws Error.
    std::string finish();

private:
    void ink(double grey);

    std::string bytes_;
    std::vector<std::unique_ptr<std::string>> jpegs_;  // until finish()
    std::unique_ptr<cairo_surface_t, DestroyPdf> target_;
    std::unique_ptr<cairo_t, DestroyPdf> drawing_;
    int fonts_ = -1;
};

}  // namespace tangi
