// window_opening.cpp: the window opens: what is seen while a painting is read, and from then on.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "surface/base/error.h"
#include "surface/painting_file/overview.h"
#include "surface/provenance/fit_doubts.h"
#include "viewer/app/window_app.h"
#include "viewer/panels/panels.h"

namespace tangi {

namespace {

constexpr double kLook_s = 0.01;  // between two looks whether it is there

// No shadows, until the painter has made a map of them: the shader is the same.
HorizonMap no_horizon() {
    HorizonMap nothing{1, 1, {}};
    nothing.values.assign(HorizonMap::kAzimuths, 0);
    return nothing;
}

}  // namespace

// Drivers compile when something is drawn for the first time, which takes a software renderer a tenth of a
// second for each shader: those that are needed at once now, and not when the hand first moves.
void WindowApp::warm_up() {
    renderer_.set_horizon(no_horizon());
    const gl::Target target(16, 16, false);
    for (const bool smooth : {false, true}) {
        Shot shot = placement().shot(1, smooth);
        if (!smooth) renderer_.fetch(scene_on_screen(), shot);
        shot.width = shot.height = 16;
        // What moves is drawn to the window.
        renderer_.draw(scene_on_screen(), shot, smooth ? target.framebuffer() : 0);
    }
    glFinish();
    cold_shaders_ = 2;
}

// Those that are drawn with while tiles are missing.
void WindowApp::warm_up_table() {
    const gl::Target target(16, 16, false);
    const bool smooth = --cold_shaders_ == 0;
    Shot shot = placement().shot(1, smooth);
    shot.width = shot.height = 16;
    renderer_.draw_by_table(scene_on_screen(), shot, smooth ? target.framebuffer() : 0);
    glFinish();
}

// While the painting is read: its overview, and how far it is. False where the window was closed meanwhile.
bool WindowApp::open_first() {
    state_.title = title_of(file_);
    std::shared_ptr<const TexelTiles> tiles;
    double mm_per_pixel = 1;
    if (std::filesystem::exists(file_))
        if (const std::optional<Overview> overview = read_overview(file_)) {
            tiles = std::make_shared<TexelTiles>(overview->surface, range_of(overview->surface));
            mm_per_pixel = overview->surface.mm_per_pixel;
            state_.painting = {overview->width, overview->height};
            state_.reflectance_model = overview->surface.reflectance_model;
            renderer_.set_painting(tiles, mm_per_pixel);
            renderer_.set_horizon(no_horizon());
        }
    double drawn_s = -1;
    while (!first_->over()) {
        if ((stop_wanted_ && stop_wanted_()) || glfwWindowShouldClose(window_.handle())) return false;
        if (glfwGetTime() - drawn_s > kProgress_s) {
            draw_opening(tiles, mm_per_pixel);
            drawn_s = glfwGetTime();
        }
        input_.hear(kLook_s);
    }
    OpenedPainting opened = first_->take();
    first_.reset();
    input_.take();  // it was meant for what was not there
    panel_input_.clear();
    show(std::move(opened), true);
    if (!photos_.empty()) documents_->hold_photos(photos_, *painter_);
    return true;
}

void WindowApp::draw_opening(const std::shared_ptr<const TexelTiles>& overview, double mm_per_pixel) {
    glfwGetFramebufferSize(window_.handle(), &window_size_.width, &window_size_.height);
    state_.window_width = window_size_.width;
    const int left = static_cast<int>(panels::width(state_));
    state_.canvas_left = static_cast<float>(left);
    const Extent screen{window_size_.width - left, window_size_.height};
    if (screen.width <= 0 || screen.height <= 0) return;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, window_size_.width, window_size_.height);
    glClearColor(0.15f, 0.15f, 0.16f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    if (overview) {
        if (screen.width != screen_.width || screen.height != screen_.height) {
            const Extent small{overview->width(), overview->height()};
            const Placement place(fitted(small, screen), {}, small, screen, mm_per_pixel);
            Scene scene = scene_of(state_, place);
            scene.on_monitor = true;
            picture_.draw(renderer_, scene, place, screen, left, false);
        } else {
            picture_.show(left);
        }
    }
    screen_ = screen;
    fonts_complete();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    ImGui::BeginDisabled();
    panels::column(state_, static_cast<float>(window_size_.height));
    ImGui::EndDisabled();
    const FirstOpening::State state = first_->state();
    panels::opening(state_, state.stage, state.fraction, screen);
    ImGui::Render();
    glViewport(0, 0, window_size_.width, window_size_.height);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_.handle());
    window_.require_device();
}

// The painting that was shown until now.
void WindowApp::put_away() {
    hand_->let_go();
    take_annotations();
    keep_annotations(true);
    painter_->hurry(false);
    tally();
    if (result_.unsaved)
        say(fmt::format("strokes on {} were not saved: open it again to recover them", state_.title));
}

// What the state says of the painting that the painter has, from `file`.
void WindowApp::know_painting(const std::filesystem::path& file) {
    const Surface& surface = painter_->surface();
    state_.title = title_of(file);
    state_.painting = {surface.width(), surface.height()};
    state_.mm_per_pixel = surface.mm_per_pixel;
    state_.stroke_mm_per_pixel = painter_->mm_per_pixel();
    state_.scale_known = surface.scale_known || state_.stroke_mm_per_pixel != 1;
    state_.reflectance_model = surface.reflectance_model;
    state_.doubts = doubts_of(surface);
    if (!state_.doubts.empty())
        say(fmt::format(
            "{} doubt{} of the fit: see Messages", state_.doubts.size(),
            state_.doubts.size() == 1 ? "" : "s"));  // in words there: here they cover the painting
    state_.from_photographs = !surface.photography.photos.empty();
    const auto [low, high] =
        std::minmax_element(surface.height_mm.pixels().begin(), surface.height_mm.pixels().end());
    state_.most_curvature = first_most_curvature(surface.mm_per_pixel);
    state_.lowest_mm = *low;
    state_.highest_mm = *high;
}

// What belongs to the painting before.
void WindowApp::forget_painting() {
    state_.ruler.reset();
    state_.profile.reset();
    state_.region.reset();
    state_.statistics.reset();
    state_.probe.reset();
    state_.left_over_strokes = 0;
    state_.left_over_of_another = false;
    state_.closing = false;
    left_over_.reset();
    held_.clear();
    if (recorder_) say("the film was not finished");
    recorder_.reset();
    board_ = gl::Texture();
    state_.board = {};
}

// From now on, this painting.
void WindowApp::show(OpenedPainting opened, bool is_first) {
    if (!is_first) put_away();
    treatment_state_->leave();
    map_.clear();
    // What is to be uploaded is of the painting before.
    changed_.clear();
    hand_.reset();
    painter_ = std::move(opened.painter);
    hand_.emplace(state_, *painter_);
    annotated_ = painter_->file();  // nothing of the painting before goes with it
    if (opened.is_new) state_.tool = Tool::paint;
    know_painting(opened.file);
    forget_painting();
    glfwSetWindowTitle(window_.handle(), fmt::format("{} - TangiPaint", state_.title).c_str());
    renderer_.set_painting(opened.tiles, painter_->surface().mm_per_pixel);
    state_.view = fitted(state_.painting, pane(state_, screen_));
    warm_up();
    painter_->start(std::move(opened.tiles));
    painter_->make_horizon();
    shown_in_ = Illuminant::d65;
    news();
    // The journal of another window is no left-over.
    if (!state_.painter.elsewhere) find_left_over(opened.file);
    open_annotations();
    documents_->shows(*painter_);
    treatment_state_->shows(*painter_);
    fitted_ = ready_to_paint_ = false;
    dirty_ = true;
}

// Adds what was done to the painting that is shown to the result.
void WindowApp::tally() {
    painter_->wait();
    const PainterState last = painter_->fetch().state;
    result_.file = painter_->file();
    result_.strokes += last.strokes;
    result_.saves += last.saves;
    result_.unsaved = last.unsaved;
}

}  // namespace tangi
