// time_lapse.h: films of a painting as it comes into being: replay --frames, --video.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/sweep.h"
#include "paint/session.h"
#include "viewer/film.h"

namespace tangi {

struct TimeLapseArguments {
    std::string folder, video, light = "-0.5,0.5,0.7";
    double every_s = 2;
    FilmArguments film;

    void add_to(Flags& flags);
    bool given() const { return !folder.empty() || !video.empty(); }
};

// Writes DIR/frame-00001.png, ..., a video, or both while a journal is replayed; whole or not at all.
class TimeLapse {
public:
    // Throws UsageError, and Error where they can't be written or the folder has frames already.
    TimeLapse(const TimeLapseArguments& arguments, Session& session);

    void after(const Event& event);
    void finish();  // the finished painting
    int frames() const { return frames_; }

private:
    void write();

    std::vector<std::unique_ptr<Film>> films_;
    Light light_;
    double every_s_;
    int width_;
    Session& session_;
    Surface shown_;
    double before_s_ = 0, stroke_s_ = 0, next_s_ = 0;  // time with the brush on the painting
    bool on_painting_ = true;
    int frames_ = 0;
};

}  // namespace tangi
