// paint_bench.cpp: what wet paint costs to look at: films over a dry layer, per pixel.
#include <benchmark/benchmark.h>

#include <array>
#include <random>
#include <vector>

#include "paint/optics/kubelka_munk.h"
#include "paint/optics/palette.h"

namespace {

using namespace tangi;

constexpr std::size_t kTile = 64 * 64;

// A tile of wet paint of `pigments` kinds, all of them in every pixel, films of 0 to 0.1 mm.
struct Tile {
    std::vector<Pigment> paints;
    std::vector<std::vector<float>> volumes;
    std::vector<std::span<const float>> planes;
    std::vector<Rgb> dry = std::vector<Rgb>(kTile), colour = std::vector<Rgb>(kTile);
    std::vector<Spectrum> dry_spectra = std::vector<Spectrum>(kTile), spectra = std::vector<Spectrum>(kTile);

    explicit Tile(int pigments) {
        std::mt19937 random(1);
        const auto uniform = [&](float most) { return most * static_cast<float>(random()) / 4294967296.0f; };
        for (int p = 0; p < pigments; ++p) {
            paints.push_back(artist_acrylics().paints[static_cast<std::size_t>(p)]);
            volumes.emplace_back(kTile);
            for (float& volume : volumes.back()) volume = uniform(0.1f / static_cast<float>(pigments));
        }
        for (const auto& plane : volumes) planes.emplace_back(plane);
        for (std::size_t i = 0; i < kTile; ++i) {
            dry[i] = Rgb(uniform(1), uniform(1), uniform(1));
            dry_spectra[i] = reflectance_of_rgb(dry[i]);
        }
    }
};

void rate(benchmark::State& state) {
    state.counters["pixels/s"] = benchmark::Counter(
        static_cast<double>(state.iterations()) * static_cast<double>(kTile), benchmark::Counter::kIsRate);
}

void BM_FilmsOverColours(benchmark::State& state) {
    Tile tile(static_cast<int>(state.range(0)));
    const FilmBatch films(tile.paints);
    for (auto _ : state) {
        films.look(tile.planes, tile.dry, tile.colour);
        benchmark::DoNotOptimize(tile.colour.data());
    }
    rate(state);
}
BENCHMARK(BM_FilmsOverColours)->Arg(1)->Arg(4)->Arg(8)->Arg(19);

// Two films of the same paints on each other.
void BM_FilmsOnEachOther(benchmark::State& state) {
    Tile tile(static_cast<int>(state.range(0)));
    const FilmBatch paints(tile.paints);
    const std::array<FilmBatch::Film, 2> films = {{{&paints, tile.planes}, {&paints, tile.planes}}};
    for (auto _ : state) {
        FilmBatch::look_through(films, tile.dry, tile.colour);
        benchmark::DoNotOptimize(tile.colour.data());
    }
    rate(state);
}
BENCHMARK(BM_FilmsOnEachOther)->Arg(4);

// The same, pixel by pixel, as the reference for tests computes it.
void BM_FilmsOneByOne(benchmark::State& state) {
    Tile tile(static_cast<int>(state.range(0)));
    for (auto _ : state) {
        for (std::size_t i = 0; i < kTile; ++i) {
            std::vector<float> volumes;
            float thickness_mm = 0;
            for (const auto& plane : tile.planes) volumes.push_back(plane[i]), thickness_mm += plane[i];
            tile.colour[i] = to_linear_rgb(
                film_look(mix(tile.paints, volumes), thickness_mm, reflectance_of_rgb(tile.dry[i])));
        }
        benchmark::DoNotOptimize(tile.colour.data());
    }
    rate(state);
}
BENCHMARK(BM_FilmsOneByOne)->Arg(4);

void BM_ReflectanceOfRgb(benchmark::State& state) {
    Tile tile(1);
    for (auto _ : state) {
        for (std::size_t i = 0; i < kTile; ++i) tile.spectra[i] = reflectance_of_rgb(tile.dry[i]);
        benchmark::DoNotOptimize(tile.spectra.data());
    }
    rate(state);
}
BENCHMARK(BM_ReflectanceOfRgb);

void BM_ToLinearRgb(benchmark::State& state) {
    Tile tile(1);
    for (auto _ : state) {
        for (std::size_t i = 0; i < kTile; ++i) tile.colour[i] = to_linear_rgb(tile.dry_spectra[i]);
        benchmark::DoNotOptimize(tile.colour.data());
    }
    rate(state);
}
BENCHMARK(BM_ToLinearRgb);

}  // namespace

BENCHMARK_MAIN();
