// compared_photos_test.cpp: photographs that a painting is compared with and does not know as they are:
// of a camera that moved, with each other's lights.
#include <gmock/gmock.h>

#include <glm/matrix.hpp>

#include "capture/formats/lights_file.h"
#include "fit/evaluate/compare.h"
#include "fit/evaluate/compared_lights.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr int kComparedWidth = 160, kComparedHeight = 120, kBeside = 20;

// Blotches of paint on a flat ground, larger than its photographs by kBeside on each side.
Surface blotches() {
    Random random(3);
    Image<float> tones((kComparedWidth + 2 * kBeside) / 5 + 2, (kComparedHeight + 2 * kBeside) / 5 + 2);
    for (float& tone : tones.pixels()) tone = random.real(0.1f, 0.8f);
    Surface s(kComparedWidth + 2 * kBeside, kComparedHeight + 2 * kBeside);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            s.diffuse(x, y) = Rgb(tones(x / 5, y / 5));
            s.confidence(x, y) = 1;
        }
    return s;
}

Surface part_of_blotches(const Surface& whole, int x0, int y0) {
    Surface s(kComparedWidth, kComparedHeight);
    for (int y = 0; y < kComparedHeight; ++y)
        for (int x = 0; x < kComparedWidth; ++x) {
            s.diffuse(x, y) = whole.diffuse(x0 + x, y0 + y);
            s.confidence(x, y) = 1;
        }
    return s;
}

// Four photographs of the painting, and one that it does not list, taken `dx`, `dy` pixels aside.
struct ComparedScene {
    TestDir dir;
    Surface surface;

    ComparedScene(int dx, int dy) {
        const Surface whole = blotches();
        surface = part_of_blotches(whole, kBeside, kBeside);
        surface.photography.white_level = 0.8;
        const Surface aside = part_of_blotches(whole, kBeside + dx, kBeside + dy);
        std::vector<Light> lights;
        const Vec3 directions[] = {{1, 0, 1}, {0, 1, 1}, {-1, 0.1f, 1}, {0, -1, 1}, {0.4f, 0.3f, 1}};
        for (std::size_t i = 0; i < 5; ++i) {
            lights.push_back(distant_light(directions[i], fmt::format("{}.png", i)));
            if (i < 4) surface.photography.photos.push_back({lights.back(), true});
            Image<Rgb> linear = relight(i < 4 ? surface : aside, {&lights.back(), 1});
            for (Rgb& pixel : linear.pixels()) pixel *= 0.8f;
            write_picture(dir / lights.back().name, linear, {});
        }
        write_lights(dir / "lights.lp", lights);
    }
};

TEST(ComparedPhotos, ThatThePaintingDoesNotListAreLaidOntoIt) {
    ComparedScene scene(7, -4);
    const CompareReport moved = compare(scene.surface, open_stack(scene.dir.path()));
    EXPECT_THAT(moved.warnings, Contains(AllOf(HasSubstr("1 photograph that the painting does not list is "
                                                         "laid onto it, by up to 8.1 px: 4.png"))));
    EXPECT_FALSE(moved.photos[4].fitted);
    EXPECT_GT(moved.photos[4].psnr_db, 30);
    // The part is laid onto the same part.
    StackOptions options;
    options.crop = Region{10, 6, 150, 112};
    ComparedScene part(7, -4);
    Surface inner(140, 106);
    for (int y = 0; y < 106; ++y)
        for (int x = 0; x < 140; ++x) {
            inner.diffuse(x, y) = part.surface.diffuse(x + 10, y + 6);
            inner.confidence(x, y) = 1;
        }
    inner.photography = part.surface.photography;
    EXPECT_GT(compare(inner, open_stack(part.dir.path(), options)).photos[4].psnr_db, 30);
    const CompareReport still =
        compare(ComparedScene(0, 0).surface, open_stack(ComparedScene(0, 0).dir.path()));
    EXPECT_THAT(still.warnings, testing::Not(Contains(HasSubstr("laid onto it"))));
    EXPECT_GT(still.photos[4].psnr_db, 60);
}

TEST(ComparedPhotos, WithEachOthersLightsAreTold) {
    ComparedScene scene(0, 0);
    Stack stack = open_stack(scene.dir.path());
    const Photography& known = scene.surface.photography;
    EXPECT_THAT(says_lights_are_exchanged(stack.photos, known, "f"), IsEmpty());
    const std::vector<Light> right = stack.lights();
    for (std::size_t i = 0; i < 4; ++i) stack.photos[i].light.direction = right[(i + 1) % 4].direction;
    EXPECT_THAT(says_lights_are_exchanged(stack.photos, known, "f"),
                AllOf(HasSubstr("f: 4 of 4 photographs have lights that others of them had"),
                      HasSubstr("0.png has the light that 1.png had")));
    EXPECT_THAT(compare(scene.surface, stack).exchanged, HasSubstr("shifted, or runs the other way"));
    // Lights of another day are their own.
    for (std::size_t i = 0; i < 4; ++i)
        stack.photos[i].light.direction = glm::normalize(right[i].direction + Vec3(0.3f, 0.2f, 0));
    EXPECT_THAT(says_lights_are_exchanged(stack.photos, known, "f"), IsEmpty());
}

}  // namespace
}  // namespace tangi
