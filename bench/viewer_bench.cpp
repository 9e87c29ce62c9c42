// viewer_bench.cpp: frames of the window's renderer, without a window (EGL), and what opening and painting
// cost.
//
// Processor time counts all threads: a software renderer is the processors.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "surface/base/error.h"
#include "viewer/render/headless.h"
#include "viewer/render/renderer.h"
#include "viewer/render/view.h"

namespace tangi {
namespace {

double processor_seconds() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Surface relief(int width, int height) {
    Surface s(width, height);
    s.mm_per_pixel = 0.1;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
            s.height_mm(x, y) = 0.4f * std::sin(0.05f * fx + 0.02f * fy) * std::cos(0.07f * fy);
            s.diffuse(x, y) = {0.5f + 0.4f * std::sin(0.01f * fx), 0.4f, 0.5f + 0.4f * std::cos(0.013f * fy)};
            s.specular(x, y) = 0.05f;
            s.roughness(x, y) = 0.15f + 0.1f * std::sin(0.03f * fx);
            s.confidence(x, y) = 1;
        }
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    return s;
}

struct Stage {
    gl::HeadlessContext context;
    Renderer renderer;
};

Stage& stage() {
    static Stage instance;
    return instance;
}

// Tilting: another light direction and view each frame, as large as the window.
void tilt(benchmark::State& state, Shadows shadows, bool smooth, int width, int height) {
    Renderer& renderer = stage().renderer;
    const Surface s = relief(width, height);
    renderer.set_painting(std::make_shared<TexelTiles>(s, range_of(s)), s.mm_per_pixel);
    if (shadows == Shadows::horizon)
        renderer.set_horizon(horizon_map(coarse_heights(s.height_mm, s.mm_per_pixel)));
    const gl::Target target(width, height, false);
    Scene scene{.lights = {distant_light({0, 0, 1})}, .shadows = shadows, .light_radius_deg = 2};
    Shot shot = pixel_by_pixel(s);
    shot.smooth = smooth;
    renderer.fetch(scene, shot);
    renderer.draw(scene, shot, target.framebuffer());  // compiles
    glFinish();
    float angle = 0;
    const double start = processor_seconds();
    for (auto _ : state) {
        angle += 0.02f;
        scene.lights[0] = distant_light({std::cos(angle), std::sin(angle), 0.6f});
        shot.eye = glm::vec4(glm::normalize(Vec3(0.2f * std::sin(angle), 0.1f, 1)), 0);
        renderer.draw(scene, shot, target.framebuffer());
        glFinish();
    }
    const auto frames = static_cast<double>(state.iterations());
    state.counters["frames/s"] = benchmark::Counter(frames, benchmark::Counter::kIsRate);
    state.counters["processor_ms"] = 1e3 * (processor_seconds() - start) / frames;
}

// A painting of 4 : 3 that is fitted into the window's part beside the panels, and tilted.
void tilt_whole(benchmark::State& state, int width, int height) {
    Renderer& renderer = stage().renderer;
    const Surface s = relief(1600, 1200);
    renderer.set_painting(std::make_shared<TexelTiles>(s, range_of(s)), s.mm_per_pixel);
    const gl::Target target(width, height, false);
    const Extent painting{s.width(), s.height()}, screen{width, height};
    const View view = fitted(painting, screen);
    float angle = 0;
    const auto draw = [&] {
        angle += 0.02f;
        const Tilt tilt{.angle_deg = {10 * std::sin(angle), 5}};
        const Placement placement(view, {tilt}, painting, screen, s.mm_per_pixel);
        const Scene scene{.lights = {distant_light(placement.in_surface({-0.5f, 0.5f, 0.6f}))}};
        renderer.fetch(scene, placement.shot(1, false));
        renderer.draw(scene, placement.shot(1, false), target.framebuffer());
        glFinish();
    };
    draw();  // compiles
    const double start = processor_seconds();
    for (auto _ : state) draw();
    state.counters["processor_ms"] =
        1e3 * (processor_seconds() - start) / static_cast<double>(state.iterations());
}

// What a picture costs that is not drawn on the window itself: copied there, enlarged where it is coarser.
void copied(benchmark::State& state, int width, int height) {
    (void)stage();
    const gl::Target picture(width, height, false);
    const gl::Texture window = gl::make_texture();
    const gl::Framebuffer framebuffer = gl::make_framebuffer();
    glBindTexture(GL_TEXTURE_2D, window.id());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 1920, 1080, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer.id());
    glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, window.id(), 0);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, picture.framebuffer());
    const auto copy = [&] {
        glBlitFramebuffer(0, 0, width, height, 0, 0, 1920, 1080, GL_COLOR_BUFFER_BIT,
                          width == 1920 ? GL_NEAREST : GL_LINEAR);
        glFinish();
    };
    copy();
    const double start = processor_seconds();
    for (auto _ : state) copy();
    state.counters["processor_ms"] =
        1e3 * (processor_seconds() - start) / static_cast<double>(state.iterations());
}

void pack(benchmark::State& state) {
    const Surface s = relief(4096, 2048);
    const TexelRange range = range_of(s);
    for (auto _ : state) {
        const TexelTiles tiles(s, range);
        benchmark::DoNotOptimize(tiles.at(0, 0));
    }
    state.counters["megapixels/s"] =
        benchmark::Counter(8.388608 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void horizons(benchmark::State& state) {
    const Surface s = relief(1024, 1024);
    const CoarseHeights heights = coarse_heights(s.height_mm, s.mm_per_pixel);
    for (auto _ : state) benchmark::DoNotOptimize(horizon_map(heights));
}

}  // namespace
}  // namespace tangi

int main(int argc, char** argv) {
    using namespace tangi;
    benchmark::Initialize(&argc, argv);
    try {
        std::printf("drawn by %s\n", stage().context.renderer().c_str());
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    const auto add = [](const char* name, Shadows shadows, bool smooth, int width, int height) {
        benchmark::RegisterBenchmark(
            name, [=](benchmark::State& state) { tilt(state, shadows, smooth, width, height); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    };
    add("tilt 1920x1080", Shadows::none, false, 1920, 1080);
    add("tilt 1920x1080, shadows", Shadows::horizon, false, 1920, 1080);
    add("tilt 1440x810", Shadows::none, false, 1440, 810);
    add("tilt 1440x810, shadows", Shadows::horizon, false, 1440, 810);
    add("tilt 960x540, shadows", Shadows::horizon, false, 960, 540);
    add("still 1920x1080, smooth, shadows", Shadows::horizon, true, 1920, 1080);
    add("tilt 3840x2160, shadows", Shadows::horizon, false, 3840, 2160);
    const auto add_sized = [](const char* name, void (*run)(benchmark::State&, int, int), int width,
                              int height) {
        benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { run(state, width, height); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    };
    add_sized("tilt 1640x1080, whole painting", tilt_whole, 1640, 1080);
    add_sized("copied to 1920x1080", copied, 1920, 1080);
    add_sized("enlarged to 1920x1080", copied, 1344, 756);
    benchmark::RegisterBenchmark("pack and levels of detail", pack)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
    benchmark::RegisterBenchmark("horizon map, 1 megapixel", horizons)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
