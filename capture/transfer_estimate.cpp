#include "capture/transfer_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "capture/photometric_stereo.h"
#include "surface/median.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kSamples = 1500;          // enough: the choice is between a handful of curves
constexpr double kLowestCosine = 0.25;  // [1] below 15 degrees shadows and interreflection rule
// [1] By which a gamma must fit better than the usual curves: near one of them (linear; 2 to 2.4) it is
// likely that one, seen through what the model leaves out; between them it is likely another.
constexpr double kBetterNear = 1.3, kBetterBetween = 1.08;
// A smooth curve of three numbers is believed only where it fits down to the noise, none of one number does,
// and it is better by this: gloss, interreflection and near lamps bend what they are seen through as well
// (real/coin: 1.46 times better, but 3 codes off; it is linear). The same against what files state.
constexpr double kBetterCurve = 1.4, kCurveFits = 1.5 / 255;
constexpr double kRatioScale = 0.1;  // [1] ln ratio from which on a pixel counts less
// [1] A rival that fits as well but for this is worth a warning; and what is added where one photograph more
// than pixels have unknowns is all there is. Of generated stacks of four, whatever they were stored with, the
// curves' residuals differ by a factor of 1.2 at most.
constexpr double kDoubtful = 1.02, kDoubtfulFew = 0.5;
constexpr double kUnknowns = 3;  // of matt reflection, a pixel

PixelSamples linearised(const Stack& stack, const Survey& survey, int sample, const Transfer& transfer) {
    PixelSamples s;
    const int photos = static_cast<int>(stack.photos.size());
    s.resize(photos, 1);
    const float* value = survey.sample(sample);
    for (int i = 0; i < photos; ++i) {
        const auto at = static_cast<std::size_t>(i);
        double sum = 0;
        float highest = 0;
        bool measured = true;  // where a registered photograph does not reach, there is no number
        for (int c = 0; c < survey.channels; ++c) {
            const float stored = value[i * survey.channels + c];
            sum += transfer.decode(stored);
            highest = std::max(highest, stored);
            measured = measured && !std::isnan(stored);
        }
        s.light[at] = stack.photos[at].light.direction;
        s.irradiance[at] = 1;
        s.value[at] = sum / survey.channels;
        s.sigma[at] = highest < kClipped && measured ? 1 : 0;
    }
    return s;
}

// A sample of pixels as one transfer curve would have them, and what photometric stereo makes of it.
struct MattSample {
    std::vector<int> index;  // of the survey's samples
    std::vector<PixelSamples> pixels;
    std::vector<LambertEstimate> estimates;

    // [1] what a matt surface should show; 0 where it would be in shadow, or nothing is known.
    double predicted(std::size_t k, std::size_t photo) const {
        if (!estimates[k].valid || !(pixels[k].sigma[photo] > 0)) return 0;
        const double cosine = glm::dot(estimates[k].normal, pixels[k].light[photo]);
        return cosine < kLowestCosine ? 0 : estimates[k].diffuse[0] * cosine;
    }
};

MattSample matt_sample(const Stack& stack, const Survey& survey, const Transfer& transfer) {
    MattSample sample;
    sample.index = survey.spread(kSamples);
    sample.pixels.resize(sample.index.size());
    sample.estimates.resize(sample.index.size());
    parallel_for(0, static_cast<int>(sample.index.size()), 16, [&](int begin, int end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
            sample.pixels[k] = linearised(stack, survey, sample.index[k], transfer);
            sample.estimates[k] = photometric_stereo(sample.pixels[k]);
        }
    });
    return sample;
}

// ln of how much more light there is in one photograph than it should be, as a plane over the picture: what
// lamps of other strength, and near ones, do. Robust (Cauchy): shadows and highlights are no lamps.
class IlluminationPlane {
public:
    IlluminationPlane(const MattSample& sample, std::size_t photo, const Survey& survey, const Stack& stack)
        : survey_(survey),
          centre_(stack.width() / 2.0, stack.height() / 2.0),
          scale_(1.0 / std::max(stack.width(), stack.height())) {
        std::vector<double> ratios;
        std::vector<glm::dvec3> terms;
        for (std::size_t k = 0; k < sample.index.size(); ++k) {
            const double predicted = sample.predicted(k, photo);
            if (!(predicted > 1e-6)) continue;
            ratios.push_back(std::log(std::max(sample.pixels[k].value[photo] / predicted, 1e-3)));
            terms.push_back(terms_of(sample.index[k]));
        }
        plane_ = {median(ratios), 0, 0};
        for (int iteration = 0; iteration < 6; ++iteration) {
            glm::dmat3 a(0);
            glm::dvec3 b(0);
            for (std::size_t k = 0; k < ratios.size(); ++k) {
                const double r = (ratios[k] - glm::dot(plane_, terms[k])) / kRatioScale;
                const double w = 1 / (1 + r * r);
                a += w * glm::outerProduct(terms[k], terms[k]);
                b += w * ratios[k] * terms[k];
            }
            if (!(std::abs(glm::determinant(a)) > 1e-6)) break;  // too few pixels for a plane
            plane_ = glm::inverse(a) * b;
        }
    }

    double factor(int sample) const { return std::exp(glm::dot(plane_, terms_of(sample))); }

private:
    glm::dvec3 terms_of(int sample) const {
        const glm::dvec2 p =
            (glm::dvec2(survey_.positions[static_cast<std::size_t>(sample)]) - centre_) * scale_;
        return {1, p.x, p.y};
    }

    const Survey& survey_;
    glm::dvec2 centre_;
    double scale_;
    glm::dvec3 plane_{0};
};

// Median deviation from robust matt reflection under lamps of any strength, in the stored encoding.
double residual_of(const Stack& stack, const Survey& survey, const Transfer& transfer) {
    const MattSample sample = matt_sample(stack, survey, transfer);
    std::vector<std::vector<double>> of_photo(stack.photos.size());
    parallel_for(0, static_cast<int>(of_photo.size()), 1, [&](int begin, int end) {
        for (auto photo = static_cast<std::size_t>(begin); photo < static_cast<std::size_t>(end); ++photo) {
            const IlluminationPlane plane(sample, photo, survey, stack);
            for (std::size_t k = 0; k < sample.index.size(); ++k) {
                const double predicted = sample.predicted(k, photo);
                if (!(predicted > 0)) continue;
                const double model = predicted * plane.factor(sample.index[k]);
                of_photo[photo].push_back(
                    std::abs(transfer.encode(static_cast<float>(model)) -
                             transfer.encode(static_cast<float>(sample.pixels[k].value[photo]))));
            }
        }
    });
    std::vector<double> deviations;
    for (const std::vector<double>& some : of_photo)
        deviations.insert(deviations.end(), some.begin(), some.end());
    return median(std::move(deviations));
}

// Cameras compress light from the middle upwards, more than they steepen it there for contrast, and lift
// shadows by a toe. Near lamps and gloss bend what photometric stereo sees into anything, also into curves
// that have one stored value for nearly all light.
bool is_of_a_camera(const Transfer& curve) {
    constexpr int steps = 64;
    constexpr double middle = 0.5, least = 0.9, least_of_shadows = 0.4;
    for (int i = 1; i <= steps; ++i) {
        const double encoded = i / static_cast<double>(steps);
        if (!(curve.log_slope(encoded) >= (encoded < middle ? least_of_shadows : least))) return false;
    }
    return true;
}

bool is_linear(const Transfer& transfer) { return transfer.kind == Transfer::Kind::linear; }

// The gamma that fits best, from a row of them, then in ever smaller steps, to 0.025.
TransferEstimate::Candidate best_gamma(const Stack& stack, const Survey& survey) {
    const auto at = [&](double gamma) {
        return residual_of(stack, survey, Transfer{Transfer::Kind::gamma, gamma});
    };
    constexpr std::array<double, 9> row = {1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4, 2.6};
    std::array<double, row.size()> residual{};
    for (std::size_t i = 0; i < row.size(); ++i) residual[i] = at(row[i]);
    const auto best =
        static_cast<std::size_t>(std::min_element(residual.begin(), residual.end()) - residual.begin());
    double gamma = row[best], lowest = residual[best];
    for (double step = 0.1; step > 0.02; step /= 2)
        for (const double next : {gamma - step, gamma + step})
            if (const double r = at(next); r < lowest) {
                gamma = next;
                lowest = r;
                break;
            }
    return {{Transfer::Kind::gamma, std::round(gamma * 1000) / 1000}, lowest};
}

// The smooth curve that fits best, by pattern search (Hooke & Jeeves 1961) from the best gamma. Gives up
// early where the first steps gain little.
TransferEstimate::Candidate best_curve(const Stack& stack, const Survey& survey,
                                       const TransferEstimate::Candidate& from) {
    using Parameters = std::array<double, 3>;
    const auto transfer_of = [](const Parameters& p) {
        const auto rounded = [](double value) { return std::round(value * 1000) / 1000; };
        return Transfer{Transfer::Kind::curve, rounded(p[0]), rounded(p[1]), rounded(p[2])};
    };
    const auto at = [&](const Parameters& p) {
        const Transfer t = transfer_of(p);
        if (!(t.gamma >= 0.2 && t.gamma <= 5 && is_of_a_camera(t))) return std::numeric_limits<double>::max();
        return residual_of(stack, survey, t);
    };
    Parameters best = {from.transfer.gamma, 0, 0};
    double lowest = from.residual;
    // The three numbers all but replace each other: a bend with the gamma that keeps the middle in place.
    const std::array<Parameters, 3> directions = {{{-0.5, 1, 0}, {1, 0, 0}, {0.25, -1, 1}}};
    for (double step = 0.8; step > 0.04;) {
        const Parameters start = best;
        for (const Parameters& direction : directions)
            for (const double sign : {step, -step}) {
                Parameters next = best;
                for (std::size_t i = 0; i < next.size(); ++i) next[i] += sign * direction[i];
                if (const double r = at(next); r < lowest) {
                    best = next;
                    lowest = r;
                    break;
                }
            }
        if (best == start) {
            step /= 2;
            if (step < 0.3 && lowest * 1.05 > from.residual) break;  // no curve: it would have shown by now
            continue;
        }
        Parameters leap = best;  // on in the direction that helped
        for (std::size_t i = 0; i < leap.size(); ++i) leap[i] += best[i] - start[i];
        if (const double r = at(leap); r < lowest) {
            best = leap;
            lowest = r;
        }
    }
    return {transfer_of(best), lowest};
}

double doubtful(const Stack& stack) {
    return kDoubtful + kDoubtfulFew / std::max(static_cast<double>(stack.photos.size()) - kUnknowns, 1.0);
}

}  // namespace

bool speaks_against(const Transfer& stated, const TransferEstimate& estimated, const Stack& stack,
                    const Survey& survey) {
    const double least = residual_of(stack, survey, estimated.transfer);
    const double much =
        is_linear(estimated.transfer) || least < kCurveFits ? kBetterNear : kBetterNear * kBetterCurve;
    return residual_of(stack, survey, stated) > std::max(much, doubtful(stack)) * least;
}

TransferEstimate estimate_transfer(const Stack& stack, const Survey& survey) {
    if (stack.development) return {Transfer{}, "developed, " + stack.development->encoding_source, {}, {}};
    if (stack.transfer) return {*stack.transfer, "given", {}, {}};
    if (stack.bits == 32) return {Transfer{}, "float file", {}, {}};
    TransferEstimate result{Transfer{}, "estimated", {}, {}};
    for (const Transfer& transfer : {Transfer{Transfer::Kind::linear}, Transfer{Transfer::Kind::srgb},
                                     Transfer{Transfer::Kind::gamma, 2.2}})
        result.candidates.push_back({transfer, residual_of(stack, survey, transfer)});
    std::vector<TransferEstimate::Candidate> ranked = result.candidates;
    std::sort(ranked.begin(), ranked.end(),
              [](const auto& a, const auto& b) { return a.residual < b.residual; });
    result.transfer = ranked[0].transfer;
    const TransferEstimate::Candidate other = best_gamma(stack, survey);
    result.candidates.push_back(other);
    const double single = std::min(other.residual, ranked[0].residual);
    const TransferEstimate::Candidate curve =
        single > kCurveFits ? best_curve(stack, survey, other) : TransferEstimate::Candidate{other};
    if (curve.residual < kCurveFits && curve.residual * kBetterCurve < single) {
        result.candidates.push_back(curve);
        result.transfer = curve.transfer;
        result.warning = fmt::format(
            "{}: stored with a tone curve that is neither linear, sRGB nor a gamma; taken as '{}' (residual "
            "{:.4f}, the best of those {:.4f}). Photographs without such a curve (camera raw, linear TIFF) "
            "are "
            "more exact",
            stack.folder.string(), curve.transfer.name(), curve.residual, single);
        return result;
    }
    const bool between = other.transfer.gamma > 1.3 && other.transfer.gamma < 1.95;
    if (other.residual * (between ? kBetterBetween : kBetterNear) < ranked[0].residual) {
        result.transfer = other.transfer;
        return result;
    }
    // sRGB and gamma 2.2 differ by little; linear or not makes all the difference.
    for (const auto& rival : ranked)
        if (is_linear(rival.transfer) != is_linear(ranked[0].transfer) &&
            rival.residual < doubtful(stack) * ranked[0].residual)
            result.warning = fmt::format(
                "{}: taken as {}, but {} fits almost as well ({:.4f} against {:.4f}); if you know how the "
                "photographs are stored, say so with --transfer",
                stack.folder.string(), result.transfer.name(), rival.transfer.name(), rival.residual,
                ranked[0].residual);
    return result;
}

}  // namespace tangi
