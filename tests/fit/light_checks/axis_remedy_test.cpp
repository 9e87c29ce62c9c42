// axis_remedy_test.cpp: what is advised of lights whose axes are wrong makes them right.
#include "fit/light_checks/axis_remedy.h"

#include <gmock/gmock.h>

#include "fit/light_checks/axis_check_shadows.h"
#include "tests/support/fit/axes_advice.h"
#include "tests/support/fit/relief_normals.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kAllAxes[] = {"x,y,z", "x,-y,z", "-x,y,z", "-x,-y,z",
                                "y,x,z", "y,-x,z", "-y,x,z", "-y,-x,z"};

LightAxes axes_said(const std::string& text, double rotation_deg = 0) {
    LightAxes axes = light_axes_of(text).value();
    axes.rotation_deg = rotation_deg;
    return axes;
}

LightAxes as_advised(const std::string& text) {
    LightAxes axes;
    const std::vector<std::string> flags = advised_flags(text);
    for (std::size_t i = 0; i + 1 < flags.size(); i += 2) {
        if (flags[i] == "--light-axes") axes = axes_said(flags[i + 1], axes.rotation_deg);
        if (flags[i] == "--light-rotation-deg") axes.rotation_deg = std::stod(flags[i + 1]);
    }
    return axes;
}

double apart(const Vec3& a, const glm::dvec2& b) { return glm::length(glm::dvec2(a.x, a.y) - b); }

TEST(AxesRemedy, FlagsAreTurnsAndBack) {
    const Vec3 listed(0.3f, 0.7f, 0.6f);
    for (const char* text : kAllAxes)
        for (const double rotation_deg : {0.0, 20.0, -90.0, 180.0}) {
            const LightAxes axes = axes_said(text, rotation_deg);
            const LightTurn turn = light_turn_of(axes);
            EXPECT_LT(apart(axes.applied(listed), turn.applied({listed.x, listed.y})), 1e-6) << text;
            EXPECT_EQ(light_turn_of(light_axes_of(turn)), turn) << text << rotation_deg;
        }
}

// Whatever was given before: what is advised is all that is to be given.
TEST(AxesRemedy, MakesWhatTheTurnMakesOfLightsAsTaken) {
    const Vec3 listed(0.3f, 0.7f, 0.6f);
    for (const char* text : kAllAxes)
        for (const double rotation_deg : {0.0, 90.0, -90.0, 180.0, 12.5})
            for (const bool mirrored : {false, true})
                for (const double turn_deg : {0.0, 90.0, 180.0, 270.0}) {
                    const LightAxes taken = axes_said(text, rotation_deg);
                    const LightTurn turn{mirrored, turn_deg};
                    if (turn == LightTurn{}) continue;
                    const std::string advice = axes_remedy(taken, turn);
                    const Vec3 as_taken = taken.applied(listed);
                    EXPECT_LT(
                        apart(as_advised(advice).applied(listed), turn.applied({as_taken.x, as_taken.y})),
                        1e-6)
                        << text << " " << rotation_deg << ": " << advice;
                }
}

TEST(AxesRemedy, SaysItInFewFlags) {
    EXPECT_EQ(axes_remedy({}, {true, 90}), "give --light-axes y,x,z");
    EXPECT_EQ(axes_remedy({}, {true, 270}), "give --light-axes -y,-x,z");
    EXPECT_EQ(axes_remedy({}, {false, 270}), "give --light-rotation-deg -90");
    EXPECT_EQ(axes_remedy({}, {true, 33.3}), "give --light-axes x,-y,z --light-rotation-deg 33");
    EXPECT_EQ(axes_remedy(axes_said("y,x,z"), {true, 90}), "leave out --light-axes");
    EXPECT_EQ(axes_remedy(axes_said("y,x,z", 90), {true, 180}),
              "leave out --light-axes --light-rotation-deg");
    EXPECT_EQ(axes_remedy(axes_said("y,x,z"), {false, 180}), "give --light-axes -y,-x,z");
    EXPECT_EQ(axes_remedy(axes_said("x,y,z", 12.5), {true, 0}),
              "give --light-axes x,-y,z --light-rotation-deg -12.5");
    EXPECT_EQ(axes_remedy(axes_said("x,-y,z", 90), {false, 90}),
              "give --light-axes -x,y,z and leave out --light-rotation-deg");
}

// Lights that are listed as each of the wrong axes says, and taken as the user asked, through the check of
// the slopes; shadows say which way round.
TEST(AxesRemedy, OfWhatSlopesSayMakesLightsRight) {
    const Vec3 right(0.3f, 0.7f, 0.6f);
    for (const char* wrong : kAllAxes)
        for (const char* given : {"x,y,z", "y,x,z", "-x,y,z", "y,-x,z"}) {
            const Vec3 listed = axes_said(wrong).applied(right);
            const LightAxes taken = axes_said(given);
            const LightTurn as_taken = light_turn_of(taken).after(light_turn_of(axes_said(wrong)));
            if (as_taken == LightTurn{}) continue;
            const glm::dvec2 x = as_taken.applied({1, 0}), y = as_taken.applied({0, 1});
            const SignCheck signs = ReliefNormals(0.3, 0.02, glm::dmat2(x, y)).check();
            const LightTurn one = signs.remedy();
            const bool is_right = one.after(as_taken) == LightTurn{};
            const ShadowCheck shadows{is_right ? one : one.opposite(), 20, -1};
            const std::string doubt = doubt_of(signs, shadows, taken);
            EXPECT_LT(apart(as_advised(doubt).applied(listed), {right.x, right.y}), 1e-6)
                << wrong << " " << given << ": " << doubt;
        }
}

TEST(AxesRemedy, OfExchangedAxesIsNoTurn) {
    const SignCheck signs = ReliefNormals(0.3, 0.02, glm::dmat2(0, 1, 1, 0)).check();
    EXPECT_THAT(doubt_of(signs, {}, {}),
                testing::AllOf(HasSubstr("were x and y of all lights exchanged"),
                               HasSubstr(": give --light-axes y,x,z; where that makes hills of valleys, give "
                                         "--light-axes -y,-x,z"),
                               Not(HasSubstr("--light-rotation-deg"))));
}

}  // namespace
}  // namespace tangi
