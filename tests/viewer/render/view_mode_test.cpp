// view_mode_test.cpp: laws of the table of view modes, which a new row must keep.
#include "viewer/render/view_mode.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>

#include "viewer/render/painting_shader.h"

namespace tangi {
namespace {

int count_of(std::string_view text, std::string_view what) {
    int count = 0;
    for (std::size_t at = text.find(what); at != std::string_view::npos; at = text.find(what, at + 1))
        ++count;
    return count;
}

TEST(ViewModes, HaveNamesOfTheirOwnAndAPlaceInTheShader) {
    std::set<std::string> names;
    for (const ViewModeTraits& mode : view_modes()) {
        EXPECT_EQ(&traits_of(mode.mode), &mode) << mode.name;
        EXPECT_TRUE(names.insert(mode.name).second) << mode.name;
        EXPECT_EQ(count_of(painting_fragment_shader(), mode.chunk) >= 1, true) << mode.name;
    }
    EXPECT_EQ(count_of(painting_fragment_shader(), "#if MODE == "), static_cast<int>(view_modes().size()));
}

// One hook of painting.frag.glsl each; but for the painting as it is, which needs none.
TEST(ViewModes, ChunksChangeOneThing) {
    for (const ViewModeTraits& mode : view_modes()) {
        const std::string_view chunk = mode.chunk;
        const int map = count_of(chunk, "#define SHOWS_MAP\n"),
                  hooks = map + count_of(chunk, "#define CHANGES_MATERIAL\n") +
                          count_of(chunk, "#define CHANGES_REFLECTION\n");
        EXPECT_EQ(hooks, mode.mode == ViewMode::painting ? 0 : 1) << mode.name;
        EXPECT_EQ(count_of(chunk, "scaled("), mode.scale.curve == MapScale::Curve::none ? 0 : 1) << mode.name;
        EXPECT_TRUE(mode.scale.curve == MapScale::Curve::none || map == 1) << mode.name;
        // WebGL knows no other letters, not even in comments.
        EXPECT_TRUE(std::ranges::all_of(chunk, [](char c) { return c > 0; })) << mode.name;
    }
}

TEST(ViewModes, ScalesGoFromEndToEnd) {
    for (const ViewModeTraits& mode : view_modes()) {
        if (mode.scale.curve == MapScale::Curve::none) continue;
        const ScaleEnds ends = mode.scale.ends == MapScale::Ends::fixed ? mode.scale.fixed : ScaleEnds{-2, 3};
        EXPECT_NEAR(value_at(mode.scale, ends, 0), ends.lowest, 1e-12) << mode.name;
        EXPECT_NEAR(value_at(mode.scale, ends, 1), ends.highest, 1e-12) << mode.name;
        for (double t = 0; t < 1; t += 0.1)
            EXPECT_LT(value_at(mode.scale, ends, t), value_at(mode.scale, ends, t + 0.1)) << mode.name;
    }
}

}  // namespace
}  // namespace tangi
