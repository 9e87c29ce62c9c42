// height_bench PAINTING.exr: how long it takes to integrate the normals of a painting, as least squares and
// with cliffs, and how well it converges. All cores.
#include <fmt/core.h>

#include <chrono>
#include <ctime>
#include <exception>

#include "fit/height/height.h"
#include "surface/painting_file/painting_file.h"

int main(int argc, char** argv) try {
    if (argc != 2) {
        fmt::print(stderr, "Usage: height_bench PAINTING.exr\n");
        return 2;
    }
    const tangi::Surface surface = tangi::read_painting(argv[1]);
    fmt::print("{:.1f} megapixels\n{:>7} {:>7} {:>10} {:>9} {:>7} {:>11}\n",
               1e-6 * static_cast<double>(surface.height_mm.size()), "sweeps", "cycles", "residual",
               "converged", "s", "processor s");
    for (const int sweeps : {0, tangi::HeightOptions().robust_sweeps}) {
        tangi::HeightOptions options;
        options.robust_sweeps = sweeps;
        tangi::Image<float> height;
        const std::clock_t processor = std::clock();
        const auto clock = std::chrono::steady_clock::now();
        const tangi::HeightReport report =
            integrate_normals({surface.normal, surface.confidence, surface.mm_per_pixel}, height, options);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - clock;
        fmt::print("{:7} {:7} {:10.1e} {:>9} {:7.2f} {:11.2f}\n", report.robust_sweeps, report.cycles,
                   report.residual, report.converged, seconds.count(),
                   static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
        std::fflush(stdout);
    }
    return 0;
} catch (const std::exception& e) {
    fmt::print(stderr, "height_bench: {}\n", e.what());
    return 1;
}
