#include "viewer/hand.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <random>

namespace tangi {

namespace {

constexpr double kZoomPerNotch = 1.15, kLightStep_deg = 3, kTurn_deg = 15;

}  // namespace

Placement Hand::placement() const {
    return Placement(state_.view, state_.tilt, state_.flat, state_.painting, screen_, state_.mm_per_pixel);
}

StrokePoint Hand::point(double time_s) const {
    glm::dvec2 at(0);
    placement().to_painting(cursor_, at);
    StrokePoint point;
    point.time_s = std::max(0.0, time_s - stroke_began_s_);
    point.x_mm = (at.x - (state_.painting.width - 1) / 2.0) * state_.stroke_mm_per_pixel;
    point.y_mm = ((state_.painting.height - 1) / 2.0 - at.y) * state_.stroke_mm_per_pixel;
    point.pressure = state_.pressure;
    return point;
}

void Hand::take(const InputEvent& event, Extent screen, double left, bool panels_busy, bool typing) {
    screen_ = screen;
    const auto follow = [&] {
        cursor_ = event.at - glm::dvec2(left, 0);
        over_canvas_ =
            cursor_.x >= 0 && cursor_.y >= 0 && cursor_.x < screen.width && cursor_.y < screen.height;
    };
    switch (event.kind) {
        case InputEvent::Kind::move:
            follow();
            move(event);
            break;
        case InputEvent::Kind::press:
            follow();
            if (drag_ != Drag::none) break;  // a second button changes nothing
            if (!over_canvas_ || panels_busy)
                drag_ = Drag::panel;
            else
                press(event);
            button_ = event.code;
            break;
        case InputEvent::Kind::release:
            follow();
            if (event.code == button_) {
                if (drag_ == Drag::tilt)
                    state_.tilt = dragged(state_.tilt, 0, 0, event.time_s - last_time_s_);
                let_go();
            }
            break;
        case InputEvent::Kind::wheel:
            if (over_canvas_ && !panels_busy)
                state_.view = zoomed(state_.view, std::pow(kZoomPerNotch, event.at.y), cursor_, screen);
            break;
        case InputEvent::Kind::key:
            if (!typing) key(event);
            break;
    }
}

void Hand::press(const InputEvent& event) {
    last_ = cursor_;
    last_time_s_ = event.time_s;
    if (event.code == GLFW_MOUSE_BUTTON_RIGHT) {
        drag_ = Drag::tilt;
    } else if (event.code == GLFW_MOUSE_BUTTON_MIDDLE || space_) {
        drag_ = Drag::pan;
        space_ = false;
    } else {
        switch (state_.tool) {
            case Tool::tilt:
                drag_ = Drag::tilt;
                break;
            case Tool::light:
                drag_ = Drag::light;
                break;
            case Tool::pan:
                drag_ = Drag::pan;
                break;
            case Tool::paint:
                drag_ = event.mods & GLFW_MOD_SHIFT ? Drag::size : Drag::paint;
                break;
            case Tool::pick:
                break;
            case Tool::ruler:
                drag_ = Drag::ruler;
                break;
        }
    }
    glm::dvec2 at;
    const bool hit = placement().to_painting(cursor_, at);
    const bool picks = event.code == GLFW_MOUSE_BUTTON_LEFT &&
                       (state_.tool == Tool::pick || (drag_ == Drag::paint && event.mods & GLFW_MOD_ALT));
    if (picks) {
        drag_ = Drag::panel;
        if (hit) painter_.pick(at.x, at.y, 2);
        return;
    }
    if (drag_ == Drag::tilt) state_.tilt = held(state_.tilt);
    if (drag_ == Drag::ruler) state_.ruler = {at, at};
    if (drag_ == Drag::light) move(event);
    if (drag_ != Drag::paint) return;
    if (!hit || state_.left_over_strokes > 0) {
        if (state_.left_over_strokes > 0)
            state_.message = "first recover or put aside the strokes of the last sitting";
        state_.message_until_s = event.time_s + 5;
        drag_ = Drag::panel;
        return;
    }
    stroke_began_s_ = event.time_s;
    seed_ = std::random_device{}();  // bristles differ from stroke to stroke; the journal has the seed
    painter_.send(state_.stroke(seed_));
    painter_.send(PointEvent{point(event.time_s)});
}

void Hand::move(const InputEvent& event) {
    const glm::dvec2 by = cursor_ - last_;
    const double seconds = event.time_s - last_time_s_;
    const double height = std::max(screen_.height, 1);
    switch (drag_) {
        case Drag::tilt:
            state_.tilt = dragged(state_.tilt, by.x / height, by.y / height, seconds);
            break;
        case Drag::pan:
            state_.view = panned(state_.view, by);
            break;
        case Drag::light: {
            const double radius = 0.5 * std::min(screen_.width, screen_.height);
            state_.sweeping = false;
            state_.lamps[state_.lamp].angles = light_at(
                {(cursor_.x - screen_.width / 2.0) / radius, (screen_.height / 2.0 - cursor_.y) / radius});
            break;
        }
        case Drag::paint:
            painter_.send(PointEvent{point(event.time_s)});
            break;
        case Drag::size:
            state_.brush.size_mm = std::clamp(state_.brush.size_mm * std::exp(by.x / 150), 0.1, 500.0);
            break;
        case Drag::ruler: {
            glm::dvec2 at;
            if (state_.ruler && placement().to_painting(cursor_, at)) state_.ruler->second = at;
            break;
        }
        case Drag::none:
        case Drag::panel: {
            glm::dvec2 at;
            if (over_canvas_ && state_.probing && placement().to_painting(cursor_, at) &&
                state_.painter.waiting < 4)
                painter_.probe(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)));
            break;
        }
    }
    last_ = cursor_;
    last_time_s_ = event.time_s;
}

void Hand::let_go() {
    if (drag_ == Drag::paint) painter_.send(EndEvent{});
    drag_ = Drag::none;
}

void Hand::control_key(int key, bool shift) {
    if (key == GLFW_KEY_Z) (shift ? state_.ask.redo : state_.ask.undo) = true;
    if (key == GLFW_KEY_Y) state_.ask.redo = true;
    if (key == GLFW_KEY_S) state_.ask.save = true;
    if (key == GLFW_KEY_Q) state_.ask.close = true;
}

void Hand::key(const InputEvent& event) {
    if (event.mods & GLFW_MOD_CONTROL) {
        control_key(event.code, event.mods & GLFW_MOD_SHIFT);
        return;
    }
    for (const ToolName& tool : kTools)
        if (event.code == tool.key) state_.tool = tool.tool;
    Angles& light = state_.lamps[state_.lamp].angles;
    switch (event.code) {
        case GLFW_KEY_ENTER:
            if (state_.closing)
                state_.ask.save = state_.ask.close = true;
            else if (state_.left_over_strokes > 0)
                state_.ask.recover = true;
            break;
        case GLFW_KEY_ESCAPE:
            state_.closing = false;
            break;
        case GLFW_KEY_F:
            state_.ask.fit = true;
            break;
        case GLFW_KEY_1:
            state_.ask.one_to_one = true;
            break;
        case GLFW_KEY_R:
            state_.ask.straighten = true;
            break;
        case GLFW_KEY_D:
            state_.ask.dry = true;
            break;
        case GLFW_KEY_S:
            state_.shadows = !state_.shadows;
            break;
        case GLFW_KEY_O:
            state_.loupe = !state_.loupe;
            break;
        case GLFW_KEY_F1:
            state_.help = !state_.help;
            break;
        case GLFW_KEY_F12:
            state_.ask.snapshot = true;
            break;
        case GLFW_KEY_TAB:
            panels_ = !panels_;
            break;
        case GLFW_KEY_SPACE:
            space_ = true;
            break;
        case GLFW_KEY_COMMA:
            state_.view = turned(state_.view, kTurn_deg);
            break;
        case GLFW_KEY_PERIOD:
            state_.view = turned(state_.view, -kTurn_deg);
            break;
        case GLFW_KEY_LEFT_BRACKET:
            state_.brush.size_mm = std::max(state_.brush.size_mm / 1.15, 0.1);
            break;
        case GLFW_KEY_RIGHT_BRACKET:
            state_.brush.size_mm = std::min(state_.brush.size_mm * 1.15, 500.0);
            break;
        case GLFW_KEY_LEFT:
            light.azimuth_deg = std::remainder(light.azimuth_deg + kLightStep_deg, 360.0);
            break;
        case GLFW_KEY_RIGHT:
            light.azimuth_deg = std::remainder(light.azimuth_deg - kLightStep_deg, 360.0);
            break;
        case GLFW_KEY_UP:
            light.elevation_deg = std::min(light.elevation_deg + kLightStep_deg, 90.0);
            break;
        case GLFW_KEY_DOWN:
            light.elevation_deg = std::max(light.elevation_deg - kLightStep_deg, 2.0);
            break;
        default:
            break;
    }
}

}  // namespace tangi
