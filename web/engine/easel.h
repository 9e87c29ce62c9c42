// easel.h: a painting at work in a browser: strokes go in as lines of a journal, changed texels come out.
//
// The page's worker owns one. It does what Painter (viewer/model/painter.h) does for the window, without
// threads and without files: the page stores the lines that were applied.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "paint/session/session.h"
#include "viewer/render/texels.h"
#include "viewer/web/web_data.h"

namespace tangi {

class Easel {
public:
    static constexpr std::size_t kUndoBytes = std::size_t(192) << 20;

    // Undo keeps `undo_bytes` of memory at most; older strokes can no longer be undone then.
    explicit Easel(Surface ground, std::size_t undo_bytes = kUndoBytes)
        : Easel(Canvas(std::make_shared<const Surface>(std::move(ground))), undo_bytes) {}
    // Of a painting that may have been painted on before.
    explicit Easel(Canvas canvas, std::size_t undo_bytes = kUndoBytes);

    // What the page draws with: web_picture_data() of it, with the heights that it had when it was opened.
    nlohmann::json picture() const;

    // The same painting on another ground of the same relief, of other colour or gloss: as if its strokes had
    // been painted there. It was painted on nothing before. Throws ContractError where the relief differs.
    void lie_on(Surface ground);

    // One line of a journal, an event (docs/reference/journal-format.md). Returns what the painter should
    // know; empty where nothing. Throws Error on what makes no sense; nothing is painted then.
    std::string apply(std::string_view line);
    // A journal's first line: throws Error where it is of another version, or goes on from another painting.
    void begin(std::string_view first_line) const;

    // Brings texels up to date, and gives what changed of the painting, as rectangles. With `all`, also what
    // only settled (quantise_volumes.h).
    std::vector<Region> refresh(bool all);
    // The texels of a level that hold these pixels, row by row.
    std::vector<Texel> texels(int level, const Region& texels) const;
    Region region_at(int level, const Region& region) const { return tiles_->region_at(level, region); }

    // The mixing board's pixels, as RGBA of sRGB, where it has changed since the last call, or all of them;
    // nothing where it has not, or there is none.
    struct BoardPicture {
        int width = 0, height = 0;  // of the board
        Region region;
        std::vector<std::uint8_t> rgba;
    };
    std::optional<BoardPicture> board_changes(bool whole = false);

    // What is on the brush: {"fill": 0..1 or more, "rgb": [sRGB, 0..255], "recipe": {"Titanium White": 0.7,
    // …}}.
    nlohmann::json on_brush() const;
    // What lies at a place [mm]: {"rgb", "recipe", "thickness_mm"}; "recipe" is empty where there is no
    // paint.
    nlohmann::json sample(Place place, double x_mm, double y_mm, double radius_mm) const;
    // Paints of the palette: [{"name": "Titanium White", "rgb": [sRGB, 0..255]}, …].
    nlohmann::json paints() const;
    nlohmann::json state()
        const;  // {"can_undo", "can_redo", "strokes", "layers", "wet", "in_stroke", "goes_on"}

    // Which painting it is, and how far it is painted (canvas_hash.h); and of how it looks
    // (hash_of(Surface)).
    std::string hash() const;
    // The same, as it was before this sitting: what its journal goes on from.
    const std::string& head() const { return head_; }
    std::string look_hash();
    // The whole painting in daylight from the upper left, RGBA of sRGB, `width` pixels wide.
    BoardPicture thumbnail(int width);
    // The layers as pictures (paint/canvas/layer_pictures.h): names; one of them as RGBA.
    std::vector<std::string> layer_names() const;
    BoardPicture layer_picture(std::size_t number) const;
    // Horizons for cast shadows (viewer/render/horizon.h): [azimuth][row][column].
    struct Horizon {
        int width = 0, height = 0;
        std::vector<std::uint8_t> values;
    };
    Horizon horizon(int largest_side);

    std::size_t bytes() const;  // that the painting takes, without undo
    const Session& session() const { return session_; }

private:
    const Canvas* canvas_of(Place place) const;
    TexelRange range_of_look() const;
    void pack_all();
    // How a part looks with its paint, made for the occasion: of the whole painting there are only texels. In
    // bands of rows, from the top.
    Surface look_in(const Region& part) const;
    void in_bands(const std::function<void(const Region& rows, const Surface& look)>& work) const;

    std::shared_ptr<const Surface> ground_;
    std::string ground_hash_;
    Session session_;
    std::optional<Surface> board_;
    TexelRange range_;
    ShownHeights heights_;
    std::string head_;
    std::optional<TexelTiles> tiles_;
};

}  // namespace tangi
