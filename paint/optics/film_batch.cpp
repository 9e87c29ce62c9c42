// film_batch.cpp: films over a dry layer for many pixels: the inner loop of showing wet paint.
//
// Loops run over a block of pixels, band by band, without a branch, so that the compiler turns them into
// vector instructions. CMakeLists.txt gives this file the flags for it; x86 processors choose at run time
// between what every one of them has and AVX2 or AVX-512. Products and sums are not fused, so all of them
// give the same bits.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "paint/optics/exp_lanes.h"
#include "paint/optics/kubelka_munk.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr std::size_t kBlock = 32;  // pixels
using Lanes = std::array<float, kBlock>;

// One band of one pixel: film_look(), with its three divisions made two; `dry` need not lie in [0, 1].
TP_INLINE float look_of(float k, float s, float dry, float k2) {
    constexpr float kThick = 1e5f;
    const float kx = smaller(larger(k, 0.0f), kThick), sx = smaller(larger(s, 0.0f), kThick);
    const float below = smaller(larger(dry, 0.0f), 1.0f);
    const float u = __builtin_sqrtf(kx * (kx + 2 * sx));
    const float whole = kx + sx + u + 1e-12f;
    const float x = smaller(2 * u + 1e-20f, 60.0f);
    const float expm1_x = expm1_of(x);
    const float h = (1 - k2) + k2 * below;  // inside_of(below) = below / h
    const float film = larger(whole * h - sx * below, 0.0f) * expm1_x;
    const float inverse = 1 / (whole * (film + x * h));
    const float inside = (sx * film + below * x * whole) * inverse;
    const float shows = x * h * whole * inverse;  // the share of what is below
    return (1 - k2) * inside / (1 - k2 * inside) + shows * (dry - below);
}

// The part of the volumes that one block needs: pigments that occur in it, padded with nothing.
struct Block {
    std::vector<std::size_t> present;
    std::vector<Lanes> volumes;

    explicit Block(std::size_t pigments) { present.reserve(pigments), volumes.resize(pigments); }

    TP_INLINE void load(std::span<const std::span<const float>> planes, std::size_t first,
                        std::size_t count) {
        present.clear();
        for (std::size_t p = 0; p < planes.size(); ++p) {
            const float* from = planes[p].data() + first;
            Lanes& to = volumes[present.size()];
            float most = 0;
            for (std::size_t i = 0; i < count; ++i) {
                to[i] = from[i];
                most = std::max(most, from[i]);
            }
            if (!(most > 0)) continue;
            for (std::size_t i = count; i < kBlock; ++i) to[i] = 0;
            present.push_back(p);
        }
    }

    // Sums stay in registers over all pigments: the compiler does not see by itself that they can.
    template <int kLanes>
    TP_INLINE void mix(const Spectrum* k, const Spectrum* s, std::size_t band, Lanes& kx, Lanes& sx) const {
        for (std::size_t i = 0; i < kBlock; i += kLanes) {
            FloatLanes<kLanes> k_sum{}, s_sum{};
            for (std::size_t j = 0; j < present.size(); ++j) {
                FloatLanes<kLanes> volume;
                std::memcpy(&volume, volumes[j].data() + i, sizeof volume);
                k_sum += volume * k[present[j]][band];
                s_sum += volume * s[present[j]][band];
            }
            std::memcpy(kx.data() + i, &k_sum, sizeof k_sum);
            std::memcpy(sx.data() + i, &s_sum, sizeof s_sum);
        }
    }
};

// A film's paints, and how much of them there is.
struct FilmToShow {
    std::span<const std::span<const float>> volumes;
    const Spectrum *k, *s;
};

template <int kLanes>
TP_INLINE void look_rgb_in(std::span<const FilmToShow> films, std::span<const Rgb> dry, std::span<Rgb> colour,
                           const std::array<Spectrum, 3>& weights, float k2) {
    const std::array<Spectrum, 3>& basis = rgb_basis();
    std::vector<Block> blocks;
    for (const FilmToShow& film : films) blocks.emplace_back(film.volumes.size());
    Lanes below[3], sum[3], seen, kx, sx;
    for (std::size_t first = 0; first < dry.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, dry.size() - first);
        for (std::size_t f = 0; f < films.size(); ++f) blocks[f].load(films[f].volumes, first, count);
        for (std::size_t i = 0; i < kBlock; ++i) {
            const Rgb& pixel = dry[first + std::min(i, count - 1)];
            below[0][i] = pixel.r, below[1][i] = pixel.g, below[2][i] = pixel.b;
        }
        for (Lanes& lanes : sum) lanes.fill(0);
        for (std::size_t band = 0; band < kBands; ++band) {
            for (std::size_t i = 0; i < kBlock; ++i)
                seen[i] = below[0][i] * basis[0][band] + below[1][i] * basis[1][band] +
                          below[2][i] * basis[2][band];
            for (std::size_t f = 0; f < films.size(); ++f) {
                blocks[f].mix<kLanes>(films[f].k, films[f].s, band, kx, sx);
                for (std::size_t i = 0; i < kBlock; ++i) seen[i] = look_of(kx[i], sx[i], seen[i], k2);
            }
            for (std::size_t i = 0; i < kBlock; ++i) {
                sum[0][i] += weights[0][band] * seen[i];
                sum[1][i] += weights[1][band] * seen[i];
                sum[2][i] += weights[2][band] * seen[i];
            }
        }
        for (std::size_t i = 0; i < count; ++i) colour[first + i] = Rgb(sum[0][i], sum[1][i], sum[2][i]);
    }
}

TP_VECTOR_CLONES
void look_rgb(std::span<const FilmToShow> films, std::span<const Rgb> dry, std::span<Rgb> colour,
              const std::array<Spectrum, 3>& weights, float k2) {
    with_lanes([&](auto lanes) TP_INLINE_LAMBDA { look_rgb_in<lanes>(films, dry, colour, weights, k2); });
}

void require_sizes(std::span<const std::span<const float>> volumes, std::size_t pigments, std::size_t dry,
                   std::size_t out) {
    TP_REQUIRE(volumes.size() == pigments, "one plane of volumes a pigment");
    TP_REQUIRE(dry == out, "as many pixels come out as there are below");
    for (const auto& plane : volumes) TP_REQUIRE(plane.size() == dry, "volumes for every pixel");
}

}  // namespace

FilmBatch::FilmBatch(std::span<const Pigment> pigments, Illuminant illuminant, float k2)
    : weights_(rgb_weights(illuminant)), k2_(k2) {
    TP_REQUIRE(k2 >= 0 && k2 < 1, "k2 is in [0, 1)");
    for (const Pigment& pigment : pigments) {
        k_.push_back(pigment.k);
        s_.push_back(pigment.s);
    }
}

void FilmBatch::look(std::span<const std::span<const float>> volumes_mm, std::span<const Rgb> dry,
                     std::span<Rgb> colour) const {
    const Film film{this, volumes_mm};
    look_through({&film, 1}, dry, colour);
}

void FilmBatch::look_through(std::span<const Film> films, std::span<const Rgb> dry, std::span<Rgb> colour) {
    TP_REQUIRE(!films.empty(), "there is a film");
    std::vector<FilmToShow> shown;
    for (const Film& film : films) {
        require_sizes(film.volumes_mm, film.paints->k_.size(), dry.size(), colour.size());
        shown.push_back({film.volumes_mm, film.paints->k_.data(), film.paints->s_.data()});
    }
    const FilmBatch& last = *films.back().paints;
    look_rgb(shown, dry, colour, last.weights_, last.k2_);
}

}  // namespace tangi
