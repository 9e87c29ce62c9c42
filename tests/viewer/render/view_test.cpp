// view_test.cpp: where a painting is on the screen, and back.
#include "viewer/render/view.h"

#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr Extent kPainting{600, 400}, kScreen{1000, 800};

Placement placed(const View& view, const glm::dvec2& tilt_deg = {}, bool flat = false) {
    return Placement(view, {{.angle_deg = tilt_deg}, flat}, kPainting, kScreen, 0.1);
}

TEST(View, FitsThePaintingInTheScreen) {
    for (const double turn : {0.0, 90.0, 30.0}) {
        const Placement p = placed(fitted(kPainting, kScreen, turn));
        double widest = 0;
        for (const glm::dvec2 corner :
             {glm::dvec2(0, 0), glm::dvec2(599, 0), glm::dvec2(0, 399), glm::dvec2(599, 399)}) {
            const glm::dvec2 at = p.to_screen(corner);
            EXPECT_TRUE(at.x > 0 && at.y > 0 && at.x < kScreen.width && at.y < kScreen.height);
            widest = std::max({widest, std::abs(at.x / 500 - 1), std::abs(at.y / 400 - 1)});
        }
        EXPECT_GT(widest, 0.93) << "and fills it";
    }
    EXPECT_EQ(fitted(kPainting, {0, 0}).zoom, 1) << "a window resized to nothing";
}

TEST(View, WhatIsUnderTheCursorStaysThere) {
    View view{{200, 150}, 1.5, 25};
    const glm::dvec2 cursor(812, 77);
    glm::dvec2 before, after;
    ASSERT_TRUE(placed(view).to_painting(cursor, before));
    for (const double factor : {1.7, 0.2, 9.0}) {
        ASSERT_TRUE(placed(zoomed(view, factor, cursor, kScreen)).to_painting(cursor, after));
        EXPECT_LT(glm::length(before - after), 1e-9);
    }
    EXPECT_EQ(zoomed(view, 1e9, cursor, kScreen).zoom, View::kLargest);
    EXPECT_EQ(zoomed(view, 1e-9, cursor, kScreen).zoom, View::kSmallest);
}

TEST(View, WhatLiesUnderTwoFingersGoesWithThem) {
    const View view{{200, 150}, 1.5, 25};
    const glm::dvec2 from(812, 77), to(300, 420);
    glm::dvec2 before, after;
    ASSERT_TRUE(placed(view).to_painting(from, before));
    for (const double factor : {1.0, 1.7, 0.2})
        for (const double turn : {0.0, 35.0, -170.0}) {
            const View pinched_view = pinched(view, from, to, factor, turn, kScreen);
            ASSERT_TRUE(placed(pinched_view).to_painting(to, after));
            EXPECT_LT(glm::length(before - after), 1e-9);
            EXPECT_NEAR(pinched_view.zoom, 1.5 * factor, 1e-12);
            EXPECT_NEAR(std::remainder(pinched_view.turn_deg - 25 - turn, 360), 0, 1e-9);
        }
    EXPECT_EQ(pinched(view, from, from, 1e9, 0, kScreen).zoom, View::kLargest);
}

TEST(View, PanningMovesByPixelsOfTheScreen) {
    const View view{{200, 150}, 3, -40};
    const glm::dvec2 spot(210, 120);
    const glm::dvec2 moved = placed(panned(view, {31, -17})).to_screen(spot) - placed(view).to_screen(spot);
    EXPECT_LT(glm::length(moved - glm::dvec2(31, -17)), 1e-9);
}

TEST(Placement, ThereAndBackUnderAnyTilt) {
    for (const glm::dvec2 tilt : {glm::dvec2(0), glm::dvec2(40, -30), glm::dvec2(-70, 60)}) {
        const Placement p = placed({{250, 220}, 0.8, 130}, tilt);
        for (const glm::dvec2 spot : {glm::dvec2(0, 0), glm::dvec2(599, 12), glm::dvec2(333, 399)}) {
            glm::dvec2 back;
            ASSERT_TRUE(p.to_painting(p.to_screen(spot), back));
            EXPECT_LT(glm::length(back - spot), 1e-6);
        }
    }
}

TEST(Placement, ShotsAgreeWithTheCursor) {
    const Placement p = placed({{250, 220}, 0.8, 20}, {35, 20});
    for (const double scale : {1.0, 0.5}) {
        const Shot shot = p.shot(scale, false);
        EXPECT_EQ(shot.width, kScreen.width * scale);
        const glm::dvec2 cursor(700, 300);
        glm::dvec2 spot;
        ASSERT_TRUE(p.to_painting(cursor, spot));
        const Vec3 q = shot.to_painting * Vec3(static_cast<float>(cursor.x * scale),
                                               static_cast<float>((kScreen.height - cursor.y) * scale), 1);
        EXPECT_GT(q.z, 0);
        EXPECT_NEAR(q.x / q.z, spot.x, 0.01);
        EXPECT_NEAR(q.y / q.z, spot.y, 0.01);
    }
}

TEST(Placement, NearerEdgesAreLarger) {
    const Placement p = placed({{299.5, 199.5}, 1, 0}, {30, 0});  // the upper edge comes nearer
    const double above = glm::length(p.to_screen({599, 0}) - p.to_screen({0, 0}));
    const double below = glm::length(p.to_screen({599, 399}) - p.to_screen({0, 399}));
    EXPECT_GT(above, below);
}

TEST(Placement, TheLightStaysInTheRoom) {
    const Vec3 light = direction_of(120, 35);
    // A painting turned towards the light is lit straight on.
    const Angles angles = angles_of(placed({{0, 0}, 1, 90}).in_surface(light));
    EXPECT_NEAR(angles.azimuth_deg, 30, 1e-4);
    EXPECT_NEAR(angles.elevation_deg, 35, 1e-4);
    EXPECT_NEAR(
        placed({}, {0, 30}).in_surface(Vec3(rotation_y(std::numbers::pi / 6) * glm::dvec3(0, 0, 1))).z, 1,
        1e-6);
    // A tilted tablet shows the same picture, lit otherwise.
    const Placement flat = placed({{100, 100}, 1, 0}, {0, 30}, true), upright = placed({{100, 100}, 1, 0});
    EXPECT_LT(glm::length(flat.to_screen({7, 9}) - upright.to_screen({7, 9})), 1e-9);
    EXPECT_GT(glm::length(flat.in_surface(light) - upright.in_surface(light)), 0.1f);
}

TEST(Placement, TheEyeIsWhereItSeesFrom) {
    // The ray from the eye to a spot of the painting passes the screen where the spot is seen: two spots on
    // one ray would be seen at one place. Here: straight ahead, three screen heights away.
    const Shot shot = placed({{299.5, 199.5}, 2, 0}).shot(1, false);
    EXPECT_NEAR(shot.eye.x, 0, 1e-4);
    EXPECT_NEAR(shot.eye.z, 3 * 800 / 2.0 * 0.1, 1e-3);
    const Shot tilted = placed({{299.5, 199.5}, 2, 0}, {0, 40}).shot(1, false);
    EXPECT_NEAR(std::atan2(-tilted.eye.x, tilted.eye.z) * 180 / std::numbers::pi, 40, 1e-3);
}

TEST(Placement, APaintingIsSeenInsideItsBoundsAlone) {
    for (const View& view : {View{{300, 200}, 1, 0}, View{{300, 200}, 0.7, 40}, View{{0, 0}, 3, -10}})
        for (const glm::dvec2 tilt_deg : {glm::dvec2(0, 0), glm::dvec2(40, -30), glm::dvec2(-88, 0)}) {
            const Placement p = placed(view, tilt_deg);
            const Shot shot = p.shot(0.5, false);
            const Region bounds = seen_on(shot, kPainting);
            Region seen{shot.width, shot.height, 0, 0};
            for (int y = 0; y < shot.height; ++y)
                for (int x = 0; x < shot.width; ++x) {
                    glm::dvec2 at;
                    if (!p.to_painting({2 * x + 1, kScreen.height - 2 * y - 1}, at)) continue;
                    if (at.x < -0.5 || at.y < -0.5 || at.x >= 599.5 || at.y >= 399.5) continue;
                    seen = {std::min(seen.x0, x), std::min(seen.y0, y), std::max(seen.x1, x + 1),
                            std::max(seen.y1, y + 1)};
                }
            ASSERT_FALSE(seen.empty());
            EXPECT_TRUE(bounds.x0 <= seen.x0 && bounds.y0 <= seen.y0 && bounds.x1 >= seen.x1 &&
                        bounds.y1 >= seen.y1)
                << tilt_deg.x << ' ' << view.zoom;
            if (tilt_deg.x == 0) {
                EXPECT_LE(bounds.width() - seen.width() + bounds.height() - seen.height(), 10)
                    << "and is not larger";
            }
        }
    EXPECT_EQ(seen_on(placed({{299.5, 199.5}, 1, 0}).shot(1, false), kPainting),
              (Region{199, 199, 801, 601}));
    EXPECT_TRUE(seen_on(placed({{5000, 200}, 1, 0}).shot(1, false), kPainting).empty());
    const Shot near = placed({{300, 200}, 50, 0}).shot(1, false);
    EXPECT_EQ(seen_on(near, kPainting), (Region{0, 0, 1000, 800}));
}

TEST(Placement, DetailSuitsTheZoom) {
    EXPECT_EQ(placed({{0, 0}, 2, 0}).shot(1, false).level, 0);
    EXPECT_EQ(placed({{0, 0}, 0.25, 0}).shot(1, false).level, 2);
    EXPECT_EQ(placed({{0, 0}, 0.25, 0}).shot(0.5, false).level, 3);
}

TEST(Lights, AnglesAndPlacesComeBack) {
    for (const double azimuth : {-170.0, -20.0, 0.0, 77.0})
        for (const double elevation : {5.0, 30.0, 80.0}) {
            const Angles back = angles_of(direction_of(azimuth, elevation));
            EXPECT_NEAR(back.azimuth_deg, azimuth, 1e-4);
            EXPECT_NEAR(back.elevation_deg, elevation, 1e-4);
            const Angles there = light_at(place_of({azimuth, elevation}));
            EXPECT_NEAR(there.azimuth_deg, azimuth, 1e-4);
            EXPECT_NEAR(there.elevation_deg, elevation, 1e-3);
        }
    EXPECT_EQ(light_at({0, 0}).elevation_deg, 90);
    EXPECT_EQ(light_at({3, 4}).elevation_deg, 2) << "beyond the rim";
}

}  // namespace
}  // namespace tangi
