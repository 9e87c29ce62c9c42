#include "fit/calibration/light_direction_field.h"

#include <Eigen/Core>
#include <glm/geometric.hpp>

#include "surface/base/symmetric_matrix.h"

namespace tangi {

using Eigen::Index;
using Eigen::MatrixXd;
using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kNegligible = 1e-3;  // of the strongest mode's square

// Polynomial i moves x where i is even, y where it is odd.
dvec2 polynomial(std::size_t i, const dvec3& d) {
    const double phi[] = {1, d.x, d.y, d.x * d.x, d.x * d.y, d.y * d.y};
    return i % 2 == 0 ? dvec2(phi[i / 2], 0) : dvec2(0, phi[i / 2]);
}

}  // namespace

std::vector<dvec2> DirectionField::untold(const dvec3& d) const {
    const TangentFrame frame = tangent_frame(d);
    std::vector<dvec3> motions = {{0, -d.z, d.y}, {d.z, 0, -d.x}, {-d.y, d.x, 0}};
    if (!strengths_known_)
        motions.insert(motions.end(),
                       {{0, d.z, d.y}, {d.z, 0, d.x}, {d.y, d.x, 0}, {d.x, -d.y, 0}, {d.x, d.y, -2 * d.z}});
    std::vector<dvec2> turns;
    for (const dvec3& motion : motions)
        turns.emplace_back(glm::dot(motion, frame.a), glm::dot(motion, frame.b));
    return turns;
}

DirectionField::DirectionField(const std::vector<dvec3>& lights, bool strengths_known)
    : strengths_known_(strengths_known) {
    const auto count = static_cast<Index>(lights.size());
    constexpr auto polynomials = static_cast<Index>(kPolynomials);
    const auto motions = static_cast<Index>(untold({0, 0, 1}).size());
    MatrixXd field(2 * count, polynomials), motion(2 * count, motions);
    const auto fill = [](MatrixXd& to, Index light, Index column, const dvec2& t) {
        to(2 * light, column) = t.x;
        to(2 * light + 1, column) = t.y;
    };
    for (Index i = 0; i < count; ++i) {
        const dvec3& d = lights[static_cast<std::size_t>(i)];
        for (Index k = 0; k < polynomials; ++k) fill(field, i, k, polynomial(static_cast<std::size_t>(k), d));
        const std::vector<dvec2> turns = untold(d);
        for (Index k = 0; k < motions; ++k) fill(motion, i, k, turns[static_cast<std::size_t>(k)]);
    }
    MatrixXd normal = motion.transpose() * motion;
    normal.diagonal().array() +=
        1e-9 * static_cast<double>(count);  // few lights cannot tell all motions apart
    const MatrixXd of_motions = solve_symmetric(normal, motion.transpose() * field).x;
    field -= motion * of_motions;
    const SymmetricEigen found =
        symmetric_eigen(field.transpose() * field / static_cast<double>(std::max<Index>(count, 1)));
    const Eigen::VectorXd& squares = found.values;
    for (Index k = 0; k < polynomials; ++k) {
        if (squares[k] <= kNegligible * squares[polynomials - 1]) continue;
        auto& mode = modes_.emplace_back();
        for (Index i = 0; i < polynomials; ++i)
            mode[static_cast<std::size_t>(i)] = found.vectors(i, k) / std::sqrt(squares[k]);
    }
    for (Index k = 0; k < motions; ++k) {
        auto& row = motions_.emplace_back();
        for (Index i = 0; i < polynomials; ++i) row[static_cast<std::size_t>(i)] = of_motions(k, i);
    }
}

std::vector<dvec2> DirectionField::at(const dvec3& d) const {
    std::array<dvec2, kPolynomials> field;
    const std::vector<dvec2> motions = untold(d);
    for (std::size_t i = 0; i < kPolynomials; ++i) {
        field[i] = polynomial(i, d);
        for (std::size_t k = 0; k < motions_.size(); ++k) field[i] -= motions_[k][i] * motions[k];
    }
    std::vector<dvec2> turns;
    for (const auto& mode : modes_) {
        dvec2& turn = turns.emplace_back(0);
        for (std::size_t i = 0; i < kPolynomials; ++i) turn += mode[i] * field[i];
    }
    return turns;
}

dvec2 DirectionField::turn(const std::vector<double>& coefficients, const dvec3& d) const {
    dvec2 sum(0);
    const std::vector<dvec2> turns = at(d);
    for (std::size_t k = 0; k < coefficients.size(); ++k) sum += coefficients[k] * turns[k];
    return sum;
}

}  // namespace tangi
