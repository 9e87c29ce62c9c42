#include "fit/residual/residual_kernel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi::residual_kernel {

double psnr_with(const Samples& s, const Colours& colours, std::size_t photo,
                 const std::function<Vec3(std::size_t)>& residual) {
    const Sampled& p = s.photos[photo];
    double sum = 0;
    long count = 0;
    for (std::size_t j = 0; j < p.stored.size(); ++j) {
        if (std::isnan(p.stored[j].r + p.stored[j].g + p.stored[j].b)) continue;
        const Rgb value = p.relit[j] + colours.to_photo * (p.irradiance[j] * (s.to_rgb[j] * residual(j)));
        for (int c = 0; c < 3; ++c, ++count) {
            const double e =
                std::min(colours.transfer.encode(std::max(value[c], 0.0f)), 1.0f) - p.stored[j][c];
            sum += e * e;
        }
    }
    return -10 * std::log10(std::max(sum / static_cast<double>(std::max(count, 1L)), 1e-10));
}

Matrix kernel_matrix(const std::vector<Vec3>& directions, Kernel kernel, double reach) {
    const auto n = static_cast<Eigen::Index>(directions.size());
    Matrix k(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            k(i, j) = kernel_at(kernel, reach,
                                glm::length(glm::dvec3(directions[static_cast<std::size_t>(i)]) -
                                            glm::dvec3(directions[static_cast<std::size_t>(j)])));
    return k;
}

Matrix inverse_of(const Matrix& kernel, double ridge) {
    const auto n = kernel.rows();
    return (kernel + ridge * Matrix::Identity(n, n)).llt().solve(Matrix::Identity(n, n));
}

// Photographs that are left out are a whole step between lights away from the others, and say little of what
// residuals do within it, edges of cast shadows above all. Of kernels that gain as much there, but for this
// part, or for what is chance, the one that trusts single photographs least is taken, and of these the one of
// least reach, which says less of lights far from all that were photographed.
constexpr double kAsMuch = 0.05, kChance_db = 0.03;

Choice choose_kernel(const Samples& s, const Colours& colours, const std::vector<Vec3>& directions,
                     const Progress& progress) {
    constexpr std::array reaches = {0.1, 0.15, 0.22, 0.32, 0.46, 0.7, 1.0, 1.5};
    constexpr std::array ridges = {0.01, 0.03, 0.1, 0.3, 1.0};
    std::vector<Choice> all;
    for (const Kernel kernel : {Kernel::gaussian, Kernel::matern})
        for (std::size_t r = 0; r < reaches.size(); ++r) {
            report(progress, "residual",
                   0.4 + 0.1 * ((kernel == Kernel::matern) + static_cast<double>(r) / reaches.size()) / 2);
            const Matrix k = kernel_matrix(directions, kernel, reaches[r]);
            std::vector<Choice> choices(ridges.size());
            parallel_for(0, static_cast<int>(ridges.size()), 1, [&](int begin, int end) {
                for (int at = begin; at < end; ++at) {
                    const double ridge = ridges[static_cast<std::size_t>(at)];
                    const Matrix inverse = inverse_of(k, ridge);
                    const Matrix left = inverse * s.residual;
                    Choice& choice = choices[static_cast<std::size_t>(at)];
                    choice = {kernel, reaches[r], ridge, {}, 0};
                    for (std::size_t i = 0; i < s.photos.size(); ++i) {
                        const auto row = static_cast<Eigen::Index>(i);
                        const double diagonal = inverse(row, row);
                        const auto from_others = [&](std::size_t j) {
                            const auto column = static_cast<Eigen::Index>(3 * j);
                            const auto value = [&](Eigen::Index c) {
                                return static_cast<float>(s.residual(row, column + c) -
                                                          left(row, column + c) / diagonal);
                            };
                            return Vec3(value(0), value(1), value(2));
                        };
                        choice.photos_db.push_back(psnr_with(s, colours, i, from_others));
                        choice.mean_db += choice.photos_db.back() / static_cast<double>(s.photos.size());
                    }
                }
            });
            std::move(choices.begin(), choices.end(), std::back_inserter(all));
        }
    const auto less = [](const Choice& a, const Choice& b) { return a.mean_db < b.mean_db; };
    const double most_db = std::max_element(all.begin(), all.end(), less)->mean_db;
    double surface_db = 0;
    for (std::size_t i = 0; i < s.photos.size(); ++i)
        surface_db += psnr_with(s, colours, i, [](std::size_t) { return Vec3(0); }) /
                      static_cast<double>(s.photos.size());
    const double enough_db = most_db - std::max(kAsMuch * (most_db - surface_db), kChance_db);
    std::erase_if(all, [&](const Choice& c) { return c.mean_db < enough_db; });
    return *std::min_element(all.begin(), all.end(), [](const Choice& a, const Choice& b) {
        return std::tuple(-a.ridge, a.reach, -a.mean_db) < std::tuple(-b.ridge, b.reach, -b.mean_db);
    });
}

// [1] Of the energy that is predicted, by the terms that are kept.
constexpr double kEnergyKept = 0.998;

FewFunctions few_functions(const Matrix& kernel, const Matrix& inverse, const Eigen::VectorXd& irradiance,
                           const Matrix& samples, int most) {
    const Matrix predicted = irradiance.asDiagonal() * (kernel * (inverse * samples));
    const SymmetricEigen found = symmetric_eigen(predicted * predicted.transpose());
    const Eigen::VectorXd energy = found.values.cwiseMax(0).reverse();
    double kept = 0;
    int terms = 0;
    while (terms < std::min<int>(most, static_cast<int>(energy.size())) && kept < kEnergyKept * energy.sum())
        kept += energy[terms++];
    Matrix components = found.vectors.rowwise().reverse().leftCols(terms);
    for (Eigen::Index t = 0; t < components.cols(); ++t) {  // their sign is arbitrary
        Eigen::Index largest = 0;
        components.col(t).cwiseAbs().maxCoeff(&largest);
        if (components(largest, t) < 0) components.col(t) *= -1;
    }
    const Matrix reached = inverse * (samples * predicted.transpose()) * components;
    return {inverse * (kernel * (irradiance.asDiagonal() * components)),
            reached * energy.head(terms).cwiseInverse().asDiagonal()};
}

}  // namespace tangi::residual_kernel
