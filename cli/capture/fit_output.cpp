#include "cli/capture/fit_output.h"

#include <algorithm>

#include "capture/formats/lights_format.h"
#include "cli/command.h"
#include "fit/pipeline/fit_passes.h"
#include "fit/pipeline/fit_report_page.h"
#include "fit/residual/residual_fit.h"
#include "fit/verdict/fit_result.h"
#include "fit/verdict/fit_verdict.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/provenance/fit_doubts.h"
#include "surface/provenance/provenance.h"

namespace tangi {

namespace {

nlohmann::json provenance_of_fit(const FitArguments& arguments, const Stack& stack,
                                 const DevelopReport& development) {
    std::vector<std::filesystem::path> inputs = arguments.photos.inputs(stack);
    if (arguments.photos.lights.empty())  // those that are found in the folder
        for (const auto& entry : std::filesystem::directory_iterator(stack.folder))
            if (entry.is_regular_file() && lights_format_named(entry.path()) && is_lights_file(entry.path()))
                inputs.push_back(entry.path());
    std::ranges::sort(inputs);
    inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
    nlohmann::json provenance = provenance_of("fit", arguments.as_json(), records_of(inputs));
    provenance["development"] = to_json(development);
    return provenance;
}

constexpr double kSizesDiffer = 0.01;  // [1] relative, of a pixel's size as given and as measured

// Pictures in the folder of the photographs may be photographs that this lights file does not list; only a
// painting is replaced there.
void refuse_to_overwrite_photographs(const FitArguments& arguments, const std::filesystem::path& out,
                                     const Stack& stack) {
    namespace fs = std::filesystem;
    refuse_to_overwrite(out, arguments.photos.inputs(stack));
    if (fs::exists(out) && fs::equivalent(fs::absolute(out).parent_path(), stack.folder) && !is_painting(out))
        refuse_to_overwrite(out, {stack.folder / out.filename()});
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

// Warns where none is stored that was asked for.
ResidualFit residual_of(FitResult& fit, const Stack& stack, const FitArguments& arguments,
                        const Progress& progress) {
    ResidualFit residual =
        try_residual(fit.surface, stack, arguments.residual_options, fit.report.warnings, progress);
    if (!residual.report.used && arguments.with_residual)
        fit.report.warnings.push_back(fmt::format("--residual: none is stored: {}", residual.report.why));
    return residual;
}

// A painting and the page that tells of it.
void save(FitFiles& files, const FitResult& fit, const ResidualFit& residual, const Progress& progress) {
    std::vector<PartToWrite> parts = {part_of(fit.errors)};
    if (!residual.residual.empty()) parts.push_back(part_of(residual.residual));
    files.painting.fill(fit.surface, std::move(parts), progress);
    OutputSet set;
    files.painting.add_to(set);
    if (files.page) {
        const std::string name = files.painting.target().filename().string();
        files.page->write(fit_page(fit, name, files.page->target()));
        set.add(*files.page);
    }
    set.commit();
}

}  // namespace

FitFiles::FitFiles(const FitArguments& arguments) : painting(arguments.out) {
    if (!arguments.report.empty()) page.emplace(arguments.report);
}

void require_sound(const FitArguments& arguments) {
    if (arguments.options.preview && arguments.looks_for_residual())
        throw UsageError("--residual: a preview has none; leave --preview out");
    if (arguments.out.empty())
        throw UsageError("--out is required: the painting to write (.exr, or .tangi, a folder)");
    require_painting_ending(arguments.out);
    if (!arguments.report.empty())
        require_ending(arguments.report, {".html"}, "a page is an .html file", "--report");
    for (const std::string& output : {arguments.out, arguments.report})
        if (!output.empty()) refuse_in_treatment(output);
}

FitInput open_for_fit(FitArguments& arguments, const std::filesystem::path& output,
                      const Progress& progress) {
    FitInput input;
    input.opened = arguments.photos.open();
    Stack& stack = input.opened.stack;
    input.told_before = stack.warnings.size();
    told(stack.warnings);  // now, not after an hour
    doubt_scale(arguments.options.mm_per_pixel, input.opened);
    if (input.opened.found_mask) arguments.photos.mask = input.opened.found_mask->string();
    refuse_to_overwrite_photographs(arguments, output, stack);
    input.development = develop_stack(stack, {}, progress);
    input.provenance = provenance_of_fit(arguments, stack, input.development);
    return input;
}

nlohmann::json write_fit(const FitArguments& arguments, FitInput& input, FitResult& fit,
                         const std::vector<std::string>& doubts, FitFiles& files, const Progress& progress) {
    UsableStack& opened = input.opened;
    const std::size_t held_out = opened.stack.held_out.size();
    // File names may hold any bytes; JSON holds UTF-8.
    fit.surface.provenance = json_line(input.provenance);
    fit.report.warnings = fit_warnings(fit.report);
    ResidualFit residual;
    if (arguments.looks_for_residual()) residual = residual_of(fit, opened.stack, arguments, progress);
    if (!input.development.encoding.doubt.empty()) opened.poor.push_back(input.development.encoding.doubt);
    std::vector<std::string> poor = doubts;
    for (std::string& reason : poor_reasons(fit.report, opened, arguments.photos.axes()))
        if (std::ranges::find(poor, reason) == poor.end()) poor.push_back(std::move(reason));
    if (const std::string none = says_none_is_held_out(held_out, fit); !none.empty()) poor.push_back(none);
    fit.surface.provenance = with_doubts(fit.surface.provenance, poor, fit.report.warnings);
    save(files, fit, residual, progress);

    std::vector<RejectedPhoto> rejected = opened.rejected;
    rejected.insert(rejected.end(), fit.report.rejected.begin(), fit.report.rejected.end());
    nlohmann::json result = fit_result(fit, rejected, arguments.out);
    if (arguments.looks_for_residual()) result["residual"] = to_json(residual.report);
    result["development"] = to_json(input.development);
    result["options"] = input.provenance.at("options");
    result["inputs"] = input.provenance.at("inputs");
    result["warnings"] = told(fit.report.warnings, input.told_before);
    result["poor"] = poor;
    return result;
}

}  // namespace tangi
