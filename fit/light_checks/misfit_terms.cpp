#include "fit/light_checks/misfit_terms.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <map>

#include "surface/base/median.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

constexpr int kRoom = 1, kFine = kMisfitTerms - 2, kCoarse = kMisfitTerms - 1;
constexpr double kBoxVariance = (kMisfitBox * kMisfitBox - 1) / 12.0;  // [pixels^2] along each axis
constexpr double kRidge = 1e-6;                                        // [1]
constexpr double kSingular = kMisfitTerms * std::numeric_limits<double>::epsilon();  // [1] as Eigen has it

// Those whose deviation is that of most, or less. Others are of another kind (metal that passes for matt,
// a hand, the frame), and say nothing about what the whole photograph has.
std::vector<MisfitNormal> usual_blocks(const std::vector<MisfitNormal>& blocks) {
    const auto rms = [](const MisfitNormal& block) {
        return std::sqrt(block.squares / static_cast<double>(block.count));
    };
    std::vector<double> all;
    for (const MisfitNormal& block : blocks)
        if (block.count > 0) all.push_back(rms(block));
    const double limit = kMisfitOutlier * median(std::move(all));
    std::vector<MisfitNormal> usual;
    for (const MisfitNormal& block : blocks)
        if (block.count > 0 && rms(block) <= limit) usual.push_back(block);
    return usual;
}

MisfitNormal sum_of_blocks(const std::vector<MisfitNormal>& blocks) {
    MisfitNormal all;
    for (const MisfitNormal& block : blocks) {
        all.matrix += block.matrix;
        all.right += block.right;
        all.squares += block.squares;
        all.count += block.count;
    }
    return all;
}

// Linear least squares with the errors that the scatter of blocks tells; not solved where it is singular.
PhotoTerms solve_blocks(const std::vector<MisfitNormal>& of_photo) {
    PhotoTerms result;
    if (const MisfitNormal all = sum_of_blocks(of_photo); all.count > 0)
        result.rms = std::sqrt(all.squares / static_cast<double>(all.count));
    const std::vector<MisfitNormal> blocks = usual_blocks(of_photo);
    if (2 * static_cast<int>(blocks.size()) < 3 * kMisfitTerms) return result;
    MisfitNormal all = sum_of_blocks(blocks);
    const auto count = static_cast<double>(all.count);
    // What nothing tells apart (on a flat painting, the room and the light) is shared between them.
    all.matrix.diagonal() *= 1 + kRidge;
    const SymmetricEigen stretches = symmetric_eigen(all.matrix);
    if (!(stretches.values[0] > kSingular * stretches.values[kMisfitTerms - 1])) return result;
    const MisfitSquare inverse =
        stretches.vectors * stretches.values.cwiseInverse().asDiagonal() * stretches.vectors.transpose();
    result.terms = inverse * all.right;
    MisfitSquare scatter = MisfitSquare::Zero();
    for (const MisfitNormal& block : blocks) {
        const MisfitTerms score = block.right - block.matrix * result.terms;
        scatter += score * score.transpose();
    }
    result.errors = (inverse * scatter * inverse).diagonal().cwiseMax(0).cwiseSqrt();
    // Without a term, the sum of squares would be larger by its square over this (one degree of freedom).
    result.sensitivities = (inverse.diagonal() * count).cwiseSqrt().cwiseInverse();
    result.blurs = inverse.bottomRightCorner<2, 2>().inverse() / count;
    result.solved = true;
    return result;
}

// [1] Of the photographs that are solved.
double middling_of(const std::vector<PhotoTerms>& photos, int term) {
    std::vector<double> values;
    for (const PhotoTerms& photo : photos)
        if (photo.solved) values.push_back(photo.terms[term]);
    return median(std::move(values));
}

MisfitTerm term_of(const PhotoTerms& photo, int k, double middling = 0) {
    const double value = photo.terms[k] - middling;
    return {value, photo.errors[k], std::abs(value) * photo.sensitivities[k]};
}

// By the one that explains more: the two overlap, so that their sum is uncertain. Both explain.
MisfitTerm blur_of(const PhotoTerms& photo, const Eigen::Vector2d& middling) {
    const Eigen::Vector2d blur = photo.terms.tail<2>() - middling;
    const bool is_fine =
        term_of(photo, kFine, middling[0]).effect >= term_of(photo, kCoarse, middling[1]).effect;
    const double variance = is_fine ? 1 : kBoxVariance;
    return {variance * blur[is_fine ? 0 : 1], variance * photo.errors[is_fine ? kFine : kCoarse],
            std::sqrt(std::max(blur.dot(photo.blurs * blur), 0.0))};
}

}  // namespace

std::vector<PhotoTerms> solve_photos(const std::vector<std::vector<MisfitNormal>>& photos) {
    std::vector<PhotoTerms> solved;
    for (const auto& blocks : photos) solved.push_back(solve_blocks(blocks));
    return solved;
}

std::vector<PhotoMisfit> relative_misfits(const std::vector<PhotoTerms>& photos) {
    const double room = middling_of(photos, kRoom);
    const Eigen::Vector2d blur(middling_of(photos, kFine), middling_of(photos, kCoarse));
    std::vector<PhotoMisfit> misfits;
    for (const PhotoTerms& photo : photos) {
        PhotoMisfit& misfit = misfits.emplace_back();
        misfit.rms = photo.rms;
        if (!photo.solved) continue;
        misfit.gain = term_of(photo, 0);
        misfit.room = term_of(photo, kRoom, room);
        misfit.constant = term_of(photo, 2);
        misfit.blur = blur_of(photo, blur);
    }
    return misfits;
}

// [1] A straight line through the values of unlit places: what is in proportion to rho_d is light of the room
// and of the relief around, and not of interest; the rest is the veil. Cauchy's weights, since some places
// are lit after all.
MisfitTerm veil_of(const std::vector<UnlitPlace>& places, double middling) {
    constexpr std::size_t kFewest = 100, kFewestPlaces = 8;  // values, and blocks of them
    constexpr int kRounds = 20;
    if (places.size() < kFewest) return {};
    glm::dvec2 line(0);
    double scale = std::numeric_limits<double>::infinity();
    glm::dmat2 inverse(1);
    std::map<int, glm::dvec2> scores;
    for (int round = 0; round <= kRounds; ++round) {
        glm::dmat2 matrix(0);
        glm::dvec2 right(0);
        std::vector<double> off;
        scores.clear();
        for (const UnlitPlace& place : places) {
            const glm::dvec2 row(place.white_rho, 1);
            const double value = static_cast<double>(place.value), left = value - glm::dot(row, line);
            const double weight = 1 / (1 + left * left / (scale * scale));
            matrix += weight * glm::outerProduct(row, row);
            right += weight * value * row;
            scores[place.block] += weight * left * row;
            off.push_back(std::abs(left));
        }
        if (!(glm::determinant(matrix) > 0)) return {};
        inverse = glm::inverse(matrix);
        if (round < kRounds) line = inverse * right;
        scale = std::max(1.4826 * median(std::move(off)), 1e-9);
    }
    if (scores.size() < kFewestPlaces) return {};
    glm::dmat2 scatter(0);
    for (const auto& [block, score] : scores) scatter += glm::outerProduct(score, score);
    const glm::dmat2 covariance = inverse * scatter * inverse;
    return {line.y, std::sqrt(std::max(covariance[1][1], 0.0)), middling > 0 ? line.y / middling : 0};
}

}  // namespace tangi
