// bind_stack.cpp: photographs with their lights: fit, compare, calibrate, generate.
#include "capture/calibration/calibration_page.h"
#include "capture/radiometry/develop_stack.h"
#include "capture/stack/grey_photos.h"
#include "capture/stack/open_screened.h"
#include "capture/stack/photo_set.h"
#include "datasets/generator.h"
#include "fit/evaluate/compare.h"
#include "fit/residual/residual_fit.h"
#include "fit/verdict/fit_result.h"
#include "fit/verdict/fit_verdict.h"
#include "python/bindings.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/provenance/fit_doubts.h"
#include "surface/provenance/provenance.h"

namespace tangi::python {

namespace {

namespace fs = std::filesystem;

UsableStack open_stack_of(const std::string& folder, const std::optional<std::string>& lights,
                          const std::optional<std::array<int, 4>>& crop,
                          const std::optional<std::string>& mask, const std::optional<std::string>& capture,
                          const std::optional<std::string>& transfer, const std::string& hold_out) {
    StackOptions options;
    options.lights_file = lights;
    options.mask_file = mask;
    options.capture_file = capture;
    if (crop) {
        const auto [x, y, width, height] = *crop;
        if (x < 0 || y < 0 || width < 1 || height < 1)
            fail("crop: (x, y, width, height) is no part of a picture");
        options.crop = Region{x, y, x + width, y + height};
    }
    if (transfer && !(options.transfer = transfer_named(*transfer)))
        fail("transfer: {} is none of linear, srgb, or a gamma", *transfer);
    const py::gil_scoped_release unlock;
    UsableStack opened = open_usable_stack(folder, options, {.finds_mask = !mask});
    if (!hold_out.empty()) tangi::hold_out(opened.stack, hold_out);
    return opened;
}

std::vector<fs::path> files_of(const Stack& stack) {
    std::vector<fs::path> files;
    for (const auto* photos : {&stack.photos, &stack.held_out})
        for (const StackPhoto& photo : *photos) files.push_back(photo.path);
    return files;
}

std::vector<std::string> names_in(const std::vector<StackPhoto>& photos) {
    std::vector<std::string> names;
    for (const StackPhoto& photo : photos) names.push_back(photo.path.filename().string());
    return names;
}

nlohmann::json options_in_json(const FitOptions& options) {
    nlohmann::json json = to_json(options);
    json["light_calibration"] = to_json(options.calibration);
    json["ward"] = to_json(options.ward);
    json["height"] = to_json(options.height);
    return json;
}

// The painting, and what `tangipaint fit` prints.
std::pair<SharedPainting, nlohmann::json> fitted(UsableStack opened, const FitOptions& options,
                                                 const std::optional<ResidualOptions>& with_residual,
                                                 const Progress& progress) {
    Stack& stack = opened.stack;
    const DevelopReport development = develop_stack(stack, {}, progress);
    nlohmann::json provenance = provenance_of("fit", options_in_json(options), records_of(files_of(stack)));
    if (with_residual) provenance["options"]["residual"] = to_json(*with_residual);
    provenance["development"] = to_json(development);
    FitResult fit = fit_painting(stack, options, progress);
    fit.surface.provenance = json_line(provenance);
    std::vector<std::string> warnings = fit_warnings(fit.report);
    ResidualFit residual;
    if (with_residual) residual = try_residual(fit.surface, stack, *with_residual, warnings, progress);
    if (!development.encoding.doubt.empty()) opened.poor.push_back(development.encoding.doubt);
    const std::vector<std::string> poor = poor_reasons(fit.report, opened, {});
    std::vector<RejectedPhoto> rejected = opened.rejected;
    rejected.insert(rejected.end(), fit.report.rejected.begin(), fit.report.rejected.end());
    nlohmann::json report = fit_result(fit, rejected, "");
    report.erase("painting");
    report["warnings"] = warnings;
    report["poor"] = poor;
    report["options"] = provenance["options"];
    report["inputs"] = provenance["inputs"];
    if (with_residual) report["residual"] = to_json(residual.report);
    fit.surface.provenance = with_doubts(fit.surface.provenance, poor, warnings);
    return {std::make_shared<Painting>(
                Painting{std::move(fit.surface), std::move(fit.errors), std::move(residual.residual)}),
            report};
}

// Numbers that are poor are no exception, but a warning that may be made one.
void warn_of_poor(const nlohmann::json& report) {
    const py::object kind = py::module_::import("tangipaint").attr("PoorNumbers");
    for (const std::string reason : report.at("poor"))
        if (PyErr_WarnEx(kind.ptr(), reason.c_str(), 1) != 0) throw py::error_already_set();
}

py::tuple fit_of(const UsableStack& opened, const std::optional<bool>& with_residual,
                 const py::object& progress, const py::kwargs& words) {
    FitOptions options;
    ResidualOptions residual;
    std::set<std::string> left = names_of(words);
    take(options, words, left);
    take(options.calibration, words, left);
    take(options.ward, words, left);
    take(options.height, words, left);
    take(residual, words, left);
    refuse(left);
    const bool looks_for_it = with_residual.value_or(!options.preview);
    if (looks_for_it && options.preview) fail("residual: a preview has none");
    auto [painting, report] = long_work(progress, [&](const Progress& told) {
        return fitted(opened, options, looks_for_it ? std::optional(residual) : std::nullopt, told);
    });
    warn_of_poor(report);
    return py::make_tuple(painting, from_json(report));
}

py::object compared(const SharedPainting& painting, const UsableStack& opened, const py::object& progress,
                    const py::kwargs& words) {
    CompareOptions options;
    std::set<std::string> left = names_of(words);
    take(options, words, left);
    refuse(left);
    return from_json(long_work(progress, [&](const Progress& told) {
        Stack stack = opened.stack;
        develop_stack(stack, {}, told);
        return to_json(compare(painting->surface, stack, options, told, {},
                               painting->has_residual() ? painting->residual : RelightingResidual()));
    }));
}

py::object calibrated(const std::string& folder, const std::string& out,
                      const std::vector<std::array<double, 3>>& spheres, bool diffuse_sphere,
                      const std::optional<double>& sphere_radius_mm, const std::optional<double>& focal_px,
                      const std::optional<double>& camera_distance_mm, bool force,
                      const py::object& progress) {
    SphereCalibrationOptions options;
    options.matt = diffuse_sphere;
    options.sphere_radius_mm = sphere_radius_mm;
    options.focal_px = focal_px;
    options.camera_distance_mm = camera_distance_mm;
    for (const auto& [x, y, radius] : spheres)
        options.spheres.push_back({{x, y}, radius, false, fmt::format("{:g},{:g},{:g}", x, y, radius)});
    if (!force)
        for (const fs::path& file : not_ours(calibration_files(out)))
            fail("{}: is not as calibrate wrote it, and would be replaced; give another name, or force=True",
                 file.string());
    return from_json(long_work(progress, [&](const Progress& told) {
        std::vector<std::string> warnings;
        Calibration calibration;
        calibration.lights = calibrate_from_spheres(pictures_in(folder, warnings), options, told);
        std::vector<std::string>& all = calibration.lights.warnings;
        all.insert(all.begin(), warnings.begin(), warnings.end());
        const CalibrationFiles files = write_calibration(out, calibration);
        nlohmann::json result = to_json(calibration);
        result["files"] = {files.lights.string(), files.json.string(), files.page.string()};
        result["warnings"] = calibration.lights.warnings;
        result["poor"] = calibration.lights.poor;
        return result;
    }));
}

py::object generated(const std::string& folder, const std::string& reflectance,
                     const std::string& arrangement, const std::string& format, const std::string& transfer,
                     const py::object& progress, const py::kwargs& words) {
    PaintingOptions painting;
    GeneratorOptions photos;
    std::set<std::string> left = names_of(words);
    take(painting, words, left);
    take(photos, words, left);
    refuse(left);
    const auto chosen = [](const auto& found, const char* name, const std::string& word) {
        if (!found) fail("{}: {} is no such word", name, word);
        return *found;
    };
    photos.reflectance = chosen(reflectance_named(reflectance), "reflectance", reflectance);
    photos.arrangement = chosen(arrangement_named(arrangement), "arrangement", arrangement);
    photos.format = chosen(generator_format_named(format), "format", format);
    photos.transfer = chosen(transfer_named(transfer), "transfer", transfer);
    require_valid(photos);
    return from_json(long_work(progress, [&](const Progress& told) {
        write_stack(folder, procedural_painting(painting), photos, told);
        return nlohmann::json{
            {"folder", folder}, {"painting", to_json(painting)}, {"photos", to_json(photos)}};
    }));
}

}  // namespace

void bind_stack(py::module_& module) {
    py::class_<UsableStack>(module, "Stack",
                            "Photographs of a folder, each with its light; pixels stay on the disk.")
        .def(
            py::init(&open_stack_of), py::arg("folder"), py::arg("lights") = py::none(), py::kw_only(),
            py::arg("crop") = py::none(), py::arg("mask") = py::none(), py::arg("capture") = py::none(),
            py::arg("transfer") = py::none(), py::arg("hold_out") = "",
            "lights: an .lp, .dome, .relight or capture.json; the one in the folder where None. crop: (x, y, "
            "width, height) [pixels]. hold_out: photographs kept from the fit, as '4:8' or names.")
        .def_property_readonly(
            "photographs", [](const UsableStack& s) { return names_in(s.stack.photos); },
            "names of the photographs to fit")
        .def_property_readonly(
            "held_out", [](const UsableStack& s) { return names_in(s.stack.held_out); },
            "names of those to compare with alone")
        .def_property_readonly(
            "lights", [](const UsableStack& s) { return s.stack.lights(); },
            "list of Light, one a photograph to fit")
        .def_property_readonly(
            "width", [](const UsableStack& s) { return s.stack.width(); }, "[pixels]")
        .def_property_readonly(
            "height", [](const UsableStack& s) { return s.stack.height(); }, "[pixels]")
        .def_property_readonly("warnings", [](const UsableStack& s) { return s.stack.warnings; })
        .def("__len__", [](const UsableStack& s) { return s.stack.photos.size(); });
    module.def(
        "fit", &fit_of, py::arg("stack"), py::kw_only(), py::arg("residual") = py::none(),
        py::arg("progress") = py::none(),
        "(Painting, dict): fits normals, height and reflectance. The dict is what `tangipaint fit` prints; "
        "what makes the numbers poor is also a warning, PoorNumbers. Options are those of the command, "
        "with _ for -: mm_per_pixel=0.1, refine=False. residual=False: looks for none.");
    module.def(
        "compare", &compared, py::arg("painting"), py::arg("stack"), py::kw_only(),
        py::arg("progress") = py::none(),
        "dict: how well the painting, relit, matches photographs: PSNR [dB], SSIM and CIEDE2000 of each, and "
        "their means. Options: cast_shadows, light_radius_deg.");
    module.def(
        "calibrate", &calibrated, py::arg("folder"), py::arg("out"), py::kw_only(),
        py::arg("spheres") = std::vector<std::array<double, 3>>{}, py::arg("diffuse_sphere") = false,
        py::arg("sphere_radius_mm") = py::none(), py::arg("focal_px") = py::none(),
        py::arg("camera_distance_mm") = py::none(), py::arg("force") = false,
        py::arg("progress") = py::none(),
        "dict: finds the lights of photographs from mirror spheres, and writes a lights file (out, .lp), a "
        "capture file and a page. spheres: (x, y, radius) [pixels] each; found where there are none.");
    module.def(
        "generate", &generated, py::arg("folder"), py::kw_only(), py::arg("reflectance") = "ggx",
        py::arg("arrangement") = "dome", py::arg("format") = "png16", py::arg("transfer") = "linear",
        py::arg("progress") = py::none(),
        "dict: writes photographs of a procedural painting, with its truth in gt/. Options are those of "
        "`tangipaint generate`, with _ for -: width=128, lights=16.");
}

}  // namespace tangi::python
