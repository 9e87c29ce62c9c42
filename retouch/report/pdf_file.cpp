// pdf_file.cpp: drawing on the pages of a PDF, by Pango and Cairo.
#include "retouch/report/pdf_file.h"

#include <cairo-pdf.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <numbers>
#include <regex>
#include <set>

#include "retouch/treatment/treatment_log.h"
#include "surface/base/error.h"
#include "surface/base/memory_error.h"
#include "surface/file/version.h"

namespace tangi {

namespace {

cairo_status_t take(void* bytes, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

// Objects that are referred to and are not there: cairo (1.16) leaves a font out without a word where there
// was no memory for it, and the text with it.
bool lacks_objects(const std::string& pdf) {
    std::string outside;  // of streams
    for (std::size_t at = 0; at < pdf.size();) {
        const std::size_t begin = std::min(pdf.find("stream\n", at), pdf.size());
        outside.append(pdf, at, begin - at);
        at = std::min(pdf.find("endstream", begin), pdf.size());
        if (at < pdf.size()) at += std::string_view("endstream").size();
    }
    static const std::regex reference(R"(\([^)]*\)|(\d+) 0 (R|obj)\b)");
    std::set<std::string> there, meant;
    for (std::sregex_iterator it(outside.begin(), outside.end(), reference), end; it != end; ++it)
        if ((*it)[1].matched) ((*it)[2] == "R" ? meant : there).insert((*it)[1]);
    return !std::ranges::includes(there, meant);
}

}  // namespace

void DestroyPdf::operator()(cairo_t* drawing) const { cairo_destroy(drawing); }
void DestroyPdf::operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
void DestroyPdf::operator()(PangoLayout* layout) const { g_object_unref(layout); }

std::vector<PdfLine> lines_of(PangoLayout* layout) {
    constexpr double mm = kPoint_mm / PANGO_SCALE;
    std::vector<PdfLine> lines;
    PangoLayoutIter* at = pango_layout_get_iter(layout);
    do {
        PangoRectangle box;
        pango_layout_iter_get_line_extents(at, nullptr, &box);
        lines.push_back({pango_layout_iter_get_line_readonly(at), box.y * mm, (box.y + box.height) * mm,
                         pango_layout_iter_get_baseline(at) * mm});
    } while (pango_layout_iter_next_line(at));
    pango_layout_iter_free(at);
    return lines;
}

double width_mm_of(PangoLayout* layout) {
    int width = 0;
    pango_layout_get_size(layout, &width, nullptr);
    return width * kPoint_mm / PANGO_SCALE;
}

Pdf::Pdf(double width_mm, double height_mm, const std::string& title)
    : target_(
          cairo_pdf_surface_create_for_stream(take, &bytes_, width_mm / kPoint_mm, height_mm / kPoint_mm)),
      drawing_(cairo_create(target_.get())) {
    cairo_pdf_surface_set_metadata(target_.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
    cairo_pdf_surface_set_metadata(target_.get(), CAIRO_PDF_METADATA_CREATOR, program_name().c_str());
    cairo_pdf_surface_set_metadata(target_.get(), CAIRO_PDF_METADATA_CREATE_DATE, utc_now().c_str());
    cairo_scale(drawing_.get(), 1 / kPoint_mm, 1 / kPoint_mm);
}

void Pdf::ink(double grey) { cairo_set_source_rgb(drawing_.get(), grey, grey, grey); }
void Pdf::end_page() { cairo_show_page(drawing_.get()); }

void Pdf::bookmark(const std::string& text, int page) {
    cairo_pdf_surface_add_outline(target_.get(), CAIRO_PDF_OUTLINE_ROOT, text.c_str(),
                                  fmt::format("page={}", page).c_str(),
                                  static_cast<cairo_pdf_outline_flags_t>(0));
}

// Lengths of layouts are in points: the size of the page's own unit would be rounded.
PdfLayout Pdf::layout(const std::string& text, double size_pt, double width_mm, bool bold,
                      bool to_the_right) {
    PdfLayout layout(pango_cairo_create_layout(drawing_.get()));
    if (fonts_ < 0) {
        PangoFontFamily** families = nullptr;
        pango_font_map_list_families(pango_cairo_font_map_get_default(), &families, &fonts_);
        g_free(families);
    }
    if (fonts_ == 0)
        fail("a PDF needs a font, and there is none; install one: apt-get install fonts-dejavu-core");
    PangoFontDescription* font = pango_font_description_from_string("sans-serif");
    pango_font_description_set_absolute_size(font, size_pt * PANGO_SCALE);
    if (bold) pango_font_description_set_weight(font, PANGO_WEIGHT_BOLD);
    pango_layout_set_font_description(layout.get(), font);
    pango_font_description_free(font);
    PangoAttrList* attributes = pango_attr_list_new();  // a hash that is broken has no hyphens in it
    pango_attr_list_insert(attributes, pango_attr_insert_hyphens_new(FALSE));
    pango_layout_set_attributes(layout.get(), attributes);
    pango_attr_list_unref(attributes);
    pango_layout_set_wrap(layout.get(), PANGO_WRAP_WORD_CHAR);
    pango_layout_set_width(layout.get(), static_cast<int>(width_mm / kPoint_mm * PANGO_SCALE));
    pango_layout_set_text(layout.get(), text.data(), static_cast<int>(text.size()));
    if (to_the_right) pango_layout_set_alignment(layout.get(), PANGO_ALIGN_RIGHT);
    return layout;
}

void Pdf::draw(const PdfLine& line, double x_mm, double baseline_mm, double grey) {
    ink(grey);
    cairo_save(drawing_.get());
    cairo_translate(drawing_.get(), x_mm, baseline_mm);
    cairo_scale(drawing_.get(), kPoint_mm, kPoint_mm);
    cairo_move_to(drawing_.get(), 0, 0);
    pango_cairo_show_layout_line(drawing_.get(), line.line);
    cairo_restore(drawing_.get());
}

double Pdf::write(const std::string& text, double x_mm, double y_mm, double width_mm, double size_pt,
                  double grey) {
    const PdfLayout laid = layout(text, size_pt, width_mm);
    const std::vector<PdfLine> lines = lines_of(laid.get());
    for (const PdfLine& line : lines) draw(line, x_mm, y_mm + line.baseline_mm, grey);
    return lines.back().bottom_mm;
}

void Pdf::rectangle(double x_mm, double y_mm, double width_mm, double height_mm, double grey) {
    ink(grey);
    cairo_rectangle(drawing_.get(), x_mm, y_mm, width_mm, height_mm);
    cairo_fill(drawing_.get());
}

void Pdf::patch(double x_mm, double y_mm, double width_mm, double height_mm, const Rgb& srgb) {
    cairo_set_source_rgb(drawing_.get(), static_cast<double>(srgb.r), static_cast<double>(srgb.g),
                         static_cast<double>(srgb.b));
    cairo_rectangle(drawing_.get(), x_mm, y_mm, width_mm, height_mm);
    cairo_fill(drawing_.get());
}

void Pdf::frame(double x_mm, double y_mm, double width_mm, double height_mm, double line_mm, double grey) {
    ink(grey);
    cairo_set_line_width(drawing_.get(), line_mm);
    cairo_rectangle(drawing_.get(), x_mm, y_mm, width_mm, height_mm);
    cairo_stroke(drawing_.get());
}

void Pdf::circle(double x_mm, double y_mm, double radius_mm, double line_mm, double grey) {
    ink(grey);
    cairo_set_line_width(drawing_.get(), line_mm);
    cairo_new_sub_path(drawing_.get());
    cairo_arc(drawing_.get(), x_mm, y_mm, radius_mm, 0, 2 * std::numbers::pi);
    cairo_stroke(drawing_.get());
}

void Pdf::disc(double x_mm, double y_mm, double radius_mm, double grey) {
    ink(grey);
    cairo_new_sub_path(drawing_.get());
    cairo_arc(drawing_.get(), x_mm, y_mm, radius_mm, 0, 2 * std::numbers::pi);
    cairo_fill(drawing_.get());
}

void Pdf::polygons(const std::vector<Polygon>& outlines, double x_mm, double y_mm, double scale,
                   double grey) {
    ink(grey);
    cairo_save(drawing_.get());
    cairo_translate(drawing_.get(), x_mm, y_mm);
    cairo_scale(drawing_.get(), scale, scale);
    for (const Polygon& polygon : outlines) {
        cairo_new_sub_path(drawing_.get());
        for (const Corner& corner : polygon) cairo_line_to(drawing_.get(), corner.x, corner.y);
        cairo_close_path(drawing_.get());
    }
    cairo_set_fill_rule(drawing_.get(), CAIRO_FILL_RULE_EVEN_ODD);
    cairo_fill(drawing_.get());
    cairo_restore(drawing_.get());
}

void Pdf::picture(int width_px, int height_px, const std::string& jpeg, double x_mm, double y_mm,
                  double width_mm) {
    jpegs_.push_back(std::make_unique<std::string>(jpeg));
    const std::unique_ptr<cairo_surface_t, DestroyPdf> image(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px));
    cairo_surface_set_mime_data(image.get(), CAIRO_MIME_TYPE_JPEG,
                                reinterpret_cast<const unsigned char*>(jpegs_.back()->data()),
                                jpegs_.back()->size(), nullptr, nullptr);
    cairo_save(drawing_.get());
    cairo_translate(drawing_.get(), x_mm, y_mm);
    cairo_scale(drawing_.get(), width_mm / width_px, width_mm / width_px);
    cairo_set_source_surface(drawing_.get(), image.get(), 0, 0);
    cairo_paint(drawing_.get());
    cairo_restore(drawing_.get());
}

std::string Pdf::finish() {
    cairo_surface_finish(target_.get());
    const cairo_status_t status = cairo_surface_status(target_.get());
    const bool no_memory =
        status == CAIRO_STATUS_NO_MEMORY || (status == CAIRO_STATUS_SUCCESS && lacks_objects(bytes_));
    if (no_memory) fail("PDF: {}", kNoMemory);
    if (status != CAIRO_STATUS_SUCCESS) fail("PDF: {}", cairo_status_to_string(status));
    return std::move(bytes_);
}

}  // namespace tangi
