// annotation_pen.h: drawing points, lines, polygons and texts on the painting, by hand or by keys, as
// viewer/web/page/mark_pen.js does it; choosing what was drawn, and moving its points. No OpenGL.
#pragma once

#include <utility>

#include "viewer/annotations/annotation_state.h"
#include "viewer/render/view.h"

namespace tangi {

class AnnotationPen {
public:
    explicit AnnotationPen(AnnotationState& state) : state_(state) {}

    // Where the painting lies on the screen; `scale` of the marks (PanelState::scale).
    struct Screen {
        Placement placement;
        Extent painting, size;
        double scale = 1;
    };
    // `cursor` [pixels of the screen], over `at` of the painting.
    void press(const Screen& screen, const glm::dvec2& cursor, const glm::dvec2& at);
    void drag(const Screen& screen, const glm::dvec2& at);
    void release(const Screen& screen);
    // The last point of what is being drawn was not meant; false where nothing is.
    bool step_back();

    // A key, as GLFW numbers it: arrows move a crosshair, Enter places a point there, Escape gives up what is
    // drawn, Backspace its last point. True where it was one. The view follows the crosshair.
    bool key(int code, int mods, const Screen& screen, View& view);

private:
    void complete();
    void refuse(const glm::dvec2& at);
    void place(const Screen& screen);
    void move_cross(const glm::dvec2& by, const Screen& screen, View& view);
    glm::dvec2 cross(const Screen& screen) const;
    bool take_hold(const Screen& screen, const glm::dvec2& cursor);

    AnnotationState& state_;
    // The point of the chosen one that is dragged: of which ring, and which of it.
    std::optional<std::pair<std::size_t, std::size_t>> moved_;
    bool goes_on_ = false;
};

}  // namespace tangi
