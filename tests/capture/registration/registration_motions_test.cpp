// registration_motions_test.cpp: a camera that zooms, rolls or tilts moved as one that shifts did.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>

#include "capture/registration/camera_motion.h"
#include "capture/registration/registration.h"
#include "tests/support/capture/registration_scenes.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

constexpr int kMovedPhotos = 20;

struct KnownMotion {
    const char* name;
    MotionVector last;      // [pixels] of the last photograph
    double shift_px = 0;    // at random, beside it
    int from = 0;           // photograph from which on; 0: it grows from the first to the last
    int to = kMovedPhotos;  // and before which
    double lowest_deg = 25;
    Arrangement arrangement = Arrangement::dome;
};

void PrintTo(const KnownMotion& motion, std::ostream* out) { *out << motion.name; }

MotionVector motion_of_photo(const KnownMotion& known, int i) {
    const bool in = i >= known.from && i < known.to;
    const double part = known.from > 0 ? (in ? 1.0 : 0.0) : i / (kMovedPhotos - 1.0);
    MotionVector m = jitter(i, known.shift_px, 0);
    for (std::size_t p = 0; p < kMotion; ++p) m[p] += part * known.last[p];
    return m;
}

RegistrationScene scene_of(const KnownMotion& known) {
    return RegistrationScene(
        kMovedPhotos, [&](int i) { return motion_of_photo(known, i); }, painting(), known.lowest_deg,
        known.arrangement);
}

class RegisterStackThat : public testing::TestWithParam<KnownMotion> {};

TP_LONG TEST_P(RegisterStackThat, IsUndoneToTheErrorThatIsStated) {
    const KnownMotion& known = GetParam();
    const RegistrationScene scene = scene_of(known);
    Stack stack = open_stack(scene.folder.path());
    hold_out(stack, "3:8");
    const Registration r = register_stack(stack, {});
    EXPECT_TRUE(r.moved);
    EXPECT_THAT(stack.warnings, testing::IsEmpty());
    ASSERT_EQ(stack.photos.size() + stack.held_out.size(), std::size_t{kMovedPhotos});
    const std::size_t reference = scene.reference_of(r);
    double squares = 0, moved = 0;
    std::size_t fitted = 0, held_out = 0;
    for (int i = 0; i < kMovedPhotos; ++i) {
        const bool held = i >= 3 && (i - 3) % 8 == 0;
        const PhotoDrift& d = held ? r.held_out[held_out++] : r.photos[fitted++];
        const double error =
            scene.error_px(d.warped ? d.homography : Homography(1), static_cast<std::size_t>(i), reference);
        EXPECT_LT(error, std::max(0.15, 3 * d.error_px)) << d.name;
        if (!held) squares += error * error;
        const double by = rms_displacement(motion_of(scene.truth[static_cast<std::size_t>(i)], scene.frame));
        moved = std::max(moved, by);
    }
    const double rms = std::sqrt(squares / static_cast<double>(fitted));
    std::cout << fmt::format("[  FIGURE  ] {}: by {:.2f} px at most, undone to {:.3f} px rms\n", known.name,
                             moved, rms);
    EXPECT_LE(rms, 0.12);
}

// Half the diagonal is 156 pixels: 1.2 % of zoom, 0.6 degrees of roll, a tilt by up to 5 pixels in the
// corners.
INSTANTIATE_TEST_SUITE_P(
    RegisterStack, RegisterStackThat,
    testing::Values(
        KnownMotion{"zooms", {0, 0, 1.9}}, KnownMotion{"zooms_out", {0, 0, -1.9}},
        KnownMotion{"rolls", {0, 0, 0, 1.63}}, KnownMotion{"tilts", {0, 0, 0, 0, 0, 0, 5, -3}},
        KnownMotion{"rolls_and_shifts", {0, 0, 0, 1.63}, 1},
        KnownMotion{"zooms_and_rolls_far", {0, 0, 4, 3}, 0.5},
        KnownMotion{"zooms_by_low_lights", {0, 0, 1.9}, 0, 0, kMovedPhotos, 15},
        KnownMotion{
            "zooms_with_the_height_of_lights", {0, 0, 1.9}, 0, 0, kMovedPhotos, 25, Arrangement::spiral},
        KnownMotion{"zooms_once", {0, 0, 1.5}, 0, 8, 9}, KnownMotion{"rolls_late", {0, 0, 0, 1.5}, 0, 14}),
    [](const auto& scene) { return std::string(scene.param.name); });

// What calibration finds before it knows any light.
TP_LONG TEST(CameraMotions, FindsZoomAndRollWithoutAnyShift) {
    for (const MotionVector& last : {MotionVector{0, 0, 1.9}, MotionVector{0, 0, 0, 1.63}, MotionVector{}}) {
        const RegistrationScene scene(12, [&](int i) {
            MotionVector m = last;
            for (double& p : m) p *= i / 11.0;
            return m;
        });
        const PhotoSet set(open_stack(scene.folder.path()));
        const CameraMotions found = find_camera_motions(read_grey_photos(set));
        const bool moves = rms_displacement(last) > 0;
        EXPECT_EQ(found.moved, moves);
        if (!moves) continue;
        // Lights that go round move edges by 0.3 pixels themselves, which is all that is known of this
        // photograph's.
        const CameraMotion& end = found.photos.back();
        double squares = 0, count = 0;
        for (double y = 0; y <= 1; y += 0.125)
            for (double x = 0; x <= 1; x += 0.125, count += 1) {
                const glm::dvec2 p(x * kWidth, y * kHeight), there = mapped(scene.truth.back(), p);
                const glm::dvec2 d = end.to_photo(p, scene.frame.centre) - there;
                squares += glm::dot(d, d);
                EXPECT_LT(glm::length(end.to_common(there, scene.frame.centre) - p), 0.5);
            }
        const double rms = std::sqrt(squares / count);
        std::cout << fmt::format(
            "[  FIGURE  ] calibration follows a camera that moved by {:.2f} px to {:.3f} px\n",
            rms_displacement(last), rms);
        EXPECT_LT(rms, 0.3);
    }
}

}  // namespace
}  // namespace tangi
