#include "capture/transfer_estimate.h"

#include <algorithm>
#include <cmath>

#include "capture/photometric_stereo.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kSamples = 1500;  // enough: the choice is between a handful of curves

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

PixelSamples linearised(const Stack& stack, const Survey& survey, int sample, const Transfer& transfer) {
    PixelSamples s;
    const int photos = static_cast<int>(stack.photos.size());
    s.resize(photos, 1);
    const float* value = survey.sample(sample);
    for (int i = 0; i < photos; ++i) {
        const auto at = static_cast<std::size_t>(i);
        double sum = 0;
        float highest = 0;
        for (int c = 0; c < survey.channels; ++c) {
            sum += transfer.decode(value[i * survey.channels + c]);
            highest = std::max(highest, value[i * survey.channels + c]);
        }
        s.light[at] = stack.photos[at].light.direction;
        s.irradiance[at] = 1;
        s.value[at] = sum / survey.channels;
        s.sigma[at] = highest < kClipped ? 1 : 0;
    }
    return s;
}

// Median deviation from robust matt reflection, in the stored encoding.
double residual_of(const Stack& stack, const Survey& survey, const Transfer& transfer) {
    const int step = std::max(1, survey.sample_count() / kSamples);
    const int used = (survey.sample_count() + step - 1) / step;
    std::vector<std::vector<double>> deviations(static_cast<std::size_t>(used));
    parallel_for(0, used, 16, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) {
            const PixelSamples s = linearised(stack, survey, k * step, transfer);
            const LambertEstimate e = photometric_stereo(s);
            if (!e.valid) continue;
            for (std::size_t i = 0; i < s.light.size(); ++i) {
                const double cosine = glm::dot(e.normal, s.light[i]);
                if (!(s.sigma[i] > 0) || cosine < 0.1) continue;
                const double model = transfer.encode(static_cast<float>(e.diffuse[0] * cosine));
                deviations[static_cast<std::size_t>(k)].push_back(
                    std::abs(model - transfer.encode(static_cast<float>(s.value[i]))));
            }
        }
    });
    std::vector<double> all;
    for (const auto& some : deviations) all.insert(all.end(), some.begin(), some.end());
    return median(std::move(all));
}

}  // namespace

TransferEstimate estimate_transfer(const Stack& stack, const Survey& survey) {
    if (stack.transfer) return {*stack.transfer, "given", {}};
    if (stack.bits == 32) return {Transfer{}, "float file", {}};
    TransferEstimate result{Transfer{}, "estimated", {}};
    for (const Transfer& transfer : {Transfer{Transfer::Kind::linear}, Transfer{Transfer::Kind::srgb},
                                     Transfer{Transfer::Kind::gamma, 2.2}})
        result.candidates.push_back({transfer, residual_of(stack, survey, transfer)});
    result.transfer = std::min_element(result.candidates.begin(), result.candidates.end(),
                                       [](const auto& a, const auto& b) { return a.residual < b.residual; })
                          ->transfer;
    return result;
}

}  // namespace tangi
