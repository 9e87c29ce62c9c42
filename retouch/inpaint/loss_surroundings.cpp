#include "retouch/inpaint/loss_surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec4.hpp>
#include <numeric>
#include <optional>

#include "paint/canvas/appearance_part.h"
#include "retouch/fill/fill.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/maps/surface_part.h"

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
    if (box.x1 <= box.x0) fail("the mask is empty; draw or choose the area that is to be retouched");
    return {std::max(box.x0 - margin, 0), std::max(box.y0 - margin, 0),
            std::min(box.x1 + margin, mask.width()), std::min(box.y1 + margin, mask.height())};
}

// Layers that level are fills.
bool filled(const Canvas& canvas) {
    return std::any_of(canvas.dried().begin(), canvas.dried().end(), [](const auto& l) { return l.levels; });
}

// What is no good to go on from: losses and other damage with the gap beside them, what was not measured.
Mask hole_in(const Canvas& canvas, const Mask& mask, const Mask& damaged, const Region& window,
             double gap_px) {
    Mask hole = cut(mask, window);
    if (!damaged.empty()) hole = united(hole, cut(damaged, window));
    for (float& v : hole.pixels()) v = v > 0 ? 1.0f : 0.0f;
    hole = dilated(hole, gap_px);
    const Image<float> confidence = cut(canvas.dry().confidence, window);
    for (std::size_t i = 0; i < hole.size(); ++i)
        if (!(confidence.pixels()[i] > 0)) hole.pixels()[i] = 1;
    return hole;
}

// A fill is where a pixel is covered by half, and covers it as a whole: so does the retouch on it, or it
// would have a rim of the fill's colour.
void cover_filled_pixels(const Canvas& canvas, Loss& loss) {
    if (!filled(canvas)) return;
    Image<float> fill_mm(loss.mask.width(), loss.mask.height());
    for (const DriedLayer& layer : canvas.dried())
        if (layer.levels)
            layer.paint.add_thickness_mm(loss.region, fill_mm.data(),
                                         static_cast<std::size_t>(fill_mm.width()));
    for (std::size_t i = 0; i < fill_mm.size(); ++i)
        if (fill_mm.pixels()[i] > 0 && loss.mask.pixels()[i] >= 0.5f) loss.mask.pixels()[i] = 1;
}

struct Surroundings {
    const Canvas& canvas;
    const Mask &mask, &damaged;
    double gap_px, ring_px;
    int margin;

    Mask hole_in(const Region& on_canvas) const {
        return tangi::hole_in(canvas, mask, damaged, on_canvas, gap_px);
    }
};

Region moved(const Region& region, int dx, int dy) {
    return {region.x0 + dx, region.y0 + dy, region.x1 + dx, region.y1 + dy};
}

// Colours carried on into each part of the loss from what lies within `margin` of it: what is farther does
// not tell, and a picture with losses here and there is too large to be smoothed as a whole.
void carry_on(const Surroundings& around, const MaskRegions& parts, const RetouchOptions& options,
              Loss& loss) {
    const int margin = around.margin;
    const Region all = loss.mask.region();
    loss.target = Image<Rgb>(all.width(), all.height());
    const auto with_margin = [&](const Region& box) {
        return intersection({box.x0 - margin, box.y0 - margin, box.x1 + margin, box.y1 + margin}, all);
    };
    const auto area_px = [](const Region& r) { return std::int64_t(r.width()) * r.height(); };
    std::int64_t all_px = 0;
    for (const MaskRegion& part : parts.regions) all_px += area_px(with_margin(part.box));
    const bool apart = all_px < area_px(all);
    for (int number = 1; number <= static_cast<int>(apart ? parts.regions.size() : 1); ++number) {
        Region window = apart ? with_margin(parts.regions[static_cast<std::size_t>(number - 1)].box) : all;
        const auto on_canvas = [&] { return moved(window, loss.region.x0, loss.region.y0); };
        Mask hole = around.hole_in(on_canvas());
        if (apart &&
            std::none_of(hole.pixels().begin(), hole.pixels().end(), [](float v) { return v < 0.5f; })) {
            window = all;  // damage all round: from farther away
            hole = around.hole_in(on_canvas());
        }
        Image<Rgb> target = smoothed_around(cut(loss.seen, window), hole, around.ring_px / 4);
        inpaint_into(target, hole, options.inpainting, around.ring_px);
        for (int y = window.y0; y < window.y1; ++y)
            for (int x = window.x0; x < window.x1; ++x)
                if (!apart || parts.number(x, y) == number)
                    loss.target(x, y) = target(x - window.x0, y - window.y0);
    }
}

// Medians over what lies round one part, of at most some thousand pixels; none where too few are.
std::optional<Gloss> gloss_round(const Surroundings& around, const MaskRegions& parts, int number,
                                 const Region& on_canvas) {
    constexpr std::size_t least = 8, most = 4000;
    const int reach = static_cast<int>(std::ceil(around.gap_px + around.ring_px)) + 1;
    const Region& own = parts.regions[static_cast<std::size_t>(number - 1)].box;
    const Region box =
        intersection({own.x0 - reach, own.y0 - reach, own.x1 + reach, own.y1 + reach}, parts.number.region());
    const Region there = moved(box, on_canvas.x0, on_canvas.y0);
    const Mask hole = around.hole_in(there);
    Mask part(box.width(), box.height());
    for (int y = 0; y < part.height(); ++y)
        for (int x = 0; x < part.width(); ++x)
            part(x, y) = parts.number(x + box.x0, y + box.y0) == number ? 1.0f : 0.0f;
    const Image<float> inside_px = distance_inside_px(part);
    std::vector<std::array<int, 2>> ring;
    for (int y = 0; y < part.height(); ++y)
        for (int x = 0; x < part.width(); ++x)
            if (hole(x, y) < 0.5f && -static_cast<double>(inside_px(x, y)) <= around.gap_px + around.ring_px)
                ring.push_back({x, y});
    if (ring.size() < least) return std::nullopt;
    const std::size_t stride = (ring.size() + most - 1) / most;
    std::vector<float> specular, roughness, luminances;
    Surface seen;  // of some rows of the box at a time, so that memory is bounded
    constexpr int rows = 64;
    int seen_from = -rows;
    for (std::size_t i = 0; i < ring.size(); i += stride) {
        const auto [x, y] = ring[i];
        if (y / rows * rows != seen_from) {
            seen_from = y / rows * rows;
            seen = appearance_in(around.canvas, {there.x0, there.y0 + seen_from, there.x1,
                                                 std::min(there.y0 + seen_from + rows, there.y1)});
        }
        specular.push_back(seen.specular(x, y - seen_from));
        roughness.push_back(seen.roughness(x, y - seen_from));
        luminances.push_back(luminance(seen.diffuse(x, y - seen_from)));
    }
    return Gloss{std::clamp(static_cast<double>(median(std::move(specular))), 0.0, 1.0),
                 std::clamp(static_cast<double>(median(std::move(roughness))), 0.01, 1.0),
                 static_cast<double>(median(std::move(luminances)))};
}

// Parts whose glosses the eye can hardly tell apart share one, the largest part's.
void find_glosses(const Surroundings& around, const MaskRegions& parts, Loss& loss) {
    constexpr std::size_t most = 8;  // paints that are mixed to a gloss of their own
    std::vector<std::size_t> order(parts.regions.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return parts.regions[a].pixels > parts.regions[b].pixels;
    });
    std::vector<unsigned char> of_part(parts.regions.size(), 0);
    for (const std::size_t i : order) {
        const std::optional<Gloss> own = gloss_round(around, parts, static_cast<int>(i) + 1, loss.region);
        if (!own) continue;
        const auto off = [&](const Gloss& g) { return gloss_difference(g, *own); };
        const auto nearest =
            std::min_element(loss.glosses.begin(), loss.glosses.end(),
                             [&](const Gloss& a, const Gloss& b) { return off(a) < off(b); });
        if (nearest != loss.glosses.end() &&
            (off(*nearest) <= kGlossTolerance || loss.glosses.size() == most)) {
            of_part[i] = static_cast<unsigned char>(nearest - loss.glosses.begin());
        } else {
            of_part[i] = static_cast<unsigned char>(loss.glosses.size());
            loss.glosses.push_back(*own);
        }
    }
    loss.gloss_parts.resize(loss.glosses.size());
    for (const std::size_t i : order) {
        if (of_part[i] >= loss.glosses.size()) continue;  // there is none at all
        const Region& box = parts.regions[i].box;
        loss.gloss_parts[of_part[i]].push_back({box.x0 + loss.region.x0, box.y0 + loss.region.y0,
                                                box.x1 + loss.region.x0, box.y1 + loss.region.y0});
    }
    loss.gloss = Image<unsigned char>(loss.mask.width(), loss.mask.height());
    for (std::size_t i = 0; i < loss.gloss.size(); ++i)
        if (const int number = parts.number.pixels()[i]; number > 0)
            loss.gloss.pixels()[i] = of_part[static_cast<std::size_t>(number) - 1];
}

// The mean colour within each part.
std::vector<PartGround> grounds_in(const Loss& loss) {
    std::vector<glm::dvec4> sums(loss.parts.regions.size(), glm::dvec4(0));
    for (std::size_t i = 0; i < loss.mask.size(); ++i)
        if (const int number = loss.parts.number.pixels()[i]; number > 0)
            sums[static_cast<std::size_t>(number) - 1] +=
                static_cast<double>(loss.mask.pixels()[i]) * glm::dvec4(glm::dvec3(loss.seen.pixels()[i]), 1);
    std::vector<PartGround> grounds;
    for (const glm::dvec4& sum : sums)
        grounds.push_back({reflectance_of_rgb(Rgb(glm::dvec3(sum) / sum.w)), sum.w});
    return grounds;
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
    loss.mask = cut(mask, loss.region);
    cover_filled_pixels(canvas, loss);
    loss.seen = diffuse_in(canvas, loss.region);
    const Surroundings around{canvas, mask, damaged, gap_px, ring_px, margin};
    Mask any = loss.mask;
    for (float& v : any.pixels()) v = v > 0 ? 1.0f : 0.0f;
    loss.parts = regions_of(any);
    any = Mask();  // as large as the region
    if (!options.own_gloss) find_glosses(around, loss.parts, loss);
    if (patches) {  // as sharp as they are, and along with the relief of what was filled
        loss.target = loss.seen;
        const Image<float> relief_mm = cut(relief_of(canvas), loss.region);
        inpaint_into(loss.target, around.hole_in(loss.region), options.inpainting, ring_px,
                     filled(canvas) ? &relief_mm : nullptr);
    } else {
        carry_on(around, loss.parts, options, loss);
    }
    loss.grounds = grounds_in(loss);
    return loss;
}

}  // namespace tangi
