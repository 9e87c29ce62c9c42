// export_maps.cpp: the maps of a painting as it looks: EXR files, or TIFF and PNG of 16 bits.
#include "fit/exchange/export_maps.h"

#include <algorithm>

#include "cli/arguments.h"
#include "cli/export/exporter.h"
#include "fit/pixel/fit_errors.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/height_unit.h"

namespace tangi {

namespace {

namespace fs = std::filesystem;

// What 0 and full scale of a map of whole numbers stand for, and its unit.
nlohmann::json range_of(double from, double to, const std::string& unit) {
    return {{"from", from}, {"to", to}, {"unit", unit}};
}

// The maps in 16 bits, for programs that read no EXR; maps.json says what their numbers are, and import reads
// them by it. Anisotropic lobes are in EXR alone: their angles go round.
void write_whole_numbers(const fs::path& folder, const Surface& s, const std::string& extension,
                         const PictureNotes& notes) {
    const PictureStorage storage{.bits = 16, .notes = notes};
    nlohmann::json maps = nlohmann::json::object();
    const auto write = [&](const std::string& name, Image<float> map, float from, float to,
                           const std::string& unit) {
        for (float& value : map.pixels()) value = std::clamp((value - from) / (to - from), 0.0f, 1.0f);
        write_map(folder / (name + extension), map, storage);
        maps[name] = range_of(from, to, unit);
    };
    const auto [least, most] = std::ranges::minmax(s.height_mm.pixels());
    write("height", s.height_mm, least, std::max(most, least + 1e-6f),
          std::string(height_unit_of(s.mm_per_pixel, s.scale_known)));
    write("specular", s.specular, 0, 1, "1");
    write("roughness", s.roughness, 0, 1, "1");
    write("confidence", s.confidence, 0, 1, "1");
    Image<Rgb> normal = s.normal;
    for (Rgb& n : normal.pixels()) n = (n + 1.0f) / 2.0f;
    write_map(folder / ("normal" + extension), normal, storage);
    maps["normal"] = range_of(-1, 1, "1");
    write_picture(folder / ("diffuse" + extension), s.diffuse, {Transfer::Kind::srgb}, storage);
    maps["diffuse"] = {{"encoding", "srgb"}};
    if (!s.specular_colour.empty()) {
        write_map(folder / ("lobe" + extension), s.specular_colour, storage);
        maps["lobe"] = range_of(0, 1, "1");
    }
    nlohmann::json about = about_maps(s);
    about["maps"] = std::move(maps);
    write_text_file(folder / "maps.json", json_lines(about));
}

// Standard errors, in the unit of their map; in whole numbers 1 is the largest, which the file's name tells.
void write_error_maps(const fs::path& folder, const FitErrors& errors, const std::string& extension) {
    const auto write = [&](const char* name, const Image<HalfError>& halves) {
        Image<float> map(halves.width(), halves.height());
        std::ranges::transform(halves.pixels(), map.pixels().begin(),
                               [](const HalfError& e) { return static_cast<float>(e); });
        float full = 1;
        if (extension != ".exr") {
            full = std::max(std::ranges::max(map.pixels()), 1e-9f);
            for (float& value : map.pixels()) value /= full;
        }
        const std::string scale = extension == ".exr" ? "" : fmt::format("_full_scale_{:.4g}", full);
        write_map(folder / (std::string(name) + "_error" + scale + extension), map);
    };
    write("height", errors.height);
    write("slope", errors.slope);
    write("diffuse", errors.diffuse);
    write("specular", errors.specular);
    write("roughness", errors.roughness);
}

}  // namespace

nlohmann::json export_maps(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    const std::shared_ptr<const Surface> surface = job.seen_in_scale();
    return export_folder(a.out, "maps.json", [&](const fs::path& folder) {
        if (a.maps_format == "exr")
            write_maps(folder, *surface, job.progress);
        else
            write_whole_numbers(folder, *surface, "." + a.maps_format,
                                job.notes("Map of TangiPaint; its unit and range are in maps.json"));
        if (fs::is_regular_file(a.painting) && has_errors(a.painting))
            write_error_maps(folder, read_errors(a.painting, job.progress), "." + a.maps_format);
    });
}

}  // namespace tangi
