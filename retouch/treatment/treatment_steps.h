// treatment_steps.h: the steps of a treatment: each changes the canvas, says what came out, and is logged.
//
// What the command line and the window share. The canvas is that of treatment.read_canvas(), or one that goes
// on from it; where a step throws, the log and the files are as before, and the canvas is to be thrown away.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "retouch/fill/fill.h"
#include "retouch/treatment/treatment.h"

namespace tangi {

// Where a step works.
struct StepArea {
    Mask mask;
    nlohmann::json described = nlohmann::json::object();  // for the log
    std::vector<std::filesystem::path> inputs{};          // files that it was read from
};
// The union of classes of damage; empty coverage without any.
StepArea area_of_classes(const Treatment& treatment, const std::set<DamageClass>& classes);

// Where paint, or its ground, is missing: losses, flaking, old fills.
Mask damaged(const Treatment& treatment);

// Says in `results` of a layer, from its paint, how much of it lies on original ("on_original": outside of
// all mapped damage) and how much outside of the step's own area ("outside_area"), with a warning of the
// former.
void count_beside(nlohmann::json& results, const Treatment& treatment, const DriedLayer& layer,
                  const Mask& area);

nlohmann::json fill_step(Treatment& treatment, Canvas& canvas, const StepArea& area, const Filling& filling,
                         const Author& author, const Progress& progress = {});

struct Varnishing {
    bool isolating = false;
    const StepArea* area = nullptr;  // null: all of the painting
    VarnishOptions options{};
};
nlohmann::json varnish_step(Treatment& treatment, Canvas& canvas, const Varnishing& varnishing,
                            const Author& author, const Progress& progress = {});

// What was painted by hand.
struct HandRetouch {
    StepArea area;
    TreatmentStep step{};  // what is known beyond that: parameters, results, strokes
    std::string source{};  // where it was painted: named where there is nothing of it
};
// Takes it into the treatment: wet paint is dried as a layer with a new name, layers that the log does not
// know are retouches too. Throws Error naming the source where nothing was painted.
nlohmann::json retouch_step(Treatment& treatment, Canvas& canvas, HandRetouch retouch, const Author& author,
                            const Progress& progress = {});

// Takes layers off, and keeps them, so that undo brings them back. Throws Error, saying which there are,
// where one is not there.
nlohmann::json remove_step(Treatment& treatment, Canvas& canvas, const std::vector<std::string>& layers,
                           const Author& author, const Progress& progress = {});

// The step that undo_step() would undo: "take off fill 1", "lay retouch 2", "draw stain"; empty where there
// is none. `refused` says why it cannot be undone; empty where it can.
struct NextUndo {
    std::string step, refused;
};
NextUndo next_undo(const Treatment& treatment);

// Undoes the last step that was not undone and of which a layer is still on the painting, that changed the
// map of damage, or that took layers off: what is left of its layers is taken off, masks are again what they
// were before, layers lie again where they lay, bit for bit, and a new line of the log names the step. The
// log forgets nothing: step and undoing are both in it. What was undone does not come back by it. Throws
// Error where there is no such step, or it took layers off and kept nothing of them (of an earlier version).
nlohmann::json undo_step(Treatment& treatment, Canvas& canvas, const Author& author,
                         const Progress& progress = {});

// The damage of a class, as it was drawn.
struct DrawnDamage {
    DamageClass damage;
    const Mask& mask;
    nlohmann::json parameters;  // how it came about
};
// Puts its mask in the place of what the class has.
nlohmann::json draw_step(Treatment& treatment, const DrawnDamage& drawn, const Author& author,
                         const Progress& progress = {});

}  // namespace tangi
