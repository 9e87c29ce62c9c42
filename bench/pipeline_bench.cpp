// pipeline_bench.cpp: a whole fit against merely decoding its photographs: pipeline_bench PHOTOS [LIGHTS].
// Seconds by the clock and of the processor; the latter count where a machine is shared.
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <exception>

#include "fit/fit_painting.h"

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
    print("fit as users run it", timed([&] { last = fit_painting(stack).report; }), decoding);
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
