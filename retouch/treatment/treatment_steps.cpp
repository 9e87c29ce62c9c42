#include "retouch/treatment/treatment_steps.h"

#include <algorithm>

#include "retouch/treatment/removed_layers.h"
#include "retouch/treatment/treatment_area.h"
#include "surface/base/error.h"

namespace tangi {

using nlohmann::json;

StepArea area_of_classes(const Treatment& treatment, const std::set<DamageClass>& classes) {
    StepArea area{Mask(treatment.width(), treatment.height()), {{"classes", json::array()}}};
    for (const DamageClass damage : classes) {
        area.mask = united(area.mask, treatment.mask(damage));
        area.described["classes"].push_back(name_of(damage));
    }
    return area;
}

Mask damaged(const Treatment& treatment) {
    Mask all(treatment.width(), treatment.height());
    for (const DamageClass damage : {DamageClass::loss_to_ground, DamageClass::loss_to_support,
                                     DamageClass::flaking, DamageClass::old_fill})
        if (treatment.has_mask(damage)) all = united(all, treatment.mask(damage));
    return all;
}

void count_beside(json& results, const Treatment& treatment, const DriedLayer& layer, const Mask& area) {
    const double mm = treatment.mm_per_pixel();
    const OnOriginal beside = on_original(layer.paint, mapped_damage(treatment), mm);
    results["on_original"] = in_known_units(to_json(beside), treatment);
    results["outside_area"] = in_known_units(to_json(on_original(layer.paint, area, mm)), treatment);
    if (beside.whole_pixels > 0)  // what the rim of an area is covered by in part is no mistake
        results["warnings"].push_back(fmt::format(
            "{}: {} pixels of it lie on original, outside of all damage that is mapped: map it with "
            "tangipaint damage, or take the layer off again",
            layer.name, beside.whole_pixels));
}

json fill_step(Treatment& treatment, Canvas& canvas, const StepArea& area, const Filling& filling,
               const Author& author, const Progress& progress) {
    const bool proposal = filling.texture == FillTexture::patches;  // never silently
    const std::string name = treatment.new_layer_name(LayerRole::fill, proposal);
    const Mask intact =
        without(Mask(area.mask.width(), area.mask.height(), 1.0f), united(area.mask, damaged(treatment)));
    const FillReport report = lay_fill(canvas, name, area.mask, intact, filling, progress);
    if (!(report.volume_mm3 > 0))
        fail(
            "{}: there is nothing to fill: all of the area lies above the level asked for already; raise it "
            "with --offset-mm, or look whether anything is lost there",
            treatment.folder().string());
    json result = in_known_units({{"layer", name},
                                  {"regions", report.regions},
                                  {"volume_mm3", report.volume_mm3},
                                  {"deepest_mm", report.deepest_mm},
                                  {"border_rms_mm", report.border_rms_mm},
                                  {"pixels_above_level", report.not_reached}},
                                 treatment);
    result.update(area_of_step(treatment, report.area_mm2));
    if (report.smooth_regions > 0) {
        result["smooth_regions"] = report.smooth_regions;
        result["warnings"].push_back(fmt::format(
            "{} of {} regions found no relief near them that goes on from their rim, and are smooth: look "
            "farther with --search-mm, or choose another --texture",
            report.smooth_regions, report.regions));
    }
    if (const auto pixels = static_cast<double>(report.pixels); report.not_reached > 0.2 * pixels)
        result["warnings"].push_back(fmt::format(
            "{:.0f} % of the area lies above the fill's level already and was left as it is: look "
            "whether it is lost there, or raise the level with --offset-mm",
            100 * report.not_reached / pixels));
    count_beside(result, treatment, canvas.dried().back(), area.mask);
    const json parameters = {{"area", area.described},
                             {"texture", name_of(filling.texture)},
                             {"colour", {filling.colour.r, filling.colour.g, filling.colour.b}},
                             {"options", to_json(filling.options)}};
    treatment.record({.action = proposal ? "propose" : "fill",
                      .parameters = parameters,
                      .results = result,
                      .inputs = area.inputs,
                      .masks = {{name, area.mask}},
                      .canvas = &canvas,
                      .added = {{name, LayerRole::fill}}},
                     author, progress);
    return result;
}

json varnish_step(Treatment& treatment, Canvas& canvas, const Varnishing& varnishing, const Author& author,
                  const Progress& progress) {
    const auto& [isolating, area, options] = varnishing;
    const Mask mask = area ? area->mask : Mask(treatment.width(), treatment.height(), 1.0f);
    if (area_of(mask, 1).mm2 == 0)
        fail("{}: there is nothing to varnish: the mask is empty", treatment.folder().string());
    const LayerRole role = isolating ? LayerRole::isolating_varnish : LayerRole::varnish;
    const std::string name = treatment.new_layer_name(role);
    std::vector<std::string>
        under;  // retouches that an isolating varnish no longer separates from the painting
    for (const TreatmentLayer& layer : treatment.layers())
        for (const DriedLayer& dried : canvas.dried())
            if (isolating && layer.role == LayerRole::retouch && dried.name == layer.name &&
                area_of(intersected(additions(dried.paint), mask), 1).mm2 > 0)
                under.push_back(layer.name);
    lay_varnish(canvas, name, mask, options);
    json result = area_of_step(treatment, area_of(mask, treatment.mm_per_pixel()).mm2);
    result["layer"] = name;
    for (const std::string& retouch : under)
        result["warnings"].push_back(fmt::format(
            "the isolating varnish lies over '{}', which is then not apart from the painting", retouch));
    treatment.record({.action = "varnish",
                      .parameters = {{"role", name_of(role)},
                                     {"area", area ? area->described : json("all")},
                                     {"options", to_json(options)}},
                      .results = result,
                      .inputs = area ? area->inputs : std::vector<std::filesystem::path>(),
                      .canvas = &canvas,
                      .added = {{name, role}}},
                     author, progress);
    return result;
}

json retouch_step(Treatment& treatment, Canvas& canvas, HandRetouch retouch, const Author& author,
                  const Progress& progress) {
    auto& [area, step, source] = retouch;
    const std::string name = treatment.new_layer_name(LayerRole::retouch);
    // What was dried while painting is a retouch too.
    const std::vector<TreatmentLayer> logged = treatment.layers();
    for (const DriedLayer& layer : canvas.dried())
        if (std::none_of(logged.begin(), logged.end(), [&](const auto& l) { return l.name == layer.name; }))
            step.added.emplace_back(layer.name, LayerRole::retouch);
    if (canvas.wet().empty() && step.added.empty()) fail("{}: nothing was painted within the area", source);
    if (!canvas.wet().empty()) step.added.emplace_back(dry(canvas, name), LayerRole::retouch);
    json laid = json::array();
    for (const auto& [added, role] : step.added) {
        const auto layer = std::find_if(canvas.dried().begin(), canvas.dried().end(),
                                        [&added = added](const DriedLayer& l) { return l.name == added; });
        const auto volumes = volumes_mm3(layer->paint, canvas.ingredients().size(), canvas.mm_per_pixel());
        json one = in_known_units(
            {{"layer", added}, {"volumes_mm3", volumes_by_name(canvas.ingredients(), volumes)}}, treatment);
        one.update(area_of_step(treatment, area_of(additions(layer->paint), treatment.mm_per_pixel()).mm2));
        count_beside(one, treatment, *layer, area.mask);
        if (const auto said = one.find("warnings"); said != one.end()) {
            for (const json& warning : *said) step.results["warnings"].push_back(warning);
            one.erase(said);
        }
        laid.push_back(std::move(one));
    }
    step.action = "retouch";
    step.parameters["area"] = area.described;
    step.results["retouches"] = laid;
    step.masks[name] = area.mask;
    step.canvas = &canvas;
    for (const auto& input : area.inputs) step.inputs.push_back(input);
    treatment.record(step, author, progress);
    return step.results;
}

json remove_step(Treatment& treatment, Canvas& canvas, const std::vector<std::string>& layers,
                 const Author& author, const Progress& progress) {
    if (layers.empty()) fail("{}: there is no layer to take off", treatment.folder().string());
    TreatmentStep step{.action = "remove", .parameters = {{"layers", layers}}, .canvas = &canvas};
    step.removed = layers_named(canvas, layers);
    for (const std::string& layer : layers) lift_off(canvas, layer);
    treatment.record(step, author, progress);
    return {{"removed", layers}};
}

json draw_step(Treatment& treatment, const DrawnDamage& drawn, const Author& author,
               const Progress& progress) {
    const std::string name(name_of(drawn.damage));
    TreatmentStep step{.action = "draw damage", .parameters = drawn.parameters};
    step.parameters["class"] = name;
    step.masks[name] = drawn.mask;
    step.results[name] = area_of_step(treatment, area_of(drawn.mask, treatment.mm_per_pixel()).mm2);
    treatment.record(step, author, progress);
    return step.results;
}

}  // namespace tangi
