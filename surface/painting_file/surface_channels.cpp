#include "surface/painting_file/surface_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/parallel.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace {

constexpr float kSmallestRoughness = 1e-6f;  // [1] its square divides
constexpr std::uint64_t kHashOffset = 0xcbf29ce484222325u, kHashPrime = 0x100000001b3u;  // FNV-1a

bool is_specular_colour(const Rgb& c) {
    return std::min({c.r, c.g, c.b}) >= 0 && std::max({c.r, c.g, c.b}) <= 1;
}

// What a pixel must not hold where it was measured; empty where all is well.
std::string wrong_at(const Surface& s, std::span<const DryChannel> channels, std::size_t i) {
    for (const DryChannel& c : channels)
        if (const float value = c.base[i * c.stride]; !std::isfinite(value))
            return fmt::format("map '{}' holds {}", c.name, value);
    const float roughness = s.roughness.pixels()[i];
    if (!(roughness >= kSmallestRoughness))
        return fmt::format("map 'roughness' holds {}, less than {}", roughness, kSmallestRoughness);
    if (!s.specular_colour.empty()) {
        const Rgb& colour = s.specular_colour.pixels()[i];
        if (!is_specular_colour(colour))
            return fmt::format("map 'lobe' holds ({}, {}, {}), which is not from 0 to 1", colour.r, colour.g,
                               colour.b);
    }
    if (!s.lobe_axes.empty())
        if (const float across = s.lobe_axes.pixels()[i].roughness_v; !(across >= kSmallestRoughness))
            return fmt::format("map 'roughness.V' holds {}, less than {}", across, kSmallestRoughness);
    const Vec3& normal = s.normal.pixels()[i];
    if (!(normal.z > 0))
        return fmt::format("map 'normal' holds ({}, {}, {}), which points away", normal.x, normal.y,
                           normal.z);
    if (!(std::abs(glm::length(normal) - 1) <= 0.01f))
        return fmt::format("map 'normal' holds ({}, {}, {}), which is no unit vector", normal.x, normal.y,
                           normal.z);
    return {};
}

std::string said_at(const std::string& what, const Surface& s, int x, int y) {
    const PartOfPainting place = s.part_of.value_or(PartOfPainting{});
    return what.empty() ? what : fmt::format("{} at pixel ({}, {})", what, place.left + x, place.top + y);
}

// Other programs write zeros where nothing was measured: what surface.h promises of such pixels.
void clear_pixel(Surface& s, std::size_t i) {
    static const Surface unmeasured(1, 1);
    if (!std::isfinite(s.height_mm.pixels()[i])) s.height_mm.pixels()[i] = unmeasured.height_mm(0, 0);
    s.normal.pixels()[i] = unmeasured.normal(0, 0);
    s.diffuse.pixels()[i] = unmeasured.diffuse(0, 0);
    s.specular.pixels()[i] = unmeasured.specular(0, 0);
    s.roughness.pixels()[i] = unmeasured.roughness(0, 0);
    s.confidence.pixels()[i] = unmeasured.confidence(0, 0);
    if (!s.specular_colour.empty()) s.specular_colour.pixels()[i] = Rgb(1);
    if (!s.lobe_axes.empty()) s.lobe_axes.pixels()[i] = {unmeasured.roughness(0, 0), 0};
}

// Nothing to do about a pixel: numbers, and a unit vector to rounding. What is not told here may still be all
// right.
bool is_plain(const Surface& s, std::span<const DryChannel> channels, std::size_t i) {
    float none = 0;  // x - x is 0 unless x is infinite or no number
    for (const DryChannel& c : channels) {
        const float value = c.base[i * c.stride];
        none += value - value;
    }
    const float *normal = channels[1].base + 3 * i,
                length2 = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    if (!s.specular_colour.empty() && !is_specular_colour(s.specular_colour.pixels()[i])) return false;
    if (!s.lobe_axes.empty() && !(s.lobe_axes.pixels()[i].roughness_v >= kSmallestRoughness)) return false;
    return none == 0 && channels[8].base[i] >= kSmallestRoughness && normal[2] > 0 &&
           std::abs(length2 - 1) <= 1.5e-5f;
}

}  // namespace

std::vector<DryChannel> channels_of(Surface& s) {
    float* normal = &s.normal.data()->x;
    float* diffuse = &s.diffuse.data()->r;
    std::vector<DryChannel> channels = {{"height", s.height_mm.data(), 1},
                                        {"normal.X", normal, 3},
                                        {"normal.Y", normal + 1, 3},
                                        {"normal.Z", normal + 2, 3},
                                        {"diffuse.R", diffuse, 3},
                                        {"diffuse.G", diffuse + 1, 3},
                                        {"diffuse.B", diffuse + 2, 3},
                                        {"specular", s.specular.data(), 1},
                                        {"roughness", s.roughness.data(), 1},
                                        {"confidence", s.confidence.data(), 1}};
    if (!s.specular_colour.empty())
        for (std::size_t c = 0; c < kLobeChannels.size(); ++c)
            channels.push_back({kLobeChannels[c], &s.specular_colour.data()->r + c, 3});
    if (!s.lobe_axes.empty()) {
        channels.push_back({kAxesChannels[0], &s.lobe_axes.data()->roughness_v, 2});
        channels.push_back({kAxesChannels[1], &s.lobe_axes.data()->tangent, 2});
    }
    return channels;
}

void make_usable(Surface& s, int y0, int y1, std::vector<std::string>& wrong) {
    const auto channels = channels_of(s);
    for (int y = y0; y < y1; ++y)
        for (int x = 0; x < s.width(); ++x) {
            const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width()) +
                           static_cast<std::size_t>(x);
            if (is_plain(s, channels, i)) continue;
            const std::string what = wrong_at(s, channels, i);
            Vec3& normal = s.normal.pixels()[i];
            if (what.empty()) {
                // Half floats and resampling shorten normals; a float's rounding is no reason to touch
                // them.
                if (std::abs(glm::length(normal) - 1) > 1e-5f) normal = glm::normalize(normal);
            } else if (s.confidence.pixels()[i] <= 0) {
                clear_pixel(s, i);
            } else if (wrong[static_cast<std::size_t>(y)].empty()) {
                wrong[static_cast<std::size_t>(y)] = said_at(what, s, x, y);
            }
        }
}

std::string first_wrong(const Surface& s) {
    const auto channels = channels_of(const_cast<Surface&>(s));  // read only
    std::vector<std::string> wrong(static_cast<std::size_t>(s.height()));
    parallel_for(0, s.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width() && wrong[static_cast<std::size_t>(y)].empty(); ++x) {
                const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(s.width()) +
                               static_cast<std::size_t>(x);
                if (!is_plain(s, channels, i) && !(s.confidence.pixels()[i] <= 0))
                    wrong[static_cast<std::size_t>(y)] = said_at(wrong_at(s, channels, i), s, x, y);
            }
    });
    const auto found =
        std::find_if(wrong.begin(), wrong.end(), [](const auto& text) { return !text.empty(); });
    return found == wrong.end() ? std::string() : *found;
}

// Four rows at a time: each waits for its own products only.
void hash_rows(std::span<const DryChannel> channels, int width, int y0, int y1,
               std::span<std::uint64_t> hashes) {
    for (int y = y0; y < y1; y += 4) {
        std::array<std::uint64_t, 4> hash;
        hash.fill(kHashOffset);
        for (const DryChannel& c : channels) {
            std::array<const float*, 4> value;
            for (int k = 0; k < 4; ++k)
                value[static_cast<std::size_t>(k)] =
                    c.base + static_cast<std::size_t>(std::min(y + k, y1 - 1)) *
                                 static_cast<std::size_t>(width) * c.stride;
            for (std::size_t at = 0; at < static_cast<std::size_t>(width) * c.stride; at += c.stride)
                for (std::size_t k = 0; k < 4; ++k)
                    hash[k] = (hash[k] ^ std::bit_cast<std::uint32_t>(value[k][at])) * kHashPrime;
        }
        for (int k = 0; k < 4 && y + k < y1; ++k)
            hashes[static_cast<std::size_t>(y + k)] = hash[static_cast<std::size_t>(k)];
    }
}

std::string joined_hash(std::span<const std::uint64_t> rows) {
    std::uint64_t hash = kHashOffset;
    for (const std::uint64_t row : rows) hash = (hash ^ row) * kHashPrime;
    return fmt::format("{:016x}", hash);
}

void hash_all_rows(const Surface& s, std::span<std::uint64_t> hashes) {
    const auto channels = channels_of(const_cast<Surface&>(s));  // read only
    parallel_for(0, s.height(), 16,
                 [&](int begin, int end) { hash_rows(channels, s.width(), begin, end, hashes); });
}

std::string hash_of(const Surface& s) {
    std::vector<std::uint64_t> rows(static_cast<std::size_t>(s.height()));
    hash_all_rows(s, rows);
    return joined_hash(rows);
}

double kept_scale_mm(double mm_per_pixel) {
    return std::stod(fmt::format("{}", static_cast<float>(mm_per_pixel)));
}

}  // namespace tangi
