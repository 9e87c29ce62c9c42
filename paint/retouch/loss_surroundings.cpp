#include "paint/retouch/loss_surroundings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "paint/appearance_part.h"
#include "paint/retouch/fill.h"
#include "surface/error.h"

namespace tangi {

namespace {

Region box_of(const Mask& mask, int margin) {
    Region box{mask.width(), mask.height(), 0, 0};
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            if (!(mask(x, y) > 0)) continue;
            box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1),
                   std::max(box.y1, y + 1)};
        }
    if (box.x1 <= box.x0) fail("retouch: the mask is empty; draw or choose the area that is to be retouched");
    return {std::max(box.x0 - margin, 0), std::max(box.y0 - margin, 0),
            std::min(box.x1 + margin, mask.width()), std::min(box.y1 + margin, mask.height())};
}

template <class T>
Image<T> crop(const Image<T>& image, const Region& region) {
    Image<T> part(region.width(), region.height());
    for (int y = 0; y < part.height(); ++y)
        for (int x = 0; x < part.width(); ++x) part(x, y) = image(x + region.x0, y + region.y0);
    return part;
}

// Layers that level are fills.
bool filled(const Canvas& canvas) {
    return std::any_of(canvas.dried().begin(), canvas.dried().end(), [](const auto& l) { return l.levels; });
}

// What is no good to go on from: losses and other damage with the gap beside them, what was not measured.
Mask hole_in(const Canvas& canvas, const Mask& mask, const Mask& damaged, const Region& window,
             double gap_px) {
    Mask hole = crop(mask, window);
    if (!damaged.empty()) hole = united(hole, crop(damaged, window));
    for (float& v : hole.pixels()) v = v > 0 ? 1.0f : 0.0f;
    hole = dilated(hole, gap_px);
    const Image<float> confidence = crop(canvas.dry().confidence, window);
    for (std::size_t i = 0; i < hole.size(); ++i)
        if (!(confidence.pixels()[i] > 0)) hole.pixels()[i] = 1;
    return hole;
}

// Colours carried on into each part of the loss from what lies within `margin` of it: what is farther does
// not tell, and a picture with losses here and there is too large to be smoothed as a whole.
void carry_on(const Canvas& canvas, const Mask& mask, const Mask& damaged, const RetouchOptions& options,
              double gap_px, double ring_px, int margin, Loss& loss) {
    Mask any = loss.mask;
    for (float& v : any.pixels()) v = v > 0 ? 1.0f : 0.0f;
    const MaskRegions parts = regions_of(any);
    loss.target = Image<Rgb>(any.width(), any.height());
    const auto with_margin = [&](const Region& box) {
        return intersection({box.x0 - margin, box.y0 - margin, box.x1 + margin, box.y1 + margin},
                            any.region());
    };
    const auto area_px = [](const Region& r) { return std::int64_t(r.width()) * r.height(); };
    std::int64_t all_px = 0;
    for (const MaskRegion& part : parts.regions) all_px += area_px(with_margin(part.box));
    const bool apart = all_px < area_px(any.region());
    for (int number = 1; number <= static_cast<int>(apart ? parts.regions.size() : 1); ++number) {
        Region window =
            apart ? with_margin(parts.regions[static_cast<std::size_t>(number - 1)].box) : any.region();
        const auto on_canvas = [&] {
            return Region{window.x0 + loss.region.x0, window.y0 + loss.region.y0, window.x1 + loss.region.x0,
                          window.y1 + loss.region.y0};
        };
        Mask hole = hole_in(canvas, mask, damaged, on_canvas(), gap_px);
        if (apart &&
            std::none_of(hole.pixels().begin(), hole.pixels().end(), [](float v) { return v < 0.5f; })) {
            window = any.region();  // damage all round: from farther away
            hole = hole_in(canvas, mask, damaged, on_canvas(), gap_px);
        }
        Image<Rgb> target = smoothed_around(crop(loss.seen, window), hole, ring_px / 4);
        inpaint_into(target, hole, options.inpainting, ring_px);
        for (int y = window.y0; y < window.y1; ++y)
            for (int x = window.x0; x < window.x1; ++x)
                if (!apart || parts.number(x, y) == number)
                    loss.target(x, y) = target(x - window.x0, y - window.y0);
    }
}

}  // namespace

Loss loss_of(const Canvas& canvas, const Mask& mask, const Mask& damaged, const RetouchOptions& options) {
    TP_REQUIRE(mask.region() == canvas.region(), "the mask is the painting's");
    TP_REQUIRE(damaged.empty() || damaged.region() == mask.region(), "the mask is the painting's");
    Loss loss;
    loss.mm_per_pixel = canvas.mm_per_pixel();
    const double gap_px = options.annulus.gap_mm / loss.mm_per_pixel,
                 ring_px = std::max(options.annulus.annulus_mm / loss.mm_per_pixel, 2.0);
    const bool patches = options.inpainting == Inpainting::patches;
    const int margin = static_cast<int>(std::ceil(gap_px + (patches ? 6 : 2) * ring_px)) + 2;
    loss.region = box_of(mask, margin);
    loss.mask = crop(mask, loss.region);
    loss.seen = diffuse_in(canvas, loss.region);
    if (patches) {  // as sharp as they are, and along with the relief of what was filled
        loss.target = loss.seen;
        const Image<float> relief_mm = crop(relief_of(canvas), loss.region);
        const Mask hole = hole_in(canvas, mask, damaged, loss.region, gap_px);
        inpaint_into(loss.target, hole, options.inpainting, ring_px, filled(canvas) ? &relief_mm : nullptr);
    } else {
        carry_on(canvas, mask, damaged, options, gap_px, ring_px, margin, loss);
    }
    Rgb sum(0);
    float weights = 0;
    for (std::size_t i = 0; i < loss.mask.size(); ++i) {
        sum += loss.mask.pixels()[i] * loss.seen.pixels()[i];
        weights += loss.mask.pixels()[i];
    }
    loss.below = reflectance_of_rgb(sum / weights);
    return loss;
}

}  // namespace tangi
