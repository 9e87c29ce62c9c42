// random_journal.h: a journal of everything that can happen at a canvas, drawn from a seed.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "surface/base/noise.h"
#include "tests/support/paint/journal_text.h"

namespace tangi {

class RandomJournal {
public:
    RandomJournal(std::uint64_t seed, double width_mm, double height_mm)
        : seed_(seed), width_mm_(width_mm), height_mm_(height_mm) {}

    // The text of a journal with so many events; strokes count as one.
    std::string text(int events) {
        text_ = kJournalHeader;
        line(R"({"event": "palette", "paints": "all"})");
        for (int i = 0; i < events; ++i) event(i);
        return text_;
    }

private:
    double between(double low, double high) {
        return low +
               (high - low) * static_cast<double>(procedural::uniform(procedural::hash(seed_, drawn_++)));
    }
    int below(int count) { return static_cast<int>(between(0, count)); }
    void line(const std::string& text) { text_ += text + "\n"; }

    void event(int number) {
        switch (below(12)) {
            case 0:
                if (undoable_ > 0) line(R"({"event": "undo"})"), --undoable_, ++redoable_;
                return;
            case 1:
                if (redoable_ > 0) line(R"({"event": "redo"})"), ++undoable_, --redoable_;
                return;
            case 2:
                line(fmt::format(R"({{"event": "dry", "layer": "layer {}", "part": {:.3f}}})", number,
                                 between(0.2, 1)));
                // Where nothing is wet, nothing is done: what can be undone is not known after it.
                undoable_ = redoable_ = 0;
                return;
            case 3:
                line(fmt::format(
                    R"({{"event": "pile", "on": "painting", "paint": {{"Cadmium Orange": 1}}, "x": {:.2f}, "y": {:.2f}, "size_mm": {:.2f}}})",
                    between(-0.3, 0.3) * width_mm_, between(-0.3, 0.3) * height_mm_, between(4, 12)));
                done();
                return;
            default:
                stroke(below(5) == 0);
        }
    }
    void done() { ++undoable_, redoable_ = 0; }
    // A stroke that changes nothing cannot be undone: after one that may be such, one undo at most is sure,
    // of what it or the one before it did.
    void done_once() { undoable_ = std::min(undoable_ + 1, 1), redoable_ = 0; }

    void stroke(bool on_palette) {
        constexpr const char* kTools[] = {"round", "flat",   "filbert", "fan",    "knife",
                                          "rag",   "smudge", "scrape",  "eraser", "height eraser"};
        constexpr const char* kPaints[] = {"Titanium White", "Bone Black", "Cobalt Blue", "Cadmium Orange"};
        const double size = between(3, 16);
        line(fmt::format(
            R"({{"event": "stroke", "brush": {{"preset": "{}", "size_mm": {:.2f}}}, "on": "{}", "paint": {{"{}": {:.3f}, "{}": {:.3f}}}, "load": {:.2f}, "start": "{}", "medium": {:.2f}, "pressure_gamma": {:.2f}, "seed": {}}})",
            kTools[below(10)], size, on_palette ? "palette" : "painting", kPaints[below(2)], between(0.2, 2),
            kPaints[2 + below(2)], between(0.2, 2), between(0.2, 1.2), below(3) == 0 ? "dirty" : "clean",
            below(3) == 0 ? between(0, 0.8) : 0.0, between(0.6, 1.8), below(100000)));
        double x = between(-0.5, 0.5) * width_mm_, y = between(-0.5, 0.5) * height_mm_, t = 0;
        double heading = between(0, 6.28), tilt = between(0, 0.6), rotation = between(-180, 180);
        for (int i = 0, points = 2 + below(12); i < points; ++i) {
            line(fmt::format(
                R"({{"event": "point", "t": {:.4f}, "x": {:.4f}, "y": {:.4f}, "p": {:.3f}, "tx": {:.4f}, "ty": {:.4f}, "r": {:.2f}}})",
                t, x, y, between(0.1, 1), tilt * std::cos(heading), tilt * std::sin(heading), rotation));
            heading += between(-0.8, 0.8);
            rotation += between(-10, 10);
            t += between(0.005, 0.08);
            x += between(1, 9) * std::cos(heading);
            y += between(1, 9) * std::sin(heading);
        }
        line(R"({"event": "end"})");
        done_once();
    }

    std::uint64_t seed_, drawn_ = 0;
    double width_mm_, height_mm_;
    int undoable_ = 0, redoable_ = 0;
    std::string text_;
};

}  // namespace tangi
