// treatment_facts.cpp: of the treatment: what is to be known of it whenever something was logged.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "viewer/treatment/treatment_controller.h"

namespace tangi {

using nlohmann::json;

namespace {

// A line of the log in a few words: "varnish: isolating varnish 1".
std::string told(const json& entry) {
    std::vector<std::string> of;
    const json results = entry.value("results", json::object()),
               asked = entry.value("parameters", json::object());
    const auto add = [&](const json& from, const char* field) {
        if (from.contains(field) && from[field].is_string()) of.push_back(from[field].get<std::string>());
    };
    add(results, "layer");
    for (const json& layer : results.value("retouches", json::array())) add(layer, "layer");
    for (const char* field : {"layers", "brought_back"})
        for (const json& layer : asked.value(field, json::array()))
            if (layer.is_string()) of.push_back(layer.get<std::string>());
    add(asked, "suggest");
    if (const json name = asked.value("class", json()); name.is_string())
        if (const auto damage = damage_class_named(name.get<std::string>()))
            of.emplace_back(title_of(*damage));
    for (const json& name : asked.value("masks", json::array()))
        if (const auto damage = damage_class_named(name.get<std::string>()))
            of.emplace_back(title_of(*damage));
    const std::string action = entry.value("action", "");
    return of.empty() ? action : fmt::format("{}: {}", action, fmt::join(of, ", "));
}

}  // namespace

TreatmentController::Facts TreatmentController::facts_of(const Treatment& treatment, const Canvas& canvas) {
    Facts facts;
    Mask belongs(treatment.width(), treatment.height());
    for (std::size_t i = 0; i < kDamageClasses.size(); ++i) {
        DamageRow& row = facts.damage[i];
        row.damage = kDamageClasses[i];
        row.there = treatment.has_mask(row.damage);
        if (!row.there) continue;
        Mask mask = treatment.mask(row.damage);
        const MaskArea area = area_of(mask, treatment.mm_per_pixel());
        row.logged = {area.regions, area.mm2 / 100, area.percent};
        belongs = united(belongs, mask);
        facts.masks.emplace_back(row.damage, std::move(mask));
    }
    const std::vector<TreatmentLayer> layers = treatment.layers();
    for (const TreatmentLayer& layer : layers) {
        LayerRow row{layer.name, layer.role, {}};
        for (const DriedLayer& dried : canvas.dried())
            if (dried.name == layer.name)
                row.on_original = on_original(dried.paint, belongs, treatment.mm_per_pixel());
        facts.layers.push_back(std::move(row));
    }
    facts.additions = additions_of(canvas, layers, belongs);
    facts.next_undo = next_undo(treatment);
    const auto& entries = treatment.log().entries();
    for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
        const json& c = entry->content;
        facts.log.push_back({entry->line, c.value("time", ""), c.value("who", ""), told(c), entry->sha256});
    }
    return facts;
}

void TreatmentController::adopt(Facts facts) {
    TreatmentState& t = state_.treatment_state;
    for (std::size_t i = 0; i < facts.damage.size(); ++i) {
        facts.damage[i].shown = t.damage[i].shown;
        if (drafts_.contains(facts.damage[i].damage)) facts.damage[i].corrected = t.damage[i].corrected;
    }
    t.damage = facts.damage;
    t.layers_moved |= !std::ranges::equal(t.layers, facts.layers, {}, &LayerRow::name, &LayerRow::name);
    t.layers = std::move(facts.layers);
    t.next_undo = std::move(facts.next_undo);
    t.log = std::move(facts.log);
    if (!last_)  // a draft without corrections goes by what the class had before
        std::erase_if(drafts_, [](const auto& draft) { return !draft.second.can_undo(); });
    for (const auto& [damage, mask] : facts.masks)
        if (!drafts_.contains(damage)) map_.set(damage, mask);
    map_.set_additions(facts.additions);
    map_changed_ = map_.compose(style_);
    confine_due_ = true;
}

// After something was logged.
void TreatmentController::refresh() {
    refresh_due_ = false;
    start(
        "reading the treatment",
        [this, painter = painter_](const Progress&) -> Finish {
            Facts facts = facts_of(treatment(), canvas_of(*painter));
            return [this, facts = std::move(facts)]() mutable { adopt(std::move(facts)); };
        },
        true);
}

}  // namespace tangi
