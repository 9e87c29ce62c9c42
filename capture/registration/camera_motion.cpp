#include "capture/registration/camera_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "capture/registration/motion_template.h"
#include "capture/stack/duplicate_photos.h"
#include "surface/base/median.h"
#include "surface/base/parallel.h"

namespace tangi {

using glm::dvec2;
using glm::dvec4;
using namespace motion_template;

namespace {

constexpr double kMoved = 0.25;  // [pixels of the reduced photographs] rms from which on a camera moved
// [1] Standard deviation of the zoom that is expected where few edges tell it: what focusing anew changes a
// lens's magnification by is of this order.
constexpr double kZoomSigma = 0.01;
constexpr int kTurns = 3;  // of the template, at most
// [standard deviations of chance] by which the median photograph agrees with the others, for a photograph to
// be missed that does so by a quarter of it: a rock among grey spheres of which all of the background is
// alike has 1.8 of 9.8, the least of any photograph of canvas, coin, door, fresco, icon and leaf 12.7
// of 27.6.
constexpr double kBeyondChance = 5, kAsMuchByChance = 0.25;
constexpr int kElsewhere = 24;     // places where a photograph is laid to see what chance makes
constexpr double kSettled = 0.01;  // [pixels] change of every drift below which another turn is no use

// Normal equations of what the template moves by, robustly.
struct DriftEquations {
    glm::dmat4 normal{0};
    dvec4 right{0};
    double residuals = 0;  // sum of weighted squares
};

DriftEquations drift_equations(const Directions& photo, const std::vector<TemplatePixel>& pixels,
                               const ToPhoto& to_photo) {
    // The photograph's edges may be stronger or weaker as a whole.
    double cross = 0, square = 0;
    std::vector<float> values(2 * pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const dvec2 p = to_photo({pixels[i].x, pixels[i].y});
        values[2 * i] = sample(photo.cosine, p.x, p.y);
        values[2 * i + 1] = sample(photo.sine, p.x, p.y);
        for (std::size_t c = 0; c < 2; ++c) {
            cross += static_cast<double>(values[2 * i + c]) * pixels[i].value[c];
            square += static_cast<double>(pixels[i].value[c]) * pixels[i].value[c];
        }
    }
    const double scale = std::max(cross / std::max(square, 1e-12), 0.05);
    DriftEquations equations;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (std::size_t c = 0; c < 2; ++c) {
            const double r = values[2 * i + c] - scale * pixels[i].value[c];
            const double weight = 1 / (1 + r * r / (0.03 * 0.03));
            const dvec4 slope = scale * pixels[i].slope[c];
            equations.normal += weight * glm::outerProduct(slope, slope);
            equations.right += weight * r * slope;
            equations.residuals += weight * r * r;
        }
    return equations;
}

// Moves `drift` until the photograph agrees best with the template; its zoom only where it may.
void follow(const Directions& photo, const std::vector<TemplatePixel>& pixels, const dvec2& centre,
            bool zooms, CameraMotion& drift) {
    const double span = std::max(centre.x, centre.y);
    for (int iteration = 0; iteration < 15; ++iteration) {
        auto [normal, right, residuals] = drift_equations(photo, pixels, ToPhoto(drift, centre));
        for (int k = 0; k < 4; ++k) normal[k][k] *= 1 + 1e-9;
        if (!(glm::determinant(glm::dmat3(normal)) > 1e-12 * span * span)) return;
        // Neighbouring pixels are not independent: the blur makes about ten of them one.
        const double variance = 10 * residuals / static_cast<double>(2 * pixels.size());
        const double prior = variance / (kZoomSigma * kZoomSigma);
        normal[3][3] += prior;
        right[3] += prior * (drift.zoom - 1);
        if (!zooms) {
            for (int k = 0; k < 3; ++k) normal[3][k] = normal[k][3] = 0;
            right[3] = 0;
        }
        const glm::dmat4 inverse = glm::inverse(normal);
        const dvec4 step = inverse * right;  // photo(p) = template(p + step): the template moves back
        drift.shift_px -= dvec2(step);
        drift.roll_rad -= step.z;
        drift.zoom -= step.w;
        drift.sigma_px = std::sqrt(variance * std::max(inverse[0][0], inverse[1][1]));
        if (glm::length(dvec2(step)) < 1e-3 && std::max(std::abs(step.z), std::abs(step.w)) * span < 1e-3)
            break;
    }
}

// [1] Correlation of a photograph's edges with the template of `count` photographs less its own part in it,
// where the drift and an offset lay them on each other.
double agreement_of(const Directions& photo, const std::vector<TemplatePixel>& pixels, const dvec2& centre,
                    CameraMotion drift, std::size_t count, const dvec2& offset = {0, 0}) {
    drift.shift_px += offset;
    const ToPhoto to_photo(drift, centre);
    const double own = offset == dvec2(0) ? 1 / static_cast<double>(count) : 0;
    const dvec2 most(photo.cosine.cols - 1, photo.cosine.rows - 1);
    double cross = 0, square = 0, others = 0;
    for (const TemplatePixel& pixel : pixels) {
        const dvec2 p = to_photo({pixel.x, pixel.y});
        if (p.x < 0 || p.y < 0 || p.x > most.x || p.y > most.y) continue;
        const double values[2] = {sample(photo.cosine, p.x, p.y), sample(photo.sine, p.x, p.y)};
        for (std::size_t c = 0; c < 2; ++c) {
            const double other = pixel.value[c] - own * values[c];
            cross += values[c] * other;
            square += values[c] * values[c];
            others += other * other;
        }
    }
    const double all = std::sqrt(square * others);
    return all > 0 ? cross / all : 0;
}

// How strong a photograph's edges are all over the picture.
double strength_of(const Directions& photo) {
    cv::Mat strength;
    cv::magnitude(photo.cosine, photo.sine, strength);
    return cv::mean(strength)[0];
}

// [1] What correlates by chance: mean and standard deviation of the agreement where the photograph is laid
// elsewhere, by an eighth of the picture and more.
struct Chance {
    double mean = 0, sigma = 0;
};
Chance chance_of(const Directions& photo, const std::vector<TemplatePixel>& pixels, const dvec2& centre,
                 const CameraMotion& drift, std::size_t count) {
    double sum = 0, squares = 0;
    for (int k = 0; k < kElsewhere; ++k) {
        const double angle = k * std::numbers::pi * (3 - std::sqrt(5.0));  // golden: all around
        const double reach = 0.125 + 0.2 * (k + 0.5) / kElsewhere;
        const dvec2 offset = 2.0 * centre * reach * dvec2(std::cos(angle), std::sin(angle));
        const double a = agreement_of(photo, pixels, centre, drift, count, offset);
        sum += a, squares += a * a;
    }
    const double mean = sum / kElsewhere;
    return {mean, std::sqrt(std::max((squares - sum * mean) / (kElsewhere - 1), 1e-12))};
}

void find_strange(const std::vector<Directions>& all, const std::vector<TemplatePixel>& pixels,
                  const dvec2& centre, std::vector<CameraMotion>& drifts) {
    if (all.size() < kFewestToTellStrays) return;
    std::vector<double> correlations(all.size()), strengths(all.size()), beyond_chance(all.size());
    parallel_for(0, static_cast<int>(all.size()), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            correlations[i] = agreement_of(all[i], pixels, centre, drifts[i], all.size());
            strengths[i] = strength_of(all[i]);
            const Chance chance = chance_of(all[i], pixels, centre, drifts[i], all.size());
            beyond_chance[i] = (correlations[i] - chance.mean) / chance.sigma;
            drifts[i].agreement = correlations[i];
        }
    });
    const double usual = median(strengths), usually_beyond = median(beyond_chance);
    const bool agreed = median(correlations) > kOthersAgree;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool nothing = agreed && correlations[i] <= kNothingAlike;
        const bool by_chance =
            usually_beyond > kBeyondChance && beyond_chance[i] < kAsMuchByChance * usually_beyond;
        drifts[i].strange = strengths[i] > kEdgesOfItsOwn * usual && (nothing || by_chance);
    }
}

// Whether the zooms displace the photographs by more than lights do that go round: 0.1 pixels (rms) of
// generated paintings whose camera did not zoom, 0.4 where it did, by 1.2 % from the first to the last.
bool zooms_by_more(const std::vector<CameraMotion>& drifts, const dvec2& centre) {
    double squares = 0;
    for (const CameraMotion& d : drifts) {
        const double by = CameraMotion{.zoom = d.zoom}.displacement_px(centre);
        squares += by * by / static_cast<double>(drifts.size());
    }
    return std::sqrt(squares) > kMoved;
}

// All photographs' edges, blurred by so many pixels.
std::vector<Directions> directions_of_all(const GreyPhotos& photos, double blur) {
    std::vector<Directions> all(photos.mean.size());
    parallel_for(0, static_cast<int>(all.size()), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            all[static_cast<std::size_t>(i)] =
                directions_of(photos.mean[static_cast<std::size_t>(i)], photos.step, blur);
    });
    return all;
}

// Drifts from their median.
void take_off_median(std::vector<CameraMotion>& drifts) {
    std::vector<double> x, y, roll, zoom;
    for (const CameraMotion& d : drifts) {
        x.push_back(d.shift_px.x);
        y.push_back(d.shift_px.y);
        roll.push_back(d.roll_rad);
        zoom.push_back(d.zoom);
    }
    for (CameraMotion& d : drifts) {
        d.shift_px -= dvec2(median(x), median(y));
        d.roll_rad -= median(roll);
        d.zoom /= median(zoom);
    }
}

// [pixels] The largest.
double change_of(const std::vector<CameraMotion>& drifts, const std::vector<CameraMotion>& before,
                 const dvec2& centre) {
    double change = 0;
    for (std::size_t i = 0; i < drifts.size(); ++i)
        change = std::max(
            change, CameraMotion{drifts[i].shift_px - before[i].shift_px,
                                 drifts[i].roll_rad - before[i].roll_rad, drifts[i].zoom / before[i].zoom}
                        .displacement_px(centre));
    return change;
}

// Lays all photographs on their mean, and again on what that makes of it. `progress` from 0 to 1. False where
// too few edges are clear.
bool follow_all(const std::vector<Directions>& all, const dvec2& centre, bool zooms,
                std::vector<CameraMotion>& drifts, const std::function<void(double)>& progress) {
    for (int turn = 0; turn < kTurns; ++turn) {
        progress(turn / static_cast<double>(kTurns));
        const auto pixels = template_pixels(mean_of(all, drifts, centre), centre);
        if (pixels.size() < 500) return false;
        const std::vector<CameraMotion> before = drifts;
        parallel_for(0, static_cast<int>(all.size()), 1, [&](int begin, int end) {
            for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                follow(all[i], pixels, centre, zooms, drifts[i]);
        });
        take_off_median(drifts);
        if (change_of(drifts, before, centre) < kSettled) break;  // another template would be the same
    }
    return true;
}

// Whether the camera moved, by those photographs that are not strange; what these did means nothing.
void judge_motion(const dvec2& centre, double reduction, CameraMotions& motions) {
    double squares = 0, counted = 0;
    for (CameraMotion& d : motions.photos) {
        if (d.strange) {
            d = {.agreement = d.agreement, .strange = true};
            continue;
        }
        const double displacement = d.displacement_px(centre);
        squares += displacement * displacement;
        ++counted;
    }
    squares /= std::max(counted, 1.0);
    motions.moved = std::sqrt(squares) > kMoved;
    motions.rms_px = std::sqrt(squares) * reduction;
}

// The first photograph's frame becomes the common one: a pixel goes there, then to the photograph. In pixels
// of whole photographs; their centre is the reduced picture's but for half a pixel.
void refer_to_first(const dvec2& centre, double reduction, CameraMotions& motions) {
    const CameraMotion reference = motions.photos.front();
    for (CameraMotion& d : motions.photos) {
        const dvec2 middle = d.to_photo(reference.to_common(centre, centre), centre);
        d.roll_rad -= reference.roll_rad;
        d.zoom /= reference.zoom;
        d.shift_px = middle - centre;
        if (!motions.moved) d.shift_px = {0, 0}, d.roll_rad = 0, d.zoom = 1;
        d.shift_px *= reduction;
        d.sigma_px *= reduction;
    }
}

}  // namespace

dvec2 CameraMotion::to_photo(const dvec2& pixel, const dvec2& centre) const {
    return ToPhoto(*this, centre)(pixel);
}

dvec2 CameraMotion::to_common(const dvec2& pixel, const dvec2& centre) const {
    const dvec2 d = (pixel - shift_px - centre) / zoom;
    const double c = std::cos(roll_rad), s = std::sin(roll_rad);
    return centre + dvec2(c * d.x + s * d.y, -s * d.x + c * d.y);
}

double CameraMotion::displacement_px(const dvec2& centre) const {
    // Of the distance from the centre, the mean square over a rectangle is a third of the corners'.
    const double turned = zoom * zoom + 1 - 2 * zoom * std::cos(roll_rad);
    return std::sqrt(glm::dot(shift_px, shift_px) + turned * glm::dot(centre, centre) / 3);
}

CameraMotions find_camera_motions(const GreyPhotos& photos, const Progress& progress) {
    const std::size_t count = photos.mean.size();
    CameraMotions result;
    result.photos.resize(count);
    const Image<float>& first = photos.mean.front();
    if (count < 2 || first.width() < 32 || first.height() < 32) return result;
    const dvec2 centre((first.width() - 1) / 2.0, (first.height() - 1) / 2.0);
    const auto shown = [&](double from) {
        return [&progress, from](double part) { report(progress, "drift", from + part / 2); };
    };
    // From coarse to fine.
    if (!follow_all(directions_of_all(photos, 3), centre, true, result.photos, shown(0)))
        return {.photos = std::vector<CameraMotion>(count)};
    const bool zooms = zooms_by_more(result.photos, centre);
    if (!zooms)
        for (CameraMotion& d : result.photos) d.zoom = 1;
    const std::vector<Directions> fine = directions_of_all(photos, 1);
    if (!follow_all(fine, centre, zooms, result.photos, shown(0.5)))
        return {.photos = std::vector<CameraMotion>(count)};
    find_strange(fine, template_pixels(mean_of(fine, result.photos, centre), centre), centre, result.photos);
    judge_motion(centre, photos.reduction, result);
    refer_to_first(centre, photos.reduction, result);
    report(progress, "drift", 1);
    return result;
}

}  // namespace tangi
