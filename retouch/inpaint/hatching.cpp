#include "retouch/inpaint/hatching.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "retouch/fill/surroundings.h"
#include "surface/base/error.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

// SplitMix64 (Steele, Lea, Flood 2014): what is drawn by chance depends on place and seed only.
std::uint64_t hashed(std::uint64_t value) {
    value += 0x9e3779b97f4a7c15ULL;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
    return value ^ (value >> 31);
}
double chance(std::uint64_t value) { return static_cast<double>(hashed(value) >> 11) * 0x1p-53; }

// Of the pixel that holds a place.
std::uint64_t number_of(const glm::vec2& p) {
    return static_cast<std::uint64_t>(p.y) << 32 | static_cast<std::uint64_t>(p.x);
}

bool covered(const Mask& mask, float x, float y) {
    const int u = static_cast<int>(std::floor(x)), v = static_cast<int>(std::floor(y));
    return u >= 0 && v >= 0 && u < mask.width() && v < mask.height() && mask(u, v) >= 0.5f;
}

// Middles of the pixels covered, in an order by chance.
std::vector<glm::vec2> shuffled_pixels(const Mask& mask, std::uint64_t seed) {
    std::vector<std::pair<std::uint64_t, glm::vec2>> all;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (mask(x, y) >= 0.5f)
                all.emplace_back(0u, glm::vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
    for (auto& [order, place] : all) order = hashed(hashed(seed) ^ number_of(place));
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<glm::vec2> places;
    for (const auto& [order, place] : all) places.push_back(place);
    return places;
}

// Points in buckets, to ask whether one is near.
class Neighbours {
public:
    Neighbours(const Mask& mask, double reach)
        : reach_(static_cast<float>(reach)),
          columns_(static_cast<int>(mask.width() / reach) + 1),
          rows_(static_cast<int>(mask.height() / reach) + 1),
          buckets_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}
    void add(const glm::vec2& p, int owner) { buckets_[bucket(p)].push_back({p, owner}); }
    // Nearer than `distance` (<= reach) to a point of another owner.
    bool near(const glm::vec2& p, double distance, int owner) const {
        const int cx = static_cast<int>(p.x / reach_), cy = static_cast<int>(p.y / reach_);
        for (int y = std::max(cy - 1, 0); y <= std::min(cy + 1, rows_ - 1); ++y)
            for (int x = std::max(cx - 1, 0); x <= std::min(cx + 1, columns_ - 1); ++x)
                for (const auto& [q, who] :
                     buckets_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                              static_cast<std::size_t>(x)])
                    if (who != owner && glm::length(p - q) < static_cast<float>(distance)) return true;
        return false;
    }

private:
    std::size_t bucket(const glm::vec2& p) const {
        return static_cast<std::size_t>(p.y / reach_) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(p.x / reach_);
    }
    float reach_;
    int columns_, rows_;
    std::vector<std::vector<std::pair<glm::vec2, int>>> buckets_;
};

void require_valid(const MarkGeometry& g) {
    TP_REQUIRE(g.pitch_px >= 1 && g.width_px >= 1 && g.length_px >= 1, "marks are a pixel at least");
}

// Where lines go, and those that are there.
struct Flow {
    const Mask& mask;
    const Image<float>& direction_rad;
    const MarkGeometry& geometry;
    Neighbours others;
};

// Half of a line, from its seed on.
std::vector<glm::vec2> traced(const Flow& flow, const glm::vec2& seed, float sign, int owner) {
    const MarkGeometry& g = flow.geometry;
    std::vector<glm::vec2> path;
    glm::vec2 at = seed, last(0);
    for (double length = 0; length < g.length_px / 2; length += 0.5) {
        const float angle = flow.direction_rad(static_cast<int>(at.x), static_cast<int>(at.y));
        glm::vec2 along(std::cos(angle), std::sin(angle));
        // Directions have no sense; lines go on as they came.
        if (path.empty())
            along *= sign;
        else if (glm::dot(along, last) < 0)
            along = -along;
        last = along;
        at += 0.5f * along;
        if (!covered(flow.mask, at.x, at.y) || flow.others.near(at, 0.7 * g.pitch_px, owner)) break;
        path.push_back(at);
    }
    return path;
}

}  // namespace

std::vector<Mark> vertical_marks(const Mask& mask, const MarkGeometry& g) {
    require_valid(g);
    std::vector<Mark> marks;
    int number = 0;
    for (double left = 0; left < mask.width(); left += std::round(g.pitch_px), ++number) {
        const int x = std::min(static_cast<int>(left + g.width_px / 2), mask.width() - 1);
        // Pieces of half to whole length.
        int y = 0, end = 0;
        std::uint64_t draw = hashed(g.seed + static_cast<std::uint64_t>(number));
        while (y < mask.height()) {
            draw = hashed(draw);
            end = std::min(y + std::max(static_cast<int>(g.length_px * (0.5 + 0.5 * chance(draw))), 1),
                           mask.height());
            bool any = false;
            for (int v = y; v < end && !any; ++v)
                for (int u = x - static_cast<int>(g.width_px); u <= x + static_cast<int>(g.width_px); ++u)
                    any = any || covered(mask, static_cast<float>(u), static_cast<float>(v));
            if (any)
                marks.push_back({{{static_cast<float>(left + g.width_px / 2), static_cast<float>(y)},
                                  {static_cast<float>(left + g.width_px / 2), static_cast<float>(end)}}});
            y = end;
        }
    }
    return marks;
}

std::vector<Mark> flow_marks(const Mask& mask, const Image<float>& direction_rad, const MarkGeometry& g) {
    require_valid(g);
    TP_REQUIRE(direction_rad.region() == mask.region(), "a direction for every pixel");
    Flow flow{mask, direction_rad, g, Neighbours(mask, g.pitch_px)};
    std::vector<Mark> marks;
    for (const glm::vec2& seed : shuffled_pixels(mask, g.seed)) {
        const int owner = static_cast<int>(marks.size());
        if (flow.others.near(seed, g.pitch_px, owner)) continue;
        std::vector<glm::vec2> path = traced(flow, seed, -1, owner);
        std::reverse(path.begin(), path.end());
        path.push_back(seed);
        const auto ahead = traced(flow, seed, 1, owner);
        path.insert(path.end(), ahead.begin(), ahead.end());
        for (const glm::vec2& p : path) flow.others.add(p, owner);
        marks.push_back({path});
    }
    return marks;
}

std::vector<Mark> crossed_marks(const Mask& mask, const MarkGeometry& g) {
    require_valid(g);
    // One net of each direction; by chance which line is on top.
    std::vector<std::pair<std::uint64_t, Mark>> woven;
    // Two thirds of the area a net: together they leave an eighth bare.
    const double lines_a_pixel = 2.0 / 3 / (g.width_px * g.length_px);
    for (int net = 0; net < 3; ++net) {
        const double angle = (net * 60 + 75) * std::numbers::pi / 180;
        for (const glm::vec2& seed :
             shuffled_pixels(mask, hashed(g.seed + static_cast<std::uint64_t>(net)))) {
            const std::uint64_t draw =
                hashed(hashed(g.seed + 3 + static_cast<std::uint64_t>(net)) ^ number_of(seed));
            if (chance(draw) > lines_a_pixel) continue;
            const double a = angle + 0.25 * (chance(draw + 1) - 0.5);
            const glm::vec2 half(static_cast<float>(0.5 * g.length_px * std::cos(a)),
                                 static_cast<float>(0.5 * g.length_px * std::sin(a)));
            woven.push_back({hashed(draw + 2), {{seed - half, seed + half}}});
        }
    }
    std::sort(woven.begin(), woven.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Mark> marks;
    for (auto& [order, mark] : woven) marks.push_back(std::move(mark));
    return marks;
}

std::vector<Mark> dots(const Mask& mask, const MarkGeometry& g) {
    require_valid(g);
    Neighbours others(mask, g.pitch_px);
    std::vector<Mark> marks;
    for (const glm::vec2& seed : shuffled_pixels(mask, g.seed)) {
        const int owner = static_cast<int>(marks.size());
        if (others.near(seed, g.pitch_px, owner)) continue;
        others.add(seed, owner);
        marks.push_back({{seed}});
    }
    return marks;
}

Image<int> rasterised(const std::vector<Mark>& marks, const Mask& mask, double width_px) {
    Image<int> owner(mask.width(), mask.height(), -1);
    const auto stamp = [&](float x0, float y0, float x1, float y1, int number, auto&& holds) {
        for (int y = std::max(static_cast<int>(std::floor(y0)), 0);
             y < std::min(static_cast<int>(std::ceil(y1)), mask.height()); ++y)
            for (int x = std::max(static_cast<int>(std::floor(x0)), 0);
                 x < std::min(static_cast<int>(std::ceil(x1)), mask.width()); ++x)
                if (mask(x, y) >= 0.5f && holds(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f))
                    owner(x, y) = number;
    };
    const auto radius = static_cast<float>(width_px / 2);
    for (std::size_t i = 0; i < marks.size(); ++i) {
        const auto& path = marks[i].path_px;
        const int number = static_cast<int>(i);
        if (path.size() == 2 && path[0].x == path[1].x) {
            const float left = std::round(path[0].x - radius), right = left + std::round(2 * radius);
            stamp(left, path[0].y, right, path[1].y, number, [](float, float) { return true; });
            continue;
        }
        for (std::size_t p = 0; p < path.size(); ++p) {
            const glm::vec2 a = path[p], b = path[std::min(p + 1, path.size() - 1)];
            const glm::vec2 low = glm::min(a, b) - radius, high = glm::max(a, b) + radius;
            stamp(low.x, low.y, high.x, high.y, number, [&](float x, float y) {
                const glm::vec2 at(x, y), ab = b - a;
                const float length2 = glm::dot(ab, ab);
                const float t = length2 > 0 ? std::clamp(glm::dot(at - a, ab) / length2, 0.0f, 1.0f) : 0.0f;
                return glm::length(at - a - t * ab) <= radius;
            });
        }
    }
    return owner;
}

Image<float> form_direction_rad(const Image<float>& lightness, const Mask& hole, double sigma_px) {
    Image<float> whole = lightness;
    membrane_into(whole, hole);  // so that the hole has no edge of its own
    cv::Mat gx, gy;
    cv::GaussianBlur(view_of(whole), gx, cv::Size(), 1.0);
    cv::Sobel(gx, gy, CV_32F, 0, 1);
    cv::Sobel(gx.clone(), gx, CV_32F, 1, 0);
    Image<float> tensor[3];
    for (int c = 0; c < 3; ++c) {
        const cv::Mat product = c == 0 ? gx.mul(gx) : c == 1 ? gx.mul(gy) : gy.mul(gy);
        cv::Mat smooth;
        cv::GaussianBlur(product, smooth, cv::Size(), sigma_px);
        tensor[c] = Image<float>(hole.width(), hole.height());
        smooth.copyTo(view_of(tensor[c]));
        membrane_into(tensor[c], hole);
    }
    Image<float> direction(hole.width(), hole.height());
    for (std::size_t i = 0; i < hole.size(); ++i) {
        const float xx = tensor[0].pixels()[i], xy = tensor[1].pixels()[i], yy = tensor[2].pixels()[i];
        // Across the strongest change.
        direction.pixels()[i] = 0.5f * std::atan2(2 * xy, xx - yy) + static_cast<float>(std::numbers::pi / 2);
    }
    return direction;
}

}  // namespace tangi
