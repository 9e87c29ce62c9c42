// paint_command.cpp: tangipaint paint [PAINTING.exr | --substrate NAME]: the window
#include <filesystem>
#include <tuple>

#include "capture/formats/lights_format.h"
#include "cli/arguments.h"
#include "cli/capture/fit_folder.h"
#include "cli/capture/photo_source.h"
#include "cli/command_list.h"
#include "cli/export/export_painting.h"
#include "cli/paint/substrate_arguments.h"
#include "cli/retouch/treatment_arguments.h"
#include "paint/files/canvas_file.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_tiles.h"
#include "viewer/app/window.h"
#include "viewer/model/user_settings.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct PaintArguments {
    std::string painting, out, palette, brushes, size = "1280x800", monitor, intent = "relative",
                                                 camera = "0";
    std::optional<double> mm_per_pixel;
    SubstrateArguments substrate;
    PhotosArguments photos;
    AuthorArguments author;
};

// Width and height.
std::pair<int, int> size_of(const std::string& text) {
    int end = 0, width = 0, height = 0;
    if (std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &end) != 2 ||
        static_cast<std::size_t>(end) != text.size() || width < 1 || height < 1 || width > 16384 ||
        height > 16384)
        throw UsageError(fmt::format("--size {}: is not a width and a height in pixels, as 1280x800", text));
    return {width, height};
}

Canvas canvas_of(const PaintArguments& a, const Progress& progress) {
    if (!a.substrate.given())
        return read_canvas(a.painting, progress,
                           a.mm_per_pixel ? a.mm_per_pixel : treatment_scale(a.painting));
    return Canvas(std::make_shared<Surface>(a.substrate.make(progress)));
}

HostServices workshop_of(const PaintArguments& a) {
    HostServices workshop;
    workshop.open_photos = [photos = a.photos](const fs::path& folder, std::shared_ptr<const Surface> dry,
                                               const fs::path& painting, const Progress& progress) {
        // What was said of photographs is of the folder that was named with it.
        PhotosArguments arguments = folder == fs::path(photos.folder) ? photos : PhotosArguments();
        arguments.folder = folder;
        return open_photo_book(arguments, std::move(dry), painting, progress);
    };
    workshop.fit = [](const fs::path& photographs, const fs::path& out, const Progress& progress) {
        const nlohmann::json result = fit_folder(photographs, out, progress);
        return std::string();  // its doubts are kept with the painting, which tells them when it is opened
    };
    workshop.export_canvas = [](const ShownPainting& shown, const std::string& format, const fs::path& out,
                                const Progress& progress) {
        const nlohmann::json result = export_canvas(shown, format, out, progress);
        return result.contains("warnings")
                   ? fmt::format("{}", fmt::join(result["warnings"].get<std::vector<std::string>>(), "; "))
                   : std::string();
    };
    workshop.exports = exports_of_window();
    for (const LightsFormat& format : lights_formats())
        workshop.lights_endings +=
            fmt::format("{}{}", workshop.lights_endings.empty() ? "" : " ", format.extension);
    return workshop;
}

void require_sound(const PaintArguments& a) {
    if (a.painting.empty() != a.substrate.given())
        throw UsageError("give a painting, paint PAINTING.exr, or a new canvas, paint --substrate linen");
    if (a.substrate.given() && a.mm_per_pixel)
        throw UsageError("--mm-per-pixel is of a painting; the pixels of a substrate are --pixel-mm");
    a.substrate.refuse_useless();
    if (a.monitor == "srgb")
        refuse_typed(a.substrate.typed(), {"--intent"},
                     "is of a monitor's profile, and with --monitor srgb there is none");
    (void)size_of(a.size);
    if (!a.substrate.given() && !a.out.empty())
        throw UsageError(
            "--out is of a new canvas; a painting is saved where it is (copy it first to keep it as it was)");
    if (a.photos.folder.empty() && (!a.photos.lights.empty() || !a.photos.capture.empty()))
        throw UsageError("--lights and --capture are of photographs: give their folder with --photos");
    if (!a.photos.folder.empty() && !fs::is_directory(a.photos.folder))
        fail("--photos {}: is not a folder; give the folder that holds the photographs", a.photos.folder);
    if (!a.out.empty()) require_ending(a.out, {".exr"}, "a painting is an .exr file");
    if (!a.out.empty() && fs::exists(a.out))
        fail("--out {}: exists already; open it with: paint {}", a.out, a.out);
}

WindowSetup setup_of(const PaintArguments& a) {
    std::vector<std::string> warnings;
    WindowSetup setup{
        .open = [a](const Progress& p) { return canvas_of(a, p); },
        .palette = a.palette.empty() ? artist_acrylics() : read_palette(a.palette),
        .brushes = a.brushes.empty() ? brush_presets() : read_brush_presets(a.brushes, &warnings)};
    if (a.substrate.given())
        for (const std::string& warning : a.substrate.warnings()) warnings.push_back(warning);
    told(warnings);
    setup.warnings = warnings;
    std::tie(setup.width, setup.height) = size_of(a.size);
    setup.file_is_new = a.substrate.given();
    setup.file = !setup.file_is_new ? fs::path(a.painting) : a.out.empty() ? untitled({}) : fs::path(a.out);
    setup.author = a.author.author();
    setup.stop_wanted = interrupted;
    setup.workshop = workshop_of(a);
    setup.photos = a.photos.folder;
    setup.settings = settings_folder();
    setup.monitor_is_srgb = a.monitor == "srgb";
    if (!a.monitor.empty() && !setup.monitor_is_srgb) setup.monitor = Monitor::read(a.monitor);
    setup.intent = a.intent == "relative" ? RenderingIntent::relative : RenderingIntent::perceptual;
    setup.camera = a.camera;
    return setup;
}

nlohmann::json as_json(const WindowResult& result) {
    return {{"painting",
             fs::exists(result.file) ? nlohmann::json(result.file.string()) : nlohmann::json(nullptr)},
            {"strokes", result.strokes},
            {"saves", result.saves},
            {"unsaved", result.unsaved},
            {"frames", result.frames},
            {"tilt_deg", {result.tilt_deg.x, result.tilt_deg.y}},
            {"light_deg", {result.light_azimuth_deg, result.light_elevation_deg}},
            {"fetched_bytes", result.fetched_bytes},
            {"uploaded_bytes", result.uploaded_bytes},
            {"drawn_by", result.drawn_by}};
}

nlohmann::json run_paint(PaintArguments a) {
    if (fs::is_regular_file(fs::path(a.painting) / "log.jsonl"))  // a treatment
        a.painting = (fs::path(a.painting) / "painting.exr").string();
    require_sound(a);
    const Progress progress = console_progress();
    return as_json(run_window(setup_of(a), progress));
}

}  // namespace

Command paint_command() {
    return {
        "paint", "hold a painting, tilt it, light it and paint on it: the window", [](Flags& flags) {
            auto a = std::make_shared<PaintArguments>();
            flags.option("PAINTING", a->painting,
                         "painting file (.exr), or folder of a treatment; saved in place, its dry layer "
                         "never changes");
            a->substrate.add_to(flags);
            flags.option("--out", a->out,
                         "where a new canvas is saved (.exr); untitled-1.exr where not given");
            flags.option("--photos", a->photos.folder, "folder of photographs to compare the painting with");
            flags.option(
                "--lights", a->photos.lights,
                fmt::format("their lights file ({}); where not given, the only one in the folder",
                            extensions_in_words([](const LightsFormat& f) { return !f.is_capture; })));
            flags.option("--capture", a->photos.capture, "their capture.json");
            flags.option("--palette", a->palette, "palette file (.json)");
            flags.option("--brushes", a->brushes, "presets file (.json) with further brushes");
            flags
                .option("--mm-per-pixel", a->mm_per_pixel,
                        "size of the painting's pixels where the file does not say")
                .check(within(1e-4, 1e3));
            a->author.add_to(flags);
            flags.option("--size", a->size, "of the window in pixels").show_default();
            flags.option("--monitor", a->monitor,
                         "ICC profile of the monitor (.icc); srgb: none; where not given, the one that the "
                         "desktop has put on the screen");
            flags.option("--intent", a->intent, "relative or perceptual: how the monitor's profile is used")
                .check(one_of({"relative", "perceptual"}))
                .show_default();
            flags.option("--camera", a->camera, "number of the webcam, for head and light").show_default();
            return [a] { return run_paint(*a); };
        }};
}

}  // namespace tangi
