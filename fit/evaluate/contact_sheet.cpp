#include "fit/evaluate/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "surface/report/false_colour.h"

namespace tangi {

namespace {

constexpr Rgb kPaper(0.965f), kInk(0.12f), kSoft(0.42f), kRule(0.84f), kHeldOut(0.72f, 0.25f, 0.05f);

// Lays out cells of one width in three columns; every length follows from the width of the sheet.
class Sheet {
public:
    Sheet(int width, const Surface& surface) {
        margin_ = width / 50;
        gap_ = width / 90;
        text_ = std::max(7, width / 130);
        cell_ = (width - 2 * margin_ - 2 * gap_) / 3;
        picture_height_ = std::max(1, static_cast<int>(std::lround(static_cast<double>(cell_) *
                                                                   surface.height() / surface.width())));
        // Tall paintings would make the sheet endless: narrower pictures, centred in their cells.
        picture_height_ = std::min(picture_height_, cell_ * 5 / 4);
        picture_width_ = std::min(cell_, static_cast<int>(std::lround(static_cast<double>(picture_height_) *
                                                                      surface.width() / surface.height())));
        picture_width_ = std::max(picture_width_, 1);
        width_ = width;
        y_ = margin_;
    }

    int text() const { return text_; }
    int legend_height() const { return text_ * 10 / 3; }

    void line(const std::string& words, double size, const Rgb& ink) {
        const int height = static_cast<int>(text_ * size);
        room(y_ + 9 * height / 4);
        draw_text(picture_, words, margin_, y_, height, ink);
        y_ += 9 * height / 4;
    }

    void rule() {
        room(y_ + gap_ + 1);
        for (int x = margin_; x < width_ - margin_; ++x) picture_(x, y_) = kRule;
        y_ += gap_;
    }

    void space(int pixels) { room(y_ += pixels); }

    struct Cell {
        std::string title, note;  // above the picture; below it
        Image<Rgb> picture;
        std::optional<Image<Rgb>> legend;  // below the picture
    };

    // Up to three cells beside each other.
    void row(const std::vector<Cell>& cells) {
        const int top = y_ + 2 * text_, below = top + picture_height_ + text_ / 2;
        int bottom = below;
        for (const Cell& cell : cells) {
            int end = below;
            if (cell.legend) end += cell.legend->height() + text_ / 2;
            if (!cell.note.empty()) end += 2 * text_;
            bottom = std::max(bottom, end);
        }
        room(bottom + gap_);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const Cell& cell = cells[i];
            const int left = margin_ + static_cast<int>(i) * (cell_ + gap_);
            draw_text(picture_, cell.title, left, y_, text_, kInk);
            paste(resized(cell.picture, picture_width_, picture_height_), left + (cell_ - picture_width_) / 2,
                  top);
            if (cell.legend) paste(*cell.legend, left, below);
            draw_text(picture_, cell.note, left,
                      below + (cell.legend ? cell.legend->height() + text_ / 2 : 0), text_ * 4 / 5, kSoft);
        }
        y_ = bottom + gap_;
    }

    Image<Rgb> legend_for(ColourMap map, const ValueRange& range, const std::string& unit) const {
        return legend(map, range, unit, cell_, std::max(16, legend_height()), {kInk, kPaper});
    }

    Image<Rgb> finished() {
        room(y_ + margin_ - gap_);
        return std::move(picture_);
    }

private:
    // Makes the sheet at least this high.
    void room(int height) {
        if (height <= picture_.height()) return;
        Image<Rgb> taller(width_, height, kPaper);
        std::copy(picture_.pixels().begin(), picture_.pixels().end(), taller.pixels().begin());
        picture_ = std::move(taller);
    }

    void paste(const Image<Rgb>& what, int x0, int y0) {
        for (int y = 0; y < what.height(); ++y)
            for (int x = 0; x < what.width(); ++x) picture_(x0 + x, y0 + y) = what(x, y);
    }

    int width_, margin_, gap_, text_, cell_, picture_width_, picture_height_, y_;
    Image<Rgb> picture_;
};

void add_photo(Sheet& sheet, const ComparedPictures& pictures, const CompareOptions& options) {
    const PhotoComparison& p = pictures.result;
    sheet.rule();
    sheet.line(fmt::format("{}   {}", p.name, p.fitted ? "fitted" : "held out: the fit never saw it"), 1.15,
               p.fitted ? kInk : kHeldOut);
    const ValueRange percent{-100 * options.error_range, 100 * options.error_range};
    const Image<Rgb> error =
        map_picture(luma_difference(pictures.photo, pictures.relit), -options.error_range,
                    options.error_range, ColourMap::diverging, pictures.mask);
    sheet.row(
        {{fmt::format("Photograph, light {:.0f} deg up, from {:.0f} deg", p.elevation_deg, p.azimuth_deg), "",
          for_display(pictures.photo, pictures), std::nullopt},
         {fmt::format("Relit: PSNR {:.1f} dB, SSIM {:.3f}, dE2000 {:.1f}", p.psnr_db, p.ssim, p.delta_e_2000),
          "", for_display(pictures.relit, pictures), std::nullopt},
         {"Relit - photograph, brightness", "", error,
          sheet.legend_for(ColourMap::diverging, percent, "%")}});
}

void add_maps(Sheet& sheet, const Surface& surface) {
    sheet.rule();
    sheet.line("The maps of the painting", 1.15, kInk);
    std::vector<Sheet::Cell> row;
    for (MapPicture& map : map_pictures(surface, 1200)) {
        std::optional<Image<Rgb>> scale;
        if (map.range) scale = sheet.legend_for(ColourMap::sequential, *map.range, map.unit);
        row.push_back({map.title, map.meaning, std::move(map.picture), std::move(scale)});
        if (row.size() == 3) {
            sheet.row(row);
            row.clear();
        }
    }
    if (!row.empty()) sheet.row(row);
}

std::string described(const char* what, const ComparisonMean& mean) {
    if (mean.count == 0) return fmt::format("{}: none", what);
    return fmt::format("{} {}: {:.1f} dB, SSIM {:.3f}, dE2000 {:.1f}", mean.count, what, mean.psnr_db,
                       mean.ssim, mean.delta_e_2000);
}

}  // namespace

std::vector<std::string> typical_photos(const CompareReport& report, int count) {
    std::vector<const PhotoComparison*> candidates;
    for (const PhotoComparison& photo : report.photos)
        if (!photo.fitted || report.held_out.count == 0) candidates.push_back(&photo);
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto* a, const auto* b) { return a->psnr_db < b->psnr_db; });
    std::vector<std::string> names;
    const std::size_t wanted = std::min(candidates.size(), static_cast<std::size_t>(std::max(count, 0)));
    for (std::size_t i = 0; i < wanted; ++i) {
        const std::size_t at =
            wanted == 1 ? candidates.size() / 2 : i * (candidates.size() - 1) / (wanted - 1);
        names.push_back(candidates[at]->name);
    }
    return names;
}

Image<Rgb> contact_sheet(const Surface& surface, const Stack& photos, const CompareReport& report,
                         const ContactSheetOptions& options, const Progress& progress) {
    validate(options);
    Stack chosen = photos;
    chosen.photos.clear();
    chosen.held_out.clear();
    for (const std::string& name : typical_photos(report, options.photos))
        for (const auto* list : {&photos.photos, &photos.held_out})
            for (const StackPhoto& photo : *list)
                if (photo.light.name == name) chosen.photos.push_back(photo);

    Sheet sheet(options.width, surface);
    sheet.line("Painting and photographs compared", 1.8, kInk);
    sheet.line(fmt::format("Mean over photographs, {}; {}. Values as stored ({}), {} x {} pixels.",
                           described("held out", report.held_out), described("fitted", report.fitted),
                           report.transfer.name(), report.width, report.height),
               1, kSoft);
    sheet.space(sheet.text());
    compare(surface, chosen, report.options, progress,
            [&](const ComparedPictures& pictures) { add_photo(sheet, pictures, report.options); });
    add_maps(sheet, surface);
    return sheet.finished();
}

}  // namespace tangi
