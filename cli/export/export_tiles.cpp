// export_tiles.cpp: a painting as tiles of pictures: IIIF with a manifest, Deep Zoom.
#include <algorithm>
#include <array>
#include <cmath>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/export/exporter.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/maps/material.h"
#include "surface/painting_file/painting_reader.h"
#include "surface/publish/tile_pyramid.h"
#include "surface/render/part_relighter.h"
#include "surface/render/viewing_exposure.h"
#include "surface/report/false_colour.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr const char* kFiles = "files.json";  // what lists the others
constexpr int kTileQuality = 90;

constexpr double kLookedAt = 4e6;  // [pixels] that say which values a map has, evenly over the painting

// As `snapshot` shows it.
PictureSource picture_as_lit(const ExportJob& job, std::shared_ptr<const PaintingReader> painting) {
    const Light light = distant_light(parse_direction_in_front(job.arguments.light, "--light"));
    const auto exposure = static_cast<float>(viewing_exposure(painting->header().photography.white_level));
    const auto lit = std::make_shared<PartRelighter>(painting, RelightOptions{.cast_shadows = true});
    return {painting->width(), painting->height(), [lit, light, exposure](const Region& region) {
                Image<Rgb> picture = lit->draw(region, std::array{light});
                const Transfer srgb{Transfer::Kind::srgb};
                for (Rgb& pixel : picture.pixels())
                    pixel = glm::clamp(srgb.encode(pixel * exposure), 0.0f, 1.0f);
                return picture;
            }};
}

// Every n-th pixel of every n-th row.
Surface sample_of(const PaintingReader& painting, const Progress& progress) {
    const int step = std::max(
        1, static_cast<int>(std::ceil(std::sqrt(painting.width() * double(painting.height()) / kLookedAt))));
    const auto count = [&](int pixels) { return (pixels + step - 1) / step; };
    Surface sample = blank_surface(painting.header(), count(painting.width()), count(painting.height()));
    describe(painting.header(), sample);
    const std::vector<Region> blocks = painting.blocks();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        report(progress, "read painting", static_cast<double>(i) / static_cast<double>(blocks.size()));
        const Region& b = blocks[i];
        const Surface part = painting.read(b);
        for (int y = count(b.y0); y * step < b.y1; ++y)
            for (int x = count(b.x0); x * step < b.x1; ++x)
                set_material(sample, x, y, material_at(part, x * step - b.x0, y * step - b.y0));
    }
    return sample;
}

struct Layer {
    std::string key, label;
    PictureSource picture;
};

std::vector<Layer> layers_of(const ExportJob& job, const std::shared_ptr<const PaintingReader>& painting) {
    std::vector<Layer> layers = {{"picture", "Picture", picture_as_lit(job, painting)}};
    for (MapLook& map : map_looks(sample_of(*painting, job.progress)))
        layers.push_back({map.key,
                          map.unit == "1" || map.unit.empty() ? map.title : map.title + " [" + map.unit + "]",
                          {painting->width(), painting->height(),
                           [painting, draw = std::move(map.draw)](const Region& region) {
                               return draw(painting->read(region));
                           }}});
    return layers;
}

json in_language(const char* language, const std::string& text) { return {{language, {valid_utf8(text)}}}; }

// Those of a file, on this canvas instead of their own target.
json annotations_on(const std::string& canvas, json annotations) {
    for (std::size_t i = 0; i < annotations.size(); ++i) {
        json& item = annotations[i];
        json target = {{"type", "SpecificResource"}, {"source", {{"id", canvas}, {"type", "Canvas"}}}};
        if (item["target"].is_string()) {
            const std::string whole = item["target"];
            target["selector"] = {{"type", "FragmentSelector"},
                                  {"value", whole.substr(whole.find("#xywh=") + 1)}};
        } else {
            for (const char* key : {"selector", "state"})
                if (item["target"].contains(key)) target[key] = item["target"][key];
        }
        item["target"] = target;
        item["id"] = fmt::format("{}/annotation/{}", canvas, i + 1);
        item.erase("@context");  // that of the manifest holds for all of it
    }
    return annotations;
}

// One canvas, whose picture is a choice of the layers.
json manifest_of(const ExportJob& job, const PaintingHeader& painting, const std::string& url,
                 const json& choices) {
    const PictureNotes notes = job.notes("");
    const std::string canvas = url + "/canvas";
    json manifest = {{"@context", "http://iiif.io/api/presentation/3/context.json"},
                     {"id", url + "/manifest.json"},
                     {"type", "Manifest"},
                     {"label", in_language("none", notes.title)}};
    json about = json::array();
    const auto say = [&](const char* label, const std::string& value) {
        if (!value.empty())
            about.push_back({{"label", in_language("en", label)}, {"value", in_language("none", value)}});
    };
    say("Creator", notes.creator);
    if (painting.scale_known)
        say("Size", fmt::format("{:.1f} × {:.1f} mm", painting.width * painting.mm_per_pixel,
                                painting.height * painting.mm_per_pixel));
    say("Source", notes.source);
    say("Made by", job.program());
    manifest["metadata"] = about;
    if (!notes.credit.empty())
        manifest["requiredStatement"] = {{"label", in_language("en", "Credit")},
                                         {"value", in_language("none", notes.credit)}};
    const json shown = {{"id", canvas + "/painting/1"},
                        {"type", "Annotation"},
                        {"motivation", "painting"},
                        {"target", canvas},
                        {"body", {{"type", "Choice"}, {"items", choices}}}};
    json page = {{"id", canvas},
                 {"type", "Canvas"},
                 {"label", in_language("none", notes.title)},
                 {"width", painting.width},
                 {"height", painting.height},
                 {"items", {{{"id", canvas + "/painting"}, {"type", "AnnotationPage"}, {"items", {shown}}}}}};
    if (const json notes_on_it = annotations_on(canvas, job.annotations()); !notes_on_it.empty())
        page["annotations"] = {
            {{"id", canvas + "/annotations"}, {"type", "AnnotationPage"}, {"items", notes_on_it}}};
    manifest["items"] = json::array({page});
    return manifest;
}

std::string url_of(const ExportArguments& a) {
    std::string url = a.url.empty() ? "http://localhost:8000" : a.url;
    while (url.ends_with('/')) url.pop_back();
    if (!url.starts_with("http://") && !url.starts_with("https://"))
        throw UsageError(fmt::format("--url {}: an address begins with https:// or http://", a.url));
    return url;
}

}  // namespace

json export_iiif(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    const std::string url = url_of(a);
    const std::shared_ptr<const PaintingReader> painting = job.seen_by_parts();
    job.annotations();  // what is wrong with them is known before the work
    const PictureStorage storage{.jpeg_quality = kTileQuality};
    json result = export_folder(a.out, kFiles, [&](const fs::path& folder) {
        json choices = json::array();
        for (const Layer& layer : layers_of(job, painting)) {
            const std::string id = url + "/" + layer.key;
            const json info = write_iiif_image(folder / layer.key, id, layer.picture, storage, job.progress);
            const json& largest = info["sizes"].back();
            choices.push_back(
                {{"id", fmt::format("{}/full/{},{}/0/default.jpg", id, largest["width"].get<int>(),
                                    largest["height"].get<int>())},
                 {"type", "Image"},
                 {"format", "image/jpeg"},
                 {"label", in_language("en", layer.label)},
                 {"width", painting->width()},
                 {"height", painting->height()},
                 {"service", {{{"id", id}, {"type", "ImageService3"}, {"profile", "level0"}}}}});
        }
        write_text_file(folder / "manifest.json",
                        json_lines(manifest_of(job, painting->header(), url, choices)));
    });
    result["manifest"] = url + "/manifest.json";
    if (a.url.empty())
        result["warnings"] =
            told({fmt::format("{}: its addresses begin with {}, to try it there: cd {} && python3 -m "
                              "http.server; give --url where "
                              "the folder will be published",
                              a.out, url, a.out)});
    return result;
}

json export_deepzoom(const ExportJob& job) {
    const std::shared_ptr<const PaintingReader> painting = job.seen_by_parts();
    return export_folder(job.arguments.out, kFiles, [&](const fs::path& folder) {
        write_deep_zoom(folder / "picture.dzi", picture_as_lit(job, painting), {.jpeg_quality = kTileQuality},
                        job.progress);
    });
}

}  // namespace tangi
