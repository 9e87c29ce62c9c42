#include "viewer/app/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "surface/base/error.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_tiles.h"
#include "viewer/app/window_app.h"
#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"
#include "viewer/panels/shown_texts.h"

namespace tangi {

namespace {

// Begins to read what the window is opened with. What is no painting is found before there is a window.
std::unique_ptr<FirstOpening> opening_of(const WindowSetup& setup, const Progress& progress) {
    if (!setup.file_is_new) (void)painting_parts(setup.file);
    return std::make_unique<FirstOpening>(
        [open = setup.open, palette = setup.palette, file = setup.file,
         is_new = setup.file_is_new](const Progress& p) {
            OpenedPainting opened;
            const auto stamp = stamp_of(main_file_of(file));
            opened.painter = std::make_unique<Painter>(
                Painter::Setup{open(p), palette, file, is_new, stamp}, [] { glfwPostEmptyEvent(); }, p);
            opened.tiles = std::make_shared<TexelTiles>(opened.painter->surface(), opened.painter->range());
            opened.file = file;
            return opened;
        },
        progress);
}

constexpr double kSweep_deg_per_s = 40;
constexpr std::size_t kFetchBytes = std::size_t(8) << 20;  // for the loupe, in one frame
constexpr int kMostMoments = 100;                          // of panels in one frame; further ones wait

}  // namespace

WindowApp::WindowApp(WindowSetup setup, const Progress& progress)
    : stop_wanted_(std::move(setup.stop_wanted)),
      file_(setup.file),
      photos_(setup.photos),
      settings_(setup.settings),
      first_(opening_of(setup, progress)),
      window_(fmt::format("{} - TangiPaint", setup.file.filename().string()), setup.width, setup.height),
      input_(window_.handle()),
      panels_(window_.handle()) {
    state_.scale = panels_.scale();
    state_.use_palette(setup.palette);
    if (!setup.brushes.empty()) state_.brushes = setup.brushes;
    const auto wake = [] { glfwPostEmptyEvent(); };
    documents_.emplace(
        state_, DocumentController::Setup{std::move(setup.workshop), setup.palette, setup.settings, wake,
                                          [this](const std::string& text) { say(text); }});
    treatment_state_.emplace(
        state_, TreatmentController::Setup{std::move(setup.author), setup.palette, wake,
                                           [this](const std::string& text) { say(text); }, setup.settings});
    devices_.emplace(state_, Devices::Setup{.camera = setup.camera,
                                            .wake = wake,
                                            .say = [this](const std::string& text) { say(text); }});
    use_monitor(setup);
    const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    result_.drawn_by = name ? name : "";
    for (const std::string& warning : setup.warnings) say(warning);
    try {
        keys_file_ = SettingsFile(setup.settings / "keys.json");
        if (!setup.settings.empty()) state_.keys = Keys::read(keys_file_.path());
    } catch (const Error& error) {
        keys_file_.cannot_be_read();
        say(error.what());  // the usual keys, then
    }
}

// A profile that the screen has is used where nothing else is said; a bad one is no reason not to paint.
void WindowApp::use_monitor(WindowSetup& setup) {
    monitor_ = std::move(setup.monitor);
    state_.monitor = "as sRGB";
    if (!monitor_ && !setup.monitor_is_srgb) try {
            if (const auto icc = profile_of_the_screen()) monitor_.emplace(*icc, "the profile of the screen");
        } catch (const Error& error) {
            say(error.what());
        }
    if (!monitor_) return;
    monitor_->set_intent(setup.intent);
    state_.monitor = monitor_->name();
    renderer_.set_monitor(monitor_->table());
}

Scene WindowApp::scene_on_screen() const {
    Scene scene = scene_of(state_, placement());
    scene.on_monitor = true;
    return scene;
}

// What was said before and may not have been read yet stays above it; all is kept in the panel Messages.
void WindowApp::say(const std::string& text) {
    constexpr std::size_t kMostSaid = 200, kMostLines = 4;
    if (state_.said.empty() || state_.said.back() != text) state_.said.push_back(text);
    if (state_.said.size() > kMostSaid) state_.said.pop_front();
    const bool is_read = state_.message.empty() || now_s_ > state_.message_until_s;
    if (is_read || state_.message == text)
        state_.message = text;
    else if (!state_.message.ends_with("\n" + text))
        state_.message += "\n" + text;
    while (std::ranges::count(state_.message, '\n') >= static_cast<std::ptrdiff_t>(kMostLines))
        state_.message.erase(0, state_.message.find('\n') + 1);
    state_.message_until_s = now_s_ + 8;
    settle_ = kFramesAfterwards;
}

void WindowApp::animate(double seconds) {
    if (!hand_->holds()) state_.tilt = advanced(state_.tilt, seconds);
    if (state_.sweeping && !state_.comparing.on) {
        Angles& light = state_.lights[state_.light].angles;
        light.azimuth_deg = std::remainder(light.azimuth_deg + kSweep_deg_per_s * seconds, 360.0);
    }
    Comparing& comparing = state_.comparing;
    comparing.blink_photo = std::fmod(now_s_, 2 * comparing.blink_s) < comparing.blink_s;
    if (comparing.way != CompareWay::blink) comparing.blink_photo = false;
    if (now_s_ > state_.message_until_s && !state_.whole_message) state_.message.clear();
}

// What is under the cursor, four times as large.
void WindowApp::loupe(const Scene& scene) {
    glm::dvec2 at;
    if (!state_.loupe || !hand_->over_canvas() || !placement().to_painting(hand_->cursor(), at)) return;
    constexpr int kSide = 240;
    constexpr double kLarger = 4;
    if (!loupe_.width()) loupe_ = gl::Target(kSide, kSide, false);
    View view = state_.view;
    view.centre_px = at;
    view.zoom *= kLarger;
    const Placement place(view, {state_.tilt, state_.flat}, state_.painting, {kSide, kSide},
                          state_.mm_per_pixel);
    const Shot shot = place.shot(1, true);
    if (!renderer_.fetch(scene, shot, kFetchBytes, true).complete) settle_ = std::max(settle_, 2);
    renderer_.draw(scene, shot, loupe_.framebuffer());
    const int x = static_cast<int>(left_ + hand_->cursor().x) - kSide / 2;
    const int y = window_size_.height - static_cast<int>(hand_->cursor().y) - kSide / 2;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, loupe_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, kSide, kSide, x, y, x + kSide, y + kSide, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void WindowApp::draw(bool moved) {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, window_size_.width, window_size_.height);
    glClearColor(0.15f, 0.15f, 0.16f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    const Placement place = placement();
    const bool compares = state_.comparing.shows();
    if (compares) {
        held_.show(state_.comparing, monitor_ ? &*monitor_ : nullptr);
    } else {
        if (moved || dirty_ || !picture_.fine())
            picture_.draw(renderer_, scene_on_screen(), place, screen_, static_cast<int>(left_),
                          moved || (dirty_ && hand_->holds()));
        else
            picture_.show(static_cast<int>(left_));
        loupe(scene_on_screen());
    }
    dirty_ = false;
    if (fonts_complete()) settle_ = std::max(settle_, 1);
    const auto finger = input_.finger();
    if (finger) settle_ = kFramesAfterwards;
    for (int moment = 1;; ++moment) {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        const auto [enter, escape] = panel_input_.feed(finger, ready_to_type());
        if (dialog_ && enter) dialog_->enter();
        if (dialog_ && escape) dialog_->escape();
        ImGui::NewFrame();
        if (escape) PanelInput::close_popups();
        draw_panels(place);
        if (state_.annotations.until_typed > 0) --state_.annotations.until_typed;
        ImGui::Render();
        if (const auto complaint = panels::number_complaint()) say(*complaint);
        if (!panel_input_.waits() || moment == kMostMoments) break;
        requests();  // what this moment asked for, before the next one asks again
    }
    if (panel_input_.waits()) settle_ = kFramesAfterwards;
    glViewport(0, 0, window_size_.width, window_size_.height);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_.handle());
    window_.require_device();
    ++result_.frames;
}

// What is typed has where to go.
bool WindowApp::ready_to_type() const {
    return dialog_ ? dialog_->ready_to_type() : state_.annotations.until_typed == 0;
}

// All of them as they are at this moment.
void WindowApp::draw_panels(const Placement& place) {
    if (state_.comparing.shows()) panels::held_photo(state_, held_.left(), held_.right(), screen_);
    if (hand_->panels_wanted()) {
        panels::column(state_, static_cast<float>(window_size_.height));
        if (state_.treatment_state.on)
            panels::treatment_column(state_, static_cast<float>(window_size_.height));
    }
    panels::measurements(state_);
    panels::board(state_);
    panels::new_canvas(state_);
    panels::help(state_);
    if (dialog_ && !dialog_->draw()) dialog_.reset();
    panels::overlay(state_, place, screen_, hand_->cursor(), hand_->over_canvas());
}

// Makes the panels able to write what they show: true where they could not before.
bool WindowApp::fonts_complete() {
    PanelFonts& fonts = panels_.fonts();
    const auto need = [&](std::string_view text) { fonts.need(text); };
    each_shown_text(state_, need);
    if (dialog_) dialog_->each_text(need);
    fonts.need_typed();
    return fonts.complete();
}

// What the picture depends on, but for strokes.
std::string WindowApp::seen_now(const Placement& place) const {
    const Scene scene = scene_of(state_, place);
    const Shot shot = place.shot(1, true);
    // Up to its last member (always the same): what comes after that is padding, which is never the same.
    constexpr std::size_t kShotBytes = offsetof(Shot, smooth);
    std::string seen(reinterpret_cast<const char*>(&shot), kShotBytes);
    for (const Light& light : scene.lights)
        seen += fmt::format("{} {} {} {} {}", light.direction.x, light.direction.y, light.direction.z,
                            light.gain.r, light.position_mm ? light.position_mm->z : 0);
    seen += fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(scene.model),
                        static_cast<int>(scene.shadows), scene.light_radius_deg, scene.ambient,
                        scene.exposure[0][0], scene.shoulder, static_cast<int>(scene.mode), scene.strength,
                        scene.sharpness, scene.lowest_mm, scene.highest_mm, scene.most_curvature);
    const Comparing& comparing = state_.comparing;
    if (comparing.shows())
        return fmt::format("{} {} {} {} {}", seen.substr(0, kShotBytes),
                           static_cast<const void*>(comparing.held().get()), static_cast<int>(comparing.way),
                           comparing.divider, comparing.blink_photo);
    return seen;
}

WindowResult run_window(WindowSetup setup, const Progress& progress) {
    return WindowApp(std::move(setup), progress).run();
}

}  // namespace tangi
