// ward_batch.h: the Ward fit of many pixels at once, one pixel a lane of a vector register.
//
// The same start, priors, bounds, robust loss and errors as WardFitter (ward_fit.h), in floats. A lane's
// arithmetic never depends on the other lanes, so a pixel's result is the same bits whatever pixels it is
// fitted with, in whatever order and on however many threads.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "capture/stack/pixel_samples.h"
#include "fit/pixel/ward_fit.h"
#include "surface/base/vector_targets.h"

namespace tangi {

constexpr int kWardLanes = kVectorLanes;

// One number for each of 16 pixels.
struct alignas(64) WardLane {
    std::array<float, kWardLanes> at{};

    float& operator[](int lane) { return at[static_cast<std::size_t>(lane)]; }
    float operator[](int lane) const { return at[static_cast<std::size_t>(lane)]; }
    float* data() { return at.data(); }
    const float* data() const { return at.data(); }
};

// Samples of up to 16 pixels under the same lights; a lane that no pixel has is one whose sigmas are 0.
struct WardBatch {
    int photos = 0, channels = 3;
    std::array<WardLane, 3> view;                    // [unit vector] to the camera
    std::vector<std::array<WardLane, 3>> light;      // [photo] unit vector
    std::vector<WardLane> ambient, visible;          // [photo] as in PixelSamples
    std::vector<WardLane> irradiance, value, sigma;  // [photo * channels + channel] as in PixelSamples
    WardLane prior_ln_alpha, prior_specular;         // WardPrior's
    WardLane prior_ln_alpha_sigma, prior_specular_sigma;
    std::array<WardLane, 2> prior_slope, prior_slope_weight;  // weight: 1 / sigma^2
    std::array<WardLane, 3> shape;  // c, a, b of StretchShape of the prior's stretch
    WardLane start_given;           // 1 where a pixel starts at `start`, 0 where photometric stereo says
    std::array<WardLane, 5> start;  // slope x, y, rho_d of the channels
    std::array<int, kWardLanes>
        pixel{};  // the caller's name of the pixel, from 0; -1 where the lane is empty

    // Empties all lanes. Priors become `prior`.
    void resize(int photo_count, int channel_count, const WardPrior& prior);
    // Puts a pixel into an empty lane.
    void set(int lane, int name, const PixelSamples& samples);
    void set_prior(int lane, const WardPrior& prior);
    void set_start(int lane, const WardStart& start);
};

// Result of one lane. Natural parameters as in ward_residual.h.
struct WardSolution {
    std::array<float, kWardParameters> theta{};
    float slope_error = 0;     // [1] as in WardEstimate, like the next two
    float specular_error = 0;  // [1]
    float ln_alpha_error = 0;  // [1] of ln alpha
    float diffuse_error = 0;   // [1] as in WardEstimate
    float cost = 0;            // sum of the squares of the robust residuals, priors included
    float chi2 = 0;            // [1] cost per degree of freedom
    int iterations = 0;        // evaluations of residuals and derivatives
    bool valid = false;        // as in WardEstimate
    bool converged = false;
    bool doubtful = false;  // not converged, not a number, or a slope at its bound: for Ceres to look at

    WardEstimate estimate(int channels) const;
};

// What the iteration keeps of 16 pixels.
struct WardSlots {
    int photos = 0, channels = 3;
    std::array<WardLane, 3> view;
    std::vector<std::array<WardLane, 4>> light;  // [photo] direction, ambient
    std::vector<WardLane> weight, target;  // [photo * channels + channel] irradiance and value / (sigma * c)
    // Mean of both priors and 1 / (sigma * c)^2 of them, c the robust scale.
    WardLane prior_ln_alpha, prior_specular, prior_ln_alpha_weight, prior_specular_weight;
    std::array<WardLane, 2> prior_slope, prior_slope_weight;  // likewise
    std::array<WardLane, 3> shape;                            // as of WardBatch
    std::array<WardLane, kWardParameters> theta;
    WardLane damping, damping_growth, cost, used, iterations, alive;  // alive: 1 where not finished
    WardLane resumed;                                                 // 1 where `system` is that of theta
    std::array<WardLane, 33> system;  // cost, gradient and J^T J, as the kernel lays them out
    WardLane valid, converged, slope_variance, ln_alpha_variance, specular_variance, diffuse_variance;
    WardLane lobe_covariance;  // of ln alpha and rho_s
    std::array<int, kWardLanes> pixel{};

    void resize(int photo_count, int channel_count);
    // Lanes `to`, to + 1 … become these of `from`, which may be this where all of them are `to` or later.
    void copy_lanes(int to, const WardSlots& from, std::span<const int> lanes);
};

// Memory of photometric stereo and of the lobe's start.
struct WardScratch {
    std::vector<WardLane> lanes;
    std::vector<std::array<int, 2>> network;  // sorts `sorted` keys: pairs to compare and exchange
    int sorted = -1;
};

// Fits batches one after another and hands out solutions under the pixels' names. Lanes whose neighbours have
// converged wait and go on together, so that registers stay full. One a thread.
class WardBatchFitter {
public:
    // `solutions` of pixels 0 <= name < count can be read after finish().
    explicit WardBatchFitter(const WardFitOptions& options);

    void start(int count);
    void fit(const WardBatch& batch);
    void finish();
    const std::vector<WardSolution>& solutions() const { return solutions_; }

private:
    void deliver(const WardSlots& slots, int lane);
    std::vector<int> deliver_finished(const WardSlots& slots);  // returns the lanes that are not

    WardFitOptions options_;
    WardSlots current_, waiting_;
    int waiting_count_ = 0;
    WardScratch scratch_;
    std::vector<WardSolution> solutions_;
};

}  // namespace tangi
