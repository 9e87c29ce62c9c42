// stroke_bench.cpp: what strokes cost: pixels under the bristles a second, and the time of a frame at 60 Hz.
//
// The canvas is fully wet where the brush goes, with the paints of the brush and of the canvas: both
// directions of the transfer work on every pixel. A frame is one sample of the pen: the way of 1/60 s.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "bench/cpu_clock.h"
#include "paint/canvas/appearance.h"
#include "paint/optics/palette.h"
#include "paint/session/history.h"
#include "paint/stroke/stroke.h"
#include "paint/substrate/substrate.h"
#include "surface/base/parallel.h"

namespace {

using namespace tangi;

constexpr double kPixel_mm = 0.15;

std::shared_ptr<const Surface> surface_of(int width, int height) {
    auto surface = std::make_shared<Surface>(width, height);
    surface->mm_per_pixel = kPixel_mm;
    // A weave's relief: the work is that of a real support.
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            surface->height_mm(x, y) =
                0.05f * std::sin(1.4f * static_cast<float>(x)) * std::sin(1.4f * static_cast<float>(y));
    return surface;
}

// `paints` in all: half of them on the canvas, half on the brush.
Canvas wet_canvas(int width, int height, int paints) {
    Canvas canvas(surface_of(width, height));
    PaintTile tile;
    for (int i = 0; i < paints; ++i) {
        const auto id = canvas.add(artist_acrylics().paints[static_cast<std::size_t>(i)]);
        if (i < (paints + 1) / 2) tile.ingredients.push_back(id);
    }
    tile.thickness_mm.assign(tile.ingredients.size() * PaintTile::kPixels, 0.1f / static_cast<float>(paints));
    const auto shared = std::make_shared<PaintTile>(tile);
    for (int y = 0; y < canvas.wet().rows(); ++y)
        for (int x = 0; x < canvas.wet().columns(); ++x) canvas.writable_wet().set_tile({x, y}, shared);
    return canvas;
}

struct Frames {
    std::vector<double> ms, cpu_ms;
    double pixels = 0, seconds = 0, lift_ms = 0;
};

// A stroke back and forth in the middle of the canvas, `speed_px` pixels a second.
Frames stroke_frames(Canvas& canvas, int size_px, int paints, double speed_px, int frames, bool look) {
    BrushSettings settings = brush_presets().at("round");
    settings.size_mm = size_px * kPixel_mm;
    Brush brush(settings, kPixel_mm, 1);
    std::vector<Portion> recipe;
    for (int i = paints / 2; i < paints; ++i) recipe.push_back({static_cast<IngredientId>(i), 1});
    brush.load(recipe, 2);
    Surface shown = look ? canvas.dry() : Surface(1, 1);
    canvas.take_dirty();
    History history;
    history.begin(canvas);
    Stroke stroke(canvas, brush, {}, 1);
    Frames result;
    const double half = canvas.width() * 0.4;
    for (int i = 0; i <= frames; ++i) {
        const double way = std::fmod(i * speed_px / 60, 4 * half);
        const double x = way < 2 * half ? way - half : 3 * half - way;
        const auto start = std::chrono::steady_clock::now();
        const double cpu_start = cpu_seconds();
        stroke.add({i / 60.0, x * kPixel_mm, 30 * std::sin(0.05 * i) * kPixel_mm, 0.6, 0, 0, 0});
        if (look) {
            const auto dirty = canvas.take_painted();
            update_appearance(canvas, dirty, shown);
        }
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
        if (i < 3) continue;  // the spline waits for its neighbours
        result.ms.push_back(passed.count() * 1e3);
        result.cpu_ms.push_back((cpu_seconds() - cpu_start) * 1e3);
        result.seconds += passed.count();
    }
    result.pixels = stroke.bristle_pixels();
    const auto lifted = std::chrono::steady_clock::now();
    stroke.finish();
    if (look) update_appearance(canvas, canvas.take_painted(), shown);
    result.lift_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - lifted).count();
    history.end(canvas);
    std::sort(result.ms.begin(), result.ms.end());
    return result;
}

// Pixels under the bristles a second. Arguments: size of the brush in pixels, paints in all.
void BM_BristlePixels(benchmark::State& state) {
    set_thread_count(1);
    const int size = static_cast<int>(state.range(0)), paints = static_cast<int>(state.range(1));
    Canvas canvas = wet_canvas(2048, 512, paints);
    double pixels = 0;
    for (auto _ : state) pixels += stroke_frames(canvas, size, paints, 1500, 60, false).pixels;
    state.counters["pixels/s"] = benchmark::Counter(pixels, benchmark::Counter::kIsRate);
    set_thread_count(0);
}
BENCHMARK(BM_BristlePixels)->ArgsProduct({{11, 31, 61, 201}, {2, 4, 8}})->Unit(benchmark::kMillisecond);

// Frames of a quick stroke (1500 pixels a second) on a wet canvas of 4096 x 4096. Arguments: size, threads,
// and whether the look of the changed tiles is part of the frame.
void BM_Frame(benchmark::State& state) {
    const int size = static_cast<int>(state.range(0));
    set_thread_count(static_cast<int>(state.range(1)));
    Canvas canvas = wet_canvas(4096, 4096, 4);
    Frames all;
    for (auto _ : state) {
        const Frames some = stroke_frames(canvas, size, 4, 1500, 240, state.range(2) != 0);
        all.ms.insert(all.ms.end(), some.ms.begin(), some.ms.end());
        all.cpu_ms.insert(all.cpu_ms.end(), some.cpu_ms.begin(), some.cpu_ms.end());
        all.lift_ms = std::max(all.lift_ms, some.lift_ms);
    }
    std::sort(all.ms.begin(), all.ms.end());
    std::sort(all.cpu_ms.begin(), all.cpu_ms.end());
    state.counters["cpu_p50_ms"] = all.cpu_ms[all.cpu_ms.size() / 2];
    state.counters["cpu_p99_ms"] = all.cpu_ms[all.cpu_ms.size() * 99 / 100];
    state.counters["p50_ms"] = all.ms[all.ms.size() / 2];
    state.counters["p99_ms"] = all.ms[all.ms.size() * 99 / 100];
    state.counters["most_ms"] = all.ms.back();
    state.counters["lift_ms"] = all.lift_ms;
    set_thread_count(0);
}
BENCHMARK(BM_Frame)
    ->Args({61, 1, 0})
    ->Args({61, 2, 1})
    ->Args({201, 1, 0})
    ->Args({201, 2, 0})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(2);

// The thesis's table 4.1: brushes of 11, 31 and 61 pixels, smooth and quick strokes (300 and 1500 pixels a
// second), on a canvas of its iPad's size, with the look of what changed. Frames that could be drawn in a
// second, by the time that the process had a processor for.
void BM_Table41(benchmark::State& state) {
    set_thread_count(1);
    const int size = static_cast<int>(state.range(0));
    const auto speed = static_cast<double>(state.range(1));
    Canvas canvas = wet_canvas(1024, 768, 4);
    double cpu_ms = 0, frames = 0;
    for (auto _ : state) {
        const Frames some = stroke_frames(canvas, size, 4, speed, 240, true);
        for (const double ms : some.cpu_ms) cpu_ms += ms;
        frames += static_cast<double>(some.cpu_ms.size());
    }
    state.counters["frames/s"] = 1e3 * frames / cpu_ms;
    set_thread_count(0);
}
BENCHMARK(BM_Table41)->ArgsProduct({{11, 31, 61}, {300, 1500}})->Unit(benchmark::kMillisecond)->Iterations(2);

void BM_Substrate(benchmark::State& state) {
    SubstrateOptions options;
    options.width_mm = options.height_mm = 76.8;
    options.pixel_mm = kPixel_mm;
    for (auto _ : state) benchmark::DoNotOptimize(make_substrate(SubstrateKind::linen, options));
    state.counters["pixels/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * 512 * 512, benchmark::Counter::kIsRate);
}
BENCHMARK(BM_Substrate)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
