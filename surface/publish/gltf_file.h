// gltf_file.h: a painting as a binary glTF 2.0 file (.glb): a mesh of its relief, or a plane with a normal
// map, and its reflectance as that of glTF.
#pragma once

#include <filesystem>
#include <optional>

#include "surface/publish/mesh.h"

namespace tangi {

// rho_d is the base colour. The lobe of Ward, whose alpha is that of Beckmann, becomes glTF's of the same
// alpha = roughness^2; rho_s over the 0.04 of glTF's dielectric is the colour of KHR_materials_specular;
// lobes that are anisotropic are those of KHR_materials_anisotropy. Lengths are in metres. `mesh`: the relief
// as mesh_of() makes it, whose base is left out; without it the normals are a map on a plane. Throws Error
// where the file cannot be written.
void write_gltf(const std::filesystem::path& path, const Surface& surface, const std::optional<Mesh>& mesh);

}  // namespace tangi
