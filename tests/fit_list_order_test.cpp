// fit_list_order_test.cpp: a list of lights that is in another order than the photographs is told as that,
// and not as lights that are turned.
#include "fit/list_order.h"

#include <gmock/gmock.h>

#include "surface/light.h"
#include "tests/bumps.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<std::string> names_of(const Bumps& bumps) {
    std::vector<std::string> names;
    for (const Light& light : bumps.lights) names.push_back(light.name);
    return names;
}

// Each photograph gets the light of another one; `of` may be beyond the ends.
void list_otherwise(Bumps& bumps, const std::function<int(int)>& of) {
    const std::vector<Light> right = bumps.lights;
    const int count = static_cast<int>(right.size());
    for (int i = 0; i < count; ++i)
        bumps.lights[static_cast<std::size_t>(i)].direction =
            right[static_cast<std::size_t>((of(i) + count) % count)].direction;
}

ListOrder order_of(const Bumps& bumps, std::vector<int> lines = {}) {
    if (lines.empty())
        for (std::size_t i = 0; i < bumps.lights.size(); ++i) lines.push_back(static_cast<int>(i));
    return check_list_order(bumps.survey, Transfer{}, bumps.lights, lines, Bumps::kWidth, Bumps::kHeight);
}

// As slopes say it of lights that this makes right.
SignCheck turned_by(const LightTurn& turn) {
    SignCheck signs;
    signs.turned = {.turn = turn, .log_ratio = -2, .certainty = 20};
    return signs;
}

Bumps rings() { return Bumps(0.25, 0, 0.002, 0, Bumps::rings()); }

TEST(ListOrder, ShiftedByOneIsNoTurn) {
    for (const int shift : {1, -1, 2}) {
        Bumps bumps = rings();
        list_otherwise(bumps, [&](int i) { return i + shift; });
        const ListOrder order = order_of(bumps);
        ASSERT_FALSE(order.better.empty()) << shift;
        EXPECT_EQ(order.better[0].shift, -shift);
        EXPECT_FALSE(order.better[0].from);
        const std::string doubt = doubt_of(order, turned_by(order.better[0].turn), {}, names_of(bumps));
        EXPECT_THAT(
            doubt,
            AllOf(HasSubstr(fmt::format("is off by {} photograph", std::abs(shift))),
                  HasSubstr(fmt::format("photo_02.png fits the light of photo_{:02}.png", (18 - shift) % 16)),
                  Not(HasSubstr("--lights"))))
            << shift;
    }
}

// Most photographs are right then, and some are not.
TEST(ListOrder, IsToldOfLightsThatWereTurnedInstead) {
    Bumps bumps = rings();
    list_otherwise(bumps, [](int i) { return i + 1; });
    const LightTurn turn = order_of(bumps).better.at(0).turn;
    for (Light& light : bumps.lights) {
        const glm::dvec2 plane = turn.applied({light.direction.x, light.direction.y});
        light.direction = Vec3(static_cast<float>(plane.x), static_cast<float>(plane.y), light.direction.z);
    }
    LightFlips taken;
    taken.turn_deg = turn.turn_deg;
    EXPECT_THAT(doubt_of(order_of(bumps), {}, taken, names_of(bumps)),
                AllOf(HasSubstr("is off by 1 photograph"), HasSubstr("leave out --lights-turn"),
                      Not(HasSubstr("--lights-flip"))));
}

TEST(ListOrder, AnEntryThatIsMissingIsToldWithItsPlace) {
    Bumps bumps = rings();
    list_otherwise(bumps, [](int i) { return i < 5 ? i : i + 1; });
    const ListOrder order = order_of(bumps);
    ASSERT_FALSE(order.better.empty());
    EXPECT_EQ(order.better[0].from, 6u);  // of photo_05.png no light is listed
    EXPECT_EQ(order.better[0].shift, -1);
    EXPECT_THAT(
        doubt_of(order, {}, {}, names_of(bumps)),
        AllOf(HasSubstr("is off by 1 photograph from photo_06.png on"),
              HasSubstr("photo_07.png fits the light of photo_06.png"), HasSubstr("a line is missing")));
}

TEST(ListOrder, ThatRunsTheOtherWayIsTold) {
    Bumps bumps(0.25);
    list_otherwise(bumps, [](int i) { return 15 - i; });
    EXPECT_THAT(
        doubt_of(order_of(bumps), {}, {}, names_of(bumps)),
        AllOf(HasSubstr("runs the other way"), HasSubstr("photo_01.png fits the light of photo_14.png")));
}

// A list in another order than the names, as of rings from the top, slips by its lines.
TEST(ListOrder, SlipsByItsLines) {
    Bumps bumps = rings();
    std::vector<int> lines, photo_at(16);
    for (int i = 0; i < 16; ++i)
        lines.push_back(7 * i % 16), photo_at[static_cast<std::size_t>(7 * i % 16)] = i;
    list_otherwise(bumps, [&](int i) {
        return photo_at[static_cast<std::size_t>((lines[static_cast<std::size_t>(i)] + 1) % 16)];
    });
    const ListOrder order = order_of(bumps, lines);
    ASSERT_FALSE(order.better.empty());
    EXPECT_TRUE(order.better[0].by_lines);
    EXPECT_EQ(order.better[0].shift, -1);
}

TEST(ListOrder, ThatIsRightIsLeftAlone) {
    for (const double nearness : {0.0, 0.25}) {
        const Bumps bumps(0.25, nearness, 0.002, 0, Bumps::rings());
        EXPECT_THAT(doubt_of(order_of(bumps), {}, {}, names_of(bumps)), IsEmpty()) << nearness;
        // And where all lights are turned: a turn is one.
        EXPECT_THAT(doubt_of(order_of(bumps), turned_by({false, 36}), {}, names_of(bumps)), IsEmpty());
    }
    Bumps exchanged = rings();
    std::swap(exchanged.lights[3].direction, exchanged.lights[8].direction);
    EXPECT_THAT(doubt_of(order_of(exchanged), {}, {}, names_of(exchanged)), IsEmpty());
    Bumps flat(0);
    list_otherwise(flat, [](int i) { return i + 1; });
    EXPECT_THAT(doubt_of(order_of(flat), {}, {}, names_of(flat)), IsEmpty());
}

}  // namespace
}  // namespace tangi
