// light_priors.h: what the joint problem of pixels, lights and rig takes for likely before any photograph, as
// cost functions.
#pragma once

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "fit/calibration/light_residual.h"
#include "fit/pixel/ward_residual.h"

namespace tangi {

constexpr int kJointTrend = 6;  // of ln gains: 1, x, y, x^2, x y, y^2 of the direction

struct LobePrior {
    static constexpr WardPrior kPrior{};
    template <class T>
    bool operator()(const T* pixel, T* residual) const {
        residual[0] = (pixel[2] - kPrior.ln_alpha) / kPrior.ln_alpha_sigma;
        residual[1] = pixel[3] / kPrior.specular_sigma;
        return true;
    }
};

struct FlatnessPrior {
    static constexpr double kFlatness = 0.03;  // [1] slope; robust, so that relief does not count
    template <class T>
    bool operator()(const T* pixel, T* residual) const {
        residual[0] = pixel[0] / kFlatness;
        residual[1] = pixel[1] / kFlatness;
        return true;
    }
};

struct GainPrior {
    glm::dvec3 l;
    double weight;
    template <class T>
    bool operator()(const T* log_gain, const T* trend, T* residual) const {
        residual[0] = (log_gain[0] - trend[0] - trend[1] * l.x - trend[2] * l.y - trend[3] * l.x * l.x -
                       trend[4] * l.x * l.y - trend[5] * l.y * l.y) *
                      weight;
        return true;
    }
};

template <int size>
struct Weighted {  // residuals weight * parameter
    std::array<double, size> weight;
    template <class T>
    bool operator()(const T* parameter, T* residual) const {
        for (int i = 0; i < size; ++i) residual[i] = weight[static_cast<std::size_t>(i)] * parameter[i];
        return true;
    }
};

// Residuals weight * parameter, of a block of any size.
class PullToZero final : public ceres::CostFunction {
public:
    PullToZero(int size, double weight) : weight_(weight) {
        set_num_residuals(size);
        mutable_parameter_block_sizes()->push_back(size);
    }
    bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
        const int size = num_residuals();
        for (int i = 0; i < size; ++i) {
            residuals[i] = weight_ * parameters[0][i];
            if (jacobians && jacobians[0])
                for (int j = 0; j < size; ++j) jacobians[0][i * size + j] = i == j ? weight_ : 0;
        }
        return true;
    }

private:
    double weight_;
};

// A light's own turn: what the smooth field (its `modes` at the light, by their coefficients) leaves of it.
class TurnPrior final : public ceres::CostFunction {
public:
    TurnPrior(std::vector<glm::dvec2> modes, double weight) : modes_(std::move(modes)), weight_(weight) {
        set_num_residuals(kJointTurn);
        *mutable_parameter_block_sizes() = {kJointTurn, static_cast<int>(modes_.size())};
    }
    bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
        const std::size_t count = modes_.size();
        for (int i = 0; i < kJointTurn; ++i) {
            residuals[i] = weight_ * parameters[0][i];
            for (std::size_t k = 0; k < count; ++k) residuals[i] -= weight_ * modes_[k][i] * parameters[1][k];
            if (jacobians && jacobians[0])
                for (int j = 0; j < kJointTurn; ++j) jacobians[0][i * kJointTurn + j] = i == j ? weight_ : 0;
            if (jacobians && jacobians[1])
                for (std::size_t k = 0; k < count; ++k)
                    jacobians[1][static_cast<std::size_t>(i) * count + k] = -weight_ * modes_[k][i];
        }
        return true;
    }

private:
    std::vector<glm::dvec2> modes_;
    double weight_;
};

// Keeps at zero what all turns together have of the motions that photographs cannot tell: `untold` of each
// light (DirectionField::untold).
class MotionPrior final : public ceres::CostFunction {
public:
    explicit MotionPrior(std::vector<std::vector<glm::dvec2>> untold) : untold_(std::move(untold)) {
        set_num_residuals(static_cast<int>(untold_.front().size()));
        mutable_parameter_block_sizes()->assign(untold_.size(), kJointTurn);
    }
    bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
        const double weight = kExactly / static_cast<double>(untold_.size());
        std::fill(residuals, residuals + num_residuals(), 0);
        for (std::size_t light = 0; light < untold_.size(); ++light)
            for (std::size_t m = 0; m < untold_[light].size(); ++m)
                for (int i = 0; i < kJointTurn; ++i) {
                    const double by = weight * untold_[light][m][i];
                    residuals[m] += by * parameters[light][i];
                    if (jacobians && jacobians[light])
                        jacobians[light][m * kJointTurn + static_cast<std::size_t>(i)] = by;
                }
        return true;
    }

private:
    static constexpr double kExactly = 1e6;  // [1/rad]
    std::vector<std::vector<glm::dvec2>> untold_;
};

}  // namespace tangi
