// relight_command.cpp: tangipaint relight PAINTING.exr --light X,Y,Z --out IMAGE, --lights FILE.lp --out
// DIR, or --sweep AZIMUTH,ELEVATION --out FILM
#include <algorithm>
#include <filesystem>
#include <set>

#include "capture/formats/lights_format.h"
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/relight/light_sweep.h"
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/render/relight.h"
#include "surface/render/relighting_residual.h"
#include "surface/render/viewing_exposure.h"
#include "viewer/render/gpu_relight.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct RelightArguments {
    std::string painting, out, lights_file, encoding, model = "bounded";
    std::string illuminant = "D65", paint_model = "spectral";
    std::vector<std::string> directions, positions;
    double gain = 1;
    std::optional<bool> with_residual;  // where not said, if there is one of what is drawn
    bool gpu = false;
    RelightOptions options;
    SweepArguments sweep;
};

// A painting with its paint, and what its residual adds where none lies.
struct Painting {
    Canvas canvas;
    std::shared_ptr<const Surface> surface;
    RelightingResidual residual;  // empty where it is left out
    Image<float> bare;
    std::vector<std::string> warnings;
};

// How paint, and under another light all of the painting, is seen.
AppearanceOptions look_of(const RelightArguments& arguments) {
    const Illuminant illuminant = parse_illuminant(arguments.illuminant, "--illuminant");
    const auto model = paint_model_named(arguments.paint_model);
    if (!model)
        throw UsageError(fmt::format("--paint-model {}: is not spectral or thesis", arguments.paint_model));
    return {.illuminant = illuminant, .model = *model};
}

// What is drawn that a residual is none of; empty where it fits.
std::string drawn_otherwise(const RelightArguments& arguments, const Surface& dry,
                            const RelightingResidual& residual) {
    const RelightOptions& o = arguments.options;
    if (look_of(arguments).illuminant != Illuminant::d65)
        return "--illuminant: what a residual adds is of the light of the photographs";
    const float radius = static_cast<float>(residual.light_radius_deg);
    if (o.cast_shadows && o.model == WardModel::bounded &&
        static_cast<float>(light_radius_deg(dry, o)) == radius)
        return {};
    return fmt::format(
        "the residual was fitted with --cast-shadows, --model bounded and --light-radius-deg {}, and is none "
        "of anything else",
        radius);
}

// Where it is asked for, there must be one, unless the fit found that none is better.
RelightingResidual residual_to_add(const RelightArguments& arguments, const Surface& dry,
                                   std::vector<std::string>& warnings, const Progress& progress) {
    if (!arguments.with_residual.value_or(true)) return {};
    RelightingResidual residual = read_residual(arguments.painting, dry, progress);
    const bool required = arguments.with_residual.has_value();
    if (residual.empty()) {
        if (required && !residual_in_vain(dry))
            fail("{}: has no part 'residual'; fit the painting again, without --no-residual",
                 arguments.painting);
        if (required)
            warnings.push_back(
                fmt::format("--residual: {} holds none, since the fit found none that predicts photographs "
                            "better than the surface alone, which is what is shown",
                            arguments.painting));
        return residual;
    }
    const std::string otherwise = drawn_otherwise(arguments, dry, residual);
    if (otherwise.empty()) return residual;
    if (required) throw UsageError(fmt::format("--residual: {}; leave one of them out", otherwise));
    return {};
}

Painting read_all(const RelightArguments& arguments, const Progress& progress) {
    const AppearanceOptions look = look_of(arguments);
    Canvas canvas = read_canvas(arguments.painting, progress);
    std::vector<std::string> warnings;
    RelightingResidual residual = residual_to_add(arguments, canvas.dry(), warnings, progress);
    auto surface = shown(canvas, look, progress);
    Image<float> bare = residual.empty() ? Image<float>() : bare_part(canvas);
    return {std::move(canvas), std::move(surface), std::move(residual), std::move(bare), std::move(warnings)};
}

struct Encoding {
    Transfer transfer;
    bool as_camera_sees = false;  // in the photographs' channels; else linear Rec. 709
};

Encoding encoding_of(const RelightArguments& arguments, const Surface& surface, const fs::path& picture) {
    if (!arguments.encoding.empty()) {
        const auto transfer = transfer_named(arguments.encoding);
        if (!transfer)
            throw UsageError(fmt::format("--encoding {}: is not srgb, linear, or a gamma in [0.2, 5]",
                                         arguments.encoding));
        return {*transfer};
    }
    if (lower_extension(picture) == ".exr") return {Transfer{}};
    if (surface.photography.photos.empty()) return {Transfer{Transfer::Kind::srgb}};
    return {surface.photography.transfer, true};
}

// Pictures of one painting: by the reference renderer, or with --gpu by OpenGL as far as that goes.
class PaintingRelighter {
public:
    PaintingRelighter(const Painting& painting, const RelightArguments& arguments)
        : painting_(painting), options_(arguments.options) {
        if (arguments.gpu) by_gpu([&] { gpu_.emplace(*painting.surface); });
    }

    Image<Rgb> picture(const std::vector<Light>& lights, const Progress& progress) {
        Image<Rgb> picture;
        if (!gpu_ || !by_gpu([&] { picture = gpu_->relight(lights, options_); }))
            picture = relight(*painting_.surface, lights, options_, progress);
        add_residual(painting_.residual, painting_.canvas.dry(), lights, painting_.bare, picture);
        return picture;
    }
    std::string drawn_by() const { return gpu_ ? gpu_->device() : "reference renderer"; }

private:
    // False, with a note, where OpenGL cannot.
    bool by_gpu(const std::function<void()>& action) {
        try {
            action();
            return true;
        } catch (const Error& error) {
            gpu_.reset();
            warn(fmt::format("--gpu: {}; the reference renderer draws instead", error.what()));
            return false;
        }
    }

    const Painting& painting_;
    RelightOptions options_;
    std::optional<GpuRelight> gpu_;
};

void write_relit(const fs::path& path, const Surface& surface, const std::vector<Light>& lights,
                 const RelightArguments& arguments, PaintingRelighter& relighter, const Progress& progress) {
    const Encoding encoding = encoding_of(arguments, surface, path);
    const Photography& photography = surface.photography;
    Image<Rgb> picture = relighter.picture(lights, progress);
    // Only files of floats hold any unit.
    const bool any_unit = lower_extension(path) == ".exr";
    glm::mat3 exposure(
        static_cast<float>(any_unit ? photography.white_level : viewing_exposure(photography.white_level)));
    if (encoding.as_camera_sees && photography.to_camera)
        exposure = exposure * glm::mat3(*photography.to_camera);
    for (Rgb& pixel : picture.pixels()) pixel = exposure * pixel;
    write_picture(path, picture, encoding.transfer);
}

// A light in the paint has no distance from it: nothing could be said of how bright it is there.
void require_above_paint(const Surface& surface, const Vec3& light_mm, const std::string& flag) {
    const Vec3 corner_mm = surface.point_mm(0, 0);
    const auto pixel = [&](float distance_mm) { return std::round(distance_mm / surface.mm_per_pixel); };
    const double x = pixel(light_mm.x - corner_mm.x), y = pixel(corner_mm.y - light_mm.y);
    if (!(x >= 0 && y >= 0 && x < surface.width() && y < surface.height())) return;
    const float height_mm = surface.height_mm(static_cast<int>(x), static_cast<int>(y));
    if (!(light_mm.z >= height_mm + 0.001f))
        throw UsageError(fmt::format(
            "{}: lies in the painting, which is {:.3f} mm high there; z must be larger", flag, height_mm));
}

// The lights that --light and --point-light name.
std::vector<Light> lights_named(const Painting& painting, const RelightArguments& arguments) {
    std::vector<Light> lights;
    for (const std::string& text : arguments.directions)
        lights.push_back(distant_light(parse_direction(text, "--light")));
    for (const std::string& text : arguments.positions) {
        lights.push_back(near_light(parse_position(text, "--point-light")));
        require_above_paint(*painting.surface, *lights.back().position_mm, "--point-light " + text);
    }
    for (Light& light : lights) light.gain = Rgb(static_cast<float>(arguments.gain));
    return lights;
}

// A picture that comes out black has a reason.
std::vector<std::string> lights_behind(const RelightArguments& arguments) {
    std::vector<std::string> warnings;
    for (const std::string& text : arguments.directions)
        if (parse_direction(text, "--light").z < 0)
            warnings.push_back(fmt::format(
                "--light {}: comes from behind the painting and lights nothing but slopes that face it; z "
                "points towards the viewer",
                text));
    return warnings;
}

nlohmann::json relight_one(const Painting& painting, const RelightArguments& arguments,
                           const Progress& progress) {
    require_picture_format(arguments.out);
    refuse_to_overwrite(arguments.out, {arguments.painting});
    const std::vector<Light> lights = lights_named(painting, arguments);
    std::vector<std::string> all = painting.warnings;
    for (std::string& warning : lights_behind(arguments)) all.push_back(std::move(warning));
    const nlohmann::json warnings = told(all);
    PaintingRelighter relighter(painting, arguments);
    write_relit(arguments.out, *painting.surface, lights, arguments, relighter, progress);
    return {{"pictures", {arguments.out}},
            {"warnings", warnings},
            {"residual", !painting.residual.empty()},
            {"drawn_by", relighter.drawn_by()}};
}

// A film is for people: sRGB, as bright as the photographs were.
nlohmann::json relight_sweep(const Painting& painting, const RelightArguments& arguments,
                             const Progress& progress) {
    refuse_to_overwrite(arguments.out, {arguments.painting});
    std::vector<Light> lights = lights_named(painting, arguments);
    const nlohmann::json warnings = told(painting.warnings);
    lights.emplace_back();
    PaintingRelighter relighter(painting, arguments);
    const auto draw = [&](const Light& light) {
        lights.back() = light;
        lights.back().gain = Rgb(static_cast<float>(arguments.gain));
        Image<Rgb> picture = relighter.picture(lights, {});
        for (Rgb& pixel : picture.pixels())
            pixel *= viewing_exposure(painting.surface->photography.white_level);
        return picture;
    };
    const int frames = write_sweep(arguments.sweep, arguments.out, draw, progress);
    return {{"film", arguments.out},
            {"frames", frames},
            {"warnings", warnings},
            {"residual", !painting.residual.empty()},
            {"drawn_by", relighter.drawn_by()}};
}

// Windows programs write their folders with backslashes.
fs::path portable(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return fs::path(name);
}

// Where the lights file lies beside its photographs, these have the names of the pictures to be made. One
// that lies there is a photograph, unless the photograph that the lights file names is another file.
void refuse_to_overwrite_photograph(const fs::path& output, const fs::path& lights_file, const Light& light) {
    const fs::path folder = fs::absolute(lights_file).parent_path(), listed = portable(light.name);
    if (!fs::exists(output)) return;
    for (const fs::path& named : {folder / listed, folder / listed.filename()}) {
        std::error_code missing;
        const bool same_folder =
            fs::equivalent(fs::absolute(output).parent_path(), named.parent_path(), missing);
        if (same_folder && (!fs::exists(named) || fs::equivalent(output, named)))
            fail("--out {}: would overwrite the photograph {}; choose another folder",
                 output.parent_path().string(), output.string());
    }
}

// Of a lights file of any format; of a capture file in the frame of the picture that it describes.
LightList lights_in(const fs::path& path) {
    LightList list = read_lights(path);
    if (list.capture && list.capture->geometry) list.lights = in_picture(*list.capture).lights;
    if (list.lights.empty()) fail("{}: holds no light", path.string());
    if (std::ranges::any_of(list.lights, [](const Light& light) { return light.name.empty(); }))
        fail(
            "{}: does not name the photographs of its lights, after which the pictures are called; give a "
            "lights file that does (.lp)",
            path.string());
    // The picture is of what was asked for; where the lights really stood is another matter.
    if (list.capture)
        list.warnings.insert(list.warnings.end(), list.capture->poor.begin(), list.capture->poor.end());
    return list;
}

nlohmann::json relight_all(const Painting& painting, const RelightArguments& arguments,
                           const Progress& progress) {
    const LightList file = lights_in(arguments.lights_file);
    std::vector<std::string> all = painting.warnings;
    all.insert(all.end(), file.warnings.begin(), file.warnings.end());
    const nlohmann::json warnings = told(all);
    std::vector<fs::path> outputs;
    std::set<fs::path> seen;
    for (const Light& light : file.lights) {
        outputs.push_back(fs::path(arguments.out) / (portable(light.name).stem().string() + ".png"));
        if (!seen.insert(outputs.back()).second)
            fail("{}: two photographs have the stem '{}', so their relit pictures would be one file",
                 arguments.lights_file, outputs.back().stem().string());
        refuse_to_overwrite(outputs.back(), {arguments.painting, arguments.lights_file});
        refuse_to_overwrite_photograph(outputs.back(), arguments.lights_file, light);
    }
    FolderFiles written(arguments.out);  // all of them, or none
    PaintingRelighter relighter(painting, arguments);
    nlohmann::json pictures = nlohmann::json::array();
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        // As strong, and as near, as it was estimated for the photograph of its name.
        Light light = as_photographed(file.lights[i], painting.surface->photography);
        light.gain *= static_cast<float>(arguments.gain);
        told_of(written.temporary(), arguments.out, [&] {
            write_relit(written.temporary() / outputs[i].filename(), *painting.surface, {light}, arguments,
                        relighter, {});
        });
        pictures.push_back(outputs[i].string());
        report(progress, "relight", static_cast<double>(i + 1) / static_cast<double>(outputs.size()));
    }
    written.place();
    return {{"pictures", pictures},
            {"warnings", warnings},
            {"residual", !painting.residual.empty()},
            {"drawn_by", relighter.drawn_by()}};
}

nlohmann::json run_relight(RelightArguments arguments) {
    const bool one = !arguments.directions.empty() || !arguments.positions.empty();
    const bool sweeps = arguments.sweep.given();
    if ((one || sweeps) == !arguments.lights_file.empty())
        throw UsageError(
            "give either lights (--light X,Y,Z, --point-light X,Y,Z), a lights file (--lights FILE.lp) or "
            "the way "
            "of a light (--sweep AZIMUTH,ELEVATION)");
    if (sweeps && !arguments.encoding.empty())
        throw UsageError("--encoding: is of single pictures; those of --sweep are sRGB");
    const auto model = ward_model_named(arguments.model);
    if (!model) throw UsageError(fmt::format("--model {}: is not {}", arguments.model, ward_model_names()));
    arguments.options.model = *model;
    const Progress progress = console_progress();
    const Painting painting = read_all(arguments, progress);
    if (sweeps) return relight_sweep(painting, arguments, progress);
    return one ? relight_one(painting, arguments, progress) : relight_all(painting, arguments, progress);
}

}  // namespace

Command relight_command() {
    return {
        "relight", "show a painting under other lights", [](Flags& flags) {
            auto a = std::make_shared<RelightArguments>();
            a->options.cast_shadows = true;  // as the photographs have them
            flags.option("PAINTING", a->painting, "painting file (.exr)").required();
            flags
                .option(
                    "--light", a->directions,
                    "direction to a distant light: X,Y,Z, x right, y up, z towards the viewer; may be given "
                    "several times")
                .one_value();
            flags
                .option("--point-light", a->positions,
                        "position of a near light in mm from the centre: X,Y,Z; may be given several times")
                .one_value();
            flags.option(
                "--lights", a->lights_file,
                fmt::format("lights file ({}): one picture for each of its lights", extensions_in_words()));
            flags
                .option("--out", a->out,
                        "picture to write (.png .tif .jpg .exr); with --lights the folder for the pictures; "
                        "with --sweep a "
                        "video (.mp4 .webm) or a folder")
                .required();
            a->sweep.add_to(flags);
            flags.option("--encoding", a->encoding,
                         "srgb, linear or a gamma; where not given, as the photographs were (EXR: linear)");
            flags.option("--model", a->model, ward_model_names()).show_default();
            flags
                .option("--illuminant", a->illuminant,
                        "lights that paint is seen under, by eyes used to them: A, D50, D65, F11 or LED; "
                        "what is dry by a reflectance estimated from its colour")
                .show_default();
            flags
                .option("--paint-model", a->paint_model,
                        "how paints make a colour: spectral, or thesis, its RGB model, for comparison")
                .show_default();
            flags.option("--gain", a->gain, "strength of the lights, 1 = as for the photographs")
                .check(within(0, 1e4));
            flags.flag(
                "--residual", a->with_residual,
                "add what the photographs showed beyond the surface, where no paint lies; where not said, "
                "if the painting has such a residual, and shadows, model, light radius and illuminant are "
                "those that it was fitted with");
            flags.flag("--gpu", a->gpu,
                       "draw with OpenGL, without a window; where that cannot be, as without it");
            flags.fields(a->options);
            return [a] { return run_relight(*a); };
        }};
}

}  // namespace tangi
