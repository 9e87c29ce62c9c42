// report_pdf.cpp: a report as a PDF, laid out on A4.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "retouch/report/pdf_file.h"
#include "retouch/report/report_document.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kPageWidth_mm = 210, kPageHeight_mm = 297, kMargin_mm = 18;
constexpr double kWidth_mm = kPageWidth_mm - 2 * kMargin_mm, kBottom_mm = kPageHeight_mm - kMargin_mm - 4;
constexpr double kGap_mm = 3, kCell_mm = 1.5, kKey_mm = 4;
constexpr double kPicture_dpi = 300, kCoarsest_dpi = 100;  // small pictures stay small
constexpr double kHeading_pt = 13, kText_pt = 9.5, kSmall_pt = 8, kTable_pt = 7.5;

std::string jpeg_of(const Image<Rgb>& picture, const fs::path& beside) {
    const AtomicFile file(beside.parent_path() / "report-picture.jpg");  // never committed: it vanishes
    told_of(file.temporary(), beside, [&] { write_picture_8bit(file.temporary(), picture); });
    return read_text_file(file.temporary());
}

// A length that is round, and 15 to 50 mm long on paper.
double scale_bar_mm(double denominator) {
    double length = 1;
    for (const double next : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0})
        if (length / denominator < 15) length = next;
    return length;
}

// Where a plan goes on a page [mm], at 1:denominator.
struct PlanPlace {
    double x_mm, y_mm, denominator;
};

// A plan with its scale bar below; gives the height. Its picture only `for_real`.
double draw_plan(Pdf& pdf, const ReportPlan& plan, const fs::path& beside, const PlanPlace& place,
                 bool for_real) {
    const auto& [x_mm, y_mm, denominator] = place;
    const double width = plan.width_mm / denominator, height = plan.height_mm / denominator;
    if (plan.picture.empty()) {
        pdf.rectangle(x_mm, y_mm, width, height, 0);
        pdf.polygons(plan.outlines, x_mm, y_mm, 1 / denominator, 1);
    } else if (for_real) {
        pdf.picture(plan.picture.width(), plan.picture.height(), jpeg_of(plan.picture, beside), x_mm, y_mm,
                    width);
    }
    pdf.frame(x_mm, y_mm, width, height, 0.1, kLine);  // so that the edge of a white picture can be cut along
    if (!plan.scale_known) return height;
    const double bar = scale_bar_mm(denominator), paper = bar / denominator, top = y_mm + height + 3;
    for (int part = 0; part < 4; ++part)
        pdf.rectangle(x_mm + part * paper / 4, top, paper / 4, 1.5, part % 2 == 0 ? 0 : 0.75);
    return height + 3 + 1.5 + 1 +
           pdf.write(fmt::format("{:.4g} mm on the painting", bar), x_mm, top + 2.5, 60, kSmall_pt);
}

std::string in_words(const ReportPlan& plan, double denominator) {
    if (!plan.scale_known) return plan.caption + ". Not at scale: the painting's is unknown.";
    return fmt::format("{}. Scale 1:{:.4g}; the whole is {:.1f} × {:.1f} mm. Print without scaling (100 %).",
                       plan.caption, denominator, plan.width_mm, plan.height_mm);
}

// The scale 1:n at which a plan goes on a page.
double denominator_within(const ReportPlan& plan, double width_mm, double height_mm) {
    double denominator = 1;
    for (const double next : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0})
        if (plan.width_mm / denominator > width_mm || plan.height_mm / denominator > height_mm)
            denominator = next;
    return denominator;
}

double fitting(const ReportPlan& plan) {
    constexpr double high_mm = kBottom_mm - kMargin_mm - 25;
    if (!plan.scale_known) return std::max(plan.width_mm / kWidth_mm, plan.height_mm / high_mm);
    return denominator_within(plan, kWidth_mm, high_mm);
}

// Lays blocks on pages. Done twice, since each page tells how many there are: the first time without
// pictures.
class Sheets {
public:
    Sheets(const ReportDocument& document, const fs::path& path, int pages)
        : pdf_(kPageWidth_mm, kPageHeight_mm, document.title),
          document_(document),
          path_(path),
          pages_(pages) {
        y_ += pdf_.write(document.title, kMargin_mm, y_, kWidth_mm, 18) + 2;
        for (std::size_t i = 0; i < document.blocks.size(); ++i) {
            next_ = i + 1 < document.blocks.size() ? &document.blocks[i + 1] : nullptr;
            std::visit([&](const auto& b) { lay(b); }, document.blocks[i]);
        }
        end_page();
    }
    int pages() const { return page_ - 1; }
    std::string finish() { return pdf_.finish(); }

private:
    void end_page() {
        const double y = kPageHeight_mm - kMargin_mm + 2;
        pdf_.write(document_.title, kMargin_mm, y, kWidth_mm - 30, kSmall_pt, kSoft);
        const std::string number = fmt::format("page {} of {}", page_, pages_);
        const PdfLayout laid = pdf_.layout(number, kSmall_pt, 30, false, true);
        for (const PdfLine& line : lines_of(laid.get()))
            pdf_.draw(line, kPageWidth_mm - kMargin_mm - width_mm_of(laid.get()), y + line.baseline_mm,
                      kSoft);
        pdf_.end_page();
        ++page_;
        y_ = kMargin_mm;
    }
    void need(double height_mm) {
        if (y_ + height_mm > kBottom_mm && y_ > kMargin_mm) end_page();
    }

    // A heading stands with what it is about.
    void lay(const ReportHeading& h) {
        const auto* pictures = next_ ? std::get_if<ReportPictures>(next_) : nullptr;
        need(pictures ? 14 + size_of(*pictures).height_mm() : 45);
        if (y_ > kMargin_mm) y_ += 5;
        pdf_.bookmark(h.text, page_);
        const PdfLayout laid = pdf_.layout(h.text, kHeading_pt, kWidth_mm, true);
        for (const PdfLine& line : lines_of(laid.get())) pdf_.draw(line, kMargin_mm, y_ + line.baseline_mm);
        y_ += lines_of(laid.get()).back().bottom_mm + 2;
    }
    void lay(const ReportText& t) {
        const PdfLayout laid = pdf_.layout(t.text, t.soft ? kSmall_pt : kText_pt, kWidth_mm);
        for (const PdfLine& line : lines_of(laid.get())) {
            need(line.bottom_mm - line.top_mm);
            pdf_.draw(line, kMargin_mm, y_ + line.baseline_mm - line.top_mm, t.soft ? kSoft : kInk);
            y_ += line.bottom_mm - line.top_mm;
        }
        y_ += 2;
    }

    // A cell of a row, and which of its lines comes next.
    struct Cell {
        PdfLayout layout;
        std::vector<PdfLine> lines;
        double x_mm;
        std::size_t next = 0;
        double left_mm() const {
            return next < lines.size() ? lines.back().bottom_mm - lines[next].top_mm : 0;
        }
    };
    using Row = std::vector<Cell>;

    Row row_of(const ReportTable& t, const std::vector<std::string>& cells, bool head) {
        TP_REQUIRE(cells.size() == t.widths.size(), "a table has as many cells in a row as columns");
        double sum = 0;
        for (const double w : t.widths) sum += w;
        Row row;
        double x = kMargin_mm;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const double width = kWidth_mm * t.widths[i] / sum;
            const double after = i == 0 && !t.keys.empty() ? kKey_mm + 1.5 : 0;
            PdfLayout laid = pdf_.layout(cells[i], kTable_pt, width - kCell_mm - after, head);
            std::vector<PdfLine> lines = lines_of(laid.get());
            row.push_back({std::move(laid), std::move(lines), x + after});
            x += width;
        }
        return row;
    }
    static double left_mm(const Row& row) {
        double most = 0;
        for (const Cell& cell : row) most = std::max(most, cell.left_mm());
        return most;
    }

    // As many lines of each cell as this page has room for; false where it has none.
    bool draw_lines(Row& row, bool head) {
        double used = 0;
        bool any = false;
        for (Cell& cell : row) {
            const std::size_t first = cell.next;
            while (cell.next < cell.lines.size()) {
                const PdfLine& line = cell.lines[cell.next];
                const double from = cell.lines[first].top_mm;
                if (y_ + line.bottom_mm - from + 1 > kBottom_mm) break;
                pdf_.draw(line, cell.x_mm, y_ + 0.5 + line.baseline_mm - from, head ? kSoft : kInk);
                used = std::max(used, line.bottom_mm - from);
                ++cell.next;
                any = true;
            }
        }
        y_ += used + 1;
        return any;
    }

    // Rows that fit on a page stay whole; longer ones go on on the next.
    void lay_row(const ReportTable& t, const std::vector<std::string>& cells, bool head,
                 const Rgb* key = nullptr) {
        Row row = row_of(t, cells, head);
        const auto next_page = [&] {
            end_page();
            if (!head && !t.head.empty()) lay_row(t, t.head, true);
        };
        if (y_ + left_mm(row) + 1 > kBottom_mm && left_mm(row) < kBottom_mm - kMargin_mm - 20) next_page();
        if (key) pdf_.patch(kMargin_mm, y_ + 0.9, kKey_mm, 2.2, *key);
        for (;;) {
            const bool any = draw_lines(row, head);
            if (!(left_mm(row) > 0)) break;
            TP_REQUIRE(any || y_ > kMargin_mm + 20, "a line of text fits on a page");
            next_page();
        }
        pdf_.rectangle(kMargin_mm, y_, kWidth_mm, 0.1, kLine);
        y_ += 0.3;
    }
    void lay(const ReportTable& t) {
        need(16);
        if (!t.head.empty()) lay_row(t, t.head, true);
        for (std::size_t i = 0; i < t.rows.size(); ++i)
            lay_row(t, t.rows[i], false, i < t.keys.size() ? &t.keys[i] : nullptr);
        y_ += 3;
    }

    // [mm] of a row of pictures and their captions.
    struct Size {
        double width = 0, tallest = 0, captions = 0;
        double height_mm() const { return tallest + captions + 4; }
    };
    Size size_of(const ReportPictures& p) {
        const auto n = static_cast<double>(p.pictures.size());
        Size size{(kWidth_mm - (n - 1) * kGap_mm) / n, 0, 0};
        for (const auto& [picture, caption] : p.pictures) {
            size.width = std::min(size.width, picture.width() / kCoarsest_dpi * 25.4);
            size.width = std::min(size.width, 175.0 * picture.width() / picture.height());
        }
        for (const auto& [picture, caption] : p.pictures) {
            size.tallest = std::max(size.tallest, size.width * picture.height() / picture.width());
            const PdfLayout laid = pdf_.layout(caption, kSmall_pt, size.width);
            size.captions = std::max(size.captions, lines_of(laid.get()).back().bottom_mm);
        }
        return size;
    }
    void lay(const ReportPictures& p) {
        if (p.pictures.empty()) return;
        const Size size = size_of(p);
        need(size.height_mm() - 1);
        double x = kMargin_mm;
        for (const auto& [picture, caption] : p.pictures) {
            if (pages_ > 0)
                pdf_.picture(picture.width(), picture.height(), jpeg_of(picture, path_), x, y_, size.width);
            pdf_.write(caption, x, y_ + size.tallest + 1, size.width, kSmall_pt, kSoft);
            x += size.width + kGap_mm;
        }
        y_ += size.height_mm();
    }

    void lay(const ReportLights& l) {
        constexpr double radius = 28;
        need(2 * radius + 16);
        const double cx = kMargin_mm + radius + 6, cy = y_ + radius + 2;
        for (const int elevation : {0, 30, 60}) {
            const double r = radius * std::cos(elevation * std::numbers::pi / 180);
            pdf_.circle(cx, cy, r, 0.15, kLine);
            pdf_.write(fmt::format("{}°", elevation), cx - 1.5, cy + r, 10, 6, kSoft);
        }
        for (std::size_t i = 0; i < l.lights.size(); ++i) {
            const auto& direction = l.lights[i].direction;
            if (!direction) continue;
            const double x = cx + radius * direction->x, y = cy - radius * direction->y;
            if (l.lights[i].held_out)
                pdf_.circle(x, y, 0.5, 0.2, kInk);
            else
                pdf_.disc(x, y, 0.5, kInk);
            pdf_.write(std::to_string(i + 1), x + 0.6, y - 2.4, 8, 5, kSoft);
        }
        y_ += 2 * radius + 6;
        y_ += pdf_.write(l.caption, kMargin_mm, y_, kWidth_mm, kSmall_pt, kSoft) + 3;
    }

    void lay(const ReportPlan& plan) {
        if (y_ > kMargin_mm) end_page();
        const double denominator = fitting(plan);
        y_ += pdf_.write(in_words(plan, denominator), kMargin_mm, y_, kWidth_mm, kText_pt) + 2;
        y_ += draw_plan(pdf_, plan, path_, {kMargin_mm, y_, denominator}, pages_ > 0) + 3;
    }

    Pdf pdf_;
    const ReportDocument& document_;
    const fs::path& path_;
    int pages_, page_ = 1;
    double y_ = kMargin_mm;
    const ReportBlock* next_ = nullptr;  // after the one that is laid
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
    // Pages of more than 14400 points (ISO 32000-1:2008, annex C) are not shown by every reader.
    constexpr double most = 14400 * 25.4 / 72 - 2 * margin - caption - bar;
    const double denominator = plan.scale_known ? denominator_within(plan, most, most) : fitting(plan);
    const double width = std::max(plan.width_mm / denominator, 100.0) + 2 * margin;
    Pdf pdf(width, plan.height_mm / denominator + 2 * margin + caption + bar, plan.caption);
    pdf.write(in_words(plan, denominator), margin, margin, width - 2 * margin, kSmall_pt);
    draw_plan(pdf, plan, path, {margin, margin + caption, denominator}, true);
    pdf.end_page();
    write_bytes(path, pdf.finish());
}

}  // namespace tangi
