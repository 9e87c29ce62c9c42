#include "viewer/window.h"

#include <epoxy/gl.h>
// GLFW must not bring another loader's headers.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "surface/error.h"
#include "surface/picture_file.h"
#include "viewer/desktop.h"
#include "viewer/hand.h"
#include "viewer/live_picture.h"
#include "viewer/panels/panels.h"

namespace tangi {

namespace {

constexpr int kFramesAfterwards = 3;  // panels need some to settle
constexpr double kSweep_deg_per_s = 40;
constexpr double kHorizonPause_s = 0.4;  // after the last change, before shadows are made again
constexpr double kFrame_s = 1 / 60.0;
constexpr std::size_t kUploadBytes = std::size_t(8) << 20;  // in one frame

class App {
public:
    App(WindowSetup setup, const Progress& progress);
    WindowResult run();

private:
    bool frame();
    void news();
    void requests();
    void loupe(const Scene& scene);
    void warm_up();
    void find_left_over(const std::filesystem::path& file);
    void animate(double seconds);
    void draw(bool moved);
    void snapshot();
    void say(const std::string& text);
    bool closing();
    Placement placement() const {
        return Placement(state_.view, state_.tilt, state_.flat, state_.painting, screen_,
                         state_.mm_per_pixel);
    }

    std::function<bool()> stop_wanted_;
    Glfw glfw_;
    DesktopWindow window_;
    Input input_;
    PanelContext panels_;
    Renderer renderer_;
    Painter painter_;
    WindowState state_;
    Hand hand_;
    LivePicture picture_;
    gl::Target loupe_;
    std::optional<Journal> left_over_;
    std::deque<TexelPatch> patches_;
    Extent screen_{1, 1}, window_size_{1, 1};
    double left_ = 0, now_s_ = 0, horizon_due_s_ = 0, moved_s_ = -1;
    std::string seen_;  // the scene and placement of the last picture
    int settle_ = kFramesAfterwards;
    bool dirty_ = true, close_when_saved_ = false, close_unsaved_ = false, fitted_ = false;
    std::size_t first_bytes_ = 0;
    WindowResult result_;
};

App::App(WindowSetup setup, const Progress& progress)
    : stop_wanted_(std::move(setup.stop_wanted)),
      window_(fmt::format("{} - TangiPaint", setup.file.filename().string()), setup.width, setup.height),
      input_(window_.handle()),
      panels_(window_.handle()),
      painter_(
          {std::move(setup.canvas), setup.palette, setup.file, setup.file_is_new},
          [] { glfwPostEmptyEvent(); }, progress),
      hand_(state_, painter_) {
    const Surface& surface = painter_.surface();
    state_.title = setup.file.filename().string();
    state_.painting = {surface.width(), surface.height()};
    state_.mm_per_pixel = surface.mm_per_pixel;
    state_.stroke_mm_per_pixel = painter_.mm_per_pixel();
    state_.scale_known = surface.scale_known;
    state_.law = surface.law;
    state_.palette = setup.palette;
    if (!setup.brushes.empty()) state_.brushes = setup.brushes;
    const auto [low, high] =
        std::minmax_element(surface.height_mm.pixels().begin(), surface.height_mm.pixels().end());
    state_.lowest_mm = *low;
    state_.highest_mm = *high;
    TexelTiles tiles(surface, painter_.range(), renderer_.tile_bits(surface.width(), surface.height()));
    renderer_.set_painting(tiles, surface.mm_per_pixel);
    first_bytes_ = renderer_.uploaded_bytes();
    find_left_over(setup.file);
    warm_up();
    painter_.start(std::move(tiles));
    painter_.make_horizon();
    const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    result_.drawn_by = name ? name : "";
}

// Drivers compile when something is drawn for the first time, which takes a software renderer half a second:
// now, and not when the hand first moves.
void App::warm_up() {
    HorizonMap nothing{1, 1, {}};
    nothing.values.assign(HorizonMap::kAzimuths, 0);
    renderer_.set_horizon(nothing);  // until the painter has made one
    const gl::Target target(16, 16, false);
    for (const bool smooth : {false, true}) {
        Shot shot = placement().shot(1, smooth);
        shot.width = shot.height = 16;
        renderer_.draw(scene_of(state_, placement()), shot, target.framebuffer());
    }
    glFinish();
}

void App::find_left_over(const std::filesystem::path& file) {
    try {
        left_over_ = left_over(sitting_files(file));
    } catch (const Error& error) {
        say(error.what());  // one can look at the painting all the same
    }
    if (!left_over_) return;
    const auto strokes = std::count_if(
        left_over_->entries.begin(), left_over_->entries.end(),
        [](const Journal::Entry& entry) { return std::holds_alternative<StrokeEvent>(entry.event); });
    state_.left_over_strokes = std::max(1, static_cast<int>(strokes));
}

void App::say(const std::string& text) {
    state_.message = text;
    state_.message_until_s = now_s_ + 8;
    settle_ = kFramesAfterwards;
}

void App::news() {
    PainterNews news = painter_.fetch();
    state_.painter = news.state;
    for (TexelPatch& patch : news.patches) patches_.push_back(std::move(patch));
    std::size_t bytes = 0;
    while (!patches_.empty() && bytes < kUploadBytes) {
        bytes += patches_.front().texels.size() * sizeof(Texel);
        renderer_.upload(patches_.front());
        patches_.pop_front();
    }
    if (bytes > 0) {
        dirty_ = true;
        horizon_due_s_ = now_s_ + kHorizonPause_s;
    }
    if (news.horizon) {
        renderer_.set_horizon(*news.horizon);
        dirty_ = true;
    }
    if (news.probe) state_.probe = news.probe;
    if (news.picked) {
        state_.take_up(*news.picked);
        state_.tool = Tool::paint;
    }
    for (const std::string& message : news.messages) say(message);
    if (horizon_due_s_ > 0 && now_s_ >= horizon_due_s_ && !hand_.holds() && patches_.empty()) {
        horizon_due_s_ = 0;
        painter_.make_horizon();
    }
}

void App::snapshot() {
    const Shot shot = placement().shot(1, true);
    const gl::Target target(shot.width, shot.height, false);
    renderer_.draw(scene_of(state_, placement()), shot, target.framebuffer());
    std::filesystem::path path = painter_.file();
    for (int i = 1;; ++i) {
        path.replace_filename(fmt::format("{}-{}.png", painter_.file().stem().string(), i));
        if (!std::filesystem::exists(path)) break;
    }
    try {
        write_picture_8bit(path, renderer_.read(target));
        say("wrote " + path.filename().string());
    } catch (const Error& error) {
        say(error.what());
    }
}

void App::requests() {
    WindowState::Requests ask = std::exchange(state_.ask, {});
    if (ask.fit) state_.view = fitted(state_.painting, screen_, state_.view.turn_deg);
    if (ask.one_to_one) state_.view.zoom = 1;
    if (ask.straighten) {
        state_.tilt = sent_back(state_.tilt);
        state_.view = turned(state_.view, -state_.view.turn_deg);
    }
    const bool blocked = state_.left_over_strokes > 0;
    if (ask.undo && state_.painter.can_undo && !blocked) painter_.send(UndoEvent{});
    if (ask.redo && state_.painter.can_redo && !blocked) painter_.send(RedoEvent{});
    if (ask.dry && !blocked)
        painter_.send(DryEvent{fmt::format("layer {}", state_.painter.layers.size() + 1), 1});
    if (!ask.lift.empty() && !blocked) painter_.send(LiftEvent{ask.lift});
    if (ask.recover && left_over_) {
        painter_.recover(std::move(*left_over_));
        left_over_.reset();
        state_.left_over_strokes = 0;
    }
    if (ask.discard) {
        painter_.discard();
        left_over_.reset();
        state_.left_over_strokes = 0;
    }
    if (ask.snapshot) snapshot();
    if (ask.save && !blocked) {
        hand_.let_go();
        painter_.save();
    }
    if (ask.close && ask.save) close_when_saved_ = true;
    if (ask.close || ask.close_unsaved) glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
    if (ask.close_unsaved) close_unsaved_ = true;
}

// What to do about a window that is to be closed: true where it may.
bool App::closing() {
    if (!glfwWindowShouldClose(window_.handle())) return false;
    hand_.let_go();  // in mid-stroke: the stroke ends here
    if (close_unsaved_) return true;
    if (close_when_saved_ || !state_.closing) {
        close_when_saved_ = false;
        painter_.wait();
        news();  // what became of it, and messages
    }
    if (!state_.painter.unsaved) return true;
    state_.closing = true;  // asks
    glfwSetWindowShouldClose(window_.handle(), GLFW_FALSE);
    settle_ = kFramesAfterwards;
    return false;
}

void App::animate(double seconds) {
    if (!hand_.holds()) state_.tilt = advanced(state_.tilt, seconds);
    if (state_.sweeping) {
        Angles& light = state_.lamps[state_.lamp].angles;
        light.azimuth_deg = std::remainder(light.azimuth_deg + kSweep_deg_per_s * seconds, 360.0);
    }
    if (now_s_ > state_.message_until_s) state_.message.clear();
}

// What is under the cursor, four times as large.
void App::loupe(const Scene& scene) {
    glm::dvec2 at;
    if (!state_.loupe || !hand_.over_canvas() || !placement().to_painting(hand_.cursor(), at)) return;
    constexpr int kSide = 240;
    constexpr double kLarger = 4;
    if (!loupe_.width()) loupe_ = gl::Target(kSide, kSide, false);
    View view = state_.view;
    view.centre_px = at;
    view.zoom *= kLarger;
    const Placement place(view, state_.tilt, state_.flat, state_.painting, {kSide, kSide},
                          state_.mm_per_pixel);
    renderer_.draw(scene, place.shot(1, true), loupe_.framebuffer());
    const int x = static_cast<int>(left_ + hand_.cursor().x) - kSide / 2;
    const int y = window_size_.height - static_cast<int>(hand_.cursor().y) - kSide / 2;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, loupe_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, kSide, kSide, x, y, x + kSide, y + kSide, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void App::draw(bool moved) {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, window_size_.width, window_size_.height);
    glClearColor(0.15f, 0.15f, 0.16f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    const Placement place = placement();
    if (moved || dirty_ || !picture_.fine())
        picture_.draw(renderer_, scene_of(state_, place), place, screen_, moved || (dirty_ && hand_.holds()));
    dirty_ = false;
    picture_.show(static_cast<int>(left_), window_size_.height);
    loupe(scene_of(state_, place));
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    if (hand_.panels_wanted()) panels::column(state_, static_cast<float>(window_size_.height));
    panels::help(state_);
    panels::overlay(state_, place, screen_, hand_.cursor(), hand_.over_canvas());
    ImGui::Render();
    glViewport(0, 0, window_size_.width, window_size_.height);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_.handle());
    ++result_.frames;
}

// True while there is something to do.
bool App::frame() {
    const double before = now_s_;
    now_s_ = glfwGetTime();
    const bool woken = input_.woken();
    const std::deque<InputEvent> events = input_.take();
    glfwGetFramebufferSize(window_.handle(), &window_size_.width, &window_size_.height);
    left_ = hand_.panels_wanted() ? panels::kWidth : 0;
    const Extent screen{window_size_.width - static_cast<int>(left_), window_size_.height};
    const bool resized = screen.width != screen_.width || screen.height != screen_.height;
    if (screen.width > 0 && screen.height > 0) screen_ = screen;
    if (!fitted_) state_.view = fitted(state_.painting, screen_);
    fitted_ = true;
    const bool panels_busy = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup) ||
                             (state_.help && ImGui::GetIO().WantCaptureMouse);
    for (const InputEvent& event : events)
        hand_.take(event, screen_, left_, panels_busy, ImGui::GetIO().WantTextInput);
    requests();
    news();
    animate(std::min(now_s_ - before, 0.1));
    if (window_size_.width <= static_cast<int>(left_) || window_size_.height <= 0 ||
        glfwGetWindowAttrib(window_.handle(), GLFW_ICONIFIED)) {
        settle_ = kFramesAfterwards;  // when it comes back
        return false;                 // nothing to be seen
    }

    // What the picture depends on; strokes and light alike.
    const Placement place = placement();
    const Scene scene = scene_of(state_, place);
    const Shot shot = place.shot(1, true);
    std::string seen(reinterpret_cast<const char*>(&shot), sizeof shot);
    for (const Light& light : scene.lights)
        seen += fmt::format("{} {} {} {} {}", light.direction.x, light.direction.y, light.direction.z,
                            light.gain.r, light.position_mm ? light.position_mm->z : 0);
    seen += fmt::format("{} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(scene.model),
                        static_cast<int>(scene.shadows), scene.light_radius_deg, scene.ambient,
                        scene.exposure[0][0], scene.shoulder, static_cast<int>(scene.mode), scene.strength,
                        scene.sharpness, scene.lowest_mm, scene.highest_mm);
    const bool moved = seen != seen_;
    seen_ = std::move(seen);
    if (moved) moved_s_ = now_s_;
    if (woken || moved || dirty_ || resized) settle_ = kFramesAfterwards;
    const bool rests = now_s_ - moved_s_ > 0.15;
    if (settle_ > 0 || !patches_.empty() || (rests && !picture_.fine())) {
        // Fine pictures wait until the hand rests.
        if (moved || dirty_ || picture_.fine() || rests) {
            draw(moved || (!rests && !picture_.fine()));
            --settle_;
        }
    }
    return state_.tilt.moves() || state_.sweeping || settle_ > 0 || !patches_.empty() || !picture_.fine();
}

WindowResult App::run() {
    bool busy = true;
    for (;;) {
        if (busy)
            glfwPollEvents();
        else
            glfwWaitEventsTimeout(0.25);
        if (stop_wanted_ && stop_wanted_()) break;
        if (closing()) break;
        busy = frame();
        // Without vertical synchronisation, or with a picture that did not change, do not spin.
        if (busy) {
            const double left = now_s_ + kFrame_s - glfwGetTime();
            if (left > 0) glfwWaitEventsTimeout(left);
        }
    }
    hand_.let_go();
    painter_.wait();
    const PainterState last = painter_.fetch().state;
    result_.strokes = last.strokes;
    result_.saves = last.saves;
    result_.unsaved = last.unsaved;
    result_.tilt_deg = state_.tilt.angle_deg;
    result_.light_azimuth_deg = state_.lamps.front().angles.azimuth_deg;
    result_.light_elevation_deg = state_.lamps.front().angles.elevation_deg;
    result_.uploaded_bytes = renderer_.uploaded_bytes() - first_bytes_;
    return result_;
}

}  // namespace

WindowResult run_window(WindowSetup setup, const Progress& progress) {
    return App(std::move(setup), progress).run();
}

}  // namespace tangi
