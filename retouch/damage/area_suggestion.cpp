// area_suggestion.cpp: abrasion, stains, old fills and overpaint, by what changes at their rims; flaking.
#include "retouch/damage/area_suggestion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "retouch/damage/area_features.h"
#include "retouch/damage/flaking_suggestion.h"
#include "retouch/damage/local_deviation.h"
#include "retouch/damage/stain_evidence.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr double kMost = 0.4;        // [1] of the picture: larger areas are the picture
constexpr double kStroke_mm2 = 100;  // what lies on the paint and is smaller may be a stroke of a broad brush
constexpr int kLeast = 60;           // [blocks] fewer have no rim to judge by

double colour_step(const Rim& rim) {
    return std::hypot(rim.of(Cue::lightness).step, rim.of(Cue::a).step, rim.of(Cue::b).step);
}

// [1] How much the gloss changes at the rim: 1 is about what one sees.
double gloss_step(const Rim& rim) {
    return std::max(std::abs(rim.of(Cue::roughness).step) / 0.25,
                    std::abs(rim.of(Cue::specular).step) / 0.45);
}
double gloss_agrees(const Rim& rim) {
    return std::abs(rim.of(Cue::roughness).step) / 0.25 > std::abs(rim.of(Cue::specular).step) / 0.45
               ? rim.of(Cue::roughness).agree
               : rim.of(Cue::specular).agree;
}
std::string gloss_words(const Rim& rim) {
    return fmt::format("alpha times {:.2f}, rho_s times {:.2f}", std::exp(rim.of(Cue::roughness).step),
                       std::exp(rim.of(Cue::specular).step));
}

// The rim as it is seen close by and from further off: what fades out changes less close by.
struct Rims {
    Rim close, far, within_paint;
};

Judged judge_fill(const Rims& rims) {
    const Rim& rim = rims.far;
    const RimStep &texture = rim.of(Cue::texture), &height = rim.of(Cue::height);
    const double look = std::max(gloss_step(rim), colour_step(rim) / 8);
    const double off_level = std::abs(height.step) / (2 * height.usual + 0.05);
    return {rising(-texture.step / std::log(3.0), 0.15) * rising(texture.agree / 0.7, 0.08) *
                rising(look, 0.25) * rising(2 - off_level, 0.3),
            fmt::format("{:.1f} times as smooth, {}, {:+.3f} mm", std::exp(-texture.step), gloss_words(rim),
                        height.step)};
}

Judged judge_overpaint(const Rims& rims) {
    const Rim& rim = rims.far;
    const RimStep &texture = rim.of(Cue::texture), &height = rim.of(Cue::height);
    const double other = std::max(std::abs(texture.step) / 0.3, colour_step(rim) / 8);
    return {rising(height.step / (0.5 * height.usual + 0.03), 0.2) * rising(height.agree / 0.7, 0.06) *
                rising(gloss_step(rim), 0.25) * rising(gloss_agrees(rim) / 0.8, 0.06) * rising(other, 0.25),
            fmt::format("{:.3f} mm higher, {}", height.step, gloss_words(rim))};
}

// Rubbed down to the tops of the ground: level where paint and ground still change from thread to thread.
// Matt and low alone is what half of the losses, earths and thin places are too.
Judged judge_abrasion(const Rims& rims) {
    const Rim& rim = rims.far;
    const RimStep& height = rim.of(Cue::height);
    const RimStep& wear = rim.of(Cue::wear);
    const double matter = (rim.of(Cue::roughness).step / 0.2 - rim.of(Cue::specular).step / 0.35) / 2;
    const double lower = -height.step / (0.5 * height.usual + 0.02);
    return {rising(wear.step / 0.65, 0.12) * rising(wear.agree / 0.7, 0.08) * rising(matter, 0.2) *
                rising(gloss_agrees(rim) / 0.5, 0.08) * rising(lower / 0.7, 0.25) *
                rising(height.agree / 0.6, 0.06),
            fmt::format("{:.1f} times the colours for its relief, {}, {:+.3f} mm", std::exp(wear.step),
                        gloss_words(rim), height.step)};
}

// What goes on across the rim in one paint loses light by the law of a stain, by about as much all round;
// gloss, height and texture change no more than they do anyway.
Judged judge_stain(const Rims& rims) {
    const Rim &rim = rims.close, &paint = rims.within_paint;
    const RimStep &red = paint.of(Cue::red), &green = paint.of(Cue::green), &blue = paint.of(Cue::blue);
    const double steady = -blue.step / (1.5 * blue.spread + 0.05);
    // Neither blue alone, as yellow paint does, nor all alike, as black does.
    const double r = red.step / blue.step, g = green.step / blue.step;
    const double order = std::max({std::abs(r - 0.3) / 0.2, std::abs(g - 0.55) / 0.2, r > g ? 2.0 : 0.0});
    const double others = std::max(
        {gloss_step(rim) / 0.6, std::abs(rim.of(Cue::height).step) / (0.5 * rim.of(Cue::height).usual + 0.02),
         std::abs(rim.of(Cue::texture).step) / 0.3});
    return {rising(-blue.step / 0.25, 0.2) * rising(steady, 0.25) * rising(blue.agree / 0.8, 0.06) *
                rising(2 - order, 0.2) * rising(2 - others, 0.2),
            fmt::format("lets pass {:.2f}, {:.2f}, {:.2f} of red, green, blue", std::exp(red.step),
                        std::exp(green.step), std::exp(blue.step))};
}

cv::Mat deviation(const cv::Mat& m, double part = 0.25) {
    const int side = std::min(m.cols, m.rows);
    return m - local_statistics(m, std::max(static_cast<int>(part * side), 8)).median;
}

struct AreaSearch {
    std::vector<cv::Mat> evidence;
    std::vector<double> thresholds;
    int close, far;  // [blocks] from the rim
    int reach;  // [blocks] by which the evidence is narrower than the area: its window looks across the rim
    Judged (*judge)(const Rims&);
};

cv::Mat blurred(const cv::Mat& m, double sigma) {
    cv::Mat result;
    cv::GaussianBlur(m, result, {}, sigma);
    return result;
}

AreaSearch search_for(DamageClass damage, const AreaFeatures& f) {
    const cv::Mat rough = deviation(f.of(Cue::roughness)) / 0.25,
                  weak = -deviation(f.of(Cue::specular)) / 0.45;
    switch (damage) {
        case DamageClass::old_fill:
            return {
                {-deviation(f.of(Cue::texture)) / std::log(2.0)}, {1, 1.3, 1.7, 2.2, 3}, 2, 4, 3, judge_fill};
        case DamageClass::overpaint:
            return {{rough, -rough, weak, -weak}, {0.7, 1, 1.4, 2, 2.8}, 2, 4, 0, judge_overpaint};
        case DamageClass::abrasion:
            return {{cv::min(blurred(cv::max(rough, weak), 2), deviation(f.of(Cue::wear)) / 0.6)},
                    {0.4, 0.6, 0.9, 1.3, 2},
                    2,
                    8,
                    0,
                    judge_abrasion};
        default:
            return {{deviation(blurred(stain_evidence(f), 2))},
                    {0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4},
                    5,
                    6,
                    0,
                    judge_stain};
    }
}

// [1] How much of the area a mask of the painting covers.
double part_of(const Mask& mask, const Area& area, int block) {
    double covered = 0;
    for (int y = 0; y < area.box.height; ++y)
        for (int x = 0; x < area.box.width; ++x)
            if (area.inside.at<unsigned char>(y, x))
                covered += static_cast<double>(
                    mask(std::min((area.box.x + x) * block + block / 2, mask.width() - 1),
                         std::min((area.box.y + y) * block + block / 2, mask.height() - 1)));
    return covered / std::max(area.blocks, 1);
}

struct Found {
    Area area;
    Judged judged;
};

// The surest of those that lie within each other, or overlap.
std::vector<Found> surest(std::vector<Found> found, const cv::Size& size) {
    std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
        return a.judged.confidence > b.judged.confidence;
    });
    cv::Mat taken = cv::Mat::zeros(size, CV_8U);
    std::vector<Found> kept;
    for (const Found& f : found) {
        cv::Mat here = taken(f.area.box);
        if (cv::countNonZero(here & f.area.inside) > 0) continue;
        here.setTo(255, f.area.inside);
        kept.push_back(f);
    }
    return kept;
}

// What is found all over a picture is how it is painted: each that is like it in size, and nearly as sure,
// makes an area less likely to be damage.
void doubt_manner(std::vector<Found>& found) {
    std::vector<double> sure;
    for (const Found& one : found) {
        int alike = 0;
        for (const Found& other : found)
            alike += &other != &one && other.area.blocks > 0.4 * one.area.blocks &&
                     other.judged.confidence > 0.5 * one.judged.confidence;
        sure.push_back(one.judged.confidence / (1 + std::max(alike - 1, 0) / 3.0));
    }
    for (std::size_t i = 0; i < found.size(); ++i) found[i].judged.confidence = sure[i];
    std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
        return a.judged.confidence > b.judged.confidence;
    });
}

// By what changes at their rims; the surest of those that overlap, all of them to be judged by how many there
// are.
std::vector<Found> found_by_rims(const Surface& surface, double mm_per_pixel, DamageClass damage,
                                 const AreaOptions& options, int& block, const Progress& progress) {
    const AreaFeatures f = area_features_of(surface, mm_per_pixel / surface.mm_per_pixel, kSide_px, progress);
    block = f.block;
    const double block_mm2 = mm_per_pixel * mm_per_pixel * block * block;
    const int least = std::max(kLeast, static_cast<int>(std::ceil(options.smallest_area_mm2 / block_mm2)));
    const AreaSearch search = search_for(damage, f);
    // What suggest_loss() finds is neither worn nor filled, though it is lower, matt, and may be smooth.
    const Mask lost = damage == DamageClass::abrasion || damage == DamageClass::old_fill
                          ? suggest_loss(surface, mm_per_pixel).mask
                          : Mask();
    std::vector<Found> found;
    for (std::size_t i = 0; i < search.evidence.size(); ++i) {
        report(progress, "compare areas",
               0.3 + 0.6 * static_cast<double>(i) / static_cast<double>(search.evidence.size()));
        for (Area& area : areas_above(search.evidence[i], search.thresholds, least, kMost)) {
            if (!lost.empty() && part_of(lost, area, f.block) > 0.2) continue;
            if (search.reach > 0) area = grown(area, search.reach, f.measured.size());
            const Rims rims{rim_of(f, area, search.close), rim_of(f, area, search.far),
                            rim_of(f, area, 4, Compared::within_paint)};
            if (std::min(rims.close.points, rims.far.points) < 24 || rims.far.seen < 0.75) continue;
            if (damage == DamageClass::stain && rims.within_paint.points < 24) continue;
            Judged judged = search.judge(rims);
            if (damage == DamageClass::overpaint)
                judged.confidence *= rising(area.blocks * block_mm2 / kStroke_mm2, 0.15);
            found.push_back({std::move(area), std::move(judged)});
        }
    }
    found = surest(std::move(found), f.measured.size());
    doubt_manner(found);
    return found;
}

std::vector<Found> found_by_cracks(const Surface& surface, double mm_per_pixel, const AreaOptions& options,
                                   int& block, const Progress& progress) {
    std::vector<Found> found;
    for (FlakingArea& flaking :
         flaking_areas(surface, mm_per_pixel, options.smallest_area_mm2, block, progress))
        found.push_back({std::move(flaking.area), {flaking.confidence, std::move(flaking.cues)}});
    return surest(std::move(found),
                  {(surface.width() + block - 1) / block, (surface.height() + block - 1) / block});
}

}  // namespace

AreaSuggestion suggest_areas(const Surface& surface, double mm_per_pixel, DamageClass damage,
                             const AreaOptions& options, const Progress& progress) {
    TP_REQUIRE(std::find(kAreaClasses.begin(), kAreaClasses.end(), damage) != kAreaClasses.end(),
               "areas are suggested of the classes of kAreaClasses");
    validate(options);
    AreaSuggestion suggestion;
    suggestion.begin(surface);
    const int width = surface.width(), height = surface.height();
    if (width < 32 || height < 32) return suggestion;
    int block = 1;  // [pixels]
    const std::vector<Found> found =
        damage == DamageClass::flaking
            ? found_by_cracks(surface, mm_per_pixel, options, block, progress)
            : found_by_rims(surface, mm_per_pixel, damage, options, block, progress);
    const double block_mm2 = mm_per_pixel * mm_per_pixel * block * block;
    for (const Found& one : found) {
        const double sure = one.judged.confidence;
        suggestion.surest = std::max(suggestion.surest, sure);
        const cv::Rect& box = one.area.box;
        for (int y = box.y * block; y < std::min((box.y + box.height) * block, height); ++y)
            for (int x = box.x * block; x < std::min((box.x + box.width) * block, width); ++x) {
                if (!one.area.inside.at<unsigned char>(y / block - box.y, x / block - box.x)) continue;
                suggestion.confidence(x, y) = static_cast<float>(sure);
                if (sure >= options.area_confidence) suggestion.mask(x, y) = 1;
            }
        if (sure < options.area_confidence) continue;
        const cv::Rect tight = cv::boundingRect(one.area.inside) + box.tl();
        suggestion.areas.push_back(
            {{tight.x * block, tight.y * block, std::min((tight.x + tight.width) * block, width),
              std::min((tight.y + tight.height) * block, height)},
             one.area.blocks * block_mm2,
             sure,
             one.judged.cues});
        suggestion.weak += sure < kWeakEvidence ? 1 : 0;
    }
    report(progress, "compare areas", 1);
    return suggestion;
}

}  // namespace tangi
