// bad_axes_test.cpp: lights whose axes are exchanged, as the program's user meets them: what is advised mends
// them. Mirrored and turned axes: bad_input_test.cpp.
#include <gtest/gtest.h>

#include <sstream>

#include "capture/stack/stack_calibration.h"
#include "tests/programs/support/cli_program.h"
#include "tests/support/fit/axes_advice.h"

namespace tangi {
namespace {

// Lines of a lights file as one has them whose axes are such.
void list_as(const char* axes_of_file, std::vector<std::string>& lines) {
    const LightAxes axes = light_axes_of(axes_of_file).value();
    for (std::size_t i = 1; i < lines.size(); ++i) {
        std::istringstream words(lines[i]);
        std::string name;
        Vec3 v;
        words >> name >> v.x >> v.y >> v.z;
        v = axes.applied(v);
        lines[i] = fmt::format("{} {:.6f} {:.6f} {:.6f}", name, v.x, v.y, v.z);
    }
}

TEST(CliBadAxes, AreMendedByWhatIsAdvised) {
    const TinyStack stack({}, 80);
    const auto fit = [&](const std::vector<std::string>& flags) {
        std::vector<std::string> words = {"fit", stack.path(), "--out", stack.out("a.exr"), "--no-refine"};
        words.insert(words.end(), flags.begin(), flags.end());
        return tangipaint(words);
    };
    const Finished right = fit({});
    ASSERT_TRUE(ended(right, 0));
    struct Wrong {
        const char* listed;
        std::vector<std::string> given;
        const char* advice;
    };
    const std::string as_listed = bytes_of(stack.lights());
    for (const auto& [listed, given, advice] :
         {Wrong{"y,x,z", {}, ": give --light-axes y,x,z\n"},
          Wrong{"-y,-x,z", {}, ": give --light-axes -y,-x,z\n"},
          Wrong{"y,x,z", {"--light-axes", "x,-y,z"}, ": give --light-axes y,x,z\n"}}) {
        write_bytes(stack.lights(), as_listed);
        stack.change_lights([&, axes = listed](auto& lines) { list_as(axes, lines); });
        const Finished wrong = fit(given);
        EXPECT_TRUE(ended(wrong, 3, {"poor result", advice}));
        const Finished mended = fit(advised_flags(wrong.err));
        EXPECT_TRUE(ended(mended, 0));
        EXPECT_EQ(mended.json()["dry_hash"], right.json()["dry_hash"]) << wrong.err;
    }
}

}  // namespace
}  // namespace tangi
