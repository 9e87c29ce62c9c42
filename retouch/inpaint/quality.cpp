#include "retouch/inpaint/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "paint/canvas/appearance_part.h"
#include "retouch/colour_match/gloss.h"
#include "retouch/treatment/treatment.h"
#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

// Gaussian means over pixels of weight 1, wherever there are some near.
Image<float> means(const Image<float>& values, const Mask& weight, double sigma_px) {
    cv::Mat sum = view_of(values).mul(view_of(weight)), weights;
    cv::GaussianBlur(sum, sum, cv::Size(), sigma_px, sigma_px, cv::BORDER_REPLICATE);
    cv::GaussianBlur(view_of(weight), weights, cv::Size(), sigma_px, sigma_px, cv::BORDER_REPLICATE);
    Image<float> result(values.width(), values.height());
    for (int y = 0; y < values.height(); ++y)
        for (int x = 0; x < values.width(); ++x)
            result(x, y) = sum.at<float>(y, x) / std::max(weights.at<float>(y, x), 1e-12f);
    return result;
}

// A quantity as it is inside the mask and outside of it, on both sides carried a little across the border,
// and as the outside goes on through the mask.
struct Sides {
    Image<float> within, without, carried_on;
};

// One region of the mask and its surroundings, cut out of the painting.
struct Cut {
    Region region;
    Mask retouch, surroundings, hole;  // 0 or 1
    double sigma_px = 1;
    std::vector<std::size_t> border;  // pixels inside at the rim

    Sides sides_of(const Image<float>& part) const {
        Sides sides{means(part, retouch, sigma_px), means(part, surroundings, sigma_px), {}};
        sides.carried_on = sides.without;
        membrane_into(sides.carried_on, hole);
        return sides;
    }
};

// A region of the mask, and how far aside it is looked at: at (0, 0) the retouch is judged; elsewhere, the
// original in its shape.
struct Outline {
    int number = 0;
    int dx = 0, dy = 0;
};

// Whose shape the cut has: the retouch's where it is looked at, and all retouches, as coverage in its region.
struct CutShape {
    Mask own, any;
};

CutShape shape_of(const MaskRegions& numbers, const Outline& place, const Region& region) {
    const int w = region.width(), h = region.height();
    CutShape shape{Mask(w, h), Mask(w, h)};
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const int u = x + region.x0, v = y + region.y0, from_x = u - place.dx, from_y = v - place.dy;
            const bool own = from_x >= 0 && from_y >= 0 && from_x < numbers.number.width() &&
                             from_y < numbers.number.height() &&
                             numbers.number(from_x, from_y) == place.number;
            shape.own(x, y) = own ? 1.0f : 0.0f;
            shape.any(x, y) = own || numbers.number(u, v) != 0 ? 1.0f : 0.0f;
        }
    return shape;
}

// Pixels inside that have a neighbour outside.
std::vector<std::size_t> border_of(const Mask& retouch) {
    const int w = retouch.width(), h = retouch.height();
    std::vector<std::size_t> border;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            if (!inside(retouch(x, y))) continue;
            const bool rim = (x > 0 && !inside(retouch(x - 1, y))) || (y > 0 && !inside(retouch(x, y - 1))) ||
                             (x + 1 < w && !inside(retouch(x + 1, y))) ||
                             (y + 1 < h && !inside(retouch(x, y + 1)));
            if (rim)
                border.push_back(static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                                 static_cast<std::size_t>(x));
        }
    return border;
}

Cut cut_of(const Canvas& canvas, const MaskRegions& numbers, const Outline& place, const Mask& damaged,
           const QualityOptions& options) {
    const double mm = canvas.mm_per_pixel();
    const double gap_px = options.annulus.gap_mm / mm,
                 ring_px = std::max(options.annulus.annulus_mm / mm, 1.0);
    Region box = numbers.regions[static_cast<std::size_t>(place.number - 1)].box;
    box = {box.x0 + place.dx, box.y0 + place.dy, box.x1 + place.dx, box.y1 + place.dy};
    const int margin = static_cast<int>(std::ceil(gap_px + ring_px)) + 2;
    Cut cut;
    cut.sigma_px = std::max(options.seen_mm / mm / 2, 0.5);
    cut.region = {std::max(box.x0 - margin, 0), std::max(box.y0 - margin, 0),
                  std::min(box.x1 + margin, canvas.width()), std::min(box.y1 + margin, canvas.height())};
    CutShape shape = shape_of(numbers, place, cut.region);
    const Image<float> away = distance_inside_px(shape.any);
    cut.retouch = std::move(shape.own);
    cut.surroundings = Mask(cut.region.width(), cut.region.height());
    for (int y = 0; y < cut.surroundings.height(); ++y)
        for (int x = 0; x < cut.surroundings.width(); ++x) {
            const int u = x + cut.region.x0, v = y + cut.region.y0;
            const bool good = -static_cast<double>(away(x, y)) > gap_px &&
                              canvas.dry().confidence(u, v) > 0 &&
                              (damaged.empty() || !inside(damaged(u, v)));
            cut.surroundings(x, y) = good ? 1.0f : 0.0f;
        }
    cut.border = border_of(cut.retouch);
    cut.hole = cut.surroundings;
    float known = 0;
    for (float& f : cut.hole.pixels()) known += f, f = 1 - f;
    if (!(known > 0))
        fail(
            "nothing measured and undamaged lies beside the retouch at x {}, y {}; give a wider "
            "--annulus-mm",
            box.x0, box.y0);
    return cut;
}

constexpr std::size_t kYardsticks = 4;     // beside a region, at most
constexpr std::size_t kManyRegions = 100;  // from which on one beside each tells as much
constexpr int kSmall_px = 1 << 18;         // places of at most so many pixels are looked at side by side

// Places beside a region where all of its shape is undamaged.
std::vector<Outline> undamaged_places(const MaskRegions& numbers, int number, const Mask& intact,
                                      int gap_px) {
    const std::size_t most = numbers.regions.size() > kManyRegions ? 1 : kYardsticks;
    const Region& box = numbers.regions[static_cast<std::size_t>(number - 1)].box;
    std::vector<Outline> places;
    constexpr std::array<std::array<int, 2>, 8> sides = {
        {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};
    for (const auto& [sx, sy] : sides)
        for (const double far : {1.0, 1.5, 2.0}) {
            if (places.size() == most) return places;
            const Outline place{number, static_cast<int>(sx * (far * box.width() + gap_px)),
                                static_cast<int>(sy * (far * box.height() + gap_px))};
            bool good = box.x0 + place.dx >= 0 && box.y0 + place.dy >= 0 &&
                        box.x1 + place.dx <= intact.width() && box.y1 + place.dy <= intact.height();
            for (int y = box.y0; y < box.y1 && good; ++y)
                for (int x = box.x0; x < box.x1 && good; ++x)
                    good = numbers.number(x, y) != number || inside(intact(x + place.dx, y + place.dy));
            if (!good) continue;
            places.push_back(place);
            break;
        }
    return places;
}

Step step_of(const Sides& sides, const std::vector<std::size_t>& border) {
    Step step;
    for (const std::size_t i : border) {
        const double d = static_cast<double>(sides.within.pixels()[i] - sides.without.pixels()[i]);
        step.mean += d, step.rms += d * d;
    }
    const double n = std::max(static_cast<double>(border.size()), 1.0);
    step.mean /= n;
    step.rms = std::sqrt(step.rms / n);
    return step;
}

Image<float> channel_of(const Image<Rgb>& colours, int c) {
    Image<float> channel(colours.width(), colours.height());
    for (std::size_t i = 0; i < colours.size(); ++i) channel.pixels()[i] = colours.pixels()[i][c];
    return channel;
}

double difference(const Sides* rgb, Image<float> Sides::*one, Image<float> Sides::*other, std::size_t i) {
    const auto lab = [&](Image<float> Sides::*side) {
        return lab_from_linear(
            {(rgb[0].*side).pixels()[i], (rgb[1].*side).pixels()[i], (rgb[2].*side).pixels()[i]});
    };
    return delta_e_2000(lab(one), lab(other));
}

// Colour under one illuminant; the map, if there is one, keeps the worst.
void compare_colour(const Cut& cut, const Image<Rgb>& look, std::size_t illuminant, RetouchQuality& q,
                    Image<float>* worst) {
    Sides rgb[3];
    for (int c = 0; c < 3; ++c) rgb[c] = cut.sides_of(channel_of(look, c));
    double sum = 0, border = 0;
    int pixels = 0;
    for (int y = 0; y < cut.retouch.height(); ++y)
        for (int x = 0; x < cut.retouch.width(); ++x) {
            if (!inside(cut.retouch(x, y))) continue;
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(cut.retouch.width()) +
                static_cast<std::size_t>(x);
            const double d = difference(rgb, &Sides::within, &Sides::carried_on, i);
            if (worst) {
                float& most = (*worst)(x + cut.region.x0, y + cut.region.y0);
                most = std::max(most, static_cast<float>(d));
            }
            sum += d, ++pixels;
        }
    for (const std::size_t i : cut.border) border += difference(rgb, &Sides::within, &Sides::without, i);
    q.delta_e[illuminant] = sum / std::max(pixels, 1);
    q.border_delta_e[illuminant] = border / std::max(static_cast<double>(cut.border.size()), 1.0);
}

// Means of luminance count for gloss as well.
void compare_relief_and_gloss(const Cut& cut, const Surface& seen, double height_unit_mm, RetouchQuality& q,
                              QualityReport* report) {
    Image<float> luminances(seen.width(), seen.height());
    for (std::size_t i = 0; i < luminances.size(); ++i)
        luminances.pixels()[i] = luminance(seen.diffuse.pixels()[i]);
    const Sides height = cut.sides_of(seen.height_mm), specular = cut.sides_of(seen.specular),
                roughness = cut.sides_of(seen.roughness), light = cut.sides_of(luminances);
    q.height_mm = step_of(height, cut.border);
    q.height_mm.mean *= height_unit_mm, q.height_mm.rms *= height_unit_mm;
    q.specular = step_of(specular, cut.border);
    q.roughness = step_of(roughness, cut.border);
    const auto gloss = [&](Image<float> Sides::*side, std::size_t i) {
        return Gloss{(specular.*side).pixels()[i], (roughness.*side).pixels()[i],
                     std::max((light.*side).pixels()[i], 1e-4f)};
    };
    for (const std::size_t i : cut.border)
        q.gloss_step += gloss_difference(gloss(&Sides::within, i), gloss(&Sides::without, i)) /
                        static_cast<double>(cut.border.size());
    if (!report) return;
    for (int y = 0; y < cut.retouch.height(); ++y)
        for (int x = 0; x < cut.retouch.width(); ++x) {
            if (!inside(cut.retouch(x, y))) continue;
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(cut.retouch.width()) +
                static_cast<std::size_t>(x);
            const int u = x + cut.region.x0, v = y + cut.region.y0;
            report->height_mm(u, v) = static_cast<float>(height_unit_mm) *
                                      (height.within.pixels()[i] - height.carried_on.pixels()[i]);
            report->gloss(u, v) =
                static_cast<float>(gloss_difference(gloss(&Sides::within, i), gloss(&Sides::carried_on, i)));
        }
}

// A place that is compared, and where its figures go; of a retouch, the maps too.
struct ComparedPlace {
    Outline outline;
    RetouchQuality* quality = nullptr;
    bool retouch = false;
};

struct Comparison {
    const Canvas& canvas;
    const MaskRegions& numbers;
    const Mask& damaged;
    std::span<const Illuminant> illuminants;
    const QualityOptions& options;

    // Memory is that of the place and its surroundings.
    void compare(const ComparedPlace& place, QualityReport& result) const {
        RetouchQuality& q = *place.quality;
        const MaskRegion& region = numbers.regions[static_cast<std::size_t>(place.outline.number - 1)];
        const auto& [number, dx, dy] = place.outline;
        q.box = {region.box.x0 + dx, region.box.y0 + dy, region.box.x1 + dx, region.box.y1 + dy};
        q.area_mm2 = region.pixels * canvas.mm_per_pixel() * canvas.mm_per_pixel();
        q.delta_e.fill(std::numeric_limits<double>::quiet_NaN());
        q.border_delta_e = q.delta_e;
        const Cut cut = cut_of(canvas, numbers, place.outline, damaged, options);
        q.border_px = static_cast<int>(cut.border.size());
        for (const Illuminant illuminant : illuminants) {
            compare_colour(cut, appearance_in(canvas, cut.region, {.illuminant = illuminant}).diffuse,
                           static_cast<std::size_t>(illuminant), q,
                           place.retouch ? &result.delta_e : nullptr);
        }
        compare_relief_and_gloss(cut, appearance_in(canvas, cut.region), canvas.height_unit_mm(), q,
                                 place.retouch ? &result : nullptr);
    }

    // Small ones side by side, large ones one after the other: each takes memory.
    void compare(const std::vector<ComparedPlace>& places, QualityReport& result,
                 const Progress& progress) const {
        std::vector<const ComparedPlace*> small, large;
        for (const ComparedPlace& place : places) {
            const Region& box = numbers.regions[static_cast<std::size_t>(place.outline.number - 1)].box;
            (std::int64_t(box.width()) * box.height() <= kSmall_px ? small : large).push_back(&place);
        }
        std::mutex reporting;
        std::size_t done = 0;
        const auto tell = [&](std::size_t more) {
            const std::lock_guard lock(reporting);
            done += more;
            report(progress, "compare retouches",
                   static_cast<double>(done) / static_cast<double>(places.size()));
        };
        tell(0);
        parallel_for(0, static_cast<int>(small.size()), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) compare(*small[static_cast<std::size_t>(i)], result);
            tell(static_cast<std::size_t>(end - begin));
        });
        for (const ComparedPlace* place : large) {
            compare(*place, result);
            tell(1);
        }
    }
};

}  // namespace

Image<Rgb> look_under(const Canvas& canvas, Illuminant illuminant, const Progress& progress) {
    return appearance(canvas, {.illuminant = illuminant}, progress).diffuse;
}

RetouchQuality mean_of(std::vector<RetouchQuality> regions) {
    TP_REQUIRE(!regions.empty(), "a mean is of something");
    RetouchQuality mean = regions.front();
    mean.undamaged.clear();
    const double part = 1 / static_cast<double>(regions.size());
    const auto take = [&](auto member) {
        double sum = 0;
        for (RetouchQuality& q : regions) sum += part * member(q);
        member(mean) = sum;
    };
    for (std::size_t illuminant = 0; illuminant < kIlluminants; ++illuminant) {
        take([illuminant](RetouchQuality& q) -> double& { return q.delta_e[illuminant]; });
        take([illuminant](RetouchQuality& q) -> double& { return q.border_delta_e[illuminant]; });
    }
    take([](RetouchQuality& q) -> double& { return q.gloss_step; });
    for (Step RetouchQuality::*step :
         {&RetouchQuality::height_mm, &RetouchQuality::specular, &RetouchQuality::roughness}) {
        take([step](RetouchQuality& q) -> double& { return (q.*step).mean; });
        take([step](RetouchQuality& q) -> double& { return (q.*step).rms; });
    }
    return mean;
}

QualityReport quality_of(const Canvas& canvas, const Mask& mask, const Mask& damaged,
                         std::span<const Illuminant> illuminants, const QualityOptions& options,
                         const Progress& progress) {
    validate(options);
    validate(options.annulus);
    TP_REQUIRE(mask.region() == canvas.region(), "the mask is the painting's");
    TP_REQUIRE(damaged.empty() || damaged.region() == mask.region(), "the mask is the painting's");
    const MaskRegions numbers = regions_of(mask);
    if (numbers.regions.empty()) fail("the mask is empty; give that of the retouch");
    QualityReport result;
    result.delta_e = result.height_mm = result.gloss = Image<float>(mask.width(), mask.height());
    // The retouches, and undamaged places beside each.
    const double gap_px = options.annulus.gap_mm / canvas.mm_per_pixel();
    Mask intact = dilated(mask, gap_px);
    if (!damaged.empty()) intact = united(intact, damaged);
    for (std::size_t i = 0; i < intact.size(); ++i)
        intact.pixels()[i] =
            inside(intact.pixels()[i]) || !(canvas.dry().confidence.pixels()[i] > 0) ? 0.0f : 1.0f;
    std::vector<ComparedPlace> places;
    result.regions.resize(numbers.regions.size());
    for (std::size_t i = 0; i < numbers.regions.size(); ++i) {
        const int number = static_cast<int>(i) + 1;
        RetouchQuality& q = result.regions[i];
        places.push_back({{number, 0, 0}, &q, true});
        const std::vector<Outline> beside =
            undamaged_places(numbers, number, intact, static_cast<int>(std::ceil(2 * gap_px)) + 2);
        q.undamaged.resize(beside.size());
        for (std::size_t k = 0; k < beside.size(); ++k) places.push_back({beside[k], &q.undamaged[k], false});
    }
    intact = Mask();  // as large as the painting
    Comparison{canvas, numbers, damaged, illuminants, options}.compare(places, result, progress);
    return result;
}

}  // namespace tangi
