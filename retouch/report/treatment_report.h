// treatment_report.h: the report of a treatment, for people and for other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "retouch/treatment/treatment.h"
#include "surface/base/progress.h"

namespace tangi {

// Writes one page (NAME.html, pictures within, no scripts) and the same as A4 pages (NAME.pdf), with the
// headings of EN 16095 (condition recording) and EN 16853 (conservation process): identification, examination
// with the light directions, condition with the damage map, measures with layers and recipes, the result:
// states side by side under normal and raking light, quality maps; the log with its hashes. The PDF has the
// masks at scale too. `page` names either of the two. Beside it:
//   NAME.annotations.json   damage as W3C Web Annotations with SVG selectors (Web Annotation Data Model 2017)
//   NAME.manifest.json      the same on an IIIF Presentation 3.0 canvas with the picture
// Their identifiers are addresses below `published_at` ("https://museum.example/42/"), where the files are to
// be found; URNs without, which programs that show IIIF do not open.
//   NAME.picture.jpg, NAME.damage.png
//   NAME.mask.colour.pdf, NAME.mask.white.pdf   fills and retouches at 1:1 on a page of their size: in their
//                           colours, and white on black
// Throws Error where the treatment does not pass its check(), naming the first fault. Gives the paths.
std::vector<std::filesystem::path> write_treatment_report(const Treatment& treatment,
                                                          const std::filesystem::path& page,
                                                          const std::string& tool,
                                                          const Progress& progress = {},
                                                          const std::string& published_at = "");

// Outlines of the classes of damage as annotations, and a manifest with the same, of the files of a report
// that is called `name`.
nlohmann::json web_annotations(const Treatment& treatment, const std::string& name,
                               const std::string& published_at = "");
nlohmann::json iiif_manifest(const Treatment& treatment, const std::string& name,
                             const std::string& published_at = "");

// "M10 20L30 40ZM…": polygons as an SVG path, to a tenth of a pixel.
std::string svg_path(const std::vector<Polygon>& polygons, double scale = 1);

}  // namespace tangi
