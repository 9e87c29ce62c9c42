#include "cli/time_lapse.h"

#include <array>
#include <utility>

#include "cli/arguments.h"
#include "paint/appearance.h"
#include "surface/atomic_file.h"
#include "surface/picture_file.h"
#include "surface/relight.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// The mean of squares of whole pixels, so that it is at most `width` wide.
Image<Rgb> reduced(const Image<Rgb>& picture, int width) {
    const int side = (picture.width() + width - 1) / width;
    if (side <= 1) return picture;
    Image<Rgb> small(picture.width() / side, std::max(picture.height() / side, 1));
    const int rows = std::min(side, picture.height());
    for (int y = 0; y < small.height(); ++y)
        for (int x = 0; x < small.width(); ++x) {
            Rgb sum(0);
            for (int py = 0; py < rows; ++py)
                for (int px = 0; px < side; ++px) sum += picture(x * side + px, y * side + py);
            small(x, y) = sum / static_cast<float>(side * rows);
        }
    return small;
}

}  // namespace

void TimeLapseArguments::add_to(Flags& flags) {
    flags.option("--frames", folder, "folder for pictures of the painting as it comes into being (.png)");
    flags.option("--every", every_s, "seconds of painting between two of them")
        .check(within(0.01, 1e6))
        .show_default();
    flags.option("--frames-width", width, "they are at most so many pixels wide")
        .check(within(16, 16384))
        .show_default();
    flags.option("--frames-light", light, "direction of their light, X,Y,Z").show_default();
}

TimeLapse::TimeLapse(const TimeLapseArguments& a, Session& session)
    : folder_(a.folder), every_s_(a.every_s), width_(a.width), session_(session) {
    light_.direction = parse_direction(a.light, "--frames-light");
    require_writable_folder(folder_);
    make_folder(folder_);
    if (fs::exists(folder_ / "frame-00001.png"))
        fail("--frames {}: has frames already; name another folder, or remove them", folder_.string());
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

void TimeLapse::finish() { write(); }

void TimeLapse::write() {
    const auto dirty = session_.canvas().take_dirty();
    update_appearance(session_.canvas(), dirty, shown_);
    const Image<Rgb> picture = reduced(relight(shown_, std::array{light_}), width_);
    write_picture(folder_ / fmt::format("frame-{:05}.png", ++frames_), picture, {Transfer::Kind::srgb},
                  {.bits = 8});
    next_s_ = before_s_ + stroke_s_ + every_s_;
}

}  // namespace tangi
