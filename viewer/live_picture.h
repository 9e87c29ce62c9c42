// live_picture.h: the picture in the window.
#pragma once

#include "viewer/renderer.h"
#include "viewer/view.h"

namespace tangi {

// Drawn again only where something in it has changed, coarser while it moves on a slow machine.
class LivePicture {
public:
    // Keeps the time that it took, if it moves, and with it the next frame's coarseness. Waits until it is
    // drawn.
    void draw(Renderer& renderer, const Scene& scene, const Placement& placement, Extent screen, bool moving);

    bool fine() const { return fine_; }  // as fine as it can be, nothing missing

    // Copies it to the window: `left` pixels are panels.
    void show(int left, int window_height) const;

    const gl::Target& target() const { return target_; }

private:
    void adapt(double seconds);

    gl::Target target_;
    Extent screen_;
    double scale_ = 1;
    bool fine_ = false, warm_ = false;
};

}  // namespace tangi
