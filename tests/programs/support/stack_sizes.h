// stack_sizes.h: photographs of a size go through the program, from their making to the comparison.
#pragma once

#include <gmock/gmock.h>

#include <chrono>

#include "tests/programs/support/cli_program.h"

namespace tangi {

// Generates photographs, fits them but for some, relights the painting and compares it with those held out.
// `part` is that of the picture, in its middle, which a mask keeps: what is registered is all of it.
inline void expect_through_the_program(int width, int height, int lights, const std::string& hold_out,
                                       int held_out, double part = 1) {
    const TestDir dir;
    const std::string photos = (dir / "photos").string(), painting = (dir / "p.exr").string(),
                      mask = (dir / "mask.png").string(), picture = (dir / "relit.png").string();
    const Conditions patient{.timeout = std::chrono::seconds(3000)};
    ASSERT_TRUE(ended(tangipaint({"generate", "--out", photos, "--width", std::to_string(width), "--height",
                                  std::to_string(height), "--lights", std::to_string(lights), "--held-out",
                                  "0", "--supersampling", "1", "--seed", "3"},
                                 patient),
                      0));
    Image<Rgb> inside(width, height);
    int pixels = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (std::abs(y + 0.5 - height / 2.0) <= part * height / 2) inside(x, y) = Rgb(1), ++pixels;
    write_picture_8bit(mask, inside);
    const Finished fit =
        tangipaint({"fit", photos, "--out", painting, "--hold-out", hold_out, "--mask", mask}, patient);
    ASSERT_TRUE(ended(fit, 0));
    const nlohmann::json said = fit.json();
    EXPECT_EQ(said["photographs"]["fitted"], lights - held_out);
    EXPECT_EQ(said["photographs"]["held_out"], held_out);
    EXPECT_THAT(said["photographs"]["rejected"], testing::IsEmpty());
    EXPECT_FALSE(said["registration"]["moved"]);
    ASSERT_EQ(said["registration"]["held_out"].size(), static_cast<std::size_t>(held_out));
    for (const nlohmann::json& drift : said["registration"]["held_out"]) {
        EXPECT_TRUE(drift["registered"]) << drift;
        EXPECT_LT(drift["drift_px"], 0.2) << drift;
    }
    // Of few lights, too few may reach a pixel in a groove.
    EXPECT_LE(said["pixels"]["fitted"], pixels);
    EXPECT_GE(said["pixels"]["fitted"], pixels - (lights < 10 ? pixels / 1000 : 0));
    ASSERT_TRUE(ended(tangipaint({"relight", painting, "--light=-0.4,0.3,1", "--out", picture}, patient), 0));
    EXPECT_EQ(read_picture(picture).region(), inside.region());
    const Finished compare = tangipaint(
        {"compare", painting, photos, "--mask", mask, "--out", (dir / "compared").string()}, patient);
    ASSERT_TRUE(ended(compare, 0));
    const nlohmann::json mean = compare.json()["mean"];
    EXPECT_EQ(mean["held_out"]["count"], held_out);
    EXPECT_GT(mean["held_out"]["psnr_db"], 25) << mean;
}

}  // namespace tangi
