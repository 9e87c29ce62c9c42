#include <algorithm>

#include "retouch/report/report_content.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_picture.h"
#include "surface/base/json_text.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// A map that is black but for some places, without what is black beside them.
Image<Rgb> cut_to_what_is_there(const Image<Rgb>& map) {
    Region box{map.width(), map.height(), 0, 0};
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x)
            if (map(x, y) != Rgb(0))
                box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1),
                       std::max(box.y1, y + 1)};
    if (box.x1 <= box.x0) return map;
    const int margin = std::max(box.width(), box.height()) / 8 + 4;
    box = intersection({box.x0 - margin, box.y0 - margin, box.x1 + margin, box.y1 + margin}, map.region());
    Image<Rgb> part(box.width(), box.height());
    for (int y = 0; y < part.height(); ++y)
        for (int x = 0; x < part.width(); ++x) part(x, y) = map(x + box.x0, y + box.y0);
    return part;
}

}  // namespace

std::string by_each_light(const json& differences) {
    std::string text;
    for (const auto& [illuminant, value] : differences.items())
        text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", illuminant, value.get<double>());
    return text;
}

Image<Rgb> fitting(const Image<Rgb>& picture, int side_by_side) {
    const int side_px = report_picture_px(side_by_side);
    return reduced(picture, side_px, side_px);
}

std::string spaced(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

namespace {

// A retouch's figures; in brackets those of undamaged areas of its shape.
std::vector<std::string> quality_row(const json& region) {
    const json own = region.value("undamaged", json());
    const auto bracket = [&](const std::string& text) { return own.is_object() ? " (" + text + ")" : ""; };
    const auto colour = [&](const char* key) {
        return by_each_light(region.at(key)) + (own.is_object() ? bracket(by_each_light(own.at(key))) : "");
    };
    const auto number = [&](const json& of) { return fmt::format("{:.3f}", of.get<double>()); };
    const StatedLength area = stated_length(region, "area", "_mm2"),
                       height = stated_length(region, "height_step");
    return {fmt::format("{}, {}", json_line(region.at("box_px").at(0)), json_line(region.at("box_px").at(1))),
            fmt::format("{:.1f}{}", area.value.get<double>(), area.unit),
            colour("delta_e_2000"),
            colour("border_delta_e_2000"),
            number(height.value.at("rms")) + std::string(height.unit) +
                (own.is_object() ? bracket(number(stated_length(own, "height_step").value.at("rms"))) : ""),
            number(region.at("gloss_step")) + (own.is_object() ? bracket(number(own.at("gloss_step"))) : "")};
}

struct QualityPictures {
    ReportPictures maps, raking;
};

QualityPictures quality_pictures(const json& outputs, const fs::path& folder) {
    QualityPictures pictures;
    for (const auto& [file, hash] : outputs.items()) {
        const fs::path path = file;
        if (path.filename() == "delta_e_2000.png") {
            pictures.maps.pictures.push_back({cut_to_what_is_there(read_picture(folder / path)), {}});
            // By itself: GCC 12 warns of a copy beyond the string where it is part of the line above.
            pictures.maps.pictures.back().caption =
                "ΔE2000, the worst under the illuminants: black 0, white 10 and more; cut to the retouches";
        } else if (path.stem().string().starts_with("raking_")) {
            pictures.raking.pictures.push_back({fitting(read_picture(folder / path), 4),
                                                spaced(path.stem().string()) + ", at 15°, with shadows"});
        }
    }
    for (ReportPicture& p : pictures.maps.pictures) p.picture = fitting(p.picture, 2);
    return pictures;
}

}  // namespace

void add_quality(ReportMatter& m) {
    const auto last = std::find_if(m.log().rbegin(), m.log().rend(), [](const LogEntry& e) {
        return e.content.value("action", "") == "quality";
    });
    if (last == m.log().rend()) return;
    const json& results = last->content.at("results");
    const bool since =
        std::any_of(m.log().rbegin(), last, [](const LogEntry& e) { return e.content.contains("layers"); });
    m.add(ReportText{fmt::format("Retouches against what is beside them (line {} of the log{})", last->line,
                                 since ? "; layers have changed since" : "")});
    m.add(
        ReportText{"ΔE2000 of each retouched area from its surroundings' colour carried on into it, and "
                   "across its border; steps "
                   "of height (rms) and gloss across the border. In brackets: the same of undamaged areas of "
                   "its shape beside "
                   "it, which tells how much the painting itself varies.",
                   true});
    ReportTable table{
        {"At pixel", "Area", "ΔE2000", "Across the border", "Height", "Gloss"}, {}, {1.3, 1.2, 4, 4, 2.4, 2}};
    for (const json& region : results.at("regions")) table.rows.push_back(quality_row(region));
    m.add(std::move(table));
    QualityPictures pictures = quality_pictures(last->content.at("outputs"), m.t.folder());
    m.add(std::move(pictures.maps));
    m.add(std::move(pictures.raking));
}

}  // namespace tangi
