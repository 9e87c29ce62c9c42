#include "cli/time_lapse.h"

#include <array>
#include <utility>

#include "cli/arguments.h"
#include "cli/command.h"
#include "paint/appearance.h"
#include "paint/retouch/treatment_picture.h"
#include "surface/error.h"
#include "surface/relight.h"

namespace tangi {

void TimeLapseArguments::add_to(Flags& flags) {
    flags.option("--frames", folder, "folder for pictures of the painting as it comes into being (.png)");
    flags.option("--video", video, "the same as a video (.mp4 .webm)");
    flags.option("--every", every_s, "seconds of painting between two of them")
        .check(within(0.01, 1e6))
        .show_default();
    film.add_to(flags);
    flags.option("--frames-light", light, "direction of their light, X,Y,Z").show_default();
}

TimeLapse::TimeLapse(const TimeLapseArguments& a, Session& session)
    : every_s_(a.every_s), width_(a.film.width), session_(session) {
    light_.direction = parse_direction(a.light, "--frames-light");
    if (!a.video.empty() && !names_a_video(a.video))
        throw UsageError(
            fmt::format("--video {}: a video is .mp4 or .webm; --frames writes pictures", a.video));
    if (!a.folder.empty() && names_a_video(a.folder))
        throw UsageError(
            fmt::format("--frames {}: is a folder for pictures; --video writes a video", a.folder));
    for (const std::string& out : {a.folder, a.video})
        if (!out.empty()) films_.push_back(make_film(out, a.film.frames_per_s));
    shown_ = appearance(session_.canvas());
    session_.canvas().take_dirty();
    write();
}

void TimeLapse::after(const Event& event) {
    if (const auto* point = std::get_if<PointEvent>(&event)) {
        if (on_painting_) stroke_s_ = point->point.time_s;
    } else if (const auto* stroke = std::get_if<StrokeEvent>(&event)) {
        before_s_ += std::exchange(stroke_s_, 0.0);
        on_painting_ = stroke->on == Place::painting;
    }
    if (before_s_ + stroke_s_ >= next_s_) write();
}

void TimeLapse::finish() {
    write();
    for (const auto& film : films_) film->finish();
}

void TimeLapse::write() {
    const auto dirty = session_.canvas().take_dirty();
    update_appearance(session_.canvas(), dirty, shown_);
    const Image<Rgb> picture = encoded_srgb(reduced(relight(shown_, std::array{light_}), width_, 0));
    for (const auto& film : films_) film->add(picture);
    ++frames_;
    next_s_ = before_s_ + stroke_s_ + every_s_;
}

}  // namespace tangi
