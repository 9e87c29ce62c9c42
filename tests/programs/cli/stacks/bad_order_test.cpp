// bad_order_test.cpp: lists of lights in another order than the photographs, as the program's user meets
// them: the advice is the one that explains, and nothing that leaves some lights wrong ends as good.
#include <algorithm>

#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

// Lists each photograph's name with the direction of the line that `of` says, counted from 0.
void exchange_directions(const TinyStack& stack, const std::function<std::size_t(std::size_t)>& of) {
    stack.change_lights([&](auto& lines) {
        const std::vector<std::string> right(lines.begin() + 1, lines.end());
        for (std::size_t i = 0; i < right.size(); ++i) {
            const std::string& other = right[of(i) % right.size()];
            lines[i + 1] = right[i].substr(0, right[i].find(' ')) + other.substr(other.find(' '));
        }
    });
}

TEST(CliBadOrder, OfOnePhotographIsNoTurn) {
    const TinyStack stack([](GeneratorOptions& options) { options.lights = 20; }, 80);
    const auto fit = [&](std::vector<std::string> flags) {
        flags.insert(flags.begin(), {"fit", stack.path(), "--out", stack.out("a.exr"), "--no-refine"});
        return tangipaint(flags);
    };
    EXPECT_TRUE(ended(fit({}), 0));
    std::filesystem::copy_file(stack.out("a.exr"), stack.out("right.exr"));
    exchange_directions(stack, [](std::size_t i) { return i + 1; });
    const Finished shifted = fit({});
    EXPECT_TRUE(ended(shifted, 3,
                      {"poor result: the list of lights is off by 1 photograph",
                       stack.name(2) + " fits the light of " + stack.name(1)}));
    EXPECT_EQ(shifted.err.find("give --light-rotation-deg"), std::string::npos) << shifted.err;
    // Whichever of painting and list is wrong.
    const auto compare = [&](const char* painting) {
        return tangipaint({"compare", stack.out(painting), stack.path(), "--out", stack.out("c")});
    };
    EXPECT_TRUE(ended(compare("right.exr"), 3,
                      {"have lights that others of them had when the painting was fitted",
                       stack.name(0) + " has the light that " + stack.name(1) + " had"}));
    EXPECT_TRUE(ended(compare("a.exr"), 3, {"poor result: the list of lights is off by 1 photograph"}));
    // What slopes alone advise, taken all the same.
    const double turn = shifted.json()["light_axes_check"]["turned"]["turn_deg"];
    const Finished turned =
        fit({"--light-rotation-deg", fmt::format("{:.0f}", turn > 90 ? turn - 180 : turn)});
    EXPECT_TRUE(ended(turned, 3, {"is off by 1 photograph", "leave out --light-rotation-deg"}));
}

}  // namespace
}  // namespace tangi
