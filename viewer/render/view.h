// view.h: which part of a painting is seen, how large and how turned, and where it lies in space.
//
// Screen: pixels of the canvas area, origin at its upper left corner, x right, y down. Painting: pixels,
// whole numbers are centres. No OpenGL here.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "viewer/render/scene.h"
#include "viewer/render/tilt.h"

namespace tangi {

struct View {
    glm::dvec2 centre_px{0};  // [pixels of the painting] at the middle of the screen
    double zoom = 1;          // [pixels of the screen for one of the painting]
    double turn_deg = 0;      // of the painting, counter-clockwise

    static constexpr double kSmallest = 1.0 / 1024, kLargest = 64;
};

struct Extent {
    int width = 0, height = 0;  // [pixels]
};

View fitted(Extent painting, Extent screen, double turn_deg = 0);
// Larger by `factor`; what is under the cursor stays there.
View zoomed(View view, double factor, const glm::dvec2& cursor, Extent screen);
View panned(View view, const glm::dvec2& by);  // [pixels of the screen]
View turned(View view, double by_deg);
// Larger and turned, so that what was at `from` is at `to` [pixels of the screen].
View pinched(View view, const glm::dvec2& from, const glm::dvec2& to, double factor, double turn_deg,
             Extent screen);

// The painting in space: turned by view and tilt about the middle of the screen, seen in perspective from
// three heights of the screen.
class Placement {
public:
    // How it is held before whoever looks; without: upright, seen from straight before it.
    struct Pose {
        Tilt tilt{};
        bool flat = false;  // the screen itself is tilted, as a tablet: the picture stays, the light moves
        Vec3 viewer = {0, 0, 1};  // the direction to whoever looks, a unit vector: gloss is seen from there,
                                  // the picture stays, since the eye itself sees the screen from aside
    };
    Placement(const View& view, const Pose& pose, Extent painting, Extent screen, double mm_per_pixel);

    // Screen -> painting; false where the ray misses the painting's plane.
    bool to_painting(const glm::dvec2& screen, glm::dvec2& painting) const;
    glm::dvec2 to_screen(const glm::dvec2& painting) const;

    // From the room's frame to the surface's.
    Vec3 in_surface(const Vec3& direction) const;

    // A shot of the screen, with `scale` pixels for each of its; `smooth` as there.
    Shot shot(double scale, bool smooth) const;

private:
    glm::dmat3 screen_from_painting_, painting_from_screen_, orientation_;
    glm::dvec4 eye_;
    Extent screen_;
    double zoom_;
};

// Where on the picture a shot may show the painting: no pixel outside does. Rows from below, empty where it
// is not seen.
Region seen_on(const Shot& shot, Extent painting);
// What a shot shows of the painting's plane: a convex outline [pixels of the painting].
std::vector<glm::dvec2> outline_of(const Shot& shot);
// The part of a convex outline where dot(normal, place) >= least.
std::vector<glm::dvec2> clipped(const std::vector<glm::dvec2>& outline, const glm::dvec2& normal,
                                double least);

// Unit vector of a light from its azimuth (counter-clockwise from x) and elevation above the plane, and back.
Vec3 direction_of(double azimuth_deg, double elevation_deg);
struct Angles {
    double azimuth_deg = 0, elevation_deg = 90;
};
Angles angles_of(const Vec3& direction);

// The light that the cursor at this place of a disc means (centre 0, radius 1, y up): its rim is 2 degrees
// high.
Angles light_at(const glm::dvec2& place);
glm::dvec2 place_of(const Angles& light);

}  // namespace tangi
