// fill_command.cpp: tangipaint fill DIR and tangipaint varnish DIR: layers on a painting under treatment.
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/treatment_arguments.h"
#include "paint/retouch/fill.h"
#include "surface/error.h"

namespace tangi {

namespace {

struct FillArguments {
    std::string treatment, texture = "surroundings", colour = "0.86,0.84,0.79";
    AreaArguments area;
    AuthorArguments author;
    FillOptions fill;
};

nlohmann::json run_fill(const FillArguments& a) {
    const auto texture = fill_texture_named(a.texture);
    const std::vector<double> rgb = numbers_in(a.colour, "--colour", "R,G,B");
    if (rgb.size() != 3) throw UsageError(fmt::format("--colour {}: give three numbers: R,G,B", a.colour));
    if (a.area.empty())
        throw UsageError("say what is filled: --class loss_to_ground, --mask FILE or --polygon X,Y;X,Y;X,Y");
    const Progress progress = console_progress();
    Treatment treatment = open_treatment(a.treatment);
    const Mask area = a.area.area(treatment);
    Canvas canvas = treatment.read_canvas(progress);
    const bool proposal = *texture == FillTexture::patches;  // never silently
    const std::string name = treatment.new_layer_name(LayerRole::fill, proposal);
    const Mask intact = without(Mask(area.width(), area.height(), 1.0f), united(area, damaged(treatment)));
    const FillReport report =
        lay_fill(canvas, name, area, intact, *texture, Rgb(rgb[0], rgb[1], rgb[2]), a.fill, progress);
    const OnOriginal beside = on_original(canvas.dried().back().paint, area, treatment.mm_per_pixel());
    nlohmann::json result = {{"layer", name},
                             {"regions", report.regions},
                             {"area_cm2", report.area_mm2 / 100},
                             {"volume_mm3", report.volume_mm3},
                             {"deepest_mm", report.deepest_mm},
                             {"border_rms_mm", report.border_rms_mm},
                             {"pixels_above_level", report.not_reached},
                             {"on_original", to_json(beside)}};
    nlohmann::json parameters = {
        {"area", a.area.as_json()}, {"texture", a.texture}, {"colour", rgb}, {"options", to_json(a.fill)}};
    treatment.record({.action = proposal ? "propose" : "fill",
                      .parameters = parameters,
                      .results = result,
                      .inputs = a.area.inputs(),
                      .masks = {{name, area}},
                      .canvas = &canvas,
                      .added = {{name, LayerRole::fill}}},
                     a.author.author(), progress);
    return result;
}

struct VarnishArguments {
    std::string treatment;
    bool isolating = false;
    AreaArguments area;
    AuthorArguments author;
    VarnishOptions varnish;
};

nlohmann::json run_varnish(const VarnishArguments& a) {
    const Progress progress = console_progress();
    Treatment treatment = open_treatment(a.treatment);
    const Mask area =
        a.area.empty() ? Mask(treatment.width(), treatment.height(), 1.0f) : a.area.area(treatment);
    Canvas canvas = treatment.read_canvas(progress);
    const LayerRole role = a.isolating ? LayerRole::isolating_varnish : LayerRole::varnish;
    const std::string name = treatment.new_layer_name(role);
    lay_varnish(canvas, name, area, a.varnish);
    nlohmann::json result = {{"layer", name},
                             {"area_cm2", area_of(area, treatment.mm_per_pixel()).mm2 / 100}};
    treatment.record({.action = "varnish",
                      .parameters = {{"role", name_of(role)},
                                     {"area", a.area.empty() ? nlohmann::json("all") : a.area.as_json()},
                                     {"options", to_json(a.varnish)}},
                      .results = result,
                      .inputs = a.area.inputs(),
                      .canvas = &canvas,
                      .added = {{name, role}}},
                     a.author.author(), progress);
    return result;
}

}  // namespace

Command fill_command() {
    return {"fill", "fill losses to the level of what is around, as a layer that comes off again",
            [](Flags& flags) {
                auto a = std::make_shared<FillArguments>();
                flags.option("TREATMENT", a->treatment, "folder of the treatment").required();
                a->area.add_to(flags, "that is filled");
                flags
                    .option("--texture", a->texture,
                            "relief of the fill: smooth, surroundings (goes on from the rim), weave (threads "
                            "keep their phase), patches (of many places; made up, so it is a proposal)")
                    .check(one_of({"smooth", "surroundings", "weave", "patches"}))
                    .show_default();
                flags.option("--colour", a->colour, "R,G,B of the fill, linear, 0..1").show_default();
                a->author.add_to(flags);
                flags.fields(a->fill);
                return [a] { return run_fill(*a); };
            }};
}

Command varnish_command() {
    return {"varnish", "lay varnish over a painting under treatment, or between it and retouches",
            [](Flags& flags) {
                auto a = std::make_shared<VarnishArguments>();
                flags.option("TREATMENT", a->treatment, "folder of the treatment").required();
                flags.flag("--isolating", a->isolating, "isolating varnish, before retouching");
                a->area.add_to(flags, "that is varnished; all where nothing is given");
                a->author.add_to(flags);
                flags.fields(a->varnish);
                return [a] { return run_varnish(*a); };
            }};
}

}  // namespace tangi
