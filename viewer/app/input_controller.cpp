#include "viewer/app/input_controller.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <random>
#include <utility>

namespace tangi {

namespace {

constexpr double kZoomPerNotch = 1.15;
constexpr double kShortestRuler_px = 2;  // [pixels of the painting] a click puts it away

}  // namespace

Placement InputController::placement() const { return placement_of(state_, screen_); }

AnnotationPen::Screen InputController::annotated() const {
    return {placement(), state_.painting, screen_, static_cast<double>(state_.scale)};
}

StrokePoint InputController::point(const glm::dvec2& at, double time_s) const {
    StrokePoint point;
    point.time_s = std::max(0.0, time_s - stroke_began_s_);
    point.x_mm = (at.x - (state_.painting.width - 1) / 2.0) * state_.stroke_mm_per_pixel;
    point.y_mm = ((state_.painting.height - 1) / 2.0 - at.y) * state_.stroke_mm_per_pixel;
    hold(point, state_.view.turn_deg);
    return point;
}

// As the hand holds it over what lies there turned by `turn_deg`, counter-clockwise: the same hand makes the
// same mark on the screen however the painting is turned. A brush that follows the stroke is turned by it.
// A mouse has a slider for the pressure, and is held straight.
void InputController::hold(StrokePoint& point, double turn_deg) const {
    point.pressure = pen_ ? pen_->pressure : static_cast<double>(state_.pressure);
    const HeldBrush held = held_over(pen_, turn_deg, follows_);
    point.tilt_x = held.tilt.x;
    point.tilt_y = held.tilt.y;
    point.rotation_deg = held.rotation_deg;
}

// [mm] from the middle of the palette.
StrokePoint InputController::board_point(const InputEvent& event) const {
    const BoardState& board = state_.board;
    const auto& [x0, y0, x1, y1] = board.rect;
    StrokePoint point;
    point.time_s = std::max(0.0, event.time_s - stroke_began_s_);
    const double mm = board.size.width * state_.stroke_mm_per_pixel / std::max(x1 - x0, 1.0f);
    point.x_mm = (event.at.x - (x0 + x1) / 2) * mm;
    point.y_mm = ((y0 + y1) / 2 - event.at.y) * mm;
    hold(point, 0);
    return point;
}

void InputController::begin_board_stroke(const InputEvent& event) {
    drag_ = Drag::panel;
    if (state_.left_over_strokes > 0 || state_.finishing || event.code != GLFW_MOUSE_BUTTON_LEFT) return;
    drag_ = Drag::board;
    stroke_began_s_ = event.time_s;
    seed_ = std::random_device{}();
    follows_ = state_.brush.follow;
    painter_.send(state_.board_stroke(seed_));
    painter_.send(PointEvent{board_point(event)});
}

void InputController::follow(const InputEvent& event, double left) {
    cursor_ = event.at - glm::dvec2(left, 0);
    pen_ = event.pen;
    state_.pen = pen_;
    over_canvas_ =
        cursor_.x >= 0 && cursor_.y >= 0 && cursor_.x < screen_.width && cursor_.y < screen_.height;
    // Beside a photograph, both halves show the same part of the painting.
    const Extent half = pane(state_, screen_);
    if (half.width < screen_.width && cursor_.x >= half.width) cursor_.x -= half.width;
}

// On the mixing palette, the panels or the canvas. A second button changes nothing.
void InputController::press_somewhere(const InputEvent& event, bool panels_busy) {
    if (drag_ != Drag::none) return;
    source_ = event.source;
    if (state_.board.has(event.at))
        begin_board_stroke(event);
    else if (!over_canvas_ || panels_busy)
        drag_ = Drag::panel;
    else
        press(event);
    button_ = event.code;
}

void InputController::release(const InputEvent& event) {
    if (event.code != button_) return;
    if (drag_ == Drag::tilt) state_.tilt = dragged(state_.tilt, 0, 0, event.time_s - last_time_s_);
    let_go();
}

void InputController::take(const InputEvent& event, Extent screen, double left, bool panels_busy,
                           bool typing) {
    screen_ = screen;
    using Kind = InputEvent::Kind;
    const bool points = event.kind == Kind::move || event.kind == Kind::press ||
                        event.kind == Kind::release || event.kind == Kind::lost;
    // What another device does meanwhile has no part in it: a mouse that is pushed, a palm.
    if (holds() && points && event.source != source_) return;
    switch (event.kind) {
        case InputEvent::Kind::move:
            follow(event, left);
            move(event);
            break;
        case InputEvent::Kind::press:
            follow(event, left);
            press_somewhere(event, panels_busy);
            break;
        case InputEvent::Kind::release:
            follow(event, left);
            release(event);
            break;
        case InputEvent::Kind::wheel:
            if (over_canvas_ && !panels_busy && !draws())  // else what is drawn would jump
                state_.view =
                    zoomed(state_.view, std::pow(kZoomPerNotch, event.at.y), cursor_, pane(state_, screen));
            break;
        case InputEvent::Kind::key:
            if (!typing) key(event);
            break;
        case InputEvent::Kind::key_up:
            if (event.code == GLFW_KEY_SPACE) space_ = false;
            break;
        case InputEvent::Kind::text:
            break;  // the panels'
        case InputEvent::Kind::gesture:
            if (drag_ == Drag::none && !panels_busy) gesture(event);
            break;
        case InputEvent::Kind::leave:
            over_canvas_ &= holds();  // what is dragged goes on outside
            break;
        case InputEvent::Kind::lost:
            let_go();
            break;
    }
}

// Two fingers: what lies under their middle stays there.
void InputController::gesture(const InputEvent& event) {
    const double left = state_.canvas_left;
    glm::dvec2 at = event.at - glm::dvec2(left, 0);
    if (at.x < 0 || at.x >= screen_.width || at.y < 0 || at.y >= screen_.height) return;
    const Extent half = pane(state_, screen_);
    if (half.width < screen_.width && at.x >= half.width) at.x -= half.width;
    state_.view = pinched(state_.view, at - event.by, at, event.factor, event.turn_deg, half);
}

InputController::Drag InputController::drag_for(const InputEvent& event) const {
    if (event.code == GLFW_MOUSE_BUTTON_MIDDLE || space_) return Drag::pan;
    const bool compares = state_.comparing.on;  // nothing tilts then, and nothing is lit or painted
    const bool wipes = state_.comparing.shows() && state_.comparing.way == CompareWay::wipe;
    const Drag otherwise = wipes ? Drag::divider : Drag::pan;
    if (event.code == GLFW_MOUSE_BUTTON_RIGHT) return compares ? otherwise : Drag::tilt;
    if (pen_ && pen_->eraser) return compares ? otherwise : Drag::paint;
    switch (state_.tool) {
        case Tool::tilt:
            return compares ? otherwise : Drag::tilt;
        case Tool::light:
            return compares ? otherwise : Drag::light;
        case Tool::paint:
            if (compares) return otherwise;
            return event.mods & GLFW_MOD_SHIFT ? Drag::size : Drag::paint;
        case Tool::pan:
            return Drag::pan;
        case Tool::damage:
            return compares ? otherwise : Drag::mask;
        case Tool::pick:
        case Tool::sample:
            return Drag::panel;
        case Tool::ruler:
            return Drag::ruler;
        case Tool::region:
            return Drag::region;
        case Tool::annotate:
            return compares ? otherwise : Drag::annotation;
    }
    return Drag::panel;
}

void InputController::press(const InputEvent& event) {
    last_ = cursor_;
    last_time_s_ = event.time_s;
    drag_ = drag_for(event);
    if (drag_ == Drag::pan) space_ = false;
    glm::dvec2 at;
    const bool hit = placement().to_painting(cursor_, at);
    const bool picks = event.code == GLFW_MOUSE_BUTTON_LEFT &&
                       (state_.tool == Tool::pick || (drag_ == Drag::paint && event.mods & kAnotherWay));
    if (picks) {
        drag_ = Drag::panel;
        if (hit) painter_.pick(at.x, at.y, 2);
        return;
    }
    if (drag_ == Drag::tilt) state_.tilt = held(state_.tilt);
    if (drag_ == Drag::ruler) {
        state_.ruler = {at, at};
        state_.profile.reset();
    }
    if (drag_ == Drag::region) {
        corner_ = at;
        state_.region.reset();
        state_.statistics.reset();
    }
    if (drag_ == Drag::light || drag_ == Drag::divider) move(event);
    if (drag_ == Drag::mask) {
        drag_ = Drag::panel;
        if (hit) press_on_mask(event, at);
    }
    if (drag_ == Drag::annotation && event.code == GLFW_MOUSE_BUTTON_LEFT && hit)
        annotator_.press(annotated(), cursor_, at);
    if (state_.tool == Tool::sample && event.code == GLFW_MOUSE_BUTTON_LEFT && hit)
        state_.treatment_state.ask.match_at = at;
    if (drag_ == Drag::paint && !begin_stroke(event, hit ? &at : nullptr)) drag_ = Drag::panel;
}

bool InputController::begin_stroke(const InputEvent& event, const glm::dvec2* at) {
    if (state_.finishing) return false;
    if (!at || state_.left_over_strokes > 0) {
        if (state_.left_over_strokes > 0)
            state_.message = "first recover or discard the strokes that were not saved";
        state_.message_until_s = event.time_s + 5;
        return false;
    }
    if (state_.painter.elsewhere) {
        state_.message = "it is open in another window: paint there, or save it under another name here";
        state_.message_until_s = event.time_s + 5;
        return false;
    }
    if (!state_.treatment_state.no_strokes.empty()) {
        state_.message = state_.treatment_state.no_strokes;
        state_.message_until_s = event.time_s + 5;
        return false;
    }
    stroke_began_s_ = event.time_s;
    seed_ = std::random_device{}();  // bristles differ from stroke to stroke; the journal has the seed
    beside_ = pen_ && pen_->eraser ? state_.erasing_stroke(seed_) : state_.stroke(seed_);
    follows_ = beside_->brush.follow;
    points_beside_.clear();
    add_to_stroke(point(*at, event.time_s));
    return true;
}

// Of the box round the two points, so that no stroke across a corner is missed. A blade as long as the brush
// is large reaches 0.71 of that on its diagonal.
bool InputController::brush_may_reach(const StrokePoint& from, const StrokePoint& to) const {
    const double reach_mm = 0.75 * beside_->brush.size_mm;
    const auto overlaps = [&](double a_mm, double b_mm, int pixels) {
        const double half_mm = 0.5 * pixels * state_.stroke_mm_per_pixel + reach_mm;
        return std::min(a_mm, b_mm) <= half_mm && std::max(a_mm, b_mm) >= -half_mm;
    };
    return overlaps(from.x_mm, to.x_mm, state_.painting.width) &&
           overlaps(from.y_mm, to.y_mm, state_.painting.height);
}

void InputController::add_to_stroke(const StrokePoint& point) {
    if (!beside_) {
        painter_.send(PointEvent{point});
        return;
    }
    const bool reaches = brush_may_reach(points_beside_.empty() ? point : points_beside_.back(), point);
    points_beside_.push_back(point);
    if (!reaches) return;
    painter_.send(*std::exchange(beside_, {}));
    for (const StrokePoint& earlier : std::exchange(points_beside_, {})) painter_.send(PointEvent{earlier});
}

void InputController::move_light() {
    const double radius = 0.5 * std::min(screen_.width, screen_.height);
    state_.sweeping = false;
    state_.lights[state_.light].angles =
        light_at({(cursor_.x - screen_.width / 2.0) / radius, (screen_.height / 2.0 - cursor_.y) / radius});
}

// From the corner where it began to `at` [pixels of the painting], both within.
void InputController::stretch_region(const glm::dvec2& at) {
    const auto pixel = [](double v, int size) {
        return std::clamp(static_cast<int>(std::floor(v + 0.5)), 0, size);
    };
    const Region region{pixel(std::min(corner_.x, at.x), state_.painting.width),
                        pixel(std::min(corner_.y, at.y), state_.painting.height),
                        pixel(std::max(corner_.x, at.x) + 1, state_.painting.width),
                        pixel(std::max(corner_.y, at.y) + 1, state_.painting.height)};
    if (!region.empty()) state_.region = region;
}

// What is dragged over the painting itself; nothing beyond the horizon of one that is tilted away.
void InputController::move_on_painting(const InputEvent& event) {
    glm::dvec2 at;
    if (!placement().to_painting(cursor_, at)) return;
    if (drag_ == Drag::paint)
        add_to_stroke(point(at, event.time_s));
    else if (drag_ == Drag::mask)
        state_.treatment_state.touches.push_back(
            {MaskTouch::Kind::drag, {at.x + 0.5, at.y + 0.5}, mask_erases_});
    else if (drag_ == Drag::region)
        stretch_region(at);
    else if (drag_ == Drag::annotation)
        annotator_.drag(annotated(), at);
    else if (drag_ == Drag::ruler && state_.ruler)
        state_.ruler->second = at;
}

void InputController::move(const InputEvent& event) {
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
        case Drag::light:
            move_light();
            break;
        case Drag::paint:
        case Drag::mask:
        case Drag::region:
        case Drag::ruler:
        case Drag::annotation:
            move_on_painting(event);
            break;
        case Drag::board:
            if (state_.board.rect[2] > 0) painter_.send(PointEvent{board_point(event)});
            break;
        case Drag::size:
            state_.brush.size_mm = std::clamp(state_.brush.size_mm * std::exp(by.x / 150), 0.1, 500.0);
            break;
        case Drag::divider:
            state_.comparing.divider =
                std::clamp(static_cast<float>(cursor_.x / std::max(screen_.width, 1)), 0.0f, 1.0f);
            break;
        case Drag::none:
        case Drag::panel:
            break;
    }
    last_ = cursor_;
    last_time_s_ = event.time_s;
}

// What photographs are held against is lit as they were: nothing else can light it. Says so.
bool InputController::is_idle(Action action, double time_s) {
    constexpr std::array kOfLight = {Action::light_left, Action::light_right, Action::light_up,
                                     Action::light_down, Action::shadows,     Action::illuminant,
                                     Action::loupe};
    if (!state_.comparing.on || std::ranges::count(kOfLight, action) == 0) return false;
    state_.message = "what is compared is lit as the photograph was; " + state_.keys.text(Action::compare) +
                     " goes back to the painting";
    state_.message_until_s = time_s + 5;
    return true;
}

void InputController::probe(bool changed) {
    if (changed) probed_.reset();
    const bool rests = drag_ == Drag::none || drag_ == Drag::panel;
    glm::dvec2 at;
    if (!rests || !over_canvas_ || !state_.probing || !placement().to_painting(cursor_, at)) return;
    const glm::ivec2 pixel(std::lround(at.x), std::lround(at.y));
    if (probed_ == pixel || state_.painter.waiting >= 4) return;  // while strokes wait, later
    painter_.probe(pixel.x, pixel.y);
    probed_ = pixel;
}

void InputController::put_ruler_away() {
    state_.ruler.reset();
    state_.profile.reset();
}

void InputController::end_stroke() {
    if (draws() || drag_ == Drag::annotation) let_go();
}

void InputController::let_go() {
    if ((drag_ == Drag::paint && !beside_) || drag_ == Drag::board) painter_.send(EndEvent{});
    beside_.reset();
    if (drag_ == Drag::mask) state_.treatment_state.touches.push_back({MaskTouch::Kind::release, {}});
    if (drag_ == Drag::ruler && state_.ruler) {
        if (glm::length(state_.ruler->second - state_.ruler->first) < kShortestRuler_px)
            put_ruler_away();
        else
            painter_.profile(state_.ruler->first, state_.ruler->second);
    }
    if (drag_ == Drag::region && state_.region) painter_.statistics(*state_.region);
    if (drag_ == Drag::annotation) annotator_.release(annotated());
    drag_ = Drag::none;
}

}  // namespace tangi
