// light_sufficiency.cpp: whether photometric stereo has a unique answer.
#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "capture/stack/stack.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

// Smallest eigenvalue of a symmetric matrix (Smith 1961, "Eigenvalues of a symmetric 3 x 3 matrix").
double smallest_eigenvalue(const glm::dmat3& a) {
    const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3;
    const glm::dmat3 rest = a - mean * glm::dmat3(1);
    double squares = 0;
    for (int i = 0; i < 3; ++i) squares += glm::dot(rest[i], rest[i]);
    const double spread = std::sqrt(squares / 6);
    if (!(spread > 0)) return mean;
    const double r = std::clamp(glm::determinant((1 / spread) * rest) / 2, -1.0, 1.0);
    return mean + 2 * spread * std::cos((std::acos(r) + 2 * std::numbers::pi) / 3);
}

}  // namespace

void require_enough_lights(const std::vector<Light>& lights, const std::string& what) {
    if (lights.size() < 4)
        fail("{}: {} usable photographs; at least 4 under different lights are needed", what, lights.size());
    // The smallest eigenvalue of the scatter of directions is 0 where all lie in one plane with the painting:
    // then one component of the normals stays unknown.
    glm::dmat3 scatter(0);
    for (const Light& light : lights)
        scatter += glm::outerProduct(glm::dvec3(light.direction), glm::dvec3(light.direction));
    const double smallest = smallest_eigenvalue(scatter / static_cast<double>(lights.size()));
    if (smallest < 2e-4)
        fail(
            "{}: all lights lie in one plane (within {:.1f} degrees), which leaves the relief across it "
            "unknown; add "
            "photographs lit from other sides",
            what, std::sqrt(std::max(smallest, 0.0)) * 180 / std::numbers::pi);
}

}  // namespace tangi
