#include "viewer/render/view.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace tangi {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kEyeHeights = 3;  // distance of the eye in heights of the screen
constexpr double kMargin = 0.95;   // of the screen that a fitted painting takes
constexpr double kLowest_deg = 2;

// Right and up [pixels of the painting, turned] of a vector on the screen.
glm::dvec2 unturned(const View& view, const glm::dvec2& screen) {
    const double a = view.turn_deg * kDegree, x = screen.x, y = -screen.y;
    return {(std::cos(a) * x + std::sin(a) * y) / view.zoom,
            -(-std::sin(a) * x + std::cos(a) * y) / view.zoom};
}

}  // namespace

View fitted(Extent painting, Extent screen, double turn_deg) {
    const double a = turn_deg * kDegree, c = std::abs(std::cos(a)), s = std::abs(std::sin(a));
    const double width = c * painting.width + s * painting.height,
                 height = s * painting.width + c * painting.height;
    View view{{(painting.width - 1) / 2.0, (painting.height - 1) / 2.0}, 1, turn_deg};
    if (screen.width > 0 && screen.height > 0 && width > 0 && height > 0)
        view.zoom = std::clamp(kMargin * std::min(screen.width / width, screen.height / height),
                               View::kSmallest, View::kLargest);
    return view;
}

View zoomed(View view, double factor, const glm::dvec2& cursor, Extent screen) {
    const glm::dvec2 from_middle = cursor - 0.5 * glm::dvec2(screen.width, screen.height);
    const glm::dvec2 under = view.centre_px + unturned(view, from_middle);
    view.zoom = std::clamp(view.zoom * factor, View::kSmallest, View::kLargest);
    view.centre_px = under - unturned(view, from_middle);
    return view;
}

View panned(View view, const glm::dvec2& by) {
    view.centre_px -= unturned(view, by);
    return view;
}

View turned(View view, double by_deg) {
    view.turn_deg = std::remainder(view.turn_deg + by_deg, 360.0);
    return view;
}

View pinched(View view, const glm::dvec2& from, const glm::dvec2& to, double factor, double turn_deg,
             Extent screen) {
    const glm::dvec2 middle = 0.5 * glm::dvec2(screen.width, screen.height);
    const glm::dvec2 under = view.centre_px + unturned(view, from - middle);
    view.zoom = std::clamp(view.zoom * factor, View::kSmallest, View::kLargest);
    view = turned(view, turn_deg);
    view.centre_px = under - unturned(view, to - middle);
    return view;
}

Placement::Placement(const View& view, const Pose& pose, Extent painting, Extent screen, double mm_per_pixel)
    : screen_(screen), zoom_(view.zoom) {
    const glm::dmat3 turn = rotation_z(view.turn_deg * kDegree), hand = pose.tilt.rotation();
    const glm::dmat3 seen = pose.flat ? glm::dmat3(1) : hand;
    const double distance = kEyeHeights * std::max(screen.height, 1);  // [pixels of the screen]
    // Painting -> plane through the middle of the screen, in its pixels, y up. Columns.
    const double z = view.zoom;
    const glm::dmat3 plane =
        turn * glm::dmat3({z, 0, 0}, {0, -z, 0}, {-z * view.centre_px.x, z * view.centre_px.y, 1});
    const glm::dmat3 projected({distance * seen[0].x, distance * seen[0].y, -seen[0].z},
                               {distance * seen[1].x, distance * seen[1].y, -seen[1].z}, {0, 0, distance});
    const glm::dmat3 screened({1, 0, 0}, {0, -1, 0}, {screen.width / 2.0, screen.height / 2.0, 1});
    screen_from_painting_ = screened * projected * plane;
    painting_from_screen_ = glm::inverse(screen_from_painting_);
    orientation_ = glm::transpose(hand * turn);
    const glm::dvec3 eye =
        glm::transpose(seen * turn) * (distance / z * mm_per_pixel * glm::dvec3(pose.viewer));
    const glm::dvec2 middle((painting.width - 1) / 2.0, (painting.height - 1) / 2.0);
    const glm::dvec2 centre = (view.centre_px - middle) * mm_per_pixel;
    eye_ = {eye.x + centre.x, eye.y - centre.y, eye.z, 1};
}

bool Placement::to_painting(const glm::dvec2& screen, glm::dvec2& painting) const {
    const glm::dvec3 q = painting_from_screen_ * glm::dvec3(screen, 1);
    if (!(q.z > 0)) return false;
    painting = glm::dvec2(q) / q.z;
    return true;
}

glm::dvec2 Placement::to_screen(const glm::dvec2& painting) const {
    const glm::dvec3 q = screen_from_painting_ * glm::dvec3(painting, 1);
    return glm::dvec2(q) / q.z;
}

Vec3 Placement::in_surface(const Vec3& direction) const { return Vec3(orientation_ * glm::dvec3(direction)); }

Shot Placement::shot(double scale, bool smooth) const {
    Shot shot;
    shot.width = std::max(1, static_cast<int>(std::lround(screen_.width * scale)));
    shot.height = std::max(1, static_cast<int>(std::lround(screen_.height * scale)));
    const double x = static_cast<double>(screen_.width) / shot.width,
                 y = static_cast<double>(screen_.height) / shot.height;
    const glm::dmat3 screen_from_shot({x, 0, 0}, {0, -y, 0}, {0, static_cast<double>(screen_.height), 1});
    glm::dmat3 to_painting = painting_from_screen_ * screen_from_shot;
    // Pixels of the screen have their centres at halves, as those of the shot.
    to_painting /= to_painting[2].z == 0 ? 1.0 : std::abs(to_painting[2].z);
    shot.to_painting = glm::mat3(to_painting);
    shot.eye = glm::vec4(eye_);
    shot.level = std::max(0, static_cast<int>(std::lround(std::log2(std::max(1.0, x / zoom_)))));
    shot.smooth = smooth;
    return shot;
}

std::vector<glm::dvec2> clipped(const std::vector<glm::dvec2>& outline, const glm::dvec2& normal,
                                double least) {
    std::vector<glm::dvec2> inside;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
        const double over_a = glm::dot(normal, a) - least, over_b = glm::dot(normal, b) - least;
        if (over_a >= 0) inside.push_back(a);
        if ((over_a >= 0) != (over_b >= 0)) inside.push_back(a + over_a / (over_a - over_b) * (b - a));
    }
    return inside;
}

std::vector<glm::dvec2> outline_of(const Shot& shot) {
    const glm::dmat3 m(shot.to_painting);
    // What lies behind the viewer is not seen: there the third component is not positive.
    const double nearest = 1e-4 * std::abs(m[2].z);
    std::vector<glm::dvec2> outline =
        clipped({{0, 0}, {shot.width, 0}, {shot.width, shot.height}, {0, shot.height}}, {m[0].z, m[1].z},
                nearest - m[2].z);
    for (glm::dvec2& p : outline) {
        const glm::dvec3 q = m * glm::dvec3(p, 1);
        p = glm::dvec2(q) / q.z;
    }
    return outline;
}

Region seen_on(const Shot& shot, Extent painting) {
    const glm::dmat3 m = glm::inverse(glm::dmat3(shot.to_painting));
    // The third component is 1 / that of to_painting, which is largest at a corner of the picture.
    double largest = 0;
    for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(shot.width, 0), glm::dvec2(0, shot.height),
                                    glm::dvec2(shot.width, shot.height)})
        largest = std::max(largest, (glm::dmat3(shot.to_painting) * glm::dvec3(corner, 1)).z);
    if (largest <= 0) return {};  // all of it lies behind the viewer
    const double nearest = 0.5 / largest;
    const double right = painting.width - 0.5, bottom = painting.height - 0.5;
    std::vector<glm::dvec2> outline = clipped({{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}},
                                              {m[0].z, m[1].z}, nearest - m[2].z);
    for (glm::dvec2& p : outline) {
        const glm::dvec3 q = m * glm::dvec3(p, 1);
        p = glm::dvec2(q) / q.z;
    }
    outline = clipped(clipped(outline, {1, 0}, 0), {-1, 0}, -shot.width);
    outline = clipped(clipped(outline, {0, 1}, 0), {0, -1}, -shot.height);
    if (outline.empty()) return {};
    glm::dvec2 low = outline.front(), high = low;
    for (const glm::dvec2& p : outline) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    // Half a pixel more on each side: the shader reckons with single precision.
    const auto inside = [](double v, int size) { return std::clamp(static_cast<int>(v), 0, size); };
    return {inside(std::floor(low.x - 0.5), shot.width), inside(std::floor(low.y - 0.5), shot.height),
            inside(std::ceil(high.x + 0.5), shot.width), inside(std::ceil(high.y + 0.5), shot.height)};
}

Vec3 direction_of(double azimuth_deg, double elevation_deg) {
    const double a = azimuth_deg * kDegree, e = elevation_deg * kDegree;
    return Vec3(glm::dvec3(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)));
}

Angles angles_of(const Vec3& d) {
    const double across = std::hypot(d.x, d.y);
    return {across > 0 ? std::atan2(d.y, d.x) / kDegree : 0, std::atan2(d.z, across) / kDegree};
}

Angles light_at(const glm::dvec2& place) {
    const double radius = std::min(glm::length(place), 1.0);
    const double azimuth = radius > 0 ? std::atan2(place.y, place.x) / kDegree : 0;
    return {azimuth, std::max(std::acos(radius) / kDegree, kLowest_deg)};
}

glm::dvec2 place_of(const Angles& light) {
    const Vec3 d = direction_of(light.azimuth_deg, light.elevation_deg);
    return {d.x, d.y};
}

}  // namespace tangi
