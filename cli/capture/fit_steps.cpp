#include "cli/capture/fit_steps.h"

#include <algorithm>
#include <array>

#include "cli/arguments.h"
#include "cli/capture/fit_output.h"
#include "cli/command.h"
#include "cli/result_summary.h"
#include "fit/pipeline/fit_report_page.h"
#include "fit/steps/fit_tiles.h"
#include "fit/verdict/fit_result.h"
#include "fit/verdict/fit_verdict.h"
#include "surface/base/error.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "surface/provenance/provenance.h"

namespace tangi {

namespace {

constexpr int kTilePixels = 1024;  // a side, as the tiles of paintings

// Of results, what a plan cannot know of the painting.
constexpr std::array kOfPainting = {"painting",      "dry_hash",         "final_height",
                                    "height_solver", "support_tilt_deg", "support_bulge_deg"};
// And what the pixels tell anew.
constexpr std::array kOfPixels = {"reduction",
                                  "colour",
                                  "photo_misfits",
                                  "pixels",
                                  "solver_agreement",
                                  "median_confidence",
                                  "unsure_pixels",
                                  "median_residual_sigma",
                                  "refined",
                                  "light_angular_radius",
                                  "width",
                                  "height"};

nlohmann::json tiles_in(const FitTiles& grid) {
    return {{"side", grid.side}, {"columns", grid.columns()}, {"rows", grid.rows()}, {"all", grid.count()}};
}

struct PlanFiles {
    explicit PlanFiles(const FitArguments& arguments)
        : json(arguments.plan), maps(maps_of_plan(arguments.plan)) {
        if (!arguments.report.empty()) page.emplace(arguments.report);
    }
    AtomicFile json, maps;
    std::optional<AtomicFile> page;
};

nlohmann::json result_of_plan(const FitArguments& arguments, FitInput& input, const FitPlan& plan) {
    const FitReport& report = plan.first.result.report;
    std::vector<RejectedPhoto> rejected = input.opened.rejected;
    rejected.insert(rejected.end(), report.rejected.begin(), report.rejected.end());
    nlohmann::json result = fit_result(plan.first.result, rejected, {});
    for (const char* name : kOfPainting) result.erase(name);
    const FitTiles grid{plan.stack.width(), plan.stack.height(), kTilePixels};
    result["plan"] = arguments.plan;
    result["width"] = grid.width;
    result["height"] = grid.height;
    result["mm_per_pixel"] = plan.described.mm_per_pixel;
    result["reduction"] = plan.first.reduction;
    result["tiles"] = tiles_in(grid);
    result["development"] = to_json(input.development);
    result["options"] = input.provenance.at("options");
    result["inputs"] = input.provenance.at("inputs");
    result["warnings"] = told(report.warnings, input.told_before);
    if (!input.development.encoding.doubt.empty())
        input.opened.poor.push_back(input.development.encoding.doubt);
    result["poor"] = poor_reasons(report, input.opened, arguments.photos.axes());
    return result;
}

nlohmann::json run_plan(FitArguments arguments, const Progress& progress) {
    require_ending(arguments.plan, {".json"}, "a plan is a .json file", "--plan");
    refuse_in_treatment(arguments.plan);
    PlanFiles files(arguments);
    FitInput input = open_for_fit(arguments, arguments.plan, progress);
    const FitPlan plan = plan_fit(input.opened.stack, arguments.options_of_fit(), progress);
    nlohmann::json result = result_of_plan(arguments, input, plan);
    write_plan(plan,
               {{"tile_pixels", kTilePixels},
                {"options", arguments.as_json()},
                {"provenance", input.provenance},
                {"result", result}},
               files.json, files.maps);
    OutputSet set;
    set.add(files.maps);
    set.add(files.json);
    if (files.page) {
        files.page->write(
            fit_page(plan.first.result, files.json.target().filename().string(), files.page->target()));
        set.add(*files.page);
    }
    set.commit();
    return result;
}

// The photographs, opened as the plan's were; and the plan.
struct OpenedPlan {
    OpenedPlan(FitArguments& arguments, const Progress& progress) : file(arguments.plan) {
        arguments.take_from_plan(file.content().at("options"));
        input.opened = arguments.photos.open();
        input.told_before = input.opened.stack.warnings.size();
        input.development = develop_stack(input.opened.stack, {}, progress);
        input.provenance = file.content().at("provenance");
        if (const auto changed =
                changed_since(input.provenance.at("inputs"), arguments.photos.inputs(input.opened.stack)))
            fail("{}: is no longer what it was when {} was made: bring it back, or make the plan again",
                 changed->string(), arguments.plan);
        plan = file.plan(input.opened.stack);
    }
    PlanFile file;
    FitInput input;
    FitPlan plan;
};

nlohmann::json run_tiles(FitArguments arguments, const Progress& progress) {
    OpenedPlan opened(arguments, progress);
    const FittedTiles tiles(folder_of_tiles(arguments.plan), opened.file);
    const std::vector<int> numbers =
        of_words([&] { return tiles_named(arguments.tiles, tiles.grid().count()); });
    const FitTilesReport report =
        fit_tiles(opened.plan, arguments.options_of_fit(), tiles, numbers, progress);
    nlohmann::json of = tiles_in(tiles.grid());
    of["asked"] = report.asked;
    of["there_before"] = report.there;
    of["fitted"] = report.fitted;
    return {{"plan", arguments.plan},
            {"tiles", of},
            {"pixels", {{"all", report.pixels}}},
            {"warnings", nlohmann::json::array()},
            {"poor", nlohmann::json::array()}};
}

std::vector<std::string> words_of(const nlohmann::json& result, const char* name) {
    return result.at(name).get<std::vector<std::string>>();
}

nlohmann::json run_finish(FitArguments arguments, const Progress& progress) {
    require_sound(arguments);
    FitFiles files(arguments);
    OpenedPlan opened(arguments, progress);
    const nlohmann::json planned = opened.file.content().at("result");
    const FittedTiles tiles(folder_of_tiles(arguments.plan), opened.file);
    RefinedPixels pixels = tiles.all(static_cast<int>(opened.plan.stack.photos.size()), progress);
    opened.plan.stack.warnings = words_of(planned, "warnings");
    opened.input.told_before = opened.plan.stack.warnings.size();
    FitResult fit =
        finish_fit(std::move(opened.plan), arguments.options_of_fit(), std::move(pixels), progress);
    nlohmann::json result =
        write_fit(arguments, opened.input, fit, words_of(planned, "poor"), files, progress);
    for (const auto& [name, value] : planned.items())
        if (!result.contains(name) || std::ranges::find(kOfPixels, name) == kOfPixels.end())
            if (name != "warnings" && name != "poor") result[name] = value;
    return result;
}

}  // namespace

std::optional<FitStep> fit_step_of(const FitArguments& arguments, const std::vector<std::string>& typed) {
    if (std::ranges::find(typed, "--tiles") != typed.end())
        of_words([&] { require_tile_numbers(arguments.tiles); });
    if (arguments.plan.empty()) {
        if (!arguments.tiles.empty() || arguments.finish)
            throw UsageError("--tiles and --finish go on with a plan: name it with --plan");
        return {};
    }
    const FitStep step = arguments.finish           ? FitStep::finish
                         : !arguments.tiles.empty() ? FitStep::tiles
                                                    : FitStep::plan;
    if (step == FitStep::finish && !arguments.tiles.empty())
        throw UsageError("--tiles and --finish are two steps: first all tiles, then --finish");
    if (step == FitStep::plan) {
        refuse_typed(typed, {"--out"}, "a plan is no painting yet: --finish makes it");
        refuse_typed(typed, {"--preview"}, "a preview is made in one go; leave --plan out");
        if (!arguments.options.refine)
            throw UsageError("--no-refine: a fit in steps refines; leave --plan out");
        return step;
    }
    constexpr std::array kOfStep = {"--plan",    "--tiles",     "--finish", "--out",      "--report",
                                    "--threads", "--memory-mb", "--quiet",  "--progress", "--log"};
    for (const std::string& flag : typed)
        if (flag.starts_with("--") && std::ranges::find(kOfStep, flag) == kOfStep.end())
            throw UsageError(flag + ": is the plan's to say: make the plan with it");
    if (step == FitStep::tiles)
        refuse_typed(typed, {"--out", "--report"},
                     "tiles lie beside their plan; --finish makes the painting");
    return step;
}

nlohmann::json run_fit_step(FitStep step, FitArguments arguments, const Progress& progress) {
    switch (step) {
        case FitStep::plan:
            return run_plan(std::move(arguments), progress);
        case FitStep::tiles:
            return run_tiles(std::move(arguments), progress);
        case FitStep::finish:
            break;
    }
    return run_finish(std::move(arguments), progress);
}

std::vector<std::string> fit_step_in_words(const nlohmann::json& result) {
    const nlohmann::json& tiles = result.at("tiles");
    const auto plan = result.at("plan").get<std::string>();
    if (!tiles.contains("fitted"))
        return {fmt::format("{}: a picture of {} × {} pixels, in {} tiles; {}", plan,
                            result.at("width").get<int>(), result.at("height").get<int>(),
                            tiles.at("all").get<int>(), verdict_in_words(result)),
                fmt::format("next: tangipaint fit PHOTOS --plan {} --tiles 0-{}", plan,
                            tiles.at("all").get<int>() - 1)};
    return {fmt::format("{}: {} of {} tiles fitted, {} were there", plan, tiles.at("fitted").get<int>(),
                        tiles.at("asked").get<int>(), tiles.at("there_before").get<int>())};
}

}  // namespace tangi
