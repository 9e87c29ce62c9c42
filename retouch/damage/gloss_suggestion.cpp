// gloss_suggestion.cpp: patches whose highlights are narrower or wider, stronger or weaker than around them;
// and the wand.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "retouch/damage/damage_suggestion.h"
#include "retouch/damage/local_deviation.h"
#include "surface/base/median.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr int kGlossSide_px = 640;  // patches are looked for in a copy of this size at most

// Logarithms of alpha and rho_s; medians of 5 x 5 pixels, as single pixels of both are noisy.
struct GlossMaps {
    cv::Mat roughness, specular;
};

GlossMaps gloss_of(const Surface& s, double factor) {
    cv::Mat roughness(s.height(), s.width(), CV_32F), specular(s.height(), s.width(), CV_32F);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            roughness.at<float>(y, x) = std::log(std::max(s.roughness(x, y), 1e-3f));
            specular.at<float>(y, x) = std::log(std::max(s.specular(x, y), 0.0f) + 0.004f);
        }
    GlossMaps gloss;
    for (auto [from, to] : {std::pair{&roughness, &gloss.roughness}, {&specular, &gloss.specular}}) {
        cv::Mat small, smooth;
        cv::resize(*from, small, {}, factor, factor, cv::INTER_AREA);
        cv::medianBlur(small, smooth, 5);
        cv::medianBlur(smooth, *to, 5);
    }
    return gloss;
}

// Logarithms of the factors by which highlights are narrower, and wider or else weaker, than around. rho_s
// counts only where alpha says nothing: of narrow highlights it is noisy.
struct Contrast {
    cv::Mat glossier, matter;
};

Contrast contrast_of(const GlossMaps& gloss, int radius, float wanted) {
    const cv::Mat wider = gloss.roughness - local_statistics(gloss.roughness, radius).median;
    const cv::Mat weaker = local_statistics(gloss.specular, radius).median - gloss.specular;
    cv::Mat matter = cv::max(wider, weaker);
    matter.setTo(0, wider < -wanted);
    return {-wider, matter};
}

float median_in(const cv::Mat& values, const cv::Mat& inside) {
    std::vector<float> some;
    for (int y = 0; y < values.rows; ++y)
        for (int x = 0; x < values.cols; ++x)
            if (inside.at<unsigned char>(y, x)) some.push_back(values.at<float>(y, x));
    return median(std::move(some));
}

// The search, in a copy of the painting.
struct GlossSearch {
    GlossMaps gloss;
    double factor;     // the copy's size over the painting's
    double pixel_mm2;  // of the copy
    const GlossOptions& options;
};

// A patch against a ring around it; nothing where it fades out, or alpha says the contrary.
std::optional<GlossPatch> patch_of(const GlossSearch& search, const cv::Mat& inside, bool glossier) {
    cv::Mat grown;
    cv::dilate(inside, grown, disc(8));
    const cv::Mat ring = grown & ~inside;
    const auto ratio = [&](const cv::Mat& values) {
        return std::exp(static_cast<double>(median_in(values, inside) - median_in(values, ring)));
    };
    GlossPatch patch;
    patch.glossier = glossier;
    patch.roughness_ratio = ratio(search.gloss.roughness);
    patch.specular_ratio = ratio(search.gloss.specular);
    const double against_rim =
        glossier ? 1 / patch.roughness_ratio : std::max(patch.roughness_ratio, 1 / patch.specular_ratio);
    if (against_rim < std::sqrt(search.options.contrast)) return {};
    if (!glossier && patch.roughness_ratio < 0.9) return {};
    return patch;
}

// CV_8U, 255 where patches are, which are added to `found`.
cv::Mat patches_in(const GlossSearch& search, const cv::Mat& strength, bool glossier,
                   std::vector<GlossPatch>& found) {
    cv::Mat patches;
    cv::morphologyEx(strength > 1, patches, cv::MORPH_CLOSE, disc(3));
    cv::morphologyEx(patches.clone(), patches, cv::MORPH_OPEN, disc(3));  // strokes and cracks go
    cv::Mat numbers, stats, centres;
    const int count = cv::connectedComponentsWithStats(patches, numbers, stats, centres, 8, CV_32S);
    cv::Mat kept = cv::Mat::zeros(patches.size(), CV_8U);
    for (int i = 1; i < count; ++i) {
        const double mm2 = stats.at<int>(i, cv::CC_STAT_AREA) * search.pixel_mm2;
        if (mm2 < search.options.smallest_patch_mm2) continue;
        const cv::Mat inside = numbers == i;
        std::optional<GlossPatch> patch = patch_of(search, inside, glossier);
        if (!patch) continue;
        const auto to_full = [&](int v) { return static_cast<int>(std::lround(v / search.factor)); };
        const int x = stats.at<int>(i, cv::CC_STAT_LEFT), y = stats.at<int>(i, cv::CC_STAT_TOP);
        patch->area_mm2 = mm2;
        patch->box = {to_full(x), to_full(y), to_full(x + stats.at<int>(i, cv::CC_STAT_WIDTH)),
                      to_full(y + stats.at<int>(i, cv::CC_STAT_HEIGHT))};
        found.push_back(*patch);
        kept.setTo(255, inside);
    }
    return kept;
}

// At the painting's size.
void show(const cv::Mat& kept, const cv::Mat& strength, DamageSuggestion& suggestion) {
    const int width = suggestion.mask.width(), height = suggestion.mask.height();
    cv::Mat full, confidence;
    cv::resize(kept, full, {width, height}, 0, 0, cv::INTER_LINEAR);
    cv::resize(strength, confidence, {width, height}, 0, 0, cv::INTER_LINEAR);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            suggestion.mask(x, y) = full.at<unsigned char>(y, x) >= 128 ? 1.0f : 0.0f;
            const float s = std::max(confidence.at<float>(y, x), 0.0f);
            suggestion.confidence(x, y) = s * s / (s * s + 1);
        }
}

}  // namespace

GlossSuggestion suggest_gloss(const Surface& surface, double mm_per_pixel, const GlossOptions& options,
                              const Progress& progress) {
    validate(options);
    require_consistent(surface);
    const int width = surface.width(), height = surface.height();
    GlossSuggestion result;
    for (DamageSuggestion* s : {&result.glossier, &result.matter})
        *s = {Mask(width, height), Image<float>(width, height)};
    if (width < 32 || height < 32) return result;
    report(progress, "compare gloss", 0);
    const double factor = std::min(1.0, kGlossSide_px / static_cast<double>(std::max(width, height)));
    const GlossSearch search{gloss_of(surface, factor), factor,
                             mm_per_pixel * mm_per_pixel / (factor * factor), options};
    const int side = std::min(search.gloss.roughness.cols, search.gloss.roughness.rows);
    const auto wanted = static_cast<float>(std::log(options.contrast));
    const Contrast contrast = contrast_of(search.gloss, std::max(static_cast<int>(0.3 * side), 8), wanted);
    report(progress, "compare gloss", 0.6);
    for (const bool glossier : {true, false}) {
        const cv::Mat strength = (glossier ? contrast.glossier : contrast.matter) / wanted;
        const cv::Mat kept = patches_in(search, strength, glossier, result.patches);
        show(kept, strength, glossier ? result.glossier : result.matter);
    }
    report(progress, "compare gloss", 1);
    return result;
}

}  // namespace tangi
