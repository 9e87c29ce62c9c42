#include "capture/registration/edge_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "surface/base/parallel.h"
#include "surface/image/opencv_view.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr float kLargestGradient = 0.15f;  // [1 per pixel] of the logarithm
constexpr double kEdge = 0.04;             // [1 per pixel] from which on an edge counts fully
constexpr double kQuietOutside =
    0.8;  // how much edges around the circle, in parallel with it, count against it
constexpr double kMostInside = 0.8;   // of the points that should lie in the circle
constexpr double kLargestHough = 48;  // [pixels] radius; larger circles are sought in a reduced field

void add_edges(const Image<float>& photo, float step, float share, Image<Vec3>& tensor) {
    cv::Mat logarithm;
    cv::log(view_of(photo) + std::max(2 * step, 3 * dark_noise(photo)), logarithm);
    cv::GaussianBlur(logarithm, logarithm, {}, 1.0, 1.0, cv::BORDER_REPLICATE);
    for (int y = 0; y < tensor.height(); ++y) {
        const float* row = logarithm.ptr<float>(y);
        const float* above = logarithm.ptr<float>(std::max(y - 1, 0));
        const float* below = logarithm.ptr<float>(std::min(y + 1, tensor.height() - 1));
        for (int x = 0; x < tensor.width(); ++x) {
            const float gx = (row[std::min(x + 1, tensor.width() - 1)] - row[std::max(x - 1, 0)]) / 2;
            const float gy = (below[x] - above[x]) / 2;
            const float size = std::max(std::hypot(gx, gy), 1e-9f);
            tensor(x, y) +=
                share * std::min(size, kLargestGradient) / (size * size) * Vec3(gx * gx, gx * gy, gy * gy);
        }
    }
}

EdgeField halved(const EdgeField& field) {
    EdgeField half{Image<Vec3>(std::max(field.width() / 2, 1), std::max(field.height() / 2, 1))};
    for (int y = 0; y < half.height(); ++y)
        for (int x = 0; x < half.width(); ++x)
            half.tensor(x, y) =
                (field.tensor.clamped(2 * x, 2 * y) + field.tensor.clamped(2 * x + 1, 2 * y) +
                 field.tensor.clamped(2 * x, 2 * y + 1) + field.tensor.clamped(2 * x + 1, 2 * y + 1)) /
                4.0f;
    return half;
}

// Votes for centres at one radius, part of the circumference that votes.
Image<float> votes_at(const EdgeField& field, const Region& centres, double radius) {
    Image<float> votes(centres.width(), centres.height());
    const float share = static_cast<float>(1 / (2 * std::numbers::pi * radius));
    const int reach = static_cast<int>(std::ceil(radius)) + 1;
    for (int y = std::max(0, centres.y0 - reach); y < std::min(field.height(), centres.y1 + reach); ++y)
        for (int x = std::max(0, centres.x0 - reach); x < std::min(field.width(), centres.x1 + reach); ++x) {
            const Vec3& t = field.tensor(x, y);
            const float difference = std::hypot(t.x - t.z, 2 * t.y);  // of both eigenvalues
            const float strength = std::min(difference / static_cast<float>(kEdge), 1.0f);
            if (strength < 0.15f) continue;
            const float angle = std::atan2(2 * t.y, t.x - t.z) / 2;
            const float nx = std::cos(angle), ny = std::sin(angle);
            for (const float sign : {-1.0f, 1.0f}) {
                const int cx =
                    static_cast<int>(std::lround(x + sign * static_cast<float>(radius) * nx)) - centres.x0;
                const int cy =
                    static_cast<int>(std::lround(y + sign * static_cast<float>(radius) * ny)) - centres.y0;
                if (cx >= 0 && cy >= 0 && cx < votes.width() && cy < votes.height())
                    votes(cx, cy) += share * strength;
            }
        }
    cv::Mat view = view_of(votes);
    cv::blur(view, view, {3, 3});
    return votes;
}

bool holds_most(const CircleSearch& search, const dvec2& centre, double radius) {
    const auto inside = std::count_if(search.inside.begin(), search.inside.end(), [&](const dvec2& point) {
        return glm::length(point - centre) < radius;
    });
    return static_cast<double>(inside) >= kMostInside * static_cast<double>(search.inside.size());
}

// A direction from a circle's centre, and cosine and sine of twice its angle.
struct Spoke {
    dvec2 normal;
    float cos_2, sin_2;
};

constexpr int kFewestAngles = 48, kMostAngles = 256;

// So many directions, evenly spread.
std::span<const Spoke> spokes(int count) {
    static const auto all = [] {
        std::array<std::vector<Spoke>, kMostAngles + 1> counts;
        for (std::size_t n = kFewestAngles; n < counts.size(); ++n)
            for (std::size_t i = 0; i < n; ++i) {
                const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
                const dvec2 normal(std::cos(angle), std::sin(angle));
                counts[n].push_back({normal, static_cast<float>(normal.x * normal.x - normal.y * normal.y),
                                     static_cast<float>(2 * normal.x * normal.y)});
            }
        return counts;
    }();
    return all[static_cast<std::size_t>(count)];
}

// [1 per pixel] Of an edge across a spoke, at a place in the picture: what lies across less what lies along,
// so that noise, which has no direction, counts for nothing.
float strength_across(const EdgeField& field, const dvec2& place, const Spoke& spoke) {
    const int x = static_cast<int>(place.x), y = static_cast<int>(place.y);
    const int right = std::min(x + 1, field.width() - 1), below = std::min(y + 1, field.height() - 1);
    const float u = static_cast<float>(place.x) - static_cast<float>(x),
                v = static_cast<float>(place.y) - static_cast<float>(y);
    const Vec3 t = (1 - v) * ((1 - u) * field.tensor(x, y) + u * field.tensor(right, y)) +
                   v * ((1 - u) * field.tensor(x, below) + u * field.tensor(right, below));
    return std::max(0.0f, spoke.cos_2 * (t.x - t.z) + spoke.sin_2 * 2 * t.y);
}

// Climbs to the best score nearby.
Circle climbed(const EdgeField& field, Circle circle) {
    constexpr glm::ivec3 nowhere(4);  // no neighbour of it is one of here
    glm::ivec3 from = nowhere;  // the move to here from where neighbours were tried: those are no better
    for (double step = std::max(1.0, circle.radius_px / 16); step > 0.2;) {
        Circle best = circle;
        glm::ivec3 best_move(0);
        for (int i = 0; i < 27; ++i) {
            const glm::ivec3 move(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            const glm::ivec3 before = glm::abs(from + move);
            if (i == 13 || std::max({before.x, before.y, before.z}) <= 1) continue;
            const dvec2 centre = circle.centre_px + step * dvec2(move);
            const double radius = circle.radius_px + step * move.z;
            const double score = outline_score(field, centre, radius);
            if (score > best.score) best = {centre, radius, score}, best_move = move;
        }
        if (best.score > circle.score) {
            circle = best;
            from = best_move;
        } else {
            step /= 2;
            from = nowhere;
        }
    }
    return circle;
}

}  // namespace

// From second differences, of which half are smaller than 0.6745 sigma.
float dark_noise(const Image<float>& photo) {
    std::vector<float> sorted(photo.pixels().begin(), photo.pixels().end());
    const auto quarter = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
    std::nth_element(sorted.begin(), quarter, sorted.end());
    const float dark = *quarter;
    std::vector<float> differences;
    for (int y = 0; y < photo.height(); ++y)
        for (int x = 1; x + 1 < photo.width(); x += 2)
            if (photo(x, y) <= dark)
                differences.push_back(std::abs(photo(x - 1, y) - 2 * photo(x, y) + photo(x + 1, y)));
    if (differences.empty()) return 0;
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    return *middle / (0.6745f * std::sqrt(6.0f));
}

EdgeField edge_field(std::span<const Image<float>> photos, float step) {
    EdgeField field{Image<Vec3>(photos.front().width(), photos.front().height())};
    for (const Image<float>& photo : photos)
        add_edges(photo, step, 1.0f / static_cast<float>(photos.size()), field.tensor);
    return field;
}

double outline_score(const EdgeField& field, const dvec2& centre, double radius) {
    if (!(radius > 2)) return 0;
    const int angles = std::clamp(static_cast<int>(4 * radius), kFewestAngles, kMostAngles);
    const auto strength = [&](const Spoke& spoke, double r) -> std::optional<double> {
        const dvec2 place = centre + r * spoke.normal;
        if (place.x < 0 || place.y < 0 || place.x > field.width() - 1 || place.y > field.height() - 1)
            return {};
        return std::min(1.0, strength_across(field, place, spoke) / kEdge);
    };
    double sum = 0;
    int in_picture = 0;
    for (const Spoke& spoke : spokes(angles)) {
        const auto here = strength(spoke, radius);
        if (!here) continue;
        ++in_picture;
        double outside = 0;
        for (const double factor : {1.10, 1.17, 1.24})
            outside += strength(spoke, factor * radius + 2).value_or(0) / 3;
        sum += *here - kQuietOutside * outside;
    }
    return 2 * in_picture < angles ? 0 : std::max(0.0, sum / in_picture);
}

namespace {

// Best first, each once.
std::vector<Circle> distinct(std::vector<Circle> all, const CircleSearch& search) {
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
    std::vector<Circle> circles;
    for (const Circle& circle : all) {
        const bool known = std::any_of(circles.begin(), circles.end(), [&](const Circle& other) {
            return glm::length(circle.centre_px - other.centre_px) +
                       std::abs(circle.radius_px - other.radius_px) <
                   0.08 * other.radius_px + 1;
        });
        if (!known && holds_most(search, circle.centre_px, circle.radius_px)) circles.push_back(circle);
        if (static_cast<int>(circles.size()) == search.most) break;
    }
    return circles;
}

// In a field of half the size, where outlines are half as wide, and some are lost.
std::vector<Circle> circles_in_half(const EdgeField& field, const CircleSearch& search) {
    CircleSearch smaller = search;
    smaller.smallest_px = search.smallest_px / 2;
    smaller.largest_px = search.largest_px / 2;
    smaller.centres = {search.centres.x0 / 2, search.centres.y0 / 2, search.centres.x1 / 2 + 1,
                       search.centres.y1 / 2 + 1};
    for (dvec2& point : smaller.inside) point = (point + 0.5) / 2.0 - 0.5;
    std::vector<Circle> circles = find_circles(halved(field), smaller);
    for (Circle& circle : circles) {
        circle = {(circle.centre_px + 0.5) * 2.0 - 0.5, 2 * circle.radius_px, 0};
        circle.score = outline_score(field, circle.centre_px, circle.radius_px);
        circle = climbed(field, circle);
    }
    return circles;
}

// Centres of circles of this radius that may hold the points that they should.
Region centres_around(const CircleSearch& search, double radius) {
    Region r = search.centres;
    if (search.inside.empty()) return r;
    dvec2 low = search.inside.front(), high = low;
    for (const dvec2& point : search.inside) low = glm::min(low, point), high = glm::max(high, point);
    r.x0 = std::max(r.x0, static_cast<int>(std::floor(low.x - radius)));
    r.y0 = std::max(r.y0, static_cast<int>(std::floor(low.y - radius)));
    r.x1 = std::min(r.x1, static_cast<int>(std::ceil(high.x + radius)) + 1);
    r.y1 = std::min(r.y1, static_cast<int>(std::ceil(high.y + radius)) + 1);
    return r;
}

}  // namespace

std::vector<Circle> find_circles(const EdgeField& field, const CircleSearch& search) {
    if (search.largest_px > kLargestHough) {
        std::vector<Circle> circles = circles_in_half(field, search);
        // Small ones at full size as well: how large others may be is nothing to them.
        if (search.smallest_px < kLargestHough) {
            CircleSearch small = search;
            small.largest_px = kLargestHough;
            small.centres = centres_around(search, kLargestHough);
            const std::vector<Circle> more = find_circles(field, small);
            circles.insert(circles.end(), more.begin(), more.end());
        }
        CircleSearch both =
            search;  // a pattern of small circles is not to take the places of all larger ones
        both.most = static_cast<int>(circles.size());
        return distinct(std::move(circles), both);
    }
    std::vector<double> radii;
    for (double radius = search.smallest_px; radius <= search.largest_px;
         radius = std::max(radius + 0.75, radius * 1.03))
        radii.push_back(radius);
    std::vector<std::vector<Circle>> found(radii.size());
    parallel_for(0, static_cast<int>(radii.size()), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const double radius = radii[static_cast<std::size_t>(i)];
            const Image<float> votes = votes_at(field, search.centres, radius);
            auto& circles = found[static_cast<std::size_t>(i)];
            for (int y = 0; y < votes.height(); ++y)
                for (int x = 0; x < votes.width(); ++x) {
                    bool largest = votes(x, y) > 0.02f;
                    for (int k = 0; k < 9 && largest; ++k)
                        largest = votes(x, y) >= votes.clamped(x + k % 3 - 1, y + k / 3 - 1);
                    const dvec2 centre(x + search.centres.x0, y + search.centres.y0);
                    if (largest && holds_most(search, centre, radius))
                        circles.push_back({centre, radius, votes(x, y)});
                }
            std::sort(circles.begin(), circles.end(),
                      [](const auto& a, const auto& b) { return a.score > b.score; });
            circles.resize(std::min<std::size_t>(circles.size(), 8));
        }
    });
    std::vector<Circle> all;
    for (const auto& circles : found) all.insert(all.end(), circles.begin(), circles.end());
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
    all.resize(std::min<std::size_t>(all.size(), 150));
    parallel_for(0, static_cast<int>(all.size()), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            Circle& circle = all[static_cast<std::size_t>(i)];
            circle.score = outline_score(field, circle.centre_px, circle.radius_px);
            circle = climbed(field, circle);
        }
    });
    return distinct(std::move(all), search);
}

}  // namespace tangi
