#include "fit/pipeline/painting_fit.h"

#include <algorithm>
#include <cmath>

#include "capture/stack/profile_colours.h"
#include "fit/exchange/float_scale.h"
#include "fit/height/subpixel_slopes.h"
#include "fit/light_checks/light_outlier_vote.h"
#include "fit/pipeline/final_height.h"
#include "fit/pipeline/fit_lights.h"
#include "fit/pipeline/fit_warnings.h"
#include "fit/pipeline/reduced_result.h"
#include "surface/base/error.h"
#include "surface/image/memory_budget.h"

namespace tangi {

namespace {

constexpr int kForModels = 4;  // pixels that choose the reflectance model, by those that calibrate lights

// [deg] As FitReport::support_bulge_deg. Slopes that grow in proportion to the distance from the middle, by
// least squares.
double bulge_deg(const Surface& surface) {
    const double middle_x = (surface.width() - 1) / 2.0, middle_y = (surface.height() - 1) / 2.0;
    double weights = 0, outwards = 0, squares = 0, farthest = 0;
    glm::dvec2 slopes(0), places(0);
    for (int y = 0; y < surface.height(); ++y)
        for (int x = 0; x < surface.width(); ++x) {
            const Vec3& n = surface.normal(x, y);
            const double weight = static_cast<double>(surface.confidence(x, y));
            if (!(weight > 0) || !(n.z > 0.05f)) continue;
            const glm::dvec2 lean(n.x / n.z, n.y / n.z), place(x - middle_x, middle_y - y);
            weights += weight;
            slopes += weight * lean;
            places += weight * place;
            outwards += weight * glm::dot(lean, place);
            squares += weight * glm::dot(place, place);
            farthest = std::max(farthest, glm::dot(place, place));
        }
    if (!(weights > 0)) return 0;
    outwards -= glm::dot(slopes, places) / weights;  // a tilt is no bulge
    squares -= glm::dot(places, places) / weights;
    return squares > 0 ? std::atan(outwards / squares * std::sqrt(farthest)) * 180 / M_PI : 0;
}

// Scale, law and photographs.
void describe(const Surface& described, Surface& surface) {
    surface.reflectance_model = described.reflectance_model;
    surface.mm_per_pixel = described.mm_per_pixel;
    surface.scale_known = described.scale_known;
    surface.photography = described.photography;
}

}  // namespace

// And sorts the photographs: sums are taken in this order, so the order of the lines in a lights file changes
// no bit of the result.
void PaintingFit::require_fittable() {
    require_enough_lights(stack_.lights(), stack_.folder.string());
    std::sort(stack_.photos.begin(), stack_.photos.end(),
              [](const StackPhoto& a, const StackPhoto& b) { return a.path < b.path; });
}

void PaintingFit::require_room() const {
    // [bytes a pixel] Standard errors, and the height's solver (height.h): what every fit takes.
    constexpr double errors_and_height = 5 * sizeof(HalfError) + 21;
    require_memory_of_surface(stack_.folder, stack_.width(), stack_.height(), errors_and_height,
                              "fitting a picture");
}

void PaintingFit::preprocess(int least_reduction) {
    Preprocessed seen = tangi::preprocess(stack_, options_.register_photos, progress_, least_reduction);
    survey_ = std::move(seen.survey);
    reduced_ = std::move(seen.reduced);
    order_before_ = std::move(seen.order_before);
    report_.transfer = std::move(seen.transfer);
    report_.registration = std::move(seen.registration);
    report_.sharpening = seen.sharpening;
    report_.rejected = std::move(seen.rejected);
    report_.turned_doubt = std::move(seen.turned_doubt);
}

void PaintingFit::linearise() {
    if (stack_.transfer_of_chart && report_.transfer.source == "given")
        report_.transfer.source = "colour chart";
    // A chart in the photographs knows better.
    if (!stack_.colour) {
        stack_.colour = colour_of_profiles(stack_);
        report_.colour.by_profile = stack_.colour.has_value();
    }
    warn(report_.transfer.warning);
    transfer_ = report_.transfer.transfer;
    take_unit();
}

// The white level that is found for photographs in a unit of their own, told.
void PaintingFit::take_unit() {
    if (options_.white_level) return;
    options_.white_level = white_level_of_unit(stack_, survey_);
    if (options_.white_level)
        warn(fmt::format(
            "{}: the photographs are floats in a unit of their own: 98 % of their values are below {:.2g}. "
            "A white that faces the light is taken for {:.2g}, so that colours are right up to a "
            "common factor; give the linear value of a matt white as --white-level",
            stack_.folder.string(), bright_stored(survey_), *options_.white_level));
}

void PaintingFit::start_surface() {
    const std::optional<double> mm_per_pixel =
        options_.mm_per_pixel ? options_.mm_per_pixel : stack_.mm_per_pixel;
    surface_.mm_per_pixel = mm_per_pixel.value_or(1.0);
    surface_.scale_known = mm_per_pixel.has_value();
    surface_.photography = {.transfer = transfer_,
                            .white_level = options_.white_level.value_or(1),
                            .photos = {},
                            .rig = {},
                            .light_model = {},
                            .to_camera = {}};
}

void PaintingFit::balance_colours() {
    report_.white_balances = balance_photographs(stack_, survey_, transfer_);
    noise_ = noise_model(stack_, transfer_, options_);
    if (!options_.white_level) warn(says_too_dark(stack_, survey_, transfer_, *noise_));
}

void PaintingFit::calibrate_lights() {
    const Lighting given = listed_lighting(stack_, surface_.photography.white_level);
    if (options_.lights_as_given)
        report_.lights = {.lighting = given};
    else
        report_.lights =
            tangi::calibrate_lights({stack_, survey_, transfer_,
                                     noise_for_lights(stack_, transfer_, options_), surface_.mm_per_pixel},
                                    given, options_.ward, options_.calibration, progress_);
    report_.light_outliers = light_outliers_of(stack_, report_.lights, survey_, transfer_);
    if (!order_before_) report_.list_order = check_list_order(survey_, transfer_, stack_);
    name_photographs();
    take_white_of_chart();
    lighting_ = as_camera_sees(report_.lights.lighting, stack_);
    warn(warning_of(report_.lights, stack_.folder.string()));
}

void PaintingFit::name_photographs() {
    for (std::size_t i = 0; i < stack_.photos.size(); ++i) {
        const std::string& name = stack_.photos[i].light.name;
        report_.photo_names.push_back(name);
        if (const long pixels = survey_.photos[i].without_number; pixels > 0)
            report_.without_number.emplace_back(name, pixels);
    }
    report_.order_names = report_.photo_names;
    if (order_before_) {
        report_.list_order = std::move(order_before_->order);
        report_.order_names = std::move(order_before_->names);
    }
}

// Where a chart says it, and the user does not.
void PaintingFit::take_white_of_chart() {
    if (white_given_) return;
    const std::optional<double> white =
        white_level_by_chart(stack_, transfer_, report_.lights.lighting, surface_.mm_per_pixel);
    report_.colour.white_by_chart = white.has_value();
    if (white) surface_.photography.white_level = report_.lights.lighting.white_level = *white;
}

void PaintingFit::describe_lights() {
    tangi::describe_lights(stack_, report_.lights, surface_.photography);
    report_.light_angular_radius.deg = options_.light_radius_deg.value_or(Rig::kPointLight_deg);
    surface_.photography.rig.light_radius_deg = static_cast<float>(report_.light_angular_radius.deg);
}

void PaintingFit::select_reflectance_model() {
    // Batches fit these pixels in no time, and models that few pixels choose differ from sample to sample.
    const LightSample sample(surveyed(), options_.ward, kForModels * options_.calibration.samples);
    lobes_ = choose_lobes(sample);
    surface_.reflectance_model = report_.reflectance_model.reflectance_model;
    take_vote(report_.light_outliers, sample, stack_.lights(), lighting_, surface_.reflectance_model);
    report_.misfit = light_misfit(surveyed(), lighting_, options_.ward, surface_.reflectance_model);
}

// The reflectance model of the painting and what its lobes may be: as given, as the lights' calibration found
// it, or as validation photographs are predicted best.
LobeFreedom PaintingFit::choose_lobes(const LightSample& sample) {
    ReflectanceModelSelection& choice = report_.reflectance_model;
    const bool open = !options_.lights_as_given;
    if (open && (!options_.diffuse_roughness || !options_.second_lobe_weight))
        choice =
            tangi::select_reflectance_model(sample, lighting_, progress_, report_.lights.diffuse_roughness);
    ReflectanceModel& model = choice.reflectance_model;
    model = {.diffuse_roughness = options_.diffuse_roughness.value_or(model.diffuse_roughness),
             .second_lobe_weight = options_.second_lobe_weight.value_or(model.second_lobe_weight)};
    if (open && !options_.anisotropic_specular)
        choose_stretches(sample, lighting_, !options_.second_lobe_weight, choice);
    const bool anisotropic =
        options_.anisotropic_specular ? *options_.anisotropic_specular > 0 : choice.stretches.chosen;
    const bool rgb = stack_.channels == 3;
    if (open && !options_.coloured_specular && rgb)
        choice.colours = choose_specular_colours(sample, lighting_, model, anisotropic);
    const bool coloured =
        options_.coloured_specular ? *options_.coloured_specular > 0 : choice.colours.chosen;
    return {rgb && coloured, anisotropic};
}

// From here on all is of the reduced picture.
void PaintingFit::reduce_to_preview() {
    if (!options_.preview || reduced_.empty()) return;
    report_.reduction = reduced_.reduction();
    result_ = reduced_result(result_, reduced_);
    survey_ = at_reduced_positions(std::move(survey_), report_.reduction);
}

// The maps: not before they are needed.
void PaintingFit::make_maps(int width, int height) {
    Surface maps(width, height);
    describe(surface_, maps);
    surface_ = std::move(maps);
    result_.errors = FitErrors(width, height);
}

void PaintingFit::fit_pixels() {
    if (surface_.height_mm.empty()) make_maps(stack_.width(), stack_.height());
    visibility_ = fit_passes(
        calibrated(), std::move(reduced_), options_, lobes_,
        [this](FitResult& first, int reduction, bool height_known) {
            look_at_signs(first, reduction, height_known);
        },
        result_, progress_);
}

PaintingFit::PaintingFit(FitPlan plan, const FitOptions& options, const Progress& progress)
    : stack_(std::move(plan.stack)), options_(options), progress_(progress) {
    options_.white_level = plan.white_level;
    survey_ = std::move(plan.survey);
    transfer_ = plan.transfer;
    lighting_ = std::move(plan.lighting);
    surface_ = std::move(plan.described);
    report_ = std::move(plan.first.result.report);
    noise_ = noise_model(stack_, transfer_, options_);
}

FitPlan PaintingFit::planned() {
    TP_REQUIRE(!reduced_.empty(), "photographs are reduced");
    ReducedLook seen = look_at_reduced(
        calibrated(), reduced_, options_, lobes_,
        [this](FitResult& first, int reduction, bool height_known) {
            look_at_signs(first, reduction, height_known);
        },
        result_, progress_);
    if (!seen.suffices()) warn(says_reduced_do_not_suffice(stack_, seen));
    seen.first.result.report.warnings = stack_.warnings;
    return {.stack = std::move(stack_),
            .transfer = transfer_,
            .lighting = std::move(lighting_),
            .survey = std::move(survey_),
            .described = std::move(surface_),
            .white_level = options_.white_level,
            .first = std::move(seen.first)};
}

void PaintingFit::take_pixels(RefinedPixels pixels) {
    describe(surface_, pixels.surface);
    surface_ = std::move(pixels.surface);
    surface_.part_of.reset();  // it is the whole
    result_.errors = std::move(pixels.errors);
    PassCounts counts;
    for (const PassCounts& tile : pixels.counts) counts += tile;
    summarise(counts, options_, result_);
    settle_refined(true, lighting_, pixels.lights, surface_);
    visibility_ = std::move(pixels.lights);
}

void PaintingFit::look_at_signs(FitResult& first, int reduction, bool height_known) const {
    FitReport& seen = first.report;
    if (!height_known) seen.signs = check_signs(first.surface.normal, first.surface.confidence);
    // Where slopes say that an axis is mirrored, or all are turned, this height is of no use.
    if (seen.signs.wrong() == height_known) return;
    const Survey survey = at_reduced_positions(survey_, reduction);
    seen.shadow_signs = check_shadows(first.surface, seen.signs, {survey, transfer_, lighting_}, progress_);
}

// That compares photographs pixel by pixel.
void PaintingFit::find_misfit() {
    if (report_.reduction > 1) return;
    report_.photo_misfits = photo_misfits(calibrated(), surface_, options_.ward.model_error, progress_);
    warn_of_misfit(stack_, report_);
    if (report_.sharpening.suspected() && !report_.sharpening.found())
        warn(stack_.folder.string() + ": " + says_sharpened(report_.sharpening));
}

void PaintingFit::correct_colours() {
    const bool by_profile = report_.colour.by_profile, white_by_chart = report_.colour.white_by_chart;
    if (report_.reduction > 1 && stack_.colour) stack_.colour->chart = {};  // it is of the whole picture
    report_.colour = tangi::correct_colours(stack_, surface_);
    report_.colour.by_profile = by_profile;
    report_.colour.white_by_chart = white_by_chart;
}

void PaintingFit::find_height() {
    add_mixing_error(surface_.normal, surface_.confidence, result_.errors.slope);
    const FinalHeight height = final_height(surface_, lit_survey(), options_.height,
                                            {explains_photographs(report_), report_.refined, &*visibility_},
                                            &result_.errors.height, progress_);
    report_.height = height.report;
    report_.height_choice = height.choice;
    support_ = height.plane;
    if (!options_.light_radius_deg && (explains_photographs(report_) || report_.refined)) {
        report_.light_angular_radius = find_light_angular_radius(surface_, lit_survey());
        surface_.photography.rig.light_radius_deg = static_cast<float>(report_.light_angular_radius.deg);
    }
}

void PaintingFit::find_support() {
    report_.support_bulge_deg = bulge_deg(surface_);
    report_.support_tilt_deg =
        std::atan(std::hypot(support_.a, support_.b) / surface_.mm_per_pixel) * 180 / M_PI;
}

FitResult PaintingFit::finished() {
    warn_of_exposure(stack_, survey_, report_, options_.ward.bounds.diffuse_max, lighting_.white_level);
    warn_of_unsure_pixels(stack_, report_);
    report_.warnings = stack_.warnings;
    return std::move(result_);
}

}  // namespace tangi
