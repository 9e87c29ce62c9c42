#include "fit/verdict/fit_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/pipeline/fit_passes.h"

namespace tangi {

namespace {

// [sigma] Median residual from which on lights that were taken in the order of file names are doubted.
constexpr double kDoubtfulOrder = 1;

// [sigma] Median residual that generated stacks of honest photographs, gilded, brushed, varnished, noisy and
// compressed ones too, stay below; and beyond which no painting is explained, unless it is of metal alone:
// lists of lights that belong to other photographs have 2.2 to 3.1, lists that are off by one of 20 have 1.8.
constexpr double kHonest = 1.5, kUnexplained = 2;

constexpr double kDoubtfulScatter_deg =
    6;  // of lights in that order; fit/light_checks/light_outliers.h says no more beyond

constexpr double kDoubtfulTilt_deg = 5, kDoubtfulBulge_deg = 5;  // of a painting as a whole

// Beside the advice to turn lights; with a separator before it. Empty where viewers show the stored pixels.
std::string says_lights_are_as_viewed(const Stack& stack) {
    if (stack.orientation == 1) return {};
    return fmt::format(
        ". The photographs carry EXIF orientation {}, which is not applied: the lights seem to be listed for "
        "the pictures as viewers show them. Either give these flags, and the painting is as the pixels are "
        "stored; or turn the pixels of all photographs as viewers do and set the orientation to 1 (exiftran "
        "-a, or "
        "ImageMagick's mogrify -auto-orient), and leave the lights as they are",
        stack.orientation);
}

// Lights that were taken in the order of file names, since their list names no photograph.
void doubt_order_of_names(const FitReport& report, bool lights_by_order, std::vector<std::string>& reasons) {
    if (!lights_by_order) return;
    if (report.median_rms_residual > kDoubtfulOrder)
        reasons.push_back(fmt::format(
            "no name in the lights file is that of a photograph, so lights were taken in the order of the "
            "file names, and the photographs differ from the model by {}: is the order the same? Name the "
            "photographs in the lights file as they are called",
            beyond_expected(report.median_rms_residual)));
    else if (report.light_outliers.scatter_deg > kDoubtfulScatter_deg)
        reasons.push_back(fmt::format(
            "no name in the lights file is that of a photograph, so lights were taken in the order of the "
            "file names, and those that the photographs show scatter by {:.0f}° round the listed ones: is "
            "the order the same? Name the photographs in the lights file as they are called",
            report.light_outliers.scatter_deg));
}

// Lights that are listed in another order; empty where they are not.
std::string doubt_of_list_order(const FitReport& report, const LightAxes& axes) {
    // Metal fits some wrong order better where matt reflection is all that is asked: the fitted surface
    // decides.
    const bool fits_as_listed = report.median_rms_residual < kHonest;
    std::string doubt = doubt_of(report.list_order, report.signs, axes, report.order_names, fits_as_listed);
    // Single lights that are wrong, or exchanged, are told one by one.
    if (doubt.empty() && !fits_as_listed && report.light_outliers.odd.empty())
        doubt = doubt_of_any_order(report.list_order);
    return doubt;
}

// Lights whose axes are turned or mirrored; empty where they are not.
std::string doubt_of_axes(const FitReport& report, const Stack& stack, const LightAxes& axes) {
    std::string doubt = doubt_of(report.signs, report.shadow_signs, axes);
    if (!doubt.empty())
        doubt +=
            or_order(report.list_order, report.signs, report.order_names) + says_lights_are_as_viewed(stack);
    return doubt;
}

// A list that is in another order looks turned as well: one advice, the one that explains.
void doubt_lights(const FitReport& report, const Stack& stack, const LightAxes& axes,
                  std::vector<std::string>& reasons) {
    std::string order = doubt_of_list_order(report, axes);
    if (!order.empty()) {
        reasons.push_back(std::move(order));
        return;
    }
    if (std::string turned = doubt_of_axes(report, stack, axes); !turned.empty())
        reasons.push_back(std::move(turned));
    if (axes.differ() && report.median_rms_residual > kDoubtfulOrder)
        reasons.push_back(fmt::format(
            "lights were mirrored or turned as asked, and the photographs still differ from the model by {}: "
            "are they the right ones?",
            beyond_expected(report.median_rms_residual)));
    for (std::string& odd : doubts_of(report.light_outliers, report.photo_names))
        reasons.push_back(std::move(odd));
}

// Photographs that the model does not explain, for no reason that was found.
void doubt_unexplained(const FitReport& report, std::vector<std::string>& reasons) {
    if (!reasons.empty() || !(report.median_rms_residual > kUnexplained) ||
        !is_in_matt_paint(report.photo_misfits))
        return;
    const std::string not_by = ruled_out(report.photo_misfits);
    reasons.push_back(fmt::format(
        "photographs differ from the model by {}, in matt paint, too{}: are the lights those of these "
        "photographs, in their order, and the photographs all of one painting, not turned or mirrored?",
        beyond_expected(report.median_rms_residual),
        not_by.empty() ? "" : fmt::format(" ({} were looked for, and it is none of them)", not_by)));
}

// Too little that was measured.
void doubt_pixels(const FitReport& report, std::vector<std::string>& reasons) {
    const double fitted =
        static_cast<double>(report.fitted) / static_cast<double>(std::max(report.pixels, 1L));
    if (report.fitted == 0)
        reasons.push_back("no pixel could be measured: the photographs are too dark, clipped, or masked out");
    else if (report.median_confidence < 0.5)
        reasons.push_back(
            fmt::format("the median confidence is only {:.2f}: the photographs leave the normals open; where "
                        "much of them is a dark background, --crop or --mask leaves that out",
                        report.median_confidence));
    if (fitted > 0 && report.not_converged > report.fitted / 2)
        reasons.push_back(fmt::format("{} of {} pixels did not converge; try --max-iterations 100",
                                      report.not_converged, report.fitted));
}

}  // namespace

std::vector<std::string> poor_reasons(const FitReport& report, const UsableStack& opened,
                                      const LightAxes& axes) {
    std::vector<std::string> reasons = opened.poor;
    doubt_order_of_names(report, opened.lights_by_order, reasons);
    if (!report.turned_doubt.empty()) reasons.push_back(report.turned_doubt);
    if (!report.transfer.doubt.empty()) reasons.push_back(report.transfer.doubt);
    doubt_lights(report, opened.stack, axes, reasons);
    if (report.lights.bent_most)
        reasons.push_back(
            "the object was taken to be flat as a whole, and the lights' directions had to turn across the "
            "picture for that by as much as they may: if it is round or bulges, fit with --shape relief");
    if (report.sharpening.found()) reasons.push_back(says_sharpened(report.sharpening));
    for (std::string& cause : doubts_of(report.photo_misfits, report.photo_names))
        reasons.push_back(std::move(cause));
    doubt_unexplained(report, reasons);
    doubt_pixels(report, reasons);
    return reasons;
}

std::string says_none_is_held_out(std::size_t asked, const FitResult& fit) {
    const auto& photos = fit.surface.photography.photos;
    if (asked == 0 ||
        std::any_of(photos.begin(), photos.end(), [](const auto& photo) { return !photo.fitted; }))
        return {};
    return fmt::format(
        "all {} photographs of --hold-out were rejected (photographs.rejected has the reasons), so that "
        "nothing tells "
        "how well the painting predicts light that the fit never saw; hold out others",
        asked);
}

std::vector<std::string> fit_warnings(const FitReport& report) {
    std::vector<std::string> warnings = report.warnings;
    if (report.support_tilt_deg > kDoubtfulTilt_deg)
        warnings.push_back(
            fmt::format("the normals tilt by {:.0f} degrees as a whole, as if the painting did not face the "
                        "camera; if it did, the "
                        "light directions are off by about as much",
                        report.support_tilt_deg));
    if (const double bulge = report.support_bulge_deg; std::abs(bulge) > kDoubtfulBulge_deg)
        warnings.push_back(fmt::format(
            "the normals turn {} by {:.0f} degrees from the middle of the picture to its corners, as on a "
            "painting that {}; if it is flat, the lights were {} than is taken here: their positions "
            "(capture.json, --lights-mm), or more photographs, would tell",
            bulge > 0 ? "outwards" : "inwards", std::abs(bulge), bulge > 0 ? "bulges" : "is hollow",
            bulge > 0 ? "nearer" : "farther away"));
    if (report.fitted > 0 && !report.height.converged)
        warnings.push_back(fmt::format(
            "the height has not converged after {} cycles (residual {:.1g}), so that its long waves "
            "may be off; give --max-cycles more",
            report.height.cycles, report.height.residual));
    return warnings;
}

}  // namespace tangi
