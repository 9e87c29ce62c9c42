// annotation_window_test.cpp: annotations in the real window, by pointer and keyboard: drawn, written,
// chosen, changed, deleted; saved where `export --annotations` takes them from, and not lost before.
#include <gmock/gmock.h>

#include "tests/programs/support/painting_window.h"
#include "viewer/annotations/annotation_document.h"
#include "viewer/model/view_words.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Drawn = AnnotationKind;

class AnnotationWindow : public Window {
protected:
    void SetUp() override {
        Window::SetUp();
        if (IsSkipped()) return;
        saved_ = folder_ / "small.annotations.json";
        unsaved_ = folder_ / "small.annotations.unsaved.json";
        state_.painting = {160, 120};
        state_.view = fitted(state_.painting, kArea);
    }
    // Where a place of the painting is on the screen, as it was opened.
    std::pair<int, int> at(double x, double y) const {
        const glm::dvec2 p = placement_of(state_, kArea).to_screen({x, y});
        return {static_cast<int>(std::lround(p.x)) + Screen::kWidth - kArea.width,
                static_cast<int>(std::lround(p.y))};
    }
    void write(const std::string& text) {
        screen_->enter(text);
        screen_->settled();
    }
    void save() {
        screen_->key("ctrl+s");
        EXPECT_TRUE(Screen::until([&] { return fs::exists(saved_) && !fs::exists(unsaved_); }));
        screen_->settled();
    }
    Annotations in_file(const fs::path& file) const {
        return annotations_of(read_annotations(file.string(), file.string()), {"", 160, 120});
    }
    // Until changes that were made are on the disk.
    Annotations kept(std::size_t count, const std::string& last_text) const {
        EXPECT_TRUE(Screen::until([&] {
            if (!fs::exists(unsaved_)) return false;
            const Annotations now = in_file(unsaved_);
            return now.size() == count && now.back()->text == last_text;
        })) << last_text;
        return fs::exists(unsaved_) ? in_file(unsaved_) : Annotations();
    }
    // But for the ends of scales, which are the painting's.
    static std::string seen_in(const std::string& words) { return words.substr(0, words.find("&lowest=")); }
    void expect_near(const Annotation& annotation, Drawn kind, const std::vector<glm::dvec2>& ring) {
        EXPECT_EQ(annotation.shape.kind, kind);
        ASSERT_EQ(annotation.shape.rings[0].size(), ring.size());
        for (std::size_t i = 0; i < ring.size(); ++i)  // a pixel of the screen is a quarter of the painting's
            EXPECT_LT(glm::length(annotation.shape.rings[0][i] - ring[i]), 0.5) << annotation.text << i;
    }

    static constexpr Extent kArea{Screen::kWidth - 300, Screen::kHeight};  // beside the panels
    // The painting, where no mark of these tests lies, and no probe.
    static constexpr Region kFree{345, 450, 930, 560};
    fs::path saved_, unsaved_;
    WindowState state_;  // as the window begins
};

TEST_F(AnnotationWindow, DrawsWritesAndSavesEachKind) {
    start();
    const auto bare = screen_->settled();
    screen_->key("a");
    click(at(40, 30));
    EXPECT_TRUE(screen_->becomes_different(
        bare, {at(40, 30).first - 12, at(40, 30).second - 12, at(40, 30).first + 12, at(40, 30).second + 12},
        0.1))
        << "its mark lies where it was drawn";
    write("A loss, <old>");
    screen_->key("shift+a");
    screen_->drag(1, at(60, 20), at(110, 30));
    write("A crack");
    screen_->key("shift+a");
    for (const auto& corner : {at(70, 50), at(100, 50), at(100, 70), at(70, 50)}) click(corner);
    write("A patch");
    screen_->key("shift+a");
    click(at(20, 60));
    write("Signature");
    const std::string painting = bytes_of(painting_);
    EXPECT_FALSE(fs::exists(saved_));
    kept(4, "Signature");
    save();
    const Annotations all = in_file(saved_);
    ASSERT_EQ(all.size(), 4u);
    expect_near(*all[0], Drawn::point, {{40, 30}});
    expect_near(*all[1], Drawn::line, {{60, 20}, {110, 30}});
    expect_near(*all[2], Drawn::polygon, {{70, 50}, {100, 50}, {100, 70}});
    expect_near(*all[3], Drawn::text, {{20, 60}});
    EXPECT_EQ(all[0]->text, "A loss, <old>");
    EXPECT_EQ(all[3]->text, "Signature");
    EXPECT_THAT(all[3]->json["target"]["source"].get<std::string>(), testing::StartsWith("urn:tangipaint:"));
    for (const auto& one : all)
        EXPECT_EQ(seen_in(one->view), seen_in(view_words(state_))) << "as it was opened";
    EXPECT_EQ(close().code, 0);
    EXPECT_EQ(bytes_of(painting_), painting) << "it was not painted on, and not written anew";
    EXPECT_THAT(names_in(folder_.path()), ElementsAre("small.annotations.json", "small.exr"));
}

TEST_F(AnnotationWindow, ChoosingOneBringsItsLightViewAndLookBack) {
    start();
    screen_->key("a");
    click(at(40, 30));
    write("first");
    const auto first = screen_->settled();
    screen_->x({"key", "l"});
    screen_->drag(1, {kMiddleX, kMiddleY}, {kMiddleX + 300, kMiddleY + 20});
    screen_->x({"key", "comma", "key", "a", "mousemove", "20", "690"});
    screen_->settled();
    screen_->x({"mousemove", std::to_string(kMiddleX), std::to_string(kMiddleY), "click", "4"});
    const auto other = screen_->settled();
    EXPECT_GT(Screen::difference(first, other, kFree), 0.02);
    screen_->key("Return");  // another one, at the crosshair
    screen_->settled();
    write("second");
    screen_->key("ctrl+Next");  // after the last comes the first
    EXPECT_TRUE(screen_->becomes_alike(first, kFree, 0.004));
    screen_->settled();
    screen_->key("ctrl+Prior");
    EXPECT_TRUE(screen_->becomes_alike(other, kFree, 0.004));
    screen_->settled();
    // It keeps another view from now on.
    screen_->x({"key", "shift+F2"});
    screen_->key("ctrl+Next");
    screen_->settled();
    screen_->x({"key", "shift+F2"});
    save();
    const Annotations all = in_file(saved_);
    ASSERT_EQ(all.size(), 2u);
    WindowState seen = state_;
    follow_view_words(seen, all[1]->view);
    EXPECT_LT(seen.lights[0].angles.elevation_deg, 45);
    EXPECT_NEAR(seen.view.turn_deg, 15, 1e-6);
    EXPECT_GT(seen.view.zoom, state_.view.zoom);
    EXPECT_EQ(seen_in(all[0]->view), seen_in(view_words(state_)));
    EXPECT_EQ(close().code, 0);
}

TEST_F(AnnotationWindow, WorksByKeysAlone) {
    start();
    screen_->x({"mousemove", "20", "690", "key", "a", "key", "shift+a", "key", "shift+a"});
    screen_->x({"key", "Return", "key", "Right", "key", "Right", "key", "Return", "key", "Down", "key",
                "Down", "key", "Return", "key", "Return"});
    write("by keys");
    Annotations now = kept(1, "by keys");
    ASSERT_EQ(now.size(), 1u);
    const double step = 10 / state_.view.zoom;
    expect_near(*now[0], Drawn::polygon,
                {{79.5, 59.5}, {79.5 + 2 * step, 59.5}, {79.5 + 2 * step, 59.5 + 2 * step}});
    screen_->key("F2");
    screen_->settled();
    screen_->x({"key", "End"});
    write(", and more");
    kept(1, "by keys, and more");
    screen_->x({"key", "shift+a", "key", "shift+a", "key", "Left", "key", "Return"});  // a point
    write("a second");
    kept(2, "a second");
    screen_->key("Delete");
    kept(1, "by keys, and more");
    screen_->key("ctrl+z");
    kept(2, "a second");
    in_one_frame(
        {"key", "ctrl+z", "key", "ctrl+z", "key", "ctrl+z"});  // its text, itself, what was added before
    kept(1, "by keys");
    screen_->key("ctrl+y");
    kept(1, "by keys, and more");
    save();
    EXPECT_EQ(close().code, 0);
    EXPECT_EQ(in_file(saved_)[0]->text, "by keys, and more");
}

TEST_F(AnnotationWindow, CornersCanBeMoved) {
    start();
    screen_->x({"key", "a", "key", "shift+a"});
    screen_->drag(1, at(60, 20), at(110, 30));
    write("A crack");
    screen_->drag(1, at(110, 30), at(120, 70));
    EXPECT_TRUE(Screen::until(
        [&] { return fs::exists(unsaved_) && in_file(unsaved_)[0]->shape.rings[0][1].y > 69; }));
    const Annotations now = in_file(unsaved_);
    expect_near(*now[0], Drawn::line, {{60, 20}, {120, 70}});
    EXPECT_EQ(now[0]->text, "A crack");
    screen_->key("ctrl+z");
    screen_->settled();
    save();
    expect_near(*in_file(saved_)[0], Drawn::line, {{60, 20}, {110, 30}});
    EXPECT_EQ(close().code, 0);
}

TEST_F(AnnotationWindow, AsksBeforeItLosesAnnotations) {
    start();
    screen_->key("a");
    click(at(40, 30));
    write("not lost");
    screen_->key("ctrl+q");
    screen_->settled();
    EXPECT_TRUE(program_->running()) << "it asks";
    screen_->key("Return");  // save and close
    const Finished done = program_->wait();
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.json()["saves"], 0) << "the painting is as it was";
    ASSERT_TRUE(fs::exists(saved_));
    EXPECT_EQ(in_file(saved_)[0]->text, "not lost");
    EXPECT_FALSE(fs::exists(unsaved_));
}

TEST_F(AnnotationWindow, ThoseOfACrashAreThereAgain) {
    start();
    screen_->key("a");
    click(at(40, 30));
    write("before the crash");
    kept(1, "before the crash");
    program_->signal(SIGKILL);
    program_->wait();
    start();
    const auto again = screen_->settled();
    screen_->key("a");
    screen_->key("ctrl+z");  // as it was saved: without any
    EXPECT_TRUE(screen_->becomes_different(
        again, {at(40, 30).first - 12, at(40, 30).second - 12, at(40, 30).first + 12, at(40, 30).second + 12},
        0.1));
    EXPECT_TRUE(Screen::until([&] { return !fs::exists(unsaved_); }));
    screen_->key("ctrl+y");
    kept(1, "before the crash");
    program_->signal(SIGTERM);  // asks nothing, and loses nothing
    EXPECT_EQ(program_->wait().code, 0);
    EXPECT_EQ(in_file(unsaved_)[0]->text, "before the crash");
}

TEST_F(AnnotationWindow, ASecondWindowLooksOnly) {
    start();
    screen_->key("a");
    click(at(40, 30));
    write("of the first");
    save();
    click(at(100, 30));
    write("not saved");
    kept(2, "not saved");
    const std::string unsaved = bytes_of(unsaved_);
    const auto other_screen = Screen::open();
    ASSERT_TRUE(other_screen);
    const auto second = window_on(*other_screen);
    const auto [x, y] = at(70, 80);
    other_screen->x({"key", "a", "mousemove", std::to_string(x), std::to_string(y), "click", "1"});
    other_screen->settled();
    other_screen->key("ctrl+q");
    EXPECT_EQ(second->wait().code, 0) << "nothing is asked";
    EXPECT_EQ(bytes_of(unsaved_), unsaved);
    EXPECT_EQ(in_file(saved_).size(), 1u);
    save();
    EXPECT_EQ(in_file(saved_).size(), 2u);
    EXPECT_EQ(close().code, 0);
}

TEST_F(AnnotationWindow, LoadsThoseOfOthersAndCopiesThem) {
    write_bytes(folder_ / "theirs.json",
                R"({"type": "AnnotationPage", "items": [{"type": "Annotation", "bodyValue": "theirs",
                    "target": "http://a.example/canvas#xywh=20,20,40,30"}]})");
    write_bytes(folder_ / "bad.json", R"({"type": "AnnotationPage", "items": [{"type": "Annotation"}]})");
    start();
    const auto load = [&](const std::string& name) {
        screen_->key("ctrl+l");
        screen_->settled();
        write((folder_ / name).string());
    };
    load("bad.json");
    EXPECT_FALSE(fs::exists(unsaved_));
    load("theirs.json");
    kept(1, "theirs");
    screen_->key("ctrl+shift+l");
    screen_->settled();
    screen_->x({"key", "ctrl+a"});
    write((folder_ / "copy.json").string());
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "copy.json"); }));
    EXPECT_EQ(in_file(folder_ / "copy.json")[0]->text, "theirs");
    save();
    // They go with the painting when it is saved under another name.
    screen_->key("ctrl+shift+s");
    screen_->settled();
    screen_->x({"key", "ctrl+a"});
    write((folder_ / "other.exr").string());
    EXPECT_TRUE(Screen::until([&] { return fs::exists(folder_ / "other.annotations.json"); }));
    screen_->settled();
    EXPECT_EQ(close().json()["painting"], (folder_ / "other.exr").string());
    EXPECT_EQ(in_file(folder_ / "other.annotations.json")[0]->text, "theirs");
    EXPECT_EQ(in_file(saved_)[0]->text, "theirs");
}

}  // namespace
}  // namespace tangi
