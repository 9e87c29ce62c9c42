// session.h: a sitting at a canvas: events go in, paint changes. The window and replay() feed the same
// events.
#pragma once

#include <memory>
#include <optional>

#include "paint/canvas.h"
#include "paint/history.h"
#include "paint/journal.h"
#include "paint/palette.h"
#include "surface/progress.h"

namespace tangi {

class Session {
public:
    Session(std::shared_ptr<const Surface> dry, Palette palette,
            std::size_t undo_bytes = std::size_t(1) << 30);
    Session(Canvas canvas, Palette palette, std::size_t undo_bytes = std::size_t(1) << 30);

    Session(const Session&) = delete;  // a stroke under way refers to the canvas
    Session& operator=(const Session&) = delete;

    // Throws Error on what makes no sense here: a point without a stroke, a paint that the palette has not. A
    // stroke that begins while another is not over ends that one.
    void apply(const Event& event);
    // Ends a stroke that is under way.
    void finish();

    const Canvas& canvas() const { return canvas_; }
    Canvas& canvas() { return canvas_; }
    const History& history() const { return history_; }
    const Brush* brush() const { return brush_.get(); }

    // What was done so far.
    struct Totals {
        int strokes = 0, points = 0, steps = 0;
        double bristle_pixels = 0;
    };
    const Totals& totals() const { return totals_; }

private:
    void begin(const StrokeEvent& event);

    Canvas canvas_;
    Palette palette_;
    History history_;
    std::unique_ptr<Brush> brush_;
    std::optional<Stroke> stroke_;
    Totals totals_;
};

// All events of a journal. Errors name its file and line.
void replay(Session& session, const Journal& journal, const Progress& progress = {});

}  // namespace tangi
