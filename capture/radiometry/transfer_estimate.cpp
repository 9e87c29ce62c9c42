#include "capture/radiometry/transfer_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "capture/radiometry/transfer_evidence.h"

namespace tangi {

namespace {

constexpr int kCurveSamples = 1500;  // enough: the choice is between a handful of curves
// By which a gamma that is none of the usual must fit better than these, surfaces being found as if lights
// were equally strong [1]: near one of them (linear; 2 to 2.4) it is likely that one, seen through what the
// model leaves out; between them it is likely another. And ln by which it must explain the photographs
// better, lights of any strength.
constexpr double kBetterNear = 1.3, kBetterBetween = 1.08, kUnusual = 3;
// A smooth curve of three numbers is believed only where it fits down to the noise, none of one number does,
// and it is better by this: gloss, interreflection and near lights bend what they are seen through as well.
// Of 336 generated surveys without a tone curve two are taken for one, gilded ones, and that is told.
constexpr double kBetterCurve = 1.4, kCurveFits = 1.5 / 255;
// [1] Probability of curves with other slopes from which on the choice is open.
constexpr double kOpen = 0.1;
// [deg] From which on slopes are others: twice what the fit leaves them off by under many lights, and more
// than neighbours (gamma 1.8 and sRGB) differ by.
constexpr double kOtherSlopes_deg = 2.5;
constexpr double kWorthTelling = 0.01;  // [1] probability of a curve that is named among the possible ones
constexpr double kBelievedCurve = 10;   // [1] times as often as not, what files state blindly is right
constexpr double kSureAgainst = 20;     // [1] odds by which photographs contradict it even so

// Median deviation from robust matt reflection, surfaces being found as if lights were equally strong.
double residual_of(const Stack& stack, const Survey& survey, const Transfer& transfer) {
    return matt_sample(stack.lights(), {survey, transfer, stack.width(), stack.height()}, kCurveSamples)
        .residual();
}

// Cameras compress light from the middle upwards, more than they steepen it there for contrast, and lift
// shadows by a toe. Near lights and gloss bend what photometric stereo sees into anything, also into curves
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

bool is_usual(const Transfer& t) {
    return t.kind == Transfer::Kind::linear || t.kind == Transfer::Kind::srgb ||
           (t.kind == Transfer::Kind::gamma && t.gamma == 2.2);
}

// Those, and the one that others were stored with.
bool is_common(const Transfer& t) {
    return is_usual(t) || (t.kind == Transfer::Kind::gamma && t.gamma == 1.8);
}

// A curve, and its residual.
struct Fitted {
    Transfer transfer;
    double residual = 0;
};

// The gamma that fits best, from a row of them, then in ever smaller steps, to 0.025.
Fitted best_gamma(const Stack& stack, const Survey& survey) {
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
Fitted best_curve(const Stack& stack, const Survey& survey, const Fitted& from) {
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

// Linear, sRGB and gamma 2.2, and gammas that somebody may have meant otherwise.
std::vector<TransferTrial> trials_of(const Stack& stack, const Survey& survey) {
    std::vector<TransferTrial> trials;
    for (const Transfer& transfer :
         {Transfer{Transfer::Kind::linear}, Transfer{Transfer::Kind::srgb},
          Transfer{Transfer::Kind::gamma, 2.2}, Transfer{Transfer::Kind::gamma, 1.8},
          Transfer{Transfer::Kind::gamma, 1.4}, Transfer{Transfer::Kind::gamma, 1.6},
          Transfer{Transfer::Kind::gamma, 2.7}})
        trials.push_back(try_transfer(stack, survey, transfer));
    weigh(trials, stack);
    return trials;
}

// Of sRGB and gamma 2.2, which differ by little, the one that fits better.
std::size_t most_probable_usual(const std::vector<TransferTrial>& trials) {
    std::size_t best = 0;  // linear light, then sRGB and gamma 2.2
    for (std::size_t i = 0; i < 3; ++i)
        if (trials[i].probability > trials[best].probability) best = i;
    if (best == 0) return 0;
    return trials[1].equal_residual <= trials[2].equal_residual ? 1 : 2;
}

// Adds a gamma that is none of the usual where it fits better than all of these, and explains more.
bool add_unusual(std::vector<TransferTrial>& trials, const Stack& stack, const Survey& survey) {
    double usual = std::numeric_limits<double>::max(), unusual = usual;
    for (const TransferTrial& trial : trials) {
        double& least = is_usual(trial.transfer) ? usual : unusual;
        least = std::min(least, trial.equal_residual);
    }
    if (!(unusual < usual)) return false;
    const Fitted gamma = best_gamma(stack, survey);
    const bool between = gamma.transfer.gamma > 1.3 && gamma.transfer.gamma < 1.95;
    if (!(gamma.residual * (between ? kBetterBetween : kBetterNear) < usual)) return false;
    std::vector<TransferTrial> with = trials;
    std::erase_if(with, [&](const TransferTrial& trial) { return trial.transfer == gamma.transfer; });
    with.push_back(try_transfer(stack, survey, gamma.transfer));
    weigh(with, stack);
    for (const TransferTrial& trial : with)
        if (is_usual(trial.transfer) && trial.log_evidence + kUnusual > with.back().log_evidence)
            return false;
    trials = std::move(with);
    return true;
}

// What may be said of a choice that is open: the curves, how probable, and what hangs on them.
std::string open_choice(const Stack& stack, const TransferEstimate& e) {
    std::vector<TransferEstimate::Candidate> possible;
    for (const auto& candidate : e.candidates)
        if (candidate.probability > kWorthTelling && !(candidate.transfer == e.transfer))
            possible.push_back(candidate);
    std::sort(possible.begin(), possible.end(),
              [](const auto& a, const auto& b) { return a.probability > b.probability; });
    std::string others;
    for (const auto& candidate : possible)
        others +=
            fmt::format("{}{} ({:.0f} %, {:.1f} degrees)", others.empty() ? "" : ", ",
                        candidate.transfer.name(), 100 * candidate.probability, candidate.slopes_change_deg);
    return fmt::format(
        "{}: how the photographs are stored is open: taken as {}, but they, and lights that stand as these "
        "do, "
        "allow as well {} (probability, and by how much the slopes of the middling pixel would change); say "
        "what it is with --transfer linear, srgb or a gamma such as 2.2",
        stack.folder.string(), e.transfer.name(), others);
}

// Whether it matters which curve is taken, and is open. Gammas of somebody's own are no part of that: a free
// exponent takes up what gloss makes of the lights' strengths, and few files have one.
void tell_of_open_choice(const Stack& stack, TransferEstimate& e) {
    double all = 0, other_slopes = 0, other_colours = 0;
    for (const auto& candidate : e.candidates) {
        if (!is_common(candidate.transfer)) continue;
        all += candidate.probability;
        if (candidate.slopes_change_deg > kOtherSlopes_deg) other_slopes += candidate.probability;
        // sRGB and gammas near it differ by little; linear or not makes all the difference.
        if (is_linear(candidate.transfer) != is_linear(e.transfer)) other_colours += candidate.probability;
    }
    if (other_slopes > kOpen * all) e.doubt = open_choice(stack, e);
    if (std::max(other_slopes, other_colours) > kOpen * all) e.warning = open_choice(stack, e);
}

// A tone curve where it explains the photographs, and no gamma does.
std::optional<TransferEstimate::Candidate> tone_curve(const Stack& stack, const Survey& survey,
                                                      const std::vector<TransferTrial>& trials,
                                                      std::string& warning) {
    double single = std::numeric_limits<double>::max();
    for (const TransferTrial& trial : trials) single = std::min(single, trial.equal_residual);
    if (!(single > kCurveFits)) return std::nullopt;
    const Fitted gamma = best_gamma(stack, survey);
    single = std::min(single, gamma.residual);
    if (!(single > kCurveFits)) return std::nullopt;
    const Fitted curve = best_curve(stack, survey, gamma);
    if (!(curve.residual < kCurveFits && curve.residual * kBetterCurve < single)) return std::nullopt;
    warning = fmt::format(
        "{}: stored with a tone curve that is neither linear, sRGB nor a gamma; taken as '{}' (residual "
        "{:.4f}, the best of those {:.4f}). Photographs without such a curve (camera raw, linear TIFF) are "
        "more exact",
        stack.folder.string(), curve.transfer.name(), curve.residual, single);
    return TransferEstimate::Candidate{curve.transfer, curve.residual, 1, 0};
}

}  // namespace

bool speaks_against(const Transfer& stated, const TransferEstimate& estimated, const Stack& stack,
                    const Survey& survey) {
    std::vector<TransferTrial> both = {try_transfer(stack, survey, stated),
                                       try_transfer(stack, survey, estimated.transfer)};
    weigh(both, stack);
    return both[1].log_evidence - both[0].log_evidence > std::log(kBelievedCurve * kSureAgainst);
}

TransferEstimate estimate_transfer(const Stack& stack, const Survey& survey) {
    if (stack.development) return {Transfer{}, "developed, " + stack.development->encoding_source, {}, {}};
    if (stack.transfer) return {*stack.transfer, "given", {}, {}};
    if (stack.bits == 32) return {Transfer{}, "float file", {}, {}};
    TransferEstimate result{Transfer{}, "estimated", {}, {}};
    std::vector<TransferTrial> trials = trials_of(stack, survey);
    const bool unusual = add_unusual(trials, stack, survey);
    const std::size_t taken = unusual ? trials.size() - 1 : most_probable_usual(trials);
    result.transfer = trials[taken].transfer;
    for (const TransferTrial& trial : trials)
        result.candidates.push_back(
            {trial.transfer, trial.residual, trial.probability, slopes_change_deg(trial, trials[taken])});
    if (const auto curve = tone_curve(stack, survey, trials, result.warning)) {
        result.candidates.push_back(*curve);
        result.transfer = curve->transfer;
        return result;
    }
    if (!unusual) tell_of_open_choice(stack, result);
    return result;
}

}  // namespace tangi
