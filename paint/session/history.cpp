#include "paint/session/history.h"

#include "surface/base/error.h"

namespace tangi {

namespace {

bool same_tiles(const PaintLayer& a, const PaintLayer& b) {
    for (int y = 0; y < a.rows(); ++y)
        for (int x = 0; x < a.columns(); ++x)
            if (a.tile({x, y}) != b.tile({x, y})) return false;
    return true;
}

bool same(const DriedLayer& a, const DriedLayer& b) {
    return a.name == b.name && same_tiles(a.paint, b.paint);
}

}  // namespace

std::vector<History::Change> History::changes(const PaintLayer& before, const PaintLayer& after) {
    std::vector<Change> result;
    for (int y = 0; y < before.rows(); ++y)
        for (int x = 0; x < before.columns(); ++x) {
            const auto &old = before.tile({x, y}), &now = after.tile({x, y});
            if (old != now) result.push_back({{x, y}, {old, nullptr}, {now, nullptr}});
        }
    return result;
}

// One layer at a time comes, goes or changes; between the layers below and above that stay, all are listed.
std::vector<History::LayerChange> History::changes(const std::vector<DriedLayer>& before,
                                                   const std::vector<DriedLayer>& after) {
    std::size_t first = 0, last = 0;
    const std::size_t most = std::min(before.size(), after.size());
    while (first < most && same(before[first], after[first])) ++first;
    while (last < most - first && same(before[before.size() - 1 - last], after[after.size() - 1 - last]))
        ++last;
    std::vector<LayerChange> result;
    const std::size_t olds = before.size() - first - last, news = after.size() - first - last;
    for (std::size_t i = 0; i < std::max(olds, news); ++i) {
        const DriedLayer *old = i < olds ? &before[first + i] : nullptr,
                         *now = i < news ? &after[first + i] : nullptr;
        const PaintLayer none(old ? old->paint.width() : now->paint.width(),
                              old ? old->paint.height() : now->paint.height());
        TP_REQUIRE(!old || !now || old->name == now->name, "a layer keeps its name");
        // Of those that go, each is at the number where the one before it was.
        result.push_back({now ? first + i : first + std::min(olds, news), (old ? old : now)->name,
                          old != nullptr, now != nullptr,
                          changes(old ? old->paint : none, now ? now->paint : none)});
    }
    return result;
}

History::KeptController History::kept_hand(const std::optional<BrushInHand>& hand) {
    KeptController result{hand, {}};
    if (!hand) return result;
    for (const PaintLayer::TilePtr& cells : hand->cells) result.cells.push_back({cells, nullptr});
    result.brush->cells.clear();
    return result;
}

void History::begin(const Canvas& canvas, Place place, const std::optional<BrushInHand>& hand) {
    TP_REQUIRE(!wet_before_, "an action ends before the next begins");
    place_ = place;
    hand_before_ = hand;
    wet_before_ = canvas.wet();
    dried_before_ = canvas.dried();
}

bool History::end(const Canvas& canvas, const std::optional<BrushInHand>& hand) {
    TP_REQUIRE(wet_before_, "an action that ends has begun");
    Action action;
    action.place = place_;
    action.wet = changes(*wet_before_, canvas.wet());
    action.dried = changes(dried_before_, canvas.dried());
    const auto count = [&](const std::vector<Change>& all) {
        // Of two neighbours in time, one holds the tile that they share; the last state is the canvas's.
        for (const Change& change : all)
            action.bytes += std::max(change.before.tile ? change.before.tile->bytes() : 0,
                                     change.after.tile ? change.after.tile->bytes() : 0);
    };
    count(action.wet);
    for (const LayerChange& layer : action.dried) count(layer.tiles);
    action.hand_before = kept_hand(hand_before_);
    action.hand_after = kept_hand(hand);
    if (hand && hand != hand_before_)
        for (const PaintLayer::TilePtr& cells : hand->cells) action.bytes += cells->bytes();
    const bool changed = !action.wet.empty() || !action.dried.empty();
    wet_before_.reset();
    dried_before_.clear();
    actions_.resize(done_);
    actions_.push_back(std::move(action));
    done_ = actions_.size();
    keep_to_budget();
    return changed;
}

void History::abandon(Canvas& canvas) {
    TP_REQUIRE(wet_before_, "an action that is abandoned has begun");
    Action action;
    action.wet = changes(*wet_before_, canvas.wet());
    action.dried = changes(dried_before_, canvas.dried());
    restore(canvas, action, false, nullptr);
    wet_before_.reset();
    dried_before_.clear();
}

// Moves an action's tiles to the disk. Where that fails, those that are not there yet stay in memory.
void History::store(Action& action) {
    const auto put = [&](Kept& kept) {
        if (!kept.tile) return;
        kept.stored = store_.put(kept.tile);
        kept.tile.reset();
    };
    const auto move = [&](std::vector<Change>& all) {
        for (Change& change : all)
            for (Kept* kept : {&change.before, &change.after}) put(*kept);
    };
    move(action.wet);
    for (LayerChange& layer : action.dried) move(layer.tiles);
    for (KeptController* hand : {&action.hand_before, &action.hand_after})
        for (Kept& cells : hand->cells) put(cells);
    action.bytes = 0;
}

void History::keep_to_budget() {
    std::size_t sum = bytes();
    for (std::size_t oldest = 0; sum > budget_bytes_ && !actions_.empty();) {
        while (oldest < actions_.size() && actions_[oldest].bytes == 0) ++oldest;
        if (oldest == actions_.size()) return;
        const std::size_t had = actions_[oldest].bytes;
        try {
            store(actions_[oldest]);
            sum -= had;
        } catch (const Error& error) {
            if (!std::exchange(warned_, true))
                warning_ = fmt::format("{}. The oldest steps can no longer be undone", error.what());
            if (actions_.size() == 1) return;
            // Going, the oldest makes room in memory or on the disk.
            sum -= actions_.front().bytes;
            actions_.pop_front();
            --done_;
            oldest = 0;
        }
    }
}

Place History::place_to_undo() const {
    TP_REQUIRE(can_undo(), "there is something to undo");
    return actions_[done_ - 1].place;
}

Place History::place_to_redo() const {
    TP_REQUIRE(can_redo(), "there is something to redo");
    return actions_[done_].place;
}

PaintLayer::TilePtr History::tile_of(const Kept& kept) {
    return kept.stored ? store_.get(kept.stored) : kept.tile;
}

void History::restore(Canvas& canvas, const Action& action, bool forwards, std::optional<BrushInHand>* hand) {
    // All are read before anything changes: the disk may fail.
    const auto tiles_of = [&](const std::vector<Change>& all) {
        Tiles tiles;
        for (const Change& change : all)
            tiles.emplace_back(change.at, tile_of(forwards ? change.after : change.before));
        return tiles;
    };
    const KeptController& kept = forwards ? action.hand_after : action.hand_before;
    std::optional<BrushInHand> held = kept.brush;
    for (const Kept& cells : kept.cells) held->cells.push_back(tile_of(cells));
    const auto put = [&](PaintLayer& layer, Tiles tiles) {
        for (auto& [at, tile] : tiles) {
            layer.set_tile(at, std::move(tile));
            canvas.mark_dirty(at);
        }
    };
    Tiles wet = tiles_of(action.wet);
    std::vector<Tiles> dried;
    for (const LayerChange& layer : action.dried) dried.push_back(tiles_of(layer.tiles));

    if (hand) *hand = std::move(held);
    put(canvas.writable_wet(), std::move(wet));
    auto& layers = canvas.writable_dried();
    for (std::size_t i = 0; i < action.dried.size(); ++i) {
        const std::size_t k = forwards ? i : action.dried.size() - 1 - i;
        const LayerChange& change = action.dried[k];
        const bool there = forwards ? change.was : change.is, wanted = forwards ? change.is : change.was;
        const auto at = layers.begin() + static_cast<std::ptrdiff_t>(change.number);
        if (!there) layers.insert(at, {change.name, PaintLayer(canvas.width(), canvas.height())});
        put(layers[change.number].paint, std::move(dried[k]));
        if (!wanted) layers.erase(layers.begin() + static_cast<std::ptrdiff_t>(change.number));
    }
}

bool History::undo(Canvas& canvas, std::optional<BrushInHand>* hand) {
    if (!can_undo()) return false;
    restore(canvas, actions_[done_ - 1], false, hand);
    --done_;
    return true;
}

bool History::redo(Canvas& canvas, std::optional<BrushInHand>* hand) {
    if (!can_redo()) return false;
    restore(canvas, actions_[done_], true, hand);
    ++done_;
    return true;
}

void History::forget() {
    TP_REQUIRE(!wet_before_, "no action is under way");
    actions_.clear();
    done_ = 0;
}

std::size_t History::bytes() const {
    std::size_t sum = 0;
    for (const Action& action : actions_) sum += action.bytes;
    return sum;
}

}  // namespace tangi
