// sharpening_test.cpp: sharpened photographs are found by their noise, others are not.
#include "capture/registration/sharpening.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "capture/stack/compression.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kWide = 160, kHigh = 120, kPhotos = 12;

// [1] Uniform in -0.5 .. 0.5 from a hash.
float uniform(std::uint64_t key) {
    key = (key ^ (key >> 31)) * 0x9E3779B97F4A7C15u;
    key = (key ^ (key >> 29)) * 0xBF58476D1CE4E5B9u;
    key ^= key >> 32;
    return static_cast<float>(static_cast<double>(key >> 11) / 9007199254740992.0 - 0.5);
}

// Gentle hills under lights from all around, with noise of 0.004.
Image<float> photograph(int photo) {
    Image<float> picture(kWide, kHigh);
    const double angle = 2 * M_PI * photo / kPhotos;
    for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x) {
            const double p = 0.3 * std::sin(x / 9.0) * std::cos(y / 13.0), q = 0.3 * std::sin(y / 8.0);
            const auto key = static_cast<std::uint64_t>((photo * kHigh + y) * kWide + x);
            float noise = 0;
            for (std::uint64_t k = 0; k < 4; ++k) noise += uniform(7 * key + k + 1);
            picture(x, y) = static_cast<float>(0.4 * (0.8 - p * std::cos(angle) - q * std::sin(angle))) +
                            0.004f * noise / std::sqrt(4 / 12.0f);
        }
    return picture;
}

float mean_around(const Image<float>& p, int x, int y) {
    float sum = 0;
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
            sum += p(std::clamp(x + i, 0, p.width() - 1), std::clamp(y + j, 0, p.height() - 1));
    return sum / 9;
}

// Negative amounts soften.
Image<float> unsharp_mask(const Image<float>& p, float amount) {
    Image<float> result(p.width(), p.height());
    for (int y = 0; y < p.height(); ++y)
        for (int x = 0; x < p.width(); ++x)
            result(x, y) = p(x, y) + amount * (p(x, y) - mean_around(p, x, y));
    return result;
}

Sharpening of_stack(const std::function<Image<float>(const Image<float>&)>& change,
                    const std::string& extension = ".exr") {
    TestDir folder;
    std::vector<std::filesystem::path> paths;
    for (int i = 0; i < kPhotos; ++i) {
        const Image<float> grey = change(photograph(i));
        Image<Rgb> picture(kWide, kHigh);
        for (std::size_t k = 0; k < picture.size(); ++k) picture.pixels()[k] = Rgb(grey.pixels()[k]);
        paths.push_back(folder.path() / fmt::format("photo_{:02}{}", i, extension));
        write_picture(paths.back(), picture, {});
    }
    const Stack stack = open_photographs(paths);
    PictureCollector collected(stack);
    StackReader reader(stack);
    collected.add(reader.read(0, stack.height(), {}));
    return find_sharpening(collected, rounding_of_jpeg(stack));
}

TEST(Sharpening, OfUnsharpMasksIsFound) {
    for (const float amount : {0.7f, 1.2f}) {
        const Sharpening s = of_stack([&](const Image<float>& p) { return unsharp_mask(p, amount); });
        EXPECT_TRUE(s.found()) << amount << ": " << s.ratio << " ± " << s.error;
        EXPECT_THAT(says_sharpened(s), testing::HasSubstr("without sharpening"));
    }
}

TEST(Sharpening, OfPhotographsAsTheyCameIsNotFound) {
    for (const float amount : {0.0f, -0.5f}) {
        const Sharpening s = of_stack([&](const Image<float>& p) { return unsharp_mask(p, amount); });
        EXPECT_GT(s.blocks, 0);
        EXPECT_FALSE(s.suspected()) << amount << ": " << s.ratio << " ± " << s.error;
        EXPECT_EQ(says_sharpened(s), "");
    }
}

TEST(Sharpening, IsNotSaidOfJpeg) {
    const Sharpening s = of_stack([](const Image<float>& p) { return p; }, ".jpg");
    EXPECT_TRUE(s.compressed) << s.ratio;
    EXPECT_FALSE(s.suspected());
}

}  // namespace
}  // namespace tangi
