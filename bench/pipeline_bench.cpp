// pipeline_bench.cpp: a whole fit, stage by stage, against merely decoding its photographs:
// pipeline_bench PHOTOS [LIGHTS]. Seconds by the clock and of the processor; the latter count where a machine
// is shared. Memory is the most that the program has had so far.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <ctime>
#include <exception>
#include <mutex>
#include <string>

#include "fit/pipeline/fit_painting.h"

namespace {

using namespace tangi;

struct Seconds {
    double clock, processor;
};

template <class Work>
Seconds timed(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    work();
    const std::chrono::duration<double> clock = std::chrono::steady_clock::now() - start;
    return {clock.count(), static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC};
}

// Prints each stage of a fit once it has ended.
class Stages {
public:
    Progress progress() {
        return Progress([this](std::string_view stage, double) {
            const std::lock_guard lock(mutex_);
            if (stage == stage_) return true;
            end();
            stage_ = stage;
            return true;
        });
    }
    void end() {
        const std::chrono::duration<double> clock = std::chrono::steady_clock::now() - start_;
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        if (!stage_.empty())
            fmt::print("  {:<26} {:8.2f} s {:8.2f} s of the processor   {:6.1f} MB\n", stage_, clock.count(),
                       static_cast<double>(std::clock() - before_) / CLOCKS_PER_SEC,
                       static_cast<double>(usage.ru_maxrss) * 1024 / 1e6);
        stage_.clear();
        start_ = std::chrono::steady_clock::now();
        before_ = std::clock();
    }

private:
    std::mutex mutex_;
    std::string stage_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::clock_t before_ = std::clock();
};

void print(const char* what, const Seconds& t, const Seconds& decoding) {
    fmt::print("{:<28} {:8.2f} s {:8.2f} s of the processor   {:5.2f} x decoding\n", what, t.clock,
               t.processor, t.processor / decoding.processor);
}

void run(const char* folder, const char* lights) {
    StackOptions options;
    if (lights) options.lights_file = lights;
    const Stack stack = open_stack(folder, options);
    fmt::print("{} photographs of {} x {}\n", stack.photos.size(), stack.width(), stack.height());
    const Seconds decoding = timed([&] {
        StackReader reader(stack);
        const int rows = reader.rows_for(96u << 20);
        for (int y = 0; y < stack.height(); y += rows)
            reader.read(y, std::min(y + rows, stack.height()), Transfer{});
    });
    print("decoding", decoding, decoding);
    FitOptions fit;
    fit.register_photos = false;
    fit.lights_as_given = true;
    fit.refine = false;
    FitReport last;
    print("one pass, lights as given", timed([&] { last = fit_painting(stack, fit).report; }), decoding);
    fmt::print(
        "  {} of {} compared with Ceres agree in cost within 1 %; {} of {} pixels doubtful, {} polished\n",
        last.solvers.cost_agrees, last.solvers.compared, last.solvers.doubtful, last.fitted,
        last.solvers.polished);
    Stages stages;
    const Seconds whole = timed([&] {
        last = fit_painting(stack, {}, stages.progress()).report;
        stages.end();
    });
    print("fit as users run it", whole, decoding);
    fmt::print(
        "  {} of {} compared with Ceres agree in cost within 1 %; {} of {} pixels doubtful, {} polished\n",
        last.solvers.cost_agrees, last.solvers.compared, last.solvers.doubtful, last.fitted,
        last.solvers.polished);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        fmt::print(stderr, "pipeline_bench PHOTOS [LIGHTS]\n");
        return 2;
    }
    try {
        run(argv[1], argc > 2 ? argv[2] : nullptr);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
