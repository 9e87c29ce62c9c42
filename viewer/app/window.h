// window.h: the window: hold a painting, tilt it, light it, paint on it.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <map>
#include <string>

#include "paint/brush/brush_settings.h"
#include "paint/canvas/canvas.h"
#include "paint/optics/palette.h"
#include "retouch/treatment/treatment.h"
#include "surface/base/progress.h"
#include "viewer/model/host_services.h"
#include "viewer/render/display_profile.h"

namespace tangi {

struct WindowSetup {
    // Reads or makes what is shown, on a thread of its own, while the window shows how far it is.
    std::function<Canvas(const Progress&)> open;
    Palette palette;
    std::map<std::string, BrushSettings> brushes;
    std::filesystem::path file{};  // what is opened, or where a new canvas is to be saved
    bool file_is_new = false;
    int width = 1280, height = 800;  // [pixels] of the window
    HostServices workshop{};
    std::filesystem::path photos{};    // a folder of photographs to compare it with at once
    std::optional<Monitor> monitor{};  // its colours; without: as the screen says, else sRGB
    bool monitor_is_srgb = false;      // whatever the screen says
    RenderingIntent intent = RenderingIntent::relative;
    std::string camera = "0";             // number of the webcam, or a video in its place
    std::filesystem::path settings{};     // folder of keys.json and recent.json; empty: there is none
    Author author{};                      // of what is done to a painting under treatment
    std::vector<std::string> warnings{};  // of what the window is opened with; they are told in it
    std::function<bool()> stop_wanted{};  // asked between frames: Ctrl-C, a kill
};

struct WindowResult {
    std::filesystem::path file;  // the painting that was shown last; counts are of all that were
    int strokes = 0, saves = 0;
    bool unsaved = false;  // strokes are in the journal and not in the painting
    long frames = 0;
    glm::dvec2 tilt_deg{0};
    double light_azimuth_deg = 0, light_elevation_deg = 0;
    std::size_t fetched_bytes = 0;   // of texels to the graphics device, as they came into sight
    std::size_t uploaded_bytes = 0;  // what changed of them, and shadows
    std::string drawn_by;
};

// Shows the window until it is closed. A large painting is first seen as its overview
// (surface/painting_file/overview.h). Throws Error where there is no display or no OpenGL 3.3, and what
// `open` throws.
WindowResult run_window(WindowSetup setup, const Progress& progress = {});

}  // namespace tangi
