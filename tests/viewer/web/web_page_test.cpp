// web_page_test.cpp: the published page shows what the reference renderer computes, and needs nothing
// but itself.
#include "viewer/web/web_page.h"

#include <gmock/gmock.h>

#include <regex>

#include "surface/file/atomic_file.h"
#include "surface/file/version.h"
#include "tests/viewer/web/page_support.h"
#include "tests/web/held_reference.h"
#include "tests/web/tablet.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

TP_LONG TEST_F(WebPageInABrowser, EqualsTheReferenceFromAFolderAndAsOneFile) {
    const Surface s = painted_surface(kWidth, kHeight);
    write_web_page(scratch_ / "page", s, {.title = "Ridges"});
    write_web_page(scratch_ / "page.html", s, {.title = "Ridges"});
    struct ViewLight {
        const char* page;
        double azimuth_deg, elevation_deg;
    };
    for (const ViewLight light :
         {ViewLight{"page/index.html", 130, 60}, {"page/index.html", -20, 15}, {"page.html", 250, 35}}) {
        open(url_of(scratch_ / light.page, light.azimuth_deg, light.elevation_deg));
        const Image<Rgb> seen = middle_of(browser_->screenshot());
        // One step as everywhere, and half of one that 8 bits round.
        EXPECT_GE(part_within(seen, reference(s, light.azimuth_deg, light.elevation_deg), 1.5), 0.999)
            << light.page;
        EXPECT_LT(part_within(seen, reference(s, light.azimuth_deg + 15, light.elevation_deg), 1.5), 0.5)
            << "the light matters here";
    }
    EXPECT_EQ(browser_->errors, "");
    for (const std::string& url : browser_->requests)
        EXPECT_TRUE(url.starts_with("file://") || url.starts_with("about:") || url.starts_with("blob:"))
            << url;
}

TP_LONG TEST_F(WebPageInABrowser, FollowsTheHand) {
    const Surface s = painted_surface(kWidth, kHeight);
    write_web_page(scratch_ / "page.html", s, {.title = "Ridges"});
    open_at("file://" + (scratch_ / "page.html").string() + "#zoom=1.6", {800, 640});
    const auto text = [&](const char* id) {
        return browser_->evaluate(fmt::format("document.getElementById('{}').textContent", id))
            .get<std::string>();
    };
    const Image<Rgb> before = browser_->screenshot();
    EXPECT_EQ(text("title"), "Ridges");
    EXPECT_NE(text("size").find("30.0 mm × 27.0 mm"), std::string::npos) << text("size");
    EXPECT_EQ(text("angles"), "135° · 50° high");
    browser_->drag({400, 240}, {700, 240});
    EXPECT_TRUE(
        browser_->becomes_true("/^(0|35\\d|[1-9])° · [2-9]° high/.test("
                               "document.getElementById('angles').textContent)"))
        << text("angles");
    EXPECT_LT(part_within(before, browser_->screenshot(), 3), 0.9) << "the picture follows the light";
    // A distance, by the tool Measure.
    browser_->evaluate("document.querySelector('[data-tool=ruler]').click()");
    browser_->drag({350, 240}, {450, 240});
    EXPECT_TRUE(
        browser_->becomes_true("/^6\\.2\\d mm$/.test(document.getElementById('distance')?.textContent)"))
        << text("distance");
    EXPECT_EQ(browser_->errors, "");
}

// The device's sensor, as the browser has it.
TP_LONG TEST_F(WebPageInABrowser, FollowsHowTheDeviceIsHeld) {
    const Surface s = painted_surface(kWidth, kHeight);
    write_web_page(scratch_ / "page.html", s, {.title = "Ridges"});
    for (const char* name : {"accelerometer", "gyroscope"})
        browser_->call("Browser.setPermission", {{"permission", {{"name", name}}}, {"setting", "granted"}});
    hold_screen(*browser_, 0, 0, 0);
    open(url_of(scratch_ / "page.html", 130, 50));
    browser_->evaluate("document.getElementById('follow').click()");
    ASSERT_TRUE(
        browser_->becomes_true("document.getElementById('follow').getAttribute('aria-pressed') === 'true'"))
        << browser_->errors;
    const Vec3 light = direction_of(130, 50);
    for (const glm::dvec3 turn : {glm::dvec3(0, 20, 0), glm::dvec3(0, -10, 25), glm::dvec3(30, 15, -12)}) {
        hold_screen(*browser_, turn.x, turn.y, turn.z);
        ASSERT_TRUE(browser_->becomes_true("document.documentElement.dataset.drawn === 'whole'"));
        const Image<Rgb> seen = middle_of(browser_->screenshot());
        const double distance_mm = 3 * kScreenHeight * s.mm_per_pixel;
        EXPECT_GE(
            part_within(seen, reference_held(s, light, distance_mm, held_screen(turn.x, turn.y, turn.z)), 2),
            0.995)
            << turn.x << " " << turn.y << " " << turn.z;
        EXPECT_LT(part_within(seen, reference_held(s, light, distance_mm, held_screen(0, 0, 0)), 2), 0.6)
            << "how it is held matters here";
    }
    EXPECT_EQ(browser_->errors, "");
}

// A link that is followed within the page, as between figures of a text; and numbers that nobody could reach
// by hand.
TP_LONG TEST_F(WebPageInABrowser, FollowsLinksAndShowsWhatCanBeShown) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight), {.title = "Ridges"});
    open("file://" + (scratch_ / "page.html").string() + "#zoom=1&azimuth=20&elevation=500&exposure=99");
    const auto angles_are = [&](const std::string& text) {
        return browser_->becomes_true(
            fmt::format("document.getElementById('angles').textContent === '{}'", text));
    };
    EXPECT_TRUE(angles_are("20° · 90° high"));
    EXPECT_EQ(browser_->evaluate("+document.getElementById('exposure').value"), 3);
    const Image<Rgb> before = browser_->screenshot();
    for (const auto& [hash, angles] : std::vector<std::pair<std::string, std::string>>{
             {"azimuth=150&elevation=20", "150° · 20° high"},
             {"azimuth=-730&elevation=-5&x=-1e9&tilt_x=800", "350° · 2° high"},
             {"azimuth=12,5&elevation=33,2", "13° · 33° high"},
             {"azimuth=abc&elevation=&zoom=nan&look=77", "13° · 33° high"}}) {
        browser_->evaluate(fmt::format("location.hash = '{}'", hash));
        EXPECT_TRUE(angles_are(angles)) << hash;
    }
    browser_->evaluate("location.hash = 'azimuth=200&elevation=15&tilt_x=0&x=150&y=135&exposure=0&look=0'");
    EXPECT_TRUE(angles_are("200° · 15° high"));
    EXPECT_TRUE(browser_->becomes_true("document.documentElement.dataset.drawn === 'whole'"));
    EXPECT_LT(part_within(before, browser_->screenshot(), 3), 0.9) << "the picture follows the link";
    browser_->evaluate("location.hash = 'ui=0'");
    EXPECT_TRUE(browser_->becomes_true("document.body.classList.contains('bare')"));
    EXPECT_EQ(browser_->errors, "");
}

// The scale of each mode is that with which the window opens the painting.
TEST(WebPage, FalseColoursBeginAndEndAsInTheWindow) {
    const TestDir dir;
    Surface s = painted_surface(kWidth, kHeight);
    s.mm_per_pixel = 0.2;
    for (float& h : s.height_mm.pixels()) h = std::clamp(h, -0.25f, 0.5f);
    s.height_mm(0, 0) = -0.25f;
    s.height_mm(1, 0) = 0.5f;
    write_web_page(dir / "page.html", s, {.title = "Ridges"});
    const std::string page = read_text_file(dir / "page.html");
    EXPECT_NE(page.find(R"({"ends":[-0.25,0.5],"name":"Height"})"), std::string::npos);
    EXPECT_NE(page.find(R"({"ends":[-0.5,0.5],"name":"Curvature"})"), std::string::npos);
    EXPECT_NE(page.find(R"({"ends":[0.0,1.0],"name":"Confidence"})"), std::string::npos);
}

// Every control can be reached, also on a phone.
TP_LONG TEST_F(WebPageInABrowser, HasAllControlsOnAnyScreen) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight), {.title = "Ridges"});
    for (const glm::ivec2 screen : {glm::ivec2{360, 640}, {844, 390}, {768, 1024}, {1366, 768}}) {
        open_at("file://" + (scratch_ / "page.html").string(), screen);
        browser_->evaluate(
            "{ const more = document.getElementById('more'); if (more.offsetWidth) more.click(); }");
        const nlohmann::json hidden = browser_->evaluate(
            "[...document.querySelectorAll('#controls button, #controls select, #controls input')].filter(e "
            "=> {"
            "const b = e.getBoundingClientRect(); return e.id !== 'more' && !e.closest('[hidden]') && "
            "!(b.width > 0 && b.left >= 0 &&"
            "b.right <= innerWidth && b.bottom <= innerHeight); }).map(e => e.id)");
        EXPECT_EQ(hidden, nlohmann::json::array()) << screen.x << " x " << screen.y;
    }
    EXPECT_EQ(browser_->errors, "");
}

// What is painted below a pane: with the panes hidden the screen shows there what is around the painting.
TP_LONG TEST_F(WebPageInABrowser, BeginsBesideItsCaption) {
    for (const glm::ivec2 painting : {glm::ivec2{300, 200}, {200, 300}}) {
        write_web_page(scratch_ / "page.html", painted_surface(painting.x, painting.y),
                       {.title = "Ridges and grains", .credit = "A. Painter, 1901"});
        for (const glm::ivec2 screen : {glm::ivec2{390, 844}, {844, 390}, {1366, 768}}) {
            open_at("file://" + (scratch_ / "page.html").string(), screen);
            const nlohmann::json panes = browser_->evaluate(
                "['caption', 'lighting'].map(id => { const b = "
                "document.getElementById(id).getBoundingClientRect();"
                "return [b.left, b.top, b.right, b.bottom]; })");
            browser_->evaluate(
                "['caption', 'lighting', 'scale'].forEach(id => document.getElementById(id).style.visibility "
                "= 'hidden')");
            const Image<Rgb> picture = browser_->screenshot();
            const Rgb around = picture(1, 1);
            for (const nlohmann::json& box : panes)
                for (int y = box[1].get<int>() + 1; y < box[3].get<int>(); ++y)
                    for (int x = box[0].get<int>() + 1; x < box[2].get<int>(); ++x)
                        ASSERT_LT(glm::distance(picture(x, y), around), 0.02f)
                            << x << ", " << y << " of " << screen.x << " x " << screen.y;
        }
    }
}

TP_LONG TEST_F(WebPageInABrowser, SaysWhatTheBrowserLacks) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight), {});
    browser_.emplace(scratch_.path(), std::vector<std::string>{"--disable-3d-apis"});
    browser_->open("file://" + (scratch_ / "page.html").string(), kScreenWidth, kScreenHeight);
    EXPECT_TRUE(
        browser_->becomes_true("!document.getElementById('failed').hidden && /WebGL "
                               "2/.test(document.getElementById('failed').innerText)"));
    EXPECT_EQ(browser_->errors, "");
}

// A tile that is missing is told and tried again; coarser ones stand in.
TP_LONG TEST_F(WebPageInABrowser, ShowsWhatThereIs) {
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
    std::size_t on_disk = 0;
    for (const auto& entry : fs::recursive_directory_iterator(dir / "page"))
        if (entry.is_regular_file()) on_disk += entry.file_size();
    EXPECT_EQ(report.bytes, on_disk);
    EXPECT_EQ(report.first_bytes,
              fs::file_size(dir / "page/index.html") + fs::file_size(dir / "page/parts/1/0_0.js"));
    const std::string page = read_text_file(dir / "page/index.html");
    EXPECT_EQ(page.find("</script><b>"), std::string::npos) << "a title stays text";
    EXPECT_FALSE(std::regex_search(page, std::regex(R"re((src|href|url|import|fetch)\W{1,3}https?:)re")))
        << "nothing comes from elsewhere; vocabularies have addresses for names";
    EXPECT_EQ(page.find("{{"), std::string::npos);
    EXPECT_NE(page.find("<meta name=\"generator\" content=\"" + program_name()), std::string::npos);
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

// A site has a page of its own; other files may lie beside ours.
TEST(WebPage, DoesNotReplaceWhatOthersWrote) {
    const TestDir dir;
    const Surface s = painted_surface(30, 40);
    const fs::path site = dir / "site";
    fs::create_directories(site / "parts/0");
    const auto expect_refused = [&](const fs::path& mine) {
        write_text_file(mine, "mine");
        const std::string said = error_of([&] { write_web_page(site, s, {}); });
        EXPECT_THAT(said, testing::StartsWith(mine.string() + ": is not of an earlier export"));
        EXPECT_THAT(said, testing::HasSubstr("another folder"));
        EXPECT_EQ(read_text_file(mine), "mine");
        fs::remove(mine);
    };
    for (const char* mine : {"index.html", "parts/logo.svg", "parts/0/0_0.js.bak"})
        expect_refused(site / mine);
    fs::remove_all(site / "parts");
    expect_refused(site / "parts");
    write_text_file(site / "about.html", "mine");
    for (int times = 0; times < 2; ++times) write_web_page(site, s, {});
    EXPECT_EQ(read_text_file(site / "about.html"), "mine");
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{"site"});
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
