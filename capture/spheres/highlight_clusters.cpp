#include "capture/spheres/highlight_clusters.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <opencv2/imgproc.hpp>

#include "surface/base/parallel.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr float kOfBrightest = 0.4f;   // of the photograph's brightest pixels
constexpr float kOfMedian = 2.5f;      // times what stays
constexpr double kLargestSpot = 0.02;  // [1] diameter of a spot / diagonal of the picture
constexpr std::size_t kMostSpots = 400;
constexpr double kGoodScore = 0.5;

// A window of one scale and what the photographs have in it.
struct Window {
    dvec2 centre;
    double radius = 0, score = 0;
};

// What one photograph shows in a window: its one spot, or the one that is far brighter than all others.
const HighlightSpot* only_spot(std::span<const HighlightSpot> spots, const dvec2& centre, double radius,
                               int& count) {
    const HighlightSpot* best = nullptr;
    count = 0;
    double second = 0;
    for (const HighlightSpot& spot : spots) {
        if (glm::length(spot.place_px - centre) > radius) continue;
        ++count;
        const double weight = spot.peak * spot.area_px;
        if (!best || weight > best->peak * best->area_px) {
            if (best) second = std::max<double>(second, best->peak * best->area_px);
            best = &spot;
        } else {
            second = std::max(second, weight);
        }
    }
    if (best && second > 0.4 * best->peak * best->area_px) return nullptr;
    return best;
}

double score_of(std::span<const std::vector<HighlightSpot>> spots, const dvec2& centre, double radius) {
    double one = 0, several = 0, around = 0;
    for (const auto& photo : spots) {
        int count = 0, with_ring = 0;
        if (only_spot(photo, centre, radius, count))
            one += 1;
        else if (count > 0)
            several += 1;
        only_spot(photo, centre, 1.5 * radius, with_ring);
        around += std::min(2, with_ring - count);
    }
    return (one - several - 0.5 * around) / static_cast<double>(spots.size());
}

// The window moved onto the middle of its spots until it stays.
HighlightCluster settled(std::span<const std::vector<HighlightSpot>> spots, Window window) {
    HighlightCluster cluster;
    for (int turn = 0; turn < 4; ++turn) {
        cluster.places_px.clear();
        dvec2 low(1e9), high(-1e9);
        for (const auto& photo : spots) {
            int count = 0;
            const HighlightSpot* spot = only_spot(photo, window.centre, window.radius, count);
            if (!spot) continue;
            cluster.places_px.push_back(spot->place_px);
            low = glm::min(low, spot->place_px);
            high = glm::max(high, spot->place_px);
        }
        if (cluster.places_px.empty()) break;
        window.centre = (low + high) / 2.0;
    }
    cluster.centre_px = window.centre;
    for (const dvec2& place : cluster.places_px)
        cluster.radius_px = std::max(cluster.radius_px, glm::length(place - window.centre));
    cluster.score = score_of(spots, window.centre, std::max(window.radius, 1.05 * cluster.radius_px));
    return cluster;
}

}  // namespace

Image<float> median_of(std::span<const Image<float>> photos) {
    Image<float> median(photos.front().width(), photos.front().height());
    parallel_for(0, median.height(), 8, [&](int begin, int end) {
        std::vector<float> values(photos.size());
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < median.width(); ++x) {
                for (std::size_t i = 0; i < photos.size(); ++i) values[i] = photos[i](x, y);
                // Of few photographs the smaller value: a highlight may be there in two of four.
                const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
                std::nth_element(values.begin(), middle, values.end());
                median(x, y) = *middle;
            }
    });
    return median;
}

std::vector<HighlightSpot> highlight_spots(const Image<float>& photo, const Image<float>& median) {
    std::vector<float> sorted(photo.pixels().begin(), photo.pixels().end());
    const auto fifth = std::min<std::size_t>(5, sorted.size()) - 1;  // the brightest may be dead
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(fifth), sorted.end(),
                     std::greater<>());
    const float threshold = kOfBrightest * sorted[fifth];
    cv::Mat bright(photo.height(), photo.width(), CV_8U), labels, statistics, centroids;
    for (int y = 0; y < photo.height(); ++y)
        for (int x = 0; x < photo.width(); ++x)
            bright.at<unsigned char>(y, x) =
                photo(x, y) >= threshold && photo(x, y) > kOfMedian * median(x, y) && photo(x, y) > 0;
    const int count = cv::connectedComponentsWithStats(bright, labels, statistics, centroids, 8);
    const double largest = std::max(6.0, kLargestSpot * std::hypot(photo.width(), photo.height()));
    std::vector<HighlightSpot> spots;
    std::vector<float> peaks(static_cast<std::size_t>(count));
    for (int y = 0; y < photo.height(); ++y)
        for (int x = 0; x < photo.width(); ++x) {
            float& peak = peaks[static_cast<std::size_t>(labels.at<int>(y, x))];
            peak = std::max(peak, photo(x, y));
        }
    for (int i = 1; i < count; ++i) {
        if (std::max(statistics.at<int>(i, cv::CC_STAT_WIDTH), statistics.at<int>(i, cv::CC_STAT_HEIGHT)) >
            2 * largest)
            continue;
        spots.push_back({{centroids.at<double>(i, 0), centroids.at<double>(i, 1)},
                         peaks[static_cast<std::size_t>(i)],
                         static_cast<double>(statistics.at<int>(i, cv::CC_STAT_AREA))});
    }
    std::stable_sort(spots.begin(), spots.end(),
                     [](const auto& a, const auto& b) { return a.peak * a.area_px > b.peak * b.area_px; });
    spots.resize(std::min(spots.size(), kMostSpots));
    return spots;
}

std::vector<HighlightCluster> highlight_clusters(std::span<const std::vector<HighlightSpot>> spots, int width,
                                                 int height) {
    std::vector<Window> windows;
    for (double radius = 4; radius < 0.35 * std::min(width, height); radius *= 1.4) {
        // Only windows around places that have spots in several photographs can score.
        const double cell = radius / 2;
        std::map<std::pair<int, int>, int> photos_near;
        for (const auto& photo : spots) {
            std::map<std::pair<int, int>, bool> seen;
            for (const HighlightSpot& spot : photo)
                for (int dy = -2; dy <= 2; ++dy)
                    for (int dx = -2; dx <= 2; ++dx)
                        seen[{static_cast<int>(std::lround(spot.place_px.x / cell)) + dx,
                              static_cast<int>(std::lround(spot.place_px.y / cell)) + dy}] = true;
            for (const auto& [place, _] : seen) ++photos_near[place];
        }
        for (const auto& [place, count] : photos_near) {
            if (count < kGoodScore * static_cast<double>(spots.size())) continue;
            const dvec2 centre(place.first * cell, place.second * cell);
            windows.push_back({centre, radius, score_of(spots, centre, radius)});
        }
    }
    // Of equal scores the smaller window, which knows its place better.
    std::stable_sort(windows.begin(), windows.end(),
                     [](const Window& a, const Window& b) { return a.score > b.score; });
    std::vector<HighlightCluster> clusters;
    for (const Window& window : windows) {
        if (window.score < kGoodScore || clusters.size() == 12) break;
        HighlightCluster cluster = settled(spots, window);
        if (cluster.score < kGoodScore || cluster.places_px.size() < 3) continue;
        const bool overlaps =
            std::any_of(clusters.begin(), clusters.end(), [&](const HighlightCluster& other) {
                return glm::length(other.centre_px - cluster.centre_px) <
                       other.radius_px + cluster.radius_px + 2;
            });
        if (!overlaps) clusters.push_back(std::move(cluster));
    }
    return clusters;
}

}  // namespace tangi
