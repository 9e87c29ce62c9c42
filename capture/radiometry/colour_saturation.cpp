#include "capture/radiometry/colour_saturation.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "capture/stack/stack_calibration.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

namespace {

constexpr std::size_t kFewestOfSaturation = 4, kFewestColours = 40;
constexpr std::size_t kQuarters = 4;  // of the picture, rejected in turn
// [1] Scatter of ln ratios over the picture: below, it is nearly of one colour, and nothing is to be scaled.
constexpr double kLeastChroma = 0.05;
// [1] Metal, and light that comes off one paint onto another, change the ratios of real pictures from light
// to light: by 0.8 to 1.2 on paint, by up to 1.6 on bronze. What a program does and light does not is beyond
// this factor, either way, by more than four standard errors.
constexpr double kMostByLight = 2, kSaturationSigmas = 4;
constexpr int kSaturationRounds = 8;
constexpr double kTukey = 4.685, kMadToSigma = 1 / 0.6745;
constexpr double kLeastScatter = 0.5 / 255;  // [1] ln of light near full scale: rounding to 8 bits

using Unknowns = Eigen::Matrix<double, 5, 1>;  // of red and blue: light, veil; of both: scale less 1
using Normal = Eigen::Matrix<double, 5, 5>;

// What a sample says of a photograph in red or blue.
struct ScaleSay {
    Unknowns row;
    double off = 0;
    std::size_t part = 0;
};

// ln(red / green), ln(blue / green) and ln green.
glm::dvec3 ratios_to_green(const Rgb& v) {
    return {std::log(static_cast<double>(v.r / v.g)), std::log(static_cast<double>(v.b / v.g)),
            std::log(static_cast<double>(v.g))};
}

bool is_sample(const Rgb& v) { return v.r > 0 && v.g > 0 && v.b > 0; }  // false of NaN

// The median of what the photographs say of each sample; NaN where fewer than half do.
std::vector<glm::dvec3> usual_ratios(const ColourSamples& s) {
    const std::size_t samples = s.values.size() / s.photos;
    std::vector<glm::dvec3> usual(samples, glm::dvec3(std::nan("")));
    for (std::size_t k = 0; k < samples; ++k) {
        std::array<std::vector<double>, 3> told;
        for (std::size_t i = 0; i < s.photos; ++i)
            if (const Rgb& v = s.values[k * s.photos + i]; is_sample(v))
                for (int c = 0; c < 3; ++c)
                    told[static_cast<std::size_t>(c)].push_back(ratios_to_green(v)[c]);
        if (2 * told[0].size() > s.photos)
            usual[k] = {median(std::move(told[0])), median(std::move(told[1])), median(std::move(told[2]))};
    }
    return usual;
}

std::vector<ScaleSay> says_of_saturation(const ColourSamples& s, const std::vector<glm::dvec3>& usual,
                                         double green, std::size_t photo) {
    std::vector<ScaleSay> says;
    for (std::size_t k = 0; k < usual.size(); ++k) {
        const Rgb& v = s.values[k * s.photos + photo];
        if (std::isnan(usual[k].x) || !is_sample(v)) continue;
        const glm::dvec3 seen = ratios_to_green(v);
        for (int c = 0; c < 2; ++c) {
            ScaleSay say{Unknowns::Zero(), seen[c] - usual[k][c], static_cast<std::size_t>(s.part[k])};
            say.row[c] = 1;
            say.row[2 + c] =
                std::expm1(-usual[k][c]) * std::exp(green - usual[k].z);  // as in white_balances.cpp
            say.row[4] = usual[k][c];
            says.push_back(say);
        }
    }
    return says;
}

struct SaturationSums {
    Normal normal = Normal::Zero();
    Unknowns right = Unknowns::Zero();
    void add(const ScaleSay& say, double weight) {
        normal += weight * say.row * say.row.transpose();
        right += weight * say.off * say.row;
    }
    // A little is added where all pixels are neutral, or equally bright: nothing is changed then.
    Unknowns solution() const {
        return solve_symmetric(normal + 1e-9 * normal.trace() * Normal::Identity(), right).x;
    }
};

ColourSaturation saturation_of(const std::vector<ScaleSay>& says) {
    std::array<SaturationSums, kQuarters> parts;
    Unknowns x = Unknowns::Zero();
    double scatter = 0;  // none yet: all count
    std::vector<double> rests(says.size());
    for (int round = 0; round < kSaturationRounds; ++round) {
        parts = {};
        for (std::size_t i = 0; i < says.size(); ++i) {
            const double u = scatter > 0 ? rests[i] / (kTukey * scatter) : 0;
            if (std::abs(u) < 1) parts[says[i].part].add(says[i], (1 - u * u) * (1 - u * u));
        }
        SaturationSums all;
        for (const SaturationSums& part : parts) all.normal += part.normal, all.right += part.right;
        x = all.solution();
        std::vector<double> sizes;
        for (std::size_t i = 0; i < says.size(); ++i)
            sizes.push_back(std::abs(rests[i] = says[i].off - says[i].row.dot(x)));
        scatter = std::max(median(std::move(sizes)) * kMadToSigma, kLeastScatter);
    }
    double mean = 0, squares = 0;  // jackknife (Quenouille 1956)
    std::array<double, kQuarters> without{};
    for (std::size_t p = 0; p < kQuarters; ++p) {
        SaturationSums rest;
        for (std::size_t q = 0; q < kQuarters; ++q)
            if (q != p) rest.normal += parts[q].normal, rest.right += parts[q].right;
        without[p] = rest.solution()[4];
        mean += without[p] / kQuarters;
    }
    for (const double value : without) squares += (value - mean) * (value - mean);
    ColourSaturation result{1 + x[4], std::sqrt(squares * (kQuarters - 1) / kQuarters)};
    result.sigma = std::hypot(result.sigma, kLeastScatter);
    const double unsure = kSaturationSigmas * result.sigma;
    result.differs = result.scale + unsure < 1 / kMostByLight || result.scale - unsure > kMostByLight;
    return result;
}

double scatter_of_colours(const std::vector<glm::dvec3>& usual) {
    double widest = 0;
    for (int c = 0; c < 2; ++c) {
        std::vector<double> values;
        for (const glm::dvec3& pixel : usual)
            if (!std::isnan(pixel[c])) values.push_back(pixel[c]);
        if (values.size() < kFewestColours) return 0;
        const double middle = median(values);
        for (double& value : values) value = std::abs(value - middle);
        widest = std::max(widest, kMadToSigma * median(std::move(values)));
    }
    return widest;
}

}  // namespace

std::vector<ColourSaturation> colour_saturations(const ColourSamples& samples) {
    if (samples.photos < kFewestOfSaturation || samples.values.empty()) return {};
    const std::vector<glm::dvec3> usual = usual_ratios(samples);
    if (scatter_of_colours(usual) < kLeastChroma) return {};
    std::vector<double> greens;
    for (const glm::dvec3& pixel : usual)
        if (!std::isnan(pixel.z)) greens.push_back(pixel.z);
    const double green = median(std::move(greens));
    std::vector<ColourSaturation> result(samples.photos);
    parallel_for(0, static_cast<int>(samples.photos), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            const std::vector<ScaleSay> says = says_of_saturation(samples, usual, green, i);
            if (says.size() >= 2 * kFewestColours) result[i] = saturation_of(says);
        }
    });
    return result;
}

std::string warning_of(std::span<const ColourSaturation> photos, std::span<const std::string> names,
                       const std::string& where) {
    constexpr double grey = 0.1;  // [1] of the colours that are left
    std::vector<std::string> told;
    for (std::size_t i = 0; i < photos.size(); ++i)
        if (photos[i].differs)
            told.push_back(std::abs(photos[i].scale) < grey ? fmt::format("{} (grey)", names[i])
                                                            : fmt::format("{} (× {:.2f} ± {:.2f})", names[i],
                                                                          photos[i].scale, photos[i].sigma));
    if (told.empty()) return {};
    return fmt::format(
        "{}: {} of {} photographs have other colours than most, as if their saturation was changed or they "
        "were made grey: {}. This is not undone, and colours and gloss are wrong by it: convert all "
        "photographs alike, from the camera's files, or leave these out of the lights file",
        where, told.size(), photos.size(), joined(told));
}

}  // namespace tangi
