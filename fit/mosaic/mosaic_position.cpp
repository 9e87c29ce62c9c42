#include "fit/mosaic/mosaic_position.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "surface/image/local_contrast.h"
#include "surface/maps/surface_part.h"
#include "surface/provenance/fit_doubts.h"

namespace tangi {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr int kOverviewSize = 2400;   // [pixels] twice that in which features are sought
constexpr double kPaintFloor = 0.02;  // [1] of rho_d: darker paint has little contrast to register by
// [1] Of local contrast of relief: curvature counts in these parts of its scale, up to so many of it.
constexpr float kReliefPart = 0.2f, kMostRelief = 3;

// Means of what was measured, per pixel of the reduction.
struct Means {
    Image<float> paint, x, y;  // luminance of rho_d, slopes; NaN where nothing was measured
};

Means means_of(const Surface& s, int reduction) {
    const int width = s.width() / reduction, height = s.height() / reduction;
    Means means{Image<float>(width, height, kNone), Image<float>(width, height, kNone),
                Image<float>(width, height, kNone)};
    for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) {
            float paint = 0, x = 0, y = 0, count = 0;
            for (int j = v * reduction; j < (v + 1) * reduction; ++j)
                for (int i = u * reduction; i < (u + 1) * reduction; ++i) {
                    if (!(s.confidence(i, j) > 0)) continue;
                    const Slope slope = slope_of(s.normal(i, j));
                    paint += luminance(s.diffuse(i, j)), x += slope.x, y += slope.y, ++count;
                }
            if (count > 0)
                means.paint(u, v) = paint / count, means.x(u, v) = x / count, means.y(u, v) = y / count;
        }
    return means;
}

// [1 a pixel] Divergence of the slopes, y up; NaN at the border.
Image<float> curvature_of(const Means& means) {
    const int width = means.x.width(), height = means.x.height();
    Image<float> curvature(width, height, kNone);
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x)
            curvature(x, y) =
                (means.x(x + 1, y) - means.x(x - 1, y) + means.y(x, y - 1) - means.y(x, y + 1)) / 2;
    return curvature;
}

// Curvature about 1, in parts of its median size.
Image<float> relief_of(const Means& means) {
    Image<float> relief = curvature_of(means);
    std::vector<float> sizes;
    for (const float c : relief.pixels())
        if (std::isfinite(c)) sizes.push_back(std::abs(c));
    if (sizes.empty()) return relief;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const float scale = std::max(1.5f * *middle, 1e-6f);  // 1 / 0.6745: normal distribution
    for (float& c : relief.pixels()) c = 1 + kReliefPart * std::clamp(c / scale, -kMostRelief, kMostRelief);
    return relief;
}

void fill_unknown(Image<float>& image, float with) {
    for (float& value : image.pixels())
        if (!std::isfinite(value)) value = with;
}

void copy_rows(const Image<float>& from, int y, Image<float>& to) {
    for (int row = 0; row < from.height() && y + row < to.height(); ++row)
        std::ranges::copy(from.row(row), to.row(y + row).begin());
}

}  // namespace

MosaicPosition position_of(std::string name, std::shared_ptr<const Surface> surface,
                           std::shared_ptr<const FitErrors> errors, std::string hash) {
    MosaicPosition position;
    position.name = std::move(name);
    position.width = surface->width(), position.height = surface->height();
    position.mm_per_pixel = surface->mm_per_pixel, position.scale_known = surface->scale_known;
    position.reflectance_model = surface->reflectance_model;
    position.white_level = surface->photography.white_level;
    position.poor = poor_of(*surface);
    position.has_specular_colour = !surface->specular_colour.empty();
    position.has_lobe_axes = !surface->lobe_axes.empty();
    position.has_errors = errors != nullptr;
    position.hash = std::move(hash);
    position.read = [surface = std::move(surface), errors = std::move(errors)](const Region& part) {
        MosaicPart read{cut(*surface, part), {}};
        if (!errors) return read;
        read.errors.slope = cut(errors->slope, part);
        read.errors.diffuse = cut(errors->diffuse, part);
        read.errors.specular = cut(errors->specular, part);
        read.errors.roughness = cut(errors->roughness, part);
        read.errors.height = cut(errors->height, part);
        return read;
    };
    return position;
}

glm::dvec2 PositionLook::reduced(const glm::dvec2& p) const {
    return (p - glm::dvec2(part.x0, part.y0) + 0.5) / double(reduction) - 0.5;
}

PositionOverview overview_of(const MosaicPosition& position) {
    PositionOverview overview;
    const int longest = std::max(position.width, position.height);
    const int reduction = overview.reduction = (longest + kOverviewSize - 1) / kOverviewSize;
    const int width = position.width / reduction, height = position.height / reduction;
    Means all{Image<float>(width, height), Image<float>(width, height), Image<float>(width, height)};
    const int band = std::max(kBandPixels / position.width / reduction, 1);
    for (int y = 0; y < height; y += band) {
        const int end = std::min(y + band, height);
        const Means means = means_of(
            position.read({0, y * reduction, width * reduction, end * reduction}).surface, reduction);
        copy_rows(means.paint, y, all.paint);
        copy_rows(means.x, y, all.x);
        copy_rows(means.y, y, all.y);
    }
    overview.relief = relief_of(all);
    overview.paint = std::move(all.paint);
    fill_unknown(overview.paint, 0);
    fill_unknown(overview.relief, 1);
    return overview;
}

PositionLook look_at(const MosaicPosition& position, const Region& part, int reduction) {
    const auto whole = [&](int value, int most) {
        return std::clamp(value, 0, most) / reduction * reduction;
    };
    PositionLook look{{whole(part.x0, position.width), whole(part.y0, position.height),
                       whole(part.x1, position.width), whole(part.y1, position.height)},
                      reduction,
                      {},
                      {}};
    if (look.part.empty()) return look;
    const Means means = means_of(position.read(look.part).surface, reduction);
    look.paint = local_contrast(means.paint, kPaintFloor);
    look.relief = local_contrast(relief_of(means), 0);
    return look;
}

}  // namespace tangi
