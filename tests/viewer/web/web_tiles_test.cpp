// web_tiles_test.cpp: what a page unpacks is what was packed.
#include "viewer/web/web_tiles.h"

#include <zlib.h>

#include "tests/support/viewer/viewer_support.h"

namespace tangi {
namespace {

std::vector<unsigned char> inflated(const std::string& packed, std::size_t size) {
    std::vector<unsigned char> bytes(size + 1);
    uLongf got = bytes.size();
    EXPECT_EQ(uncompress(bytes.data(), &got, reinterpret_cast<const Bytef*>(packed.data()),
                         static_cast<uLong>(packed.size())),
              Z_OK);
    EXPECT_EQ(got, size);
    bytes.resize(size);
    return bytes;
}

// As a reader of the header's description would write it.
std::vector<Texel> unpacked(const std::string& packed, int width, int height,
                            std::span<const WebField> fields = kWebFields) {
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::size_t size = 0;
    for (const WebField& field : fields) size += (field.kept > 8 ? 2 : 1) * count;
    const std::vector<unsigned char> bytes = inflated(packed, size);
    std::vector<Texel> texels(count, Texel{});
    std::size_t at = 0;
    for (const WebField& field : fields) {
        const std::int64_t modulus = std::int64_t(1) << field.kept;
        std::vector<std::int64_t> codes;
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t folded = bytes[at + i] + (field.kept > 8 ? 256 * bytes[at + count + i] : 0);
            const std::int64_t rest = folded % 2 ? -(folded + 1) / 2 : folded / 2;
            const auto w = static_cast<std::size_t>(width);
            const bool first_row = i < w, first_column = i % w == 0;
            std::int64_t guess = 0;
            if (first_row && !first_column) guess = codes[i - 1];
            if (!first_row && first_column) guess = codes[i - w];
            if (!first_row && !first_column) {
                std::array<std::int64_t, 3> middle = {codes[i - 1], codes[i - w],
                                                      codes[i - 1] + codes[i - w] - codes[i - w - 1]};
                std::sort(middle.begin(), middle.end());
                guess = middle[1];
            }
            codes.push_back(((guess + rest) % modulus + modulus) % modulus);
            const double wider = (std::pow(2, field.bits) - 1) / static_cast<double>(modulus - 1);
            texels[i][static_cast<std::size_t>(field.word)] |=
                static_cast<std::uint32_t>(std::lround(static_cast<double>(codes[i]) * wider)) << field.shift;
        }
        at += (field.kept > 8 ? 2 : 1) * count;
    }
    return texels;
}

TEST(WebTiles, KeepWhatCanBeSeen) {
    const Surface s = painted_surface(300, 270);
    const TexelTiles tiles(s, range_of(s));
    struct Place {
        int level, column, row, width, height;
    };
    for (const Place p : {Place{0, 0, 0, 256, 256}, {0, 1, 1, 44, 14}, {1, 0, 0, 150, 135}}) {
        const std::vector<Texel> texels =
            unpacked(web_tile(tiles, {p.level, p.column, p.row}), p.width, p.height);
        for (int y = 0; y < p.height; ++y)
            for (int x = 0; x < p.width; ++x) {
                const Texel& got = texels[static_cast<std::size_t>(y * p.width + x)];
                const Material truth = unpack(tiles.at(256 * p.column + x, 256 * p.row + y, p.level),
                                              tiles.range()),
                               m = unpack(got, tiles.range());
                ASSERT_LT(glm::length(m.normal - truth.normal), 2e-4) << p.level << " " << x << " " << y;
                ASSERT_EQ(m.diffuse, truth.diffuse);
                ASSERT_NEAR(std::sqrt(m.specular), std::sqrt(truth.specular), 2e-4);
                ASSERT_NEAR(m.roughness / truth.roughness, 1, 2e-3);
                ASSERT_NEAR(m.height_mm, truth.height_mm,
                            1e-5 * (tiles.range().height_max_mm - tiles.range().height_min_mm));
                ASSERT_NEAR(m.confidence, truth.confidence, 0.009);
            }
    }
}

TEST(WebTiles, KeepTheColoursOfLobes) {
    const Surface s = gilded_surface(120, 90);
    const TexelTiles tiles(s, range_of(s));
    const std::vector<Texel> texels =
        unpacked(web_tile(tiles, {0, 0, 0}), 120, 90, web_fields(tiles.range()));
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 120; ++x) {
            const Material truth = unpack(tiles.at(x, y), tiles.range()),
                           m = unpack(texels[static_cast<std::size_t>(y * 120 + x)], tiles.range());
            ASSERT_EQ(m.specular_colour, truth.specular_colour);
            ASSERT_EQ(m.specular, truth.specular);
            ASSERT_NEAR(m.roughness / truth.roughness, 1, 2e-3);
            ASSERT_EQ(m.confidence, truth.confidence);
        }
}

TEST(WebTiles, KeepLobesThatAreDrawnOutAsTheyAre) {
    const Surface s = brushed_surface(120, 90);
    const TexelTiles tiles(s, range_of(s));
    const std::vector<Texel> texels =
        unpacked(web_tile(tiles, {0, 0, 0}), 120, 90, web_fields(tiles.range()));
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 120; ++x)
            ASSERT_EQ(texels[static_cast<std::size_t>(y * 120 + x)], tiles.at(x, y)) << x << " " << y;
}

TEST(WebTiles, AreSmallWhereNothingHappens) {
    const Surface flat(256, 256);
    EXPECT_LT(web_tile(TexelTiles(flat, range_of(flat)), {}).size(), 5000u);
    const Surface busy = painted_surface(256, 256);
    EXPECT_GT(web_tile(TexelTiles(busy, range_of(busy)), {}).size(), 100000u);
}

TEST(WebTiles, LevelsEndWithOneTile) {
    EXPECT_EQ(web_levels(1, 1), 1);
    EXPECT_EQ(web_levels(256, 256), 1);
    EXPECT_EQ(web_levels(257, 3), 2);
    EXPECT_EQ(web_levels(10000, 10000), 7);
    for (const int side : {255, 257, 4052, 70000}) {
        const LevelSize last = level_size(side, side, web_levels(side, side) - 1);
        EXPECT_EQ(last.columns() * last.rows(), 1) << side;
    }
}

TEST(WebTiles, HorizonsComeBack) {
    HorizonMap map{5, 3, {}};
    Random random(2);
    for (int i = 0; i < 5 * 3 * HorizonMap::kAzimuths; ++i)
        map.values.push_back(static_cast<std::uint8_t>(random.real(0, 255)));
    std::vector<unsigned char> bytes = inflated(web_horizon(map), map.values.size());
    for (std::size_t i = 1; i < bytes.size(); ++i)
        bytes[i] = static_cast<unsigned char>(bytes[i] + bytes[i - 1]);
    EXPECT_EQ(bytes, map.values);
}

}  // namespace
}  // namespace tangi
