// tablet.h: the web application in a browser, with pen, fingers and a sensor, as a person has it in the hand.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/programs/support/browser.h"
#include "tests/web/web_support.h"

namespace tangi {

using Places = std::vector<glm::dvec2>;  // [CSS pixels]

// The sensor tells again and again, as it does in the hand, until what is smoothed has come to rest. Browsers
// pass on changes of a tenth of a degree and more.
inline void hold_screen(Browser& browser, double alpha, double beta, double gamma) {
    for (int i = 0; i <= 40; ++i) {
        const double trembles = i == 40 ? 0 : i % 2 ? 0.12 : -0.12;
        browser.call("DeviceOrientation.setDeviceOrientationOverride",
                     {{"alpha", alpha}, {"beta", beta + trembles}, {"gamma", gamma}});
        std::this_thread::sleep_for(std::chrono::milliseconds(40));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
}

class Tablet {
public:
    // The same scratch folder is the same device: what is stored on it is there again.
    Tablet(const std::filesystem::path& scratch, const std::string& url,
           const std::vector<std::string>& flags = {"--hide-scrollbars"})
        : url_(url), browser_(scratch, flags) {}

    Browser& browser() { return browser_; }

    // Opens the application; true once it is ready.
    bool open(int width = 800, int height = 600) {
        resize(width, height);
        browser_.call("Emulation.setTouchEmulationEnabled", {{"enabled", true}, {"maxTouchPoints", 5}});
        browser_.call("Page.navigate", {{"url", url_}});
        return browser_.becomes_true("document.documentElement.dataset.ready === 'yes'");
    }
    void resize(int width, int height) {
        const bool upright = height > width;
        browser_.call(
            "Emulation.setDeviceMetricsOverride",
            {{"width", width},
             {"height", height},
             {"deviceScaleFactor", 1},
             {"mobile", true},
             {"screenOrientation",
              {{"type", upright ? "portraitPrimary" : "landscapePrimary"}, {"angle", upright ? 0 : 90}}}});
    }
    // A new painting, open and drawn.
    bool begin(const nlohmann::json& choice) {
        await("tangipaint.create({title: 'Test', choice: " + choice.dump() +
              ", picture: null, relief: null})");
        return is_drawn();
    }
    bool is_drawn() {
        return browser_.becomes_true(
            "!!tangipaint.open && document.documentElement.dataset.drawn === 'whole' && "
            "document.getElementById('busy').hidden");
    }
    // What an expression, or its promise, gives.
    nlohmann::json await(const std::string& expression) {
        const nlohmann::json answer =
            browser_.call("Runtime.evaluate",
                          {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
        if (answer.contains("exceptionDetails"))
            fail("{}: {}", expression, answer["exceptionDetails"]["exception"].value("description", "?"));
        return answer["result"].value("value", nlohmann::json());
    }
    nlohmann::json hashes() { return await("tangipaint.connection.ask('hash')"); }
    std::string journal() { return await("tangipaint.open.work.text()"); }
    int strokes() { return await("tangipaint.open.work.next"); }
    // What was sent is painted and stored.
    bool is_settled() {
        return browser_.becomes_true(
            "document.documentElement.dataset.waiting === '0' && tangipaint.open.work.unstored === 0");
    }

    void pen(const Places& way, double pressure = 0.5, int tilt_x = 0, int tilt_y = 0,
             const char* type = "pen") {
        const auto send = [&](const char* kind, const glm::dvec2& at, int buttons) {
            browser_.call("Input.dispatchMouseEvent", {{"type", kind},
                                                       {"x", at.x},
                                                       {"y", at.y},
                                                       {"button", "left"},
                                                       {"buttons", buttons},
                                                       {"clickCount", 1},
                                                       {"pointerType", type},
                                                       {"force", pressure},
                                                       {"tiltX", tilt_x},
                                                       {"tiltY", tilt_y}});
        };
        send("mousePressed", way.front(), 1);
        for (std::size_t i = 1; i < way.size(); ++i) send("mouseMoved", way[i], 1);
        send("mouseReleased", way.back(), 0);
    }
    // Each finger's way; all have as many places.
    void fingers(const std::vector<Places>& ways) {
        const std::size_t steps = ways.front().size();
        for (std::size_t i = 0; i < steps; ++i) touch(i == 0 ? "touchStart" : "touchMove", ways, i);
        browser_.call("Input.dispatchTouchEvent",
                      {{"type", "touchEnd"}, {"touchPoints", nlohmann::json::array()}});
    }
    void touch(const char* type, const std::vector<Places>& ways, std::size_t step) {
        nlohmann::json points = nlohmann::json::array();
        for (std::size_t finger = 0; finger < ways.size(); ++finger)
            points.push_back({{"x", ways[finger][step].x}, {"y", ways[finger][step].y}, {"id", finger}});
        browser_.call("Input.dispatchTouchEvent", {{"type", type}, {"touchPoints", points}});
    }
    // Whether the page may read the sensor.
    void allow_sensor(bool allowed) {
        for (const char* name : {"accelerometer", "gyroscope"})
            browser_.call("Browser.setPermission",
                          {{"permission", {{"name", name}}}, {"setting", allowed ? "granted" : "denied"}});
    }
    void hold(double alpha, double beta, double gamma) { hold_screen(browser_, alpha, beta, gamma); }

private:
    std::string url_;
    Browser browser_;
};

inline Places straight(glm::dvec2 from, glm::dvec2 to, int points = 10) {
    Places way;
    for (int i = 0; i < points; ++i) way.push_back(from + (to - from) * (i / (points - 1.0)));
    return way;
}

inline const nlohmann::json kSmall = {
    {"substrate", "linen"}, {"width_mm", 80}, {"height_mm", 60}, {"pixel_mm", 0.25}, {"seed", 3}};
class WebApplication : public testing::Test {
protected:
    void SetUp() override {
        TP_NEEDS_WEB_APP();
        if (browser_program().empty()) GTEST_SKIP() << "no Chromium here (Debian: chromium-headless-shell)";
        start();
    }
    void start(const std::vector<std::string>& flags = {"--hide-scrollbars"}) {
        tablet_.reset();
        tablet_.emplace(scratch_.path(), server_.url(), flags);
    }
    void begin(int width = 800, int height = 600) {
        ASSERT_TRUE(tablet_->open(width, height)) << tablet_->browser().errors;
        ASSERT_TRUE(tablet_->begin(kSmall)) << tablet_->browser().errors;
    }
    void paint_three_strokes() {
        tablet_->pen(straight({250, 250}, {550, 270}), 0.4);
        tablet_->pen(straight({300, 350}, {500, 260}), 0.7, 20, -10);
        tablet_->pen(straight({330, 240}, {350, 380}), 0.5, 0, 0, "mouse");
        ASSERT_TRUE(tablet_->is_settled()) << tablet_->browser().errors;
    }
    nlohmann::json state(const std::string& name) { return tablet_->await("tangipaint." + name); }

    TestDir scratch_;
    WebServer server_;
    std::optional<Tablet> tablet_;
};

}  // namespace tangi
