// window_state.h: everything that the window's panels show and change. No OpenGL, no GLFW.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "paint/brush/brush_settings.h"
#include "paint/optics/palette.h"
#include "paint/session/journal.h"
#include "paint/substrate/substrate_choice.h"
#include "viewer/annotations/annotation_state.h"
#include "viewer/devices/pen.h"
#include "viewer/model/background_job.h"
#include "viewer/model/comparison.h"
#include "viewer/model/export_format.h"
#include "viewer/model/painter.h"
#include "viewer/model/shortcuts.h"
#include "viewer/model/treatment_state.h"
#include "viewer/render/scene.h"
#include "viewer/render/tilt.h"
#include "viewer/render/view.h"

namespace tangi {

enum class Tool { tilt, light, pan, paint, pick, ruler, region, annotate, damage, sample };

struct ToolName {
    Tool tool;
    const char* name;
    Action action;
};
inline constexpr std::array<ToolName, 10> kTools = {{{Tool::tilt, "Tilt", Action::tool_tilt},
                                                     {Tool::light, "Light", Action::tool_light},
                                                     {Tool::pan, "Pan", Action::tool_pan},
                                                     {Tool::paint, "Paint", Action::tool_paint},
                                                     {Tool::pick, "Pick", Action::tool_pick},
                                                     {Tool::ruler, "Ruler", Action::tool_ruler},
                                                     {Tool::region, "Region", Action::tool_region},
                                                     {Tool::annotate, "Annotate", Action::tool_annotate},
                                                     {Tool::damage, "Damage", Action::tool_damage},
                                                     {Tool::sample, "Match", Action::tool_sample}}};

// What the light is made of, for paint: in what order the key goes through them.
struct LightName {
    Illuminant illuminant;
    const char* name;
};
inline constexpr std::array<LightName, kIlluminants> kLights = {
    {{Illuminant::d65, "daylight (D65)"},
     {Illuminant::d50, "warm daylight (D50)"},
     {Illuminant::a, "incandescent (A)"},
     {Illuminant::f11, "fluorescent (F11)"},
     {Illuminant::warm_led, "warm LED (3000 K)"}}};
const char* light_named(Illuminant illuminant);
Illuminant light_after(Illuminant illuminant);

inline constexpr std::size_t kMostViewLights = 4;  // of a scene's 8: the panel has room for so many

struct ViewLight {
    Angles angles{135, 50};
    float gain = 1;
    bool on = true;
    bool near = false;      // at a distance, instead of far away
    float distance = 1.5f;  // in widths of the painting
};

// How a photograph and the relit painting are shown.
enum class CompareWay { aside, wipe, blink, difference, delta_e };

struct CompareWayName {
    CompareWay way;
    const char* name;
};
inline constexpr std::array<CompareWayName, 5> kCompareWays = {{{CompareWay::aside, "Side by side"},
                                                                {CompareWay::wipe, "Wipe"},
                                                                {CompareWay::blink, "Blink"},
                                                                {CompareWay::difference, "Difference"},
                                                                {CompareWay::delta_e, "Colour difference"}}};

// Two pictures of the painting beside each other, instead of a photograph and the painting.
struct HeldPair {
    std::string left, right;                    // what they are
    std::shared_ptr<const HeldPhoto> pictures;  // as `photo` and `relit`
};

inline constexpr std::size_t kPairWays = 3;  // side by side, wipe and blink: those of two pictures

// Photographs that are held against the painting.
struct Comparing {
    bool loaded = false;  // a folder of photographs is there
    bool on = false;      // and shown
    std::string folder;
    Comparison::News news;
    CompareWay way = CompareWay::wipe;
    float divider = 0.5f;      // [1] of the screen's width: the photograph is left of it
    bool blink_photo = false;  // what is shown at this moment
    float blink_s = 0.6f;
    int scrolled_to = -1;  // the photograph that the list was scrolled to

    std::optional<HeldPair> pair;  // held up instead of photographs

    const std::shared_ptr<const HeldPhoto>& held() const { return pair ? pair->pictures : news.held; }
    // A photograph is on the screen, instead of the painting under its lights.
    bool shows() const { return on && held(); }
    bool aside() const { return shows() && way == CompareWay::aside; }
};

// The palette that paints are mixed on, as it lies on the screen.
// What a brush brings along to the palette that paints are mixed on: nothing, what was chosen since the last
// stroke there, or what it took up there, which it paints with on the painting as well.
enum class Carried { nothing, chosen, taken_up };

struct BoardState {
    bool open = false;
    Extent size{};                // [pixels of the palette]
    unsigned texture = 0;         // OpenGL's name of its picture
    std::array<float, 4> rect{};  // [pixels of the window] x0, y0, x1, y1; all 0 where it is not seen
    Carried carried = Carried::nothing;

    bool has(const glm::dvec2& at) const {
        return at.x >= rect[0] && at.y >= rect[1] && at.x < rect[2] && at.y < rect[3];
    }
};

// A new canvas that is being chosen.
struct NewCanvas {
    bool open = false;  // the panel is
    SubstrateChoice choice{.which = "canvas"};
    std::string picture;            // or painting that was chosen as one; empty: none
    std::vector<std::string> kept;  // names of those that were kept
    std::string name;               // of the file
    std::filesystem::path folder;   // that it is written to
    Extent size{};                  // [pixels] of a picture or a painting, by the preview
    unsigned texture = 0;           // OpenGL's name of the preview; 0: there is none
    Extent preview{};               // [pixels]
    std::string complaint;          // why it cannot be made

    // [pixels] It will have; 0 where that is not known yet.
    glm::dvec2 pixels() const;
    double bytes() const;  // to paint on it
};

// What devices move the painting and the light, beside mouse and keys.
struct Following {
    bool head = false, light = false;  // by the webcam
    bool sensor = false;
    bool recentre = false;   // asked for: whoever looks now looks straight on
    bool sees_head = false;  // a face is in the webcam's picture
    std::string gamepad;     // its name; empty: there is none
};

// The painting, as opened.
struct OpenedState {
    std::string title;
    Extent painting;
    double mm_per_pixel = 1;         // in the unit of its heights, which are pixels where it has no scale
    double stroke_mm_per_pixel = 1;  // of strokes and brushes, and all that is told: a scale can be given
    bool scale_known = false;        // the painting's own, or given
    double height_unit_mm() const { return stroke_mm_per_pixel / mm_per_pixel; }
    ReflectanceModel reflectance_model{};
    float lowest_mm = 0, highest_mm = 1;
    bool from_photographs = false;    // and so can be compared with them
    std::vector<std::string> doubts;  // that the fit had, as the painting's file has them
};

// How it is seen.
struct ViewState {
    View view;
    Tilt tilt;
    bool flat = false;
    Vec3 viewer{0, 0, 1};  // direction from the middle of the screen, for gloss
    Following follow;
    ViewMode mode = ViewMode::painting;
    float strength = 0.7f, sharpness = 40;
    float most_curvature = 1;  // [1/mm] in the unit of its heights
    bool loupe = false, probing = true;
    float canvas_left = 0;  // [pixels of the window] where the painting's part of it begins
};

// How it is lit.
struct LightingState {
    Illuminant illuminant = Illuminant::d65;  // the colour of all lights
    std::vector<ViewLight> lights{ViewLight{}};
    std::size_t light = 0;  // that is moved
    bool sweeping = false;
    float ambient = 0.03f, exposure_stops = 0, shoulder = 0.15f, light_radius_deg = 1.5f;
    bool shadows = true;
    WardModel model = WardModel::bounded;
};

// What it is painted with.
struct BrushState {
    Palette palette;
    std::map<std::string, BrushSettings> brushes;
    std::string brush_name = "flat";
    BrushSettings brush;
    float pressure = 0.6f, stabiliser_mm = 0;
    std::optional<PenSample> pen;  // that moves the pointer
    bool dirty_brush = false;
    std::map<std::string, float> mix;  // parts of paints on the brush
    PaintFinish finish;                // of the mixture
    BoardState board;
    std::vector<Rgb> paint_colours;  // [sRGB] of the palette's paints, opaque
};

// What was measured of it.
struct MeasurementState {
    std::optional<Probe> probe;
    std::optional<std::pair<glm::dvec2, glm::dvec2>> ruler;  // [pixels of the painting]
    std::optional<HeightProfile> profile;                    // along it
    std::optional<Region> region;                            // that was chosen
    std::optional<RegionStatistics> statistics;              // of it
};

// What the user is told.
struct MessageState {
    std::string message;
    double message_until_s = 0;
    bool whole_message = false;    // however long it is: else it is cut to two lines
    std::deque<std::string> said;  // by the window, the newest last
};

// Strokes that were not saved: what becomes of them is asked before anything else.
struct UnsavedState {
    int left_over_strokes = 0;          // that a crash left: recover or discard
    bool left_over_of_another = false;  // they were made on another painting than lies here now
    bool closing = false;               // with unsaved strokes: asked what to do
    struct Finishing {
        std::size_t all = 0, left = 0;  // events
    };
    std::optional<Finishing> finishing;  // to be closed once these are painted
    std::filesystem::path dropped;       // a folder: compare or fit?
    std::filesystem::path open_next;     // once it is decided what becomes of strokes that are not saved
};

// The panels themselves.
struct PanelState {
    bool paint_comes_first = false, annotations_come_first = false;
    int window_width = 10'000;  // [pixels]
    double frame_ms = 0;
    bool help = false;
    float scale = 1;  // [1] of the panels: 2 on a screen of twice the usual density
    Keys keys;
    std::optional<Action> rebinding;  // the next key is this action's
    std::vector<std::string> pens;
    std::string monitor;  // what its colours are
};

// What runs beside the window.
struct JobsState {
    std::optional<Job::State> job;  // that runs
    std::string job_title;
    std::optional<Job::State> film;  // of a sweep, that is written
};

// Requests of the panels and the hand, by who does them.
struct ViewRequests {
    bool fit = false, one_to_one = false, straighten = false, snapshot = false;
    bool film_dialog = false, stop_film = false;
    std::filesystem::path film;

    friend bool operator==(const ViewRequests&, const ViewRequests&) = default;
};

struct PaintRequests {
    bool undo = false, redo = false, dry = false, wash = false;
    bool lay_out = false, wipe_board = false, squeeze = false;
    std::string lift;  // name of a layer
    bool palette_dialog = false;
    std::filesystem::path palette;

    friend bool operator==(const PaintRequests&, const PaintRequests&) = default;
};

struct SavingRequests {
    bool save = false, save_dialog = false;
    std::filesystem::path save_as;
    const ExportFormat* export_dialog = nullptr;  // one of `exports`
    const ExportFormat* format = nullptr;         // and where to: `export_to`
    std::filesystem::path export_to;

    friend bool operator==(const SavingRequests&, const SavingRequests&) = default;
};

struct ClosingRequests {
    bool recover = false, discard = false;
    bool close = false, close_unsaved = false, close_now = false, stay = false;

    friend bool operator==(const ClosingRequests&, const ClosingRequests&) = default;
};

struct PhotoRequests {
    bool photos_dialog = false, put_photos_away = false, fit_dialog = false;
    std::filesystem::path photos, fit_folder;
    int step_photo = 0;
    std::optional<int> photo;
    bool report_dialog = false, stop_report = false;
    std::filesystem::path report;

    friend bool operator==(const PhotoRequests&, const PhotoRequests&) = default;
};

struct OpeningRequests {
    bool open_dialog = false, stop_job = false;
    std::filesystem::path open;
    bool new_canvas = false, begin_canvas = false, substrate_dialog = false, height_dialog = false;
    std::filesystem::path substrate, height_from;

    friend bool operator==(const OpeningRequests&, const OpeningRequests&) = default;
};

// Its parts are bases, so that a function can take the one that it is about.
struct WindowState : OpenedState,
                     ViewState,
                     LightingState,
                     BrushState,
                     MeasurementState,
                     MessageState,
                     UnsavedState,
                     PanelState,
                     JobsState {
    WindowState();

    Tool tool = Tool::tilt;
    NewCanvas new_canvas;
    PainterState painter;  // what the painter told
    Comparing comparing;
    std::vector<std::filesystem::path> recent;
    std::vector<ExportFormat> exports;  // that are offered (HostServices); stays as it is
    std::string lights_endings;         // of lights files (HostServices)
    TreatmentState treatment_state;
    AnnotationState annotations;

    // Strokes, corrections of the damage map or annotations would be lost, or have to be recovered.
    bool unsaved() const { return painter.unsaved || treatment_state.edits > 0 || annotations.unsaved; }

    // What the panels ask for; the window does it and clears them.
    struct Requests : ViewRequests,
                      PaintRequests,
                      SavingRequests,
                      ClosingRequests,
                      PhotoRequests,
                      OpeningRequests,
                      AnnotationRequests {
        bool keys_changed = false, usual_keys = false;

        friend bool operator==(const Requests&, const Requests&) = default;
    } ask;

    void use_brush(const std::string& name);
    // All that has a colour, as it looks in this light.
    void see_in(Illuminant lit_by);
    // That of the lights; photographs are held against the painting in daylight.
    Illuminant illuminant_now() const { return comparing.on ? Illuminant::d65 : illuminant; }
    // Another paint box: of the mixture, the paints stay that it has too; its first where there are none.
    void use_palette(Palette other);
    // The mixture on the brush as linear Rec. 709, laid on thickly.
    Rgb mixed_colour() const;
    // What is on the brush now, or will be when a stroke begins.
    OnBrush on_brush() const;
    // rho_s and alpha of the mixture: those that were chosen, else of its paints, by their parts.
    glm::dvec2 mixed_gloss() const;
    StrokeEvent stroke(std::uint64_t seed) const;
    StrokeEvent board_stroke(
        std::uint64_t seed);  // on the palette; washes the brush where that was asked for
    StrokeEvent erasing_stroke(
        std::uint64_t seed) const;  // of the brush `eraser`, as large as the one in use
    bool take_up(const Probe& picked);
};

// How a painting is called: its file's name, with the folder's where that is a treatment.
std::string title_of(const std::filesystem::path& painting);

// What of the screen the painting is placed in: the half, where it stands beside a photograph.
Extent pane(const WindowState& state, Extent screen);
// Where the painting lies there. Photographs were taken from straight ahead: it is not tilted beside one.
Placement placement_of(const WindowState& state, Extent screen);

// The lights and settings as the renderer takes them.
Scene scene_of(const WindowState& state, const Placement& placement);

}  // namespace tangi
