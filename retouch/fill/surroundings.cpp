#include "retouch/fill/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "retouch/fill/fill.h"
#include "retouch/fill/texture_synthesis.h"
#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr double kModeBandwidth = 4;  // [L*a*b*] of the mean shift
constexpr std::array<std::string_view, 4> kMethodNames = {"membrane", "telea", "navier-stokes", "patches"};

glm::dvec3 vector_of(const Lab& lab) { return {lab.l, lab.a, lab.b}; }

// The densest place of the colours near their median, and the colour of the pixels there.
Rgb mode_of(const std::vector<Rgb>& colours, const Rgb& start) {
    std::vector<glm::dvec3> labs;
    for (const Rgb& c : colours) labs.push_back(vector_of(lab_from_linear(c)));
    glm::dvec3 at = vector_of(lab_from_linear(start));
    Rgb mode = start;
    for (int pass = 0; pass < 30; ++pass) {
        glm::dvec3 sum(0), colour(0);
        double weights = 0;
        for (std::size_t i = 0; i < labs.size(); ++i) {
            const glm::dvec3 off = (labs[i] - at) / kModeBandwidth;
            const double w = std::exp(-0.5 * glm::dot(off, off));
            sum += w * labs[i], colour += w * glm::dvec3(colours[i]), weights += w;
        }
        if (!(weights > 1e-9)) break;
        const glm::dvec3 next = sum / weights;
        mode = Rgb(colour / weights);
        if (glm::length(next - at) < 0.01) break;
        at = next;
    }
    return mode;
}

// Colours count by their own spread, relief half as much.
void patches_into(Image<Rgb>& colours, const Mask& hole, const Image<float>* relief_mm) {
    Mask usable(hole.width(), hole.height());
    for (std::size_t i = 0; i < hole.size(); ++i) usable.pixels()[i] = inside(hole.pixels()[i]) ? 0.0f : 1.0f;
    std::vector<SynthesisChannel> channels(3, {Image<float>(hole.width(), hole.height())});
    float spread = 1e-4f;
    for (int c = 0; c < 3; ++c) {
        Image<float>& values = channels[static_cast<std::size_t>(c)].values;
        for (std::size_t i = 0; i < hole.size(); ++i)
            values.pixels()[i] = std::cbrt(std::max(colours.pixels()[i][c], 0.0f));
        spread = std::max(spread, spread_of(values, usable));
    }
    for (SynthesisChannel& channel : channels)
        for (float& v : channel.values.pixels()) v /= spread;
    if (relief_mm) {
        channels.push_back({*relief_mm, true});
        const float half = 2 * std::max(spread_of(*relief_mm, usable), 1e-6f);
        for (float& v : channels.back().values.pixels()) v /= half;
    }
    if (!synthesise_into(channels, hole, usable))
        fail(
            "patches: no whole patch of undamaged painting lies beside the mask; take another --inpainting, "
            "or "
            "a wider --annulus-mm");
    for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < hole.size(); ++i) {
            if (!inside(hole.pixels()[i])) continue;
            const float v = spread * channels[static_cast<std::size_t>(c)].values.pixels()[i];
            colours.pixels()[i][c] = v * v * v;
        }
}

}  // namespace

namespace {

// How far beside a mask its surroundings reach.
struct Reach {
    double near_px, far_px;

    Reach(const Surface& surface, const AnnulusOptions& options)
        : near_px(options.gap_mm / surface.mm_per_pixel),
          far_px(near_px + std::max(options.annulus_mm / surface.mm_per_pixel, 1.0)) {}
};

// The part of the picture that holds the mask and its surroundings; empty where the mask is.
Region region_round(const Mask& loss, const Reach& reach) {
    Region box{loss.width(), loss.height(), 0, 0};
    for (int y = 0; y < loss.height(); ++y)
        for (int x = 0; x < loss.width(); ++x)
            if (loss(x, y) > 0) {
                box.x0 = std::min(box.x0, x), box.y0 = std::min(box.y0, y);
                box.x1 = std::max(box.x1, x + 1), box.y1 = std::max(box.y1, y + 1);
            }
    if (box.x1 <= box.x0) return {};
    const int margin = static_cast<int>(std::ceil(reach.far_px)) + 2;
    return {std::max(box.x0 - margin, 0), std::max(box.y0 - margin, 0),
            std::min(box.x1 + margin, loss.width()), std::min(box.y1 + margin, loss.height())};
}

// Calls each(x, y) for the pixels of the surroundings.
template <class Each>
void for_annulus(const Surface& surface, const Mask& loss, const Mask& damaged, const AnnulusOptions& options,
                 Each&& each) {
    validate(options);
    TP_REQUIRE(loss.region() == surface.height_mm.region(), "the mask is the painting's");
    TP_REQUIRE(damaged.empty() || damaged.region() == loss.region(), "the mask is the painting's");
    const Reach reach(surface, options);
    const Region box = region_round(loss, reach);
    if (box.empty()) fail("surroundings: the mask is empty; draw or choose the damage first");
    Mask part(box.width(), box.height());  // distances take as much memory again
    for (int y = 0; y < part.height(); ++y)
        for (int x = 0; x < part.width(); ++x) part(x, y) = loss(x + box.x0, y + box.y0);
    const Image<float> distance = distance_inside_px(part);
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) {
            const double away = -static_cast<double>(distance(x - box.x0, y - box.y0));
            if (away > reach.near_px && away <= reach.far_px && surface.confidence(x, y) > 0 &&
                !inside(loss(x, y)) && (damaged.empty() || !inside(damaged(x, y))))
                each(x, y);
        }
}

}  // namespace

Mask annulus_mask(const Surface& surface, const Mask& loss, const Mask& damaged,
                  const AnnulusOptions& options) {
    Mask annulus(loss.width(), loss.height());
    for_annulus(surface, loss, damaged, options, [&](int x, int y) { annulus(x, y) = 1; });
    return annulus;
}

Annulus annulus_of(const Surface& surface, const Mask& loss, const Mask& damaged,
                   const AnnulusOptions& options) {
    std::vector<Rgb> colours;
    std::vector<float> channels[3], heights, speculars, roughnesses;
    for_annulus(surface, loss, damaged, options, [&](int x, int y) {
        const Rgb& c = surface.diffuse(x, y);
        colours.push_back(c);
        for (int channel = 0; channel < 3; ++channel) channels[channel].push_back(c[channel]);
        heights.push_back(surface.height_mm(x, y));
        speculars.push_back(surface.specular(x, y));
        roughnesses.push_back(surface.roughness(x, y));
    });
    if (colours.empty())
        fail(
            "surroundings: nothing measured and undamaged lies {} to {} mm beside the mask; give a wider "
            "--annulus-mm, or a mask that leaves some of the painting",
            options.gap_mm, options.gap_mm + options.annulus_mm);
    Annulus a;
    a.pixels = static_cast<int>(colours.size());
    a.median = {median(channels[0]), median(channels[1]), median(channels[2])};
    // Some thousands of pixels tell the mode as well as all of them.
    std::vector<Rgb> sample;
    const std::size_t step = std::max<std::size_t>(colours.size() / 4000, 1);
    for (std::size_t i = 0; i < colours.size(); i += step) sample.push_back(colours[i]);
    a.mode = mode_of(sample, a.median);
    std::vector<double> off;
    for (const Rgb& c : sample) off.push_back(delta_e_2000(lab_from_linear(c), lab_from_linear(a.mode)));
    a.spread = median(off);
    a.height_mm = median(heights);
    a.specular = median(speculars);
    a.roughness = median(roughnesses);
    return a;
}

std::string_view name_of(Inpainting method) { return kMethodNames[static_cast<std::size_t>(method)]; }

std::optional<Inpainting> inpainting_named(std::string_view name) {
    for (std::size_t i = 0; i < kMethodNames.size(); ++i)
        if (kMethodNames[i] == name) return static_cast<Inpainting>(i);
    return std::nullopt;
}

void membrane_into(Image<float>& values, const Mask& hole) {
    TP_REQUIRE(values.region() == hole.region(), "the mask has the size of the picture");
    if (std::all_of(hole.pixels().begin(), hole.pixels().end(), inside))
        fail("inpainting: the mask covers the whole picture; nothing is left to go on from");
    Mask unknown(hole.width(), hole.height());
    for (std::size_t i = 0; i < hole.size(); ++i)
        unknown.pixels()[i] = inside(hole.pixels()[i]) ? 1.0f : 0.0f;
    solve_membrane(values, unknown);
}

void inpaint_into(Image<float>& values, const Mask& hole, Inpainting method, double radius_px) {
    if (method == Inpainting::membrane) return membrane_into(values, hole);
    TP_REQUIRE(method != Inpainting::patches, "patches are of colours");
    TP_REQUIRE(values.region() == hole.region(), "the mask has the size of the picture");
    cv::Mat mask(hole.height(), hole.width(), CV_8U);
    for (int y = 0; y < hole.height(); ++y)
        for (int x = 0; x < hole.width(); ++x) mask.at<unsigned char>(y, x) = inside(hole(x, y)) ? 255 : 0;
    // OpenCV rounds as if values were grey levels: on a scale of many levels that does not matter.
    const auto [low, high] = std::minmax_element(values.pixels().begin(), values.pixels().end());
    const float base = *low, scale = 60000 / std::max(*high - *low, 1e-20f);
    cv::Mat levels, filled;
    view_of(values).convertTo(levels, CV_32F, scale, -base * scale);
    cv::inpaint(levels, mask, filled, radius_px,
                method == Inpainting::telea ? cv::INPAINT_TELEA : cv::INPAINT_NS);
    for (int y = 0; y < hole.height(); ++y)
        for (int x = 0; x < hole.width(); ++x)
            if (inside(hole(x, y))) values(x, y) = filled.at<float>(y, x) / scale + base;
}

float spread_of(const Image<float>& values, const Mask& where) {
    double sum = 0, squares = 0, count = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!inside(where.pixels()[i])) continue;
        const auto v = static_cast<double>(values.pixels()[i]);
        sum += v, squares += v * v, count += 1;
    }
    return count > 0
               ? static_cast<float>(std::sqrt(std::max(squares / count - sum * sum / (count * count), 0.0)))
               : 0;
}

void inpaint_into(Image<Rgb>& colours, const Mask& hole, Inpainting method, double radius_px,
                  const Image<float>* relief_mm) {
    if (method == Inpainting::patches) return patches_into(colours, hole, relief_mm);
    for (int c = 0; c < 3; ++c) {
        Image<float> channel(colours.width(), colours.height());
        for (std::size_t i = 0; i < colours.size(); ++i)
            channel.pixels()[i] = std::cbrt(std::max(colours.pixels()[i][c], 0.0f));
        inpaint_into(channel, hole, method, radius_px);
        for (std::size_t i = 0; i < colours.size(); ++i) {
            if (!inside(hole.pixels()[i])) continue;
            const float v = std::max(channel.pixels()[i], 0.0f);
            colours.pixels()[i][c] = v * v * v;
        }
    }
}

Image<Rgb> smoothed_around(const Image<Rgb>& colours, const Mask& excluded, double sigma_px) {
    TP_REQUIRE(colours.region() == excluded.region(), "the mask has the size of the picture");
    if (!(sigma_px > 0)) return colours;
    cv::Mat weighted(colours.height(), colours.width(), CV_32FC4);
    for (int y = 0; y < colours.height(); ++y)
        for (int x = 0; x < colours.width(); ++x) {
            const float w = inside(excluded(x, y)) ? 0.0f : 1.0f;
            const Rgb& c = colours(x, y);
            weighted.at<cv::Vec4f>(y, x) = {w * c.r, w * c.g, w * c.b, w};
        }
    cv::GaussianBlur(weighted, weighted, cv::Size(), sigma_px, sigma_px, cv::BORDER_REPLICATE);
    Image<Rgb> result = colours;
    for (int y = 0; y < colours.height(); ++y)
        for (int x = 0; x < colours.width(); ++x) {
            const cv::Vec4f& v = weighted.at<cv::Vec4f>(y, x);
            if (v[3] > 1e-4f && !inside(excluded(x, y))) result(x, y) = Rgb(v[0], v[1], v[2]) / v[3];
        }
    return result;
}

}  // namespace tangi
