#include "viewer/annotations/annotation_pen.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tangi {

namespace {

using Kind = AnnotationKind;

// [pixels of the screen] From a point: what hits a mark (its disc), a corner that is dragged, and what
// closes a polygon; a line that is no longer is one click; and steps of an arrow key.
constexpr double kMark_px = 12, kPoint_px = 8, kClose_px = 10, kShortest_px = 5, kStep_px = 10;

// On the painting, whose pixels end half a pixel from their centres.
glm::dvec2 within(const glm::dvec2& at, Extent painting) {
    return glm::clamp(at, glm::dvec2(-0.5), glm::dvec2(painting.width - 0.5, painting.height - 0.5));
}

double apart(const Placement& placement, const glm::dvec2& a, const glm::dvec2& b) {
    return glm::length(placement.to_screen(a) - placement.to_screen(b));
}

// At its first or its last corner.
bool closes(const AnnotationDraft& draft, const Placement& placement, const glm::dvec2& at,
            double within_px) {
    return draft.kind == Kind::polygon && draft.points.size() >= 3 &&
           (apart(placement, draft.points.front(), at) < within_px ||
            apart(placement, draft.points.back(), at) < within_px);
}

glm::dvec2 arrow_of(int code) {
    switch (code) {
        case GLFW_KEY_LEFT:
            return {-1, 0};
        case GLFW_KEY_RIGHT:
            return {1, 0};
        case GLFW_KEY_UP:
            return {0, -1};
        case GLFW_KEY_DOWN:
            return {0, 1};
        default:
            return {0, 0};
    }
}

}  // namespace

// A point of the chosen one, or the mark of any.
bool AnnotationPen::take_hold(const Screen& screen, const glm::dvec2& cursor) {
    if (!state_.shown) return false;
    const auto is_near = [&](const glm::dvec2& p, double px) {
        return glm::length(screen.placement.to_screen(p) - cursor) < px * screen.scale;
    };
    if (const auto chosen = annotation_in(state_.items, state_.chosen); chosen && state_.refused.empty())
        for (std::size_t r = 0; r < chosen->shape.rings.size(); ++r)
            for (std::size_t i = 0; i < chosen->shape.rings[r].size(); ++i)
                if (is_near(chosen->shape.rings[r][i], kPoint_px)) {
                    moved_ = {r, i};
                    goes_on_ = false;
                    return true;
                }
    for (auto item = state_.items.rbegin(); item != state_.items.rend(); ++item)  // the last lies above
        if (is_near((*item)->shape.rings.front().front(), kMark_px)) {
            state_.choose((*item)->id);
            return true;
        }
    return false;
}

void AnnotationPen::press(const Screen& screen, const glm::dvec2& cursor, const glm::dvec2& at) {
    state_.cross.reset();
    moved_.reset();
    if (state_.draft && state_.draft->kind != state_.kind) state_.draft.reset();
    if (!state_.draft && take_hold(screen, cursor)) return;
    const glm::dvec2 place = within(at, screen.painting);
    if (!state_.refused.empty()) {
        refuse(place);
    } else if (!state_.draft) {
        state_.draft = {state_.kind, {place}, true};
        if (state_.kind == Kind::line) state_.draft->points.push_back(place);
    } else if (closes(*state_.draft, screen.placement, place, kClose_px * screen.scale)) {
        complete();
    } else {
        state_.draft->points.push_back(place);
        state_.draft->held = true;
    }
}

void AnnotationPen::drag(const Screen& screen, const glm::dvec2& at) {
    const glm::dvec2 place = within(at, screen.painting);
    if (state_.draft && state_.draft->held) state_.draft->points.back() = place;
    const auto chosen = annotation_in(state_.items, state_.chosen);
    if (!moved_ || !chosen) return;
    AnnotationShape shape = chosen->shape;
    const auto [ring, i] = *moved_;
    if (ring >= shape.rings.size() || i >= shape.rings[ring].size()) return;  // undone meanwhile
    shape.rings[ring][i] = place;
    state_.acts.push_back({AnnotationAct::Kind::reshape, chosen->id, shape, {}, goes_on_});
    goes_on_ = true;
}

void AnnotationPen::release(const Screen& screen) {
    moved_.reset();
    if (!state_.draft || !state_.draft->held) return;
    AnnotationDraft& draft = *state_.draft;
    draft.held = false;
    if (draft.kind == Kind::point || draft.kind == Kind::text) {
        complete();
    } else if (draft.kind == Kind::line) {
        if (apart(screen.placement, draft.points[0], draft.points[1]) > kShortest_px * screen.scale)
            complete();
        else
            draft.points.resize(1);  // its end is where the next click is
    }
}

bool AnnotationPen::step_back() {
    if (!state_.draft) return false;
    state_.draft->held = false;
    if (state_.draft->points.size() > 1 && state_.draft->kind == Kind::polygon)
        state_.draft->points.pop_back();
    else
        state_.draft.reset();
    return true;
}

// Who takes it says why it cannot be.
void AnnotationPen::refuse(const glm::dvec2& at) {
    state_.acts.push_back({AnnotationAct::Kind::place, {}, AnnotationShape{state_.kind, {{at}}}});
}

void AnnotationPen::complete() {
    AnnotationDraft draft = std::move(*state_.draft);
    state_.draft.reset();
    state_.acts.push_back(
        {AnnotationAct::Kind::place, {}, AnnotationShape{draft.kind, {std::move(draft.points)}}});
}

// Where it begins: what is in the middle of the screen.
glm::dvec2 AnnotationPen::cross(const Screen& screen) const {
    if (state_.cross) return *state_.cross;
    glm::dvec2 at(0);
    screen.placement.to_painting(0.5 * glm::dvec2(screen.size.width, screen.size.height), at);
    return within(at, screen.painting);
}

void AnnotationPen::move_cross(const glm::dvec2& by, const Screen& screen, View& view) {
    const glm::dvec2 from = cross(screen);
    glm::dvec2 to = from;
    screen.placement.to_painting(screen.placement.to_screen(from) + by, to);
    state_.cross = within(to, screen.painting);
    const glm::dvec2 seen = screen.placement.to_screen(*state_.cross);
    if (seen.x < 0 || seen.y < 0 || seen.x > screen.size.width || seen.y > screen.size.height)
        view.centre_px = *state_.cross;
}

void AnnotationPen::place(const Screen& screen) {
    const glm::dvec2 at = cross(screen);
    state_.cross = at;
    if (!state_.refused.empty()) {
        refuse(at);
        return;
    }
    if (state_.draft && state_.draft->kind != state_.kind) state_.draft.reset();
    if (state_.draft && closes(*state_.draft, screen.placement, at, kStep_px / 2)) {
        complete();
        return;
    }
    if (!state_.draft) state_.draft = {state_.kind, {}, false};
    state_.draft->points.push_back(at);
    const std::size_t wanted = state_.kind == Kind::polygon ? 0 : state_.kind == Kind::line ? 2 : 1;
    if (state_.draft->points.size() == wanted) complete();
}

bool AnnotationPen::key(int code, int mods, const Screen& screen, View& view) {
    const bool shift = mods == GLFW_MOD_SHIFT;
    if (mods != 0 && !shift) return false;
    if (const glm::dvec2 arrow = arrow_of(code); arrow != glm::dvec2(0)) {
        move_cross(arrow * (shift ? 1.0 : kStep_px * screen.scale), screen, view);
        return true;
    }
    if (shift) return false;
    if (code == GLFW_KEY_ENTER || code == GLFW_KEY_KP_ENTER) {
        place(screen);
    } else if (code == GLFW_KEY_ESCAPE && (state_.draft || state_.cross || !state_.chosen.empty())) {
        if (!state_.draft && !state_.cross) state_.choose({});
        state_.draft.reset();
        state_.cross.reset();
    } else {
        return code == GLFW_KEY_BACKSPACE && step_back();
    }
    return true;
}

}  // namespace tangi
