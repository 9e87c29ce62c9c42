// history.h: undo and redo: the tiles that each action changed, as they were before and after it.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "paint/canvas.h"

namespace tangi {

class History {
public:
    // Beyond `budget_bytes` of tiles, the oldest actions can no longer be undone.
    explicit History(std::size_t budget_bytes = std::size_t(1) << 30) : budget_bytes_(budget_bytes) {}

    // Between these two, everything that changes on the canvas is one action. What was undone before cannot
    // be redone after it.
    void begin(const Canvas& canvas);
    void end(const Canvas& canvas);

    bool can_undo() const { return done_ > 0; }
    bool can_redo() const { return done_ < actions_.size(); }
    // False where there is nothing to undo or redo. Tiles come back bit for bit and are marked as dirty.
    bool undo(Canvas& canvas);
    bool redo(Canvas& canvas);

    std::size_t bytes() const;

private:
    struct Change {
        TileIndex at;
        PaintLayer::TilePtr before, after;
    };
    struct Action {
        std::vector<Change> wet;
        // Layers of dried paint; they share their tiles, so two copies take little.
        std::optional<std::vector<DriedLayer>> dried_before, dried_after;
        std::size_t bytes = 0;  // of the tiles that only this action holds on to
    };
    static void restore_dried(Canvas& canvas, const std::vector<DriedLayer>& layers);

    std::size_t budget_bytes_;
    std::optional<PaintLayer> wet_before_;
    std::optional<std::vector<DriedLayer>> dried_before_;
    std::deque<Action> actions_;
    std::size_t done_ = 0;  // actions_[0 .. done_) are on the canvas
};

}  // namespace tangi
