// canvas.h: what is painted on: a dry surface whose relief never changes, layers of dried paint, and wet
// paint.
//
// Pixels are those of the dry surface: row 0 at the top. Heights add: what a brush meets is the dry surface
// plus the dried layers plus the wet paint.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "paint/canvas/canvas_part.h"
#include "paint/canvas/paint_layer.h"
#include "paint/optics/pigment.h"
#include "surface/maps/surface.h"

namespace tangi {

// Which canvas of a sitting something happens on.
enum class Place { painting, palette };

// A part of a recipe; the parts of a recipe count by their ratio.
struct Portion {
    IngredientId ingredient = 0;
    double part = 1;
};

// Whether two sizes of pixels are the same as far as painting files tell, which hold floats.
bool same_scale(double a_mm, double b_mm);

struct DriedLayer {
    std::string name;
    PaintLayer paint;
    // A body with a surface of its own, as a fill: what the dry normals show beyond the dry height does not
    // come through where it is thick.
    bool levels = false;
};

class Canvas {
public:
    // `mm_per_pixel` gives a scale to a surface that has none; without it, such a pixel counts as one mm.
    // Throws ContractError where there is no surface or it has no pixels, Error where its scale is known to
    // be another.
    explicit Canvas(std::shared_ptr<const Surface> dry, std::optional<double> mm_per_pixel = {});

    // Lies on another dry surface of the same relief and scale, of other colour or gloss: as if all had been
    // painted on that, since brushes meet relief alone. Throws ContractError where relief or scale differ.
    void lie_on(std::shared_ptr<const Surface> dry);

    const Surface& dry() const { return *dry_; }
    const std::shared_ptr<const Surface>& dry_shared() const { return dry_; }
    int width() const { return dry_->width(); }
    int height() const { return dry_->height(); }
    Region region() const { return dry_->height_mm.region(); }
    double mm_per_pixel() const { return mm_per_pixel_; }
    // Of the dry surface, or given to paint on it with.
    bool scale_known() const { return dry_->scale_known || mm_per_pixel_ != dry_->mm_per_pixel; }
    // [mm] that one unit of the dry surface's height is: 1, or a pixel where the surface's scale is unknown.
    double height_unit_mm() const { return mm_per_pixel_ / dry_->mm_per_pixel; }

    // The number of this paint, which is added where it is new: another name, colour or gloss. Throws Error
    // beyond 32768.
    IngredientId add(const Pigment& ingredient);
    const std::vector<Pigment>& ingredients() const { return ingredients_; }

    const PaintLayer& wet() const { return wet_; }
    const std::vector<DriedLayer>& dried() const { return dried_; }

    // To write to: tiles must be marked as dirty by who writes.
    PaintLayer& writable_wet() { return wet_; }
    std::vector<DriedLayer>& writable_dried() { return dried_; }

    void mark_dirty(TileIndex tile) { mark_dirty(tile, wet_.region_of(tile)); }
    void mark_dirty(TileIndex tile, const Region& part);
    // Changed, but by less than can be seen (quantise_volumes.h).
    void mark_settled(TileIndex tile, const Region& part);
    // What changed since the last call: a part of each tile that did, tile by tile.
    std::vector<Region> take_dirty();
    // The same without what has only settled; and some of that, to be drawn when there is time.
    std::vector<Region> take_painted();
    std::vector<Region> take_settled(std::size_t most);
    bool has_settled() const { return !settled_.empty(); }

    // Confines brushes: where `mask` (one number a pixel, the canvas's size) is 0 they neither give nor take
    // nor push paint, where it is below 1 the less of it. Empty: brushes work everywhere, as at first. Goes
    // with the sitting, not with the file. Throws ContractError for another size, Error outside [0, 1].
    void confine(std::shared_ptr<const Image<float>> mask);
    const std::shared_ptr<const Image<float>>& mask() const { return mask_; }

    // Adds to `out`, row by row, the height [mm] of what is dry in `region`, which lies on the canvas.
    void relief_mm(const Region& region, float* out, std::size_t stride) const;

    // Volume [mm^3] of each ingredient, in wet paint and dried layers together.
    std::vector<double> volumes_mm3() const;

    // Memory beyond the dry surface.
    std::size_t bytes() const;

private:
    std::shared_ptr<const Surface> dry_;
    double mm_per_pixel_ = 1;
    std::vector<Pigment> ingredients_;
    PaintLayer wet_;
    std::vector<DriedLayer> dried_;
    std::map<TileIndex, Region> dirty_, settled_;
    std::shared_ptr<const Image<float>> mask_;
};

// The dry surface or the appearance of this canvas for who knows nothing of canvases: where a scale was given
// to paint with, in that scale, heights in mm as those of the paint. Of the photographs only the rig goes
// along.
std::shared_ptr<const Surface> in_scale_of(const Canvas& canvas, std::shared_ptr<const Surface> surface);

// [mm^3] What there is of each paint, by its name: of one brought to several glosses, all of it; of one with
// medium, what is not medium, which is counted by itself. Paints of one name that are others have numbers:
// "Sky", "Sky (2)". `mm3`: of the ingredients, as volumes_mm3().
std::map<std::string, double> volumes_by_name(const std::vector<Pigment>& ingredients,
                                              const std::vector<double>& mm3);

// What a spot is made of: the ingredients of the wet paint within a circle. Where paint lies on other wet
// paint, it is the mixture of both that looks most like the spot, were the lower film thick.
struct Recipe {
    std::vector<Portion> portions;  // parts sum to 1; empty where there is no paint
    double thickness_mm = 0;        // mean over the circle
};
Recipe recipe_at(const Canvas& canvas, double x, double y, double radius_px);

// Turns a share of the wet paint (0..1] within `where` into dry paint: a layer of its own, on top of those
// there are. Films that dried one after the other lie on each other and are never one. Volume is conserved.
// Returns the layer's name: free_layer_name() of `name`; empty where there is no wet paint, and nothing
// changes.
std::string dry(Canvas& canvas, const std::string& name, const CanvasPart& where = {}, double share = 1);

// `name`, or where a dried layer has that already, or it is "wet" or "dry", the next in number that is free:
// after "retouch", "retouch 2"; after "layer 2", "layer 3".
std::string free_layer_name(const Canvas& canvas, const std::string& name);

// Takes a dried layer off again (the topmost, in a file in which several have the name). Throws Error where
// there is none of this name.
void lift_off(Canvas& canvas, const std::string& name);

}  // namespace tangi
