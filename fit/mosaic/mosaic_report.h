// mosaic_report.h: how a mosaic was made of its positions, as JSON, as lines for a terminal and as a page
// with a picture of the layout.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fit/mosaic/make_mosaic.h"

namespace tangi {

// {"width", "height", "positions": [{"name", "joined", "to_wall", "sigma_px", …}], "overlaps": […], "seams":
// […], "left_out": […], …}; docs/reference/result-json.md says all fields.
nlohmann::json to_json(const std::vector<MosaicPosition>& positions, const MosaicReport& report);

// SVG: the outlines of the positions on the wall with their names, and a line for each overlap, from centre
// to centre, in the colour of its residual (green below half of what makes a mosaic poor, red above it).
std::string layout_picture(const std::vector<MosaicPosition>& positions, const MosaicReport& report,
                           const MosaicOptions& options);

// Whole page, one file. Whatever names contain, they stay text.
std::string mosaic_page(const std::vector<MosaicPosition>& positions, const MosaicReport& report,
                        const MosaicOptions& options, const std::string& title);

}  // namespace tangi
