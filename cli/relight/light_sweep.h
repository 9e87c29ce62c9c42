// light_sweep.h: a film of a painting while a light moves over it: relight --sweep.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/flags.h"
#include "surface/base/progress.h"
#include "surface/image/image.h"
#include "surface/maps/light.h"

namespace tangi {

constexpr int kMostFrames = 99'999;  // of a film, as the names of frames have digits

// How pictures of a film are made, whatever they show.
struct FilmArguments {
    int width = 1280;
    double frames_per_s = 25;

    void add_to(Flags& flags);
};

struct SweepArguments {
    std::vector<std::string> corners;  // "AZIMUTH,ELEVATION"
    double seconds = 8;
    FilmArguments film;

    void add_to(Flags& flags);
    bool given() const { return !corners.empty(); }
};

// Draws the linear picture under this light.
using DrawUnder = std::function<Image<Rgb>(const Light& light)>;

// Writes the film to `out`, a video or a folder. Throws UsageError for directions below the painting, and
// what make_film() throws. Returns how many pictures it has.
int write_sweep(const SweepArguments& arguments, const std::string& out, const DrawUnder& draw,
                const Progress& progress);

}  // namespace tangi
