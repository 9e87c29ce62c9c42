#include "paint/substrate/picture_substrate.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/common.hpp>

#include "paint/substrate/substrate.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/math/portable_math.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;

Image<float> lightness_of(const Image<Rgb>& linear) {
    Image<float> result(linear.width(), linear.height());
    for (std::size_t i = 0; i < result.size(); ++i) {
        const float y = std::clamp(luminance(linear.pixels()[i]), 0.0f, 1.0f);
        // CIE 15: L* / 100.
        result.pixels()[i] = y > 216.0f / 24389 ? 1.16f * portable::cbrt(y) - 0.16f : 24389.0f / 2700 * y;
    }
    return result;
}

Surface substrate_of_picture(const Image<Rgb>& linear, const Image<float>& relief,
                             const PictureSubstrateOptions& options) {
    validate(options);
    const int least = std::min(linear.width(), linear.height()),
              most = std::max(linear.width(), linear.height());
    if (least < 8 || most > 65536)
        fail("a picture of {} x {} pixels is no support: 8 to 65536 a side", linear.width(), linear.height());
    if (!relief.empty() && relief.region() != linear.region())
        fail("the relief is {} x {} pixels, but the picture is {} x {}; give a relief of its size",
             relief.width(), relief.height(), linear.width(), linear.height());
    Surface surface(linear.width(), linear.height());
    surface.mm_per_pixel = kept_scale_mm(options.pixel_mm);
    surface.scale_known = options.pixel_known;
    for (std::size_t i = 0; i < linear.size(); ++i) {
        const Rgb c = linear.pixels()[i];
        if (!std::isfinite(c.r) || !std::isfinite(c.g) || !std::isfinite(c.b))
            fail("the picture holds a colour that is not finite, at pixel {}", i);
        surface.diffuse.pixels()[i] = glm::clamp(c, 0.0f, 1.0f);
    }
    std::ranges::fill(surface.specular.pixels(), static_cast<float>(options.specular));
    std::ranges::fill(surface.roughness.pixels(), static_cast<float>(options.roughness));
    std::ranges::fill(surface.confidence.pixels(), 1.0f);
    if (relief.empty()) return surface;

    std::vector<float> sorted(relief.pixels().begin(), relief.pixels().end());
    double mean = 0;
    for (const float h : sorted) {
        if (!std::isfinite(h)) fail("the relief holds a number that is not finite");
        mean += h / static_cast<double>(sorted.size());
    }
    const auto quantile = [&](double part) {
        const auto at =
            sorted.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(sorted.size() - 1));
        std::nth_element(sorted.begin(), at, sorted.end());
        return *at;
    };
    const float low = quantile(0.001), high = quantile(0.999);
    if (!(high > low)) return surface;
    const auto per_unit = static_cast<float>(options.relief_mm / (high - low));
    for (std::size_t i = 0; i < relief.size(); ++i)
        surface.height_mm.pixels()[i] = (relief.pixels()[i] - static_cast<float>(mean)) * per_unit;
    surface.normal = normals_of(surface.height_mm, surface.mm_per_pixel);
    return surface;
}

fs::path substrate_shelf() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return fs::path(value ? value : "");
    };
    const fs::path data = variable("XDG_DATA_HOME"), home = variable("HOME");
    if (data.is_absolute()) return data / "tangipaint/substrates";
    if (!home.is_absolute()) fail("HOME names no folder: where supports are kept is not known");
    return home / ".local/share/tangipaint/substrates";
}

std::vector<std::string> kept_substrates(const fs::path& shelf) {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(shelf, none))
        if (entry.path().extension() == ".exr" && entry.path().filename().string()[0] != '.')
            names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

fs::path kept_substrate(const fs::path& shelf, const std::string& name) {
    const bool plain =
        !name.empty() && name.size() <= 100 && name[0] != '.' &&
        std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == '/'; });
    if (!plain) fail("'{}' can't be the name of a substrate: no '/', and no '.' in front", name);
    if (substrate_named(name)) fail("'{}' is a substrate that the program makes; choose another name", name);
    return shelf / (name + ".exr");
}

void keep_substrate(const fs::path& shelf, const std::string& name, const Surface& surface) {
    const fs::path path = kept_substrate(shelf, name);
    if (fs::exists(path))
        fail("{}: there is a substrate '{}' already; choose another name", path.string(), name);
    make_folder(shelf);
    write_painting(path, surface);
}

}  // namespace tangi
