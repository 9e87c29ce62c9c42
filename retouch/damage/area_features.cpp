#include "retouch/damage/area_features.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "retouch/damage/local_deviation.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr int kTextureWindow = 7;  // [blocks]
constexpr int kMargin = 24;        // [blocks] around an area
constexpr int kWeaveWindow = 7;    // [blocks] what is broader is no weave
constexpr float kLeastGlossNoise = 0.03f;
constexpr double kWearWindow = 5;  // [blocks] sigma

// What is summed over a block.
enum Sum : std::size_t {
    kHeight,
    kL,
    kA,
    kB,
    kRed,
    kGreen,
    kBlue,
    kRoughness,
    kSpecular,
    kSlopeX,
    kSlopeY,
    kSlope2,
    kMeasured,
    kSums
};
using Sums = std::array<double, kSums>;

void add_pixel(const Surface& s, int x, int y, double unit_mm, Sums& sums) {
    const glm::dvec3 rho(glm::max(s.diffuse(x, y), Rgb(0)));
    const Lab lab = lab_from_linear(rho);
    const double h = static_cast<double>(s.height_mm(x, y)) * unit_mm;
    const Slope slope = slope_of(s.normal(x, y));
    const double sx = std::clamp(static_cast<double>(slope.x), -3.0, 3.0),
                 sy = std::clamp(static_cast<double>(slope.y), -3.0, 3.0);
    sums[kHeight] += h, sums[kL] += lab.l, sums[kA] += lab.a, sums[kB] += lab.b;
    sums[kRed] += std::log(rho.r + 0.01), sums[kGreen] += std::log(rho.g + 0.01),
        sums[kBlue] += std::log(rho.b + 0.01);
    sums[kRoughness] += static_cast<double>(std::log(std::max(s.roughness(x, y), 1e-3f)));
    sums[kSpecular] += static_cast<double>(std::log(std::max(s.specular(x, y), 0.0f) + 0.004f));
    sums[kSlopeX] += sx, sums[kSlopeY] += sy, sums[kSlope2] += sx * sx + sy * sy;
    sums[kMeasured] += s.confidence(x, y) == 0 && s.diffuse(x, y) == Rgb(0) ? 0 : 1;
}

// What was not measured holds zeros and NaN in some files: it counts as nothing.
bool finite(const Surface& s, int x, int y) {
    const Rgb& d = s.diffuse(x, y);
    const Vec3& n = s.normal(x, y);
    return std::isfinite(s.height_mm(x, y) + d.r + d.g + d.b + n.x + n.y + s.roughness(x, y) +
                         s.specular(x, y)) &&
           n.z > 0;
}

// Means of blocks, CV_64F: variances need the digits.
std::array<cv::Mat, kSums> means_of(const Surface& s, double unit_mm, int block, const Progress& progress) {
    const int columns = (s.width() + block - 1) / block, rows = (s.height() + block - 1) / block;
    std::array<cv::Mat, kSums> means;
    for (cv::Mat& m : means) m = cv::Mat(rows, columns, CV_64F);
    report(progress, "compare areas", 0);
    parallel_for(0, rows, 8, [&](int begin, int end) {
        for (int row = begin; row < end; ++row)
            for (int column = 0; column < columns; ++column) {
                Sums sums{};
                int count = 0;
                for (int y = row * block; y < std::min((row + 1) * block, s.height()); ++y)
                    for (int x = column * block; x < std::min((column + 1) * block, s.width()); ++x)
                        if (finite(s, x, y)) add_pixel(s, x, y, unit_mm, sums), ++count;
                for (std::size_t i = 0; i < kSums; ++i)
                    means[i].at<double>(row, column) = count > 0 ? sums[i] / count : 0;
            }
    });
    report(progress, "compare areas", 0.2);
    return means;
}

cv::Mat box(const cv::Mat& m, int window) {
    cv::Mat result;
    cv::boxFilter(m, result, -1, {window, window}, {-1, -1}, true, cv::BORDER_REFLECT);
    return result;
}

cv::Mat in_floats(const cv::Mat& m) {
    cv::Mat result;
    m.convertTo(result, CV_32F);
    return result;
}

// Single pixels of alpha and rho_s are noisy.
cv::Mat calm(const cv::Mat& m) {
    cv::Mat once, twice;
    cv::medianBlur(in_floats(m), once, 5);
    cv::medianBlur(once, twice, 5);
    return twice;
}

cv::Mat log_texture(const cv::Mat& x, const cv::Mat& y, const cv::Mat& squares) {
    const cv::Mat mx = box(x, kTextureWindow), my = box(y, kTextureWindow);
    cv::Mat v = box(squares, kTextureWindow) - mx.mul(mx) - my.mul(my), result;
    cv::log(cv::max(v, 1e-8), result);
    return in_floats(0.5 * result);
}

// [1] rms of what is finer than kWeaveWindow, over kWearWindow.
cv::Mat fine_squares(const cv::Mat& m) {
    const cv::Mat fine = m - box(m, kWeaveWindow);
    cv::Mat squares = fine.mul(fine), result;
    cv::GaussianBlur(squares, result, {}, kWearWindow, kWearWindow, cv::BORDER_REFLECT);
    return result;
}

cv::Mat range_of(const cv::Mat& a, const cv::Mat& b) {
    const cv::Mat window = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
    cv::Mat squares = cv::Mat::zeros(a.size(), CV_32F), low, high, range;
    for (const cv::Mat& m : {a, b}) {
        cv::erode(m, low, window);
        cv::dilate(m, high, window);
        range = high - low;
        squares += range.mul(range);
    }
    cv::sqrt(squares, range);
    return range;
}

cv::Mat wear_of(const cv::Mat& height, const std::array<cv::Mat, 3>& lab) {
    constexpr double least_contrast = 1, least_relief_mm = 0.01;  // that are told from noise
    cv::Mat colour = cv::Mat::zeros(height.size(), height.type()), relief = fine_squares(height);
    for (const cv::Mat& channel : lab) colour += fine_squares(channel);
    cv::log(cv::max(colour, 0) + least_contrast * least_contrast, colour);
    cv::log(cv::max(relief, 0) + least_relief_mm * least_relief_mm, relief);
    return in_floats(0.5 * (colour - relief));
}

double robust_spread(std::vector<double> values) {
    const double middle = median(values);
    for (double& v : values) v = std::abs(v - middle);
    return 1.4826 * median(std::move(values));
}

RimStep step_of(const std::vector<double>& in, const std::vector<double>& out,
                const std::vector<double>& far) {
    std::vector<double> steps, control;
    for (std::size_t i = 0; i < in.size(); ++i) {
        steps.push_back(in[i] - out[i]);
        control.push_back(std::abs(out[i] - far[i]));
    }
    RimStep r;
    r.step = median(steps);
    double agree = 0;
    for (const double s : steps) agree += s * r.step > 0 && std::abs(s) > std::abs(r.step) / 3 ? 1 : 0;
    r.agree = agree / static_cast<double>(steps.size());
    r.usual = 1.4826 * median(std::move(control));
    r.spread = robust_spread(std::move(steps));
    r.variety = robust_spread(in) / std::max(robust_spread(out), 1e-3);
    return r;
}

}  // namespace

AreaFeatures area_features_of(const Surface& surface, double unit_mm, int most_px, const Progress& progress) {
    AreaFeatures f;
    f.block = std::max((std::max(surface.width(), surface.height()) + most_px - 1) / most_px, 1);
    const auto means = means_of(surface, unit_mm, f.block, progress);
    const auto mean = [&](Sum sum) -> const cv::Mat& { return means[sum]; };
    const auto map = [&](Cue cue) -> cv::Mat& { return f.maps[static_cast<std::size_t>(cue)]; };
    map(Cue::height) = in_floats(mean(kHeight));
    map(Cue::lightness) = in_floats(mean(kL));
    map(Cue::a) = in_floats(mean(kA));
    map(Cue::b) = in_floats(mean(kB));
    map(Cue::red) = in_floats(mean(kRed));
    map(Cue::green) = in_floats(mean(kGreen));
    map(Cue::blue) = in_floats(mean(kBlue));
    map(Cue::roughness) = calm(mean(kRoughness));
    map(Cue::specular) = calm(mean(kSpecular));
    map(Cue::texture) = log_texture(mean(kSlopeX), mean(kSlopeY), mean(kSlope2));
    map(Cue::wear) = wear_of(mean(kHeight), {mean(kL), mean(kA), mean(kB)});

    f.measured = mean(kMeasured) > 0.5;
    f.gloss_range = range_of(map(Cue::roughness), map(Cue::specular));
    // A fifth of a picture at least lies away from the edges of its paints.
    f.gloss_noise = std::max(kLeastGlossNoise, 2 * quantile(f.gloss_range, 0.2));
    return f;
}

float within_paint(const AreaFeatures& f, float gloss_step) {
    return std::exp(-gloss_step * gloss_step / (f.gloss_noise * f.gloss_noise));
}

namespace {

// What lies on both sides of an area's rim.
class AreaRim {
public:
    AreaRim(const AreaFeatures& f, const Area& area, int away)
        : f_(f), inside_(area.inside), measured_(f.measured(area.box)), away_(away) {
        for (std::size_t c = 0; c < kCues; ++c) maps_[c] = f.maps[c](area.box);
        cv::distanceTransform(inside_, in_, cv::DIST_L2, 5);
        cv::distanceTransform(inside_ == 0, out_, cv::DIST_L2, 5);
    }

    bool is_rim(int x, int y) const { return in_.at<float>(y, x) > 0 && in_.at<float>(y, x) < 1.5f; }

    // Pixels across the rim: as far inside as outside of it, and three times as far outside.
    struct Across {
        cv::Point inside, outside, far;
        cv::Point rim;
        float gx = 0, gy = 0, length = 0;  // inwards
        cv::Point along(int d) const {
            return {rim.x + static_cast<int>(std::lround(static_cast<float>(d) * gx / length)),
                    rim.y + static_cast<int>(std::lround(static_cast<float>(d) * gy / length))};
        }
    };
    // Nothing where one of them was not measured, or lies on the other side.
    std::optional<Across> across(int x, int y) const {
        Across a;
        a.rim = {x, y};
        a.gx = distance(x + 2, y) - distance(x - 2, y);
        a.gy = distance(x, y + 2) - distance(x, y - 2);
        a.length = std::hypot(a.gx, a.gy);
        if (!(a.length > 0)) return {};
        a.inside = a.along(away_), a.outside = a.along(-away_), a.far = a.along(-3 * away_);
        if (!good(a.inside, true) || !good(a.outside, false) || !good(a.far, false)) return {};
        return a;
    }

    // No edge between two paints lies there.
    bool is_one_paint(const Across& a) const {
        bool one_paint = true;
        for (int d = -away_; one_paint && d <= away_; ++d) {
            const auto step = [&](Cue cue) {
                const cv::Mat& m = maps_[static_cast<std::size_t>(cue)];
                return m.at<float>(a.along(d)) - m.at<float>(a.outside);
            };
            one_paint = within_paint(f_, std::hypot(step(Cue::roughness), step(Cue::specular))) > 0.4f;
        }
        return one_paint;
    }

    double value(std::size_t cue, const cv::Point& p) const {
        return static_cast<double>(maps_[cue].at<float>(p));
    }

private:
    // [blocks] to the rim, above 0 inside.
    float distance(int x, int y) const {
        const cv::Point p(std::clamp(x, 0, inside_.cols - 1), std::clamp(y, 0, inside_.rows - 1));
        return in_.at<float>(p) - out_.at<float>(p);
    }
    bool good(const cv::Point& p, bool within) const {
        return cv::Rect(0, 0, inside_.cols, inside_.rows).contains(p) &&
               (inside_.at<unsigned char>(p) != 0) == within && measured_.at<unsigned char>(p) != 0;
    }

    const AreaFeatures& f_;
    const cv::Mat& inside_;
    const cv::Mat measured_;
    std::array<cv::Mat, kCues> maps_;
    cv::Mat in_, out_;
    int away_;  // [blocks] from the rim
};

}  // namespace

Rim rim_of(const AreaFeatures& f, const Area& area, int away, Compared which) {
    const AreaRim at(f, area, away);
    std::array<std::vector<double>, kCues> ins, outs, fars;
    int all = 0;
    for (int y = 0; y < area.inside.rows; ++y)
        for (int x = 0; x < area.inside.cols; ++x) {
            if (!at.is_rim(x, y)) continue;
            ++all;
            const std::optional<AreaRim::Across> across = at.across(x, y);
            if (!across) continue;
            if (which == Compared::within_paint && !at.is_one_paint(*across)) continue;
            for (std::size_t c = 0; c < kCues; ++c) {
                ins[c].push_back(at.value(c, across->inside));
                outs[c].push_back(at.value(c, across->outside));
                fars[c].push_back(at.value(c, across->far));
            }
        }
    Rim rim;
    rim.points = static_cast<int>(ins[0].size());
    rim.seen = rim.points / std::max<double>(all, 1);
    if (rim.points < 12) return rim;
    for (std::size_t c = 0; c < kCues; ++c) rim.cues[c] = step_of(ins[c], outs[c], fars[c]);
    return rim;
}

std::vector<Area> areas_above(const cv::Mat& evidence, const std::vector<double>& thresholds, int least,
                              double most) {
    std::vector<Area> areas;
    const cv::Rect picture(0, 0, evidence.cols, evidence.rows);
    for (const double threshold : thresholds) {
        cv::Mat above, whole;
        cv::morphologyEx(evidence > threshold, above, cv::MORPH_CLOSE, disc(2));
        cv::morphologyEx(above, whole, cv::MORPH_OPEN, disc(3));
        std::vector<std::vector<cv::Point>> outlines;
        cv::findContours(whole, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
        for (std::size_t i = 0; i < outlines.size(); ++i) {
            Area area;
            area.box = cv::boundingRect(outlines[i]);
            if (area.box.area() < least) continue;
            area.box = cv::Rect(area.box.x - kMargin, area.box.y - kMargin, area.box.width + 2 * kMargin,
                                area.box.height + 2 * kMargin) &
                       picture;
            area.inside = cv::Mat::zeros(area.box.size(), CV_8U);
            cv::drawContours(area.inside, outlines, static_cast<int>(i), cv::Scalar(255), cv::FILLED,
                             cv::LINE_8, cv::noArray(), 0, -area.box.tl());
            area.blocks = cv::countNonZero(area.inside);
            if (area.blocks >= least && area.blocks <= most * static_cast<double>(evidence.total()))
                areas.push_back(area);
        }
    }
    return areas;
}

Area grown(const Area& area, int blocks, const cv::Size& picture) {
    Area wider;
    wider.box = cv::Rect(area.box.x - blocks, area.box.y - blocks, area.box.width + 2 * blocks,
                         area.box.height + 2 * blocks) &
                cv::Rect({0, 0}, picture);
    cv::Mat inside = cv::Mat::zeros(wider.box.size(), CV_8U);
    area.inside.copyTo(inside(cv::Rect(area.box.tl() - wider.box.tl(), area.box.size())));
    cv::dilate(inside, wider.inside, disc(blocks));
    wider.blocks = cv::countNonZero(wider.inside);
    return wider;
}

}  // namespace tangi
