// procedural_painting.h: oil paintings made of noise, with every quantity that a fit should find known
// exactly.
//
// Canvas, ground, brush strokes, gold leaf, craquelure, losses, varnish and a retouch are functions of a
// point in mm. They are sampled on a grid finer than the pixels and averaged over each pixel. Frame and units
// as in surface.h.
#pragma once

#include <cstdint>

#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/image/homography.h"
#include "surface/maps/surface.h"

namespace tangi {

struct PaintingOptions {
    std::uint64_t seed = 1;
    int width = 512;                 // [pixels]
    int height = 512;                // [pixels]
    double mm_per_pixel = 0.25;      // [mm]
    int supersampling = 2;           // samples along each side of a pixel
    double weave_mm = 0.12;          // [mm] height of the canvas threads above each other; 0 = a smooth panel
    double thread_pitch_mm = 1.2;    // [mm] from thread to thread; a plain weave repeats after two
    double thread_irregularity = 1;  // [1] 0 = a perfect lattice
    double coverage = 1;  // [1] number of brush strokes, 1 = the ground shows hardly anywhere, 0 = no paint
    double brush_width_mm = 5;     // [mm] of the main brush; others are up to twice as wide and half as wide
    double impasto = 1;            // [1] thickness of the paint; 1 = ridges up to about 1 mm
    double craquelure = 1;         // [1] depth of the cracks in units of 0.25 mm; 0 = none
    double crack_distance_mm = 7;  // [mm] from crack to crack
    double cupping_mm = 0.04;      // [mm] how far paint curls up along the cracks
    bool losses = true;            // places where the paint has come off, down to ground and canvas
    bool varnish = true;           // a glossy patch
    bool retouch = true;           // a matt patch of later paint
    bool gilding = false;          // a border of gold leaf
    double brushed = 0;            // [1] stretch of the leaf's lobe, which was rubbed along the border
    bool abrasion = false;         // paint rubbed off the tops of the ground, gloss with it
    bool flaking = false;          // plates of paint whose edges have come up
    bool stain = false;            // a film that absorbs, most of it at its rim
    bool old_fill = false;         // smooth putty in place of paint
    bool overpaint = false;        // a later layer over the paint

    static constexpr std::string_view name = "painting";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"seed", 0, 9e15, "1", "another painting for each number"}, self.seed);
        visit(FieldInfo{"width", 2, 32768, "pixels", "width of the picture"}, self.width);
        visit(FieldInfo{"height", 2, 32768, "pixels", "height of the picture"}, self.height);
        visit(FieldInfo{"mm_per_pixel", 1e-3, 10, "mm", "size of a pixel"}, self.mm_per_pixel);
        visit(FieldInfo{"supersampling", 1, 8, "1", "samples along each side of a pixel"},
              self.supersampling);
        visit(FieldInfo{"weave_mm", 0, 1, "mm", "relief of the canvas (0 = panel)"}, self.weave_mm);
        visit(FieldInfo{"thread_pitch_mm", 0.1, 20, "mm", "distance of the threads"}, self.thread_pitch_mm);
        visit(FieldInfo{"thread_irregularity", 0, 2, "1", "irregularity of the threads"},
              self.thread_irregularity);
        visit(FieldInfo{"coverage", 0, 4, "1", "number of brush strokes (1 = well covered)"}, self.coverage);
        visit(FieldInfo{"brush_width_mm", 0.5, 100, "mm", "width of the main brush"}, self.brush_width_mm);
        visit(FieldInfo{"impasto", 0, 4, "1", "thickness of the paint"}, self.impasto);
        visit(FieldInfo{"craquelure", 0, 2, "1", "depth of the cracks (0 = none)"}, self.craquelure);
        visit(FieldInfo{"crack_distance_mm", 0.5, 100, "mm", "distance from crack to crack"},
              self.crack_distance_mm);
        visit(FieldInfo{"cupping_mm", 0, 1, "mm", "height of the paint's edges along cracks"},
              self.cupping_mm);
        visit(FieldInfo{"losses", 0, 1, "", "places where paint is missing"}, self.losses);
        visit(FieldInfo{"varnish", 0, 1, "", "a glossy patch"}, self.varnish);
        visit(FieldInfo{"retouch", 0, 1, "", "a matt patch of later paint"}, self.retouch);
        visit(FieldInfo{"gilding", 0, 1, "", "a border of gold leaf, whose lobe has its colour"},
              self.gilding);
        visit(
            FieldInfo{
                "brushed", 0, 1, "1",
                "with gilding: gold leaf was rubbed along the border: ln of its lobe's width across the "
                "grooves over the mean (0 = alike in all directions)"},
            self.brushed);
        visit(FieldInfo{"abrasion", 0, 1, "", "paint that was rubbed off down to the ground"}, self.abrasion);
        visit(FieldInfo{"flaking", 0, 1, "", "plates of paint whose edges come up"}, self.flaking);
        visit(FieldInfo{"stain", 0, 1, "", "a stain"}, self.stain);
        visit(FieldInfo{"old_fill", 0, 1, "", "smooth putty in place of paint"}, self.old_fill);
        visit(FieldInfo{"overpaint", 0, 1, "", "a later layer over the paint"}, self.overpaint);
    }
};

// The truth about a painting; all maps have the same size. Masks are 1 inside, 0 outside.
struct PaintingTruth {
    Image<float> height_mm;  // [mm] above the mean plane of the bare canvas, mean over the pixel
    Image<Vec3> normal;      // [unit vector] of the mean slope over the pixel
    Image<Rgb> diffuse;      // [1] rho_d, albedo
    Image<float>
        specular;  // [1] reflectance F0 at normal incidence; the same number is rho_s of a Ward lobe,
                   //     whose peak at normal incidence equals that of GGX with equal alpha
    Image<float>
        roughness;  // [1] alpha: rms slope (Ward), width of the GGX distribution (not its square root)
    Image<Rgb> specular_colour;  // [1] as in surface.h: of gold leaf; empty where there is none
    Image<LobeAxes> lobe_axes;   // as in surface.h: of leaf that was rubbed; empty where there is none
    Image<unsigned char> loss, craquelure, varnish, retouch;
    Image<unsigned char> abrasion, flaking, stain, old_fill, overpaint;
    Image<unsigned char>
        valid;  // 0 where a pixel mixes intact and lost or cracked paint: no one surface fits it
    double mm_per_pixel = 1;  // [mm]

    PaintingTruth() = default;
    PaintingTruth(int width, int height, double mm_per_pixel = 1);  // flat, matt, white, valid, undamaged

    int width() const { return height_mm.width(); }
    int height() const { return height_mm.height(); }
};

// Throws Error on options outside their intervals, Cancelled where progress asks for it. Does not depend on
// the number of threads.
PaintingTruth procedural_painting(const PaintingOptions& options = {}, const Progress& progress = {});

// What a camera sees of a painting, from its own place.
struct PaintingView {
    int width = 0, height = 0;  // [pixels] of its picture
    double mm_per_pixel = 1;    // [mm] at the picture's centre
    Homography to_mm{1};        // pixel of the picture -> [mm] of the painting's plane, y up
    glm::dmat3 rotation{1};     // vectors of the painting's frame -> those of the camera's
};

// The truth about this part of it in the picture's pixels and the camera's frame: height is along the
// camera's axis, above the plane through the painting's point at the picture's centre, so that a tilted
// camera's has a slope. Relief has no parallax. Errors as above.
PaintingTruth procedural_painting(const PaintingOptions& options, const PaintingView& view,
                                  const Progress& progress = {});

// The same maps as a Surface; confidence is 1 where valid. Exact for the Ward model.
Surface surface_of(const PaintingTruth& truth);

}  // namespace tangi
