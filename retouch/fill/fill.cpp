#include "retouch/fill/fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "retouch/fill/fill_patch.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr float kNothing_mm = 1e-5f;  // rounding of heights of some mm: what was filled before is level

constexpr int kSize = PaintTile::kSize;

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

Pigment body_of(const Filling& filling) {
    const Rgb& colour = filling.colour;
    Pigment body =
        pigment_of_rgb(fmt::format("fill ({:.3g}, {:.3g}, {:.3g})", colour.r, colour.g, colour.b), colour);
    body.specular = static_cast<float>(filling.options.specular);
    body.roughness = static_cast<float>(filling.options.roughness);
    return body;
}

MaskRegions regions_to_fill(const Mask& loss) {
    MaskRegions regions = regions_of(loss);
    if (regions.regions.empty())
        fail("there is nothing to fill: the mask is empty, or covers no pixel by half");
    return regions;
}

// A loss that is being filled, region by region.
class LossFill {
public:
    LossFill(const Canvas& canvas, const Mask& loss, const Mask& intact, const Filling& filling)
        : canvas_(canvas),
          loss_(loss),
          intact_(intact),
          texture_(filling.texture),
          options_(filling.options),
          mm_(canvas.mm_per_pixel()),
          regions_(regions_to_fill(loss)),
          relief_(relief_of(canvas)),
          rim_px_(std::max(options_.rim_mm / mm_, 1.5)),
          wide_(dilated(loss, rim_px_)),
          depth_px_(distance_inside_px(wide_)),
          fine_px_(weave() ? std::max(options_.weave_mm / mm_, 1.0) : std::max(2 / mm_, 4.0)),
          levelled_(relief_) {}

    // First the level everywhere, so that no step of a loss is taken for relief.
    void level(const Progress& progress) {
        const int ring_px = weave() ? static_cast<int>(std::ceil(3 * fine_px_)) : 3 + rim();
        const FillGround ground{relief_, wide_, intact_, depth_px_, rim(), ring_px};
        for (const MaskRegion& region : regions_.regions) {
            report(progress, "fill",
                   0.5 * static_cast<double>(patches_.size()) / static_cast<double>(regions_.regions.size()));
            patches_.push_back(patch_of(region.box, ground));
            const FillPatch& patch = patches_.back();
            for (int y = patch.box.y0; y < patch.box.y1; ++y)
                for (int x = patch.box.x0; x < patch.box.x1; ++x)
                    if (wide_(x, y) > 0.5f)
                        levelled_(x, y) = patch.level_mm(x - patch.box.x0, y - patch.box.y0);
        }
    }

    void add_relief(const Progress& progress) {
        const Mask everywhere(loss_.width(), loss_.height(), 1.0f);
        const Mask usable = without(intact_.empty() ? everywhere : intact_, wide_);
        const Image<float> detail = fine_relief(levelled_, fine_px_);
        const int reach = static_cast<int>(std::ceil(std::min(options_.search_mm / mm_, 400.0)));
        const ReliefSource source{detail, usable, reach};
        if (texture_ == FillTexture::patches)
            make_relief(source, progress);
        else
            take_relief(source, progress);
    }

    // [mm] Of the fill at each pixel; counts it in `result`.
    Image<float> thickness(FillReport& result) const {
        result.smooth_regions = smooth_regions_;
        result.regions = static_cast<int>(patches_.size());
        result.area_mm2 = area_of(loss_, mm_).mm2;
        Image<float> thickness(canvas_.width(), canvas_.height()), filled = relief_;
        for (std::size_t i = 0; i < patches_.size(); ++i) {
            const Region& own = regions_.regions[i].box;
            for (int y = own.y0; y < own.y1; ++y)
                for (int x = own.x0; x < own.x1; ++x) {
                    if (regions_.number(x, y) != static_cast<int>(i) + 1) continue;
                    const float level = patches_[i].level_mm(x - patches_[i].box.x0, y - patches_[i].box.y0);
                    const float wanted = level + static_cast<float>(options_.offset_mm) - relief_(x, y);
                    ++result.pixels;
                    result.not_reached += wanted < kNothing_mm ? 1 : 0;
                    thickness(x, y) = wanted < kNothing_mm ? 0.0f : wanted;
                    filled(x, y) += thickness(x, y);
                    result.deepest_mm = std::max(result.deepest_mm, static_cast<double>(thickness(x, y)));
                    result.volume_mm3 += static_cast<double>(thickness(x, y)) * mm_ * mm_;
                }
        }
        result.border_rms_mm = border_rms_mm(filled, loss_, wide_, rim() + 1);
        return thickness;
    }

private:
    bool weave() const { return texture_ == FillTexture::weave; }
    int rim() const { return static_cast<int>(std::ceil(rim_px_)); }  // [pixels]

    // Of many places.
    void make_relief(const ReliefSource& source, const Progress& progress) {
        for (std::size_t i = 0; i < patches_.size(); ++i) {
            report(progress, "fill",
                   0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(patches_.size()));
            if (!add_patches(patches_[i], canvas_.dry(), levelled_, source, wide_, progress))
                ++smooth_regions_;
        }
    }

    // Of one place for each patch.
    void take_relief(const ReliefSource& source, const Progress& progress) {
        const ReliefRamp flush{static_cast<float>(rim_px_), static_cast<float>(rim_px_ + 1.5 / mm_)};
        std::mutex reporting;
        std::size_t done = 0;
        parallel_for(0, static_cast<int>(patches_.size()), 1, [&](int begin, int end) {
            int smooth = 0;
            for (int i = begin; i < end; ++i) {
                FillPatch& patch = patches_[static_cast<std::size_t>(i)];
                const ReliefShift shift = best_shift(patch, source, fine_px_ / 4);
                if (shift.found)
                    tangi::add_relief(patch, shift, weave() ? source.detail_mm : levelled_, depth_px_,
                                      weave() ? ReliefRamp{} : flush);
                else
                    ++smooth;
            }
            const std::lock_guard lock(reporting);
            smooth_regions_ += smooth;
            done += static_cast<std::size_t>(end - begin);
            report(progress, "fill",
                   0.5 + 0.5 * static_cast<double>(done) / static_cast<double>(patches_.size()));
        });
    }

    const Canvas& canvas_;
    const Mask &loss_, &intact_;
    const FillTexture texture_;
    const FillOptions& options_;
    const double mm_;
    const MaskRegions regions_;
    const Image<float> relief_;
    const double rim_px_;
    const Mask wide_;  // the loss with its rim
    const Image<float> depth_px_;
    const double fine_px_;  // relief that is finer goes on from elsewhere
    Image<float> levelled_;
    std::vector<FillPatch> patches_;
    int smooth_regions_ = 0;
};

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
                    const Filling& filling, const Progress& progress) {
    validate(filling.options);
    TP_REQUIRE(loss.region() == canvas.region() && (intact.empty() || intact.region() == canvas.region()),
               "a mask has the size of its canvas");
    LossFill fill(canvas, loss, intact, filling);
    fill.level(progress);
    if (filling.texture != FillTexture::smooth) fill.add_relief(progress);
    FillReport result;
    const Image<float> thickness = fill.thickness(result);
    add_layer(canvas, name, body_of(filling), thickness, true);
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
