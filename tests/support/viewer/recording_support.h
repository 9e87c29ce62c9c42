// recording_support.h: a painter whose journals are looked at.
#pragma once

#include <gmock/gmock.h>

#include "tests/support/viewer/painter_support.h"

namespace tangi {

class Recording : public PainterTest {
protected:
    void SetUp() override { write_painting(file_, *flat_surface(200, 150)); }

    void begin_stroke(double y_mm = 0, int points = 10) {
        StrokeEvent event;
        event.brush = even_brush();
        event.paint = {{"Titanium White", 1}};
        painter_->send(event);
        go_on(y_mm, 0, points);
    }
    void go_on(double y_mm, int from, int points) {
        for (int i = from; i < from + points; ++i)
            painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = i - 10.0, .y_mm = y_mm}});
    }
    void expect_record_makes(const fs::path& painting) {
        EXPECT_THAT(read_journal(recovery_files(painting).record).warnings, testing::IsEmpty());
        EXPECT_TRUE(recorded_as_saved(painting));
    }
    std::size_t paints_on_it() {
        std::size_t paints = 0;
        painter_->look([&](const Surface&, const Canvas& now) { paints = now.ingredients().size(); }).get();
        return paints;
    }
    int strokes_in(const Journal& journal) {
        return static_cast<int>(std::ranges::count_if(journal.entries, [](const auto& entry) {
            return std::holds_alternative<StrokeEvent>(entry.event);
        }));
    }

    const RecoveryFiles files_ = recovery_files(file_);
};

}  // namespace tangi
