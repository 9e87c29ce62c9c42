// fit_command.cpp: tangipaint fit PHOTOS --out PAINTING.exr
#include "cli/capture/fit_folder.h"
#include "cli/capture/fit_output.h"
#include "cli/capture/fit_steps.h"
#include "cli/command_list.h"
#include "cli/result_summary.h"

namespace tangi {

namespace {

nlohmann::json run_fit(FitArguments arguments, const Progress& progress) {
    require_sound(arguments);
    FitFiles files(arguments);  // before the work: an output that can't be written is known now
    FitInput input = open_for_fit(arguments, arguments.out, progress);
    FitResult fit = fit_painting(input.opened.stack, arguments.options_of_fit(), progress);
    return write_fit(arguments, input, fit, {}, files, progress);
}

std::vector<std::string> said_in_words(const nlohmann::json& result) {
    return result.contains("painting") ? fit_in_words(result) : fit_step_in_words(result);
}

}  // namespace

nlohmann::json fit_folder(const std::filesystem::path& photographs, const std::filesystem::path& out,
                          const Progress& progress) {
    FitArguments arguments;
    arguments.photos.folder = photographs;
    if (std::filesystem::is_regular_file(photographs)) {
        arguments.photos.lights = photographs;
        arguments.photos.folder = std::filesystem::absolute(photographs).parent_path();
    }
    arguments.out = out;
    return run_fit(arguments, progress);
}

Command fit_command() {
    return {"fit", "fit height, normals and Ward parameters to photographs: the main job",
            [](Flags& flags) {
                auto arguments = std::make_shared<FitArguments>();
                arguments->add_to(flags);
                return [arguments, typed = flags.typed()] {
                    const std::optional<FitStep> step = fit_step_of(*arguments, typed());
                    if (!arguments->like.empty()) arguments->take_from_painting(typed());
                    if (!arguments->looks_for_residual())
                        refuse_typed(typed(),
                                     {"--residual-terms", "--residual-colour-terms", "--residual-samples",
                                      "--residual-min-gain-db"},
                                     "is of a residual, of which there is none");
                    return step ? run_fit_step(*step, *arguments, console_progress())
                                : run_fit(*arguments, console_progress());
                };
            },
            said_in_words};
}

}  // namespace tangi
