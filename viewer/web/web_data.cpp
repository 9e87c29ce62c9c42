#include "viewer/web/web_data.h"

#include <algorithm>

#include "surface/file/version.h"
#include "viewer/render/painting_shader.h"
#include "viewer/render/scene.h"
#include "viewer/render/vertex_shader.h"
#include "viewer/render/view_mode.h"

namespace tangi {

using nlohmann::json;

namespace {

// View modes in the order of their numbers: names, and what the scale of each begins and ends with.
json looks(const Surface& s, const ShownHeights& heights) {
    Scene scene;
    scene.lowest_mm = heights.lowest_mm;
    scene.highest_mm = heights.highest_mm;
    scene.most_curvature = first_most_curvature(s.mm_per_pixel);
    json all = json::array();
    for (const ViewModeTraits& mode : view_modes()) {
        scene.mode = mode.mode;
        const ScaleEnds ends = scale_ends(scene);
        all.push_back({{"name", mode.name}, {"ends", {ends.lowest, ends.highest}}});
    }
    return all;
}

}  // namespace

int web_levels(int width, int height) {
    int levels = 1;
    while (std::max(width, height) > 1LL << (kTileBits + levels - 1)) ++levels;
    return levels;
}

ShownHeights heights_of(const Surface& s) {
    const auto [low, high] = std::minmax_element(s.height_mm.pixels().begin(), s.height_mm.pixels().end());
    return {*low, *high};
}

json web_picture_data(const Surface& s, const TexelRange& range, const ShownHeights& heights) {
    return {{"width", s.width()},
            {"height", s.height()},
            {"mm_per_pixel", s.mm_per_pixel},
            {"scale_known", s.scale_known},
            {"levels", web_levels(s.width(), s.height())},
            {"range",
             {range.diffuse_max, range.specular_max, range.height_min_mm,
              range.height_max_mm - range.height_min_mm}},
            {"reflectance_model",
             {s.reflectance_model.diffuse_roughness, s.reflectance_model.second_lobe_weight}},
            {"specular_colour", range.coloured_specular},
            {"anisotropic_specular", range.anisotropic_specular},
            {"looks", looks(s, heights)},
            {"software", program_name()},
            {"vertex_shader", kPaintingVertexShader},
            {"fragment_shader", painting_fragment_shader()}};
}

}  // namespace tangi
