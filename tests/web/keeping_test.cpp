// keeping_test.cpp: what the web application keeps and gives: files taken along, storage that is full, two
// tabs, new versions.
#include <gmock/gmock.h>

#include <regex>

#include "paint/canvas/appearance.h"
#include "paint/canvas/canvas_hash.h"
#include "paint/files/canvas_file.h"
#include "paint/session/session.h"
#include "surface/file/atomic_file.h"
#include "surface/file/base64.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "tests/programs/support/cli_program.h"
#include "tests/support/viewer/viewer_support.h"
#include "tests/web/tablet.h"
#include "web/engine/ground.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class WebKeeping : public WebApplication {
protected:
    // What the button of the sheet saves, under the painting's title.
    fs::path taken(const std::string& button, const std::string& ending) {
        const fs::path folder = scratch_ / "downloads";
        fs::path file = folder / ("Test." + ending);
        fs::create_directories(folder);
        fs::remove(file);
        tablet_->browser().call("Browser.setDownloadBehavior",
                                {{"behavior", "allow"}, {"downloadPath", folder.string()}});
        tablet_->await(
            fmt::format("(() => {{ if (document.getElementById('sheet-painting').hidden) "
                        "document.getElementById('open-painting').click(); "
                        "[...document.querySelectorAll('#sheet-painting button')].find(b => b.textContent "
                        "=== {}).click(); }})()",
                        json(button).dump()));
        for (int i = 0; i < 400 && !fs::exists(file); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        EXPECT_TRUE(fs::exists(file)) << button << " " << tablet_->browser().errors;
        return file;
    }
    void dry() {
        ASSERT_TRUE(tablet_->browser().becomes_true("tangipaint.open.state.wet"))
            << "what is not wet cannot dry";
        tablet_->await("document.getElementById('open-painting').click()");
        tablet_->await(
            "[...document.querySelectorAll('#sheet-painting button')].find(b => b.textContent === 'Let "
            "everything dry').click()");
        tablet_->await("document.getElementById('open-painting').click()");
        ASSERT_TRUE(tablet_->browser().becomes_true("!tangipaint.open.state.wet"));
        ASSERT_TRUE(tablet_->is_settled());
    }
    // A work on a painting file of this scratch folder.
    void begin_on(const fs::path& file) {
        tablet_->await(
            "fetch('data:application/octet-stream;base64," + base64(read_text_file(file)) +
            "').then(r => r.blob()).then(b => tangipaint.create({title: 'Test', choice: {painting: "
            "true, name: 'fitted.exr'}, picture: b}))");
        ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    }
    bool asks(const std::string& words) {
        return tablet_->browser().becomes_true(
            fmt::format("document.getElementById('asked').open && "
                        "document.getElementById('asked').textContent.includes({})",
                        json(words).dump()));
    }
    int kept() {
        return tablet_->await("tangipaint.storage.journal(tangipaint.open.work.record.id).then(j => j.next)");
    }
};

// Each file, by who opens it.
TEST_F(WebKeeping, SavesPictureLayersPaintingAndJournal) {
    begin();
    paint_three_strokes();
    dry();
    tablet_->pen(straight({300, 300}, {500, 330}), 0.6);
    ASSERT_TRUE(tablet_->is_settled());
    const json hashes = tablet_->hashes();

    const Image<Rgb> picture = read_picture(taken("Picture", "png"));
    EXPECT_EQ(picture.width(), 320);
    EXPECT_EQ(picture.height(), 240);
    EXPECT_THAT(read_text_file(scratch_ / "downloads/Test.png"),
                testing::HasSubstr(std::string("iTXtTitle\0\0\0\0\0Test", 18)));

    const auto ground = std::make_shared<const Surface>(make_ground(kSmall));
    Session session(ground, artist_acrylics());
    replay(session, read_journal(taken("Journal", "jsonl")));
    EXPECT_EQ(hash_of(session.canvas(), hash_of(*ground)), hashes["canvas"]);

    const fs::path painting = taken("Painting file (.exr)", "exr");
    const Canvas canvas = read_canvas(painting);
    EXPECT_EQ(hash_of(canvas, hash_of(canvas.dry())), hashes["canvas"]);
    EXPECT_EQ(hash_of(canvas.dry()), hash_of(*ground));
    EXPECT_EQ(canvas.dried().size(), 1u);
    EXPECT_FALSE(canvas.wet().empty());
    EXPECT_EQ(canvas.dry().provenance, ground->provenance);
    EXPECT_EQ(hash_of(read_painted(painting)), hash_of(appearance(session.canvas())));
    EXPECT_LT(fs::file_size(painting), 320u * 240u * 10u * 4u) << "it is packed";

    const fs::path layers = taken("Layers (OpenRaster)", "ora");
    const json listed = read_json(
        output_of(
            "python3 - '" + layers.string() +
            "' <<'END'\nimport sys, json, zipfile, xml.etree.ElementTree as x\n"
            "z = zipfile.ZipFile(sys.argv[1]); assert z.testzip() is None\n"
            "i = z.infolist()[0]\n"
            "s = x.fromstring(z.read('stack.xml'))\n"
            "names = [l.get('src') for l in s.iter('layer')]\n"
            "print(json.dumps({'first': i.filename, 'plain': i.compress_type == 0, 'type': "
            "z.read('mimetype').decode(), 'size': [s.get('w'), s.get('h')], 'layers': [l.get('name') for "
            "l in s.iter('layer')], 'pngs': all(z.read(n)[:4] == b'\\x89PNG' for n in names + "
            "['mergedimage.png', 'Thumbnails/thumbnail.png'])}))\nEND"),
        "the archive");
    EXPECT_EQ(listed["first"], "mimetype");
    EXPECT_EQ(listed["plain"], true);
    EXPECT_EQ(listed["type"], "image/openraster");
    EXPECT_EQ(listed["size"], json::array({"320", "240"}));
    EXPECT_EQ(listed["pngs"], true);
    EXPECT_THAT(listed["layers"].dump(), testing::HasSubstr("layer 1"));
    EXPECT_EQ(tablet_->browser().errors, "");
}

// What was in the file beside the painting is there again, bit for bit; and with its paint the painting goes
// on on the tablet.
TEST_F(WebKeeping, SavesAFittedPaintingWithAllThatWasInItsFile) {
    const Surface surface = painted_surface(300, 220);
    PartToWrite part{{"residual", 150, 110, {"a", "b"}, {{"about", "something"}}, true}, {}};
    part.fill = [](int y0, int y1, std::span<float* const> planes) {
        for (int i = 0; i < (y1 - y0) * 150; ++i)
            planes[0][i] = 0.25f * static_cast<float>(y0 + i), planes[1][i] = 1;
    };
    {
        AtomicFile file(scratch_ / "fitted.exr");
        write_painting(file, surface, std::array{part});
    }
    ASSERT_TRUE(tablet_->open());
    begin_on(scratch_ / "fitted.exr");
    tablet_->pen(straight({300, 250}, {500, 320}), 0.6);
    ASSERT_TRUE(tablet_->is_settled());
    dry();
    tablet_->pen(straight({300, 320}, {500, 250}), 0.6);
    ASSERT_TRUE(tablet_->is_settled());
    const json hashes = tablet_->hashes();
    const fs::path saved = taken("Painting file (.exr)", "exr");
    const Canvas canvas = read_canvas(saved);
    EXPECT_EQ(hash_of(canvas.dry()), hash_of(surface));
    EXPECT_EQ(hash_of(canvas, hash_of(surface)), hashes["canvas"]);
    const auto before = parts_beside_paint(scratch_ / "fitted.exr"), after = parts_beside_paint(saved);
    ASSERT_EQ(after.size(), 1u);
    EXPECT_EQ(after[0].info.attributes, before[0].info.attributes);
    EXPECT_TRUE(after[0].info.half);
    std::vector<float> a(150 * 110 * 2), b(a.size());
    before[0].fill(0, 110, std::array{a.data(), a.data() + 150 * 110});
    after[0].fill(0, 110, std::array{b.data(), b.data() + 150 * 110});
    EXPECT_EQ(a, b);

    fs::copy_file(saved, scratch_ / "again.exr");
    tablet_->await("document.getElementById('to-gallery').click()");
    ASSERT_TRUE(tablet_->browser().becomes_true(
        "!tangipaint.open && !!document.querySelector('#works li:not(.new) .open')"));
    begin_on(scratch_ / "again.exr");
    EXPECT_EQ(tablet_->hashes()["canvas"], hashes["canvas"]) << "with its paint";
    EXPECT_EQ(tablet_->await("tangipaint.open.state.layers.length"), 1);
    EXPECT_EQ(tablet_->browser().errors, "");
}

// A retouch painted on the tablet is taken by the desk's command, within the damage.
TEST_F(WebKeeping, GivesARetouchThatTheTreatmentTakes) {
    const std::string painting = (scratch_ / "fitted.exr").string(),
                      treatment = (scratch_ / "p.treatment").string();
    write_painting(painting, painted_surface(300, 220));
    ASSERT_TRUE(tablet_->open());
    begin_on(painting);
    tablet_->pen(straight({300, 250}, {500, 320}), 0.6);
    ASSERT_TRUE(tablet_->is_settled());
    const fs::path journal = taken("Journal", "jsonl");
    ASSERT_TRUE(ended(tangipaint({"damage", painting, "--treatment", treatment, "--class", "loss_to_ground",
                                  "--polygon", "-3,-3;3,-3;3,3;-3,3"}),
                      0));
    const Finished retouched = tangipaint(
        {"treatment", "retouch", treatment, "--strokes", journal.string(), "--class", "loss_to_ground"});
    ASSERT_TRUE(ended(retouched, 0));
    EXPECT_GT(retouched.json()["retouches"][0]["area_cm2"].get<double>(), 0.05);
    EXPECT_EQ(retouched.json()["retouches"][0]["on_original"]["pixels"], 0);
    EXPECT_TRUE(ended(tangipaint({"treatment", "check", treatment}), 0));
}

// A browser that can hand files to other apps, as a stand-in: what it is given, and a painter who thinks
// better of it.
TEST_F(WebKeeping, SharesFilesWhereTheBrowserCan) {
    tablet_->browser().call(
        "Page.addScriptToEvaluateOnNewDocument",
        {{"source",
          "navigator.canShare = ({files}) => files.every(f => f.type === 'image/png');"
          "navigator.share = async ({files, title}) => { if (window.thinksBetter) throw new "
          "DOMException('no', 'AbortError'); window.shared = {name: files[0].name, size: "
          "files[0].size, title}; };"}});
    begin();
    paint_three_strokes();
    const auto press = [&](const std::string& text) {
        tablet_->await(
            "[...document.querySelectorAll('#sheet-painting button')].find(b => b.textContent === " +
            json(text).dump() + ").click()");
    };
    tablet_->await("document.getElementById('open-painting').click()");
    press("To another app");
    press("Picture");
    ASSERT_TRUE(tablet_->browser().becomes_true("!!window.shared")) << tablet_->browser().errors;
    EXPECT_EQ(tablet_->await("window.shared.name"), "Test.png");
    EXPECT_GT(tablet_->await("window.shared.size"), 1000);
    taken("Journal", "jsonl");  // which no other app takes: a file
    tablet_->await("window.thinksBetter = true, window.shared = null, 1");
    press("Picture");
    ASSERT_TRUE(tablet_->browser().becomes_true("document.getElementById('busy').hidden"));
    EXPECT_EQ(tablet_->await("window.shared"), nullptr);
    EXPECT_EQ(tablet_->browser().errors, "");
}

// The browser's own limit is met: what does not fit is told, kept in memory, and written once there is room.
// Chromium asks for what is left once in a while, so the limit is there before the first stroke; of
// estimate() it makes up a number.
TEST_F(WebKeeping, SaysWhenTheBrowserHasNoRoomLeft) {
    const auto limit = [&](const json& bytes) {
        json what = {{"origin", server_.url()}};
        if (!bytes.is_null()) what["quotaSize"] = bytes;
        tablet_->browser().call("Storage.overrideQuotaForOrigin", what);
    };
    ASSERT_TRUE(tablet_->open()) << tablet_->browser().errors;
    tablet_->await("navigator.serviceWorker.ready.then(() => 1)");
    limit(tablet_->await("navigator.storage.estimate().then(e => e.usage + 100000)"));
    ASSERT_TRUE(tablet_->begin(kSmall)) << tablet_->browser().errors;
    const auto is_full = [&] { return tablet_->await("document.getElementById('asked').open") == true; };
    int strokes = 0;
    for (; strokes < 40 && !is_full(); ++strokes) {
        tablet_->pen(straight({260, 260 + 4 * strokes}, {540, 260 + 4 * strokes}, 200));
        ASSERT_TRUE(tablet_->browser().becomes_true(
            "document.getElementById('asked').open || tangipaint.open.work.unstored === 0"));
    }
    ASSERT_TRUE(asks("no room to keep")) << strokes;
    EXPECT_EQ(tablet_->await("tangipaint.open.work.unstored"), 1);
    EXPECT_EQ(kept(), strokes - 1);
    write_text_file(scratch_ / "journal.jsonl", tablet_->journal());
    EXPECT_EQ(std::ranges::count_if(
                  read_journal(scratch_ / "journal.jsonl").entries,
                  [](const auto& entry) { return std::holds_alternative<StrokeEvent>(entry.event); }),
              strokes)
        << "what can be saved by hand has the last one, too";
    tablet_->await("document.querySelector('#asked .button').click()");
    limit(nullptr);
    tablet_->pen(straight({260, 500}, {340, 500}));
    ASSERT_TRUE(tablet_->is_settled());
    EXPECT_EQ(kept(), strokes + 1);
    EXPECT_EQ(tablet_->browser().errors, "");
}

// As if the strokes had been painted on that ground; the journal then goes on from it.
TEST_F(WebKeeping, ChangesTheLookOfTheGroundUnderThePaint) {
    begin();
    paint_three_strokes();
    tablet_->await("document.getElementById('open-painting').click()");
    tablet_->await(
        "(() => { const s = document.querySelector('#sheet-painting [aria-label^=Tone]'); s.value = 0.3; "
        "s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); })()");
    ASSERT_TRUE(tablet_->browser().becomes_true("!!tangipaint.open.work.record.choice.tint"));
    ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    const json choice = tablet_->await("tangipaint.open.work.record.choice");
    EXPECT_NEAR(choice["tint"][1].get<double>(), 0.37, 0.01);
    EXPECT_FALSE(choice.contains("specular")) << "what was not set";
    write_text_file(scratch_ / "journal.jsonl", tablet_->journal());
    const Journal journal = read_journal(scratch_ / "journal.jsonl");
    const auto ground = std::make_shared<const Surface>(make_ground(choice));
    Session session(ground, artist_acrylics());
    EXPECT_EQ(journal.head.on, hash_of(session.canvas(), hash_of(*ground)));
    replay(session, journal);
    EXPECT_EQ(tablet_->hashes()["canvas"], hash_of(session.canvas(), hash_of(*ground)));
    EXPECT_EQ(tablet_->hashes()["look"], hash_of(appearance(session.canvas())));
    EXPECT_EQ(tablet_->browser().errors, "");
}

TEST_F(WebKeeping, RefusesAPaintingThatMemoryDoesNotHold) {
    ASSERT_TRUE(tablet_->open());
    EXPECT_THAT(tablet_
                    ->await("tangipaint.create({title: 'Wall', choice: {substrate: 'linen', width_mm: 16000, "
                            "height_mm: 12000, pixel_mm: 1}}).then(() => 'open', e => e.message)")
                    .get<std::string>(),
                testing::HasSubstr("192.0 megapixels"));
    EXPECT_EQ(tablet_->await("tangipaint.storage.works().then(w => w.length)"), 0);
    ASSERT_TRUE(tablet_->begin(kSmall)) << "a smaller one";
}

TEST_F(WebKeeping, OpensAWorkInOneTabAtATime) {
    begin();
    paint_three_strokes();
    const std::string id = tablet_->await("tangipaint.open.work.record.id");
    // Another tab has it.
    tablet_->await("document.getElementById('to-gallery').click()");
    ASSERT_TRUE(tablet_->browser().becomes_true(
        "!tangipaint.open && !!document.querySelector('#works li:not(.new) .open')"));
    tablet_->await("new Promise(ready => navigator.locks.request('tangipaint-" + id +
                   "', () => { ready(1); return new Promise(done => { window.leave = done; }); }))");
    tablet_->await("document.querySelector('#works li:not(.new) .open').click()");
    ASSERT_TRUE(asks("open in another tab"));
    tablet_->await("document.querySelector('#asked .button').click(), window.leave()");
    tablet_->await("document.querySelector('#works li:not(.new) .open').click()");
    ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    EXPECT_EQ(tablet_->strokes(), 3);
}

// A newer version that keeps works otherwise waits in another tab: this one writes what it has, and closes.
TEST_F(WebKeeping, GivesWayToANewerVersionWithoutLosingAStroke) {
    begin();
    paint_three_strokes();
    const std::string id = tablet_->await("tangipaint.open.work.record.id");
    EXPECT_EQ(
        tablet_->await("new Promise((done, failed) => { const r = indexedDB.open('tangipaint', 2); "
                       "r.onsuccess = () => done(r.result); r.onerror = () => failed(r.error); "
                       "}).then(base => new Promise(done => { const r = "
                       "base.transaction('strokes').objectStore('strokes').getAll(IDBKeyRange.bound(['" +
                       id + "', 0], ['" + id +
                       "', Infinity])); r.onsuccess = () => "
                       "done(r.result.length); }))"),
        3);
    EXPECT_TRUE(asks("newer TangiPaint"));
}

// An update that cannot be fetched whole changes nothing; one that can waits until no page of the old version
// is open.
TEST_F(WebKeeping, UpdatesWithoutDisturbingAnOpenWork) {
    const fs::path app = scratch_ / "app";
    fs::copy(web_app(), app, fs::copy_options::recursive);
    const WebServer server(app);
    tablet_.emplace(scratch_.path(), server.url());
    begin();
    paint_three_strokes();
    ASSERT_TRUE(tablet_->browser().becomes_true("!!navigator.serviceWorker.controller"));
    const auto release = [&](const std::string& name, const std::string& further_file) {
        write_text_file(app / "share.js",
                        read_text_file(web_app() / "share.js") + "\nwindow.release = '" + name + "';\n");
        const std::string worker = read_text_file(web_app() / "service_worker.js");
        const std::string renamed =
            std::regex_replace(worker, std::regex("version = '[0-9a-f]+'"), "version = '" + name + "'");
        EXPECT_NE(renamed, worker);
        write_text_file(app / "service_worker.js",
                        std::regex_replace(renamed, std::regex("files = \\["), "files = [" + further_file));
        return tablet_->await(
            "navigator.serviceWorker.getRegistration().then(r => r.update().then(() => new Promise(done => { "
            "const w = r.installing ?? r.waiting; if (!w) done('none'); else if (w.state === 'installed') "
            "done(w.state); else w.onstatechange = () => done(w.state); })), e => e.name)");
    };
    EXPECT_THAT(release("half", "\"missing.js\", ").get<std::string>(), testing::AnyOf("redundant", "none"));
    EXPECT_EQ(release("next", ""), "installed");
    tablet_->pen(straight({260, 300}, {340, 320}));  // the open work goes on
    ASSERT_TRUE(tablet_->is_settled()) << tablet_->browser().errors;
    const json hashes = tablet_->hashes();
    tablet_->browser().call("Page.reload", {{"ignoreCache", false}});
    ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    EXPECT_EQ(tablet_->await("window.release ?? ''"), "") << "the old one, as a whole";
    EXPECT_EQ(tablet_->hashes(), hashes);
    const std::string id = tablet_->await("tangipaint.open.work.record.id");
    // Chromium takes its time to see that no page is open.
    for (int i = 0; i < 8 && tablet_->await("window.release ?? ''") != "next"; ++i) {
        tablet_->browser().call("Page.navigate", {{"url", "about:blank"}});
        std::this_thread::sleep_for(std::chrono::seconds(2));
        tablet_->browser().call("Page.navigate", {{"url", server.url() + "#" + id}});
        ASSERT_TRUE(tablet_->is_drawn()) << tablet_->browser().errors;
    }
    EXPECT_EQ(tablet_->await("window.release ?? ''"), "next");
    EXPECT_EQ(tablet_->hashes(), hashes);
    EXPECT_EQ(tablet_->browser().errors, "");
}

}  // namespace
}  // namespace tangi
