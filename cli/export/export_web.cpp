// export_web.cpp: the web page of a painting, as a folder or as one file.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/export/exporter.h"
#include "cli/export/web_origin.h"
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// The canvas with so many of its dried layers, and its wet paint or none.
Canvas canvas_with(const Canvas& canvas, std::size_t layers, bool wet) {
    Canvas part = canvas;
    part.writable_dried().resize(layers);
    if (!wet) part.writable_wet() = PaintLayer(canvas.width(), canvas.height());
    return part;
}

std::shared_ptr<const Surface> seen(const Canvas& canvas, const Progress& progress) {
    return in_scale_of(canvas, shown(canvas, {}, progress));
}

// Without paint, with each layer on those before it, and with what is wet.
std::vector<WebState> states_of_layers(const ExportJob& job) {
    const auto& dried = job.canvas().dried();
    const bool wet = !job.canvas().wet().empty();
    if (dried.empty() && !wet)
        fail("--layers: {} has no layers of paint; --state compares it with another painting file",
             job.arguments.painting);
    std::vector<WebState> states = {
        {"Without paint", seen(canvas_with(job.canvas(), 0, false), job.progress)}};
    for (std::size_t i = 0; i < dried.size(); ++i)
        states.push_back({dried[i].name, seen(canvas_with(job.canvas(), i + 1, false), job.progress)});
    if (wet) states.push_back({"Wet paint", seen(job.canvas(), job.progress)});
    return states;
}

// "Before=before.exr", or a file alone, which is called as it is.
std::pair<std::string, fs::path> name_and_file(const std::string& words) {
    const auto equals = words.find('=');
    if (equals == std::string::npos || fs::exists(words)) return {fs::path(words).stem().string(), words};
    if (equals == 0 || equals + 1 == words.size())
        throw UsageError(fmt::format("--state {}: is a name and a file, NAME=PAINTING.exr", words));
    return {words.substr(0, equals), words.substr(equals + 1)};
}

WebState earlier_state(const ExportJob& job, const std::string& words) {
    const auto [name, file] = name_and_file(words);
    const Canvas canvas = read_canvas(file, job.progress);
    const Canvas& now = job.canvas();
    if (canvas.width() != now.width() || canvas.height() != now.height())
        fail(
            "--state {}: {} has {} × {} pixels, {} has {} × {}; fit the later one with --align-to the "
            "earlier",
            words, file.string(), canvas.width(), canvas.height(), job.arguments.painting, now.width(),
            now.height());
    if (canvas.scale_known() != now.scale_known() || !same_scale(canvas.mm_per_pixel(), now.mm_per_pixel()))
        fail("--state {}: {} and {} have pixels of different sizes; fit both with the same --mm-per-pixel",
             words, file.string(), job.arguments.painting);
    return {name, seen(canvas, job.progress)};
}

// The earliest first; the painting itself is the last.
std::vector<WebState> states_of(const ExportJob& job) {
    std::vector<WebState> states;
    for (const std::string& words : job.arguments.states) states.push_back(earlier_state(job, words));
    if (job.arguments.paint_layers) {
        for (WebState& state : states_of_layers(job)) states.push_back(std::move(state));
    } else {
        states.push_back(
            {states.empty() ? job.arguments.words.title : fs::path(job.arguments.painting).stem().string(),
             seen(job.canvas(), job.progress)});
    }
    return states;
}

// Who looks at a page tells its states by their names.
void require_names_that_differ(const ExportArguments& a) {
    std::set<std::string> names;
    if (!a.paint_layers) names.insert(fs::path(a.painting).stem().string());
    for (const std::string& words : a.states)
        if (const std::string name = name_and_file(words).first; !names.insert(name).second)
            throw UsageError(
                fmt::format("--state {}: two states are called {}; name this one otherwise: --state "
                            "NAME=PAINTING.exr",
                            words, name));
}

// As browsers name them, each once.
std::vector<std::string> origins_of(const ExportArguments& a) {
    std::vector<std::string> origins;
    for (const std::string& words : a.origins)
        if (std::string sent = origin_as_sent(words); std::ranges::find(origins, sent) == origins.end())
            origins.push_back(std::move(sent));
    return origins;
}

// What the painting came from, as schema.org has it: names, sizes and hashes.
json works_behind(const Surface& surface) {
    const json provenance = json_or_discarded(surface.provenance);
    json works = json::array();
    if (!provenance.is_object()) return works;
    for (const json& input : provenance.value("inputs", json::array())) {
        if (!input.is_object() || !input.contains("file")) continue;
        json work = {{"@type", "MediaObject"}, {"name", input["file"]}};
        if (input.contains("sha256")) work["sha256"] = input["sha256"];
        if (input.contains("bytes"))
            work["contentSize"] = fmt::format("{} B", input["bytes"].get<std::size_t>());
        if (input.contains("modified")) work["dateModified"] = input["modified"];
        works.push_back(std::move(work));
    }
    return works;
}

// schema.org's VisualArtwork: the painting; its encoding: this page, made of the painting's file.
json linked_data(const ExportJob& job, const Surface& surface, const PictureNotes& notes) {
    json file = {{"@type", "MediaObject"}, {"name", fs::path(job.arguments.painting).filename().string()}};
    if (!notes.source.empty()) file["sha256"] = notes.source.substr(notes.source.find(':') + 1);
    if (const json works = works_behind(surface); !works.empty()) file["isBasedOn"] = works;
    json artwork = {
        {"@context", "https://schema.org"},
        {"@type", "VisualArtwork"},
        {"name", valid_utf8(notes.title)},
        {"encoding",
         {{"@type", "MediaObject"},
          {"encodingFormat", "text/html"},
          {"isBasedOn", file},
          {"creator",
           {{"@type", "SoftwareApplication"}, {"name", "TangiPaint"}, {"softwareVersion", version()}}}}}};
    if (!notes.creator.empty())
        artwork["creator"] = {{"@type", "Person"}, {"name", valid_utf8(notes.creator)}};
    if (!notes.credit.empty()) artwork["creditText"] = valid_utf8(notes.credit);
    const auto length = [&](int pixels) {
        return json{
            {"@type", "QuantitativeValue"}, {"value", pixels * surface.mm_per_pixel}, {"unitCode", "MMT"}};
    };
    if (surface.scale_known) {
        artwork["width"] = length(surface.width());
        artwork["height"] = length(surface.height());
    }
    return artwork;
}

void tell_losses(const WebReport& report, const ExportArguments& a, json& result) {
    result["jpeg_quality"] = report.jpeg_quality;
    result["psnr_db"] = report.psnr_db;
    result["height_rms"] = report.height_rms;
    if (report.psnr_db < a.web.lossy_psnr_db)
        result["warnings"] = told(
            {fmt::format("{}: is relit with a PSNR of {:.1f} dB, not the {} of --lossy-psnr-db; leave it "
                         "out for a page without losses",
                         a.out, report.psnr_db, a.web.lossy_psnr_db)});
}

}  // namespace

json export_web(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    const fs::path page =
        lower_extension(a.out) == ".html" ? fs::path(a.out) : fs::path(a.out) / "index.html";
    if (page != fs::path(a.out) && fs::exists(a.out) && !fs::is_directory(a.out))
        fail("--out {}: is a file; give a folder, or a page of one file, .html", a.out);
    std::vector<fs::path> inputs = {a.painting};
    for (const std::string& words : a.states) inputs.push_back(name_and_file(words).second);
    if (!a.annotations.empty()) inputs.emplace_back(a.annotations);
    require_names_that_differ(a);
    refuse_to_overwrite(page, inputs);
    const PictureNotes notes = job.notes("");
    WebWords words = a.words;
    words.title = notes.title;
    words.creator = a.creator;
    words.origins = origins_of(a);
    words.annotations = job.annotations();  // what is wrong with them is known before the work
    if (!notes.source.empty()) words.id = "urn:tangipaint:" + notes.source.substr(notes.source.find(':') + 1);
    const std::vector<WebState> states = states_of(job);
    words.linked = linked_data(job, *states.back().surface, notes);
    const WebReport report = write_web_page(a.out, states, words, a.web, job.progress);
    json files = json::array();
    for (const fs::path& path : report.files) files.push_back(path.string());
    json result = {{"files", files},
                   {"levels", report.levels},
                   {"tiles", report.tiles},
                   {"bytes", report.bytes},
                   {"first_picture_bytes", report.first_bytes}};
    if (report.jpeg_quality > 0) tell_losses(report, a, result);
    if (states.size() > 1) {
        result["shared_tiles"] = report.shared_tiles;
        for (const WebState& state : states) result["states"].push_back(state.name);
    }
    return result;
}

}  // namespace tangi
