// export_maps.cpp: the maps of a painting as it looks, as EXR files and as OpenLIME takes them.
#include "fit/exchange/export_maps.h"
#include "cli/arguments.h"
#include "cli/relight/exporter.h"

namespace tangi {

namespace {

std::vector<std::string> lost_to_openlime(const std::string& painting, const Surface& surface) {
    std::vector<std::string> lost;
    if (!surface.lobe_axes.empty())
        lost.push_back(
            fmt::format("{}: its gloss is anisotropic in places (brushed metal, a weave), which "
                        "OpenLIME's maps cannot hold: they are written as round ones of the same mean "
                        "roughness; --to maps keeps them",
                        painting));
    if (surface.reflectance_model.second_lobe_weight > 0)
        lost.push_back(fmt::format(
            "{}: a part of its gloss, {:.2g}, is a second lobe of twice the roughness, which OpenLIME's maps "
            "cannot hold: highlights are shown narrower than they are; --to maps keeps it",
            painting, surface.reflectance_model.second_lobe_weight));
    if (surface.reflectance_model.diffuse_roughness > 0)
        lost.push_back(fmt::format(
            "{}: its matt paint reflects as rough surfaces do (diffuse roughness {:.2g}), which OpenLIME's "
            "maps cannot hold: slopes are shown after Lambert's law; --to maps keeps it",
            painting, surface.reflectance_model.diffuse_roughness));
    return lost;
}

}  // namespace

nlohmann::json export_maps(const ExportJob& job) {
    const std::shared_ptr<const Surface> surface = job.seen_in_scale();
    return export_folder(job.arguments.out, "maps.json", [&](const std::filesystem::path& folder) {
        write_maps(folder, *surface, job.progress);
    });
}

nlohmann::json export_openlime(const ExportJob& job) {
    const std::shared_ptr<const Surface> surface = job.seen_in_scale();
    nlohmann::json result = export_folder(
        job.arguments.out, "brdf.json",
        [&](const std::filesystem::path& folder) { write_openlime(folder, *surface, job.progress); });
    if (const auto lost = lost_to_openlime(job.arguments.painting, *surface); !lost.empty())
        result["warnings"] = told(lost);
    return result;
}

}  // namespace tangi
