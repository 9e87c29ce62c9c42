#include "viewer/app/live_view.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace tangi {

namespace {

// [bytes] To the device in one frame; what is missing comes with the next.
constexpr std::size_t kFetchMoving = std::size_t(4) << 20, kFetchResting = std::size_t(32) << 20;

// What has happened since [s].
class Watch {
public:
    double lap_s() {
        const Clock::time_point now = Clock::now();
        return std::chrono::duration<double>(now - std::exchange(since_, now)).count();
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point since_ = Clock::now();
};

}  // namespace

void Coarseness::took(double draw_s, double enlarge_s) {
    constexpr double kFrame_s = 1 / 60.0;
    constexpr double kSmallest = 0.25;
    constexpr double kWorth = 0.8;  // [1] of the time of a sharp picture that a coarse one may take
    if (scale_ < 1) enlarge_s_ = enlarge_s;
    const double sharp_s = draw_s / (scale_ * scale_);
    const double seconds = draw_s + (scale_ < 1 ? enlarge_s_ : 0);
    if (seconds > 0.9 * kFrame_s) {
        const double room_s = std::max(0.7 * kFrame_s - enlarge_s_, 0.35 * kFrame_s);
        scale_ = std::max(scale_ * std::clamp(std::sqrt(room_s / draw_s), 0.6, 0.97), kSmallest);
    } else if (seconds < 0.4 * kFrame_s) {
        scale_ = std::min(scale_ * 1.05, 1.0);
    }
    if (scale_ < 1 && scale_ * scale_ * sharp_s + enlarge_s_ > kWorth * sharp_s) scale_ = 1;
}

void LivePicture::draw(Renderer& renderer, const Scene& scene, const Placement& placement, Extent screen,
                       int left, bool moving) {
    const bool coarse = moving && coarseness_.scale() < 1;
    const Shot shot = placement.shot(coarse ? coarseness_.scale() : 1.0, !moving);
    screen_ = screen;
    Watch watch;
    const bool complete = renderer.fetch(scene, shot, moving ? kFetchMoving : kFetchResting).complete;
    fine_ = !moving && complete;
    if (moving && !coarse) {
        // Straight to the window: a software renderer takes a third of the time again to copy it.
        renderer.draw(scene, shot, 0, false, {left, 0});
    } else {
        if (target_.width() != shot.width || target_.height() != shot.height)
            target_ = gl::Target(shot.width, shot.height, false);
        renderer.draw(scene, shot, target_.framebuffer());
    }
    glFinish();
    const double draw_s = watch.lap_s();
    if (!moving || coarse) show(left);
    if (coarse) glFinish();
    if (moving && warm_) coarseness_.took(draw_s, watch.lap_s());
    warm_ = moving;  // the first frame compiles, or comes after a pause
}

void LivePicture::show(int left) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, target_.width(), target_.height(), left, 0, left + screen_.width, screen_.height,
                      GL_COLOR_BUFFER_BIT, target_.width() == screen_.width ? GL_NEAREST : GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace tangi
