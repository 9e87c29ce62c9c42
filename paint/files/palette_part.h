// palette_part.h: what lies beside a painting while it is painted, in its file: the palette with all that was
// mixed on it, and the brush with what is on it. A sitting that goes on with them paints the same bits as one
// that was never interrupted.
//
// Part `palette`: as part `wet` (paint_parts.h), of the palette's own size, with ingredients of its own. Part
// `brush`: the bristles' loads (`volume.NNNNN` and `total`, mm), row by row; its attribute `brush` is JSON:
// settings, seed, rotation_rad, on which canvas it was used last (`painting` or `palette`), whose ingredients
// the numbers are of, and goes_on (Session::brush_goes_on()).
#pragma once

#include <filesystem>
#include <vector>

#include "paint/session/session.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_reader.h"

namespace tangi {

// The session's palette and brush as they are now: it may go on.
std::vector<PartToWrite> tools_of(const Session& session);

// The parts to write beside the painting: those of `beside` that are something else, and these tools.
std::vector<PartToWrite> with_tools(std::vector<PartToWrite> beside, const std::vector<PartToWrite>& tools);
std::vector<PartToWrite> with_tools(std::vector<PartToWrite> beside, const Session& session);

// Of parts, those that are palette and brush.
std::vector<PartToWrite> tools_among(const std::vector<PartToWrite>& parts);

// Gives a session, in which nothing was painted yet, the palette and the brush in a painting file; nothing
// where it has none. Throws Error naming the file, the part and the place.
void read_tools(const std::filesystem::path& path, Session& session, const Progress& progress = {});

// Whether there is paint on a painting, or a palette or brush beside it.
bool has_paint_or_tools(const PaintingHeader& header);

}  // namespace tangi
