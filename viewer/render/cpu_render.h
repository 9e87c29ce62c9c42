// cpu_render.h: a scene as the reference renderer has it, pixel by pixel, without OpenGL.
#pragma once

#include "surface/base/progress.h"
#include "surface/maps/surface.h"
#include "viewer/render/scene.h"

namespace tangi {

// [1] Straight up to s = 1 - shoulder, then bent towards 1 with the same slope: 1 - (1 - s)^2 / (1 - 2 s +
// v). Without a shoulder it clips at 1.
float toned(float value, float shoulder);

// The painting (ViewMode::painting) under the scene's lights, with its shadows, exposure and tone curve:
// sRGB-encoded, 0..1, at most `side_px` pixels wide and high (0: all of them).
Image<Rgb> scene_picture(const Surface& surface, const Scene& scene, int side_px = 0,
                         const Progress& progress = {});

}  // namespace tangi
