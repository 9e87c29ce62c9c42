// mirror_sphere.h: mirror balls in a stack of photographs: where they are, and where they show the lamp.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/registration/edge_field.h"
#include "capture/spheres/ball_highlight.h"
#include "capture/spheres/ball_outline.h"
#include "surface/base/error.h"

namespace tangi {

// Where the user says that a ball is: a circle, or a box around it. Pixels, y down.
struct GivenBall {
    glm::dvec2 centre_px{0, 0};
    double radius_px = 0;  // of a box, half its shorter side
    bool is_box = false;   // the ball lies in the box, and may be smaller
    std::string text;      // as the user wrote it, for messages
};

struct FoundBall {
    BallImage image;
    BallImage circle{};                 // from which its outline was sought
    std::optional<BallImage> before{};  // the circle that the user gave, with its standard errors
    std::string name;                   // "ball 1 at (629, 64)", for messages
    bool given = false;
    double outline_coverage = 0;  // [1] part of the outline that was measured; 0: taken as given
    double outline_residual_px = 0;
    std::optional<Known> elongation{};    // BallOutline's
    std::vector<Highlight> highlights{};  // one a photograph; empty for matt balls
    BallCrops crops;

    int highlights_found() const;
    int highlights_in(HighlightState state) const;
};

// No ball was found where none was said to be.
class NoBallError : public Error {
public:
    using Error::Error;
};

struct BallSearch {
    std::vector<FoundBall> balls;  // from top to bottom
    std::vector<std::string> warnings, poor;
};

// Finds mirror balls: a small bright spot that wanders about as the light moves, one a photograph, within a
// circle of edges that stay, as lamps before the painting make it wander and as the shading of all else says
// that they stood. What shows highlights but not so is left out with a warning; so is a second ball that
// shows few, unless it has the first one's size and shows the same lamps. Balls given by the user are sought
// only where they are given; one that is not there is left out with a warning, and Error says so where no
// ball is left. Without given balls, no ball at all is an Error too.
BallSearch find_mirror_balls(const PhotoSet& set, const GreyPhotos& photos, const CameraShakes& drifts,
                             const BallCamera& camera, std::span<const GivenBall> given,
                             const std::optional<double>& expected_px = {}, const Progress& progress = {});

// Outline and highlights once more, for a camera that is known by now.
void measure_again(FoundBall& ball, const BallCamera& camera);

// Seeks the outline from ball.circle; where a circle was given, it is weighed with what is found
// (given_outline.h). False where none was given and none is found: the ball is left as it is. What the user
// is to know of a given circle is added to `warnings`.
bool find_outline(FoundBall& ball, const BallCamera& camera, const std::string& given_text,
                  std::vector<std::string>& warnings);

// The circle near a given ball or box that has edges along it, in the pixels of the whole photographs;
// nothing where none has. Where a circle of quite another size around the same place has far clearer edges,
// that one, and `contradiction` says so to the user.
std::optional<Circle> circle_near(const EdgeField& field, const GreyPhotos& photos, const GivenBall& given,
                                  std::string& contradiction);

// What a given circle or box says of the ball before its outline is looked at, with standard errors; nothing
// where a circle that shows says otherwise, or says more than a box does.
std::optional<BallImage> before_of(const GivenBall& given, bool circle_seen,
                                   const std::string& contradiction);

// Throws Error where a given ball does not lie in the photographs.
void require_in_picture(const GivenBall& given, int width, int height);

}  // namespace tangi
