#include "cli/relight/light_sweep.h"

#include <algorithm>
#include <cmath>

#include "cli/arguments.h"
#include "cli/command.h"
#include "retouch/treatment/treatment_picture.h"
#include "viewer/video/light_sweep.h"
#include "viewer/video/video_writer.h"

namespace tangi {

namespace {

Angles corner_of(const std::string& text) {
    const auto n = numbers_in(text, "--sweep", "AZIMUTH,ELEVATION in degrees");
    if (n.size() != 2)
        throw UsageError(fmt::format("--sweep {}: is not AZIMUTH,ELEVATION in degrees, as 180,15", text));
    if (!(std::abs(n[0]) <= 36'000))
        throw UsageError(fmt::format("--sweep {}: an azimuth lies within 36000 degrees, 100 turns", text));
    if (!(n[1] > 0 && n[1] <= 90))
        throw UsageError(fmt::format(
            "--sweep {}: an elevation is above 0 (in the painting's plane) and at most 90 degrees", text));
    return {n[0], n[1]};
}

}  // namespace

void FilmArguments::add_to(Flags& flags) {
    flags.option("--frames-width", width, "pictures of a film are at most so many pixels wide")
        .check(within(16, 16384))
        .show_default();
    flags.option("--frame-rate", frames_per_s, "pictures of a video in a second")
        .check(within(1, 240))
        .show_default();
}

void SweepArguments::add_to(Flags& flags) {
    flags
        .option(
            "--sweep", corners,
            "a film of a light that moves, written to a video (.mp4 .webm) or a folder: AZIMUTH,ELEVATION in "
            "degrees, counter-clockwise from the right, above the painting; given once: once round; several "
            "times: from one to the next")
        .one_value();
    flags.option("--seconds", seconds, "how long the film is").check(within(0.04, 3600)).show_default();
    film.add_to(flags);
}

int write_sweep(const SweepArguments& a, const std::string& out, const DrawUnder& draw,
                const Progress& progress) {
    std::vector<Angles> corners;
    for (const std::string& text : a.corners) corners.push_back(corner_of(text));
    const double frames = std::round(a.seconds * a.film.frames_per_s);
    if (frames > kMostFrames)
        throw UsageError(
            fmt::format("--seconds {} --frame-rate {}: are {:.0f} pictures; a film has {} at most", a.seconds,
                        a.film.frames_per_s, frames, kMostFrames));
    const std::vector<Angles> path = sweep_path(corners, std::max(static_cast<int>(frames), 1));
    if (!names_a_video(out)) require_writable_folder(out);
    const std::unique_ptr<Film> film = make_film(out, a.film.frames_per_s);
    for (std::size_t i = 0; i < path.size(); ++i) {
        report(progress, "sweep", static_cast<double>(i) / static_cast<double>(path.size()));
        const Light light = distant_light(direction_of(path[i].azimuth_deg, path[i].elevation_deg));
        film->add(encoded_srgb(reduced(draw(light), a.film.width, 0)));
    }
    film->finish();
    report(progress, "sweep", 1);
    return static_cast<int>(path.size());
}

}  // namespace tangi
