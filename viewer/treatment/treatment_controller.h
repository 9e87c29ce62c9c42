// treatment_controller.h: the treatment of the painting that the window shows: it is read and checked, masks
// of damage are drawn, steps are laid and logged. What takes long runs beside the window. No OpenGL.
//
// Files of a treatment are only written by record() of treatment.h; `sitting.json` beside them remembers
// which damage is painted on, so that strokes that a crash left stop at the same mask.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "paint/optics/palette.h"
#include "retouch/mask/mask_editor.h"
#include "retouch/treatment/treatment_steps.h"
#include "viewer/model/background_job.h"
#include "viewer/model/damage_map.h"
#include "viewer/model/painter.h"
#include "viewer/model/user_settings.h"
#include "viewer/model/window_state.h"

namespace tangi {

// The folder of the treatment that a painting file belongs to; nothing where it belongs to none.
std::optional<std::filesystem::path> treatment_of(const std::filesystem::path& painting);

// [mm/px] That its treatment was given, where the painting does not know its own.
std::optional<double> treatment_scale(const std::filesystem::path& painting);

// What commands say, for the window: "--search-mm" is "search mm", as the panel calls it.
std::string in_panel_words(const std::string& text);

class TreatmentController {
public:
    struct Setup {
        Author author;
        Palette palette;
        std::function<void()> wake;
        std::function<void(const std::string&)> say;
        std::filesystem::path settings{};  // folder that holds the user's pigment_pairs.json; empty: none
    };
    TreatmentController(WindowState& state, Setup setup);
    ~TreatmentController();

    // Recipes are of these paints from now on.
    void use_palette(Palette palette) { setup_.palette = std::move(palette); }
    // From now on, this painting; after leave().
    void shows(Painter& painter);
    // Before the painter goes: what runs is stopped.
    void leave();

    // Does what was asked for, and what the hand did to the mask.
    void take();
    // Enters the corrections of the map in the log, at once: the window closes. Says why where it cannot;
    // then they are still there.
    void keep_now();
    // Looks what has become of it; changes the state. True where there may be something to be seen of it.
    bool look();

    // The map, null where there is none; and the part of its picture that changed since the last call.
    const DamageMap* map() const { return state_.treatment_state.on ? &map_ : nullptr; }
    Region map_changed() { return std::exchange(map_changed_, Region{}); }

private:
    // One treatment, used by jobs and the painter's thread, one at a time.
    struct Held {
        std::mutex mutex;
        Treatment treatment;
    };
    // What is to be known of it when something was logged.
    struct Facts {
        std::array<DamageRow, kDamageClasses.size()> damage;
        std::vector<std::pair<DamageClass, Mask>> masks;
        std::vector<LayerRow> layers;
        std::vector<LogRow> log;
        NextUndo next_undo;
        Image<std::uint8_t> additions;
    };
    struct Suggested {
        std::string action;
        nlohmann::json options, results;
        std::vector<std::pair<std::string, DamageSuggestion>> further;  // masks without a class
        DamageSuggestion best;
        MaskRegions regions;
        std::vector<double> confidence;  // of each region: the mean over it
        double mm_per_pixel = 1;
    };
    // What a suggestion is looked for in, and how, as it was when it was asked for.
    struct Search {
        Suggesting what = Suggesting::loss;
        std::string made_with;
        std::shared_ptr<const Surface> dry;
        double mm_per_pixel = 1;
        bool scale_known = false;
        LossOptions loss;
        CraquelureOptions craquelure;
        GlossOptions gloss;
        AreaOptions areas;
    };
    struct Found {
        Suggested suggested;
        ShownSuggestion shown;
    };
    struct Preview {
        Canvas canvas;  // with the retouch on top
        StepArea area;
        nlohmann::json parameters, results;
        std::string layer;
    };
    // How a retouch is laid to be looked at, as it was when it was asked for.
    struct Laying {
        RetouchMode mode = RetouchMode::mimetic;
        RetouchOptions options;
        std::set<DamageClass> where;
        Palette palette;
        std::shared_ptr<const std::vector<PigmentPair>> list;  // that `pairs` are of
        std::vector<PairWarning> pairs;
        std::string made_with;
    };
    // What a save by the painter's thread goes by.
    struct Keeping {
        std::mutex mutex;
        StepArea area;
        double feather_mm = 0;
        Author author;
        std::atomic<bool> done = false;
    };
    using Finish = std::function<void()>;
    using Work = std::function<Finish(const Progress&)>;

    // `ours`: what nobody asked for, and what is asked for meanwhile waits for.
    bool start(std::string title, Work work, bool ours = false);
    Author author() const {
        const std::string& who = state_.treatment_state.who;
        return {who.empty() ? setup_.author.who : who, setup_.author.tool};
    }
    Treatment treatment() const;  // a copy, of this moment
    static Facts facts_of(const Treatment& treatment, const Canvas& canvas);
    static Canvas canvas_of(Painter& painter);
    void adopt(Facts facts);
    void finish_job();
    void keep_up();
    void look_for_folder();
    void compose_map();
    void open(const std::filesystem::path& folder);
    void refresh();
    void confine();
    static Painter::Kept kept(Held& held, Keeping& keeping, Canvas& canvas, const Painter::ToKeep& recovery);
    std::string no_strokes() const;

    // Masks.
    MaskDraft& draft();
    void touch(const MaskTouch& touch);
    void changed(const Region& region);
    void count_edits();
    void count_corrected();
    bool all_is_logged();
    void polygon(const Polygon& corners, MaskEdit edit);
    void wand_at(const MaskTouch& touch);
    void keep_edits();
    void drop_edits();
    void suggest();
    Search search_of(Suggesting what) const;
    static Found found_by(const Search& search, const Progress& progress);
    static void find_losses(const Search& search, Found& found, const Progress& progress);
    static void find_craquelure(const Search& search, Found& found, const Progress& progress);
    static void find_gloss(const Search& search, Found& found, const Progress& progress);
    static void find_areas(const Search& search, Found& found, const Progress& progress);
    Mask sure_enough() const;
    void show_suggestion();
    void accept();

    // Steps.
    using Step = std::function<std::string(Treatment&, Canvas&, const Progress&)>;
    void step(std::string title, Step work);
    void steps(const TreatmentState::Ask& ask);
    void begin();
    void fill();
    void varnish(bool isolating);
    void preview();
    static Preview laid(const Laying& laying, const Treatment& now, Canvas canvas, ShownRetouch& shown,
                        const Progress& progress);
    void apply();
    void remove(const std::vector<std::string>& layers);
    void undo_last();
    void report(const std::filesystem::path& html);
    void check();
    void show_state();
    void hold(const HeldPair& pair);
    void compare_states();
    void see_from();
    void match(const std::optional<glm::dvec2>& at);
    // What results are made with.
    std::vector<Illuminant> illuminants_that_count() const;
    RetouchOptions retouch_options() const;
    nlohmann::json made_on() const;
    std::string preview_made_with() const;
    std::string match_made_with() const;
    std::string suggestion_made_with(Suggesting what) const;
    void find_stale();
    void read_pairs();
    void change_pairs(const ColourMatchRequests& ask);

    WindowState& state_;
    Setup setup_;
    Painter* painter_ = nullptr;
    std::shared_ptr<Held> held_;
    std::unique_ptr<Job> job_;
    Finish finish_;  // by the job, while it runs; ours once it is over
    // That mixtures keep apart; jobs go on with those that they began with.
    std::shared_ptr<const std::vector<PigmentPair>> pairs_;
    SettingsFile pairs_file_;
    std::map<DamageClass, MaskDraft> drafts_;
    std::optional<Corner> last_;  // of the brush that is drawn
    std::optional<Suggested> suggested_;
    std::shared_ptr<const Preview> preview_;
    DamageMap map_;
    DamageMap::Style style_;
    Region map_changed_;
    float threshold_ = 0;
    std::optional<TreatmentStage> state_shown_;
    std::shared_ptr<Keeping> keeping_ = std::make_shared<Keeping>();
    std::filesystem::path painting_;  // that the painter had when the treatment was opened
    bool gone_ = false;               // the folder, as was found last
    std::chrono::steady_clock::time_point looked_{};
    std::string confined_by_;  // what the painter was confined by last
    bool refresh_due_ = false, confine_due_ = false, job_is_ours_ = false;
};

}  // namespace tangi
