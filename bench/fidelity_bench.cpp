// fidelity_bench.cpp: how well held-out photographs are predicted: PTM and HSH by least squares a channel in
// floats, the Ward fit, and the Ward fit in the relighting residual, as a table.
//   fidelity_bench [--hold-out WHICH] STACK[=TEST]...
// Of a STACK alone, the photographs WHICH (default 4:8: 4, 12, 20, …) are held out; with =TEST all of STACK
// are fitted, and those of the folder TEST predicted.
#include <fmt/format.h>
#include <glog/logging.h>

#include <chrono>
#include <cstdio>

#include "fit/evaluate/compare.h"
#include "fit/exchange/ptm_hsh.h"
#include "fit/pipeline/fit_painting.h"
#include "fit/residual/residual_fit.h"
#include "surface/base/error.h"
#include "surface/image/metrics.h"
#include "surface/image_file/image_io.h"

namespace tangi {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// [dB] mean over the photographs, all pixels, values as stored.
double psnr_of(const RtiImage& image, const std::vector<StackPhoto>& photos) {
    double sum = 0;
    for (const StackPhoto& photo : photos)
        sum += psnr_db(read_picture(photo.path), evaluate(image, photo.light.direction));
    return sum / static_cast<double>(photos.size());
}

void print_row(const std::string& argument, const std::string& which) {
    const std::size_t split = argument.find('=');
    Stack stack = open_stack(argument.substr(0, split)), test = stack;
    if (split == std::string::npos) {
        hold_out(stack, which);
        test = stack;
        test.photos = stack.held_out;
        test.held_out.clear();
    } else {
        test = open_stack(argument.substr(split + 1));
    }
    // Files of floats are linear light, and what RTI viewers show is not.
    const bool comparable = test.bits != 32;
    const auto rti = [&](RtiBasis basis) {
        const std::string none = "–";
        if (!comparable) return none;
        try {
            return fmt::format("{:.2f}", psnr_of(fit_rti(stack, basis), test.photos));
        } catch (const Error& error) {  // too few lights, or all at one height
            fmt::print(stderr, "{}\n", error.what());
            return none;
        }
    };
    const std::string ptm = rti(RtiBasis::ptm), hsh = rti(RtiBasis::hsh9);
    Clock::time_point start = Clock::now();
    const FitResult fit = fit_painting(stack);
    const double fit_s = seconds_since(start);
    start = Clock::now();
    const ResidualFit residual = fit_residual(fit.surface, stack);
    const double residual_s = seconds_since(start);
    const CompareReport report = compare(fit.surface, test, {}, {}, {}, residual.residual);
    const double ward = report.all.psnr_db;
    std::printf("| %s | %s | %s | %.2f | %.2f | %d | %.0f | %.0f |\n", argument.c_str(), ptm.c_str(),
                hsh.c_str(), ward, report.all.residual_psnr_db.value_or(ward),
                residual.report.terms + 2 * residual.report.colour_terms, fit_s, residual_s);
    std::fflush(stdout);
}

int run(int count, char** arguments) {
    std::string which = "4:8";
    std::puts("| stack | PTM 6 | HSH 9 | Ward | faithful | its coefficients | fit s | faithful s |");
    std::puts("|---|---|---|---|---|---|---|---|");
    for (int i = 1; i < count; ++i) {
        const std::string argument = arguments[i];
        if (argument == "--hold-out" && i + 1 < count) {
            which = arguments[++i];
            continue;
        }
        print_row(argument, which);
    }
    return 0;
}

}  // namespace
}  // namespace tangi

int main(int count, char** arguments) {
    google::InitGoogleLogging(arguments[0]);
    FLAGS_minloglevel = 3;
    try {
        return tangi::run(count, arguments);
    } catch (const std::exception& error) {
        fmt::print(stderr, "fidelity_bench: {}\n", error.what());
        return 1;
    }
}
