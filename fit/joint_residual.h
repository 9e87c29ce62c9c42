// joint_residual.h: one grey sample of one photograph as a residual of pixel, lamp and rig, with analytic
// derivatives.
//
// Lengths are in picture widths, positions from the picture's centre. With d the lamp's given direction, x
// the pixel's position, the rig's bend b, the lamps' nearness m and the camera's nearness c:
//   e  = d turned by b x (first order), unit;   u = e - m (x, 0)          towards the lamp
//   l  = u / |u|;   v = unit of (-c x, 1)                                 towards the camera
//   model = exp(g) / |u|^2 (rho_d (max(n.l, 0) + k) + rho_s pi lobe(alpha) max(n.l, 0))
// with g the lamp's ln gain, k the ambient light and the bounded lobe of surface/ward.h. Residual
// (model - value) / sigma.
#pragma once

#include <ceres/sized_cost_function.h>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace tangi {

constexpr int kJointPixel = 5;  // slope x, slope y, ln alpha, rho_s, rho_d
constexpr int kJointRig = 4;    // lamp nearness, ambient, camera nearness, bend

class JointResidual final : public ceres::SizedCostFunction<1, kJointPixel, 1, kJointRig> {
public:
    JointResidual(const glm::dvec3& direction, const glm::dvec2& position, double value, double sigma)
        : direction_(direction), position_(position), value_(value), sigma_(sigma) {}

    // parameters: pixel, ln gain, rig.
    bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

private:
    glm::dvec3 direction_;
    glm::dvec2 position_;
    double value_, sigma_;
};

}  // namespace tangi
