// annotation_pen_test.cpp: what is drawn lies where the pointer was, however the painting is enlarged, turned
// and tilted; by hand and by keys.
#include "viewer/annotations/annotation_pen.h"

#include <GLFW/glfw3.h>
#include <gmock/gmock.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::IsEmpty;
using testing::SizeIs;
using Act = AnnotationAct::Kind;
using Drawn = AnnotationKind;

constexpr Extent kPenPainting{400, 300}, kPenScreen{800, 600};

class AnnotationPens : public testing::Test {
protected:
    AnnotationPen::Screen screen() const {
        const Placement::Pose pose{.tilt = {.angle_deg = tilt_deg_}};
        return {Placement(view_, pose, kPenPainting, kPenScreen, 0.1), kPenPainting, kPenScreen, 1};
    }
    glm::dvec2 seen(const glm::dvec2& at) const { return screen().placement.to_screen(at); }
    void press(const glm::dvec2& at) { pen_.press(screen(), seen(at), at); }
    void click(const glm::dvec2& at) {
        press(at);
        pen_.release(screen());
    }
    void drag(const glm::dvec2& from, const glm::dvec2& to) {
        press(from);
        for (const double t : {0.3, 0.7, 1.0}) pen_.drag(screen(), from + t * (to - from));
        pen_.release(screen());
    }
    void key(int code, int times = 1, int mods = 0) {
        for (int i = 0; i < times; ++i) EXPECT_TRUE(pen_.key(code, mods, screen(), view_));
    }
    // What was done since; the one that was placed is there then, and chosen.
    std::vector<AnnotationAct> acts() {
        std::vector<AnnotationAct> acts = std::exchange(state_.acts, {});
        for (const AnnotationAct& act : acts) {
            if (act.kind == Act::place) state_.chosen = list_.add(act.shape, "");
            if (act.kind == Act::reshape) list_.reshape(act.id, act.shape, act.goes_on);
            if (act.kind == Act::choose) state_.chosen = act.id;
        }
        state_.items = list_.now();
        return acts;
    }
    void expect_placed(const AnnotationShape& wanted) {
        const std::vector<AnnotationAct> done = acts();
        ASSERT_THAT(done, SizeIs(1));
        EXPECT_EQ(done[0].kind, Act::place);
        ASSERT_EQ(done[0].shape.rings.size(), 1u);
        EXPECT_EQ(done[0].shape.kind, wanted.kind);
        const auto &is = done[0].shape.rings[0], &was = wanted.rings[0];
        ASSERT_EQ(is.size(), was.size());
        for (std::size_t i = 0; i < is.size(); ++i) EXPECT_LT(glm::length(is[i] - was[i]), 1e-6) << i;
        EXPECT_FALSE(state_.draft);
    }

    AnnotationState state_;
    AnnotationList list_{{}, {"", kPenPainting.width, kPenPainting.height}};
    AnnotationPen pen_{state_};
    View view_ = fitted(kPenPainting, kPenScreen);
    glm::dvec2 tilt_deg_{0};
};

TEST_F(AnnotationPens, DrawEachKindWhereThePointerWas) {
    for (const double zoom : {0.5, 2.0, 20.0})
        for (const double turn_deg : {0.0, 30.0, -135.0})
            for (const double tilt : {0.0, 40.0}) {
                view_ = {{180, 120}, zoom, turn_deg};
                tilt_deg_ = {tilt, -tilt / 2};
                const glm::dvec2 a(180, 120), b = a + glm::dvec2(60, 5) / zoom,
                                              c = a + glm::dvec2(30, 50) / zoom;
                state_ = {};
                list_ = {{}, {"", kPenPainting.width, kPenPainting.height}};
                click(a);
                expect_placed({Drawn::point, {{a}}});
                state_.shown = false;  // marks are no targets
                state_.kind = Drawn::text;
                drag(a, b);
                expect_placed({Drawn::text, {{b}}});
                state_.kind = Drawn::line;
                drag(a, b);
                expect_placed({Drawn::line, {{a, b}}});
                click(a);
                EXPECT_THAT(acts(), IsEmpty()) << "its end is where the next click is";
                click(b);
                expect_placed({Drawn::line, {{a, b}}});
                state_.kind = Drawn::polygon;
                for (const glm::dvec2& corner : {a, b, c}) click(corner);
                EXPECT_THAT(acts(), IsEmpty());
                click(a);
                expect_placed({Drawn::polygon, {{a, b, c}}});
                for (const glm::dvec2& corner : {a, b, c, c}) click(corner);  // as a double click
                expect_placed({Drawn::polygon, {{a, b, c}}});
            }
}

TEST_F(AnnotationPens, StayOnThePainting) {
    click({-30, 500});
    expect_placed({Drawn::point, {{{-0.5, 299.5}}}});
    state_.kind = Drawn::line;
    drag({10, 10}, {900, 40});
    expect_placed({Drawn::line, {{{10, 10}, {399.5, 40}}}});
}

TEST_F(AnnotationPens, ChooseAndMoveWhatIsThere) {
    state_.kind = Drawn::polygon;
    for (const glm::dvec2& corner : {glm::dvec2(100, 100), {200, 100}, {200, 200}, {100, 100}}) click(corner);
    acts();
    const std::string polygon = state_.chosen;
    state_.kind = Drawn::point;
    click({300, 50});
    acts();
    const std::string point = state_.chosen;
    click({102, 101});  // on the first one's mark
    ASSERT_THAT(state_.acts, SizeIs(1));
    EXPECT_EQ(state_.acts[0].kind, Act::choose);
    EXPECT_EQ(state_.acts[0].id, polygon);
    acts();
    press({201, 199});  // its third corner
    for (const double x : {210.0, 230.0}) {
        pen_.drag(screen(), {x, 250});
        acts();
    }
    pen_.release(screen());
    EXPECT_EQ(annotation_in(state_.items, polygon)->shape.rings[0],
              (std::vector<glm::dvec2>{{100, 100}, {200, 100}, {230, 250}}));
    list_.undo();
    EXPECT_EQ(annotation_in(list_.now(), polygon)->shape.rings[0][2], glm::dvec2(200, 200)) << "one step";
    EXPECT_EQ(list_.now().size(), 2u) << "none was drawn";
    state_.refused = "another window has it";
    click({10, 10});
    ASSERT_THAT(state_.acts, SizeIs(1)) << "of which it is said why it cannot be";
    state_.acts.clear();
    press({300, 50});
    ASSERT_THAT(state_.acts, SizeIs(1));
    EXPECT_EQ(state_.acts[0].id, point) << "looking is not refused";
}

TEST_F(AnnotationPens, DrawByKeysAlone) {
    view_ = {{200, 150}, 2, 90};  // turned: up on the screen is to the right... of the painting
    state_.kind = Drawn::polygon;
    key(GLFW_KEY_ENTER);
    key(GLFW_KEY_RIGHT, 4);
    key(GLFW_KEY_ENTER);
    key(GLFW_KEY_DOWN, 2, GLFW_MOD_SHIFT);
    key(GLFW_KEY_DOWN);
    key(GLFW_KEY_ENTER);
    key(GLFW_KEY_ENTER);  // the same place again: it is closed
    expect_placed({Drawn::polygon, {{{200, 150}, {200, 170}, {194, 170}}}});
    state_.kind = Drawn::point;
    key(GLFW_KEY_LEFT, 2);
    key(GLFW_KEY_ENTER);
    expect_placed({Drawn::point, {{{194, 160}}}});
    // What is drawn can be given up, and the last point of it.
    state_.kind = Drawn::polygon;
    key(GLFW_KEY_ENTER);
    key(GLFW_KEY_LEFT);
    key(GLFW_KEY_ENTER);
    key(GLFW_KEY_BACKSPACE);
    EXPECT_THAT(state_.draft->points, SizeIs(1));
    key(GLFW_KEY_ESCAPE);
    EXPECT_FALSE(state_.draft || state_.cross);
    key(GLFW_KEY_ESCAPE);
    ASSERT_THAT(state_.acts, SizeIs(1));
    EXPECT_EQ(state_.acts[0].id, "") << "none is chosen any more";
    acts();
    for (const int other : {GLFW_KEY_ESCAPE, GLFW_KEY_BACKSPACE, GLFW_KEY_A})
        EXPECT_FALSE(pen_.key(other, 0, screen(), view_));
    EXPECT_FALSE(pen_.key(GLFW_KEY_LEFT, GLFW_MOD_CONTROL, screen(), view_));
}

TEST_F(AnnotationPens, TheViewFollowsTheCrosshair) {
    view_ = {{200, 150}, 20, 0};
    key(GLFW_KEY_RIGHT, 60);  // 30 pixels of the painting, and 20 are seen
    ASSERT_TRUE(state_.cross);
    EXPECT_NEAR(state_.cross->x, 230, 1e-6);
    const glm::dvec2 at = seen(*state_.cross);
    EXPECT_TRUE(at.x >= 0 && at.x <= kPenScreen.width);
    key(GLFW_KEY_RIGHT, 2000);
    EXPECT_EQ(state_.cross->x, 399.5) << "on the painting";
}

}  // namespace
}  // namespace tangi
