// annotation_state.h: the annotations of the painting in the window, as its panel and its pen show and change
// them. No OpenGL.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "viewer/annotations/annotation_list.h"

namespace tangi {

// A shape that is being drawn.
struct AnnotationDraft {
    AnnotationKind kind = AnnotationKind::point;
    std::vector<glm::dvec2> points;  // [pixels of the painting]
    bool held = false;               // the last one follows the pointer
};

// What hand and panel do to annotations; in the order in which they do it.
struct AnnotationAct {
    enum class Kind { place, reshape, choose, text };
    Kind kind = Kind::choose;
    std::string id{};         // of which; empty: choose none
    AnnotationShape shape{};  // that is placed, or its new one
    std::string text{};
    bool goes_on = false;  // with what the last one did
};

struct AnnotationState {
    // The field has the keyboard two frames after it asked for it, or after the pointer let go; it is known a
    // frame later that keys are text.
    static constexpr int kFramesToType = 12, kFramesToKnow = 2;

    Annotations items;
    std::string chosen;                           // id; empty: none
    AnnotationKind kind = AnnotationKind::point;  // that is drawn
    bool shown = true;                            // over the painting
    bool can_undo = false, can_redo = false, unsaved = false;
    std::string file;     // that they are saved to
    std::string refused;  // why none may be changed now; empty where they may
    std::string typed;    // in the field
    bool typing = false;  // there, since it got the keyboard
    int until_typed = 0;  // frames until the field has it, where it was asked for
    std::string scrolled_to;
    std::optional<AnnotationDraft> draft;
    std::optional<glm::dvec2> cross;  // [pixels of the painting] that keys move, in the place of a pointer
    std::vector<AnnotationAct> acts;  // since they were taken

    void choose(const std::string& id) { acts.push_back({AnnotationAct::Kind::choose, id}); }
};

struct AnnotationRequests {
    bool undo_annotation = false, redo_annotation = false, remove_annotation = false;
    bool keep_view = false, write_text = false;
    int step_annotation = 0;  // to the next one, or the one before
    bool load_annotations_dialog = false, copy_annotations_dialog = false;
    std::filesystem::path load_annotations, copy_annotations;

    friend bool operator==(const AnnotationRequests&, const AnnotationRequests&) = default;
};

}  // namespace tangi
