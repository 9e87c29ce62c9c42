// light_residual.h: one grey sample of one photograph as a residual of pixel, light and rig, with analytic
// derivatives.
//
// Lengths are in picture widths, positions from the picture's centre. With d the light's given direction, s
// how much nearer it is than the others, t its turn (light_direction_field.h), x the pixel's position, a that
// of the camera, the rig's bend b, the lights' nearness m, the camera's nearness c and the height h of the
// surface:
//   d' = d + t.x a + t.y b, unit
//   q  = d' - m s (0, 0, h)                                               from the centre of the surface
//   e  = q turned by b x (first order), as long;   u = e - m s (x, 0)     towards the light
//   l  = u / |u|;   v = unit of (c (a - x), 1)                            towards the camera
//   model = exp(g + f(x)) / |u|^2 (rho_d (D + k) + rho_s pi lobe(alpha) max(n.l, 0))
// with g the light's ln gain, f its beam (beam_terms()), k the ambient light, the bounded lobe of
// surface/reflectance/ward.h and D the diffuse reflection of surface/reflectance/oren_nayar.h: max(n.l, 0)
// where the diffuse roughness is 0. Residual (model - value) / sigma.
#pragma once

#include <ceres/sized_cost_function.h>

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "fit/calibration/light_direction_field.h"

namespace tangi {

constexpr int kJointPixel = 5;  // slope x, slope y, ln alpha, rho_s, rho_d
constexpr int kJointRig = 6;    // light nearness, ambient, camera nearness, bend, diffuse roughness, height
constexpr int kJointTurn = 2;   // x and y of the turn of the light's direction
constexpr int kJointBeam = 5;   // of its beam

// Of surface/maps/light.h's Beam, in half widths: what the five parameters are multiplied by, so that each is
// what it adds to ln irradiance at the border.
inline std::array<double, kJointBeam> beam_terms(const glm::dvec2& position) {
    const double x = 2 * position.x, y = 2 * position.y;
    return {x, y, x * x, x * y, y * y};
}

struct JointSample {
    glm::dvec3 direction{0, 0, 1};  // d
    double nearer = 1;              // s
    glm::dvec2 position{0};         // x
    glm::dvec2 camera_axis{0};      // a
    double value = 0;               // [1] linear, of a light of gain 1 and white level 1
    double sigma = 1;               // [1] > 0
};

class JointResidual final
    : public ceres::SizedCostFunction<1, kJointPixel, 1, kJointRig, kJointTurn, kJointBeam> {
public:
    explicit JointResidual(const JointSample& sample) : s_(sample), frame_(tangent_frame(sample.direction)) {}

    // parameters: pixel, ln gain, rig, turn, beam.
    bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

private:
    JointSample s_;
    TangentFrame frame_;
};

}  // namespace tangi
