#include "retouch/fill/fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "retouch/fill/surroundings.h"
#include "retouch/fill/texture_synthesis.h"
#include "surface/base/error.h"
#include "surface/base/noise.h"
#include "surface/base/parallel.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr float kNothing_mm = 1e-5f;  // rounding of heights of some mm: what was filled before is level

constexpr int kSize = PaintTile::kSize;

// One region of a loss with what is around it, as pictures of their own.
struct Patch {
    Region box;
    Mask unknown;                          // the region and its rim
    Image<float> level_mm;                 // what the fill is to reach
    std::vector<std::array<int, 2>> ring;  // pixels of the canvas around, which tell the level
};

constexpr int kMostShifts = 160;  // along a side, that are tried first

// How far relief may be taken from: another place, or none.
struct Shift {
    int x = 0, y = 0;
    bool found = false;
};

struct PatchSearch {
    const Image<float>& detail_mm;  // the fine relief of the whole canvas
    const Mask& usable;             // where relief may come from
};

// The place nearby whose relief fits the ring around the patch best: least mean squared difference of the
// fine relief on the ring, of which half must be usable there, and all of the patch. Of a wide reach every
// `stride`-th place is tried, at most every `phase_px`-th, then those next to the best.
Shift best_shift(const Patch& patch, const PatchSearch& s, int reach, double phase_px) {
    std::vector<std::array<int, 2>> inside;  // some of the patch's pixels, to see that they are usable
    for (int y = 0; y < patch.unknown.height(); ++y)
        for (int x = 0; x < patch.unknown.width(); ++x)
            if (patch.unknown(x, y) > 0.5f) inside.push_back({patch.box.x0 + x, patch.box.y0 + y});
    std::vector<std::array<int, 2>> some;
    const std::size_t step = std::max<std::size_t>(patch.ring.size() / 400, 1);
    for (std::size_t i = 0; i < patch.ring.size(); i += step) some.push_back(patch.ring[i]);
    const auto usable = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < s.usable.width() && y < s.usable.height() && s.usable(x, y) > 0.5f;
    };
    Shift best;
    double least = 1e30;
    const auto search = [&](const Region& shifts, int stride) {
        for (int dy = shifts.y0; dy < shifts.y1; dy += stride)
            for (int dx = shifts.x0; dx < shifts.x1; dx += stride) {
                if (!usable(inside.front()[0] + dx, inside.front()[1] + dy) ||
                    !usable(inside.back()[0] + dx, inside.back()[1] + dy))
                    continue;
                double sum = 0;
                std::size_t seen = 0;
                for (const auto& [x, y] : some) {
                    if (!usable(x + dx, y + dy)) continue;
                    const auto d = static_cast<double>(s.detail_mm(x + dx, y + dy) - s.detail_mm(x, y));
                    sum += d * d;
                    ++seen;
                    if (sum >= least * static_cast<double>(some.size())) break;
                }
                if (2 * seen < some.size() || sum >= least * static_cast<double>(seen)) continue;
                if (!std::all_of(inside.begin(), inside.end(),
                                 [&](const auto& p) { return usable(p[0] + dx, p[1] + dy); }))
                    continue;
                least = sum / static_cast<double>(seen);
                best = {dx, dy, true};
            }
    };
    const int stride = std::clamp(static_cast<int>(phase_px), 1, std::max(2 * reach / kMostShifts, 1));
    search({-reach, -reach, reach + 1, reach + 1}, stride);
    if (best.found && stride > 1)
        search({best.x - stride + 1, best.y - stride + 1, best.x + stride, best.y + stride}, 1);
    return best;
}

Image<float> fine_relief(const Image<float>& height_mm, double sigma_px) {
    Image<float> detail(height_mm.width(), height_mm.height());
    cv::Mat smooth;
    cv::GaussianBlur(view_of(height_mm), smooth, {}, sigma_px, sigma_px, cv::BORDER_REFLECT);
    for (int y = 0; y < detail.height(); ++y)
        for (int x = 0; x < detail.width(); ++x) detail(x, y) = height_mm(x, y) - smooth.at<float>(y, x);
    return detail;
}

// What of another place differs from its own membrane, which has the same rim as the patch. It grows from
// `from_px` inside the rim to `to_px`: from the edge of the loss, so that the fill is flush there, where no
// thread has to go on.
struct Ramp {
    float from_px = 0, to_px = 1e-3f;
};

void add_relief(Patch& patch, const Shift& shift, const Image<float>& source_mm, const Image<float>& depth_px,
                const Ramp& ramp) {
    Image<float> there(patch.box.width(), patch.box.height());
    for (int y = 0; y < there.height(); ++y)
        for (int x = 0; x < there.width(); ++x)
            there(x, y) = source_mm.clamped(patch.box.x0 + x + shift.x, patch.box.y0 + y + shift.y);
    Image<float> membrane = there;
    solve_membrane(membrane, patch.unknown);
    for (int y = 0; y < there.height(); ++y)
        for (int x = 0; x < there.width(); ++x)
            if (patch.unknown(x, y) > 0.5f) {
                const float depth = depth_px(patch.box.x0 + x, patch.box.y0 + y);
                const float part = procedural::smooth_step(ramp.from_px, ramp.to_px, depth);
                patch.level_mm(x, y) += part * (there(x, y) - membrane(x, y));
            }
}

// Relief made of patches whose relief, colour and gloss go on from the rim, on the level smoothed as much as
// the relief is finer than. `wide` is the loss with its rim. Where there is no whole patch, the level stays.
// False where there was nothing to take relief from.
bool add_patches(Patch& patch, const Surface& dry, const Image<float>& levelled_mm, const PatchSearch& s,
                 const Mask& wide, int reach, const Progress& progress) {
    const Region box{std::max(patch.box.x0 - reach, 0), std::max(patch.box.y0 - reach, 0),
                     std::min(patch.box.x1 + reach, wide.width()),
                     std::min(patch.box.y1 + reach, wide.height())};
    Mask hole(box.width(), box.height()), usable = hole;
    std::vector<SynthesisChannel> channels(5, {hole});
    for (int y = 0; y < box.height(); ++y)
        for (int x = 0; x < box.width(); ++x) {
            const int u = x + box.x0, v = y + box.y0;
            usable(x, y) = s.usable(u, v);
            hole(x, y) = s.usable(u, v) > 0.5f ? 0.0f : 1.0f;
            const Lab lab = lab_from_linear(glm::dvec3(glm::max(dry.diffuse(u, v), Rgb(0))));
            channels[0].values(x, y) = s.detail_mm(u, v);
            channels[1].values(x, y) = static_cast<float>(lab.l);
            channels[2].values(x, y) = static_cast<float>(lab.a);
            channels[3].values(x, y) = static_cast<float>(lab.b);
            channels[4].values(x, y) = std::log(std::max(dry.roughness(u, v), 1e-3f));
        }
    // Relief counts as much as colour; gloss, which is noisier, half as much.
    const float relief = std::max(spread_of(channels[0].values, usable), 1e-6f);
    const float colour =
        std::max({spread_of(channels[1].values, usable), spread_of(channels[2].values, usable),
                  spread_of(channels[3].values, usable), 1e-3f});
    const float gloss = 2 * std::max(spread_of(channels[4].values, usable), 1e-3f);
    const std::array<float, 5> units = {relief, colour, colour, colour, gloss};
    for (std::size_t c = 0; c < channels.size(); ++c)
        for (float& value : channels[c].values.pixels()) value /= units[c];
    if (!synthesise_into(channels, hole, usable, {}, progress)) return false;
    for (int y = patch.box.y0; y < patch.box.y1; ++y)
        for (int x = patch.box.x0; x < patch.box.x1; ++x)
            if (wide(x, y) > 0.5f)
                patch.level_mm(x - patch.box.x0, y - patch.box.y0) =
                    levelled_mm(x, y) - s.detail_mm(x, y) +
                    relief * channels[0].values(x - box.x0, y - box.y0);
    return true;
}

// A region of a loss, its rim and a ring around it, with the level as a membrane through the ring.
Patch patch_of(const Region& own, const Image<float>& relief_mm, const Mask& wide, const Mask& intact,
               const Image<float>& depth_px, int rim_px, int ring_px) {
    const int margin = rim_px + ring_px + 2;
    Patch patch;
    patch.box = {std::max(own.x0 - margin, 0), std::max(own.y0 - margin, 0),
                 std::min(own.x1 + margin, wide.width()), std::min(own.y1 + margin, wide.height())};
    patch.unknown = Mask(patch.box.width(), patch.box.height());
    patch.level_mm = Image<float>(patch.box.width(), patch.box.height());
    for (int y = patch.box.y0; y < patch.box.y1; ++y)
        for (int x = patch.box.x0; x < patch.box.x1; ++x) {
            patch.level_mm(x - patch.box.x0, y - patch.box.y0) = relief_mm(x, y);
            // Other damage around tells no level either.
            const bool known = wide(x, y) <= 0.5f && (intact.empty() || intact(x, y) > 0.5f);
            patch.unknown(x - patch.box.x0, y - patch.box.y0) = known ? 0.0f : 1.0f;
            if (known && -depth_px(x, y) <= static_cast<float>(ring_px)) patch.ring.push_back({x, y});
        }
    if (patch.ring.size() < 8)
        fail(
            "the loss at pixel ({}, {}) has nothing intact around it to take its level from; leave some of "
            "the "
            "painting round it out of the masks of damage, or fill it in parts",
            own.x0, own.y0);
    solve_membrane(patch.level_mm, patch.unknown);
    return patch;
}

// [mm] rms of the steps from the outermost pixels of the regions to the nearest ones past the rim.
double border_rms_mm(const Image<float>& filled_mm, const Mask& loss, const Mask& wide, int past_px) {
    double steps = 0, count = 0;
    for (int y = 0; y < loss.height(); ++y)
        for (int x = 0; x < loss.width(); ++x) {
            if (!(loss(x, y) > 0.5f)) continue;
            constexpr std::array<std::array<int, 2>, 4> sides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
            for (const auto& [dx, dy] : sides) {
                const int nx = x + dx, ny = y + dy, ox = x + past_px * dx, oy = y + past_px * dy;
                if (ox < 0 || oy < 0 || ox >= loss.width() || oy >= loss.height() || loss(nx, ny) > 0.5f ||
                    wide(ox, oy) > 0.5f)
                    continue;
                const auto step = static_cast<double>(filled_mm(x, y) - filled_mm(ox, oy));
                steps += step * step;
                count += 1;
            }
        }
    return count > 0 ? std::sqrt(steps / count) : 0;
}

Pigment clear_resin(const VarnishOptions& o) {
    Pigment resin;
    resin.name = fmt::format("varnish (rho_s {:.3g}, alpha {:.3g})", o.specular, o.roughness);
    resin.origin = PigmentOrigin::colour;
    resin.specular = static_cast<float>(o.specular);
    resin.roughness = static_cast<float>(o.roughness);
    for (std::size_t band = 0; band < kBands; ++band)  // falls off exponentially, as of aged resins
        resin.k[band] = static_cast<float>(
            o.yellowing * std::pow(0.1, static_cast<double>(kBand_nm[band] - kBand_nm[0]) / 220));
    return resin;
}

}  // namespace

std::string_view name_of(FillTexture texture) {
    constexpr std::array<std::string_view, 4> names = {"smooth", "surroundings", "weave", "patches"};
    return names[static_cast<std::size_t>(texture)];
}

std::optional<FillTexture> fill_texture_named(std::string_view name) {
    for (const FillTexture t :
         {FillTexture::smooth, FillTexture::surroundings, FillTexture::weave, FillTexture::patches})
        if (name_of(t) == name) return t;
    return {};
}

Image<float> relief_of(const Canvas& canvas) {
    Image<float> relief(canvas.width(), canvas.height());
    canvas.relief_mm(canvas.region(), relief.data(), static_cast<std::size_t>(relief.width()));
    return relief;
}

void add_layer(Canvas& canvas, const std::string& name, const Pigment& paint,
               const Image<float>& thickness_mm, bool levels) {
    TP_REQUIRE(thickness_mm.region() == canvas.region(), "a layer has the size of its canvas");
    const IngredientId id = canvas.add(paint);
    PaintLayer layer(canvas.width(), canvas.height());
    for (int ty = 0; ty < layer.rows(); ++ty)
        for (int tx = 0; tx < layer.columns(); ++tx) {
            const Region region = layer.region_of({tx, ty});
            bool any = false;
            for (int y = region.y0; y < region.y1 && !any; ++y)
                for (int x = region.x0; x < region.x1 && !any; ++x) any = thickness_mm(x, y) > 0;
            if (!any) continue;
            const std::span<float> plane = layer.writable({tx, ty}).writable_plane(id);
            for (int y = region.y0; y < region.y1; ++y)
                for (int x = region.x0; x < region.x1; ++x)
                    plane[static_cast<std::size_t>((y - region.y0) * kSize + x - region.x0)] =
                        std::max(thickness_mm(x, y), 0.0f);
            canvas.mark_dirty({tx, ty});
        }
    canvas.writable_dried().push_back({name, std::move(layer), levels});
}

FillReport lay_fill(Canvas& canvas, const std::string& name, const Mask& loss, const Mask& intact,
                    FillTexture texture, const Rgb& colour, const FillOptions& options,
                    const Progress& progress) {
    validate(options);
    TP_REQUIRE(loss.region() == canvas.region() && (intact.empty() || intact.region() == canvas.region()),
               "a mask has the size of its canvas");
    const double mm = canvas.mm_per_pixel();
    const MaskRegions regions = regions_of(loss);
    if (regions.regions.empty())
        fail("there is nothing to fill: the mask is empty, or covers no pixel by half");
    const Image<float> relief = relief_of(canvas);
    const double rim_px = std::max(options.rim_mm / mm, 1.5);
    const Mask wide = dilated(loss, rim_px);
    const Image<float> depth_px = distance_inside_px(wide);
    const bool weave = texture == FillTexture::weave;
    const double fine_px = weave ? std::max(options.weave_mm / mm, 1.0) : std::max(2 / mm, 4.0);
    const int rim = static_cast<int>(std::ceil(rim_px));
    const int ring_px = weave ? static_cast<int>(std::ceil(3 * fine_px)) : 3 + rim;

    // First the level everywhere, so that no step of a loss is taken for relief.
    std::vector<Patch> patches;
    Image<float> levelled = relief;
    FillReport result;
    for (const MaskRegion& region : regions.regions) {
        report(progress, "fill",
               0.5 * static_cast<double>(patches.size()) / static_cast<double>(regions.regions.size()));
        patches.push_back(patch_of(region.box, relief, wide, intact, depth_px, rim, ring_px));
        const Patch& patch = patches.back();
        for (int y = patch.box.y0; y < patch.box.y1; ++y)
            for (int x = patch.box.x0; x < patch.box.x1; ++x)
                if (wide(x, y) > 0.5f) levelled(x, y) = patch.level_mm(x - patch.box.x0, y - patch.box.y0);
    }
    if (texture != FillTexture::smooth) {
        const Mask everywhere(loss.width(), loss.height(), 1.0f);
        const Mask usable = without(intact.empty() ? everywhere : intact, wide);
        const Image<float> detail = fine_relief(levelled, fine_px);
        const int reach = static_cast<int>(std::ceil(std::min(options.search_mm / mm, 400.0)));
        for (std::size_t i = 0; i < patches.size() && texture == FillTexture::patches; ++i) {
            report(progress, "fill",
                   0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(patches.size()));
            if (!add_patches(patches[i], canvas.dry(), levelled, {detail, usable}, wide, reach, progress))
                ++result.smooth_regions;
        }
        const Ramp flush{static_cast<float>(rim_px), static_cast<float>(rim_px + 1.5 / mm)};
        std::mutex reporting;
        std::size_t done = 0;
        const int searched = texture == FillTexture::patches ? 0 : static_cast<int>(patches.size());
        parallel_for(0, searched, 1, [&](int begin, int end) {
            int smooth = 0;
            for (int i = begin; i < end; ++i) {
                Patch& patch = patches[static_cast<std::size_t>(i)];
                const Shift shift = best_shift(patch, {detail, usable}, reach, fine_px / 4);
                if (shift.found)
                    add_relief(patch, shift, weave ? detail : levelled, depth_px, weave ? Ramp{} : flush);
                else
                    ++smooth;
            }
            const std::lock_guard lock(reporting);
            result.smooth_regions += smooth;
            done += static_cast<std::size_t>(end - begin);
            report(progress, "fill",
                   0.5 + 0.5 * static_cast<double>(done) / static_cast<double>(patches.size()));
        });
    }

    result.regions = static_cast<int>(patches.size());
    result.area_mm2 = area_of(loss, mm).mm2;
    Image<float> thickness(canvas.width(), canvas.height()), filled = relief;
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const Region& own = regions.regions[i].box;
        for (int y = own.y0; y < own.y1; ++y)
            for (int x = own.x0; x < own.x1; ++x) {
                if (regions.number(x, y) != static_cast<int>(i) + 1) continue;
                const float level = patches[i].level_mm(x - patches[i].box.x0, y - patches[i].box.y0);
                const float wanted = level + static_cast<float>(options.offset_mm) - relief(x, y);
                ++result.pixels;
                result.not_reached += wanted < kNothing_mm ? 1 : 0;
                thickness(x, y) = wanted < kNothing_mm ? 0.0f : wanted;
                filled(x, y) += thickness(x, y);
                result.deepest_mm = std::max(result.deepest_mm, static_cast<double>(thickness(x, y)));
                result.volume_mm3 += static_cast<double>(thickness(x, y)) * mm * mm;
            }
    }
    result.border_rms_mm = border_rms_mm(filled, loss, wide, rim + 1);
    Pigment body =
        pigment_of_rgb(fmt::format("fill ({:.3g}, {:.3g}, {:.3g})", colour.r, colour.g, colour.b), colour);
    body.specular = static_cast<float>(options.specular);
    body.roughness = static_cast<float>(options.roughness);
    add_layer(canvas, name, body, thickness, true);
    report(progress, "fill", 1);
    return result;
}

void lay_varnish(Canvas& canvas, const std::string& name, const Mask& area, const VarnishOptions& options) {
    validate(options);
    TP_REQUIRE(area.region() == canvas.region(), "a mask has the size of its canvas");
    Image<float> thickness = area;
    for (float& t : thickness.pixels()) t *= static_cast<float>(options.thickness_mm);
    add_layer(canvas, name, clear_resin(options), thickness, false);
}

}  // namespace tangi
