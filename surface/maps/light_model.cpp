#include "surface/maps/light_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "surface/maps/light_direction.h"

namespace tangi {

namespace {

std::vector<glm::dvec3> directions_of(std::span<const Light> lights) {
    std::vector<glm::dvec3> directions;
    for (const Light& light : lights) directions.emplace_back(light.direction);
    return directions;
}

template <class Value>
GaussianProcess process_of(std::span<const Light> lights, Value&& value) {
    std::vector<double> values;
    for (const Light& light : lights) values.push_back(value(light));
    return fit_gaussian_process(directions_of(lights), values);
}

double log_of(float value) { return std::log(std::max(static_cast<double>(value), 1e-6)); }

bool is_grey(const Light& light) { return light.gain == Rgb(light.gain.g); }

// [1/mm^degree] What a term of a beam is multiplied by.
double unit_of(std::size_t term, double radius_mm) { return term < 2 ? radius_mm : radius_mm * radius_mm; }

}  // namespace

LightModel fit_light_model(std::span<const Light> lights) {
    LightModel model{process_of(lights, [](const Light& light) { return log_of(light.gain.g); })};
    if (std::ranges::all_of(lights, is_grey)) return model;
    const auto colour = [&](int channel) {
        return process_of(lights,
                          [&](const Light& light) { return log_of(light.gain[channel] / light.gain.g); });
    };
    model.log_colours = {colour(0), colour(2)};
    return model;
}

double predicted_gain(const LightModel& model, std::span<const Light> lights, const Vec3& direction) {
    return std::exp(predicted(model.log_gain, directions_of(lights), glm::dvec3(direction)));
}

Rgb predicted_colour(const LightModel& model, std::span<const Light> lights, const Vec3& direction) {
    if (!model.log_colours) return Rgb(1);
    const std::vector<glm::dvec3> directions = directions_of(lights);
    const auto against_green = [&](const GaussianProcess& process) {
        return static_cast<float>(std::exp(predicted(process, directions, glm::dvec3(direction))));
    };
    return {against_green((*model.log_colours)[0]), 1, against_green((*model.log_colours)[1])};
}

BeamModel fit_beam_model(std::span<const Light> lights, double radius_mm) {
    BeamModel model{.radius_mm = radius_mm};
    for (std::size_t term = 0; term < model.terms.size(); ++term)
        model.terms[term] = process_of(lights, [&](const Light& light) {
            return static_cast<double>(light.beam.terms[term]) * unit_of(term, radius_mm);
        });
    return model;
}

Beam predicted_beam(const BeamModel& model, std::span<const Light> lights, const Vec3& direction) {
    Beam beam;
    const std::vector<glm::dvec3> directions = directions_of(lights);
    for (std::size_t term = 0; term < model.terms.size(); ++term)
        beam.terms[term] = static_cast<float>(
            predicted(model.terms[term], directions, glm::dvec3(direction)) / unit_of(term, model.radius_mm));
    return beam;
}

DirectionModel fit_direction_model(std::span<const Vec3> listed, std::span<const Light> lights) {
    const std::vector<glm::dvec3> directions(listed.begin(), listed.end());
    DirectionModel model;
    for (int i = 0; i < 2; ++i) {
        std::vector<double> turns;
        for (std::size_t k = 0; k < lights.size(); ++k)
            turns.push_back(turn_between(directions[k], glm::dvec3(lights[k].direction))[i]);
        model.turn[static_cast<std::size_t>(i)] = fit_gaussian_process(directions, turns);
    }
    return model;
}

Vec3 predicted_direction(const DirectionModel& model, std::span<const Vec3> listed, const Vec3& direction) {
    const std::vector<glm::dvec3> directions(listed.begin(), listed.end());
    const glm::dvec3 from(direction);
    return Vec3(turned(
        from, {predicted(model.turn[0], directions, from), predicted(model.turn[1], directions, from)}));
}

}  // namespace tangi
