// immersive_test.cpp: the painting in the room (WebXR), with a stand-in for the device (xr_device.js).
#include <gmock/gmock.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "surface/file/atomic_file.h"
#include "tests/support/viewer/viewer_support.h"
#include "tests/web/held_reference.h"
#include "tests/web/tablet.h"
#include "web/engine/ground.h"

namespace tangi {
namespace {

using nlohmann::json;

constexpr glm::ivec2 kEye(400, 300);  // [pixels], of xr_device.js
constexpr double kFocal = 900;        // [pixels]
constexpr double kAtFirst_m = 1.2;    // immersive.js

json matrix(const glm::dmat4& m) { return std::vector<double>(glm::value_ptr(m), glm::value_ptr(m) + 16); }

// Of an eye that looks along -z.
glm::dmat4 projection() {
    glm::dmat4 p(0);
    p[0][0] = 2 * kFocal / kEye.x;
    p[1][1] = 2 * kFocal / kEye.y;
    p[2][2] = -1.0001;
    p[2][3] = -1;
    p[3][2] = -0.01;
    return p;
}

struct Seen {
    Image<Rgb> colour;  // [linear]
    Image<float> alpha;
};

class WebImmersive : public WebApplication {
protected:
    void start_with_device() {
        tablet_->browser().call(
            "Page.addScriptToEvaluateOnNewDocument",
            {{"source", read_text_file(std::filesystem::path(TP_SOURCE_DIR) / "tests/web/xr_device.js")}});
        begin();
        tablet_->await(
            "Object.assign(tangipaint.look, {light: {azimuth: 130, elevation: 40}, ambient: 0, "
            "shoulder: 0}), 1");
    }
    json button(const char* then = "") {
        tablet_->await("document.getElementById('open-light').click()");
        const json there = tablet_->await(
            fmt::format("(() => {{ const b = [...document.querySelectorAll('#sheet-light button')].find(b => "
                        "b.textContent === 'Into the room'); if (b) b{}; return Boolean(b); }})()",
                        then));
        tablet_->await("document.getElementById('open-light').click()");
        return there;
    }
    void enter() {
        ASSERT_EQ(button(".click()"), true);
        ASSERT_TRUE(tablet_->browser().becomes_true("!document.getElementById('in-room').hidden"))
            << tablet_->browser().errors;
        set("projection", matrix(projection()));
        tablet_->await("xr.frame()");  // the painting is hung before the viewer
    }
    void set(const char* name, const json& value) {
        tablet_->await(fmt::format("xr.{} = {}, 1", name, value.dump()));
    }
    // What the eye sees, once all is there that it wants.
    Seen seen() {
        for (int i = 0; i < 100; ++i) {
            tablet_->await("xr.frame()");
            if (tablet_->await("tangipaint.open.view.drawing.tiles.complete") == true) break;
            std::this_thread::sleep_for(std::chrono::milliseconds(30));
        }
        tablet_->await("xr.frame()");
        const json bytes = tablet_->await("xr.pixels()");
        Seen result{Image<Rgb>(kEye.x, kEye.y), Image<float>(kEye.x, kEye.y)};
        for (int y = 0; y < kEye.y; ++y)
            for (int x = 0; x < kEye.x; ++x) {
                const auto at = [&, row = kEye.y - 1 - y](int c) {
                    return bytes[static_cast<std::size_t>(4 * (row * kEye.x + x) + c)].get<float>() / 255;
                };
                result.colour(x, y) = kSrgb.decode({at(0), at(1), at(2)});
                result.alpha(x, y) = at(3);
            }
        return result;
    }
    static Image<Rgb> middle_of(const Image<Rgb>& seen, const Surface& s) {
        Image<Rgb> middle(s.width(), s.height());
        const glm::ivec2 corner = (kEye - glm::ivec2(s.width(), s.height())) / 2;
        for (int y = 0; y < s.height(); ++y)
            for (int x = 0; x < s.width(); ++x) middle(x, y) = seen(x + corner.x, y + corner.y);
        return middle;
    }
};

TEST_F(WebImmersive, IsOfferedWhereADeviceHasIt) {
    begin();
    EXPECT_EQ(button(), false) << "a browser without a device";
    start();
    start_with_device();
    EXPECT_EQ(button(), true);
    set("refuses", "no");
    EXPECT_EQ(button(".click()"), true);
    ASSERT_TRUE(tablet_->browser().becomes_true(
        "document.getElementById('notice').textContent.includes('not allowed')"));
    EXPECT_EQ(tablet_->await("document.getElementById('in-room').hidden"), true);
    EXPECT_EQ(tablet_->browser().errors, "");
}

// One pixel as one, from where the reference renderer's eye is: the same picture, and the room around it.
TEST_F(WebImmersive, ShowsThePaintingInItsTrueSizeUnderTheRoomsLight) {
    start_with_device();
    enter();
    const Surface s = make_ground(kSmall);
    const double distance_m = kFocal * s.mm_per_pixel / 1000;
    set("head", matrix(glm::translate(glm::dmat4(1), {0, 0, distance_m - kAtFirst_m})));
    const Seen level = seen();
    const auto expected = [&](const Vec3& light) {
        return reference_held(s, light, 1000 * distance_m, glm::dmat3(1));
    };
    EXPECT_GE(part_within(middle_of(level.colour, s), expected(direction_of(130, 40)), 3), 0.97);
    const glm::ivec2 corner = (kEye - glm::ivec2(s.width(), s.height())) / 2;
    for (int y = 0; y < kEye.y; ++y)
        for (int x = 0; x < kEye.x; ++x) {
            const glm::ivec2 at = glm::ivec2(x, y) - corner;
            const bool on = at.x >= 0 && at.y >= 0 && at.x < s.width() && at.y < s.height();
            ASSERT_EQ(level.alpha(x, y), on ? 1.0f : 0.0f) << x << " " << y;
        }
    // The device's estimate; of a light behind the painting, from before it.
    const Vec3 light = direction_of(-20, 35);
    for (const float side : {1.0f, -1.0f}) {
        set("light", {{"x", light.x}, {"y", light.y}, {"z", side * light.z}});
        EXPECT_GE(part_within(middle_of(seen().colour, s), expected(light), 3), 0.97) << side;
    }
    EXPECT_LT(part_within(middle_of(level.colour, s), expected(light), 3), 0.5);
    tablet_->await("document.getElementById('leave-room').click()");
    EXPECT_TRUE(tablet_->browser().becomes_true("document.getElementById('in-room').hidden"));
    ASSERT_TRUE(tablet_->is_drawn());
    EXPECT_EQ(tablet_->browser().errors, "");
}

// On the wall and on the table that the viewer taps, and nowhere else: as GLM projects its corners.
TEST_F(WebImmersive, HangsWhereTheViewerPoints) {
    start_with_device();
    enter();
    const Surface s = make_ground(kSmall);
    const glm::dvec3 viewer(0.02, 0.05, 0.1), wall = glm::normalize(glm::dvec3(0.6, 0, 0.8));
    const glm::dvec2 half = glm::dvec2(s.width(), s.height()) * double(s.mm_per_pixel) / 2000.0;
    struct Spot {
        glm::dvec3 at, normal, up;
    };
    for (const Spot& place :
         {Spot{{0.05, 0.02, -0.4}, wall, {0, 1, 0}},
          Spot{{0, -0.25, -0.3}, {0, 1, 0}, glm::normalize(glm::dvec3(-0.02, 0, -0.4))}}) {
        glm::dmat4 hit(1);  // its y axis is the normal of what was hit
        hit[1] = glm::dvec4(place.normal, 0);
        hit[2] = glm::dvec4(glm::cross(place.up, place.normal), 0);
        hit[0] = glm::dvec4(glm::cross(glm::dvec3(hit[1]), glm::dvec3(hit[2])), 0);
        hit[3] = glm::dvec4(place.at, 1);
        const glm::dmat4 head =
            glm::inverse(glm::lookAt(viewer, place.at + glm::dvec3(0.01, 0, 0), {0, 1, 0}));
        set("head", matrix(head));
        set("hit", matrix(hit));
        tablet_->await("xr.frame()");
        tablet_->await("xr.select()");
        const Seen shown = seen();
        const glm::dvec3 right = glm::cross(place.up, place.normal);
        int differ = 0, on_it = 0;
        const glm::dmat4 to_room = glm::inverse(projection() * glm::inverse(head));
        for (int y = 0; y < kEye.y; ++y)
            for (int x = 0; x < kEye.x; ++x) {
                const glm::dvec4 far =
                    to_room * glm::dvec4(2 * (x + 0.5) / kEye.x - 1, 1 - 2 * (y + 0.5) / kEye.y, 0, 1);
                const glm::dvec3 ray = glm::dvec3(far) / far.w - viewer;
                const double way = glm::dot(place.at - viewer, place.normal) / glm::dot(ray, place.normal);
                const glm::dvec3 from_middle = viewer + way * ray - place.at;
                const bool on = way > 0 && std::abs(glm::dot(from_middle, right)) < half.x &&
                                std::abs(glm::dot(from_middle, place.up)) < half.y;
                on_it += on;
                differ += on != (shown.alpha(x, y) > 0.5f);
            }
        EXPECT_GT(on_it, 5000);
        EXPECT_LT(differ, 0.002 * kEye.x * kEye.y) << on_it;
    }
    EXPECT_EQ(tablet_->browser().errors, "");
}

}  // namespace
}  // namespace tangi
