#include "paint/retouch/modes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "paint/kubelka_munk.h"
#include "paint/retouch/line_colours.h"
#include "paint/retouch/loss_surroundings.h"
#include "surface/error.h"

namespace tangi {

namespace {

constexpr std::array<std::string_view, 6> kNames = {"mimetic",     "tratteggio", "selection",
                                                    "abstraction", "dotting",    "neutral"};
constexpr int kBlends = 8;           // steps from one pile to another
constexpr double kFusedPitches = 6;  // over which lines and dots are to have the right mean

double square(double v) { return v * v; }
double distance2(const Lab& a, const Lab& b) {
    return square(a.l - b.l) + square(a.a - b.a) + square(a.b - b.b);
}

// Centres of groups of colours: k-means in L*a*b* (Lloyd 1982), from the colours farthest apart (Gonzalez
// 1985), so that nothing is left to chance.
std::vector<Rgb> groups_of(const std::vector<Rgb>& colours, int groups) {
    std::vector<Lab> labs;
    for (const Rgb& c : colours) labs.push_back(lab_from_linear(c));
    Rgb mean(0);
    for (const Rgb& c : colours) mean += c / static_cast<float>(colours.size());
    std::vector<Lab> centres = {lab_from_linear(mean)};
    std::vector<Rgb> result = {mean};
    for (int pass = 1; pass < groups; ++pass) {
        double farthest = 1;  // nearer than L*a*b* 1, one pile serves for both
        std::optional<std::size_t> next;
        for (std::size_t i = 0; i < labs.size(); ++i) {
            double nearest = 1e300;
            for (const Lab& c : centres) nearest = std::min(nearest, distance2(labs[i], c));
            if (nearest > farthest) farthest = nearest, next = i;
        }
        if (!next) break;
        centres.push_back(labs[*next]);
    }
    for (int pass = 0; pass < 20; ++pass) {
        std::vector<glm::dvec4> sums(centres.size(), glm::dvec4(0));
        for (std::size_t i = 0; i < labs.size(); ++i) {
            std::size_t best = 0;
            for (std::size_t c = 1; c < centres.size(); ++c)
                if (distance2(labs[i], centres[c]) < distance2(labs[i], centres[best])) best = c;
            sums[best] += glm::dvec4(glm::dvec3(colours[i]), 1);
        }
        result.clear();
        std::vector<Lab> moved;
        for (const glm::dvec4& sum : sums) {
            if (!(sum.w > 0)) continue;
            result.push_back(Rgb(glm::dvec3(sum) / sum.w));
            moved.push_back(lab_from_linear(result.back()));
        }
        centres = moved;
    }
    return result;
}

// A colour at hand: paints by volume (sum 1) and what a film of them looks like.
struct Colour {
    std::vector<std::pair<int, float>> volumes;
    std::vector<std::pair<int, float>> piles;  // and their parts
    Spectrum look{};
    Lab lab;
};

class Layer {
public:
    Layer(Canvas& canvas, const Palette& palette)
        : canvas_(canvas), palette_(palette), paint_(canvas.width(), canvas.height()) {}

    // `gloss` is what the paints are brought to; `number` tells it from others; none: they keep their own.
    void put(int x, int y, const Colour& colour, float thickness_mm, const Gloss* gloss, int number) {
        constexpr int size = PaintTile::kSize;
        PaintTile& tile = paint_.writable({x / size, y / size});
        for (const auto& [paint, volume] : colour.volumes) {
            const auto [at, added] = ids_.try_emplace({paint, number}, IngredientId(0));
            if (added) {
                PaintFinish finish;
                if (gloss) finish.specular = gloss->specular, finish.roughness = gloss->roughness;
                at->second = canvas_.add(finished(palette_.paints[static_cast<std::size_t>(paint)], finish));
            }
            tile.writable_plane(at->second)[static_cast<std::size_t>((y % size) * size + x % size)] +=
                volume * thickness_mm;
        }
    }
    PaintLayer take() { return std::move(paint_); }

private:
    Canvas& canvas_;
    const Palette& palette_;
    PaintLayer paint_;
    std::map<std::pair<int, int>, IngredientId> ids_;  // by paint and gloss
};

std::vector<Rgb> targets_inside(const Loss& loss) {
    std::vector<Rgb> colours;
    for (std::size_t i = 0; i < loss.mask.size(); ++i)
        if (loss.mask.pixels()[i] > 0) colours.push_back(loss.target.pixels()[i]);
    const std::size_t step = std::max<std::size_t>(colours.size() / 20000, 1);
    std::vector<Rgb> some;
    for (std::size_t i = 0; i < colours.size(); i += step) some.push_back(colours[i]);
    return some;
}

MatchOptions match_options(const Loss& loss, const RetouchOptions& options) {
    MatchOptions match = options.match;
    match.film = FilmOnGround{options.thickness_mm, loss.below};
    match.alternatives = 1;
    return match;
}

Pile pile_for(const Rgb& colour, const Loss& loss, const Palette& palette, const RetouchOptions& options) {
    const auto found =
        match_spectrum(palette.paints, reflectance_of_rgb(colour), match_options(loss, options)).recipes[0];
    Pile pile;
    pile.steps = found.steps;
    pile.mixture = found.mixture;
    pile.look = found.look;
    pile.target = reflectance_of_rgb(colour);
    return pile;
}

Colour colour_of(const std::vector<std::pair<int, float>>& parts, const std::vector<Pile>& piles,
                 const Palette& palette, const Loss& loss, double thickness_mm) {
    Colour colour;
    colour.piles = parts;
    std::map<int, float> volumes;
    for (const auto& [pile, part] : parts) {
        const Mixture& m = piles[static_cast<std::size_t>(pile)].mixture;
        for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i)
            volumes[m.paints[i]] += part * static_cast<float>(m.volumes[i]);
    }
    std::vector<Pigment> pigments;
    std::vector<float> amounts;
    for (const auto& [paint, volume] : volumes) {
        colour.volumes.emplace_back(paint, volume);
        pigments.push_back(palette.paints[static_cast<std::size_t>(paint)]);
        amounts.push_back(volume);
    }
    colour.look = film_look(mix(pigments, amounts), static_cast<float>(thickness_mm), loss.below);
    colour.lab = lab_under(colour.look);
    return colour;
}

// Colours of the piles, and, for mimetic retouching, of mixtures of any two.
std::vector<Colour> colours_of(const std::vector<Pile>& piles, bool blends, const Palette& palette,
                               const Loss& loss, double thickness_mm) {
    std::vector<Colour> colours;
    for (int i = 0; i < static_cast<int>(piles.size()); ++i)
        colours.push_back(colour_of({{i, 1.0f}}, piles, palette, loss, thickness_mm));
    for (int i = 0; blends && i < static_cast<int>(piles.size()); ++i)
        for (int j = i + 1; j < static_cast<int>(piles.size()); ++j)
            for (int step = 1; step < kBlends; ++step) {
                const float part = static_cast<float>(step) / kBlends;
                colours.push_back(colour_of({{i, 1 - part}, {j, part}}, piles, palette, loss, thickness_mm));
            }
    return colours;
}

// For every pixel inside, the number of the colour at hand that looks nearest; -1 elsewhere.
Image<int> nearest_colours(const Loss& loss, const std::vector<Colour>& colours) {
    Image<int> chosen(loss.mask.width(), loss.mask.height(), -1);
    for (std::size_t i = 0; i < loss.mask.size(); ++i) {
        if (!(loss.mask.pixels()[i] > 0)) continue;
        const Lab wanted = lab_from_linear(loss.target.pixels()[i]);
        int best = 0;
        for (int c = 1; c < static_cast<int>(colours.size()); ++c)
            if (distance2(colours[static_cast<std::size_t>(c)].lab, wanted) <
                distance2(colours[static_cast<std::size_t>(best)].lab, wanted))
                best = c;
        chosen.pixels()[i] = best;
    }
    return chosen;
}

// What a mark is of, in whole pixels.
MarkGeometry geometry_of(const Loss& loss, const RetouchOptions& options) {
    MarkGeometry g;
    g.pitch_px = std::round(options.pitch_mm / loss.mm_per_pixel);
    g.width_px = std::round(options.width_mm / loss.mm_per_pixel);
    g.length_px = std::max(options.length_mm / loss.mm_per_pixel, 1.0);
    g.seed = static_cast<std::uint64_t>(options.seed);
    if (g.width_px < 1 || g.pitch_px < 2)
        fail(
            "lines {} mm wide, {} mm apart, are finer than the painting's pixels of {:.3g} mm; give "
            "--width-mm {:.3g} and --pitch-mm {:.3g} at least",
            options.width_mm, options.pitch_mm, loss.mm_per_pixel, loss.mm_per_pixel, 2 * loss.mm_per_pixel);
    if (g.width_px > g.pitch_px)
        fail("lines of {} mm do not fit side by side at --pitch-mm {}", options.width_mm, options.pitch_mm);
    return g;
}

std::vector<Mark> marks_of(RetouchMode mode, const Loss& loss, const MarkGeometry& g, const Mask& hole) {
    switch (mode) {
        case RetouchMode::tratteggio:
            return vertical_marks(loss.mask, g);
        case RetouchMode::selection: {
            Image<float> lightness(hole.width(), hole.height());
            for (std::size_t i = 0; i < hole.size(); ++i)
                lightness.pixels()[i] = static_cast<float>(lab_from_linear(loss.seen.pixels()[i]).l);
            return flow_marks(loss.mask, form_direction_rad(lightness, hole, 2 * g.pitch_px), g);
        }
        case RetouchMode::abstraction:
            return crossed_marks(loss.mask, g);
        default:
            return dots(loss.mask, g);
    }
}

// The paints' own gloss counts by volume; divided by the area in the end.
void add_to(RetouchGloss& gloss, const Colour& colour, const Palette& palette, double painted_mm2) {
    gloss.area_mm2 += painted_mm2;
    for (const auto& [paint, volume] : colour.volumes) {
        const Pigment& p = palette.paints[static_cast<std::size_t>(paint)];
        gloss.of_paint.specular += painted_mm2 * static_cast<double>(volume * p.specular);
        gloss.of_paint.roughness += painted_mm2 * static_cast<double>(volume * p.roughness);
    }
}

Rgb toned_down(const Rgb& colour, const RetouchOptions& options) {
    Lab lab = lab_from_linear(colour);
    lab.l = std::clamp(lab.l + options.neutral_lightness, 0.0, 100.0);
    lab.a *= options.neutral_chroma, lab.b *= options.neutral_chroma;
    const double y = (lab.l + 16) / 116;
    const auto back = [](double f) { return f > 6.0 / 29 ? f * f * f : (116 * f - 16) * 27 / 24389; };
    const glm::dvec3 xyz =
        glm::dvec3(back(y + lab.a / 500), back(y), back(y - lab.b / 200)) * white_xyz(Illuminant::d65);
    return to_linear_rgb(smooth_spectrum(xyz, Illuminant::d65));
}

}  // namespace

std::string_view name_of(RetouchMode mode) { return kNames[static_cast<std::size_t>(mode)]; }

std::optional<RetouchMode> retouch_mode_named(std::string_view name) {
    for (std::size_t i = 0; i < kNames.size(); ++i)
        if (kNames[i] == name) return static_cast<RetouchMode>(i);
    return std::nullopt;
}

RetouchReport lay_retouch(Canvas& canvas, const Palette& palette, const Mask& mask, const Mask& damaged,
                          RetouchMode mode, const std::string& layer, const RetouchOptions& options,
                          const Progress& progress) {
    validate(options);
    validate(options.annulus);
    report(progress, "look at the surroundings", 0);
    Loss loss = loss_of(canvas, mask, damaged, options);
    const bool lines = mode != RetouchMode::mimetic && mode != RetouchMode::neutral;
    if (mode == RetouchMode::neutral || mode == RetouchMode::abstraction) {
        const std::vector<Rgb> inside = targets_inside(loss);
        Rgb mean = groups_of(inside, 1)[0];
        if (mode == RetouchMode::neutral) mean = toned_down(mean, options);
        for (Rgb& t : loss.target.pixels()) t = mean;
    }
    RetouchReport result;
    result.region = loss.region;
    Image<int> chosen;
    std::vector<Colour> colours;
    if (!lines) {
        const auto groups = groups_of(targets_inside(loss), mode == RetouchMode::neutral ? 1 : options.piles);
        for (std::size_t i = 0; i < groups.size(); ++i) {
            report(progress, "match colours", static_cast<double>(i) / static_cast<double>(groups.size()));
            result.piles.push_back(pile_for(groups[i], loss, palette, options));
        }
        colours = colours_of(result.piles, mode == RetouchMode::mimetic, palette, loss, options.thickness_mm);
        chosen = nearest_colours(loss, colours);
    } else {
        const MarkGeometry g = geometry_of(loss, options);
        result.pitch_mm = g.pitch_px * loss.mm_per_pixel, result.width_mm = g.width_px * loss.mm_per_pixel;
        Mask hole = loss.mask;
        for (float& v : hole.pixels()) v = v > 0 ? 1.0f : 0.0f;
        const std::vector<Mark> marks = marks_of(mode, loss, g, dilated(hole, 1));
        result.marks = static_cast<int>(marks.size());
        const Image<int> owner = rasterised(marks, loss.mask, g.width_px);
        const auto groups = groups_of(targets_inside(loss), std::max(options.piles / 2, 1));
        report(progress, "choose pure colours", 0);
        std::vector<Pile> gaps;
        for (std::size_t i = 0; i < groups.size() && !options.bare_gaps; ++i)
            gaps.push_back(pile_for(groups[i], loss, palette, options));
        auto of_lines = line_colours(owner, loss.mask, loss.target, groups, gaps, palette, loss.below,
                                     options.thickness_mm, options.match.lamps, kFusedPitches * g.pitch_px);
        result.piles = std::move(of_lines.piles);
        chosen = std::move(of_lines.pile);
        colours = colours_of(result.piles, false, palette, loss, options.thickness_mm);
    }

    report(progress, "lay paint", 0);
    Layer laid(canvas, palette);
    const double pixel_mm2 = square(loss.mm_per_pixel);
    const int cell =
        lines ? static_cast<int>(kFusedPitches * std::round(result.pitch_mm / loss.mm_per_pixel)) : 1;
    FusedDifference difference(loss.mask, cell);
    for (std::size_t i = 0; i < loss.glosses.size(); ++i)
        result.glosses.push_back({loss.glosses[i], {0, 0, 0}, 0, loss.gloss_parts[i]});
    for (int y = 0; y < loss.mask.height(); ++y)
        for (int x = 0; x < loss.mask.width(); ++x) {
            const float covered = loss.mask(x, y);
            if (!(covered > 0)) continue;
            result.area_mm2 += pixel_mm2 * static_cast<double>(covered);
            const int number = chosen(x, y);
            const float part = lines ? 1.0f : covered;
            if (number >= 0) {
                const Colour& colour = colours[static_cast<std::size_t>(number)];
                const double painted_mm2 = pixel_mm2 * static_cast<double>(part);
                RetouchGloss* const gloss =
                    loss.glosses.empty() ? nullptr : &result.glosses[loss.gloss(x, y)];
                laid.put(x + loss.region.x0, y + loss.region.y0, colour,
                         part * static_cast<float>(options.thickness_mm), gloss ? &gloss->wanted : nullptr,
                         gloss ? loss.gloss(x, y) : 0);
                result.painted_mm2 += painted_mm2;
                if (gloss) add_to(*gloss, colour, palette, painted_mm2);
                for (const auto& [pile, share] : colour.piles) {
                    Pile& p = result.piles[static_cast<std::size_t>(pile)];
                    p.share += pixel_mm2 * static_cast<double>(part * share);
                }
            }
            if (covered >= 0.5f)
                difference.add(x, y,
                               number >= 0 ? colours[static_cast<std::size_t>(number)].look : loss.below,
                               reflectance_of_rgb(loss.target(x, y)));
        }
    for (Pile& p : result.piles) {
        p.volume_mm3 = p.share * options.thickness_mm;
        p.share /= std::max(result.painted_mm2, 1e-12);
    }
    for (RetouchGloss& gloss : result.glosses) {
        const double part = 1 / std::max(gloss.area_mm2, 1e-12);
        gloss.of_paint.specular *= part, gloss.of_paint.roughness *= part;
        gloss.of_paint.luminance = gloss.wanted.luminance;
    }
    result.delta_e_mean = difference.means();
    result.target = std::move(loss.target);
    PaintLayer paint = laid.take();
    for (const TileIndex tile : paint.painted()) canvas.mark_dirty(tile);
    canvas.writable_dried().push_back({layer, std::move(paint)});
    report(progress, "lay paint", 1);
    return result;
}

}  // namespace tangi
