// report_pdf_file.cpp: a report as a PDF, laid out on A4 by Pango and Cairo.
#include <cairo-pdf.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "paint/retouch/report_document.h"
#include "paint/retouch/treatment_log.h"
#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/picture_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kPoint_mm = 25.4 / 72;
constexpr double kPageWidth_mm = 210, kPageHeight_mm = 297, kMargin_mm = 18;
constexpr double kWidth_mm = kPageWidth_mm - 2 * kMargin_mm, kBottom_mm = kPageHeight_mm - kMargin_mm - 4;
constexpr double kGap_mm = 3, kCell_mm = 1.5;
constexpr double kPicture_dpi = 300, kCoarsest_dpi = 100;  // small pictures stay small
constexpr double kHeading_pt = 13, kText_pt = 9.5, kSmall_pt = 8, kTable_pt = 7.5;
constexpr double kInk = 0, kSoft = 0.35, kLine = 0.75;  // greys

template <auto destroy>
struct Destroy {
    template <class T>
    void operator()(T* object) const {
        destroy(object);
    }
};
using Drawing = std::unique_ptr<cairo_t, Destroy<cairo_destroy>>;
using Target = std::unique_ptr<cairo_surface_t, Destroy<cairo_surface_destroy>>;
using Layout = std::unique_ptr<PangoLayout, Destroy<g_object_unref>>;

cairo_status_t take(void* bytes, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

// A line of laid out text; heights in mm from the top of its layout.
struct Line {
    PangoLayoutLine* line;
    double top_mm, bottom_mm, baseline_mm;
};

std::vector<Line> lines_of(PangoLayout* layout) {
    constexpr double mm = kPoint_mm / PANGO_SCALE;
    std::vector<Line> lines;
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

// A PDF in the making: mm from the top left corner of the page, drawn into memory.
class Pdf {
public:
    Pdf(double width_mm, double height_mm, const std::string& title, const std::string& maker)
        : target_(cairo_pdf_surface_create_for_stream(take, &bytes_, width_mm / kPoint_mm,
                                                      height_mm / kPoint_mm)),
          drawing_(cairo_create(target_.get())) {
        cairo_pdf_surface_set_metadata(target_.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
        cairo_pdf_surface_set_metadata(target_.get(), CAIRO_PDF_METADATA_CREATOR, maker.c_str());
        cairo_pdf_surface_set_metadata(target_.get(), CAIRO_PDF_METADATA_CREATE_DATE, utc_now().c_str());
        cairo_scale(drawing_.get(), 1 / kPoint_mm, 1 / kPoint_mm);
    }

    cairo_t* operator*() const { return drawing_.get(); }
    void ink(double grey) { cairo_set_source_rgb(drawing_.get(), grey, grey, grey); }
    void end_page() { cairo_show_page(drawing_.get()); }
    void bookmark(const std::string& text, int page) {
        cairo_pdf_surface_add_outline(target_.get(), CAIRO_PDF_OUTLINE_ROOT, text.c_str(),
                                      fmt::format("page={}", page).c_str(),
                                      static_cast<cairo_pdf_outline_flags_t>(0));
    }

    // Text broken into lines of a width. Lengths of layouts are in points: the size of the page's own unit
    // would be rounded.
    Layout layout(const std::string& text, double size_pt, double width_mm, bool bold = false) {
        Layout layout(pango_cairo_create_layout(drawing_.get()));
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
        return layout;
    }
    void draw(const Line& line, double x_mm, double baseline_mm) {
        cairo_save(drawing_.get());
        cairo_translate(drawing_.get(), x_mm, baseline_mm);
        cairo_scale(drawing_.get(), kPoint_mm, kPoint_mm);
        cairo_move_to(drawing_.get(), 0, 0);
        pango_cairo_show_layout_line(drawing_.get(), line.line);
        cairo_restore(drawing_.get());
    }
    // All of a text; gives its height.
    double write(const std::string& text, double x_mm, double y_mm, double width_mm, double size_pt,
                 double grey = kInk) {
        ink(grey);
        const Layout laid = layout(text, size_pt, width_mm);
        const std::vector<Line> lines = lines_of(laid.get());
        for (const Line& line : lines) draw(line, x_mm, y_mm + line.baseline_mm);
        return lines.back().bottom_mm;
    }
    void rectangle(double x_mm, double y_mm, double width_mm, double height_mm, double grey) {
        ink(grey);
        cairo_rectangle(drawing_.get(), x_mm, y_mm, width_mm, height_mm);
        cairo_fill(drawing_.get());
    }
    // The file of a JPEG goes into the PDF as it is: Cairo never looks at the pixels.
    void picture(const Image<Rgb>& pixels, const std::string& jpeg, double x_mm, double y_mm,
                 double width_mm) {
        jpegs_.push_back(std::make_unique<std::string>(jpeg));
        const Target image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, pixels.width(), pixels.height()));
        cairo_surface_set_mime_data(image.get(), CAIRO_MIME_TYPE_JPEG,
                                    reinterpret_cast<const unsigned char*>(jpegs_.back()->data()),
                                    jpegs_.back()->size(), nullptr, nullptr);
        cairo_save(drawing_.get());
        cairo_translate(drawing_.get(), x_mm, y_mm);
        cairo_scale(drawing_.get(), width_mm / pixels.width(), width_mm / pixels.width());
        cairo_set_source_surface(drawing_.get(), image.get(), 0, 0);
        cairo_paint(drawing_.get());
        cairo_restore(drawing_.get());
    }
    std::string finish() {
        cairo_surface_finish(target_.get());
        const cairo_status_t status = cairo_surface_status(target_.get());
        if (status != CAIRO_STATUS_SUCCESS) fail("PDF: {}", cairo_status_to_string(status));
        return std::move(bytes_);
    }

private:
    std::string bytes_;
    std::vector<std::unique_ptr<std::string>> jpegs_;  // until finish()
    Target target_;
    Drawing drawing_;
    int fonts_ = -1;
};

std::string jpeg_of(const Image<Rgb>& picture, const fs::path& beside) {
    const AtomicFile file(beside.parent_path() / "report-picture.jpg");  // never committed: it vanishes
    write_picture_8bit(file.temporary(), picture);
    return read_text_file(file.temporary());
}

// A length that is round, and 15 to 50 mm long on paper.
double scale_bar_mm(double denominator) {
    double length = 1;
    for (const double next : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0})
        if (length / denominator < 15) length = next;
    return length;
}

// A plan at 1:denominator with its scale bar below; gives the height.
double draw_plan(Pdf& pdf, const ReportPlan& plan, const fs::path& beside, double x_mm, double y_mm,
                 double denominator, bool for_real) {
    const double width = plan.width_mm / denominator, height = plan.height_mm / denominator;
    if (plan.picture.empty()) {
        pdf.rectangle(x_mm, y_mm, width, height, 0);
        pdf.ink(1);
        cairo_save(*pdf);
        cairo_translate(*pdf, x_mm, y_mm);
        cairo_scale(*pdf, 1 / denominator, 1 / denominator);
        for (const Polygon& polygon : plan.outlines) {
            cairo_new_sub_path(*pdf);
            for (const Corner& corner : polygon) cairo_line_to(*pdf, corner.x, corner.y);
            cairo_close_path(*pdf);
        }
        cairo_set_fill_rule(*pdf, CAIRO_FILL_RULE_EVEN_ODD);
        cairo_fill(*pdf);
        cairo_restore(*pdf);
    } else if (for_real) {
        pdf.picture(plan.picture, jpeg_of(plan.picture, beside), x_mm, y_mm, width);
    }
    pdf.ink(kLine);  // so that the edge of a white picture can be cut along
    cairo_set_line_width(*pdf, 0.1);
    cairo_rectangle(*pdf, x_mm, y_mm, width, height);
    cairo_stroke(*pdf);
    const double bar = scale_bar_mm(denominator), paper = bar / denominator, top = y_mm + height + 3;
    for (int part = 0; part < 4; ++part)
        pdf.rectangle(x_mm + part * paper / 4, top, paper / 4, 1.5, part % 2 == 0 ? 0 : 0.75);
    return height + 3 + 1.5 + 1 +
           pdf.write(fmt::format("{:.4g} mm on the painting", bar), x_mm, top + 2.5, 60, kSmall_pt);
}

std::string in_words(const ReportPlan& plan, double denominator) {
    return fmt::format("{}. Scale 1:{:.4g}; the whole is {:.1f} × {:.1f} mm. Print without scaling (100 %).",
                       plan.caption, denominator, plan.width_mm, plan.height_mm);
}

// Lays blocks on pages. Done twice, since each page tells how many there are: the first time without
// pictures.
class Sheets {
public:
    Sheets(const ReportDocument& document, const fs::path& path, int pages)
        : pdf_(kPageWidth_mm, kPageHeight_mm, document.title, document.maker),
          document_(document),
          path_(path),
          pages_(pages) {
        y_ += pdf_.write(document.title, kMargin_mm, y_, kWidth_mm, 18) + 2;
        for (const ReportBlock& block : document.blocks) std::visit([&](const auto& b) { lay(b); }, block);
        end_page();
    }
    int pages() const { return page_ - 1; }
    std::string finish() { return pdf_.finish(); }

private:
    void end_page() {
        const double y = kPageHeight_mm - kMargin_mm + 2;
        pdf_.write(document_.title, kMargin_mm, y, kWidth_mm - 30, kSmall_pt, kSoft);
        const std::string number = fmt::format("page {} of {}", page_, pages_);
        pdf_.ink(kSoft);
        const Layout laid = pdf_.layout(number, kSmall_pt, 30);
        pango_layout_set_alignment(laid.get(), PANGO_ALIGN_RIGHT);
        int width = 0;
        pango_layout_get_size(laid.get(), &width, nullptr);
        for (const Line& line : lines_of(laid.get()))
            pdf_.draw(line, kPageWidth_mm - kMargin_mm - width * kPoint_mm / PANGO_SCALE,
                      y + line.baseline_mm);
        pdf_.end_page();
        ++page_;
        y_ = kMargin_mm;
    }
    void need(double height_mm) {
        if (y_ + height_mm > kBottom_mm && y_ > kMargin_mm) end_page();
    }

    void lay(const ReportHeading& h) {
        need(45);  // a heading stands with what it is about
        if (y_ > kMargin_mm) y_ += 5;
        pdf_.bookmark(h.text, page_);
        pdf_.ink(kInk);
        const Layout laid = pdf_.layout(h.text, kHeading_pt, kWidth_mm, true);
        for (const Line& line : lines_of(laid.get())) pdf_.draw(line, kMargin_mm, y_ + line.baseline_mm);
        y_ += lines_of(laid.get()).back().bottom_mm + 2;
    }
    void lay(const ReportText& t) {
        const Layout laid = pdf_.layout(t.text, t.soft ? kSmall_pt : kText_pt, kWidth_mm);
        for (const Line& line : lines_of(laid.get())) {
            need(line.bottom_mm - line.top_mm);
            pdf_.ink(t.soft ? kSoft : kInk);
            pdf_.draw(line, kMargin_mm, y_ + line.baseline_mm - line.top_mm);
            y_ += line.bottom_mm - line.top_mm;
        }
        y_ += 2;
    }

    // Rows that fit on a page stay whole; longer ones go on on the next.
    void lay_row(const ReportTable& t, const std::vector<std::string>& cells, bool head) {
        TP_REQUIRE(cells.size() == t.widths.size(), "a table has as many cells in a row as columns");
        double sum = 0;
        for (const double w : t.widths) sum += w;
        struct Cell {
            Layout layout;
            std::vector<Line> lines;
            double x_mm;
            std::size_t next = 0;
            double left_mm() const {
                return next < lines.size() ? lines.back().bottom_mm - lines[next].top_mm : 0;
            }
        };
        std::vector<Cell> row;
        double x = kMargin_mm;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const double width = kWidth_mm * t.widths[i] / sum;
            Layout laid = pdf_.layout(cells[i], kTable_pt, width - kCell_mm, head);
            std::vector<Line> lines = lines_of(laid.get());
            row.push_back({std::move(laid), std::move(lines), x});
            x += width;
        }
        const auto left = [&] {
            double most = 0;
            for (const Cell& cell : row) most = std::max(most, cell.left_mm());
            return most;
        };
        const auto next_page = [&] {
            end_page();
            if (!head && !t.head.empty()) lay_row(t, t.head, true);
        };
        if (y_ + left() + 1 > kBottom_mm && left() < kBottom_mm - kMargin_mm - 20) next_page();
        for (;;) {
            pdf_.ink(head ? kSoft : kInk);
            double used = 0;
            bool any = false;
            for (Cell& cell : row) {
                const std::size_t first = cell.next;
                while (cell.next < cell.lines.size()) {
                    const Line& line = cell.lines[cell.next];
                    const double from = cell.lines[first].top_mm;
                    if (y_ + line.bottom_mm - from + 1 > kBottom_mm) break;
                    pdf_.draw(line, cell.x_mm, y_ + 0.5 + line.baseline_mm - from);
                    used = std::max(used, line.bottom_mm - from);
                    ++cell.next;
                    any = true;
                }
            }
            y_ += used + 1;
            if (!(left() > 0)) break;
            TP_REQUIRE(any || y_ > kMargin_mm + 20, "a line of text fits on a page");
            next_page();
        }
        pdf_.rectangle(kMargin_mm, y_, kWidth_mm, 0.1, kLine);
        y_ += 0.3;
    }
    void lay(const ReportTable& t) {
        need(16);
        if (!t.head.empty()) lay_row(t, t.head, true);
        for (const auto& cells : t.rows) lay_row(t, cells, false);
        y_ += 3;
    }

    void lay(const ReportPictures& p) {
        if (p.pictures.empty()) return;
        const auto n = static_cast<double>(p.pictures.size());
        double width = (kWidth_mm - (n - 1) * kGap_mm) / n;
        for (const auto& [picture, caption] : p.pictures) {
            width = std::min(width, picture.width() / kCoarsest_dpi * 25.4);
            width = std::min(width, 175.0 * picture.width() / picture.height());
        }
        double tallest = 0, captions = 0;
        for (const auto& [picture, caption] : p.pictures) {
            tallest = std::max(tallest, width * picture.height() / picture.width());
            const Layout laid = pdf_.layout(caption, kSmall_pt, width);
            captions = std::max(captions, lines_of(laid.get()).back().bottom_mm);
        }
        need(tallest + captions + 3);
        double x = kMargin_mm;
        for (const auto& [picture, caption] : p.pictures) {
            if (pages_ > 0) pdf_.picture(picture, jpeg_of(picture, path_), x, y_, width);
            pdf_.write(caption, x, y_ + tallest + 1, width, kSmall_pt, kSoft);
            x += width + kGap_mm;
        }
        y_ += tallest + captions + 4;
    }

    void lay(const ReportLights& l) {
        constexpr double radius = 28;
        need(2 * radius + 16);
        const double cx = kMargin_mm + radius + 6, cy = y_ + radius + 2;
        cairo_set_line_width(*pdf_, 0.15);
        for (const int elevation : {0, 30, 60}) {
            const double r = radius * std::cos(elevation * std::numbers::pi / 180);
            pdf_.ink(kLine);
            cairo_new_sub_path(*pdf_);
            cairo_arc(*pdf_, cx, cy, r, 0, 2 * std::numbers::pi);
            cairo_stroke(*pdf_);
            pdf_.write(fmt::format("{}°", elevation), cx - 1.5, cy + r, 10, 6, kSoft);
        }
        for (std::size_t i = 0; i < l.lights.size(); ++i) {
            const auto& direction = l.lights[i].direction;
            if (!direction) continue;
            const double x = cx + radius * direction->x, y = cy - radius * direction->y;
            pdf_.ink(kInk);
            cairo_new_sub_path(*pdf_);
            cairo_arc(*pdf_, x, y, 0.5, 0, 2 * std::numbers::pi);
            cairo_fill(*pdf_);
            pdf_.write(std::to_string(i + 1), x + 0.6, y - 2.4, 8, 5, kSoft);
        }
        y_ += 2 * radius + 6;
        y_ += pdf_.write(l.caption, kMargin_mm, y_, kWidth_mm, kSmall_pt, kSoft) + 3;
    }

    void lay(const ReportPlan& plan) {
        if (y_ > kMargin_mm) end_page();
        double denominator = 1;
        for (const double next : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0})
            if (plan.width_mm / denominator > kWidth_mm ||
                plan.height_mm / denominator > kBottom_mm - kMargin_mm - 25)
                denominator = next;
        y_ += pdf_.write(in_words(plan, denominator), kMargin_mm, y_, kWidth_mm, kText_pt) + 2;
        y_ += draw_plan(pdf_, plan, path_, kMargin_mm, y_, denominator, pages_ > 0) + 3;
    }

    Pdf pdf_;
    const ReportDocument& document_;
    const fs::path& path_;
    int pages_, page_ = 1;
    double y_ = kMargin_mm;
};

void write_bytes(const fs::path& path, const std::string& bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace

int report_picture_px(int side_by_side) {
    const double width_mm = (kWidth_mm - (side_by_side - 1) * kGap_mm) / side_by_side;
    return static_cast<int>(std::ceil(width_mm / 25.4 * kPicture_dpi));
}

void write_pdf(const fs::path& path, const ReportDocument& document) {
    const int pages = Sheets(document, path, 0).pages();
    write_bytes(path, Sheets(document, path, pages).finish());
}

void write_pdf(const fs::path& path, const ReportPlan& plan) {
    constexpr double margin = 10, caption = 12, bar = 14;
    const double width = std::max(plan.width_mm, 100.0) + 2 * margin;
    Pdf pdf(width, plan.height_mm + 2 * margin + caption + bar, plan.caption, "tangipaint");
    pdf.write(in_words(plan, 1), margin, margin, width - 2 * margin, kSmall_pt);
    draw_plan(pdf, plan, path, margin, margin + caption, 1, true);
    pdf.end_page();
    write_bytes(path, pdf.finish());
}

}  // namespace tangi
