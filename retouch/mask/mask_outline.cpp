// mask_outline.cpp: outlines of masks by marching squares.
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "retouch/mask/mask.h"

namespace tangi {

namespace {

// An edge of the grid of pixel centres: from centre (x, y) to the right (0) or down (1).
struct GridEdge {
    int x = 0, y = 0, down = 0;
    friend auto operator<=>(const GridEdge&, const GridEdge&) = default;
};

// The squares between four pixel centres, of which those beyond the picture are 0.
class Squares {
public:
    explicit Squares(const Mask& mask) : mask_(mask) {}

    // The pieces of the outline, from edge to edge, inside on the left as seen with y up.
    std::map<GridEdge, GridEdge> pieces() const {
        std::map<GridEdge, GridEdge> next;
        for (int y = -1; y < mask_.height(); ++y)
            for (int x = -1; x < mask_.width(); ++x) add_square(x, y, next);
        return next;
    }

    Corner on(const GridEdge& e) const {
        const float a = at(e.x, e.y), b = at(e.x + 1 - e.down, e.y + e.down);
        const double t = (0.5 - static_cast<double>(a)) / static_cast<double>(b - a);
        return {e.x + 0.5 + (e.down ? 0 : t), e.y + 0.5 + (e.down ? t : 0)};
    }

private:
    float at(int x, int y) const {
        return x < 0 || y < 0 || x >= mask_.width() || y >= mask_.height() ? 0.0f : mask_(x, y);
    }

    void add_square(int x, int y, std::map<GridEdge, GridEdge>& next) const {
        // Corners clockwise on the screen from the top left, edges from each to the one after it.
        const std::array<float, 4> value = {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)};
        const std::array<GridEdge, 4> edge = {GridEdge{x, y, 0}, GridEdge{x + 1, y, 1}, GridEdge{x, y + 1, 0},
                                              GridEdge{x, y, 1}};
        std::array<bool, 4> in{};
        for (std::size_t i = 0; i < 4; ++i) in[i] = value[i] > 0.5f;
        // Each run of corners inside is cut off by one piece; of two opposite corners, regions that touch
        // at a corner are one, as regions_of() has it.
        const bool saddle = in[0] == in[2] && in[1] == in[3] && in[0] != in[1];
        for (std::size_t i = 0; i < 4; ++i) {
            if (!in[i] || in[(i + 3) % 4]) continue;  // begins a run: entered over the edge before it
            std::size_t last = i;
            while (in[(last + 1) % 4]) last = (last + 1) % 4;
            const GridEdge entered = edge[(i + 3) % 4], left = edge[last];
            if (!saddle) {
                next[entered] = left;
            } else {
                // Joined through the middle: the pieces cut off the corners outside instead.
                next[entered] = edge[(last + 2) % 4];
            }
        }
    }

    const Mask& mask_;
};

double signed_area(const Polygon& polygon) {
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        sum += a.x * b.y - b.x * a.y;
    }
    return sum / 2;
}

Polygon simplified(const Polygon& polygon, double tolerance_px) {
    if (tolerance_px <= 0 || polygon.size() < 4) return polygon;
    std::vector<cv::Point2f> points, fewer;
    for (const Corner& c : polygon) points.emplace_back(static_cast<float>(c.x), static_cast<float>(c.y));
    cv::approxPolyDP(points, fewer, tolerance_px, true);
    if (fewer.size() < 3) return polygon;
    Polygon result;
    for (const cv::Point2f& p : fewer) result.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
    return result;
}

}  // namespace

std::vector<Polygon> outlines_of(const Mask& mask, double tolerance_px, double smallest_px2) {
    const Squares squares(mask);
    std::map<GridEdge, GridEdge> next = squares.pieces();
    std::vector<Polygon> outlines;
    while (!next.empty()) {
        Polygon polygon;
        for (auto piece = next.begin(); piece != next.end();) {
            polygon.push_back(squares.on(piece->first));
            const GridEdge to = piece->second;
            next.erase(piece);
            piece = next.find(to);
        }
        if (polygon.size() < 3 || std::abs(signed_area(polygon)) < smallest_px2) continue;
        outlines.push_back(simplified(polygon, tolerance_px));
    }
    return outlines;
}

}  // namespace tangi
