// mosaic_support.h: positions of a procedural painting whose fits are perfect, so that what a mosaic makes of
// them is the mosaic's own doing.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "datasets/positions.h"
#include "fit/mosaic/make_mosaic.h"
#include "surface/image/colour.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {

struct MosaicScene {
    PaintingOptions painting;
    std::vector<CameraPosition> cameras;
    std::vector<MosaicPosition> positions;
};

inline MosaicPosition position_of(const std::string& name, Surface surface) {
    const std::string hash = hash_of(surface);
    return position_of(name, std::make_shared<const Surface>(std::move(surface)), nullptr, hash);
}

// The camera's exposure is in rho_d, as a fit that knows no white has it.
inline Surface seen_by(const CameraPosition& camera, const PaintingOptions& painting) {
    Surface surface = surface_of(procedural_painting(painting, camera.view));
    for (Rgb& c : surface.diffuse.pixels()) c *= static_cast<float>(camera.exposure);
    for (float& c : surface.confidence.pixels()) c = std::max(c, 0.5f);
    return surface;
}

inline MosaicScene mosaic_scene(const PaintingOptions& painting, const PositionsOptions& options) {
    MosaicScene scene{painting, camera_positions(painting, options), {}};
    for (const CameraPosition& camera : scene.cameras)
        scene.positions.push_back(position_of(camera.name, seen_by(camera, painting)));
    return scene;
}

// Pixels as of a museum's photographs. At 0.3 mm a pixel the paint's relief is as fine as pixels, which no
// resampling keeps: normals half a pixel apart differ by 9 degrees there, and a Lanczos kernel leaves 4.
inline PaintingOptions small_wall() { return {.width = 520, .height = 340, .mm_per_pixel = 0.06}; }

// Pixel of the wall -> pixel of the whole painting, exactly: the first position is the wall's anchor.
inline Homography to_whole(const MosaicScene& scene, const MosaicReport& report) {
    return scene.cameras[0].to_painting * glm::inverse(report.layout.positions[0].to_wall);
}

// What a mosaic should be, pixel by pixel, if position i lay exactly where the mosaic puts it: in the wall's
// frame, whose plane is the painting's and which is turned as its anchor is. Where positions are put is
// judged by itself; relief as fine as pixels makes degrees of a third of a pixel.
inline Surface truth_of(const MosaicScene& scene, const MosaicReport& report, std::size_t i) {
    const PaintingView &anchor = scene.cameras[0].view, &own = scene.cameras[i].view;
    PaintingView view{report.layout.width, report.layout.height, anchor.mm_per_pixel,
                      own.to_mm * glm::inverse(report.layout.positions[i].to_wall), glm::dmat3(1)};
    const double turn = std::atan2(anchor.rotation[0].y, anchor.rotation[0].x);
    view.rotation = {std::cos(turn), std::sin(turn), 0, -std::sin(turn), std::cos(turn), 0, 0, 0, 1};
    return surface_of(procedural_painting(scene.painting, view));
}

// The position in whose middle a pixel of the wall lies, or the nearest such.
inline std::size_t shown_by(const MosaicScene& scene, const MosaicReport& report, const glm::dvec2& pixel) {
    const auto off = [&](std::size_t i) {
        const PaintingView& view = scene.cameras[i].view;
        return glm::distance(
            mapped(report.layout.positions[i].to_wall, glm::dvec2(view.width - 1, view.height - 1) / 2.0),
            pixel);
    };
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < scene.cameras.size(); ++i)
        if (off(i) < off(nearest)) nearest = i;
    return nearest;
}

// [pixels of the wall] of points of all joined positions, against where they are.
inline double placement_rms(const MosaicScene& scene, const MosaicReport& report) {
    double sum = 0, count = 0;
    const Homography whole = glm::inverse(to_whole(scene, report));
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        if (!report.layout.positions[i].joined) continue;
        const PaintingView& view = scene.cameras[i].view;
        for (int y = 0; y <= 4; ++y)
            for (int x = 0; x <= 4; ++x) {
                const glm::dvec2 p = glm::dvec2(x, y) / 4.0 * glm::dvec2(view.width - 1, view.height - 1);
                const glm::dvec2 off = mapped(report.layout.positions[i].to_wall, p) -
                                       mapped(whole, mapped(scene.cameras[i].to_painting, p));
                sum += glm::dot(off, off), ++count;
            }
    }
    return std::sqrt(sum / count);
}

}  // namespace tangi
