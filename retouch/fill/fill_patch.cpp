#include "retouch/fill/fill_patch.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "retouch/fill/fill.h"
#include "retouch/fill/surroundings.h"
#include "retouch/fill/texture_synthesis.h"
#include "surface/base/error.h"
#include "surface/base/noise.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr int kMostShifts = 160;  // along a side, that are tried first

// What a patch is compared by, with the same pixels of another place.
struct PatchPixels {
    std::vector<std::array<int, 2>> inside;  // of the canvas: those of the patch, to see that they are usable
    std::vector<std::array<int, 2>> ring;    // some of the ring around it
};

PatchPixels pixels_of(const FillPatch& patch) {
    PatchPixels pixels;
    for (int y = 0; y < patch.unknown.height(); ++y)
        for (int x = 0; x < patch.unknown.width(); ++x)
            if (patch.unknown(x, y) > 0.5f) pixels.inside.push_back({patch.box.x0 + x, patch.box.y0 + y});
    const std::size_t step = std::max<std::size_t>(patch.ring.size() / 400, 1);
    for (std::size_t i = 0; i < patch.ring.size(); i += step) pixels.ring.push_back(patch.ring[i]);
    return pixels;
}

// The best of the places that were tried: least mean squared difference of the fine relief on the ring, of
// which half must be usable there, and all of the patch.
class ShiftSearch {
public:
    ShiftSearch(const FillPatch& patch, const ReliefSource& source)
        : pixels_(pixels_of(patch)), source_(source) {}

    void search(const Region& shifts, int stride) {
        for (int dy = shifts.y0; dy < shifts.y1; dy += stride)
            for (int dx = shifts.x0; dx < shifts.x1; dx += stride) try_shift(dx, dy);
    }
    const ReliefShift& best() const { return best_; }

private:
    bool usable(int x, int y) const {
        const Mask& usable = source_.usable;
        return x >= 0 && y >= 0 && x < usable.width() && y < usable.height() && usable(x, y) > 0.5f;
    }

    void try_shift(int dx, int dy) {
        const auto& [inside, ring] = pixels_;
        const auto usable_there = [&](const auto& p) { return usable(p[0] + dx, p[1] + dy); };
        if (!usable_there(inside.front()) || !usable_there(inside.back())) return;
        double sum = 0;
        std::size_t seen = 0;
        for (const auto& [x, y] : ring) {
            if (!usable(x + dx, y + dy)) continue;
            const auto d = static_cast<double>(source_.detail_mm(x + dx, y + dy) - source_.detail_mm(x, y));
            sum += d * d;
            ++seen;
            if (sum >= least_ * static_cast<double>(ring.size())) break;
        }
        if (2 * seen < ring.size() || sum >= least_ * static_cast<double>(seen)) return;
        if (!std::all_of(inside.begin(), inside.end(), usable_there)) return;
        least_ = sum / static_cast<double>(seen);
        best_ = {dx, dy, true};
    }

    PatchPixels pixels_;
    const ReliefSource& source_;
    ReliefShift best_;
    double least_ = 1e30;
};

// The part of the canvas that a patch is made from, with what has to go on from the rim.
struct SynthesisScene {
    Region box;
    Mask hole, usable;
    std::vector<SynthesisChannel> channels;  // relief, L*, a*, b*, logarithm of alpha
};

SynthesisScene scene_of(const FillPatch& patch, const Surface& dry, const ReliefSource& s) {
    const int reach = s.reach_px;
    SynthesisScene scene;
    scene.box = {std::max(patch.box.x0 - reach, 0), std::max(patch.box.y0 - reach, 0),
                 std::min(patch.box.x1 + reach, s.usable.width()),
                 std::min(patch.box.y1 + reach, s.usable.height())};
    const Region& box = scene.box;
    scene.hole = scene.usable = Mask(box.width(), box.height());
    scene.channels.assign(5, {scene.hole});
    for (int y = 0; y < box.height(); ++y)
        for (int x = 0; x < box.width(); ++x) {
            const int u = x + box.x0, v = y + box.y0;
            scene.usable(x, y) = s.usable(u, v);
            scene.hole(x, y) = s.usable(u, v) > 0.5f ? 0.0f : 1.0f;
            const Lab lab = lab_from_linear(glm::dvec3(glm::max(dry.diffuse(u, v), Rgb(0))));
            scene.channels[0].values(x, y) = s.detail_mm(u, v);
            scene.channels[1].values(x, y) = static_cast<float>(lab.l);
            scene.channels[2].values(x, y) = static_cast<float>(lab.a);
            scene.channels[3].values(x, y) = static_cast<float>(lab.b);
            scene.channels[4].values(x, y) = std::log(std::max(dry.roughness(u, v), 1e-3f));
        }
    return scene;
}

// Each channel in units of its own: relief counts as much as colour; gloss, which is noisier, half as much.
// Gives the relief's unit [mm].
float make_comparable(SynthesisScene& scene) {
    auto& channels = scene.channels;
    const Mask& usable = scene.usable;
    const float relief = std::max(spread_of(channels[0].values, usable), 1e-6f);
    const float colour =
        std::max({spread_of(channels[1].values, usable), spread_of(channels[2].values, usable),
                  spread_of(channels[3].values, usable), 1e-3f});
    const float gloss = 2 * std::max(spread_of(channels[4].values, usable), 1e-3f);
    const std::array<float, 5> units = {relief, colour, colour, colour, gloss};
    for (std::size_t c = 0; c < channels.size(); ++c)
        for (float& value : channels[c].values.pixels()) value /= units[c];
    return relief;
}

}  // namespace

FillPatch patch_of(const Region& own, const FillGround& ground) {
    const auto& [relief_mm, wide, intact, depth_px, rim_px, ring_px] = ground;
    const int margin = rim_px + ring_px + 2;
    FillPatch patch;
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

ReliefShift best_shift(const FillPatch& patch, const ReliefSource& source, double phase_px) {
    ShiftSearch places(patch, source);
    const int reach = source.reach_px;
    const int stride = std::clamp(static_cast<int>(phase_px), 1, std::max(2 * reach / kMostShifts, 1));
    places.search({-reach, -reach, reach + 1, reach + 1}, stride);
    const ReliefShift best = places.best();
    if (best.found && stride > 1)
        places.search({best.x - stride + 1, best.y - stride + 1, best.x + stride, best.y + stride}, 1);
    return places.best();
}

Image<float> fine_relief(const Image<float>& height_mm, double sigma_px) {
    Image<float> detail(height_mm.width(), height_mm.height());
    cv::Mat smooth;
    cv::GaussianBlur(view_of(height_mm), smooth, {}, sigma_px, sigma_px, cv::BORDER_REFLECT);
    for (int y = 0; y < detail.height(); ++y)
        for (int x = 0; x < detail.width(); ++x) detail(x, y) = height_mm(x, y) - smooth.at<float>(y, x);
    return detail;
}

void add_relief(FillPatch& patch, const ReliefShift& shift, const Image<float>& source_mm,
                const Image<float>& depth_px, const ReliefRamp& ramp) {
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

bool add_patches(FillPatch& patch, const Surface& dry, const Image<float>& levelled_mm,
                 const ReliefSource& source, const Mask& wide, const Progress& progress) {
    SynthesisScene scene = scene_of(patch, dry, source);
    const float relief = make_comparable(scene);
    if (!synthesise_into(scene.channels, scene.hole, scene.usable, {}, progress)) return false;
    for (int y = patch.box.y0; y < patch.box.y1; ++y)
        for (int x = patch.box.x0; x < patch.box.x1; ++x)
            if (wide(x, y) > 0.5f)
                patch.level_mm(x - patch.box.x0, y - patch.box.y0) =
                    levelled_mm(x, y) - source.detail_mm(x, y) +
                    relief * scene.channels[0].values(x - scene.box.x0, y - scene.box.y0);
    return true;
}

}  // namespace tangi
