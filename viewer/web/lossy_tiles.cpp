#include "viewer/web/lossy_tiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/image/colour.h"
#include "surface/render/relight.h"
#include "surface/report/jpeg_bytes.h"
#include "viewer/web/web_tiles.h"

namespace tangi {

namespace {

// [rows] JPEG's blocks have 8: no block of a field has rows of another.
int padded(int height) { return (height + 7) / 8 * 8; }

std::vector<WebField> fields_packed(const TexelRange& range, Packing packing) {
    std::vector<WebField> some;
    for (const WebField& field : web_fields(range))
        if (field.packing == packing) some.push_back(field);
    return some;
}

std::uint32_t most_of(const WebField& field) { return (std::uint32_t(1) << field.bits) - 1; }
std::uint32_t code_of(const Texel& texel, const WebField& field) {
    return texel[static_cast<std::size_t>(field.word)] >> field.shift & most_of(field);
}
void set_code(Texel& texel, const WebField& field, std::uint32_t code) {
    std::uint32_t& word = texel[static_cast<std::size_t>(field.word)];
    word = (word & ~(most_of(field) << field.shift)) | code << field.shift;
}

void append(std::string& bytes, std::uint32_t number) {
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xff);
}
void append_piece(std::string& bytes, const std::string& piece) {
    append(bytes, static_cast<std::uint32_t>(piece.size()));
    bytes += piece;
}

class Reading {
public:
    explicit Reading(std::string_view bytes) : rest_(bytes) {}
    std::uint32_t number() {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < 4; ++i)
            value |= static_cast<std::uint32_t>(static_cast<unsigned char>(rest_.at(i))) << (8 * i);
        rest_.remove_prefix(4);
        return value;
    }
    std::string_view piece() {
        const std::size_t size = number();
        const std::string_view piece = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return piece;
    }

private:
    std::string_view rest_;
};

// Half way to the best: an eye notices a tint of flat paint before it notices a lost bump, and colours are
// small.
int colour_quality(int quality) { return (quality + 100) / 2; }

std::uint8_t in_8_bits(double part) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
}

// The texels of a tile, row by row.
std::vector<Texel> texels_of(const TexelTiles& tiles, const TilePlace& place) {
    std::vector<Texel> texels;
    texels.reserve(static_cast<std::size_t>(place.width) * static_cast<std::size_t>(place.height));
    for (int y = 0; y < place.height; ++y)
        for (int x = 0; x < place.width; ++x)
            texels.push_back(tiles.at(place.x0 + x, place.y0 + y, place.level));
    return texels;
}

// What a page makes of a tile; exact fields are those of `texels`.
std::vector<Texel> unpacked(const std::string& packed, const TexelRange& range, const TilePlace& place,
                            std::vector<Texel> texels) {
    const std::vector<WebField> greys = fields_packed(range, Packing::grey),
                                colours = fields_packed(range, Packing::colour);
    Reading reading(packed);
    std::vector<std::array<std::uint32_t, 2>> ends;
    for (std::size_t k = 0; k < greys.size(); ++k) {
        const std::uint32_t lowest = reading.number();
        ends.push_back({lowest, reading.number()});
    }
    const Samples8 colour = samples_of_jpeg(reading.piece()), grey = samples_of_jpeg(reading.piece());
    const auto width = static_cast<std::size_t>(place.width),
               rows = static_cast<std::size_t>(padded(place.height));
    for (std::size_t i = 0; i < texels.size(); ++i) {
        for (std::size_t k = 0; k < colours.size(); ++k)
            set_code(texels[i], colours[k],
                     static_cast<std::uint32_t>(
                         std::lround(colour.values[3 * i + k] / 255.0 * most_of(colours[k]))));
        for (std::size_t k = 0; k < greys.size(); ++k) {
            const double part = grey.values[(k * rows + i / width) * width + i % width] / 255.0;
            set_code(texels[i], greys[k],
                     ends[k][0] + static_cast<std::uint32_t>(std::lround(part * (ends[k][1] - ends[k][0]))));
        }
    }
    return texels;
}

// As a painting of its own, of the same laws.
Surface surface_of(const std::vector<Texel>& texels, const TexelRange& range, const TilePlace& place,
                   const Surface& like) {
    Surface s(place.width, place.height);
    s.mm_per_pixel = like.mm_per_pixel;
    s.reflectance_model = like.reflectance_model;
    if (range.coloured_specular || range.anisotropic_specular)
        s.specular_colour = Image<Rgb>(place.width, place.height);
    if (range.anisotropic_specular) s.lobe_axes = Image<LobeAxes>(place.width, place.height);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const Material m = unpack(texels[i], range);
        s.normal.pixels()[i] = m.normal;
        s.diffuse.pixels()[i] = m.diffuse;
        s.specular.pixels()[i] = m.specular;
        s.roughness.pixels()[i] = m.roughness;
        s.height_mm.pixels()[i] = m.height_mm;
        s.confidence.pixels()[i] = 1;
        if (!s.specular_colour.empty()) s.specular_colour.pixels()[i] = m.specular_colour;
        if (!s.lobe_axes.empty()) s.lobe_axes.pixels()[i] = axes_of(m.stretch, m.roughness);
    }
    return s;
}

}  // namespace

std::string lossy_tile(const TexelTiles& tiles, const TileName& name, int quality) {
    const TilePlace place = place_of(tiles, name);
    const std::vector<Texel> texels = texels_of(tiles, place);
    const std::vector<WebField> greys = fields_packed(tiles.range(), Packing::grey),
                                colours = fields_packed(tiles.range(), Packing::colour),
                                exact = fields_packed(tiles.range(), Packing::exact);
    const auto width = static_cast<std::size_t>(place.width), height = static_cast<std::size_t>(place.height),
               rows = static_cast<std::size_t>(padded(place.height));
    Samples8 colour{place.width, place.height, 3, {}},
        grey{place.width, padded(place.height) * static_cast<int>(greys.size()), 1,
             std::vector<std::uint8_t>(width * rows * greys.size())};
    for (const Texel& texel : texels)
        for (const WebField& field : colours)
            colour.values.push_back(in_8_bits(code_of(texel, field) / double(most_of(field))));
    std::string bytes;
    for (std::size_t k = 0; k < greys.size(); ++k) {
        const auto less = [&](const Texel& a, const Texel& b) {
            return code_of(a, greys[k]) < code_of(b, greys[k]);
        };
        const auto [low, high] = std::minmax_element(texels.begin(), texels.end(), less);
        const std::uint32_t lowest = code_of(*low, greys[k]), highest = code_of(*high, greys[k]);
        append(bytes, lowest);
        append(bytes, highest);
        for (std::size_t y = 0; y < rows; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                const std::uint32_t code = code_of(texels[std::min(y, height - 1) * width + x], greys[k]);
                grey.values[(k * rows + y) * width + x] =
                    in_8_bits((code - lowest) / std::max(1.0, double(highest - lowest)));
            }
    }
    append_piece(bytes, jpeg_bytes(colour, colour_quality(quality)));
    append_piece(bytes, jpeg_bytes(grey, quality));
    append_piece(bytes, exact.empty() ? "" : web_tile(tiles, name, exact));
    return bytes;
}

std::string lossy_horizon(const HorizonMap& map, int quality) {
    return jpeg_bytes(
        {map.width, map.height * HorizonMap::kAzimuths, 1, {map.values.begin(), map.values.end()}}, quality);
}

LossyError& LossyError::operator+=(const LossyError& other) {
    squared += other.squared;
    height_squared += other.height_squared;
    values += other.values;
    heights += other.heights;
    return *this;
}

double LossyError::psnr_db() const {
    return squared > 0 ? 10 * std::log10(static_cast<double>(values) / squared) : 99;
}

double LossyError::height_rms() const {
    return heights > 0 ? std::sqrt(height_squared / static_cast<double>(heights)) : 0;
}

LossyError error_of(const std::string& packed, const Surface& surface, const TexelTiles& tiles,
                    const TileName& name, std::span<const Light> lights) {
    const TilePlace place = place_of(tiles, name);
    const std::vector<Texel> texels = texels_of(tiles, place);
    const Surface truth = surface_of(texels, tiles.range(), place, surface),
                  got = surface_of(unpacked(packed, tiles.range(), place, texels), tiles.range(), place,
                                   surface);
    LossyError error;
    const Transfer srgb{Transfer::Kind::srgb};
    for (const Light& light : lights) {
        const Image<Rgb> a = relight(truth, std::span(&light, 1)), b = relight(got, std::span(&light, 1));
        for (std::size_t i = 0; i < a.size(); ++i) {
            const Rgb difference = glm::clamp(srgb.encode(b.pixels()[i]), 0.0f, 1.0f) -
                                   glm::clamp(srgb.encode(a.pixels()[i]), 0.0f, 1.0f);
            error.squared += static_cast<double>(glm::dot(difference, difference));
            error.values += 3;
        }
    }
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const double difference = got.height_mm.pixels()[i] - truth.height_mm.pixels()[i];
        error.height_squared += difference * difference;
        ++error.heights;
    }
    return error;
}

int quality_for(double psnr_db, const Surface& surface, const TexelTiles& tiles,
                std::span<const Light> lights) {
    // So that the whole keeps what the sample promises (docs/validation/viewer.md).
    constexpr double kMargin_db = 0.3;
    constexpr int kSample = 24, kLowest = 10;
    const LevelSize size = level_size(tiles.width(), tiles.height(), 0);
    const int all = size.columns() * size.rows(), count = std::min(all, kSample);
    const auto reached = [&](int quality) {
        std::vector<LossyError> errors(static_cast<std::size_t>(count));
        parallel_for(0, count, 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) {
                const int at = static_cast<int>((i + 0.5) * all / count);
                const TileName name{0, at % size.columns(), at / size.columns()};
                errors[static_cast<std::size_t>(i)] =
                    error_of(lossy_tile(tiles, name, quality), surface, tiles, name, lights);
            }
        });
        LossyError sum;
        for (const LossyError& error : errors) sum += error;  // in one order, for any number of threads
        return sum.psnr_db() >= psnr_db + (count < all ? kMargin_db : 0);
    };
    int low = kLowest, high = kBestQuality;  // the lowest that does is in [low, high]
    while (low < high) {
        const int middle = (low + high) / 2;
        if (reached(middle))
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

}  // namespace tangi
