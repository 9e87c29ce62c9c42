// picture_collector.cpp: overviews and patches of photographs, gathered from bands.
#include <algorithm>
#include <cmath>

#include "capture/registration.h"
#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr std::size_t kBytes = 96u << 20;      // for the overviews, and again for the patches
constexpr double kMostOverviewPixels = 1.0e6;  // of an overview
constexpr int kPatch = 80;                     // [pixels] side of a patch

}  // namespace

PictureCollector::PictureCollector(const Stack& stack)
    : photos_(static_cast<int>(stack.photos.size())),
      width_(stack.width()),
      height_(stack.height()),
      corner_(stack.crop.x0, stack.crop.y0) {
    if (photos_ == 0) return;
    const double budget = static_cast<double>(kBytes) / sizeof(float) / photos_;
    const double area = static_cast<double>(width_) * height_;
    const int r =
        std::max(1, static_cast<int>(std::ceil(std::sqrt(area / std::min(budget, kMostOverviewPixels)))));
    overview_.reduction = r;
    overview_.origin = corner_ + glm::dvec2((r - 1) / 2.0);
    const Image<float> empty((width_ + r - 1) / r, (height_ + r - 1) / r);
    overview_.pictures.assign(static_cast<std::size_t>(photos_), empty);
    counts_.assign(1, empty);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) counts_[0](x / r, y / r) += 1;
    if (r == 1) return;
    const int side = std::clamp(static_cast<int>(std::sqrt(budget / (kPatch * kPatch))), 2, 12);
    const int columns = std::min(side, width_ / kPatch), rows = std::min(side, height_ / kPatch);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            AlignmentWindow patch;
            patch.origin = corner_ + glm::floor(glm::dvec2(width_ * (i + 0.5) / columns - kPatch / 2.0,
                                                           height_ * (j + 0.5) / rows - kPatch / 2.0));
            patch.pictures.assign(static_cast<std::size_t>(photos_), Image<float>(kPatch, kPatch));
            patches_.push_back(std::move(patch));
        }
}

void PictureCollector::keep(const std::vector<bool>& kept) {
    TP_REQUIRE(static_cast<int>(kept.size()) == photos_, "one flag a photograph");
    const auto thin_out = [&](AlignmentWindow& window) {
        std::vector<Image<float>> pictures;
        for (std::size_t i = 0; i < kept.size(); ++i)
            if (kept[i]) pictures.push_back(std::move(window.pictures[i]));
        window.pictures = std::move(pictures);
    };
    thin_out(overview_);
    for (AlignmentWindow& patch : patches_) thin_out(patch);
    photos_ = static_cast<int>(std::count(kept.begin(), kept.end(), true));
}

void PictureCollector::add(const Band& band) {
    TP_REQUIRE(band.photos() == photos_ && (photos_ == 0 || band.width() == width_), "a band of this stack");
    const int r = static_cast<int>(overview_.reduction);
    parallel_for(0, photos_, 1, [&](int begin, int end) {
        std::vector<float> grey(static_cast<std::size_t>(width_));
        for (int i = begin; i < end; ++i)
            for (int y = band.y0(); y < band.y1(); ++y) {
                const auto photo = static_cast<std::size_t>(i);
                std::fill(grey.begin(), grey.end(), 0.0f);
                for (int c = 0; c < band.channels(); ++c) {
                    const float* row = band.row(i, c, y);
                    for (int x = 0; x < width_; ++x) grey[static_cast<std::size_t>(x)] += row[x];
                }
                // What lies outside a warped photograph is dark, and so without edges beyond its own.
                for (float& value : grey)
                    value = std::isnan(value) ? 0 : value / static_cast<float>(band.channels());
                float* const reduced = &overview_.pictures[photo](0, y / r);
                const float* const counts = &counts_[0](0, y / r);
                for (int x = 0, column = 0; x < width_; ++column)
                    for (const int next = std::min(x + r, width_); x < next; ++x)
                        reduced[column] += grey[static_cast<std::size_t>(x)] / counts[column];
                for (AlignmentWindow& patch : patches_) {
                    const int x0 = static_cast<int>(patch.origin.x - corner_.x);
                    const int row = y - static_cast<int>(patch.origin.y - corner_.y);
                    if (row < 0 || row >= kPatch) continue;
                    std::copy_n(&grey[static_cast<std::size_t>(x0)], kPatch, &patch.pictures[photo](0, row));
                }
            }
    });
}

}  // namespace tangi
