#include "paint/session.h"

#include "surface/error.h"
#include "surface/noise.h"

namespace tangi {

Session::Session(std::shared_ptr<const Surface> dry, Palette palette, std::size_t undo_bytes)
    : Session(Canvas(std::move(dry)), std::move(palette), undo_bytes) {}

Session::Session(Canvas canvas, Palette palette, std::size_t undo_bytes)
    : canvas_(std::move(canvas)), palette_(std::move(palette)), history_(undo_bytes) {}

void Session::begin(const StrokeEvent& event) {
    finish();
    std::vector<Portion> recipe;
    for (const auto& [name, part] : event.paint) recipe.push_back({canvas_.add(palette_.at(name)), part});
    // The bristles are the brush's own: another seed, or another stroke with a washed brush, grows other
    // ones.
    auto brush =
        std::make_unique<Brush>(event.brush, canvas_.mm_per_pixel(), procedural::hash(event.seed, 1));
    if (event.start != BrushStart::clean && brush_) brush->take_over(*brush_);
    if (event.start != BrushStart::same && !recipe.empty())
        brush->load(recipe, event.load, event.start == BrushStart::dirty);
    stroke_.reset();
    brush_ = std::move(brush);
    history_.begin(canvas_);
    stroke_.emplace(canvas_, *brush_, event.options, procedural::hash(event.seed, 2));
    ++totals_.strokes;
}

void Session::finish() {
    if (!stroke_) return;
    stroke_->finish();
    totals_.steps += stroke_->steps();
    totals_.bristle_pixels += stroke_->bristle_pixels();
    stroke_.reset();
    history_.end(canvas_);
}

void Session::apply(const Event& event) {
    if (const auto* point = std::get_if<PointEvent>(&event)) {
        if (!stroke_) fail("a point comes before any stroke has begun");
        stroke_->add(point->point);
        ++totals_.points;
        return;
    }
    finish();
    if (const auto* stroke = std::get_if<StrokeEvent>(&event)) {
        begin(*stroke);
    } else if (std::holds_alternative<UndoEvent>(event)) {
        if (!history_.undo(canvas_)) fail("there is nothing to undo");
    } else if (std::holds_alternative<RedoEvent>(event)) {
        if (!history_.redo(canvas_)) fail("there is nothing to redo");
    } else if (const auto* drying = std::get_if<DryEvent>(&event)) {
        history_.begin(canvas_);
        dry(canvas_, drying->layer, canvas_.region(), drying->part);
        history_.end(canvas_);
    } else if (const auto* lift = std::get_if<LiftEvent>(&event)) {
        const auto& layers = canvas_.dried();
        const bool known =
            std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return l.name == lift->layer; });
        if (known) history_.begin(canvas_);
        lift_off(canvas_, lift->layer);
        history_.end(canvas_);
    }
}

void replay(Session& session, const Journal& journal, const Progress& progress) {
    const auto count = static_cast<double>(journal.entries.size());
    for (std::size_t i = 0; i < journal.entries.size(); ++i) {
        report(progress, "replay strokes", static_cast<double>(i) / count);
        try {
            session.apply(journal.entries[i].event);
        } catch (const Error& error) {
            fail("{}:{}: {}", journal.source, journal.entries[i].line, error.what());
        }
    }
    session.finish();
    report(progress, "replay strokes", 1);
}

}  // namespace tangi
