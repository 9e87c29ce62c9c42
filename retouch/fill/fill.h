// fill.h: what is laid on a painting over more than a stroke: fills of losses, isolating and final varnish.
//
// Each is one dried layer of the canvas, with colour and gloss of its own, and can be lifted off again.
#pragma once

#include <optional>
#include <string>

#include "paint/canvas/canvas.h"
#include "retouch/mask/mask.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"

namespace tangi {

// Where the relief of a fill comes from.
enum class FillTexture {
    smooth,        // none: a membrane over the loss
    surroundings,  // a place nearby whose relief goes on from the rim best
    weave,         // the same by its finest relief alone, over a wide rim: threads keep their phase
    patches        // of many places whose relief, colour and gloss go on from the rim (texture_synthesis.h):
                   // made up, so the layer is a proposal
};
std::string_view name_of(FillTexture texture);
std::optional<FillTexture> fill_texture_named(std::string_view name);

struct FillOptions {
    double offset_mm = 0;     // of the fill above the level of the surroundings; below 0: slightly below
    double rim_mm = 0.6;      // beside a loss, which the height there is not trusted: steps are blurred
    double weave_mm = 1.2;    // [mm] from thread to thread, for FillTexture::weave
    double search_mm = 40;    // how far from the loss relief is looked for
    double specular = 0.005;  // [1] rho_s of the fill
    double roughness = 0.4;   // [1] alpha of the fill

    static constexpr std::string_view name = "fill";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"offset_mm", -10, 10, "mm", "of the fill above the level around; below 0: lower"},
              self.offset_mm);
        visit(FieldInfo{"rim_mm", 0, 10, "mm", "width beside a loss where the height is not trusted"},
              self.rim_mm);
        visit(FieldInfo{"weave_mm", 0.05, 20, "mm", "distance of the threads, for --texture weave"},
              self.weave_mm);
        visit(FieldInfo{"search_mm", 1, 1000, "mm", "how far from the loss relief is looked for"},
              self.search_mm);
        visit(FieldInfo{"specular", 0, 1, "1", "rho_s of the layer's surface"}, self.specular);
        visit(FieldInfo{"roughness", 0.01, 1, "1", "alpha of the layer's surface"}, self.roughness);
    }
};

// What a loss is filled with.
struct Filling {
    FillTexture texture = FillTexture::surroundings;
    Rgb colour{1};  // linear Rec. 709
    FillOptions options{};
};

struct FillReport {
    double area_mm2 = 0, volume_mm3 = 0, deepest_mm = 0;
    double border_rms_mm = 0;  // of the step from the fill's edge to the surroundings past the rim
    int regions = 0, pixels = 0;
    int smooth_regions = 0;  // of those that were to have relief, and found none near them
    int not_reached = 0;     // pixels of the mask that lie above the fill's level already: left as they are
};

// Fills `loss` (where it is above 1/2) with a layer called `name`, on top, to the level of what is around:
// the height there, with all dried paint, goes on over the loss as a membrane (Laplace's equation), with the
// relief of another place added so that its rim fits (Perez, Gangnet, Blake 2003, "Poisson image editing").
// `intact` is where relief may come from and levels may be read: not in other losses; empty: everywhere but
// in `loss`. Throws Error where the mask is empty or leaves nothing around it.
FillReport lay_fill(Canvas& canvas, const std::string& name, const Mask& loss, const Mask& intact,
                    const Filling& filling, const Progress& progress = {});

struct VarnishOptions {
    double thickness_mm = 0.02;
    double specular = 0.04;   // [1] rho_s: of a resin's refractive index of about 1.5
    double roughness = 0.08;  // [1] alpha: 0.05 glossy, 0.3 matt
    double yellowing = 0;     // [1/mm] absorption of blue light (410 nm), a tenth of it in red

    static constexpr std::string_view name = "varnish";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"thickness_mm", 1e-4, 1, "mm", "thickness of the varnish"}, self.thickness_mm);
        visit(FieldInfo{"specular", 0, 1, "1", "rho_s of its surface"}, self.specular);
        visit(FieldInfo{"roughness", 0.01, 1, "1", "alpha of its surface: 0.05 is glossy, 0.3 matt"},
              self.roughness);
        visit(FieldInfo{"yellowing", 0, 100, "1", "absorption of blue light [1/mm]; 0 = clear"},
              self.yellowing);
    }
};

// A layer of even thickness where `area` is (times its coverage). It follows the relief below.
void lay_varnish(Canvas& canvas, const std::string& name, const Mask& area,
                 const VarnishOptions& options = {});

// The height [mm] of what is dry, with all dried layers.
Image<float> relief_of(const Canvas& canvas);

// Laplace's equation inside of `unknown` (above 1/2), with the values outside as its border; coarse to fine.
void solve_membrane(Image<float>& values, const Mask& unknown);

// Puts `thickness_mm` of one paint on the canvas as its topmost dried layer.
void add_layer(Canvas& canvas, const std::string& name, const Pigment& paint,
               const Image<float>& thickness_mm, bool levels);

}  // namespace tangi
