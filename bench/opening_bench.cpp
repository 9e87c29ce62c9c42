// opening_bench.cpp: opening_bench PAINTING.exr: what the window does until its first picture, stage by
// stage.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>

#include "paint/files/canvas_file.h"
#include "surface/base/error.h"
#include "surface/painting_file/overview.h"
#include "viewer/model/painter.h"
#include "viewer/render/headless.h"
#include "viewer/render/renderer.h"
#include "viewer/render/view.h"

namespace tangi {
namespace {

using Clock = std::chrono::steady_clock;

class Stages {
public:
    void end(const char* stage) {
        rusage usage{};
        ::getrusage(RUSAGE_SELF, &usage);
        const auto seconds = [](const timeval& t) {
            return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        };
        const double processor = seconds(usage.ru_utime) + seconds(usage.ru_stime);
        const Clock::time_point now = Clock::now();
        std::printf("%-28s %7.3f s   processor %7.3f s   peak %6ld MB\n", stage,
                    std::chrono::duration<double>(now - last_).count(), processor - last_processor_,
                    usage.ru_maxrss / 1000);
        last_ = now;
        last_processor_ = processor;
    }

private:
    Clock::time_point last_ = Clock::now();
    double last_processor_ = 0;
};

void open(const char* path) {
    Stages stages;
    const gl::HeadlessContext context;
    Renderer renderer;
    stages.end("OpenGL");
    const Extent screen{1920, 1080};
    const gl::Target target(screen.width, screen.height, false);
    const Scene scene{.lights = {distant_light({-0.5f, 0.5f, 0.7f})}};
    const auto draw = [&](const std::shared_ptr<const TexelTiles>& tiles, double mm_per_pixel) {
        renderer.set_painting(tiles, mm_per_pixel);
        const Extent painting{tiles->width(), tiles->height()};
        const Placement place(fitted(painting, screen), {}, painting, screen, mm_per_pixel);
        const Shot shot = place.shot(1, true);
        renderer.fetch(scene, shot);
        renderer.draw(scene, shot, target.framebuffer());
        glFinish();
    };
    if (const std::optional<Overview> overview = read_overview(path)) {
        const Surface& s = overview->surface;
        stages.end("read overview");
        draw(std::make_shared<TexelTiles>(s, range_of(s)), s.mm_per_pixel);
        stages.end("first picture of it");
    }
    Canvas canvas = read_canvas(path);
    stages.end("read");
    Painter painter({.canvas = std::move(canvas), .palette = artist_acrylics(), .file = path}, [] {});
    stages.end("appearance");
    const Surface& surface = painter.surface();
    const auto tiles = std::make_shared<TexelTiles>(surface, painter.range());
    stages.end("texels");
    draw(tiles, surface.mm_per_pixel);
    stages.end("first picture");
}

}  // namespace
}  // namespace tangi

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: opening_bench PAINTING.exr\n");
        return 2;
    }
    try {
        tangi::open(argv[1]);
    } catch (const tangi::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
