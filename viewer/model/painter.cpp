#include "viewer/model/painter.h"

#include <chrono>

#include "paint/canvas/appearance.h"
#include "paint/canvas/canvas_hash.h"
#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "paint/session/journal_file_text.h"
#include "paint/session/mixing_board.h"
#include "retouch/treatment/confining_mask.h"
#include "surface/base/error.h"
#include "surface/file/error_message.h"
#include "surface/file/stale_temporaries.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace {

using Clock = std::chrono::steady_clock;
constexpr float kPaintRoom_mm = 20;                             // what can stand on a painting
constexpr const char* kErrorsPart = "errors";                   // docs/reference/quantities.md
constexpr auto kBeforeShowing = std::chrono::milliseconds(25);  // of painting, at most
constexpr std::size_t kSettledAtOnce = 4;                       // [tiles] a few milliseconds
constexpr auto kBetweenSettled = std::chrono::milliseconds(5);

}  // namespace

Painter::Painter(Setup setup, std::function<void()> wake, const Progress& progress)
    : session_(std::move(setup.canvas), std::move(setup.palette)),
      dry_(session_.canvas().dry_shared()),
      dry_hash_(hash_of(*dry_)),
      mm_per_pixel_(session_.canvas().mm_per_pixel()),
      record_(recovery_files(setup.file)),
      stamp_(setup.stamp ? setup.stamp : stamp_of(main_file_of(setup.file))),
      file_is_new_(setup.file_is_new),
      file_(setup.file),
      wake_(std::move(wake)) {
    remove_stale_temporaries(file_);
    if (!file_is_new_ && std::filesystem::exists(file_))
        guarded([&] {
            read_tools(file_, session_, progress);
            for (const PartInfo& part : painting_parts(file_))
                if (part.name == kErrorsPart) errors_.emplace(file_, part);
        });
    session_.masks_from([this](const std::string& name) {
        const Canvas& on = session_.canvas();
        return masks_beside(record_.files().unsaved, on.width(), on.height())(name);
    });
    const Canvas& canvas = session_.canvas();
    if (!canvas.wet().empty() || !canvas.dried().empty()) painted_ = appearance(canvas, {}, progress);
    range_ = range_of(surface(), kPaintRoom_mm / static_cast<float>(session_.canvas().height_unit_mm()));
    session_.canvas().take_dirty();
    for (const DriedLayer& layer : session_.canvas().dried()) own_.layers.push_back(layer.name);
    mark_saved();
    note_what_is_saved();
    weigh_brush();
    news_.brush_goes_on = session_.brush_goes_on();
    news_.state = own_;
}

Painter::~Painter() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    something_.notify_all();
    horizon_stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (horizon_thread_.joinable()) horizon_thread_.join();
}

std::filesystem::path Painter::file() const {
    const std::lock_guard lock(mutex_);
    return file_;
}

void Painter::start(std::shared_ptr<TexelTiles> tiles) {
    tiles_ = std::move(tiles);
    // Not before: what is opened again is the window's own until then.
    own_.elsewhere = !file_is_new_ && !claim_.take(file_);
    news_.state = own_;
    thread_ = std::thread([this] { work(); });
}

void Painter::post(std::function<void()> job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.push_back(std::move(job));
    }
    something_.notify_one();
}

void Painter::wait() {
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [&] { return jobs_.empty() && !busy_; });
}

bool Painter::idle() const {
    const std::lock_guard lock(mutex_);
    return jobs_.empty() && !busy_;
}

void Painter::hurry(bool give_up_saving) {
    if (give_up_saving || saves_waiting_ == 0) hurry_ = true;
}

PainterNews Painter::fetch() {
    const std::lock_guard lock(mutex_);
    PainterNews news = std::move(news_);
    news_ = {};
    news_.state = news.state;
    news.state.waiting = jobs_.size();
    return news;
}

void Painter::say(std::string text) {
    const std::lock_guard lock(mutex_);
    news_.messages.push_back(std::move(text));
}

void Painter::guarded(const std::function<void()>& action) {
    try {
        action();
    } catch (const std::exception& error) {
        say(message_of(error));
    }
}

void Painter::work() {
    auto shown = Clock::now(), synced = shown;
    bool changed = session_.board() != nullptr;  // that an earlier sitting left: it is shown
    for (;;) {
        std::function<void()> job;
        // What only settled is drawn when there is nothing else to do, a few tiles at a time: drawn when the
        // brush is lifted, all that a long stroke came over would keep the next one waiting.
        const bool settling = !session_.in_stroke() && session_.canvas().has_settled();
        {
            std::unique_lock lock(mutex_);
            busy_ = changed || settling;
            if (jobs_.empty() && !busy_) idle_.notify_all();
            if (!changed)
                something_.wait_for(lock, settling ? kBetweenSettled : std::chrono::milliseconds(1000),
                                    [&] { return stop_ || !jobs_.empty(); });
            if (!jobs_.empty()) {
                job = std::move(jobs_.front());
                jobs_.pop_front();
                busy_ = true;
            } else if (stop_ && !changed) {
                break;
            }
        }
        if (job) {
            guarded(job);
            changed = true;
        }
        if (changed && (!job || Clock::now() - shown >= kBeforeShowing)) {
            guarded([&] { show_changes(session_.canvas().take_painted()); });
            shown = Clock::now();
            changed = false;
        } else if (!job && settling) {
            guarded([&] { show_changes(session_.canvas().take_settled(kSettledAtOnce)); });
        }
        if (Clock::now() - synced >= std::chrono::seconds(1)) {
            keep_record([&] {
                write_masks();
                record_.sync();
            });
            synced = Clock::now();
        }
    }
    guarded([&] {
        if (!own_.elsewhere) end_stroke();
        record_.sync();
        // All of it was undone: nothing is to be recovered.
        if (!own_.unsaved && !record_.empty() && !keep_) record_.put_away();
    });
}

// A copy of the dry surface is as large as that: made only where one paints.
Surface& Painter::own_surface() {
    if (!painted_) painted_ = *dry_;
    return *painted_;
}

void Painter::get_ready() {
    post([this] { own_surface(); });
}

// Texels of what was painted since the last time.
void Painter::show_changes(const std::vector<Region>& dirty) {
    if (!dirty.empty()) {
        update_appearance(shown_ ? *shown_ : session_.canvas(), dirty, own_surface());
        count(dirty);
    }
    std::vector<Region> changed;
    for (Region region : dirty) {
        // Slopes look two pixels far at most.
        region = {region.x0 - 2, region.y0 - 2, region.x1 + 2, region.y1 + 2};
        make_texels(region);
        changed.push_back(region);
    }
    show_board();
    weigh_brush();
    own_.can_undo = session_.history().can_undo();
    own_.can_redo = session_.history().can_redo();
    own_.strokes = session_.totals().strokes + skipped_strokes_;
    own_.layers.clear();
    for (const DriedLayer& layer : session_.canvas().dried()) own_.layers.push_back(layer.name);
    {
        const std::lock_guard lock(mutex_);
        news_.changed.insert(news_.changed.end(), changed.begin(), changed.end());
        news_.state = own_;
    }
    wake_();
}

// The palette: the whole of it when it is new, then what has changed.
void Painter::show_board() {
    Canvas* board = session_.board();
    own_.has_board = board != nullptr;
    if (!board) return;
    const std::vector<Region> dirty = board->take_dirty();
    std::vector<BoardPatch> patches;
    if (!board_) {
        board_ = appearance(*board, look_);
        patches.push_back(board_patch(*board_, board->region()));
    } else {
        update_appearance(*board, dirty, *board_, look_);
        for (const Region& r : dirty) {
            const Region all = board->region();
            patches.push_back(board_patch(*board_, {std::max(r.x0 - 1, 0), std::max(r.y0 - 1, 0),
                                                    std::min(r.x1 + 1, all.x1), std::min(r.y1 + 1, all.y1)}));
        }
    }
    const std::lock_guard lock(mutex_);
    for (BoardPatch& patch : patches) news_.board.push_back(std::move(patch));
}

// Two windows would write one journal, and the one that saves last would undo what the other one saved.
void Painter::refuse_elsewhere() const {
    if (own_.elsewhere)
        fail("{} is open in another window: paint there, or save it under another name here",
             record_.files().painting.filename().string());
}

// So that strokes have a ground when they are recovered.
void Painter::begin_file() {
    const std::filesystem::path& painting = record_.files().painting;
    if (std::filesystem::exists(painting))
        fail("{} has come to be there meanwhile: save under another name", painting.filename().string());
    write_canvas(painting, session_.canvas());
    file_is_new_ = false;
    stamp_ = stamp_of(main_file_of(painting));
    claim_.take(painting);
    note_what_is_saved();
}

void Painter::end_stroke() {
    if (order_.in_stroke()) apply(EndEvent{});
}

void Painter::apply(const Event& event, bool recorded) {
    refuse_elsewhere();
    // The rest of a stroke that something else has ended, as a key in the midst of it.
    if (order_.fit(event) == EventOrder::Fit::nowhere) return;
    if (order_.fit(event) == EventOrder::Fit::after_end) apply(EndEvent{}, recorded);
    const bool undo = std::holds_alternative<UndoEvent>(event);
    if (undo || std::holds_alternative<RedoEvent>(event)) {
        if (hurry_) return;
        if (undo ? !session_.history().can_undo() : !session_.history().can_redo())
            fail("there is nothing to {}", undo ? "undo" : "redo");
    }
    if (file_is_new_) begin_file();
    // What cannot be read again is not painted, and what cannot be painted not recorded: a replay would
    // stumble over it.
    require_readable(event);
    if (!hurry_) session_.apply(event);
    order_.take(event);
    if (recorded) {
        if (names_paints(event)) record_paints();
        if (std::holds_alternative<StrokeEvent>(event)) record_mask();
        record(event);
    }
    own_.unsaved = true;
    own_.stroking = order_.in_stroke();
    if (hurry_) {
        skipped_strokes_ += std::holds_alternative<StrokeEvent>(event);
        return;
    }
    for (std::string warning; !(warning = session_.take_warning()).empty();) say(std::move(warning));
    const bool redo = std::holds_alternative<RedoEvent>(event);
    own_.undone += undo ? 1 : redo ? -1 : 0;
    if (undo || redo) own_.unsaved = !is_as_saved();
}

void Painter::send(Event event) {
    post([this, event = std::move(event)] { apply(event); });
}

void Painter::squeeze(PileEvent pile) {
    post([this, pile = std::move(pile)]() mutable {
        if (const Canvas* board = session_.board()) pile.at = free_place(*board, pile.size_mm);
        apply(pile);
    });
}

}  // namespace tangi
