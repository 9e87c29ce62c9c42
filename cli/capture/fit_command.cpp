// fit_command.cpp: tangipaint fit PHOTOS --out PAINTING.exr
#include "capture/radiometry/develop_stack.h"
#include "cli/arguments.h"
#include "cli/capture/fit_folder.h"
#include "cli/capture/fit_result.h"
#include "cli/capture/fit_verdict.h"
#include "cli/command_list.h"
#include "cli/result_summary.h"
#include "fit/pipeline/fit_painting.h"
#include "fit/pipeline/fit_passes.h"
#include "fit/pipeline/fit_report_page.h"
#include "fit/residual/residual_fit.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
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
    std::string out, report, solver = "batch", shape = "flat";
    FitOptions options;
    std::optional<bool> with_residual;  // where not said, if it predicts better
    ResidualOptions residual_options;

    // A preview has none, nor are its photographs there to be compared with.
    bool looks_for_residual() const { return with_residual.value_or(!options.preview); }
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
    options["shape"] = arguments.shape;
    if (arguments.looks_for_residual()) options["residual"] = to_json(arguments.residual_options);
    options["photos"] = arguments.photos.as_json();
    return {{"program", "tangipaint " TP_VERSION},
            {"command", "fit"},
            {"options", options},
            {"development", to_json(development)},
            {"inputs", inputs}};
}

constexpr double kSizesDiffer = 0.01;  // [1] relative, of a pixel's size as given and as measured

// Pictures in the folder of the photographs may be photographs that this lights file does not list; only a
// painting is replaced there.
void refuse_to_overwrite_photographs(const FitArguments& arguments, const Stack& stack) {
    namespace fs = std::filesystem;
    const fs::path out = arguments.out;
    refuse_to_overwrite(out, arguments.photos.inputs(stack));
    if (fs::exists(out) && fs::equivalent(fs::absolute(out).parent_path(), stack.folder) && !is_painting(out))
        refuse_to_overwrite(out, {stack.folder / out.filename()});
}

// What the command writes, put in place together.
struct FitFiles {
    explicit FitFiles(const FitArguments& arguments) : painting(arguments.out) {
        if (!arguments.report.empty()) page.emplace(arguments.report);
    }
    AtomicFile painting;
    std::optional<AtomicFile> page;
};

void require_sound(const FitArguments& arguments) {
    if (arguments.options.preview && arguments.looks_for_residual())
        throw UsageError("--residual: a preview has none; leave --preview out");
    if (lower_extension(arguments.out) != ".exr") fail("--out {}: a painting is an .exr file", arguments.out);
    if (!arguments.report.empty() && lower_extension(arguments.report) != ".html")
        throw UsageError(fmt::format("--report {}: a page is an .html file", arguments.report));
    for (const std::string& output : {arguments.out, arguments.report})
        if (!output.empty()) refuse_in_treatment(output);
}

// A pixel's size that is given, and is not the one that was measured.
void doubt_scale(const std::optional<double>& mm_per_pixel, UsableStack& opened) {
    const auto& measured = opened.stack.mm_per_pixel;
    if (!mm_per_pixel || !measured || !(std::abs(*mm_per_pixel / *measured - 1) > kSizesDiffer)) return;
    opened.poor.push_back(fmt::format(
        "--mm-per-pixel {:.6g} is used, but the capture file measured {:.6g}: one of them is wrong, and "
        "lights, heights and areas with it; leave the flag out, or measure again",
        *mm_per_pixel, *measured));
}

FitOptions options_of(const FitArguments& arguments) {
    FitOptions options = arguments.options;
    options.solver = arguments.solver == "ceres" ? Solver::ceres : Solver::batch;
    options.calibration.flat = arguments.shape == "flat";
    options.register_photos = arguments.photos.registration != "off";
    return options;
}

// What fit_residual() says; none, told, where photographs that were fitted can no longer be read: the fit is
// not lost for it.
ResidualFit residual_or_none(const FitResult& fit, const Stack& stack, const ResidualOptions& options,
                             std::vector<std::string>& warnings, const Progress& progress) {
    try {
        return fit_residual(fit.surface, stack, options, progress);
    } catch (const Error& error) {
        warnings.push_back(fmt::format("no residual is stored: {}", error.what()));
        ResidualFit none;
        none.report.why = error.what();
        return none;
    }
}

// Warns where none is stored that was asked for.
ResidualFit residual_of(FitResult& fit, const Stack& stack, const FitArguments& arguments,
                        const Progress& progress) {
    ResidualFit residual =
        residual_or_none(fit, stack, arguments.residual_options, fit.report.warnings, progress);
    if (residual.report.used) return residual;
    if (arguments.with_residual)
        fit.report.warnings.push_back(fmt::format("--residual: none is stored: {}", residual.report.why));
    fit.surface.provenance = with_residual_in_vain(fit.surface.provenance);
    return residual;
}

// A painting and the page that tells of it.
void save(FitFiles& files, const FitResult& fit, const ResidualFit& residual, const Progress& progress) {
    std::vector<PartToWrite> parts = {part_of(fit.errors)};
    if (!residual.residual.empty()) parts.push_back(part_of(residual.residual));
    add_overview(parts, fit.surface, fit.surface);
    fill_painting(files.painting, fit.surface, parts, progress);
    OutputSet set;
    set.add(files.painting);
    if (files.page) {
        const std::string name = files.painting.target().filename().string();
        files.page->write(fit_page(fit, name, files.page->target()));
        set.add(*files.page);
    }
    set.commit();
}

nlohmann::json run_fit(FitArguments arguments, const Progress& progress) {
    require_sound(arguments);
    FitFiles files(arguments);  // before the work: an output that can't be written is known now
    UsableStack opened = arguments.photos.open();
    Stack& stack = opened.stack;
    const std::size_t told_before = stack.warnings.size();
    told(stack.warnings);  // now, not after an hour
    doubt_scale(arguments.options.mm_per_pixel, opened);
    if (opened.found_mask) arguments.photos.mask = opened.found_mask->string();
    refuse_to_overwrite_photographs(arguments, stack);
    const DevelopReport development = develop_stack(stack, {}, progress);
    const nlohmann::json provenance = provenance_of(arguments, stack, development);
    const std::size_t held_out = stack.held_out.size();

    FitResult fit = fit_painting(stack, options_of(arguments), progress);
    // File names may hold any bytes; JSON holds UTF-8.
    fit.surface.provenance = json_line(provenance);
    fit.report.warnings = fit_warnings(fit.report);
    ResidualFit residual;
    if (arguments.looks_for_residual()) residual = residual_of(fit, stack, arguments, progress);
    if (!development.encoding.doubt.empty()) opened.poor.push_back(development.encoding.doubt);
    std::vector<std::string> poor = poor_reasons(fit.report, opened, arguments.photos.axes());
    if (const std::string none = says_none_is_held_out(held_out, fit); !none.empty()) poor.push_back(none);
    fit.surface.provenance = with_doubts(fit.surface.provenance, poor, fit.report.warnings);
    save(files, fit, residual, progress);

    std::vector<RejectedPhoto> rejected = opened.rejected;
    rejected.insert(rejected.end(), fit.report.rejected.begin(), fit.report.rejected.end());
    nlohmann::json result = fit_result(fit, rejected, arguments.out);
    if (arguments.looks_for_residual()) result["residual"] = to_json(residual.report);
    result["development"] = to_json(development);
    result["warnings"] = told(fit.report.warnings, told_before);
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
                flags
                    .option(
                        "--shape", arguments->shape,
                        "flat: the object is, as a whole, as a painting is, which tells lights apart from "
                        "slopes; relief: it is round, bulges or is all slopes (a vessel, a carving, a "
                        "statue), and the photographs alone say how")
                    .check(one_of({"flat", "relief"}));
                flags.fields(arguments->options);
                flags.fields(arguments->options.calibration);
                flags.fields(arguments->options.ward);
                flags.fields(arguments->options.height);
                flags.flag("--residual", arguments->with_residual,
                           "store what the photographs show beyond the surface, for relight; where not said, "
                           "if it predicts photographs better that are left out");
                flags.fields(arguments->residual_options);
                return [arguments, typed = flags.typed()] {
                    if (!arguments->looks_for_residual())
                        refuse_typed(typed(),
                                     {"--residual-terms", "--residual-colour-terms", "--residual-samples",
                                      "--residual-min-gain-db"},
                                     "is of a residual, of which there is none");
                    return run_fit(*arguments, console_progress());
                };
            },
            fit_in_words};
}

}  // namespace tangi
