// video_writer.h: pictures in a row: a video, or numbered pictures in a folder; whole or not at all.
#pragma once

#include <filesystem>
#include <memory>

#include "surface/image/colour.h"
#include "surface/image/image.h"

namespace tangi {

class OutputSet;

class Film {
public:
    virtual ~Film() = default;  // without finish(): nothing of it stays
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    // The next picture, sRGB-encoded 0..1; all have the size of the first.
    virtual void add(const Image<Rgb>& encoded_srgb) = 0;
    // All of it is written, under a temporary name. Throws Error, as on a full disk.
    virtual void complete() = 0;
    virtual void add_to(OutputSet& set) = 0;  // to have its own name with the set; after complete()
    void finish();                            // both, by itself

protected:
    Film() = default;
};

// .mp4 and .webm are videos (ffmpeg_writer_file.h); anything else is a folder.
bool names_a_video(const std::filesystem::path& out);

// Throws Error where it cannot be written, where this machine has no encoder for the video, or where the
// folder has frames already.
std::unique_ptr<Film> make_film(const std::filesystem::path& out, double frames_per_s);

Image<Rgb> encoded_srgb(Image<Rgb> linear);

}  // namespace tangi
