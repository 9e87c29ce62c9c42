// export_maps.h: the maps of a Surface as pictures, for other programs.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "surface/base/progress.h"
#include "surface/maps/surface.h"

namespace tangi {

// height.exr [mm], normal.exr [unit vector], diffuse.exr [linear], specular.exr, roughness.exr,
// confidence.exr, lobe.exr where lobes have colours, roughness_v.exr and tangent.exr [rad] where they are
// anisotropic: 32-bit floats, and maps.json with the scale, the law that all pixels share (second lobe,
// diffuse_roughness), and white level, light from all around and camera as the attribute `photography` has
// them, without photographs. import_maps() reads them back. Files appear one by one, each whole (AtomicFolder
// makes of them a folder that is there as a whole); returns their paths. Throws Error where the folder cannot
// be written.
std::vector<std::filesystem::path> write_maps(const std::filesystem::path& folder, const Surface& surface,
                                              const Progress& progress = {});

// What maps.json says of a surface.
nlohmann::json about_maps(const Surface& surface);

// What OpenLIME's Ward shader takes: kd.png (sRGB), ks.png (in colour where lobes are), normals.png (2 c -
// 1), gloss.png (of lobes that are anisotropic the mean), 8 bit, since browsers show no more, all but kd.png
// without a colour space, so that a page's shader has the numbers as they are; and brdf.json
// with colorspaces and alphaLimits, which its channels need. Lobes outside the limits [0.01, 1] and rho_d
// above 1 are clamped; the number of clamped pixels is in brdf.json. A second lobe and diffuse roughness have
// no place there and are left out.
std::vector<std::filesystem::path> write_openlime(const std::filesystem::path& folder, const Surface& surface,
                                                  const Progress& progress = {});

}  // namespace tangi
