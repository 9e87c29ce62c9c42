// libmypaint_strokes.cpp: strokes of libmypaint's brush engine, with pigment mixing, as stroke_bench draws
// ours.
#include <benchmark/benchmark.h>
#include <libmypaint/mypaint-brush.h>
#include <libmypaint/mypaint-tiled-surface.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "bench/cpu_clock.h"

namespace {

constexpr int kTile = MYPAINT_TILE_SIZE;

// All tiles in memory: premultiplied RGBA, 1 << 15 is one.
struct Surface {
    MyPaintTiledSurface2 tiled;  // the first member: libmypaint is given its address
    int columns, rows;
    std::vector<std::uint16_t> pixels, beyond;
    MyPaintSurfaceDrawDabFunction2 draw;
    double painted = 0;  // [pixels] under the dabs

    Surface(int width, int height)
        : tiled{},
          columns((width + kTile - 1) / kTile),
          rows((height + kTile - 1) / kTile),
          pixels(static_cast<std::size_t>(columns * rows * kTile * kTile * 4)),
          beyond(static_cast<std::size_t>(kTile * kTile * 4)) {
        const auto start = [](MyPaintTiledSurface2* self, MyPaintTileRequest* request) {
            request->buffer = reinterpret_cast<Surface*>(self)->tile(request->tx, request->ty);
        };
        mypaint_tiled_surface2_init(&tiled, start, [](MyPaintTiledSurface2*, MyPaintTileRequest*) {});
        draw = tiled.parent.draw_dab_pigment;
        tiled.parent.draw_dab_pigment = counted;
        // Fully wet: opaque ochre everywhere.
        for (std::size_t i = 0; i < pixels.size(); i += 4) {
            pixels[i] = 24000, pixels[i + 1] = 16000, pixels[i + 2] = 5000, pixels[i + 3] = 1 << 15;
        }
    }
    ~Surface() { mypaint_tiled_surface2_destroy(&tiled); }
    Surface(const Surface&) = delete;
    Surface& operator=(const Surface&) = delete;

    std::uint16_t* tile(int tx, int ty) {
        if (tx < 0 || ty < 0 || tx >= columns || ty >= rows) return beyond.data();
        return pixels.data() + static_cast<std::size_t>((ty * columns + tx) * kTile * kTile * 4);
    }
    // Blue above ochre: what the brush brings.
    bool is_painted(int x, int y) {
        const std::uint16_t* p = tile(x / kTile, y / kTile) + ((y % kTile) * kTile + x % kTile) * 4;
        return p[2] > p[0];
    }
    static int counted(MyPaintSurface2* self, float x, float y, float radius, float r, float g, float b,
                       float opaque, float hardness, float eraser, float aspect, float angle, float lock,
                       float colorize, float posterize, float levels, float paint) {
        auto* surface = reinterpret_cast<Surface*>(self);
        surface->painted += std::numbers::pi * radius * radius / std::max(aspect, 1.0f);
        return surface->draw(self, x, y, radius, r, g, b, opaque, hardness, eraser, aspect, angle, lock,
                             colorize, posterize, levels, paint);
    }
};

// Arguments: size of the brush in pixels, speed of the stroke in pixels a second.
void BM_Libmypaint(benchmark::State& state) {
    const int size = static_cast<int>(state.range(0));
    const double speed = static_cast<double>(state.range(1));
    Surface surface(2048, 512);
    MyPaintBrush* brush = mypaint_brush_new();
    mypaint_brush_from_defaults(brush);
    const auto set = [&](MyPaintBrushSetting setting, double value) {
        mypaint_brush_set_base_value(brush, setting, static_cast<float>(value));
    };
    set(MYPAINT_BRUSH_SETTING_RADIUS_LOGARITHMIC, std::log(size / 2.0));
    set(MYPAINT_BRUSH_SETTING_OPAQUE, 1);
    set(MYPAINT_BRUSH_SETTING_HARDNESS, 0.8);
    set(MYPAINT_BRUSH_SETTING_PAINT_MODE, 1);  // spectral
    set(MYPAINT_BRUSH_SETTING_SMUDGE, 0.3);    // takes paint up, as ours does
    set(MYPAINT_BRUSH_SETTING_COLOR_H, 0.62);
    set(MYPAINT_BRUSH_SETTING_COLOR_S, 0.9);
    set(MYPAINT_BRUSH_SETTING_COLOR_V, 0.7);
    // Without pressure's usual effects, so that every dab is of this size.
    mypaint_brush_set_mapping_n(brush, MYPAINT_BRUSH_SETTING_OPAQUE_MULTIPLY, MYPAINT_BRUSH_INPUT_PRESSURE,
                                0);
    set(MYPAINT_BRUSH_SETTING_OPAQUE_MULTIPLY, 1);

    auto* interface = &surface.tiled.parent;
    std::vector<double> ms;
    int missing = 0;
    double seconds = 0;
    for (auto _ : state) {
        mypaint_brush_reset(brush);
        mypaint_brush_new_stroke(brush);
        mypaint_brush_stroke_to_2(brush, interface, 100, 256, 0, 0, 0, 10, 1, 0, 0);
        for (int i = 0; i <= 60; ++i) {
            const double way = std::fmod(i * speed / 60, 2 * 1848.0);
            const double x = way < 1848 ? 100 + way : 100 + 2 * 1848 - way;
            const double y = 256 + 30 * std::sin(0.05 * i);
            const double start = cpu_seconds();
            mypaint_surface_begin_atomic(&interface->parent);
            mypaint_brush_stroke_to_2(brush, interface, static_cast<float>(x), static_cast<float>(y), 0.6f, 0,
                                      0, 1 / 60.0, 1, 0, 0);
            MyPaintRectangle rectangle{};
            MyPaintRectangles roi{1, &rectangle};
            mypaint_surface2_end_atomic(interface, &roi);
            ms.push_back((cpu_seconds() - start) * 1e3);
            seconds += ms.back() / 1e3;
            // Version 1.6.0 reads memory that nobody has set and then stops painting: is there paint?
            if (i > 5 && !surface.is_painted(static_cast<int>(x) - size / 4, static_cast<int>(y))) ++missing;
        }
    }
    mypaint_brush_unref(brush);
    if (surface.painted == 0 || missing > 0.2 * static_cast<double>(ms.size())) {
        const std::string words = "it did not paint: " + std::to_string(missing) + " of " +
                                  std::to_string(ms.size()) + " samples without paint";
        state.SkipWithError(words.c_str());
        return;
    }
    std::sort(ms.begin(), ms.end());
    state.counters["pixels/s"] = surface.painted / seconds;
    state.counters["cpu_p50_ms"] = ms[ms.size() / 2];
    state.counters["cpu_p99_ms"] = ms[ms.size() * 99 / 100];
    state.counters["unpainted"] = missing;
}
BENCHMARK(BM_Libmypaint)
    ->ArgsProduct({{11, 31, 61, 201}, {300, 1500}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(4);

}  // namespace
