// relight_command.cpp: tangipaint relight PAINTING.exr --light X,Y,Z --out IMAGE, or --lights FILE.lp --out
// DIR
#include <algorithm>
#include <filesystem>
#include <set>

#include "capture/lights_file.h"
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "fit/compare.h"
#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/painting_file.h"
#include "surface/picture_file.h"
#include "surface/relight.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct RelightArguments {
    std::string painting, out, lights_file, encoding, model = "bounded";
    std::vector<std::string> directions, positions;
    double gain = 1;
    RelightOptions options;
};

struct Encoding {
    Transfer transfer;
    float exposure = 1;  // multiplies the linear picture
};

Encoding encoding_of(const RelightArguments& arguments, const Surface& surface, const fs::path& picture) {
    const float white = static_cast<float>(surface.photography.white_level);
    if (!arguments.encoding.empty()) {
        const auto transfer = transfer_named(arguments.encoding);
        if (!transfer)
            throw UsageError(fmt::format("--encoding {}: is not srgb, linear, or a gamma in [0.2, 5]",
                                         arguments.encoding));
        return {*transfer, white};
    }
    std::string extension = picture.extension().string();
    if (extension == ".exr" || extension == ".EXR") return {Transfer{}, white};
    if (surface.photography.photos.empty()) return {Transfer{Transfer::Kind::srgb}, white};
    return {surface.photography.transfer, white};
}

void write_relit(const fs::path& path, const Surface& surface, const std::vector<Light>& lights,
                 const RelightArguments& arguments, const Progress& progress) {
    const Encoding encoding = encoding_of(arguments, surface, path);
    Image<Rgb> picture = relight(surface, lights, arguments.options, progress);
    for (Rgb& pixel : picture.pixels()) pixel *= encoding.exposure;
    write_picture(path, picture, encoding.transfer);
}

nlohmann::json relight_one(const Surface& surface, const RelightArguments& arguments,
                           const Progress& progress) {
    require_picture_format(arguments.out);
    std::vector<Light> lights;
    for (const std::string& text : arguments.directions) {
        const Vec3 v = parse_vector(text, "--light");
        if (!(glm::length(v) > 1e-6f))
            throw UsageError(fmt::format("--light {}: a direction cannot be zero", text));
        lights.push_back(distant_light(v));
    }
    for (const std::string& text : arguments.positions) {
        const Vec3 v = parse_vector(text, "--point-light");
        if (!(v.z > 0))
            throw UsageError(
                fmt::format("--point-light {}: z must be positive, in front of the painting", text));
        lights.push_back(near_light(v));
    }
    for (Light& light : lights) light.gain = Rgb(static_cast<float>(arguments.gain));
    write_relit(arguments.out, surface, lights, arguments, progress);
    return {{"pictures", {arguments.out}}};
}

nlohmann::json relight_all(const Surface& surface, const RelightArguments& arguments,
                           const Progress& progress) {
    const LightsFile file = read_lights_file(arguments.lights_file);
    nlohmann::json warnings = told(file.warnings);
    std::vector<fs::path> outputs;
    std::set<fs::path> seen;
    for (const Light& light : file.lights) {
        std::string name = light.name;
        std::replace(name.begin(), name.end(), '\\', '/');
        outputs.push_back(fs::path(arguments.out) / (fs::path(name).stem().string() + ".png"));
        if (!seen.insert(outputs.back()).second)
            fail("{}: two photographs have the stem '{}', so their relit pictures would be one file",
                 arguments.lights_file, outputs.back().stem().string());
    }
    make_folder(arguments.out);
    nlohmann::json pictures = nlohmann::json::array();
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        // As strong, and as near, as it was estimated for the photograph of its name.
        const Light light = as_photographed(file.lights[i], surface.photography);
        write_relit(outputs[i], surface, {light}, arguments, {});
        pictures.push_back(outputs[i].string());
        report(progress, "relight", static_cast<double>(i + 1) / static_cast<double>(outputs.size()));
    }
    return {{"pictures", pictures}, {"warnings", warnings}};
}

nlohmann::json run_relight(RelightArguments arguments) {
    const bool one = !arguments.directions.empty() || !arguments.positions.empty();
    if (one == !arguments.lights_file.empty())
        throw UsageError(
            "give either lights (--light X,Y,Z, --point-light X,Y,Z) or a lights file (--lights FILE.lp)");
    const auto model = ward_model_named(arguments.model);
    if (!model)
        throw UsageError(fmt::format("--model {}: is not ward1992, duer or bounded", arguments.model));
    arguments.options.model = *model;
    const Progress progress = console_progress();
    const Surface surface = read_painting(arguments.painting, progress);
    return one ? relight_one(surface, arguments, progress) : relight_all(surface, arguments, progress);
}

}  // namespace

Command relight_command() {
    return {
        "relight", "show a painting under other lights", [](CLI::App& app) {
            auto a = std::make_shared<RelightArguments>();
            a->options.cast_shadows = true;  // as the photographs have them
            app.add_option("PAINTING", a->painting, "painting file (.exr)")->required();
            app.add_option(
                   "--light", a->directions,
                   "direction to a distant light: X,Y,Z, x right, y up, z towards the viewer; may be given "
                   "several times")
                ->allow_extra_args(false);
            app.add_option(
                   "--point-light", a->positions,
                   "position of a near light in mm from the centre: X,Y,Z; may be given several times")
                ->allow_extra_args(false);
            app.add_option("--lights", a->lights_file,
                           "lights file (.lp): one picture for each of its lights");
            app.add_option(
                   "--out", a->out,
                   "picture to write (.png .tif .jpg .exr); with --lights the folder for the pictures")
                ->required();
            app.add_option("--encoding", a->encoding,
                           "srgb, linear or a gamma; where not given, as the photographs were (EXR: linear)");
            app.add_option("--model", a->model, "ward1992, duer or bounded")->capture_default_str();
            app.add_option("--gain", a->gain, "strength of the lights, 1 = as for the photographs")
                ->check(CLI::Range(0.0, 1e4));
            add_fields(app, a->options);
            return [a] { return run_relight(*a); };
        }};
}

}  // namespace tangi
