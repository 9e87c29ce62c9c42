#include "viewer/live_picture.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace tangi {

namespace {

// [bytes] To the device in one frame; what is missing comes with the next.
constexpr std::size_t kFetchMoving = std::size_t(4) << 20, kFetchResting = std::size_t(32) << 20;

}  // namespace

void LivePicture::draw(Renderer& renderer, const Scene& scene, const Placement& placement, Extent screen,
                       bool moving) {
    using Clock = std::chrono::steady_clock;
    const Shot shot = placement.shot(moving ? scale_ : 1.0, !moving);
    if (target_.width() != shot.width || target_.height() != shot.height)
        target_ = gl::Target(shot.width, shot.height, false);
    const Clock::time_point start = Clock::now();
    const bool complete = renderer.fetch(scene, shot, moving ? kFetchMoving : kFetchResting).complete;
    renderer.draw(scene, shot, target_.framebuffer());
    glFinish();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (moving && warm_) adapt(seconds);
    warm_ = moving;  // the first frame compiles, or comes after a pause
    fine_ = !moving && complete;
    screen_ = screen;
}

void LivePicture::show(int left, int window_height) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, target_.width(), target_.height(), left, window_height - screen_.height,
                      left + screen_.width, window_height, GL_COLOR_BUFFER_BIT,
                      target_.width() == screen_.width ? GL_NEAREST : GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void LivePicture::adapt(double seconds) {
    constexpr double kFrame_s = 1 / 60.0;
    if (seconds > 0.9 * kFrame_s)
        scale_ = std::max(scale_ * std::clamp(std::sqrt(0.7 * kFrame_s / seconds), 0.6, 0.97), 0.25);
    else if (seconds < 0.4 * kFrame_s)
        scale_ = std::min(scale_ * 1.05, 1.0);
}

}  // namespace tangi
