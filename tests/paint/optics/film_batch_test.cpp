// film_batch_test.cpp: many films at once against one at a time.
#include <gtest/gtest.h>

#include <array>

#include "paint/optics/kubelka_munk.h"
#include "paint/optics/palette.h"
#include "surface/base/parallel.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Pixels of paints in all amounts: none, one, all; thin as dust and thick as a finger.
struct Pixels {
    std::vector<Pigment> paints{artist_acrylics().paints.begin(), artist_acrylics().paints.begin() + 6};
    std::vector<std::vector<float>> volumes;
    std::vector<std::span<const float>> planes;
    std::vector<Rgb> dry;

    explicit Pixels(std::size_t count, std::uint64_t seed = 1) {
        Random random(seed);
        volumes.assign(paints.size(), std::vector<float>(count, 0.0f));
        for (std::size_t i = 0; i < count; ++i) {
            dry.push_back({random.real(), random.real(), random.real()});
            if (i % 7 == 0) continue;
            for (auto& plane : volumes)
                if (random.uniform() < 0.5)
                    plane[i] = static_cast<float>(std::pow(10, random.uniform(-7, 1)));
        }
        for (const auto& plane : volumes) planes.emplace_back(plane);
    }
    std::vector<float> at(std::size_t i) const {
        std::vector<float> result;
        for (const auto& plane : volumes) result.push_back(plane[i]);
        return result;
    }
    Spectrum one_by_one(std::size_t i, const Spectrum& below) const {
        const std::vector<float> here = at(i);
        float thickness_mm = 0;
        for (const float v : here) thickness_mm += v;
        return film_look(mix(paints, here), thickness_mm, below);
    }
};

TEST(FilmBatch, AgreesWithOneFilmAtATime) {
    for (const std::size_t count : {std::size_t(1), std::size_t(31), std::size_t(32), std::size_t(1000)}) {
        const Pixels pixels(count, count);
        for (const Illuminant light : {Illuminant::d65, Illuminant::a}) {
            std::vector<Rgb> colour(count);
            FilmBatch(pixels.paints, light).look(pixels.planes, pixels.dry, colour);
            for (std::size_t i = 0; i < count; ++i) {
                const Rgb expected =
                    to_linear_rgb(pixels.one_by_one(i, reflectance_of_rgb(pixels.dry[i])), light);
                for (int c = 0; c < 3; ++c) ASSERT_NEAR(colour[i][c], expected[c], 5e-6) << i;
            }
        }
    }
}

TEST(FilmBatch, FilmsOnEachOtherAgreeWithOneFilmAtATime) {
    const Pixels below(257), above(257, 7);
    const FilmBatch one(below.paints), other(above.paints, Illuminant::a);
    const std::array<FilmBatch::Film, 2> films = {{{&one, below.planes}, {&other, above.planes}}};
    std::vector<Rgb> colour(257);
    FilmBatch::look_through(films, below.dry, colour);
    for (std::size_t i = 0; i < 257; ++i) {
        const Spectrum first = below.one_by_one(i, reflectance_of_rgb(below.dry[i]));
        const Rgb expected = to_linear_rgb(above.one_by_one(i, first), Illuminant::a);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(colour[i][c], expected[c], 5e-6) << i;
    }
    EXPECT_THROW(FilmBatch::look_through({}, below.dry, colour), ContractError);
}

TEST(FilmBatch, WithoutPaintGivesTheDryLayerEvenOutsideOfTheGamut) {
    Pixels pixels(64);
    for (auto& plane : pixels.volumes) std::fill(plane.begin(), plane.end(), 0.0f);
    pixels.dry[3] = {1.4f, 1.2f, 0.9f};    // brighter than a perfect white, as fits can be
    pixels.dry[4] = {-0.03f, 0.4f, 0.5f};  // outside of the triangle
    std::vector<Rgb> colour = pixels.dry;
    FilmBatch(pixels.paints).look(pixels.planes, colour, colour);  // in place
    for (std::size_t i = 0; i < colour.size(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(colour[i][c], pixels.dry[i][c], 1e-5) << i;
    // Paint covers that too, gradually.
    std::fill(pixels.volumes[1].begin(), pixels.volumes[1].end(), 1.0f);  // black: what hides best
    FilmBatch(pixels.paints).look(pixels.planes, pixels.dry, colour);
    EXPECT_NEAR(colour[3].r, colour[5].r, 1e-3);
}

TEST(FilmBatch, GivesTheSameBitsWhereverAPixelLies) {
    // Tiles are shown whole, in part, on many threads: a pixel's colour is the same in all of them.
    const Pixels pixels(500);
    const FilmBatch films(pixels.paints);
    std::vector<Rgb> whole(500), parts(500);
    films.look(pixels.planes, pixels.dry, whole);
    parallel_for(0, 500, 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto at = static_cast<std::size_t>(i);
            std::vector<std::span<const float>> planes;
            for (const auto& plane : pixels.planes) planes.push_back(plane.subspan(at, 1));
            films.look(planes, {&pixels.dry[at], 1}, {&parts[at], 1});
        }
    });
    EXPECT_EQ(std::memcmp(whole.data(), parts.data(), whole.size() * sizeof(Rgb)), 0);
}

TEST(FilmBatch, StaysFiniteForAbsurdVolumes) {
    Pixels pixels(5);
    const float absurd[] = {1e-38f, 1e-20f, 1e6f, 1e30f, -1e-9f};
    for (auto& plane : pixels.volumes) std::copy(std::begin(absurd), std::end(absurd), plane.begin());
    std::vector<Rgb> colour(5);
    FilmBatch(pixels.paints).look(pixels.planes, pixels.dry, colour);
    for (const Rgb& rgb : colour)
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(rgb[c] > -0.2f && rgb[c] < 1.2f) << rgb[c];
}

TEST(FilmBatch, RefusesSizesThatDiffer) {
    Pixels pixels(8);
    const FilmBatch films(pixels.paints);
    std::vector<Rgb> colour(8), few(7);
    EXPECT_EQ(films.pigments(), 6u);
    EXPECT_THROW(films.look(pixels.planes, pixels.dry, few), ContractError);
    EXPECT_THROW(films.look(pixels.planes, few, few), ContractError);
    EXPECT_THROW(films.look({pixels.planes.data(), 5}, pixels.dry, colour), ContractError);
    EXPECT_THROW(FilmBatch(pixels.paints, Illuminant::d65, 1.0f), ContractError);
}

}  // namespace
}  // namespace tangi
