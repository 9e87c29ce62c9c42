#include "capture/registration/alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr float kCauchy = 2;          // [scales]
constexpr double kLeastFree = 0.25;   // [1] smallest 1 - leverage that a residual is divided by
constexpr double kRidge = 0.02;       // [1] of a pixel's weight: keeps light terms determinate
constexpr float kLeastScale = 1e-4f;  // [1] contrast
constexpr int kRounds = 3;            // of reweighting a pixel's fit
constexpr double kTiedStep = 1.5;     // [1] over-relaxed: it converges by halves
constexpr double kLeastZ = 0.2;       // [1] lights are taken for no lower than 12 degrees
constexpr double kMisfitPx = 0.12;    // [pixels] of shift for misfit as large as what fits, light from above
constexpr double kModelErrors = 1.5;  // [1] times that error, a finer model must move a picture by
constexpr double kMany = 0.4;         // [1] of the pictures: what they tell, the others are free to have
constexpr float kShared = 36;         // pictures, squared, from which on pixels have scales of their own
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

Three Alignment::terms_under(const glm::dvec3& l) {
    return {1, l.x / std::max(l.z, kLeastZ), l.y / std::max(l.z, kLeastZ)};
}

Alignment::Alignment(const MotionFrame& frame, const std::vector<glm::dvec3>& lights,
                     std::vector<bool> in_model)
    : pictures(lights.size()), frame_(frame), in_model_(std::move(in_model)), scales_(lights.size(), 1) {
    TP_REQUIRE(lights.size() == in_model_.size(), "one flag a picture");
    for (const glm::dvec3& l : lights) terms_of_.push_back(terms_under(l));
    terms_ = std::count(in_model_.begin(), in_model_.end(), true) >= kEnoughForRelief ? 3 : 1;
}

void Alignment::sample() {
    parallel_for(0, static_cast<int>(pixels_.size()), 64, [&](int begin, int end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
            const Pixel& pixel = pixels_[k];
            const AlignmentWindow& window = (*windows_)[static_cast<std::size_t>(pixel.window)];
            for (std::size_t i = 0; i < pictures.size(); ++i) {
                Sample& s = samples_[k * pictures.size() + i];
                const glm::dvec2 q =
                    (mapped(pictures[i].homography, pixel.position) - window.origin) / window.reduction;
                if (!sample_at(window.pictures[i], q, s.value, s.dx, s.dy)) s.value = kNaN;
            }
        }
    });
}

// One round of a pixel's least squares of value and gradient by the light's terms; `robust`: weighed by the
// deviations from the fit as it is, which are handed out. False where it cannot be told.
bool Alignment::fit_pixel(std::size_t k, bool robust, PixelFit& fit, std::vector<float>& deviations) {
    const auto n = static_cast<std::size_t>(terms_), count = pictures.size();
    Sample* s = &samples_[k * count];
    Small a{};
    Three b{}, bx{}, by{};
    deviations.clear();
    for (std::size_t i = 0; i < count; ++i) {
        s[i].weight = 0;
        if (std::isnan(s[i].value) || !in_model_[i]) continue;
        const Three& f = terms_of_[i];
        float w = 1 / (scales_[i] * scales_[i]);
        if (robust) {
            const float r = (s[i].value - static_cast<float>(dot(fit.value, f, n))) / scales_[i];
            deviations.push_back(std::abs(r));
            const float t = r / (kCauchy * pixels_[k].scale);
            w /= 1 + t * t;
        }
        s[i].weight = w;
        for (std::size_t p = 0; p < n; ++p) {
            for (std::size_t q = 0; q <= p; ++q) a[p][q] += w * f[p] * f[q];
            b[p] += w * f[p] * s[i].value;
            bx[p] += w * f[p] * s[i].dx;
            by[p] += w * f[p] * s[i].dy;
        }
    }
    for (std::size_t p = 1; p < n; ++p) a[p][p] += kRidge * a[0][0];
    if (!(a[0][0] > 0) || !factorise(a, n)) return false;
    solve(a, n, b), solve(a, n, bx), solve(a, n, by);
    fit = {b, bx, by, a};
    return true;
}

// Of a pixel's residuals: its own and the usual one, by how many tell it.
float Alignment::scale_of(std::vector<float> deviations) const {
    const float part = static_cast<float>(deviations.size()), scale = 1.4826f * median(std::move(deviations));
    return std::max(std::sqrt((part * part * scale * scale + kShared * typical_scale_ * typical_scale_) /
                              (part * part + kShared)),
                    kLeastScale);
}

// Each picture's residual is that against a fit without itself.
void Alignment::find_residuals(std::size_t k, const PixelFit& fit) {
    const auto n = static_cast<std::size_t>(terms_), count = pictures.size();
    Sample* s = &samples_[k * count];
    for (std::size_t i = 0; i < count; ++i) {
        if (std::isnan(s[i].value)) {
            s[i].residual = kNaN;
            continue;
        }
        const Three& f = terms_of_[i];
        Three h = f;
        solve(fit.factor, n, h);
        const double free = std::max(kLeastFree, 1 - s[i].weight * dot(h, f, n));
        s[i].residual = static_cast<float>((s[i].value - dot(fit.value, f, n)) / free);
        s[i].dx = static_cast<float>(dot(fit.dx, f, n));
        s[i].dy = static_cast<float>(dot(fit.dy, f, n));
    }
}

// A robust least-squares fit of value and gradient to the terms of the light.
void Alignment::predict_pixel(std::size_t k) {
    PixelFit fit;
    std::vector<float> deviations;
    for (int round = 0; round < kRounds; ++round) {
        if (!fit_pixel(k, round > 0, fit, deviations)) {
            for (std::size_t i = 0; i < pictures.size(); ++i)
                samples_[k * pictures.size() + i].residual = kNaN;
            return;
        }
        if (!deviations.empty()) pixels_[k].scale = scale_of(deviations);
    }
    find_residuals(k, fit);
    pixels_[k].terms = fit.value;
    if (terms_ == 3) add_tied_rows(k, fit.factor, fit.value);
}

// The rows of a motion that is linear in the light's terms, after what the pixel's own terms take up.
void Alignment::add_tied_rows(std::size_t k, const Small& factor, const Three& c) {
    const std::size_t count = pictures.size();
    const Sample* s = &samples_[k * count];
    const Pixel& pixel = pixels_[k];
    const double reduction = (*windows_)[static_cast<std::size_t>(pixel.window)].reduction;
    const auto basis = motion_basis(frame_.normalised(pixel.position));
    const auto parameters = static_cast<std::size_t>(least_);
    const auto rows_of = [&](std::size_t i) {
        const double u = terms_of_[i][1] / reduction, v = terms_of_[i][2] / reduction;
        std::array<double, kTied> row{};
        for (std::size_t p = 0; p < parameters; ++p) {
            const double along = s[i].dx * basis[p].x + s[i].dy * basis[p].y;
            row[2 * p] = along * u, row[2 * p + 1] = along * v;
        }
        return row;
    };
    std::array<Three, kTied> taken_up{};
    for (std::size_t i = 0; i < count; ++i) {
        if (!(s[i].weight > 0)) continue;
        const auto row = rows_of(i);
        for (std::size_t q = 0; q < 2 * parameters; ++q)
            for (std::size_t p = 0; p < 3; ++p) taken_up[q][p] += s[i].weight * terms_of_[i][p] * row[q];
    }
    for (std::size_t q = 0; q < 2 * parameters; ++q) solve(factor, 3, taken_up[q]);
    for (std::size_t i = 0; i < count; ++i) {
        if (!(s[i].weight > 0)) continue;
        auto row = rows_of(i);
        for (std::size_t q = 0; q < 2 * parameters; ++q) row[q] -= dot(taken_up[q], terms_of_[i], 3);
        tied_[k].add(row, s[i].value - dot(c, terms_of_[i], 3), s[i].weight / (pixel.scale * pixel.scale),
                     2 * parameters);
    }
}

void Alignment::predict() {
    tied_.assign(pixels_.size(), {});
    parallel_for(0, static_cast<int>(pixels_.size()), 64, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) predict_pixel(static_cast<std::size_t>(k));
    });
    parallel_for(0, static_cast<int>(pictures.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            std::vector<float> deviations;
            for (std::size_t k = 0; k < pixels_.size(); ++k) {
                const float r = samples_[k * pictures.size() + i].residual;
                if (!std::isnan(r)) deviations.push_back(std::abs(r) / pixels_[k].scale);
            }
            if (!deviations.empty())
                scales_[i] = std::max(1.4826f * median(std::move(deviations)), kLeastScale);
        }
    });
    std::vector<float> of_pixels;
    for (const Pixel& pixel : pixels_) of_pixels.push_back(pixel.scale);
    typical_scale_ = median(std::move(of_pixels));
    std::vector<float> of_model;
    for (std::size_t i = 0; i < pictures.size(); ++i)
        if (in_model_[i]) of_model.push_back(scales_[i]);
    const float middle = std::max(median(std::move(of_model)), 1e-6f);  // relative: pixels have theirs
    for (float& scale : scales_) scale = std::clamp(scale / middle, 0.2f, 20.0f);
}

struct Alignment::MotionEvidence {
    // How a picture agrees with its prediction, in sums over pixels.
    struct Agreement {
        double product = 0, squares = 0, predicted = 0, weights = 0;

        double correlation() const { return product / std::sqrt(std::max(squares * predicted, 1e-30)); }
        void add(double value, double prediction, double weight) {
            product += weight * value * prediction;
            squares += weight * value * value;
            predicted += weight * prediction * prediction;
            weights += weight;
        }
    };
    std::vector<MotionCell> cells;
    std::vector<Agreement> agreements;  // of the cells
    Agreement all;

    // [standard errors] by which correlations of cells differ from 0.
    double certainty() const {
        double sum = 0, square_sum = 0, count = 0;
        for (const Agreement& agreement : agreements) {
            if (agreement.squares == 0) continue;
            const double a = agreement.correlation();
            sum += a, square_sum += a * a, count += 1;
        }
        const double variance = count > 1 ? (square_sum - sum * sum / count) / (count - 1) : 0;
        return variance > 0 ? sum / std::sqrt(count * variance) : 0;
    }
};

Alignment::MotionEvidence Alignment::evidence_of(std::size_t i) const {
    MotionEvidence evidence{std::vector<MotionCell>(static_cast<std::size_t>(cells_)),
                            std::vector<MotionEvidence::Agreement>(static_cast<std::size_t>(cells_)),
                            {}};
    for (std::size_t k = 0; k < pixels_.size(); ++k) {
        const Pixel& pixel = pixels_[k];
        const Sample& s = samples_[k * pictures.size() + i];
        if (std::isnan(s.residual)) continue;
        const float scale = pixel.scale * scales_[i], t = s.residual / (kCauchy * scale);
        const double weight = 1 / (scale * scale * (1 + t * t));
        const double reduction = (*windows_)[static_cast<std::size_t>(pixel.window)].reduction;
        const glm::dvec2 gradient = glm::dvec2(s.dx, s.dy) / reduction;
        const auto basis = motion_basis(frame_.normalised(pixel.position));
        MotionVector row;
        for (std::size_t p = 0; p < kMotion; ++p) row[p] = glm::dot(gradient, basis[p]);
        const auto cell = static_cast<std::size_t>(pixel.cell);
        evidence.cells[cell].add(row, s.residual, weight);
        const double w = 1 / (pixel.scale * pixel.scale);
        evidence.agreements[cell].add(s.value, s.value - s.residual, w);
        evidence.all.add(s.value, s.value - s.residual, w);
    }
    return evidence;
}

void Alignment::judge_agreement(const MotionEvidence& evidence, std::size_t i) {
    AlignedPicture& picture = pictures[i];
    const MotionEvidence::Agreement& all = evidence.all;
    picture.correlation = all.correlation();
    picture.expected = std::sqrt(all.predicted / std::max(all.weights, 1e-30));
    picture.contrast = std::sqrt(all.squares / std::max(all.weights, 1e-30));
    const double c = std::clamp(picture.correlation, 0.05, 1.0);
    picture.model_error_px = kMisfitPx * windows_->front().reduction * std::sqrt(1 - c * c) / c *
                             std::hypot(1.0, terms_of_[i][1], terms_of_[i][2]);
    picture.certainty = evidence.certainty();
}

void Alignment::move(std::size_t i, MotionModel largest) {
    const MotionEvidence evidence = evidence_of(i);
    judge_agreement(evidence, i);
    AlignedPicture& picture = pictures[i];
    const MotionVector so_far = motion_of(picture.homography, frame_);
    picture.told = supported_model(evidence.cells, so_far, largest, kModelErrors * picture.model_error_px);
    picture.last = solve_motion(evidence.cells, std::max(picture.told, std::min(least_, largest)));
    if (picture.last.model == MotionModel::none) picture.last = solve_motion(evidence.cells, picture.told);
    picture.covariance = picture.last.covariance;
}

// Motions linear in the light's terms look like relief to a pixel's fit, which follows them: that part of the
// pictures' steps says nothing, and is replaced by what the whole stack says.
void Alignment::replace_tied_part() {
    tied = {};
    if (terms_ < 3) return;
    std::vector<TiedCell> cells(static_cast<std::size_t>(cells_));
    for (std::size_t k = 0; k < pixels_.size(); ++k)
        cells[static_cast<std::size_t>(pixels_[k].cell)] += tied_[k];
    tied = solve_tied(cells, least_);
    const auto replaced = static_cast<std::size_t>(least_);
    Small a{};
    std::array<Three, kMotion> linear{};
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        if (!in_model_[i]) continue;
        const Three& f = terms_of_[i];
        for (std::size_t p = 0; p < 3; ++p) {
            for (std::size_t q = 0; q <= p; ++q) a[p][q] += f[p] * f[q];
            for (std::size_t q = 0; q < replaced; ++q) linear[q][p] += f[p] * pictures[i].last.motion[q];
        }
    }
    if (!factorise(a, 3)) return;
    for (std::size_t q = 0; q < replaced; ++q) solve(a, 3, linear[q]);
    const auto& t = tied.motion;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        if (!in_model_[i]) continue;  // the others' fits did not follow it
        const Three& f = terms_of_[i];
        for (std::size_t q = 0; q < replaced; ++q)
            pictures[i].last.motion[q] += (kTiedStep * t[2 * q] - linear[q][1]) * f[1] +
                                          (kTiedStep * t[2 * q + 1] - linear[q][2]) * f[2];
    }
}

void Alignment::apply_steps() {
    // A step beyond the reach of gradients is shortened, not believed.
    const double reach = 2 * windows_->front().reduction;
    for (AlignedPicture& picture : pictures) {
        MotionVector step = picture.last.motion;
        const double shorten = std::min(1.0, reach / std::max(rms_displacement(step), 1e-12));
        for (double& value : step) value *= shorten;
        // What the data no longer support is taken back.
        MotionVector kept = motion_of(picture.homography, frame_);
        const auto parameters = std::max<std::size_t>(static_cast<std::size_t>(picture.last.model), 2);
        for (std::size_t p = parameters; p < kMotion; ++p) kept[p] = 0;
        picture.homography = normalised(homography_of(kept, frame_) * homography_of(step, frame_));
    }
}

// A camera that zooms, rolls or tilts does so from photograph to photograph, by less than many of them tell
// by themselves.
void Alignment::free_all() {
    double all = 0, similar = 0, homographic = 0;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        if (!in_model_[i]) continue;
        all += 1;
        similar += pictures[i].told >= MotionModel::similarity;
        homographic += pictures[i].told >= MotionModel::homography;
    }
    least_ = homographic > kMany * all ? MotionModel::homography
             : similar > kMany * all   ? MotionModel::similarity
                                       : MotionModel::translation;
}

void Alignment::iterate(MotionModel largest, int times) {
    if (pixels_.empty()) return;
    for (int round = 0; round < times; ++round) {
        sample();
        predict();
        parallel_for(0, static_cast<int>(pictures.size()), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) move(static_cast<std::size_t>(i), largest);
        });
        replace_tied_part();
        apply_steps();
        free_all();
    }
}

}  // namespace tangi
