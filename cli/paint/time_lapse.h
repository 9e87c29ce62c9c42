// time_lapse.h: films of a painting as it comes into being: replay --frames, --video.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/relight/light_sweep.h"
#include "paint/session/session.h"
#include "viewer/video/video_writer.h"

namespace tangi {

class OutputSet;

struct TimeLapseArguments {
    std::string folder, video, light = "-0.5,0.5,0.7";
    double every_s = 2;
    FilmArguments film;

    void add_to(Flags& flags);
    bool given() const { return !folder.empty() || !video.empty(); }
    // Throws UsageError for flags that say how a film is made which is not asked for.
    void refuse_useless() const;

    std::function<std::vector<std::string>()> typed;  // flags of the command
};

// Writes DIR/frame-00001.png, ..., a video, or both while a journal is replayed; whole or not at all.
// Pictures are as far apart as was asked for, in seconds with the brush on the painting, within strokes too.
class TimeLapse {
public:
    // Of the journal, which is replayed in this session after that. Throws UsageError, as for more pictures
    // than a film has, and Error where they can't be written or the folder has frames already.
    TimeLapse(const TimeLapseArguments& arguments, const Journal& journal, Session& session);
    TimeLapse(const TimeLapse&) = delete;  // the session looks here
    TimeLapse& operator=(const TimeLapse&) = delete;

    void complete();              // with the finished painting; all is written, under temporary names
    void add_to(OutputSet& set);  // to have their own names with it
    int frames() const { return frames_; }

private:
    void write();

    std::vector<std::unique_ptr<Film>> films_;
    Light light_;
    int width_;
    Session& session_;
    Surface shown_;
    int frames_ = 0;
};

}  // namespace tangi
