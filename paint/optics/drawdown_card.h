// drawdown_card.h: a palette as a paint maker shows it: every paint on a card, by itself, with white, and
// anisotropic over black and white.
#pragma once

#include "paint/optics/palette.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/image/image.h"

namespace tangi {

struct DrawdownOptions {
    int card_px = 400;
    int columns = 4;
    double thickest_mm = 0.2;
    double tint = 0.1;

    static constexpr std::string_view name = "drawdown";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"card_px", 120, 2000, "1", "width of a card in pixels"}, self.card_px);
        visit(FieldInfo{"columns", 1, 20, "1", "cards in a row"}, self.columns);
        visit(FieldInfo{"thickest_mm", 0.001, 10, "mm", "dry film at the thick end of the drawdown"},
              self.thickest_mm);
        visit(FieldInfo{"tint", 0.001, 0.999, "1",
                        "part of the paint in its stronger tint; the other has a fifth"},
              self.tint);
    }
};

// The white that tints are made with: the lightest paint of the palette, or titanium white where none is
// light.
const Pigment& white_of(const Palette& palette);

// Cards in the order of the palette, linear Rec. 709 under the illuminant, adapted to D65. Throws Error where
// options are outside of their intervals, or the picture has more than 100 million pixels; Cancelled.
Image<Rgb> drawdown_cards(const Palette& palette, Illuminant illuminant, const DrawdownOptions& options = {},
                          const Progress& progress = {});

}  // namespace tangi
