// export_openlime.cpp: the maps of a painting as OpenLIME takes them, and a page that shows them.
#include <fmt/format.h>

#include <algorithm>

#include "cli/arguments.h"
#include "cli/export/exporter.h"
#include "cli/export/openlime_annotations.h"
#include "fit/exchange/export_maps.h"
#include "surface/base/html_escape.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/publish/tile_pyramid.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// [pixels] Larger pictures are shown as tiles: textures of phones end at 4096.
constexpr int kLargestWhole_px = 2048;

constexpr const char* kPage = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="@PROGRAM@">
<title>@TITLE@</title>
<style>
html, body, .openlime { margin: 0; width: 100%; height: 100%; background: #222; overflow: hidden; touch-action: none; position: relative }
/* OpenLIME shows f, not pi f, and takes no exposure: 1.68 is pi, sRGB-encoded. */
.openlime > canvas { width: 100%; height: 100%; filter: brightness(1.68) }
.openlime-overlay { position: absolute; top: 0; width: 100%; height: 100% }
#notes { position: absolute; left: 12px; bottom: 12px; max-width: min(420px, calc(100vw - 24px)); max-height: 40vh; overflow-y: auto; margin: 0; padding: 0;
  list-style: none; font: 14px/1.45 system-ui, sans-serif }
#notes button { display: block; width: 100%; min-height: 44px; margin-top: 4px; padding: 6px 12px; font: inherit; text-align: left; white-space: pre-line;
  color: #f0eee9; background: #1b1b1ae6; border: 1px solid #fff4; border-radius: 7px; cursor: pointer }
#notes button[aria-pressed="true"] { border-color: #ffe9a8; outline: 1px solid #ffe9a8 }
#notes button:focus-visible { outline: 2.5px solid #7fd0cb; outline-offset: 2px }
</style>
</head>
<body>
<div class="openlime"></div>
<ol id="notes" aria-label="Annotations" hidden></ol>
<!-- For OpenLIME 1.2.6, which is not part of this folder: put its openlime.esm.js here (npm install openlime,
     node_modules/openlime/dist/js), and hand the folder out by a web server. -->
<script type="module">
import * as OpenLIME from './openlime.esm.js';
const viewer = new OpenLIME.Viewer('.openlime');
const layer = new OpenLIME.Layer(@LAYER@);
viewer.addLayer('painting', layer);
const light = (x, y) => layer.setLight([x, y], 0);
const begin = () => { light(-0.5, 0.5); document.body.dataset.state = 'ready'; };
if (layer.status === 'ready') begin();
else layer.addEvent('ready', begin);
addEventListener('pointermove', event => {
  if (event.shiftKey) light(2 * event.clientX / innerWidth - 1, 1 - 2 * event.clientY / innerHeight);
});
const annotations = @ANNOTATIONS@.map(a => ({...a, visible: true, needsUpdate: true, elements: []}));
if (annotations.length) {
  const style = `.openlime-annotation { fill: none; stroke: #ffe9a8; stroke-width: 2px; vector-effect: non-scaling-stroke; pointer-events: all; cursor: pointer }
    text.openlime-annotation { fill: #ffe9a8; stroke: none } .openlime-annotation.selected { fill: #ffe9a833; stroke-width: 4px }`;
  const notes = new OpenLIME.Layer({type: 'svg_annotations', layout: layer.layout, annotations, style, overlayElement: viewer.overlayElement});
  const list = document.getElementById('notes');
  list.hidden = false;
  notes.addEvent('selected', chosen => {
    if (chosen.data.light) light(...chosen.data.light);
    annotations.forEach((a, i) => {
      const button = list.children[i].firstChild;
      button.setAttribute('aria-pressed', a === chosen);
      button.innerHTML = a === chosen && a.description || a.label;
    });
  });
  for (const annotation of annotations) {
    const button = list.appendChild(document.createElement('li')).appendChild(document.createElement('button'));
    button.innerHTML = annotation.label;  // escaped by who wrote this page
    button.onclick = () => { notes.clearSelected(); notes.setSelected(annotation); };
  }
  viewer.addLayer('annotations', notes);
}
</script>
</body>
</html>
)";

std::string with(std::string text, std::string_view what, const std::string& by) {
    return text.replace(text.find(what), what.size(), by);
}

// Beside the maps, which stay as they are: other programs read them, and `import`.
void write_page(const ExportJob& job, const nlohmann::json& annotations, const fs::path& folder) {
    const nlohmann::json brdf = read_json(read_text_file(folder / "brdf.json"), "brdf.json");
    nlohmann::json channels = brdf.at("channels");
    const Image<Rgb> kd = read_picture(folder / "kd.png");
    const bool tiled = std::max(kd.width(), kd.height()) > kLargestWhole_px;
    if (tiled) {
        make_folder(folder / "tiles");
        for (auto& [name, file] : channels.items()) {
            const fs::path tiles = fs::path("tiles") / (name + ".dzi");
            // Normals and gloss are numbers, which JPEG would smear.
            const bool is_colour = name == "kd" || name == "ks";
            const Image<Rgb> map = read_picture(folder / file.get<std::string>());
            write_deep_zoom(folder / tiles, source_of(map), {.jpeg_quality = 92}, job.progress,
                            is_colour ? "jpg" : "png");
            file = tiles.generic_string();
        }
    }
    const nlohmann::json layer = {{"type", "brdf"},
                                  {"layout", tiled ? "deepzoom" : "image"},
                                  {"channels", channels},
                                  {"colorspaces", brdf.at("colorspaces")},
                                  {"alphaLimits", brdf.at("alphaLimits")},
                                  {"pixelSize", brdf.at("mm_per_pixel")}};
    const PictureNotes notes = job.notes("");
    std::string page = with(kPage, "@PROGRAM@", job.program());
    page = with(std::move(page), "@TITLE@", escaped(valid_utf8(notes.title)));
    page = with(std::move(page), "@LAYER@", json_line(layer));
    const std::string listed = json_line(openlime_annotations(annotations, kd.width(), kd.height()));
    write_text_file(folder / "index.html", with(std::move(page), "@ANNOTATIONS@", inside_script(listed)));
}

std::vector<std::string> lost_to_openlime(const std::string& painting, const Surface& surface) {
    std::vector<std::string> lost;
    if (!surface.lobe_axes.empty())
        lost.push_back(
            fmt::format("{}: its gloss is anisotropic in places (brushed metal, a weave), which "
                        "OpenLIME's maps cannot hold: they are written as round ones of the same mean "
                        "roughness; --to maps keeps them",
                        painting));
    if (surface.reflectance_model.second_lobe_weight > 0)
        lost.push_back(fmt::format(
            "{}: a part of its gloss, {:.2g}, is a second lobe of twice the roughness, which OpenLIME's maps "
            "cannot hold: highlights are shown narrower than they are; --to maps keeps it",
            painting, surface.reflectance_model.second_lobe_weight));
    if (surface.reflectance_model.diffuse_roughness > 0)
        lost.push_back(fmt::format(
            "{}: its matt paint reflects as rough surfaces do (diffuse roughness {:.2g}), which OpenLIME's "
            "maps cannot hold: slopes are shown after Lambert's law; --to maps keeps it",
            painting, surface.reflectance_model.diffuse_roughness));
    return lost;
}

}  // namespace

nlohmann::json export_openlime(const ExportJob& job) {
    const nlohmann::json annotations = job.annotations();
    const std::shared_ptr<const Surface> surface = job.seen_in_scale();
    nlohmann::json result = export_folder(job.arguments.out, "brdf.json", [&](const fs::path& folder) {
        write_openlime(folder, *surface, job.progress);
        write_page(job, annotations, folder);
    });
    if (const auto lost = lost_to_openlime(job.arguments.painting, *surface); !lost.empty())
        result["warnings"] = told(lost);
    return result;
}

}  // namespace tangi
