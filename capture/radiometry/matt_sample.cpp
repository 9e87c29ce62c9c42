#include "capture/radiometry/matt_sample.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

constexpr double kLowestCosine = 0.25;  // [1] below 15 degrees shadows and interreflection rule
constexpr double kRatioScale = 0.1;     // [1] ln ratio from which on a pixel counts less
constexpr float kNoDeviation = std::numeric_limits<float>::quiet_NaN();

PixelSamples linearised(const std::vector<Light>& lights, const LinearSurvey& linear, int sample) {
    const auto& [survey, transfer, width, height] = linear;
    PixelSamples s;
    const int photos = static_cast<int>(lights.size());
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
        s.light[at] = lights[at].direction;
        s.irradiance[at] = 1;
        s.value[at] = sum / survey.channels;
        s.sigma[at] = highest < kClipped && measured ? 1 : 0;
    }
    return s;
}

// [1] what a matt surface should show; 0 where it would be in shadow, or nothing is known.
double predicted(const MattSample& sample, std::size_t k, std::size_t photo) {
    if (!sample.estimates[k].valid || !(sample.pixels[k].sigma[photo] > 0)) return 0;
    const double cosine = glm::dot(sample.estimates[k].normal, sample.pixels[k].light[photo]);
    return cosine < kLowestCosine ? 0 : sample.estimates[k].diffuse[0] * cosine;
}

// ln of how much more light there is in one photograph than it should be, as a plane over the picture: what
// lights of other strength, and near ones, do. Robust (Cauchy): shadows and highlights are no lights.
class IlluminationPlane {
public:
    IlluminationPlane(const MattSample& sample, std::size_t photo, const LinearSurvey& linear)
        : survey_(linear.survey),
          centre_(linear.width / 2.0, linear.height / 2.0),
          scale_(1.0 / std::max(linear.width, linear.height)) {
        std::vector<double> ratios;
        std::vector<glm::dvec3> terms;
        for (std::size_t k = 0; k < sample.index.size(); ++k) {
            const double matt = predicted(sample, k, photo);
            if (!(matt > 1e-6)) continue;
            ratios.push_back(std::log(std::max(sample.pixels[k].value[photo] / matt, 1e-3)));
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
    double at_centre() const { return plane_.x; }

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

// Surfaces, under the lights as they were found. A weak light counts as much as a strong one: were its light
// weighed by its strength, a light that is taken for weak by mistake would have no say in that.
void find_surfaces(MattSample& sample) {
    // What all lights share is the paint's.
    const double common = std::exp(median(sample.log_strengths));
    parallel_for(0, static_cast<int>(sample.index.size()), 16, [&](int begin, int end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k) {
            PixelSamples alike = sample.pixels[k];
            for (std::size_t photo = 0; photo < alike.value.size(); ++photo)
                alike.value[photo] *= common / sample.factors[photo][k];
            sample.estimates[k] = photometric_stereo(alike);
        }
    });
}

// Lights, with the surfaces as they were found, and what is left.
void find_lights(MattSample& sample, const LinearSurvey& linear) {
    const Transfer& transfer = linear.transfer;
    const std::size_t photos = sample.log_strengths.size();
    parallel_for(0, static_cast<int>(photos), 1, [&](int begin, int end) {
        for (auto photo = static_cast<std::size_t>(begin); photo < static_cast<std::size_t>(end); ++photo) {
            const IlluminationPlane plane(sample, photo, linear);
            sample.log_strengths[photo] = plane.at_centre();
            for (std::size_t k = 0; k < sample.index.size(); ++k) {
                float& deviation = sample.deviations[photo][k];
                deviation = kNoDeviation;
                const double matt = predicted(sample, k, photo), factor = plane.factor(sample.index[k]);
                if (matt > 0)
                    deviation = std::abs(transfer.encode(static_cast<float>(matt * factor)) -
                                         transfer.encode(static_cast<float>(sample.pixels[k].value[photo])));
                sample.factors[photo][k] = factor;
            }
        }
    });
}

}  // namespace

double MattSample::residual(const std::optional<Left>& without) const {
    std::vector<float> known;
    for (std::size_t photo = 0; photo < deviations.size(); ++photo) {
        if (without && photo % without->step == without->first) continue;
        for (const float deviation : deviations[photo])
            if (!std::isnan(deviation)) known.push_back(deviation);
    }
    return static_cast<double>(median(std::move(known)));
}

std::vector<double> MattSample::mean_deviations(double most) const {
    std::vector<double> means;
    for (std::size_t k = 0; k < index.size(); ++k) {
        double sum = 0, count = 0;
        for (const std::vector<float>& of_photo : deviations) {
            if (std::isnan(of_photo[k])) continue;
            sum += std::min(static_cast<double>(of_photo[k]), most);
            ++count;
        }
        means.push_back(count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN());
    }
    return means;
}

MattSample matt_sample(const std::vector<Light>& lights, const LinearSurvey& linear, int wanted, int rounds) {
    MattSample sample;
    sample.index = linear.survey.spread(wanted);
    sample.pixels.resize(sample.index.size());
    sample.estimates.resize(sample.index.size());
    parallel_for(0, static_cast<int>(sample.index.size()), 16, [&](int begin, int end) {
        for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
            sample.pixels[k] = linearised(lights, linear, sample.index[k]);
    });
    sample.log_strengths.assign(lights.size(), 0);
    sample.deviations.assign(lights.size(), std::vector<float>(sample.index.size(), kNoDeviation));
    sample.factors.assign(lights.size(), std::vector<double>(sample.index.size(), 1));
    find_surfaces(sample);
    find_lights(sample, linear);
    for (int round = 1; round < rounds; ++round) refine(sample, linear);
    return sample;
}

void refine(MattSample& sample, const LinearSurvey& linear) {
    find_surfaces(sample);
    find_lights(sample, linear);
}

}  // namespace tangi
