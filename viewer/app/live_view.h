// live_view.h: the picture in the window.
#pragma once

#include "viewer/render/renderer.h"
#include "viewer/render/view.h"

namespace tangi {

// How coarsely to draw what moves, so that a frame takes 1/60 s.
//
// Enlarging a picture takes time, too: a software renderer's is half of what it takes to draw it. So coarser
// pictures are drawn only where the whole gets faster, and by a good deal: else a sharp one is better.
class Coarseness {
public:
    double scale() const { return scale_; }  // [1] pixels drawn for one of the screen, along a side

    // What the last frame took: to be drawn, and to be enlarged where it was drawn coarser.
    void took(double draw_s, double enlarge_s);

private:
    double scale_ = 1;
    double enlarge_s_ = 0;  // the last time that something was; to begin with, it costs nothing
};

// Drawn again only where something in it has changed, coarser while it moves on a slow machine.
class LivePicture {
public:
    // On the window, whose lower left corner the screen's part of it is `left` (panels) beside. Keeps the
    // time that it took, if it moves, and with it the next frame's coarseness. Waits until it is drawn.
    void draw(Renderer& renderer, const Scene& scene, const Placement& placement, Extent screen, int left,
              bool moving);

    bool fine() const { return fine_; }  // as fine as it can be, nothing missing

    // On the window again, as it was drawn at rest.
    void show(int left) const;

private:
    gl::Target target_;
    Extent screen_;
    Coarseness coarseness_;
    bool fine_ = false, warm_ = false;
};

}  // namespace tangi
