// craquelure_suggestion.cpp: thin lines that are darker, lower or less glossy than both their sides.
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "retouch/damage/damage_suggestion.h"
#include "retouch/damage/local_deviation.h"
#include "surface/base/parallel.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr int kTile_px = 512, kMargin_px = 40;
// [scales of the contrast] What a line by itself must have, and one within a network of others: cracks are
// seldom alone, strokes are. Parts of a line may have less.
constexpr float kAlone = 2.4f, kAmongOthers = 0.9f, kPossible = 0.5f;
constexpr double kNeighbourhood_mm = 8;  // within which lines make a network
constexpr double kDense_per_mm = 0.06;   // length on area of one: islands of 30 mm, half of their rims seen

// Second derivatives at a scale, times its square so that scales compare (Lindeberg 1998).
struct Hessian {
    cv::Mat xx, xy, yy;
};

Hessian hessian_of(const cv::Mat& values, double sigma) {
    cv::Mat smooth;
    cv::GaussianBlur(values, smooth, {}, sigma, sigma, cv::BORDER_REPLICATE);
    Hessian h;
    const double scale = sigma * sigma;
    const cv::Mat second = (cv::Mat_<float>(1, 3) << 1, -2, 1);
    const cv::Mat first = (cv::Mat_<float>(1, 3) << -0.5f, 0, 0.5f);
    const auto filter = [&](const cv::Mat& row, const cv::Mat& column) {
        cv::Mat result;
        cv::sepFilter2D(smooth, result, CV_32F, row, column, {-1, -1}, 0, cv::BORDER_REPLICATE);
        return cv::Mat(result * scale);
    };
    const cv::Mat one = cv::Mat::ones(1, 1, CV_32F);
    h.xx = filter(second, one);
    h.yy = filter(one, second);
    h.xy = filter(first, first);
    return h;
}

float at(const cv::Mat& m, float x, float y) {  // bilinear, the border goes on
    x = std::clamp(x, 0.0f, static_cast<float>(m.cols - 1));
    y = std::clamp(y, 0.0f, static_cast<float>(m.rows - 1));
    const int x0 = std::min(static_cast<int>(x), m.cols - 2), y0 = std::min(static_cast<int>(y), m.rows - 2);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const float *top = m.ptr<float>(y0) + x0, *bottom = m.ptr<float>(y0 + 1) + x0;
    return (1 - fy) * ((1 - fx) * top[0] + fx * top[1]) + fy * ((1 - fx) * bottom[0] + fx * bottom[1]);
}

// What of a tile is looked at, smallest where a crack is.
struct Maps {
    cv::Mat darkness, height_mm, gloss;  // logarithms of Y and rho_s
};

Maps maps_of(const Surface& s, const Region& r, float unit_mm) {
    const auto matrix = [&] { return cv::Mat(r.height(), r.width(), CV_32F); };
    Maps m{matrix(), matrix(), matrix()};
    for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) {
            const int row = y - r.y0, column = x - r.x0;
            m.darkness.at<float>(row, column) = std::log(std::max(luminance(s.diffuse(x, y)), 0.0f) + 0.02f);
            m.height_mm.at<float>(row, column) = s.height_mm(x, y) * unit_mm;
            m.gloss.at<float>(row, column) = std::log(std::max(s.specular(x, y), 0.0f) + 0.004f);
        }
    return m;
}

// By how much a pixel lies below both points `reach` to its sides, the smaller of the two; negative on edges.
float valley(const cv::Mat& m, float x, float y, float nx, float ny, float reach) {
    return std::min(at(m, x + nx * reach, y + ny * reach), at(m, x - nx * reach, y - ny * reach)) -
           at(m, x, y);
}

// [1] of lines at each pixel of a tile, best of all scales: contrasts in units of `noise`, darkness leads.
struct Contrasts {
    cv::Mat darkness, height_mm, gloss;
};

Contrasts contrasts_of(const Maps& m, const std::vector<double>& sigmas) {
    Contrasts c{cv::Mat::zeros(m.darkness.size(), CV_32F), cv::Mat::zeros(m.darkness.size(), CV_32F),
                cv::Mat::zeros(m.darkness.size(), CV_32F)};
    for (const double sigma : sigmas) {
        const Hessian h = hessian_of(m.darkness, sigma);
        cv::Mat dark, low, gloss;
        const double fine = 0.6 * sigma;
        cv::GaussianBlur(m.darkness, dark, {}, fine);
        cv::GaussianBlur(m.height_mm, low, {}, fine);
        cv::GaussianBlur(m.gloss, gloss, {}, fine);
        const auto reach = static_cast<float>(2 * sigma + 0.7);
        for (int y = 0; y < dark.rows; ++y)
            for (int x = 0; x < dark.cols; ++x) {
                const float xx = h.xx.at<float>(y, x), yy = h.yy.at<float>(y, x), xy = h.xy.at<float>(y, x);
                const float mean = (xx + yy) / 2, root = std::hypot((xx - yy) / 2, xy);
                const float across = mean + root, along = mean - root;
                // A valley: curved up across, hardly along (Frangi et al. 1998: not a spot).
                if (!(across > 0) || std::abs(along) > 0.6f * across) continue;
                float nx = xy, ny = across - xx;
                if (xx >= yy) nx = across - yy, ny = xy;
                const float length = std::hypot(nx, ny);
                if (!(length > 0)) continue;
                nx /= length, ny /= length;
                const auto px = static_cast<float>(x), py = static_cast<float>(y);
                const float depth = valley(dark, px, py, nx, ny, reach);
                if (!(depth > c.darkness.at<float>(y, x))) continue;
                c.darkness.at<float>(y, x) = depth;
                c.height_mm.at<float>(y, x) = std::max(valley(low, px, py, nx, ny, reach), 0.0f);
                c.gloss.at<float>(y, x) = std::max(valley(gloss, px, py, nx, ny, reach), 0.0f);
            }
    }
    return c;
}

void copy_inner(const cv::Mat& from, const Region& with_margin, const Region& inner, Image<float>& to) {
    for (int y = inner.y0; y < inner.y1; ++y)
        for (int x = inner.x0; x < inner.x1; ++x)
            to(x, y) = from.at<float>(y - with_margin.y0, x - with_margin.x0);
}

// The spread of what is not 0, of which few are cracks.
float scale_of(const Image<float>& contrast, float least) {
    std::vector<float> some;
    for (std::size_t i = 0; i < contrast.size(); i += std::max<std::size_t>(contrast.size() / 500000, 1))
        if (const float v = contrast.pixels()[i]; v > 0) some.push_back(v);
    if (some.size() < 100) return least;
    const auto p90 = some.begin() + static_cast<std::ptrdiff_t>(some.size() * 9 / 10);
    std::nth_element(some.begin(), p90, some.end());
    return std::max(*p90, least);
}

// The contrasts of lines over the whole painting.
struct LineMaps {
    Image<float> dark, low, matt;
};

// Tile by tile: memory is that of a row of tiles.
LineMaps line_maps_of(const Surface& surface, const std::vector<double>& sigmas, float unit_mm,
                      const Progress& progress) {
    const int width = surface.width(), height = surface.height();
    LineMaps maps{Image<float>(width, height), Image<float>(width, height), Image<float>(width, height)};
    const int columns = (width + kTile_px - 1) / kTile_px, rows = (height + kTile_px - 1) / kTile_px;
    for (int row = 0; row < rows; ++row) {
        report(progress, "look for cracks", 0.8 * row / rows);
        parallel_for(0, columns, 1, [&](int begin, int end) {
            for (int column = begin; column < end; ++column) {
                const Region inner{column * kTile_px, row * kTile_px,
                                   std::min((column + 1) * kTile_px, width),
                                   std::min((row + 1) * kTile_px, height)};
                const Region wide{std::max(inner.x0 - kMargin_px, 0), std::max(inner.y0 - kMargin_px, 0),
                                  std::min(inner.x1 + kMargin_px, width),
                                  std::min(inner.y1 + kMargin_px, height)};
                const Contrasts c = contrasts_of(maps_of(surface, wide, unit_mm), sigmas);
                copy_inner(c.darkness, wide, inner, maps.dark);
                copy_inner(c.height_mm, wide, inner, maps.low);
                copy_inner(c.gloss, wide, inner, maps.matt);
            }
        });
    }
    return maps;
}

// [scales of the contrast] Darkness leads; height and gloss support it.
void add_score(const LineMaps& maps, const Surface& surface, float sensitivity, Image<float>& score) {
    // However lively the painting, a line that is darker than both sides by a fifth counts.
    const float dark_scale = std::min(scale_of(maps.dark, 0.05f), 0.2f),
                low_scale = scale_of(maps.low, 1e-4f), matt_scale = scale_of(maps.matt, 0.1f);
    for (int y = 0; y < score.height(); ++y)
        for (int x = 0; x < score.width(); ++x) {
            // Cracks are often fitted badly: only what was not seen at all is left out.
            if (surface.confidence(x, y) == 0 && surface.diffuse(x, y) == Rgb(0)) continue;
            const float support = 0.5f * std::min(maps.low(x, y) / low_scale, 3.0f) +
                                  0.5f * std::min(maps.matt(x, y) / matt_scale, 3.0f);
            const float d = maps.dark(x, y) / dark_scale;
            score(x, y) = sensitivity * d * (0.6f + 0.4f * support);
        }
}

float mix(float a, float b, float t) { return a + (b - a) * t; }

// [1] How much a pixel lies in a network of cracks, 0..1: by the length of sure lines within some mm.
Image<float> network_of(const Image<float>& score, double mm_per_pixel) {
    Mask sure(score.width(), score.height());
    for (std::size_t i = 0; i < score.size(); ++i)
        sure.pixels()[i] = score.pixels()[i] > kAlone ? 1.0f : 0.0f;
    Image<float> network = skeleton_of(sure);
    const double sigma_px = std::clamp(kNeighbourhood_mm / mm_per_pixel, 4.0, 200.0);
    // A far blur needs no detail.
    const double factor = std::min(1.0, 4 / sigma_px);
    cv::Mat small, smooth, full;
    cv::resize(view_of(network), small, {}, factor, factor, cv::INTER_AREA);
    cv::GaussianBlur(small, smooth, {}, sigma_px * factor, sigma_px * factor, cv::BORDER_REFLECT);
    cv::resize(smooth, full, view_of(network).size(), 0, 0, cv::INTER_LINEAR);
    const auto dense = static_cast<float>(kDense_per_mm * mm_per_pixel);
    for (int y = 0; y < network.height(); ++y)
        for (int x = 0; x < network.width(); ++x)
            network(x, y) = std::min(full.at<float>(y, x) / dense, 1.0f);
    return network;
}

// Hysteresis (Canny 1986), then pieces that are long and thin; pieces that nearly touch are one.
Mask traced(const Image<float>& score, const Image<float>& network, double mm_per_pixel, double widest_px,
            double shortest_mm) {
    const int width = score.width(), height = score.height();
    Mask possible(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            possible(x, y) = score(x, y) > kPossible * mix(kAlone, kAmongOthers, network(x, y)) ? 1.0f : 0.0f;
    cv::Mat joined, numbers;
    cv::dilate(view_of(possible) > 0, joined, cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
    const auto count = static_cast<std::size_t>(cv::connectedComponents(joined, numbers, 8, CV_32S));
    const Mask skeleton = skeleton_of(possible);
    struct Piece {
        double certain = 0, area = 0, length = 0, network = 0;
    };
    std::vector<Piece> pieces(count);
    const auto piece_at = [&](int x, int y) -> Piece& {
        return pieces[static_cast<std::size_t>(numbers.at<int>(y, x))];
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (!(possible(x, y) > 0)) continue;
            Piece& piece = piece_at(x, y);
            piece.area += 1;
            piece.length += skeleton(x, y) > 0 ? 1.1 : 0;  // the mean of straight and diagonal steps
            piece.network += static_cast<double>(network(x, y));
            piece.certain += score(x, y) > mix(kAlone, kAmongOthers, network(x, y)) ? 1 : 0;
        }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Piece& piece = piece_at(x, y);
            const bool alone = piece.network < 0.4 * piece.area;
            const bool crack = piece.certain >= 3 && piece.certain * 8 >= piece.area &&
                               piece.length * mm_per_pixel >= (alone ? 3 : 1) * shortest_mm &&
                               piece.area <= widest_px * piece.length;
            possible(x, y) = crack ? possible(x, y) : 0.0f;
        }
    return possible;
}

}  // namespace

CraquelureSuggestion suggest_craquelure(const Surface& surface, double mm_per_pixel,
                                        const CraquelureOptions& options, const Progress& progress) {
    validate(options);
    CraquelureSuggestion suggestion;
    suggestion.begin(surface);
    const int width = surface.width(), height = surface.height();
    if (width < 16 || height < 16) return suggestion;
    const double widest_px = std::clamp(options.widest_mm / mm_per_pixel, 1.5, 24.0);
    std::vector<double> sigmas;
    for (double sigma = 0.7; sigma <= std::max(widest_px / 2.5, 0.8); sigma *= 1.5) sigmas.push_back(sigma);
    const auto unit_mm = static_cast<float>(mm_per_pixel / surface.mm_per_pixel);
    Image<float>& score = suggestion.confidence;
    add_score(line_maps_of(surface, sigmas, unit_mm, progress), surface,
              static_cast<float>(options.sensitivity), score);

    report(progress, "look for cracks", 0.85);
    const Image<float> network = network_of(score, mm_per_pixel);
    suggestion.mask = traced(score, network, mm_per_pixel, widest_px, options.shortest_mm);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float s = score(x, y) / mix(kAlone, kAmongOthers, network(x, y));
            score(x, y) = s * s / (s * s + 1);
        }
    suggestion.measure = measure_lines(suggestion.mask, mm_per_pixel);
    report(progress, "look for cracks", 1);
    return suggestion;
}

}  // namespace tangi
