#include "capture/spheres/given_outline.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "capture/spheres/outline_profiles.h"
#include "surface/base/parallel.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kClick_px = 0.6, kClickOfRadius = 0.02;
constexpr double kSigmas = 3;  // of what is given, within which the sphere is looked for
// [1 per pixel of the outline] By how much the logarithm of the likelihood grows with agreement(): edges of
// one pattern are not independent of each other. And [pixels] what the radius of the outermost clear ring
// tells of the sphere's: right inside its outline a mirror shows what lies around it, compressed to a band of
// dense edges. Of 58 rendered spheres of 26 and 32 pixels radius on patterns from canvas to noise, circles
// off by up to a pixel: 98 % of centres and radii lie within two standard deviations; with a likelihood of 1,
// 96
// %, and without the last two numbers 83 % of the radii.
constexpr double kLikelihood = 0.7;
constexpr double kRingSigma_px = 0.7, kRingInside_px = 0.15;
// [1] agreement() by which another place must be better to be believed against what was given. Patterns alone
// reach 0.08 (the same spheres, up to 4 pixels from the circle).
constexpr double kTellsClearlyBetter = 0.3;
constexpr double kSearched = 0.05;         // [1] of the radius, and ...
constexpr double kSearchedAtLeast_px = 2;  // ... where refine_outline() looks for an outline
constexpr double kTellsMore = 0.5;  // [1] of the circle's errors: what is less certain moves it for nothing
// [1] Of the edges on an outline that was found, those on a circle outside of it, which make it a ring
// inside.
constexpr double kSeenToo = 0.5;
// Of an outline that is as certain as least squares say: its edges lie on it, nearly all around. On smooth
// patterns, edges of the mirrored picture make one with edges 0.3 pixels off and more.
constexpr double kSharp_px = 0.25, kMostOfIt = 0.6;
constexpr double kFinest_px = 0.4;  // of the grid: an edge's own width is a pixel
constexpr std::size_t kFewestProfiles = 12;

struct Belief {
    dvec3 mean{0}, sigma{0};  // of the step from the middle: centre, radius
    // Of the best places within one standard error: agreement() with what is right outside, and the edges on
    // it.
    double best = 0;
};

// Numbers along one axis: from -half to half, `grid` apart.
struct Steps {
    double grid = 1;
    int half = 0;
    Steps(double sigma)
        : grid(std::max(std::min(sigma / 2, kFinest_px), sigma / 6)),
          half(static_cast<int>(std::ceil(kSigmas * sigma / grid))) {}
    int count() const { return 2 * half + 1; }
    double at(int i) const { return grid * (i - half); }
};

// agreement() with edges right outside, too: a ring that has one is not the outermost.
OutlineContrast strict_contrast(const std::vector<EdgeProfile>& profiles, const dvec3& step) {
    constexpr double nearest = 1.25;  // [pixels] an edge reaches no farther
    OutlineContrast contrast = contrast_of(profiles, step);
    double beside = 0;
    for (const EdgeProfile& profile : profiles)
        beside += profile.at(glm::dot(dvec3(profile.outwards, 1), step) + nearest);
    contrast.outside = (3 * contrast.outside + beside / static_cast<double>(profiles.size())) / 4;
    return contrast;
}

// Over a grid around the middle, `sigma` being the standard errors before.
Belief belief_of(const std::vector<EdgeProfile>& profiles, const dvec3& sigma, double outline_px) {
    const Steps xs(sigma.x), ys(sigma.y), rs(sigma.z);
    const int columns = xs.count() * ys.count();
    std::vector<double> logarithms(static_cast<std::size_t>(columns * rs.count()));
    const auto at = [&](int column, int r) { return static_cast<std::size_t>(column * rs.count() + r); };
    const auto step_at = [&](int column, int r) {
        return dvec3(xs.at(column / ys.count()), ys.at(column % ys.count()), rs.at(r));
    };
    Belief belief;
    parallel_for(0, columns, 4, [&](int begin, int end) {
        for (int column = begin; column < end; ++column)
            for (int r = 0; r < rs.count(); ++r) {
                logarithms[at(column, r)] = strict_contrast(profiles, step_at(column, r)).agreement();
            }
    });
    for (int column = 0; column < columns; ++column)
        for (int r = 0; r < rs.count(); ++r) {
            const dvec3 z = glm::abs(step_at(column, r)) / sigma;
            if (std::max({z.x, z.y, z.z}) >= 1) continue;
            belief.best = std::max(belief.best, logarithms[at(column, r)]);
        }
    for (double& value : logarithms) value *= kLikelihood * outline_px;
    const double most = *std::max_element(logarithms.begin(), logarithms.end());
    double sum = 0;
    dvec3 squares(0);
    for (int column = 0; column < columns; ++column)
        for (int r = 0; r < rs.count(); ++r) {
            const dvec3 step = step_at(column, r), z = step / sigma;
            double likelihood = 0;  // over the rings that may be what is seen of this radius
            for (int ring = 0; ring < rs.count(); ++ring) {
                const double off = (rs.at(ring) + kRingInside_px - step.z) / kRingSigma_px;
                likelihood += std::exp(logarithms[at(column, ring)] - most - off * off / 2);
            }
            const double weight = likelihood * std::exp(-glm::dot(z, z) / 2);
            sum += weight;
            belief.mean += weight * step;
            squares += weight * step * step;
        }
    if (!(sum > 0)) return {.sigma = sigma};
    belief.mean /= sum;
    const dvec3 grid(xs.grid, ys.grid, rs.grid);  // which tells no less than its own steps
    belief.sigma =
        glm::sqrt(glm::max(squares / sum - belief.mean * belief.mean, dvec3(0)) + grid * grid / 12.0 +
                  dvec3(kCentreSystematic * kCentreSystematic, kCentreSystematic * kCentreSystematic, 0));
    belief.sigma = glm::min(belief.sigma, sigma);
    return belief;
}

std::vector<EdgeProfile> profiles_within(const SphereCrops& crops, const SphereImage& sphere,
                                         const SphereCamera& camera, const dvec3& sigma) {
    constexpr double beyond = 5;  // [pixels] that contrast_of() looks outside
    return profiles_around(crops, sphere, camera,
                           kSigmas * (std::hypot(sigma.x, sigma.y) + sigma.z) + beyond);
}

double outline_length(const SphereImage& sphere) { return 2 * std::numbers::pi * sphere.radius_px; }

dvec3 sigmas_of(const SphereImage& sphere) {
    return {sphere.centre_sigma_px, sphere.centre_sigma_px, sphere.radius_sigma_px};
}

SphereImage moved(SphereImage sphere, const Belief& belief) {
    sphere.centre_px += dvec2(belief.mean);
    sphere.radius_px += belief.mean.z;
    sphere.centre_sigma_px = std::max(belief.sigma.x, belief.sigma.y);
    sphere.radius_sigma_px = belief.sigma.z;
    return sphere;
}

// The circle and the outline, by what is independent of each other in their errors: how a limb fades is a
// matter of the sphere, and stays.
SphereImage mean_of(const SphereImage& given, const SphereImage& found) {
    const auto weight = [](double sigma, double systematic) {
        return 1 / std::max(sigma * sigma - systematic * systematic, 1e-4);
    };
    const double cg = weight(given.centre_sigma_px, 0), rg = weight(given.radius_sigma_px, 0);
    const double cf = weight(found.centre_sigma_px, kCentreSystematic),
                 rf = weight(found.radius_sigma_px, kRadiusSystematic);
    return {.centre_px = (cg * given.centre_px + cf * found.centre_px) / (cg + cf),
            .radius_px = (rg * given.radius_px + rf * found.radius_px) / (rg + rf),
            .centre_sigma_px = std::hypot(1 / std::sqrt(cg + cf), kCentreSystematic),
            .radius_sigma_px = std::hypot(1 / std::sqrt(rg + rf), kRadiusSystematic)};
}

// [standard errors of `given`] the coordinate that differs most.
double apart(const SphereImage& given, const SphereImage& other) {
    const dvec2 centre = glm::abs(other.centre_px - given.centre_px);
    return std::max(std::max(centre.x, centre.y) / given.centre_sigma_px,
                    std::abs(other.radius_px - given.radius_px) / given.radius_sigma_px);
}

// Bayes's rule (Gelman et al. 2013, "Bayesian Data Analysis"): centre and radius have the circle's numbers
// and standard errors before, and what edges say of them after; mean and standard deviation of the result,
// over all places within three standard errors. Where edges say nothing, or many things, that is the circle
// again.
SphereImage weighed(const SphereCrops& crops, const SphereImage& before, const SphereCamera& camera) {
    const std::vector<EdgeProfile> profiles = profiles_within(crops, before, camera, sigmas_of(before));
    if (profiles.size() < kFewestProfiles) return before;
    return moved(before, belief_of(profiles, sigmas_of(before), outline_length(before)));
}

// The circle, where edges say no more of it than whoever gave it; each of its numbers.
SphereImage as_given(SphereImage given, const Belief& belief) {
    const double centre_sigma = std::max(belief.sigma.x, belief.sigma.y);
    if (centre_sigma < kTellsMore * given.centre_sigma_px) {
        given.centre_px += dvec2(belief.mean);
        given.centre_sigma_px = centre_sigma;
    }
    if (belief.sigma.z < kTellsMore * given.radius_sigma_px) {
        given.radius_px += belief.mean.z;
        given.radius_sigma_px = belief.sigma.z;
    }
    return given;
}

// Whether an outline that was found beside a circle is the sphere's. Inside its outline a mirror shows rings,
// of the horizon and what lies before it: where edges are on a larger one around the same middle as well, one
// of those is what was found.
bool is_outline_beside(const std::vector<EdgeProfile>& profiles, const SphereImage& given,
                       const SphereOutline& found, const OutlineContrast& contrast,
                       const std::optional<Belief>& belief) {
    if (!belief) return true;
    if (found.sphere.radius_px < given.radius_px) {
        const dvec2 off = found.sphere.centre_px - given.centre_px;
        for (const double sigmas : {-1.0, -0.5, 0.0, 0.5, 1.0})
            if (contrast_of(profiles, dvec3(off, sigmas * given.radius_sigma_px)).on > kSeenToo * contrast.on)
                return false;
    }
    return contrast.agreement() > kTellsClearlyBetter + std::max(belief->best, 0.0);
}

}  // namespace

SphereImage with_click_errors(SphereImage given) {
    given.centre_sigma_px = given.radius_sigma_px = std::max(kClick_px, kClickOfRadius * given.radius_px);
    return given;
}

GivenOutline judge_outline(const SphereCrops& crops, const SphereImage& given,
                           const std::optional<SphereOutline>& found, const SphereCamera& camera) {
    const auto verdict = [&](OutlineVerdict which, const SphereImage& sphere) {
        const double centre = glm::length(sphere.centre_px - given.centre_px);
        return GivenOutline{which, sphere, std::max(centre, std::abs(sphere.radius_px - given.radius_px))};
    };
    const std::vector<EdgeProfile> profiles = profiles_within(crops, given, camera, sigmas_of(given));
    std::optional<Belief> belief;
    if (profiles.size() >= kFewestProfiles)
        belief = belief_of(profiles, sigmas_of(given), outline_length(given));
    if (found && found->residual_px < kSharp_px && found->coverage > kMostOfIt) {
        const std::vector<EdgeProfile> there = profiles_within(crops, found->sphere, camera, dvec3(0));
        const OutlineContrast contrast = contrast_of(there, dvec3(0));
        if (contrast.stands_out()) {
            if (apart(given, found->sphere) <= kSigmas)
                return verdict(OutlineVerdict::found, mean_of(given, found->sphere));
            if (is_outline_beside(profiles, given, *found, contrast, belief))
                return verdict(OutlineVerdict::beside, found->sphere);
        }
    }
    return verdict(OutlineVerdict::given, belief ? as_given(given, *belief) : given);
}

void widen_errors(const SphereCrops& crops, SphereOutline& outline, const SphereCamera& camera) {
    const std::vector<EdgeProfile> there = profiles_within(crops, outline.sphere, camera, dvec3(0));
    if (there.empty() || contrast_of(there, dvec3(0)).stands_out()) return;
    SphereImage before = outline.sphere;
    before.centre_sigma_px = before.radius_sigma_px =
        std::max(kSearched * before.radius_px, kSearchedAtLeast_px) / 2;
    const SphereImage open = weighed(crops, before, camera);
    // It is somewhere else as likely as here.
    const auto with = [](double stated, double sigma, double off) {
        return std::max(stated, std::hypot(sigma, off));
    };
    outline.sphere.centre_sigma_px = with(outline.sphere.centre_sigma_px, open.centre_sigma_px,
                                          glm::length(open.centre_px - before.centre_px) / std::sqrt(2.0));
    outline.sphere.radius_sigma_px =
        with(outline.sphere.radius_sigma_px, open.radius_sigma_px, open.radius_px - before.radius_px);
}

}  // namespace tangi
