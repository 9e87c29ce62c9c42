// paint_support.h: what tests of brushes and strokes share: small canvases, plain paints, simple strokes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "paint/brush/brush.h"
#include "paint/canvas/canvas.h"
#include "paint/optics/palette.h"
#include "paint/session/session.h"
#include "paint/stroke/stroke.h"

namespace tangi {

constexpr double kTestPixel = 0.25;  // [mm]

inline std::shared_ptr<Surface> flat_surface(int width, int height, double pixel_mm = kTestPixel) {
    auto surface = std::make_shared<Surface>(width, height);
    surface->mm_per_pixel = pixel_mm;
    surface->scale_known = true;
    for (Rgb& colour : surface->diffuse.pixels()) colour = Rgb(0.5f, 0.4f, 0.3f);
    for (float& confidence : surface->confidence.pixels()) confidence = 1;
    return surface;
}

inline Canvas flat_canvas(int width = 128, int height = 96, double pixel_mm = kTestPixel) {
    return Canvas(flat_surface(width, height, pixel_mm));
}

// A brush without chance: even bristles, even load, no grain.
inline BrushSettings even_brush(double size_mm = 5) {
    BrushSettings s;
    s.size_mm = size_mm;
    s.groove_mm = 0;
    s.load_variation = 0;
    s.grain = 0;
    return s;
}

inline BrushSettings flat_of(double size_mm) {
    BrushSettings s = brush_presets().at("flat");
    s.size_mm = size_mm;
    return s;
}

// Of any tile.
inline bool has_upper(const PaintLayer& layer) {
    for (const TileIndex at : layer.painted())
        if (layer.tile(at)->has_upper()) return true;
    return false;
}

inline IngredientId add_paint(Canvas& canvas, const std::string& name) {
    return canvas.add(artist_acrylics().at(name));
}

// A straight stroke [mm], points 1 mm apart.
inline void stroke(Canvas& canvas, Brush& brush, PathPoint from, PathPoint to, double pressure = 0.6,
                   std::uint64_t seed = 1) {
    Stroke s(canvas, brush, {}, seed);
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const int count = std::max(1, static_cast<int>(length));
    for (int i = 0; i <= count; ++i) {
        const double t = static_cast<double>(i) / count;
        StrokePoint point;
        point.time_s = i * 0.01;
        point.x_mm = from.x + (to.x - from.x) * t;
        point.y_mm = from.y + (to.y - from.y) * t;
        point.pressure = pressure;
        s.add(point);
    }
    s.finish();
}

// Of a sitting: where [mm] the hand is, t seconds after it began.
inline Event point(double t, double x, double y, double p = 0.6) { return PointEvent{{t, x, y, p, 0, 0, 0}}; }

inline std::vector<double> on_both(const Canvas& canvas, const Brush& brush) {
    std::vector<double> sums = canvas.volumes_mm3();
    const auto more = brush.volumes_mm3(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += more[i];
    return sums;
}

inline Image<float> thickness_of(const Canvas& canvas) {
    Image<float> result(canvas.width(), canvas.height());
    for (int y = 0; y < canvas.height(); ++y)
        for (int x = 0; x < canvas.width(); ++x) result(x, y) = canvas.wet().thickness_mm(x, y);
    return result;
}

// With a preset's tool, 6 mm wide.
inline StrokeEvent tool_stroke(const std::string& preset, const std::string& paint, std::uint64_t seed) {
    StrokeEvent event;
    event.brush = brush_presets().at(preset);
    event.brush.size_mm = 6;
    if (!paint.empty()) event.paint = {{paint, 1}};
    event.seed = seed;
    return event;
}

// A whole stroke from (-10, y) to (10, y) mm.
inline void draw_line(Session& session, const StrokeEvent& stroke, double y) {
    session.apply(stroke);
    session.apply(point(0, -10, y));
    session.apply(point(0.1, 10, y));
    session.apply(EndEvent{});
}

}  // namespace tangi
