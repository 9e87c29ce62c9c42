#include "retouch/mask/mask.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "surface/base/error.h"
#include "surface/image/opencv_view.h"
#include "surface/image_file/image_alpha.h"
#include "surface/image_file/image_io.h"
#include "surface/image_file/picture_rows.h"

namespace tangi {

namespace {

constexpr int kLines = 16;  // a pixel, on which polygons are measured

template <class Combine>
Mask combined(const Mask& a, const Mask& b, const Combine& combine) {
    TP_REQUIRE(a.region() == b.region(), "masks of one painting have one size");
    Mask result(a.width(), a.height());
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x) result(x, y) = combine(a(x, y), b(x, y));
    return result;
}

// Adds `part` for the run [x0, x1) of a row, to the pixels in proportion to how much of them it covers.
void add_run(std::span<float> row, double x0, double x1, float part) {
    x0 = std::clamp(x0, 0.0, static_cast<double>(row.size()));
    x1 = std::clamp(x1, 0.0, static_cast<double>(row.size()));
    for (auto x = static_cast<std::size_t>(x0); x < row.size() && static_cast<double>(x) < x1; ++x) {
        const double left = std::max(x0, static_cast<double>(x)),
                     right = std::min(x1, static_cast<double>(x) + 1);
        row[x] += part * static_cast<float>(right - left);
    }
}

}  // namespace

MaskArea area_of(const Mask& mask, double mm_per_pixel) {
    double pixels = 0;
    for (const float part : mask.pixels()) pixels += static_cast<double>(part);
    MaskArea area;
    area.mm2 = pixels * mm_per_pixel * mm_per_pixel;
    area.percent = mask.empty() ? 0 : 100 * pixels / static_cast<double>(mask.size());
    area.regions = static_cast<int>(regions_of(mask).regions.size());
    return area;
}

MaskRegions regions_of(const Mask& mask) {
    MaskRegions result;
    result.number = Image<int>(mask.width(), mask.height());
    if (mask.empty()) return result;
    const cv::Mat inside = view_of(mask) > 0.5f;
    cv::Mat stats, centroids, numbers = view_of(result.number);
    const int count = cv::connectedComponentsWithStats(inside, numbers, stats, centroids, 8, CV_32S);
    for (int i = 1; i < count; ++i) {
        const int x = stats.at<int>(i, cv::CC_STAT_LEFT), y = stats.at<int>(i, cv::CC_STAT_TOP);
        result.regions.push_back(
            {{x, y, x + stats.at<int>(i, cv::CC_STAT_WIDTH), y + stats.at<int>(i, cv::CC_STAT_HEIGHT)},
             stats.at<int>(i, cv::CC_STAT_AREA)});
    }
    return result;
}

Mask connected_at(const Mask& mask, int x, int y) {
    if (x < 0 || y < 0 || x >= mask.width() || y >= mask.height() || !(mask(x, y) > 0)) return {};
    constexpr int kReached = 1;
    cv::Mat inside = view_of(mask) > 0.0f;  // 255
    cv::floodFill(inside, cv::Point(x, y), cv::Scalar(kReached), nullptr, {}, {}, 8);
    Mask area(mask.width(), mask.height());
    for (int row = 0; row < mask.height(); ++row)
        for (int column = 0; column < mask.width(); ++column)
            area(column, row) = inside.at<unsigned char>(row, column) == kReached;
    return area;
}

void write_mask(const std::filesystem::path& path, const Mask& mask) { write_map(path, mask, {.bits = 8}); }

Mask as_kept(const Mask& mask) {
    Mask kept = mask;
    for (float& part : kept.pixels()) part = std::round(std::clamp(part, 0.0f, 1.0f) * 255) / 255;
    return kept;
}

Mask read_mask(const std::filesystem::path& path, int width, int height) {
    // Before it is unpacked: another picture may be of any size.
    if (const PictureContent size = PictureRows(path).content(); size.width != width || size.height != height)
        fail("{}: is {} x {} pixels, but the painting has {} x {}; a mask has the painting's size",
             path.string(), size.width, size.height, width, height);
    const PictureWithAlpha file = read_picture_with_alpha(path);
    const Image<Rgb>& picture = file.colour;
    Mask mask(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Rgb c = picture(x, y);
            const float mean = (c.r + c.g + c.b) / 3;
            const float alpha = file.alpha.empty() ? 1.0f : file.alpha(x, y);
            if (!std::isfinite(mean + alpha))
                fail("{}: holds {} at pixel ({}, {})", path.string(), mean + alpha, x, y);
            mask(x, y) = std::clamp(mean, 0.0f, 1.0f);
        }
    see_through(mask, file.alpha);
    return mask;
}

namespace {

// Where a line at this height enters and leaves the polygons, by place: each is one of winding number not 0,
// and what lies within two of them is a hole. `to` is called for each run that is inside.
template <class Run>
void runs_inside(const std::vector<Polygon>& polygons, double at, Run&& to) {
    struct RimCrossing {
        double x;
        std::size_t polygon;
        int turn;
    };
    std::vector<RimCrossing> crossings;
    for (std::size_t p = 0; p < polygons.size(); ++p)
        for (std::size_t i = 0; i < polygons[p].size(); ++i) {
            const Corner &a = polygons[p][i], &b = polygons[p][(i + 1) % polygons[p].size()];
            if ((a.y <= at) != (b.y <= at))
                crossings.push_back({a.x + (b.x - a.x) * ((at - a.y) / (b.y - a.y)), p, a.y <= at ? 1 : -1});
        }
    std::ranges::sort(crossings, {}, &RimCrossing::x);
    std::vector<int> winding(polygons.size());
    bool inside = false;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        int& own = winding[crossings[i].polygon];
        const bool was = own != 0;
        own += crossings[i].turn;
        inside = inside != (was != (own != 0));
        if (inside) to(crossings[i].x, crossings[i + 1].x);
    }
}

// Corners on a line, or a way there and back. Of the polygon stretched to a unit square, which changes
// nothing of it; kLeastEnclosed is above what the rounding of corners (placed through a view, in doubles)
// leaves there, and far below what a hand can draw.
bool encloses_nothing(const Polygon& polygon) {
    constexpr int kRows = 64;
    constexpr double kLeastEnclosed = 1e-9;
    Corner low = polygon.front(), high = low;
    for (const Corner& c : polygon) {
        low = {std::min(low.x, c.x), std::min(low.y, c.y)};
        high = {std::max(high.x, c.x), std::max(high.y, c.y)};
    }
    if (!(high.x > low.x) || !(high.y > low.y)) return true;
    Polygon unit = polygon;
    for (Corner& c : unit) c = {(c.x - low.x) / (high.x - low.x), (c.y - low.y) / (high.y - low.y)};
    double area = 0;
    for (int row = 0; row < kRows; ++row)
        runs_inside({unit}, (row + 0.5) / kRows,
                    [&](double from, double to) { area += (to - from) / kRows; });
    return area < kLeastEnclosed;
}

void require_polygon(const Polygon& polygon) {
    if (polygon.size() < 3)
        fail("a polygon of {} corners has no inside; give at least three", polygon.size());
    for (const Corner& c : polygon)
        if (!std::isfinite(c.x) || !std::isfinite(c.y))
            fail("a polygon's corner ({}, {}) is not finite", c.x, c.y);
    if (encloses_nothing(polygon))
        fail("a polygon of {} corners encloses nothing: they lie on one line; set them around an area",
             polygon.size());
}

}  // namespace

Mask mask_of_polygons(const std::vector<Polygon>& polygons, int width, int height) {
    double top = height, bottom = 0;
    for (const Polygon& polygon : polygons) {
        require_polygon(polygon);
        for (const Corner& c : polygon) {
            top = std::min(top, c.y);
            bottom = std::max(bottom, c.y);
        }
    }
    Mask mask(width, height);
    const int first = static_cast<int>(std::clamp(std::floor(top), 0.0, static_cast<double>(height)));
    const int last = static_cast<int>(std::clamp(std::ceil(bottom), 0.0, static_cast<double>(height)));
    for (int y = first; y < last; ++y)
        for (int line = 0; line < kLines; ++line)
            runs_inside(polygons, y + (line + 0.5) / kLines,
                        [&](double from, double to) { add_run(mask.row(y), from, to, 1.0f / kLines); });
    bool any = false;
    for (float& part : mask.pixels()) {
        part = std::min(part, 1.0f);
        any = any || part > 0;
    }
    if (!any)
        fail("nothing of the polygon lies in the picture, which is {} x {} pixels from its top left corner",
             width, height);
    return mask;
}

Image<float> distance_inside_px(const Mask& mask) {
    const int width = mask.width(), height = mask.height();
    Image<float> result(width, height);
    const cv::Mat inside = view_of(mask) > 0.5f;
    const int count = cv::countNonZero(inside);
    const auto far = static_cast<float>(width + height);
    if (count == 0 || count == width * height) {
        std::fill(result.pixels().begin(), result.pixels().end(), count == 0 ? -far : far);
        return result;
    }
    cv::Mat in, out;
    cv::distanceTransform(inside, in, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::distanceTransform(~inside, out, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    // Distances are between centres; the outline runs half-way.
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float d = in.at<float>(y, x);
            result(x, y) = d > 0 ? d - 0.5f : 0.5f - out.at<float>(y, x);
        }
    return result;
}

Mask dilated(const Mask& mask, double radius_px) {
    TP_REQUIRE(std::isfinite(radius_px), "a radius is finite");
    if (radius_px == 0) return mask;
    const Image<float> distance = distance_inside_px(mask);
    Mask result(mask.width(), mask.height());
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            const float part = std::clamp(distance(x, y) + static_cast<float>(radius_px) + 0.5f, 0.0f, 1.0f);
            result(x, y) = radius_px > 0 ? std::max(part, mask(x, y)) : std::min(part, mask(x, y));
        }
    return result;
}

Mask feathered(const Mask& mask, double width_px) {
    TP_REQUIRE(width_px >= 0 && std::isfinite(width_px), "a feather has a width");
    if (width_px == 0) return mask;
    const Image<float> distance = distance_inside_px(mask);
    Mask result(mask.width(), mask.height());
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            result(x, y) =
                std::min(mask(x, y), std::clamp(distance(x, y) / static_cast<float>(width_px), 0.0f, 1.0f));
    return result;
}

Mask united(const Mask& a, const Mask& b) {
    return combined(a, b, [](float p, float q) { return std::max(p, q); });
}

Mask intersected(const Mask& a, const Mask& b) {
    return combined(a, b, [](float p, float q) { return std::min(p, q); });
}

Mask without(const Mask& a, const Mask& b) {
    return combined(a, b, [](float p, float q) { return std::min(p, 1 - q); });
}

}  // namespace tangi
