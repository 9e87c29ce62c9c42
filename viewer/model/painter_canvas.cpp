// painter_canvas.cpp: of the painter: the canvas changed, confined and shown otherwise than by strokes.
#include <algorithm>

#include "paint/canvas/appearance_part.h"
#include "surface/painting_file/painting_tiles.h"
#include "viewer/model/painter.h"

namespace tangi {

namespace {

// All that lies in a tile, bottom up: layers share the tiles that they did not change.
std::vector<PaintLayer::TilePtr> stack_at(const Canvas& canvas, TileIndex at) {
    std::vector<PaintLayer::TilePtr> stack;
    for (const DriedLayer& layer : canvas.dried())
        if (const auto& tile = layer.paint.tile(at)) stack.push_back(tile);
    stack.push_back(canvas.wet().tile(at));
    return stack;
}

std::vector<TileIndex> tiles_that_differ(const Canvas& a, const Canvas& b) {
    std::vector<TileIndex> tiles;
    for (int y = 0; y < a.wet().rows(); ++y)
        for (int x = 0; x < a.wet().columns(); ++x)
            if (stack_at(a, {x, y}) != stack_at(b, {x, y})) tiles.push_back({x, y});
    return tiles;
}

}  // namespace

Painter::SavedTiles Painter::tiles_of(const Canvas& canvas) {
    SavedTiles saved;
    for (const DriedLayer& layer : canvas.dried()) saved.layers.push_back(layer.name);
    for (int y = 0; y < canvas.wet().rows(); ++y)
        for (int x = 0; x < canvas.wet().columns(); ++x) {
            const auto stack = stack_at(canvas, {x, y});
            if (std::ranges::all_of(stack, [](const auto& tile) { return !tile; })) continue;
            for (const auto& tile : stack) saved.stacks[{x, y}].push_back({tile.get(), tile});
        }
    return saved;
}

// Tiles that undo brought back are the same, unless they were on disk meanwhile: these count as others.
bool Painter::are_tiles_of(const SavedTiles& saved, const Canvas& canvas) {
    const SavedTiles now = tiles_of(canvas);
    const auto same = [](const SavedTile& a, const SavedTile& b) {
        return a.tile == b.tile && (!a.tile || !a.alive.expired());
    };
    return now.layers == saved.layers &&
           std::ranges::equal(saved.stacks, now.stacks, [&](const auto& a, const auto& b) {
               return a.first == b.first && std::ranges::equal(a.second, b.second, same);
           });
}

void Painter::mark_saved() {
    saved_ = tiles_of(session_.canvas());
    saved_board_.reset();
    if (const Canvas* board = session_.board()) saved_board_ = tiles_of(*board);
    own_.unsaved = false;
}

bool Painter::is_as_saved() const {
    if (!are_tiles_of(saved_, session_.canvas())) return false;
    const Canvas* board = session_.board();
    if (!board || !saved_board_) return !board || board->wet().painted().empty();
    return are_tiles_of(*saved_board_, *board);
}

// Pixels with wet paint, of the tiles that changed.
void Painter::count(std::span<const Region> changed) {
    const PaintLayer& wet = session_.canvas().wet();
    for (const Region& part : changed) {
        const TileIndex at{part.x0 / PaintTile::kSize, part.y0 / PaintTile::kSize};
        Counted counted;
        if (wet.tile(at)) {
            const Region r = wet.region_of(at);
            Image<float> mm(r.width(), r.height());
            wet.add_thickness_mm(r, mm.data(), static_cast<std::size_t>(mm.width()));
            for (int y = 0; y < r.height(); ++y)
                for (int x = 0; x < r.width(); ++x) {
                    if (!(mm(x, y) > 0)) continue;
                    ++counted.painted;
                    counted.outside += allowed_ && (*allowed_)(r.x0 + x, r.y0 + y) < 1;
                }
        }
        counted_[at] = counted;
    }
    own_.painted_px = own_.outside_px = 0;
    for (const auto& [at, counted] : counted_) {
        own_.painted_px += counted.painted;
        own_.outside_px += counted.outside;
    }
}

void Painter::confine(Stops stops, std::shared_ptr<const Image<float>> allowed) {
    post([this, stops = std::move(stops), allowed = std::move(allowed)] {
        end_stroke();
        session_.canvas().confine(stops.mask);
        stops_ = stops;
        allowed_ = allowed;
        std::vector<Region> painted;
        for (const TileIndex at : session_.canvas().wet().painted())
            painted.push_back(session_.canvas().wet().region_of(at));
        count(painted);
    });
}

void Painter::show(std::optional<Canvas> canvas) {
    Canvas& own = session_.canvas();
    for (const TileIndex tile : tiles_that_differ(shown_ ? *shown_ : own, canvas ? *canvas : own))
        own.mark_dirty(tile);
    shown_ = std::move(canvas);
}

// The canvas is this one from now on. Its paints go on from those of the one before, whose numbers the brush
// knows.
void Painter::adopt(Canvas canvas) {
    show({});
    canvas.confine(session_.canvas().mask());
    for (const TileIndex tile : tiles_that_differ(session_.canvas(), canvas)) canvas.mark_dirty(tile);
    session_.canvas() = std::move(canvas);
    session_.forget_history();
    if (!own_.unsaved) mark_saved();
}

std::future<void> Painter::change(std::function<void(Canvas&)> work) {
    auto promise = std::make_shared<std::promise<void>>();
    post([this, promise, work = std::move(work)] {
        try {
            if (hurry_) throw Cancelled();
            refuse_elsewhere();
            refuse_replaced();
            end_stroke();
            Canvas next = session_.canvas();
            next.confine({});
            work(next);
            // A step of a treatment writes the file anew.
            own_.elsewhere = !claim_.take(record_.files().painting);
            const auto stamp = std::exchange(stamp_, stamp_of(main_file_of(record_.files().painting)));
            adopt(std::move(next));
            if (stamp_ != stamp) note_what_is_saved();
            promise->set_value();
        } catch (...) {
            promise->set_exception(std::current_exception());
        }
    });
    return promise->get_future();
}

std::future<void> Painter::look(std::function<void(const Surface&, const Canvas&)> work) {
    return look_at_session(
        [this, work = std::move(work)](const Session& session) { work(surface(), session.canvas()); });
}

std::future<void> Painter::look_at_session(std::function<void(const Session&)> work) {
    auto promise = std::make_shared<std::promise<void>>();
    post([this, promise, work = std::move(work)] {
        try {
            end_stroke();
            work(session_);
            promise->set_value();
        } catch (...) {
            promise->set_exception(std::current_exception());
        }
    });
    return promise->get_future();
}

void Painter::show_as(std::function<Canvas(const Canvas&)> view) {
    post([this, view = std::move(view)] {
        end_stroke();
        show(view ? std::optional(view(session_.canvas())) : std::nullopt);
    });
}

// Of pixels, as far as the painting goes.
void Painter::make_texels(const Region& region) {
    const Canvas& canvas = shown_ ? *shown_ : session_.canvas();
    const Region part = intersection(region, canvas.region());
    if (look_.illuminant == Illuminant::d65)
        tiles_->update(surface(), part);
    else
        tiles_->update_part(appearance_in(canvas, part, look_), part);
}

void Painter::show_in(Illuminant illuminant) {
    post([this, illuminant] {
        if (illuminant == look_.illuminant) return;
        look_.illuminant = illuminant;
        board_.reset();
        show_rows_in(illuminant, 0);
    });
}

void Painter::show_rows_in(Illuminant illuminant, int row) {
    constexpr int kRows = 256;
    const Region all = session_.canvas().region();
    if (illuminant != look_.illuminant || row >= all.y1 || hurry_) return;  // another one has begun
    const Region rows{all.x0, row, all.x1, std::min(row + kRows, all.y1)};
    make_texels(rows);
    {
        const std::lock_guard lock(mutex_);
        news_.changed.push_back(rows);
    }
    post([=, this] { show_rows_in(illuminant, row + kRows); });
}

void Painter::keep_by(Keep keep) {
    post([this, keep = std::move(keep)] { keep_ = keep; });
}

}  // namespace tangi
