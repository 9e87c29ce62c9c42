// head_tracking.h: from where the painting is looked at, as a camera at the screen sees the head (tangiBook
// of the thesis).
//
// The camera looks out of the screen, so that the left of its picture is the right of the screen. No camera
// here: boxes in, directions out.
#pragma once

#include <optional>
#include <vector>

#include "surface/image/image.h"
#include "viewer/devices/one_euro.h"

namespace tangi {

// How far the picture of a usual webcam reaches from side to side.
inline constexpr double kCameraWidth_deg = 60;

// A face in a camera's picture: the middle of its box from the middle of the picture, to the right and down,
// and the width of the box [all in widths of the picture].
struct FaceBox {
    glm::dvec2 at{0};
    double width = 0;
};

// Where a place of the camera's picture lies, seen from the screen: a unit vector, x right, y up, z out of
// the screen.
Vec3 direction_in_room(const glm::dvec2& at, double camera_width_deg = kCameraWidth_deg);

// Of the faces that a detector found, the one to follow: near the one before, else the largest. Nothing where
// there is none.
std::optional<FaceBox> followed(const std::vector<FaceBox>& faces, const std::optional<FaceBox>& before);

// Follows a head over time.
class HeadFollower {
public:
    // The direction from the painting to the viewer, a unit vector. The first face, and the first after
    // recentre(), is straight on. Without a face it stays where it was.
    Vec3 see(const std::optional<FaceBox>& face, double time_s);
    Vec3 direction() const { return direction_; }
    void recentre();  // whoever looks now looks straight on

private:
    OneEuro smooth_{1.0, 8.0};
    std::optional<glm::dvec2> neutral_;
    Vec3 direction_{0, 0, 1};
};

}  // namespace tangi
