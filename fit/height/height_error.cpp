#include "fit/height/height_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fit/height/height_grid.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kDraws = 4;   // fields of errors
constexpr int kCycles = 2;  // of multigrid: what they leave are waves longer than the window
constexpr int kSmooth = 6;  // [pixels] half the side, less a half, of the squares that are averaged
// [rows] That are averaged by one thread, after a radius more; always the same, since sums begin there.
constexpr int kStrip = 256;

// From `from` into `to`, which do not overlap.
void running_mean(const float* from, float* to, int count, int radius) {
    double sum = 0;
    int inside = 0;
    for (int i = 0; i < std::min(radius, count); ++i, ++inside) sum += from[i];
    for (int i = 0; i < count; ++i) {
        if (i + radius < count) {
            sum += from[i + radius];
            ++inside;
        }
        if (i - radius - 1 >= 0) {
            sum -= from[i - radius - 1];
            --inside;
        }
        to[i] = static_cast<float>(sum / inside);
    }
}

// Row by row, so that of large images few rows are in memory.
void mean_of_strip(const Image<float>& from, int radius, int begin, int end, Image<float>& to) {
    const int width = from.width(), height = from.height();
    const std::size_t held = 2 * static_cast<std::size_t>(radius) + 2;  // rows, as means along x
    std::vector<float> rows(held * static_cast<std::size_t>(width));
    const auto row = [&](int y) {
        return &rows[static_cast<std::size_t>(y) % held * static_cast<std::size_t>(width)];
    };
    std::vector<double> sums(static_cast<std::size_t>(width));
    const int first = std::max(begin - radius, 0);
    int inside = 0;
    const auto add = [&](int y) {
        float* const mean = row(y);
        running_mean(from.row(y).data(), mean, width, radius);
        for (int x = 0; x < width; ++x) sums[static_cast<std::size_t>(x)] += static_cast<double>(mean[x]);
        ++inside;
    };
    for (int y = first; y < std::min(begin + radius, height); ++y) add(y);
    for (int y = begin; y < end; ++y) {
        if (y + radius < height) add(y + radius);
        if (const int gone = y - radius - 1; gone >= first) {
            const float* const mean = row(gone);
            for (int x = 0; x < width; ++x) sums[static_cast<std::size_t>(x)] -= static_cast<double>(mean[x]);
            --inside;
        }
        for (int x = 0; x < width; ++x)
            to(x, y) = static_cast<float>(sums[static_cast<std::size_t>(x)] / inside);
    }
}

template <class Change>  // of a pixel's place
void for_pixels(const Image<float>& image, const Change& change) {
    parallel_for(0, image.height(), 32, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < image.width(); ++x) change(x, y);
    });
}

}  // namespace

void box_mean(const Image<float>& from, int radius, Image<float>& to) {
    TP_REQUIRE(from.width() == to.width() && from.height() == to.height(), "one size");
    parallel_for(0, (from.height() + kStrip - 1) / kStrip, 1, [&](int begin, int end) {
        for (int strip = begin; strip < end; ++strip)
            mean_of_strip(from, radius, strip * kStrip, std::min((strip + 1) * kStrip, from.height()), to);
    });
}

Image<HalfError> height_errors(const SlopeEdges& edges, const Image<float>& height_mm,
                               const Progress& progress) {
    const int width = edges.right.width(), height = edges.right.height();
    Image<HalfError> squares(width, height);
    Image<float> z(width, height);
    HeightMultigrid grid(edges.right, edges.down, z);
    grid.coarsen();
    for (int draw = 0; draw < kDraws; ++draw) {
        report(progress, "height error", draw / static_cast<double>(kDraws));
        edges.divergence_of_errors(draw, height_mm, grid.b());
        for_pixels(z, [&](int x, int y) { z(x, y) = 0; });
        for (int cycle = 0; cycle < kCycles; ++cycle) grid.cycle();
        Image<float>& mean = grid.b();
        box_mean(z, kHeightErrorWindow / 2, mean);
        for_pixels(z, [&](int x, int y) {
            const float off = z(x, y) - mean(x, y);
            squares(x, y) = squares(x, y) + off * off / kDraws;
        });
    }
    for_pixels(z, [&](int x, int y) {
        const float offset = edges.offset_mm(x, y);
        z(x, y) = squares(x, y) + offset * offset;
    });
    Image<float>& mean = grid.b();
    box_mean(z, kSmooth, mean);
    for_pixels(z, [&](int x, int y) {
        squares(x, y) = edges.confidence()(x, y) > 0 ? std::sqrt(mean(x, y)) : 0.0f;
    });
    report(progress, "height error", 1);
    return squares;
}

void add_disagreement(const Image<float>& height_mm, Image<float>& other, Image<HalfError>& errors) {
    TP_REQUIRE(height_mm.region() == other.region() && errors.region() == other.region(), "one size");
    for_pixels(other, [&](int x, int y) { other(x, y) -= height_mm(x, y); });
    Image<float> mean(other.width(), other.height());
    box_mean(other, kHeightErrorWindow / 2, mean);
    for_pixels(other, [&](int x, int y) {
        const float off = other(x, y) - mean(x, y);
        other(x, y) = off * off;
    });
    box_mean(other, kSmooth, mean);
    for_pixels(other, [&](int x, int y) {
        HalfError& error = errors(x, y);
        if (error > 0) error = std::sqrt(error * error + mean(x, y));
    });
}

}  // namespace tangi
