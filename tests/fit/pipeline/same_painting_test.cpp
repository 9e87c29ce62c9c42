// same_painting_test.cpp: a stack that is turned, mirrored, cut, twice as large or in another order of names
// is the same painting.
#include <gmock/gmock.h>

#include <functional>
#include <iostream>

#include "fit/pipeline/fit_painting.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

constexpr int kWidth = 112, kHeight = 84;

// A stack with photographs of another shape, and how its pixels lie in the one it was made of.
struct Change {
    int width = kWidth, height = kHeight;
    std::function<glm::ivec2(int x, int y)> from = [](int x, int y) { return glm::ivec2(x, y); };
    std::function<Vec3(const Vec3&)> turned = [](const Vec3& v) { return v; };
    std::function<int(int)> number = [](int i) { return i; };
};

class SamePainting : public testing::Test {
protected:
    SamePainting() {
        const PaintingTruth truth = procedural_painting(
            {.seed = 5, .width = kWidth, .height = kHeight, .impasto = 0.3, .gilding = true});
        write_stack(folder_.path(), truth, {.lights = 20});
        stack_ = open_stack(folder_.path());
        whole_ = fit_painting(stack_).surface;
    }

    // [deg] Mean and largest angle between normals of the changed stack's painting and this one's.
    std::pair<double, double> apart_deg(const Change& change) const {
        const TestDir changed;
        std::vector<Light> lights = stack_.lights();
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const Image<Rgb> photo = read_picture(stack_.photos[i].path);
            Image<Rgb> picture(change.width, change.height);
            for (int y = 0; y < change.height; ++y)
                for (int x = 0; x < change.width; ++x) {
                    const glm::ivec2 at = change.from(x, y);
                    picture(x, y) = photo(at.x, at.y);
                }
            lights[i].name = fmt::format("photo_{:03}.png", change.number(static_cast<int>(i)));
            lights[i].direction = change.turned(lights[i].direction);
            write_picture(changed / lights[i].name, picture, {});
        }
        write_lights_file(changed / "lights.lp", lights);
        const Surface found = fit_painting(open_stack(changed.path())).surface;
        double sum = 0, most = 0;
        for (int y = 0; y < change.height; ++y)
            for (int x = 0; x < change.width; ++x) {
                const glm::ivec2 at = change.from(x, y);
                const Vec3 expected = change.turned(whole_.normal(at.x, at.y));
                const double angle =
                    std::acos(std::min(glm::dot(expected, found.normal(x, y)), 1.0f)) * 180 / M_PI;
                sum += angle;
                most = std::max(most, angle);
            }
        const double mean = sum / (change.width * change.height);
        std::cout << fmt::format("normals apart by {:.4f} deg, {:.2f} at most\n", mean, most);
        return {mean, most};
    }

    TestDir folder_;
    Stack stack_;
    Surface whole_;
};

// What is left are sums in another order, and pixels with two minima.
TP_LONG TEST_F(SamePainting, InAnotherOrderOfNames) {
    EXPECT_LT(apart_deg({.number = [](int i) { return 7 * i % 20; }}).first, 0.02);
}

TP_LONG TEST_F(SamePainting, Mirrored) {
    EXPECT_LT(apart_deg({.from = [](int x, int y) { return glm::ivec2(kWidth - 1 - x, y); },
                         .turned = [](const Vec3& v) { return Vec3(-v.x, v.y, v.z); }})
                  .first,
              0.02);
}

TP_LONG TEST_F(SamePainting, TurnedByAQuarter) {
    EXPECT_LT(apart_deg({.width = kHeight,
                         .height = kWidth,
                         .from = [](int x, int y) { return glm::ivec2(kWidth - 1 - y, x); },
                         .turned = [](const Vec3& v) { return Vec3(-v.y, v.x, v.z); }})
                  .first,
              0.02);
}

// Other pixels choose the models and calibrate the lights; and where a pixel has become four, its neighbours
// are itself.
TP_LONG TEST_F(SamePainting, CutOrTwiceAsLarge) {
    EXPECT_LT(
        apart_deg({.width = 80, .height = 60, .from = [](int x, int y) { return glm::ivec2(x + 9, y + 5); }})
            .first,
        0.15);
    EXPECT_LT(apart_deg({.width = 2 * kWidth,
                         .height = 2 * kHeight,
                         .from = [](int x, int y) { return glm::ivec2(x / 2, y / 2); }})
                  .first,
              0.6);
}

}  // namespace
}  // namespace tangi
