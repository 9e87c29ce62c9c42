#include "fit/pipeline/row_fitter.h"

#include <algorithm>
#include <cmath>

#include "fit/material/occluded_pixels.h"
#include "fit/material/specular_colour.h"
#include "surface/maps/surface_part.h"

namespace tangi {

namespace {

static_assert(kWardLanes == kMarchLanes);

// Pixels that batches are fed before the last of them are waited for: few enough to stay in memory's nearer
// half, many enough that registers are full nearly all the time.
constexpr int kPixelsAtOnce = 8192;
constexpr double kSampleSize = 512;
constexpr float kHidden = 0.5f;  // [1] part of a light that reaches a pixel: less is mostly in shadow
// A crevice that few lights reach: what the brightest photographs show, and what is not much darker. With the
// usual fifth as highlights, one of which less than a fifth is lit is lost (generated deep relief: 31.7 dB
// instead of 32.9, when this was tried in both passes).
constexpr PhotometricStereoOptions kLitStereo = {.shadow = kWardStereo.shadow, .highlights = 0.05};

bool is_occluded(int x, int y, const PixelKnowledge& known) { return known.occluded && known.occluded(x, y); }

// Of a pixel that relief hides from some of the lights, under lights of the colour of its lobe: as those that
// reach it show it, or as what is around it.
enum class Shade { lit, around };
std::optional<WardStart> start_in_shade(Shade shade, int x, int y, const Surface& surface,
                                        const PixelKnowledge& known, const PixelSamples& samples) {
    if (shade == Shade::around) {
        if (!known.prior) return {};
        const Rgb colour = known.specular_colour ? known.specular_colour(x, y) : Rgb(1);
        return WardStart{.slope = known.prior(x, y).slope,
                         .diffuse = glm::dvec3(surface.diffuse(x, y) / colour)};
    }
    const LambertEstimate lit = photometric_stereo(samples, kLitStereo);
    return lit.valid ? std::optional(start_of(lit)) : std::nullopt;
}

// The cheapest. Others are as probable beside it as their costs say, in units of what residuals are: the
// slope's variance is that of them all.
WardSolution best_of(const WardSolution& own, const std::vector<WardSolution>& tried) {
    WardSolution best = own;
    for (const WardSolution& other : tried)
        if (other.valid && !other.doubtful && (!best.valid || other.cost < best.cost)) best = other;
    float weights = 1, squares = 0;
    const auto add = [&](const WardSolution& other) {
        if (!other.valid || other.doubtful || !(other.cost > best.cost)) return;
        const float weight = std::exp((best.cost - other.cost) / (2 * std::max(best.chi2, 1.0f)));
        const float dx = other.theta[0] - best.theta[0], dy = other.theta[1] - best.theta[1];
        weights += weight;
        squares += weight * (dx * dx + dy * dy) / 2;
    };
    add(own);
    for (const WardSolution& other : tried) add(other);
    best.slope_error = std::hypot(best.slope_error, std::sqrt(squares / weights));
    return best;
}

}  // namespace

SolverAgreement& SolverAgreement::operator+=(const SolverAgreement& other) {
    compared += other.compared;
    cost_agrees += other.cost_agrees;
    cheaper += other.cheaper;
    slope_agrees += other.slope_agrees;
    doubtful += other.doubtful;
    polished += other.polished;
    return *this;
}

bool is_compared(int x, int y, int width, int height) {
    const double area = static_cast<double>(width) * height;
    const int step = std::max(4, static_cast<int>(std::sqrt(area / kSampleSize)));
    return x % step == step / 2 && y % step == step / 2;
}

RowFitter::RowFitter(const WardFitOptions& options, Solver solver, const Lighting& lighting,
                     const NoiseModel& noise, int channels)
    : solver_(solver),
      lighting_(lighting),
      noise_(noise),
      sampler_(lighting, noise, options.prior, channels),
      ceres_(options),
      batches_(options),
      again_(options),
      highlights_(options.by_highlight),
      in_shade_(options.in_shade),
      bounds_(options.bounds),
      prior_(options.prior) {}

PixelSamples& RowFitter::samples_at(const Band& band, int x, int y, const Surface& surface,
                                    const PixelKnowledge& known) {
    illuminate(lighting_, surface.point_mm(x, y), band.channels(), samples_);
    std::size_t at = 0;
    for (int i = 0; i < band.photos(); ++i)
        for (int c = 0; c < band.channels(); ++c, ++at) {
            const float value = band.row(i, c, y)[x];
            samples_.value[at] = value;
            samples_.sigma[at] = noise_.sigma(value);
        }
    const glm::ivec2 at_relief = in_painting(surface, x, y);
    for (std::size_t i = 0; known.shadows && i < samples_.light.size(); ++i)
        samples_.visible[i] = known.shadows->visible_part(at_relief.x, at_relief.y, Vec3(samples_.light[i]));
    return samples_;
}

PixelSamples& RowFitter::white_samples_at(const Band& band, int x, int y, const Surface& surface,
                                          const PixelKnowledge& known) {
    PixelSamples& samples = samples_at(band, x, y, surface, known);
    if (known.specular_colour) divide_by_specular_colour(known.specular_colour(x, y), samples);
    return samples;
}

WardPrior RowFitter::prior_at(int x, int y, const PixelKnowledge& known) const {
    const WardPrior prior = known.prior ? known.prior(x, y) : prior_;
    return is_occluded(x, y, known) ? of_its_own(prior) : prior;
}

bool RowFitter::may_be_shaded(int x, int y, bool explained, bool shaded, const PixelKnowledge& known) const {
    return (in_shade_ && (!explained || shaded)) || is_occluded(x, y, known);
}

WardEstimate RowFitter::by_ceres(const Band& band, int x, int y, const Surface& surface,
                                 const PixelKnowledge& known) {
    PixelSamples& samples = white_samples_at(band, x, y, surface, known);
    WardEstimate best = ceres_.fit(samples, prior_at(x, y, known));
    const bool explained = best.valid && best.rms_residual <= kPoorFit;
    const bool shaded = std::ranges::any_of(samples.visible, [](double part) { return part < kHidden; });
    const bool in_doubt = may_be_shaded(x, y, explained, shaded, known);
    const WardPrior prior = known.prior ? known.prior(x, y) : prior_;
    for (const Shade shade : {Shade::lit, Shade::around}) {
        if (!in_doubt) break;
        white_samples_at(band, x, y, surface, known);
        const auto start = start_in_shade(shade, x, y, surface, known, samples);
        if (!start) continue;
        const double unexplained = hide_dark(*start, samples);
        WardEstimate in_shade = ceres_.fit(samples, prior, &*start);
        in_shade.cost += unexplained;
        if (in_shade.valid && in_shade.converged && (!best.valid || in_shade.cost < best.cost))
            best = in_shade;
    }
    return best;
}

// What the relief leaves of the lights on the lanes of the batch. Most lights are above any horizon, which is
// cheap to see.
void RowFitter::shade(const CastShadows& shadows, const glm::ivec2& first, int count, int first_name) {
    WardLane steepest;
    for (int lane = 0; lane < count; ++lane)
        steepest[lane] = shadows.steepest_horizon(first.x + lane, first.y);
    for (std::size_t i = 0; i < batch_.light.size(); ++i) {
        const auto& [lx, ly, lz] = batch_.light[i];
        std::uint32_t doubtful = 0;
        for (int lane = 0; lane < count; ++lane) {
            const float across = std::sqrt(lx[lane] * lx[lane] + ly[lane] * ly[lane]);
            doubtful |= std::uint32_t{!shadows.clears(steepest[lane], across, lz[lane])} << lane;
        }
        if (doubtful == 0) continue;
        shadows.visible_parts(first.x, first.y, {lx.data(), ly.data(), lz.data()}, doubtful,
                              batch_.visible[i].data());
        for (int lane = 0; lane < count; ++lane)
            if (batch_.visible[i][lane] < kHidden)
                shaded_[static_cast<std::size_t>(first_name + lane)] = true;
    }
}

// divide_by_specular_colour() of one lane.
void RowFitter::divide_lane_by_specular_colour(const Rgb& colour, int lane) {
    if (colour == Rgb(1)) return;
    const Rgb crosstalk = crosstalk_of(colour);
    for (std::size_t first = 0; first + 2 < batch_.value.size(); first += 3) {
        const float most = std::max(
            {batch_.value[first][lane], batch_.value[first + 1][lane], batch_.value[first + 2][lane]});
        for (int c = 0; c < 3; ++c) {
            const std::size_t at = first + static_cast<std::size_t>(c);
            batch_.irradiance[at][lane] *= colour[c];
            float& sigma = batch_.sigma[at][lane];
            if (sigma != 0) sigma = std::copysign(std::hypot(sigma, crosstalk[c] * most), sigma);
        }
    }
}

void RowFitter::start_row(const Band& band, int y, int first_name, const Image<unsigned char>& mask,
                          const Surface& surface, const PixelKnowledge& known) {
    for (int x0 = 0; x0 < band.width(); x0 += kWardLanes) {
        const int count = std::min(kWardLanes, band.width() - x0);
        const auto masked = [&](int lane) { return !mask.empty() && !mask(x0 + lane, y); };
        int rejected = 0;
        for (int lane = 0; lane < count; ++lane) rejected += masked(lane);
        if (rejected == count) continue;
        sampler_.fill(band, surface, x0, y, count, first_name + x0, batch_);
        for (int lane = 0; lane < count; ++lane) {
            if (masked(lane)) {
                batch_.pixel[static_cast<std::size_t>(lane)] = -1;
                continue;
            }
            if (known.prior) batch_.set_prior(lane, prior_at(x0 + lane, y, known));
            if (known.specular_colour)
                divide_lane_by_specular_colour(known.specular_colour(x0 + lane, y), lane);
        }
        if (known.shadows) shade(*known.shadows, in_painting(surface, x0, y), count, first_name + x0);
        batches_.fit(batch_);
    }
}

// After the row was fitted, for which its samples are gone: what the second pass has found tells shadows
// better than what the first had (0.1 to 0.5 dB of held-out photographs of generated thick paint).
void RowFitter::look_at_row(const Band& band, int y, const Surface& surface, const PixelKnowledge& known) {
    for (int x0 = 0; known.lights && x0 < band.width(); x0 += kWardLanes) {
        const int count = std::min(kWardLanes, band.width() - x0);
        sampler_.fill(band, surface, x0, y, count, x0, batch_);
        known.lights->look(batch_, surface, *known.shadows, x0, y, count);
    }
}

std::vector<int> RowFitter::fit_again(const Band& band, std::size_t count,
                                      const std::function<std::optional<Offer>(int name)>& offer) {
    std::vector<int> names;
    again_.start(static_cast<int>(count));
    int lane = kWardLanes;
    for (int name = 0; name < static_cast<int>(count); ++name) {
        const std::optional<Offer> other = offer(name);
        if (!other) continue;
        if (lane == kWardLanes) {
            if (!names.empty()) again_.fit(other_batch_);
            other_batch_.resize(band.photos(), band.channels(), prior_);
            lane = 0;
        }
        other_batch_.set(lane, name, *other->samples);
        other_batch_.set_prior(lane, other->prior);
        other_batch_.set_start(lane, other->start);
        names.push_back(name);
        ++lane;
    }
    if (!names.empty()) again_.fit(other_batch_);
    again_.finish();
    return names;
}

// Of rows from `first` on that batches just fitted, those that explain little: from their highlight, where
// that explains more.
void RowFitter::fit_by_highlight(const Band& band, int first, const Surface& surface,
                                 const PixelKnowledge& known, std::vector<WardSolution>& solutions) {
    constexpr auto poor = static_cast<float>(kPoorFit * kPoorFit);
    constexpr auto clearly = static_cast<float>(kClearlyCheaper);
    const int width = band.width();
    const auto names = fit_again(band, solutions.size(), [&](int name) -> std::optional<Offer> {
        const WardSolution& solution = solutions[static_cast<std::size_t>(name)];
        if (!solution.valid || !(solution.chi2 > poor)) return {};
        const int x = name % width, y = first + name / width;
        const PixelSamples& samples = white_samples_at(band, x, y, surface, known);
        const auto start = highlight_start(samples, bounds_);
        if (!start) return {};
        return Offer{&samples, prior_at(x, y, known), *start};
    });
    for (const int name : names) {
        const WardSolution& other = again_.solutions()[static_cast<std::size_t>(name)];
        WardSolution& solution = solutions[static_cast<std::size_t>(name)];
        if (other.valid && !other.doubtful && other.cost < clearly * solution.cost) solution = other;
    }
}

// Those that explain little, that relief hides some light from, or that are much darker than what is around
// them: as crevices, whose dark photographs are hidden, where that explains more. What explains nearly as
// much counts in the slope's error.
void RowFitter::fit_in_shade(const Band& band, int first, const RowTask& task,
                             std::vector<WardSolution>& solutions) {
    const Surface& surface = task.surface;
    const PixelKnowledge& known = task.known;
    constexpr auto poor = static_cast<float>(kPoorFit * kPoorFit);
    const int width = band.width();
    std::vector<std::vector<WardSolution>> tried(solutions.size());
    const auto in_doubt = [&](int name) {
        const int x = name % width, y = first + name / width;
        const WardSolution& solution = solutions[static_cast<std::size_t>(name)];
        if (!task.mask.empty() && !task.mask(x, y)) return false;
        const bool explained = solution.valid && solution.chi2 <= poor;
        return may_be_shaded(x, y, explained, shaded_[static_cast<std::size_t>(name)], known);
    };
    for (const Shade shade : {Shade::lit, Shade::around}) {
        std::vector<float> unexplained;
        const auto names = fit_again(band, solutions.size(), [&](int name) -> std::optional<Offer> {
            if (!in_doubt(name)) return {};
            const int x = name % width, y = first + name / width;
            PixelSamples& samples = white_samples_at(band, x, y, surface, known);
            const auto start = start_in_shade(shade, x, y, surface, known, samples);
            if (!start) return {};
            unexplained.push_back(static_cast<float>(hide_dark(*start, samples)));
            return Offer{&samples, known.prior ? known.prior(x, y) : prior_, *start};
        });
        for (std::size_t i = 0; i < names.size(); ++i) {
            tried[static_cast<std::size_t>(names[i])].push_back(
                again_.solutions()[static_cast<std::size_t>(names[i])]);
            tried[static_cast<std::size_t>(names[i])].back().cost += unexplained[i];
        }
    }
    for (std::size_t i = 0; i < solutions.size(); ++i)
        if (!tried[i].empty()) solutions[i] = best_of(solutions[i], tried[i]);
}

void RowFitter::judge(const Band& band, int x, int y, const RowTask& task, const WardSolution& solution,
                      WardEstimate& e) {
    const glm::ivec2 at = in_painting(task.surface, x, y), size = painting_size(task.surface);
    const bool compared = is_compared(at.x, at.y, size.x, size.y);
    if (!solution.doubtful && !compared) return;
    const WardEstimate other = by_ceres(band, x, y, task.surface, task.known);
    const double ratio =
        e.rms_residual * e.rms_residual / std::max(other.rms_residual * other.rms_residual, 1e-12);
    const auto tile = static_cast<std::size_t>(task.tile > 0 ? x / task.tile : 0);
    if (agreement_.size() <= tile) agreement_.resize(tile + 1);
    SolverAgreement& agreement = agreement_[tile];
    if (compared && e.valid && other.valid) {
        const bool agrees = std::abs(ratio - 1) <= 0.01;
        ++agreement.compared;
        agreement.cost_agrees += agrees;
        agreement.cheaper += !agrees && ratio < 1;
        agreement.slope_agrees += glm::length(e.slope - other.slope) <= 0.01;
    }
    if (!solution.doubtful) return;
    ++agreement.doubtful;
    // Not a number is not below anything.
    if (!other.valid || (e.valid && ratio <= 1)) return;
    ++agreement.polished;
    e = other;
}

void RowFitter::fit(const Band& band, int y0, int y1, const RowTask& task, const Done& done) {
    if (solver_ == Solver::ceres)
        fit_by_ceres(band, y0, y1, task, done);
    else
        fit_in_batches(band, y0, y1, task, done);
}

void RowFitter::fit_by_ceres(const Band& band, int y0, int y1, const RowTask& task, const Done& done) {
    const PixelKnowledge& known = task.known;
    for (int y = y0; y < y1; ++y) {
        for (int x = 0; x < band.width(); ++x) {
            if (!task.mask.empty() && !task.mask(x, y)) continue;
            const WardEstimate e = by_ceres(band, x, y, task.surface, known);
            if (e.valid) done(x, y, known.specular_colour ? coloured(e, known.specular_colour(x, y)) : e);
        }
        look_at_row(band, y, task.surface, known);
    }
}

void RowFitter::fit_in_batches(const Band& band, int y0, int y1, const RowTask& task, const Done& done) {
    const Surface& surface = task.surface;
    const PixelKnowledge& known = task.known;
    const int width = band.width(), rows = std::max(1, kPixelsAtOnce / width);
    for (int first = y0; first < y1; first += rows) {
        const int last = std::min(first + rows, y1);
        batches_.start((last - first) * width);
        shaded_.assign(static_cast<std::size_t>((last - first) * width), false);
        for (int y = first; y < last; ++y) start_row(band, y, (y - first) * width, task.mask, surface, known);
        batches_.finish();
        std::vector<WardSolution> solutions(batches_.solutions());
        if (highlights_) fit_by_highlight(band, first, surface, known, solutions);
        if (in_shade_ || known.occluded) fit_in_shade(band, first, task, solutions);
        hand_out(band, first, last, task, solutions, done);
        for (int y = first; y < last; ++y) look_at_row(band, y, surface, known);
    }
}

void RowFitter::hand_out(const Band& band, int y0, int y1, const RowTask& task,
                         const std::vector<WardSolution>& solutions, const Done& done) {
    const PixelKnowledge& known = task.known;
    for (int y = y0; y < y1; ++y)
        for (int x = 0; x < band.width(); ++x) {
            const WardSolution& solution = solutions[static_cast<std::size_t>((y - y0) * band.width() + x)];
            if (!solution.valid && !solution.doubtful) continue;
            WardEstimate e = solution.estimate(band.channels());
            if (known.stretch) e.stretch = known.stretch(x, y);
            if (task.judged) judge(band, x, y, task, solution, e);
            if (e.valid) done(x, y, known.specular_colour ? coloured(e, known.specular_colour(x, y)) : e);
        }
}

}  // namespace tangi
