#include "capture/radiometry/developed_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "capture/photo/exposure_merge.h"
#include "capture/stack/photo_source.h"
#include "surface/base/error.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr int kSampledRows = 64;    // at a time
constexpr int kPhotosLookedAt = 5;  // photographs that checks and brackets read

// A grid of pixels of one file as the development makes them so far, mean of the channels; NaN where clipped.
std::vector<float> sample_of(const Stack& stack, const fs::path& file, const Light& light) {
    PhotoSource source(stack, {file, light, 0, {}, {{file, 1.0}}});
    const PhotoHeader& header = source.header();
    const auto channels = static_cast<std::size_t>(header.channels);
    // The frames and exposures are those of the photographs, whatever picture is made of them.
    const Region part = stack.geometry ? Region{0, 0, header.width, header.height} : stack.crop;
    const std::size_t row = static_cast<std::size_t>(header.width) * channels;
    const int step =
        std::max(1, static_cast<int>(std::sqrt(static_cast<double>(part.width()) * part.height() / 20000)));
    std::vector<float> rows, sample;
    for (int y0 = 0; y0 < part.y1; y0 += kSampledRows) {
        const int y1 = std::min(y0 + kSampledRows, header.height);
        rows.resize(row * static_cast<std::size_t>(y1 - y0));
        source.read_rows(y0, y1, rows);
        for (int y = std::max(y0, part.y0); y < std::min(y1, part.y1); ++y)
            for (int x = part.x0; x < part.x1; x += step) {
                if ((y - part.y0) % step != 0) break;
                const float* value =
                    &rows[row * static_cast<std::size_t>(y - y0) + static_cast<std::size_t>(x) * channels];
                float sum = 0;
                for (std::size_t c = 0; c < channels; ++c)
                    sum += value[c] < stack.development->sensor_clipped
                               ? value[c]
                               : std::numeric_limits<float>::quiet_NaN();
                sample.push_back(sum / static_cast<float>(channels));
            }
    }
    return sample;
}

// Mean over what is not clipped; clipped pixels count as full scale.
double mean_of(const std::vector<float>& sample) {
    double sum = 0;
    for (const float value : sample) sum += std::isnan(value) ? 1.0 : static_cast<double>(value);
    return sample.empty() ? 0 : sum / static_cast<double>(sample.size());
}

// Photographs to look at, spread over the stack.
std::vector<const StackPhoto*> some_photos(const Stack& stack) {
    std::vector<const StackPhoto*> some;
    const std::size_t count = stack.photos.size(), wanted = std::min<std::size_t>(count, kPhotosLookedAt);
    for (std::size_t i = 0; i < wanted; ++i) some.push_back(&stack.photos[i * count / wanted]);
    return some;
}

// All settings of brackets, relative to the reference exposure, ascending.
std::vector<double> settings_of(Stack& stack) {
    std::set<double> distinct;
    for (StackPhoto* photo : all_photos(stack))
        for (const Exposure& exposure : photo->exposures) distinct.insert(exposure.relative);
    return {distinct.begin(), distinct.end()};
}

std::size_t index_of(double relative, const std::vector<double>& settings) {
    return static_cast<std::size_t>(std::lower_bound(settings.begin(), settings.end(), relative) -
                                    settings.begin());
}

// Pixels of a few photographs, at each setting and the next lower one.
std::vector<ExposurePair> exposure_pairs(const Stack& stack, const std::vector<double>& settings) {
    std::vector<ExposurePair> pairs;
    for (const StackPhoto* photo : some_photos(stack)) {
        std::vector<Exposure> exposures = photo->exposures;
        std::sort(exposures.begin(), exposures.end(),
                  [](const Exposure& a, const Exposure& b) { return a.relative < b.relative; });
        std::vector<float> below;
        for (std::size_t k = 0; k < exposures.size(); ++k) {
            std::vector<float> sample = sample_of(stack, exposures[k].path, photo->light);
            if (k > 0)
                pairs.push_back({index_of(exposures[k].relative, settings),
                                 index_of(exposures[k - 1].relative, settings), sample, below});
            below = std::move(sample);
        }
    }
    return pairs;
}

// Where setting k and the one below are not related as they should be.
void warn_of_setting(const std::vector<double>& settings, const RefinedExposures& refined, std::size_t k,
                     Stack& stack) {
    const double given = settings[k] / settings[k - 1], found = refined.relative[k] / refined.relative[k - 1];
    if (!refined.refined[k])
        stack.warnings.push_back(
            fmt::format("{}: no pixels are well exposed both at {:.4g} and at {:.4g} of the reference "
                        "exposure; their ratio is "
                        "taken as given",
                        stack.folder.string(), settings[k - 1], settings[k]));
    else if (std::abs(std::log(found / given)) > std::log(1.26))
        stack.warnings.push_back(
            fmt::format("{}: exposures said to differ by a factor of {:.3g} differ by {:.3g} in the "
                        "photographs, which is what is "
                        "used; check the brackets, and that all are stored alike",
                        stack.folder.string(), given, found));
    if (refined.scatter[k] > 0.02)
        stack.warnings.push_back(
            fmt::format("{}: the ratio of neighbouring exposures changes by {:.1f} % from light to "
                        "light: the lights or the "
                        "shutter are not steady",
                        stack.folder.string(), 100 * refined.scatter[k]));
}

}  // namespace

std::vector<StackPhoto*> all_photos(Stack& stack) {
    std::vector<StackPhoto*> all;
    for (StackPhoto& photo : stack.photos) all.push_back(&photo);
    for (StackPhoto& photo : stack.held_out) all.push_back(&photo);
    return all;
}

void relate_exposures(Stack& stack, DevelopReport& report_) {
    const std::vector<double> settings = settings_of(stack);
    const RefinedExposures refined = refine_exposures(settings, exposure_pairs(stack, settings));
    for (std::size_t k = 0; k < settings.size(); ++k) {
        report_.settings.push_back(
            {settings[k], refined.relative[k], refined.scatter[k], refined.refined[k]});
        if (k > 0) warn_of_setting(settings, refined, k, stack);
    }
    for (StackPhoto* photo : all_photos(stack))
        for (Exposure& exposure : photo->exposures)
            exposure.relative = refined.relative[index_of(exposure.relative, settings)];
}

void check_frames(Stack& stack, const DevelopReport& report_) {
    if (!report_.dark && !report_.ambient) return;
    double brightest = 0,
           below = 0;  // mean of the brightest photograph, dark frame taken off; part that is 0
    for (const StackPhoto* photo : some_photos(stack)) {
        const std::vector<float> sample = sample_of(stack, photo->path, photo->light);
        const double mean = mean_of(sample);
        if (mean < brightest) continue;
        brightest = mean;
        below = static_cast<double>(std::count(sample.begin(), sample.end(), 0.0f)) /
                static_cast<double>(std::max<std::size_t>(sample.size(), 1));
    }
    if (const auto& dark = report_.dark) {
        const std::string name = dark->files.front().string();
        if (below > 0.5)
            fail(
                "{}: the dark frame ({:.4f} of full scale on average) is brighter than {:.0f} % of the "
                "brightest photograph; it must be taken with the lens covered",
                name, dark->mean, 100 * below);
        if (dark->mean > brightest)
            stack.warnings.push_back(fmt::format(
                "{}: the dark frame ({:.4f} of full scale on average) is brighter than what it leaves of the "
                "photographs ({:.4f}); was the lens covered?",
                name, dark->mean, brightest));
    }
    if (const auto& ambient = report_.ambient) {
        const std::string name = ambient->files.front().string();
        const double part = ambient->mean / std::max(brightest, 1e-9);
        if (part >= 0.8)
            fail(
                "{}: the photograph of the ambient light has {:.0f} % of the brightness of the brightest "
                "photographs; the "
                "light must be off in it, and the room darker",
                name, 100 * part);
        if (part > 0.25)
            stack.warnings.push_back(
                fmt::format("{}: {:.0f} % of the light in the photographs is ambient; what is left when it "
                            "is taken off is noisy",
                            name, 100 * part));
    }
}

}  // namespace tangi
