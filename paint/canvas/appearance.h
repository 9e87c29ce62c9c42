// appearance.h: a painted canvas as a Surface that can be relit: wet film over dried layers over the dry
// surface.
//
// Colour: Kubelka-Munk films, one over the other (kubelka_munk.h). Shape: heights add, and so do slopes
// (DESIGN section 3): slope = slope of the dry normal + gradient of the paint's thickness, so that detail
// finer than the fitted height survives, but under layers that level. Gloss: of each layer that of its
// paints, by volume, over what lies below as far as it covers; paints shine white and
// alike in all directions, so colour and stretch of the lobe of what is dry fade as they cover it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "paint/canvas/canvas.h"
#include "paint/optics/spectrum.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// How paints make a colour.
enum class PaintModel {
    spectral,  // films on 12 bands (kubelka_munk.h)
    thesis  // thesis_mixture_srgb() of their masstones, for comparison: opaque as far as it covers, as gloss
            // does
};
std::string_view name_of(PaintModel model);  // "spectral", "thesis"
std::optional<PaintModel> paint_model_named(std::string_view name);

struct AppearanceOptions {
    // Under another than D65, what is dry is seen by a reflectance that is estimated from its colour
    // (reflectance_of_rgb()), also where it is bare.
    Illuminant illuminant = Illuminant::d65;
    PaintModel model = PaintModel::spectral;
    double covering_mm = 0.01;  // thickness at which paint's skin hides 63 % of the gloss below

    static constexpr std::string_view name = "appearance";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(
            FieldInfo{"covering_mm", 1e-5, 10, "mm", "paint of this thickness hides 63 % of the gloss below"},
            self.covering_mm);
    }
};

// The whole canvas. Where there is no paint, the dry surface comes out bit for bit, but for its diffuse
// colour under another illuminant than D65.
Surface appearance(const Canvas& canvas, const AppearanceOptions& options = {},
                   const Progress& progress = {});

// The same without a copy where it would be the dry surface.
std::shared_ptr<const Surface> shown(const Canvas& canvas, const AppearanceOptions& options = {},
                                     const Progress& progress = {});

// [1] Part of each pixel, 0..1, that no paint covers: what is left there of what photographs showed beyond
// the dry surface (surface/render/relighting_residual.h). Empty where nothing was painted.
Image<float> bare_part(const Canvas& canvas, const AppearanceOptions& options = {});

// Brings a surface that appearance() made up to date where the canvas has changed: `changed` are parts of it
// that lie within one tile each, as Canvas::take_dirty() gives them. Normals around them are touched too:
// slopes reach two pixels far.
void update_appearance(const Canvas& canvas, std::span<const Region> changed, Surface& surface,
                       const AppearanceOptions& options = {}, const Progress& progress = {});

}  // namespace tangi
