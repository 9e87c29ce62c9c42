// flaking_suggestion.cpp: where plates of paint between cracks have come up at their edges.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "retouch/damage/area_features.h"
#include "retouch/damage/flaking_suggestion.h"
#include "retouch/damage/local_deviation.h"

namespace tangi {

namespace {

constexpr double kMostFlaking = 0.7;  // [1] of the picture: flaking may be nearly all of it
constexpr int kDirections = 8;        // in which a crack may be crossed
constexpr double kLifted_mm = 0.03;   // of an edge above its plate: along sound cracks paint curls by less
constexpr double kDeep_mm = 0.10;     // of the gap below its edges: through paint that stands up by that much
constexpr double kNear_mm = 3;        // sigma over which cracks are looked at together
constexpr double kFewCracks = 0.04;   // [1] of the area; where there are no more, single ones tell nothing
constexpr double kLeast_mm2 = 7;      // of lifted edges, some 0.7 mm wide: of four or five plates
constexpr std::array<double, 4> kThresholds = {0.06, 0.09, 0.13, 0.18};

// What stands beside a pixel of a crack, which is crossed where it is deepest.
struct Crossing {
    double rise_mm = 0;  // of the lower of the two edges above its plate
    bool lifted = false;
    float direction = 0;  // [rad] across
};

// [pixels] from a crack: its gap, the edges beside it, and where their plates lie.
struct CrackReach {
    float gap, edge, plate;
};

// Height in mm, linear between pixels; the border goes on.
class Heights {
public:
    Heights(const Surface& s, double unit_mm) : map_(s.height_mm), unit_mm_(unit_mm) {}
    double at(float x, float y) const {
        const auto fx = std::floor(x), fy = std::floor(y);
        const int u = static_cast<int>(fx), v = static_cast<int>(fy);
        const float right = x - fx, down = y - fy;
        const float above = (1 - right) * map_.clamped(u, v) + right * map_.clamped(u + 1, v);
        const float below = (1 - right) * map_.clamped(u, v + 1) + right * map_.clamped(u + 1, v + 1);
        return unit_mm_ * static_cast<double>((1 - down) * above + down * below);
    }

private:
    const Image<float>& map_;
    double unit_mm_;
};

Crossing crossing_at(const Heights& heights, int x, int y, const CrackReach& reach) {
    Crossing best;
    double deepest = -1e30;
    for (int i = 0; i < kDirections; ++i) {
        const float a = std::numbers::pi_v<float> * static_cast<float>(i) / kDirections;
        const auto at = [&](float d) {
            return heights.at(static_cast<float>(x) + d * std::cos(a),
                              static_cast<float>(y) + d * std::sin(a));
        };
        const auto edge = [&](float side) {
            double highest = -1e30;
            for (const float d : {0.33f, 0.5f, 0.67f, 0.83f, 1.0f})
                highest = std::max(highest, at(side * d * reach.edge));
            return highest;
        };
        const auto plate = [&](float side) {
            return (at(side * 0.86f * reach.plate) + at(side * reach.plate) +
                    at(side * 1.14f * reach.plate)) /
                   3;
        };
        const double gap = std::min({at(-reach.gap), at(0), at(reach.gap)}), left = edge(-1), right = edge(1);
        const double depth = std::min(left, right) - gap;
        if (!(depth > deepest)) continue;
        deepest = depth;
        const double left_plate = plate(-1), right_plate = plate(1);
        best.rise_mm = std::min(left - left_plate, right - right_plate);
        best.lifted =
            best.rise_mm > kLifted_mm && depth > kDeep_mm && gap < std::min(left_plate, right_plate);
        best.direction = a;
    }
    return best;
}

// Sums over blocks, CV_32F.
struct Cracks {
    cv::Mat all, lifted;   // [pixels of cracks]
    cv::Mat cosine, sine;  // of twice the direction of those that are lifted
    cv::Mat rise_mm;       // of those
    int block = 1;
};

Cracks cracks_of(const Surface& s, const Mask& lines, double mm_per_pixel) {
    Cracks c;
    c.block = std::max((std::max(s.width(), s.height()) + kSide_px - 1) / kSide_px, 1);
    c.all = cv::Mat::zeros((s.height() + c.block - 1) / c.block, (s.width() + c.block - 1) / c.block, CV_32F);
    for (cv::Mat* m : {&c.lifted, &c.cosine, &c.sine, &c.rise_mm}) *m = c.all.clone();
    const auto px = [mm_per_pixel](double mm, double least) {
        return static_cast<float>(std::max(mm / mm_per_pixel, least));
    };
    const CrackReach reach{px(0.2, 0.7), px(0.9, 3), px(2.1, 7)};
    const Heights heights(s, mm_per_pixel / s.mm_per_pixel);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            if (!(lines(x, y) > 0)) continue;
            const Crossing crossing = crossing_at(heights, x, y, reach);
            const cv::Point at(x / c.block, y / c.block);
            c.all.at<float>(at) += 1;
            if (!crossing.lifted) continue;
            c.lifted.at<float>(at) += 1;
            c.cosine.at<float>(at) += std::cos(2 * crossing.direction);
            c.sine.at<float>(at) += std::sin(2 * crossing.direction);
            c.rise_mm.at<float>(at) += static_cast<float>(crossing.rise_mm);
        }
    return c;
}

// [1] Part of the cracks around each place that stand open between lifted edges, and run in all directions:
// plates have edges all round, strokes that run beside each other have not.
cv::Mat evidence_of(const Cracks& c, double mm_per_pixel) {
    const double sigma = std::max(kNear_mm / (mm_per_pixel * c.block), 1.5);
    const auto around = [&](const cv::Mat& m) {
        cv::Mat result;
        cv::GaussianBlur(m, result, {}, sigma, sigma, cv::BORDER_REFLECT);
        return result;
    };
    const cv::Mat all = around(c.all), lifted = around(c.lifted), cosine = around(c.cosine),
                  sine = around(c.sine);
    cv::Mat along;
    cv::magnitude(cosine, sine, along);
    return (lifted - along) / (all + kFewCracks * c.block * c.block);
}

double sum_in(const cv::Mat& m, const Area& area) {
    double sum = 0;
    for (int y = 0; y < area.box.height; ++y)
        for (int x = 0; x < area.box.width; ++x)
            if (area.inside.at<unsigned char>(y, x))
                sum += static_cast<double>(m.at<float>(area.box.y + y, area.box.x + x));
    return sum;
}

// An area against the rest of the picture, and against what lies close beside it: an outline is wrong beyond
// which as many edges are lifted.
Judged judge(const Cracks& c, const Area& area, double mm_per_pixel) {
    const auto within = [&](const cv::Mat& m) { return sum_in(m, area); };
    const double all = within(c.all), lifted = within(c.lifted);
    if (!(all > 0) || !(lifted > 0)) return {};
    const int ring = std::max(static_cast<int>(std::lround(kNear_mm / (mm_per_pixel * c.block))), 2);
    const Area wider = grown(area, ring, c.all.size());
    const double beside = (sum_in(c.lifted, wider) - lifted) / std::max(sum_in(c.all, wider) - all, 20.0);
    const double part = lifted / all,
                 elsewhere = (cv::sum(c.lifted)[0] - lifted) / std::max(cv::sum(c.all)[0] - all, 1.0);
    const double directions = 1 - std::hypot(within(c.cosine), within(c.sine)) / lifted;
    return {rising(part / 0.1, 0.2) * rising(part / (4 * elsewhere + 0.02), 0.25) *
                rising(lifted * mm_per_pixel * mm_per_pixel / kLeast_mm2, 0.2) *
                rising(directions / 0.5, 0.12) * rising(2 - beside / (0.4 * part), 0.2),
            fmt::format(
                "{:.0f} % of the cracks stand open between edges that rise by {:.2f} mm; elsewhere {:.0f} %",
                100 * part, within(c.rise_mm) / lifted, 100 * elsewhere)};
}

}  // namespace

std::vector<FlakingArea> flaking_areas(const Surface& surface, double mm_per_pixel, double smallest_mm2,
                                       int& block, const Progress& progress) {
    const CraquelureSuggestion lines = suggest_craquelure(surface, mm_per_pixel, {}, progress);
    const Cracks cracks = cracks_of(surface, lines.mask, mm_per_pixel);
    block = cracks.block;
    const double block_mm2 = mm_per_pixel * mm_per_pixel * block * block;
    const int least = std::max(static_cast<int>(std::ceil(smallest_mm2 / block_mm2)), 60);
    std::vector<FlakingArea> areas;
    for (Area& area : areas_above(evidence_of(cracks, mm_per_pixel), {kThresholds.begin(), kThresholds.end()},
                                  least, kMostFlaking)) {
        Judged judged = judge(cracks, area, mm_per_pixel);
        areas.push_back({std::move(area), judged.confidence, std::move(judged.cues)});
    }
    return areas;
}

}  // namespace tangi
