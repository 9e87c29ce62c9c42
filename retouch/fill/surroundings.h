// surroundings.h: what a loss is surrounded by: its colour, gloss and height, and these carried on into it.
#pragma once

#include <optional>
#include <string_view>

#include "retouch/mask/mask.h"
#include "surface/base/options.h"
#include "surface/maps/surface.h"

namespace tangi {

struct AnnulusOptions {
    double gap_mm = 0.3;  // beside the loss that does not count: its edge is seldom clean
    double annulus_mm = 4;

    static constexpr std::string_view name = "annulus";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"gap_mm", 0, 100, "mm", "edge beside the loss that does not count as surroundings"},
              self.gap_mm);
        visit(FieldInfo{"annulus_mm", 0.01, 500, "mm", "width of the surroundings that are looked at"},
              self.annulus_mm);
    }
};

// What lies round a loss. Colours are linear Rec. 709 under D65.
struct Annulus {
    int pixels = 0;
    Rgb mode{};         // the commonest colour: mean shift in L*a*b* (Comaniciu & Meer 2002) from the median
    Rgb median{};       // by channel
    double spread = 0;  // median CIEDE2000 of the pixels from the mode
    float height_mm = 0;  // medians
    float specular = 0, roughness = 0;
};

// Pixels from gap_mm to gap_mm + annulus_mm outside of `loss`, as far as they are measured (confidence > 0)
// and not in `damaged` (may be empty: none are). Throws Error where nothing is left.
Annulus annulus_of(const Surface& surface, const Mask& loss, const Mask& damaged,
                   const AnnulusOptions& options = {});

// The pixels themselves: coverage 1 or 0.
Mask annulus_mask(const Surface& surface, const Mask& loss, const Mask& damaged,
                  const AnnulusOptions& options = {});

// How colour is carried on into a loss.
enum class Inpainting {
    membrane,       // Laplace's equation: as smooth as can be (Perez, Gangnet, Blake 2003)
    telea,          // Telea 2004: fast marching, through OpenCV
    navier_stokes,  // Bertalmio, Bertozzi, Sapiro 2001, through OpenCV: isophotes go on
    patches         // of the surroundings (texture_synthesis.h): strokes go on
};
std::string_view name_of(Inpainting method);
std::optional<Inpainting> inpainting_named(std::string_view name);

// Replaces values where `hole` is 1/2 and more by a membrane (solve_membrane() of fill.h). Throws
// ContractError where sizes differ, Error where the hole is all there is.
void membrane_into(Image<float>& values, const Mask& hole);

// The same by another method, without patches; radius_px: how far Telea and Navier-Stokes look around.
void inpaint_into(Image<float>& values, const Mask& hole, Inpainting method, double radius_px = 5);
// Colours: in perceptually even steps (cube roots), not below 0. Patches go along with a relief, where one is
// given that is known in the hole as well (that of a fill). Throws Error where there is no whole patch.
void inpaint_into(Image<Rgb>& colours, const Mask& hole, Inpainting method, double radius_px = 5,
                  const Image<float>* relief_mm = nullptr);

// Standard deviation over the mask's pixels.
float spread_of(const Image<float>& values, const Mask& where);

// Colours as they are seen from some way off: Gaussian means over what is not `excluded`.
Image<Rgb> smoothed_around(const Image<Rgb>& colours, const Mask& excluded, double sigma_px);

}  // namespace tangi
