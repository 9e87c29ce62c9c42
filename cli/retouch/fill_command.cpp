// fill_command.cpp: tangipaint fill DIR: fills of losses in a painting under treatment.
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch/treatment_arguments.h"
#include "surface/base/error.h"

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
    refuse_over_unsaved(treatment);
    const StepArea area = a.area.step_area(treatment);
    Canvas canvas = treatment.read_canvas(progress);
    nlohmann::json result =
        fill_step(treatment, canvas, area, {*texture, Rgb(rgb[0], rgb[1], rgb[2]), a.fill}, a.author.author(),
                  progress);
    if (result.contains("warnings")) told(result["warnings"].get<std::vector<std::string>>());
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

}  // namespace tangi
