#include "paint/retouch/treatment_steps.h"

#include <algorithm>

#include "surface/error.h"

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

json fill_step(Treatment& treatment, Canvas& canvas, const StepArea& area, FillTexture texture,
               const Rgb& colour, const FillOptions& options, const Author& author,
               const Progress& progress) {
    const bool proposal = texture == FillTexture::patches;  // never silently
    const std::string name = treatment.new_layer_name(LayerRole::fill, proposal);
    const Mask intact =
        without(Mask(area.mask.width(), area.mask.height(), 1.0f), united(area.mask, damaged(treatment)));
    const FillReport report = lay_fill(canvas, name, area.mask, intact, texture, colour, options, progress);
    const OnOriginal beside = on_original(canvas.dried().back().paint, area.mask, treatment.mm_per_pixel());
    json result = {{"layer", name},
                   {"regions", report.regions},
                   {"area_cm2", report.area_mm2 / 100},
                   {"volume_mm3", report.volume_mm3},
                   {"deepest_mm", report.deepest_mm},
                   {"border_rms_mm", report.border_rms_mm},
                   {"pixels_above_level", report.not_reached},
                   {"on_original", to_json(beside)}};
    const json parameters = {{"area", area.described},
                             {"texture", name_of(texture)},
                             {"colour", {colour.r, colour.g, colour.b}},
                             {"options", to_json(options)}};
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

json varnish_step(Treatment& treatment, Canvas& canvas, bool isolating, const StepArea* area,
                  const VarnishOptions& options, const Author& author, const Progress& progress) {
    const Mask mask = area ? area->mask : Mask(treatment.width(), treatment.height(), 1.0f);
    if (area_of(mask, 1).mm2 == 0)
        fail("{}: there is nothing to varnish: the mask is empty", treatment.folder().string());
    const LayerRole role = isolating ? LayerRole::isolating_varnish : LayerRole::varnish;
    const std::string name = treatment.new_layer_name(role);
    lay_varnish(canvas, name, mask, options);
    json result = {{"layer", name}, {"area_cm2", area_of(mask, treatment.mm_per_pixel()).mm2 / 100}};
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

std::string journal_file(const Treatment& treatment) {
    std::string file = treatment.new_layer_name(LayerRole::retouch);
    std::replace(file.begin(), file.end(), ' ', '_');
    return "strokes/" + file + ".jsonl";
}

json retouch_step(Treatment& treatment, Canvas& canvas, const StepArea& area, TreatmentStep step,
                  const std::string& source, const Author& author, const Progress& progress) {
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
        json paints = json::object();
        const auto volumes = volumes_mm3(layer->paint, canvas.ingredients().size(), canvas.mm_per_pixel());
        for (std::size_t i = 0; i < volumes.size(); ++i)
            if (volumes[i] > 0) paints[canvas.ingredients()[i].name] = volumes[i];
        laid.push_back(
            {{"layer", added},
             {"area_cm2", area_of(additions(layer->paint), treatment.mm_per_pixel()).mm2 / 100},
             {"volumes_mm3", paints},
             {"on_original", to_json(on_original(layer->paint, area.mask, treatment.mm_per_pixel()))}});
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
    for (const std::string& layer : layers) lift_off(canvas, layer);
    treatment.record({.action = "remove", .parameters = {{"layers", layers}}, .canvas = &canvas}, author,
                     progress);
    return {{"removed", layers}};
}

json undo_step(Treatment& treatment, Canvas& canvas, const Author& author, const Progress& progress) {
    std::set<std::string> there;
    for (const TreatmentLayer& layer : treatment.layers()) there.insert(layer.name);
    // The step that brought a layer is the first that has it: from the last line on, the one where one of
    // those that are still there appears.
    std::set<std::string> known;
    const LogEntry* last = nullptr;
    std::vector<std::string> layers;
    for (const LogEntry& entry : treatment.log().entries()) {
        if (!entry.content.contains("layers")) continue;
        std::vector<std::string> brought;
        for (const json& layer : entry.content["layers"])
            if (const auto name = layer.at("name").get<std::string>();
                known.insert(name).second && there.contains(name))
                brought.push_back(name);
        if (!brought.empty()) last = &entry, layers = brought;
    }
    if (!last)
        fail("{}: there is no step to undo: nothing lies on the painting", treatment.folder().string());
    const json undone = {
        {"line", last->line}, {"action", last->content.at("action")}, {"sha256", last->sha256}};
    for (const std::string& layer : layers) lift_off(canvas, layer);
    treatment.record(
        {.action = "undo", .parameters = {{"step", undone}, {"layers", layers}}, .canvas = &canvas}, author,
        progress);
    return {{"undone", undone}, {"removed", layers}};
}

json draw_step(Treatment& treatment, DamageClass damage, const Mask& mask, const json& parameters,
               const Author& author, const std::vector<std::filesystem::path>& inputs,
               const Progress& progress) {
    const std::string name(name_of(damage));
    TreatmentStep step{.action = "draw damage", .parameters = parameters, .inputs = inputs};
    step.parameters["class"] = name;
    step.masks[name] = mask;
    step.results[name] = {{"area_cm2", area_of(mask, treatment.mm_per_pixel()).mm2 / 100}};
    treatment.record(step, author, progress);
    return step.results;
}

}  // namespace tangi
