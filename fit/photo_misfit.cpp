#include "fit/photo_misfit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <map>

#include "surface/light.h"
#include "surface/median.h"
#include "surface/parallel.h"
#include "surface/relighter.h"

namespace tangi {

namespace {

constexpr int kRows = 24, kColumn = 12;  // [pixels] of a block: waves of the finest relief, many in a picture
constexpr double kPixels = 2e5;          // of the picture that are looked at, or more where it is very wide
constexpr int kFewestStripes = 4;        // of blocks, from top to bottom
constexpr double kRidge = 1e-6;          // [1]
constexpr double kOutlier = 6;           // [standard deviations] robust
constexpr float kUnlit = 0.01f;          // [1] of a matt white's light: less is none
constexpr std::size_t kSamples = 1u << 17;  // of places that no lamp reaches

constexpr int kBox = 9;  // [pixels] side of a coarse blur

// Gain, room, constant, two of a direction, two of uneven light, and of a blur: fine and coarse.
constexpr int kTerms = 9, kFine = kTerms - 2, kCoarse = kTerms - 1;
constexpr double kBoxVariance = (kBox * kBox - 1) / 12.0;  // [pixels^2] along each axis
using Terms = Eigen::Matrix<double, kTerms, 1>;
using Square = Eigen::Matrix<double, kTerms, kTerms>;

// What a block of one photograph says: normal equations, and what there is to explain.
struct Normal {
    Square matrix = Square::Zero();
    Terms right = Terms::Zero();
    double squares = 0;
    long count = 0;
};

// Of a place that no lamp reaches, in one channel.
struct Unlit {
    float white_rho = 0, value = 0;
    int block = 0;
};

// Rows of a stripe under one light, channels averaged.
struct StripePhoto {
    Image<float> predicted, measured, sigma;  // sigma: 0 where there is nothing to compare
    Image<float> blurred;                     // the prediction, by a box
    std::vector<Unlit> unlit;
};

float mean_of(const Rgb& colour, int channels) {
    return channels == 1 ? colour.g : (colour.r + colour.g + colour.b) / 3;
}

// Two unit vectors at right angles to a direction and to each other: a direction that is off is shaded by
// them, and must not pass for another cause.
std::array<Vec3, 2> across(const Vec3& direction) {
    const Vec3 other = std::abs(direction.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
    const Vec3 first = glm::normalize(glm::cross(direction, other));
    return {first, glm::cross(direction, first)};
}

// Means of kBox x kBox pixels; of no use nearer to the border than half of that.
Image<float> box_mean(const Image<float>& picture) {
    Image<float> across(picture.width(), picture.height()), mean = across;
    for (int y = 0; y < picture.height(); ++y)
        for (int x = kBox / 2; x + kBox / 2 < picture.width(); ++x)
            for (int i = -kBox / 2; i <= kBox / 2; ++i) across(x, y) += picture(x + i, y) / kBox;
    for (int y = kBox / 2; y + kBox / 2 < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x)
            for (int i = -kBox / 2; i <= kBox / 2; ++i) mean(x, y) += across(x, y + i) / kBox;
    return mean;
}

// Linear least squares with the errors that the scatter of blocks tells; all zero where it is singular.
void solve_blocks(const std::vector<Normal>& blocks, PhotoMisfit& misfit) {
    Normal all;
    for (const Normal& block : blocks) {
        all.matrix += block.matrix;
        all.right += block.right;
        all.squares += block.squares;
        all.count += block.count;
    }
    if (all.count == 0) return;
    const auto count = static_cast<double>(all.count);
    misfit.rms = std::sqrt(all.squares / count);
    if (2 * static_cast<int>(blocks.size()) < 3 * kTerms) return;
    // What nothing tells apart (on a flat painting, the room and the lamp) is shared between them.
    all.matrix.diagonal() *= 1 + kRidge;
    const Eigen::FullPivLU<Square> lu(all.matrix);
    if (!lu.isInvertible()) return;
    const Square inverse = lu.inverse();
    const Terms terms = inverse * all.right;
    Square scatter = Square::Zero();
    for (const Normal& block : blocks) {
        const Terms score = block.right - block.matrix * terms;
        scatter += score * score.transpose();
    }
    const Square covariance = inverse * scatter * inverse;
    MisfitTerm* const out[] = {&misfit.gain, &misfit.room, &misfit.constant};
    for (int k = 0; k < 3; ++k)
        // Without it, the sum of squares would be larger by this (one degree of freedom).
        *out[k] = {terms[k], std::sqrt(std::max(covariance(k, k), 0.0)),
                   std::abs(terms[k]) / std::sqrt(inverse(k, k) * count)};
    // By the one that explains more: the two overlap, so that their sum is uncertain. Both explain.
    const auto marginal = [&](int k) { return std::abs(terms[k]) / std::sqrt(inverse(k, k)); };
    const bool is_fine = marginal(kFine) >= marginal(kCoarse);
    const int k = is_fine ? kFine : kCoarse;
    const double variance = is_fine ? 1 : kBoxVariance;
    const Eigen::Vector2d blur = terms.tail<2>();
    const Eigen::Matrix2d certainty = inverse.bottomRightCorner<2, 2>().inverse();
    misfit.blur = {variance * terms[k], variance * std::sqrt(std::max(covariance(k, k), 0.0)),
                   std::sqrt(std::max(blur.dot(certainty * blur), 0.0) / count)};
}

// [1] A straight line through the values of unlit places: what is in proportion to rho_d is light of the room
// and of the relief around, and not of interest; the rest is the veil. Cauchy's weights, since some places
// are lit after all.
MisfitTerm veil_of(const std::vector<Unlit>& places, double middling) {
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
        for (const Unlit& place : places) {
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

class Comparison {
public:
    Comparison(const Stack& stack, const NoiseModel& noise, const Surface& surface, const Lighting& lighting,
               double model_error)
        : stack_(stack),
          noise_(noise),
          surface_(surface),
          lighting_(lighting),
          model_error_(model_error),
          relighter_(surface, {.cast_shadows = true}, static_cast<int>(lighting.lights.size())),
          normals_(lighting.lights.size()),
          unlit_(lighting.lights.size()),
          brightness_(lighting.lights.size()) {}

    void add(const Band& band) {
        parallel_for(0, band.photos(), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) add_photo(band, i);
        });
        ++stripes_;
    }
    std::vector<std::vector<Normal>>& normals() { return normals_; }
    // [1] linear, of all photographs
    double middling() const { return static_cast<double>(median(brightness_)); }
    std::vector<Unlit> unlit() const {
        std::vector<Unlit> all;
        for (const auto& photo : unlit_) all.insert(all.end(), photo.begin(), photo.end());
        return all;
    }

private:
    void add_photo(const Band& band, int photo);
    void look_at_row(const Band& band, int photo, int y, StripePhoto& into) const;
    void add_block(const StripePhoto& stripe, int y0, int x0, float limit, float offset, int photo);

    const Stack& stack_;
    const NoiseModel& noise_;
    const Surface& surface_;
    const Lighting& lighting_;
    double model_error_;
    Relighter relighter_;
    std::vector<std::vector<Normal>> normals_;  // [photo][block]
    std::vector<std::vector<Unlit>> unlit_;     // [photo]
    std::vector<float> brightness_;             // [photo] median of the stripe
    int stripes_ = 0;
};

// Prediction and photograph of a row; collects what no lamp reaches.
void Comparison::look_at_row(const Band& band, int photo, int y, StripePhoto& into) const {
    const Light& light = lighting_.lights[static_cast<std::size_t>(photo)];
    const auto white = static_cast<float>(lighting_.white_level);
    std::vector<Rgb> row(static_cast<std::size_t>(band.width()), Rgb(0));
    relighter_.add_row(light, y, row);
    const int r = y - band.y0(), columns = std::max(band.width() / kColumn, 1);
    for (int x = 0; x < band.width(); ++x) {
        const Rgb predicted = white * row[static_cast<std::size_t>(x)];
        into.predicted(x, r) = mean_of(predicted, band.channels());
        into.sigma(x, r) = 0;
        if (!(surface_.confidence(x, y) > 0) || (!stack_.mask.empty() && !stack_.mask(x, y))) continue;
        float mean = 0, values[3] = {};
        bool known = true;
        for (int c = 0; c < band.channels(); ++c) {
            values[c] = band.row(photo, c, y)[x];
            known = known && noise_.sigma(values[c]) > 0;
            mean += values[c] / static_cast<float>(band.channels());
        }
        if (!known) continue;
        into.measured(x, r) = mean;
        into.sigma(x, r) = static_cast<float>(
            std::hypot(noise_.sigma(mean), model_error_ * static_cast<double>(std::max(mean, 0.0f))));
        const Incidence in = incidence(light, surface_.point_mm(x, y), surface_.photography.rig);
        const Rgb rho = in.irradiance * surface_.diffuse(x, y) * white;
        const Rgb direct = predicted - surface_.photography.rig.ambient * rho;
        if (!(mean_of(direct, band.channels()) < kUnlit * mean_of(rho, band.channels()))) continue;
        const int block = stripes_ * columns + std::min(x / kColumn, columns - 1);
        for (int c = 0; c < band.channels(); ++c) into.unlit.push_back({rho[c], values[c], block});
    }
}

void Comparison::add_block(const StripePhoto& stripe, int y0, int x0, float limit, float offset, int photo) {
    Normal& block = normals_[static_cast<std::size_t>(photo)].emplace_back();
    const Image<float>& p = stripe.predicted;
    constexpr int kMargin = kBox / 2;
    const std::array<Vec3, 2> aside = across(lighting_.lights[static_cast<std::size_t>(photo)].direction);
    for (int r = kMargin; r + kMargin < p.height(); ++r)
        for (int x = std::max(x0, kMargin); x < std::min(x0 + kColumn, p.width() - kMargin); ++x) {
            const float sigma = stripe.sigma(x, r), residual = stripe.measured(x, r) - p(x, r);
            if (!(sigma > 0) || !(std::abs(residual / sigma - offset) < limit)) continue;
            const float laplacian = p(x - 1, r) + p(x + 1, r) + p(x, r - 1) + p(x, r + 1) - 4 * p(x, r);
            const float rho = mean_of(surface_.diffuse(x, y0 + r), stack_.channels);
            const double white_rho = lighting_.white_level * static_cast<double>(rho);
            const Vec3& normal = surface_.normal(x, y0 + r);
            const double lit = static_cast<double>(p(x, r)) > 2 * kUnlit * white_rho ? white_rho : 0;
            const glm::dvec2 from_middle(2.0 * x / surface_.width() - 1,
                                         2.0 * (y0 + r) / surface_.height() - 1);
            Terms terms;
            terms << p(x, r), white_rho, 1, lit * static_cast<double>(glm::dot(normal, aside[0])),
                lit * static_cast<double>(glm::dot(normal, aside[1])), from_middle.x * p(x, r),
                from_middle.y * p(x, r), static_cast<double>(laplacian) / 2,
                static_cast<double>(stripe.blurred(x, r) - p(x, r));
            terms /= static_cast<double>(sigma);
            const double left = static_cast<double>(residual / sigma);
            block.matrix += terms * terms.transpose();
            block.right += terms * left;
            block.squares += left * left;
            ++block.count;
        }
}

void Comparison::add_photo(const Band& band, int photo) {
    const int rows = band.y1() - band.y0();
    StripePhoto stripe{Image<float>(band.width(), rows),
                       Image<float>(band.width(), rows),
                       Image<float>(band.width(), rows),
                       {},
                       {}};
    for (int y = band.y0(); y < band.y1(); ++y) look_at_row(band, photo, y, stripe);
    stripe.blurred = box_mean(stripe.predicted);
    std::vector<float> off, values;
    for (std::size_t i = 0; i < stripe.sigma.size(); ++i) {
        const float sigma = stripe.sigma.pixels()[i];
        if (!(sigma > 0)) continue;
        values.push_back(stripe.measured.pixels()[i]);
        off.push_back((values.back() - stripe.predicted.pixels()[i]) / sigma);
    }
    brightness_[static_cast<std::size_t>(photo)] = median(std::move(values));
    const float middle = median(off);
    for (float& value : off) value = std::abs(value - middle);
    const float limit = static_cast<float>(kOutlier * 1.4826) * median(std::move(off));
    for (int x0 = 0; x0 + kColumn <= band.width(); x0 += kColumn)
        add_block(stripe, band.y0(), x0, limit, middle, photo);
    auto& unlit = unlit_[static_cast<std::size_t>(photo)];
    const std::size_t room = kSamples / lighting_.lights.size();
    const std::size_t step = stripe.unlit.size() / std::max<std::size_t>(room, 1) + 1;
    for (std::size_t i = 0; i < stripe.unlit.size(); i += step) unlit.push_back(stripe.unlit[i]);
}

}  // namespace

PhotoMisfits photo_misfits(const Stack& stack, const Transfer& transfer, const NoiseModel& noise,
                           const Surface& surface, const Lighting& lighting, double model_error,
                           const Progress& progress) {
    PhotoMisfits misfits;
    const int height = stack.height(), rows = std::min(kRows + kBox - 1, height);
    if (rows < kBox || stack.width() < kBox) return misfits;
    const double row_pixels = static_cast<double>(stack.width()) * rows;
    const int stripes = std::min(std::max(static_cast<int>(kPixels / row_pixels), kFewestStripes),
                                 std::max(height / rows, 1));
    Comparison comparison(stack, noise, surface, lighting, model_error);
    StackReader reader(stack);
    int next = 0;
    for (int k = 0; k < stripes; ++k) {
        const int y0 = std::max(next, static_cast<int>((height - rows) * (k + 0.5) / stripes));
        if (y0 + rows > height) break;
        comparison.add(reader.read(y0, y0 + rows, transfer));
        next = y0 + rows;
        report(progress, "causes of misfit", (k + 1) / static_cast<double>(stripes));
    }
    std::vector<double> strengths;
    for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
        PhotoMisfit& misfit = misfits.photos.emplace_back();
        solve_blocks(comparison.normals()[i], misfit);
        misfit.strength = static_cast<double>(lighting.lights[i].gain.g) * (1 + misfit.gain.value);
        strengths.push_back(misfit.strength);
    }
    misfits.veil = veil_of(comparison.unlit(), comparison.middling());
    const double middling = median(strengths);
    for (PhotoMisfit& misfit : misfits.photos) misfit.strength /= middling > 0 ? middling : 1;
    return misfits;
}

}  // namespace tangi
