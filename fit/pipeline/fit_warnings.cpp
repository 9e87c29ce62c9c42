#include "fit/pipeline/fit_warnings.h"

#include "fit/calibration/light_sample.h"
#include "fit/exchange/float_scale.h"

namespace tangi {

namespace {

// Whether so much is clipped that what paint reflects is open: only lower bounds are left.
bool warn_of_clipping(Stack& stack, const Survey& surveyed) {
    constexpr double kMuch = 0.05;  // [1] of the values: highlights alone are less
    if (stack.bits == 32) return false;
    double clipped = 0;
    std::size_t worst = 0;
    for (std::size_t i = 0; i < surveyed.photos.size(); ++i) {
        clipped += surveyed.photos[i].clipped / static_cast<double>(surveyed.photos.size());
        if (surveyed.photos[i].clipped > surveyed.photos[worst].clipped) worst = i;
    }
    if (!(clipped > kMuch)) return false;
    stack.warnings.push_back(
        fmt::format("{}: {:.0f} % of the values are clipped, in {} {:.0f} %: the photographs are "
                    "overexposed, and how much "
                    "the brightest paint reflects is lost; expose less, or take --brackets",
                    stack.folder.string(), 100 * clipped, stack.photos[worst].light.name,
                    100 * surveyed.photos[worst].clipped));
    return true;
}

}  // namespace

std::string says_too_dark(const Stack& stack, const Survey& surveyed, const Transfer& transfer,
                          const NoiseModel& noise) {
    if (stack.bits == 32 && !stack.development) return {};  // floats have no full scale
    const double bright = transfer.decode(bright_stored(surveyed));
    if (!(bright > 0 && bright < kDarkFloats)) return {};
    return fmt::format(
        "{}: the photographs are dark: 98 % of their values are below {:.2g} of full scale, in linear light, "
        "as where values of a camera were not scaled to all bits of the file. Noise is taken for {:.2g} of "
        "full scale, and colours for those of a painting as dark: give the linear value of a matt white as "
        "--white-level, and the noise of stored values, where it is less, as --noise",
        stack.folder.string(), bright, noise.stored());
}

void warn_of_misfit(Stack& stack, const FitReport& report) {
    if (explains_photographs(report)) return;
    const PhotoMisfits& misfits = report.photo_misfits;
    const std::string worst = worst_of(misfits, report.photo_names), not_by = ruled_out(misfits);
    std::string cause = "what makes the result poor says why";
    if (!report.sharpening.suspected() && doubts_of(misfits, report.photo_names).empty())
        cause = fmt::format(
            "{}{}",
            is_in_gloss(misfits)
                ? fmt::format("most where there is gloss ({:.1f} times what is expected, in {:.0f} % of the "
                              "values; matt "
                              "paint {:.1f} times): metal, glass and varnish look like that",
                              misfits.glossy.rms, 100 * misfits.glossy.part, misfits.matt.rms)
                : "not only where there is gloss: wrong light directions look like that, and noise and "
                  "compression that are coarser than is expected",
            not_by.empty() ? "" : fmt::format(" ({} were looked for, and it is none of them)", not_by));
    stack.warnings.push_back(fmt::format(
        "{}: photographs differ from the model by {}{}{}; {}", stack.folder.string(),
        beyond_expected(report.median_rms_residual),
        report.refined ? "" : ": shadows and neighbours' lobes are not believed, so the fit is not refined",
        worst.empty() ? "" : "; " + worst, cause));
}

void warn_of_exposure(Stack& stack, const Survey& surveyed, const FitReport& report, double diffuse_max,
                      double white_level) {
    const bool overexposed = warn_of_clipping(stack, surveyed);
    if (!(report.too_bright > report.fitted / 20) || overexposed) return;
    stack.warnings.push_back(
        fmt::format("{}: {:.0f} % of the pixels would reflect more than {} times the light that falls on "
                    "them: the white "
                    "level {} is too low; give the linear value of a matt white as --white-level",
                    stack.folder.string(),
                    100.0 * static_cast<double>(report.too_bright) / static_cast<double>(report.fitted),
                    diffuse_max, white_level));
}

std::string says_reduced_do_not_suffice(const Stack& stack, const ReducedLook& look) {
    return fmt::format(
        "{}: {}: of a picture that memory holds, fit without --plan looks at every pixel twice instead, and "
        "knows "
        "such places better",
        stack.folder.string(),
        look.believed
            ? fmt::format("relief hides {:.1f} % of the light, and what it hides of single pixels the "
                          "reduced photographs do not tell",
                          100 * look.hidden)
            : "the reduced photographs do not tell the relief");
}

void warn_of_unsure_pixels(Stack& stack, const FitReport& report) {
    constexpr double kManyUnsure = 0.1;
    if (!(report.unsure > kManyUnsure)) return;
    stack.warnings.push_back(
        fmt::format("{}: of {:.0f} % of the pixels the photographs hardly tell the slope (confidence "
                    "below 0.5): they are "
                    "too dark, or too few lights reach them, and lights higher above the painting would",
                    stack.folder.string(), 100 * report.unsure));
}

}  // namespace tangi
