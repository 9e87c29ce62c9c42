#include "fit/pixel/ward_batch.h"

#include <algorithm>
#include <cmath>

#include "fit/pixel/specular_error.h"
#include "fit/pixel/ward_kernel.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

// Of 16 lanes, those that must still be moving for a step to be worth it; with fewer they wait for others.
constexpr int kFewest = 9;

}  // namespace

void WardBatch::resize(int photo_count, int channel_count, const WardPrior& prior) {
    TP_REQUIRE(photo_count >= 0 && (channel_count == 1 || channel_count == 3), "photographs are grey or RGB");
    photos = photo_count;
    channels = channel_count;
    const auto n = static_cast<std::size_t>(photo_count), m = n * static_cast<std::size_t>(channel_count);
    light.resize(n);
    ambient.resize(n);
    visible.resize(n);
    for (WardLane& part : visible) part.at.fill(1);
    irradiance.resize(m);
    value.resize(m);
    sigma.assign(m, WardLane());
    pixel.fill(-1);
    start_given.at.fill(0);
    for (int lane = 0; lane < kWardLanes; ++lane) set_prior(lane, prior);
    view[2].at.fill(1);
    for (auto& l : light) l[2].at.fill(1);
}

void WardBatch::set_prior(int lane, const WardPrior& prior) {
    prior_ln_alpha[lane] = static_cast<float>(prior.ln_alpha);
    prior_specular[lane] = static_cast<float>(prior.specular);
    prior_ln_alpha_sigma[lane] = static_cast<float>(prior.ln_alpha_sigma);
    prior_specular_sigma[lane] = static_cast<float>(prior.specular_sigma);
    shape[0][lane] = 1;
    shape[1][lane] = shape[2][lane] = 0;
    if (prior.stretch != glm::dvec2(0)) {
        const StretchShape<double> s = shape_of(prior.stretch.x, prior.stretch.y);
        shape[0][lane] = static_cast<float>(s.c);
        shape[1][lane] = static_cast<float>(s.a);
        shape[2][lane] = static_cast<float>(s.b);
    }
    for (int i = 0; i < 2; ++i) {
        const auto k = static_cast<std::size_t>(i);
        prior_slope[k][lane] = static_cast<float>(prior.slope[i]);
        prior_slope_weight[k][lane] = static_cast<float>(1 / (prior.slope_sigma[i] * prior.slope_sigma[i]));
    }
}

void WardBatch::set_start(int lane, const WardStart& given) {
    start_given[lane] = 1;
    for (int i = 0; i < 2; ++i) start[static_cast<std::size_t>(i)][lane] = static_cast<float>(given.slope[i]);
    for (int c = 0; c < 3; ++c)
        start[static_cast<std::size_t>(2 + c)][lane] = static_cast<float>(given.diffuse[c]);
}

void WardBatch::set(int lane, int name, const PixelSamples& s) {
    TP_REQUIRE(s.photos() == photos && s.channels == channels, "samples of this batch's photographs");
    pixel[static_cast<std::size_t>(lane)] = name;
    for (int i = 0; i < 3; ++i) view[static_cast<std::size_t>(i)][lane] = static_cast<float>(s.view[i]);
    for (std::size_t i = 0; i < light.size(); ++i) {
        for (int k = 0; k < 3; ++k)
            light[i][static_cast<std::size_t>(k)][lane] = static_cast<float>(s.light[i][k]);
        ambient[i][lane] = static_cast<float>(s.ambient[i]);
        visible[i][lane] = static_cast<float>(s.visible[i]);
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
        irradiance[i][lane] = static_cast<float>(s.irradiance[i]);
        value[i][lane] = static_cast<float>(s.value[i]);
        sigma[i][lane] = static_cast<float>(s.sigma[i]);
    }
}

void WardSlots::resize(int photo_count, int channel_count) {
    if (photos == photo_count && channels == channel_count && !light.empty()) return;
    photos = photo_count;
    channels = channel_count;
    light.resize(static_cast<std::size_t>(photo_count));
    weight.resize(light.size() * static_cast<std::size_t>(channel_count));
    target.resize(weight.size());
    pixel.fill(-1);
}

void WardSlots::copy_lanes(int to, const WardSlots& from, std::span<const int> lanes) {
    // Row by row, since a row is a line of the cache.
    const auto copy = [&](WardLane& target_row, const WardLane& source) {
        int k = to;
        for (const int lane : lanes) target_row[k++] = source[lane];
    };
    const auto copy_all = [&](auto& target_rows, const auto& source) {
        for (std::size_t i = 0; i < source.size(); ++i) copy(target_rows[i], source[i]);
    };
    copy_all(view, from.view);
    for (std::size_t i = 0; i < light.size(); ++i) copy_all(light[i], from.light[i]);
    copy_all(weight, from.weight);
    copy_all(target, from.target);
    copy_all(prior_slope, from.prior_slope);
    copy_all(prior_slope_weight, from.prior_slope_weight);
    copy_all(shape, from.shape);
    copy_all(theta, from.theta);
    copy_all(system, from.system);
    for (const auto member :
         {&WardSlots::prior_ln_alpha, &WardSlots::prior_specular, &WardSlots::prior_ln_alpha_weight,
          &WardSlots::prior_specular_weight, &WardSlots::damping, &WardSlots::damping_growth,
          &WardSlots::used, &WardSlots::iterations, &WardSlots::alive, &WardSlots::resumed, &WardSlots::valid,
          &WardSlots::converged})
        copy(this->*member, from.*member);
    for (const int lane : lanes)
        pixel[static_cast<std::size_t>(to++)] = from.pixel[static_cast<std::size_t>(lane)];
}

WardBatchFitter::WardBatchFitter(const WardFitOptions& options) : options_(options) {
    validate(options);
    TP_REQUIRE(options.bounds.alpha_max < 1, "ln alpha is negative");
}

void WardBatchFitter::start(int count) {
    solutions_.assign(static_cast<std::size_t>(count), WardSolution());
    waiting_count_ = 0;
}

void WardBatchFitter::deliver(const WardSlots& slots, int lane) {
    const int name = slots.pixel[static_cast<std::size_t>(lane)];
    if (name < 0) return;
    WardSolution& s = solutions_[static_cast<std::size_t>(name)];
    s.valid = slots.valid[lane] > 0;
    if (!s.valid) return;  // too dark, or too few samples: Ceres would not fit it either
    for (std::size_t i = 0; i < s.theta.size(); ++i) {
        const std::size_t last = static_cast<std::size_t>(kWardCommon + slots.channels) - 1;
        s.theta[i] = slots.theta[std::min(i, last)][lane];
    }
    const auto scale2 = static_cast<float>(options_.robust_scale * options_.robust_scale);
    s.cost = slots.cost[lane] * scale2;
    s.chi2 = s.cost / std::max(slots.used[lane] + 2 - static_cast<float>(kWardCommon + slots.channels), 1.0f);
    // Variances are in units of the robust scale, too; larger where residuals are larger than sigma says.
    const float inflation = std::max(s.chi2, 1.0f) / scale2;
    const auto error = [&](const WardLane& variance) {
        return std::sqrt(std::max(variance[lane] * inflation, 0.0f));
    };
    s.slope_error = error(slots.slope_variance);
    s.ln_alpha_error = error(slots.ln_alpha_variance);
    s.specular_error =
        static_cast<float>(specular_error(s.theta[3], s.theta[2],
                                          {.ln_alpha = slots.ln_alpha_variance[lane] * inflation,
                                           .specular = slots.specular_variance[lane] * inflation,
                                           .both = slots.lobe_covariance[lane] * inflation},
                                          options_.bounds));
    s.diffuse_error = error(slots.diffuse_variance);
    s.iterations = static_cast<int>(slots.iterations[lane]);
    s.converged = slots.converged[lane] > 0;
    const bool finite = std::isfinite(s.cost) && std::isfinite(s.theta[0]) && std::isfinite(s.theta[1]) &&
                        std::isfinite(s.slope_error);
    s.valid = std::isfinite(s.theta[0]) && std::isfinite(s.theta[1]) && std::isfinite(s.slope_error);
    const auto bound = static_cast<float>(options_.bounds.slope);
    s.doubtful = !s.converged || !finite || std::abs(s.theta[0]) >= bound || std::abs(s.theta[1]) >= bound;
}

std::vector<int> WardBatchFitter::deliver_finished(const WardSlots& slots) {
    std::vector<int> alive;
    for (int lane = 0; lane < kWardLanes; ++lane)
        if (slots.alive[lane] > 0)
            alive.push_back(lane);
        else
            deliver(slots, lane);
    return alive;
}

void WardBatchFitter::fit(const WardBatch& batch) {
    current_.resize(batch.photos, batch.channels);
    waiting_.resize(batch.photos, batch.channels);
    current_.pixel = batch.pixel;
    start_ward_batch(batch, options_, scratch_, current_);
    run_ward_slots(current_, options_, kFewest);
    const std::vector<int> alive = deliver_finished(current_);
    for (std::span<const int> left = alive; !left.empty();) {
        const std::size_t n = std::min(left.size(), static_cast<std::size_t>(kWardLanes - waiting_count_));
        waiting_.copy_lanes(waiting_count_, current_, left.first(n));
        waiting_count_ += static_cast<int>(n);
        left = left.subspan(n);
        if (waiting_count_ < kWardLanes) break;
        run_ward_slots(waiting_, options_, kFewest);
        const std::vector<int> still = deliver_finished(waiting_);
        waiting_.copy_lanes(0, waiting_, still);  // upwards: none is overwritten before it is read
        waiting_count_ = static_cast<int>(still.size());
    }
}

void WardBatchFitter::finish() {
    for (int lane = waiting_count_; lane < kWardLanes; ++lane) waiting_.alive[lane] = 0;
    if (waiting_count_ > 0) run_ward_slots(waiting_, options_, 1);
    for (int lane = 0; lane < waiting_count_; ++lane) deliver(waiting_, lane);
    waiting_count_ = 0;
}

WardEstimate WardSolution::estimate(int channels) const {
    WardEstimate e;
    e.valid = valid;
    if (!valid) return e;
    e.slope = {theta[0], theta[1]};
    e.roughness = std::exp(static_cast<double>(theta[2]));
    e.specular = theta[3];
    for (int c = 0; c < 3; ++c)
        e.diffuse[c] = theta[static_cast<std::size_t>(kWardCommon + (c < channels ? c : 0))];
    e.slope_error = slope_error;
    e.specular_error = specular_error;
    e.diffuse_error = diffuse_error;
    e.roughness_error = ln_alpha_error * e.roughness;
    e.rms_residual = std::sqrt(static_cast<double>(chi2));
    e.cost = cost;
    e.converged = converged;
    return e;
}

}  // namespace tangi
