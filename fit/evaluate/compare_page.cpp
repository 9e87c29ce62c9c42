#include "fit/evaluate/compare_page.h"

#include <array>

#include "fit/evaluate/compare_page_html.h"
#include "surface/base/html_escape.h"
#include "surface/base/json_text.h"
#include "surface/base/parallel.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"
#include "surface/report/false_colour.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int kStops = 17;  // colours from which the page draws its scales

std::string hex(const Rgb& srgb) {
    const glm::ivec3 c(glm::round(srgb * 255.0f));
    return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
}

json scale_of(ColourMap map) {
    json stops = json::array();
    for (int i = 0; i < kStops; ++i) stops.push_back(hex(colour_at(map, i / double(kStops - 1))));
    return stops;
}

json legend_of(ColourMap map, const ValueRange& range, const std::string& unit) {
    json marks = json::array();
    for (const double value : ticks(range))
        marks.push_back(
            {{"at", (value - range.lo) / (range.hi - range.lo)}, {"label", tick_label(value, range)}});
    return {{"scale", map == ColourMap::sequential ? "sequential" : "diverging"},
            {"lo", range.lo},
            {"hi", range.hi},
            {"unit", unit == "1" ? "" : unit},
            {"ticks", std::move(marks)}};
}

// A file name for a photograph that every system and every URL takes; the number makes it unique.
std::string picture_stem(int index, const std::string& name) {
    std::string stem;
    for (const char c : fs::path(name).stem().string())
        stem +=
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ? c : '_';
    return fmt::format("{:03}_{}", index, stem.substr(0, 60));
}

// Writes the four pictures of a photograph; their paths in the folder.
json write_pictures(const fs::path& folder, const ComparedPictures& pictures, const CompareOptions& options) {
    const int width = pictures.photo.width(), height = pictures.photo.height();
    const auto mask = [&](int y) { return pictures.mask.row(y); };
    const std::array<std::pair<const char*, PictureRow>, 4> drawn = {
        {{"photo", [&](int y, std::span<Rgb> row) { for_display(pictures.photo.row(y), pictures, row); }},
         {"relit", [&](int y, std::span<Rgb> row) { for_display(pictures.relit.row(y), pictures, row); }},
         {"error",
          [&](int y, std::span<Rgb> row) {
              std::vector<float> error(row.size());
              luma_difference(pictures.photo.row(y), pictures.relit.row(y), error);
              map_row(error, -options.error_range, options.error_range, ColourMap::diverging, mask(y), row);
          }},
         {"delta_e", [&](int y, std::span<Rgb> row) {
              map_row(pictures.delta_e.row(y), 0, options.delta_e_range, ColourMap::sequential, mask(y), row);
          }}}};
    const std::string stem = "pictures/" + picture_stem(pictures.index, pictures.result.name);
    const auto path = [&](const char* what) { return fmt::format("{}_{}.jpg", stem, what); };
    parallel_for(0, static_cast<int>(drawn.size()), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto& [what, draw] = drawn[static_cast<std::size_t>(i)];
            write_picture_8bit(folder / path(what), shrunk(width, height, options.picture_size, draw));
        }
    });
    json paths;
    for (const auto& [what, draw] : drawn) paths[what] = path(what);
    return paths;
}

json write_maps(const fs::path& folder, const Surface& surface, const CompareOptions& options) {
    json maps = json::array();
    for (const MapPicture& map : map_pictures(surface, options.picture_size)) {
        const std::string path = fmt::format("pictures/map_{}.png", map.key);
        write_picture_8bit(folder / path, map.picture);
        json entry = {{"key", map.key},
                      {"title", map.title},
                      {"symbol", map.symbol},
                      {"meaning", map.meaning},
                      {"picture", path}};
        if (map.range) entry["legend"] = legend_of(ColourMap::sequential, *map.range, map.unit);
        maps.push_back(std::move(entry));
    }
    return maps;
}

CompareReport write_files(const fs::path& folder, const Surface& surface, const Stack& photos,
                          const CompareOptions& options, const Progress& progress,
                          const RelightingResidual& residual) {
    make_folder(folder / "pictures");
    json files = json::array();
    const ComparisonSink sink = [&](const ComparedPictures& pictures) {
        files.push_back(write_pictures(folder, pictures, options));
    };
    CompareReport report = compare(surface, photos, options, progress, sink, residual);
    json data = to_json(report);
    data["software"] = program_name();
    for (std::size_t i = 0; i < files.size(); ++i) data["photos"][i]["pictures"] = files[i];
    write_text_file(folder / "compare.json", json_lines(data));
    data["maps"] = write_maps(folder, surface, options);
    write_text_file(folder / "compare.html", comparison_page(data));
    return report;
}

}  // namespace

CompareReport write_comparison(const fs::path& folder, const Surface& surface, const Stack& photos,
                               const CompareOptions& options, const Progress& progress,
                               const RelightingResidual& residual) {
    FolderFiles written(folder);  // one that is stopped leaves an older one as it was
    CompareReport report;
    told_of(written.temporary(), folder,
            [&] { report = write_files(written.temporary(), surface, photos, options, progress, residual); });
    written.place();
    return report;
}

std::string comparison_page(const json& report) {
    json data = report;
    const CompareOptions defaults;
    const auto option = [&](const char* name, double otherwise) {
        return report.contains("options") ? report["options"].value(name, otherwise) : otherwise;
    };
    const double error = option("error_range", defaults.error_range);
    const double delta_e = option("delta_e_range", defaults.delta_e_range);
    data["scales"] = {{"sequential", scale_of(ColourMap::sequential)},
                      {"diverging", scale_of(ColourMap::diverging)}};
    data["legends"] = {{"error", legend_of(ColourMap::diverging, {-100 * error, 100 * error}, "%")},
                       {"delta_e", legend_of(ColourMap::sequential, {0, delta_e}, "ΔE")}};

    const std::string text = inside_script(json_line(data));
    std::string page = kComparePageHtml;
    const std::string mark = "{{report}}";
    const std::size_t at = page.find(mark);
    TP_REQUIRE(at != std::string::npos, "the page has a place for its data");
    return page.replace(at, mark.size(), text);
}

}  // namespace tangi
