#include "capture/stack/reduced_photos.h"

#include <opencv2/core/cvdef.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

// Enough for lights, models and the long waves of a height, and little memory: 48 colour photographs of a
// megapixel take 288 MB.
constexpr double kMostPixels = 1e6;

int reduced(int size, int reduction) { return (size + reduction - 1) / reduction; }

TP_VECTOR_CLONES
void add_row(const float* row, int width, bool first, float* __restrict sum, float* __restrict highest) {
    if (first) {
        std::copy_n(row, width, sum);
        std::copy_n(row, width, highest);
        return;
    }
    for (int x = 0; x < width; ++x) {
        sum[x] += row[x];
        highest[x] = row[x] > highest[x] ? row[x] : highest[x];
    }
}

// Linear light of each half.
std::vector<float> table_of(const Transfer& transfer) {
    std::vector<float> table(std::size_t{1} << 16);
    for (std::size_t code = 0; code < table.size(); ++code) {
        const float value = cv::float16_t::fromBits(static_cast<std::uint16_t>(code));
        table[code] = std::isnan(value) ? value : transfer.decode(value);
    }
    return table;
}

}  // namespace

int ReducedPhotos::reduction_for(int width, int height) {
    return std::max(
        1, static_cast<int>(std::ceil(std::sqrt(width * static_cast<double>(height) / kMostPixels))));
}

ReducedPhotos::ReducedPhotos(const Stack& stack, int reduction)
    : channels_(stack.channels),
      full_width_(stack.width()),
      full_height_(stack.height()),
      width_(reduced(stack.width(), reduction)),
      height_(reduced(stack.height(), reduction)),
      reduction_(reduction),
      clipped_(stack.development  ? stack.development->clipped
               : stack.bits == 32 ? std::numeric_limits<float>::infinity()
                                  : kClipped),
      developed_(stack.development != nullptr),
      photos_(stack.photos.size()) {
    const auto channels = static_cast<std::size_t>(channels_);
    for (Photo& photo : photos_) {
        photo.values.resize(channels * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
        photo.sum.resize(channels * static_cast<std::size_t>(full_width_));
        photo.highest.resize(photo.sum.size());
    }
}

void ReducedPhotos::add(const Band& band) {
    TP_REQUIRE(band.photos() == static_cast<int>(photos_.size()) && band.width() == full_width_ &&
                   band.channels() == channels_,
               "a band of these photographs");
    parallel_for(0, band.photos(), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            Photo& photo = photos_[static_cast<std::size_t>(i)];
            for (int y = band.y0(); y < band.y1(); ++y) {
                for (int c = 0; c < channels_; ++c) {
                    const auto at = static_cast<std::size_t>(c) * static_cast<std::size_t>(full_width_);
                    add_row(band.row(i, c, y), full_width_, y % reduction_ == 0, &photo.sum[at],
                            &photo.highest[at]);
                }
                if (y % reduction_ == reduction_ - 1 || y == full_height_ - 1)
                    finish_row(photo, y / reduction_);
            }
        }
    });
}

void ReducedPhotos::finish_row(Photo& photo, int row) const {
    // So that the next half is not below it.
    const float clipped = 1 + 1.0f / 1024;
    const int rows = std::min(reduction_, full_height_ - row * reduction_);
    for (int c = 0; c < channels_; ++c) {
        const auto at = static_cast<std::size_t>(c) * static_cast<std::size_t>(full_width_);
        const float *sums = &photo.sum[at], *maxima = &photo.highest[at];
        std::uint16_t* value =
            &photo.values[static_cast<std::size_t>(c * height_ + row) * static_cast<std::size_t>(width_)];
        for (int x = 0; x < full_width_; x += reduction_) {
            const int next = std::min(x + reduction_, full_width_);
            float sum = 0, highest = 0;
            for (int k = x; k < next; ++k) {
                sum += sums[k];
                highest = std::max(highest, maxima[k]);
            }
            const float mean = sum / static_cast<float>(rows * (next - x));
            *value++ = cv::float16_t(highest >= clipped_ ? highest * clipped : mean).bits();
        }
    }
}

void ReducedPhotos::keep(const std::vector<bool>& kept) {
    TP_REQUIRE(kept.size() == photos_.size(), "one flag a photograph");
    std::vector<Photo> photos;
    for (std::size_t i = 0; i < kept.size(); ++i)
        if (kept[i]) photos.push_back(std::move(photos_[i]));
    photos_ = std::move(photos);
}

Band ReducedPhotos::read(int y0, int y1, const Transfer& transfer) const {
    const std::vector<float> table = table_of(developed_ ? Transfer{} : transfer);
    Band band(static_cast<int>(photos_.size()), channels_, width_, y0, y1);
    parallel_for(0, band.photos(), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            for (int c = 0; c < channels_; ++c)
                for (int y = y0; y < y1; ++y) {
                    const std::uint16_t* values = &photos_[static_cast<std::size_t>(i)]
                                                       .values[static_cast<std::size_t>(c * height_ + y) *
                                                               static_cast<std::size_t>(width_)];
                    float* row = band.row(i, c, y);
                    for (int x = 0; x < width_; ++x) row[x] = table[values[x]];
                }
    });
    return band;
}

Image<unsigned char> reduced_mask(const Image<unsigned char>& mask, int reduction) {
    if (mask.empty()) return {};
    Image<unsigned char> result(reduced(mask.width(), reduction), reduced(mask.height(), reduction));
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (mask(x, y)) result(x / reduction, y / reduction) = 1;
    return result;
}

Survey at_reduced_positions(Survey survey, int reduction) {
    for (glm::ivec2& position : survey.positions) position /= reduction;
    return survey;
}

}  // namespace tangi
