#include "capture/radiometry/white_balances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "capture/radiometry/colour_line.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr std::size_t kFewestWithCasts = 4, kFewestSamples = 20;
constexpr int kMeans = 5, kMedians = 10;  // rounds
// [1] ln gain: 3 % of red or blue are about 1 CIEDE2000 on a light grey, which is what an eye tells at best.
constexpr double kMatters = 0.03;
// Standard errors: by chance none of a hundred photographs is four off. What is told is off by more than
// matters, surely: 2.5 left no cast of 168 generated stacks silent and told none of 56 without (matt to
// gilded, 8 to 40 lights, JPEG of quality 75 and up; 2 told one, 3 left two silent).
constexpr double kCastSigmas = 4, kSureSigmas = 2.5;
// [1] ln: bronze and gold give lights such colours, which are no cast of the photograph.
constexpr double kLeastUndone = 0.1;
// [1] Of what a pixel usually has of its photograph's light: less is shadow, lit from around; more is
// highlight, and half as much again is as much as a veil may add (kMostVeil).
constexpr float kShadow = 0.4f, kHighlight = 1 + static_cast<float>(kMostVeil);
constexpr float kDarkest8 = 0.04f, kDarkestOfCasts16 = 0.004f;  // [1] stored: ten codes of 8 bits
constexpr float kOfBright = 0.02f;                              // [1] of the photograph's median light

const Vec3 kUsualLight(0, std::numbers::sqrt2_v<float> / 2, std::numbers::sqrt2_v<float> / 2);  // 45 degrees

constexpr double kNoCast = std::numeric_limits<double>::quiet_NaN();

// ln(red / green), ln(blue / green) and ln green, [sample][photo]; NaN where unknown.
struct Ratios {
    std::size_t photos = 0, samples = 0;
    std::vector<dvec3> y;
    const dvec3& at(std::size_t sample, std::size_t photo) const { return y[sample * photos + photo]; }
};

dvec3 log_ratios(const Rgb& v) {
    const bool good = v.r > 0 && v.g > 0 && v.b > 0;  // false of NaN
    return good ? dvec3(std::log(v.r / v.g), std::log(v.b / v.g), std::log(v.g)) : dvec3(kNoCast);
}

Ratios ratios_of(const ColourSamples& s) {
    Ratios r{s.photos, s.values.size() / std::max<std::size_t>(s.photos, 1), {}};
    for (const Rgb& v : s.values) r.y.push_back(log_ratios(v));
    return r;
}

// What pixels and photographs have of their own: y = pixel + photo.
struct Parts {
    std::vector<dvec3> pixels, photos;
};

template <class Middle>
void alternate(const Ratios& r, Parts& parts, const Middle& middle) {
    for (const bool of_photos : {false, true}) {
        std::vector<dvec3>& to = of_photos ? parts.photos : parts.pixels;
        parallel_for(0, static_cast<int>(to.size()), of_photos ? 1 : 64, [&](int begin, int end) {
            std::array<std::vector<double>, 3> left;
            for (int i = begin; i < end; ++i) {
                const auto at = static_cast<std::size_t>(i);
                for (auto& channel : left) channel.clear();
                for (std::size_t k = 0; k < (of_photos ? r.samples : r.photos); ++k) {
                    const dvec3& y = of_photos ? r.at(k, at) : r.at(at, k);
                    if (std::isnan(y.x)) continue;
                    const dvec3 rest = y - (of_photos ? parts.pixels[k] : parts.photos[k]);
                    if (std::isnan(rest.x)) continue;
                    for (int c = 0; c < 3; ++c) left[static_cast<std::size_t>(c)].push_back(rest[c]);
                }
                to[at] = left[0].empty() ? dvec3(kNoCast)
                                         : dvec3(middle(left[0]), middle(left[1]), middle(left[2]));
            }
        });
        if (!of_photos) continue;
        for (dvec3& photo : to)
            if (std::isnan(photo.x)) photo = dvec3(0);
    }
}

Parts polished(const Ratios& r) {
    Parts parts{std::vector<dvec3>(r.samples, dvec3(0)), std::vector<dvec3>(r.photos, dvec3(0))};
    const auto mean = [](const std::vector<double>& v) {
        return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
    };
    for (int round = 0; round < kMeans; ++round) alternate(r, parts, mean);
    for (int round = 0; round < kMedians; ++round)
        alternate(r, parts, [](const std::vector<double>& v) { return median(v); });
    return parts;
}

// The value that half of the photographs or more share, in both channels; of equally many, that of the first
// of them. Where no half agrees, lights of all colours, their mean: what a light that no photograph had is
// likeliest to be.
dvec2 common_value(const std::vector<dvec3>& photos) {
    dvec2 best(0);
    std::size_t most = 0;
    for (const dvec3& candidate : photos) {
        std::array<std::vector<double>, 2> near;
        for (const dvec3& other : photos) {
            const dvec2 off = glm::abs(dvec2(other) - dvec2(candidate));
            if (std::max(off.x, off.y) < kMatters) near[0].push_back(other.x), near[1].push_back(other.y);
        }
        if (near[0].size() <= most) continue;
        most = near[0].size();
        best = {median(near[0]), median(near[1])};
    }
    if (2 * most >= photos.size()) return best;
    const dvec3 sum = std::accumulate(photos.begin(), photos.end(), dvec3(0));
    return dvec2(sum) / static_cast<double>(photos.size());
}

// [1] What each sample is worth, 1 / variance: by how much its ratios scatter over the photographs, beyond
// what these have of their own. A matt pixel keeps its colour; metal, gloss and what is dark do not.
std::vector<double> worths(const Ratios& r, const Parts& parts) {
    std::vector<double> result(r.samples, 0);
    parallel_for(0, static_cast<int>(r.samples), 64, [&](int begin, int end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
            double squares = 0, count = 0;
            for (std::size_t i = 0; i < r.photos; ++i) {
                const dvec2 off(r.at(k, i) - parts.pixels[k] - parts.photos[i]);
                if (!std::isnan(off.x)) squares += glm::dot(off, off), ++count;
            }
            if (count > 2 && 2 * count > static_cast<double>(r.photos))
                result[k] = 1 / (squares / (count - 1) + kHalfCode * kHalfCode);
        }
    });
    return result;
}

// What photographs are compared with.
struct Reference {
    const std::vector<dvec3>& pixels;
    const std::vector<double>& worth;
    const std::vector<int>& part;
    dvec2 common{0};
    double green = 0;  // [1] ln of the usual pixel's

    Reference(const Parts& parts, const std::vector<double>& of_samples, const std::vector<int>& where,
              const dvec2& of_most)
        : pixels(parts.pixels), worth(of_samples), part(where), common(of_most) {
        std::vector<double> greens;
        for (const dvec3& pixel : pixels)
            if (!std::isnan(pixel.z)) greens.push_back(pixel.z);
        green = median(std::move(greens));
    }
};

// What the samples say of a photograph in a channel. White light of strength v, added to a pixel of red r and
// green g, changes ln(r / g) by v (1 / r - 1 / g), as long as it is weak.
std::vector<ColourSay> says_of(const Ratios& r, const Reference& beside, std::size_t photo, int channel) {
    std::vector<ColourSay> says;
    for (std::size_t k = 0; k < r.samples; ++k) {
        const double off = r.at(k, photo)[channel] - beside.pixels[k][channel];
        if (std::isnan(off) || !(beside.worth[k] > 0)) continue;
        const double own = beside.pixels[k][channel] + beside.common[channel];
        says.push_back({.veil = std::expm1(-own) * std::exp(beside.green - beside.pixels[k].z),
                        .off = off - beside.common[channel],
                        .worth = beside.worth[k],
                        .part = static_cast<std::size_t>(beside.part[k])});
    }
    return says;
}

WhiteBalance judged(const Ratios& r, const Reference& beside, std::size_t photo, const Vec3& light) {
    WhiteBalance result;
    for (int channel = 0; channel < 2; ++channel) {
        const std::vector<ColourSay> says = says_of(r, beside, photo, channel);
        result.samples = static_cast<int>(says.size());
        if (says.size() < kFewestSamples / 2) return result;
        const ColourLine line = colour_line(says, largest_veil(light));
        result.log_gain[channel] = line.at_white;
        result.sigma[channel] = line.sigma;
        result.uneven[channel] = line.uneven;
        result.uneven_sigma[channel] = line.uneven_sigma;
    }
    result.decide();
    return result;
}

// What most have in common was told from all pixels alike, metal too; now from what lines say.
void refer_to_most(std::vector<WhiteBalance>& photos) {
    std::vector<dvec3> known;
    for (const WhiteBalance& photo : photos)
        if (photo.sigma.x > 0 && photo.sigma.y > 0) known.emplace_back(photo.log_gain, 0);
    if (known.empty()) return;
    const dvec2 common = common_value(known);
    for (WhiteBalance& photo : photos) {
        photo.log_gain -= common;
        photo.decide();
    }
}

}  // namespace

Rgb WhiteBalance::gain() const {
    if (!differs) return Rgb(1);
    return {static_cast<float>(std::exp(log_gain.x)), 1, static_cast<float>(std::exp(log_gain.y))};
}

void WhiteBalance::decide() {
    differs = unclear = false;
    if (!(sigma.x > 0) || !(sigma.y > 0)) return;
    for (int channel = 0; channel < 2; ++channel) {
        const double size = std::abs(log_gain[channel]);
        if (uneven[channel] > kMatters + kSureSigmas * uneven_sigma[channel]) unclear = true;
        if (!(size > kMatters + kSureSigmas * sigma[channel])) continue;
        // A part that is off by less than half as much is made worse by undoing it.
        const bool of_all = size > kCastSigmas * sigma[channel] && size > 2 * uneven[channel];
        (of_all ? differs : unclear) = true;
    }
    unclear = unclear && !differs;
}

void WhiteBalances::refer_to(std::span<const std::optional<dvec2>> log_gains) {
    std::array<std::vector<double>, 2> off;
    for (std::size_t i = 0; i < std::min(photos.size(), log_gains.size()); ++i)
        if (log_gains[i] && photos[i].sigma.x > 0)
            for (int channel = 0; channel < 2; ++channel)
                off[static_cast<std::size_t>(channel)].push_back(photos[i].log_gain[channel] -
                                                                 (*log_gains[i])[channel]);
    if (off[0].empty()) return;
    const dvec2 offset(median(off[0]), median(off[1]));
    if (std::max(std::abs(offset.x), std::abs(offset.y)) < kMatters) return;
    for (WhiteBalance& photo : photos) {
        photo.log_gain -= offset;
        photo.decide();
    }
}

int WhiteBalances::differing() const {
    return static_cast<int>(
        std::count_if(photos.begin(), photos.end(), [](const auto& p) { return p.differs; }));
}

int WhiteBalances::unclear() const {
    return static_cast<int>(
        std::count_if(photos.begin(), photos.end(), [](const auto& p) { return p.unclear; }));
}

WhiteBalances white_balances(const ColourSamples& samples, std::span<const Light> lights) {
    WhiteBalances result;
    const Ratios ratios = ratios_of(samples);
    if (ratios.photos < kFewestWithCasts || ratios.samples < kFewestSamples) return result;
    TP_REQUIRE(samples.part.size() == ratios.samples, "each sample is somewhere");
    TP_REQUIRE(lights.empty() || lights.size() == ratios.photos, "a light a photograph");
    const Parts parts = polished(ratios);
    const std::vector<double> worth = worths(ratios, parts);
    const Reference beside(parts, worth, samples.part, common_value(parts.photos));
    result.photos.resize(ratios.photos);
    parallel_for(0, static_cast<int>(ratios.photos), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            result.photos[i] = judged(ratios, beside, i, lights.empty() ? kUsualLight : lights[i].direction);
    });
    refer_to_most(result.photos);
    // Lights of as many colours: none is the one that a photograph to come would have, and what undoes them
    // in these makes others worse predicted.
    const bool no_most = 2 * static_cast<std::size_t>(result.differing()) > result.photos.size();
    for (WhiteBalance& photo : result.photos) {
        const double size = std::max(std::abs(photo.log_gain.x), std::abs(photo.log_gain.y));
        if (no_most || size < kLeastUndone) photo.unclear |= std::exchange(photo.differs, false);
    }
    return result;
}

WhiteBalances white_balances(const Survey& survey, const Transfer& transfer, float clipped, int bits,
                             std::span<const Light> lights) {
    const ColourSamples samples = colour_samples(survey, transfer, clipped, bits);
    return samples.values.empty() ? WhiteBalances{} : white_balances(samples, lights);
}

ColourSamples colour_samples(const Survey& survey, const Transfer& transfer, float clipped, int bits) {
    if (survey.channels != 3 || survey.sample_count() == 0) return {};
    const std::size_t photos = survey.photos.size(),
                      samples = static_cast<std::size_t>(survey.sample_count());
    ColourSamples s{photos, std::vector<Rgb>(samples * photos, Rgb(std::numeric_limits<float>::quiet_NaN())),
                    std::vector<int>(samples)};
    const float darkest = bits == 8 ? kDarkest8 : bits == 16 ? kDarkestOfCasts16 : 0.0f;
    std::vector<float> level(photos);
    const auto linear = [&](std::size_t k, std::size_t i) {
        const float* v = survey.sample(static_cast<int>(k)) + 3 * i;
        return Rgb(transfer.decode(v[0]), transfer.decode(v[1]), transfer.decode(v[2]));
    };
    const auto stored_well = [&](const float* v) {  // false of NaN
        return std::min({v[0], v[1], v[2]}) > darkest && std::max({v[0], v[1], v[2]}) < clipped &&
               !std::isnan(v[0] + v[1] + v[2]);
    };
    for (std::size_t i = 0; i < photos; ++i) {
        std::vector<float> greens;
        for (std::size_t k = 0; k < samples; ++k)
            if (stored_well(survey.sample(static_cast<int>(k)) + 3 * i)) greens.push_back(linear(k, i).g);
        level[i] = std::max(median(std::move(greens)), 1e-9f);
    }
    glm::ivec2 low(std::numeric_limits<int>::max()), high(0);
    for (const glm::ivec2& at : survey.positions) low = glm::min(low, at), high = glm::max(high, at);
    for (std::size_t k = 0; k < samples; ++k) {
        const glm::ivec2 at = 2 * survey.positions[k];
        s.part[k] = (at.x > low.x + high.x) + 2 * (at.y > low.y + high.y);
        std::vector<float> shares;
        for (std::size_t i = 0; i < photos; ++i)
            if (stored_well(survey.sample(static_cast<int>(k)) + 3 * i))
                shares.push_back(linear(k, i).g / level[i]);
        const float usual = median(shares);
        for (std::size_t i = 0; i < photos; ++i) {
            if (!stored_well(survey.sample(static_cast<int>(k)) + 3 * i)) continue;
            const Rgb value = linear(k, i);
            const float share = value.g / level[i];
            if (share < std::max(kShadow * usual, kOfBright) || share > kHighlight * usual) continue;
            s.values[k * photos + i] = value;
        }
    }
    return s;
}

WhiteBalance white_balance_beside(std::span<const Rgb> expected, std::span<const Rgb> photographed,
                                  std::span<const int> part, const Vec3& light) {
    TP_REQUIRE(expected.size() == photographed.size() && expected.size() == part.size(), "pairs of pixels");
    Ratios ratios{1, 0, {}};
    Parts parts{{}, {dvec3(0)}};
    std::vector<int> where;
    for (std::size_t k = 0; k < expected.size(); ++k) {
        const dvec3 own = log_ratios(expected[k]), seen = log_ratios(photographed[k]);
        if (std::isnan(own.x) || std::isnan(seen.x)) continue;
        parts.pixels.push_back(own);
        ratios.y.push_back(seen);
        where.push_back(part[k]);
    }
    ratios.samples = where.size();
    if (ratios.samples < kFewestSamples) return {};
    const std::vector<double> alike(ratios.samples, 1);
    return judged(ratios, Reference(parts, alike, where, dvec2(0)), 0, light);
}

std::string warning_of(const WhiteBalances& balances, std::span<const std::string> names,
                       const std::string& where, std::string_view remedy) {
    const int differing = balances.differing(), unclear = balances.unclear();
    if (differing == 0 && unclear == 0) return {};
    std::size_t most = 0;
    double largest = 0;
    for (std::size_t i = 0; i < balances.photos.size(); ++i) {
        const WhiteBalance& b = balances.photos[i];
        const double size = std::max(std::abs(b.log_gain.x), std::abs(b.log_gain.y));
        if ((differing > 0 ? b.differs : b.unclear) && size > largest) largest = size, most = i;
    }
    const WhiteBalance& b = balances.photos[most];
    const std::string by =
        fmt::format("{}: red × {:.2f} ± {:.2f}, blue × {:.2f} ± {:.2f} against green", names[most],
                    std::exp(b.log_gain.x), std::exp(b.log_gain.x) * b.sigma.x, std::exp(b.log_gain.y),
                    std::exp(b.log_gain.y) * b.sigma.y);
    if (differing == 0)
        return fmt::format(
            "{}: colours change from photograph to photograph in {} of {}, most in {}; lights of several "
            "colours, a second light, metal and gloss look like that, so it is not undone",
            where, unclear, balances.photos.size(), by);
    const bool no_most = 2 * static_cast<std::size_t>(differing) > balances.photos.size();
    return fmt::format(
        "{}: the white balance, or the colour of the lights, changes from photograph to photograph: {} of {} "
        "differ from {}, most of all {}; {}. Photograph with a fixed white balance{}",
        where, differing, balances.photos.size(), no_most ? "the mean, since no half is alike" : "most", by,
        remedy, no_most ? ", and lights of one colour" : "");
}

nlohmann::json to_json(const WhiteBalances& balances, std::span<const std::string> names, bool all) {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < balances.photos.size(); ++i) {
        const WhiteBalance& b = balances.photos[i];
        if (!all && !b.differs && !b.unclear) continue;
        if (!(b.sigma.x > 0)) continue;
        const dvec2 gain = glm::exp(b.log_gain);
        list.push_back({{"photograph", names[i]},
                        {"red", gain.x},
                        {"blue", gain.y},
                        {"sigma_red", gain.x * b.sigma.x},
                        {"sigma_blue", gain.y * b.sigma.y},
                        {"undone", b.differs}});
    }
    return list;
}

}  // namespace tangi
