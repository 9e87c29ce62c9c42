// window_requests.cpp: what hand and panels ask of the window, and what comes back from the painter.
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

#include "surface/base/error.h"
#include "surface/file/error_message.h"
#include "surface/image_file/image_io.h"
#include "viewer/app/window_app.h"
#include "viewer/video/light_sweep.h"

namespace tangi {

namespace {

constexpr double kHorizonPause_s = 0.4;  // after the last change, before shadows are made again
constexpr std::size_t kUploadBytes = std::size_t(8) << 20;  // in one frame

// Whether a stroke that is under way has to end before what is asked for: before all but what concerns only
// how the painting is seen, and what runs beside it.
bool comes_after_strokes(WindowState::Requests ask, const TreatmentState::Ask& treatment_state) {
    ask.fit = ask.one_to_one = ask.straighten = ask.snapshot = false;
    ask.stop_job = ask.stop_report = ask.stop_film = ask.keys_changed = ask.usual_keys = false;
    ask.step_photo = 0;
    ask.photo.reset();
    return ask != WindowState::Requests{} || treatment_state != TreatmentState::Ask{};
}

}  // namespace

void WindowApp::find_left_over(const std::filesystem::path& file) {
    try {
        left_over_ = left_over(recovery_files(file));
    } catch (const std::exception& error) {
        say(message_of(error));  // one can look at the painting all the same
    }
    if (!left_over_) return;
    if (left_over_->lines_lost > 0)
        say(fmt::format("{}: {} line{} damaged (line {}); the strokes of the others can be recovered",
                        std::filesystem::path(left_over_->source).filename().string(), left_over_->lines_lost,
                        left_over_->lines_lost == 1 ? " is" : "s are", left_over_->warnings.front().line));
    state_.left_over_strokes = std::max(1, strokes_left(left_over_->entries));
    state_.left_over_of_another = !is_of(*left_over_, painter_->saved_hash());
    if (state_.left_over_of_another)
        say(fmt::format("{}: its strokes are of another painting than {} is now; nothing is done with them",
                        std::filesystem::path(left_over_->source).filename().string(),
                        file.filename().string()));
}

void WindowApp::take_board(std::vector<BoardPatch> patches) {
    for (BoardPatch& patch : patches) {
        if (monitor_) monitor_->apply({&patch.srgb.data()->r, 3 * patch.srgb.size()});
        const Region& r = patch.region;
        if (!board_) {
            board_ = gl::make_texture();
            state_.board.size = {patch.width, patch.height};
            state_.board.texture = board_.id();
            glBindTexture(GL_TEXTURE_2D, board_.id());
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
            glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, patch.width, patch.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                         nullptr);
        }
        glBindTexture(GL_TEXTURE_2D, board_.id());
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glTexSubImage2D(GL_TEXTURE_2D, 0, r.x0, r.y0, r.width(), r.height(), GL_RGB, GL_UNSIGNED_BYTE,
                        patch.srgb.data());
        glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    }
    if (!patches.empty()) settle_ = kFramesAfterwards;
}

void WindowApp::board_requests(const PaintRequests& ask) {
    if (ask.wash) {
        painter_->send(WashEvent{});
        state_.board.carried = Carried::nothing;
    }
    if (ask.lay_out || ask.wipe_board) {
        PaletteEvent event;
        event.all_paints = ask.lay_out;
        painter_->send(event);
    }
    if (!ask.squeeze) return;
    PileEvent pile;
    for (const auto& [name, part] : state_.mix)
        if (part > 0) pile.paint.emplace_back(name, part);
    pile.finish = state_.finish;
    painter_->squeeze(std::move(pile));
}

// What is saved is seen.
void WindowApp::save(const SavingRequests& ask) {
    const bool in_place =
        ask.save || (!ask.save_as.empty() && ask.save_as.lexically_normal() == painter_->file());
    const bool saved_annotations = in_place && save_annotations();
    if ((!ask.save && ask.save_as.empty()) || state_.finishing) return;
    if (state_.left_over_strokes > 0) {
        say("first recover or discard the strokes that were not saved");
        return;
    }
    if (state_.treatment_state.preview) {
        say("first apply the retouch that is previewed, or put it aside");
        return;
    }
    if (state_.treatment_state.state) {
        state_.treatment_state.state.reset();
        painter_->show_as({});
    }
    if (ask.save && !(saved_annotations && painted_is_saved())) painter_->save();
    if (!ask.save_as.empty()) painter_->save_as(ask.save_as);
}

// Some of what changed of the painting, a frame's share.
void WindowApp::upload_changed() {
    const bool uploads = !changed_.empty();
    const std::size_t before = renderer_.uploaded().changes;
    while (!changed_.empty() && renderer_.uploaded().changes - before < kUploadBytes) {
        renderer_.upload(changed_.front());
        changed_.pop_front();
    }
    if (uploads) {
        dirty_ = true;
        horizon_due_s_ = now_s_ + kHorizonPause_s;
    }
}

void WindowApp::upload_damage_map() {
    const DamageMap* map = treatment_state_->map();
    if (!map) return;
    if (const Region changed = treatment_state_->map_changed(); !changed.empty()) {
        map_.update(map->picture(), changed);
        settle_ = kFramesAfterwards;
    }
    state_.treatment_state.map_texture = map_.id();
}

// What the painter was asked about the painting.
void WindowApp::take_answers(PainterNews& news) {
    if (news.probe) {
        state_.probe = news.probe;
        settle_ = std::max(settle_, 1);
    }
    if (news.profile) state_.profile = std::move(news.profile);
    if (news.statistics) state_.statistics = news.statistics;
    if (!news.picked) return;
    if (state_.take_up(*news.picked))
        state_.tool = Tool::paint;
    else
        say(fmt::format(
            "no paint of the palette lies there to be picked up{}",
            state_.treatment_state.on ? "; Match, under Colour, finds a recipe for what is seen" : ""));
}

void WindowApp::news() {
    PainterNews news = painter_->fetch();
    if (news.state.saves != state_.painter.saves) documents_->remember(painter_->file());
    state_.painter = news.state;
    if (news.brush_goes_on) state_.board.carried = *news.brush_goes_on ? Carried::taken_up : Carried::nothing;
    const std::string name = title_of(painter_->file());
    move_annotations();
    if (name != state_.title) {  // it was saved under another
        state_.title = name;
        glfwSetWindowTitle(window_.handle(), fmt::format("{} - TangiPaint", name).c_str());
    }
    changed_.insert(changed_.end(), news.changed.begin(), news.changed.end());
    take_board(std::move(news.board));
    upload_changed();
    if (news.horizon) {
        renderer_.set_horizon(*news.horizon);
        dirty_ = true;
    }
    upload_damage_map();
    take_answers(news);
    for (const std::string& message : news.messages) say(message);
    if (news.needs_name && !dialog_) state_.ask.save_dialog = true;
    if (horizon_due_s_ > 0 && now_s_ >= horizon_due_s_ && !hand_->holds() && changed_.empty()) {
        horizon_due_s_ = 0;
        painter_->make_horizon();
    }
}

void WindowApp::snapshot() {
    const Shot shot = placement().shot(1, true);
    const gl::Target target(shot.width, shot.height, false);
    renderer_.fetch(scene_of(state_, placement()), shot);
    renderer_.draw(scene_of(state_, placement()), shot, target.framebuffer());
    std::filesystem::path path = painter_->file();
    for (int i = 1;; ++i) {
        path.replace_filename(fmt::format("{}-{}.png", painter_->file().stem().string(), i));
        if (!std::filesystem::exists(path)) break;
    }
    try {
        write_picture_8bit(path, renderer_.read(target));
        say("wrote " + path.filename().string());
    } catch (const Error& error) {
        say(error.what());
    }
}

// This view, while the light goes once round.
void WindowApp::begin_film(const std::filesystem::path& out) {
    constexpr double kFilm_s = 8, kPictures_per_s = 25;
    const Placement place = placement();
    film_shot_ = place.shot(1, true);
    film_scenes_.clear();
    Angles& light = state_.lights[state_.light].angles;
    const Angles before = light;
    for (const Angles& at : sweep_path({before}, static_cast<int>(kFilm_s * kPictures_per_s))) {
        light = at;
        film_scenes_.push_back(scene_of(state_, place));
    }
    light = before;
    film_name_ = out.filename().string();
    recorder_ = std::make_unique<Recorder>(out, kPictures_per_s, static_cast<int>(film_scenes_.size()),
                                           [] { glfwPostEmptyEvent(); });
}

// One picture of the film a frame, so that looking goes on.
void WindowApp::film() {
    if (!recorder_) return;
    const Job::State job = recorder_->state();
    state_.film = job;
    settle_ = std::max(settle_, 1);
    if (job.over) {
        say(!job.error.empty() ? job.error
            : job.cancelled    ? "stopped: no film was written"
                               : "wrote " + film_name_);
        recorder_.reset();
        state_.film.reset();
        return;
    }
    const int next = recorder_->next();
    if (next < 0) return;
    const gl::Target target(film_shot_.width, film_shot_.height, false);
    const Scene& scene = film_scenes_[static_cast<std::size_t>(next)];
    renderer_.fetch(scene, film_shot_);
    renderer_.draw(scene, film_shot_, target.framebuffer());
    recorder_->add(renderer_.read(target));
}

void WindowApp::keep_keys() {
    if (settings_.empty()) return;
    try {
        if (const std::string told = keys_file_.make_way(); !told.empty()) say(told);
        state_.keys.write(keys_file_.path());
        keys_file_.is_written();
    } catch (const std::exception& error) {
        say(message_of(error));  // they hold until the window closes
    }
}

// What the file system says of a place (a name too long, a folder that cannot be looked into) is no reason to
// end.
void WindowApp::requests() {
    try {
        do_requests(std::exchange(state_.ask, {}));
    } catch (const std::filesystem::filesystem_error& error) {
        say(message_of(error));
    }
}

// How the painting is seen.
void WindowApp::view_requests(const ViewRequests& ask) {
    if (ask.fit) state_.view = fitted(state_.painting, pane(state_, screen_), state_.view.turn_deg);
    if (ask.one_to_one) state_.view.zoom = 1;
    if (ask.straighten) {
        state_.tilt = sent_back(state_.tilt);
        state_.view = turned(state_.view, -state_.view.turn_deg);
    }
}

// What is done to the painting; nothing while another than it is seen, or while it cannot be painted on.
void WindowApp::paint_requests(const PaintRequests& ask) {
    const bool other =
        state_.treatment_state.state || state_.treatment_state.preview;  // than the painting is seen
    if (state_.left_over_strokes > 0 || other || state_.finishing) return;
    // Whether there is something to undo the painter knows: what is seen of it may be a frame old.
    if (ask.undo) painter_->send(UndoEvent{});
    if (ask.redo) painter_->send(RedoEvent{});
    if (ask.dry) {
        const std::vector<std::string>& layers = state_.painter.layers;
        std::string name;
        for (std::size_t i = layers.size() + 1; name.empty() || std::ranges::count(layers, name) > 0; ++i)
            name = fmt::format("layer {}", i);
        painter_->send(DryEvent{name, 1});
    }
    if (!ask.lift.empty()) painter_->send(LiftEvent{ask.lift});
    board_requests(ask);
}

// What the last sitting left.
void WindowApp::recovery_requests(const ClosingRequests& ask) {
    if (ask.recover && left_over_ && !state_.treatment_state.no_strokes.empty()) {
        say(state_.treatment_state.no_strokes);
    } else if (ask.recover && left_over_) {
        painter_->recover(std::move(*left_over_));
        left_over_.reset();
        state_.left_over_strokes = 0;
    }
    if (ask.discard) {
        painter_->discard();
        left_over_.reset();
        state_.left_over_strokes = 0;
    }
}

// The window stays open after all.
void WindowApp::stay_open() {
    documents_->use_palette(state_.palette);  // if another one was to come with opening it again
    glfwSetWindowShouldClose(window_.handle(), GLFW_FALSE);
    close_when_saved_ = open_when_saved_ = state_.closing = false;
    state_.open_next.clear();
    state_.finishing.reset();
}

void WindowApp::closing_requests(const WindowState::Requests& ask) {
    if (ask.stay) stay_open();
    if (ask.close_now) {
        painter_->hurry(true);
        close_unsaved_ = true;
        glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
        return;
    }
    if (!state_.open_next.empty() && (ask.close || ask.close_unsaved || open_when_saved_)) {
        // Not the window is to be closed, but the painting.
        open_when_saved_ = open_when_saved_ || ask.save;
        finish_and_open();
        return;
    }
    if (ask.close && ask.save) close_when_saved_ = true;
    if (ask.close || ask.close_unsaved) glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
    if (ask.close_unsaved) close_unsaved_ = true;
}

void WindowApp::do_requests(const WindowState::Requests& ask) {
    if (comes_after_strokes(ask, state_.treatment_state.ask)) hand_->end_stroke();
    annotation_requests(ask);
    dialogs(ask);
    documents_->take(ask, *painter_);
    treatment_state_->take();
    if (!ask.open.empty()) open_when_allowed(ask.open);
    if (!ask.palette.empty()) take_palette(ask.palette);
    canvas_requests(ask);
    if (ask.usual_keys) state_.keys = {};
    if (ask.usual_keys || ask.keys_changed) keep_keys();
    view_requests(ask);
    paint_requests(ask);
    recovery_requests(ask);
    if (ask.snapshot) snapshot();
    if (!ask.film.empty()) begin_film(ask.film);
    if (ask.stop_film && recorder_) recorder_->stop();
    save(ask);
    closing_requests(ask);
}

}  // namespace tangi
