// treatment_report.h: the report of a treatment, for people and for other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "paint/retouch/treatment.h"
#include "surface/progress.h"

namespace tangi {

// Writes one page (HTML, pictures within, no scripts), with the headings of EN 16095 (condition recording)
// and EN 16853 (conservation process): identification, condition with the damage map, measures with
// parameters and recipes, layers, state before and after under normal and raking light, the log with its
// hashes. Its style sheet makes it print on A4. Beside it:
//   NAME.annotations.json   damage as W3C Web Annotations with SVG selectors (Web Annotation Data Model 2017)
//   NAME.manifest.json      the same on an IIIF Presentation 3.0 canvas with the picture
//   NAME.picture.jpg, NAME.damage.png
//   NAME.mask.colour.html, NAME.mask.white.html   printable masks at scale, in mm: additions in the
//   painting's
//                           colours, and white on black
// Throws Error where the treatment does not pass its check(), naming the first fault. Gives the paths.
std::vector<std::filesystem::path> write_treatment_report(const Treatment& treatment,
                                                          const std::filesystem::path& html,
                                                          const std::string& tool,
                                                          const Progress& progress = {});

// Outlines of a class of damage as annotations; `target` is the picture that they are on.
nlohmann::json web_annotations(const Treatment& treatment, const std::string& target);
nlohmann::json iiif_manifest(const Treatment& treatment, const std::string& picture);

// "M10 20L30 40ZM…": polygons as an SVG path, to a tenth of a pixel.
std::string svg_path(const std::vector<Polygon>& polygons, double scale = 1);

}  // namespace tangi
