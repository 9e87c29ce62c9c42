// registration_data_test.cpp: real and path-traced stacks whose camera stood still, or moved as is
// known.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>

#include "capture/registration/registration.h"
#include "surface/base/json_reading.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

void expect_still(const char* name, double most_px) {
    TP_DATA(folder, name);
    Stack stack = open_stack(folder);
    const std::size_t photos = stack.photos.size();
    const Registration r = register_stack(stack, {});
    std::cout << "[  FIGURE  ] " << name << ": typical drift " << r.typical_drift_px << " px\n";
    EXPECT_FALSE(r.moved) << name;
    EXPECT_LE(r.typical_drift_px, most_px) << name;
    EXPECT_EQ(stack.photos.size(), photos) << name;
    for (const StackPhoto& photo : stack.photos) EXPECT_FALSE(photo.homography) << photo.light.name;
}

TEST(DataRegistration, FindsNoMotionInFresco) { expect_still("real/fresco", 0.1); }
TEST(DataRegistration, FindsNoMotionInIcon) { expect_still("real/icon", 0.1); }
TEST(DataRegistration, FindsNoMotionInLeaf) { expect_still("real/leaf", 0.1); }
TEST(DataRegistration, FindsNoMotionInImpasto) { expect_still("impasto/png16", 0.05); }
// Metal: highlights are most of what there is to see.
TEST(DataRegistration, FindsNoMotionInCoin) { expect_still("real/coin", 0.4); }

TEST(DataRegistration, HandheldIsRegisteredToWithin0_15Pixels) {
    TP_DATA(folder, "handheld");
    Stack stack = open_stack(folder / "png16");
    const Registration r = register_stack(stack, {});
    const auto cameras = read_json(bytes_of(folder / "gt/cameras.json"), "JSON");
    ASSERT_EQ(r.photos.size(), cameras.size());
    const glm::dvec2 centre(351.5 - 17 / 0.4261, 263.5);  // of the painting, which is 200 mm wide
    const double half = 100 / 0.4261;
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < r.photos.size(); ++i) {
        const auto& rows = cameras[i].at("H_image_to_reference_z0");
        Homography to_reference(1);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                to_reference[column][row] =
                    rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
        for (double y = -1; y <= 1; y += 0.1)
            for (double x = -1; x <= 1; x += 0.1, count += 1) {
                const glm::dvec2 p = centre + half * glm::dvec2(x, y);
                const glm::dvec2 d = mapped(to_reference, mapped(r.photos[i].homography, p)) - p;
                sum += glm::dot(d, d);
            }
    }
    const double rms = std::sqrt(sum / count);
    std::cout << "[  FIGURE  ] handheld: jitter after registration " << rms << " px rms\n";
    EXPECT_LE(rms, 0.15);
}

}  // namespace
}  // namespace tangi
