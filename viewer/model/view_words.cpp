#include "viewer/model/view_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surface/publish/svg_elements.h"
#include "surface/publish/web_annotations.h"

namespace tangi {

namespace {

constexpr double kLowestLight_deg = 2,
                 kMostSoftness_deg = 15;  // as the panels' sliders and link.js have them

// As link.js rounds them.
double to_four_places(double value) { return std::round(1e4 * value) / 1e4 + 0.0; }

class ViewWords {
public:
    void add(const std::string& name, const std::string& value) {
        text += fmt::format("{}{}={}", text.empty() ? "" : "&", name, value);
    }
    void add(const std::string& name, double value) { add(name, fmt::format("{}", to_four_places(value))); }

    std::string text;
};

double near_of(const ViewLight& light) { return light.near ? static_cast<double>(light.distance) : 0; }

// Those that shine, the one that is moved first; where none does, that one, dark.
std::vector<ViewLight> shining(const WindowState& s) {
    std::vector<ViewLight> lights;
    for (std::size_t i = 0; i < s.lights.size(); ++i)
        if (s.lights[i].on) lights.insert(i == s.light ? lights.begin() : lights.end(), s.lights[i]);
    if (!lights.empty()) return lights;
    lights.push_back(s.lights[s.light]);
    lights.front().gain = 0;
    return lights;
}

// azimuth, elevation, strength, distance (0: far away).
ViewLight light_from(double azimuth_deg, double elevation_deg, double gain, double near) {
    ViewLight light;
    light.angles = {std::remainder(azimuth_deg, 360.0), std::clamp(elevation_deg, kLowestLight_deg, 90.0)};
    light.gain = static_cast<float>(std::clamp(gain, 0.0, 4.0));
    light.near = near > 0;
    if (light.near) light.distance = static_cast<float>(std::clamp(near, 0.2, 5.0));
    return light;
}

void follow_lights(WindowState& s, std::string_view words) {
    const auto azimuth = number_in_view(words, "azimuth"), elevation = number_in_view(words, "elevation");
    if (!azimuth || !elevation) return;
    s.lights = {light_from(*azimuth, *elevation, number_in_view(words, "gain").value_or(1),
                           number_in_view(words, "near").value_or(0))};
    for (std::size_t i = 2; i <= kMostViewLights; ++i) {
        const std::vector<double> v =
            numbers_in_list(word_in_view(words, fmt::format("light_{}", i))).numbers;
        if (v.size() == 4) s.lights.push_back(light_from(v[0], v[1], v[2], v[3]));
    }
    s.light = 0;
    s.sweeping = false;
    const auto illuminant = illuminant_named(word_in_view(words, "illuminant"));
    if (const Illuminant lit_by = illuminant.value_or(Illuminant::d65); lit_by != s.illuminant)
        s.see_in(lit_by);
}

void follow_view(WindowState& s, std::string_view words) {
    const auto number = [&](std::string_view name, double otherwise, double low, double high) {
        return std::clamp(number_in_view(words, name).value_or(otherwise), low, high);
    };
    View& view = s.view;
    view.centre_px = {number("x", view.centre_px.x, 0, std::max(s.painting.width - 1, 0)),
                      number("y", view.centre_px.y, 0, std::max(s.painting.height - 1, 0))};
    view.zoom = number("zoom", view.zoom, View::kSmallest, View::kLargest);
    if (const auto turn = number_in_view(words, "turn")) view.turn_deg = std::remainder(*turn, 360.0);
    const glm::dvec2 tilt = s.tilt.angle_deg;
    s.tilt = Tilt{.angle_deg = {number("tilt_x", tilt.x, -Tilt::kMost_deg, Tilt::kMost_deg),
                                number("tilt_y", tilt.y, -Tilt::kMost_deg, Tilt::kMost_deg)}};
    if (number_in_view(words, "tilt_x")) s.flat = number("flat", 0, 0, 1) != 0;
}

void follow_look(WindowState& s, std::string_view words) {
    const auto take = [&](const char* name, float& value, double low, double high) {
        if (const auto told = number_in_view(words, name))
            value = static_cast<float>(std::clamp(*told, low, high));
    };
    if (const auto look = number_in_view(words, "look")) {
        const auto last = static_cast<double>(view_modes().size() - 1);
        s.mode = static_cast<ViewMode>(std::lround(std::clamp(*look, 0.0, last)));
    }
    if (const auto shadows = number_in_view(words, "shadows")) s.shadows = *shadows != 0;
    take("softness", s.light_radius_deg, 0, kMostSoftness_deg);
    take("exposure", s.exposure_stops, -4, 4);
    take("ambient", s.ambient, 0, 1);
    take("shoulder", s.shoulder, 0, 1);
    take("effect", s.strength, 0, 1);
    take("sharpness", s.sharpness, 2, 200);
    take("lowest", s.lowest_mm, -1e6, 1e6);
    take("highest", s.highest_mm, -1e6, 1e6);
    take("curvature", s.most_curvature, 1e-6, 1e6);
    if (const auto model = ward_model_named(word_in_view(words, "ward"))) s.model = *model;
}

}  // namespace

std::string view_words(const WindowState& s) {
    ViewWords words;
    const std::vector<ViewLight> lights = shining(s);
    words.add("azimuth", lights.front().angles.azimuth_deg);
    words.add("elevation", lights.front().angles.elevation_deg);
    words.add("tilt_x", s.tilt.angle_deg.x);
    words.add("tilt_y", s.tilt.angle_deg.y);
    words.add("x", s.view.centre_px.x);
    words.add("y", s.view.centre_px.y);
    words.add("zoom", s.view.zoom);
    words.add("turn", s.view.turn_deg);
    words.add("look", static_cast<double>(s.mode));
    words.add("softness", static_cast<double>(s.light_radius_deg));
    words.add("exposure", static_cast<double>(s.exposure_stops));
    words.add("ambient", static_cast<double>(s.ambient));
    words.add("shoulder", static_cast<double>(s.shoulder));
    words.add("colour", "ffffff");  // a page's light may have another
    words.add("shadows", s.shadows ? 1.0 : 0.0);
    words.add("gain", static_cast<double>(lights.front().gain));
    words.add("near", near_of(lights.front()));
    for (std::size_t i = 1; i < lights.size(); ++i)
        words.add(fmt::format("light_{}", i + 1),
                  fmt::format("{},{},{},{}", to_four_places(lights[i].angles.azimuth_deg),
                              to_four_places(lights[i].angles.elevation_deg),
                              to_four_places(static_cast<double>(lights[i].gain)),
                              to_four_places(near_of(lights[i]))));
    if (s.flat) words.add("flat", 1);
    words.add("illuminant", std::string(name_of(s.illuminant)));
    words.add("ward", std::string(name_of(s.model)));
    words.add("effect", static_cast<double>(s.strength));
    words.add("sharpness", static_cast<double>(s.sharpness));
    words.add("lowest", static_cast<double>(s.lowest_mm));
    words.add("highest", static_cast<double>(s.highest_mm));
    words.add("curvature", static_cast<double>(s.most_curvature));
    return words.text;
}

void follow_view_words(WindowState& s, std::string_view words) {
    if (words.empty()) return;
    follow_lights(s, words);
    follow_view(s, words);
    follow_look(s, words);
}

}  // namespace tangi
