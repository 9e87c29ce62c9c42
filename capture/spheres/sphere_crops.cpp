#include "capture/spheres/sphere_crops.h"

#include <algorithm>
#include <cmath>

#include "surface/base/parallel.h"

namespace tangi {

using glm::dvec2;

bool SphereCrops::holds(const dvec2& pixel, double margin) const {
    return pixel.x >= region.x0 + margin && pixel.y >= region.y0 + margin &&
           pixel.x <= region.x1 - 1 - margin && pixel.y <= region.y1 - 1 - margin;
}

float SphereCrops::value(std::size_t photo, const dvec2& pixel) const {
    const Image<float>& picture = photos[photo];
    const double px = pixel.x - region.x0, py = pixel.y - region.y0;
    const int x = static_cast<int>(std::floor(px)), y = static_cast<int>(std::floor(py));
    const float u = static_cast<float>(px - x), v = static_cast<float>(py - y);
    return (1 - v) * ((1 - u) * picture.clamped(x, y) + u * picture.clamped(x + 1, y)) +
           v * ((1 - u) * picture.clamped(x, y + 1) + u * picture.clamped(x + 1, y + 1));
}

std::vector<SphereCrops> read_sphere_crops(const PhotoSet& set, const GreyPhotos& photos,
                                           const CameraMotions& drifts, std::span<const SphereImage> spheres,
                                           const Progress& progress) {
    std::vector<SphereCrops> crops(spheres.size());
    for (std::size_t b = 0; b < spheres.size(); ++b) {
        const double reach = 1.5 * spheres[b].radius_px + 6;
        const auto bound = [](double value, int end) {
            return std::clamp(static_cast<int>(std::lround(value)), 0, end);
        };
        crops[b] = {.region = {bound(spheres[b].centre_px.x - reach, photos.width),
                               bound(spheres[b].centre_px.y - reach, photos.height),
                               bound(spheres[b].centre_px.x + reach, photos.width),
                               bound(spheres[b].centre_px.y + reach, photos.height)},
                    .photos = std::vector<Image<float>>(set.size()),
                    .drift = drifts.photos,
                    .picture_centre = {(photos.width - 1) / 2.0, (photos.height - 1) / 2.0},
                    .step = photos.step};
    }
    const int count = static_cast<int>(set.size()), batch = std::max(2, thread_count());
    for (int first = 0; first < count; first += batch) {
        report(progress, "spheres", first / static_cast<double>(count));
        parallel_for(first, std::min(first + batch, count), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i)
                for (SphereCrops& crop : crops)
                    crop.photos[static_cast<std::size_t>(i)] =
                        read_grey_region(set, static_cast<std::size_t>(i), crop.region);
        });
    }
    report(progress, "spheres", 1);
    return crops;
}

}  // namespace tangi
