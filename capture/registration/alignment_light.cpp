// alignment_light.cpp: which light a picture shows, whatever is listed for it.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "capture/registration/alignment.h"
#include "surface/base/median.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

constexpr int kLightSweeps = 6;
constexpr double kLightCauchy = 2;   // [scales]
constexpr double kLowestShown = 4;   // [1] l.xy / l.z at most: 14 degrees high
constexpr double kLeastUpright = 0;  // [1] of what is even in a picture: its sign is known

// One pixel's terms and what a picture has there.
struct LitSample {
    Eigen::Vector3d terms;
    double value, weight;
};

// value ~ terms . (a, u, v), robustly.
Eigen::Vector3d robust_light(std::vector<LitSample>& samples) {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    double scale = 0;
    for (int sweep = 0; sweep < kLightSweeps; ++sweep) {
        Eigen::Matrix3d normal = 1e-12 * Eigen::Matrix3d::Identity();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (const LitSample& s : samples) {
            const double t = sweep == 0 ? 0 : (s.value - s.terms.dot(light)) / (kLightCauchy * scale);
            const double weight = s.weight / (1 + t * t);
            normal += weight * s.terms * s.terms.transpose();
            right += weight * s.value * s.terms;
        }
        light = solve_symmetric(normal, right).x;
        std::vector<double> deviations;
        for (const LitSample& s : samples) deviations.push_back(std::abs(s.value - s.terms.dot(light)));
        scale = std::max(1.4826 * median(std::move(deviations)), 1e-6);
    }
    return light;
}

double correlation_under(const std::vector<LitSample>& samples, const Eigen::Vector3d& light) {
    double product = 0, squares = 0, predicted = 0;
    for (const LitSample& s : samples) {
        const double prediction = s.terms.dot(light);
        product += s.weight * s.value * prediction;
        squares += s.weight * s.value * s.value;
        predicted += s.weight * prediction * prediction;
    }
    return product / std::sqrt(std::max(squares * predicted, 1e-30));
}

}  // namespace

std::vector<std::optional<Alignment::ShownLight>> Alignment::per_photo_lights(
    const std::vector<std::size_t>& of) {
    std::vector<std::optional<ShownLight>> shown(of.size());
    const std::vector<bool> before = in_model_;
    for (const std::size_t i : of) in_model_[i] = false;
    if (terms_ == 3 && std::count(in_model_.begin(), in_model_.end(), true) >= kEnoughForRelief) {
        sample();
        predict();
        for (std::size_t at = 0; at < of.size(); ++at) {
            std::vector<LitSample> samples;
            for (std::size_t k = 0; k < pixels_.size(); ++k) {
                const Sample& s = samples_[k * pictures.size() + of[at]];
                const Pixel& pixel = pixels_[k];
                if (std::isnan(s.residual)) continue;
                samples.push_back({{pixel.terms[0], pixel.terms[1], pixel.terms[2]},
                                   s.value,
                                   1.0 / (pixel.scale * pixel.scale)});
            }
            if (samples.size() < 100) continue;
            // What is even in all pictures is in this one: local contrast knows no strength.
            const Eigen::Vector3d found = robust_light(samples);
            if (!(found[0] > kLeastUpright)) continue;
            glm::dvec2 slope(found[1] / found[0], found[2] / found[0]);
            if (const double steep = glm::length(slope); steep > kLowestShown) slope *= kLowestShown / steep;
            shown[at] = {glm::normalize(glm::dvec3(slope, 1)),
                         correlation_under(samples, {1, slope.x, slope.y})};
        }
    }
    in_model_ = before;
    return shown;
}

void Alignment::set_light(std::size_t picture, const glm::dvec3& light) {
    terms_of_[picture] = terms_under(light);
}

}  // namespace tangi
