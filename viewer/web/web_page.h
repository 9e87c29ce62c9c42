// web_page.h: a painting as a web page that needs nothing else: no network, no server, no plug-in.
//
// The page draws with WebGL 2 and the window's own shaders. It fetches tiles (web_tiles.h) as they come into
// view, coarse ones first, as scripts: a page that was opened from a disk may load scripts beside it, but
// neither read pictures nor other files.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// The numbers of a page; its words are in WebWords.
struct WebOptions {
    int shadow_side = 512;                                     // of the map of horizons, 0 for no shadows
    double light_azimuth_deg = 135, light_elevation_deg = 50;  // at the beginning

    // [dB] 0: tiles without losses. Else tiles are JPEG pictures (lossy_tiles.h), of the lowest quality by
    // which the painting is relit as well as that.
    double lossy_psnr_db = 0;

    // Beyond it no page of one file is written: browsers would read it all before they show anything.
    double largest_page_mb = 64;

    static constexpr std::string_view name = "web";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"shadow_side", 0, 1024, "px",
                        "web: longer side of the map that cast shadows come from; 0: no shadows"},
              self.shadow_side);
        visit(FieldInfo{"light_azimuth_deg", -360, 360, "deg",
                        "web: where the light is at first, counter-clockwise from the right"},
              self.light_azimuth_deg);
        visit(FieldInfo{"light_elevation_deg", 2, 90, "deg", "web: its height above the painting's plane"},
              self.light_elevation_deg);
        visit(FieldInfo{"lossy_psnr_db", 0, 60, "dB",
                        "web: a tenth of the bytes or so, by pictures with losses that relight as well as "
                        "this, such as "
                        "38; 0: without losses"},
              self.lossy_psnr_db);
        visit(FieldInfo{"largest_page_mb", 0.1, 2000, "MB", "web: largest page of one file (.html)"},
              self.largest_page_mb);
    }
};

struct WebWords {
    std::string title{}, credit{}, creator{};  // as people read them; credit and creator may be empty
    // What the painting is called by programs, an IRI: by it the browser keeps what is annotated. The title
    // where empty.
    std::string id{};
    nlohmann::json annotations = nlohmann::json::array();  // W3C Web Annotations, each with its selector
    nlohmann::json linked{};                               // JSON-LD of the page's head; null for none
    std::vector<std::string>
        origins{};  // of other sites whose pages it hears ("https://museum.example"; "*": all)
};

// One of several states of a painting, of the same pixels and scale: before and after, or with more and more
// paint.
struct WebState {
    std::string name;
    std::shared_ptr<const Surface> surface;
};

struct WebReport {
    std::vector<std::filesystem::path> files;  // the page, and the folder of its parts where there is one
    int levels = 0, tiles = 0;
    std::size_t bytes = 0;        // of all files, as they lie on the disk and are sent
    std::size_t first_bytes = 0;  // before the first picture: page and coarsest tiles
    // Of a page with losses: the quality of its JPEG pictures, how well they relight (under the first light,
    // the same one 15 degrees high, and that a quarter round), and what is left of heights [the surface's
    // unit].
    int jpeg_quality = 0;
    double psnr_db = 0, height_rms = 0;
    int shared_tiles = 0;  // that a state has of the one before it, and are written once
};

// `path` with the extension .html: one file that holds everything. Else a folder with index.html and
// parts/, made where it is missing; what was published there before is replaced, the page last. Throws Error
// where it cannot be written, where another program's page or parts lie there, and for a single page that
// would be larger than largest_page_mb; ContractError where states differ in size. All states are held in
// memory at once.
WebReport write_web_page(const std::filesystem::path& path, std::span<const WebState> states,
                         const WebWords& words, const WebOptions& options = {},
                         const Progress& progress = {});
// The same of one state.
WebReport write_web_page(const std::filesystem::path& path, const Surface& surface, const WebWords& words,
                         const WebOptions& options = {}, const Progress& progress = {});

}  // namespace tangi
