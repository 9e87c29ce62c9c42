// light_bundle_adjustment.h: the bundle adjustment of light calibration: grey pixels, gains, beams,
// directions and rig at once.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "fit/calibration/light_direction_field.h"

namespace tangi {

// Where the parameters start: at values that may be far off (a light three times as strong), near the
// minimum, or at it: then what lies far off, as shadows do, does not count at all any more.
enum class JointStart { far, near, there };

// How the lights' directions may differ from those listed.
enum class DirectionFreedom {
    listed,  // not at all
    smooth,  // they turn by a smooth field of few numbers over direction
    own,     // and each light by a few degrees of its own
    // As own, but by as much as the directions' standard errors say; and the diffuse roughness with it, which
    // photographs tell only together with the directions.
    measured,
};

// [1/width] Of RigParameters::bend, either way.
constexpr double kMostBend = 0.5;

// What the problem may move.
struct JointFreedom {
    bool rig = true;    // else it stays as it is given
    bool gains = true;  // else they do
    DirectionFreedom directions = DirectionFreedom::listed;
    bool beams = false;  // else they are even, or as given
    // Else the pixels stay too, and each light stands alone: its own turn is only kept small.
    bool pixels = true;
};

// Lengths are in picture widths (the longer side), positions from the centre, y up.
struct LightBundleAdjustment {
    struct Pixel {
        glm::dvec2 position{0};
        int sample = 0;  // the caller's name for it
        glm::dvec2 slope{0};
        double ln_alpha = -1.6, specular = 0, diffuse = 0;  // start, and result
    };
    struct Observation {
        int pixel, photo;
        double value;  // [1] linear, relative to the white level
        double sigma;  // [1] > 0
    };
    struct RigParameters {
        double light_inverse_distance = 0;   // [1/width] of the lights' distance; 0 = far away
        double ambient = 0;                  // [1] as Rig::ambient
        double camera_inverse_distance = 0;  // [1/width]
        double bend = 0;                     // [1/width] as Rig::bend_per_mm
        double roughness = 0;                // [1] as ReflectanceModel::diffuse_roughness
        double height = 0;                   // [width] as Rig::surface_above_mm
    };

    std::vector<glm::dvec3> directions;  // [unit vectors] of the lights, one a photograph
    std::vector<Pixel> pixels;
    std::vector<Observation> observations;

    std::vector<double>
        nearer;  // [1] of each light: how many times nearer than rig.light_inverse_distance says
    bool lights_known = false;  // their nearness is as given, and nothing bends
    bool camera_known = false;  // its nearness is as given
    // The object is flat as a whole: slopes are around 0. Else nothing is said of them, and what bends the
    // rig must be shown.
    bool flat = true;
    glm::dvec2 camera_axis{0};  // above which the camera is

    // [rad] Standard error of each direction as listed, of either component; 0: it stays. Of use where
    // directions are measured.
    std::vector<double> direction_sigma;

    double robust_scale = 2;  // [sigma] of the observations' loss: where not started far; and result

    std::vector<double> log_gains;  // one a photograph: start, and result
    double gain_scatter = 0;        // [1] of log_gains about their smooth trend: what is expected, and result
    std::vector<glm::dvec2>
        turns;  // of the directions (light_direction_field.h): start, and result; one a photograph
    std::vector<std::array<double, 5>> beams;  // by beam_terms() of light_residual.h: start, and result
    RigParameters rig;                         // start, and result

    double cost = 0;  // result: half the sum of squares, as the robust loss counts them, priors included

    // [1] How uneven a light's beam is: rms of ln irradiance over the pixels.
    double unevenness(std::size_t light) const;

    // Minimises. False where the start cannot be evaluated.
    bool solve(const JointFreedom& freedom, JointStart start);

    // Standard errors (68 %) of what a solved problem moved; empty what it did not, and all where the
    // photographs leave something open.
    struct Errors {
        std::vector<double> log_gains;       // [1] of each, less the mean of all
        std::vector<double> direction_deg;   // of each, across it, in rms of its two components
        std::vector<double> beams;           // [1] of ln irradiance, of each light: rms over the picture
        std::optional<RigParameters> rig{};  // 0: stays as given
    };
    Errors errors(const JointFreedom& freedom) const;
};

}  // namespace tangi
