// focal_evidence.cpp: see focal_evidence.h.
#include "capture/sphere_lights/focal_evidence.h"

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr double kHeightSigma = 0.05;  // [radii] of a height that was measured
constexpr double kShortLens = 0.9;     // [1] diagonal / focal length of a lens of 48 mm (35-mm equivalent)
constexpr double kContradict = 3.5;    // [standard errors] between two that cannot both be right
constexpr double kAgree = 1;           // up to which they do without any doubt

double apart(const FocalEvidence& a, const FocalEvidence& b) {
    return std::abs(a.inverse_focal.value - b.inverse_focal.value) /
           std::hypot(a.inverse_focal.sigma, b.inverse_focal.sigma);
}

// In the photographs, by us.
bool is_measured(const FocalEvidence& e) {
    return e.source == FocalSource::highlights || e.source == FocalSource::outlines;
}

struct Pair {
    std::size_t first = 0, second = 0;
    double apart = 0;
};

Pair worst_pair(const std::vector<FocalEvidence>& evidence) {
    Pair worst;
    for (std::size_t i = 0; i < evidence.size(); ++i)
        for (std::size_t j = i + 1; j < evidence.size(); ++j)
            if (const double far = apart(evidence[i], evidence[j]); far > worst.apart) worst = {i, j, far};
    return worst;
}

// How badly the evidence fits the others; of two that only fit each other badly, what was measured in the
// pictures stays.
double strangeness(const std::vector<FocalEvidence>& evidence, std::size_t at) {
    double sum = 0;
    for (const FocalEvidence& other : evidence) {
        const double far = apart(evidence[at], other);
        sum += far * far;
    }
    return sum + (is_measured(evidence[at]) ? 0 : evidence[at].source == FocalSource::lengths ? 2e-3 : 1e-3);
}

std::optional<Known> mean_of(const std::vector<FocalEvidence>& evidence) {
    double weights = 0, sum = 0;
    for (const FocalEvidence& e : evidence) {
        const double weight = 1 / (e.inverse_focal.sigma * e.inverse_focal.sigma);
        weights += weight;
        sum += weight * e.inverse_focal.value;
    }
    if (!(weights > 0)) return std::nullopt;
    return Known{sum / weights, 1 / std::sqrt(weights)};
}

// What a source would have to say to agree with what the others agree on; nothing where it does itself. Of
// two alone either may be wrong.
std::optional<Known> would_be(const FocalVerdict& verdict, FocalSource source) {
    if (!verdict.uses(source)) return mean_of(verdict.agree);
    return verdict.agree.size() > 1 ? std::nullopt : mean_of(verdict.disagree);
}

std::string focal_text(const Known& inverse_focal) {
    if (!(inverse_focal.value > inverse_focal.sigma))
        return fmt::format("{:.0f} px or more", 1 / (inverse_focal.value + inverse_focal.sigma));
    const double focal = 1 / inverse_focal.value;
    return fmt::format("{:.0f} ± {:.0f} px", focal, focal * inverse_focal.sigma / inverse_focal.value);
}

}  // namespace

Known MeasuredLengths::height() const {
    const double radius = sphere_radius_mm.value_or(1);
    if (sphere_height_mm && sphere_radius_mm) return {*sphere_height_mm, kHeightSigma * radius};
    return {radius, radius};
}

std::optional<Known> MeasuredLengths::depth() const {
    if (!sphere_radius_mm || !camera_distance_mm) return std::nullopt;
    const Known high = height();
    if (!(*camera_distance_mm > high.value + *sphere_radius_mm))
        fail(
            "--camera-distance-mm {:g}: spheres of {:g} mm radius whose centres are {:g} mm above the "
            "painting "
            "do not "
            "fit between camera and painting; is the distance in millimetres, and --sphere-height-mm?",
            *camera_distance_mm, *sphere_radius_mm, high.value);
    return Known{*camera_distance_mm - high.value,
                 std::hypot(high.sigma, MeasuredLengths::kDistanceSigma * *camera_distance_mm)};
}

std::optional<FocalEvidence> evidence_of_lengths(const MeasuredLengths& lengths, const Known& radius_px) {
    const std::optional<Known> depth = lengths.depth();
    if (!depth) return std::nullopt;
    const double inverse = *lengths.sphere_radius_mm / (radius_px.value * depth->value);
    return FocalEvidence{
        FocalSource::lengths,
        {inverse, inverse * std::hypot(depth->sigma / depth->value, radius_px.sigma / radius_px.value)}};
}

std::optional<FocalEvidence> evidence_of_outline(const Known& elongation, double offset_px,
                                                 double diagonal_px) {
    if (!(offset_px > 1)) return std::nullopt;
    const auto inverse_of = [&](double e) {
        return std::sqrt(std::max(0.0, (1 + e) * (1 + e) - 1)) / offset_px;
    };
    const double middle = inverse_of(elongation.value),
                 high = inverse_of(std::max(elongation.value, 0.0) + elongation.sigma),
                 low = inverse_of(elongation.value - elongation.sigma);
    const double sigma = std::max(high - middle, middle - low);
    if (sigma > any_lens(diagonal_px).sigma) return std::nullopt;
    return FocalEvidence{FocalSource::outlines, {middle, sigma}};
}

Known any_lens(double diagonal_px) { return {0, kShortLens / diagonal_px}; }

std::vector<Known> FocalVerdict::alternatives() const {
    std::vector<Known> all = {inverse_focal};
    if (disagree.empty())
        for (const FocalEvidence& e : agree)
            if (!is_measured(e)) all.push_back(e.inverse_focal);
    for (const FocalEvidence& e : disagree) {
        int against = 0;
        for (const FocalEvidence& other : agree)
            if (apart(e, other) > kContradict) against += is_measured(other) ? 2 : 1;
        if (against < 2) all.push_back(e.inverse_focal);
    }
    return all;
}

bool FocalVerdict::uses(FocalSource source) const {
    return std::any_of(agree.begin(), agree.end(),
                       [&](const FocalEvidence& e) { return e.source == source; });
}

double FocalVerdict::doubt() const {
    return std::clamp((disagreement - kAgree) / (kContradict - kAgree), 0.0, 1.0);
}

FocalVerdict judge(const std::vector<FocalEvidence>& evidence, double diagonal_px) {
    FocalVerdict verdict{.inverse_focal = any_lens(diagonal_px), .agree = evidence, .disagree = {}};
    verdict.disagreement = worst_pair(evidence).apart;
    while (true) {
        const Pair worst = worst_pair(verdict.agree);
        if (!(worst.apart > kContradict)) break;
        const std::size_t out =
            strangeness(verdict.agree, worst.first) > strangeness(verdict.agree, worst.second) ? worst.first
                                                                                               : worst.second;
        verdict.disagree.push_back(verdict.agree[out]);
        verdict.agree.erase(verdict.agree.begin() + static_cast<std::ptrdiff_t>(out));
    }
    std::vector<FocalEvidence> all = verdict.agree;
    all.push_back({FocalSource::given, any_lens(diagonal_px)});
    verdict.inverse_focal = *mean_of(all);
    return verdict;
}

std::string contradiction_of(const FocalVerdict& verdict, const MeasuredLengths& lengths,
                             const Known& radius_px) {
    if (verdict.disagree.empty()) return {};
    std::vector<FocalEvidence> all = verdict.agree;
    all.insert(all.end(), verdict.disagree.begin(), verdict.disagree.end());
    std::string measured, given;
    for (const FocalEvidence& e : all) {
        if (e.source == FocalSource::highlights)
            measured +=
                fmt::format("the highlights say that the focal length is {}; ", focal_text(e.inverse_focal));
        const bool odd = std::any_of(all.begin(), all.end(), [&](const FocalEvidence& other) {
            return apart(e, other) > kContradict;
        });
        if (e.source == FocalSource::outlines && odd)
            measured += fmt::format("the outline's shape says that the focal length is {}; ",
                                    focal_text(e.inverse_focal));
    }
    const auto add = [&](const std::string& what, double is, const std::string& should) {
        given += fmt::format("{}{} {:g} would have to be {}", given.empty() ? "" : ", or ", what, is, should);
    };
    if (lengths.focal_px)
        if (const auto rest = would_be(verdict, FocalSource::given))
            add("the focal length (--focal-px, --focal-35mm)", *lengths.focal_px, focal_text(*rest));
    const std::optional<Known> depth = lengths.depth();
    if (const auto rest = would_be(verdict, FocalSource::lengths); depth && rest && rest->value > 0) {
        const double radius = *lengths.sphere_radius_mm,
                     deep = radius / (radius_px.value * rest->value);  // [mm] as the others say
        const double high = lengths.height().value;
        add("--camera-distance-mm", *lengths.camera_distance_mm, fmt::format("{:.0f}", deep + high));
        add(lengths.sphere_height_mm ? "--sphere-height-mm" : "--sphere-height-mm, taken to be", high,
            fmt::format("{:.0f}", *lengths.camera_distance_mm - deep));
        add("--sphere-radius-mm", radius, fmt::format("{:.2f}", radius * depth->value / deep));
    }
    return fmt::format(
        "what is given contradicts what the photographs show: spheres are seen with a radius of {:.1f} ± "
        "{:.1f} px; "
        "{}{}. Measure again; the stated errors allow for each of these being wrong",
        radius_px.value, radius_px.sigma, measured, given);
}

}  // namespace tangi
