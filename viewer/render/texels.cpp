#include "viewer/render/texels.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

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

// Bits of a word, from `shift` on.
struct Field {
    int word = 0, shift = 0;
    std::uint32_t largest = 0;  // 0: texels do not have it
    void set(Texel& texel, std::uint32_t number) const {
        texel[static_cast<std::size_t>(word)] |= number << shift;
    }
    void put(Texel& texel, float v) const { set(texel, code(v, largest)); }
    std::uint32_t number(const Texel& texel) const {
        return texel[static_cast<std::size_t>(word)] >> shift & largest;
    }
    float in(const Texel& texel) const { return value(number(texel), largest); }
};

constexpr Field field(int word, int shift, int bits) { return {word, shift, (1u << bits) - 1}; }

// The fields that texels.h describes.
struct Layout {
    Field u, v, red, green, blue, specular, alpha, confidence, height;
    Field after{}, before{}, largest{};  // the lobe's colour
    Field stretch_x{}, stretch_y{};
};
constexpr Layout kWhiteLobes{.u = field(0, 0, 16),
                             .v = field(0, 16, 16),
                             .red = field(1, 0, 11),
                             .green = field(1, 11, 11),
                             .blue = field(1, 22, 10),
                             .specular = field(2, 0, 16),
                             .alpha = field(2, 16, 16),
                             .confidence = field(3, 0, 8),
                             .height = field(3, 8, 24)};
constexpr Layout kColouredLobes{.u = field(0, 0, 16),
                                .v = field(0, 16, 16),
                                .red = field(1, 0, 11),
                                .green = field(1, 11, 11),
                                .blue = field(1, 22, 10),
                                .specular = field(2, 0, 12),
                                .alpha = field(2, 12, 13),
                                .confidence = field(3, 0, 6),
                                .height = field(3, 15, 17),
                                .after = field(2, 25, 7),
                                .before = field(3, 8, 7),
                                .largest = field(3, 6, 2)};
constexpr Layout kDrawnOutLobes{.u = field(0, 0, 13),
                                .v = field(0, 13, 12),
                                .red = field(1, 0, 10),
                                .green = field(1, 10, 10),
                                .blue = field(1, 20, 9),
                                .specular = field(2, 0, 11),
                                .alpha = field(2, 11, 12),
                                .confidence = field(1, 29, 3),
                                .height = field(3, 16, 16),
                                .after = field(2, 23, 7),
                                .before = field(0, 25, 7),
                                .largest = field(2, 30, 2),
                                .stretch_x = field(3, 0, 8),
                                .stretch_y = field(3, 8, 8)};

// Calls `with` with the layout of these texels, known when compiled.
template <class With>
auto by_layout(const TexelRange& r, const With& with) {
    if (r.anisotropic_specular) return with.template operator()<kDrawnOutLobes>();
    if (r.coloured_specular) return with.template operator()<kColouredLobes>();
    return with.template operator()<kWhiteLobes>();
}

constexpr float kNoStretch = 127;  // code of 0
float stretch_code(float stretch) {
    return (kNoStretch + kNoStretch * std::clamp(stretch, -1.0f, 1.0f)) / 255;
}
float stretch_of_code(std::uint32_t code) { return (static_cast<float>(code) - kNoStretch) / kNoStretch; }

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
    range.anisotropic_specular = !s.lobe_axes.empty();
    range.coloured_specular = range.anisotropic_specular || !s.specular_colour.empty();
    return range;
}

namespace {

template <const Layout& l>
Texel packed(const Material& m, const TexelRange& r) {
    const Vec3 n = m.normal / (std::abs(m.normal.x) + std::abs(m.normal.y) + std::abs(m.normal.z));
    const auto root = [](float v) { return std::sqrt(std::max(v, 0.0f)); };
    const auto rho = [&](float v) { return root(v / r.diffuse_max); };
    const float height = (m.height_mm - r.height_min_mm) / (r.height_max_mm - r.height_min_mm);
    Texel texel{};
    l.u.put(texel, 0.5f + 0.5f * (n.x + n.y));
    l.v.put(texel, 0.5f + 0.5f * (n.x - n.y));
    l.red.put(texel, rho(m.diffuse.r));
    l.green.put(texel, rho(m.diffuse.g));
    l.blue.put(texel, rho(m.diffuse.b));
    l.alpha.put(texel, (std::log2(std::max(m.roughness, 1e-6f)) + 14) / 20);
    l.confidence.put(texel, m.confidence);
    // Heights need all 24 bits: in double, since a float has no more.
    l.height.set(texel,
                 static_cast<std::uint32_t>(
                     std::clamp<double>(height, 0.0, 1.0) * static_cast<double>(l.height.largest) + 0.5));
    float specular = m.specular;
    if constexpr (l.largest.largest > 0) {  // means of several colours may have no channel of 1
        const Rgb& colour = m.specular_colour;
        const int largest = colour.r >= colour.g && colour.r >= colour.b ? 0 : colour.g >= colour.b ? 1 : 2;
        const float most = std::max(colour[largest], 1e-6f);
        specular *= most;
        l.largest.set(texel, static_cast<std::uint32_t>(largest));
        l.after.put(texel, colour[(largest + 1) % 3] / most);
        l.before.put(texel, colour[(largest + 2) % 3] / most);
    }
    if constexpr (l.stretch_x.largest > 0) {
        l.stretch_x.put(texel, stretch_code(m.stretch.x));
        l.stretch_y.put(texel, stretch_code(m.stretch.y));
    }
    l.specular.put(texel, root(specular / r.specular_max));
    return texel;
}

template <const Layout& l>
Material unpacked(const Texel& t, const TexelRange& r) {
    Material m;
    const float u = 2 * l.u.in(t)-1, v = 2 * l.v.in(t)-1;
    const float x = 0.5f * (u + v), y = 0.5f * (u - v);
    m.normal = glm::normalize(Vec3(x, y, 1 - std::abs(x) - std::abs(y)));
    const Rgb root(l.red.in(t), l.green.in(t), l.blue.in(t));
    m.diffuse = r.diffuse_max * root * root;
    const float gloss = l.specular.in(t);
    m.specular = r.specular_max * gloss * gloss;
    m.roughness = std::exp2(20 * l.alpha.in(t)-14);
    m.height_mm = r.height_min_mm + (r.height_max_mm - r.height_min_mm) * l.height.in(t);
    m.confidence = l.confidence.in(t);
    if constexpr (l.largest.largest > 0) {
        const auto largest = static_cast<int>(l.largest.number(t));
        m.specular_colour[(largest + 1) % 3] = l.after.in(t);
        m.specular_colour[(largest + 2) % 3] = l.before.in(t);
    }
    if constexpr (l.stretch_x.largest > 0)
        m.stretch = {stretch_of_code(l.stretch_x.number(t)), stretch_of_code(l.stretch_y.number(t))};
    return m;
}

}  // namespace

Texel pack(const Material& m, const TexelRange& r) {
    return by_layout(r, [&]<const Layout & l>() { return packed<l>(m, r); });
}

Material unpack(const Texel& t, const TexelRange& r) {
    return by_layout(r, [&]<const Layout & l>() { return unpacked<l>(t, r); });
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

// [bytes] Of 24 megapixels; those of larger paintings are on disk.
constexpr std::size_t kHeldTexels = std::size_t(512) << 20;

TexelTiles::TexelTiles(const Surface& s, const TexelRange& range) : TexelTiles(s.width(), s.height(), range) {
    update(s, {0, 0, width_, height_});
}

TexelTiles::TexelTiles(int width, int height, const TexelRange& range)
    : width_(width), height_(height), range_(range) {
    std::size_t tiles = 0;
    for (int level = 0; level < level_count(width_, height_); ++level) {
        const LevelSize size = level_size(width_, height_, level);
        first_.push_back(tiles);
        tiles += static_cast<std::size_t>(size.columns()) * static_cast<std::size_t>(size.rows());
    }
    memory_ = ScratchMemory(tiles * kTileTexels * sizeof(Texel), kHeldTexels);
    texels_ = {static_cast<Texel*>(memory_.data()), tiles * kTileTexels};
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

template <class MaterialAt>
void TexelTiles::update(const Region& region, const MaterialAt& material) {
    make(0, region_at(0, region), [&](int x, int y) { return pack(material(x, y), range_); });
    for (int level = 1; level < levels(); ++level) {
        const LevelSize below = level_size(width_, height_, level - 1);
        make(level, region_at(level, region), [&](int x, int y) {
            MeanMaterial mean(range_.anisotropic_specular);
            for (int sy = 2 * y; sy < std::min(2 * y + 2, below.height); ++sy)
                for (int sx = 2 * x; sx < std::min(2 * x + 2, below.width); ++sx)
                    mean.add(unpack(at(sx, sy, level - 1), range_));
            return pack(mean.material(), range_);
        });
    }
}

void TexelTiles::update(const Surface& s, const Region& region) {
    TP_REQUIRE(s.width() == width_ && s.height() == height_, "tiles are of this surface");
    update(region, [&](int x, int y) { return material_at(s, x, y); });
}

void TexelTiles::update_part(const Surface& s, const Region& region) {
    TP_REQUIRE(s.width() == region.width() && s.height() == region.height(), "the surface is of this region");
    update(region, [&](int x, int y) { return material_at(s, x - region.x0, y - region.y0); });
}

}  // namespace tangi
