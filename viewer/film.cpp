#include "viewer/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/picture_file.h"
#include "viewer/video_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

class FrameFolder : public Film {
public:
    explicit FrameFolder(fs::path folder) : folder_(std::move(folder)), is_new_(!fs::exists(folder_)) {
        make_folder(folder_);
        if (fs::exists(frame(1)))
            fail("{}: has frames already; name another folder, or remove them", folder_.string());
    }
    ~FrameFolder() override {
        if (finished_) return;
        std::error_code gone;
        for (int i = 1; i <= frames_; ++i) fs::remove(frame(i), gone);
        if (is_new_) fs::remove(folder_, gone);
    }
    void add(const Image<Rgb>& encoded_srgb) override {
        write_picture_8bit(frame(frames_ + 1), encoded_srgb);
        ++frames_;
    }
    void finish() override { finished_ = true; }

private:
    fs::path frame(int number) const { return folder_ / fmt::format("frame-{:05}.png", number); }

    fs::path folder_;
    bool is_new_, finished_ = false;
    int frames_ = 0;
};

}  // namespace

bool names_a_video(const fs::path& out) {
    const std::string extension = lower_extension(out);
    return extension == ".mp4" || extension == ".webm";
}

std::unique_ptr<Film> make_film(const fs::path& out, double frames_per_s) {
    if (names_a_video(out)) return make_video(out, frames_per_s);
    return std::make_unique<FrameFolder>(out);
}

Image<Rgb> encoded_srgb(Image<Rgb> linear) {
    const Transfer srgb{Transfer::Kind::srgb};
    for (Rgb& pixel : linear.pixels()) pixel = srgb.encode(pixel);
    return linear;
}

}  // namespace tangi
