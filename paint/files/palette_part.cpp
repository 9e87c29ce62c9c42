#include "paint/files/palette_part.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "paint/files/canvas_file.h"
#include "paint/files/paint_parts.h"
#include "paint/session/mixing_board.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr const char *kPalette = "palette", *kBrush = "brush", *kTotal = "total";

PartToWrite part_of(const Brush& brush, Place place, bool goes_on) {
    PartToWrite part;
    const int size = brush.grid_size();
    const auto load = std::make_shared<const BrushLoad>(brush.bristles());
    part.info = {kBrush, size, size, {kTotal}, {}};
    for (const IngredientId id : load->ingredients) part.info.channels.push_back(volume_channel(id));
    part.info.attributes["brush"] = json_line(json{{"settings", brush_to_json(brush.settings())},
                                                   {"seed", brush.seed()},
                                                   {"rotation_rad", load->rotation_rad},
                                                   {"on", place == Place::painting ? "painting" : "palette"},
                                                   {"goes_on", goes_on}});
    part.fill = [load, size](int y0, int y1, std::span<float* const> planes) {
        const auto copy = [&](const std::vector<float>& from, float* to) {
            std::copy_n(from.data() + static_cast<std::ptrdiff_t>(y0) * size,
                        static_cast<std::ptrdiff_t>(y1 - y0) * size, to);
        };
        copy(load->total_mm, planes[0]);
        for (std::size_t i = 0; i < load->mm.size(); ++i) copy(load->mm[i], planes[i + 1]);
    };
    return part;
}

// A canvas shares its tiles with its copies until they change.
PartToWrite part_of(const Canvas& board) {
    const auto kept = std::make_shared<const Canvas>(board);
    PartToWrite part = part_of(kPalette, kept->wet());
    add_ingredients(part.info, kept->ingredients());
    part.fill = [kept, fill = std::move(part.fill)](int y0, int y1, std::span<float* const> planes) {
        fill(y0, y1, planes);
    };
    return part;
}

Canvas read_board(const fs::path& path, const PartInfo& info, double mm_per_pixel, const Progress& progress) {
    Canvas board = make_board({info.width * mm_per_pixel, info.height * mm_per_pixel}, mm_per_pixel);
    read_ingredients(path, info, board);
    board.writable_wet() = read_layer(path, info, board, progress);
    return board;
}

// `total` is what earlier versions counted along the way, from step to step.
void require_total(const fs::path& path, const PartInfo& info, int y, std::span<const float> total,
                   std::span<const float> sums) {
    for (std::size_t x = 0; x < total.size(); ++x)
        if (!(std::abs(total[x] - sums[x]) <= 1e-3f * (1 + sums[x])))
            fail("{}: part '{}', channel '{}' holds {} at pixel ({}, {}), but the volumes there sum to {}",
                 path.string(), info.name, kTotal, total[x], x, y, sums[x]);
}

bool is_tool(const PartToWrite& part) { return part.info.name == kPalette || part.info.name == kBrush; }

struct ReadBrush {
    std::unique_ptr<Brush> brush;
    Place place = Place::painting;
    bool goes_on = false;
};

// What the attribute says of the brush in the hand.
struct BrushNote {
    json settings;
    std::uint64_t seed = 0;
    float rotation_rad = 0;
    Place place = Place::painting;
    bool goes_on = false;
};

BrushNote note_of(const PartInfo& info, const std::string& where) {
    const auto text = info.attributes.find("brush");
    const json about = text == info.attributes.end() ? json() : json_or_discarded(text->second);
    if (!about.is_object() || !about.value("seed", json()).is_number_unsigned() ||
        !about.value("rotation_rad", json()).is_number() || !about.contains("settings"))
        fail("{}: has no settings, seed and rotation_rad", where);
    BrushNote note;
    note.settings = about["settings"];
    note.seed = about["seed"].get<std::uint64_t>();
    note.rotation_rad = about["rotation_rad"].get<float>();
    if (!std::isfinite(note.rotation_rad)) fail("{}: rotation_rad is not finite", where);
    const json on = about.value("on", json());
    if (on != "painting" && on != "palette")
        fail("{}: 'on' is {}, not painting or palette", where, shown(on));
    note.place = on == "painting" ? Place::painting : Place::palette;
    note.goes_on = about.value("goes_on", json()) == true;
    return note;
}

std::unique_ptr<Brush> brush_of(const BrushNote& note, double mm_per_pixel, const std::string& where) {
    const BrushSettings settings = brush_from_json(note.settings, where);
    try {
        return std::make_unique<Brush>(settings, mm_per_pixel, note.seed);
    } catch (const Error& error) {  // it knows of no file
        fail("{}: {}", where, error.what());
    }
}

// The cells of a border that are not in the part: earlier versions gave a brush that is too small to be
// resolved a cell or two less. Throws Error where the part has another size.
int margin_of(const fs::path& path, const PartInfo& info, const Brush& brush) {
    const int size = brush.grid_size();
    const int margin = brush.coverage() < 1 ? std::clamp((size - info.width) / 2, 0, 2) : 0;
    if (info.width != size - 2 * margin || info.height != info.width)
        fail(
            "{}: part 'brush' is {} x {}, but a brush of these settings is {} x {}: the file is damaged; "
            "take a copy from before",
            path.string(), info.width, info.height, size, size);
    return margin;
}

// Paints are numbered as the canvas's ingredients, of which there are so many.
BrushLoad read_load(const fs::path& path, const PartInfo& info, const Brush& brush, std::size_t ingredients) {
    const int size = brush.grid_size(), margin = margin_of(path, info, brush);
    PartInfo volumes = info;
    if (volumes.channels.empty() || volumes.channels.front() != kTotal)
        fail("{}: part 'brush' has no channel 'total'", path.string());
    volumes.channels.erase(volumes.channels.begin());
    BrushLoad load;
    load.ingredients = ingredients_of(path, volumes, ingredients, false);
    load.mm.resize(load.ingredients.size());
    const auto width = static_cast<std::size_t>(info.width), cells = static_cast<std::size_t>(size * size);
    load.total_mm.resize(cells);
    for (std::vector<float>& plane : load.mm) plane.resize(cells);
    read_painting_part(path, info, [&](int y0, int y1, std::span<const float* const> planes) {
        for (int y = y0; y < y1; ++y) {
            std::vector<float> sums(width);
            const auto row_of = [&](std::size_t c) {
                return std::span(planes[c] + static_cast<std::size_t>(y - y0) * width, width);
            };
            for (std::size_t c = 0; c < planes.size(); ++c) {
                std::vector<float>& plane = c == 0 ? load.total_mm : load.mm[c - 1];
                require_volumes(path, info, c, y, row_of(c));
                for (std::size_t x = 0; c > 0 && x < width; ++x) sums[x] += row_of(c)[x];
                std::ranges::copy(row_of(c), plane.begin() + (y + margin) * size + margin);
            }
            require_thickness(path, info, y, sums, kMostOnBristles_mm);
            require_total(path, info, y, row_of(0), sums);
        }
    });
    return load;
}

ReadBrush read_brush(const fs::path& path, const PartInfo& info, const Canvas& painting,
                     const std::optional<Canvas>& board) {
    const std::string where = fmt::format("{}: attribute 'brush' of part 'brush'", path.string());
    const BrushNote note = note_of(info, where);
    if (note.place == Place::palette && !board)
        fail("{}: it was used on a palette, which is not there", where);
    const Canvas& canvas = note.place == Place::palette ? *board : painting;
    std::unique_ptr<Brush> brush = brush_of(note, painting.mm_per_pixel(), where);
    BrushLoad load = read_load(path, info, *brush, canvas.ingredients().size());
    load.rotation_rad = note.rotation_rad;
    brush->put_back(load);
    return {std::move(brush), note.place, note.goes_on};
}

}  // namespace

std::vector<PartToWrite> tools_of(const Session& session) {
    std::vector<PartToWrite> tools;
    if (session.board()) tools.push_back(part_of(*session.board()));
    if (session.brush())
        tools.push_back(part_of(*session.brush(), session.brush_place(), session.brush_goes_on()));
    return tools;
}

std::vector<PartToWrite> tools_among(const std::vector<PartToWrite>& parts) {
    std::vector<PartToWrite> tools;
    std::ranges::copy_if(parts, std::back_inserter(tools), is_tool);
    return tools;
}

std::vector<PartToWrite> with_tools(std::vector<PartToWrite> beside, const std::vector<PartToWrite>& tools) {
    std::erase_if(beside, is_tool);
    beside.insert(beside.end(), tools.begin(), tools.end());
    return beside;
}

std::vector<PartToWrite> with_tools(std::vector<PartToWrite> beside, const Session& session) {
    return with_tools(std::move(beside), tools_of(session));
}

void read_tools(const fs::path& path, Session& session, const Progress& progress) {
    std::optional<Canvas> board;
    ReadBrush hand;
    const std::vector<PartInfo> parts = painting_parts(path);
    for (const PartInfo& part : parts)
        if (part.name == kPalette)
            board.emplace(read_board(path, part, session.canvas().mm_per_pixel(), progress));
    for (const PartInfo& part : parts)
        if (part.name == kBrush) hand = read_brush(path, part, session.canvas(), board);
    session.take_up(std::move(board), std::move(hand.brush), hand.place, hand.goes_on);
}

bool has_paint_or_tools(const PaintingHeader& header) {
    return is_painted(header) || std::ranges::any_of(header.parts, [](const PartInfo& part) {
               return part.name == kPalette || part.name == kBrush;
           });
}

}  // namespace tangi
