// session.h: a sitting at a canvas: events go in, paint changes. The window and replay() feed the same
// events.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "paint/canvas/canvas.h"
#include "paint/optics/palette.h"
#include "paint/session/history.h"
#include "paint/session/journal.h"
#include "surface/base/progress.h"

namespace tangi {

class Session {
public:
    Session(std::shared_ptr<const Surface> dry, Palette palette,
            std::size_t undo_bytes = std::size_t(1) << 30);
    Session(Canvas canvas, Palette palette, std::size_t undo_bytes = std::size_t(1) << 30);

    Session(const Session&) = delete;  // a stroke under way refers to the canvas
    Session& operator=(const Session&) = delete;

    // Goes on with what an earlier sitting left: its palette, and the brush with what is on it, whose paints
    // have the numbers of the ingredients at `place`. Before anything is painted.
    void take_up(std::optional<Canvas> board, std::unique_ptr<Brush> brush, Place place, bool goes_on);

    // Where the masks that events name are taken from, by their names.
    using Masks = std::function<std::shared_ptr<const Image<float>>(const std::string& name)>;
    void masks_from(Masks masks) { masks_ = std::move(masks); }

    // Throws Error on what makes no sense here: a point without a stroke, a paint that the palette has not.
    // Any event but a point ends a stroke that is not over.
    void apply(const Event& event);
    // Ends a stroke that is under way.
    void finish() { end_by(EndEvent{}); }
    // Likewise, since this event comes next, as apply() does by itself.
    void end_by(const Event& event);

    const Canvas& canvas() const { return canvas_; }
    Canvas& canvas() { return canvas_; }
    // The palette that paints are mixed on (mixing_board.h); null until an event uses it.
    const Canvas* board() const { return board_ ? &*board_ : nullptr; }
    Canvas* board() { return board_ ? &*board_ : nullptr; }
    const Palette& palette() const { return palette_; }

    // Undo and redo take what was done last, on the painting or on the palette, and what was on the brush
    // with it.
    const History& history() const { return history_; }
    void forget_history() { history_.forget(); }
    // What the user should know, once: that a layer has another name than was asked for, that a stroke
    // changed nothing, that piles do not fit on the palette, that the disk has no room for undo. One at a
    // time; empty where there is nothing more.
    std::string take_warning();

    // Has `look` called while strokes go on on the painting: when brushes were on it for `first_s` in all,
    // with what was painted until then on the canvas (Stroke::watch()). It gives when it is called next.
    void watch(double first_s, Stroke::Look look);
    // What is in the hand, null before the first stroke, and where it was used last: its paints have the
    // numbers of that canvas's ingredients.
    const Brush* brush() const { return brush_.get(); }
    Place brush_place() const { return brush_place_; }
    // The last stroke mixed paint on the palette, or went on with what was on the brush: who paints on goes
    // on with what is on it, and does not load it anew.
    bool brush_goes_on() const { return goes_on_; }
    // A stroke has begun and not ended.
    bool in_stroke() const { return order_.in_stroke(); }

    // What was done so far.
    struct Totals {
        int strokes = 0, points = 0, steps = 0;
        double bristle_pixels = 0;
    };
    const Totals& totals() const { return totals_; }

private:
    Canvas& on(Place place);
    std::vector<Portion> recipe_of(Canvas& canvas, PaintParts paint, const PaintFinish& finish);
    Brush& tool_for(const StrokeEvent& event, Canvas& canvas);
    void take_brush(const StrokeEvent& event, Canvas& canvas);
    void warn_of_what_is_not_used(const StrokeEvent& event);
    void begin(const StrokeEvent& event);
    void act(Place place, const std::function<void(Canvas&)>& action);
    void dry_paint(const DryEvent& event);
    void lay(const PileEvent& event);
    void lay_out(const PaletteEvent& event);
    void undo();
    void redo();
    void confine(const ConfineEvent& event);
    void take_hand(const std::optional<BrushInHand>& hand);
    void wash();
    void warn_of_no_effect(bool changed);

    Canvas canvas_;
    std::optional<Canvas> board_;
    Palette palette_;
    History history_;
    std::unique_ptr<Brush> brush_;
    std::optional<BrushInHand> hand_;  // the brush as the last stroke left it
    Place brush_place_ = Place::painting, stroke_place_ = Place::painting;
    bool goes_on_ = false;
    std::unique_ptr<Brush> eraser_;  // of the stroke under way, beside what is in the hand
    std::optional<Stroke> stroke_;
    Totals totals_;
    std::deque<std::string> warnings_;
    EventOrder order_;
    Masks masks_;
    std::string why_bare_;                  // should no paint be on the brush of the stroke
    double painted_s_ = 0, look_at_s_ = 0;  // by strokes that are over, on the painting
    Stroke::Look look_;
};

// All events of a journal. Errors name its file and line. What comes after the last undo and redo in it is
// not kept to be undone. Returns what the user should know (Session::take_warning()), with the journal's own
// warnings, by line, with file and line.
std::vector<std::string> replay(Session& session, const Journal& journal, const Progress& progress = {});

}  // namespace tangi
