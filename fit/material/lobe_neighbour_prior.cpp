#include "fit/material/lobe_neighbour_prior.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

constexpr int kStep = 2;                  // [pixels] between neighbours that are asked
constexpr float kColour = 0.15f;          // [1] difference, relative to the brightness, of another material
constexpr float kColourFloor = 0.02f;     // [1] ... and what noise makes of dark colours
constexpr float kLnAlphaSpread = 0.15f;   // [1] within one material, at least
constexpr float kSpecularSpread = 0.01f;  // [1] likewise
constexpr float kSpecularPart = 0.1f;     // [1] of rho_s, likewise
constexpr float kToldNothing = 0.98f;  // [1] of the prior's variance that is left: photographs told nothing

// What the photographs of a pixel say of a number of its lobe, by itself; weight: 1 / variance, 0 where
// nothing.
struct Told {
    float value = 0, weight = 0;
};

// From what the fit left, `value` with `error`, the prior that it was fitted with is taken off again. Else
// neighbours that know little, and were all drawn to the same prior, would together bear witness to it.
Told told(float value, float error, float prior, float prior_sigma, float spread2) {
    const float variance = square(error), prior_variance = square(prior_sigma);
    if (!(variance < kToldNothing * prior_variance)) return {};
    const float left = 1 / (prior_variance - variance);
    return {(value * prior_variance - prior * variance) * left,
            1 / (variance * prior_variance * left + spread2)};
}

// [1] alpha from which on a lobe is so wide that it may stand in for matt reflection, and where all of it
// may.
constexpr float kWide = 0.3f, kAllWide = 0.45f;

// Part of a lobe that may stand in for matt reflection.
float wide_part(float alpha) { return std::clamp((alpha - kWide) / (kAllWide - kWide), 0.0f, 1.0f); }

// What pixels of a row say, with columns beyond both ends that say nothing: the loops over neighbours have no
// special cases and can be vectorised.
struct Row {
    std::vector<float> red, green, blue;  // of rho_d
    std::vector<float> wide;              // rho_s, as far as it may stand in for that
    std::vector<float> ln_alpha, ln_alpha_weight, specular, specular_weight;

    Row() = default;
    Row(const Surface& s, const FitErrors& errors, const WardPrior& general, int y) {
        const auto middle = static_cast<float>(general.ln_alpha),
                   rho_middle = static_cast<float>(general.specular);
        const auto sigma = static_cast<float>(general.ln_alpha_sigma),
                   rho_sigma = static_cast<float>(general.specular_sigma);
        const auto size = static_cast<std::size_t>(s.width() + 2 * kLobeReach);
        for (std::vector<float>* values :
             {&red, &green, &blue, &wide, &ln_alpha, &ln_alpha_weight, &specular, &specular_weight})
            values->assign(size, 0.0f);
        for (int x = 0; x < s.width(); ++x) {
            const auto at = static_cast<std::size_t>(x + kLobeReach);
            const Rgb& colour = s.diffuse(x, y);
            red[at] = colour.r;
            green[at] = colour.g;
            blue[at] = colour.b;
            if (!(s.confidence(x, y) > 0)) continue;
            const float alpha = s.roughness(x, y), rho = s.specular(x, y);
            wide[at] = wide_part(alpha) * rho;
            const Told width =
                told(std::log(alpha), errors.roughness(x, y) / alpha, middle, sigma, square(kLnAlphaSpread));
            ln_alpha[at] = width.value;
            ln_alpha_weight[at] = width.weight;
            const Told strength = told(rho, errors.specular(x, y), rho_middle, rho_sigma,
                                       square(kSpecularSpread) + square(kSpecularPart * rho));
            specular[at] = strength.value;
            specular_weight[at] = strength.weight;
        }
    }
};

// Weighted sums of what neighbours have, for each pixel of a row.
struct Moments {
    std::vector<float> weight, sum, squares;
    std::vector<float> count;  // [neighbours] that say something, as far as they are alike
    // Starts with one pseudo-neighbour.
    Moments(std::size_t size, double value, double sigma)
        : weight(size, static_cast<float>(1 / (sigma * sigma))),
          sum(size, static_cast<float>(value / (sigma * sigma))),
          squares(size, static_cast<float>(value * value / (sigma * sigma))),
          count(size, 1.0f) {}
    float mean(std::size_t i) const { return sum[i] / weight[i]; }
    // Of the mean, and by how much neighbours differ beyond what their errors explain (DerSimonian & Laird
    // 1986, "Meta-analysis in clinical trials"): weighted squares of errors alone would add up to the count.
    float variance(std::size_t i) const {
        const float differ = squares[i] - square(sum[i]) / weight[i];
        return (1 + std::max(differ - count[i], 0.0f)) / weight[i];
    }
};

// 1 / distance^2 at which another colour is another material, of each pixel of a row: by rho_d, and by rho_d
// with wide lobes.
struct InverseScales2 {
    std::vector<float> matt, both;
    InverseScales2(const Row& row, std::size_t width) : matt(width), both(width) {
        const auto of = [](float brightness) {
            return 1 / (3 * square(2 * (kColour * brightness + kColourFloor)));
        };
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t at = x + kLobeReach;
            const float brightness = (row.red[at] + row.green[at] + row.blue[at]) / 3;
            matt[x] = of(brightness);
            both[x] = of(brightness + row.wide[at]);
        }
    }
};

// Adds what a neighbour says of a number of the lobe of pixel i, as far as it is `alike`.
TP_INLINE void add_told(float alike, float value, float weight, int i, float* __restrict weights,
                        float* __restrict sums, float* __restrict squares, float* __restrict counts) {
    const float w = alike * weight;
    weights[i] += w;
    sums[i] += w * value;
    squares[i] += w * value * value;
    counts[i] += weight > 0 ? alike : 0.0f;
}

// Adds what `row` has `shift` columns to the right of each pixel of `own`. How alike two colours are falls
// from 1 to 0 by Tukey's biweight, which near 1 is a Gaussian. Pixels of one material have rho_d in common,
// or, where the fit took a wide lobe of some for a part of it, both together.
TP_VECTOR_CLONES
void add_neighbours(const Row& own, const Row& row, int shift, const InverseScales2& scales,
                    Moments& ln_alpha, Moments& specular) {
    const int size = static_cast<int>(scales.matt.size());
    const std::ptrdiff_t here = kLobeReach, at = kLobeReach + shift;
    const float *r = own.red.data() + here, *g = own.green.data() + here, *b = own.blue.data() + here;
    const float *nr = row.red.data() + at, *ng = row.green.data() + at, *nb = row.blue.data() + at;
    const float *wide = own.wide.data() + here, *n_wide = row.wide.data() + at;
    const float *a = row.ln_alpha.data() + at, *a_weight = row.ln_alpha_weight.data() + at;
    const float *s = row.specular.data() + at, *s_weight = row.specular_weight.data() + at;
    const float *matt_scale = scales.matt.data(), *both_scale = scales.both.data();
    float *__restrict aw = ln_alpha.weight.data(), *__restrict as = ln_alpha.sum.data(),
          *__restrict aq = ln_alpha.squares.data(), *__restrict an = ln_alpha.count.data();
    float *__restrict sw = specular.weight.data(), *__restrict ss = specular.sum.data(),
          *__restrict sq = specular.squares.data(), *__restrict sn = specular.count.data();
    for (int i = 0; i < size; ++i) {
        const float red = nr[i] - r[i], green = ng[i] - g[i], blue = nb[i] - b[i];
        const float more = n_wide[i] - wide[i];
        const float by_matt = red * red + green * green + blue * blue;
        const float by_both = by_matt + more * (3 * more + 2 * (red + green + blue));
        const float distance2 = std::min(by_matt * matt_scale[i], by_both * both_scale[i]);
        const float near = std::max(1 - distance2, 0.0f), alike = near * near;
        add_told(alike, a[i], a_weight[i], i, aw, as, aq, an);
        add_told(alike, s[i], s_weight[i], i, sw, ss, sq, sn);
    }
}

}  // namespace

void LobePriors::advance(int y0, int y1) {
    TP_REQUIRE(y0 >= first_ && y0 <= end_ && y0 <= y1 && y1 <= surface_.height(), "rows in their order");
    const auto width = static_cast<std::size_t>(surface_.width());
    const auto offset_of = [&](int y) { return static_cast<std::size_t>(y - first_) * width; };
    priors_.erase(priors_.begin(), priors_.begin() + static_cast<std::ptrdiff_t>(offset_of(y0)));
    first_ = y0;
    // Rows whose neighbours are about to be overwritten have to be found before.
    const int begin = end_;
    end_ = std::max(end_, std::min(y1 + kLobeReach, surface_.height()));
    priors_.resize(offset_of(end_));
    const int top = std::max(begin - kLobeReach, 0), bottom = std::min(end_ + kLobeReach, surface_.height());
    std::vector<Row> rows(static_cast<std::size_t>(bottom - top));
    parallel_for(top, bottom, 16, [&](int from, int to) {
        for (int y = from; y < to; ++y)
            rows[static_cast<std::size_t>(y - top)] = Row(surface_, errors_, general_, y);
    });
    parallel_for(begin, end_, 4, [&](int from, int to) {
        for (int y = from; y < to; ++y) {
            const Row& own = rows[static_cast<std::size_t>(y - top)];
            const InverseScales2 scales(own, width);
            Moments ln_alpha(width, general_.ln_alpha, general_.ln_alpha_sigma),
                specular(width, general_.specular, general_.specular_sigma);
            for (int v = y - kLobeReach; v <= y + kLobeReach; v += kStep) {
                if (v < 0 || v >= surface_.height()) continue;
                for (int shift = -kLobeReach; shift <= kLobeReach; shift += kStep)
                    if (v != y || shift != 0)
                        add_neighbours(own, rows[static_cast<std::size_t>(v - top)], shift, scales, ln_alpha,
                                       specular);
            }
            Prior* prior = &priors_[offset_of(y)];
            for (std::size_t x = 0; x < width; ++x)
                prior[x] = {ln_alpha.mean(x), std::sqrt(ln_alpha.variance(x) + square(kLnAlphaSpread)),
                            specular.mean(x),
                            std::sqrt(specular.variance(x) + square(kSpecularSpread) +
                                      square(kSpecularPart * specular.mean(x)))};
        }
    });
}

WardPrior LobePriors::at(int x, int y) const {
    TP_REQUIRE(y >= first_ && y < end_, "a row that is known");
    const Prior& p =
        priors_[static_cast<std::size_t>(y - first_) * static_cast<std::size_t>(surface_.width()) +
                static_cast<std::size_t>(x)];
    return {p.ln_alpha, p.ln_alpha_sigma, p.specular, p.specular_sigma};
}

}  // namespace tangi
