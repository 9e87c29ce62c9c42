// import_maps.h: maps that other programs made (Ward maps as OpenLIME shows them; albedo, normals, height) to
// a Surface.
//
// Ward maps: f = kd / pi + ks lobe, kd and ks linear 0..1; normals n = 2 c - 1, x right, y up; gloss g with
//     alpha = (1 - g (M - m) - m)^4,   m = 1 - alpha_max^(1/4),   M = 1 - alpha_min^(1/4)
// (OpenLIME's ShaderBRDF, whose alphaLimits travel beside the maps). A specular colour becomes its luminance.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "fit/height/height.h"
#include "surface/base/options.h"
#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// Pictures of one size; grey ones are fine for all but normals.
struct MapFiles {
    std::optional<std::filesystem::path> diffuse, specular, normals, gloss, roughness, height, lobe;
    std::optional<std::filesystem::path> across, tangent;  // roughness_v and tangent, of roughness
    std::optional<std::filesystem::path> confidence;       // [1] 0 = not measured
};

// The maps in a folder by their names, in any case: kd, diffuse, albedo, basecolor (also as NAME-kdmap,
// NAME_kd); ks, specular; no, nomap, normal, normals; gl, glmap, gloss; roughness, alpha; height,
// displacement; lobe (colours of lobes), roughness_v and tangent (alpha across
// it), confidence (all as write_maps() writes them). Those in `named` are taken instead of
// what the folder has. Throws Error where two files claim to be the same map.
MapFiles find_maps(const std::filesystem::path& folder, const MapFiles& named = {});

struct ImportOptions {
    std::optional<double> mm_per_pixel{};
    std::optional<double> alpha_min{}, alpha_max{};  // [1] what gloss 1 and 0 stand for; 0.01 and 0.5
    bool normals_y_down = false;                     // green grows downwards (DirectX)
    std::optional<bool> diffuse_srgb{};              // the diffuse map is sRGB-encoded; linear
    std::optional<double> height_range_mm{};         // [mm] from 0 to full scale of an integer height map; 1
    std::optional<double> second_lobe_weight{}, diffuse_roughness{};  // [1] as ReflectanceModel's
    // No flags, but what the maps' description says:
    bool scale_known = true;    // of mm_per_pixel, where that is given
    bool levelled = false;      // the height is above the support already: no plane is taken off it
    double height_from_mm = 0;  // [mm] what 0 of an integer height map stands for
    Photography photography{};

    static constexpr std::string_view name = "import";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"mm_per_pixel", 1e-6, 1e3, "mm", "size of a pixel on the painting (1 where unknown)"},
              self.mm_per_pixel);
        visit(
            FieldInfo{"alpha_min", 1e-3, 1, "1", "roughness that gloss 1 stands for (of brdf.json, or 0.01)"},
            self.alpha_min);
        visit(
            FieldInfo{"alpha_max", 1e-3, 1, "1", "roughness that gloss 0 stands for (of brdf.json, or 0.5)"},
            self.alpha_max);
        visit(FieldInfo{"normals_y_down", 0, 1, "", "green of the normal map grows downwards"},
              self.normals_y_down);
        visit(FieldInfo{"diffuse_srgb", 0, 1, "",
                        "the diffuse map is sRGB-encoded, not linear (of brdf.json, or linear)"},
              self.diffuse_srgb);
        visit(FieldInfo{"height_range_mm", 1e-6, 1e4, "mm",
                        "height of full scale over 0 in an integer height map (of maps.json, or 1)"},
              self.height_range_mm);
        visit(FieldInfo{"second_lobe_weight", 0, 1, "1",
                        "part of the gloss in a lobe of twice the roughness (of maps.json, or 0)"},
              self.second_lobe_weight);
        visit(
            FieldInfo{
                "diffuse_roughness", 0, 1, "1",
                "0: matt paint follows Lambert's law; above: that of rough surfaces (of maps.json, or 0)"},
            self.diffuse_roughness);
    }
};

// [1] What gloss 1 and 0 stand for.
double least_alpha(const ImportOptions& options);
double greatest_alpha(const ImportOptions& options);

// What the maps.json or brdf.json that write_maps() or write_openlime() wrote (export_maps.h) says of the
// maps in this folder, where `options` do not say it: scale, law and photography, and of maps of 16 bits
// encoding and heights; scale, encoding and limits of alpha. Another program's file of that name says nothing
// but what OpenLIME's layers need, too. Throws Error naming it where it cannot be read.
ImportOptions as_described(const std::filesystem::path& folder, ImportOptions options);

struct ImportReport {
    long pixels = 0, measured = 0;  // measured: with a normal
    long facing_away = 0;           // of these: z is not above 0
    double median_tilt_deg = 0;     // [deg] of the normals before anything is done to them
    double support_tilt_deg = 0;    // [deg] of the plane taken off the height
    HeightReport height;            // of the integration; converged where a height map was given
    std::vector<std::string> warnings;
};

// One map is in memory at a time beside the surface. Normals of a length under 0.5 and a confidence of 0 say
// that nothing was measured; those that point away (z not above 0) are bent up to the horizon, with a warning
// that says how many. Without normals, they are those of the height; without height, it is integrated from
// them, without cliffs, of which only photographs could tell. Throws Error naming the file: neither diffuse
// map, nor normals or height; only one of roughness_v and tangent, or either without roughness; sizes that
// differ; values that are no numbers; normals most of which point away.
Surface import_maps(const MapFiles& files, const ImportOptions& options, ImportReport& report,
                    const Progress& progress = {});

}  // namespace tangi
