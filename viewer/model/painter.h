// painter.h: the painting engine on a thread of its own, so that looking never waits for painting.
//
// The window sends events; the painter applies them to the canvas, records them (crash_recovery.h), makes
// texels of what has changed, and tells where, for the window to upload them. What a stroke under way is in
// the way of ends it, and what comes of the stroke after that is left out (paint/session/event_order.h).
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "paint/canvas/appearance.h"
#include "paint/session/session.h"
#include "surface/file/file_stamp.h"
#include "surface/painting_file/exr_pixel_reader.h"
#include "viewer/model/crash_recovery.h"
#include "viewer/model/measurement.h"
#include "viewer/model/painting_lock.h"
#include "viewer/model/palette_image.h"
#include "viewer/render/horizon.h"
#include "viewer/render/texels.h"

namespace tangi {

// How far a pixel's maps may be off where the painting was fitted (the part `errors`,
// docs/reference/quantities.md); 0 where it is not known.
struct StandardErrors {
    float slope = 0, diffuse = 0, specular = 0, roughness = 0;
    float height_mm = 0;  // of relief within some 30 pixels
};

// What is at a place: all maps of its pixel, and the paint of the wet layer there.
struct Probe {
    int x = 0, y = 0;
    Material material;
    StandardErrors errors{};  // where no paint lies over what was fitted
    double paint_mm = 0;
    std::vector<std::pair<std::string, double>> recipe{};  // of paints, parts that sum to 1
};

// What is on the brush.
struct OnBrush {
    double fill = 0;                                       // [1] of a full load; more where it took paint up
    std::vector<std::pair<std::string, double>> recipe{};  // of paints, parts that sum to 1; most first
    Rgb colour{0};                                         // [linear] laid on thickly
    friend bool operator==(const OnBrush&, const OnBrush&) = default;
};

struct PainterState {
    OnBrush on_brush;       // as the last stroke has left it so far
    bool stroking = false;  // a stroke is under way
    bool can_undo = false, can_redo = false, unsaved = false, saving = false, has_board = false;
    bool elsewhere = false;  // it is open in another window: here one may look
    int strokes = 0, undone = 0, saves = 0;
    std::vector<std::string> layers;     // dried, from the bottom up
    std::size_t waiting = 0;             // events not painted yet
    int painted_px = 0, outside_px = 0;  // that hold wet paint: all, and those outside of where it may lie
};

// What has happened since it was last fetched.
struct PainterNews {
    std::vector<Region> changed;  // of the painting: its tiles have the new texels
    std::vector<BoardPatch> board;
    std::optional<HorizonMap> horizon;
    std::optional<Probe> probe, picked;
    std::optional<HeightProfile> profile;
    std::optional<RegionStatistics> statistics;
    std::vector<std::string> messages;  // errors, and what was done
    bool needs_name = false;            // it was not saved: another painting lies at its place
    // A painting was opened, or strokes recovered: whether one paints on with what is on the brush.
    std::optional<bool> brush_goes_on;
    PainterState state;
};

class Painter {
public:
    struct Setup {
        Canvas canvas;
        Palette palette;
        std::filesystem::path file;  // where it is saved, and beside which its journal lies
        bool file_is_new = false;    // it is written before the first stroke, so that strokes have a ground
        std::optional<FileStamp> stamp{};  // of the file before it was read
    };
    // `wake` is called from the painter's thread when there is news.
    Painter(Setup setup, std::function<void()> wake, const Progress& progress = {});
    ~Painter();  // finishes what was sent

    // What the painting looks like; only before start().
    const Surface& surface() const { return painted_ ? *painted_ : *dry_; }
    const TexelRange& range() const { return range_; }
    // [mm] Of strokes and brushes; that of the surface where its scale is known.
    double mm_per_pixel() const { return mm_per_pixel_; }
    std::filesystem::path file() const;
    const std::shared_ptr<const Surface>& dry() const { return dry_; }
    // Of the painting in the file (hash_of(Canvas)); only before the first change.
    const std::string& saved_hash() const { return saved_hash_; }

    // Takes on the tiles that were made of surface(), and keeps them up to date. The painting is this
    // window's from then on, unless another one has it.
    void start(std::shared_ptr<TexelTiles> tiles);

    void send(Event event);
    void squeeze(PileEvent pile);   // onto the palette, where there is room for it
    void recover(Journal journal);  // paints what a crash left
    void discard();                 // puts the journal of unsaved strokes aside
    // Not over another painting that was put in its place.
    void save();
    // And it has this name from then on. What lies there is overwritten.
    void save_as(const std::filesystem::path& file);
    void probe(int x, int y);
    void pick(double x, double y, double radius_px);
    void profile(const glm::dvec2& from_px, const glm::dvec2& to_px);
    void statistics(const Region& region);
    void make_horizon();
    void get_ready();  // to paint: takes the memory that the first stroke needs, in time

    // Brushes stop at `mask` (Canvas::confine()), which journals name (ConfineEvent); wet paint outside of
    // `allowed` is counted. Null: neither.
    struct Stops {
        std::shared_ptr<const Image<float>> mask;
        std::string name, png;  // of its file (ConfiningMask), and what that holds
    };
    void confine(Stops stops, std::shared_ptr<const Image<float>> allowed);
    // Has `work` change the canvas, between strokes; undo goes no further back. What it throws comes out of
    // the future, and the canvas is as it was.
    std::future<void> change(std::function<void(Canvas&)> work);
    // The painting as it is, to look at.
    std::future<void> look(std::function<void(const Surface& seen, const Canvas& canvas)> work);
    // The same, with the palette and the brush.
    std::future<void> look_at_session(std::function<void(const Session& session)> work);
    // Shows the painting as `view` makes it of what it is, until something else is shown or it is changed by
    // change(). Empty: as it is.
    void show_as(std::function<Canvas(const Canvas&)> view);
    // Shows the painting and the palette as they look in this light, some rows after others, so that strokes
    // come between. What is probed, measured, looked at and saved stays as it is in daylight (D65).
    void show_in(Illuminant illuminant);
    // Saving in its place is `keep`'s business, which may change the canvas and says what was done. Where it
    // did nothing, since nothing was painted, the journal goes on.
    struct ToKeep {
        std::string journal;            // of what was done since the last time; empty: nothing
        std::filesystem::path unsaved;  // its file, which goes with what is kept; need not be there
        std::map<std::string, std::string> masks;  // that it names -> what their files hold
        std::vector<PartToWrite> tools;            // palette and brush as they are now (palette_part.h)
    };
    struct Kept {
        std::string said;
        bool done = true;
    };
    using Keep = std::function<Kept(Canvas& canvas, const ToKeep& recovery)>;
    void keep_by(Keep keep);

    PainterNews fetch();
    void wait();        // until everything that was sent is done
    bool idle() const;  // it is
    // It is to end: what was sent and is not painted yet is recorded only, so that it can be recovered, but
    // for undo and redo; nothing is changed. Where a save was asked for, only if that is given up.
    void hurry(bool give_up_saving);

private:
    void work();
    void post(std::function<void()> job);
    void apply(const Event& event, bool recorded = true);
    void paint(const Event& event);
    void end_stroke();
    void record(const Event& event);
    void record_paints();
    void record_mask();
    void write_masks();
    void took_mask(const std::string& name);
    void begin_journal();
    void keep_record(const std::function<void()>& action);
    void begin_file();
    void refuse_elsewhere() const;
    void refuse_replaced() const;
    void show_changes(const std::vector<Region>& dirty);
    Surface& own_surface();
    void make_texels(const Region& region);
    void show_rows_in(Illuminant illuminant, int row);
    void show_board();
    void weigh_brush();
    void say(std::string text);
    void guarded(const std::function<void()>& action);
    void mark_saved();
    void note_what_is_saved();
    bool is_as_saved() const;
    void write(const std::filesystem::path& to, bool over);
    void write_files(const std::filesystem::path& to);
    void keep_step();
    bool is_replaced() const;
    Probe look_at(int x, int y, double radius_px);
    void adopt(Canvas canvas);
    void show(std::optional<Canvas> canvas);
    void count(std::span<const Region> changed);

    // The painter's thread only, once it runs.
    Session session_;
    std::shared_ptr<const Surface> dry_;
    const std::string dry_hash_;
    std::string saved_hash_;            // of what is in the file: hash_of(Canvas)
    std::optional<Surface> painted_;    // what the painting looks like; the dry surface where it has no paint
    std::optional<PartPixels> errors_;  // that the file has
    std::optional<Surface> board_;      // what the palette looks like
    std::shared_ptr<TexelTiles> tiles_;
    TexelRange range_;
    double mm_per_pixel_;
    RecoveryRecord record_;
    PaintingClaim claim_;
    std::optional<FileStamp> stamp_;  // of the painting's file, as it was read or written last
    EventOrder order_;                // of what was sent
    bool file_is_new_, told_of_journal_ = false;
    PainterState own_;
    std::optional<Canvas> shown_;  // instead of the session's
    AppearanceOptions look_;       // by which it is shown
    // All tiles of a canvas by where they are, without keeping them in memory.
    struct SavedTile {
        const PaintTile* tile = nullptr;  // null: no paint
        std::weak_ptr<const PaintTile> alive;
    };
    struct SavedTiles {
        std::vector<std::string> layers;  // dried
        std::map<TileIndex, std::vector<SavedTile>> stacks;
    };
    static SavedTiles tiles_of(const Canvas& canvas);
    static bool are_tiles_of(const SavedTiles& saved, const Canvas& canvas);
    SavedTiles saved_;                       // as in the file
    std::optional<SavedTiles> saved_board_;  // likewise
    Keep keep_;
    Stops stops_;
    // Of the journal of this sitting: whether it says which paints it is painted with; the mask that it stops
    // at, as far as it says; all that it names, with what their files hold; and those of which there is no
    // file yet.
    bool paints_recorded_ = false;
    std::string recorded_mask_;
    std::map<std::string, std::string> masks_;
    std::set<std::string> unwritten_masks_;
    std::shared_ptr<const Image<float>> allowed_;
    struct Counted {
        int painted = 0, outside = 0;
    };
    std::map<TileIndex, Counted> counted_;

    mutable std::mutex mutex_;
    std::filesystem::path file_;  // as record_ has it, for other threads
    std::condition_variable something_, idle_;
    std::deque<std::function<void()>> jobs_;
    PainterNews news_;
    bool stop_ = false, busy_ = false;

    std::function<void()> wake_;
    std::atomic<bool> horizon_stop_ = false, hurry_ = false;
    std::atomic<int> saves_waiting_ = 0;
    int skipped_strokes_ = 0;
    std::uint64_t weighed_seed_ = 0;  // of the brush that holds full_mm3_
    double full_mm3_ = 0;
    std::chrono::steady_clock::time_point weighed_{};
    std::thread thread_, horizon_thread_;
};

}  // namespace tangi
