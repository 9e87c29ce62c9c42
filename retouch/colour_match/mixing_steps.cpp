#include "retouch/colour_match/mixing_steps.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"

namespace tangi {

namespace {

struct Ratio {
    int so_far, added;
};

std::vector<Ratio> ratios() {
    std::vector<Ratio> all;
    for (const int n : kMeasures) {
        all.push_back({n, 1});
        if (n > 1) all.push_back({1, n});
    }
    return all;
}

// One way to mix `count` paints: their order, the ratio of each step, and what comes out.
struct Way {
    std::array<signed char, kMostPaints> order{};
    std::array<signed char, kMostPaints> ratio{};  // [1..count-1], into ratios()
    std::array<float, kMostPaints> log_volume{};   // by the place in the mixture, not in the order
};

Way way_of(const std::array<int, kMostPaints>& order, int count, int number, const std::vector<Ratio>& all) {
    Way way;
    std::array<double, kMostPaints> volume{};
    volume[static_cast<std::size_t>(order[0])] = 1;
    for (int i = 0; i < count; ++i)
        way.order[static_cast<std::size_t>(i)] = static_cast<signed char>(order[static_cast<std::size_t>(i)]);
    for (int i = 1; i < count; ++i) {
        const int which = number % static_cast<int>(all.size());
        number /= static_cast<int>(all.size());
        const Ratio& ratio = all[static_cast<std::size_t>(which)];
        way.ratio[static_cast<std::size_t>(i)] = static_cast<signed char>(which);
        const double whole = ratio.so_far + ratio.added;
        for (double& v : volume) v *= ratio.so_far / whole;
        volume[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = ratio.added / whole;
    }
    for (int i = 0; i < count; ++i)
        way.log_volume[static_cast<std::size_t>(i)] =
            static_cast<float>(std::log(volume[static_cast<std::size_t>(i)]));
    return way;
}

std::vector<Way> ways_of(int count) {
    const std::vector<Ratio> all = ratios();
    std::vector<Way> ways;
    std::array<int, kMostPaints> order = {0, 1, 2, 3};
    do {
        if (order[0] > order[1]) continue;  // the first two are one step
        int total = 1;
        for (int i = 1; i < count; ++i) total *= static_cast<int>(all.size());
        for (int number = 0; number < total; ++number) ways.push_back(way_of(order, count, number, all));
    } while (std::next_permutation(order.begin(), order.begin() + count));
    return ways;
}

// 13 ways for two paints, 507 for three, 26364 for four.
const std::vector<Way>& ways(int count) {
    static const std::array<std::vector<Way>, kMostPaints + 1> all = {std::vector<Way>(), std::vector<Way>(),
                                                                      ways_of(2), ways_of(3), ways_of(4)};
    return all[static_cast<std::size_t>(count)];
}

std::vector<MixingStep> steps_of(const Way& way, const Mixture& mixture) {
    const std::vector<Ratio> all = ratios();
    std::vector<MixingStep> steps;
    for (int i = 0; i < mixture.count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const int paint = mixture.paints[static_cast<std::size_t>(way.order[at])];
        const Ratio ratio = i == 0 ? Ratio{0, 1} : all[static_cast<std::size_t>(way.ratio[at])];
        steps.push_back({paint, ratio.so_far, ratio.added});
    }
    return steps;
}

}  // namespace

std::vector<MeasuredMixture> measurable_near(const Mixture& ideal, const FilmMatch& match, std::size_t keep) {
    TP_REQUIRE(ideal.count >= 1 && ideal.count <= kMostPaints, "a mixture of a few paints");
    if (ideal.count == 1) return {{ideal, {{ideal.paints[0], 0, 1}}}};
    const auto curvature = match.curvature(ideal);
    std::array<float, kMostPaints> log_ideal{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(ideal.count); ++i)
        log_ideal[i] = static_cast<float>(std::log(std::max(ideal.volumes[i], 1e-9)));
    const std::vector<Way>& all = ways(ideal.count);
    std::vector<std::pair<float, std::uint32_t>> ranked(all.size());
    for (std::size_t w = 0; w < all.size(); ++w) {
        std::array<float, kMostPaints> off{};
        for (std::size_t i = 0; i < kMostPaints; ++i) off[i] = all[w].log_volume[i] - log_ideal[i];
        float sum = 0;
        for (std::size_t i = 0; i < kMostPaints; ++i)
            for (std::size_t j = 0; j < kMostPaints; ++j)
                sum += static_cast<float>(curvature[i * kMostPaints + j]) * off[i] * off[j];
        ranked[w] = {sum, static_cast<std::uint32_t>(w)};
    }
    const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(std::min(keep, ranked.size()));
    std::partial_sort(ranked.begin(), end, ranked.end());
    std::vector<MeasuredMixture> result;
    for (auto it = ranked.begin(); it != end; ++it) {
        const auto steps = steps_of(all[it->second], ideal);
        result.push_back({mixture_of(steps), steps});
    }
    return result;
}

Mixture mixture_of(const std::vector<MixingStep>& steps) {
    TP_REQUIRE(!steps.empty() && steps.size() <= kMostPaints, "a mixture of a few paints");
    Mixture m;
    for (const MixingStep& step : steps) {
        const double whole = step.so_far + step.added;
        for (double& v : m.volumes) v *= step.so_far / whole;
        const auto at = static_cast<std::size_t>(m.count++);
        m.paints[at] = step.paint;
        m.volumes[at] = step.added / whole;
    }
    return m;
}

std::string text_of(const std::vector<MixingStep>& steps, const std::vector<Pigment>& paints) {
    std::string text;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const std::string& name = paints[static_cast<std::size_t>(steps[i].paint)].name;
        if (i == 0)
            text = steps.size() > 1 ? fmt::format("{} {}", steps[1].so_far, name) : name;
        else
            text += fmt::format("{}{} {}", i == 1 ? " + " : fmt::format("; {} of it + ", steps[i].so_far),
                                steps[i].added, name);
    }
    return text;
}

}  // namespace tangi
