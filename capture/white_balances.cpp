#include "capture/white_balances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "surface/error.h"
#include "surface/median.h"
#include "surface/parallel.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr std::size_t kFewestWithCasts = 4, kFewestSamples = 20;
constexpr int kMeans = 5, kMedians = 10, kLines = 8;  // rounds
// [1] ln gain: 3 % of red or blue are about 1 CIEDE2000 on a light grey, which is what an eye tells at best.
constexpr double kMatters = 0.03;
constexpr double kCastSigmas = 4;      // of dozens of photographs, by chance, none
constexpr double kUnevenSigmas = 2.5;  // where parts disagree, which makes the error large
constexpr double kCastFloor = 0.002;   // [1] ln gain: of curves and rounding
// [1] Part of the light in a photograph that is a veil of white, more than in others: gloss of a painting
// under raking light, the room.
constexpr double kVeil = 0.05;
// [1] Scatter between parts and colours / difference, from which on it is no gain. Of a part of icon, whose
// gold is yellow only where it shines, 0.35 lets 8 of 62 photographs pass for casts, this none.
constexpr double kUnclear = 0.25;
constexpr std::size_t kCastGroups = 8;  // four parts of the picture, of each the redder and the bluer half
constexpr std::size_t kFewestInGroup = 4;
constexpr float kShadow = 0.4f,
                kHighlight = 1.5f;  // [1] of what a pixel usually has of its photograph's light
constexpr float kDarkest8 = 0.04f, kDarkestOfCasts16 = 0.004f;  // [1] stored: ten codes of 8 bits
constexpr float kOfBright = 0.02f;                              // [1] of the photograph's median light

constexpr double kNoCast = std::numeric_limits<double>::quiet_NaN();

// ln(red / green) and ln(blue / green), [sample][photo]; NaN where unknown.
struct Ratios {
    std::size_t photos = 0, samples = 0;
    std::vector<dvec2> y;
    const dvec2& at(std::size_t sample, std::size_t photo) const { return y[sample * photos + photo]; }
};

dvec2 log_ratios(const Rgb& v) {
    const bool good = v.r > 0 && v.g > 0 && v.b > 0;  // false of NaN
    return good ? dvec2(std::log(v.r / v.g), std::log(v.b / v.g)) : dvec2(kNoCast);
}

Ratios ratios_of(const ColourSamples& s) {
    Ratios r{s.photos, s.values.size() / std::max<std::size_t>(s.photos, 1), {}};
    for (const Rgb& v : s.values) r.y.push_back(log_ratios(v));
    return r;
}

// What pixels and photographs have of their own: y = pixel + photo.
struct Parts {
    std::vector<dvec2> pixels, photos;
};

template <class Middle>
void alternate(const Ratios& r, Parts& parts, const Middle& middle) {
    for (const bool of_photos : {false, true}) {
        std::vector<dvec2>& to = of_photos ? parts.photos : parts.pixels;
        parallel_for(0, static_cast<int>(to.size()), of_photos ? 1 : 64, [&](int begin, int end) {
            std::array<std::vector<double>, 2> left;
            for (int i = begin; i < end; ++i) {
                const auto at = static_cast<std::size_t>(i);
                for (auto& channel : left) channel.clear();
                for (std::size_t k = 0; k < (of_photos ? r.samples : r.photos); ++k) {
                    const dvec2& y = of_photos ? r.at(k, at) : r.at(at, k);
                    if (std::isnan(y.x)) continue;
                    const dvec2 rest = y - (of_photos ? parts.pixels[k] : parts.photos[k]);
                    if (std::isnan(rest.x)) continue;
                    left[0].push_back(rest.x), left[1].push_back(rest.y);
                }
                to[at] = left[0].empty() ? dvec2(kNoCast) : dvec2(middle(left[0]), middle(left[1]));
            }
        });
        if (!of_photos) continue;
        for (dvec2& photo : to)
            if (std::isnan(photo.x)) photo = dvec2(0);
    }
}

Parts polished(const Ratios& r) {
    Parts parts{std::vector<dvec2>(r.samples, dvec2(0)), std::vector<dvec2>(r.photos, dvec2(0))};
    const auto mean = [](const std::vector<double>& v) {
        return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
    };
    for (int round = 0; round < kMeans; ++round) alternate(r, parts, mean);
    for (int round = 0; round < kMedians; ++round)
        alternate(r, parts, [](const std::vector<double>& v) { return median(v); });
    return parts;
}

// The value that half of the photographs or more share, in both channels; of equally many, that of the first
// of them. Where no half agrees, lamps of all colours, their mean: what a light that no photograph had is
// likeliest to be.
dvec2 common_value(const std::vector<dvec2>& photos) {
    dvec2 best(0);
    std::size_t most = 0;
    for (const dvec2& candidate : photos) {
        std::array<std::vector<double>, 2> near;
        for (const dvec2& other : photos) {
            const dvec2 off = glm::abs(other - candidate);
            if (std::max(off.x, off.y) < kMatters) near[0].push_back(other.x), near[1].push_back(other.y);
        }
        if (near[0].size() <= most) continue;
        most = near[0].size();
        best = {median(near[0]), median(near[1])};
    }
    if (2 * most >= photos.size()) return best;
    return std::accumulate(photos.begin(), photos.end(), dvec2(0)) / static_cast<double>(photos.size());
}

// One sample's say on a photograph: the pixel's own ratio, and what the photograph's differs from it by.
struct Say {
    double pixel = 0, off = 0;
    std::size_t group = 0;
};

struct CastLine {
    double at_white = 0, sigma = 0, scatter = 0;
};

// off = at_white + slope * pixel, by Tukey's weights; slopes are those of a veil. With each group's median as
// one independent observation.
CastLine line_through(const std::vector<Say>& says) {
    double mean = 0, slope = 0, middle = 0, spread = 0;
    std::vector<double> sizes(says.size());
    double sigma = 1;
    for (int round = 0; round < kLines; ++round) {
        double weights = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (const Say& say : says) {
            const double u =
                round == 0 ? 0 : (say.off - middle - slope * (say.pixel - mean)) / (4.685 * sigma);
            if (std::abs(u) >= 1) continue;
            const double w = (1 - u * u) * (1 - u * u);
            weights += w, x += w * say.pixel, y += w * say.off;
            xx += w * say.pixel * say.pixel, xy += w * say.pixel * say.off;
        }
        if (!(weights > 0)) break;
        mean = x / weights, middle = y / weights;
        spread = std::max(xx / weights - mean * mean, 0.0);
        const double prior = sigma * sigma / (kVeil * kVeil * static_cast<double>(kCastGroups));
        slope = (xy / weights - mean * middle) / (spread + prior);
        for (std::size_t i = 0; i < says.size(); ++i)
            sizes[i] = std::abs(says[i].off - middle - slope * (says[i].pixel - mean));
        sigma = std::max(median(sizes) / 0.6745, 1e-4);
    }
    std::array<std::vector<double>, kCastGroups> groups;
    for (const Say& say : says) groups[say.group].push_back(say.off - middle - slope * (say.pixel - mean));
    double squares = 0, count = 0;
    for (const std::vector<double>& group : groups) {
        if (group.size() < kFewestInGroup) continue;
        const double off = median(group);
        squares += off * off;
        ++count;
    }
    CastLine line;
    line.at_white = middle - slope * mean;
    if (count < 3) {  // a chart's patches: each one is as good as a part
        line.scatter = sigma;
        count = static_cast<double>(says.size());
    } else {
        line.scatter = std::sqrt(squares / (count - 2));
    }
    const double of_mean = line.scatter / std::sqrt(count);
    const double of_slope = spread > 0 ? std::min(of_mean / std::sqrt(spread), kVeil) : kVeil;
    line.sigma = std::sqrt(of_mean * of_mean + mean * mean * of_slope * of_slope + kCastFloor * kCastFloor);
    return line;
}

WhiteBalance judged(const Ratios& r, const Parts& parts, const std::vector<int>& part, std::size_t photo,
                    const dvec2& common) {
    WhiteBalance result;
    for (int channel = 0; channel < 2; ++channel) {
        std::vector<double> own;
        for (std::size_t k = 0; k < r.samples; ++k)
            if (!std::isnan(parts.pixels[k].x)) own.push_back(parts.pixels[k][channel]);
        const double middle = median(own);
        std::vector<Say> says;
        for (std::size_t k = 0; k < r.samples; ++k) {
            const dvec2& y = r.at(k, photo);
            if (std::isnan(y.x) || std::isnan(parts.pixels[k].x)) continue;
            const double pixel = parts.pixels[k][channel];
            says.push_back({pixel + common[channel], y[channel] - pixel - common[channel],
                            2 * static_cast<std::size_t>(part[k]) + (pixel > middle)});
        }
        result.samples = static_cast<int>(says.size());
        if (says.size() < kFewestSamples / 2) return result;
        const CastLine line = line_through(says);
        result.log_gain[channel] = line.at_white;
        result.sigma[channel] = line.sigma;
        result.scatter[channel] = line.scatter;
    }
    result.decide();
    return result;
}

}  // namespace

Rgb WhiteBalance::gain() const {
    if (!differs) return Rgb(1);
    return {static_cast<float>(std::exp(log_gain.x)), 1, static_cast<float>(std::exp(log_gain.y))};
}

void WhiteBalance::decide() {
    differs = unclear = false;
    if (!(sigma.x > 0) || !(sigma.y > 0)) return;
    // One gain changes all of the picture alike.
    const bool uneven = glm::length(scatter) > kUnclear * glm::length(log_gain);
    for (int channel = 0; channel < 2; ++channel) {
        const double size = std::abs(log_gain[channel]);
        if (uneven && size > std::max(2 * kMatters, kUnevenSigmas * sigma[channel])) unclear = true;
        if (!uneven && size > std::max(kMatters, kCastSigmas * sigma[channel])) differs = true;
    }
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

void WhiteBalances::leave_lamps_of_many_colours() {
    if (2 * static_cast<std::size_t>(differing()) <= photos.size()) return;
    for (WhiteBalance& photo : photos)
        if (std::exchange(photo.differs, false)) photo.unclear = true;
}

int WhiteBalances::differing() const {
    return static_cast<int>(
        std::count_if(photos.begin(), photos.end(), [](const auto& p) { return p.differs; }));
}

int WhiteBalances::unclear() const {
    return static_cast<int>(
        std::count_if(photos.begin(), photos.end(), [](const auto& p) { return p.unclear; }));
}

WhiteBalances white_balances(const ColourSamples& samples) {
    WhiteBalances result;
    const Ratios ratios = ratios_of(samples);
    if (ratios.photos < kFewestWithCasts || ratios.samples < kFewestSamples) return result;
    TP_REQUIRE(samples.part.size() == ratios.samples, "each sample is somewhere");
    const Parts parts = polished(ratios);
    const dvec2 common = common_value(parts.photos);
    result.photos.resize(ratios.photos);
    parallel_for(0, static_cast<int>(ratios.photos), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            result.photos[static_cast<std::size_t>(i)] =
                judged(ratios, parts, samples.part, static_cast<std::size_t>(i), common);
    });
    return result;
}

WhiteBalances white_balances(const Survey& survey, const Transfer& transfer, float clipped, int bits) {
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
    return white_balances(s);
}

WhiteBalance white_balance_beside(std::span<const Rgb> expected, std::span<const Rgb> photographed,
                                  std::span<const int> part) {
    TP_REQUIRE(expected.size() == photographed.size() && expected.size() == part.size(), "pairs of pixels");
    Ratios ratios{1, 0, {}};
    Parts parts{{}, {dvec2(0)}};
    std::vector<int> where;
    for (std::size_t k = 0; k < expected.size(); ++k) {
        const dvec2 own = log_ratios(expected[k]), seen = log_ratios(photographed[k]);
        if (std::isnan(own.x) || std::isnan(seen.x)) continue;
        parts.pixels.push_back(own);
        ratios.y.push_back(seen);
        where.push_back(part[k]);
    }
    ratios.samples = where.size();
    return ratios.samples < kFewestSamples ? WhiteBalance{} : judged(ratios, parts, where, 0, dvec2(0));
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
            "{}: colours change from photograph to photograph in {} of {}, most in {}; by how much depends "
            "on "
            "the place (metal and gloss look like that, or a second light), or more than half differ (lamps "
            "of several colours), so it is no white balance and is not undone",
            where, unclear, balances.photos.size(), by);
    return fmt::format(
        "{}: the white balance, or the colour of the lamps, changes from photograph to photograph: {} of {} "
        "differ "
        "from most, most of all {}; {}. Photograph with a fixed white balance",
        where, differing, balances.photos.size(), by, remedy);
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
