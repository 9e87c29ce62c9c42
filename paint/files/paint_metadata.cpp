#include "paint/files/paint_metadata.h"
#include "surface/file/version.h"
#include "surface/maps/height_unit.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace tangi {

namespace {

nlohmann::json bands_of(const Spectrum& spectrum) {
    nlohmann::json bands = nlohmann::json::array();
    for (const float value : spectrum) bands.push_back(shortest(value));
    return bands;
}

}  // namespace

double shortest(float value) { return std::stod(fmt::format("{}", value)); }

nlohmann::json scale_in_words(const Canvas& canvas) {
    return {{"software", program_name()},
            {"mm_per_pixel", canvas.mm_per_pixel()},
            {"scale_known", canvas.scale_known()},
            {"height_unit", height_unit_of(canvas.mm_per_pixel(), canvas.scale_known())},
            {"thickness_unit", "mm"},
            {"bands_nm", kBand_nm}};
}

nlohmann::json in_words(const Pigment& p, double mm3) {
    return {{"paint", p.name},
            {"medium", shortest(p.medium)},
            {"specular", shortest(p.specular)},
            {"roughness", shortest(p.roughness)},
            {"k", bands_of(p.k)},
            {"s", bands_of(p.s)},
            {"origin", name_of(p.origin)},
            {"approximate", p.approximate()},
            {"source", p.source},
            {"mm3", mm3},
            {"paint_mm3", (1 - static_cast<double>(p.medium)) * mm3}};
}

}  // namespace tangi
