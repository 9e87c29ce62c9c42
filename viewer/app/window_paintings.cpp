// window_paintings.cpp: of the window: which painting is shown: opened, dropped on it, or a new canvas.
#include <GLFW/glfw3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "surface/base/error.h"
#include "surface/file/error_message.h"
#include "viewer/app/window_app.h"
#include "viewer/dialogs/file_ending.h"
#include "viewer/model/user_settings.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::size_t memory_bytes() {
    return static_cast<std::size_t>(::sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::size_t>(::sysconf(_SC_PAGE_SIZE));
}

}  // namespace

// Where strokes are not saved, asks first.
void WindowApp::open_when_allowed(const fs::path& file) {
    // Those of another painting stay where they are: it may be that one which is opened.
    const bool asks = state_.left_over_strokes > 0 && !state_.left_over_of_another;
    if (state_.unsaved() || asks) {
        if (asks)
            say("first recover or discard the strokes that were not saved");
        else
            state_.closing = true;
        state_.open_next = state_.closing ? file : fs::path();
        return;
    }
    documents_->open(file);
}

void WindowApp::take_dropped() {
    for (const fs::path& path : input_.take_dropped()) {
        std::error_code gone;
        if (fs::is_regular_file(path / "log.jsonl", gone))
            open_when_allowed(path / "painting.exr");  // a treatment
        else if (fs::is_directory(path, gone))
            state_.dropped = path;
        else if (is_picture(path))
            choose_canvas(path);
        else
            open_when_allowed(path);
    }
}

// The painter knows its paints from the start: the painting is opened again with others.
void WindowApp::take_palette(const fs::path& file) {
    if (!fs::exists(painter_->file())) {
        say("save the painting first: another paint box comes with opening it again");
        return;
    }
    if (state_.left_over_strokes > 0) {
        say("first recover or discard the strokes that were not saved: they are of the paints that there "
            "are");
        return;
    }
    try {
        Palette palette = read_palette(file);
        if (palette.paints.empty()) fail("{}: there are no paints in it", file.string());
        documents_->use_palette(std::move(palette));
    } catch (const Error& error) {
        say(error.what());
        return;
    }
    open_when_allowed(painter_->file());
}

// Another painting, once this one is saved, where that was asked for.
void WindowApp::finish_and_open() {
    if (open_when_saved_) {
        treatment_state_->keep_now();
        if (!painted_all()) return;
        open_when_saved_ = false;
        if (state_.unsaved()) return;  // it could not be saved: the message says why
    }
    state_.closing = false;
    documents_->open(std::exchange(state_.open_next, {}));
}

// The panel as it begins: beside the painting that is open.
void WindowApp::choose_canvas(const fs::path& ground) {
    NewCanvas& n = state_.new_canvas;
    n.open = true;
    n.folder = fs::absolute(painter_->file()).parent_path();
    if (state_.treatment_state.on) n.folder = n.folder.parent_path();  // a treatment's folder is its own
    n.name = untitled(n.folder).filename().string();
    n.complaint.clear();
    n.choice.keep_as.clear();
    if (preview_) preview_->again();
    if (!ground.empty()) n.choice.which = n.picture = ground.string();
    try {
        n.kept = kept_substrates(substrate_shelf());
    } catch (const Error&) {
        n.kept.clear();  // there is no home
    }
    settle_ = kFramesAfterwards;
}

// While it is chosen: the preview under the light as it stands.
void WindowApp::preview_canvas() {
    NewCanvas& n = state_.new_canvas;
    if (!n.open) return;
    if (!preview_) preview_ = std::make_unique<SubstratePreview>([] { glfwPostEmptyEvent(); });
    const Angles& light = state_.lights[state_.light].angles;
    preview_->want(n.choice, direction_of(light.azimuth_deg, light.elevation_deg));
    std::optional<SubstratePreview::Seen> seen = preview_->fetch();
    if (!seen) return;
    n.complaint = seen->complaint;
    n.size = seen->size;
    n.preview = {seen->picture.width(), seen->picture.height()};
    preview_texture_.clear();
    if (!seen->picture.empty()) preview_texture_.update(seen->picture, seen->picture.region());
    n.texture = preview_texture_.id();
    settle_ = kFramesAfterwards;
}

// Why a canvas of this name, size and ground cannot be begun now; empty where it can.
std::string WindowApp::against_canvas(const fs::path& file) const {
    const NewCanvas& n = state_.new_canvas;
    std::error_code unknown;
    if (fs::exists(file, unknown))
        return fmt::format("{} is there already: choose another name", file.filename().string());
    if (const double gb = 1e-9 * n.bytes(), most = 1e-9 * static_cast<double>(memory_bytes()); gb > most)
        return fmt::format(
            "it would take {:.0f} GB to paint on, and this machine has {:.0f}: larger pixels, or a smaller "
            "canvas",
            gb, most);
    if (state_.job) return fmt::format("first stop, or wait for: {}", state_.job_title);
    if (n.choice.keep_as.empty()) return {};
    try {
        if (fs::exists(kept_substrate(substrate_shelf(), n.choice.keep_as)))
            return fmt::format("a ground is kept as '{}' already: choose another name", n.choice.keep_as);
    } catch (const std::exception& error) {
        return message_of(error);
    }
    return {};
}

void WindowApp::begin_canvas() {
    NewCanvas& n = state_.new_canvas;
    const bool is_path = n.name.find('/') != std::string::npos || n.name == "~";
    const auto [file, complaint] = is_path ? NamedFile{{}, "the file needs a name, without '/'"}
                                           : with_ending(typed_path(n.folder, n.name), ".exr");
    n.complaint = file.empty() ? complaint : against_canvas(file);
    if (!n.complaint.empty()) return;
    n.open = false;
    documents_->make(file, n.choice);
    open_when_allowed(file);
}

void WindowApp::canvas_requests(const OpeningRequests& ask) {
    if (ask.new_canvas) choose_canvas({});
    NewCanvas& n = state_.new_canvas;
    if (!ask.substrate.empty()) {
        n.choice.which = n.picture = ask.substrate.string();
        n.size = {};
    }
    if (!ask.height_from.empty()) n.choice.height_from = ask.height_from.string();
    if (ask.begin_canvas) begin_canvas();
}

// True where the painter has done what was sent, and what became of it is known; else the panels say how far
// it is, and it is to be asked again.
bool WindowApp::painted_all() {
    const bool done = painter_->idle();
    news();
    const std::size_t left = state_.painter.waiting;
    if (done)
        state_.finishing.reset();
    else
        state_.finishing = {std::max(state_.finishing ? state_.finishing->all : 0, left + 1), left};
    if (!done && now_s_ - progress_s_ > kProgress_s) {
        settle_ = std::max(settle_, 1);
        progress_s_ = now_s_;
    }
    return done;
}

// Nothing was painted since it was saved, whatever of that has come here yet.
bool WindowApp::painted_is_saved() {
    const bool done = painter_->idle();
    news();
    return done && !state_.painter.unsaved;
}

// What to do about a window that is to be closed: true where it may.
bool WindowApp::closing() {
    if (!glfwWindowShouldClose(window_.handle())) return false;
    hand_->let_go();  // in mid-stroke: the stroke ends here
    take_annotations();
    if (close_unsaved_) return true;
    if (close_when_saved_) treatment_state_->keep_now();
    if (close_when_saved_ || !state_.closing) {
        if (!painted_all()) return false;
        close_when_saved_ = false;
    }
    const bool writes = documents_->writes() || recorder_;
    if (!state_.unsaved() && !writes) return true;
    state_.closing = true;  // asks
    glfwSetWindowShouldClose(window_.handle(), GLFW_FALSE);
    settle_ = kFramesAfterwards;
    return false;
}

}  // namespace tangi
