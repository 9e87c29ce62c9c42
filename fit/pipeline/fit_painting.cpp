#include "fit/pipeline/fit_painting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capture/radiometry/colour_saturation.h"
#include "capture/stack/profile_colours.h"
#include "fit/calibration/capture_order_gain.h"
#include "fit/exchange/float_scale.h"
#include "fit/light_checks/light_outlier_vote.h"
#include "fit/pipeline/final_height.h"
#include "fit/pipeline/fit_passes.h"
#include "fit/pipeline/preprocess.h"
#include "surface/base/error.h"
#include "surface/image/memory_budget.h"

namespace tangi {

namespace {

constexpr int kForModels = 4;  // pixels that choose the reflectance model, by those that calibrate lights

// Files of floats have no full scale: their noise is relative to the white level.
// Floats in a unit of their own (float_scale.h) have noise in that unit, too.
double unit_of_noise(double white_level) {
    return white_level > kBrightFloats ? white_level : std::min(white_level, 1.0);
}

NoiseModel noise_model(const Stack& stack, const Transfer& transfer, const FitOptions& options) {
    if (const Development* d = stack.development.get(); d && d->bits != 32)
        return NoiseModel(d->encoding, options.noise.value_or(d->bits == 8 ? 0.012 : 0.006), true,
                          d->clipped);
    if (stack.bits == 32)
        return NoiseModel(
            transfer, options.noise.value_or(0.006 * unit_of_noise(options.white_level.value_or(1))), false);
    return NoiseModel(transfer, options.noise.value_or(stack.bits == 8 ? 0.012 : 0.006), true);
}

// Lights are told by what they hardly light, too. With the noise that is taken for the pixels' sake, shadows
// of a weak light pass for its light: of 24 lights of strengths 0.3 to 2, low ones were off by up to 12 %,
// with this by 2 %. The noise of a sensor cannot be measured where paintings are textured to the pixel.
NoiseModel noise_for_lights(const Stack& stack, const Transfer& transfer, const FitOptions& options) {
    FitOptions quiet = options;
    if (!options.noise && stack.bits == 16 && !stack.development) quiet.noise = 0.002;
    return noise_model(stack, transfer, quiet);
}

Rig rig_of(const Stack& stack) {
    Rig rig;
    if (stack.camera_mm) {
        rig.camera_distance_mm = stack.camera_mm->z;
        rig.camera_axis_mm = glm::vec2(*stack.camera_mm);
    }
    return rig;
}

// [deg] Of the photographs' directions; empty where none is known.
std::vector<double> direction_sigmas(const Stack& stack) {
    std::vector<double> sigmas;
    for (const StackPhoto& photo : stack.photos) sigmas.push_back(photo.direction_sigma_deg);
    return std::all_of(sigmas.begin(), sigmas.end(), [](double sigma) { return sigma == 0; })
               ? std::vector<double>{}
               : sigmas;
}

// Empty where they are not.
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

// Held-out photographs get the light that the others make likely.
void describe_lights(const Stack& stack, const LightCalibration& calibration, Photography& photography) {
    photography.rig = calibration.lighting.rig;
    photography.light_model = calibration.light_model;
    photography.beams = calibration.beams;
    const auto add = [&](const Light& light, bool fitted, const StackPhoto& photo) {
        photography.photos.push_back({light, fitted, photo.homography});
        if (light.direction != photo.light.direction)
            photography.photos.back().listed_direction = photo.light.direction;
    };
    const auto in_colour = [&](Light light) {
        const float strength = light.gain.g;
        if (light.gain != Rgb(strength)) light.gain = strength * light_of_gain(light.gain / strength, stack);
        return light;
    };
    for (std::size_t i = 0; i < stack.photos.size(); ++i)
        add(in_colour(calibration.lighting.lights[i]), true, stack.photos[i]);
    const Photography fitted = photography;
    const std::vector<Light>& lights = calibration.lighting.lights;  // in the order of their paths
    const ShotOrder order =
        photography.light_model ? fit_shot_order(*photography.light_model, lights) : ShotOrder{};
    for (const StackPhoto& photo : stack.held_out) {
        Light light = photo.light;
        light.direction = corrected_direction(calibration, light.direction);
        if (light.position_mm) light.position_mm = light.direction * glm::length(*light.position_mm);
        Light photographed = as_photographed(light, fitted);
        if (photography.light_model) {
            const auto before = std::count_if(stack.photos.begin(), stack.photos.end(),
                                              [&](const StackPhoto& p) { return p.path < photo.path; });
            photographed.gain =
                static_cast<float>(predicted_gain(order, *photography.light_model, lights,
                                                  photographed.direction, static_cast<int>(before))) *
                (photographed.gain / photographed.gain.g);
        }
        add(photographed, false, photo);
    }
}

// Directions as listed, which is what may be wrong; strengths as found.
LightOutliers light_outliers_of(const Stack& stack, const LightCalibration& calibration,
                                const Survey& surveyed, const Transfer& transfer) {
    std::vector<Light> lights = stack.lights();
    for (std::size_t i = 0; i < lights.size(); ++i) lights[i].gain = calibration.lighting.lights[i].gain;
    return light_outliers(surveyed, transfer, lights, stack.width(), stack.height());
}

// The law of the painting and what its lobes may be: as given, as the lights' calibration found it, or as
// validation photographs are predicted best.
LobeFreedom choose_reflectance(const LightSample& sample, const Lighting& lighting, int channels,
                               const FitOptions& options, const std::optional<double>& diffuse_roughness,
                               ReflectanceModelSelection& choice, const Progress& progress) {
    const bool open = !options.lights_as_given;
    if (open && (!options.diffuse_roughness || !options.second_lobe_weight))
        choice = select_reflectance_model(sample, lighting, progress, diffuse_roughness);
    choice.reflectance_model = {
        .diffuse_roughness = options.diffuse_roughness.value_or(choice.reflectance_model.diffuse_roughness),
        .second_lobe_weight =
            options.second_lobe_weight.value_or(choice.reflectance_model.second_lobe_weight)};
    if (open && !options.anisotropic_specular)
        choose_stretches(sample, lighting, !options.second_lobe_weight, choice);
    const bool anisotropic =
        options.anisotropic_specular ? *options.anisotropic_specular > 0 : choice.stretches.chosen;
    if (open && !options.coloured_specular && channels == 3)
        choice.colours = choose_specular_colours(sample, lighting, choice.reflectance_model, anisotropic);
    return {
        channels == 3 && (options.coloured_specular ? *options.coloured_specular > 0 : choice.colours.chosen),
        anisotropic};
}

// Finds the colour of each photograph's light beside the others', and makes it that of its light: so the fit
// takes it off in linear light, each channel with its own noise and clipping, and photographs are predicted
// as they are.
WhiteBalances balance_photographs(Stack& stack, const Survey& surveyed, const Transfer& transfer) {
    const float clipped = stack.development  ? stack.development->clipped
                          : stack.bits == 32 ? std::numeric_limits<float>::infinity()
                                             : kClipped;
    const ColourSamples samples = colour_samples(surveyed, transfer, clipped, stack.bits);
    if (samples.values.empty()) return {};
    WhiteBalances balances = white_balances(samples, stack.lights());
    std::vector<std::string> names;
    for (const StackPhoto& photo : stack.photos) names.push_back(photo.light.name);
    if (std::string warning = warning_of(colour_saturations(samples), names, stack.folder.string());
        !warning.empty())
        stack.warnings.push_back(std::move(warning));
    if (stack.colour) {
        std::vector<std::optional<glm::dvec2>> by_chart;
        for (const StackPhoto& photo : stack.photos) {
            const auto found = stack.colour->log_gains.find(photo.path.filename().string());
            by_chart.push_back(found == stack.colour->log_gains.end() ? std::nullopt
                                                                      : std::optional(found->second));
        }
        balances.refer_to(by_chart);
    }
    for (std::size_t i = 0; i < stack.photos.size(); ++i) stack.photos[i].light.gain *= balances.gain(i);
    if (std::string warning = warning_of(balances, names, stack.folder.string()); !warning.empty())
        stack.warnings.push_back(std::move(warning));
    return balances;
}

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

// The white level that was found for photographs in a unit of their own, told.
void take_unit(Stack& stack, const Survey& surveyed, FitOptions& options) {
    if (options.white_level) return;
    options.white_level = white_level_of_unit(stack, surveyed);
    if (options.white_level)
        stack.warnings.push_back(fmt::format(
            "{}: the photographs are floats in a unit of their own: 98 % of their values are below {:.2g}. "
            "A white that faces the light is taken for {:.2g}, so that colours are right up to a "
            "common factor; give the linear value of a matt white as --white-level",
            stack.folder.string(), bright_stored(surveyed), *options.white_level));
}

// What the model does not explain: by how much, in which photographs and pixels, and what is known of the
// cause.
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

}  // namespace

FitResult fit_painting(Stack stack, const FitOptions& asked, const Progress& progress) {
    validate(asked);
    FitOptions options = asked;
    require_enough_lights(stack.lights(), stack.folder.string());
    // [bytes a pixel] Standard errors, and the height's solver (height.h): what every fit takes.
    constexpr double errors_and_height = 5 * sizeof(HalfError) + 21;
    require_memory_of_surface(stack.folder, stack.width(), stack.height(), errors_and_height,
                              "fitting a picture");
    // Sums are taken in this order, so the order of the lines in a lights file changes no bit of the result.
    std::sort(stack.photos.begin(), stack.photos.end(),
              [](const StackPhoto& a, const StackPhoto& b) { return a.path < b.path; });
    FitResult result;
    FitReport& report_ = result.report;
    Preprocessed seen = preprocess(stack, options.register_photos, progress);
    const Survey& surveyed = seen.survey;
    report_.transfer = seen.transfer;
    report_.registration = std::move(seen.registration);
    report_.sharpening = seen.sharpening;
    report_.rejected = std::move(seen.rejected);
    report_.turned_doubt = std::move(seen.turned_doubt);
    if (stack.transfer_of_chart && report_.transfer.source == "given")
        report_.transfer.source = "colour chart";
    // A chart in the photographs knows better.
    if (!stack.colour) {
        stack.colour = colour_of_profiles(stack);
        report_.colour.by_profile = stack.colour.has_value();
    }
    if (!report_.transfer.warning.empty()) stack.warnings.push_back(report_.transfer.warning);
    const Transfer transfer = report_.transfer.transfer;
    take_unit(stack, surveyed, options);

    result.surface = Surface(stack.width(), stack.height());
    Surface& surface = result.surface;
    const std::optional<double> mm_per_pixel =
        options.mm_per_pixel ? options.mm_per_pixel : stack.mm_per_pixel;
    surface.mm_per_pixel = mm_per_pixel.value_or(1.0);
    surface.scale_known = mm_per_pixel.has_value();
    surface.photography = {.transfer = transfer,
                           .white_level = options.white_level.value_or(1),
                           .photos = {},
                           .rig = {},
                           .light_model = {},
                           .to_camera = {}};
    report_.white_balances = balance_photographs(stack, surveyed, transfer);
    const NoiseModel noise = noise_model(stack, transfer, options);
    if (!options.white_level)
        if (std::string warning = says_too_dark(stack, surveyed, transfer, noise); !warning.empty())
            stack.warnings.push_back(std::move(warning));
    const Lighting given{stack.lights(), rig_of(stack), surface.photography.white_level,
                         direction_sigmas(stack)};
    report_.lights =
        options.lights_as_given
            ? LightCalibration{.lighting = given}
            : calibrate_lights(stack, surveyed, transfer, noise_for_lights(stack, transfer, options), given,
                               surface.mm_per_pixel, options.ward, options.calibration, progress);
    report_.light_outliers = light_outliers_of(stack, report_.lights, surveyed, transfer);
    if (!seen.order_before) report_.list_order = check_list_order(surveyed, transfer, stack);
    for (std::size_t i = 0; i < stack.photos.size(); ++i) {
        const std::string& name = stack.photos[i].light.name;
        report_.photo_names.push_back(name);
        if (const long pixels = surveyed.photos[i].without_number; pixels > 0)
            report_.without_number.emplace_back(name, pixels);
    }
    report_.order_names = report_.photo_names;
    if (seen.order_before) {
        report_.list_order = std::move(seen.order_before->order);
        report_.order_names = std::move(seen.order_before->names);
    }
    std::optional<double> white;
    if (!asked.white_level)
        white = white_level_by_chart(stack, transfer, report_.lights.lighting, surface.mm_per_pixel);
    if (white) surface.photography.white_level = report_.lights.lighting.white_level = *white;
    const Lighting lighting = as_camera_sees(report_.lights.lighting, stack);
    if (std::string warning = warning_of(report_.lights, stack.folder.string()); !warning.empty())
        stack.warnings.push_back(std::move(warning));
    describe_lights(stack, report_.lights, surface.photography);
    float& light_radius_deg = surface.photography.rig.light_radius_deg;
    report_.light_angular_radius.deg = options.light_radius_deg.value_or(Rig::kPointLight_deg);
    light_radius_deg = static_cast<float>(report_.light_angular_radius.deg);
    // Batches fit these pixels in no time, and laws that few pixels choose differ from sample to sample.
    const LightSample sample(stack, surveyed, transfer, noise, surface.mm_per_pixel, options.ward,
                             kForModels * options.calibration.samples);
    const LobeFreedom lobes =
        choose_reflectance(sample, lighting, stack.channels, options, report_.lights.diffuse_roughness,
                           report_.reflectance_model, progress);
    surface.reflectance_model = report_.reflectance_model.reflectance_model;
    take_vote(report_.light_outliers, sample, stack.lights(), lighting, surface.reflectance_model);
    report_.misfit = light_misfit(stack, surveyed, transfer, noise, lighting, surface.mm_per_pixel,
                                  options.ward, surface.reflectance_model);
    result.errors = FitErrors(stack.width(), stack.height());
    const auto look_at_signs = [&](bool height_known) {
        if (!height_known) report_.signs = check_signs(surface.normal, surface.confidence);
        // Where slopes say that an axis is mirrored, or all are turned, this height is of no use.
        if (report_.signs.wrong() != height_known)
            report_.shadow_signs = check_shadows(surface, report_.signs, surveyed, transfer, lighting.lights,
                                                 lighting.white_level, progress);
    };
    const LightVisibility lights =
        fit_passes(stack, transfer, lighting, noise, options, lobes, look_at_signs, result, progress);
    report_.photo_misfits =
        photo_misfits(stack, transfer, noise, surface, lighting, options.ward.model_error, progress);
    warn_of_misfit(stack, report_);
    if (report_.sharpening.suspected() && !report_.sharpening.found())
        stack.warnings.push_back(stack.folder.string() + ": " + says_sharpened(report_.sharpening));
    const bool by_profile = report_.colour.by_profile;
    report_.colour = correct_colours(stack, surface);
    report_.colour.by_profile = by_profile;
    report_.colour.white_by_chart = white.has_value();
    const FinalHeight height = final_height(surface, surveyed, transfer, lighting, options.height,
                                            {explains_photographs(report_), report_.refined, &lights},
                                            &result.errors.height, progress);
    report_.height = height.report;
    report_.height_choice = height.choice;
    if (!options.light_radius_deg && (explains_photographs(report_) || report_.refined)) {
        report_.light_angular_radius = find_light_angular_radius(surface, surveyed, transfer, lighting);
        light_radius_deg = static_cast<float>(report_.light_angular_radius.deg);
    }
    report_.support_bulge_deg = bulge_deg(surface);
    report_.support_tilt_deg =
        std::atan(std::hypot(height.plane.a, height.plane.b) / surface.mm_per_pixel) * 180 / M_PI;
    const bool overexposed = warn_of_clipping(stack, surveyed);
    if (report_.too_bright > report_.fitted / 20 && !overexposed)
        stack.warnings.push_back(
            fmt::format("{}: {:.0f} % of the pixels would reflect more than {} times the light that falls on "
                        "them: the white "
                        "level {} is too low; give the linear value of a matt white as --white-level",
                        stack.folder.string(),
                        100.0 * static_cast<double>(report_.too_bright) / static_cast<double>(report_.fitted),
                        options.ward.bounds.diffuse_max, lighting.white_level));
    constexpr double kManyUnsure = 0.1;
    if (report_.unsure > kManyUnsure)
        stack.warnings.push_back(
            fmt::format("{}: of {:.0f} % of the pixels the photographs hardly tell the slope (confidence "
                        "below 0.5): they are "
                        "too dark, or too few lights reach them, and lights higher above the painting would",
                        stack.folder.string(), 100 * report_.unsure));
    report_.warnings = stack.warnings;
    return result;
}

}  // namespace tangi
