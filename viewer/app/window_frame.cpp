// window_frame.cpp: frame after frame: what came is done, what changed is drawn.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>

#include "viewer/app/window_app.h"
#include "viewer/panels/panels.h"

namespace tangi {

namespace {

constexpr double kFrame_s = 1 / 60.0;
constexpr int kMostHeldFrames = 10;  // that keys wait for what a dialog does

}  // namespace

// A painting that is seen whole, as it was fitted, stays so, also in the half beside a photograph.
void WindowApp::resize(Extent screen) {
    const View was = fitted(state_.painting, pane_, state_.view.turn_deg);
    const bool is_fitted =
        !fitted_ || (state_.view.centre_px == was.centre_px && state_.view.zoom == was.zoom);
    if (screen.width > 0 && screen.height > 0) screen_ = screen;
    pane_ = pane(state_, screen_);
    if (is_fitted) state_.view = fitted(state_.painting, pane_, state_.view.turn_deg);
    fitted_ = true;
}

// Each key does what it does before the next: two Ctrl+Z that come within one slow frame are two. What comes
// after one that may close a dialog waits until it is known whether it did.
void WindowApp::take_input(std::deque<InputEvent> events) {
    events.insert(events.begin(), held_back_.begin(), held_back_.end());
    held_back_.clear();
    const bool floating = state_.help || dialog_ || state_.profile || state_.statistics ||
                          state_.board.open || state_.new_canvas.open;
    const bool unfolded = PanelInput::popup_is_open();
    const bool panels_busy = unfolded || (floating && ImGui::GetIO().WantCaptureMouse);
    // A dialog that is gone is typed into until Dear ImGui has noticed.
    bool undecided = held_frames_ > 0 && (dialog_ ? panel_input_.waits() : ImGui::GetIO().WantTextInput);
    if (held_frames_ > 0) --held_frames_;
    while (!events.empty() && !undecided) {
        const InputEvent event = events.front();
        // What was typed before a click elsewhere goes into its field first.
        const bool types = panel_input_.waits() && ImGui::GetIO().WantTextInput;
        if (types && event.kind == InputEvent::Kind::press) break;
        events.pop_front();
        const bool field_comes = state_.annotations.until_typed > 0;
        panel_input_.put(event);
        hand_->take(event, screen_, left_, panels_busy,
                    dialog_ || unfolded || field_comes || ImGui::GetIO().WantTextInput);
        if (event.kind != InputEvent::Kind::key && state_.annotations.acts.empty()) continue;
        requests();
        // The key that asks for a field is not meant for it: Enter would end it.
        if (!field_comes && state_.annotations.until_typed > 0) panel_input_.take_back_key();
        undecided = dialog_ && (event.code == GLFW_KEY_ESCAPE || event.code == GLFW_KEY_ENTER ||
                                event.code == GLFW_KEY_KP_ENTER);
        if (undecided) held_frames_ = kMostHeldFrames;
    }
    held_back_ = std::move(events);
}

// What of the window the painting has, which may be nothing.
Extent WindowApp::canvas_area() {
    glfwGetFramebufferSize(window_.handle(), &window_size_.width, &window_size_.height);
    state_.window_width = window_size_.width;
    left_ = hand_->panels_wanted() ? panels::width(state_) : 0;
    state_.canvas_left = static_cast<float>(left_);
    const float right = hand_->panels_wanted() ? panels::treatment_width(state_) : 0;
    return {window_size_.width - static_cast<int>(left_ + static_cast<double>(right)), window_size_.height};
}

// How far what runs beside the window is: seen now and then.
void WindowApp::look_at_jobs() {
    progress_due_ |= documents_->look();
    progress_due_ |= treatment_state_->look();
    if (!progress_due_ || now_s_ - progress_s_ <= kProgress_s) return;
    settle_ = std::max(settle_, 1);
    progress_s_ = now_s_;
    progress_due_ = false;
}

void WindowApp::show_opened() {
    auto opened = documents_->opened();
    if (!opened) return;
    if (opened->palette) {
        state_.use_palette(*opened->palette);
        treatment_state_->use_palette(*opened->palette);
    }
    show(std::move(*opened), false);
}

// Does what came since the last frame, and what goes on by itself.
void WindowApp::advance(std::deque<InputEvent> events, double seconds) {
    take_input(std::move(events));
    take_dropped();
    look_at_jobs();
    if (state_.tool == Tool::paint && !ready_to_paint_) painter_->get_ready();
    ready_to_paint_ |= state_.tool == Tool::paint;
    requests();
    keep_annotations(false);
    if (state_.illuminant_now() != shown_in_) painter_->show_in(shown_in_ = state_.illuminant_now());
    news();
    preview_canvas();
    hand_->probe(dirty_);
    show_opened();
    if (state_.help) state_.pens = input_.pens();
    devices_->step(now_s_, seconds, screen_);
    film();
    animate(seconds);
}

// Draws where something changed (`woken`: something came), and what was drawn coarsely. True while there is
// more of it to be done.
bool WindowApp::draw_what_changed(bool woken) {
    std::string seen = seen_now(placement());
    const Comparing& comparing = state_.comparing;
    const bool moved = seen != seen_;
    seen_ = std::move(seen);
    if (moved) moved_s_ = now_s_;
    if (woken || moved || dirty_) settle_ = kFramesAfterwards;
    const bool rests = now_s_ - moved_s_ > 0.15, fine = comparing.shows() || picture_.fine();
    if (settle_ > 0 || !changed_.empty() || (rests && !fine)) {
        // Fine pictures wait until the hand rests.
        if (moved || dirty_ || fine || rests) {
            draw(moved || (!rests && !fine));
            --settle_;
        }
    } else if (cold_shaders_ > 0 && rests && !hand_->holds()) {
        warm_up_table();
    }
    return settle_ > 0 || !changed_.empty() || !fine;
}

// True while there is something to do.
bool WindowApp::frame() {
    const double before = now_s_;
    now_s_ = glfwGetTime();
    const bool was_woken = input_.woken();
    std::deque<InputEvent> events = input_.take();
    const bool woken = was_woken || !events.empty() || !held_back_.empty();
    const Extent screen = canvas_area();
    const bool resized = screen.width != screen_.width || screen.height != screen_.height;
    const Extent now = pane(state_, screen_);  // half of it, where a photograph came to its side
    if (resized || !fitted_ || now.width != pane_.width || now.height != pane_.height) resize(screen);
    advance(std::move(events), std::min(now_s_ - before, 0.1));
    if (screen.width <= 0 || window_size_.height <= 0 ||
        glfwGetWindowAttrib(window_.handle(), GLFW_ICONIFIED)) {
        settle_ = kFramesAfterwards;  // when it comes back
        return false;                 // nothing to be seen
    }
    const bool draws_on = draw_what_changed(woken || resized);
    return draws_on || state_.finishing || cold_shaders_ > 0 || state_.tilt.moves() || state_.sweeping ||
           recorder_ || (state_.comparing.shows() && state_.comparing.way == CompareWay::blink);
}

WindowResult WindowApp::run() {
    if (!open_first()) {
        result_.file = file_;
        return result_;
    }
    bool busy = true;
    for (;;) {
        if (busy)
            input_.hear();
        else
            input_.hear(devices_->polled() || input_.polled() ? kFrame_s : 0.25);
        if (stop_wanted_ && stop_wanted_()) break;
        if (closing()) break;
        busy = frame();
        // Without vertical synchronisation, or with a picture that did not change, do not spin.
        if (busy) {
            const double left = now_s_ + kFrame_s - glfwGetTime();
            if (left > 0) input_.hear(left);
        }
    }
    hand_->let_go();
    take_annotations();
    keep_annotations(true);
    // Who ends programs kills them soon afterwards: what waits goes into the journal at once, though it was
    // to be saved.
    painter_->hurry(stop_wanted_ && stop_wanted_());
    tally();
    result_.tilt_deg = state_.tilt.angle_deg;
    result_.light_azimuth_deg = state_.lights.front().angles.azimuth_deg;
    result_.light_elevation_deg = state_.lights.front().angles.elevation_deg;
    const UploadedBytes& uploaded = renderer_.uploaded();
    result_.uploaded_bytes = uploaded.changes + uploaded.horizons;
    result_.fetched_bytes = uploaded.tiles;
    return result_;
}

}  // namespace tangi
