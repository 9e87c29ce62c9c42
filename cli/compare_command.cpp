// compare_command.cpp: tangipaint compare PAINTING.exr PHOTOS --out DIR
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "fit/compare_page.h"
#include "surface/error.h"
#include "surface/painting_file.h"

namespace tangi {

namespace {

struct CompareArguments {
    std::string painting, out;
    PhotosArguments photos;
    CompareOptions options;
};

// Below this the relit picture is another picture: wrong lights, another painting, another crop.
constexpr double kPoorPsnr_db = 15;

nlohmann::json run_compare(const CompareArguments& arguments) {
    const Progress progress = console_progress();
    const Surface surface = read_painting(arguments.painting, progress);
    const Stack photos = arguments.photos.open();
    const CompareReport report =
        write_comparison(arguments.out, surface, photos, arguments.options, progress);
    nlohmann::json result = to_json(report);
    result["page"] = (std::filesystem::path(arguments.out) / "compare.html").string();
    result["warnings"] = told(report.warnings);
    result["poor"] = nlohmann::json::array();
    if (report.all.psnr_db < kPoorPsnr_db)
        result["poor"].push_back(
            fmt::format("the relit pictures differ from the photographs by {:.1f} dB on average; are these "
                        "the photographs, and "
                        "the lights, of this painting?",
                        report.all.psnr_db));
    return result;
}

}  // namespace

Command compare_command() {
    return {"compare", "compare a painting, relit, with photographs, in numbers and pictures",
            [](CLI::App& app) {
                auto a = std::make_shared<CompareArguments>();
                app.add_option("PAINTING", a->painting, "painting file (.exr)")->required();
                a->photos.add_to(app, false);
                app.add_option("--out", a->out, "folder for compare.html, compare.json and the pictures")
                    ->required();
                add_fields(app, a->options);
                return [a] { return run_compare(*a); };
            }};
}

}  // namespace tangi
