#include "paint/session/session.h"

#include <algorithm>

#include "paint/session/mixing_board.h"
#include "surface/base/error.h"
#include "surface/base/noise.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

constexpr double kSmallestPile_mm = 3;  // the width of a small brush
constexpr double kSmallestPile_px =
    3;  // lower ones are as wide as this (lay_pile()), and run into each other

constexpr std::size_t kManyPaints = 50;  // strokes through all of them take ten times as long as through four

}  // namespace

Session::Session(std::shared_ptr<const Surface> dry, Palette palette, std::size_t undo_bytes)
    : Session(Canvas(std::move(dry)), std::move(palette), undo_bytes) {}

Session::Session(Canvas canvas, Palette palette, std::size_t undo_bytes)
    : canvas_(std::move(canvas)), palette_(std::move(palette)), history_(undo_bytes) {}

void Session::take_up(std::optional<Canvas> board, std::unique_ptr<Brush> brush, Place place, bool goes_on) {
    TP_REQUIRE(!board_ && !brush_ && !stroke_, "a sitting takes up another before it begins");
    TP_REQUIRE(!brush || place == Place::painting || board, "a brush was used where there is a canvas");
    board_ = std::move(board);
    brush_ = std::move(brush);
    brush_place_ = place;
    hand_ = kept(brush_.get(), place);
    goes_on_ = brush_ && goes_on;
}

Canvas& Session::on(Place place) {
    if (place == Place::painting) return canvas_;
    const double mm = canvas_.mm_per_pixel();
    if (!board_) board_.emplace(make_board(default_board_size(mm), mm));
    return *board_;
}

std::vector<Portion> Session::recipe_of(Canvas& canvas, PaintParts paint, const PaintFinish& finish) {
    // As a journal has them, where names are in order: replayed, paints have the same numbers.
    std::sort(paint.begin(), paint.end());
    const std::size_t before = canvas.ingredients().size();
    std::vector<Portion> recipe;
    for (const auto& [name, part] : paint)
        recipe.push_back({canvas.add(finished(palette_.at(name), finish)), part});
    if (before < kManyPaints && canvas.ingredients().size() >= kManyPaints)
        warnings_.push_back(
            fmt::format("there are {} paints by now: a paint with another 'specular', 'roughness' or "
                        "'medium' is one of its "
                        "own, and each that lies at a place makes strokes there slower and the file larger",
                        canvas.ingredients().size()));
    return recipe;
}

std::string Session::take_warning() {
    if (warnings_.empty()) return history_.take_warning();
    std::string first = std::move(warnings_.front());
    warnings_.pop_front();
    return first;
}

void Session::watch(double first_s, Stroke::Look look) {
    TP_REQUIRE(!stroke_, "no stroke is under way");
    look_at_s_ = first_s;
    look_ = std::move(look);
}

void Session::warn_of_what_is_not_used(const StrokeEvent& event) {
    const bool same = event.start == BrushStart::same && !event.brush.erases;
    if (same && !brush_ && event.on == Place::painting)
        warnings_.emplace_back(
            "'start' is \"same\", but no brush was used before this stroke: it begins with a clean one, "
            "without paint");
    const std::string_view zero = event.load == 0            ? "'load'"
                                  : event.brush.load_mm == 0 ? "the brush's load_mm"
                                                             : "";
    if (!same && !event.paint.empty() && !zero.empty())
        warnings_.push_back(fmt::format("'paint' is not used: {} is 0, so no paint is loaded", zero));
    why_bare_ = same                      ? "'start' is \"same\", and nothing was left on it"
                : !event.paint.empty()    ? fmt::format("{} is 0", zero)
                : event.brush.load_mm > 0 ? "'paint' is missing or empty"
                                          : "";  // a rag is never loaded
    if (same && !event.paint.empty())
        warnings_.emplace_back(
            "'paint' is not used: where 'start' is \"same\", the brush goes on with what is on it");
    // What is said of paint that is not loaded.
    std::string unused;
    const auto note = [&](bool given, const char* key) {
        if (given) unused += fmt::format("{}'{}'", unused.empty() ? "" : ", ", key);
    };
    note(event.finish.specular.has_value(), "specular");
    note(event.finish.roughness.has_value(), "roughness");
    note(event.finish.medium != 0, "medium");
    note(event.load != 1 && event.load != 0, "load");
    if (!unused.empty() && (same || event.paint.empty()))
        warnings_.push_back(fmt::format("{} {} not used: no paint is loaded for this stroke{}", unused,
                                        unused.find(',') == std::string::npos ? "is" : "are",
                                        same ? ", whose 'start' is \"same\"" : " ('paint' is missing)"));
}

// What the stroke is made with. An eraser is none of the hand's brushes: what it takes is gone, and the brush
// in the hand keeps what is on it.
Brush& Session::tool_for(const StrokeEvent& event, Canvas& canvas) {
    warn_of_what_is_not_used(event);
    if (!event.brush.erases) {
        goes_on_ = event.on == Place::palette || event.start == BrushStart::same;
        take_brush(event, canvas);
        return *brush_;
    }
    eraser_ = std::make_unique<Brush>(event.brush, canvas_.mm_per_pixel(), procedural::hash(event.seed, 1));
    return *eraser_;
}

// The brush in the hand for a stroke, with what is on it.
void Session::take_brush(const StrokeEvent& event, Canvas& canvas) {
    if (event.start != BrushStart::clean && brush_) {
        if (brush_place_ != event.on) {
            const auto& paints = on(brush_place_).ingredients();
            std::vector<IngredientId> number(paints.size());
            for (const IngredientId id : brush_->ingredients()) number[id] = canvas.add(paints[id]);
            brush_->renumber(number);
            brush_place_ = event.on;
        }
        // The same brush goes on with what is on each of its bristles.
        if (brush_->settings() == event.brush) return;
    }
    // The bristles are the brush's own: another seed grows other ones.
    auto brush =
        std::make_unique<Brush>(event.brush, canvas_.mm_per_pixel(), procedural::hash(event.seed, 1));
    if (event.start != BrushStart::clean && brush_) brush->take_over(*brush_);
    brush_ = std::move(brush);
    brush_place_ = event.on;
}

void Session::begin(const StrokeEvent& event) {
    Canvas& canvas = on(event.on);
    const std::vector<Portion> recipe = recipe_of(canvas, event.paint, event.finish);
    Brush& tool = tool_for(event, canvas);
    if (event.start != BrushStart::same && !recipe.empty())
        tool.load(recipe, event.load, event.start == BrushStart::dirty);
    history_.begin(canvas, event.on, hand_);
    stroke_place_ = event.on;
    stroke_.emplace(canvas, tool, event.options, procedural::hash(event.seed, 2));
    if (look_ && event.on == Place::painting)
        stroke_->watch(look_at_s_ - painted_s_, [this](double age_s) {
            look_at_s_ = look_(painted_s_ + age_s);
            return look_at_s_ - painted_s_;
        });
    ++totals_.strokes;
}

// One action of the history. Where it ends by an error, nothing has changed.
void Session::act(Place place, const std::function<void(Canvas&)>& action) {
    Canvas& canvas = on(place);
    history_.begin(canvas, place, hand_);
    try {
        action(canvas);
    } catch (...) {
        history_.abandon(canvas);
        throw;
    }
    history_.end(canvas, hand_);
}

void Session::dry_paint(const DryEvent& event) {
    std::string name;
    act(Place::painting, [&](Canvas& canvas) { name = dry(canvas, event.layer, event.where, event.part); });
    if (name.empty())
        warnings_.push_back(
            fmt::format("there is no wet paint that could dry: there is no layer '{}'", event.layer));
    else if (name != event.layer)
        warnings_.push_back(fmt::format("there is a layer '{}' already: what dries now is the layer '{}'",
                                        event.layer, name));
}

void Session::lay(const PileEvent& event) {
    const Canvas& below = on(event.on);
    const double mm = below.mm_per_pixel(), right = below.width() * mm / 2, top = below.height() * mm / 2,
                 x = std::abs(event.at.x), y = std::abs(event.at.y), radius = event.size_mm / 2;
    const std::string where = fmt::format("the pile at ({:.6g}, {:.6g}) mm lies", event.at.x, event.at.y),
                      edge = fmt::format("outside of the {}, which reaches to ({:.4g}, {:.4g}) mm",
                                         event.on == Place::painting ? "painting" : "palette", right, top);
    if (portable::hypot(std::max(x - right, 0.0), std::max(y - top, 0.0)) >= radius) {
        for (const auto& paint : event.paint) palette_.at(paint.first);  // that there are all
        warnings_.push_back(fmt::format("{} wholly {}: nothing is laid", where, edge));
        return;
    }
    if (x + radius > right + mm / 2 || y + radius > top + mm / 2)
        warnings_.push_back(fmt::format("{} in part {}: what is beyond is left out", where, edge));
    act(event.on, [&](Canvas& canvas) {
        lay_pile(canvas, recipe_of(canvas, event.paint, event.finish), event.at, event.size_mm,
                 event.height_mm);
    });
}

void Session::lay_out(const PaletteEvent& event) {
    const double mm = canvas_.mm_per_pixel();
    std::vector<std::string> paints = event.paints;
    if (event.all_paints)
        for (const Pigment& paint : palette_.paints) paints.push_back(paint.name);
    for (const std::string& paint : paints)
        palette_.at(paint);  // that there are all, before anything is done
    if (event.width_mm && event.height_mm) {
        Canvas wanted = make_board({*event.width_mm, *event.height_mm}, mm);
        if (!board_)
            board_.emplace(std::move(wanted));
        else if (board_->region() != wanted.region())
            fail("the palette is {} x {} mm already; its size is chosen before it is used",
                 board_->width() * mm, board_->height() * mm);
    }
    act(Place::palette, [&](Canvas& board) {
        wipe(board);
        if (paints.empty()) return;
        const auto piles = laid_out(paints, {board.width() * mm, board.height() * mm});
        for (const PileEvent& pile : piles)
            lay_pile(board, recipe_of(board, pile.paint, pile.finish), pile.at, pile.size_mm, pile.height_mm);
        const double size_mm = piles.front().size_mm;
        if (size_mm < kSmallestPile_mm || size_mm < kSmallestPile_px * mm)
            warnings_.push_back(fmt::format(
                "the palette of {:.4g} x {:.4g} mm is too small for {} paints: their piles are {:.2g} mm "
                "({:.2g} pixels) wide, and a brush does not meet one alone; lay out fewer, or make it larger "
                "('width_mm', 'height_mm') before it is used",
                board.width() * mm, board.height() * mm, piles.size(), size_mm, size_mm / mm));
    });
}

// Of the stroke that is over: why it is not to be seen.
void Session::warn_of_no_effect(bool changed) {
    const auto& load = (eraser_ ? *eraser_ : *brush_).bristles().total_mm;
    const bool is_empty = std::all_of(load.begin(), load.end(), [](float mm) { return mm == 0; });
    if (stroke_->steps() == 0 || changed) return;
    if (stroke_->greatest_pressure() == 0)
        warnings_.emplace_back(
            "the stroke is not pressed at any of its points ('p' is 0): it paints nothing");
    else if (!stroke_->met_canvas())
        warnings_.push_back(
            fmt::format("the stroke lies wholly outside of the {}, which reaches to ({:.4g}, {:.4g}) mm: it "
                        "paints nothing",
                        stroke_place_ == Place::painting ? "painting" : "palette",
                        on(stroke_place_).width() * canvas_.mm_per_pixel() / 2,
                        on(stroke_place_).height() * canvas_.mm_per_pixel() / 2));
    else if (is_empty)
        warnings_.push_back(fmt::format(
            "the stroke changes nothing: {}no wet paint lies under it{}",
            why_bare_.empty() ? "" : fmt::format("no paint is on the brush ({}), and ", why_bare_),
            stroke_place_ == Place::painting && !canvas_.dried().empty() ? "; what is dry stays as it is"
                                                                         : ""));
    else
        warnings_.push_back(
            fmt::format("the stroke changes nothing{}",
                        stroke_place_ == Place::painting && canvas_.mask()
                            ? ": it lies outside of the mask that brushes stop at (in a treatment: the "
                              "damage map as it is in the log)"
                            : ""));
}

void Session::end_by(const Event& event) {
    if (!stroke_) return;
    order_.end_by(event);
    stroke_->finish();
    totals_.steps += stroke_->steps();
    totals_.bristle_pixels += stroke_->bristle_pixels();
    if (stroke_place_ == Place::painting) painted_s_ += stroke_->age_s();
    if (!eraser_) hand_ = kept(brush_.get(), brush_place_);
    warn_of_no_effect(history_.end(on(stroke_place_), hand_));
    stroke_.reset();
    eraser_.reset();
}

void Session::undo() {
    if (!history_.can_undo()) fail("there is nothing to undo");
    std::optional<BrushInHand> hand;
    history_.undo(on(history_.place_to_undo()), &hand);
    take_hand(hand);
}

void Session::redo() {
    if (!history_.can_redo()) fail("there is nothing to redo");
    std::optional<BrushInHand> hand;
    history_.redo(on(history_.place_to_redo()), &hand);
    take_hand(hand);
}

void Session::confine(const ConfineEvent& event) {
    if (!event.mask.empty() && !masks_)
        fail("brushes stop at a mask here, {}, and it is not known where masks are kept", event.mask);
    canvas_.confine(event.mask.empty() ? nullptr : masks_(event.mask));
}

void Session::take_hand(const std::optional<BrushInHand>& hand) {
    if (hand == hand_) return;
    brush_ = taken_up(hand, canvas_.mm_per_pixel());
    brush_place_ = hand ? hand->place : Place::painting;
    hand_ = hand;
}

void Session::wash() {
    brush_.reset();
    hand_.reset();
    brush_place_ = Place::painting;
    goes_on_ = false;
}

void Session::apply(const Event& event) {
    if (const auto* point = std::get_if<PointEvent>(&event)) {
        if (order_.fit(event) == EventOrder::Fit::nowhere) fail("{}", why_nowhere(order_));
        stroke_->add(point->point);
        order_.take(event);
        ++totals_.points;
        return;
    }
    end_by(event);
    if (const auto* stroke = std::get_if<StrokeEvent>(&event)) {
        begin(*stroke);
    } else if (std::holds_alternative<UndoEvent>(event)) {
        undo();
    } else if (std::holds_alternative<RedoEvent>(event)) {
        redo();
    } else if (const auto* drying = std::get_if<DryEvent>(&event)) {
        dry_paint(*drying);
    } else if (const auto* lift = std::get_if<LiftEvent>(&event)) {
        act(Place::painting, [&](Canvas& canvas) { lift_off(canvas, lift->layer); });
    } else if (const auto* pile = std::get_if<PileEvent>(&event)) {
        lay(*pile);
    } else if (const auto* palette = std::get_if<PaletteEvent>(&event)) {
        lay_out(*palette);
    } else if (const auto* mask = std::get_if<ConfineEvent>(&event)) {
        confine(*mask);
    } else if (const auto* paints = std::get_if<PaintsEvent>(&event)) {
        palette_ = paints->palette ? *paints->palette : artist_acrylics();
    } else if (std::holds_alternative<WashEvent>(event)) {
        wash();
    }
    order_.take(event);
}

std::vector<std::string> replay(Session& session, const Journal& journal, const Progress& progress) {
    std::vector<JournalWarning> warnings = journal.warnings;
    const auto take_warnings = [&](int line) {
        for (std::string text; !(text = session.take_warning()).empty();)
            warnings.push_back({line, std::move(text)});
    };
    int stroke_line = 0;  // of the stroke that finish() ends
    const auto count = static_cast<double>(journal.entries.size());
    std::size_t last_undo = 0;
    for (std::size_t i = 0; i < journal.entries.size(); ++i)
        if (std::holds_alternative<UndoEvent>(journal.entries[i].event) ||
            std::holds_alternative<RedoEvent>(journal.entries[i].event))
            last_undo = i + 1;
    for (std::size_t i = 0; i < journal.entries.size(); ++i) {
        report(progress, "replay strokes", static_cast<double>(i) / count);
        const auto& [line, event] = journal.entries[i];
        const bool is_stroke = std::holds_alternative<StrokeEvent>(event);
        try {
            // Of the stroke that ends here, by its line.
            if (session.in_stroke() && !std::holds_alternative<PointEvent>(event)) {
                session.end_by(event);
                take_warnings(stroke_line);
            }
            if (is_stroke) stroke_line = line;
            if (is_stroke && i >= last_undo) session.forget_history();
            session.apply(event);
        } catch (const Error& error) {
            fail("{}:{}: {}", journal.source, line, error.what());
        }
        take_warnings(line);
    }
    session.finish();
    take_warnings(stroke_line);
    report(progress, "replay strokes", 1);
    std::ranges::stable_sort(warnings, {}, &JournalWarning::line);
    std::vector<std::string> told;
    for (const JournalWarning& warning : warnings)
        told.push_back(fmt::format("{}:{}: {}", journal.source, warning.line, warning.text));
    return told;
}

}  // namespace tangi
