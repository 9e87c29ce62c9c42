#include "fit/pipeline/fit_lights.h"

#include <algorithm>
#include <limits>

#include "capture/radiometry/colour_saturation.h"
#include "fit/exchange/float_scale.h"

namespace tangi {

namespace {

// Files of floats have no full scale: their noise is relative to the white level.
// Floats in a unit of their own (float_scale.h) have noise in that unit, too.
double unit_of_noise(double white_level) {
    return white_level > kBrightFloats ? white_level : std::min(white_level, 1.0);
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

Light in_colour(Light light, const Stack& stack) {
    const float strength = light.gain.g;
    if (light.gain != Rgb(strength)) light.gain = strength * light_of_gain(light.gain / strength, stack);
    return light;
}

// As the chart showed each photograph's white balance, where it did. stack.colour is there.
std::vector<std::optional<glm::dvec2>> log_gains_by_chart(const Stack& stack) {
    std::vector<std::optional<glm::dvec2>> by_chart;
    for (const StackPhoto& photo : stack.photos) {
        const auto found = stack.colour->log_gains.find(photo.path.filename().string());
        by_chart.push_back(found == stack.colour->log_gains.end() ? std::nullopt
                                                                  : std::optional(found->second));
    }
    return by_chart;
}

}  // namespace

NoiseModel noise_model(const Stack& stack, const Transfer& transfer, const FitOptions& options) {
    if (const Development* d = stack.development.get(); d && d->bits != 32)
        return NoiseModel(d->encoding, options.noise.value_or(d->bits == 8 ? 0.012 : 0.006), true,
                          d->clipped);
    if (stack.bits == 32)
        return NoiseModel(
            transfer, options.noise.value_or(0.006 * unit_of_noise(options.white_level.value_or(1))), false);
    return NoiseModel(transfer, options.noise.value_or(stack.bits == 8 ? 0.012 : 0.006), true);
}

NoiseModel noise_for_lights(const Stack& stack, const Transfer& transfer, const FitOptions& options) {
    FitOptions quiet = options;
    if (!options.noise && stack.bits == 16 && !stack.development) quiet.noise = 0.002;
    return noise_model(stack, transfer, quiet);
}

Lighting listed_lighting(const Stack& stack, double white_level) {
    return {stack.lights(), rig_of(stack), white_level, direction_sigmas(stack)};
}

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
    if (stack.colour) balances.refer_to(log_gains_by_chart(stack));
    for (std::size_t i = 0; i < stack.photos.size(); ++i) stack.photos[i].light.gain *= balances.gain(i);
    if (std::string warning = warning_of(balances, names, stack.folder.string()); !warning.empty())
        stack.warnings.push_back(std::move(warning));
    return balances;
}

LightOutliers light_outliers_of(const Stack& stack, const LightCalibration& calibration,
                                const Survey& surveyed, const Transfer& transfer) {
    std::vector<Light> lights = stack.lights();
    for (std::size_t i = 0; i < lights.size(); ++i) lights[i].gain = calibration.lighting.lights[i].gain;
    return light_outliers(surveyed, transfer, lights, stack.width(), stack.height());
}

void describe_lights(const Stack& stack, const LightCalibration& calibration, Photography& photography) {
    const std::vector<Light>& lights = calibration.lighting.lights;
    photography.rig = calibration.lighting.rig;
    photography.beams = calibration.beams;
    photography.directions = calibration.directions;
    const auto add = [&](const Light& light, bool fitted, const StackPhoto& photo) {
        photography.photos.push_back({light, fitted, photo.homography});
        if (light.direction != photo.light.direction)
            photography.photos.back().listed_direction = photo.light.direction;
    };
    for (std::size_t i = 0; i < stack.photos.size(); ++i)
        add(in_colour(lights[i], stack), true, stack.photos[i]);
    if (calibration.light_model) photography.light_model = fit_light_model(fitted_lights(photography));
    const Photography fitted = photography;
    for (const StackPhoto& photo : stack.held_out) add(as_photographed(photo.light, fitted), false, photo);
}

}  // namespace tangi
