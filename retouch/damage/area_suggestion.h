// area_suggestion.h: areas that look abraded, stained, filled or painted over, as suggestions for a person to
// judge. Each cue compares an area with what is around its rim; where few cues speak, the evidence is weak
// and said to be.
//
// Cues (docs/theory/damage-and-fills.md has the method, and how often it is right):
//   abrasion   level where paint and ground change from thread to thread, matter and lower, and no loss
//   stain      what goes on in one paint across the rim lets less light pass, by the same factors all round,
//              least of the blue; neither height, gloss nor texture changes
//   old_fill   far smoother than around; another gloss or colour; neither a pit nor a hill
//   overpaint  lies higher all round, with another gloss, and another texture or colour
//   flaking    cracks stand open between edges that rise, in all directions; it is told from the rest of the
//              picture, not by a rim
#pragma once

#include <string>
#include <vector>

#include "retouch/damage/damage_suggestion.h"
#include "retouch/mask/damage_class.h"

namespace tangi {

struct AreaOptions {
    double smallest_area_mm2 = 25;
    double area_confidence = 0.5;  // areas below it are not suggested

    static constexpr std::string_view name = "area";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(
            FieldInfo{
                "smallest_area_mm2", 0, 1e6, "mm2",
                "areas of abrasion, stain, old fill, overpaint or flaking that are smaller are left out"},
            self.smallest_area_mm2);
        visit(FieldInfo{"area_confidence", 0, 1, "1", "such areas that are less sure are not suggested"},
              self.area_confidence);
    }
};

// [1] An area that is less sure rests on weak evidence.
inline constexpr double kWeakEvidence = 0.7;

struct SuggestedArea {
    Region box;
    double area_mm2 = 0;
    double confidence = 0;  // [1]
    std::string cues;       // what speaks for it, in numbers: "4.1 times as smooth as around, matter"
};

struct AreaSuggestion : DamageSuggestion {
    std::vector<SuggestedArea> areas;  // the surest first
    double surest = 0;                 // [1] confidence of the surest area, suggested or not
    int weak = 0;                      // how many of them rest on weak evidence
};

// Classes that suggest_areas() knows.
inline constexpr std::array<DamageClass, 5> kAreaClasses = {DamageClass::abrasion, DamageClass::stain,
                                                            DamageClass::old_fill, DamageClass::overpaint,
                                                            DamageClass::flaking};

// In means of blocks of pixels, at most 640 along the longer side. Where the surface's scale is unknown, a
// pixel counts as `mm_per_pixel`. Throws ContractError for another class than those above.
AreaSuggestion suggest_areas(const Surface& surface, double mm_per_pixel, DamageClass damage,
                             const AreaOptions& options = {}, const Progress& progress = {});

}  // namespace tangi
