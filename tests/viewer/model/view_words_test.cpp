// view_words_test.cpp: light, view and look as words are the same once they are followed, and pages
// understand them.
#include "viewer/model/view_words.h"

#include "tests/support/test_support.h"

namespace tangi {
namespace {

WindowState some_state() {
    WindowState s;
    s.painting = {400, 300};
    s.lights = {ViewLight{{-70, 20}, 0.5f}, ViewLight{{135, 50}, 1, false},
                ViewLight{{10, 85}, 2, true, true, 1.25f}};
    s.light = 2;
    s.tilt.angle_deg = {12.5, -30};
    s.tilt.speed_deg_per_s = {4, 4};
    s.view = {{123.4, 56.75}, 3.5, -40};
    s.flat = true;
    s.mode = ViewMode::curvature;
    s.strength = 0.25f;
    s.sharpness = 12;
    s.most_curvature = 0.5f;
    s.lowest_mm = -0.125f;
    s.highest_mm = 0.75f;
    s.illuminant = Illuminant::f11;
    s.ambient = 0.11f;
    s.exposure_stops = -1.5f;
    s.shoulder = 0.4f;
    s.light_radius_deg = 6;
    s.shadows = false;
    s.model = WardModel::duer;
    return s;
}

TEST(ViewWords, ShowTheSameAgain) {
    const WindowState was = some_state();
    WindowState s;
    s.painting = was.painting;
    s.sweeping = true;
    follow_view_words(s, view_words(was));
    ASSERT_EQ(s.lights.size(), 2u) << "those that shine";
    EXPECT_EQ(s.light, 0u);
    EXPECT_TRUE(s.lights[0].near) << "the one that is moved first";
    EXPECT_FLOAT_EQ(s.lights[0].distance, 1.25f);
    EXPECT_NEAR(s.lights[0].angles.elevation_deg, 85, 1e-4);
    EXPECT_NEAR(s.lights[1].angles.azimuth_deg, -70, 1e-4);
    EXPECT_FLOAT_EQ(s.lights[1].gain, 0.5f);
    EXPECT_FALSE(s.lights[1].near || s.sweeping || s.tilt.moves());
    EXPECT_EQ(s.tilt.angle_deg, was.tilt.angle_deg);
    EXPECT_EQ(s.view.centre_px, was.view.centre_px);
    EXPECT_EQ(s.view.zoom, was.view.zoom);
    EXPECT_EQ(s.view.turn_deg, was.view.turn_deg);
    EXPECT_TRUE(s.flat);
    EXPECT_EQ(s.mode, was.mode);
    EXPECT_EQ(s.illuminant, was.illuminant);
    EXPECT_EQ(s.model, was.model);
    EXPECT_EQ(s.shadows, was.shadows);
    EXPECT_EQ(view_words(s), view_words(was));
}

TEST(ViewWords, OfAPageAreFollowed) {
    WindowState s = some_state();
    follow_view_words(
        s,
        "azimuth=20&elevation=30&tilt_x=5&tilt_y=0&x=149.5&y=134.5&zoom=1&turn=90&look=4&softness=1.5&"
        "exposure=1&ambient=0.03&shoulder=0.15&colour=ffcc88&shadows=1");
    ASSERT_EQ(s.lights.size(), 1u) << "a page has one light";
    EXPECT_EQ(s.lights[0].angles.azimuth_deg, 20);
    EXPECT_EQ(s.lights[0].gain, 1);
    EXPECT_FALSE(s.lights[0].near);
    EXPECT_EQ(s.mode, ViewMode::height);
    EXPECT_EQ(s.view.turn_deg, 90);
    EXPECT_TRUE(s.shadows);
    EXPECT_EQ(s.exposure_stops, 1);
    EXPECT_EQ(s.illuminant, Illuminant::d65);
    EXPECT_FALSE(s.flat);
}

TEST(ViewWords, BeyondReachAreTheNearestAndWhatIsNoneIsLeftAlone) {
    WindowState s = some_state();
    follow_view_words(
        s, "azimuth=500&elevation=-20&tilt_x=200&zoom=1e9&x=-5&y=1e9&look=77&softness=99&exposure=-9");
    EXPECT_NEAR(s.lights[0].angles.azimuth_deg, 140, 1e-9);
    EXPECT_EQ(s.lights[0].angles.elevation_deg, 2);
    EXPECT_EQ(s.tilt.angle_deg.x, Tilt::kMost_deg);
    EXPECT_EQ(s.view.zoom, View::kLargest);
    EXPECT_EQ(s.view.centre_px, glm::dvec2(0, 299));
    EXPECT_EQ(s.mode, ViewMode::curvature) << "the last";
    EXPECT_EQ(s.light_radius_deg, 15);
    EXPECT_EQ(s.exposure_stops, -4);
    const std::string before = view_words(s);
    for (const char* nothing : {"", "hello", "azimuth=x&elevation=20&zoom=&look=nan", "&&=&="}) {
        WindowState same = s;
        follow_view_words(same, nothing);
        EXPECT_EQ(same.view.zoom, s.view.zoom) << nothing;
        EXPECT_EQ(same.lights.size(), s.lights.size());
        EXPECT_EQ(same.mode, s.mode);
    }
}

}  // namespace
}  // namespace tangi
