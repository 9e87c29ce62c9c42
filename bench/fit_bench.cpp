// fit_bench.cpp: how long a pixel takes in batches, in WardFitter and in Ceres' other solvers on the same
// residuals, and how long height integration takes. One thread for the pixels but where it says two, all for
// the height.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numbers>

#include "datasets/generator.h"
#include "fit/height/height.h"
#include "fit/pixel/ward_batch.h"
#include "fit/pixel/ward_fit.h"
#include "fit/pixel/ward_kernel.h"
#include "surface/base/instruction_sets.h"
#include "surface/base/parallel.h"
#include "surface/reflectance/ward.h"
#include "tests/support/fit/ward_samples.h"

namespace tangi {
namespace {

// WardFitter as the bench runs it: the model's error is in sigma already, so that all solvers see the same
// samples.
WardFitOptions options() {
    WardFitOptions o;
    o.model_error = 0;
    return o;
}

struct Pixel {
    PixelSamples samples;
    WardVector start;  // unbounded parameters
};

double cost_of(const PixelSamples& s, const WardVector& theta) { return robust_cost(s, options(), theta); }

// 64 pixels of a generated painting, started as WardFitter starts.
const std::vector<Pixel>& pixels() {
    static const std::vector<Pixel> all = [] {
        std::vector<Pixel> result;
        for (PixelSamples& samples : generated_pixels(64, 3)) {
            const WardVector start = unbounded_of(start_of(samples, options()), options().bounds);
            result.push_back({std::move(samples), start});
        }
        return result;
    }();
    return all;
}

// The residuals of WardResiduals for automatic derivatives, in unbounded parameters.
class AutoResiduals {
public:
    using Scalar = double;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kWardParameters };

    explicit AutoResiduals(const PixelSamples& s) : s_(s), options_(options()) {}
    int NumResiduals() const { return static_cast<int>(s_.value.size()) + 2; }

    template <class T>
    bool operator()(const T* u, T* r) const {
        using std::exp;
        using std::log1p;
        using std::sin;
        using std::sqrt;
        T theta[kWardParameters];
        for (int i = 0; i < kWardParameters; ++i) {
            const auto [low, high] = ward_interval(options_.bounds, i);
            theta[i] = low + (high - low) / 2 * (T(1) + sin(u[i]));
        }
        const T inverse = T(1) / sqrt(T(1) + theta[0] * theta[0] + theta[1] * theta[1]);
        const T alpha = exp(theta[2]);
        const double c2 = options_.robust_scale * options_.robust_scale;
        std::size_t at = 0;
        for (const glm::dvec3& l : s_.light) {
            const T n_l = (l.z - theta[0] * l.x - theta[1] * l.y) * inverse;
            const WardAngles<T> angles{n_l, inverse, n_l + inverse, T(2 + 2 * l.z)};
            const bool lit = n_l > T(0);
            const T lobe =
                lit ? T(std::numbers::pi) * theta[3] * n_l * ward_lobe(WardModel::bounded, angles, alpha)
                    : T(0);
            for (int c = 0; c < 3; ++c, ++at) {
                r[at] = T(0);
                if (!(s_.sigma[at] > 0)) continue;
                const T diffuse = lit ? theta[kWardCommon + c] * n_l : T(0);
                const T plain = (s_.irradiance[at] * (diffuse + lobe) - s_.value[at]) / s_.sigma[at];
                const T s = plain * plain / c2;
                if (s < T(1e-8)) {
                    r[at] = plain;
                } else {
                    const T root = options_.robust_scale * sqrt(log(T(1) + s));
                    r[at] = plain < T(0) ? -root : root;
                }
            }
        }
        r[at] = (theta[2] - options_.prior.ln_alpha) / options_.prior.ln_alpha_sigma;
        r[at + 1] = (theta[3] - options_.prior.specular) / options_.prior.specular_sigma;
        return true;
    }

private:
    const PixelSamples& s_;
    WardFitOptions options_;
};

// The same with analytic derivatives, as WardFitter has them.
class AnalyticResiduals {
public:
    using Scalar = double;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kWardParameters };

    explicit AnalyticResiduals(const PixelSamples& s)
        : options_(options()), residuals_(s, options_.prior, options_.robust_scale) {}
    int NumResiduals() const { return residuals_.size(); }
    bool operator()(const double* u, double* r, double* jacobian) const {
        double derivative[kWardParameters];
        const WardVector theta = natural_of(u, options_.bounds, derivative);
        residuals_.evaluate(theta.data(), r, jacobian);
        if (jacobian)
            for (int column = 0; column < kWardParameters; ++column)
                for (int row = 0; row < residuals_.size(); ++row)
                    jacobian[column * residuals_.size() + row] *= derivative[column];
        return true;
    }

private:
    WardFitOptions options_;
    WardResiduals residuals_;
};

// Stops all solvers at about the same accuracy: costs are around 100, so 1e-5 of them is what TinySolver's
// absolute 1e-3 is.
template <class Solver>
void set_tiny_options(Solver& solver) {
    solver.options.max_num_iterations = options().max_iterations;
    solver.options.parameter_tolerance = 1e-5;
    solver.options.function_tolerance = 1e-3;
    solver.options.gradient_tolerance = 1e-8;
    solver.options.initial_trust_region_radius = 1e3;
}

using Parameters = Eigen::Matrix<double, kWardParameters, 1>;

// Runs `solve` (pixel to natural parameters) over the pixels, one an iteration; counts the mean cost at the
// end.
template <class Solve>
void run(benchmark::State& state, Solve&& solve) {
    const std::vector<Pixel>& all = pixels();
    double cost = 0;
    for (const Pixel& pixel : all)
        cost += cost_of(pixel.samples, solve(pixel)) / static_cast<double>(all.size());
    std::size_t k = 0;
    for (auto _ : state) benchmark::DoNotOptimize(solve(all[k++ % all.size()]));
    state.counters["cost"] = cost;
}

void ceres_problem_autodiff(benchmark::State& state) {
    run(state, [](const Pixel& pixel) {
        WardVector u = pixel.start;
        ceres::Problem problem;
        auto* cost = new ceres::AutoDiffCostFunction<AutoResiduals, ceres::DYNAMIC, kWardParameters>(
            new AutoResiduals(pixel.samples), static_cast<int>(pixel.samples.value.size()) + 2);
        problem.AddResidualBlock(cost, nullptr, u.data());
        ceres::Solver::Options o;
        o.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
        o.max_num_iterations = options().max_iterations;
        o.function_tolerance = 1e-5;
        o.parameter_tolerance = 1e-5;
        o.initial_trust_region_radius = 1e3;
        o.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(o, &problem, &summary);
        return natural_of(u.data(), options().bounds, nullptr);
    });
}

void tiny_solver_autodiff(benchmark::State& state) {
    using Function = ceres::TinySolverAutoDiffFunction<AutoResiduals, Eigen::Dynamic, kWardParameters>;
    ceres::TinySolver<Function> solver;
    set_tiny_options(solver);
    run(state, [&](const Pixel& pixel) {
        const AutoResiduals residuals(pixel.samples);
        Parameters u(pixel.start.data());
        solver.Solve(Function(residuals), &u);
        return natural_of(u.data(), options().bounds, nullptr);
    });
}

void tiny_solver_analytic(benchmark::State& state) {
    ceres::TinySolver<AnalyticResiduals> solver;
    set_tiny_options(solver);
    run(state, [&](const Pixel& pixel) {
        Parameters u(pixel.start.data());
        solver.Solve(AnalyticResiduals(pixel.samples), &u);
        return natural_of(u.data(), options().bounds, nullptr);
    });
}

void ward_fitter(benchmark::State& state) {
    WardFitter fitter(options());
    run(state, [&](const Pixel& pixel) {
        const WardEstimate e = fitter.fit(pixel.samples);
        return WardVector{e.slope.x,    e.slope.y,    std::log(e.roughness), e.specular,
                          e.diffuse[0], e.diffuse[1], e.diffuse[2]};
    });
}

void photometric_stereo_alone(benchmark::State& state) {
    run(state, [](const Pixel& pixel) {
        const LambertEstimate e = photometric_stereo(pixel.samples, kWardStereo);
        return WardVector{-e.normal.x / e.normal.z,
                          -e.normal.y / e.normal.z,
                          0,
                          0,
                          e.diffuse[0],
                          e.diffuse[1],
                          e.diffuse[2]};
    });
}

// Batches of the same pixels again and again, in another order each time, as many as a few rows of a picture
// have.
constexpr int kRounds = 32;
int batch_pixel(int k) {
    const int count = static_cast<int>(pixels().size());
    return (k * 5 + k / count * 3) % count;
}
const std::vector<WardBatch>& batches() {
    static const std::vector<WardBatch> all = [] {
        const std::vector<Pixel>& some = pixels();
        const int count = static_cast<int>(some.size());
        std::vector<WardBatch> result(static_cast<std::size_t>(kRounds * count / kWardLanes));
        for (int k = 0; k < kRounds * count; ++k) {
            WardBatch& batch = result[static_cast<std::size_t>(k / kWardLanes)];
            const PixelSamples& s = some[static_cast<std::size_t>(batch_pixel(k))].samples;
            if (k % kWardLanes == 0) batch.resize(s.photos(), s.channels, options().prior);
            batch.set(k % kWardLanes, k, s);
        }
        return result;
    }();
    return all;
}

void fit_batches(WardBatchFitter& fitter) {
    fitter.start(static_cast<int>(batches().size()) * kWardLanes);
    for (const WardBatch& batch : batches()) fitter.fit(batch);
    fitter.finish();
    benchmark::DoNotOptimize(fitter.solutions().data());
}

// Mean cost at the end, in doubles as that of the others, and evaluations a pixel.
void report_batches(benchmark::State& state, const WardBatchFitter& fitter) {
    const int count = static_cast<int>(pixels().size());
    double cost = 0, evaluations = 0;
    for (int k = 0; k < count; ++k) {
        const WardSolution& s = fitter.solutions()[static_cast<std::size_t>(k)];
        const WardVector theta = {s.theta[0], s.theta[1], s.theta[2], s.theta[3],
                                  s.theta[4], s.theta[5], s.theta[6]};
        cost += cost_of(pixels()[static_cast<std::size_t>(batch_pixel(k))].samples, theta) / count;
        evaluations += (1.0 + s.iterations) / count;
    }
    state.counters["cost"] = cost;
    state.counters["evaluations"] = evaluations;
}

// Start, errors and all; an iteration is a pixel.
void ward_batches(benchmark::State& state, const std::string& set) {
    use_instruction_set(set);
    WardBatchFitter fitter(options());
    const int count = static_cast<int>(batches().size()) * kWardLanes;
    while (state.KeepRunningBatch(count)) fit_batches(fitter);
    report_batches(state, fitter);
    use_instruction_set("");
}

// Both threads fit all batches; an iteration is a pixel. By the clock: on two idle cores it takes half of
// what one thread does.
void ward_batches_2_threads(benchmark::State& state) {
    WardBatchFitter fitters[2] = {WardBatchFitter(options()), WardBatchFitter(options())};
    const int count = static_cast<int>(batches().size()) * kWardLanes;
    set_thread_count(2);
    while (state.KeepRunningBatch(2 * count))
        parallel_for(0, 2, 1, [&](int begin, int end) {
            for (int k = begin; k < end; ++k) fit_batches(fitters[k]);
        });
    set_thread_count(0);
}

// Only what comes before the first step.
void ward_batches_start(benchmark::State& state) {
    WardScratch scratch;
    WardSlots slots;
    slots.resize(batches()[0].photos, batches()[0].channels);
    const int count = static_cast<int>(batches().size()) * kWardLanes;
    while (state.KeepRunningBatch(count))
        for (const WardBatch& batch : batches()) start_ward_batch(batch, options(), scratch, slots);
}

BENCHMARK(ceres_problem_autodiff)->Unit(benchmark::kMicrosecond);
BENCHMARK(tiny_solver_autodiff)->Unit(benchmark::kMicrosecond);
BENCHMARK(tiny_solver_analytic)->Unit(benchmark::kMicrosecond);
BENCHMARK(ward_fitter)->Unit(benchmark::kMicrosecond);
BENCHMARK(photometric_stereo_alone)->Unit(benchmark::kMicrosecond);
BENCHMARK(ward_batches_start)->Unit(benchmark::kMicrosecond);
BENCHMARK(ward_batches_2_threads)->Unit(benchmark::kMicrosecond)->UseRealTime();

// Relief of 12 pixels' wavelength on a bulge over the whole picture, heights in pixels.
void height(benchmark::State& state) {
    const int w = static_cast<int>(state.range(0)), h = static_cast<int>(state.range(1));
    constexpr double k = 2 * std::numbers::pi / 12, amplitude = 0.5;
    const double bulge = 0.05 / w;
    Image<Vec3> normal(w, h);
    Image<float> confidence(w, h, 1.0f), truth(w, h);
    double truth_mean = 0;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const double u = x - (w - 1) / 2.0, v = (h - 1) / 2.0 - y;
            const double z = amplitude * std::sin(k * u) * std::cos(0.6 * k * v) - bulge * (u * u + v * v);
            const double p = amplitude * k * std::cos(k * u) * std::cos(0.6 * k * v) - 2 * bulge * u;
            const double q = -amplitude * 0.6 * k * std::sin(k * u) * std::sin(0.6 * k * v) - 2 * bulge * v;
            normal(x, y) = normal_of({static_cast<float>(p), static_cast<float>(q)});
            truth(x, y) = static_cast<float>(z);
            truth_mean += z / (static_cast<double>(w) * h);
        }
    Image<float> z;
    HeightReport report;
    for (auto _ : state) report = integrate_normals({normal, confidence, 1}, z);
    double square = 0;
    for (std::size_t i = 0; i < z.size(); ++i)
        square +=
            std::pow(z.pixels()[i] - (truth.pixels()[i] - truth_mean), 2) / static_cast<double>(z.size());
    state.counters["rms_px"] = std::sqrt(square);
    state.counters["cycles"] = report.cycles;
    state.counters["MP"] = 1e-6 * w * h;
}

BENCHMARK(height)->Args({1150, 870})->Args({3060, 2290})->Unit(benchmark::kMillisecond)->UseRealTime();

// The usual table, and how the solvers compare.
class RatioReporter : public benchmark::ConsoleReporter {
public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& r : runs)
            if (!r.error_occurred) time_[r.benchmark_name()] = r.GetAdjustedCPUTime();
    }
    void print_ratios() const {
        const auto ratio = [&](const char* what, const char* to) {
            const auto a = time_.find(what), b = time_.find(to);
            if (a != time_.end() && b != time_.end())
                std::printf("ratio %s / %s = %.2f\n", what, to, a->second / b->second);
        };
        const std::string best = "ward_batches/" + instruction_sets().front();
        for (const char* what :
             {"ceres_problem_autodiff", "tiny_solver_autodiff", "tiny_solver_analytic", "ward_fitter"})
            ratio(what, best.c_str());
    }

private:
    std::map<std::string, double> time_;
};

}  // namespace
}  // namespace tangi

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    for (const std::string& set : tangi::instruction_sets())
        benchmark::RegisterBenchmark(("ward_batches/" + set).c_str(), tangi::ward_batches, set)
            ->Unit(benchmark::kMicrosecond);
    tangi::RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.print_ratios();
    return 0;
}
