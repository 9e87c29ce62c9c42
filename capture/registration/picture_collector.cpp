// picture_collector.cpp: overviews and patches of photographs, gathered from bands.
#include <algorithm>
#include <cmath>

#include "capture/registration/registration.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

constexpr std::size_t kBytes = 96u << 20;      // for the overviews, and again for the patches
constexpr double kMostOverviewPixels = 1.0e6;  // of an overview
constexpr int kPatch = 80;                     // [pixels] side of a patch

}  // namespace

RegistrationGrid::RegistrationGrid(const Stack& stack)
    : width(stack.width()), height(stack.height()), corner(stack.crop.x0, stack.crop.y0) {
    const std::size_t photos = stack.photos.size() + stack.held_out.size();
    if (photos == 0) return;
    const double budget = static_cast<double>(kBytes) / sizeof(float) / static_cast<double>(photos);
    const double area = static_cast<double>(width) * height;
    reduction =
        std::max(1, static_cast<int>(std::ceil(std::sqrt(area / std::min(budget, kMostOverviewPixels)))));
    if (reduction == 1) return;
    const int side = std::clamp(static_cast<int>(std::sqrt(budget / (kPatch * kPatch))), 2, 12);
    const int columns = std::min(side, width / kPatch), rows = std::min(side, height / kPatch);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            patches.emplace_back(static_cast<int>(std::floor(width * (i + 0.5) / columns - kPatch / 2.0)),
                                 static_cast<int>(std::floor(height * (j + 0.5) / rows - kPatch / 2.0)));
}

PictureCollector::PictureCollector(const Stack& stack)
    : PictureCollector(RegistrationGrid(stack), static_cast<int>(stack.photos.size())) {}

PictureCollector::PictureCollector(const RegistrationGrid& grid, int photos) : grid_(grid), photos_(photos) {
    const auto count = static_cast<std::size_t>(photos);
    const int r = grid.reduction;
    overview_.reduction = r;
    overview_.origin = grid.corner + glm::dvec2((r - 1) / 2.0);
    counts_ = Image<float>((grid.width + r - 1) / r, (grid.height + r - 1) / r);
    overview_.pictures.assign(count, counts_);
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) counts_(x / r, y / r) += 1;
    for (const glm::ivec2& place : grid.patches) {
        patches_.emplace_back().origin = grid.corner + glm::dvec2(place);
        patches_.back().pictures.assign(count, Image<float>(kPatch, kPatch));
    }
}

std::vector<const AlignmentWindow*> PictureCollector::in_full() const {
    std::vector<const AlignmentWindow*> windows;
    if (grid_.reduction == 1) windows.push_back(&overview_);
    for (const AlignmentWindow& patch : patches_) windows.push_back(&patch);
    return windows;
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

namespace {

// Brightness of a row of a photograph. No sample (outside of a warped photograph, where a file has none)
// stays none: as black it would have edges, which do not move with the painting.
TP_VECTOR_CLONES
void grey_of(const Band& band, int photo, int y, std::vector<float>& grey) {
    const int width = band.width();
    const auto channels = static_cast<float>(band.channels());
    float* __restrict values = grey.data();
    std::fill_n(values, width, 0.0f);
    for (int c = 0; c < band.channels(); ++c) {
        const float* row = band.row(photo, c, y);
        for (int x = 0; x < width; ++x) values[x] += row[x];
    }
    for (int x = 0; x < width; ++x) values[x] /= channels;
}

}  // namespace

void PictureCollector::add(const Band& band) {
    const int width = grid_.width, r = grid_.reduction;
    TP_REQUIRE(band.photos() == photos_ && (photos_ == 0 || band.width() == width),
               "a band of these pictures");
    parallel_for(0, photos_, 1, [&](int begin, int end) {
        std::vector<float> grey(static_cast<std::size_t>(width));
        for (int i = begin; i < end; ++i)
            for (int y = band.y0(); y < band.y1(); ++y) {
                const auto photo = static_cast<std::size_t>(i);
                grey_of(band, i, y, grey);
                float* reduced = &overview_.pictures[photo](0, y / r);
                const float* counts = &counts_(0, y / r);
                for (int x = 0; x < width; x += r) {
                    float sum = 0;
                    for (int k = x; k < std::min(x + r, width); ++k) sum += grey[static_cast<std::size_t>(k)];
                    *reduced++ += sum / *counts++;
                }
                for (std::size_t k = 0; k < patches_.size(); ++k) {
                    const glm::ivec2& place = grid_.patches[k];
                    const int row = y - place.y;
                    if (row < 0 || row >= kPatch) continue;
                    std::copy_n(&grey[static_cast<std::size_t>(place.x)], kPatch,
                                &patches_[k].pictures[photo](0, row));
                }
            }
    });
}

}  // namespace tangi
