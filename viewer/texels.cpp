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

// Bits of a field, from `shift` on.
struct Field {
    int shift;
    std::uint32_t largest;
    std::uint32_t of(float v) const { return code(v, largest) << shift; }
    float in(std::uint32_t word) const { return value(word >> shift & largest, largest); }
};

// Of the words z and w.
struct GlossLayout {
    Field specular, alpha, confidence, height;
};
constexpr GlossLayout kWhiteLobes{{0, 65535}, {16, 65535}, {0, 255}, {8, (1u << 24) - 1}};
constexpr GlossLayout kColouredLobes{{0, 4095}, {12, 8191}, {0, 63}, {15, (1u << 17) - 1}};
constexpr Field kColourAfter{25, 127}, kColourBefore{8, 127};
constexpr int kLargestShift = 6;
const GlossLayout& layout_of(const TexelRange& r) { return r.coloured_lobes ? kColouredLobes : kWhiteLobes; }

// What a texel of the next level has of those below.
class MeanMaterial {
public:
    void add(const Material& m) {
        const Slope slope = slope_of(m.normal);
        const float weight = m.specular + 1e-6f;
        sum_.normal += m.normal;
        sum_.diffuse += m.diffuse;
        sum_.specular += m.specular;
        lobe_colour_ += weight * m.lobe_colour;
        sum_.height_mm += m.height_mm;
        sum_.confidence += m.confidence;
        gloss_ += weight;
        slope_x_ += weight * slope.x;
        slope_y_ += weight * slope.y;
        spread_ += weight * (m.roughness * m.roughness + slope.x * slope.x + slope.y * slope.y);
        ++count_;
    }
    Material material() const {
        const float length = glm::length(sum_.normal) / count_;
        const float x = slope_x_ / gloss_, y = slope_y_ / gloss_;
        const float variance = spread_ / gloss_ - x * x - y * y;
        return {glm::normalize(sum_.normal), sum_.diffuse * (length / count_),
                sum_.specular / count_,      std::sqrt(std::max(variance, 1e-12f)),
                sum_.height_mm / count_,     sum_.confidence / count_,
                lobe_colour_ / gloss_};
    }

private:
    Material sum_{.normal = Vec3(0)};
    Rgb lobe_colour_{0};
    float count_ = 0, gloss_ = 0, spread_ = 0, slope_x_ = 0, slope_y_ = 0;
};

}  // namespace

TexelRange range_of(const Surface& s, float paint_mm) {
    std::vector<TexelRange> rows(static_cast<std::size_t>(s.height()));
    parallel_for(0, s.height(), 64, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            TexelRange& row = rows[static_cast<std::size_t>(y)];
            row.height_max_mm = 0;
            for (const float z : s.height_mm.row(y)) {
                row.height_min_mm = std::min(row.height_min_mm, z);
                row.height_max_mm = std::max(row.height_max_mm, z);
            }
            for (const Rgb& c : s.diffuse.row(y))
                row.diffuse_max = std::max({row.diffuse_max, c.r, c.g, c.b});
            for (const float v : s.specular.row(y)) row.specular_max = std::max(row.specular_max, v);
        }
    });
    TexelRange range;
    float low = 0, high = 0;
    for (const TexelRange& row : rows) {
        low = std::min(low, row.height_min_mm);
        high = std::max(high, row.height_max_mm);
        range.diffuse_max = std::max(range.diffuse_max, row.diffuse_max);
        range.specular_max = std::max(range.specular_max, row.specular_max);
    }
    // A few wild pixels must not take the bits of all others.
    range.diffuse_max = std::min(range.diffuse_max, 16.0f);
    range.specular_max = std::min(range.specular_max, 16.0f);
    range.height_min_mm = low;
    range.height_max_mm = std::max(high, low + 1e-6f) + paint_mm;
    range.coloured_lobes = !s.lobe_colour.empty();
    return range;
}

Texel pack(const Material& m, const TexelRange& r) {
    const Vec3 n = m.normal / (std::abs(m.normal.x) + std::abs(m.normal.y) + std::abs(m.normal.z));
    const auto root = [](float v) { return std::sqrt(std::max(v, 0.0f)); };
    const auto rho = [&](float v) { return root(v / r.diffuse_max); };
    const float alpha = (std::log2(std::max(m.roughness, 1e-6f)) + 14) / 20;
    const float height = (m.height_mm - r.height_min_mm) / (r.height_max_mm - r.height_min_mm);
    const GlossLayout& layout = layout_of(r);
    // Heights need all 24 bits: in double, since a float has no more.
    const auto z = static_cast<std::uint32_t>(
        std::clamp<double>(height, 0.0, 1.0) * static_cast<double>(layout.height.largest) + 0.5);
    Texel texel = {code(0.5f + 0.5f * (n.x + n.y), 65535) | code(0.5f + 0.5f * (n.x - n.y), 65535) << 16,
                   code(rho(m.diffuse.r), 2047) | code(rho(m.diffuse.g), 2047) << 11 |
                       code(rho(m.diffuse.b), 1023) << 22,
                   layout.alpha.of(alpha), layout.confidence.of(m.confidence) | z << layout.height.shift};
    float specular = m.specular;
    if (r.coloured_lobes) {  // means of several colours may have no channel of 1
        const Rgb& colour = m.lobe_colour;
        const int largest = colour.r >= colour.g && colour.r >= colour.b ? 0 : colour.g >= colour.b ? 1 : 2;
        const float most = std::max(colour[largest], 1e-6f);
        specular *= most;
        texel[2] |= kColourAfter.of(colour[(largest + 1) % 3] / most);
        texel[3] |= static_cast<std::uint32_t>(largest) << kLargestShift |
                    kColourBefore.of(colour[(largest + 2) % 3] / most);
    }
    texel[2] |= layout.specular.of(root(specular / r.specular_max));
    return texel;
}

Material unpack(const Texel& t, const TexelRange& r) {
    Material m;
    const float u = 2 * value(t[0] & 0xffffu, 65535) - 1, v = 2 * value(t[0] >> 16, 65535) - 1;
    const float x = 0.5f * (u + v), y = 0.5f * (u - v);
    m.normal = glm::normalize(Vec3(x, y, 1 - std::abs(x) - std::abs(y)));
    const Rgb root(value(t[1] & 0x7ffu, 2047), value((t[1] >> 11) & 0x7ffu, 2047), value(t[1] >> 22, 1023));
    m.diffuse = r.diffuse_max * root * root;
    const GlossLayout& layout = layout_of(r);
    const float gloss = layout.specular.in(t[2]);
    m.specular = r.specular_max * gloss * gloss;
    m.roughness = std::exp2(20 * layout.alpha.in(t[2]) - 14);
    m.height_mm = r.height_min_mm + (r.height_max_mm - r.height_min_mm) * layout.height.in(t[3]);
    m.confidence = layout.confidence.in(t[3]);
    if (r.coloured_lobes) {
        const int largest = static_cast<int>(t[3] >> kLargestShift & 3u);
        m.lobe_colour[(largest + 1) % 3] = kColourAfter.in(t[2]);
        m.lobe_colour[(largest + 2) % 3] = kColourBefore.in(t[3]);
    }
    return m;
}

Material material_at(const Surface& s, int x, int y) {
    return {s.normal(x, y),
            s.diffuse(x, y),
            s.specular(x, y),
            s.roughness(x, y),
            s.height_mm(x, y),
            s.confidence(x, y),
            s.lobe_colour.empty() ? Rgb(1) : s.lobe_colour(x, y)};
}

LevelSize level_size(int width, int height, int level) {
    const int up = (1 << level) - 1;
    return {(width + up) >> level, (height + up) >> level};
}

int level_count(int width, int height) {
    int levels = 1;
    while (std::max(width, height) > 16LL << (levels - 1)) ++levels;
    return levels;
}

TexelTiles::TexelTiles(const Surface& s, const TexelRange& range)
    : width_(s.width()), height_(s.height()), range_(range) {
    std::size_t tiles = 0;
    for (int level = 0; level < level_count(width_, height_); ++level) {
        const LevelSize size = level_size(width_, height_, level);
        first_.push_back(tiles);
        tiles += static_cast<std::size_t>(size.columns()) * static_cast<std::size_t>(size.rows());
    }
    memory_ = ScratchMemory(tiles * kTileTexels * sizeof(Texel));
    texels_ = {static_cast<Texel*>(memory_.data()), tiles * kTileTexels};
    update(s, {0, 0, width_, height_});
}

std::size_t TexelTiles::offset(int x, int y, int level) const {
    const int columns = level_size(width_, height_, level).columns();
    const std::size_t tile = first_[static_cast<std::size_t>(level)] +
                             static_cast<std::size_t>(y >> kTileBits) * static_cast<std::size_t>(columns) +
                             static_cast<std::size_t>(x >> kTileBits);
    return tile * kTileTexels +
           static_cast<std::size_t>((y & (kTileSide - 1)) << kTileBits | (x & (kTileSide - 1)));
}

std::span<const Texel> TexelTiles::tile(const TileName& name) const {
    return {&texels_[offset(name.column << kTileBits, name.row << kTileBits, name.level)], kTileTexels};
}

const Texel& TexelTiles::at(int x, int y, int level) const { return texels_[offset(x, y, level)]; }

Region TexelTiles::region_at(int level, const Region& region) const {
    const int up = (1 << level) - 1;
    const Region r = {std::clamp(region.x0, 0, width_), std::clamp(region.y0, 0, height_),
                      std::clamp(region.x1, 0, width_), std::clamp(region.y1, 0, height_)};
    return {r.x0 >> level, r.y0 >> level, (r.x1 + up) >> level, (r.y1 + up) >> level};
}

// Texels as make(x, y) gives them. Who reads waits for the copying only, not for the arithmetic.
template <class Make>
void TexelTiles::make(int level, const Region& r, const Make& make) {
    parallel_for(r.y0, r.y1, 64, [&](int begin, int end) {
        std::array<Texel, kTileSide> some;
        for (int y = begin; y < end; ++y)
            for (int x0 = r.x0; x0 < r.x1;) {
                const int x1 = std::min((x0 | (kTileSide - 1)) + 1, r.x1);
                for (int x = x0; x < x1; ++x) some[static_cast<std::size_t>(x - x0)] = make(x, y);
                const auto held = lock();
                std::copy_n(some.begin(), x1 - x0, &texels_[offset(x0, y, level)]);
                x0 = x1;
            }
    });
}

void TexelTiles::update(const Surface& s, const Region& region) {
    TP_REQUIRE(s.width() == width_ && s.height() == height_, "tiles are of this surface");
    make(0, region_at(0, region), [&](int x, int y) { return pack(material_at(s, x, y), range_); });
    for (int level = 1; level < levels(); ++level) {
        const LevelSize below = level_size(width_, height_, level - 1);
        make(level, region_at(level, region), [&](int x, int y) {
            MeanMaterial mean;
            for (int sy = 2 * y; sy < std::min(2 * y + 2, below.height); ++sy)
                for (int sx = 2 * x; sx < std::min(2 * x + 2, below.width); ++sx)
                    mean.add(unpack(at(sx, sy, level - 1), range_));
            return pack(mean.material(), range_);
        });
    }
}

}  // namespace tangi
