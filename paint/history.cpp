#include "paint/history.h"

#include "surface/error.h"

namespace tangi {

namespace {

bool same_tiles(const PaintLayer& a, const PaintLayer& b) {
    for (int y = 0; y < a.rows(); ++y)
        for (int x = 0; x < a.columns(); ++x)
            if (a.tile({x, y}) != b.tile({x, y})) return false;
    return true;
}

bool same_layers(const std::vector<DriedLayer>& a, const std::vector<DriedLayer>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].name != b[i].name || !same_tiles(a[i].paint, b[i].paint)) return false;
    return true;
}

}  // namespace

void History::begin(const Canvas& canvas) {
    TP_REQUIRE(!wet_before_, "an action ends before the next begins");
    wet_before_ = canvas.wet();
    dried_before_ = canvas.dried();
}

void History::end(const Canvas& canvas) {
    TP_REQUIRE(wet_before_, "an action that ends has begun");
    Action action;
    const PaintLayer& before = *wet_before_;
    for (int y = 0; y < before.rows(); ++y)
        for (int x = 0; x < before.columns(); ++x) {
            const auto &old = before.tile({x, y}), &now = canvas.wet().tile({x, y});
            if (old == now) continue;
            action.bytes += (old ? old->bytes() : 0) + (now ? now->bytes() : 0);
            action.wet.push_back({{x, y}, old, now});
        }
    if (!same_layers(*dried_before_, canvas.dried())) {
        for (const DriedLayer& layer : *dried_before_) action.bytes += layer.paint.bytes();
        for (const DriedLayer& layer : canvas.dried()) action.bytes += layer.paint.bytes();
        action.dried_before = std::move(dried_before_);
        action.dried_after = canvas.dried();
    }
    wet_before_.reset();
    dried_before_.reset();
    actions_.resize(done_);
    actions_.push_back(std::move(action));
    done_ = actions_.size();
    for (std::size_t sum = bytes(); sum > budget_bytes_ && actions_.size() > 1;) {
        sum -= actions_.front().bytes;
        actions_.pop_front();
        --done_;
    }
}

void History::restore_dried(Canvas& canvas, const std::vector<DriedLayer>& layers) {
    for (const auto* some : {&canvas.dried(), &layers})
        for (const DriedLayer& layer : *some)
            for (const TileIndex tile : layer.paint.painted()) canvas.mark_dirty(tile);
    canvas.writable_dried() = layers;
}

bool History::undo(Canvas& canvas) {
    if (!can_undo()) return false;
    const Action& action = actions_[--done_];
    for (const Change& change : action.wet) {
        canvas.writable_wet().set_tile(change.at, change.before);
        canvas.mark_dirty(change.at);
    }
    if (action.dried_before) restore_dried(canvas, *action.dried_before);
    return true;
}

bool History::redo(Canvas& canvas) {
    if (!can_redo()) return false;
    const Action& action = actions_[done_++];
    for (const Change& change : action.wet) {
        canvas.writable_wet().set_tile(change.at, change.after);
        canvas.mark_dirty(change.at);
    }
    if (action.dried_after) restore_dried(canvas, *action.dried_after);
    return true;
}

std::size_t History::bytes() const {
    std::size_t sum = 0;
    for (const Action& action : actions_) sum += action.bytes;
    return sum;
}

}  // namespace tangi
