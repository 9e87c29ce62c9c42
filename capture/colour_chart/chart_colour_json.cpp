// chart_colour_json.cpp: what was found of the chart and its colours, as JSON
// (docs/reference/capture-json.md).
#include "capture/colour_chart/chart_colour.h"
#include "surface/maps/photography_json.h"

namespace tangi {

using nlohmann::json;

namespace {

json summary_of(const ColourErrors& errors) {
    if (!(errors.mean >= 0)) return nullptr;
    return {{"mean", errors.mean}, {"maximum", errors.maximum}, {"percentile_90", errors.percentile_90}};
}

json or_null(double error) { return error >= 0 ? json(error) : json(nullptr); }

}  // namespace

json to_json(const FoundChart& chart) {
    json corners = json::array();
    for (const glm::dvec2& c : chart_corners(chart)) corners.push_back({c.x, c.y});
    return {{"corners_px", std::move(corners)},
            {"chart_to_picture", to_json(chart.chart_to_picture)},
            {"given", chart.patches_seen == 0},
            {"patches_seen", chart.patches_seen},
            {"grid_residual_px", chart.grid_residual_px},
            {"misfit", chart.misfit},
            {"warnings", chart.warnings}};
}

json to_json(const ColourCorrection& c, const ChartReference& reference) {
    json patches = json::array();
    for (std::size_t i = 0; i < kChartPatches; ++i)
        patches.push_back(
            {{"number", i + 1},
             {"name", reference.patches[i].name},
             {"reference",
              {reference.patches[i].linear.r, reference.patches[i].linear.g, reference.patches[i].linear.b}},
             {"photographs", c.lights.photos[i]},
             {"before", or_null(c.before.patches[i])},
             {"after", or_null(c.after.patches[i])},
             {"cross_validated", or_null(c.cross_validated.patches[i])}});
    json photos = json::array();
    for (const ColourCorrection::OfPhoto& photo : c.of_photos) photos.push_back(summary_of(photo.after));
    return {{"reference", c.reference},
            {"white_balance", {c.white_balance.r, c.white_balance.g, c.white_balance.b}},
            {"matrix", to_json(c.matrix)},
            {"matrix_solved", c.matrix_solved},
            {"neutral_kept", c.neutral_kept},
            {"delta_e_2000",
             {{"before", summary_of(c.before)},
              {"after", summary_of(c.after)},
              {"cross_validated", summary_of(c.cross_validated)},
              {"neutral", c.neutral_error},
              {"neutral_gain", c.neutral_gain}}},
            {"light", {{"degree", c.light_degree}, {"residual", c.lights.residual}}},
            {"of_photographs", std::move(photos)},
            {"patches_used", c.patches_used},
            {"patches", std::move(patches)},
            {"warnings", c.warnings}};
}

}  // namespace tangi
