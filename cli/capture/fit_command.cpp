// fit_command.cpp: tangipaint fit PHOTOS --out PAINTING.exr
#include "capture/radiometry/develop_stack.h"
#include "cli/arguments.h"
#include "cli/capture/fit_folder.h"
#include "cli/command_list.h"
#include "cli/result_summary.h"
#include "fit/pipeline/fit_painting.h"
#include "fit/pipeline/fit_passes.h"
#include "fit/pipeline/fit_report_page.h"
#include "fit/residual/residual_fit.h"
#include "surface/base/error.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/fit_doubts.h"
#include "surface/painting_file/overview.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

namespace {

struct FitArguments {
    PhotosArguments photos;
    std::string out, report, solver = "batch";
    FitOptions options;
    bool with_residual = false;
    ResidualOptions residual_options;
};

nlohmann::json provenance_of(const FitArguments& arguments, const Stack& stack,
                             const DevelopReport& development) {
    nlohmann::json inputs = nlohmann::json::array();
    const auto add = [&](const std::filesystem::path& path) {
        inputs.push_back({{"file", path.filename().string()}, {"bytes", std::filesystem::file_size(path)}});
    };
    for (const StackPhoto& photo : stack.photos) {
        if (photo.exposures.empty()) add(photo.path);
        for (const Exposure& exposure : photo.exposures) add(exposure.path);
    }
    nlohmann::json options = to_json(arguments.options);
    options["light_calibration"] = to_json(arguments.options.calibration);
    options["ward"] = to_json(arguments.options.ward);
    options["height"] = to_json(arguments.options.height);
    options["solver"] = arguments.solver;
    if (arguments.with_residual) options["residual"] = to_json(arguments.residual_options);
    options["photos"] = arguments.photos.as_json();
    return {{"program", "tangipaint " TP_VERSION},
            {"command", "fit"},
            {"options", options},
            {"development", to_json(development)},
            {"inputs", inputs}};
}

// [sigma] Median residual from which on lights that were taken in the order of file names are doubted.
constexpr double kDoubtfulOrder = 1;

// [sigma] Median residual that generated stacks of honest photographs, gilded, brushed, varnished, noisy and
// compressed ones too, stay below; and beyond which no painting is explained, unless it is of metal alone:
// lists of lights that belong to other photographs have 2.2 to 3.1, lists that are off by one of 20 have 1.8.
constexpr double kHonest = 1.5, kUnexplained = 2;

constexpr double kDoubtfulScatter_deg =
    6;  // of lights in that order; fit/light_checks/light_outliers.h says no more beyond

constexpr double kSizesDiffer = 0.01;  // [1] relative, of a pixel's size as given and as measured

constexpr double kDoubtfulBulge_deg = 5;  // of a painting as a whole

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

// What makes the result doubtful as a whole; empty where nothing does.
std::vector<std::string> poor_reasons(const FitReport& report, const UsableStack& opened,
                                      const LightAxes& axes) {
    std::vector<std::string> reasons = opened.poor;
    if (opened.lights_by_order && report.median_rms_residual > kDoubtfulOrder)
        reasons.push_back(fmt::format(
            "no name in the lights file is that of a photograph, so lights were taken in the order of the "
            "file names, and the photographs differ from the model by {}: is the order the same? Name the "
            "photographs in the lights file as they are called",
            beyond_expected(report.median_rms_residual)));
    else if (opened.lights_by_order && report.light_outliers.scatter_deg > kDoubtfulScatter_deg)
        reasons.push_back(fmt::format(
            "no name in the lights file is that of a photograph, so lights were taken in the order of the "
            "file names, and those that the photographs show scatter by {:.0f}° round the listed ones: is "
            "the order the same? Name the photographs in the lights file as they are called",
            report.light_outliers.scatter_deg));
    if (!report.turned_doubt.empty()) reasons.push_back(report.turned_doubt);
    if (!report.transfer.doubt.empty()) reasons.push_back(report.transfer.doubt);
    // A list that is in another order looks turned as well: one advice, the one that explains.
    // Metal fits some wrong order better where matt reflection is all that is asked: the fitted surface
    // decides.
    const bool fits_as_listed = report.median_rms_residual < kHonest;
    std::string doubt = doubt_of(report.list_order, report.signs, axes, report.order_names, fits_as_listed);
    // Single lights that are wrong, or exchanged, are told one by one.
    if (doubt.empty() && !fits_as_listed && report.light_outliers.odd.empty())
        doubt = doubt_of_any_order(report.list_order);
    const bool out_of_order = !doubt.empty();
    if (!out_of_order) {
        doubt = doubt_of(report.signs, report.shadow_signs, axes);
        if (!doubt.empty())
            doubt += or_order(report.list_order, report.signs, report.order_names) +
                     says_lights_are_as_viewed(opened.stack);
    }
    if (!doubt.empty()) reasons.push_back(std::move(doubt));
    if (axes.differ() && !out_of_order && report.median_rms_residual > kDoubtfulOrder)
        reasons.push_back(fmt::format(
            "lights were mirrored or turned as asked, and the photographs still differ from the model by {}: "
            "are they the right ones?",
            beyond_expected(report.median_rms_residual)));
    for (std::string& odd : doubts_of(report.light_outliers, report.photo_names))
        if (!out_of_order) reasons.push_back(std::move(odd));
    if (report.sharpening.found()) reasons.push_back(says_sharpened(report.sharpening));
    for (std::string& cause : doubts_of(report.photo_misfits, report.photo_names))
        reasons.push_back(std::move(cause));
    if (reasons.empty() && report.median_rms_residual > kUnexplained &&
        is_in_matt_paint(report.photo_misfits)) {
        const std::string not_by = ruled_out(report.photo_misfits);
        reasons.push_back(fmt::format(
            "photographs differ from the model by {}, in matt paint, too{}: are the lights those of these "
            "photographs, in their order, and the photographs all of one painting, not turned or mirrored?",
            beyond_expected(report.median_rms_residual),
            not_by.empty() ? "" : fmt::format(" ({} were looked for, and it is none of them)", not_by)));
    }
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
    return reasons;
}

// What is asked for is a number that the result then does not have; empty where some photograph is still held
// out.
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

nlohmann::json colour_of(const FitResult& fit) {
    const ColourReport& colour = fit.report.colour;
    const auto known = [](bool is, double value) {
        return is ? nlohmann::json(value) : nlohmann::json(nullptr);
    };
    return {{"corrected", colour.corrected},
            {"by", !colour.corrected   ? nlohmann::json(nullptr)
                   : colour.by_profile ? nlohmann::json("ICC profile")
                                       : nlohmann::json("colour chart")},
            {"chart_delta_e_2000", known(colour.delta_e_2000 >= 0, colour.delta_e_2000)},
            {"clamped_pixels", colour.clamped},
            {"patches", colour.patches},
            {"patches_delta_e_2000", known(colour.patches_delta_e > 0, colour.patches_delta_e)},
            {"white_level", fit.surface.photography.white_level},
            {"white_by_chart", colour.white_by_chart}};
}

nlohmann::json result_of(const FitResult& fit, const std::vector<RejectedPhoto>& rejected,
                         const std::string& out) {
    const FitReport& r = fit.report;
    nlohmann::json candidates = nlohmann::json::array();
    for (const auto& candidate : r.transfer.candidates)
        candidates.push_back({{"transfer", candidate.transfer.name()},
                              {"residual", candidate.residual},
                              {"probability", candidate.probability},
                              {"slopes_change_deg", candidate.slopes_change_deg}});
    nlohmann::json without_number = nlohmann::json::array();
    for (const auto& [name, pixels] : r.without_number)
        without_number.push_back({{"name", name}, {"pixels", pixels}});
    int fitted_photos = 0, held_out = 0;
    for (const auto& photo : fit.surface.photography.photos) ++(photo.fitted ? fitted_photos : held_out);
    return {
        {"painting", out},
        {"width", fit.surface.width()},
        {"height", fit.surface.height()},
        {"photographs",
         {{"fitted", fitted_photos},
          {"held_out", held_out},
          {"rejected", to_json(rejected)},
          {"without_number", without_number}}},
        {"transfer",
         {{"name", r.transfer.transfer.name()}, {"source", r.transfer.source}, {"tried", candidates}}},
        {"colour", colour_of(fit)},
        {"registration", to_json(r.registration)},
        {"lights", to_json(r.lights)},
        {"light_axes_check", to_json(r.signs, r.shadow_signs)},
        {"light_outliers", to_json(r.light_outliers, r.photo_names)},
        {"sharpening", to_json(r.sharpening)},
        {"photo_misfits", to_json(r.photo_misfits, r.photo_names)},
        {"white_balances", to_json(r.white_balances, r.photo_names)},
        {"list_orders", to_json(r.list_order)},
        {"reflectance_model", to_json(r.reflectance_model)},
        {"specular_colour_pixels", r.coloured},
        {"anisotropic_pixels", r.anisotropic},
        {"pixels", {{"all", r.pixels}, {"fitted", r.fitted}, {"not_converged", r.not_converged}}},
        {"solver_agreement",
         {{"compared", r.solvers.compared},
          {"cost_within_1_percent", r.solvers.cost_agrees},
          {"else_batch_cheaper", r.solvers.cheaper},
          {"slope_within_0.01", r.solvers.slope_agrees},
          {"doubtful", r.solvers.doubtful},
          {"polished", r.solvers.polished}}},
        {"median_confidence", r.median_confidence},
        {"unsure_pixels", r.unsure},
        {"median_residual_sigma", r.median_rms_residual},
        {"mm_per_pixel", fit.surface.mm_per_pixel},
        {"scale_known", fit.surface.scale_known},
        {"support_tilt_deg", r.support_tilt_deg},
        {"support_bulge_deg", r.support_bulge_deg},
        {"refined", r.refined},
        {"final_height", to_json(r.height_choice)},
        {"light_angular_radius", to_json(r.light_angular_radius)},
        {"height_solver",
         {{"cycles", r.height.cycles}, {"residual", r.height.residual}, {"converged", r.height.converged}}},
        {"dry_hash", hash_of(fit.surface)}};
}

// Pictures in the folder of the photographs may be photographs that this lights file does not list; only a
// painting is replaced there.
void refuse_to_overwrite_photographs(const FitArguments& arguments, const Stack& stack) {
    namespace fs = std::filesystem;
    const fs::path out = arguments.out;
    refuse_to_overwrite(out, arguments.photos.inputs(stack));
    if (fs::exists(out) && fs::equivalent(fs::absolute(out).parent_path(), stack.folder) && !is_painting(out))
        refuse_to_overwrite(out, {stack.folder / out.filename()});
}

nlohmann::json run_fit(FitArguments arguments, const Progress& progress) {
    if (lower_extension(arguments.out) != ".exr") fail("--out {}: a painting is an .exr file", arguments.out);
    if (!arguments.report.empty() && lower_extension(arguments.report) != ".html")
        throw UsageError(fmt::format("--report {}: a page is an .html file", arguments.report));
    for (const std::string& output : {arguments.out, arguments.report})
        if (!output.empty()) refuse_in_treatment(output);
    AtomicFile file(arguments.out);  // before the work: an output that can't be written is known now
    std::optional<AtomicFile> page;
    if (!arguments.report.empty()) page.emplace(arguments.report);
    UsableStack opened = arguments.photos.open();
    Stack& stack = opened.stack;
    const std::size_t told_before = stack.warnings.size();
    told(stack.warnings);  // now, not after an hour
    if (const auto& mm = arguments.options.mm_per_pixel;
        mm && stack.mm_per_pixel && std::abs(*mm / *stack.mm_per_pixel - 1) > kSizesDiffer)
        opened.poor.push_back(fmt::format(
            "--mm-per-pixel {:.6g} is used, but the capture file measured {:.6g}: one of them is wrong, and "
            "lights, heights and areas with it; leave the flag out, or measure again",
            *mm, *stack.mm_per_pixel));
    if (opened.found_mask) arguments.photos.mask = opened.found_mask->string();
    refuse_to_overwrite_photographs(arguments, stack);
    const DevelopReport development = develop_stack(stack, {}, progress);
    const nlohmann::json provenance = provenance_of(arguments, stack, development);
    const std::size_t held_out = stack.held_out.size();
    FitOptions fit_options = arguments.options;
    fit_options.solver = arguments.solver == "ceres" ? Solver::ceres : Solver::batch;
    fit_options.register_photos = arguments.photos.registration != "off";
    FitResult fit = fit_painting(stack, fit_options, progress);
    // File names may hold any bytes; JSON holds UTF-8.
    fit.surface.provenance = provenance.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    std::vector<std::string> warnings = fit.report.warnings;
    if (fit.report.support_tilt_deg > 5)
        warnings.push_back(
            fmt::format("the normals tilt by {:.0f} degrees as a whole, as if the painting did not face the "
                        "camera; if it did, the "
                        "light directions are off by about as much",
                        fit.report.support_tilt_deg));
    if (const double bulge = fit.report.support_bulge_deg; std::abs(bulge) > kDoubtfulBulge_deg)
        warnings.push_back(fmt::format(
            "the normals turn {} by {:.0f} degrees from the middle of the picture to its corners, as on a "
            "painting that {}; if it is flat, the lights were {} than is taken here: their positions "
            "(capture.json, --lights-mm), or more photographs, would tell",
            bulge > 0 ? "outwards" : "inwards", std::abs(bulge), bulge > 0 ? "bulges" : "is hollow",
            bulge > 0 ? "nearer" : "farther away"));
    if (fit.report.fitted > 0 && !fit.report.height.converged)
        warnings.push_back(fmt::format(
            "the height has not converged after {} cycles (residual {:.1g}), so that its long waves "
            "may be off; give --max-cycles more",
            fit.report.height.cycles, fit.report.height.residual));
    ResidualFit residual;
    if (arguments.with_residual)
        residual = fit_residual(fit.surface, stack, arguments.residual_options, progress);
    std::vector<PartToWrite> parts = {part_of(fit.errors)};
    if (!residual.residual.empty()) parts.push_back(part_of(residual.residual));
    if (arguments.with_residual && !residual.report.used)
        warnings.push_back(
            "--residual: a residual predicts validation photographs no better than the surface "
            "alone, so none is stored");
    if (arguments.with_residual && !residual.report.used)
        fit.surface.provenance = with_residual_in_vain(fit.surface.provenance);
    if (!development.encoding.doubt.empty()) opened.poor.push_back(development.encoding.doubt);
    std::vector<std::string> poor = poor_reasons(fit.report, opened, arguments.photos.axes());
    if (const std::string none = says_none_is_held_out(held_out, fit); !none.empty()) poor.push_back(none);
    fit.surface.provenance = with_doubts(fit.surface.provenance, poor, warnings);
    add_overview(parts, fit.surface, fit.surface);
    fill_painting(file, fit.surface, parts, progress);
    OutputSet set;  // a painting and the page that tells of it
    set.add(file);
    if (page) {
        fit.report.warnings = warnings;
        page->write(fit_page(fit, std::filesystem::path(arguments.out).filename().string(), page->target()));
        set.add(*page);
    }
    set.commit();
    std::vector<RejectedPhoto> rejected = opened.rejected;
    rejected.insert(rejected.end(), fit.report.rejected.begin(), fit.report.rejected.end());
    nlohmann::json result = result_of(fit, rejected, arguments.out);
    if (arguments.with_residual) result["residual"] = to_json(residual.report);
    result["development"] = to_json(development);
    result["warnings"] = told(warnings, told_before);
    result["poor"] = poor;
    return result;
}

}  // namespace

nlohmann::json fit_folder(const std::filesystem::path& photographs, const std::filesystem::path& out,
                          const Progress& progress) {
    FitArguments arguments;
    arguments.photos.folder = photographs;
    if (std::filesystem::is_regular_file(photographs)) {
        arguments.photos.lights = photographs;
        arguments.photos.folder = std::filesystem::absolute(photographs).parent_path();
    }
    arguments.out = out;
    return run_fit(arguments, progress);
}

Command fit_command() {
    return {"fit", "fit height, normals and Ward parameters to photographs: the main job",
            [](Flags& flags) {
                auto arguments = std::make_shared<FitArguments>();
                arguments->photos.add_to(flags, true);
                flags.option("--out", arguments->out, "the painting file to write (.exr)").required();
                flags.option("--report", arguments->report,
                             "also write a page on how the photographs were understood (.html)");
                flags
                    .option("--solver", arguments->solver,
                            "batch: many pixels at once, checked and polished by Ceres; ceres: Ceres alone, "
                            "some fifty times slower a pixel")
                    .check(one_of({"batch", "ceres"}));
                flags.fields(arguments->options);
                flags.fields(arguments->options.calibration);
                flags.fields(arguments->options.ward);
                flags.fields(arguments->options.height);
                flags.flag("--residual", arguments->with_residual,
                           "also store what the photographs show beyond the surface, for relight --residual");
                flags.fields(arguments->residual_options);
                return [arguments, typed = flags.typed()] {
                    if (!arguments->with_residual)
                        refuse_typed(typed(),
                                     {"--residual-terms", "--residual-colour-terms", "--residual-samples",
                                      "--residual-min-gain-db"},
                                     "is of --residual, which is not asked for");
                    return run_fit(*arguments, console_progress());
                };
            },
            fit_in_words};
}

}  // namespace tangi
