// treatment_shown.cpp: of the treatment: states that are shown, and held against each other.
#include <fmt/format.h>

#include "paint/canvas/appearance_part.h"
#include "retouch/colour_match/viewing_distance.h"
#include "retouch/treatment/treatment_picture.h"
#include "viewer/render/cpu_render.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

namespace {

constexpr int kMostPixels = 4000;       // of a side of pictures that are held against each other
constexpr int kDistanceMost_px = 2000;  // the eye's blur is wide

HeldPhoto::Picture bytes_of(const Image<Rgb>& srgb) {
    HeldPhoto::Picture picture(srgb.width(), srgb.height());
    for (std::size_t i = 0; i < srgb.size(); ++i)
        picture.pixels()[i] = glm::u8vec3(255.0f * glm::clamp(srgb.pixels()[i], 0.0f, 1.0f) + 0.5f);
    return picture;
}

std::shared_ptr<const HeldPhoto> pair_of(const Image<Rgb>& left_srgb, const Image<Rgb>& right_srgb) {
    auto held = std::make_shared<HeldPhoto>();
    held->photo = bytes_of(left_srgb);
    held->relit = bytes_of(right_srgb);
    return held;
}

}  // namespace

// The painting as it was in a state, until another is chosen.
void TreatmentController::show_state() {
    state_shown_ = state_.treatment_state.state;
    if (preview_ && state_shown_) {
        preview_.reset();
        state_.treatment_state.preview.reset();
    }
    if (preview_) return;
    if (!state_shown_)
        painter_->show_as({});
    else
        painter_->show_as([layers = treatment().layers(), state = *state_shown_](const Canvas& canvas) {
            return in_state(canvas, layers, state);
        });
}

void TreatmentController::hold(const HeldPair& pair) {
    Comparing& c = state_.comparing;
    c.pair = pair;
    c.on = true;
    if (c.way != CompareWay::aside && c.way != CompareWay::blink) c.way = CompareWay::wipe;
}

void TreatmentController::compare_states() {
    const TreatmentState& t = state_.treatment_state;
    // As they are held against each other: not tilted.
    const Placement straight(state_.view, {}, state_.painting, state_.painting, state_.mm_per_pixel);
    start("relighting two states",
          [this, painter = painter_, scene = scene_of(state_, straight), left = t.left,
           right = t.right](const Progress& progress) -> Finish {
              const Canvas canvas = canvas_of(*painter);
              const auto picture = [&](const std::optional<TreatmentStage>& state) {
                  return scene_picture(state ? surface_in_state(treatment(), canvas, *state, progress)
                                             : appearance(canvas, {}, progress),
                                       scene, kMostPixels, progress);
              };
              const auto title = [](const auto& state) { return state ? title_of(*state) : "Now"; };
              const Image<Rgb> first = picture(left);
              HeldPair pair{title(left), title(right), pair_of(first, picture(right))};
              return [this, pair = std::move(pair)] { hold(pair); };
          });
}

// The colours from near, and as they are seen from further away.
void TreatmentController::see_from() {
    const auto distance_m = static_cast<double>(state_.treatment_state.distance_m);
    start("looking from afar",
          [this, painter = painter_, distance_m, view = preview_](const Progress& p) -> Finish {
              Surface surface = appearance(view ? view->canvas : canvas_of(*painter), {}, p);
              const double mm = treatment().mm_per_pixel();
              Image<Rgb> near = colour_of(surface, kDistanceMost_px);
              const double reduced = static_cast<double>(surface.width()) / near.width();
              const Transfer srgb{Transfer::Kind::srgb};
              Image<Rgb> far = near;
              for (Rgb& c : far.pixels()) c = srgb.decode(c);
              far = shown_from(far, mm * reduced, distance_m);
              for (Rgb& c : far.pixels()) c = srgb.encode(glm::max(c, Rgb(0)));
              HeldPair pair{"from near", fmt::format("from {:.1f} m", distance_m), pair_of(near, far)};
              return [this, pair = std::move(pair)] { hold(pair); };
          });
}

}  // namespace tangi
