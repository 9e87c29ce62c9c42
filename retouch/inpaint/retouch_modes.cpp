#include "retouch/inpaint/retouch_modes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "retouch/inpaint/line_colours.h"
#include "retouch/inpaint/loss_surroundings.h"
#include "retouch/inpaint/mixture_colours.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr std::array<std::string_view, 6> kModeNames = {"mimetic",     "tratteggio", "selection",
                                                        "abstraction", "dotting",    "neutral"};
constexpr double kFusedPitches = 6;  // over which lines and dots are to have the right mean

bool has_lines(RetouchMode mode) { return mode != RetouchMode::mimetic && mode != RetouchMode::neutral; }

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

std::vector<Rgb> targets_inside(const Mask& mask, const Image<Rgb>& target) {
    std::vector<Rgb> colours;
    for (std::size_t i = 0; i < mask.size(); ++i)
        if (mask.pixels()[i] > 0) colours.push_back(target.pixels()[i]);
    const std::size_t step = std::max<std::size_t>(colours.size() / 20000, 1);
    std::vector<Rgb> some;
    for (std::size_t i = 0; i < colours.size(); i += step) some.push_back(colours[i]);
    return some;
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

void add_pairs(const Colour& blend, RetouchReport& result) {
    const auto in_a_pile = [&](int a, int b) {
        return std::any_of(blend.piles.begin(), blend.piles.end(), [&](const auto& pile) {
            const Mixture& m = result.piles[static_cast<std::size_t>(pile.first)].mixture;
            const auto begin = m.paints.begin(), end = begin + m.count;
            return std::find(begin, end, a) != end && std::find(begin, end, b) != end;
        });
    };
    for (const auto& [a, of_a] : blend.volumes)
        for (const auto& [b, of_b] : blend.volumes)
            if (a < b && !in_a_pile(a, b)) result.blended.insert({a, b});
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

// Colours for every pixel of the loss, and the piles that they are of.
class Chosen {
public:
    Chosen(const Loss& loss, const Palette& palette, RetouchMode mode, const RetouchOptions& options)
        : loss_(loss), palette_(palette), mode_(mode), options_(options) {
        number = Image<int>(loss.mask.width(), loss.mask.height(), -1);
    }

    // Marks of the whole loss, where there are any.
    void draw(const MarkGeometry& geometry, RetouchReport& result) {
        result.pitch_mm = geometry.pitch_px * loss_.mm_per_pixel;
        result.width_mm = geometry.width_px * loss_.mm_per_pixel;
        Mask hole = loss_.mask;
        for (float& v : hole.pixels()) v = v > 0 ? 1.0f : 0.0f;
        const std::vector<Mark> marks = marks_of(mode_, loss_, geometry, dilated(hole, 1));
        result.marks = static_cast<int>(marks.size());
        owner_ = rasterised(marks, loss_.mask, geometry.width_px);
        blur_px_ = kFusedPitches * geometry.pitch_px;
    }

    // One ground after the other: paint that looks right over one does not over another that shows through.
    void choose(const Progress& progress) {
        share_grounds(progress);
        for (std::size_t i = 0; i < grounds.spectra.size(); ++i) {
            const Mask own = grounds.spectra.size() == 1 ? loss_.mask : mask_of(static_cast<int>(i));
            const auto first = static_cast<int>(colours.size());
            const Image<int> here = choose_over(own, grounds.spectra[i], progress);
            for (std::size_t k = 0; k < number.size(); ++k)
                if (own.pixels()[k] > 0 && here.pixels()[k] >= 0)
                    number.pixels()[k] = first + here.pixels()[k];
        }
    }

    const Spectrum& below(int x, int y) const {
        return grounds.spectra[grounds.of_part[static_cast<std::size_t>(loss_.parts.number(x, y)) - 1]];
    }

    Grounds grounds;
    std::vector<Pile> piles;
    std::vector<Colour> colours;
    Image<int> number;  // of each pixel's colour; -1 where nothing is painted

private:
    bool lines() const { return owner_.size() > 0; }
    int wanted_piles() const {
        if (lines()) return std::max(options_.piles / 2, 1);
        return mode_ == RetouchMode::neutral ? 1 : options_.piles;
    }

    Mask mask_of(int ground) const {
        Mask own = loss_.mask;
        for (std::size_t k = 0; k < own.size(); ++k)
            if (const int part = loss_.parts.number.pixels()[k];
                part == 0 || grounds.of_part[static_cast<std::size_t>(part) - 1] != ground)
                own.pixels()[k] = 0;
        return own;
    }

    // A part in which no line lies goes with the largest that has some.
    void share_grounds(const Progress& progress) {
        std::vector<PartGround> parts = loss_.grounds;
        if (lines()) {
            std::vector<bool> has(parts.size());
            for (std::size_t k = 0; k < owner_.size(); ++k)
                if (const int part = loss_.parts.number.pixels()[k];
                    part > 0 && owner_.pixels()[k] >= 0 && loss_.mask.pixels()[k] >= 0.5f)
                    has[static_cast<std::size_t>(part) - 1] = true;
            std::size_t largest = 0;
            for (std::size_t i = 0; i < parts.size(); ++i)
                if (has[i] && (!has[largest] || parts[i].pixels > parts[largest].pixels)) largest = i;
            for (std::size_t i = 0; i < parts.size(); ++i)
                if (!has[i]) parts[i].below = parts[largest].below;
        }
        const auto largest =
            std::max_element(parts.begin(), parts.end(),
                             [](const PartGround& a, const PartGround& b) { return a.pixels < b.pixels; });
        std::vector<Pile> probes;
        if (parts.size() > 1 && !(lines() && options_.bare_gaps))
            probes = piles_for(loss_.mask, largest->below, progress);
        grounds = grounds_of(parts, probes, palette_, options_.thickness_mm);
    }

    std::vector<Pile> piles_for(const Mask& own, const Spectrum& below, const Progress& progress) {
        const auto groups = groups_of(targets_inside(own, loss_.target), wanted_piles());
        std::vector<Pile> found;
        for (std::size_t i = 0; i < groups.size(); ++i) {
            report(progress, lines() ? "choose pure colours" : "match colours",
                   static_cast<double>(i) / static_cast<double>(groups.size()));
            found.push_back(pile_for(groups[i], below, palette_, options_));
        }
        return found;
    }

    // Numbers of colours from the first that is added.
    Image<int> choose_over(const Mask& own, const Spectrum& below, const Progress& progress) {
        std::vector<Pile> found;
        Image<int> chosen;
        if (!lines() || !options_.bare_gaps) found = piles_for(own, below, progress);
        if (lines()) {
            const LinesToColour to_colour{
                .owner = owner_,
                .mask = own,
                .target = loss_.target,
                .groups = groups_of(targets_inside(own, loss_.target), wanted_piles()),
                .gaps = std::move(found),
                .blur_px = blur_px_};
            auto of_lines = line_colours(to_colour, palette_, below, options_);
            found = std::move(of_lines.piles);
            chosen = std::move(of_lines.pile);
        }
        std::vector<Colour> own_colours =
            colours_of(found, mode_ == RetouchMode::mimetic, palette_, below, options_);
        if (!lines()) chosen = nearest_colours(own, loss_.target, own_colours);
        const auto first = static_cast<int>(piles.size());
        for (Colour& colour : own_colours) {
            for (auto& [pile, part] : colour.piles) pile += first;
            colours.push_back(std::move(colour));
        }
        piles.insert(piles.end(), found.begin(), found.end());
        return chosen;
    }

    const Loss& loss_;
    const Palette& palette_;
    RetouchMode mode_;
    const RetouchOptions& options_;
    Image<int> owner_;  // marks, -1 for none (hatching.h)
    double blur_px_ = 0;
};

// What is laid pixel by pixel, and the report on it.
class RetouchLaying {
public:
    RetouchLaying(Canvas& canvas, const Palette& palette, const Loss& loss, const Chosen& chosen,
                  const RetouchLayer& layer, RetouchReport& result)
        : palette_(palette),
          loss_(loss),
          chosen_(chosen),
          options_(layer.options),
          lines_(has_lines(layer.mode)),
          pixel_mm2_(loss.mm_per_pixel * loss.mm_per_pixel),
          result_(result),
          laid_(canvas, palette),
          difference_(loss.mask, cell_px()),
          used_(chosen.colours.size()) {}

    void lay(int x, int y) {
        const float covered = loss_.mask(x, y);
        result_.area_mm2 += pixel_mm2_ * static_cast<double>(covered);
        const int number = chosen_.number(x, y);
        if (number >= 0) {
            used_[static_cast<std::size_t>(number)] = true;
            paint(x, y, chosen_.colours[static_cast<std::size_t>(number)], lines_ ? 1.0f : covered);
        }
        if (covered >= 0.5f)
            difference_.add(
                x, y,
                number >= 0 ? chosen_.colours[static_cast<std::size_t>(number)].look : chosen_.below(x, y),
                reflectance_of_rgb(loss_.target(x, y)));
    }

    // Shares and means of what was laid.
    PaintLayer finish() {
        for (Pile& p : result_.piles) {
            p.volume_mm3 = p.share * options_.thickness_mm;
            p.share /= std::max(result_.painted_mm2, 1e-12);
        }
        for (RetouchGloss& gloss : result_.glosses) {
            const double part = 1 / std::max(gloss.area_mm2, 1e-12);
            gloss.of_paint.specular *= part, gloss.of_paint.roughness *= part;
            gloss.of_paint.luminance = gloss.wanted.luminance;
        }
        for (std::size_t i = 0; i < used_.size(); ++i)
            if (used_[i] && chosen_.colours[i].piles.size() > 1) add_pairs(chosen_.colours[i], result_);
        result_.delta_e_mean = difference_.means();
        return laid_.take();
    }

private:
    // Over which colours are compared: with lines, the means over some of them.
    int cell_px() const {
        return lines_ ? static_cast<int>(kFusedPitches * std::round(result_.pitch_mm / loss_.mm_per_pixel))
                      : 1;
    }

    void paint(int x, int y, const Colour& colour, float part) {
        const double painted_mm2 = pixel_mm2_ * static_cast<double>(part);
        RetouchGloss* const gloss = loss_.glosses.empty() ? nullptr : &result_.glosses[loss_.gloss(x, y)];
        laid_.put(x + loss_.region.x0, y + loss_.region.y0, colour,
                  part * static_cast<float>(options_.thickness_mm), gloss ? &gloss->wanted : nullptr,
                  gloss ? loss_.gloss(x, y) : 0);
        result_.painted_mm2 += painted_mm2;
        if (gloss) add_to(*gloss, colour, palette_, painted_mm2);
        for (const auto& [pile, share] : colour.piles)
            result_.piles[static_cast<std::size_t>(pile)].share +=
                pixel_mm2_ * static_cast<double>(part * share);
    }

    const Palette& palette_;
    const Loss& loss_;
    const Chosen& chosen_;
    const RetouchOptions& options_;
    const bool lines_;
    const double pixel_mm2_;
    RetouchReport& result_;
    Layer laid_;
    FusedDifference difference_;
    std::vector<bool> used_;  // of the colours
};

// A neutral retouch and an abstraction aim at one colour.
void aim(Loss& loss, RetouchMode mode, const RetouchOptions& options) {
    if (mode != RetouchMode::neutral && mode != RetouchMode::abstraction) return;
    const std::vector<Rgb> inside = targets_inside(loss.mask, loss.target);
    Rgb mean = groups_of(inside, 1)[0];
    if (mode == RetouchMode::neutral) mean = toned_down(mean, options);
    for (Rgb& t : loss.target.pixels()) t = mean;
}

}  // namespace

std::string_view name_of(RetouchMode mode) { return kModeNames[static_cast<std::size_t>(mode)]; }

std::optional<RetouchMode> retouch_mode_named(std::string_view name) {
    for (std::size_t i = 0; i < kModeNames.size(); ++i)
        if (kModeNames[i] == name) return static_cast<RetouchMode>(i);
    return std::nullopt;
}

RetouchReport lay_retouch(Canvas& canvas, const Palette& palette, const Mask& mask, const Mask& damaged,
                          const RetouchLayer& layer, const Progress& progress) {
    const RetouchOptions& options = layer.options;
    validate(options);
    validate(options.annulus);
    report(progress, "look at the surroundings", 0);
    Loss loss = loss_of(canvas, mask, damaged, options);
    aim(loss, layer.mode, options);
    RetouchReport result;
    result.region = loss.region;
    for (std::size_t i = 0; i < loss.glosses.size(); ++i)
        result.glosses.push_back({loss.glosses[i], {0, 0, 0}, 0, loss.gloss_parts[i]});
    Chosen chosen(loss, palette, layer.mode, options);
    if (has_lines(layer.mode)) chosen.draw(geometry_of(loss, options), result);
    chosen.choose(progress);
    result.piles = std::move(chosen.piles);
    result.grounds = static_cast<int>(chosen.grounds.spectra.size());

    report(progress, "lay paint", 0);
    RetouchLaying laying(canvas, palette, loss, chosen, layer, result);
    for (int y = 0; y < loss.mask.height(); ++y)
        for (int x = 0; x < loss.mask.width(); ++x)
            if (loss.mask(x, y) > 0) laying.lay(x, y);
    PaintLayer paint = laying.finish();
    result.target = std::move(loss.target);
    for (const TileIndex tile : paint.painted()) canvas.mark_dirty(tile);
    canvas.writable_dried().push_back({layer.name, std::move(paint)});
    report(progress, "lay paint", 1);
    return result;
}

}  // namespace tangi
