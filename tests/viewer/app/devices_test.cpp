// devices_test.cpp: gamepads, heads, light and gravity as numbers; cameras as video files; sensors as
// folders.
#include "viewer/app/devices.h"

#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "tests/support/test_support.h"
#include "viewer/devices/ambient_light_tracking.h"
#include "viewer/video/video_writer.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = std::numbers::pi / 180;

WindowState some_window() {
    WindowState state;
    state.painting = {400, 300};
    state.view = fitted(state.painting, {800, 600});
    return state;
}

TEST(Gamepad, SticksRestNearTheMiddleAndReachTheirRim) {
    EXPECT_EQ(past_dead_zone({0.1, 0.1}), glm::dvec2(0));
    EXPECT_EQ(past_dead_zone({0.0, 0.15}), glm::dvec2(0));
    EXPECT_NEAR(past_dead_zone({0, -1}).y, -1, 1e-12);
    EXPECT_NEAR(glm::length(past_dead_zone({0.9, 0.9})), 1, 1e-12) << "square rims as well";
    double before = 0;
    for (double x = 0.16; x <= 1; x += 0.01) {
        const double now = past_dead_zone({x, 0}).x;
        EXPECT_GT(now, before);
        EXPECT_LT(now - before, 0.03) << "without a jump";
        before = now;
    }
}

TEST(Gamepad, TiltsMovesTheLightAndZooms) {
    WindowState state = some_window();
    const WindowState start = state;
    GamepadMoment pad;
    EXPECT_FALSE(apply_gamepad(pad, pad, 0.1, {800, 600}, state));
    pad.left = {0, -1};  // towards oneself, as a drag downwards
    EXPECT_TRUE(apply_gamepad(pad, pad, 0.1, {800, 600}, state));
    EXPECT_GT(state.tilt.angle_deg.x, 5);
    EXPECT_GT(dragged(Tilt{}, 0, 0.1, 0.1).angle_deg.x, 0) << "the same way";
    for (int i = 0; i < 100; ++i) apply_gamepad(pad, pad, 0.1, {800, 600}, state);
    EXPECT_EQ(state.tilt.angle_deg.x, Tilt::kMost_deg);

    pad = {.right = {1, 0}};
    for (int i = 0; i < 100; ++i) apply_gamepad(pad, pad, 0.1, {800, 600}, state);
    EXPECT_NEAR(state.lights[0].angles.azimuth_deg, 0, 40) << "on the right";
    EXPECT_NEAR(state.lights[0].angles.elevation_deg, 2, 1) << "at the rim";

    pad = {.closer = 1};
    for (int i = 0; i < 10; ++i) apply_gamepad(pad, pad, 0.1, {800, 600}, state);
    EXPECT_NEAR(state.view.zoom / start.view.zoom, 4, 1e-9) << "whatever the frames";
    EXPECT_NEAR(glm::distance(state.view.centre_px, start.view.centre_px), 0, 1e-9);
}

TEST(Gamepad, ButtonsActOnce) {
    WindowState state = some_window();
    const GamepadMoment up, down{.straighten = true, .shadows = true};
    const bool shadows = state.shadows;
    apply_gamepad(down, up, 0.02, {800, 600}, state);
    apply_gamepad(down, down, 0.02, {800, 600}, state);
    EXPECT_NE(state.shadows, shadows);
    EXPECT_TRUE(state.ask.straighten);
}

TEST(Gamepad, LeavesAPaintingAloneThatIsCompared) {
    WindowState state = some_window();
    state.comparing.on = true;
    const GamepadMoment pad{.left = {1, 0}, .right = {1, 0}};
    EXPECT_FALSE(apply_gamepad(pad, pad, 1, {800, 600}, state));
    EXPECT_EQ(state.tilt.angle_deg, glm::dvec2(0));
}

TEST(OneEuroFilter, FollowsWhatMovesAndSteadiesWhatRests) {
    Random random(3);
    OneEuro filter(1.0, 8.0);
    double in = 0, out = 0;
    glm::dvec2 last(0);
    for (int i = 1; i < 600; ++i) {
        const glm::dvec2 noise(random.real(-0.01, 0.01), 0);
        last = filter(glm::dvec2(0.3, 0) + noise, i / 30.0);
        if (i < 100) continue;
        in += noise.x * noise.x;
        out += (last.x - 0.3) * (last.x - 0.3);
    }
    EXPECT_LT(std::sqrt(out / in), 0.6);
    for (int i = 0; i < 15; ++i) last = filter({0.3 + 0.04 * i, 0}, 20 + i / 30.0);
    EXPECT_NEAR(last.x, 0.3 + 0.04 * 14, 0.12) << "half a second of moving 1.2 a second";
}

TEST(Head, LeftInThePictureIsRightOfTheScreen) {
    EXPECT_NEAR(direction_in_room({0, 0}).z, 1, 1e-6);
    const Vec3 edge = direction_in_room({-0.5, 0});
    EXPECT_NEAR(std::atan2(edge.x, edge.z) / kDegree, kCameraWidth_deg / 2, 1e-4);
    EXPECT_GT(direction_in_room({0, -0.2}).y, 0) << "above";
    HeadFollower head;
    const FaceBox first{{0.1, 0.05}, 0.25};
    EXPECT_NEAR(head.see(first, 0).z, 1, 1e-6) << "wherever the camera is, this is straight on";
    Vec3 now(0);
    for (int i = 1; i < 60; ++i) now = head.see(FaceBox{{-0.2, 0.05}, 0.25}, i / 30.0);
    EXPECT_NEAR(now.x / now.z, 2 * std::tan(30 * kDegree) * 0.3, 0.01);
    EXPECT_NEAR(now.y, 0, 1e-3);
    EXPECT_EQ(head.see({}, 3), now) << "without a face it stays";
    head.recentre();
    EXPECT_NEAR(head.see(FaceBox{{-0.2, 0.05}, 0.25}, 4).z, 1, 1e-6);
}

TEST(Head, FollowsTheSameFace) {
    const FaceBox near{{0.2, 0}, 0.3}, far{{-0.2, 0}, 0.15};
    EXPECT_FALSE(followed({}, near));
    EXPECT_EQ(followed({far, near}, {})->at.x, 0.2) << "the largest";
    EXPECT_EQ(followed({near, far}, FaceBox{{-0.19, 0.01}, 0.15})->at.x, -0.2) << "the one before";
    EXPECT_EQ(followed({near}, FaceBox{{-0.3, 0}, 0.15})->at.x, 0.2) << "which has gone";
}

TEST(Head, MovesTheEyeAndNotThePicture) {
    WindowState state = some_window();
    const Shot straight = placement_of(state, {800, 600}).shot(1, true);
    state.viewer = glm::normalize(Vec3(0.5f, 0.2f, 1));
    const Shot aside = placement_of(state, {800, 600}).shot(1, true);
    EXPECT_EQ(straight.to_painting, aside.to_painting);
    EXPECT_NEAR(glm::distance(glm::normalize(Vec3(aside.eye)), state.viewer), 0, 1e-5);
    EXPECT_NEAR(glm::length(Vec3(aside.eye)), glm::length(Vec3(straight.eye)), 1e-2);
    state.view.turn_deg = 90;  // what was at the right of the screen is at the painting's lower edge
    const Vec3 turned = glm::normalize(Vec3(placement_of(state, {800, 600}).shot(1, true).eye));
    EXPECT_NEAR(turned.y, -state.viewer.x, 1e-5);
    EXPECT_NEAR(turned.x, state.viewer.y, 1e-5);
}

// A room with a window or light at a place of the picture [widths from its middle].
Image<float> room(const glm::dvec2& at, float light) {
    Image<float> picture(64, 48);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::dvec2 from = (glm::dvec2(x, y) - glm::dvec2(31.5, 23.5)) / 64.0 - at;
            picture(x, y) = 0.1f + light * static_cast<float>(glm::length(from) < 0.07);
        }
    return picture;
}

TEST(RoomLight, IsWhereTheLightIs) {
    for (const glm::dvec2& at : {glm::dvec2(0, 0), glm::dvec2(0.25, -0.15), glm::dvec2(-0.3, 0.1)}) {
        const auto found = brightest_direction(room(at, 0.9f));
        ASSERT_TRUE(found);
        const double off_deg = std::acos(std::min(1.0f, glm::dot(*found, direction_in_room(at)))) / kDegree;
        EXPECT_LT(off_deg, 2.5) << at.x << " " << at.y;
    }
    EXPECT_FALSE(brightest_direction(room({0, 0}, 0))) << "evenly bright";
    EXPECT_FALSE(brightest_direction(Image<float>(64, 48))) << "a covered lens";
    EXPECT_FALSE(brightest_direction(Image<float>(1, 1)));
}

// A folder as sysfs has it.
fs::path accelerometer_in(const fs::path& root, const glm::dvec3& raw) {
    const fs::path folder = root / "iio:device1";
    fs::create_directories(folder);
    write_bytes(folder / "name", "accel_3d\n");
    write_bytes(folder / "in_accel_scale", "0.009806\n");
    for (int axis = 0; axis < 3; ++axis)
        write_bytes(folder / fmt::format("in_accel_{}_raw", "xyz"[axis]), fmt::format("{:.0f}\n", raw[axis]));
    return folder;
}

TEST(TiltSensor, ReadsGravityInTheScreensFrame) {
    const TestDir root;
    EXPECT_FALSE(Accelerometer::find(root.path()));
    EXPECT_FALSE(Accelerometer::find("/nowhere"));
    fs::create_directory(root / "iio:device0");
    write_bytes(root / "iio:device0" / "name", "als\n");
    const fs::path folder = accelerometer_in(root.path(), {100, -980, 300});
    const auto found = Accelerometer::find(root.path());
    ASSERT_TRUE(found);
    EXPECT_EQ(found->name(), "accel_3d");
    EXPECT_NEAR(glm::distance(found->read(), 0.009806 * glm::dvec3(100, -980, 300)), 0, 1e-9);
    write_bytes(folder / "in_mount_matrix", "0, -1, 0; 1, 0, 0; 0, 0, 1\n");
    write_bytes(folder / "in_accel_x_scale", "0.02\n");
    const glm::dvec3 mounted = Accelerometer::find(root.path())->read();
    EXPECT_NEAR(glm::distance(mounted, glm::dvec3(980 * 0.009806, 2, 300 * 0.009806)), 0, 1e-9);
    fs::remove(folder / "in_accel_y_raw");
    EXPECT_THROW(found->read(), Error);
}

TEST(TiltSensor, TurnsAreFoundFromGravity) {
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        const glm::dvec2 deg(random.real(-60, 60), random.real(-60, 60));
        // Screens that stand, lie, and lean: gravity in the room's frame, which is the screen's at the
        // beginning.
        const glm::dvec3 neutral =
            9.81 * glm::normalize(glm::dvec3(random.real(-0.2, 0.2), 1, random.real(-1, 2)));
        const glm::dmat3 turn = rotation_x(deg.x * kDegree) * rotation_y(deg.y * kDegree);
        const auto found = tilt_between_deg(neutral, glm::transpose(turn) * neutral);
        ASSERT_TRUE(found);
        // Of all turns that explain gravity it is one: gravity is where it was.
        const glm::dmat3 again = rotation_x(found->x * kDegree) * rotation_y(found->y * kDegree);
        const glm::dvec3 normal = again[2];
        EXPECT_NEAR(glm::dot(normal, glm::normalize(neutral)), glm::dot(turn[2], glm::normalize(neutral)),
                    1e-9);
    }
    // A tablet on the table: both angles are seen.
    const auto lying =
        tilt_between_deg({0, 0, 9.81}, glm::transpose(rotation_x(20 * kDegree)) * glm::dvec3(0, 0, 9.81));
    EXPECT_NEAR(lying->x, 20, 1e-9);
    EXPECT_NEAR(lying->y, 0, 1e-9);
    EXPECT_FALSE(tilt_between_deg({0, 0, 9.81}, {0, 0, 2})) << "falls";
    EXPECT_FALSE(tilt_between_deg({0, 0, 9.81}, {0, 0, -9.81}));
    EXPECT_FALSE(tilt_between_deg({0, 0, 0}, {0, 0, 9.81}));
}

// A frame after another, as the window makes them, until something is so.
bool steps_until(Devices& devices, const std::function<bool()>& done) {
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
        const double now_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        devices.step(now_s, 0.01, {800, 600});
        if (done()) return true;
        if (now_s > 20) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

TEST(Devices, TheTiltSensorTiltsTheScreenUntilItIsGone) {
    const TestDir root;
    accelerometer_in(root.path(), {0, 0, 1000});
    WindowState state = some_window();
    std::string said;
    Devices devices(
        state, {.sensors = root.path(), .wake = [] {}, .say = [&](const std::string& text) { said = text; }});
    state.follow.sensor = true;
    bool stepped = false;
    EXPECT_TRUE(steps_until(devices, [&] { return std::exchange(stepped, true) && devices.polled(); }));
    EXPECT_TRUE(state.flat);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    devices.step(0.1, 0.01, {800, 600});
    accelerometer_in(root.path(), {-500, 0, 866});  // turned by 30 degrees about y
    EXPECT_TRUE(steps_until(devices, [&] { return std::abs(std::abs(state.tilt.angle_deg.y) - 30) < 0.5; }))
        << state.tilt.angle_deg.y;
    state.follow.recentre = true;
    EXPECT_TRUE(steps_until(devices, [&] { return std::abs(state.tilt.angle_deg.y) < 0.5; }));
    fs::remove_all(root / "iio:device1");
    EXPECT_TRUE(steps_until(devices, [&] { return !state.follow.sensor; }));
    EXPECT_THAT(said, testing::HasSubstr("accel_3d cannot be read"));
    devices.step(1, 0.01, {800, 600});
    EXPECT_FALSE(state.flat) << "as it was";
    state.follow.sensor = true;
    devices.step(1, 0.01, {800, 600});
    EXPECT_FALSE(state.follow.sensor);
    EXPECT_THAT(said, testing::HasSubstr("no accelerometer"));
}

// What a camera sees, as a video.
fs::path video_of(const fs::path& file, int pictures, const std::function<Image<Rgb>(int)>& picture) {
    const auto film = make_film(file, 30);
    for (int i = 0; i < pictures; ++i) film->add(picture(i));
    film->finish();
    return file;
}

TEST(Devices, TheLightGoesWhereTheRoomIsBrightUntilTheCameraIsGone) {
    const TestDir folder;
    const fs::path video = video_of(folder / "room.mp4", 40, [](int) {
        Image<Rgb> picture(64, 48);
        const Image<float> grey = room({-0.3, -0.1}, 0.9f);
        for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 64; ++x) picture(x, y) = Rgb(std::pow(grey(x, y), 1 / 2.2f));
        return picture;
    });
    WindowState state = some_window();
    std::string said;
    Devices devices(
        state,
        {.camera = video.string(), .wake = [] {}, .say = [&](const std::string& text) { said = text; }});
    state.follow.light = true;
    const Angles wanted = angles_of(direction_in_room({-0.3, -0.1}));
    EXPECT_TRUE(steps_until(devices, [&] {
        const Angles& light = state.lights[0].angles;
        return std::abs(light.azimuth_deg - wanted.azimuth_deg) < 4 &&
               std::abs(light.elevation_deg - wanted.elevation_deg) < 3;
    }));
    EXPECT_TRUE(steps_until(devices, [&] { return !state.follow.light; })) << "the video ends";
    EXPECT_THAT(said, testing::HasSubstr("gives no more pictures"));
    Devices none(state, {.camera = (folder / "none.mp4").string(),
                         .wake = [] {},
                         .say = [&](const std::string& text) { said = text; }});
    state.follow.head = true;
    EXPECT_TRUE(steps_until(none, [&] { return !state.follow.head; }));
    EXPECT_THAT(said, testing::HasSubstr("cannot be opened"));
    EXPECT_EQ(state.viewer, Vec3(0, 0, 1));
}

// No camera and nobody before it here: a saint of an icon stands for whoever looks, and moves to the left of
// the picture.
TEST(DataHead, AFaceMovesTheEye) {
    TP_DATA(icon, "real/icon");
    const Image<Rgb> lying = read_picture(icon / "image30.jpg");
    constexpr int kPictures = 60, kMoves_px = 160;
    const TestDir folder;
    const fs::path video = video_of(folder / "saint.mp4", kPictures, [&](int i) {
        Image<Rgb> picture(640, 480);
        for (Rgb& c : picture.pixels()) c = Rgb(0.3f);
        const int shift = 200 - kMoves_px * std::clamp(i - 20, 0, 20) / 20;
        for (int y = 0; y < lying.width(); ++y)
            for (int x = 0; x < lying.height(); ++x) {  // his head is at the right: a quarter turn
                const int to_x = x + shift;
                if (to_x < 640 && y < 480) picture(to_x, y) = lying(lying.width() - 1 - y, x);
            }
        return picture;
    });
    WindowState state = some_window();
    std::string said;
    Devices devices(
        state,
        {.camera = video.string(), .wake = [] {}, .say = [&](const std::string& text) { said = text; }});
    state.follow.head = true;
    bool seen = false;
    Vec3 last(0, 0, 1);
    steps_until(devices, [&] {
        seen |= state.follow.sees_head;
        if (state.follow.head) last = state.viewer;
        return !state.follow.head;
    });
    ASSERT_TRUE(seen) << said;
    // To the left of the picture, which is the right of the screen.
    const double moved = 2 * std::tan(kCameraWidth_deg / 2 * kDegree) * kMoves_px / 640.0;
    EXPECT_NEAR(last.x / last.z, moved, 0.1 * moved);
    EXPECT_NEAR(last.y / last.z, 0, 0.05);
}

}  // namespace
}  // namespace tangi
