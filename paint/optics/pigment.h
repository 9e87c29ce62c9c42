// pigment.h: a paint as the paint model sees it: how it absorbs and scatters, and how we know.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "paint/optics/spectrum.h"
#include "surface/base/options.h"

namespace tangi {

// Where K and S come from, best first.
enum class PigmentOrigin {
    measured,           // K and S from a series of measurements
    masstone_and_tint,  // solved from the reflectance of the paint by itself and of a mixture with white
    masstone,           // K/S from the reflectance of the paint by itself; S only by how thick it hides
    colour              // the same from an RGB colour: one of many paints that look like this
};

std::string_view name_of(PigmentOrigin origin);

struct Pigment {
    std::string name;
    Spectrum k{}, s{};  // absorption and scattering of the dry paint [1/mm]
    PigmentOrigin origin = PigmentOrigin::measured;
    std::string source;  // who measured it; empty where nobody says
    // The surface of a thick film of it: Ward's rho_s and alpha (surface/reflectance/ward.h).
    float specular = 0.04f;
    float roughness = 0.15f;
    float medium = 0;  // [1] part of it, by volume, that is clear medium which was stirred in (PaintFinish)

    // Looks right by itself, but mixtures and thin films are a guess.
    bool approximate() const { return origin == PigmentOrigin::masstone || origin == PigmentOrigin::colour; }
};

// A clear medium, as glazes are thinned with: a film of 1 mm absorbs and scatters less than 2 % in every
// band. No film of it hides, so it has no look of its own.
bool is_clear(const Pigment& paint);
// What medium without pigment is counted as; the name of no paint that has a colour.
inline constexpr const char* kClearMedium = "clear medium";

// What a painter does to a paint before it goes on the brush.
struct PaintFinish {
    std::optional<double> specular{}, roughness{};  // [1] rho_s and alpha instead of the paint's own
    double medium = 0;  // [1] part of clear medium, by volume: 0 as from the tube, 0.9 a glaze

    static constexpr std::string_view name = "paint";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"specular", 0, 1, "1", "Ward's rho_s of the dry film"}, self.specular);
        visit(FieldInfo{"roughness", 0.001, 1, "1", "Ward's alpha: 0.05 is glossy, 0.5 matte"},
              self.roughness);
        visit(FieldInfo{"medium", 0, 0.99, "1", "part of clear medium, by volume"}, self.medium);
    }
    friend bool operator==(const PaintFinish&, const PaintFinish&) = default;
};

// The paint with this finish. Medium neither absorbs nor scatters: K and S are those of what is left (Duncan
// 1940, as in mixtures). Throws Error where the finish is out of its range.
Pigment finished(Pigment paint, const PaintFinish& finish);

// Films of this thickness hide: over black, they are 98 % as bright as over white (ISO 6504). Default for
// paints of which no more is known than their colour; titanium white needs about as much
// (docs/theory/kubelka-munk.md).
inline constexpr float kHidingThickness_mm = 0.1f;

// K and S from reflectances (outside, without specular reflection, 0..1) of films that hide: of the paint by
// itself, and of `tint`, `concentration` parts by volume of it and 1 - concentration of `white`. Bands where
// both look the same say nothing about S: it is taken from their neighbours. Throws Error naming the paint:
// reflectances outside of [0, 1], concentration outside of (0, 1), a tint that no mixture of both can be, or
// that is the masstone in most bands that could tell.
Pigment pigment_of_tint(std::string name, const Spectrum& masstone, const Spectrum& tint, float concentration,
                        const Pigment& white);

// From the reflectance of a film that hides (outside, without specular reflection), or a linear Rec. 709
// colour under D65 in [0, 1]: approximate. S is the same in all bands, such that a film of `hiding_mm` just
// hides. Throws Error naming the paint: numbers outside of [0, 1], hiding_mm outside of [0.001, 10].
Pigment pigment_of_masstone(std::string name, const Spectrum& masstone,
                            float hiding_mm = kHidingThickness_mm);
Pigment pigment_of_rgb(std::string name, const Rgb& linear, float hiding_mm = kHidingThickness_mm);

// Luminance Y of a film over black (0.01) as a part of that over white (0.80), as of the cards that opacity
// is measured on, specular reflection left out. 1 hides.
double contrast_ratio(const Pigment& pigment, float thickness_mm, Illuminant illuminant = Illuminant::d65);

// The thickness [mm] where the contrast ratio reaches `ratio`, 10 where that takes more.
double hiding_thickness_mm(const Pigment& pigment, double ratio = 0.98,
                           Illuminant illuminant = Illuminant::d65);

}  // namespace tangi
