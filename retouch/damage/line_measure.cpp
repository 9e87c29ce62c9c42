// line_measure.cpp: skeletons of masks, and the length and width of lines.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "retouch/damage/damage_suggestion.h"

namespace tangi {

namespace {

// The 8 neighbours of a pixel, clockwise from above; what lies beyond the picture is 0.
std::array<bool, 8> around(const Image<unsigned char>& on, int x, int y) {
    constexpr std::array<std::array<int, 2>, 8> steps = {
        {{0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}}};
    std::array<bool, 8> p{};
    for (std::size_t i = 0; i < 8; ++i) {
        const int nx = x + steps[i][0], ny = y + steps[i][1];
        p[i] = nx >= 0 && ny >= 0 && nx < on.width() && ny < on.height() && on(nx, ny) != 0;
    }
    return p;
}

// One of the two passes of Zhang & Suen 1984: whether a pixel of the rim goes.
bool goes(const std::array<bool, 8>& p, bool second) {
    int neighbours = 0, rises = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        neighbours += p[i] ? 1 : 0;
        rises += !p[i] && p[(i + 1) % 8] ? 1 : 0;
    }
    if (neighbours < 2 || neighbours > 6 || rises != 1) return false;
    const bool up = p[0], right = p[2], down = p[4], left = p[6];
    return second ? !(up && right && left) && !(up && down && left)
                  : !(up && right && down) && !(right && down && left);
}

}  // namespace

Mask skeleton_of(const Mask& mask) {
    Image<unsigned char> on(mask.width(), mask.height());
    std::vector<std::array<int, 2>> left, going;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (mask(x, y) > 0.5f) {
                on(x, y) = 1;
                left.push_back({x, y});
            }
    for (bool changed = true; changed;) {
        changed = false;
        for (const bool second : {false, true}) {
            going.clear();
            for (const auto& [x, y] : left)
                if (goes(around(on, x, y), second)) going.push_back({x, y});
            for (const auto& [x, y] : going) on(x, y) = 0;
            std::erase_if(left, [&](const auto& p) { return !on(p[0], p[1]); });
            changed = changed || !going.empty();
        }
    }
    Mask skeleton(mask.width(), mask.height());
    for (const auto& [x, y] : left) skeleton(x, y) = 1;
    return skeleton;
}

CraquelureMeasure measure_lines(const Mask& lines, double mm_per_pixel) {
    CraquelureMeasure measure;
    if (lines.empty()) return measure;
    const Mask skeleton = skeleton_of(lines);
    const auto on = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < lines.width() && y < lines.height() && skeleton(x, y) > 0;
    };
    double length_px = 0, area_px = 0;
    for (int y = 0; y < lines.height(); ++y)
        for (int x = 0; x < lines.width(); ++x) {
            area_px += static_cast<double>(lines(x, y));
            if (!on(x, y)) continue;
            // Each link once; a diagonal one only where no pixel beside it makes the way round.
            length_px += on(x + 1, y) ? 1 : 0;
            length_px += on(x, y + 1) ? 1 : 0;
            if (on(x + 1, y + 1) && !on(x + 1, y) && !on(x, y + 1)) length_px += std::numbers::sqrt2;
            if (on(x - 1, y + 1) && !on(x - 1, y) && !on(x, y + 1)) length_px += std::numbers::sqrt2;
        }
    measure.pieces = static_cast<int>(regions_of(lines).regions.size());
    measure.length_mm = length_px * mm_per_pixel;
    measure.width_mm = length_px > 0 ? area_px / length_px * mm_per_pixel : 0;
    const double area_cm2 = static_cast<double>(lines.size()) * mm_per_pixel * mm_per_pixel / 100;
    measure.density_per_cm = measure.length_mm / 10 / area_cm2;
    return measure;
}

}  // namespace tangi
