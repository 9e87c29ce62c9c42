// motion.h: small motions of a picture's plane in eight parameters, nested from a shift to a homography, and
// their estimation from displacement equations that are grouped in cells.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <vector>

#include "surface/image/homography.h"

namespace tangi {

constexpr int kMotion = 8;
using MotionVector = std::array<double, kMotion>;
using MotionMatrix = std::array<MotionVector, kMotion>;

// Each contains the one before: its value is the number of parameters it has.
enum class MotionModel { none = 0, translation = 2, similarity = 4, homography = 8 };
const char* name_of(MotionModel model);

// Normalised coordinates: (pixel - centre) / radius; the corners of the picture lie on the unit circle.
struct MotionFrame {
    glm::dvec2 centre{0};
    double radius = 1;  // [pixels] half the diagonal

    MotionFrame() = default;
    MotionFrame(double width, double height);  // of pictures whose pixel centres run from 0 to width - 1
    glm::dvec2 normalised(const glm::dvec2& p) const { return (p - centre) / radius; }
};

// [1] What one pixel of each parameter moves a point (x, y in normalised coordinates) by, to first order:
// shift, scale, rotation, the two shears and the two vanishing directions.
inline std::array<glm::dvec2, kMotion> motion_basis(const glm::dvec2& n) {
    return {{{1, 0}, {0, 1}, {n.x, n.y}, {-n.y, n.x}, {n.x, -n.y}, {n.y, n.x}, n * n.x, n * n.y}};
}

// Pixel of a picture that was reduced by `factor` -> pixel of the whole one.
inline Homography enlarging(double factor) {
    const double offset = (factor - 1) / 2;
    return {factor, 0, 0, 0, factor, 0, offset, offset, 1};
}

// The map that moves points by `motion` [pixels], to first order; exactly a homography.
Homography homography_of(const MotionVector& motion, const MotionFrame& frame);

// The motion [pixels], to first order, that a homography near the identity means.
MotionVector motion_of(const Homography& h, const MotionFrame& frame);

// [pixels] Root mean square over the picture (a disc of the frame's radius over sqrt 2) of the displacement,
// and of its standard error where `covariance` is that of the motion's parameters.
double rms_displacement(const MotionVector& motion);
double rms_displacement(const MotionMatrix& covariance);

// Normal equations of displacement, summed over one cell of the picture: residual + row . motion = 0.
template <std::size_t N>
struct DisplacementCell {
    std::array<double, N*(N + 1) / 2> normal{};
    std::array<double, N> right{};
    double count = 0;

    // Of the first `parameters`, the others being 0.
    void add(const std::array<double, N>& row, double residual, double weight, std::size_t parameters = N) {
        std::size_t at = 0;
        for (std::size_t i = 0; i < parameters; ++i) {
            for (std::size_t j = 0; j <= i; ++j) normal[at++] += weight * row[i] * row[j];
            right[i] -= weight * row[i] * residual;
        }
        count += 1;
    }
    DisplacementCell& operator+=(const DisplacementCell& other) {
        for (std::size_t i = 0; i < normal.size(); ++i) normal[i] += other.normal[i];
        for (std::size_t i = 0; i < N; ++i) right[i] += other.right[i];
        count += other.count;
        return *this;
    }
};
using MotionCell = DisplacementCell<kMotion>;

struct MotionEstimate {
    MotionVector motion{};      // [pixels]; 0 beyond the model's parameters
    MotionMatrix covariance{};  // [pixels^2]
    MotionModel model = MotionModel::none;
    int cells = 0;  // that said anything
};

// Least squares; its covariance is that of cells that are independent of each other, whatever the errors
// inside a cell have in common (the cluster-robust sandwich of Liang & Zeger 1986, White 1980).
MotionEstimate solve_motion(const std::vector<MotionCell>& cells, MotionModel model);

// A motion that is linear in the slope (u, v) of a light: of each parameter of a motion, in their order, what
// it has for u = 1, then for v = 1.
constexpr std::size_t kTied = 2 * kMotion;
using TiedCell = DisplacementCell<kTied>;
struct TiedMotion {
    std::array<double, kTied> motion{};                         // [pixels]; 0 beyond the model's parameters
    std::array<std::array<double, kTied>, kTied> covariance{};  // [pixels^2]
};
// As solve_motion(); zero where that gives up.
TiedMotion solve_tied(const std::vector<TiedCell>& cells, MotionModel model);

// The largest model at most `largest` whose parameters beyond the next smaller one are told from 0 by Wald's
// test at a level of 0.001, and move the picture by more than `least_px`. `motion_so_far` is what the cells'
// residuals are already free of.
MotionModel supported_model(const std::vector<MotionCell>& cells, const MotionVector& motion_so_far,
                            MotionModel largest, double least_px);

}  // namespace tangi
