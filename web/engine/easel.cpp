#include "web/engine/easel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "paint/canvas/appearance_part.h"
#include "paint/canvas/appearance_slopes.h"
#include "paint/canvas/canvas_hash.h"
#include "paint/canvas/layer_pictures.h"
#include "paint/session/journal_file_text.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/image/colour.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"
#include "viewer/model/palette_image.h"
#include "viewer/render/horizon.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr float kPaintRoom_mm = 20;  // what can stand on a painting
constexpr std::size_t kSettledAtOnce = 8;
constexpr double kSpared = 1024;  // [pixels] that cost as much as a part of its own
constexpr int kBand = 64;         // rows that are looked at at once: those of a tile of paint
const Vec3 kDaylight = glm::normalize(Vec3(-1, 1, 2));

json srgb_of(const Rgb& linear) {
    const Rgb encoded = Transfer{Transfer::Kind::srgb}.encode(glm::clamp(linear, 0.0f, 1.0f));
    json codes = json::array();
    for (int c = 0; c < 3; ++c) codes.push_back(std::lround(255 * encoded[c]));
    return codes;
}

std::uint8_t code_of(float encoded) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(encoded, 0.0f, 1.0f) * 255));
}

// Parts of at least a thousandth, by the paints' names.
json recipe_of(const std::vector<Pigment>& paints, std::span<const double> parts) {
    json recipe = json::object();
    double sum = 0;
    for (const double part : parts) sum += part;
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (parts[i] > 0.001 * sum)
            recipe[paints[i].name] = recipe.value(paints[i].name, 0.0) + parts[i] / sum;
    return recipe;
}

Rgb colour_of(const std::vector<Pigment>& paints, std::span<const double> parts) {
    std::vector<Pigment> used;
    std::vector<float> shares;
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (parts[i] > 0) used.push_back(paints[i]), shares.push_back(static_cast<float>(parts[i]));
    return thick_film(used, shares, Illuminant::d65);
}

double area(const Region& r) { return static_cast<double>(r.width()) * r.height(); }

// Parts that lie side by side as one, of those that follow each other: each is looked at together with what
// is around it.
std::vector<Region> joined_once(const std::vector<Region>& parts) {
    constexpr std::ptrdiff_t kBack = 8;
    std::vector<Region> result;
    for (const Region& part : parts) {
        const auto last = result.end(), first = last - std::min<std::ptrdiff_t>(kBack, last - result.begin());
        const auto beside = std::find_if(first, last, [&](const Region& r) {
            return area(united(r, part)) <= area(r) + area(part) + kSpared;
        });
        if (beside == last)
            result.push_back(part);
        else
            *beside = united(*beside, part);
    }
    return result;
}

Rgb lit(const Surface& surface, int x, int y) {
    return reflected(surface, x, y, kDaylight, {0, 0, 1}, WardModel::bounded) + 0.15f * surface.diffuse(x, y);
}

}  // namespace

Easel::Easel(Canvas canvas, std::size_t undo_bytes)
    : ground_(canvas.dry_shared()),
      ground_hash_(hash_of(*ground_)),
      session_(std::move(canvas), artist_acrylics(), undo_bytes),
      range_(range_of_look()),
      head_(hash()) {
    pack_all();
}

TexelRange Easel::range_of_look() const {
    return range_of(*ground_, kPaintRoom_mm / static_cast<float>(session_.canvas().height_unit_mm()));
}

void Easel::pack_all() {
    const Canvas& canvas = session_.canvas();
    tiles_.emplace(canvas.width(), canvas.height(), range_);
    heights_ = {std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
    const auto pack = [&](const Region& part, const Surface& look) {
        tiles_->update_part(look, part);
        const ShownHeights here = heights_of(look);
        heights_ = {std::min(heights_.lowest_mm, here.lowest_mm),
                    std::max(heights_.highest_mm, here.highest_mm)};
    };
    if (canvas.ingredients().empty())
        pack(canvas.region(), *in_scale_of(canvas, ground_));
    else
        in_bands(pack);
    session_.canvas().take_dirty();
}

Surface Easel::look_in(const Region& part) const {
    const Canvas& canvas = session_.canvas();
    return *in_scale_of(canvas, std::make_shared<const Surface>(appearance_in(canvas, part)));
}

void Easel::in_bands(const std::function<void(const Region& rows, const Surface& look)>& work) const {
    const Region all = session_.canvas().region();
    for (int y = all.y0; y < all.y1; y += kBand) {
        const Region rows{all.x0, y, all.x1, std::min(y + kBand, all.y1)};
        work(rows, look_in(rows));
    }
}

void Easel::lie_on(Surface ground) {
    const auto dry = std::make_shared<const Surface>(std::move(ground));
    session_.canvas().lie_on(dry);
    ground_ = dry;
    ground_hash_ = hash_of(*ground_);
    head_ = hash_of(Canvas(ground_), ground_hash_);
    range_ = range_of_look();
    pack_all();
}

json Easel::picture() const {
    return web_picture_data(*in_scale_of(session_.canvas(), ground_), range_, heights_);
}

void Easel::begin(std::string_view first_line) const {
    const JournalHead head = head_from(first_line, "the journal");
    if (!head.on.empty() && head.on != hash())
        fail("the journal goes on from another painting ({}) than this one ({})", head.on, hash());
}

std::string Easel::apply(std::string_view line) {
    std::string why;
    const auto parsed = parsed_line(line, "the stroke", &why);
    if (!parsed) fail("the line is no JSON: {}", why);
    session_.apply(event_from_json(*parsed, "the stroke"));
    std::string told;
    for (std::string text; !(text = session_.take_warning()).empty();)
        told += (told.empty() ? "" : "; ") + text;
    return told;
}

std::vector<Region> Easel::refresh(bool all) {
    Canvas& canvas = session_.canvas();
    std::vector<Region> changed = canvas.take_painted();
    if (all)
        for (const Region& region : canvas.take_settled(kSettledAtOnce)) changed.push_back(region);
    for (Region& region : changed) region = intersection(grown(region), canvas.region());
    changed = joined_once(joined_once(changed));  // of tiles to rows, of rows to blocks
    for (const Region& region : changed) tiles_->update_part(look_in(region), region);
    return changed;
}

std::vector<Texel> Easel::texels(int level, const Region& region) const {
    std::vector<Texel> result;
    result.reserve(static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height()));
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) result.push_back(tiles_->at(x, y, level));
    return result;
}

std::optional<Easel::BoardPicture> Easel::board_changes(bool whole) {
    Canvas* board = session_.board();
    if (!board) return {};
    const std::vector<Region> changed = board->take_dirty();
    const bool is_new = !board_;
    if (is_new) board_ = appearance(*board);
    if (changed.empty() && !is_new && !whole) return {};
    if (!is_new && !changed.empty()) update_appearance(*board, changed, *board_);
    Region all = is_new || whole ? board->region() : changed.front();
    for (const Region& r : changed)
        all = {std::min(all.x0, r.x0), std::min(all.y0, r.y0), std::max(all.x1, r.x1),
               std::max(all.y1, r.y1)};
    all = {std::max(all.x0 - 2, 0), std::max(all.y0 - 2, 0), std::min(all.x1 + 2, board->width()),
           std::min(all.y1 + 2, board->height())};
    const BoardPatch patch = board_patch(*board_, all, kDaylight);
    BoardPicture picture{board->width(), board->height(), all, {}};
    picture.rgba.reserve(4 * patch.srgb.size());
    for (const auto& pixel : patch.srgb)
        for (const std::uint8_t code : {pixel.r, pixel.g, pixel.b, std::uint8_t(255)})
            picture.rgba.push_back(code);
    return picture;
}

const Canvas* Easel::canvas_of(Place place) const {
    return place == Place::painting ? &session_.canvas() : session_.board();
}

json Easel::on_brush() const {
    const Brush* brush = session_.brush();
    const Canvas* canvas = brush ? canvas_of(session_.brush_place()) : nullptr;
    if (!canvas) return {{"fill", 0}, {"recipe", json::object()}};
    const std::vector<double> mm3 = brush->volumes_mm3(canvas->ingredients().size());
    double sum = 0;
    for (const double part : mm3) sum += part;
    const double full = brush->full_mm3();
    if (!(sum > 0) || !(full > 0)) return {{"fill", 0}, {"recipe", json::object()}};
    return {{"fill", sum / full},
            {"rgb", srgb_of(colour_of(canvas->ingredients(), mm3))},
            {"recipe", recipe_of(canvas->ingredients(), mm3)}};
}

json Easel::sample(Place place, double x_mm, double y_mm, double radius_mm) const {
    const Canvas* canvas = canvas_of(place);
    if (!canvas) return nullptr;
    const double mm = canvas->mm_per_pixel();
    const double x = x_mm / mm + (canvas->width() - 1) / 2.0, y = (canvas->height() - 1) / 2.0 - y_mm / mm;
    if (!(x > -0.5 && y > -0.5 && x < canvas->width() - 0.5 && y < canvas->height() - 0.5)) return nullptr;
    const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
    const Surface seen = appearance_in(*canvas, {column, row, column + 1, row + 1});
    const Recipe recipe = recipe_at(*canvas, x, y, std::max(radius_mm / mm, 0.5));
    std::vector<double> parts(canvas->ingredients().size());
    for (const Portion& portion : recipe.portions) parts[portion.ingredient] += portion.part;
    return {{"rgb", srgb_of(seen.diffuse(0, 0))},
            {"recipe", recipe.portions.empty() ? json::object() : recipe_of(canvas->ingredients(), parts)},
            {"thickness_mm", recipe.thickness_mm}};
}

json Easel::paints() const {
    json all = json::array();
    for (const Pigment& paint : session_.palette().paints) {
        const double one = 1;
        all.push_back({{"name", paint.name}, {"rgb", srgb_of(colour_of({paint}, {&one, 1}))}});
    }
    return all;
}

json Easel::state() const {
    json layers = json::array();
    for (const DriedLayer& layer : session_.canvas().dried()) layers.push_back(layer.name);
    return {{"can_undo", session_.history().can_undo()}, {"can_redo", session_.history().can_redo()},
            {"strokes", session_.totals().strokes},      {"layers", layers},
            {"wet", !session_.canvas().wet().empty()},   {"in_stroke", session_.in_stroke()},
            {"goes_on", session_.brush_goes_on()},       {"bytes", bytes()}};
}

std::string Easel::hash() const { return hash_of(session_.canvas(), ground_hash_); }

std::string Easel::look_hash() {
    while (!refresh(true).empty()) {  // what only settled comes in parts
    }
    return hash_of(*in_scale_of(session_.canvas(), shown(session_.canvas())));
}

Easel::BoardPicture Easel::thumbnail(int width) {
    const Region all = session_.canvas().region();
    const int w = std::clamp(width, 1, all.width());
    const int h =
        std::max(1, static_cast<int>(std::lround(static_cast<double>(w) * all.height() / all.width())));
    BoardPicture picture{w, h, {0, 0, w, h}, {}};
    const Transfer srgb{Transfer::Kind::srgb};
    for (int y = 0; y < h; ++y) {
        const int y0 = y * all.height() / h, y1 = std::max((y + 1) * all.height() / h, y0 + 1);
        const Surface rows = look_in({0, y0, all.width(), y1});
        for (int x = 0; x < w; ++x) {
            // The mean of what a pixel holds.
            const int x0 = x * all.width() / w, x1 = std::max((x + 1) * all.width() / w, x0 + 1);
            Rgb sum(0);
            for (int v = 0; v < rows.height(); ++v)
                for (int u = x0; u < x1; ++u) sum += lit(rows, u, v);
            sum /= static_cast<float>((x1 - x0) * rows.height());
            for (int c = 0; c < 3; ++c) picture.rgba.push_back(code_of(srgb.encode(sum[c])));
            picture.rgba.push_back(255);
        }
    }
    return picture;
}

std::vector<std::string> Easel::layer_names() const {
    std::vector<std::string> names;
    for (const LayerPicture& layer : layer_pictures(session_.canvas())) names.push_back(layer.name);
    return names;
}

Easel::BoardPicture Easel::layer_picture(std::size_t number) const {
    const std::vector<LayerPicture> layers = layer_pictures(session_.canvas());
    TP_REQUIRE(number < layers.size(), "there is such a layer");
    const LayerPicture& layer = layers[number];
    BoardPicture picture{layer.srgb.width(), layer.srgb.height(), layer.srgb.region(), {}};
    picture.rgba.reserve(4 * layer.srgb.size());
    for (std::size_t i = 0; i < layer.srgb.size(); ++i) {
        for (int c = 0; c < 3; ++c) picture.rgba.push_back(code_of(layer.srgb.pixels()[i][c]));
        picture.rgba.push_back(code_of(layer.alpha.pixels()[i]));
    }
    return picture;
}

Easel::Horizon Easel::horizon(int largest_side) {
    const Canvas& canvas = session_.canvas();
    Image<float> heights(canvas.width(), canvas.height());
    in_bands([&](const Region& rows, const Surface& look) {
        std::copy(look.height_mm.pixels().begin(), look.height_mm.pixels().end(),
                  heights.row(rows.y0).begin());
    });
    HorizonMap map = horizon_map(coarse_heights(heights, canvas.mm_per_pixel(), largest_side));
    return {map.width, map.height, std::move(map.values)};
}

std::size_t Easel::bytes() const {
    const auto pixels =
        static_cast<std::size_t>(ground_->width()) * static_cast<std::size_t>(ground_->height());
    return pixels * (44 + 21) + session_.canvas().bytes() +
           (session_.board() ? session_.board()->bytes() : 0);
}

}  // namespace tangi
