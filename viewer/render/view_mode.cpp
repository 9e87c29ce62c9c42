#include "viewer/render/view_mode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

#include "viewer/render/view_mode_chunks.h"

namespace tangi {

namespace {

using Curve = MapScale::Curve;
using Ends = MapScale::Ends;

constexpr std::array kViewModes = {
    ViewModeTraits{.mode = ViewMode::painting, .name = "Painting", .chunk = ""},
    ViewModeTraits{.mode = ViewMode::specular_enhancement,
                   .name = "Specular enhancement",
                   .chunk = view_mode_chunks::specular_enhancement,
                   .strongest = 1,
                   .gloss_exponent = true},
    ViewModeTraits{.mode = ViewMode::diffuse_gain,
                   .name = "Diffuse gain",
                   .chunk = view_mode_chunks::diffuse_gain,
                   .strongest = 3},
    ViewModeTraits{.mode = ViewMode::unsharp_normals,
                   .name = "Unsharp normals",
                   .chunk = view_mode_chunks::unsharp_normals,
                   .strongest = 3,
                   .coarser_levels = 3},
    ViewModeTraits{.mode = ViewMode::height,
                   .name = "Height",
                   .chunk = view_mode_chunks::height,
                   .scale = {.curve = Curve::linear, .ends = Ends::heights}},
    ViewModeTraits{.mode = ViewMode::roughness,
                   .name = "Roughness α",
                   .chunk = view_mode_chunks::roughness,
                   .scale = {.curve = Curve::logarithmic, .fixed = {0.02, 1.28}}},
    ViewModeTraits{.mode = ViewMode::specular,
                   .name = "Specular ρs",
                   .chunk = view_mode_chunks::specular,
                   .scale = {.curve = Curve::square_root, .fixed = {0, 0.3}}},
    ViewModeTraits{.mode = ViewMode::confidence,
                   .name = "Confidence",
                   .chunk = view_mode_chunks::confidence,
                   .scale = {.curve = Curve::linear, .lowest_means = "unknown", .highest_means = "certain"}},
    ViewModeTraits{.mode = ViewMode::normals, .name = "Normals", .chunk = view_mode_chunks::normals},
    ViewModeTraits{
        .mode = ViewMode::diffuse, .name = "Diffuse colour ρd", .chunk = view_mode_chunks::diffuse},
    ViewModeTraits{.mode = ViewMode::curvature,
                   .name = "Curvature",
                   .chunk = view_mode_chunks::curvature,
                   .scale = {.curve = Curve::diverging, .ends = Ends::curvature}}};

constexpr bool in_order_of_view_mode() {
    for (std::size_t i = 0; i < kViewModes.size(); ++i)
        if (kViewModes[i].mode != static_cast<ViewMode>(i)) return false;
    return true;
}
static_assert(in_order_of_view_mode());

}  // namespace

std::span<const ViewModeTraits> view_modes() { return kViewModes; }

const ViewModeTraits& traits_of(ViewMode mode) { return kViewModes[static_cast<std::size_t>(mode)]; }

double value_at(const MapScale& scale, const ScaleEnds& ends, double t) {
    const auto [lowest, highest] = ends;
    switch (scale.curve) {
        case Curve::logarithmic:
            return lowest * std::pow(highest / lowest, t);
        case Curve::square_root:
            return lowest + (highest - lowest) * t * t;
        default:
            return (1 - t) * lowest + t * highest;
    }
}

std::string scale_chunk(const MapScale& scale) {
    const auto number = [](double value) { return fmt::format("{:#.9g}", value); };  // # keeps the point
    const bool fixed = scale.ends == Ends::fixed;
    const auto [lowest, highest] = scale.fixed;
    const std::string low = fixed ? number(lowest) : "v_look.z", high = fixed ? number(highest) : "v_look.w";
    const std::string range = fixed ? number(highest - lowest) : "max(v_look.w - v_look.z, 1e-9)";
    const auto function = [](const std::string& value) {
        return fmt::format("float scaled(float value) {{ return {}; }}\n", value);
    };
    switch (scale.curve) {
        case Curve::none:
            return "";
        case Curve::linear:
            return function(fmt::format("(value - {}) / {}", low, range));
        case Curve::square_root:
            return function(fmt::format("sqrt((value - {}) / {})", low, range));
        case Curve::logarithmic:
            return function(fmt::format(
                "log2(value / {}) / {}", low,
                fixed ? number(std::log2(highest / lowest)) : fmt::format("log2({} / {})", high, low)));
        case Curve::diverging:
            return function(fmt::format("value / {}", high));
    }
    return "";
}

Rgb false_colour(float t) {
    constexpr std::array<Rgb, 5> stops = {Rgb(0.058f, 0.0003f, 0.089f), Rgb(0.042f, 0.084f, 0.258f),
                                          Rgb(0.015f, 0.279f, 0.264f), Rgb(0.107f, 0.578f, 0.125f),
                                          Rgb(0.983f, 0.799f, 0.018f)};
    const float at = 4 * std::clamp(t, 0.0f, 1.0f);
    const auto below = std::min(static_cast<std::size_t>(at), std::size_t(3));
    return glm::mix(stops[below], stops[below + 1], at - static_cast<float>(below));
}

}  // namespace tangi
