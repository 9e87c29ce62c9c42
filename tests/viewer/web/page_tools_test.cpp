// page_tools_test.cpp: what visitors do on the published page beyond looking: compare states, measure,
// annotate.
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "tests/viewer/web/page_support.h"
#include "viewer/annotations/annotation_list.h"
#include "viewer/model/measurement.h"
#include "viewer/model/view_words.h"
#include "viewer/web/web_page.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

std::shared_ptr<const Surface> shared_surface(Surface s) {
    return std::make_shared<const Surface>(std::move(s));
}

// A later state: lighter paint in the lower half, and a hill of a tenth of a millimetre there.
Surface retouched(Surface s) {
    for (int y = s.height() / 2; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            s.diffuse(x, y) = Rgb(0.9f) - 0.5f * s.diffuse(x, y);
            s.height_mm(x, y) += 0.1f;
        }
    return s;
}

class WebPageTools : public WebPageInABrowser {
protected:
    std::string page() const { return "file://" + (scratch_ / "page.html").string(); }
    std::string text(const std::string& selector) {
        const nlohmann::json said =
            browser_->evaluate(fmt::format("document.querySelector('{}')?.textContent", selector));
        return said.is_string() ? said.get<std::string>() : "";
    }
    void click_on(const std::string& selector) {
        browser_->evaluate(fmt::format("document.querySelector('{}').click()", selector));
    }
    bool is_whole() { return browser_->becomes_true("document.documentElement.dataset.drawn === 'whole'"); }
    // What "Download" would save; an id of the browser is no part of it.
    nlohmann::json downloaded() {
        EXPECT_TRUE(browser_->becomes_true("!document.querySelector('#notes .save').disabled"));
        browser_->evaluate(
            "URL.createObjectURL = blob => { blob.text().then(t => { window.saved = t; }); return 'blob:'; "
            "}; window.saved = ''");
        click_on("#notes .save");
        EXPECT_TRUE(browser_->becomes_true("window.saved !== ''"));
        return read_json(browser_->evaluate("window.saved").get<std::string>(), "the download");
    }
    // A file that is loaded by hand; what the page says of it.
    std::string loaded(const std::string& name, const std::string& content) {
        browser_->evaluate("document.getElementById('said').textContent = ''");
        browser_->evaluate(
            fmt::format("{{ const files = new DataTransfer(); files.items.add(new File([{}], '{}')); const "
                        "input = document.querySelector('#notes input');"
                        "input.files = files.files; input.dispatchEvent(new Event('change')); }}",
                        json_line(content), name));
        EXPECT_TRUE(browser_->becomes_true("document.getElementById('said').textContent !== ''"));
        return text("#said");
    }
};

TP_LONG TEST_F(WebPageTools, ComparesStatesLeftAndRightOfADivider) {
    const Surface before = painted_surface(kWidth, kHeight), after = painted_surface(kWidth, kHeight, 7);
    const std::array states = {WebState{"Before", shared_surface(before)},
                               WebState{"After", shared_surface(after)}};
    write_web_page(scratch_ / "page", states, {.title = "Ridges"});
    open(url_of(scratch_ / "page/index.html", 130, 40) + "&divider=0.5");
    browser_->evaluate("document.getElementById('curtain').style.visibility = 'hidden'");
    const Image<Rgb> a = reference(before, 130, 40), b = reference(after, 130, 40);
    const auto agreement = [&](const Image<Rgb>& seen, const Image<Rgb>& wanted, int from, int to) {
        Image<Rgb> part(to - from, kHeight), of(to - from, kHeight);
        for (int y = 0; y < kHeight; ++y)
            for (int x = from; x < to; ++x) {
                part(x - from, y) = seen(x, y);
                of(x - from, y) = wanted(x, y);
            }
        return part_within(part, of, 1.5);
    };
    Image<Rgb> seen = middle_of(browser_->screenshot());
    EXPECT_GE(agreement(seen, a, 0, kWidth / 2), 0.999);
    EXPECT_GE(agreement(seen, b, kWidth / 2, kWidth), 0.999);
    EXPECT_LT(agreement(seen, a, kWidth / 2, kWidth), 0.5) << "the states differ";
    // By keys, twice a tenth of the screen to the left; then one state alone.
    browser_->evaluate(
        "document.getElementById('curtain').style.visibility = ''; "
        "document.getElementById('curtain').focus()");
    for (int i = 0; i < 2; ++i) browser_->press("PageDown");
    EXPECT_TRUE(
        browser_->becomes_true("document.getElementById('curtain').getAttribute('aria-valuetext') === "
                               "'Before on the left 30 %, After on the right'"));
    browser_->evaluate("document.getElementById('curtain').style.visibility = 'hidden'");
    ASSERT_TRUE(is_whole());
    seen = middle_of(browser_->screenshot());
    const int moved = kWidth / 2 - kScreenWidth / 5;
    EXPECT_GE(agreement(seen, a, 0, moved), 0.999);
    EXPECT_GE(agreement(seen, b, moved, kWidth), 0.999);
    click_on("#curtained");
    ASSERT_TRUE(browser_->becomes_true("document.getElementById('curtain').hidden") && is_whole());
    EXPECT_GE(part_within(middle_of(browser_->screenshot()), a, 1.5), 0.999);
    EXPECT_EQ(browser_->errors, "");
}

TP_LONG TEST_F(WebPageTools, HoldsOnceWhatStatesHaveInCommon) {
    const Surface before = painted_surface(600, 600);
    const Surface after = retouched(before);
    const std::array states = {WebState{"Before", shared_surface(before)},
                               WebState{"After", shared_surface(after)}};
    const WebReport report =
        write_web_page(scratch_ / "page", states, {.title = "Ridges"}, {.shadow_side = 0});
    // Of 9 tiles of the finest level, the upper three are above what was retouched.
    EXPECT_EQ(report.shared_tiles, 3);
    EXPECT_TRUE(fs::exists(scratch_ / "page/parts/state1/0/0_2.js"));
    EXPECT_FALSE(fs::exists(scratch_ / "page/parts/state1/0/0_0.js"));
    open("file://" + (scratch_ / "page/index.html").string() +
         "#ui=0&zoom=1&shadows=0&ambient=0&shoulder=0&curtain=0&left=1&y=100");
    const Image<Rgb> one = browser_->screenshot();
    write_web_page(scratch_ / "alone.html", after, {.title = "Ridges"}, {.shadow_side = 0});
    open("file://" + (scratch_ / "alone.html").string() +
         "#ui=0&zoom=1&shadows=0&ambient=0&shoulder=0&y=100");
    EXPECT_GE(part_within(one, browser_->screenshot(), 1), 0.999);
    EXPECT_EQ(browser_->errors, "");
}

// A coloured light is a white one behind a filter: its strongest channel stays as it is.
TP_LONG TEST_F(WebPageTools, LightsInTheColourThatIsChosen) {
    const Surface s = painted_surface(kWidth, kHeight);
    write_web_page(scratch_ / "page.html", s, {.title = "Ridges"});
    open(url_of(scratch_ / "page.html", 130, 40) + "&colour=ff8040");
    Image<Rgb> wanted = reference(s, 130, 40);
    const Transfer srgb{Transfer::Kind::srgb};
    for (Rgb& pixel : wanted.pixels()) pixel *= srgb.decode(Rgb(1, 128 / 255.0f, 64 / 255.0f));
    EXPECT_GE(part_within(middle_of(browser_->screenshot()), wanted, 1.5), 0.999);
}

TP_LONG TEST_F(WebPageTools, MeasuresHeightsAsTheWindowDoes) {
    for (const bool known : {true, false}) {
        Surface s = painted_surface(kWidth, kHeight);
        s.scale_known = known;
        if (!known) s.mm_per_pixel = 1;
        const std::array states = {WebState{"Before", shared_surface(s)},
                                   WebState{"After", shared_surface(retouched(s))}};
        write_web_page(scratch_ / "page.html", states, {.title = "Ridges"});
        open(page() + "#ui=0&zoom=1&tool=ruler&curtain=0");
        browser_->drag({150, 150}, {250, 270});
        ASSERT_TRUE(
            browser_->becomes_true("/long/.test(document.querySelector('#profile .figures').textContent)"));
        const HeightProfile wanted = height_profile(s, {99.5, 104.5}, {199.5, 224.5});
        const auto [low, high] = std::minmax_element(wanted.height_mm.begin(), wanted.height_mm.end());
        const std::string said = text("#profile .figures"), unit = known ? "mm" : "px";
        double length = 0, over = 0, l = 0, h = 0;
        const std::string form =
            fmt::format("%lf {0} long, %lf {0} over the relief, heights from %lf to %lf {0}", unit);
        ASSERT_EQ(std::sscanf(said.c_str(), form.c_str(), &length, &over, &l, &h), 4) << said;
        EXPECT_NEAR(length, static_cast<double>(wanted.height_mm.size() - 1) * wanted.step_mm, 0.006);
        EXPECT_GT(over, length);
        // A thousandth is rounded, and the page has 16 bits of the range.
        EXPECT_NEAR(l, *low, 6e-4);
        EXPECT_NEAR(h, *high, 6e-4);
        // Both states where both are seen: the later one has a hill.
        browser_->evaluate("location.hash = 'curtain=1'");
        ASSERT_TRUE(browser_->becomes_true(
            "/Before: .*\\nAfter: .*/.test(document.querySelector('#profile .figures').textContent)"))
            << text("#profile .figures");
    }
    EXPECT_EQ(browser_->errors, "");
}

TP_LONG TEST_F(WebPageTools, KeepsAnnotationsWithTheirLightAndView) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight),
                   {.title = "Ridges", .id = "urn:tangipaint:ridges"});
    open_at(page() + "#azimuth=20&elevation=30&zoom=1&x=149.5&y=134.5", {1000, 700});
    click_on("#noted");
    click_on("[data-tool=point]");
    const nlohmann::json middle = browser_->evaluate(
        "[document.getElementById('picture').clientWidth / 2, "
        "document.getElementById('picture').clientHeight / 2]");
    const glm::dvec2 centre{middle[0].get<double>(), middle[1].get<double>()};
    browser_->click(centre + glm::dvec2(-49, 15));
    browser_->type("A loss, <b>old</b>");
    click_on("[data-tool=polygon]");
    for (const glm::dvec2 corner : {glm::dvec2{-100, -80}, {0, -80}, {0, -40}, {-100, -80}})
        browser_->click(centre + corner);
    browser_->type("A patch");
    const nlohmann::json saved = downloaded();
    EXPECT_EQ(saved["@context"], "http://www.w3.org/ns/anno.jsonld");
    ASSERT_EQ(saved["items"].size(), 2u);
    const nlohmann::json& point = saved["items"][0];
    EXPECT_EQ(point["type"], "Annotation");
    EXPECT_EQ(point["body"][0]["value"], "A loss, <b>old</b>");
    EXPECT_EQ(point["target"]["source"], "urn:tangipaint:ridges");
    // Half a pixel more than whole numbers at centres: 149.5 - 49 + 0.5, 134.5 + 15 + 0.5.
    EXPECT_NE(point["target"]["selector"]["value"].get<std::string>().find(R"(cx="101" cy="150")"),
              std::string::npos)
        << point;
    EXPECT_NE(saved["items"][1]["target"]["selector"]["value"].get<std::string>().find(
                  R"(points="50,55 150,55 150,95")"),
              std::string::npos)
        << saved["items"][1];
    EXPECT_NE(point["target"]["state"]["value"].get<std::string>().find("azimuth=20&elevation=30"),
              std::string::npos);

    // Another day, in another light: choosing one brings its light back.
    open_at(page() + "#azimuth=100&elevation=70", {1000, 700});
    click_on("#noted");
    ASSERT_TRUE(browser_->becomes_true("document.querySelectorAll('#notes li').length === 2"));
    EXPECT_EQ(text("#notes li:nth-child(1)"), "1 · A loss, <b>old</b>");
    click_on("#notes li:nth-child(2) .choose");
    EXPECT_TRUE(
        browser_->becomes_true("document.getElementById('angles').textContent === '20° · 30° high' && "
                               "!!document.querySelector('#notes .chosen')"));
    // One that is deleted comes back, once.
    browser_->evaluate("[...document.querySelectorAll('#notes .chosen button')].at(-1).click()");
    EXPECT_TRUE(browser_->becomes_true("document.querySelectorAll('#notes li').length === 1"));
    click_on("#notes .undo");
    EXPECT_TRUE(browser_->becomes_true("document.querySelectorAll('#notes li').length === 2"));
    EXPECT_EQ(browser_->errors, "");
}

TP_LONG TEST_F(WebPageTools, DrawsByKeysAlone) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight), {.title = "Ridges"});
    open_at(page() + "#zoom=1&x=149.5&y=134.5&tool=polygon", {1000, 700});
    browser_->evaluate("document.getElementById('picture').focus()");
    const auto press = [&](const char* key, int times) {
        for (int i = 0; i < times; ++i) browser_->press(key);
    };
    press("ArrowLeft", 5);
    press("Enter", 1);
    press("ArrowRight", 10);
    press("Enter", 1);
    press("ArrowDown", 4);
    press("Enter", 2);  // the same place again: it is closed
    ASSERT_TRUE(browser_->becomes_true("document.activeElement.matches('#notes textarea')"));
    const std::string svg = downloaded()["items"][0]["target"]["selector"]["value"];
    EXPECT_NE(svg.find(R"(points="100,135 200,135 200,175")"), std::string::npos) << svg;
    browser_->evaluate(
        "document.querySelector('[data-tool=ruler]').click(); document.getElementById('picture').focus()");
    press("Enter", 1);
    press("ArrowRight", 8);
    press("Enter", 1);
    EXPECT_TRUE(browser_->becomes_true(
        "/^8.00 mm long/.test(document.querySelector('#profile .figures').textContent)"))
        << text("#profile .figures");
    press("Escape", 1);
    EXPECT_TRUE(browser_->becomes_true("document.getElementById('profile').hidden"));
    EXPECT_EQ(browser_->errors, "");
}

// Shapes as treatments, IIIF and other programs write them; what is wrong with a file is said, and nothing of
// it taken.
TP_LONG TEST_F(WebPageTools, LoadsAnnotationsOfOthers) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight), {.title = "Ridges"});
    open_at(page(), {1000, 700});
    click_on("#noted");
    const auto annotation = [](const nlohmann::json& target) {
        return nlohmann::json{{"type", "Annotation"},
                              {"body", {{"type", "TextualBody"}, {"value", "theirs"}}},
                              {"target", target}};
    };
    const auto svg = [&](const std::string& shape) {
        return annotation({{"selector",
                            {{"type", "SvgSelector"},
                             {"value", "<svg xmlns=\"http://www.w3.org/2000/svg\">" + shape + "</svg>"}}}});
    };
    const nlohmann::json page_of_others = {
        {"type", "AnnotationPage"},
        {"items",
         {svg(R"(<path fill-rule="evenodd" d="M10.0 10.0L50 10L50 40ZM20 12l5 0l0 5z"/>)"),
          svg(R"(<circle cx="100" cy="100" r="20"/>)"), svg(R"(<path d="M10 100C20 80 40 80 50 100"/>)"),
          annotation("http://a.example/canvas#xywh=percent:10,10,50,20"),
          annotation({{"selector", {{"type", "PointSelector"}, {"x", 30}, {"y", 40}}}})}}};
    EXPECT_EQ(loaded("theirs.json", json_line(page_of_others)), "5 annotations were loaded.");
    ASSERT_TRUE(browser_->becomes_true("document.querySelectorAll('#notes li').length === 5"));
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('#overlay .area').length"), 3)
        << "path, circle and rectangle";
    const nlohmann::json kept = downloaded()["items"];
    for (std::size_t i = 0; i < 5; ++i)
        EXPECT_EQ(kept[i]["target"], page_of_others["items"][i]["target"]) << "what nobody changed stays";
    nlohmann::json named = page_of_others["items"][3];
    named["id"] = "urn:a";
    for (const auto& [content, said] : std::vector<std::pair<std::string, std::string>>{
             {"{", "bad.json: is no JSON"},
             {"{}", "bad.json: is no AnnotationPage of W3C Web Annotations"},
             {json_line({annotation("http://a.example/picture.jpg")}),
              "bad.json: item 1: it has no selector"},
             {json_line({svg("<circle cx='1' cy='1' r='1'/>"), svg("<g/>")}),
              "bad.json: item 2: its SvgSelector has no shape"},
             {json_line({svg("<polygon points='1,2 3,4'/>")}),
              "has a polygon with 2 points, and takes 3 or more"},
             {json_line({svg("<polygon points='1,2 3,b 5,6'/>")}), "points that are no numbers"},
             {json_line({annotation("http://a.example/canvas#xywh=1,2")}), "is no xywh=x,y,width,height"},
             {json_line({page_of_others["items"][0], named, named}),
              "bad.json: item 3 has the id of item 2"}}) {
        EXPECT_NE(loaded("bad.json", content).find(said), std::string::npos) << text("#said");
        EXPECT_EQ(browser_->evaluate("document.querySelectorAll('#notes li').length"), 5);
    }
    EXPECT_NE(loaded("far.json", json_line({svg("<rect x='290' y='10' width='100' height='10'/>")}))
                  .find("reach beyond this painting"),
              std::string::npos);
    EXPECT_EQ(browser_->errors, "");
}

// The window's file in a page, and the page's in the window: places, texts, light, view and look.
TP_LONG TEST_F(WebPageTools, SharesAnnotationsWithTheWindow) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight),
                   {.title = "Ridges", .id = "urn:tangipaint:ridges"});
    open_at(page() + "#azimuth=100&elevation=70", {1000, 700});
    click_on("#noted");
    WindowState window;
    window.painting = {kWidth, kHeight};
    window.lights[0].angles = {20, 30};
    window.tilt.angle_deg = {5, -12.5};
    window.view = {{140, 120}, 1.25, 15};
    window.mode = ViewMode::height;
    window.exposure_stops = 0.5f;
    AnnotationList list({}, {"urn:tangipaint:ridges", kWidth, kHeight});
    using Kind = AnnotationKind;
    for (const AnnotationShape& shape :
         {AnnotationShape{Kind::point, {{{30, 40.5}}}}, AnnotationShape{Kind::line, {{{0, 0}, {50.25, 60}}}},
          AnnotationShape{Kind::polygon, {{{1, 2}, {30, 2}, {30, 40}}, {{10, 5}, {20, 5}, {20, 15}}}},
          AnnotationShape{Kind::text, {{{150, 20}}}}})
        list.set_text(list.add(shape, view_words(window)), "A <loss> & more", false);
    EXPECT_EQ(loaded("window.json", text_of_page(json_of(list.now()))), "4 annotations were loaded.");
    ASSERT_TRUE(browser_->becomes_true("document.querySelectorAll('#notes li').length === 4"));
    click_on("#notes li:nth-child(3) .choose");
    EXPECT_TRUE(browser_->becomes_true("document.getElementById('angles').textContent === '20° · 30° high'"));
    EXPECT_EQ(browser_->evaluate("document.getElementById('look').value"), "4");
    // The page keeps a view of its own for one of them, which says the same.
    browser_->evaluate("document.querySelectorAll('#notes .chosen button')[1].click()");
    const nlohmann::json kept = downloaded()["items"];
    ASSERT_EQ(kept.size(), 4u);
    EXPECT_NE(kept[2]["target"]["state"], list.now()[2]->json["target"]["state"]);
    const Annotations back = annotations_of(kept, list.picture());
    for (std::size_t i = 0; i < back.size(); ++i) {
        EXPECT_EQ(back[i]->shape, list.now()[i]->shape) << i;
        EXPECT_EQ(back[i]->text, "A <loss> & more");
        WindowState seen;
        seen.painting = window.painting;
        follow_view_words(seen, back[i]->view);
        EXPECT_EQ(view_words(seen), view_words(window)) << i;
    }
    EXPECT_EQ(browser_->errors, "");
}

// A PNG in the pixels of the canvas, of what is shown, with what is drawn over it.
TP_LONG TEST_F(WebPageTools, SavesWhatIsShownAsAPicture) {
    write_web_page(scratch_ / "page.html", painted_surface(kWidth, kHeight), {.title = "Ridges"});
    open(url_of(scratch_ / "page.html", 130, 40));
    const Image<Rgb> seen = browser_->screenshot();
    browser_->evaluate(
        "URL.createObjectURL = blob => { const reader = new FileReader(); reader.onload = () => { "
        "window.saved = reader.result; };"
        "reader.readAsDataURL(blob); return 'blob:'; }; window.saved = ''; "
        "document.getElementById('snap').click()");
    ASSERT_TRUE(browser_->becomes_true("window.saved.startsWith('data:image/png;base64,')"));
    const std::string data = browser_->evaluate("window.saved");
    write_text_file(scratch_ / "saved.png", Browser::bytes_of(data.substr(data.find(',') + 1)));
    const Image<Rgb> saved = read_picture(scratch_ / "saved.png");
    ASSERT_EQ(saved.width(), kScreenWidth);
    EXPECT_GE(part_within(saved, seen, 1), 0.999);
    const std::string bytes = read_text_file(scratch_ / "saved.png");
    for (const std::string& words : {std::string("Title\0\0\0\0\0Ridges", 16),
                                     std::string("Description\0\0\0\0\0Painting, lit from 130", 38)})
        EXPECT_NE(bytes.find("iTXt" + words), std::string::npos) << words;
    EXPECT_EQ(bytes.find("Author"), std::string::npos) << "nobody is named";
}

// axe-core's rules, and targets of 44 pixels, with all panes open.
TP_LONG TEST_F(WebPageTools, IsAccessible) {
    const fs::path axe = fs::path(TP_SOURCE_DIR) / "build/web/npm/node_modules/axe-core/axe.min.js";
    const Surface s = painted_surface(kWidth, kHeight);
    const std::array states = {WebState{"Before", shared_surface(s)},
                               WebState{"After", shared_surface(retouched(s))}};
    write_web_page(scratch_ / "page.html", states, {.title = "Ridges", .credit = "A. Painter"});
    for (const glm::ivec2 screen : {glm::ivec2{390, 844}, {1366, 768}}) {
        open_at(page(), screen);
        for (const char* pane : {"#light-look-opens", "#noted", "[data-tool=point]"}) click_on(pane);
        browser_->evaluate(
            "{ const more = document.getElementById('more'); if (more.offsetWidth) more.click(); }");
        const nlohmann::json small = browser_->evaluate(
            "[...document.querySelectorAll('button, select, input, summary, [role=slider]')].map(e => [e.id "
            "|| e.textContent, e.getBoundingClientRect()])"
            ".filter(([, b]) => b.width > 0 && (b.width < 43.9 || b.height < 43.9)).map(([name]) => name)");
        EXPECT_EQ(small, nlohmann::json::array()) << screen.x;
        if (!fs::exists(axe)) continue;
        browser_->evaluate(read_text_file(axe) + ";1");
        browser_->evaluate(
            "axe.run(document, {resultTypes: ['violations']}).then(r => { window.violations = "
            "r.violations.map(v => v.id + ': ' + v.nodes.map(n => n.html.slice(0, 80)).join(' ')); })");
        ASSERT_TRUE(browser_->becomes_true("!!window.violations"));
        EXPECT_EQ(browser_->evaluate("window.violations"), nlohmann::json::array()) << screen.x;
    }
    if (!fs::exists(axe)) GTEST_SKIP() << "no axe-core here: script/web fetches it";
}

}  // namespace
}  // namespace tangi
