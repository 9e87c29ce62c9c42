#include "fit/pipeline/photo_prefetch.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kDecodedRows = 256;  // at once

}  // namespace

PhotosAhead::PhotosAhead(const Stack& stack, std::vector<StackPhoto> photos, float unit)
    : one_(stack), photos_(std::move(photos)), unit_(unit) {
    one_.held_out.clear();
    one_.photos.clear();
    start();
}

PhotosAhead::~PhotosAhead() {
    if (decoding_.valid()) decoding_.wait();
}

// One thread alone decodes when it is asked to.
void PhotosAhead::start() {
    if (started_ == photos_.size()) return;
    const auto when = thread_count() > 1 ? std::launch::async : std::launch::deferred;
    decoding_ = std::async(when, [this, index = started_] { decode(index, ahead_); });
    ++started_;
}

const StoredPhoto& PhotosAhead::next() {
    TP_REQUIRE(decoding_.valid(), "there is another photograph");
    std::exception_ptr damaged;
    try {
        decoding_.get();
    } catch (...) {
        damaged = std::current_exception();
    }
    std::swap(now_, ahead_);
    start();
    if (damaged) std::rethrow_exception(damaged);
    return now_;
}

void PhotosAhead::decode(std::size_t index, StoredPhoto& into) {
    one_.photos = {photos_[index]};
    StackReader reader(one_);
    const int width = one_.width(), height = one_.height();
    if (into.picture.width() != width || into.picture.height() != height)
        into.picture = Image<Rgb>(width, height);
    into.missing = {};
    for (int y0 = 0; y0 < height; y0 += kDecodedRows) {
        const Band band = reader.read(y0, std::min(y0 + kDecodedRows, height), Transfer{});
        for (int y = y0; y < band.y1(); ++y) {
            const float* channel[3];
            for (int c = 0; c < 3; ++c) channel[c] = band.row(0, std::min(c, one_.channels - 1), y);
            const std::span<Rgb> row = into.picture.row(y);
            for (int x = 0; x < width; ++x) {
                Rgb& value = row[static_cast<std::size_t>(x)];
                value = Rgb(channel[0][x], channel[1][x], channel[2][x]) * unit_;
                if (!std::isnan(value.r + value.g + value.b)) continue;
                if (into.missing.empty()) into.missing = Image<unsigned char>(width, height);
                into.missing(x, y) = 1;
                value = Rgb(0);
            }
        }
    }
}

}  // namespace tangi
