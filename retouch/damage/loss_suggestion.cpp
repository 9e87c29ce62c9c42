// loss_suggestion.cpp: places that lie lower than what is around them, and look different.
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "retouch/damage/damage_suggestion.h"
#include "retouch/damage/local_deviation.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr int kSearchSide_px = 640;            // candidates are looked for in a copy of this size at most
constexpr int kCutSide_px = 512;               // and cut out in one of this size at most
constexpr float kSeed = 1.8f, kExtent = 1.2f;  // [robust spreads] of a candidate's middle and of all of it

// What is compared: matrices of one size, CV_32F.
struct Features {
    cv::Mat height_mm, lightness, a, b, roughness, specular;  // logarithms of the last two
    cv::Mat measured;                                         // 0 or 1
};

// The features of a part of the surface, means of blocks of `block` x `block` pixels: the features of all
// pixels would take more memory than the painting.
Features features_of(const Surface& s, const Region& box, double unit_mm, int block) {
    const int columns = (box.width() + block - 1) / block, rows = (box.height() + block - 1) / block;
    const auto matrix = [&] { return cv::Mat(rows, columns, CV_32F); };
    Features f{matrix(), matrix(), matrix(), matrix(), matrix(), matrix(), matrix()};
    parallel_for(0, rows, 8, [&](int begin, int end) {
        for (int row = begin; row < end; ++row)
            for (int column = 0; column < columns; ++column) {
                const int x0 = box.x0 + column * block, y0 = box.y0 + row * block;
                const int x1 = std::min(x0 + block, box.x1), y1 = std::min(y0 + block, box.y1);
                std::array<double, 7> sum{};
                for (int y = y0; y < y1; ++y)
                    for (int x = x0; x < x1; ++x) {
                        const Lab lab = lab_from_linear(glm::dvec3(glm::max(s.diffuse(x, y), Rgb(0))));
                        sum[0] += static_cast<double>(s.height_mm(x, y)) * unit_mm;
                        sum[1] += lab.l, sum[2] += lab.a, sum[3] += lab.b;
                        sum[4] += static_cast<double>(std::log(std::max(s.roughness(x, y), 1e-3f)));
                        sum[5] += static_cast<double>(std::log(std::max(s.specular(x, y), 0.0f) + 0.004f));
                        sum[6] += s.confidence(x, y) == 0 && s.diffuse(x, y) == Rgb(0) ? 0 : 1;
                    }
                const double part = 1.0 / ((x1 - x0) * (y1 - y0));
                cv::Mat* const maps[] = {&f.height_mm, &f.lightness, &f.a,       &f.b,
                                         &f.roughness, &f.specular,  &f.measured};
                for (std::size_t i = 0; i < sum.size(); ++i)
                    maps[i]->at<float>(row, column) = static_cast<float>(part * sum[i]);
            }
    });
    return f;
}

// How many pixels a block is wide, so that there are at most `most_px` of them along the longer side.
int block_for(const Region& box, int most_px) {
    return std::max((std::max(box.width(), box.height()) + most_px - 1) / most_px, 1);
}

// Of block means, the value at a pixel: linear between the blocks' middles.
float at_pixel(const cv::Mat& blocks, int x, int y, int block) {
    const auto place = [block](int pixel, int count, int& first) {
        const float at = std::clamp((static_cast<float>(pixel) + 0.5f) / static_cast<float>(block) - 0.5f,
                                    0.0f, static_cast<float>(count - 1));
        first = std::min(static_cast<int>(at), std::max(count - 2, 0));
        return at - static_cast<float>(first);
    };
    int u = 0, v = 0;
    const float right = place(x, blocks.cols, u), down = place(y, blocks.rows, v);
    const int u1 = std::min(u + 1, blocks.cols - 1), v1 = std::min(v + 1, blocks.rows - 1);
    return (1 - down) * ((1 - right) * blocks.at<float>(v, u) + right * blocks.at<float>(v, u1)) +
           down * ((1 - right) * blocks.at<float>(v1, u) + right * blocks.at<float>(v1, u1));
}

// [robust spreads] Of being lower and of another look, both needed: their geometric mean.
cv::Mat evidence(const Features& f, int radius, double depth_mm) {
    const auto colour_distance = [&] {
        cv::Mat sum = cv::Mat::zeros(f.lightness.size(), CV_32F), distance;
        for (const cv::Mat* part : {&f.lightness, &f.a, &f.b}) {
            const cv::Mat d = *part - local_statistics(*part, radius).median;
            sum += d.mul(d);
        }
        cv::sqrt(sum, distance);
        return distance;
    };
    const LocalStatistics height = local_statistics(f.height_mm, radius);
    const cv::Mat lower = (height.median - f.height_mm) / (height.spread + 0.5 * depth_mm);
    const cv::Mat colour = colour_distance();
    cv::Mat look = colour / (local_spread(colour, radius) + 3);
    for (const cv::Mat* gloss : {&f.roughness, &f.specular}) {
        const LocalStatistics s = local_statistics(*gloss, radius);
        look = cv::max(look, cv::Mat(cv::abs(*gloss - s.median) / (s.spread + 0.25)));
    }
    cv::Mat both, result;
    cv::sqrt(cv::max(lower, 0).mul(cv::min(look, 8)), both);
    cv::GaussianBlur(both.mul(f.measured), result, {}, 0.8);
    return result;
}

// Bytes for GrabCut: height, how far the colour is from the candidate's, gloss.
cv::Mat bytes_for_cut(const Features& f, const cv::Mat& seed) {
    const auto in_seed = [&](const cv::Mat& m) {
        std::vector<float> values;
        for (int y = 0; y < m.rows; ++y)
            for (int x = 0; x < m.cols; ++x)
                if (seed.at<unsigned char>(y, x)) values.push_back(m.at<float>(y, x));
        return median(std::move(values));
    };
    const auto scaled = [&](const cv::Mat& m) {  // the middle 96 % fill the range
        const float low = quantile(m, 0.02), high = quantile(m, 0.98);
        cv::Mat bytes;
        const double gain = 250 / std::max(static_cast<double>(high - low), 1e-6);
        m.convertTo(bytes, CV_8U, gain, -static_cast<double>(low) * gain);
        return bytes;
    };
    cv::Mat sum = cv::Mat::zeros(f.lightness.size(), CV_32F), distance;
    for (const cv::Mat* part : {&f.lightness, &f.a, &f.b}) {
        const cv::Mat d = *part - in_seed(*part);
        sum += d.mul(d);
    }
    cv::sqrt(sum, distance);
    const cv::Mat gloss = f.specular - 0.5 * f.roughness;
    cv::Mat smooth, bytes;
    cv::medianBlur(gloss, smooth, 3);
    cv::merge(std::vector<cv::Mat>{scaled(f.height_mm), scaled(cv::min(distance, 40)), scaled(smooth)},
              bytes);
    return bytes;
}

// CV_8U, 255 inside: the candidate's outline where height, colour and gloss change.
cv::Mat cut_out(const Features& f, const cv::Mat& score) {
    const cv::Mat seed = score > kSeed;
    if (cv::countNonZero(seed) < 4) return seed;
    cv::Mat labels(score.size(), CV_8U, cv::Scalar(cv::GC_PR_BGD)), background, foreground;
    labels.setTo(cv::GC_PR_FGD, score > kExtent);
    labels.setTo(cv::GC_FGD, seed);
    cv::Mat near;
    const int reach = std::max(3, static_cast<int>(0.06 * std::max(score.cols, score.rows)));
    cv::dilate(score > kExtent, near,
               cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1}));
    labels.setTo(cv::GC_BGD, near == 0);
    if (cv::countNonZero(labels == cv::GC_BGD) < 16) return score > kExtent;
    cv::theRNG().state = 1;  // k-means starts at random: the same for each candidate
    cv::grabCut(bytes_for_cut(f, seed), labels, {}, background, foreground, 4, cv::GC_INIT_WITH_MASK);
    cv::Mat inside = (labels == cv::GC_FGD) | (labels == cv::GC_PR_FGD);
    cv::Mat closed;
    cv::morphologyEx(inside, closed, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));
    cv::morphologyEx(closed, inside, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
    return inside;
}

// [mm] Median heights within an area, away from its rim, and just beyond the rim's blur.
struct RimProfile {
    float inside = 0, near = 0;
};

RimProfile profile_of(const cv::Mat& height_mm, const cv::Mat& in, const cv::Mat& out) {
    std::vector<float> inside, near;
    for (int y = 0; y < in.rows; ++y)
        for (int x = 0; x < in.cols; ++x) {
            if (in.at<float>(y, x) > 1.2f) inside.push_back(height_mm.at<float>(y, x));
            if (const float d = out.at<float>(y, x); d > 1.2f && d < 3.2f)
                near.push_back(height_mm.at<float>(y, x));
        }
    return {median(std::move(inside)), median(std::move(near))};
}

// [mm] The level of most of the paint in a wide neighbourhood.
cv::Mat paint_level(const cv::Mat& height_mm) {
    cv::Mat small, level;
    const double factor = std::min(1.0, 300.0 / std::max(height_mm.cols, height_mm.rows));
    cv::resize(height_mm, small, {}, factor, factor, cv::INTER_AREA);
    const int radius = static_cast<int>(0.4 * std::min(small.cols, small.rows));
    cv::resize(local_statistics(small, radius).median, level, height_mm.size(), 0, 0, cv::INTER_LINEAR);
    return level;
}

// How sure an area is a loss. Paint breaks off with its full thickness: from inside, the height rises at once
// to the level of the paint around, `level_mm`, and beyond the rim it goes up as often as down. Where ground
// was left unpainted, paint around is thin, and strokes end in an edge that tapers: the height goes on
// rising. And what is bare looks different.
double judged(const Features& f, const cv::Mat& inside, float level_mm, const LossOptions& options) {
    cv::Mat in, out;
    cv::distanceTransform(inside, in, cv::DIST_L2, 3);
    cv::distanceTransform(inside == 0, out, cv::DIST_L2, 3);
    const RimProfile profile = profile_of(f.height_mm, in, out);
    const float step = profile.near - profile.inside;
    const float full = std::max(level_mm - profile.inside, step);
    if (!(step > 0)) return 0;
    constexpr float away = 3, beyond = 8;  // [pixels] from the rim: past its blur, and past a stroke's edge
    std::vector<float> colours, glosses;
    int broken = 0, rim = 0, seen = 0, going_up = 0;
    for (int y = 0; y < inside.rows; ++y)
        for (int x = 0; x < inside.cols; ++x) {
            if (!(in.at<float>(y, x) > 0 && in.at<float>(y, x) < 1.5f)) continue;
            ++rim;  // at the picture's border, too, where nothing rises
            const auto distance = [&](int dx, int dy) {
                const cv::Point p(std::clamp(x + dx, 0, inside.cols - 1),
                                  std::clamp(y + dy, 0, inside.rows - 1));
                return in.at<float>(p) - out.at<float>(p);
            };
            const float gx = distance(1, 0) - distance(-1, 0), gy = distance(0, 1) - distance(0, -1);
            const float length = std::hypot(gx, gy);
            if (!(length > 0)) continue;
            const auto along = [&](float d) {
                return cv::Point(x + static_cast<int>(std::lround(d * gx / length)),
                                 y + static_cast<int>(std::lround(d * gy / length)));
            };
            const cv::Point i = along(away - 1), o = along(-away), far = along(-beyond);
            const cv::Rect picture(0, 0, inside.cols, inside.rows);
            if (!picture.contains(i) || !picture.contains(o) || inside.at<unsigned char>(o)) continue;
            if (picture.contains(far)) {
                const float further = f.height_mm.at<float>(far) - f.height_mm.at<float>(o);
                ++seen;
                going_up += further > 0.15f * full ? 1 : further < -0.15f * full ? -1 : 0;
            }
            broken += f.height_mm.at<float>(o) - profile.inside > 0.5f * full ? 1 : 0;
            colours.push_back(std::hypot(f.lightness.at<float>(o) - f.lightness.at<float>(i),
                                         f.a.at<float>(o) - f.a.at<float>(i),
                                         f.b.at<float>(o) - f.b.at<float>(i)));
            glosses.push_back(std::max(std::abs(f.specular.at<float>(o) - f.specular.at<float>(i)),
                                       std::abs(f.roughness.at<float>(o) - f.roughness.at<float>(i))));
        }
    if (colours.size() < 8) return 0;
    const double look = std::max(static_cast<double>(median(std::move(colours))) / 8,
                                 static_cast<double>(median(std::move(glosses))) / 0.7);
    return rising(static_cast<double>(step) / options.depth_mm, 0.25) *
           rising(static_cast<double>(step / full) / 0.8, 0.06) *
           rising(1.15 - static_cast<double>(going_up) / std::max(seen, 1), 0.05) *
           rising(static_cast<double>(broken) / rim / 0.6, 0.2) * rising(look, 0.25);
}

// The coarse search over the whole painting.
struct LossSearch {
    const Surface& surface;
    const LossOptions& options;
    double mm_per_pixel, unit_mm;  // the second: of a mm of the surface, which may be a pixel
    int block;                     // pixels that are one here
    cv::Mat score{};               // [robust spreads] of being lower and of another look
    cv::Mat level_mm{};            // of most of the paint around
};

cv::Mat score_of(const Features& few, double depth_mm, const Progress& progress) {
    cv::Mat score = cv::Mat::zeros(few.height_mm.size(), CV_32F);
    const int side = std::min(few.height_mm.cols, few.height_mm.rows);
    for (const double part : {0.06, 0.12, 0.2}) {
        score = cv::max(score, evidence(few, static_cast<int>(part * side) + 2, depth_mm));
        report(progress, "look for losses", 0.2 + part);
    }
    return score;
}

// A candidate's surroundings, at full resolution where they are not too large.
struct CloseUp {
    Region part;  // of the painting
    int block;    // pixels that are one here
    Features features;
    cv::Mat score, level_mm;  // of the search, at the middles of the blocks
};

// `own`: the search's score of this candidate alone, which lies in `box`.
CloseUp close_up(const LossSearch& search, const cv::Mat& own, const cv::Rect& box) {
    const int block = search.block;
    const int margin = std::max(8, std::max(box.width, box.height) / 2);
    CloseUp near;
    near.part = {std::max((box.x - margin) * block, 0), std::max((box.y - margin) * block, 0),
                 std::min((box.x + box.width + margin) * block, search.surface.width()),
                 std::min((box.y + box.height + margin) * block, search.surface.height())};
    near.block = block_for(near.part, kCutSide_px);
    near.features = features_of(search.surface, near.part, search.unit_mm, near.block);
    const cv::Size size = near.features.height_mm.size();
    near.score = cv::Mat(size, CV_32F), near.level_mm = cv::Mat(size, CV_32F);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const int u = near.part.x0 + x * near.block + near.block / 2,
                      v = near.part.y0 + y * near.block + near.block / 2;
            near.score.at<float>(y, x) = at_pixel(own, u, v, block);
            near.level_mm.at<float>(y, x) = at_pixel(search.level_mm, u, v, block);
        }
    return near;
}

// [mm] The level of the paint around, in the middle of what lies inside.
float level_in(const cv::Mat& level_mm, const cv::Mat& inside) {
    std::vector<float> levels;
    for (int y = 0; y < inside.rows; ++y)
        for (int x = 0; x < inside.cols; ++x)
            if (inside.at<unsigned char>(y, x)) levels.push_back(level_mm.at<float>(y, x));
    return median(std::move(levels));
}

// Says how sure one piece of a candidate is, and takes it where that is enough.
void judge_piece(const CloseUp& near, const cv::Mat& inside, const LossOptions& options,
                 DamageSuggestion& suggestion) {
    cv::Mat coverage;
    inside.convertTo(coverage, CV_32F, 1.0 / 255);
    const double sure = judged(near.features, inside, level_in(near.level_mm, inside), options);
    for (int y = 0; y < near.part.height(); ++y)
        for (int x = 0; x < near.part.width(); ++x) {
            if (at_pixel(coverage, x, y, near.block) < 0.5f) continue;
            float& confidence = suggestion.confidence(near.part.x0 + x, near.part.y0 + y);
            confidence = std::max(confidence, static_cast<float>(sure));
            if (sure >= options.confidence) suggestion.mask(near.part.x0 + x, near.part.y0 + y) = 1;
        }
}

void judge_candidate(const LossSearch& search, const CloseUp& near, DamageSuggestion& suggestion) {
    cv::Mat pieces, stats, centres;
    const cv::Mat cut = cut_out(near.features, near.score);
    const int count = cv::connectedComponentsWithStats(cut, pieces, stats, centres, 8, CV_32S);
    for (int piece = 1; piece < count; ++piece) {
        const double pixels =
            static_cast<double>(stats.at<int>(piece, cv::CC_STAT_AREA)) * near.block * near.block;
        if (pixels * search.mm_per_pixel * search.mm_per_pixel < search.options.smallest_mm2 || pixels < 9)
            continue;
        judge_piece(near, pieces == piece, search.options, suggestion);
    }
}

// Candidates by hysteresis.
void judge_candidates(const LossSearch& search, DamageSuggestion& suggestion, const Progress& progress) {
    cv::Mat numbers, stats, centres;
    const int count =
        cv::connectedComponentsWithStats(search.score > kExtent, numbers, stats, centres, 8, CV_32S);
    for (int i = 1; i < count; ++i) {
        report(progress, "look for losses", 0.5 + 0.5 * i / count);
        const cv::Rect box(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                           stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
        cv::Mat own = cv::Mat::zeros(search.score.size(), CV_32F);
        search.score.copyTo(own, numbers == i);
        if (cv::countNonZero(own(box) > kSeed) < 2) continue;
        judge_candidate(search, close_up(search, own, box), suggestion);
    }
}

}  // namespace

DamageSuggestion suggest_loss(const Surface& surface, double mm_per_pixel, const LossOptions& options,
                              const Progress& progress) {
    validate(options);
    require_consistent(surface);
    const int width = surface.width(), height = surface.height();
    DamageSuggestion suggestion{Mask(width, height), Image<float>(width, height)};
    if (width < 16 || height < 16) return suggestion;
    LossSearch search{surface, options, mm_per_pixel, mm_per_pixel / surface.mm_per_pixel,
                      block_for(surface.height_mm.region(), kSearchSide_px)};
    report(progress, "look for losses", 0);
    const Features few = features_of(surface, surface.height_mm.region(), search.unit_mm, search.block);
    search.score = score_of(few, options.depth_mm, progress);
    search.level_mm = paint_level(few.height_mm);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float s = at_pixel(search.score, x, y, search.block);
            suggestion.confidence(x, y) = 0.5f * s * s / (s * s + kSeed * kSeed);  // nobody has judged it yet
        }
    judge_candidates(search, suggestion, progress);
    report(progress, "look for losses", 1);
    return suggestion;
}

}  // namespace tangi
