// mesh.h: the relief of a painting as triangles, to print or to look at, and as files of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <vector>

#include "surface/base/options.h"
#include "surface/maps/surface.h"

namespace tangi {

struct MeshOptions {
    int triangles = 500000;  // [1] at most; never finer than pixels
    double base_mm = 2;      // [mm] from the lowest point down to the plane below; 0: the relief alone, open

    static constexpr std::string_view name = "mesh";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"triangles", 12, 1e8, "1", "triangles of a mesh, at most"}, self.triangles);
        visit(
            FieldInfo{"base_mm", 0, 1e4, "mm", "thickness of the base below the lowest point; 0: none, open"},
            self.base_mm);
    }
};

// Frame of the surface, mm (pixels where its scale is unknown). Counter-clockwise from outside. With a base
// it is closed: each edge belongs to two triangles, once in each direction.
struct Mesh {
    std::vector<Vec3> vertices;
    std::vector<Vec3> normals;      // [unit vector] of the relief's vertices, which come first
    std::vector<glm::vec2> uv;      // of these: 0..1, from the picture's top left
    std::vector<Rgb> colours_srgb;  // of all: rho_d, 0..1
    std::vector<std::array<std::uint32_t, 3>> triangles;
    int columns = 0, rows = 0;  // of the relief's vertices
};

// Heights are means over the pixels around each vertex.
Mesh mesh_of(const Surface& surface, const MeshOptions& options);

// By the extension: .stl (binary), .ply (binary, with colours), .obj (with colours as further numbers of a
// vertex). Throws Error for another, and where the file cannot be written.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace tangi
