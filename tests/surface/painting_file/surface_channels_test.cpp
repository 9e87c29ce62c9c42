// surface_channels_test.cpp: the hash that proves that a dry layer has not changed.
#include "surface/painting_file/surface_channels.h"

#include <gtest/gtest.h>

#include "surface/base/parallel.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

Surface random_channels(int width, int height) {
    Random random(1);
    Surface s(width, height);
    for (const DryChannel& channel : channels_of(s))
        for (std::size_t i = 0; i < s.height_mm.size(); ++i) channel.base[i * channel.stride] = random.real();
    return s;
}

TEST(HashOf, ChangesWithEveryMapAndStaysOtherwise) {
    Surface s = random_channels(20, 33);
    const std::string hash = hash_of(s);
    EXPECT_EQ(hash.size(), 16u);
    const auto changes = [&](float& value) {
        const float before = value;
        value = std::nextafter(before, 10.0f);
        const bool changed = hash_of(s) != hash;
        value = before;
        return changed && hash_of(s) == hash;
    };
    EXPECT_TRUE(changes(s.height_mm(19, 32)));
    EXPECT_TRUE(changes(s.normal(0, 0).y));
    EXPECT_TRUE(changes(s.diffuse(5, 16).b));
    EXPECT_TRUE(changes(s.specular(1, 1)));
    EXPECT_TRUE(changes(s.roughness(2, 30)));
    EXPECT_TRUE(changes(s.confidence(3, 3)));
    s.mm_per_pixel = 3;
    s.provenance = "{}";
    EXPECT_EQ(hash_of(s), hash);
    set_thread_count(1);
    EXPECT_EQ(hash_of(s), hash);
    set_thread_count(0);
}

TEST(HashOf, SeesRowsThatChangePlaces) {
    Surface s = random_channels(5, 4);
    const std::string hash = hash_of(s);
    for (int x = 0; x < 5; ++x) std::swap(s.specular(x, 1), s.specular(x, 2));
    EXPECT_NE(hash_of(s), hash);
}

}  // namespace
}  // namespace tangi
