// demo_command.cpp: tangipaint demo: the whole path on the embedded sample, with pictures to look at.
#include <filesystem>

#include "capture/stack/stack.h"
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "datasets/sample.h"
#include "fit/evaluate/compare_page.h"
#include "fit/evaluate/contact_sheet.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct DemoArguments {
    std::string out = "out/demo";
    bool small = false;
};

// Lights that no photograph had, for pictures of the relit painting.
struct NamedLight {
    const char* file;
    Vec3 direction;
};
constexpr NamedLight kLights[] = {
    {"relit_raking_left.png", {-0.97f, 0.1f, 0.2f}},
    {"relit_raking_top.png", {0.1f, 0.97f, 0.22f}},
    {"relit_gallery.png", {0.2f, 0.45f, 0.87f}},
};

Stack sample_stack(const std::string& lights, bool small) {
    StackOptions options;
    const fs::path folder = sample_folder() / "impasto" / "jpg";
    options.lights_file = folder / lights;
    if (small) options.crop = Region{176, 176, 336, 336};
    Stack stack = open_stack(folder, options);
    stack.warnings
        .clear();  // the folder holds both lists; that the other's photographs are not in this one is meant
    return stack;
}

nlohmann::json run_demo(const DemoArguments& arguments) {
    const Progress progress = console_progress();
    const fs::path out(arguments.out);
    FolderFiles written(out);  // all of them, or none
    const fs::path hidden = written.temporary();
    FitOptions options;
    options.mm_per_pixel = 200.0 / 512;  // the sample's README
    options.white_level = 0.75;
    FitResult fit = fit_painting(sample_stack("lights.lp", arguments.small), options, progress);
    fit.surface.provenance = nlohmann::json{
        {"program", "tangipaint " TP_VERSION},
        {"command", "demo"},
        {"inputs",
         "datasets/impasto/jpg"}}.dump();
    told_of(hidden, out, [&] { write_painting(hidden / "painting.exr", fit.surface, progress); });

    for (const NamedLight& light : kLights) {
        const std::vector<Light> lights{distant_light(light.direction)};
        RelightOptions relight_options;
        relight_options.cast_shadows = true;
        told_of(hidden, out, [&] {
            write_picture(hidden / light.file, relight(fit.surface, lights, relight_options),
                          Transfer{Transfer::Kind::srgb});
        });
    }
    const Stack held_out = sample_stack("heldout.lp", arguments.small);
    CompareReport report;
    told_of(hidden, out, [&] {
        report = write_comparison(hidden / "compare", fit.surface, held_out, {}, progress);
        write_picture_8bit(hidden / "contact_sheet.png",
                           contact_sheet(fit.surface, held_out, report, {}, progress));
    });
    written.place();

    write_stderr(fmt::format(
        "\nThe sample: 48 photographs of a rendered impasto painting, fitted, relit, and compared with {}\n"
        "photographs under lights that the fit never saw.\n\n"
        "  held out    {:.1f} dB PSNR, SSIM {:.3f}, Delta E 2000 {:.2f} on average\n"
        "  fitted      {} of {} pixels, median confidence {:.2f}\n\n"
        "Look at\n"
        "  {}   photograph, relit, difference; the maps\n"
        "  {}   each photograph beside its relit picture, with a slider\n"
        "  {}   and its siblings: the painting under new lights\n"
        "  {}   the painting: EXR with height, normals, Ward parameters\n\n",
        report.held_out.count, report.held_out.psnr_db, report.held_out.ssim, report.held_out.delta_e_2000,
        fit.report.fitted, fit.report.pixels, fit.report.median_confidence,
        (out / "contact_sheet.png").string(), (out / "compare" / "compare.html").string(),
        (out / kLights[0].file).string(), (out / "painting.exr").string()));
    return {{"out", arguments.out},
            {"held_out", to_json(report)["mean"]["held_out"]},
            {"fitted_pixels", fit.report.fitted},
            {"median_confidence", fit.report.median_confidence}};
}

}  // namespace

Command demo_command() {
    return {"demo", "fit, relight and compare the embedded sample, and say where to look", [](Flags& flags) {
                auto a = std::make_shared<DemoArguments>();
                flags.option("--out", a->out, "folder for the results").show_default();
                flags.flag("--small", a->small, "only a part of the sample, for a quick look");
                return [a] { return run_demo(*a); };
            }};
}

}  // namespace tangi
