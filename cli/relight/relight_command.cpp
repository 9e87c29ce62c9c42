// relight_command.cpp: tangipaint relight PAINTING.exr --light X,Y,Z --out IMAGE, --lights FILE.lp --out
// DIR, or --sweep AZIMUTH,ELEVATION --out FILM
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/relight/light_sweep.h"
#include "cli/relight/lights_to_relight.h"
#include "cli/relight/relit_painting.h"
#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/render/viewing_exposure.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct RelightArguments {
    std::string painting, out, lights_file, encoding, model = "bounded";
    std::string illuminant = "D65", paint_model = "spectral";
    std::vector<std::string> directions, positions;
    double gain = 1;
    Drawing drawing;
    SweepArguments sweep;
    PictureNotes notes;  // title, creator, credit
    std::string source;  // the painting's hash, for pictures
};

struct Encoding {
    Transfer transfer;
    bool as_camera_sees = false;  // in the photographs' channels; else linear Rec. 709
};

Encoding encoding_of(const RelightArguments& arguments, const PaintingHeader& painting,
                     const fs::path& picture) {
    if (!arguments.encoding.empty()) {
        const auto transfer = transfer_named(arguments.encoding);
        if (!transfer)
            throw UsageError(fmt::format("--encoding {}: is not srgb, linear, or a gamma in [0.2, 5]",
                                         arguments.encoding));
        return {*transfer};
    }
    if (lower_extension(picture) == ".exr") return {Transfer{}};
    if (painting.photography.photos.empty()) return {Transfer{Transfer::Kind::srgb}};
    return {painting.photography.transfer, true};
}

std::string light_in_words(const Light& light) {
    const bool is_near = light.position_mm.has_value();
    const Vec3& v = is_near ? *light.position_mm : light.direction;
    return is_near ? fmt::format("a light at {:.1f}, {:.1f}, {:.1f} mm", v.x, v.y, v.z)
                   : fmt::format("a light from {:.3f}, {:.3f}, {:.3f}", v.x, v.y, v.z);
}

// How a picture was made, for whoever finds it in ten years.
PictureNotes notes_of(const RelightArguments& a, const PaintingHeader& painting,
                      const std::vector<Light>& lights, const Transfer& transfer) {
    PictureNotes notes = a.notes;
    if (notes.title.empty()) notes.title = fs::path(a.painting).stem().string();
    std::vector<std::string> words;
    for (const Light& light : lights) words.push_back(light_in_words(light));
    notes.description = fmt::format(
        "Relit by {} (x right, y up, z towards the viewer), model {}, {}, {}", fmt::join(words, " and "),
        a.model, a.drawing.options.cast_shadows ? "cast shadows" : "no cast shadows", transfer.name());
    notes.source = a.source;
    if (painting.scale_known) notes.mm_per_pixel = painting.mm_per_pixel;
    return notes;
}

void write_relit(const fs::path& path, const RelitPainting& painting, const std::vector<Light>& lights,
                 const RelightArguments& arguments, PaintingRelighter& relighter, const Progress& progress) {
    const PaintingHeader& header = painting.header();
    const Encoding encoding = encoding_of(arguments, header, path);
    const Photography& photography = header.photography;
    // Only files of floats hold any unit.
    const bool any_unit = lower_extension(path) == ".exr";
    glm::mat3 exposure(
        static_cast<float>(any_unit ? photography.white_level : viewing_exposure(photography.white_level)));
    if (encoding.as_camera_sees && photography.to_camera)
        exposure = exposure * glm::mat3(*photography.to_camera);
    PictureWriter writer(path, header.width, header.height, encoding.transfer,
                         {.notes = notes_of(arguments, header, lights, encoding.transfer)});
    relighter.draw(
        lights,
        [&](Image<Rgb>&& rows) {
            for (Rgb& pixel : rows.pixels()) pixel = exposure * pixel;
            writer.write(rows);
        },
        progress);
    writer.commit();
}

// A light in the paint has no distance from it: nothing could be said of how bright it is there.
void require_above_paint(const PaintingReader& painting, const Vec3& light_mm, const std::string& flag) {
    Surface corner;
    describe(painting.header(), corner);
    corner.height_mm = Image<float>(1, 1);
    corner.part_of = {0, 0, static_cast<double>(painting.width()), static_cast<double>(painting.height())};
    const Vec3 corner_mm = corner.point_mm(0, 0);
    const auto pixel = [&](float distance_mm) { return std::round(distance_mm / corner.mm_per_pixel); };
    const double x = pixel(light_mm.x - corner_mm.x), y = pixel(corner_mm.y - light_mm.y);
    if (!(x >= 0 && y >= 0 && x < painting.width() && y < painting.height())) return;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const float height_mm = painting.read_heights({column, row, column + 1, row + 1})(0, 0);
    if (!(light_mm.z >= height_mm + 0.001f))
        throw UsageError(fmt::format(
            "{}: lies in the painting, which is {:.3f} mm high there; z must be larger", flag, height_mm));
}

// The lights that --light and --point-light name.
std::vector<Light> lights_named(const RelitPainting& painting, const RelightArguments& arguments) {
    std::vector<Light> lights;
    for (const std::string& text : arguments.directions)
        lights.push_back(distant_light(parse_direction(text, "--light")));
    for (const std::string& text : arguments.positions) {
        lights.push_back(near_light(parse_position(text, "--point-light")));
        require_above_paint(*painting.seen, *lights.back().position_mm, "--point-light " + text);
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

nlohmann::json relight_one(const RelitPainting& painting, const RelightArguments& arguments,
                           const Progress& progress) {
    require_picture_ending(arguments.out);
    refuse_to_overwrite(arguments.out, {arguments.painting});
    const std::vector<Light> lights = lights_named(painting, arguments);
    std::vector<std::string> all = painting.warnings;
    for (std::string& warning : lights_behind(arguments)) all.push_back(std::move(warning));
    const nlohmann::json warnings = told(all);
    PaintingRelighter relighter(painting, arguments.drawing);
    write_relit(arguments.out, painting, lights, arguments, relighter, progress);
    return {{"pictures", {arguments.out}},
            {"warnings", warnings},
            {"residual", !painting.residual.empty()},
            {"drawn_by", relighter.drawn_by()}};
}

// A film is for people: sRGB, as bright as the photographs were.
nlohmann::json relight_sweep(const RelitPainting& painting, const RelightArguments& arguments,
                             const Progress& progress) {
    refuse_to_overwrite(arguments.out, {arguments.painting});
    std::vector<Light> lights = lights_named(painting, arguments);
    const nlohmann::json warnings = told(painting.warnings);
    lights.emplace_back();
    PaintingRelighter relighter(painting, arguments.drawing);
    const auto draw = [&](const Light& light) {
        lights.back() = light;
        lights.back().gain = Rgb(static_cast<float>(arguments.gain));
        Image<Rgb> picture = relighter.picture(lights);
        for (Rgb& pixel : picture.pixels())
            pixel *= viewing_exposure(painting.header().photography.white_level);
        return picture;
    };
    const int frames = write_sweep(arguments.sweep, arguments.out, draw, progress);
    return {{"film", arguments.out},
            {"frames", frames},
            {"warnings", warnings},
            {"residual", !painting.residual.empty()},
            {"drawn_by", relighter.drawn_by()}};
}

nlohmann::json relight_all(const RelitPainting& painting, const RelightArguments& arguments,
                           const Progress& progress) {
    const LightList file = lights_in(arguments.lights_file);
    std::vector<std::string> all = painting.warnings;
    all.insert(all.end(), file.warnings.begin(), file.warnings.end());
    const nlohmann::json warnings = told(all);
    const std::vector<fs::path> outputs = pictures_of(file.lights, arguments.lights_file, arguments.out,
                                                      {arguments.painting, arguments.lights_file});
    FolderFiles written(arguments.out);  // all of them, or none
    PaintingRelighter relighter(painting, arguments.drawing);
    nlohmann::json pictures = nlohmann::json::array();
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        // As strong, and as near, as it was estimated for the photograph of its name.
        Light light = as_photographed(file.lights[i], painting.header().photography);
        light.gain *= static_cast<float>(arguments.gain);
        told_of(written.temporary(), arguments.out, [&] {
            write_relit(written.temporary() / outputs[i].filename(), painting, {light}, arguments, relighter,
                        {});
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

// How paint, and under another light all of the painting, is seen.
AppearanceOptions look_of(const RelightArguments& arguments) {
    const Illuminant illuminant = parse_illuminant(arguments.illuminant, "--illuminant");
    const auto model = paint_model_named(arguments.paint_model);
    if (!model)
        throw UsageError(fmt::format("--paint-model {}: is not spectral or thesis", arguments.paint_model));
    return {.illuminant = illuminant, .model = *model};
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
    arguments.drawing.options.model = *model;
    const Progress progress = console_progress();
    arguments.drawing.look = look_of(arguments);
    const RelitPainting painting = open_relit(arguments.painting, arguments.drawing, progress);
    arguments.source = "sha256:" + sha256_of_painting(arguments.painting);
    if (sweeps) return relight_sweep(painting, arguments, progress);
    return one ? relight_one(painting, arguments, progress) : relight_all(painting, arguments, progress);
}

void add_notes(Flags& flags, PictureNotes& notes) {
    flags.option("--title", notes.title, "of the painting, to be kept in pictures; its file's name else");
    flags.option("--creator", notes.creator, "the artist, likewise");
    flags.option("--credit", notes.credit, "year, owner, licence, in a line, likewise");
}

}  // namespace

Command relight_command() {
    return {
        "relight", "show a painting under other lights", [](Flags& flags) {
            auto a = std::make_shared<RelightArguments>();
            a->drawing.options.cast_shadows = true;  // as the photographs have them
            flags.option("PAINTING", a->painting, "painting (.exr, or .tangi, a folder)").required();
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
                "--residual", a->drawing.with_residual,
                "add what the photographs showed beyond the surface, where no paint lies; where not said, "
                "if the painting has such a residual, and shadows, model, light radius and illuminant are "
                "those that it was fitted with");
            flags.flag("--gpu", a->drawing.gpu,
                       "draw with OpenGL, without a window; where that cannot be, as without it");
            flags.fields(a->drawing.options);
            add_notes(flags, a->notes);
            return [a] { return run_relight(*a); };
        }};
}

}  // namespace tangi
