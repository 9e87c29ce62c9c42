// input_controller.h: what mouse and keys do to the window's state and to the painting. No OpenGL.
#pragma once

#include <cstdint>

#include "viewer/annotations/annotation_pen.h"
#include "viewer/devices/input.h"
#include "viewer/model/window_state.h"

namespace tangi {

// With it a click picks paint up, or takes damage away: Ctrl, or Alt where the window manager leaves that.
inline constexpr int kAnotherWay = 0x0002 | 0x0004;  // GLFW_MOD_CONTROL, GLFW_MOD_ALT

class InputController {
public:
    InputController(WindowState& state, Painter& painter)
        : state_(state), painter_(painter), annotator_(state.annotations) {}

    // One event. `left`: where the canvas area begins [pixels of the window]; `panels_busy`: the panels take
    // it.
    void take(const InputEvent& event, Extent screen, double left, bool panels_busy, bool typing);
    // Once a frame: asks what lies under the pointer where that is another pixel than the last, or the
    // painting has `changed`.
    void probe(bool changed);
    // The button is up, whatever the window system said: it lost the pointer, or closes.
    void let_go();
    // The same, where what is held paints or draws: something else comes that has to find it done.
    void end_stroke();
    void put_ruler_away();
    void show_panels() { panels_ = true; }

    const glm::dvec2& cursor() const { return cursor_; }  // [pixels of the canvas area]
    bool over_canvas() const { return over_canvas_; }
    bool holds() const { return drag_ != Drag::none; }
    // Where something is asked in them, too.
    bool panels_wanted() const {
        return panels_ || state_.closing || state_.finishing || state_.left_over_strokes > 0;
    }

private:
    enum class Drag {
        none,
        tilt,
        light,
        pan,
        paint,
        size,
        ruler,
        region,
        annotation,
        divider,
        board,
        mask,
        panel
    };

    void follow(const InputEvent& event, double left);
    void press(const InputEvent& event);
    void press_somewhere(const InputEvent& event, bool panels_busy);
    void release(const InputEvent& event);
    void move(const InputEvent& event);
    void move_light();
    void move_on_painting(const InputEvent& event);
    void stretch_region(const glm::dvec2& at);
    void key(const InputEvent& event);
    void rebind(const InputEvent& event);
    void gesture(const InputEvent& event);
    void painting_act(Action action);
    void window_act(Action action);
    void file_act(Action action);
    void resize_brush(bool larger);
    bool is_idle(Action action, double time_s);
    void look_act(Action action);
    Drag drag_for(const InputEvent& event) const;
    bool begin_stroke(const InputEvent& event, const glm::dvec2* at);
    bool brush_may_reach(const StrokePoint& from, const StrokePoint& to) const;
    void add_to_stroke(const StrokePoint& point);
    void press_on_mask(const InputEvent& event, const glm::dvec2& at);
    bool mask_key(const InputEvent& event);
    void close_polygon(bool erase);
    bool annotation_key(const InputEvent& event);
    void annotation_act(Action action);
    AnnotationPen::Screen annotated() const;
    void treatment_act(Action action);
    void next_stage();
    Placement placement() const;
    StrokePoint point(const glm::dvec2& at, double time_s) const;
    void hold(StrokePoint& point, double turn_deg) const;
    bool draws() const { return drag_ == Drag::paint || drag_ == Drag::board || drag_ == Drag::mask; }
    StrokePoint board_point(const InputEvent& event) const;
    void begin_board_stroke(const InputEvent& event);

    WindowState& state_;
    Painter& painter_;
    AnnotationPen annotator_;
    Extent screen_;
    glm::dvec2 cursor_{0}, last_{0};
    bool over_canvas_ = false, panels_ = true, space_ = false;
    Drag drag_ = Drag::none;
    int button_ = 0;
    InputEvent::Source source_ = InputEvent::Source::mouse;  // of the button that is down
    bool follows_ = false;                                   // the brush in the hand does
    std::optional<PenSample> pen_;                           // that moves the pointer
    bool mask_erases_ = false;
    std::optional<glm::ivec2> probed_;  // [pixels of the painting] that was asked for
    glm::dvec2 corner_{0};              // [pixels of the painting] where a region began
    double last_time_s_ = 0, stroke_began_s_ = 0;
    std::uint64_t seed_ = 0;
    // A stroke that has not come near the painting yet, and its points: it is none until it does.
    std::optional<StrokeEvent> beside_;
    std::vector<StrokePoint> points_beside_;
};

}  // namespace tangi
