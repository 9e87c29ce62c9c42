// video_recorder.h: a film of what the window draws, written beside it: the window draws a picture when there
// is room for one.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "surface/image/image.h"
#include "viewer/model/background_job.h"

namespace tangi {

class Recorder {
public:
    // A film of `pictures` pictures (make_film() in video_writer.h). `wake`, from its thread: there is room,
    // or it is over.
    Recorder(const std::filesystem::path& out, double frames_per_s, int pictures, std::function<void()> wake);
    ~Recorder();  // stops: a film that is not whole is gone
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    int next() const;  // number of the picture that it wants now; -1 where it wants none
    void add(Image<Rgb> encoded_srgb);
    void stop();
    Job::State state() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace tangi
