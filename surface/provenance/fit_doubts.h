// fit_doubts.h: what a fit had doubts about, kept with the painting, in its provenance.
#pragma once

#include <string>
#include <vector>

#include "surface/maps/surface.h"

namespace tangi {

// `poor`: what makes the numbers poor; `warnings`: what else is to be known. Provenance that is no JSON
// object is kept in one, as `made_of`.
std::string with_doubts(const std::string& provenance, const std::vector<std::string>& poor,
                        const std::vector<std::string>& warnings);

// What makes its numbers poor.
std::vector<std::string> poor_of(const Surface& surface);
// All of them, what is poor first, each once; none where the painting was made without.
std::vector<std::string> doubts_of(const Surface& surface);

}  // namespace tangi
