// file_kinds.h: every kind of file that the program reads: a small whole one, and what reads it.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "capture/formats/capture_file.h"
#include "capture/formats/chart_reference.h"
#include "capture/formats/dome_file.h"
#include "capture/formats/lens_file.h"
#include "capture/formats/lights_file.h"
#include "capture/formats/relight_file.h"
#include "capture/photo/brackets.h"
#include "capture/photo/photo_file.h"
#include "capture/photo/photo_metadata.h"
#include "capture/photo/stated_transfer.h"
#include "capture/stack/profile_colours.h"
#include "fit/exchange/import_maps.h"
#include "fit/exchange/ptm_rti_file.h"
#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "paint/session/session.h"
#include "retouch/colour_match/pigment_pairs.h"
#include "retouch/mask/mask.h"
#include "retouch/treatment/treatment_folder.h"
#include "retouch/treatment/treatment_log.h"
#include "surface/file/sha256.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/overview.h"
#include "surface/publish/web_annotations.h"
#include "tests/support/capture/picture_metadata.h"
#include "tests/support/test_support.h"

namespace tangi {

struct FileKind {
    std::string name;  // of a file
    std::string whole;
    std::function<void(const std::filesystem::path&)> read;
};

const char* const kJournal =
    "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
    "{\"event\": \"palette\", \"paints\": [\"Titanium White\", \"Bone Black\"]}\n"
    "{\"event\": \"pile\", \"on\": \"painting\", \"paint\": {\"Pyrrole Red\": 1, \"Bone Black\": 2}, \"x\": "
    "1, "
    "\"y\": -1, \"size_mm\": 5, \"medium\": 0.5}\n"
    "{\"event\": \"dry\", \"layer\": \"first\", \"part\": 0.5, \"circle\": {\"x\": 0, \"y\": 0, "
    "\"radius_mm\": "
    "4}}\n"
    "{\"event\": \"stroke\", \"brush\": {\"preset\": \"flat\", \"size_mm\": 4}, \"paint\": {\"Hansa Yellow "
    "Opaque\": "
    "1}, \"load\": 0.5, \"start\": \"clean\", \"seed\": 3}\n"
    "{\"event\": \"point\", \"t\": 0, \"x\": -4, \"y\": 0, \"p\": 0.7, \"tx\": 0.1, \"r\": 20}\n"
    "{\"event\": \"point\", \"t\": 0.5, \"x\": 3.5, \"y\": 1}\n{\"event\": \"end\"}\n{\"event\": \"undo\"}\n"
    "{\"event\": \"redo\"}\n{\"event\": \"dry\", \"layer\": \"second\", \"polygon\": [[-5, -5], [5, -5], [0, "
    "5]]}\n{\"event\": \"lift\", \"layer\": \"first\"}\n";

inline std::shared_ptr<Surface> bare() {
    auto dry = std::make_shared<Surface>(24, 18);
    dry->mm_per_pixel = 0.5;
    dry->scale_known = true;
    std::fill(dry->diffuse.pixels().begin(), dry->diffuse.pixels().end(), Rgb(0.5f, 0.4f, 0.3f));
    std::fill(dry->roughness.pixels().begin(), dry->roughness.pixels().end(), 0.2f);
    std::fill(dry->confidence.pixels().begin(), dry->confidence.pixels().end(), 1.0f);
    return dry;
}

inline void play(const std::filesystem::path& journal) {
    const Journal events = read_journal(journal);
    Session session(bare(), artist_acrylics());
    replay(session, events);
}

inline std::string painting_bytes(const TestDir& dir) {
    write_bytes(dir / "j.jsonl", kJournal);
    Session session(bare(), artist_acrylics());
    Journal events = read_journal(dir / "j.jsonl");
    events.entries.resize(events.entries.size() - 2);
    replay(session, events);
    AtomicFile file(dir / "p.exr");
    write_canvas(file, session.canvas(), {}, with_tools({}, session));
    return bytes_of(dir / "p.exr");
}

inline void read_all_of_painting(const std::filesystem::path& path) {
    Session session(read_canvas(path), artist_acrylics());
    read_tools(path, session);
    parts_beside_paint(path);
    read_overview(path);
}

inline std::string picture_bytes(const TestDir& dir, const std::string& name) {
    write_picture(dir / name, Image<Rgb>(24, 18, Rgb(0.5f, 0.3f, 1.0f)), Transfer{});
    return bytes_of(dir / name);
}

// A photograph with all that cameras and programs put beside the pixels.
inline std::string photo_bytes(const TestDir& dir, const std::string& name) {
    write_picture_with_metadata(dir / name, Image<Rgb>(24, 18, Rgb(0.5f, 0.3f, 1.0f)));
    return bytes_of(dir / name);
}

// All of it, as a fit does.
inline void read_photo(const std::filesystem::path& path) {
    PhotoFile photo(path);
    const PhotoHeader& header = photo.header();
    const auto metadata = read_photo_metadata(path);
    transfer_of_metadata(metadata);
    to_camera_of_icc(metadata.icc_profile);
    if (static_cast<double>(header.width) * header.height > 1e7)
        return;  // larger than the file was, and allowed
    std::vector<float> row(static_cast<std::size_t>(header.width) *
                           static_cast<std::size_t>(header.channels));
    for (int y = 0; y < header.height; ++y) photo.read_rows(y, y + 1, row);
}

inline std::string rti_bytes(const TestDir& dir, RtiBasis basis, const std::string& name) {
    AtomicFile file(dir / name);
    write_rti_file(file, rti_of(*bare(), basis, false, {Transfer::Kind::srgb}, {.directions = 20}));
    return bytes_of(dir / name);
}

inline nlohmann::json vectors() {
    nlohmann::json list = nlohmann::json::array();
    for (const Light& l : dome_lights(5))
        list.push_back({{"x", l.direction.x}, {"y", l.direction.y}, {"z", l.direction.z}});
    return list;
}

inline nlohmann::json dome() {
    return {{"imageWidth", 200},       {"domeDiameter", 1000},
            {"verticalOffset", 5},     {"lightConfiguration", "spherical"},
            {"directions", vectors()}, {"positionsSphere", vectors()}};
}

// What maps are described by beside them.
inline std::string maps_description() {
    Photography photography;
    for (const Light& light : dome_lights(3)) photography.photos.push_back({.light = light});
    return nlohmann::json{{"scale_known", true},
                          {"mm_per_pixel", 0.1},
                          {"haze", 0.1},
                          {"diffuse_roughness", 0},
                          {"photography", to_json(photography)}}
        .dump(1);
}

// A log without hashes, which read_sealed_log() puts in: else every change would be told by them.
inline std::string treatment_log() {
    const nlohmann::json first = {{"action", "begin"},   {"format", kTreatmentFormat},
                                  {"version", 1},        {"width", 24},
                                  {"height", 18},        {"mm_per_pixel", 0.5},
                                  {"scale_known", true}, {"painting", "a.exr"},
                                  {"dry_sha256", "00"},  {"layers", nlohmann::json::array()}};
    const nlohmann::json second = {
        {"action", "varnish"},
        {"who", "me"},
        {"outputs", {{"masks/fill 1.png", "00"}}},
        {"parameters", {{"area", "all"}, {"step", {{"line", 1}}}}},
        {"results", {{"area_px", 18}, {"layer", "varnish 1"}}},
        {"layers", {{{"name", "varnish 1"}, {"role", "varnish"}, {"sha256", "00"}}}}};
    return first.dump() + "\n" + second.dump() + "\n";
}

inline void read_sealed_log(const std::filesystem::path& path) {
    std::istringstream lines(bytes_of(path));
    std::string text, hash(64, '0');
    std::size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        if (line.size() < 2 || !line.ends_with('}')) break;
        const std::string body = line.substr(0, line.size() - 1) + ",\"previous\":\"" + hash + "\"}";
        hash = sha256_of(body);
        text += body.substr(0, body.size() - 1) + ",\"sha256\":\"" + hash + "\"}\n";
    }
    const std::filesystem::path log = path.parent_path() / "sealed" / path.filename();
    std::filesystem::create_directories(log.parent_path());
    write_bytes(log, text);
    write_bytes(std::filesystem::path(log).replace_extension(".head.json"),
                nlohmann::json{{"lines", count}, {"sha256", hash}}.dump());
    require_form(TreatmentLog::open(log));
}

// What the window does with each.
inline void read_notes(const std::filesystem::path& path) {
    const nlohmann::json items = read_annotations(path.string(), path.string());
    for (const nlohmann::json& item : items) {
        const AnnotationShape shape = shape_of_selector(selector_of(item["target"]), 400, 300);
        const nlohmann::json changed =
            changed_annotation(item, {.shape = shape, .text = text_of_annotation(item)}, {"", 400, 300});
        (void)number_in_view(view_of_annotation(changed), "azimuth");
    }
    (void)text_of_page(items);
}

inline std::vector<FileKind> text_kinds() {
    std::string lights = "5\n", chart = "name,R,G,B\n";
    for (int i = 0; i < kChartPatches; ++i) chart += fmt::format("p{},0.{},0.2,0.3\n", i, 1 + i % 9);
    nlohmann::json images = nlohmann::json::array();
    for (const Light& l : dome_lights(5)) {
        lights += fmt::format("{} {} {} {}\n", l.name, l.direction.x, l.direction.y, l.direction.z);
        images.push_back({{"filename", l.name}, {"skip", false}});
    }
    const nlohmann::json project = {{"images", images}, {"dome", dome()}, {"pixelSize", 0.1}};
    const nlohmann::json spheres = {
        {"images", images},
        {"spheres", {{{"directions", {{1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}, {0, 0, 1}}}}}}};
    const std::string reflectances = "[0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.4, 0.5, 0.5, 0.6, 0.6, 0.7]";
    return {
        {"a.jsonl", kJournal, play},
        {"a.lp", lights, [](const std::filesystem::path& path) { read_lights_file(path); }},
        {"a.dome", dome().dump(1), [](const std::filesystem::path& path) { read_dome_file(path); }},
        {"a.relight", project.dump(1), [](const std::filesystem::path& path) { read_relight_file(path); }},
        {"spheres.relight", spheres.dump(1),
         [](const std::filesystem::path& path) { read_relight_file(path); }},
        {"palette.json",
         "{\"format\": \"tangipaint palette\", \"version\": 1, \"name\": \"mine\", \"paints\": [\n"
         "{\"name\": \"White\", \"k_per_mm\": " +
             reflectances + ", \"s_per_mm\": " + reflectances +
             "},\n{\"name\": \"Ochre\", \"masstone\": " + reflectances +
             ", \"hiding_mm\": 0.08},\n{\"name\": \"Sky\", \"srgb\": \"#80c0ff\", \"roughness\": 0.2}]}",
         [](const std::filesystem::path& path) {
             parse_palette(palette_text(read_palette(path)), path.string());
         }},
        {"brushes.json",
         "{\"format\": \"tangipaint brushes\", \"version\": 1, \"brushes\": {\n\"broom\": {\"preset\": "
         "\"fan\", \"size_mm\": 60}, \"nib\": {\"shape\": \"knife\", \"follow\": true}}}",
         [](const std::filesystem::path& path) { read_brush_presets(path); }},
        {"capture.json",
         "{\"format\": \"tangipaint capture 1\", \"photographs\": {\"count\": 1, \"width\": 41, \"height\": "
         "31},\n\"camera\": {\"position_mm\": [2, 3, 600], \"mm_per_pixel\": 0.5}, \"frame\": "
         "{\"origin_px\": "
         "[20, 15]},\n\"lights\": [{\"name\": \"a.png\", \"direction\": [0.6, 0, 0.8], \"position_mm\": "
         "[300, 0, "
         "400]}],\n\"poor\": [\"few lights\"], \"method\": \"mirror spheres\", \"scale\": {\"mm_per_pixel\": "
         "0.5}, "
         "\"geometry\": {\"photograph_px\": [41, 31], \"picture_px\": [40, 30], \"lens\": {\"focal_px\": "
         "[90, 90], "
         "\"principal_px\": [20, 15], \"distortion\": [0.1, 0, 0, 0]}, \"rectification\": [[1, 0, 0], [0, 1, "
         "0], [0, "
         "0, 1]], \"mm_per_pixel\": 0.5, \"turn\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"camera_mm\": [0, 0, "
         "600]}}",
         [](const std::filesystem::path& path) { in_picture(read_capture_file(path)); }},
        {"chart.csv", chart, [](const std::filesystem::path& path) { read_chart_reference(path); }},
        {"lens.yml",
         "%YAML:1.0\n---\nimage_width: 100\nimage_height: 80\ncamera_matrix: !!opencv-matrix\n   rows: 3\n"
         "   cols: 3\n   dt: d\n   data: [ 90., 0., 50., 0., 90., 40., 0., 0., 1. ]\n"
         "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0.1, 0., "
         "0., 0., 0. ]\n",
         [](const std::filesystem::path& path) { read_lens(path); }},
        {"lens.xml",
         "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>100</image_width>\n"
         "<image_height>80</image_height>\n<camera_matrix type_id=\"opencv-matrix\">\n<rows>3</rows>\n"
         "<cols>3</cols>\n<dt>d</dt>\n<data>\n90. 0. 50. 0. 90. 40. 0. 0. 1.</data></camera_matrix>\n"
         "<distortion_coefficients type_id=\"opencv-matrix\">\n<rows>5</rows><cols>1</cols><dt>d</dt>"
         "<data>0.1 0. 0. 0. 0.</data></distortion_coefficients>\n</opencv_storage>\n",
         [](const std::filesystem::path& path) { read_lens(path); }},
        {"brackets.json",
         "{\"a\": [\"brackets.json\", {\"file\": \"brackets.json\", \"exposure\": 0.5}],\n\"b\": "
         "[\"brackets.json\"]}",
         [](const std::filesystem::path& path) { read_brackets(path, path.parent_path()); }},
        {"annotations.json",
         "{\"@context\": \"http://www.w3.org/ns/anno.jsonld\", \"type\": \"AnnotationPage\", \"items\": [\n"
         "{\"type\": \"Annotation\", \"id\": \"urn:a\", \"body\": [{\"type\": \"TextualBody\", \"value\": "
         "\"A "
         "loss\"}], \"target\": {\"source\": \"urn:p\", \"selector\": {\"type\": \"SvgSelector\", \"value\": "
         "\"<svg "
         "xmlns='http://www.w3.org/2000/svg'><path d='M1 1c2 3 4 5 6 7A9 9 20 0 1 30 40Z'/><polygon "
         "points='1,2 3,4 "
         "5,6'/></svg>\"}, \"state\": {\"type\": \"urn:tangipaint:View\", \"value\": "
         "\"azimuth=20&elevation=30\"}}},\n{\"type\": \"Annotation\", \"bodyValue\": \"all\", \"target\": "
         "\"http://a.example/p#xywh=percent:1,2,3,4\"},\n{\"type\": \"Annotation\", \"target\": "
         "[{\"selector\": "
         "[{\"type\": \"PointSelector\", \"x\": 3, \"y\": 4.5}]}]}]}",
         read_notes},
        {"pairs.json",
         "{\"format\": \"tangipaint pigment pairs\", \"version\": 1, \"pairs\": [{\"first\": "
         "[\"verdigris\"], "
         "\"second\": [\"lead white\"], \"why\": \"darkens\", \"source\": \"nobody\"}]}",
         [](const std::filesystem::path& path) { read_pigment_pairs(path); }},
        {"maps.json", maps_description(),
         [](const std::filesystem::path& path) { as_described(path.parent_path(), {}); }},
        {"log.jsonl", treatment_log(), read_sealed_log}};
}

inline std::vector<FileKind> file_kinds(const TestDir& dir) {
    std::vector<FileKind> all = text_kinds();
    all.push_back({"a.exr", painting_bytes(dir), read_all_of_painting});
    all.push_back({"a.ptm", rti_bytes(dir, RtiBasis::ptm, "b.ptm"),
                   [](const std::filesystem::path& path) { read_rti_file(path); }});
    all.push_back({"a.rti", rti_bytes(dir, RtiBasis::hsh9, "b.rti"),
                   [](const std::filesystem::path& path) { read_rti_file(path); }});
    for (const char* name : {"a.png", "a.tif", "a.jpg"})
        all.push_back({name, picture_bytes(dir, name),
                       [](const std::filesystem::path& path) { read_mask(path, 24, 18); }});
    for (const char* name : {"photo.png", "photo.jpg", "photo.tif", "photo.exr", "photo.tga"})
        all.push_back({name, photo_bytes(dir, name), read_photo});
    return all;
}

}  // namespace tangi
