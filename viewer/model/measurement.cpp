#include "viewer/model/measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tangi {

namespace {

float bilinear(const Image<float>& map, double x, double y) {
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
    const float above = (1 - u) * map.clamped(x0, y0) + u * map.clamped(x0 + 1, y0);
    const float below = (1 - u) * map.clamped(x0, y0 + 1) + u * map.clamped(x0 + 1, y0 + 1);
    return (1 - v) * above + v * below;
}

// Welford 1962: no sums of squares that cancel.
class Running {
public:
    void add(double value) {
        const double from_mean = value - mean_;
        mean_ += from_mean / ++count_;
        squares_ += from_mean * (value - mean_);
    }
    MeanAndSpread result() const { return {mean_, count_ > 0 ? std::sqrt(squares_ / count_) : 0}; }

private:
    double count_ = 0, mean_ = 0, squares_ = 0;
};

// The part of the line from + t (to - from), 0 <= t <= 1, on which one coordinate is in [low, high].
void clip(double from, double to, double low, double high, double& begin, double& end) {
    const double by = to - from;
    if (by == 0) {
        if (from < low || from > high) end = -1;
        return;
    }
    const double a = (low - from) / by, b = (high - from) / by;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
}

}  // namespace

HeightProfile height_profile(const Surface& surface, const glm::dvec2& from, const glm::dvec2& to) {
    HeightProfile profile;
    profile.scale_known = surface.scale_known;
    double begin = 0, end = 1;
    clip(from.x, to.x, -0.5, surface.width() - 0.5, begin, end);
    clip(from.y, to.y, -0.5, surface.height() - 0.5, begin, end);
    if (end <= begin || from == to) return profile;
    profile.from_px = from + begin * (to - from);
    profile.to_px = from + end * (to - from);
    const glm::dvec2 along = profile.to_px - profile.from_px;
    const double length = std::hypot(along.x, along.y);
    const int steps = std::max(1, static_cast<int>(std::ceil(length)));
    profile.step_mm = length / steps * surface.mm_per_pixel;
    for (int i = 0; i <= steps; ++i) {
        const glm::dvec2 at = profile.from_px + along * (i / double(steps));
        profile.height_mm.push_back(bilinear(surface.height_mm, at.x, at.y));
    }
    return profile;
}

HeightProfile in_mm(HeightProfile profile, double mm_per_pixel) {
    profile.scale_known = true;
    profile.step_mm *= mm_per_pixel;
    for (float& height : profile.height_mm) height *= static_cast<float>(mm_per_pixel);
    return profile;
}

std::string csv_of(const HeightProfile& profile) {
    const char* unit = profile.scale_known ? "mm" : "px";
    std::string text = fmt::format("distance_{},height_{}\n", unit, unit);
    for (std::size_t i = 0; i < profile.height_mm.size(); ++i)
        text +=
            fmt::format("{:.6g},{:.6g}\n", static_cast<double>(i) * profile.step_mm, profile.height_mm[i]);
    return text;
}

RegionStatistics statistics_of(const Surface& s, const Region& wanted) {
    RegionStatistics result;
    const Region r{std::max(wanted.x0, 0), std::max(wanted.y0, 0), std::min(wanted.x1, s.width()),
                   std::min(wanted.y1, s.height())};
    result.region = r;
    Running specular, roughness, height, confidence, slope_x, slope_y;
    glm::dvec3 sum(0);
    const auto counted = [&](const auto& body) {
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x)
                if (s.confidence(x, y) > 0) body(x, y);
    };
    counted([&](int x, int y) {
        ++result.pixels;
        sum += glm::dvec3(s.diffuse(x, y));
        specular.add(s.specular(x, y));
        roughness.add(s.roughness(x, y));
        height.add(s.height_mm(x, y));
        confidence.add(s.confidence(x, y));
        const Vec3& n = s.normal(x, y);
        slope_x.add(-n.x / n.z);
        slope_y.add(-n.y / n.z);
    });
    if (result.pixels == 0) return result;
    result.lab_of_mean = lab_from_linear(sum / static_cast<double>(result.pixels));
    Running difference;
    counted([&](int x, int y) {
        difference.add(delta_e_2000(lab_from_linear(glm::dvec3(s.diffuse(x, y))), result.lab_of_mean));
    });
    result.colour_spread = difference.result().mean;
    result.specular = specular.result();
    result.roughness = roughness.result();
    result.height_mm = height.result();
    result.confidence = confidence.result();
    result.rms_slope = std::hypot(slope_x.result().deviation, slope_y.result().deviation);
    return result;
}

}  // namespace tangi
