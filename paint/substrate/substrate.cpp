#include "paint/substrate/substrate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

#include "paint/substrate/tiled_noise.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/noise.h"
#include "surface/base/parallel.h"
#include "surface/math/portable_math.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace {

using procedural::hash;
using procedural::mix;
using procedural::Seed;
using procedural::smooth_step;
using procedural::tiled_noise;
using procedural::tiled_noise_along;
using procedural::tiled_slopes;
using procedural::uniform;
using procedural::wrapped;

constexpr std::array<std::pair<SubstrateKind, std::string_view>, 6> kNames = {
    {{SubstrateKind::canvas, "canvas"},
     {SubstrateKind::linen, "linen"},
     {SubstrateKind::burlap, "burlap"},
     {SubstrateKind::panel, "panel"},
     {SubstrateKind::gesso, "gesso"},
     {SubstrateKind::paper, "paper"}}};

// The larger of both, rounded where they are within `soft` of each other.
float soft_max(float a, float b, float soft) {
    const float near = std::max(soft - std::abs(a - b), 0.0f);
    return std::max(a, b) + near * near / (4 * soft);
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
    // Without preferred directions, or anisotropic along x.
    float felt(float x_mm, float y_mm, float size, Seed which, float anisotropic = 1) const {
        const int columns = std::max(1, static_cast<int>(std::lround(width_mm / (size * anisotropic))));
        const int rows = std::max(1, static_cast<int>(std::lround(height_mm / size)));
        return tiled_slopes(x_mm / width_mm * static_cast<float>(columns),
                            y_mm / height_mm * static_cast<float>(rows), columns, rows, hash(seed, which));
    }
    float fractal_felt(float x_mm, float y_mm, float size, int octaves, Seed which) const {
        float sum = 0, strength = 1;
        for (int i = 0; i < octaves; ++i, strength *= 0.5f, size *= 0.5f)
            sum += strength * felt(x_mm, y_mm, size, hash(which, static_cast<std::uint64_t>(i)));
        return sum;
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
    float hollow;     // [relief] what is seen between threads: fluff, glue, the cloth's back
    Rgb thread_colour, hole_colour;
    float ground_mm;  // priming that fills the valleys; 0 = none
    Rgb ground_colour;
};

constexpr float kRound = 0.25f;  // [relief] within which threads that touch run into each other

// Plain weave: each thread goes over and under the ones across in turn. The height of one set of threads,
// `across` and `along` them in mm. It is continuous, also where threads end and hollows begin: a step would
// be a spike of one pixel, black in raking light.
struct Thread {
    float height;  // [1] from the hollows up to about 1.6, in units of the relief
    float fibre;   // [1] -1..1: hairs, twisted round the thread
    int number;
};

// A place in a piece, as one set of threads has it [mm].
struct ThreadPlace {
    float across, along;            // these threads
    float across_size, along_size;  // of the piece
    bool warp;
};

Thread thread_at(const Weave& w, const Piece& piece, const ThreadPlace& place) {
    const float along = place.along, along_size = place.along_size;
    // An even number of threads each way, so that over and under match where the piece repeats.
    const int threads = std::max(2, 2 * static_cast<int>(std::lround(place.across_size / w.pitch_mm / 2)));
    const int crossings = std::max(2, 2 * static_cast<int>(std::lround(along_size / w.pitch_mm / 2)));
    const Seed which = place.warp ? 11 : 12;
    const auto slow = [&](int thread, float features, Seed salt) {  // varies along each thread by itself
        const int cells =
            std::max(1, static_cast<int>(std::lround(static_cast<float>(crossings) / features)));
        const float at = along / along_size * static_cast<float>(cells);
        return tiled_noise_along(thread, at, threads, cells, hash(hash(piece.seed, which), salt));
    };
    const float position = place.across / place.across_size * static_cast<float>(threads);
    Thread best{w.hollow, 0, 0};
    float side = 0, highest = -10;
    const int near = static_cast<int>(std::lround(position - 0.5f));
    for (int k = near - 1; k <= near + 1; ++k) {
        const int number = wrapped(k, threads);
        const float wander = w.irregular * (0.22f * slow(number, 6, 1) + 0.1f * slow(number, 2, 2));
        const float slub = std::max(slow(number, 14, 3), 0.0f);
        const float width =
            w.thread * (1 + w.irregular * (0.25f * slow(number, 5, 4) + 0.7f * slub * slub * slub));
        const float d = (position - (static_cast<float>(k) + 0.5f + wander)) / (0.5f * width);
        if (std::abs(d) >= 1.6f) continue;
        const float phase = along / along_size * static_cast<float>(crossings) + static_cast<float>(number) +
                            (place.warp ? 0.0f : 1.0f);
        const float over = portable::cos(std::numbers::pi_v<float> * (phase - 0.5f));
        const float height = 0.62f * over + 0.9f * (1 - d * d) - 0.4f + 0.3f * (width / w.thread - 1);
        best.height = soft_max(best.height, height, kRound);
        if (height > highest) highest = height, best.number = number, side = d;
    }
    // Fibres are wound round the thread: two hairs across, one and a half crossings long.
    const int cells = std::max(1, crossings * 2 / 3);
    best.fibre =
        tiled_noise(2.5f * side + 8, along / along_size * static_cast<float>(cells) + 0.8f * side, 64, cells,
                    hash(hash(piece.seed, which + 4), static_cast<std::uint64_t>(best.number)));
    return best;
}

Spot weave_at(const Weave& w, const Piece& piece, float x, float y) {
    // The loom's tension varies: threads lie closer here than there.
    const float pull = 0.4f * w.irregular * w.pitch_mm;
    const float px = x + pull * piece.felt(x, y, 16 * w.pitch_mm, 26),
                py = y + pull * piece.felt(x, y, 16 * w.pitch_mm, 27);
    const Thread warp = thread_at(w, piece, {px, py, piece.width_mm, piece.height_mm, true});
    const Thread weft = thread_at(w, piece, {py, px, piece.height_mm, piece.width_mm, false});
    const bool on_warp = warp.height > weft.height;
    const Thread& top = on_warp ? warp : weft;
    Spot spot;
    const float z = soft_max(warp.height, weft.height, kRound) + 0.16f * top.fibre;
    const float tone = 1 + 0.16f * top.fibre +
                       0.12f * w.irregular * uniform(hash(piece.seed, top.number, on_warp), -1, 1) +
                       0.05f * piece.fractal(x, y, 20, 2, 23);
    const float depth = smooth_step(w.hollow, 0.4f, z);  // light that is lost between the threads
    spot.colour = glm::mix(w.hole_colour, w.thread_colour * tone * (0.6f + 0.4f * depth),
                           smooth_step(w.hollow - 0.1f, w.hollow + 0.3f, z));
    spot.height_mm = z * w.relief_mm;
    if (w.ground_mm > 0) {
        // Priming: levels the valleys, follows the crests (a soft maximum of level and weave).
        const float level = (0.05f + 0.25f * piece.fractal_felt(x, y, 4, 3, 24)) * w.relief_mm;
        const float soft = 0.45f * w.relief_mm, d = (spot.height_mm - level) / soft;
        spot.height_mm = level + soft * (d > 8 ? d : portable::log1p(portable::exp(d))) + w.ground_mm;
        spot.colour = w.ground_colour * (1 + 0.015f * piece.fractal_felt(x, y, 3, 3, 25));
        spot.specular = 0.012f;
        spot.roughness = 0.35f;
    }
    return spot;
}

// A tangential board, planed: growth rings run along x, wide and narrow by the years, pale early wood that
// ends in a dark line; vessels as fine dashes, most of them in the early wood; the plane's shallow waves.
Spot panel_at(const Piece& piece, float x, float y) {
    const float bend = 9 * piece.felt(x, y, 38, 31, 2) + 2.2f * piece.noise(x, y, 60, 7, 32) +
                       0.35f * piece.noise(x, y, 14, 2.5f, 36);
    const int bands = std::max(1, static_cast<int>(std::lround(piece.height_mm / 4.5f)));
    const float years = (y / piece.height_mm) * static_cast<float>(bands) + bend / 4.5f;
    const float season = years - std::floor(years);  // 0 spring .. 1 winter
    const float late = smooth_step(0.45f, 0.93f, season) * (1 - smooth_step(0.95f, 1.0f, season));
    const float dash = piece.noise(x, y, 2.6f, 0.13f, 33) - 0.74f + 0.22f * (1 - late);
    const float vessel = smooth_step(0.0f, 0.25f, dash);
    const float fibre = piece.noise(x, y, 9, 0.22f, 34), streak = piece.noise(x, y, 70, 1.6f, 35);
    const float waves = portable::sin(2 * std::numbers::pi_v<float> *
                                      std::max(1.0f, std::round(piece.width_mm / 2.4f)) * x / piece.width_mm);
    Spot spot;
    spot.height_mm =
        0.016f * late - 0.030f * vessel + 0.004f * fibre + 0.0015f * waves + 0.03f * piece.felt(x, y, 55, 37);
    spot.colour = glm::mix(Rgb(0.45f, 0.285f, 0.145f), Rgb(0.25f, 0.135f, 0.06f), 0.75f * late) *
                  (1 + 0.10f * fibre + 0.09f * streak + 0.08f * piece.felt(x, y, 45, 38)) *
                  (1 - 0.45f * vessel);
    spot.specular = 0.025f * (1 - 0.6f * vessel);
    spot.roughness = 0.22f;
    return spot;
}

// Small pits where air was: [1] 0..1 of the deepest.
float pinholes_at(const Piece& piece, float x, float y, float pitch_mm, Seed which) {
    const int columns = std::max(1, static_cast<int>(std::lround(piece.width_mm / pitch_mm)));
    const int rows = std::max(1, static_cast<int>(std::lround(piece.height_mm / pitch_mm)));
    const float cell_x = piece.width_mm / static_cast<float>(columns),
                cell_y = piece.height_mm / static_cast<float>(rows);
    const int i = static_cast<int>(std::floor(x / cell_x)), j = static_cast<int>(std::floor(y / cell_y));
    const Seed h = hash(hash(piece.seed, which), wrapped(i, columns), wrapped(j, rows));
    if (uniform(hash(h, 1)) > 0.4f) return 0;
    const float radius = uniform(hash(h, 2), 0.07f, 0.22f);
    const float dx = x - (static_cast<float>(i) + uniform(hash(h, 3), 0.2f, 0.8f)) * cell_x,
                dy = y - (static_cast<float>(j) + uniform(hash(h, 4), 0.2f, 0.8f)) * cell_y;
    const float out = (dx * dx + dy * dy) / (radius * radius);
    return radius / 0.22f * portable::exp(-2 * out);
}

// Chalk and glue, laid on with a broad brush, coat across coat, and sanded: of the marks of bristles the
// valleys are left, the crests are level; bubbles left pinholes.
Spot gesso_at(const Piece& piece, float x, float y) {
    const float sway = 3 * piece.felt(x, y, 60, 41) + 0.5f * piece.felt(x, y, 16, 40);
    const float upper =
        0.65f * piece.noise(x, y + sway, 55, 1.3f, 43) + 0.45f * piece.noise(x, y + sway, 30, 0.45f, 46);
    const float lower = piece.noise(x + sway, y, 1.6f, 48, 42);
    const float body = 0.016f * upper + 0.004f * lower + 0.012f * piece.felt(x, y, 24, 47);
    const float sanded = 0.004f;  // [mm] where the paper's plane cuts
    Spot spot;
    spot.height_mm = -soft_max(-body, -sanded, 0.006f) + 0.0018f * piece.fractal_felt(x, y, 0.6f, 2, 44) -
                     0.03f * pinholes_at(piece, x, y, 3.5f, 48);
    spot.colour = Rgb(0.86f, 0.85f, 0.82f) * (1 + 0.012f * piece.fractal_felt(x, y, 14, 3, 45));
    spot.specular = 0.006f;
    spot.roughness = 0.45f;
    return spot;
}

// A sheet of rags, sized, not pressed hot: the felt's print, flocks of fibres, single fibres that lie on it,
// and the sheet's own waves, since it dried free.
Spot paper_at(const Piece& piece, float x, float y) {
    const float felt = piece.fractal_felt(x, y, 2.0f, 3, 51), tooth = piece.fractal_felt(x, y, 0.5f, 2, 52);
    const auto fibres = [&](float size, Seed which) {
        const float bent_x = x + 0.5f * piece.felt(x, y, 3, which + 10),
                    bent_y = y + 0.5f * piece.felt(x, y, 3, which + 11);
        const float line = 1 - 9 * std::abs(piece.felt(bent_x, bent_y, size, which));
        const float here = smooth_step(0.05f, 0.3f, piece.felt(x, y, 1.7f, which + 12));
        return std::max(line, 0.0f) * here;
    };
    const float fibre = fibres(1.6f, 53) + fibres(1.1f, 54);
    Spot spot;
    spot.height_mm = 0.018f * felt + 0.008f * tooth + 0.007f * fibre + 0.05f * piece.felt(x, y, 70, 57);
    spot.colour = Rgb(0.82f, 0.80f, 0.73f) *
                  (1 + 0.02f * piece.fractal_felt(x, y, 5, 3, 55) + 0.012f * tooth - 0.02f * fibre);
    spot.specular = 0.002f;
    spot.roughness = 0.55f;
    return spot;
}

Spot spot_at(SubstrateKind kind, const Piece& piece, float x, float y) {
    static const Weave duck{0.62f,
                            0.96f,
                            0.075f,
                            0.35f,
                            -0.7f,
                            Rgb(0.72f, 0.68f, 0.58f),
                            Rgb(0.3f, 0.27f, 0.22f),
                            0.03f,
                            Rgb(0.84f, 0.83f, 0.79f)};
    static const Weave linen{
        0.68f, 1.0f, 0.07f, 1.0f, -0.62f, Rgb(0.37f, 0.29f, 0.195f), Rgb(0.10f, 0.075f, 0.05f), 0, Rgb(0)};
    static const Weave burlap{
        1.9f, 0.74f, 0.22f, 0.9f, -1.1f, Rgb(0.36f, 0.245f, 0.13f), Rgb(0.035f, 0.025f, 0.015f), 0, Rgb(0)};
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
    s.mm_per_pixel = kept_scale_mm(options.pixel_mm);
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
    s.provenance = json_line(nlohmann::json{{"substrate", name_of(kind)}, {"options", to_json(options)}});
    return s;
}

}  // namespace tangi
