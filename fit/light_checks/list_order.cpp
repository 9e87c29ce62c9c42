#include "fit/light_checks/list_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>
#include <random>

#include "capture/radiometry/matt_sample.h"
#include "fit/light_checks/light_outliers.h"
#include "surface/base/log_ratio.h"
#include "surface/base/parallel.h"
#include "surface/maps/light.h"

namespace tangi {

namespace {

constexpr std::size_t kFewestListed = 8;
constexpr std::size_t kMostScreened = 16;  // orders that pixels are fitted with, of those that shading allows
constexpr int kDeals = 99;                 // random orders
constexpr int kOrderRounds = 2;            // of the lights' strengths, which may differ
constexpr int kScreened = 500, kLookedAt = 4000;  // samples to look for orders with, and to judge them by
constexpr std::size_t kMostJudged = 3;            // orders
constexpr double kMostDeviation = 8;  // times the median one, beyond which a deviation counts no more
constexpr int kOrderParts = 8;        // of the picture, along each side
constexpr double kFewestOfParts = 16;
constexpr double kSureOfTurned = 3;  // [standard errors]
// cos 5 degrees: what the best lists of directions are off by, so that none tells such an order from a turn.
constexpr double kSameAsTurn = 0.996;

std::vector<Light> in_order(const std::vector<Light>& lights, const ListOrdering& order) {
    std::vector<Light> result = lights;
    for (std::size_t i = 0; i < lights.size(); ++i) result[i].direction = lights[order[i]].direction;
    return result;
}

// What an order does to all lights on the whole: the turn, with y mirrored or not, that takes their x and y
// nearest to those of the order (Procrustes).
void find_turn(const std::vector<Light>& lights, ListOrder::Other& other) {
    std::complex<double> turned = 0, mirrored = 0;
    double squares = 0;
    const auto plane = [&](std::size_t i) {
        return std::complex<double>(static_cast<double>(lights[i].direction.x),
                                    static_cast<double>(lights[i].direction.y));
    };
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::complex<double> to = plane(other.light_of[i]);
        turned += std::conj(plane(i)) * to;
        mirrored += plane(i) * to;
        squares += std::norm(plane(i));
    }
    const bool is_mirrored = std::abs(mirrored) > std::abs(turned);
    const std::complex<double> best = is_mirrored ? mirrored : turned;
    const double degrees = std::arg(best) * kDegrees;
    other.turn = {is_mirrored, degrees < 0 ? degrees + 360 : degrees};
    other.alike = squares > 0 ? std::abs(best) / squares : 0;
}

// The samples of one survey, and how orders of one list explain them.
class OrderTrial {
public:
    OrderTrial(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights, int width,
               int height, int samples)
        : survey_(survey),
          transfer_(transfer),
          lights_(lights),
          width_(width),
          height_(height),
          samples_(samples) {
        const MattSample listed = sample_of(lights);
        most_ = kMostDeviation * std::max(listed.residual(), 1e-6);
        index_ = listed.index;
        listed_ = listed.mean_deviations(most_);
    }

    double listed() const { return mean(listed_); }
    double of(const ListOrdering& order) const { return mean(deviations(order)); }

    // [deg] Of the lights that photographs show about those in this order.
    double scatter_deg(const ListOrdering& order) const {
        std::vector<Light> lights = in_order(lights_, order);
        const MattSample sample = sample_of(lights);
        for (std::size_t i = 0; i < lights.size(); ++i)
            lights[i].gain = Rgb(static_cast<float>(std::exp(sample.log_strengths[i])));
        return light_outliers(survey_, transfer_, lights, width_, height_).scatter_deg;
    }

    void judge(ListOrder::Other& other) const {
        const std::vector<double> here = deviations(other.light_of);
        std::vector<std::array<double, 3>> parts(kOrderParts * kOrderParts, {0, 0, 0});
        for (std::size_t k = 0; k < here.size(); ++k) {
            if (std::isnan(here[k]) || std::isnan(listed_[k])) continue;
            const glm::ivec2 at = survey_.positions[static_cast<std::size_t>(index_[k])];
            auto& part = parts[static_cast<std::size_t>(at.y * kOrderParts / height_ * kOrderParts +
                                                        at.x * kOrderParts / width_)];
            part[0] += here[k], part[1] += listed_[k], part[2] += 1;
        }
        LogRatio ratio;
        for (const auto& [ordered, as_listed, count] : parts)
            if (count > 0) ratio.add(ordered, as_listed);
        if (ratio.count() < kFewestOfParts) return;
        other.log_ratio = ratio.mean();
        other.certainty = ratio.certainty();
    }

private:
    MattSample sample_of(const std::vector<Light>& lights) const {
        return matt_sample(lights, {survey_, transfer_, width_, height_}, samples_, kOrderRounds);
    }
    std::vector<double> deviations(const ListOrdering& order) const {
        return sample_of(in_order(lights_, order)).mean_deviations(most_);
    }
    static double mean(const std::vector<double>& values) {
        double sum = 0, count = 0;
        for (const double value : values)
            if (!std::isnan(value)) sum += value, ++count;
        return count > 0 ? sum / count : 0;
    }

    const Survey& survey_;
    const Transfer& transfer_;
    const std::vector<Light>& lights_;
    int width_, height_, samples_;
    double most_ = 0;
    std::vector<int> index_;
    std::vector<double> listed_;
};

struct Screened {
    ListSlip slip;
    bool by_lines;
    ListOrdering light_of;
    double explained;
    double deviation = 0;
};

// Those that explain more than the list as it is, the best first.
std::vector<Screened> screen(const ShadingChanges& changes, const std::vector<Light>& lights,
                             const ListOrdering& by_name, const ListOrdering& by_line, double as_listed) {
    std::vector<Screened> found;
    for (const ListSlip& slip : list_slips(lights.size())) {
        found.push_back({slip, false, ordering_of(slip, by_name, lights), 0});
        if (by_line != by_name) found.push_back({slip, true, ordering_of(slip, by_line, lights), 0});
    }
    parallel_for(0, static_cast<int>(found.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            found[i].explained = changes.explained(lights, found[i].light_of);
    });
    std::erase_if(found, [&](const Screened& s) { return s.explained <= as_listed; });
    std::stable_sort(found.begin(), found.end(),
                     [](const Screened& a, const Screened& b) { return a.explained > b.explained; });
    // Two slips may be one order.
    std::vector<Screened> different;
    for (Screened& s : found)
        if (different.size() < kMostScreened &&
            std::none_of(different.begin(), different.end(),
                         [&](const Screened& d) { return d.light_of == s.light_of; }))
            different.push_back(std::move(s));
    return different;
}

// How much more has to go wrong for an order: of those that shading cannot tell apart, the least is told.
int complexity(const ListOrder::Other& other) {
    return (other.slip.reversed && other.slip.shift != 0 ? 2 : 0) + (other.slip.from > 0 ? 1 : 0) +
           (other.slip.shift != 0 && !other.slip.reversed ? 1 : 0) + (other.slip.row > 0 ? 1 : 0);
}

// The simplest first.
std::vector<ListOrder::Other> orders_like_turns(const std::vector<Light>& lights,
                                                const ListOrdering& by_name) {
    std::vector<ListOrder::Other> found;
    for (const ListSlip& slip : list_slips(lights.size())) {
        ListOrder::Other other{.light_of = ordering_of(slip, by_name, lights), .slip = slip, .turn = {}};
        if (other.light_of == by_name) continue;
        find_turn(lights, other);
        if (other.alike > kSameAsTurn) found.push_back(std::move(other));
    }
    std::stable_sort(found.begin(), found.end(), [](const ListOrder::Other& a, const ListOrder::Other& b) {
        return complexity(a) < complexity(b);
    });
    return found;
}

// What random orders of the list explain.
void deal(const ShadingChanges& changes, const std::vector<Light>& lights, ListOrdering order,
          ListOrder& result) {
    std::mt19937 random(1);
    for (int trial = 0; trial < kDeals; ++trial) {
        for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random() % (i + 1)]);
        const double explained = changes.explained(lights, order);
        result.by_chance += explained / kDeals;
        result.most_by_chance = std::max(result.most_by_chance, explained);
    }
}

// The best first; of those whose deviations are the same within the error of the best, the simplest.
void sort_by_fit(std::vector<ListOrder::Other>& better) {
    if (better.empty()) return;
    const auto by_ratio = [](const ListOrder::Other& a, const ListOrder::Other& b) {
        return a.log_ratio < b.log_ratio;
    };
    std::stable_sort(better.begin(), better.end(), by_ratio);
    const double limit = better[0].log_ratio + std::abs(better[0].log_ratio) / better[0].certainty;
    const auto tied = std::find_if(better.begin(), better.end(),
                                   [&](const ListOrder::Other& o) { return o.log_ratio > limit; });
    std::stable_sort(better.begin(), tied, [](const ListOrder::Other& a, const ListOrder::Other& b) {
        return complexity(a) < complexity(b);
    });
}

}  // namespace

ListOrder check_list_order(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights,
                           const std::vector<int>& lines, int width, int height) {
    ListOrder result;
    if (lights.size() < kFewestListed) return result;
    ListOrdering by_name(lights.size());
    std::iota(by_name.begin(), by_name.end(), std::size_t{0});
    ListOrdering by_line = by_name;
    std::stable_sort(by_line.begin(), by_line.end(),
                     [&](std::size_t a, std::size_t b) { return lines[a] < lines[b]; });
    const ShadingChanges changes(survey, transfer);
    result.explained = changes.explained(lights, by_name);
    result.explainable = changes.by_any_three();
    deal(changes, lights, by_name, result);
    result.as_turns = orders_like_turns(lights, by_name);
    std::vector<Screened> found = screen(changes, lights, by_name, by_line, result.explained);
    if (found.empty()) return result;
    const OrderTrial few(survey, transfer, lights, width, height, kScreened);
    parallel_for(0, static_cast<int>(found.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            found[i].deviation = few.of(found[i].light_of);
    });
    std::erase_if(found, [&](const Screened& s) { return s.deviation >= few.listed(); });
    std::stable_sort(found.begin(), found.end(),
                     [](const Screened& a, const Screened& b) { return a.deviation < b.deviation; });
    found.resize(std::min(found.size(), kMostJudged));
    const OrderTrial many(survey, transfer, lights, width, height, kLookedAt);
    for (const Screened& s : found) {
        ListOrder::Other other{.light_of = s.light_of, .slip = s.slip, .by_lines = s.by_lines, .turn = {}};
        if (s.slip.from > 0) other.from = (s.by_lines ? by_line : by_name)[s.slip.from];
        find_turn(lights, other);
        many.judge(other);
        if (!(other.log_ratio < 0 && other.certainty > kSureOfTurned)) continue;
        other.scatter_deg = many.scatter_deg(other.light_of);
        other.explained = s.explained;
        result.better.push_back(std::move(other));
    }
    if (!result.better.empty()) result.scatter_deg = many.scatter_deg(by_name);
    sort_by_fit(result.better);
    return result;
}

ListOrder check_list_order(const Survey& survey, const Transfer& transfer, const Stack& stack) {
    std::vector<int> lines;
    for (const StackPhoto& photo : stack.photos) lines.push_back(photo.number);
    return check_list_order(survey, transfer, stack.lights(), lines, stack.width(), stack.height());
}

}  // namespace tangi
