// painter_support.h: a painter of a small painting in a folder of its own.
#pragma once

#include "paint/files/canvas_file.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/paint/record_support.h"
#include "tests/support/viewer/viewer_support.h"
#include "viewer/model/painter.h"

namespace tangi {

namespace fs = std::filesystem;

class PainterTest : public testing::Test {
protected:
    void open(bool is_new = false, const Palette& palette = artist_acrylics()) {
        painter_.reset();
        Painter::Setup setup{is_new || !fs::exists(file_) ? flat_canvas(200, 150) : read_canvas(file_),
                             palette, file_, is_new};
        painter_ = std::make_unique<Painter>(std::move(setup), [] {});
        shown_ = std::make_shared<TexelTiles>(painter_->surface(), painter_->range());
        painter_->start(shown_);
    }

    void stroke(double y_mm = 0) {
        StrokeEvent event;
        event.brush = even_brush();
        event.paint = {{"Titanium White", 1}};
        painter_->send(event);
        for (int i = 0; i <= 20; ++i)
            painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = i - 10.0, .y_mm = y_mm}});
        painter_->send(EndEvent{});
    }

    PainterNews settle() {
        painter_->wait();
        return painter_->fetch();
    }

    TestDir folder_;
    fs::path file_ = folder_ / "a.exr";
    std::unique_ptr<Painter> painter_;
    std::shared_ptr<TexelTiles> shown_;
};

}  // namespace tangi
