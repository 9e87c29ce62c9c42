// page_support.h: an exported page in a browser, and what the reference renderer says of it.
#pragma once

#include <fmt/format.h>

#include <optional>

#include "surface/render/relight.h"
#include "tests/programs/support/browser.h"
#include "tests/support/long_test.h"
#include "tests/support/viewer/viewer_support.h"
#include "viewer/render/view.h"

namespace tangi {

inline constexpr int kWidth = 300, kHeight = 270, kScreenWidth = 400, kScreenHeight = 360;

// The page at one pixel for one, without controls, tone curve, ambient light and shadows.
inline std::string url_of(const std::filesystem::path& page, double azimuth_deg, double elevation_deg) {
    return fmt::format("file://{}#ui=0&zoom=1&shadows=0&ambient=0&shoulder=0&azimuth={}&elevation={}",
                       page.string(), azimuth_deg, elevation_deg);
}

// What the reference renderer gives for it, from where the page's eye is: three heights of the screen.
inline Image<Rgb> reference(Surface s, double azimuth_deg, double elevation_deg) {
    s.photography.rig = {.camera_distance_mm = static_cast<float>(3 * kScreenHeight * s.mm_per_pixel)};
    return relight(s, std::array{distant_light(direction_of(azimuth_deg, elevation_deg))});
}

inline Image<Rgb> middle_of(const Image<Rgb>& screenshot) {
    const Transfer srgb{Transfer::Kind::srgb};
    Image<Rgb> picture(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const Rgb& c = screenshot(x + (kScreenWidth - kWidth) / 2, y + (kScreenHeight - kHeight) / 2);
            picture(x, y) = srgb.decode(c);
        }
    return picture;
}

class WebPageInABrowser : public testing::Test {
protected:
    void SetUp() override {
        if (browser_program().empty()) GTEST_SKIP() << "no Chromium here (Debian: chromium-headless-shell)";
        browser_.emplace(scratch_.path());
    }
    void open(const std::string& url) { open_at(url, {kScreenWidth, kScreenHeight}); }
    void open_at(const std::string& url, glm::ivec2 screen) {
        browser_->open(url, screen.x, screen.y);
        ASSERT_TRUE(browser_->becomes_true("document.documentElement.dataset.drawn === 'whole'"))
            << browser_->errors;
    }

    TestDir scratch_;
    std::optional<Browser> browser_;
};

}  // namespace tangi
