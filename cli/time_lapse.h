// time_lapse.h: pictures of a painting as it comes into being: replay --frames.
#pragma once

#include <filesystem>
#include <string>

#include "cli/flags.h"
#include "paint/session.h"

namespace tangi {

struct TimeLapseArguments {
    std::string folder, light = "-0.5,0.5,0.7";
    double every_s = 2;
    int width = 1280;

    void add_to(Flags& flags);
};

// Writes DIR/frame-00001.png, ... while a journal is replayed.
class TimeLapse {
public:
    // Throws UsageError, and Error where the folder can't be written or has frames already.
    TimeLapse(const TimeLapseArguments& arguments, Session& session);

    void after(const Event& event);
    void finish();  // the finished painting
    int frames() const { return frames_; }

private:
    void write();

    std::filesystem::path folder_;
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
