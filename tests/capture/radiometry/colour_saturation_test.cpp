// colour_saturation_test.cpp: photographs made grey, or with more or less colour than the others, are
// named.
#include "capture/radiometry/colour_saturation.h"

#include <gmock/gmock.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kSaturationPhotos = 20;
constexpr Transfer kSaturationSrgb{Transfer::Kind::srgb};

// As programs do it: away from the grey of the encoded colour (Rec. 709 luma), or towards it.
Rgb saturated(const Rgb& linear, double scale) {
    const Rgb e = kSaturationSrgb.encode(linear);
    const float grey = 0.2126f * e.r + 0.7152f * e.g + 0.0722f * e.b;
    return kSaturationSrgb.decode(glm::clamp(Rgb(grey) + static_cast<float>(scale) * (e - grey), 0.0f, 1.0f));
}

// Matt paint of all colours under lights all around, some of it with a veil of gloss under low lights, in
// photographs whose light has a colour of its own, stored as 8 bits; `scale` is how much colour each
// photograph has.
template <class Scale>
ColourSamples photographed(const Scale& scale, double gloss = 0, double casts = 0) {
    Random random(7);
    ColourSamples s;
    s.photos = kSaturationPhotos;
    for (int k = 0; k < 900; ++k) {
        const Rgb paint = Rgb(random.real(0.08, 0.6)) *
                          Rgb(std::exp(0.3 * random.normal()), 1, std::exp(0.3 * random.normal()));
        s.part.push_back(k / 225);
        for (std::size_t i = 0; i < kSaturationPhotos; ++i) {
            const double low = static_cast<double>(i % 5) / 5;
            Rgb value =
                paint * random.real(0.4, 0.9) + Rgb(static_cast<float>(gloss * low * random.real(0, 0.1)));
            value *=
                Rgb(std::exp(casts * std::sin(double(i))), 1, std::exp(casts * std::cos(2.0 * double(i))));
            value = saturated(value, scale(i));
            for (int c = 0; c < 3; ++c)
                value[c] = kSaturationSrgb.decode(
                    std::round(255 * kSaturationSrgb.encode(value[c]) + 0.5f * float(random.normal())) / 255);
            s.values.push_back(value);
        }
    }
    return s;
}

int differing(const std::vector<ColourSaturation>& photos) {
    return static_cast<int>(
        std::count_if(photos.begin(), photos.end(), [](const auto& p) { return p.differs; }));
}

TEST(ColourSaturation, OfPhotographsThatAreAlikeIsAlike) {
    for (const double gloss : {0.0, 0.5, 1.0})
        for (const double casts : {0.0, 0.1}) {
            const auto found =
                colour_saturations(photographed([](std::size_t) { return 1.0; }, gloss, casts));
            ASSERT_EQ(found.size(), kSaturationPhotos);
            EXPECT_EQ(differing(found), 0) << gloss << ", " << casts;
        }
}

TEST(ColourSaturation, OfPhotographsMadeGreyOrChangedIsTold) {
    const auto scale = [](std::size_t i) {
        return i % 5 == 3 ? 0.0 : i == 6 ? 2.6 : i == 12 ? 0.2 : i == 13 ? 1.3 : 1.0;
    };
    for (const double gloss : {0.0, 0.5}) {
        const auto found = colour_saturations(photographed(scale, gloss, 0.05));
        ASSERT_EQ(found.size(), kSaturationPhotos);
        std::vector<std::string> names;
        for (std::size_t i = 0; i < found.size(); ++i) {
            names.push_back(fmt::format("img_{:03}.jpg", i));
            EXPECT_EQ(found[i].differs, scale(i) < 0.5 || scale(i) > 2)
                << i << ": " << found[i].scale << " ± " << found[i].sigma;
            EXPECT_NEAR(found[i].scale, scale(i), 0.15 * std::max(scale(i), 1.0)) << i;
        }
        EXPECT_THAT(
            warning_of(found, names, "here"),
            AllOf(HasSubstr("6 of 20 photographs"), HasSubstr("img_003.jpg (grey)"),
                  HasSubstr("img_006.jpg (× 2."), HasSubstr("img_012.jpg (× 0."), Not(HasSubstr("img_007"))));
    }
}

TEST(ColourSaturation, OfPicturesWithoutColourIsNotKnown) {
    EXPECT_TRUE(colour_saturations(photographed([](std::size_t) { return 0.0; })).empty());
    EXPECT_TRUE(colour_saturations({}).empty());
    EXPECT_EQ(warning_of(std::vector<ColourSaturation>{}, {}, "here"), "");
}

}  // namespace
}  // namespace tangi
