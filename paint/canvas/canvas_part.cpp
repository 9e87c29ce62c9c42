#include "paint/canvas/canvas_part.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"

namespace tangi {

namespace {

using Rows = std::vector<std::vector<RowSpan>>;

struct Grid {
    int width, height;
    double mm;  // of a pixel
    double column(double x_mm) const { return x_mm / mm + (width - 1) / 2.0; }
    double row(double y_mm) const { return (height - 1) / 2.0 - y_mm / mm; }
    // Pixels whose centres lie in [from, to), columns.
    RowSpan between(double from, double to) const {
        const auto whole = [&](double x) {
            return static_cast<int>(std::ceil(std::clamp(x, 0.0, static_cast<double>(width))));
        };
        return {whole(from), whole(to)};
    }
};

struct ToRows {
    const Grid& grid;
    Rows& rows;

    void operator()(const WholeCanvas&) const {
        for (auto& row : rows) row.push_back({0, grid.width});
    }

    void operator()(const CirclePart& circle) const {
        const double cx = grid.column(circle.centre.x), cy = grid.row(circle.centre.y);
        const double radius = circle.radius_mm / grid.mm;
        for (int y = 0; y < grid.height; ++y) {
            const double half2 = radius * radius - (y - cy) * (y - cy);
            if (half2 < 0) continue;
            const RowSpan span = grid.between(cx - std::sqrt(half2), cx + std::sqrt(half2));
            if (span.end > span.begin) rows[static_cast<std::size_t>(y)].push_back(span);
        }
    }

    void operator()(const PolygonPart& polygon) const {
        const std::size_t n = polygon.corners.size();
        std::vector<double> crossings;
        for (int y = 0; y < grid.height; ++y) {
            crossings.clear();
            for (std::size_t i = 0; i < n; ++i) {
                const PointMm &a = polygon.corners[i], &b = polygon.corners[(i + 1) % n];
                const double ya = grid.row(a.y), yb = grid.row(b.y);
                if ((ya <= y) == (yb <= y)) continue;
                const double t = (y - ya) / (yb - ya);
                crossings.push_back(grid.column(a.x) + t * (grid.column(b.x) - grid.column(a.x)));
            }
            std::sort(crossings.begin(), crossings.end());
            for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
                const RowSpan span = grid.between(crossings[i], crossings[i + 1]);
                if (span.end > span.begin) rows[static_cast<std::size_t>(y)].push_back(span);
            }
        }
    }
};

}  // namespace

std::vector<std::vector<RowSpan>> rows_of(const CanvasPart& part, int width, int height,
                                          double mm_per_pixel) {
    TP_REQUIRE(width > 0 && height > 0 && mm_per_pixel > 0, "a canvas has pixels");
    Rows rows(static_cast<std::size_t>(height));
    const Grid grid{width, height, mm_per_pixel};
    std::visit(ToRows{grid, rows}, part);
    return rows;
}

}  // namespace tangi
