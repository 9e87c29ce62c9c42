#include "paint/canvas/canvas_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>

namespace tangi {

namespace {

// FNV-1a as in hash_of(Surface), but of words where there are many: of a number as a file keeps it.
class CanvasHash {
public:
    void add(std::string_view text) {
        for (const char c : text) take(static_cast<unsigned char>(c));
        take(text.size());
    }
    void add(float value) { take(std::bit_cast<std::uint32_t>(value)); }
    void add(int value) { take(static_cast<std::uint32_t>(value)); }
    std::string hex() const { return fmt::format("{:016x}", hash_); }

private:
    void take(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3; }

    std::uint64_t hash_ = 0xcbf29ce484222325;
};

void add(CanvasHash& hash, const Pigment& paint) {
    hash.add(paint.name);
    for (const float k : paint.k) hash.add(k);
    for (const float s : paint.s) hash.add(s);
    hash.add(paint.specular), hash.add(paint.roughness);
}

// Planes without paint are in no file, nor is what lies beyond the picture's border in a tile at its edge.
void add(CanvasHash& hash, const Canvas& canvas, const PaintLayer& layer) {
    for (const TileIndex at : layer.painted()) {
        const PaintTile& tile = *layer.tile(at);
        const Region region = layer.region_of(at);
        for (const IngredientId id : tile.ingredients) {
            const auto plane = tile.plane(id);
            if (std::ranges::all_of(plane, [](float mm) { return mm == 0; })) continue;
            hash.add(at.x), hash.add(at.y);
            hash.add(is_upper(id) ? "upper film" : "film");
            add(hash, canvas.ingredients()[paint_of(id)]);
            for (int y = 0; y < region.height(); ++y)
                for (int x = 0; x < region.width(); ++x)
                    hash.add(plane[static_cast<std::size_t>(y * PaintTile::kSize + x)]);
        }
    }
}

}  // namespace

std::string hash_of(const Canvas& canvas, const std::string& dry_hash) {
    CanvasHash hash;
    hash.add(dry_hash);
    hash.add(static_cast<float>(canvas.mm_per_pixel()));
    for (const DriedLayer& layer : canvas.dried()) {
        hash.add(layer.name);
        add(hash, canvas, layer.paint);
    }
    hash.add("wet");
    add(hash, canvas, canvas.wet());
    return hash.hex();
}

}  // namespace tangi
