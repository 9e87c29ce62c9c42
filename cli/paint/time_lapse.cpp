#include "cli/paint/time_lapse.h"

#include <array>
#include <utility>

#include "cli/arguments.h"
#include "cli/command.h"
#include "paint/canvas/appearance.h"
#include "retouch/treatment/treatment_picture.h"
#include "surface/base/error.h"
#include "surface/file/output_set.h"
#include "surface/render/relight.h"

namespace tangi {

namespace {

// [s] With a brush on the painting.
double painted_s(const Journal& journal) {
    double sum = 0, first = 0, last = 0;
    bool on_painting = false, begun = false;
    for (const Journal::Entry& entry : journal.entries)
        if (const auto* stroke = std::get_if<StrokeEvent>(&entry.event)) {
            sum += std::exchange(last, 0.0) - std::exchange(first, 0.0);
            on_painting = stroke->on == Place::painting;
            begun = false;
        } else if (const auto* point = std::get_if<PointEvent>(&entry.event); point && on_painting) {
            if (!std::exchange(begun, true)) first = point->point.time_s;
            last = point->point.time_s;
        }
    return sum + last - first;
}

}  // namespace

void TimeLapseArguments::add_to(Flags& flags) {
    flags.option("--frames", folder, "folder for pictures of the painting as it comes into being (.png)");
    flags.option("--video", video, "the same as a video (.mp4 .webm)");
    flags.option("--every", every_s, "seconds of painting between two of them")
        .check(within(0.01, 1e6))
        .show_default();
    film.add_to(flags);
    flags.option("--frames-light", light, "direction of their light, X,Y,Z").show_default();
    typed = flags.typed();
}

void TimeLapseArguments::refuse_useless() const {
    if (!given())
        refuse_typed(typed(), {"--every", "--frames-width", "--frame-rate", "--frames-light"},
                     "is of a film, and none is asked for; give --video FILM.mp4 or --frames FOLDER too");
    if (video.empty())
        refuse_typed(typed(), {"--frame-rate"}, "is of a video; --frames writes pictures, without a rate");
}

TimeLapse::TimeLapse(const TimeLapseArguments& a, const Journal& journal, Session& session)
    : width_(a.film.width), session_(session) {
    light_.direction = parse_direction_in_front(a.light, "--frames-light");
    if (!a.video.empty() && !names_a_video(a.video))
        throw UsageError(
            fmt::format("--video {}: a video is .mp4 or .webm; --frames writes pictures", a.video));
    if (!a.folder.empty() && names_a_video(a.folder))
        throw UsageError(
            fmt::format("--frames {}: is a folder for pictures; --video writes a video", a.folder));
    if (const double pictures = painted_s(journal) / a.every_s; pictures > kMostFrames)
        throw UsageError(fmt::format("--every {}: are {:.0f} pictures of {}; a film has {} at most",
                                     a.every_s, pictures, journal.source, kMostFrames));
    for (const std::string& out : {a.folder, a.video})
        if (!out.empty()) films_.push_back(make_film(out, a.film.frames_per_s));
    shown_ = appearance(session_.canvas());
    session_.canvas().take_dirty();
    write();
    session_.watch(a.every_s, [this, every_s = a.every_s](double) {
        write();
        return frames_ * every_s;
    });
}

void TimeLapse::complete() {
    write();
    for (const auto& film : films_) film->complete();
}

void TimeLapse::add_to(OutputSet& set) {
    for (const auto& film : films_) film->add_to(set);
}

void TimeLapse::write() {
    const auto dirty = session_.canvas().take_dirty();
    update_appearance(session_.canvas(), dirty, shown_);
    const Image<Rgb> picture = encoded_srgb(reduced(relight(shown_, std::array{light_}), width_, 0));
    for (const auto& film : films_) film->add(picture);
    ++frames_;
}

}  // namespace tangi
