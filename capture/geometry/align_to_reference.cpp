#include "capture/geometry/align_to_reference.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "capture/registration/motion.h"
#include "capture/registration/registration.h"
#include "surface/base/error.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

using glm::dvec2;

constexpr double kMostPixels = 16e6;  // in which pictures are registered; larger ones are reduced
constexpr std::size_t kPhotographs = 12;

int reduction_of(double width, double height) {
    return std::max(1, static_cast<int>(std::ceil(std::sqrt(width * height / kMostPixels))));
}

Image<float> reduced(const Image<float>& image, int factor) {
    Image<float> result(image.width() / factor, image.height() / factor);
    cv::resize(view_of(image)({0, 0, result.width() * factor, result.height() * factor}), view_of(result),
               {result.width(), result.height()}, 0, 0, cv::INTER_AREA);
    return result;
}

// The mean luminance of photographs spread over the stack, each by its own mean, since lights differ; read in
// strips that become rows of the reduced picture.
Image<float> mean_of(const PhotoSet& photos, int factor, const Transfer& transfer, const Progress& progress) {
    const std::size_t count = std::min(photos.size(), kPhotographs);
    Image<float> mean;
    for (std::size_t i = 0; i < count; ++i) {
        report(progress, "looking for the painting", static_cast<double>(i) / static_cast<double>(count));
        PhotoSet::Reader reader = photos.open(i * photos.size() / count);
        const PhotoHeader& header = reader.header();
        Image<float> strip(header.width, factor), picture(header.width / factor, header.height / factor);
        double sum = 0;
        for (int y = 0; y < picture.height(); ++y) {
            const Image<Rgb> rows = reader.linear_rows(y * factor, (y + 1) * factor, transfer);
            std::transform(rows.pixels().begin(), rows.pixels().end(), strip.pixels().begin(),
                           [](const Rgb& c) { return std::isfinite(luminance(c)) ? luminance(c) : 0; });
            const Image<float> row = reduced(strip, factor);
            std::copy(row.pixels().begin(), row.pixels().end(), &picture(0, y));
            for (const float pixel : row.pixels()) sum += pixel;
        }
        if (mean.empty()) mean = Image<float>(picture.width(), picture.height());
        if (!(sum > 0)) continue;  // black
        const double weight = static_cast<double>(picture.size()) / sum;
        for (std::size_t k = 0; k < mean.size(); ++k)
            mean.pixels()[k] += static_cast<float>(weight * picture.pixels()[k]);
    }
    report(progress, "looking for the painting", 1);
    return mean;
}

Lens reduced(Lens lens, int factor) {
    lens.width /= factor, lens.height /= factor;
    lens.focal_px /= factor;
    lens.principal_px = (lens.principal_px + 0.5) / static_cast<double>(factor) - 0.5;
    return lens;
}

Image<float> without(const Lens& lens, const Image<float>& picture) {
    const Image<glm::vec2> map = undistortion_map(lens, picture.width(), picture.height());
    const cv::Mat places(map.height(), map.width(), CV_32FC2, const_cast<glm::vec2*>(map.data()));
    Image<float> result(picture.width(), picture.height());
    cv::remap(view_of(picture), view_of(result), places, {}, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
    return result;
}

}  // namespace

EarlierPainting earlier_painting(const Surface& surface) {
    EarlierPainting earlier{Image<float>(surface.width(), surface.height())};
    std::transform(surface.diffuse.pixels().begin(), surface.diffuse.pixels().end(),
                   earlier.brightness.pixels().begin(), [](const Rgb& c) { return luminance(c); });
    if (surface.scale_known) earlier.mm_per_pixel = surface.mm_per_pixel;
    return earlier;
}

FoundPainting find_painting(const PhotoSet& photos, const EarlierPainting& painting,
                            const std::optional<Lens>& lens, const Transfer& transfer,
                            const Progress& progress) {
    const PhotoHeader header = photos.open(0).header();
    const int factor = reduction_of(header.width, header.height);
    const int before = reduction_of(painting.brightness.width(), painting.brightness.height());
    Image<float> mean = mean_of(photos, factor, transfer, progress);
    if (lens) mean = without(reduced(*lens, factor), mean);
    PhotoDrift drift;
    try {
        drift = register_pictures(reduced(painting.brightness, before), mean);
    } catch (const Error& error) {
        fail("{}: the painting is not found in these photographs: {}", photos.folder().string(),
             error.what());
    }
    FoundPainting found;
    found.to_photo = normalised(enlarging(factor) * drift.homography * glm::inverse(enlarging(before)));
    found.error_px = drift.error_px * factor;
    found.correlation = drift.correlation;
    return found;
}

Scale scale_from(const EarlierPainting& painting, const FoundPainting& found) {
    TP_REQUIRE(painting.mm_per_pixel, "the painting's scale is known");
    const dvec2 size(painting.brightness.width(), painting.brightness.height()), middle = (size - 1.0) / 2.0;
    const double magnified = mm_per_pixel_at(found.to_photo, mapped(found.to_photo, middle));
    const double mm = *painting.mm_per_pixel * magnified;
    // The error of a distance as long as the painting.
    const double part = std::numbers::sqrt2 * found.error_px * magnified / std::max(size.x, size.y);
    return {.mm_per_pixel = mm,
            .sigma = mm * part,
            .place_px = mapped(found.to_photo, middle),
            .method = "painting"};
}

}  // namespace tangi
