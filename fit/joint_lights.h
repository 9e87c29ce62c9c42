// joint_lights.h: the bundle adjustment of light calibration: grey pixels, gains and rig at once, with Ceres.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace tangi {

// Where the parameters start: at values that may be far off (a lamp three times as strong), or near the
// minimum.
enum class JointStart { far, near };

// Lengths are in picture widths (the longer side), positions from the centre, y up.
struct JointLights {
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
        double lamp_nearness = 0;    // [1/width] of the lamps' distance; 0 = far away
        double ambient = 0;          // [1] as Rig::ambient
        double camera_nearness = 0;  // [1/width]
        double bend = 0;             // [1/width] as Rig::bend_per_mm
    };

    std::vector<glm::dvec3> directions;  // [unit vectors] of the lamps, one a photograph
    std::vector<Pixel> pixels;
    std::vector<Observation> observations;

    std::vector<double> nearer;  // [1] of each lamp: how many times nearer than rig.lamp_nearness says
    bool lamps_known = false;    // their nearness is as given, and nothing bends
    bool camera_known = false;   // its nearness is as given
    glm::dvec2 camera_axis{0};   // above which the camera is

    std::vector<double> log_gains;  // one a photograph: start, and result
    RigParameters rig;              // start, and result

    // Minimises over pixels and rig, and over the gains where `free_gains`. False where Ceres fails.
    bool solve(bool free_gains, JointStart start);
};

}  // namespace tangi
