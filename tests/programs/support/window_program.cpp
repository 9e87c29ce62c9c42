// window_program.cpp: `tangipaint paint PAINTING` and nothing else: what the sanitizers look at
// (random_hand_test.cpp).
#include <csignal>
#include <cstdio>

#include "paint/files/canvas_file.h"
#include "surface/base/error.h"
#include "viewer/app/window.h"
#include "viewer/model/user_settings.h"

namespace {

volatile std::sig_atomic_t stopped = 0;

}  // namespace

int main(int count, char** words) {
    if (count < 3) return 2;
    std::signal(SIGTERM, [](int) { stopped = 1; });
    try {
        const std::string file = words[2];
        tangi::WindowSetup setup{
            .open = [file](const tangi::Progress& p) { return tangi::read_canvas(file, p); },
            .palette = tangi::artist_acrylics(),
            .brushes = tangi::brush_presets(),
            .file = words[2],
            .settings = tangi::settings_folder()};
        setup.width = 1000;
        setup.height = 700;
        setup.camera = "/nowhere";
        setup.stop_wanted = [] { return stopped != 0; };
        tangi::run_window(std::move(setup));
    } catch (const tangi::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
