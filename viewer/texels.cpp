#include "viewer/texels.h"

#include <algorithm>
#include <cmath>

#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

std::uint32_t code(float value, std::uint32_t largest) {
    const auto top = static_cast<float>(largest);
    // Not lround(), a call for each of millions.
    return static_cast<std::uint32_t>(std::clamp(value, 0.0f, 1.0f) * top + 0.5f);
}

float value(std::uint32_t code, std::uint32_t largest) {
    return static_cast<float>(code) / static_cast<float>(largest);
}

constexpr std::uint32_t kHeightCodes = (1u << 24) - 1;

}  // namespace

TexelRange range_of(const Surface& s, float paint_mm) {
    TexelRange range;
    float low = 0, high = 0;
    for (const float z : s.height_mm.pixels()) {
        low = std::min(low, z);
        high = std::max(high, z);
    }
    for (const Rgb& c : s.diffuse.pixels()) range.diffuse_max = std::max({range.diffuse_max, c.r, c.g, c.b});
    for (const float v : s.specular.pixels()) range.specular_max = std::max(range.specular_max, v);
    // A few wild pixels must not take the bits of all others.
    range.diffuse_max = std::min(range.diffuse_max, 16.0f);
    range.specular_max = std::min(range.specular_max, 16.0f);
    range.height_min_mm = low;
    range.height_max_mm = std::max(high, low + 1e-6f) + paint_mm;
    return range;
}

Texel pack(const Material& m, const TexelRange& r) {
    const Vec3 n = m.normal / (std::abs(m.normal.x) + std::abs(m.normal.y) + std::abs(m.normal.z));
    const auto root = [](float v) { return std::sqrt(std::max(v, 0.0f)); };
    const auto rho = [&](float v) { return root(v / r.diffuse_max); };
    const float alpha = (std::log2(std::max(m.roughness, 1e-6f)) + 14) / 20;
    const float height = (m.height_mm - r.height_min_mm) / (r.height_max_mm - r.height_min_mm);
    // Heights need all 24 bits: in double, since a float has no more.
    const auto z = static_cast<std::uint32_t>(
        std::clamp<double>(height, 0.0, 1.0) * static_cast<double>(kHeightCodes) + 0.5);
    return {code(0.5f + 0.5f * (n.x + n.y), 65535) | code(0.5f + 0.5f * (n.x - n.y), 65535) << 16,
            code(rho(m.diffuse.r), 2047) | code(rho(m.diffuse.g), 2047) << 11 |
                code(rho(m.diffuse.b), 1023) << 22,
            code(root(m.specular / r.specular_max), 65535) | code(alpha, 65535) << 16,
            code(m.confidence, 255) | z << 8};
}

Material unpack(const Texel& t, const TexelRange& r) {
    Material m;
    const float u = 2 * value(t[0] & 0xffffu, 65535) - 1, v = 2 * value(t[0] >> 16, 65535) - 1;
    const float x = 0.5f * (u + v), y = 0.5f * (u - v);
    m.normal = glm::normalize(Vec3(x, y, 1 - std::abs(x) - std::abs(y)));
    const Rgb root(value(t[1] & 0x7ffu, 2047), value((t[1] >> 11) & 0x7ffu, 2047), value(t[1] >> 22, 1023));
    m.diffuse = r.diffuse_max * root * root;
    const float gloss = value(t[2] & 0xffffu, 65535);
    m.specular = r.specular_max * gloss * gloss;
    m.roughness = std::exp2(20 * value(t[2] >> 16, 65535) - 14);
    m.height_mm = r.height_min_mm + (r.height_max_mm - r.height_min_mm) * value(t[3] >> 8, kHeightCodes);
    m.confidence = value(t[3] & 0xffu, 255);
    return m;
}

Material material_at(const Surface& s, int x, int y) {
    return {s.normal(x, y),    s.diffuse(x, y),   s.specular(x, y),
            s.roughness(x, y), s.height_mm(x, y), s.confidence(x, y)};
}

TexelTiles::TexelTiles(const Surface& s, const TexelRange& range, int tile_bits)
    : width_(s.width()), height_(s.height()), tile_bits_(tile_bits), range_(range) {
    TP_REQUIRE(tile_bits >= 0 && tile_bits <= 14, "tiles have a side");
    columns_ = (width_ + (1 << tile_bits) - 1) >> tile_bits;
    rows_ = (height_ + (1 << tile_bits) - 1) >> tile_bits;
    for (int level = 0; level <= tile_bits; ++level)
        tile_texels_ += std::size_t(1) << (2 * (tile_bits - level));
    texels_.resize(tile_texels_ * static_cast<std::size_t>(count()));
    update(s, {0, 0, width_, height_});
}

std::size_t TexelTiles::offset(int tile, int level) const {
    std::size_t at = static_cast<std::size_t>(tile) * tile_texels_;
    for (int l = 0; l < level; ++l) at += std::size_t(1) << (2 * (tile_bits_ - l));
    return at;
}

std::span<const Texel> TexelTiles::level(int tile, int level) const {
    return {&texels_[offset(tile, level)], std::size_t(1) << (2 * (tile_bits_ - level))};
}

const Texel& TexelTiles::at(int x, int y, int level) const {
    const int bits = tile_bits_ - level;
    const int tile = (y >> bits) * columns_ + (x >> bits), mask = (1 << bits) - 1;
    return texels_[offset(tile, level) + static_cast<std::size_t>(((y & mask) << bits) + (x & mask))];
}

Region TexelTiles::region_in(int tile, int level, const Region& region) const {
    const int x0 = (tile % columns_) << tile_bits_, y0 = (tile / columns_) << tile_bits_;
    const int side = 1 << tile_bits_, up = (1 << level) - 1;
    const auto inside = [&](int v, int origin) { return std::clamp(v - origin, 0, side); };
    const Region r = {inside(std::max(region.x0, 0), x0), inside(std::max(region.y0, 0), y0),
                      inside(std::min(region.x1, width_), x0), inside(std::min(region.y1, height_), y0)};
    return {r.x0 >> level, r.y0 >> level, (r.x1 + up) >> level, (r.y1 + up) >> level};
}

void TexelTiles::update(const Surface& s, const Region& region) {
    TP_REQUIRE(s.width() == width_ && s.height() == height_, "tiles are of this surface");
    parallel_for(0, count(), 1, [&](int begin, int end) {
        for (int tile = begin; tile < end; ++tile) {
            const int x0 = (tile % columns_) << tile_bits_, y0 = (tile / columns_) << tile_bits_;
            const Region r = region_in(tile, 0, region);
            if (r.empty()) continue;
            Texel* const texels = &texels_[offset(tile, 0)];
            for (int y = r.y0; y < r.y1; ++y)
                for (int x = r.x0; x < r.x1; ++x)
                    texels[(static_cast<std::size_t>(y) << tile_bits_) + static_cast<std::size_t>(x)] =
                        pack(material_at(s, x0 + x, y0 + y), range_);
            for (int level = 1; level <= tile_bits_; ++level)
                make_level(tile, level, region_in(tile, level, region));
        }
    });
}

void TexelTiles::make_level(int tile, int level, const Region& r) {
    const int below = level - 1, bits = tile_bits_ - below;
    const Texel* const source = &texels_[offset(tile, below)];
    Texel* const target = &texels_[offset(tile, level)];
    // Texels below that hold any pixel of the picture.
    const Region there = region_in(tile, below, {0, 0, width_, height_});
    for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) {
            Material mean{.normal = Vec3(0), .roughness = 0};
            float count = 0, gloss = 0, spread = 0, slope_x = 0, slope_y = 0;
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    const int sx = 2 * x + i, sy = 2 * y + j;
                    if (sx >= there.x1 || sy >= there.y1) continue;
                    const Material m =
                        unpack(source[(static_cast<std::size_t>(sy) << bits) + static_cast<std::size_t>(sx)],
                               range_);
                    const Slope slope = slope_of(m.normal);
                    const float weight = m.specular + 1e-6f;
                    mean.normal += m.normal;
                    mean.diffuse += m.diffuse;
                    mean.specular += m.specular;
                    mean.height_mm += m.height_mm;
                    mean.confidence += m.confidence;
                    gloss += weight;
                    slope_x += weight * slope.x;
                    slope_y += weight * slope.y;
                    spread += weight * (m.roughness * m.roughness + slope.x * slope.x + slope.y * slope.y);
                    ++count;
                }
            if (count == 0) continue;
            const float length = glm::length(mean.normal) / count;
            mean.normal = glm::normalize(mean.normal);
            mean.diffuse *= length / count;
            mean.specular /= count;
            mean.height_mm /= count;
            mean.confidence /= count;
            slope_x /= gloss;
            slope_y /= gloss;
            const float variance = spread / gloss - slope_x * slope_x - slope_y * slope_y;
            mean.roughness = std::sqrt(std::max(variance, 1e-12f));
            const int side_bits = tile_bits_ - level;
            target[(static_cast<std::size_t>(y) << side_bits) + static_cast<std::size_t>(x)] =
                pack(mean, range_);
        }
}

int tile_bits_for(int width, int height, int most, int max_bits) {
    const auto count = [&](int bits) {
        const auto along = [&](int length) {
            return (static_cast<long long>(length) + (1LL << bits) - 1) >> bits;
        };
        return along(width) * along(height);
    };
    int bits = std::min(7, max_bits);
    // Few large tiles for small pictures as well: levels of detail end at one texel a tile.
    while (bits < max_bits && (count(bits) > most || count(bits) > 64)) ++bits;
    if (count(bits) > most)
        fail(
            "a painting of {} x {} pixels is larger than this graphics driver can hold ({} tiles of {} "
            "pixels)",
            width, height, most, 1 << bits);
    return bits;
}

}  // namespace tangi
