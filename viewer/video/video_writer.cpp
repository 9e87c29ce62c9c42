#include "viewer/video/video_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "viewer/video/ffmpeg_writer_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

class FrameFolder : public Film {
public:
    explicit FrameFolder(fs::path folder) : folder_(std::move(folder)), files_(folder_) {
        if (fs::exists(folder_ / frame(1)))
            fail("{}: has frames already; name another folder, or remove them", folder_.string());
    }
    void add(const Image<Rgb>& encoded_srgb) override {
        told_of(files_.temporary(), folder_,
                [&] { write_picture_8bit(files_.temporary() / frame(++frames_), encoded_srgb); });
    }
    void complete() override {}
    void add_to(OutputSet& set) override { set.add(files_); }

private:
    static std::string frame(int number) { return fmt::format("frame-{:05}.png", number); }

    fs::path folder_;
    FolderFiles files_;
    int frames_ = 0;
};

}  // namespace

bool names_a_video(const fs::path& out) {
    const std::string extension = lower_extension(out);
    return extension == ".mp4" || extension == ".webm";
}

void Film::finish() {
    complete();
    OutputSet set;
    add_to(set);
    set.commit();
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
