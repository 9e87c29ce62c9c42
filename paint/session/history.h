// history.h: undo and redo: the tiles that each action changed, and the brush, as they were before and after
// it.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "paint/brush/brush_in_hand.h"
#include "paint/canvas/canvas.h"
#include "paint/canvas/tile_store.h"

namespace tangi {

class History {
public:
    // Beyond `budget_bytes` of memory, the tiles of the oldest actions go to a temporary file. Only where the
    // disk has no room for that can they no longer be undone: take_warning() says so.
    explicit History(std::size_t budget_bytes = std::size_t(1) << 30) : budget_bytes_(budget_bytes) {}
    History(const History&) = delete;
    History& operator=(const History&) = delete;

    // Between these two, everything that changes on the canvas is one action, and it changes at no other
    // time. What was undone before cannot be redone after it. `hand`: what is in it then.
    void begin(const Canvas& canvas, Place place = Place::painting,
               const std::optional<BrushInHand>& hand = {});
    bool end(const Canvas& canvas,
             const std::optional<BrushInHand>& hand = {});  // whether something changed on the canvas
    // Instead of end(): brings the canvas back to what it was, and nothing was done.
    void abandon(Canvas& canvas);

    bool can_undo() const { return done_ > 0; }
    bool can_redo() const { return done_ < actions_.size(); }
    // Which canvas undo() and redo() are to be given. There must be something to undo or redo.
    Place place_to_undo() const;
    Place place_to_redo() const;
    // False where there is nothing to undo or redo. Tiles come back bit for bit and are marked as dirty;
    // `hand`, where given, becomes what was in it. Throws Error, and changes nothing, where they are on disk
    // and it fails.
    bool undo(Canvas& canvas, std::optional<BrushInHand>* hand = nullptr);
    bool redo(Canvas& canvas, std::optional<BrushInHand>* hand = nullptr);

    // What was done so far can no longer be undone.
    void forget();

    std::size_t bytes() const;  // of memory
    std::uint64_t bytes_on_disk() const { return store_.bytes(); }
    // What the user should know, once; empty where nothing.
    std::string take_warning() { return std::exchange(warning_, {}); }

private:
    // A tile in memory or on disk; neither where there is none.
    struct Kept {
        PaintLayer::TilePtr tile;
        std::shared_ptr<const StoredTile> stored;
    };
    struct Change {
        TileIndex at;
        Kept before, after;
    };
    // A layer of dried paint that came, went or changed: the one with this number.
    struct LayerChange {
        std::size_t number = 0;
        std::string name;
        bool was = false, is = false;
        std::vector<Change> tiles;
    };
    // What was in the hand; where it was a brush, `brush` has no cells, which are kept as tiles.
    struct KeptController {
        std::optional<BrushInHand> brush;
        std::vector<Kept> cells;
    };
    struct Action {
        Place place = Place::painting;
        std::vector<Change> wet;
        std::vector<LayerChange> dried;
        KeptController hand_before, hand_after;
        std::size_t bytes = 0;  // of memory that goes with it
    };
    using Tiles = std::vector<std::pair<TileIndex, PaintLayer::TilePtr>>;

    static std::vector<Change> changes(const PaintLayer& before, const PaintLayer& after);
    static std::vector<LayerChange> changes(const std::vector<DriedLayer>& before,
                                            const std::vector<DriedLayer>& after);
    static KeptController kept_hand(const std::optional<BrushInHand>& hand);
    PaintLayer::TilePtr tile_of(const Kept& kept);
    void restore(Canvas& canvas, const Action& action, bool forwards, std::optional<BrushInHand>* hand);
    void store(Action& action);
    void keep_to_budget();

    std::size_t budget_bytes_;
    TileStore store_;
    std::string warning_;
    bool warned_ = false;
    Place place_ = Place::painting;  // of the action under way
    std::optional<PaintLayer> wet_before_;
    std::vector<DriedLayer> dried_before_;
    std::optional<BrushInHand> hand_before_;
    std::deque<Action> actions_;
    std::size_t done_ = 0;  // actions_[0 .. done_) are on the canvas
};

}  // namespace tangi
