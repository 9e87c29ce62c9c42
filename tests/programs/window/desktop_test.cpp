// desktop_test.cpp: the real window on a desktop: its monitor's profile and scale, files dropped on
// it, a fit from photographs, a film.
#include <lcms2.h>

#include "tests/programs/support/window_screen.h"
#include "tests/programs/support/x_client.h"
#include "tests/support/viewer/viewer_support.h"
#include "viewer/devices/x11_connection.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

Surface painting_of(const Rgb& colour) {
    Surface s = painted_surface(160, 120);
    for (Rgb& c : s.diffuse.pixels()) c = colour;
    return s;
}

class OnADesktop : public testing::Test {
protected:
    void SetUp() override {
        screen_ = Screen::open();
        if (!screen_) GTEST_SKIP() << "no Xvfb and xdotool here";
        desktop_ = std::make_unique<XClient>(screen_->conditions().environment.at("DISPLAY"));
        write_painting(folder_ / "red.exr", painting_of({0.7f, 0.2f, 0.1f}));
    }
    void start(int width = Screen::kWidth, int height = Screen::kHeight) {
        program_ = std::make_unique<Program>(
            std::vector<std::string>{"paint", (folder_ / "red.exr").string(), "--size",
                                     fmt::format("{}x{}", width, height), "--camera", "/nowhere"},
            screen_->conditions());
        ASSERT_TRUE(Screen::until([&] {
            return !program_->running() || glm::length(screen_->picture()(width * 4 / 5, height / 2)) > 0.3f;
        }));
        screen_->settled();
        ASSERT_TRUE(program_->running()) << program_->wait().err;
    }
    Finished close() {
        screen_->key("ctrl+q");
        return program_->wait();
    }

    TestDir folder_;
    std::unique_ptr<Screen> screen_;
    std::unique_ptr<XClient> desktop_;
    std::unique_ptr<Program> program_;
};

// A monitor that shows red where others show green: what it is told is the other way round.
std::string crossed_profile() {
    const cmsCIExyY white{0.3127, 0.3290, 1};
    const cmsCIExyYTRIPLE crossed{{0.30, 0.60, 1}, {0.64, 0.33, 1}, {0.15, 0.06, 1}};
    cmsToneCurve* curve = cmsBuildGamma(nullptr, 2.2);
    cmsToneCurve* curves[] = {curve, curve, curve};
    cmsHPROFILE profile = cmsCreateRGBProfile(&white, &crossed, curves);
    cmsFreeToneCurve(curve);
    cmsUInt32Number size = 0;
    cmsSaveProfileToMem(profile, nullptr, &size);
    std::string icc(size, '\0');
    cmsSaveProfileToMem(profile, icc.data(), &size);
    cmsCloseProfile(profile);
    return icc;
}

TEST_F(OnADesktop, ShowsTheMonitorsColoursAndWritesSrgb) {
    desktop_->set_profile(crossed_profile());
    start();
    const Rgb shown = screen_->picture()(kMiddleX, kMiddleY);
    EXPECT_GT(shown.g, 1.5f * shown.r);
    screen_->key("F12");
    const fs::path snapshot = folder_ / "red-1.png";
    EXPECT_TRUE(Screen::until([&] { return fs::exists(snapshot); }));
    const Image<Rgb> written = read_picture(snapshot);
    const Rgb middle = written(written.width() / 2, written.height() / 2);
    EXPECT_GT(middle.r, 1.5f * middle.g);
    EXPECT_EQ(close().code, 0);
    desktop_->set_profile("no profile");
    start();
    const Rgb plain = screen_->picture()(kMiddleX, kMiddleY);
    EXPECT_GT(plain.r, 1.5f * plain.g) << "a bad one is no reason not to paint";
    EXPECT_EQ(close().code, 0);
}

TEST_F(OnADesktop, PanelsAreAsLargeAsTheDesktopAsks) {
    desktop_->set_dpi(192);
    start();
    const Image<Rgb> picture = screen_->picture();
    const auto red = [&](const Region& region) {
        int count = 0;
        for (int y = region.y0; y < region.y1; ++y)
            for (int x = region.x0; x < region.x1; ++x)
                count += picture(x, y).r > 0.3f && picture(x, y).r > 1.5f * picture(x, y).b;
        return count;
    };
    EXPECT_GT(red({700, 300, 900, 400}), 15'000) << "the painting";
    EXPECT_EQ(red({320, 150, 590, 340}), 0) << "lies beside a column of 600 pixels";
    EXPECT_EQ(close().code, 0);
}

int heard_errors = 0;  // by the handler of others

TEST_F(OnADesktop, ADeviceThatIsGoneIsNoErrorButOthersAre) {
    ::setenv("DISPLAY", screen_->conditions().environment.at("DISPLAY").c_str(), 1);
    const auto others = +[](Display*, XErrorEvent*) { return ++heard_errors; };
    const XErrorHandler before = XSetErrorHandler(others);
    Display* other = XOpenDisplay(nullptr);
    ASSERT_TRUE(other);
    constexpr int kNoDevice = 117, kMotion = 6;  // XI_Motion
    {
        const X11Connection pens(0), fingers(2);
        for (const X11Connection* each : {&pens, &fingers}) {
            ASSERT_TRUE(each->display());
            each->select(0, kNoDevice, {kMotion});
            XSync(each->display(), False);
        }
        EXPECT_EQ(heard_errors, 0);
        XUnmapWindow(other, 0x7fffff);
        XSync(other, False);
        EXPECT_EQ(heard_errors, 1) << "another's goes where it went before";
        fingers.select(0, kNoDevice, {kMotion});  // on its way when the connection ends
    }
    EXPECT_EQ(heard_errors, 1);
    EXPECT_EQ(XSetErrorHandler(before), others) << "and all is as it was";
    XCloseDisplay(other);
}

TEST_F(OnADesktop, OpensWhatIsDroppedOnIt) {
    const fs::path blue = folder_ / "a blue %one.exr";
    write_painting(blue, painting_of({0.1f, 0.2f, 0.7f}));
    start();
    std::string uri = "file://" + folder_.path().string() + "/a%20blue%20%25one.exr\r\n";
    ASSERT_TRUE(desktop_->drop(uri, kMiddleX, kMiddleY));
    EXPECT_TRUE(Screen::until([&] {
        const Rgb c = screen_->picture()(kMiddleX, kMiddleY);
        return c.b > 1.5f * c.r;
    }));
    EXPECT_TRUE(desktop_->drop("file:///nowhere/none.exr\r\n", kMiddleX, kMiddleY));
    screen_->settled();
    EXPECT_EQ(close().json()["painting"], blue.string());
}

TEST_F(OnADesktop, FitsPhotographsAndFilmsThem) {
    const TinyStack stack;
    start(480, 320);  // a film of it is soon made
    ASSERT_TRUE(desktop_->drop("file://" + stack.path() + "\r\n", 400, 150));
    screen_->settled();
    screen_->key("Return");  // fit them
    const fs::path fitted = stack.path() + ".exr";
    EXPECT_TRUE(Screen::until([&] { return fs::exists(fitted); }));
    screen_->settled();
    EXPECT_EQ(read_painting(fitted).width(), 32);
    screen_->key("shift+F12");
    screen_->settled();
    screen_->x({"key", "ctrl+a"});
    const fs::path film = stack.out("round.mp4");
    screen_->enter(film.string());
    EXPECT_TRUE(Screen::until([&] { return fs::exists(film); }));
    EXPECT_EQ(close().json()["painting"], fitted.string()) << "which is shown";
    EXPECT_EQ(bytes_of(film).substr(4, 4), "ftyp");
}

}  // namespace
}  // namespace tangi
