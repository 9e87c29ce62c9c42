#include "paint/exchange/blade_face.h"

#include <algorithm>

namespace tangi {

namespace {

std::size_t at(int x, int y, std::size_t stride) {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
}

// The part `taken` of the paint on a pixel.
void lift(const StepBox& box, std::size_t canvas, std::size_t load, float taken) {
    const std::size_t films = box.paint.size() / box.load.size();
    float sum = 0, load_sum = 0;
    for (std::size_t i = 0; i < box.load.size(); ++i) {
        float& on_blade = box.load[i][load];
        for (std::size_t film = 0; film < films; ++film) {
            float& paint = box.paint[films * i + film][canvas];
            const float moved = taken * paint;
            paint -= moved;
            on_blade += moved;
            sum += paint;
        }
        load_sum += on_blade;
    }
    box.total_mm[canvas] = sum;
    box.load_total_mm[load] = load_sum;
}

}  // namespace

void lift_onto_face(const StepBox& box, float face_mm, float rate) {
    for (int y = 0; y < box.height; ++y) {
        const RowSpan& span = box.bristles[static_cast<std::size_t>(y)];
        for (int x = span.begin; x < span.end; ++x) {
            const std::size_t canvas = at(x, y, box.canvas_stride);
            const float mm = box.total_mm[canvas],
                        above = box.relief_mm[canvas] + mm - box.underside_mm[at(x, y, box.underside_stride)],
                        rise = std::min(above, mm);  // what is dry stays, and the film on it
            if (rise > face_mm)
                lift(box, canvas, at(x, y, box.load_stride), box.open[canvas] * rate * (rise - face_mm) / mm);
        }
    }
}

}  // namespace tangi
