// window_data_test.cpp: a real painting in the real window, from opening to comparing, by pointer and
// keyboard; what is seen is checked against the reference renderer.
#include <gmock/gmock.h>

#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "surface/base/json_reading.h"
#include "surface/render/relight.h"
#include "tests/programs/support/cli_program.h"
#include "tests/programs/support/painting_window.h"
#include "viewer/render/view.h"

namespace tangi {
namespace {

constexpr int kPanels = 300;  // [pixels] of the column
// Places of the panels, with File and Tools folded while one paints.
constexpr std::pair<int, int> kFile{143, 18}, kToolsPart{143, 93}, kMixing{18, 424}, kLayOut{615, 51};

class DataWindow : public Window {
protected:
    // Waits for the program, since a real painting need not be bright in its middle.
    void open(const std::vector<std::string>& further = {}) {
        std::vector<std::string> words = {"paint", painting_.string(), "--size",
                                          fmt::format("{}x{}", Screen::kWidth, Screen::kHeight)};
        words.insert(words.end(), further.begin(), further.end());
        const auto before = screen_->picture();
        program_ = std::make_unique<Program>(words, screen_->conditions());
        ASSERT_TRUE(screen_->becomes_different(before, kCanvas, 0.05)) << program_->wait().err;
        screen_->settled();
    }
};

// [sRGB] What the window shows first of a surface: the usual light, tone curve and shadows, by the reference.
Image<Rgb> reference_of(Surface surface) {
    surface.photography = {};
    const Light light = distant_light(direction_of(135, 50));
    Image<Rgb> picture =
        relight(surface, {&light, 1}, {.cast_shadows = true, .light_radius_deg = 1.5, .ambient = 0.03});
    constexpr float kShoulder = 0.15f, s = 1 - kShoulder;
    for (Rgb& c : picture.pixels()) {
        for (int i = 0; i < 3; ++i)
            if (c[i] > s) c[i] = 1 - kShoulder * kShoulder / (1 - 2 * s + c[i]);
        c = glm::clamp(Transfer{Transfer::Kind::srgb}.encode(c), 0.0f, 1.0f);
    }
    return picture;
}

// Mean difference of what is seen from the reference, over means of squares of the painting that are seen
// whole: a golden picture that comes with no file.
double off_from(const Image<Rgb>& reference, const Image<Rgb>& seen) {
    const Extent painting{reference.width(), reference.height()},
        screen{Screen::kWidth - kPanels, Screen::kHeight};
    const Placement place(fitted(painting, screen), {}, painting, screen, 1);
    constexpr int kSquares = 24, kMargin = 40;  // the probe's and the status line's are left out
    double sum = 0, count = 0;
    for (int v = 1; v + 1 < kSquares; ++v)
        for (int u = 1; u + 1 < kSquares; ++u) {
            const int w = painting.width / kSquares, h = painting.height / kSquares;
            const glm::dvec2 from = place.to_screen({u * w, v * h}),
                             to = place.to_screen({(u + 1) * w, (v + 1) * h});
            const Region r{static_cast<int>(std::ceil(from.x)) + kPanels, static_cast<int>(std::ceil(from.y)),
                           static_cast<int>(to.x) + kPanels, static_cast<int>(to.y)};
            if (r.empty() || r.y0 < 5 * kMargin || r.y1 > Screen::kHeight - kMargin) continue;
            Rgb on_screen(0), in_reference(0);
            for (int y = r.y0; y < r.y1; ++y)
                for (int x = r.x0; x < r.x1; ++x) on_screen += seen(x, y);
            for (int y = v * h; y < (v + 1) * h; ++y)
                for (int x = u * w; x < (u + 1) * w; ++x) in_reference += reference(x, y);
            const Rgb off = glm::abs(on_screen / static_cast<float>(r.width() * r.height()) -
                                     in_reference / static_cast<float>(w * h));
            sum += static_cast<double>(off.r + off.g + off.b) / 3;
            ++count;
        }
    EXPECT_GT(count, 100);
    return sum / count;
}

TEST_F(DataWindow, TheFittedIconIsTiltedLitPaintedMixedSavedAndCompared) {
    TP_DATA(icon, "real/icon");
    const Finished fit = tangipaint({"fit", icon.string(), "--out", painting_.string()});
    ASSERT_NE(fit.code, 1) << fit.err;
    const Surface fitted_icon = read_painting(painting_);
    open();
    const auto upright = screen_->settled();
    EXPECT_LT(off_from(reference_of(fitted_icon), upright), 0.02);

    screen_->drag(3, {kMiddleX, kMiddleY}, {kMiddleX + 90, kMiddleY + 40});
    EXPECT_TRUE(screen_->becomes_different(upright, kCanvas, 0.02)) << "tilted";
    screen_->settled();
    EXPECT_GT(off_from(reference_of(fitted_icon), screen_->picture()), 0.04);
    screen_->key("r");
    EXPECT_TRUE(screen_->becomes_alike(upright, kCanvas, 0.004)) << "straightened";
    screen_->key("l");
    screen_->drag(1, {kMiddleX, kMiddleY}, {kMiddleX + 250, kMiddleY + 60});
    EXPECT_TRUE(screen_->becomes_different(upright, kCanvas, 0.02)) << "lit from elsewhere";
    screen_->settled();

    screen_->key("b");
    click(kFile);
    click(kToolsPart);
    auto before = screen_->settled();
    for (int i = 0; i < 3; ++i) {
        const int y = kMiddleY + 100 + 60 * i;
        screen_->drag(1, {kMiddleX - 120, y}, {kMiddleX + 100, y + 10});
        EXPECT_TRUE(screen_->becomes_different(before, {kMiddleX - 60, y - 5, kMiddleX + 40, y + 15}, 0.01))
            << "stroke " << i + 1;
        before = screen_->settled();
    }
    const Region third{kMiddleX - 60, kMiddleY + 210, kMiddleX + 40, kMiddleY + 235};
    screen_->key("ctrl+z");
    EXPECT_TRUE(screen_->becomes_different(before, third, 0.01)) << "undone";
    screen_->settled();
    screen_->key("ctrl+y");
    EXPECT_TRUE(screen_->becomes_alike(before, third, 0.01)) << "redone";

    click(kMixing);
    click(kLayOut);
    const auto laid_out = screen_->settled();
    screen_->drag(1, {592, 316}, {760, 200});  // through a pile
    EXPECT_TRUE(screen_->becomes_different(laid_out, {600, 200, 760, 330}, 0.003)) << "mixed";
    screen_->settled();
    click(kMixing);  // put away
    screen_->drag(1, {kMiddleX - 120, kMiddleY}, {kMiddleX + 100, kMiddleY + 10});
    screen_->settled();
    screen_->key("ctrl+s");
    screen_->settled();
    const auto json = close().json();
    EXPECT_EQ(json["strokes"], 5);
    EXPECT_EQ(json["saves"], 1);
    EXPECT_EQ(json["unsaved"], false);

    const Canvas canvas = read_canvas(painting_);
    EXPECT_EQ(hash_of(canvas.dry()), hash_of(fitted_icon)) << "the dry layer never changes";
    double mm3 = 0;
    for (const double volume : canvas.volumes_mm3()) mm3 += volume;
    EXPECT_GT(mm3, 0);
    open();
    EXPECT_LT(off_from(reference_of(appearance(canvas)), screen_->picture()), 0.02) << "as it was saved";
    EXPECT_EQ(close().code, 0);

    open({"--photos", icon.string()});
    screen_->key("ctrl+r");
    screen_->settled();
    screen_->enter((folder_ / "report").string());
    const fs::path page = folder_ / "report" / "compare.html";
    EXPECT_TRUE(Screen::until([&] { return fs::exists(page); }) ||
                Screen::until([&] { return fs::exists(page); }));
    const auto report = read_json(bytes_of(folder_ / "report" / "compare.json"), "JSON");
    EXPECT_GT(report["photos"].size(), 60u);
    EXPECT_GT(report["mean"]["fitted"]["psnr_db"], 30.0);
    EXPECT_EQ(close().code, 0);
}

}  // namespace
}  // namespace tangi
