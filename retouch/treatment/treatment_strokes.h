// treatment_strokes.h: the journals of strokes that a treatment's log vouches for, what is kept with them,
// and whether they make their layers again.
#pragma once

#include <string>
#include <vector>

#include "paint/optics/palette.h"
#include "retouch/treatment/confining_mask.h"
#include "retouch/treatment/treatment.h"

namespace tangi {

// Strokes of a journal that are to be painted in a session, confined to a mask, with what makes them again:
// before they are, with a clean brush and palette, the session's paints.
TreatmentStrokes strokes_within(const ConfiningMask& mask, const Journal& journal, const Session& session);

// Journals under strokes/ that are as they were logged, and yet cannot be read, or hold a point of no stroke:
// a line each, naming file and line. Those that are missing are the matter of Treatment::check().
std::vector<std::string> strokes_that_cannot_be_repeated(const Treatment& treatment);

struct StrokesRepeated {
    std::vector<std::string> faults;  // a line each: a journal that makes another layer, or none
    int painted_again = 0;            // journals that make what was logged
    // Journals of which it cannot be told: of earlier versions, of layers that were removed, or that lie on
    // such.
    int not_repeated = 0;
};
// Paints the strokes of all retouches again, each on the layers below it, and compares what they make with
// the log. `canvas`: Treatment::read_canvas().
StrokesRepeated repeat_strokes(const Treatment& treatment, const Canvas& canvas,
                               const Progress& progress = {});

}  // namespace tangi
