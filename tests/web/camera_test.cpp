// camera_test.cpp: the room in the web application: light that a camera sees, its picture behind the
// painting, and a screen that the browser turns while the tablet is tilted. The camera is a file that
// Chromium takes for one.
#include <gmock/gmock.h>

#include <fstream>

#include "tests/support/viewer/viewer_support.h"
#include "tests/web/held_reference.h"
#include "tests/web/tablet.h"
#include "web/engine/ground.h"

namespace tangi {
namespace {

using nlohmann::json;

constexpr int kVideoWidth = 640, kVideoHeight = 480;
constexpr double kFieldOfView = 66;  // [degrees], of web/app/camera.js

// A grey room with a light around a place of the picture, 0..1 from its upper left (YUV4MPEG2, 4:2:0, without
// colours).
void write_video(const std::filesystem::path& path, glm::dvec2 lamp) {
    std::ofstream file(path, std::ios::binary);
    file << fmt::format("YUV4MPEG2 W{} H{} F10:1 Ip A1:1 C420jpeg\n", kVideoWidth, kVideoHeight);
    std::string luma(std::size_t{kVideoWidth} * kVideoHeight, char(60));
    for (int y = 0; y < kVideoHeight; ++y)
        for (int x = 0; x < kVideoWidth; ++x)
            if (glm::distance(glm::dvec2(x, y), lamp * glm::dvec2(kVideoWidth, kVideoHeight)) < 40)
                luma[static_cast<std::size_t>(y * kVideoWidth + x)] = char(230);
    const std::string chroma(luma.size() / 2, char(128));
    for (int frame = 0; frame < 5; ++frame) file << "FRAME\n" << luma << chroma;
}

// Where the lamp is for who looks at the screen: x right, y up, z towards the viewer, or away from him.
Vec3 seen_from_screen(glm::dvec2 lamp, bool away) {
    const double scale = 2 * std::tan(kFieldOfView / 2 * std::numbers::pi / 180);
    const double x = (lamp.x - 0.5) * scale, y = (0.5 - lamp.y) * scale * kVideoHeight / kVideoWidth;
    return glm::normalize(Vec3(away ? x : -x, y, 1));
}

std::string words(const Vec3& v) { return fmt::format("({}, {}, {}) ", v.x, v.y, v.z); }

class WebCamera : public WebApplication {
protected:
    void start_with_lamp(glm::dvec2 lamp) {
        const std::filesystem::path video = scratch_ / "room.y4m";
        write_video(video, lamp);
        start({"--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream",
               "--use-file-for-fake-video-capture=" + video.string()});
    }
    void press(const std::string& toggle) {
        tablet_->await("document.getElementById('open-light').click()");
        tablet_->await(
            "[...document.querySelectorAll('#sheet-light [role=switch]')].find(e => e.ariaLabel === " +
            json(toggle).dump() + ").click()");
    }
    void close_sheet() { tablet_->await("document.getElementById('open-light').click()"); }
    Vec3 light() {
        const json light = state("look.light");
        return direction_of(light["azimuth"].get<double>(), light["elevation"].get<double>());
    }
    // The light that comes over the painting is this one, to a cell of the 32 x 24 that it is looked for in.
    bool light_becomes(const Vec3& expected) {
        for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(50)))
            if (glm::distance(light(), expected) < 0.05f) return true;
        return false;
    }
};

TEST_F(WebCamera, LightsThePaintingFromWhereItSeesALamp) {
    for (const glm::dvec2 lamp : {glm::dvec2(0.2, 0.25), glm::dvec2(0.7, 0.8)}) {
        start_with_lamp(lamp);
        begin();
        press("Light from the camera");
        EXPECT_TRUE(light_becomes(seen_from_screen(lamp, false))) << words(light());
        EXPECT_EQ(tablet_->await("getComputedStyle(document.getElementById('room')).display"), "none");
        for (const std::string& url : tablet_->browser().requests)
            EXPECT_TRUE(url.starts_with(server_.url()) || url.starts_with("blob:") ||
                        url.starts_with("about:"))
                << url << ": pictures stay on the page";
        EXPECT_EQ(tablet_->browser().errors, "");
    }
}

// The lamp stays in the room while the tablet, and its camera, are turned.
TEST_F(WebCamera, KeepsTheLampInTheRoomAsTheTabletIsHeld) {
    const glm::dvec2 lamp(0.5, 0.2);
    start_with_lamp(lamp);
    tablet_->allow_sensor(true);
    tablet_->hold(0, 0, 0);
    begin();
    press("Follow the tablet’s tilt");
    ASSERT_TRUE(tablet_->browser().becomes_true("!!tangipaint.look.held"));
    close_sheet();
    press("Light from the camera");
    close_sheet();
    tablet_->hold(0, 20, 0);
    const Vec3 in_room(held_screen(0, 20, 0, 90) * glm::dvec3(seen_from_screen(lamp, false)));
    EXPECT_TRUE(light_becomes(in_room)) << words(light()) << words(in_room);
}

// The painting hangs in the room that the camera at the back sees, lit by its lamp, and stays there as the
// tablet turns.
TEST_F(WebCamera, ShowsThePaintingInTheRoom) {
    const glm::dvec2 lamp(0.06, 0.5);
    start_with_lamp(lamp);
    tablet_->allow_sensor(true);
    tablet_->hold(0, 0, 0);
    begin();
    press("Camera behind the painting");
    ASSERT_TRUE(tablet_->browser().becomes_true("document.getElementById('room').videoWidth > 0"));
    EXPECT_TRUE(light_becomes(seen_from_screen(lamp, true))) << words(light());
    close_sheet();
    press("Follow the tablet’s tilt");
    ASSERT_TRUE(tablet_->browser().becomes_true("!!tangipaint.look.held"));
    close_sheet();
    tablet_->await("document.getElementById('easel').classList.add('bare')");
    tablet_->await("tangipaint.open.view.fit()");
    ASSERT_TRUE(tablet_->is_drawn());
    const auto shot = [&] { return tablet_->browser().screenshot(); };
    const auto is_room = [](const Rgb& c) {
        return std::abs(c.r - c.g) < 0.02f && std::abs(c.r - 60 / 255.0f) < 0.08f;
    };
    const Image<Rgb> level = shot();
    EXPECT_TRUE(is_room(level(60, 40))) << "beside the painting";
    EXPECT_GT(level(48, 300).r, 0.7f) << "the lamp, of a picture that fills the screen";
    EXPECT_FALSE(is_room(level(400, 300))) << "the painting";
    // Turned to the left about the screen's upright edge, the painting moves to the right, as the room does.
    const double focal = 800 / 2.0 / std::tan(kFieldOfView / 2 * std::numbers::pi / 180), turn = 12;
    const json before = tablet_->await("tangipaint.open.view.placement().toScreen(160, 120)");
    for (const double angle : {turn, -turn}) {
        tablet_->hold(0, angle, 0);  // with the screen in landscape, the device's x axis is upright
        ASSERT_TRUE(tablet_->is_drawn());
        const json after = tablet_->await("tangipaint.open.view.placement().toScreen(160, 120)");
        const double way = focal * std::tan(angle * std::numbers::pi / 180);
        EXPECT_NEAR(std::abs(after[0].get<double>() - before[0].get<double>()), std::abs(way), 8);
        EXPECT_NEAR(after[1].get<double>(), before[1].get<double>(), 4);
        const Image<Rgb> turned = shot();
        const bool to_right = after[0] > before[0];
        EXPECT_TRUE(is_room(turned(to_right ? 160 : 640, 300))) << "where the painting was: " << angle;
        EXPECT_FALSE(is_room(turned(static_cast<int>(after[0].get<double>()), 300)));
    }
    press("Camera behind the painting");
    ASSERT_TRUE(tablet_->browser().becomes_true("document.getElementById('room').hidden"));
    // With the next picture.
    EXPECT_TRUE(tablet_->browser().becomes_true("document.getElementById('picture').style.clipPath === ''"));
    EXPECT_EQ(tablet_->browser().errors, "");
}

// The browser turns what it shows while the tablet is tilted: the light stays where it is in the room, at
// once.
TEST_F(WebCamera, KeepsTheLightWhenTheScreenIsTurnedDuringATilt) {
    tablet_->allow_sensor(true);
    tablet_->hold(0, 0, 0);
    begin(600, 800);
    const Surface s = make_ground(kSmall);
    press("Follow the tablet’s tilt");
    ASSERT_TRUE(tablet_->browser().becomes_true("!!tangipaint.look.held"));
    close_sheet();
    tablet_->await("document.getElementById('easel').classList.add('bare')");
    const auto expect_lit = [&](glm::ivec2 screen, double screen_angle, const char* when) {
        tablet_->await(
            fmt::format("Object.assign(tangipaint.look, {{view: {{x: {}, y: {}, zoom: 1, turn: 0}}, light: "
                        "{{azimuth: 130, elevation: 40}}, ambient: 0, shoulder: 0}}), "
                        "tangipaint.open.view.ask()",
                        (s.width() - 1) / 2.0, (s.height() - 1) / 2.0));
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        ASSERT_TRUE(tablet_->is_drawn());
        const glm::ivec2 corner((screen.x - s.width()) / 2, (screen.y - s.height()) / 2);
        const Image<Rgb> shot = tablet_->browser().screenshot();
        Image<Rgb> seen(s.width(), s.height());
        for (int y = 0; y < s.height(); ++y)
            for (int x = 0; x < s.width(); ++x) seen(x, y) = kSrgb.decode(shot(x + corner.x, y + corner.y));
        const Image<Rgb> expected = reference_held(s, direction_of(130, 40), 3 * screen.y * s.mm_per_pixel,
                                                   held_screen(25, -10, 15, screen_angle));
        EXPECT_GE(part_within(seen, expected, 3), 0.97) << when;
    };
    tablet_->hold(25, -10, 15);
    expect_lit({600, 800}, 0, "upright");
    tablet_->resize(800, 600);  // and the sensor says nothing new
    expect_lit({800, 600}, 90, "turned");
    tablet_->resize(600, 800);
    expect_lit({600, 800}, 0, "back");
    EXPECT_EQ(tablet_->browser().errors, "");
}

}  // namespace
}  // namespace tangi
