// export_layers.cpp: the paint of a canvas as a folder for each layer, and what its files are.

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/export/exporter.h"
#include "fit/exchange/export_maps.h"
#include "paint/canvas/appearance.h"
#include "paint/canvas/layer_pictures.h"
#include "paint/files/paint_metadata.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/report/png_encode.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::string file_name_of(const std::string& layer) {
    constexpr std::size_t most_bytes = 100;  // file systems take 255
    std::string name = layer;
    for (char& c : name)
        if (c == '/' || static_cast<unsigned char>(c) < ' ') c = '_';
    std::size_t end = std::min(name.size(), most_bytes);
    while (end < name.size() && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
    name.resize(end);
    return name;
}

// The volumes of one layer, and what they are of.
nlohmann::json write_volumes(const fs::path& folder, const std::string& subfolder, const Canvas& canvas,
                             const PaintLayer& paint) {
    nlohmann::json paints = nlohmann::json::array();
    const auto mm3 = volumes_mm3(paint, canvas.ingredients().size(), canvas.mm_per_pixel());
    for (std::size_t id = 0; id < canvas.ingredients().size(); ++id) {
        const Pigment& pigment = canvas.ingredients()[id];
        const Image<float> mm = thickness_mm_of(paint, static_cast<IngredientId>(id));
        if (std::ranges::all_of(mm.pixels(), [](float v) { return v == 0; })) continue;
        const std::string file = fmt::format("{}/{:05}-{}_mm.exr", subfolder, id, file_name_of(pigment.name));
        write_map(folder / file, mm);
        nlohmann::json about = in_words(pigment, mm3[id]);
        about["file"] = file;
        about["ingredient"] = id;
        paints.push_back(std::move(about));
    }
    return paints;
}

// NUMBER-NAME/ for each layer that holds paint, from the bottom up, with colour.png (16 bit, alpha),
// thickness_mm.exr and the volume of each ingredient [mm^3/mm^2 = mm], NNNNN-NAME_mm.exr, NNNNN its number;
// names as far as they can be those of files. layers.json says of each what it is
// (docs/reference/export-formats.md). Throws Error where the folder cannot be written.
void write_layers(const fs::path& folder, const Canvas& canvas, const Progress& progress) {
    const std::vector<LayerPicture> layers = layer_pictures(canvas, {}, progress);
    nlohmann::json told = nlohmann::json::array();
    const auto write = [&](const PaintLayer& paint, bool wet, bool levels) {
        const std::size_t number = told.size() + 1;  // 0 is the dry surface
        const LayerPicture& layer = layers.at(number);
        const std::string subfolder = fmt::format("{}-{}", number, file_name_of(layer.name));
        const std::string colour = subfolder + "/colour.png", thickness = subfolder + "/thickness_mm.exr";
        make_folder(folder / subfolder);
        AtomicFile picture(folder / colour);
        picture.write(png_bytes(layer.srgb, layer.alpha, 16));
        picture.commit();
        write_map(folder / thickness, layer.thickness_mm);
        told.push_back({{"name", layer.name},
                        {"wet", wet},
                        {"levels", levels},
                        {"folder", subfolder},
                        {"colour", colour},
                        {"thickness", thickness},
                        {"paints", write_volumes(folder, subfolder, canvas, paint)}});
    };
    for (const DriedLayer& dried : canvas.dried())
        if (!dried.paint.empty()) write(dried.paint, false, dried.levels);
    if (!canvas.wet().empty()) write(canvas.wet(), true, false);
    nlohmann::json about = scale_in_words(canvas);
    about["layers"] = std::move(told);
    write_text_file(folder / "layers.json", json_lines(about));
}

}  // namespace

// With the maps of the dry surface, and of it all.
nlohmann::json export_layers(const ExportJob& job) {
    return export_folder(job.arguments.out, "layers.json", [&](const fs::path& folder) {
        write_maps(folder / "dry", *in_scale_of(job.canvas(), job.canvas().dry_shared()), job.progress);
        write_layers(folder, job.canvas(), job.progress);
        write_maps(folder / "painted", *job.seen_in_scale(), job.progress);
    });
}

}  // namespace tangi
