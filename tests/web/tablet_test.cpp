// tablet_test.cpp: the web application as a person has it in the hand: pen, fingers, sensor, no network, full
// storage.
#include "tests/web/tablet.h"

#include <gmock/gmock.h>

#include "paint/canvas/appearance.h"
#include "paint/canvas/canvas_hash.h"
#include "paint/session/session.h"
#include "surface/file/atomic_file.h"
#include "surface/file/base64.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/viewer/viewer_support.h"
#include "tests/web/held_reference.h"
#include "web/engine/ground.h"

namespace tangi {
namespace {

using nlohmann::json;

// What is painted in the browser, painted again natively from the journal that it gives.
TEST_F(WebApplication, PaintsWhatItsJournalPaintsNatively) {
    begin();
    paint_three_strokes();
    EXPECT_EQ(tablet_->strokes(), 3);
    const std::string journal = tablet_->journal();
    EXPECT_THAT(journal, testing::HasSubstr("\"tx\":0.342"));  // the pen's lean
    write_text_file(scratch_ / "journal.jsonl", journal);
    const auto ground = std::make_shared<const Surface>(make_ground(kSmall));
    Session session(ground, artist_acrylics());
    replay(session, read_journal(scratch_ / "journal.jsonl"));
    const json web = tablet_->hashes();
    EXPECT_EQ(web["canvas"], hash_of(session.canvas(), hash_of(*ground)));
    EXPECT_EQ(web["look"], hash_of(appearance(session.canvas())));
    EXPECT_GT(session.totals().bristle_pixels, 1000);
    EXPECT_EQ(read_journal(scratch_ / "journal.jsonl").head.on, hash_of(Canvas(ground), hash_of(*ground)));
    // And the other way round: it is painted again in the browser, on another work.
    tablet_->await("tangipaint.create({title: 'Again', choice: " + kSmall.dump() + ", journal: new File([" +
                   json(journal).dump() + "], 'journal.jsonl')})");
    ASSERT_TRUE(tablet_->is_drawn());
    EXPECT_EQ(tablet_->hashes(), web);
    EXPECT_EQ(tablet_->browser().errors, "");
}

// A fitted painting is painted on as it is, and what was painted comes back as a journal that goes on from
// it.
TEST_F(WebApplication, PaintsOnAFittedPainting) {
    const auto ground = std::make_shared<const Surface>(painted_surface(300, 220));
    AtomicFile file(scratch_ / "fitted.exr");
    write_painting(file, *ground);
    ASSERT_TRUE(tablet_->open());
    tablet_->await(
        "window.told = [], new MutationObserver(() => told.push([document.getElementById('busy-words')."
        "textContent, document.getElementById('busy-part').value])).observe(document.getElementById('busy-"
        "part'), {attributes: true}), 1");
    tablet_->await(
        "fetch('data:application/octet-stream;base64," + base64(read_text_file(scratch_ / "fitted.exr")) +
        "').then(r => r.blob()).then(b => tangipaint.create({title: 'Fitted', choice: {painting: true, name: "
        "'fitted.exr'}, picture: b}))");
    ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    EXPECT_EQ(tablet_->hashes()["look"], hash_of(*ground));
    EXPECT_EQ(tablet_->await("told.some(([words, part]) => words.startsWith('Reading') && part > 0)"), true)
        << "how far it is read is shown";
    tablet_->pen(straight({300, 250}, {500, 320}), 0.6);
    ASSERT_TRUE(tablet_->is_settled());
    write_text_file(scratch_ / "retouch.jsonl", tablet_->journal());
    const Journal journal = read_journal(scratch_ / "retouch.jsonl");
    EXPECT_EQ(journal.head.on, hash_of(Canvas(ground), hash_of(*ground)));
    Session session(ground, artist_acrylics());
    replay(session, journal);
    EXPECT_EQ(tablet_->hashes()["canvas"], hash_of(session.canvas(), hash_of(*ground)));
    EXPECT_GT(session.totals().bristle_pixels, 1000);
}

TEST_F(WebApplication, HasTheStrokesAgainAfterATabIsKilled) {
    begin();
    paint_three_strokes();
    const json before = tablet_->hashes();
    // A fourth one is under way.
    tablet_->browser().call("Input.dispatchMouseEvent", {{"type", "mousePressed"},
                                                         {"x", 300},
                                                         {"y", 300},
                                                         {"button", "left"},
                                                         {"buttons", 1},
                                                         {"clickCount", 1}});
    tablet_->browser().call(
        "Input.dispatchMouseEvent",
        {{"type", "mouseMoved"}, {"x", 420}, {"y", 330}, {"button", "left"}, {"buttons", 1}});
    const std::string id = tablet_->await("tangipaint.open.work.record.id");
    start();  // the browser was killed, and begins anew
    ASSERT_TRUE(tablet_->open());
    EXPECT_EQ(tablet_->await("document.querySelectorAll('#works li:not(.new)').length"), 1);
    tablet_->await("document.querySelector('#works li:not(.new) .open').click()");
    ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    EXPECT_EQ(tablet_->hashes(), before);
    EXPECT_EQ(tablet_->await("tangipaint.open.work.record.id"), id);
    EXPECT_EQ(tablet_->strokes(), 3);
}

TEST_F(WebApplication, NeedsNoNetworkAfterTheFirstTime) {
    begin();
    paint_three_strokes();
    const json before = tablet_->hashes();
    ASSERT_EQ(tablet_->await("navigator.serviceWorker.ready.then(r => r.active.state === 'activated' || "
                             "r.active.state === 'activating')"),
              true);
    server_.stop();
    tablet_->browser().call("Page.reload", {{"ignoreCache", false}});
    ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    EXPECT_EQ(tablet_->hashes(), before);
    for (const std::string& url : tablet_->browser().requests)
        EXPECT_TRUE(url.starts_with(server_.url()) || url.starts_with("blob:") || url.starts_with("about:"))
            << url;
}

// Two fingers move, zoom and turn the painting, and paint nothing; taps undo and redo.
TEST_F(WebApplication, FollowsFingers) {
    begin();
    tablet_->fingers({straight({260, 260}, {540, 300})});
    ASSERT_TRUE(tablet_->is_settled());
    EXPECT_EQ(tablet_->strokes(), 1) << "one finger paints";
    const double zoom = state("look.view.zoom"), turn = state("look.view.turn");
    tablet_->fingers({straight({350, 300}, {300, 260}), straight({450, 300}, {500, 340})});
    EXPECT_EQ(tablet_->strokes(), 1) << "two do not";
    const double spread = std::hypot(200, 80) / 100;
    EXPECT_NEAR(state("look.view.zoom").get<double>() / zoom, spread, 0.15);
    EXPECT_NEAR(state("look.view.turn").get<double>() - turn, -std::atan2(80, 200) * 180 / std::numbers::pi,
                3);
    const json painted = tablet_->hashes();
    tablet_->fingers({{{380, 300}}, {{440, 300}}});  // a tap of two
    ASSERT_TRUE(tablet_->browser().becomes_true("tangipaint.open.state.can_redo"));
    EXPECT_NE(tablet_->hashes(), painted);
    tablet_->fingers({{{380, 300}}, {{440, 300}}, {{500, 300}}});
    ASSERT_TRUE(tablet_->browser().becomes_true("!tangipaint.open.state.can_redo"));
    EXPECT_EQ(tablet_->hashes(), painted);
}

TEST_F(WebApplication, LeavesFingersOutWhileAPenIsNear) {
    begin();
    tablet_->pen(straight({260, 260}, {340, 280}));
    tablet_->fingers({straight({300, 350}, {500, 350})});  // the palm
    ASSERT_TRUE(tablet_->is_settled());
    EXPECT_EQ(tablet_->strokes(), 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    tablet_->fingers({straight({300, 350}, {500, 350})});
    ASSERT_TRUE(tablet_->is_settled());
    EXPECT_EQ(tablet_->strokes(), 2);
}

// The light stays in the room while the tablet is tilted: as the reference renderer has it, also in the hand
// that has turned the screen.
TEST_F(WebApplication, ShowsTheLightAsTheTabletIsHeld) {
    for (const bool upright : {false, true}) {
        const glm::ivec2 screen = upright ? glm::ivec2(600, 800) : glm::ivec2(800, 600);
        start();
        tablet_->allow_sensor(true);
        tablet_->hold(0, 0, 0);
        begin(screen.x, screen.y);
        const Surface s = make_ground(kSmall);
        const glm::ivec2 corner((screen.x - s.width()) / 2, (screen.y - s.height()) / 2);
        tablet_->await("document.getElementById('open-light').click()");
        tablet_->await("document.querySelector('#sheet-light [role=switch]').click()");
        ASSERT_TRUE(tablet_->browser().becomes_true("!!tangipaint.look.held")) << tablet_->browser().errors;
        tablet_->await("document.getElementById('open-light').click()");
        tablet_->await(
            fmt::format("Object.assign(tangipaint.look, {{view: {{x: {}, y: {}, zoom: 1, turn: 0}}, light: "
                        "{{azimuth: 130, elevation: 40}}, ambient: 0, "
                        "shoulder: 0}}), document.getElementById('easel').classList.add('bare')",
                        (s.width() - 1) / 2.0, (s.height() - 1) / 2.0));
        for (const glm::dvec3 turn : {glm::dvec3(0, 20, 0), glm::dvec3(25, -10, 15)}) {
            tablet_->hold(turn.x, turn.y, turn.z);
            ASSERT_TRUE(tablet_->is_drawn());
            const Image<Rgb> shot = tablet_->browser().screenshot();
            Image<Rgb> seen(s.width(), s.height());
            for (int y = 0; y < s.height(); ++y)
                for (int x = 0; x < s.width(); ++x)
                    seen(x, y) = kSrgb.decode(shot(x + corner.x, y + corner.y));
            const Image<Rgb> expected =
                reference_held(s, direction_of(130, 40), 3 * screen.y * s.mm_per_pixel,
                               held_screen(turn.x, turn.y, turn.z, upright ? 0 : 90));
            EXPECT_GE(part_within(seen, expected, 3), 0.97)
                << turn.x << " " << turn.y << " " << turn.z << " " << upright;
            const Image<Rgb> level =
                reference_held(s, direction_of(130, 40), 3 * screen.y * s.mm_per_pixel, glm::dmat3(1));
            EXPECT_LT(part_within(seen, level, 3), 0.9);
        }
    }
}

TEST_F(WebApplication, SaysWhatItIsNotAllowed) {
    begin();
    tablet_->browser().call("Browser.setPermission",
                            {{"permission", {{"name", "camera"}}}, {"setting", "denied"}});
    tablet_->await("document.getElementById('open-light').click()");
    tablet_->await(
        "[...document.querySelectorAll('#sheet-light [role=switch]')].find(e => "
        "e.ariaLabel.includes('camera')).click()");
    ASSERT_TRUE(
        tablet_->browser().becomes_true("document.getElementById('notice').classList.contains('warns')"));
    EXPECT_THAT(tablet_->await("document.getElementById('notice').textContent").get<std::string>(),
                testing::AnyOf(testing::HasSubstr("camera"), testing::HasSubstr("Camera")));
    const auto follow = [&](const char* told) {
        tablet_->await("document.querySelector('#sheet-light [role=switch]').click()");
        return tablet_->browser().becomes_true(
            fmt::format("document.getElementById('notice').textContent.includes('{}')", told));
    };
    tablet_->allow_sensor(false);
    EXPECT_TRUE(follow("switched off"));
    tablet_->allow_sensor(true);  // but there is none
    EXPECT_TRUE(follow("no tilt sensor"));
}

TEST_F(WebApplication, SaysInPlainWordsThatWebGlIsMissing) {
    start({"--disable-3d-apis"});
    tablet_->browser().call("Page.navigate", {{"url", server_.url()}});
    ASSERT_TRUE(tablet_->browser().becomes_true(
        "!!document.getElementById('failed') && !document.getElementById('failed').hidden"));
    EXPECT_THAT(tablet_->await("document.getElementById('failed').textContent").get<std::string>(),
                testing::HasSubstr("WebGL 2"));
}

// axe-core's rules (WCAG 2 and best practice), on every part of the page.
TEST_F(WebApplication, IsAccessibleByAxesRules) {
    const auto axe = std::filesystem::path(TP_SOURCE_DIR) / "build/web/npm/node_modules/axe-core/axe.min.js";
    if (!std::filesystem::exists(axe)) {
        ASSERT_EQ(std::getenv("TP_WEB"), nullptr) << axe;
        GTEST_SKIP() << "no axe-core here: script/web fetches it";
    }
    tablet_->browser().call("Page.setBypassCSP", {{"enabled", true}});
    ASSERT_TRUE(tablet_->open(360, 640));
    tablet_->await(read_text_file(axe) + ";1");
    const auto violations = [&] {
        return tablet_->await(
            "axe.run(document, {resultTypes: ['violations']}).then(r => r.violations.map(v => v.id + ': ' + "
            "v.nodes.map(n => n.html.slice(0, 80)).join(' ')))");
    };
    EXPECT_EQ(violations(), json::array()) << "gallery";
    tablet_->await("document.querySelector('#works .new .open').click()");
    EXPECT_EQ(violations(), json::array()) << "new painting";
    tablet_->await("document.querySelector('#new .ends button').click()");
    ASSERT_TRUE(tablet_->begin(kSmall));
    EXPECT_EQ(violations(), json::array()) << "easel";
    for (const char* sheet : {"brush", "palette", "light", "painting"}) {
        tablet_->await(fmt::format("document.getElementById('open-{}').click()", sheet));
        EXPECT_EQ(violations(), json::array()) << sheet;
        tablet_->await(fmt::format("document.getElementById('open-{}').click()", sheet));
    }
}

// No control is off the screen, under another, or too small for a thumb, on a phone and on a large tablet.
TEST_F(WebApplication, HasAllToolsOnAnyScreen) {
    begin(360, 640);
    for (const glm::ivec2 screen :
         {glm::ivec2(360, 640), glm::ivec2(640, 360), glm::ivec2(1366, 1024), glm::ivec2(1024, 1366)}) {
        tablet_->resize(screen.x, screen.y);
        for (const char* sheet : {"", "brush", "palette", "light", "painting"}) {
            if (*sheet) tablet_->await(fmt::format("document.getElementById('open-{}').click()", sheet));
            const json poor = tablet_->await(R"(
                [...document.querySelectorAll('#dock button, #top button, .sheet:not([hidden]) > header button')].filter(e => {
                  const box = e.getBoundingClientRect(), x = box.left + box.width / 2, y = box.top + box.height / 2;
                  const top = document.elementFromPoint(x, y);
                  return box.left < 0 || box.top < 0 || box.right > innerWidth || box.bottom > innerHeight || box.width < 40 || box.height < 40 || !(top && e.contains(top));
                }).map(e => e.id || e.ariaLabel))");
            EXPECT_EQ(poor, json::array()) << screen.x << " x " << screen.y << " " << sheet;
            EXPECT_EQ(tablet_->await("document.documentElement.scrollWidth > innerWidth"), false);
            if (*sheet) tablet_->await(fmt::format("document.getElementById('open-{}').click()", sheet));
        }
    }
    EXPECT_EQ(tablet_->browser().errors, "");
}

}  // namespace
}  // namespace tangi
