#include "retouch/inpaint/recipe_json.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace tangi {

namespace {
constexpr std::size_t kGlossBoxes = 24;  // parts of a retouch that are named, the largest
}

nlohmann::json by_each_light(const std::array<double, kIlluminants>& values) {
    nlohmann::json result = nlohmann::json::object();
    for (std::size_t illuminant = 0; illuminant < kIlluminants; ++illuminant)
        if (std::isfinite(values[illuminant]))
            result[std::string(name_of(static_cast<Illuminant>(illuminant)))] = values[illuminant];
    return result;
}

nlohmann::json as_json(const std::vector<MixingStep>& steps, const Mixture& mixture,
                       const std::vector<Pigment>& paints) {
    nlohmann::json volumes = nlohmann::json::object(), measured = nlohmann::json::array();
    for (std::size_t i = 0; i < static_cast<std::size_t>(mixture.count); ++i)
        volumes[paints[static_cast<std::size_t>(mixture.paints[i])].name] = mixture.volumes[i];
    for (const MixingStep& step : steps)
        measured.push_back({{"of_mixture", step.so_far},
                            {"paint", paints[static_cast<std::size_t>(step.paint)].name},
                            {"measures", step.added}});
    return {{"recipe", text_of(steps, paints)}, {"parts_by_volume", volumes}, {"steps", measured}};
}

std::string text_of(const PairWarning& w, const std::vector<Pigment>& paints) {
    return fmt::format("{} with {}{}{}", paints[static_cast<std::size_t>(w.a)].name,
                       paints[static_cast<std::size_t>(w.b)].name,
                       w.pair->why.empty() ? " is a pair of the list to be avoided" : ": " + w.pair->why,
                       w.pair->source.empty() ? "" : " (" + w.pair->source + ")");
}

nlohmann::json warnings_of(const Mixture& mixture, const std::vector<Pigment>& paints,
                           const std::vector<PairWarning>& pairs) {
    nlohmann::json texts = nlohmann::json::array();
    const auto begin = mixture.paints.begin(), end = begin + mixture.count;
    std::set<std::string> said;
    for (const PairWarning& w : pairs) {
        if (std::find(begin, end, w.a) == end || std::find(begin, end, w.b) == end) continue;
        const std::string text = text_of(w, paints);
        if (said.insert(text).second) texts.push_back(text);
    }
    for (auto it = begin; it != end; ++it)
        if (paints[static_cast<std::size_t>(*it)].approximate())
            texts.push_back(fmt::format("{}: only its colour is known; its mixtures are a guess",
                                        paints[static_cast<std::size_t>(*it)].name));
    return texts;
}

nlohmann::json to_json(const RetouchReport& report, const std::vector<Pigment>& paints,
                       const std::vector<PairWarning>& pairs) {
    nlohmann::json piles = nlohmann::json::array();
    for (const Pile& pile : report.piles) {
        nlohmann::json one = as_json(pile.steps, pile.mixture, paints);
        const Lab lab = lab_under(pile.look);
        one["lab"] = {lab.l, lab.a, lab.b};
        one["share"] = pile.share;
        one["volume_mm3"] = pile.volume_mm3;
        one["warnings"] = warnings_of(pile.mixture, paints, pairs);
        piles.push_back(one);
    }
    nlohmann::json result = {{"piles", piles},
                             {"area_mm2", report.area_mm2},
                             {"painted_mm2", report.painted_mm2},
                             {"delta_e_2000_from_target", by_each_light(report.delta_e_mean)}};
    for (const RetouchGloss& gloss : report.glosses) {
        nlohmann::json boxes = nlohmann::json::array();
        for (const Region& part : gloss.parts)
            if (boxes.size() < kGlossBoxes) boxes.push_back({part.x0, part.y0, part.x1, part.y1});
        result["gloss"].push_back(
            {{"specular", gloss.wanted.specular},
             {"roughness", gloss.wanted.roughness},
             {"area_mm2", gloss.area_mm2},
             {"parts", gloss.parts.size()},
             {"boxes_px", std::move(boxes)},
             {"of_paints", {{"specular", gloss.of_paint.specular}, {"roughness", gloss.of_paint.roughness}}},
             {"remedy", name_of(remedy_for(gloss.of_paint, gloss.wanted))}});
    }
    std::set<std::string> said;
    for (const PairWarning& w : pairs)
        if (report.blended.contains({std::min(w.a, w.b), std::max(w.a, w.b)}))
            if (const std::string text = text_of(w, paints); said.insert(text).second)
                result["warnings"].push_back("where two piles are mixed: " + text);
    for (const RetouchGloss& gloss : report.glosses)
        if (!can_reflect(gloss.of_paint, gloss.wanted))
            result["warnings"].push_back(fmt::format(
                "beside the loss rho_s is {:.3f}; no paint or varnish reflects more than {}: a real "
                "retouch will look less glossy than this one",
                gloss.wanted.specular, kMostSpecular));
    result["grounds"] = report.grounds;
    if (report.marks > 0)
        result["lines"] = {
            {"number", report.marks}, {"pitch_mm", report.pitch_mm}, {"width_mm", report.width_mm}};
    return result;
}

nlohmann::json to_json(const Fusion& fusion) {
    return {{"fuses", fusion.fuses},
            {"distance_m", fusion.distance_m},
            {"delta_e_2000_at_0.3_m", fusion.delta_e_near},
            {"delta_e_2000_there", fusion.delta_e_fused}};
}

Gloss gloss_of(const Mixture& mixture, const std::vector<Pigment>& paints, double luminance) {
    Gloss gloss{0, 0, luminance};
    for (std::size_t i = 0; i < static_cast<std::size_t>(mixture.count); ++i) {
        const Pigment& p = paints[static_cast<std::size_t>(mixture.paints[i])];
        gloss.specular += mixture.volumes[i] * static_cast<double>(p.specular);
        gloss.roughness += mixture.volumes[i] * static_cast<double>(p.roughness);
    }
    return gloss;
}

std::vector<char> without_pairs(std::size_t paints, const std::vector<PairWarning>& pairs) {
    if (pairs.empty()) return {};
    std::vector<char> allowed(paints * paints, 1);
    for (const PairWarning& w : pairs) {
        const auto i = static_cast<std::size_t>(w.a), j = static_cast<std::size_t>(w.b);
        allowed[i * paints + j] = allowed[j * paints + i] = 0;
    }
    return allowed;
}

nlohmann::json parameters_of(const MatchOptions& options) {
    nlohmann::json result = to_json(options);
    for (const Illuminant illuminant : options.illuminants)
        result["illuminants"].push_back(name_of(illuminant));
    result["goal"] = options.goal == MatchGoal::worst ? "worst" : "mean";
    return result;
}

nlohmann::json parameters_of(RetouchMode mode, const RetouchOptions& options) {
    nlohmann::json result = to_json(options);
    result["mode"] = name_of(mode), result["inpainting"] = name_of(options.inpainting);
    result["annulus"] = to_json(options.annulus);
    result["match"] = parameters_of(options.match);
    return result;
}

RetouchViews retouch_views(const Image<Rgb>& seen, const Mask& mask, const RetouchReport& report) {
    const Region& r = report.region;
    RetouchViews views{Image<Rgb>(r.width(), r.height()), report.target, Mask(r.width(), r.height())};
    for (int y = 0; y < r.height(); ++y)
        for (int x = 0; x < r.width(); ++x) {
            views.retouched(x, y) = seen(x + r.x0, y + r.y0);
            views.mask(x, y) = mask(x + r.x0, y + r.y0);
            if (!(views.mask(x, y) > 0)) views.target(x, y) = views.retouched(x, y);
        }
    return views;
}

}  // namespace tangi
