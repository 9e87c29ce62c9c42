// treatment_state.h: the treatment of the painting in the window, as its panels show and change it. No
// OpenGL.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "retouch/colour_match/pigment_pairs.h"
#include "retouch/damage/area_suggestion.h"
#include "retouch/fill/fill.h"
#include "retouch/inpaint/retouch_modes.h"
#include "retouch/mask/mask_editor.h"
#include "retouch/treatment/treatment_steps.h"
#include "viewer/model/background_job.h"
#include "viewer/render/view.h"

namespace tangi {

enum class MaskTool { brush, polygon, wand, area };
enum class MapStyle { filled, hatched, outlined };
enum class Suggesting { loss, craquelure, gloss, old_fill, overpaint, stain, abrasion, flaking };

// What the hand does to the mask that is drawn; `at` as in mask.h.
struct MaskTouch {
    enum class Kind { press, drag, release, polygon, wand, area };
    Kind kind = Kind::press;
    Corner at;
    bool erase = false;
    Polygon polygon{};
};

struct DamageCount {
    int count = 0;
    double area_cm2 = 0, percent = 0;
};

struct DamageRow {
    DamageClass damage = DamageClass::loss_to_ground;
    bool there = false, shown = true;  // in the log
    DamageCount logged{};
    std::optional<DamageCount> corrected{};  // with corrections that are not in the log, where there are any
};

struct LayerRow {
    std::string name;
    LayerRole role = LayerRole::fill;
    OnOriginal on_original;  // outside of the damage that is mapped; of a varnish it means nothing
};

struct LogRow {
    int line = 0;
    std::string time, who, action, sha256;
};

// A suggestion that nobody has accepted yet: regions that are sure enough are shown.
struct ShownSuggestion {
    std::string title;
    DamageClass as = DamageClass::loss_to_ground;  // where it goes
    float threshold = 0.5f;                        // [1] of confidence
    int shown = 0, regions = 0;
    double area_cm2 = 0;
    std::string measured;  // more that is to be said
    Suggesting what = Suggesting::loss;
    std::string made_with{};  // settings
    bool stale = false;       // they have been changed since
};

struct ShownRecipe {
    std::string text;
    std::map<std::string, float> mix;  // parts by volume
    std::array<double, kIlluminants> delta_e{};
    Rgb look_srgb{0};
    std::string gloss;
    std::vector<std::string> warnings;
};

struct ShownMatch {
    std::string of;  // "round the damage", "at 120, 45"
    Lab lab;
    Rgb srgb{0};
    double spread = 0;  // [CIEDE2000] of the colours there
    std::vector<ShownRecipe> recipes;
    std::string made_with{};  // settings
    bool stale = false;       // they have been changed since
};

// A retouch that was laid to be looked at, and is not on the painting yet.
struct ShownRetouch {
    std::string mode;
    std::vector<std::string> piles;
    std::array<double, kIlluminants> delta_e{};
    std::string lines;  // where lines or dots fuse
    int outside_px = 0;
    std::string made_with{};  // settings
    bool stale = false;       // they have been changed since
};

// Which treatment it is, and whether one may work on it.
struct TreatmentStatus {
    bool on = false;      // the painting is one under treatment
    bool usable = false;  // and was found to be as its log says
    bool checking = false;
    std::string folder, who, dry_sha256;
    std::string usual_who;            // where `who` is empty
    std::vector<std::string> faults;  // that the check found
    std::string no_strokes;           // why one may not paint now; empty where one may
    std::vector<LogRow> log;          // newest first
    double mm_per_pixel = 1;
    bool scale_known = false;
    float width_mm = 0;        // of a painting whose scale is unknown, as a treatment begins; 0: not given
    bool scale_asked = false;  // for it, once: a treatment keeps the scale that it began with
};

// Damage that is drawn.
struct DamageDrawing {
    std::array<DamageRow, kDamageClasses.size()> damage;
    DamageClass current = DamageClass::loss_to_ground;  // that is drawn
    MaskTool mask_tool = MaskTool::brush;
    bool erase = false;
    float brush_mm = 3;
    WandBy wand_by = WandBy::colour;
    std::array<float, 3> tolerance = {8, 0.05f, 0.5f};  // by WandBy
    int edits = 0;                                      // that are not in the log
    bool can_redo = false;
    std::vector<glm::dvec2> polygon;  // under way [pixels of the painting]
    std::vector<MaskTouch> touches;   // since they were taken
};

// How its map is shown.
struct DamageMapState {
    bool map = true;  // is shown
    MapStyle style = MapStyle::filled;
    float opacity = 0.5f;
    unsigned map_texture = 0;  // OpenGL's name of its picture
};

// Damage that is suggested.
struct SuggestionState {
    Suggesting suggesting = Suggesting::loss;
    LossOptions loss;
    CraquelureOptions craquelure;
    GlossOptions gloss;
    AreaOptions areas;
    std::optional<ShownSuggestion> suggestion;
};

// Steps: fills, varnishes and retouches, and the layers that they are.
struct StepState {
    std::set<DamageClass> where = {DamageClass::loss_to_ground};
    bool confined = true;
    float feather_mm = 0;
    FillTexture texture = FillTexture::surroundings;
    Rgb fill_srgb{0.94f, 0.93f, 0.90f};
    FillOptions fill;
    VarnishOptions isolating, varnish;
    RetouchMode mode = RetouchMode::mimetic;
    RetouchOptions retouch;
    std::optional<ShownRetouch> preview;
    std::vector<LayerRow> layers;
    bool layers_moved = false;   // since the panel drew them last
    double layers_moved_s = -1;  // when that was, by the panel's clock
    NextUndo next_undo;
};

// What of the treatment is on the painting that is seen.
struct StageState {
    std::optional<TreatmentStage> state;  // that is shown instead of what is there now
    std::optional<TreatmentStage> left = TreatmentStage::before, right;  // held against each other; or now
    bool additions = false;                                              // in false colour
    float distance_m = 2;
};

// Recipes for a colour.
struct ColourMatchState {
    std::array<bool, kIlluminants> illuminants = {true, false, true, true, false};  // that count
    int most_paints = 4;
    bool film = true;  // as thin as the retouch, over what lies there; else one that hides
    bool avoid_pairs = false;
    std::vector<PigmentPair> pairs;  // that are kept apart
    struct NewPair {
        std::string first, second, why;  // words with commas between them
    } new_pair;
    std::optional<ShownMatch> match;
};

// Requests of the treatment's panels, by what they are about.
struct DamageRequests {
    bool suggest = false, accept = false, drop_suggestion = false, keep = false, drop_edits = false,
         undo = false, redo = false;

    friend bool operator==(const DamageRequests&, const DamageRequests&) = default;
};

struct StepRequests {
    bool fill = false, isolate = false, varnish = false;
    bool preview = false, apply = false, drop_preview = false, undo_step = false, remove_all = false;
    std::string remove;  // a layer

    friend bool operator==(const StepRequests&, const StepRequests&) = default;
};

struct StageRequests {
    bool compare_states = false, see_from = false, stop_comparing = false;

    friend bool operator==(const StageRequests&, const StageRequests&) = default;
};

struct ColourMatchRequests {
    bool match_around = false;
    std::optional<glm::dvec2> match_at;  // [pixels of the painting]
    bool add_pair = false, usual_pairs = false;
    int drop_pair = -1;  // of `pairs`

    friend bool operator==(const ColourMatchRequests&, const ColourMatchRequests&) = default;
};

// Its parts are bases, so that a function can take the one that it is about.
struct TreatmentState : TreatmentStatus,
                        DamageDrawing,
                        DamageMapState,
                        SuggestionState,
                        StepState,
                        StageState,
                        ColourMatchState {
    bool in_front = true;           // in a narrow window: it is seen, and not what else there is of panels
    const char* forward = "";       // the tab that is to be seen: "Colour" when a match was found
    std::optional<Job::State> job;  // that runs
    std::string job_title;

    // What is asked for; done and cleared once a frame.
    struct Ask : DamageRequests, StepRequests, StageRequests, ColourMatchRequests {
        bool begin = false, open_dialog = false, check = false, stop = false;
        bool report_dialog = false, report_wanted = false;
        std::filesystem::path open, report;

        friend bool operator==(const Ask&, const Ask&) = default;
    } ask;
};

// As people read them: "Loss to ground".
const char* title_of(DamageClass damage);
const char* title_of(LayerRole role);
const char* title_of(TreatmentStage state);

}  // namespace tangi
