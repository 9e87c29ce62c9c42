// viewer_web_page_test.cpp: the published page shows what the reference renderer computes, and needs nothing
// but itself.
#include "viewer/web_page.h"

#include "browser.h"
#include "surface/atomic_file.h"
#include "surface/relight.h"
#include "viewer/view.h"
#include "viewer_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 300, kHeight = 270, kScreenWidth = 400, kScreenHeight = 360;

// The page at one pixel for one, without controls, tone curve, ambient light and shadows.
std::string url_of(const fs::path& page, double azimuth_deg, double elevation_deg) {
    return fmt::format("file://{}#ui=0&zoom=1&shadows=0&ambient=0&shoulder=0&azimuth={}&elevation={}",
                       page.string(), azimuth_deg, elevation_deg);
}

// What the reference renderer gives for it, from where the page's eye is: three heights of the screen.
Image<Rgb> reference(Surface s, double azimuth_deg, double elevation_deg) {
    s.photography.rig = {.camera_distance_mm = static_cast<float>(3 * kScreenHeight * s.mm_per_pixel)};
    return relight(s, std::array{distant_light(direction_of(azimuth_deg, elevation_deg))});
}

Image<Rgb> middle_of(const Image<Rgb>& screenshot) {
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
    void open(const std::string& url) {
        browser_->open(url, kScreenWidth, kScreenHeight);
        ASSERT_TRUE(browser_->becomes_true("document.documentElement.dataset.drawn === 'whole'"))
            << browser_->errors;
    }

    TestDir scratch_;
    std::optional<Browser> browser_;
};

TEST_F(WebPageInABrowser, EqualsTheReferenceFromAFolderAndAsOneFile) {
    const Surface s = painted_surface(kWidth, kHeight);
    write_web_page(scratch_ / "page", s, {.title = "Ridges"});
    write_web_page(scratch_ / "page.html", s, {.title = "Ridges"});
    struct Lamp {
        const char* page;
        double azimuth_deg, elevation_deg;
    };
    for (const Lamp lamp :
         {Lamp{"page/index.html", 130, 60}, {"page/index.html", -20, 15}, {"page.html", 250, 35}}) {
        open(url_of(scratch_ / lamp.page, lamp.azimuth_deg, lamp.elevation_deg));
        const Image<Rgb> seen = middle_of(browser_->screenshot());
        // One step as everywhere, and half of one that 8 bits round.
        EXPECT_GE(part_within(seen, reference(s, lamp.azimuth_deg, lamp.elevation_deg), 1.5), 0.999)
            << lamp.page;
        EXPECT_LT(part_within(seen, reference(s, lamp.azimuth_deg + 15, lamp.elevation_deg), 1.5), 0.5)
            << "the light matters here";
    }
    EXPECT_EQ(browser_->errors, "");
    for (const std::string& url : browser_->requests)
        EXPECT_TRUE(url.starts_with("file://") || url.starts_with("about:") || url.starts_with("blob:"))
            << url;
}

TEST_F(WebPageInABrowser, FollowsTheHand) {
    const Surface s = painted_surface(kWidth, kHeight);
    write_web_page(scratch_ / "page.html", s, {.title = "Ridges"});
    open("file://" + (scratch_ / "page.html").string());
    const auto text = [&](const char* id) {
        return browser_->evaluate(fmt::format("document.getElementById('{}').textContent", id))
            .get<std::string>();
    };
    const Image<Rgb> before = browser_->screenshot();
    EXPECT_EQ(text("title"), "Ridges");
    EXPECT_NE(text("size").find("30.0 mm × 27.0 mm"), std::string::npos) << text("size");
    EXPECT_EQ(text("angles"), "135° · 50° high");
    browser_->drag({200, 150}, {380, 150});
    EXPECT_TRUE(
        browser_->becomes_true("/^(0|35\\d|[1-9])° · [2-9]° high/.test("
                               "document.getElementById('angles').textContent)"))
        << text("angles");
    EXPECT_LT(part_within(before, browser_->screenshot(), 3), 0.9) << "the picture follows the light";
    // A distance, by the tool Measure.
    browser_->evaluate("document.querySelector('[data-tool=ruler]').click()");
    browser_->drag({150, 150}, {250, 150});
    EXPECT_TRUE(
        browser_->becomes_true("/^1\\d\\.\\d mm$/.test(document.getElementById('distance').textContent)"))
        << text("distance");
    EXPECT_EQ(browser_->errors, "");
}

TEST_F(WebPageInABrowser, SaysWhatTheBrowserLacks) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight), {});
    browser_.emplace(scratch_.path(), "--disable-3d-apis");
    browser_->open("file://" + (scratch_ / "page.html").string(), kScreenWidth, kScreenHeight);
    EXPECT_TRUE(
        browser_->becomes_true("!document.getElementById('failed').hidden && /WebGL "
                               "2/.test(document.getElementById('failed').innerText)"));
    EXPECT_EQ(browser_->errors, "");
}

// A tile that is missing is told and tried again; coarser ones stand in.
TEST_F(WebPageInABrowser, ShowsWhatThereIs) {
    const Surface s = painted_surface(kWidth, kHeight);
    write_web_page(scratch_ / "page", s, {});
    fs::rename(scratch_ / "page/parts/0/1_0.js", scratch_ / "kept.js");
    open(url_of(scratch_ / "page/index.html", 130, 60));
    EXPECT_TRUE(
        browser_->becomes_true("/0.1_0 could not/.test(document.getElementById('said').textContent)"));
    const auto agreement = [&] {
        return part_within(middle_of(browser_->screenshot()), reference(s, 130, 60), 1.5);
    };
    EXPECT_GT(agreement(), 0.8);
    EXPECT_LT(agreement(), 0.9);
    fs::rename(scratch_ / "kept.js", scratch_ / "page/parts/0/1_0.js");
    bool whole = false;
    for (int i = 0; i < 100 && !whole; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        whole = agreement() > 0.999;
    }
    EXPECT_TRUE(whole);
}

TEST(WebPage, IsPublishedAsAWhole) {
    const TestDir dir;
    const Surface s = painted_surface(300, 40), smaller = painted_surface(30, 40);
    const WebReport report =
        write_web_page(dir / "page", s, {.title = "</script><b>bold</b>", .credit = "me"});
    EXPECT_EQ(report.levels, 2);
    EXPECT_EQ(report.tiles, 3);
    const std::string page = read_text_file(dir / "page/index.html");
    EXPECT_EQ(page.find("</script><b>"), std::string::npos) << "a title stays text";
    EXPECT_EQ(page.find("http"), std::string::npos) << "nothing comes from elsewhere";
    EXPECT_EQ(page.find("{{"), std::string::npos);
    for (const char* part : {"0/0_0.js", "0/1_0.js", "1/0_0.js", "horizon.js"})
        EXPECT_TRUE(fs::exists(dir / "page/parts" / part)) << part;
    // Stopped: the old page is as it was. Replaced: nothing of it is left.
    const Progress stop = [](std::string_view, double) { return false; };
    EXPECT_THROW(write_web_page(dir / "page", smaller, {}, {}, stop), Cancelled);
    EXPECT_THROW(write_web_page(dir / "new", smaller, {}, {}, stop), Cancelled);
    EXPECT_FALSE(fs::exists(dir / "new"));
    EXPECT_EQ(read_text_file(dir / "page/index.html"), page);
    write_web_page(dir / "page", smaller, {}, {.shadow_side = 0});
    std::vector<std::string> left;
    for (const auto& entry : fs::recursive_directory_iterator(dir / "page"))
        if (entry.is_regular_file()) left.push_back(fs::relative(entry.path(), dir / "page").string());
    std::sort(left.begin(), left.end());
    EXPECT_EQ(left, (std::vector<std::string>{"index.html", "parts/0/0_0.js"}));
}

TEST(WebPage, SaysWhatIsTooLargeForOneFile) {
    const TestDir dir;
    const Surface s = painted_surface(300, 200);
    const std::string message =
        error_of([&] { write_web_page(dir / "a.html", s, {}, {.largest_page_mb = 0.2}); });
    EXPECT_NE(message.find("a.html: the painting takes more than 0.2 MB"), std::string::npos) << message;
    EXPECT_FALSE(fs::exists(dir / "a.html"));
    write_text_file(dir / "file", "");
    EXPECT_NE(error_of([&] { write_web_page(dir / "file", s, {}); }).find("file"), std::string::npos);
}

}  // namespace
}  // namespace tangi
