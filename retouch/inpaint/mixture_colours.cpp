#include "retouch/inpaint/mixture_colours.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "paint/optics/drawdown_card.h"
#include "paint/optics/kubelka_munk.h"

namespace tangi {

namespace {

constexpr int kBlends = 8;               // steps from one pile to another
constexpr std::size_t kMostGrounds = 8;  // each of which has piles of its own
constexpr double kSameLook = 1;          // CIEDE2000 on average

double square(double v) { return v * v; }
double distance2(const Lab& a, const Lab& b) {
    return square(a.l - b.l) + square(a.a - b.a) + square(a.b - b.b);
}

Medium medium_of(const std::vector<std::pair<int, float>>& volumes, const Palette& palette) {
    std::vector<Pigment> pigments;
    std::vector<float> amounts;
    for (const auto& [paint, volume] : volumes) {
        pigments.push_back(palette.paints[static_cast<std::size_t>(paint)]);
        amounts.push_back(volume);
    }
    return mix(pigments, amounts);
}

std::vector<std::pair<int, float>> volumes_of(const std::vector<std::pair<int, float>>& parts,
                                              const std::vector<Pile>& piles) {
    std::map<int, float> volumes;
    for (const auto& [pile, part] : parts) {
        const Mixture& m = piles[static_cast<std::size_t>(pile)].mixture;
        for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i)
            volumes[m.paints[i]] += part * static_cast<float>(m.volumes[i]);
    }
    return {volumes.begin(), volumes.end()};
}

bool may_come_together(const std::vector<std::pair<int, float>>& volumes, const Palette& palette,
                       const std::vector<char>& allowed) {
    if (allowed.empty()) return true;
    const std::size_t n = palette.paints.size();
    for (const auto& [a, of_a] : volumes)
        for (const auto& [b, of_b] : volumes)
            if (!allowed[static_cast<std::size_t>(a) * n + static_cast<std::size_t>(b)]) return false;
    return true;
}

}  // namespace

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

Pile pile_for(const Rgb& colour, const Spectrum& below, const Palette& palette,
              const RetouchOptions& options) {
    MatchOptions match = options.match;
    match.film = FilmOnGround{options.thickness_mm, below};
    match.alternatives = 1;
    const auto found = match_spectrum(palette.paints, reflectance_of_rgb(colour), match).recipes[0];
    Pile pile;
    pile.steps = found.steps;
    pile.mixture = found.mixture;
    pile.look = found.look;
    pile.target = reflectance_of_rgb(colour);
    return pile;
}

std::vector<Colour> colours_of(const std::vector<Pile>& piles, bool blends, const Palette& palette,
                               const Spectrum& below, const RetouchOptions& options) {
    std::vector<Colour> colours;
    const auto add = [&](const std::vector<std::pair<int, float>>& parts) {
        Colour colour{.volumes = volumes_of(parts, piles), .piles = parts, .lab = {}};
        if (parts.size() > 1 && !may_come_together(colour.volumes, palette, options.match.allowed)) return;
        colour.look =
            film_look(medium_of(colour.volumes, palette), static_cast<float>(options.thickness_mm), below);
        colour.lab = lab_under(colour.look);
        colours.push_back(std::move(colour));
    };
    for (int i = 0; i < static_cast<int>(piles.size()); ++i) add({{i, 1.0f}});
    for (int i = 0; blends && i < static_cast<int>(piles.size()); ++i)
        for (int j = i + 1; j < static_cast<int>(piles.size()); ++j)
            for (int step = 1; step < kBlends; ++step) {
                const float part = static_cast<float>(step) / kBlends;
                add({{i, 1 - part}, {j, part}});
            }
    return colours;
}

Image<int> nearest_colours(const Mask& mask, const Image<Rgb>& target, const std::vector<Colour>& colours) {
    Image<int> chosen(mask.width(), mask.height(), -1);
    for (std::size_t i = 0; i < mask.size(); ++i) {
        if (!(mask.pixels()[i] > 0)) continue;
        const Lab wanted = lab_from_linear(target.pixels()[i]);
        int best = 0;
        for (int c = 1; c < static_cast<int>(colours.size()); ++c)
            if (distance2(colours[static_cast<std::size_t>(c)].lab, wanted) <
                distance2(colours[static_cast<std::size_t>(best)].lab, wanted))
                best = c;
        chosen.pixels()[i] = best;
    }
    return chosen;
}

Grounds grounds_of(const std::vector<PartGround>& parts, const std::vector<Pile>& probes,
                   const Palette& palette, double thickness_mm) {
    std::vector<Medium> films;
    for (std::size_t i = 0; i < probes.size(); ++i)
        films.push_back(medium_of(volumes_of({{static_cast<int>(i), 1.0f}}, probes), palette));
    const auto off = [&](const Spectrum& a, const Spectrum& b) {
        if (films.empty()) return delta_e_2000(lab_under(a), lab_under(b));
        double sum = 0;
        for (const Medium& film : films)
            sum += delta_e_2000(lab_under(film_look(film, static_cast<float>(thickness_mm), a)),
                                lab_under(film_look(film, static_cast<float>(thickness_mm), b)));
        return sum / static_cast<double>(films.size());
    };
    std::vector<std::size_t> order(parts.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return parts[a].pixels > parts[b].pixels; });
    Grounds grounds{{}, std::vector<unsigned char>(parts.size(), 0)};
    for (const std::size_t i : order) {
        const auto nearest = std::min_element(grounds.spectra.begin(), grounds.spectra.end(),
                                              [&](const Spectrum& a, const Spectrum& b) {
                                                  return off(a, parts[i].below) < off(b, parts[i].below);
                                              });
        const bool shared = nearest != grounds.spectra.end() && (off(*nearest, parts[i].below) <= kSameLook ||
                                                                 grounds.spectra.size() == kMostGrounds);
        const auto number =
            shared ? static_cast<std::size_t>(nearest - grounds.spectra.begin()) : grounds.spectra.size();
        grounds.of_part[i] = static_cast<unsigned char>(number);
        if (!shared) grounds.spectra.push_back(parts[i].below);
    }
    // Each as its parts are in the mean.
    std::vector<double> pixels(grounds.spectra.size());
    for (Spectrum& ground : grounds.spectra) ground.fill(0);
    for (std::size_t i = 0; i < parts.size(); ++i) pixels[grounds.of_part[i]] += parts[i].pixels;
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (std::size_t band = 0; band < kBands; ++band)
            grounds.spectra[grounds.of_part[i]][band] +=
                parts[i].below[band] * static_cast<float>(parts[i].pixels / pixels[grounds.of_part[i]]);
    return grounds;
}

}  // namespace tangi
