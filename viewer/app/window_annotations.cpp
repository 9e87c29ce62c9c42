// window_annotations.cpp: of the window: the annotations of the painting, and their files.
#include <fmt/format.h>

#include <algorithm>

#include "surface/file/error_message.h"
#include "surface/painting_file/painting_tiles.h"
#include "viewer/app/window_app.h"
#include "viewer/model/view_words.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kKept_s = 1;  // as often as the journal of strokes, changes are put on the disk

// "One annotation", "3 annotations".
std::string counted(std::size_t count) {
    return count == 1 ? "one annotation" : fmt::format("{} annotations", count);
}

}  // namespace

void WindowApp::open_annotations() {
    AnnotationState fresh;
    fresh.kind = state_.annotations.kind;
    fresh.shown = state_.annotations.shown;
    state_.annotations = std::move(fresh);
    annotations_ = AnnotationDocument(annotated_, {"", state_.painting.width, state_.painting.height},
                                      state_.painter.elsewhere);
    annotation_source_ = {};
    know_annotations();
}

// An IRI of the painting: the hash of its file, which is computed when the first annotation is drawn.
std::string WindowApp::annotation_source() {
    if (!annotation_source_.valid())
        annotation_source_ = std::async(std::launch::async, [file = annotated_] {
                                 std::error_code unknown;
                                 if (!fs::exists(file, unknown)) return std::string("urn:tangipaint:new");
                                 return "urn:tangipaint:" + sha256_of_painting(file);
                             }).share();
    return annotation_source_.get();
}

// What of them the panels show.
void WindowApp::know_annotations() {
    AnnotationState& a = state_.annotations;
    const AnnotationList& list = annotations_.list();
    for (const std::string& text : annotations_.said()) say(text);
    if (a.items != list.now()) settle_ = kFramesAfterwards;
    a.items = list.now();
    a.can_undo = list.can_undo();
    a.can_redo = list.can_redo();
    a.unsaved = list.unsaved() && !annotations_.only_looks();
    a.file = annotations_.files().saved.filename().string();
    a.refused = annotations_.only_looks()
                    ? "It is open in another window: annotate there, or save it under another name here"
                    : "";
    const auto chosen = annotation_in(a.items, a.chosen);
    if (!chosen) a.chosen.clear();
    if (!a.typing) a.typed = chosen ? chosen->text : "";
}

// In its light, its view and its look.
void WindowApp::choose_annotation(const std::string& id) {
    AnnotationState& a = state_.annotations;
    const auto chosen = annotation_in(a.items, id);
    a.chosen = chosen ? id : "";
    a.typing = false;
    if (!chosen || chosen->view.empty()) return;
    if (state_.comparing.pair)
        state_.treatment_state.ask.stop_comparing = true;
    else
        state_.comparing.on = false;
    follow_view_words(state_, chosen->view);
}

// The next keys write its text.
void WindowApp::write_annotation() {
    AnnotationState& a = state_.annotations;
    if (a.chosen.empty() || !a.refused.empty()) return;
    a.until_typed = AnnotationState::kFramesToType;
    a.typing = false;
    state_.treatment_state.in_front = false;
    hand_->show_panels();
    settle_ = kFramesAfterwards;
}

void WindowApp::take_annotation(const AnnotationAct& act) {
    AnnotationState& a = state_.annotations;
    AnnotationList& list = annotations_.list();
    using Kind = AnnotationAct::Kind;
    if (act.kind == Kind::choose) {
        choose_annotation(act.id);
    } else if (!a.refused.empty()) {
        say(a.refused);
    } else if (act.kind == Kind::place) {
        try {
            list.set_source(annotation_source());
        } catch (const std::exception& error) {
            say(message_of(error));  // it can be annotated all the same
        }
        a.chosen = list.add(act.shape, view_words(state_));
        a.shown = true;
        write_annotation();
    } else if (act.kind == Kind::reshape) {
        list.reshape(act.id, act.shape, act.goes_on);
    } else {
        list.set_text(act.id, act.text, act.goes_on);
    }
    know_annotations();
}

void WindowApp::take_annotations() {
    for (const AnnotationAct& act : std::exchange(state_.annotations.acts, {})) take_annotation(act);
}

void WindowApp::step_annotation(int by) {
    const Annotations& items = state_.annotations.items;
    if (items.empty()) return;
    const auto count = static_cast<std::ptrdiff_t>(items.size());
    const auto at =
        std::ranges::find_if(items, [&](const auto& one) { return one->id == state_.annotations.chosen; }) -
        items.begin();
    const std::ptrdiff_t next = at == count ? (by > 0 ? 0 : count - 1) : (at + by + count) % count;
    choose_annotation(items[static_cast<std::size_t>(next)]->id);
}

// What is done to the list.
void WindowApp::change_annotations(const AnnotationRequests& ask) {
    AnnotationState& a = state_.annotations;
    AnnotationList& list = annotations_.list();
    const bool changes = ask.undo_annotation || ask.redo_annotation || ask.remove_annotation || ask.keep_view;
    if (changes && !a.refused.empty()) {
        say(a.refused);
        return;
    }
    if (changes) a.typing = false;
    if (ask.undo_annotation) list.undo();
    if (ask.redo_annotation) list.redo();
    if (ask.remove_annotation) list.remove(a.chosen);
    if (ask.keep_view && !a.chosen.empty()) {
        list.set_view(a.chosen, view_words(state_));
        say("the annotation keeps light, view and look as they are now");
    }
}

void WindowApp::annotation_file_requests(const AnnotationRequests& ask) {
    try {
        if (!ask.load_annotations.empty()) {
            if (!state_.annotations.refused.empty()) {
                say(state_.annotations.refused);
                return;
            }
            const auto [count, beyond] = annotations_.load(ask.load_annotations);
            say(fmt::format("loaded {}{}", counted(count),
                            beyond == 0 ? ""
                                        : fmt::format("; {} of them reach beyond this painting: they may be "
                                                      "of another one",
                                                      beyond)));
        }
        if (!ask.copy_annotations.empty()) {
            annotations_.write_to(ask.copy_annotations);
            say(fmt::format("wrote {} to {}", counted(state_.annotations.items.size()),
                            ask.copy_annotations.filename().string()));
        }
    } catch (const std::exception& error) {
        say(message_of(error));
    }
}

void WindowApp::annotation_requests(const AnnotationRequests& ask) {
    take_annotations();
    change_annotations(ask);
    annotation_file_requests(ask);
    know_annotations();
    if (ask.step_annotation != 0) step_annotation(ask.step_annotation);
    if (ask.write_text) write_annotation();
    know_annotations();
}

// True where they were saved, so that there may be nothing else to be.
bool WindowApp::save_annotations() {
    if (!state_.annotations.unsaved) return false;
    try {
        annotations_.save();
        say(fmt::format("saved {} as {}", counted(state_.annotations.items.size()),
                        annotations_.files().saved.filename().string()));
    } catch (const std::exception& error) {
        say(message_of(error));
    }
    know_annotations();
    return !state_.annotations.unsaved;
}

// The painting has another name: they go with it.
void WindowApp::move_annotations() {
    if (annotated_ == painter_->file()) return;
    annotated_ = painter_->file();
    annotation_source_ = {};
    try {
        annotations_.save_beside(annotated_);
    } catch (const std::exception& error) {
        say(message_of(error));
    }
    know_annotations();
}

// On the disk, so that they survive a crash; where that fails, it is said once.
void WindowApp::keep_annotations(bool at_once) {
    if (!at_once && now_s_ - annotations_kept_s_ < kKept_s) return;
    annotations_kept_s_ = now_s_;
    try {
        annotations_.keep();
        not_kept_.clear();
    } catch (const std::exception& error) {
        if (std::exchange(not_kept_, message_of(error)) != not_kept_) say(not_kept_);
    }
}

}  // namespace tangi
