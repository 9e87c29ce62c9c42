// contact_sheet.h: one picture that shows how well a painting matches its photographs, and its maps.
#pragma once

#include <string>
#include <vector>

#include "fit/evaluate/compare.h"

namespace tangi {

struct ContactSheetOptions {
    int width = 1800;  // [pixels] of the sheet
    int photos = 3;    // rows of photograph, relit picture, difference

    static constexpr std::string_view name = "contact_sheet";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"width", 480, 2400, "1", "width of the sheet, in pixels"}, self.width);
        visit(FieldInfo{"photos", 1, 12, "1", "photographs to show"}, self.photos);
    }
};

// Names of `count` photographs (or of all, where there are fewer) that stand for the rest: of the held-out
// ones, or of all where none was held out, those evenly spread from the lowest to the highest PSNR.
std::vector<std::string> typical_photos(const CompareReport& report, int count);

// Title, rows of photograph | relit | signed difference for typical_photos(report), then the maps in false
// colour with legends; sRGB-encoded, for write_picture_8bit(). The report is that of comparing the surface
// with these photographs; the pictures are computed anew with its options. Errors as compare().
Image<Rgb> contact_sheet(const Surface& surface, const Stack& photos, const CompareReport& report,
                         const ContactSheetOptions& options = {}, const Progress& progress = {});

}  // namespace tangi
