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

}  // namespace

bool JointResidual::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
    const double *pixel = parameters[0], *rig = parameters[2];
    const double p = pixel[0], q = pixel[1], rho_s = pixel[3], rho_d = pixel[4];
    const double inverse_distance = rig[0] * s_.nearer, ambient = rig[1], camera = rig[2], bend = rig[3],
                 roughness = rig[4];
    const dvec3 x(s_.position, 0), from_axis(s_.position - s_.camera_axis, 0);

    const double* turn_by = parameters[3];
    const dvec3 off = s_.direction + turn_by[0] * frame_.a + turn_by[1] * frame_.b;
    const double off_length = glm::length(off);
    const dvec3 direction = off / off_length;

    // How the direction turns with the bend: towards the border by the part of it that is above the picture.
    const auto turning = [&](const dvec3& d) {
        return dvec3(s_.position * d.z, -glm::dot(s_.position, glm::dvec2(d)));
    };
    const dvec3 from_centre = direction - dvec3(0, 0, inverse_distance * rig[5]);
    const double centre_distance = glm::length(from_centre);
    const dvec3 straight = from_centre / centre_distance;
    const dvec3 turn = turning(straight);
    const dvec3 bent = straight + bend * turn;
    const double bent_length = glm::length(bent);
    const dvec3 e = bent / bent_length;
    const dvec3 u = centre_distance * e - inverse_distance * x;
    const double distance2 = glm::dot(u, u), distance = std::sqrt(distance2);
    const dvec3 l = u / distance;
    const dvec3 sight = dvec3(0, 0, 1) - camera * from_axis;
    const double sight_length = glm::length(sight);
    const dvec3 v = sight / sight_length;

    const double n_z = 1 / std::sqrt(1 + p * p + q * q);
    const dvec3 n = n_z * dvec3(-p, -q, 1);
    const Reflected r = reflected(n, l, v, pixel[2], roughness);
    const std::array<double, kJointBeam> terms = beam_terms(s_.position);
    double log_irradiance = parameters[1][0];
    for (std::size_t k = 0; k < terms.size(); ++k) log_irradiance += parameters[4][k] * terms[k];
    const double irradiance = std::exp(log_irradiance) / distance2;
    const double shown = rho_d * (r.matt.value + ambient) + rho_s * r.lobe * r.n_l;
    residual[0] = (irradiance * shown - s_.value) / s_.sigma;
    if (!jacobians) return true;

    const double scale = irradiance / s_.sigma;
    const bool lit = r.n_l > 0;
    // d shown by n.l and n.v, with h.n = n.l + n.v, and by l.v, with h.h = 2 + 2 l.v.
    const double by_n_l = lit ? rho_d * r.matt.by_n_l + rho_s * (r.lobe + r.n_l * r.lobe_h_n) : 0;
    const double by_n_v = rho_d * r.matt.by_n_v + rho_s * r.n_l * r.lobe_h_n;
    const double by_l_v = rho_d * r.matt.by_l_v + 2 * rho_s * r.n_l * r.lobe_h_h;
    if (double* by = jacobians[0]) {
        const double n_l = glm::dot(n, l), n_v = glm::dot(n, v);
        const double slope[2] = {p, q};
        for (int k = 0; k < 2; ++k) {
            const double dn_l = -n_z * (l[k] + slope[k] * n_z * n_l);
            const double dn_v = -n_z * (v[k] + slope[k] * n_z * n_v);
            by[k] = scale * (by_n_l * dn_l + by_n_v * dn_v);
        }
        by[2] = scale * rho_s * r.n_l * r.lobe_ln_alpha;
        by[3] = scale * r.lobe * r.n_l;
        by[4] = scale * (r.matt.value + ambient);
    }
    if (jacobians[1]) jacobians[1][0] = scale * shown;
    if (double* by = jacobians[4])
        for (std::size_t k = 0; k < terms.size(); ++k) by[k] = scale * shown * terms[k];
    const auto along = [&](const dvec3& du) {  // u moves
        const dvec3 dl = across(l, du) / distance;
        return scale * (by_n_l * glm::dot(n, dl) + by_l_v * glm::dot(v, dl) -
                        2 * shown * glm::dot(u, du) / distance2);
    };
    const auto of_centre = [&](const dvec3& moved) {  // u, as from_centre moves
        const dvec3 turned = across(straight, moved);
        return glm::dot(straight, moved) * e + across(e, turned + bend * turning(turned)) / bent_length;
    };
    if (double* by = jacobians[3])
        for (int k = 0; k < kJointTurn; ++k)
            by[k] = along(of_centre(across(direction, k == 0 ? frame_.a : frame_.b) / off_length));
    if (double* by = jacobians[2]) {
        const dvec3 dv = across(v, -from_axis) / sight_length;
        by[0] = along(of_centre(dvec3(0, 0, -s_.nearer * rig[5])) - s_.nearer * x);
        by[1] = scale * rho_d;
        by[2] = scale * (by_n_v * glm::dot(n, dv) + by_l_v * glm::dot(l, dv));
        by[3] = along(centre_distance * across(e, turn) / bent_length);
        by[4] = scale * rho_d * r.matt.by_sigma;
        by[5] = along(of_centre(dvec3(0, 0, -inverse_distance)));
    }
    return true;
}

}  // namespace tangi
