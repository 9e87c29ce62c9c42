#include "viewer/web/web_tiles.h"

#include <zlib.h>

#include <algorithm>
#include <new>
#include <vector>

#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr int kCompression = 6;  // higher levels take twice the time and save 1 %

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::string result(size, '\0');
    const int done = compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                               kCompression);
    if (done == Z_MEM_ERROR) throw std::bad_alloc();
    TP_REQUIRE(done == Z_OK, "zlib has room for what it packs");
    result.resize(size);
    return result;
}

std::uint32_t kept_code(const Texel& texel, const WebField& field) {
    const std::uint32_t full = (std::uint32_t(1) << field.bits) - 1,
                        kept = (std::uint32_t(1) << field.kept) - 1;
    const std::uint32_t code = texel[static_cast<std::size_t>(field.word)] >> field.shift & full;
    return static_cast<std::uint32_t>((std::uint64_t(code) * kept + full / 2) / full);
}

int predicted(int left, int up, int corner) {
    if (corner >= std::max(left, up)) return std::min(left, up);
    if (corner <= std::min(left, up)) return std::max(left, up);
    return left + up - corner;
}

void append_planes(std::string& bytes, const std::vector<int>& codes, int width, int height, int bits) {
    const int half = 1 << (bits - 1), mask = (1 << bits) - 1;
    const std::size_t low = bytes.size(), count = codes.size();
    bytes.resize(low + (bits > 8 ? 2 : 1) * count);
    std::size_t i = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x, ++i) {
            const int left = x > 0 ? codes[i - 1] : 0;
            const int up = y > 0 ? codes[i - static_cast<std::size_t>(width)] : left;
            const int corner = x > 0 && y > 0 ? codes[i - static_cast<std::size_t>(width) - 1] : up;
            int rest = (codes[i] - predicted(x > 0 ? left : up, up, corner)) & mask;
            if (rest >= half) rest -= mask + 1;
            const int folded = rest >= 0 ? 2 * rest : -2 * rest - 1;
            bytes[low + i] = static_cast<char>(folded & 0xff);
            if (bits > 8) bytes[low + count + i] = static_cast<char>(folded >> 8);
        }
}

}  // namespace

TilePlace place_of(const TexelTiles& tiles, const TileName& name) {
    TP_REQUIRE(name.level >= 0 && name.level < tiles.levels(), "there is such a level");
    const LevelSize size = level_size(tiles.width(), tiles.height(), name.level);
    const int x0 = name.column * kTileSide, y0 = name.row * kTileSide;
    const TilePlace place{name.level, x0, y0, std::min(kTileSide, size.width - x0),
                          std::min(kTileSide, size.height - y0)};
    TP_REQUIRE(place.width > 0 && place.height > 0, "there is such a tile");
    return place;
}

std::string web_tile(const TexelTiles& tiles, const TileName& name) {
    return web_tile(tiles, name, web_fields(tiles.range()));
}

std::string web_tile(const TexelTiles& tiles, const TileName& name, std::span<const WebField> fields) {
    const auto [level, x0, y0, width, height] = place_of(tiles, name);
    std::string bytes;
    std::vector<int> codes(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (const WebField& field : fields) {
        std::size_t i = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                codes[i++] = static_cast<int>(kept_code(tiles.at(x0 + x, y0 + y, level), field));
        append_planes(bytes, codes, width, height, field.kept);
    }
    return deflated(bytes);
}

std::string web_horizon(const HorizonMap& map) {
    std::string bytes(map.values.size(), '\0');
    for (std::size_t i = 0; i < map.values.size(); ++i)
        bytes[i] = static_cast<char>(map.values[i] - (i > 0 ? map.values[i - 1] : 0));
    return deflated(bytes);
}

}  // namespace tangi
