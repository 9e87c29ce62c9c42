#include "paint/substrate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

#include "surface/error.h"
#include "surface/noise.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

using procedural::hash;
using procedural::mix;
using procedural::Seed;
using procedural::smooth_step;
using procedural::uniform;

constexpr std::array<std::pair<SubstrateKind, std::string_view>, 6> kNames = {
    {{SubstrateKind::canvas, "canvas"},
     {SubstrateKind::linen, "linen"},
     {SubstrateKind::burlap, "burlap"},
     {SubstrateKind::panel, "panel"},
     {SubstrateKind::gesso, "gesso"},
     {SubstrateKind::paper, "paper"}}};

int wrapped(int i, int count) { return ((i % count) + count) % count; }

// Noise that repeats: values in [-1, 1] at the corners of `columns` x `rows` cells, smooth between (quintic).
// x in [0, columns), y in [0, rows).
float tiled_noise(float x, float y, int columns, int rows, Seed seed) {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    const auto fade = [](float t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const float fx = fade(x - static_cast<float>(ix)), fy = fade(y - static_cast<float>(iy));
    const auto value = [&](int cx, int cy) {
        return uniform(hash(seed, wrapped(cx, columns), wrapped(cy, rows)), -1, 1);
    };
    return mix(mix(value(ix, iy), value(ix + 1, iy), fx), mix(value(ix, iy + 1), value(ix + 1, iy + 1), fx),
               fy);
}

// What a pixel of a substrate is; height before its mean is taken off.
struct Spot {
    float height_mm = 0;
    Rgb colour{0};
    float specular = 0.01f, roughness = 0.4f;
};

// The size of the piece, as procedures need it: noise of features of a given size that repeats with the
// piece.
struct Piece {
    float width_mm, height_mm;
    Seed seed;

    // Features of `sx` x `sy` mm; the sizes are adapted so that a whole number fits.
    float noise(float x_mm, float y_mm, float sx, float sy, Seed which) const {
        const int columns = std::max(1, static_cast<int>(std::lround(width_mm / sx)));
        const int rows = std::max(1, static_cast<int>(std::lround(height_mm / sy)));
        return tiled_noise(x_mm / width_mm * static_cast<float>(columns),
                           y_mm / height_mm * static_cast<float>(rows), columns, rows, hash(seed, which));
    }
    float fractal(float x_mm, float y_mm, float size, int octaves, Seed which) const {
        float sum = 0, strength = 1;
        for (int i = 0; i < octaves; ++i, strength *= 0.5f, size *= 0.5f)
            sum += strength * noise(x_mm, y_mm, size, size, hash(which, static_cast<std::uint64_t>(i)));
        return sum;
    }
};

struct Weave {
    float pitch_mm;   // between threads
    float thread;     // [1] width of a thread over the pitch
    float relief_mm;  // of a thread's crossings
    float irregular;  // [1] how much threads differ and wander
    Rgb thread_colour, hole_colour;
    float ground_mm;  // priming that fills the valleys; 0 = none
    Rgb ground_colour;
};

// Plain weave: each thread goes over and under the ones across in turn. The height of one set of threads,
// `across` and `along` them in mm.
struct Thread {
    float height;  // [1] -1.. about 1.6, in units of the relief
    float inside;  // [1] 1 in the middle, 0 at the thread's rim and beyond
    int number;
};

Thread thread_at(const Weave& w, const Piece& piece, float across, float along, float across_size,
                 float along_size, bool warp) {
    // An even number of threads each way, so that over and under match where the piece repeats.
    const int threads = std::max(2, 2 * static_cast<int>(std::lround(across_size / w.pitch_mm / 2)));
    const int crossings = std::max(2, 2 * static_cast<int>(std::lround(along_size / w.pitch_mm / 2)));
    const Seed which = warp ? 11 : 12;
    const auto slow = [&](int thread, float features, Seed salt) {  // varies along each thread by itself
        const int cells =
            std::max(1, static_cast<int>(std::lround(static_cast<float>(crossings) / features)));
        const float at = along / along_size * static_cast<float>(cells);
        return tiled_noise(static_cast<float>(thread), at, threads, cells,
                           hash(hash(piece.seed, which), salt));
    };
    const float position = across / across_size * static_cast<float>(threads);
    Thread best{-2, 0, 0};
    const int near = static_cast<int>(std::lround(position - 0.5f));
    for (int k = near - 1; k <= near + 1; ++k) {
        const int number = wrapped(k, threads);
        const float wander = w.irregular * (0.22f * slow(number, 6, 1) + 0.1f * slow(number, 2, 2));
        const float slub = std::max(slow(number, 14, 3), 0.0f);
        const float width =
            w.thread * (1 + w.irregular * (0.25f * slow(number, 5, 4) + 0.7f * slub * slub * slub));
        const float d = (position - (static_cast<float>(k) + 0.5f + wander)) / (0.5f * width);
        if (std::abs(d) >= 1) continue;
        const float phase = along / along_size * static_cast<float>(crossings) + static_cast<float>(number) +
                            (warp ? 0.0f : 1.0f);
        const float over = std::cos(std::numbers::pi_v<float> * (phase - 0.5f));
        const float height = 0.75f * over + 0.8f * (1 - d * d) - 0.4f + 0.25f * (width / w.thread - 1);
        if (height > best.height) best = {height, 1 - d * d, number};
    }
    return best;
}

Spot weave_at(const Weave& w, const Piece& piece, float x, float y) {
    const Thread warp = thread_at(w, piece, x, y, piece.width_mm, piece.height_mm, true);
    const Thread weft = thread_at(w, piece, y, x, piece.height_mm, piece.width_mm, false);
    const bool on_warp = warp.height > weft.height;
    const Thread& top = on_warp ? warp : weft;
    Spot spot;
    const bool hole = top.height < -1;
    // Fibres run along their thread.
    const float f = w.pitch_mm * 0.16f;
    const float fibres = on_warp ? piece.noise(x, y, f, 5 * f, 21) : piece.noise(x, y, 5 * f, f, 22);
    float z = hole ? -0.6f : top.height + 0.10f * fibres;
    const float tone = 1 + 0.10f * fibres +
                       0.12f * w.irregular * uniform(hash(piece.seed, top.number, on_warp), -1, 1) +
                       0.05f * piece.fractal(x, y, 20, 2, 23);
    const float depth = smooth_step(-1.0f, 0.5f, z);  // light that is lost between the threads
    spot.colour = (hole ? w.hole_colour : w.thread_colour * tone) * (0.55f + 0.45f * depth);
    spot.height_mm = z * w.relief_mm;
    if (w.ground_mm > 0) {
        // Priming: levels the valleys, follows the crests (a soft maximum of level and weave).
        const float level = (-0.35f + 0.15f * piece.fractal(x, y, 4, 3, 24)) * w.relief_mm;
        const float soft = 0.35f * w.relief_mm, d = (spot.height_mm - level) / soft;
        spot.height_mm = level + soft * (d > 8 ? d : std::log1p(std::exp(d))) + w.ground_mm;
        spot.colour = w.ground_colour * (1 + 0.015f * piece.fractal(x, y, 3, 3, 25));
        spot.specular = 0.012f;
        spot.roughness = 0.35f;
    }
    return spot;
}

Spot panel_at(const Piece& piece, float x, float y) {
    // Growth rings cut lengthwise: bands along x that wander slowly, and pores.
    const float bend = 6 * piece.noise(x, y, 90, 30, 31) + 1.2f * piece.noise(x, y, 30, 8, 32);
    const int bands = std::max(1, static_cast<int>(std::lround(piece.height_mm / 3.2f)));
    const float ring =
        0.5f + 0.5f * std::sin(2 * std::numbers::pi_v<float> *
                               ((y / piece.height_mm) * static_cast<float>(bands) + bend / 3.2f));
    const float pores = std::max(piece.noise(x, y, 4, 0.25f, 33), 0.0f),
                fine = piece.noise(x, y, 6, 0.5f, 34);
    Spot spot;
    spot.height_mm = 0.012f * ring - 0.03f * pores * pores + 0.006f * fine;
    spot.colour = glm::mix(Rgb(0.42f, 0.25f, 0.12f), Rgb(0.24f, 0.125f, 0.055f), ring * ring) *
                  (1 + 0.12f * fine - 0.25f * pores * pores);
    spot.specular = 0.025f;
    spot.roughness = 0.22f;
    return spot;
}

Spot gesso_at(const Piece& piece, float x, float y) {
    // Two coats, crosswise; the upper one shows most.
    const float warp = 2.5f * piece.noise(x, y, 25, 25, 41);
    const float lower = piece.noise(x + warp, y, 0.9f, 26, 42),
                upper = piece.noise(x, y + warp, 34, 0.8f, 43);
    const float tooth = piece.fractal(x, y, 0.7f, 2, 44);
    Spot spot;
    spot.height_mm = 0.012f * lower + 0.026f * upper + 0.010f * tooth;
    spot.colour = Rgb(0.86f, 0.85f, 0.82f) * (1 + 0.012f * piece.fractal(x, y, 12, 3, 45));
    spot.specular = 0.006f;
    spot.roughness = 0.45f;
    return spot;
}

Spot paper_at(const Piece& piece, float x, float y) {
    const float felt = piece.fractal(x, y, 1.4f, 4, 51);
    const float bent = 0.8f * piece.noise(x, y, 3, 3, 52);
    const float fibre = std::max(piece.noise(x + bent, y - bent, 1.8f, 0.12f, 53), 0.0f) +
                        std::max(piece.noise(x - bent, y - bent, 0.12f, 1.8f, 54), 0.0f);
    Spot spot;
    spot.height_mm = 0.022f * felt + 0.012f * fibre;
    spot.colour = Rgb(0.82f, 0.80f, 0.73f) * (1 + 0.03f * felt - 0.02f * fibre);
    spot.specular = 0.002f;
    spot.roughness = 0.55f;
    return spot;
}

Spot spot_at(SubstrateKind kind, const Piece& piece, float x, float y) {
    static const Weave duck{0.62f,
                            0.96f,
                            0.075f,
                            0.35f,
                            Rgb(0.72f, 0.68f, 0.58f),
                            Rgb(0.3f, 0.27f, 0.22f),
                            0.03f,
                            Rgb(0.84f, 0.83f, 0.79f)};
    static const Weave linen{0.68f, 1.02f, 0.075f, 1.0f, Rgb(0.37f, 0.29f, 0.195f), Rgb(0.10f, 0.075f, 0.05f),
                             0,     Rgb(0)};
    static const Weave burlap{
        1.9f, 0.72f, 0.24f, 1.2f, Rgb(0.36f, 0.245f, 0.13f), Rgb(0.035f, 0.025f, 0.015f), 0, Rgb(0)};
    switch (kind) {
        case SubstrateKind::canvas:
            return weave_at(duck, piece, x, y);
        case SubstrateKind::linen:
            return weave_at(linen, piece, x, y);
        case SubstrateKind::burlap:
            return weave_at(burlap, piece, x, y);
        case SubstrateKind::panel:
            return panel_at(piece, x, y);
        case SubstrateKind::gesso:
            return gesso_at(piece, x, y);
        case SubstrateKind::paper:
            break;
    }
    return paper_at(piece, x, y);
}

// Normals that look around the border, since the piece repeats.
void find_normals(Surface& s) {
    const int width = s.width(), height = s.height();
    const auto mm = static_cast<float>(2 * s.mm_per_pixel);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            s.normal(x, y) = normal_of(
                {(s.height_mm(wrapped(x + 1, width), y) - s.height_mm(wrapped(x - 1, width), y)) / mm,
                 (s.height_mm(x, wrapped(y - 1, height)) - s.height_mm(x, wrapped(y + 1, height))) / mm});
}

}  // namespace

std::string_view name_of(SubstrateKind kind) {
    for (const auto& [which, name] : kNames)
        if (which == kind) return name;
    return "paper";
}

std::optional<SubstrateKind> substrate_named(std::string_view name) {
    for (const auto& [kind, known] : kNames)
        if (known == name) return kind;
    return {};
}

std::vector<std::string> substrate_names() {
    std::vector<std::string> names;
    for (const auto& [kind, name] : kNames) names.emplace_back(name);
    return names;
}

Surface make_substrate(SubstrateKind kind, const SubstrateOptions& options, const Progress& progress) {
    validate(options);
    const double columns = std::round(options.width_mm / options.pixel_mm),
                 rows = std::round(options.height_mm / options.pixel_mm);
    if (!(columns >= 8 && rows >= 8 && columns <= 65536 && rows <= 65536))
        fail(
            "a substrate of {} x {} mm with pixels of {} mm has {} x {} pixels; 8 to 65536 a side can be "
            "made",
            options.width_mm, options.height_mm, options.pixel_mm, columns, rows);
    Surface s(static_cast<int>(columns), static_cast<int>(rows));
    s.mm_per_pixel = static_cast<float>(options.pixel_mm);  // as files keep it
    s.scale_known = true;
    const auto mm = static_cast<float>(options.pixel_mm);
    const Piece piece{static_cast<float>(s.width()) * mm, static_cast<float>(s.height()) * mm, options.seed};
    std::mutex reporting;
    int done = 0;
    std::vector<double> sums(static_cast<std::size_t>(s.height()), 0.0);
    parallel_for(0, s.height(), 8, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < s.width(); ++x) {
                const Spot spot = spot_at(kind, piece, (static_cast<float>(x) + 0.5f) * mm,
                                          (static_cast<float>(y) + 0.5f) * mm);
                s.height_mm(x, y) = spot.height_mm;
                s.diffuse(x, y) = glm::clamp(spot.colour, Rgb(0), Rgb(1));
                s.specular(x, y) = spot.specular;
                s.roughness(x, y) = spot.roughness;
                s.confidence(x, y) = 1;
                sums[static_cast<std::size_t>(y)] += spot.height_mm;
            }
        const std::lock_guard lock(reporting);
        done += end - begin;
        report(progress, "make substrate", done / static_cast<double>(s.height()));
    });
    double mean = 0;
    for (const double sum : sums) mean += sum;
    mean /= columns * rows;
    for (float& z : s.height_mm.pixels()) z -= static_cast<float>(mean);
    find_normals(s);
    s.provenance = nlohmann::json{{"substrate", name_of(kind)}, {"options", to_json(options)}}.dump();
    return s;
}

}  // namespace tangi
