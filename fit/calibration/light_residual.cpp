#include "fit/calibration/light_residual.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/reflectance/oren_nayar.h"

namespace tangi {

using glm::dvec3;

namespace {

// What a sample shows of the light that a unit light sends to its pixel, and its derivatives.
struct Reflected {
    double n_l = 0, n_v = 0, lobe = 0;                     // lobe is pi times surface/reflectance/ward.h's
    double lobe_h_n = 0, lobe_h_h = 0, lobe_ln_alpha = 0;  // d lobe by h.n, h.h, ln alpha
    DiffuseTerms<double> matt{};                           // D
};

Reflected reflected(const dvec3& n, const dvec3& l, const dvec3& v, double ln_alpha, double roughness) {
    Reflected r;
    r.n_l = std::max(glm::dot(n, l), 0.0);
    r.n_v = glm::dot(n, v);
    if (r.n_l <= 0 || r.n_v <= 0) return r;
    const double l_v = glm::dot(l, v), h_n = r.n_l + r.n_v, h_h = 2 + 2 * l_v;
    r.matt = rough_diffuse(r.n_l, r.n_v, l_v, roughness);
    const double inverse_alpha2 = std::exp(-2 * ln_alpha), inverse_h_n2 = 1 / (h_n * h_n);
    const double tan2 = std::max(h_h * inverse_h_n2 - 1, 0.0);
    r.lobe = std::exp(-tan2 * inverse_alpha2) * inverse_alpha2 * h_h * inverse_h_n2 * inverse_h_n2;
    r.lobe_h_n = r.lobe * (2 * h_h * inverse_h_n2 * inverse_alpha2 - 4) / h_n;
    r.lobe_h_h = r.lobe * (1 / h_h - inverse_h_n2 * inverse_alpha2);
    r.lobe_ln_alpha = r.lobe * (2 * tan2 * inverse_alpha2 - 2);
    return r;
}

// The derivative of a / |a| along da, times |a|.
dvec3 across(const dvec3& unit, const dvec3& da) { return da - unit * glm::dot(unit, da); }

// Where light and camera are as the pixel sees them: the header's formulas, with what their derivatives take.
struct JointGeometry {
    glm::dvec2 position;
    dvec3 x, from_axis;  // of the pixel, from the picture's centre and from the camera's axis
    double inverse_distance, bend;
    double off_length;  // of d', before it was made unit
    dvec3 direction;
    double centre_distance;
    dvec3 straight, turn;  // unit of q; how it turns with the bend
    double bent_length;
    dvec3 e;  // unit
    dvec3 u;
    double distance2, distance;
    dvec3 l;
    double sight_length;
    dvec3 v;

    JointGeometry(const JointSample& s, const TangentFrame& frame, const double* rig, const double* turn_by)
        : position(s.position),
          x(s.position, 0),
          from_axis(s.position - s.camera_axis, 0),
          inverse_distance(rig[0] * s.nearer),
          bend(rig[3]) {
        const dvec3 off = s.direction + turn_by[0] * frame.a + turn_by[1] * frame.b;
        off_length = glm::length(off);
        direction = off / off_length;
        const dvec3 from_centre = direction - dvec3(0, 0, inverse_distance * rig[5]);
        centre_distance = glm::length(from_centre);
        straight = from_centre / centre_distance;
        turn = turning(straight);
        const dvec3 bent = straight + bend * turn;
        bent_length = glm::length(bent);
        e = bent / bent_length;
        u = centre_distance * e - inverse_distance * x;
        distance2 = glm::dot(u, u), distance = std::sqrt(distance2);
        l = u / distance;
        const dvec3 sight = dvec3(0, 0, 1) - rig[2] * from_axis;
        sight_length = glm::length(sight);
        v = sight / sight_length;
    }
    // How a direction turns with the bend: towards the border by the part of it that is above the picture.
    dvec3 turning(const dvec3& d) const { return dvec3(position * d.z, -glm::dot(position, glm::dvec2(d))); }
    // Of u, as q before the bend moves.
    dvec3 of_centre(const dvec3& moved) const {
        const dvec3 turned = across(straight, moved);
        return glm::dot(straight, moved) * e + across(e, turned + bend * turning(turned)) / bent_length;
    }
};

// What the pixel shows of unit light, and its derivatives by the residual's parameters.
struct JointShading {
    const JointGeometry& g;
    const double *pixel, *rig;
    double n_z;
    dvec3 n;
    Reflected r;
    double shown;
    double by_n_l = 0, by_n_v = 0, by_l_v = 0;  // of `shown`

    JointShading(const JointGeometry& geometry, const double* pixel_, const double* rig_)
        : g(geometry), pixel(pixel_), rig(rig_) {
        const double p = pixel[0], q = pixel[1];
        n_z = 1 / std::sqrt(1 + p * p + q * q);
        n = n_z * dvec3(-p, -q, 1);
        r = reflected(n, g.l, g.v, pixel[2], rig[4]);
        shown = rho_d() * (r.matt.value + rig[1]) + rho_s() * r.lobe * r.n_l;
    }
    double rho_s() const { return pixel[3]; }
    double rho_d() const { return pixel[4]; }

    // By n.l and n.v, with h.n = n.l + n.v, and by l.v, with h.h = 2 + 2 l.v.
    void find_derivatives() {
        by_n_l = r.n_l > 0 ? rho_d() * r.matt.by_n_l + rho_s() * (r.lobe + r.n_l * r.lobe_h_n) : 0;
        by_n_v = rho_d() * r.matt.by_n_v + rho_s() * r.n_l * r.lobe_h_n;
        by_l_v = rho_d() * r.matt.by_l_v + 2 * rho_s() * r.n_l * r.lobe_h_h;
    }
    void by_pixel(double scale, double* by) const {
        const double n_l = glm::dot(n, g.l), n_v = glm::dot(n, g.v);
        for (int k = 0; k < 2; ++k) {
            const double dn_l = -n_z * (g.l[k] + pixel[k] * n_z * n_l);
            const double dn_v = -n_z * (g.v[k] + pixel[k] * n_z * n_v);
            by[k] = scale * (by_n_l * dn_l + by_n_v * dn_v);
        }
        by[2] = scale * rho_s() * r.n_l * r.lobe_ln_alpha;
        by[3] = scale * r.lobe * r.n_l;
        by[4] = scale * (r.matt.value + rig[1]);
    }
    // As u moves: irradiance falls with its square, and l turns.
    double along(double scale, const dvec3& du) const {
        const dvec3 dl = across(g.l, du) / g.distance;
        return scale * (by_n_l * glm::dot(n, dl) + by_l_v * glm::dot(g.v, dl) -
                        2 * shown * glm::dot(g.u, du) / g.distance2);
    }
    void by_turn(double scale, const TangentFrame& frame, double* by) const {
        for (int k = 0; k < kJointTurn; ++k)
            by[k] = along(scale, g.of_centre(across(g.direction, k == 0 ? frame.a : frame.b) / g.off_length));
    }
    void by_rig(double scale, double nearer, double* by) const {
        const dvec3 dv = across(g.v, -g.from_axis) / g.sight_length;
        by[0] = along(scale, g.of_centre(dvec3(0, 0, -nearer * rig[5])) - nearer * g.x);
        by[1] = scale * rho_d();
        by[2] = scale * (by_n_v * glm::dot(n, dv) + by_l_v * glm::dot(g.l, dv));
        by[3] = along(scale, g.centre_distance * across(g.e, g.turn) / g.bent_length);
        by[4] = scale * rho_d() * r.matt.by_sigma;
        by[5] = along(scale, g.of_centre(dvec3(0, 0, -g.inverse_distance)));
    }
};

}  // namespace

bool JointResidual::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
    const double* rig = parameters[2];
    const JointGeometry geometry(s_, frame_, rig, parameters[3]);
    JointShading shading(geometry, parameters[0], rig);
    const std::array<double, kJointBeam> terms = beam_terms(s_.position);
    double log_irradiance = parameters[1][0];
    for (std::size_t k = 0; k < terms.size(); ++k) log_irradiance += parameters[4][k] * terms[k];
    const double irradiance = std::exp(log_irradiance) / geometry.distance2;
    residual[0] = (irradiance * shading.shown - s_.value) / s_.sigma;
    if (!jacobians) return true;

    const double scale = irradiance / s_.sigma;
    shading.find_derivatives();
    if (jacobians[0]) shading.by_pixel(scale, jacobians[0]);
    if (jacobians[1]) jacobians[1][0] = scale * shading.shown;
    if (jacobians[2]) shading.by_rig(scale, s_.nearer, jacobians[2]);
    if (jacobians[3]) shading.by_turn(scale, frame_, jacobians[3]);
    if (double* by = jacobians[4])
        for (std::size_t k = 0; k < terms.size(); ++k) by[k] = scale * shading.shown * terms[k];
    return true;
}

}  // namespace tangi
