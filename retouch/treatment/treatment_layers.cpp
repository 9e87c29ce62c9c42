// treatment_layers.cpp: of a treatment: what its layers show in each state, and where they lie.
#include "paint/canvas/appearance.h"
#include "retouch/treatment/treatment_area.h"
#include "surface/base/error.h"

namespace tangi {

using nlohmann::json;

Canvas in_state(const Canvas& canvas, const std::vector<TreatmentLayer>& layers, TreatmentStage state) {
    Canvas shown = canvas;
    shown.writable_wet() = PaintLayer(canvas.width(), canvas.height());
    // From the top down. A retouch that was matched over varnish lies on it: without it there was never such
    // a state.
    auto& dried = shown.writable_dried();
    bool on_top = false;
    for (std::size_t i = dried.size(); i-- > 0;) {
        const auto about = std::find_if(layers.begin(), layers.end(),
                                        [&](const TreatmentLayer& l) { return l.name == dried[i].name; });
        const bool known = about != layers.end(), belongs = known && shown_from(about->role) <= state;
        on_top = on_top || belongs;
        if (!belongs && !(known && on_top && about->role == LayerRole::varnish))
            dried.erase(dried.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return shown;
}

Surface surface_in_state(const Treatment& treatment, const Canvas& canvas, TreatmentStage state,
                         const Progress& progress) {
    if (state == TreatmentStage::before && treatment.has_earlier()) return treatment.read_earlier(progress);
    return appearance(in_state(canvas, treatment.layers(), state), {}, progress);
}

Mask additions(const PaintLayer& layer) {
    Mask mask(layer.width(), layer.height());
    layer.add_thickness_mm(mask.region(), mask.data(), static_cast<std::size_t>(mask.width()));
    for (float& mm : mask.pixels()) mm = mm > 0 ? 1.0f : 0.0f;
    return mask;
}

Mask additions(const Canvas& canvas) {
    Mask mask = additions(canvas.wet());
    for (const DriedLayer& layer : canvas.dried()) mask = united(mask, additions(layer.paint));
    return mask;
}

Mask mapped_damage(const Treatment& treatment) {
    Mask all(treatment.width(), treatment.height());
    for (const DamageClass damage : kDamageClasses)
        if (treatment.has_mask(damage)) all = united(all, treatment.mask(damage));
    return all;
}

OnOriginal on_original(const PaintLayer& layer, const Mask& allowed, double mm_per_pixel) {
    TP_REQUIRE(layer.region() == allowed.region(), "a mask has the size of its canvas");
    Image<float> mm(layer.width(), layer.height());
    layer.add_thickness_mm(mm.region(), mm.data(), static_cast<std::size_t>(mm.width()));
    OnOriginal paint;
    double area = 0, volume = 0;
    for (int y = 0; y < mm.height(); ++y)
        for (int x = 0; x < mm.width(); ++x) {
            const auto outside = static_cast<double>(1 - allowed(x, y));
            if (!(mm(x, y) > 0) || !(outside > 0)) continue;
            ++paint.pixels;
            paint.whole_pixels += outside == 1 ? 1 : 0;
            area += outside;
            volume += outside * static_cast<double>(mm(x, y));
        }
    paint.area_mm2 = area * mm_per_pixel * mm_per_pixel;
    paint.volume_mm3 = volume * mm_per_pixel * mm_per_pixel;
    return paint;
}

json to_json(const OnOriginal& paint) {
    return {{"pixels", paint.pixels},
            {"whole_pixels", paint.whole_pixels},
            {"area_mm2", paint.area_mm2},
            {"volume_mm3", paint.volume_mm3}};
}

namespace {

json scaled(const json& value, double by) {
    if (value.is_number()) return value.get<double>() * by;
    if (!value.is_structured()) return value;
    json all = value;
    for (json& part : all) part = scaled(part, by);
    return all;
}

}  // namespace

json in_known_units(const json& results, double mm_per_pixel, bool scale_known) {
    if (scale_known || !results.is_structured()) return results;
    if (results.is_array()) {
        json all = json::array();
        for (const json& part : results) all.push_back(in_known_units(part, mm_per_pixel, scale_known));
        return all;
    }
    constexpr std::array<std::pair<std::string_view, std::string_view>, 3> units = {
        {{"_mm", "_px"}, {"_mm2", "_px"}, {"_mm3", "_px3"}}};
    json all = json::object();
    for (const auto& [key, value] : results.items()) {
        std::string name = key;
        json told = in_known_units(value, mm_per_pixel, scale_known);
        for (std::size_t i = 0; i < units.size(); ++i)
            if (key.ends_with(units[i].first)) {
                name.replace(key.size() - units[i].first.size(), std::string::npos, units[i].second);
                told = scaled(value, std::pow(mm_per_pixel, -static_cast<double>(i + 1)));
            }
        all[name] = std::move(told);
    }
    return all;
}

json in_known_units(const json& results, const Treatment& treatment) {
    return in_known_units(results, treatment.mm_per_pixel(), treatment.scale_known());
}

json as_stated(const CraquelureMeasure& measure, double mm_per_pixel, bool scale_known) {
    json stated = {
        {"length_mm", measure.length_mm}, {"width_mm", measure.width_mm}, {"pieces", measure.pieces}};
    if (scale_known) stated["density_cm_per_cm2"] = measure.density_per_cm;
    return in_known_units(stated, mm_per_pixel, scale_known);
}

std::string in_words(const CraquelureMeasure& measure, double mm_per_pixel, bool scale_known) {
    if (!scale_known)
        return fmt::format("{:.0f} pixels long in all, {:.2f} pixels wide on average",
                           measure.length_mm / mm_per_pixel, measure.width_mm / mm_per_pixel);
    return fmt::format("{:.1f} cm long in all, {:.2f} mm wide on average, {:.2f} cm on each cm²",
                       measure.length_mm / 10, measure.width_mm, measure.density_per_cm);
}

StatedLength stated_length(const json& results, const std::string& name, const std::string& ending) {
    if (const auto mm = results.find(name + ending); mm != results.end())
        return {*mm, ending == "_mm" ? " mm" : " mm²"};
    return {results.at(name + "_px"), " px"};
}

json area_of_step(double mm2, double mm_per_pixel, bool scale_known) {
    if (scale_known) return {{"area_cm2", mm2 / 100}};
    return {{"area_px", mm2 / (mm_per_pixel * mm_per_pixel)}};
}

json area_of_step(const Treatment& treatment, double mm2) {
    return area_of_step(mm2, treatment.mm_per_pixel(), treatment.scale_known());
}

std::string area_in_words(const json& stated) {
    if (stated.contains("area_cm2")) return fmt::format("{:.2f} cm²", stated["area_cm2"].get<double>());
    return fmt::format("{:.0f} pixels", stated.at("area_px").get<double>());
}

std::optional<Mask> mask_with(const MasksToCome& to_come, const Treatment& treatment, DamageClass damage) {
    if (const auto changed = to_come.find(std::string(name_of(damage))); changed != to_come.end())
        return as_kept(changed->second);
    if (!treatment.has_mask(damage)) return {};
    return treatment.mask(damage);
}

json damage_table(const Treatment& treatment, const MasksToCome& to_come) {
    json table = json::array();
    for (const DamageClass damage : kDamageClasses) {
        const std::optional<Mask> mask = mask_with(to_come, treatment, damage);
        if (!mask) continue;
        const MaskArea area = area_of(*mask, treatment.mm_per_pixel());
        json row = {{"class", name_of(damage)}, {"count", area.regions}, {"percent", area.percent}};
        row.update(area_of_step(treatment, area.mm2));
        table.push_back(std::move(row));
    }
    return table;
}

}  // namespace tangi
