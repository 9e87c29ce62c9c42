// bounds_bench.cpp: what bounds the prediction of held-out photographs, as a table: how much of the error is
// their lights, which no photograph tells, and how much is the surface.
//   bounds_bench PAINTING.exr STACK
// PAINTING was fitted from STACK with --hold-out. Each held-out photograph is relit with its light as
// predicted, with the strength that suits it best, and with strength and direction that suit it best. The
// latter two look at the photograph: they are bounds, no results.
#include <fmt/format.h>
#include <glog/logging.h>

#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "fit/evaluate/compare.h"
#include "surface/base/error.h"
#include "surface/image/metrics.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"

namespace tangi {
namespace {

using Change = std::array<double, 3>;  // of a light: ln gain, and turns about two axes across it [rad]

// Compass search (Hooke & Jeeves 1961) over the first `free` parameters: each evaluation is a whole picture,
// and there is nothing to differentiate.
Change best_change(const std::function<double(const Change&)>& psnr, int free) {
    Change at{}, step{0.1, 0.03, 0.03};
    double value = psnr(at);
    while (step[0] > 0.002) {
        bool better = false;
        for (int k = 0; k < 2 * free; ++k) {
            const auto parameter = static_cast<std::size_t>(k / 2);
            Change to = at;
            to[parameter] += k % 2 ? -step[parameter] : step[parameter];
            if (const double there = psnr(to); there > value) {
                value = there;
                at = to;
                better = true;
            }
        }
        if (!better)
            for (double& s : step) s /= 2;
    }
    return at;
}

Light changed(Light light, const Change& change) {
    const Vec3 to = light.direction;
    const Vec3 across = glm::normalize(glm::cross(std::abs(to.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0), to));
    light.gain *= static_cast<float>(std::exp(change[0]));
    light.direction = glm::normalize(to + static_cast<float>(change[1]) * across +
                                     static_cast<float>(change[2]) * glm::cross(to, across));
    if (light.position_mm) light.position_mm = glm::length(*light.position_mm) * light.direction;
    return light;
}

// A photograph as stored; pixels that it does not reach leave the mask.
Image<Rgb> read_photo(const Stack& one, PixelMask& mask) {
    StackReader reader(one);
    const Band band = reader.read(0, one.height(), Transfer{});
    Image<Rgb> picture(one.width(), one.height());
    for (int y = 0; y < one.height(); ++y)
        for (int x = 0; x < one.width(); ++x) {
            Rgb& value = picture(x, y);
            for (int c = 0; c < 3; ++c) value[c] = band.row(0, std::min(c, one.channels - 1), y)[x];
            if (!std::isnan(value.r + value.g + value.b)) continue;
            value = Rgb(0);
            mask(x, y) = 0;
        }
    return picture;
}

void run(const char* painting, const char* folder) {
    const Surface surface = read_painting(painting);
    const RelightingResidual residual = read_residual(painting, surface);
    const Stack stack = open_stack(folder);
    const bool modes[] = {false, true};
    std::array<double, 6> mean{};
    int count = 0;
    fmt::print(
        "| photograph | elevation | Ward | its best strength | and direction | faithful | its best strength |"
        " and direction |\n|---|---|---|---|---|---|---|---|\n");
    for (const StackPhoto& photo : stack.photos) {
        const Photography::Photo* known = find_photo(surface.photography, photo.light);
        if (!known || known->fitted) continue;
        Stack one = stack;
        one.photos = {photo};
        one.photos.front().homography = known->homography;
        PixelMask mask = measured(surface.confidence);
        const Image<Rgb> taken = read_photo(one, mask);
        const Light light = as_photographed(photo.light, surface.photography);
        fmt::print("| {} | {:.0f}° ", photo.light.name,
                   std::asin(static_cast<double>(photo.light.direction.z)) * 180 / M_PI);
        std::size_t column = 0;
        for (const bool with_residual : modes) {
            const auto psnr = [&](const Change& change) {
                const Light other = changed(light, change);
                Image<Rgb> relit = relight(surface, {&other, 1}, {.cast_shadows = true});
                if (with_residual && !residual.empty())
                    add_residual(residual, surface, {&other, 1}, {}, relit);
                return psnr_db(taken, as_photographed(relit, surface.photography), mask);
            };
            for (const double db : {psnr({}), psnr(best_change(psnr, 1)), psnr(best_change(psnr, 3))}) {
                fmt::print("| {:.2f} ", db);
                mean[column++] += db;
            }
        }
        fmt::print("|\n");
        std::fflush(stdout);
        ++count;
    }
    if (count == 0) fail("{}: all photographs of {} were fitted; hold some out", painting, folder);
    fmt::print("| mean | ");
    for (const double sum : mean) fmt::print("| {:.2f} ", sum / count);
    fmt::print("|\n");
}

}  // namespace
}  // namespace tangi

int main(int count, char** arguments) {
    google::InitGoogleLogging(arguments[0]);
    FLAGS_minloglevel = 3;
    try {
        if (count != 3) tangi::fail("give a painting and the folder of its photographs");
        tangi::run(arguments[1], arguments[2]);
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "bounds_bench: {}\n", error.what());
        return 1;
    }
}
