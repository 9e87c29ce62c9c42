// gaussian_process.h: a smooth function of the direction, from values that are known in some directions
// (Gaussian process regression: Rasmussen and Williams 2006, "Gaussian Processes for Machine Learning",
// chapters 2 and 5).
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace tangi {

// f(d) = mean + sum over parts and known directions k of weights[k] * C(|d - d_k| / reach), where C is the
// Matérn covariance of order 5/2, (1 + s + s^2/3) exp(-s) with s = sqrt(5) r.
struct GaussianProcess {
    struct Part {
        double reach = 1;             // [1] distance of unit vectors over which the function is alike
        std::vector<double> weights;  // [unit of the values] one a known direction

        friend bool operator==(const Part&, const Part&) = default;
    };
    double mean = 0;  // [unit of the values]
    std::vector<Part> parts;

    friend bool operator==(const GaussianProcess&, const GaussianProcess&) = default;
};

// `directions`: unit vectors, one a value. The mean is free; reach, and the noise of the values beside how
// much the function varies, are not chosen but averaged over, each by its restricted likelihood (chapter 5.4;
// Patterson and Thompson 1971), so that a few values that look smooth by chance are not followed. Noise has
// Student's distribution with 4 degrees of freedom (Lange, Little and Taylor 1989): values that are far off
// bend nothing. Where all values are equal, the function is. No values: 0 everywhere. O(n^3); of
// more than 100 values, some tell which reach and noise are likely.
GaussianProcess fit_gaussian_process(std::span<const glm::dvec3> directions, std::span<const double> values);

// `directions` as given to fit_gaussian_process().
double predicted(const GaussianProcess& process, std::span<const glm::dvec3> directions,
                 const glm::dvec3& direction);

}  // namespace tangi
