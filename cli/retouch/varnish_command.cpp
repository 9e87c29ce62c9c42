// varnish_command.cpp: tangipaint varnish DIR: varnish on a painting under treatment.
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch/treatment_arguments.h"

namespace tangi {

namespace {

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
    refuse_over_unsaved(treatment);
    const StepArea area = a.area.step_area(treatment);
    Canvas canvas = treatment.read_canvas(progress);
    nlohmann::json result =
        varnish_step(treatment, canvas, {a.isolating, a.area.empty() ? nullptr : &area, a.varnish},
                     a.author.author(), progress);
    if (result.contains("warnings")) told(result["warnings"].get<std::vector<std::string>>());
    return result;
}

}  // namespace

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
