// list_order_test.cpp: a list of lights that is in another order than the photographs is told as that,
// and not as lights that are turned.
#include "fit/light_checks/list_order.h"

#include <gmock/gmock.h>

#include "surface/maps/light.h"
#include "tests/support/fit/bumps.h"
#include "tests/support/long_test.h"

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

TP_LONG TEST(ListOrder, ShiftedByOneIsNoTurn) {
    for (const int shift : {1, -1, 2}) {
        Bumps bumps = rings();
        list_otherwise(bumps, [&](int i) { return i + shift; });
        const ListOrder order = order_of(bumps);
        ASSERT_FALSE(order.better.empty()) << shift;
        EXPECT_EQ(order.better[0].slip.shift, -shift);
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
    LightAxes taken;
    taken.rotation_deg = turn.turn_deg;
    EXPECT_THAT(doubt_of(order_of(bumps), {}, taken, names_of(bumps)),
                AllOf(HasSubstr("is off by 1 photograph"), HasSubstr("leave out --light-rotation-deg"),
                      Not(HasSubstr("--light-axes"))));
}

// A list with y downwards, as the user says, which is shifted besides.
TEST(ListOrder, IsToldOfLightsWhoseAxesAreRight) {
    Bumps bumps = rings();
    list_otherwise(bumps, [](int i) { return i + 1; });
    const ListOrder order = order_of(bumps);
    EXPECT_THAT(doubt_of(order, turned_by(order.better.at(0).turn), {.flip_y = true}, names_of(bumps)),
                AllOf(HasSubstr("is off by 1 photograph"), Not(HasSubstr("--light-axes"))));
    EXPECT_THAT(doubt_of(order, {}, {.exchanged = true}, names_of(bumps)),
                AllOf(HasSubstr("leave out --light-axes"), Not(HasSubstr("--light-rotation-deg"))));
}

TEST(ListOrder, AnEntryThatIsMissingIsToldWithItsPlace) {
    Bumps bumps = rings();
    list_otherwise(bumps, [](int i) { return i < 5 ? i : i + 1; });
    const ListOrder order = order_of(bumps);
    ASSERT_FALSE(order.better.empty());
    EXPECT_EQ(order.better[0].from, 6u);  // of photo_05.png no light is listed
    EXPECT_EQ(order.better[0].slip.shift, -1);
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
    EXPECT_EQ(order.better[0].slip.shift, -1);
}

TP_LONG TEST(ListOrder, AnyShiftIsFound) {
    for (const int shift : {4, 5, 8, -7}) {
        Bumps bumps(0.25);
        list_otherwise(bumps, [&](int i) { return i + shift; });
        EXPECT_THAT(doubt_of(order_of(bumps), {}, {}, names_of(bumps)),
                    HasSubstr(fmt::format("is off by {} photographs", std::abs(shift))))
            << shift;
    }
    Bumps halves = rings();
    list_otherwise(halves, [](int i) { return i + 8; });
    EXPECT_THAT(doubt_of(order_of(halves), {}, {}, names_of(halves)), HasSubstr("its halves are exchanged"));
    Bumps both(0.25);
    list_otherwise(both, [](int i) { return 15 - i + 6; });
    EXPECT_THAT(doubt_of(order_of(both), {}, {}, names_of(both)),
                HasSubstr("runs the other way, and is off by 6"));
}

TEST(ListOrder, RowsThatRunOtherwiseAreFound) {
    Bumps snaked(0.25);
    list_otherwise(snaked, [](int i) { return i / 4 % 2 == 0 ? i : i / 4 * 4 + 3 - i % 4; });
    EXPECT_THAT(doubt_of(order_of(snaked), {}, {}, names_of(snaked)), HasSubstr("to and fro in rows of 4"));
    Bumps columns(0.25);
    list_otherwise(columns, [](int i) { return i % 8 * 2 + i / 8; });
    EXPECT_THAT(doubt_of(order_of(columns), {}, {}, names_of(columns)), HasSubstr("column by column"));
}

// photo_10 comes before photo_2 where letters are sorted.
TEST(ListOrder, NamesSortedByLettersAreFound) {
    Bumps bumps(0.25);
    const int by_letters[] = {0, 1, 10, 11, 12, 13, 14, 15, 2, 3, 4, 5, 6, 7, 8, 9};
    list_otherwise(bumps, [&](int i) { return by_letters[i]; });
    for (int i = 0; i < 16; ++i)
        bumps.lights[static_cast<std::size_t>(i)].name = fmt::format("photo_{}.png", i);
    EXPECT_THAT(doubt_of(order_of(bumps), {}, {}, names_of(bumps)), HasSubstr("10 before 2"));
}

TEST(ListOrder, ListOfOtherPhotographsFitsInNoOrder) {
    Bumps bumps(0.25);
    std::vector<int> dealt = {11, 4, 14, 0, 9, 6, 1, 13, 3, 15, 8, 2, 12, 5, 10, 7};
    list_otherwise(bumps, [&](int i) { return dealt[static_cast<std::size_t>(i)]; });
    EXPECT_THAT(doubt_of_any_order(order_of(bumps)),
                HasSubstr("do not fit the photographs in the order they are listed"));
    EXPECT_FALSE(order_of(Bumps(0.25)).fits_no_order());
}

// In one even ring a shift is a turn, so both are told.
TEST(ListOrder, ShiftOfAnEvenRingMayBeATurn) {
    std::vector<Light> ring;
    for (int i = 0; i < 16; ++i)
        ring.push_back(distant_light(
            Vec3(static_cast<float>(std::cos(i * 0.3927)), static_cast<float>(std::sin(i * 0.3927)), 0.8f),
            fmt::format("photo_{:02}.png", i)));
    Bumps bumps(0.25, 0, 0.002, 0, ring);
    list_otherwise(bumps, [](int i) { return i + 3; });
    const ListOrder order = order_of(bumps);
    const SignCheck signs = turned_by({false, 112.5});
    EXPECT_THAT(doubt_of(order, signs, {}, names_of(bumps)), IsEmpty());
    EXPECT_THAT(or_order(order, signs, names_of(bumps)), HasSubstr("so it is the order or the turn"));
    EXPECT_THAT(or_order(order_of(rings()), turned_by({false, 20}), names_of(bumps)), IsEmpty());
}

TEST(ListOrder, ThatIsRightIsLeftAlone) {
    for (const double inverse_distance : {0.0, 0.25}) {
        const Bumps bumps(0.25, inverse_distance, 0.002, 0, Bumps::rings());
        EXPECT_THAT(doubt_of(order_of(bumps), {}, {}, names_of(bumps)), IsEmpty()) << inverse_distance;
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
