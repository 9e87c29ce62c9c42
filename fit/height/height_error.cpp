#include "fit/height/height_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fit/height/height_grid.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kDraws = 4;     // fields of errors
constexpr int kCycles = 2;    // of multigrid: what they leave are waves longer than the window
constexpr int kSmooth = 6;    // [pixels] half the side, less a half, of the squares that are averaged
constexpr int kColumns = 64;  // that are averaged side by side

// Running mean over `count` numbers, `stride` apart, from `from` into `to`.
void running_mean(const float* from, float* to, int count, std::ptrdiff_t stride, int radius) {
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
        to[i * stride] = static_cast<float>(sum / inside);
    }
}

// squares += (z - mean)^2 / kDraws
void add_squares(const Image<float>& z, const Image<float>& mean, Image<HalfError>& squares) {
    parallel_for(0, z.height(), 32, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < z.width(); ++x) {
                const float off = z(x, y) - mean(x, y);
                squares(x, y) = squares(x, y) + off * off / kDraws;
            }
    });
}

}  // namespace

void box_mean(Image<float>& image, int radius) {
    const int width = image.width(), height = image.height();
    parallel_for(0, height, 16, [&](int begin, int end) {
        std::vector<float> row(static_cast<std::size_t>(width));
        for (int y = begin; y < end; ++y) {
            const auto pixels = image.row(y);
            std::copy(pixels.begin(), pixels.end(), row.begin());
            running_mean(row.data(), pixels.data(), width, 1, radius);
        }
    });
    parallel_for(0, (width + kColumns - 1) / kColumns, 1, [&](int begin, int end) {
        std::vector<float> columns(static_cast<std::size_t>(kColumns) * static_cast<std::size_t>(height));
        for (int block = begin; block < end; ++block) {
            const int x0 = block * kColumns, x1 = std::min(x0 + kColumns, width);
            for (int y = 0; y < height; ++y)
                for (int x = x0; x < x1; ++x)
                    columns[static_cast<std::size_t>(x - x0) * static_cast<std::size_t>(height) +
                            static_cast<std::size_t>(y)] = image(x, y);
            for (int x = x0; x < x1; ++x)
                running_mean(&columns[static_cast<std::size_t>(x - x0) * static_cast<std::size_t>(height)],
                             &image(x, 0), height, width, radius);
        }
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
        std::fill(z.pixels().begin(), z.pixels().end(), 0.0f);
        for (int cycle = 0; cycle < kCycles; ++cycle) grid.cycle();
        Image<float>& mean = grid.b();
        std::copy(z.pixels().begin(), z.pixels().end(), mean.pixels().begin());
        box_mean(mean, kHeightErrorWindow / 2);
        add_squares(z, mean, squares);
    }
    parallel_for(0, height, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x) {
                const float offset = edges.offset_mm(x, y);
                z(x, y) = squares(x, y) + offset * offset;
            }
    });
    box_mean(z, kSmooth);
    for (std::size_t i = 0; i < z.size(); ++i)
        squares.pixels()[i] = edges.confidence().pixels()[i] > 0 ? std::sqrt(z.pixels()[i]) : 0.0f;
    report(progress, "height error", 1);
    return squares;
}

void add_disagreement(const Image<float>& height_mm, Image<float>& other, Image<HalfError>& errors) {
    TP_REQUIRE(height_mm.region() == other.region() && errors.region() == other.region(), "one size");
    Image<float> mean(other.width(), other.height());
    for (std::size_t i = 0; i < other.size(); ++i)
        mean.pixels()[i] = other.pixels()[i] -= height_mm.pixels()[i];
    box_mean(mean, kHeightErrorWindow / 2);
    for (std::size_t i = 0; i < other.size(); ++i) {
        const float off = other.pixels()[i] - mean.pixels()[i];
        other.pixels()[i] = off * off;
    }
    box_mean(other, kSmooth);
    for (std::size_t i = 0; i < other.size(); ++i) {
        HalfError& error = errors.pixels()[i];
        if (error > 0) error = std::sqrt(error * error + other.pixels()[i]);
    }
}

}  // namespace tangi
