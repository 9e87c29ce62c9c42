// export_mesh.cpp: a painting as a mesh to print (.stl, .ply, .obj), or to look at (glTF).
#include "cli/arguments.h"
#include "cli/export/exporter.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/height_unit.h"
#include "surface/publish/gltf_file.h"

namespace tangi {

namespace {

void require_extension(const ExportArguments& a, const char* extension) {
    require_ending(a.out, {extension}, fmt::format("--to {} writes a {} file", a.to, extension));
    refuse_to_overwrite(a.out, {a.painting});
}

// Of which a print, or a room, would be of the wrong size.
nlohmann::json doubts_of_scale(const ExportArguments& a, const Surface& surface) {
    if (surface.scale_known) return nlohmann::json::array();
    return told(
        {fmt::format("{}: its scale is not known, and a pixel is taken for {:g} mm; heights are as right "
                     "as that is",
                     a.painting, surface.mm_per_pixel)});
}

nlohmann::json result_of(const ExportArguments& a, const Surface& surface, const std::optional<Mesh>& mesh) {
    nlohmann::json result = {
        {"files", {a.out}},
        {"unit", a.to == "gltf" ? std::string("m")
                                : std::string(height_unit_of(surface.mm_per_pixel, surface.scale_known))},
        {"warnings", doubts_of_scale(a, surface)}};
    if (mesh) result["vertices"] = mesh->vertices.size(), result["triangles"] = mesh->triangles.size();
    return result;
}

}  // namespace

nlohmann::json export_mesh(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    require_extension(a, exporter_named(a.to).extension);
    const std::shared_ptr<const Surface> surface = job.seen_in_scale();
    const Mesh mesh = mesh_of(*surface, a.mesh);
    write_mesh(a.out, mesh);
    nlohmann::json result = result_of(a, *surface, mesh);
    result["closed"] = a.mesh.base_mm > 0;
    return result;
}

nlohmann::json export_gltf(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    require_extension(a, ".glb");
    const std::shared_ptr<const Surface> surface = job.seen_in_scale();
    std::optional<Mesh> mesh;
    if (a.relief) mesh = mesh_of(*surface, {.triangles = a.mesh.triangles, .base_mm = 0});
    write_gltf(a.out, *surface, mesh);
    return result_of(a, *surface, mesh);
}

}  // namespace tangi
