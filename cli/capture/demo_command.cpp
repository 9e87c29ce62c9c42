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
#include "surface/base/json_text.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/provenance/provenance.h"
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

FitResult fit_sample(bool small, const Progress& progress) {
    FitOptions options;
    options.mm_per_pixel = 200.0 / 512;  // the sample's README
    options.white_level = 0.75;
    Stack stack = sample_stack("lights.lp", small);
    FitResult fit = fit_painting(stack, options, progress);
    std::vector<fs::path> inputs;
    for (const StackPhoto& photo : stack.photos) inputs.push_back(photo.path);
    fit.surface.provenance = json_line(tangi::provenance_of("demo", to_json(options), records_of(inputs)));
    return fit;
}

// Where files are written until all of them are there, and the name that messages give that folder.
struct DemoFolder {
    std::filesystem::path hidden, named;
};

void write_relit(const Surface& surface, const DemoFolder& to) {
    RelightOptions options;
    options.cast_shadows = true;
    for (const NamedLight& light : kLights) {
        const std::vector<Light> lights{distant_light(light.direction)};
        told_of(to.hidden, to.named, [&] {
            write_picture(to.hidden / light.file, relight(surface, lights, options),
                          Transfer{Transfer::Kind::srgb});
        });
    }
}

// With photographs that the fit never saw.
CompareReport write_compared(const Surface& surface, bool small, const DemoFolder& to,
                             const Progress& progress) {
    const Stack held_out = sample_stack("heldout.lp", small);
    CompareReport report;
    told_of(to.hidden, to.named, [&] {
        report = write_comparison(to.hidden / "compare", surface, held_out, {}, progress);
        write_picture_8bit(to.hidden / "contact_sheet.png",
                           contact_sheet(surface, held_out, report, {}, progress));
    });
    return report;
}

void say_where_to_look(const fs::path& out, const FitReport& fit, const CompareReport& compared) {
    tell_lines(fmt::format(
        "\nThe sample: 48 photographs of a rendered impasto painting, fitted, relit, and compared with {}\n"
        "photographs under lights that the fit never saw.\n\n"
        "  held out    {:.1f} dB PSNR, SSIM {:.3f}, Delta E 2000 {:.2f} on average\n"
        "  fitted      {} of {} pixels, median confidence {:.2f}\n\n"
        "Look at\n"
        "  {}   photograph, relit, difference; the maps\n"
        "  {}   each photograph beside its relit picture, with a slider\n"
        "  {}   and its siblings: the painting under new lights\n"
        "  {}   the painting: EXR with height, normals, Ward parameters\n\n",
        compared.held_out.count, compared.held_out.psnr_db, compared.held_out.ssim,
        compared.held_out.delta_e_2000, fit.fitted, fit.pixels, fit.median_confidence,
        (out / "contact_sheet.png").string(), (out / "compare" / "compare.html").string(),
        (out / kLights[0].file).string(), (out / "painting.exr").string()));
}

nlohmann::json run_demo(const DemoArguments& arguments) {
    const Progress progress = console_progress();
    const fs::path out(arguments.out);
    FolderFiles written(out);  // all of them, or none
    const DemoFolder folder{written.temporary(), out};
    const FitResult fit = fit_sample(arguments.small, progress);
    told_of(folder.hidden, out,
            [&] { write_painting(folder.hidden / "painting.exr", fit.surface, progress); });
    write_relit(fit.surface, folder);
    const CompareReport report = write_compared(fit.surface, arguments.small, folder, progress);
    written.place();
    say_where_to_look(out, fit.report, report);
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
