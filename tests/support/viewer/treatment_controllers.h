// treatment_controllers.h: a small painting with losses on a painter and a desk of treatments, without a
// window.
#pragma once

#include <gmock/gmock.h>

#include <thread>

#include "paint/files/canvas_file.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/retouch/damage_truth.h"
#include "tests/support/viewer/viewer_support.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

inline const PaintingTruth& painting_of_controllers() {
    static const PaintingTruth painting = square_painting(160, 0.5);
    return painting;
}

class TreatmentControllers : public testing::Test {
protected:
    void SetUp() override {
        write_painting(folder_ / "a.exr", surface_of(painting_of_controllers()));
        show(folder_ / "a.exr");
    }
    void TearDown() override { documents_.reset(); }

    void show(const std::filesystem::path& file) {
        if (documents_) documents_->leave();
        painter_.reset();
        painter_ = std::make_unique<Painter>(
            Painter::Setup{read_canvas(file), artist_acrylics(), file, false}, [] {});
        painter_->start(std::make_shared<TexelTiles>(painter_->surface(), painter_->range()));
        if (!documents_)
            documents_.emplace(
                state_, TreatmentController::Setup{{"A. Restorer", "test"},
                                                   artist_acrylics(),
                                                   [] {},
                                                   [this](const std::string& text) { said_.push_back(text); },
                                                   folder_ / "settings"});
        state_.scale_known = true;
        state_.mm_per_pixel = painting_of_controllers().mm_per_pixel;
        documents_->shows(*painter_);
    }
    // Until nothing runs any more.
    void settle() {
        for (int quiet = 0, i = 0; quiet < 4 && i < 12000; ++i) {
            painter_->wait();
            documents_->take();
            documents_->look();
            state_.painter = painter_->fetch().state;
            quiet = state_.treatment_state.job || state_.painter.waiting > 0 ? 0 : quiet + 1;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        painter_->wait();
        state_.painter = painter_->fetch().state;
    }
    void begin() {
        state_.treatment_state.ask.begin = true;
        settle();
        ASSERT_EQ(state_.ask.open, folder_ / "a.treatment" / "painting.exr") << testing::PrintToString(said_);
        show(std::exchange(state_.ask.open, {}));
        settle();
        ASSERT_TRUE(state_.treatment_state.usable) << testing::PrintToString(said_);
    }
    void draw(double x, double y, double to_x, double to_y) {
        auto& touches = state_.treatment_state.touches;
        touches.push_back({MaskTouch::Kind::press, {x, y}});
        touches.push_back({MaskTouch::Kind::drag, {to_x, to_y}});
        touches.push_back({MaskTouch::Kind::release, {}});
        settle();
    }
    void stroke(double y_mm) {
        StrokeEvent event;
        event.brush = brush_presets().at("flat");
        event.brush.size_mm = 8;
        event.paint = {{"Titanium White", 1}};
        painter_->send(event);
        for (int i = 0; i <= 20; ++i)
            painter_->send(PointEvent{{.time_s = 0.01 * i, .x_mm = 3.0 * i - 30, .y_mm = y_mm}});
        painter_->send(EndEvent{});
        settle();
    }
    Treatment treatment() const { return Treatment::open(folder_ / "a.treatment"); }

    TestDir folder_;
    WindowState state_;
    std::vector<std::string> said_;
    std::unique_ptr<Painter> painter_;
    std::optional<TreatmentController> documents_;
};

}  // namespace tangi
