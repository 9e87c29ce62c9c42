// window_app.h: the window from inside: what there is of it, and what a frame does.
//
// In seven parts: window_opening.cpp shows a painting, window_frame.cpp goes from frame to frame, window.cpp
// draws and animates, window_requests.cpp does what hand and panels ask for, window_dialogs.cpp asks for
// files, window_paintings.cpp does what is about other paintings, window_annotations.cpp what is about
// annotations.
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "viewer/annotations/annotation_document.h"
#include "viewer/app/comparison_textures.h"
#include "viewer/app/damage_map_texture.h"
#include "viewer/app/desktop.h"
#include "viewer/app/devices.h"
#include "viewer/app/document_controller.h"
#include "viewer/app/first_opening.h"
#include "viewer/app/input_controller.h"
#include "viewer/app/live_view.h"
#include "viewer/app/panel_input.h"
#include "viewer/app/window.h"
#include "viewer/dialogs/file_dialog.h"
#include "viewer/model/substrate_preview.h"
#include "viewer/model/user_settings.h"
#include "viewer/treatment/treatment_controller.h"
#include "viewer/video/video_recorder.h"

namespace tangi {

class WindowApp {
public:
    WindowApp(WindowSetup setup, const Progress& progress);
    WindowResult run();

private:
    static constexpr int kFramesAfterwards = 3;  // panels need some to settle
    static constexpr double kProgress_s = 0.2;   // between two pictures of how far something is

    // What a dialog asks for (dialogs/file_dialog.h).
    struct FileQuestion {
        const char* title;
        panels::FileDialog::Wants wants;
        std::filesystem::path start;
        const char* ending = ".exr";
    };

    bool open_first();
    void draw_opening(const std::shared_ptr<const TexelTiles>& overview, double mm_per_pixel);
    bool frame();
    Extent canvas_area();
    void advance(std::deque<InputEvent> events, double seconds);
    void look_at_jobs();
    void show_opened();
    bool draw_what_changed(bool woken);
    std::string seen_now(const Placement& place) const;
    void news();
    void upload_changed();
    void upload_damage_map();
    void take_answers(PainterNews& news);
    void requests();
    void do_requests(const WindowState::Requests& ask);
    void view_requests(const ViewRequests& ask);
    void paint_requests(const PaintRequests& ask);
    void recovery_requests(const ClosingRequests& ask);
    void closing_requests(const WindowState::Requests& ask);
    void stay_open();
    void save(const SavingRequests& ask);
    void open_annotations();
    std::string annotation_source();
    void know_annotations();
    void choose_annotation(const std::string& id);
    void write_annotation();
    void take_annotation(const AnnotationAct& act);
    void take_annotations();
    void step_annotation(int by);
    void change_annotations(const AnnotationRequests& ask);
    void annotation_file_requests(const AnnotationRequests& ask);
    void annotation_requests(const AnnotationRequests& ask);
    bool save_annotations();
    void move_annotations();
    void keep_annotations(bool at_once);
    void loupe(const Scene& scene);
    void warm_up();
    void warm_up_table();
    void show(OpenedPainting opened, bool is_first);
    void put_away();
    void know_painting(const std::filesystem::path& file);
    void forget_painting();
    void tally();
    void find_left_over(const std::filesystem::path& file);
    void open_when_allowed(const std::filesystem::path& file);
    void take_dropped();
    void take_palette(const std::filesystem::path& file);
    void dialogs(const WindowState::Requests& ask);
    void treatment_dialogs();
    void photo_dialogs(const PhotoRequests& ask);
    void annotation_dialogs(const AnnotationRequests& ask);
    void choose(const FileQuestion& question, std::filesystem::path WindowState::Requests::*where);
    void choose_for_treatment(const FileQuestion& question,
                              std::filesystem::path TreatmentState::Ask::*where);
    void choose_export(const ExportFormat& format);
    void animate(double seconds);
    void draw(bool moved);
    void draw_panels(const Placement& place);
    bool fonts_complete();
    bool ready_to_type() const;
    void resize(Extent screen);
    void take_input(std::deque<InputEvent> events);
    void snapshot();
    void use_monitor(WindowSetup& setup);
    Scene scene_on_screen() const;
    void begin_film(const std::filesystem::path& out);
    void film();
    void take_board(std::vector<BoardPatch> patches);
    void board_requests(const PaintRequests& ask);
    void choose_canvas(const std::filesystem::path& ground);
    void preview_canvas();
    void begin_canvas();
    std::string against_canvas(const std::filesystem::path& file) const;
    void canvas_requests(const OpeningRequests& ask);
    void keep_keys();
    void say(const std::string& text);
    bool closing();
    bool painted_all();
    bool painted_is_saved();
    void finish_and_open();
    Placement placement() const { return placement_of(state_, screen_); }

    std::function<bool()> stop_wanted_;
    std::filesystem::path file_, photos_;  // to begin with
    std::filesystem::path settings_;       // folder; empty: nothing is remembered
    std::unique_ptr<FirstOpening> first_;
    Glfw glfw_;
    DesktopWindow window_;
    Input input_;
    PanelContext panels_;
    PanelInput panel_input_;
    Renderer renderer_;
    WindowState state_;
    std::unique_ptr<Painter> painter_;
    std::optional<InputController> hand_;
    std::optional<DocumentController> documents_;
    std::optional<TreatmentController> treatment_state_;
    std::optional<panels::FileDialog> dialog_;
    LivePicture picture_;
    HeldPictures held_;
    std::optional<Monitor> monitor_;
    std::optional<Devices> devices_;
    std::unique_ptr<Recorder> recorder_;
    std::string film_name_;
    Shot film_shot_;
    std::vector<Scene> film_scenes_;  // of its pictures
    gl::Texture board_;
    MapTexture map_, preview_texture_;
    std::unique_ptr<SubstratePreview> preview_;  // of a new canvas
    gl::Target loupe_;
    std::optional<Journal> left_over_;
    AnnotationDocument annotations_;
    std::filesystem::path annotated_;                    // the painting that they are of
    std::shared_future<std::string> annotation_source_;  // an IRI of it
    std::string not_kept_;                               // why they are not on the disk
    double annotations_kept_s_ = 0;
    std::deque<InputEvent> held_back_;  // came after a key that may close a dialog: for the panels, then
    std::deque<Region> changed_;        // of the painting, not uploaded yet
    Extent screen_{1, 1}, window_size_{1, 1};
    Illuminant shown_in_ = Illuminant::d65;
    Extent pane_{1, 1};  // what of the screen the view was fitted to
    double left_ = 0, now_s_ = 0, horizon_due_s_ = 0, moved_s_ = -1, progress_s_ = 0;
    std::string seen_;                // the scene and placement of the last picture
    int settle_ = kFramesAfterwards;  // frames to be drawn
    bool progress_due_ = false;
    int held_frames_ = 0;   // as many frames more may what is held back wait
    int cold_shaders_ = 0;  // that are compiled when there is time
    SettingsFile keys_file_;
    bool dirty_ = true, close_when_saved_ = false, close_unsaved_ = false, open_when_saved_ = false,
         fitted_ = false, ready_to_paint_ = false;
    WindowResult result_;
};

}  // namespace tangi
