#include "fit/steps/plan_file.h"

#include <algorithm>

#include "capture/stack/profile_colours.h"
#include "fit/steps/block_file.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"
#include "surface/maps/photography_json.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr const char* kFormat = "tangipaint fit plan 1";

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

template <class T>
std::span<const T> span_of(const Image<T>& image) {
    return image.pixels();
}

// Calls visit(name, map) for each map of the first fit.
template <class First, class Visit>
void each_map(First& first, const Visit& visit) {
    auto& surface = first.result.surface;
    auto& errors = first.result.errors;
    visit("height", surface.height_mm);
    visit("normal", surface.normal);
    visit("diffuse", surface.diffuse);
    visit("specular", surface.specular);
    visit("roughness", surface.roughness);
    visit("confidence", surface.confidence);
    visit("specular_colour", surface.specular_colour);
    visit("lobe_axes", surface.lobe_axes);
    visit("error.slope", errors.slope);
    visit("error.diffuse", errors.diffuse);
    visit("error.specular", errors.specular);
    visit("error.roughness", errors.roughness);
    visit("occluded", first.occluded);
}

// The lights as the camera sees them, with the motions that they were seen through.
Photography camera_of(const FitPlan& plan) {
    Photography camera;
    camera.transfer = plan.transfer;
    camera.white_level = plan.lighting.white_level;
    camera.rig = plan.lighting.rig;
    for (std::size_t i = 0; i < plan.stack.photos.size(); ++i)
        camera.photos.push_back({plan.lighting.lights[i], true, plan.stack.photos[i].homography});
    return camera;
}

json survey_of(const Survey& survey) {
    json photos = json::array();
    for (const Survey::Photo& photo : survey.photos)
        photos.push_back({{"mean", photo.mean},
                          {"maximum", photo.maximum},
                          {"at_maximum", photo.at_maximum},
                          {"clipped", photo.clipped},
                          {"present", photo.present},
                          {"without_number", photo.without_number},
                          {"transparent", photo.transparent}});
    return {{"channels", survey.channels}, {"photographs", photos}};
}

Survey survey_from(const json& j, const BlockFile& maps) {
    Survey survey;
    survey.channels = j.at("channels");
    for (const json& photo : j.at("photographs"))
        survey.photos.push_back({photo.at("mean"), photo.at("maximum"), photo.at("at_maximum"),
                                 photo.at("clipped"), photo.at("present"), photo.at("without_number"),
                                 photo.at("transparent")});
    survey.positions = maps.get<glm::ivec2>("survey.positions");
    survey.values = maps.get<float>("survey.values");
    survey.ranks = maps.get<std::uint32_t>("survey.ranks");
    return survey;
}

json first_of(const FitPlan& plan) {
    const FitReport& report = plan.first.result.report;
    const Plane& plane = plan.first.plane;
    return {{"reduction", plan.first.reduction},
            {"width", plan.first.result.surface.width()},
            {"height", plan.first.result.surface.height()},
            {"plane", {plane.a, plane.b, plane.c}},
            {"median_residual_sigma", report.median_rms_residual},
            {"best_residual_sigma", report.misfit.best_explained},
            {"specular_colour_pixels", report.coloured},
            {"anisotropic_pixels", report.anisotropic}};
}

json painting_of(const FitPlan& plan) {
    const Surface& described = plan.described;
    const ColourReport& colour = plan.first.result.report.colour;
    return {{"mm_per_pixel", described.mm_per_pixel},
            {"scale_known", described.scale_known},
            {"diffuse_roughness", described.reflectance_model.diffuse_roughness},
            {"second_lobe_weight", described.reflectance_model.second_lobe_weight},
            {"photography", to_json(described.photography)},
            {"colour_by_profile", colour.by_profile},
            {"white_by_chart", colour.white_by_chart},
            {"light_radius_deg", plan.first.result.report.light_angular_radius.deg}};
}

Surface described_by(const json& painting) {
    Surface described;
    described.mm_per_pixel = painting.at("mm_per_pixel");
    described.scale_known = painting.at("scale_known");
    described.reflectance_model = {.diffuse_roughness = painting.at("diffuse_roughness"),
                                   .second_lobe_weight = painting.at("second_lobe_weight")};
    described.photography = photography_from_json(painting.at("photography"));
    return described;
}

FirstFit first_from(const json& j, const json& painting, const Surface& described, const BlockFile& maps) {
    FirstFit first;
    first.reduction = j.at("reduction");
    first.plane = {j.at("plane").at(0), j.at("plane").at(1), j.at("plane").at(2)};
    const int width = j.at("width"), height = j.at("height");
    first.result.surface = Surface(width, height);
    Surface& surface = first.result.surface;
    surface.mm_per_pixel = described.mm_per_pixel * first.reduction;
    surface.scale_known = described.scale_known;
    surface.reflectance_model = described.reflectance_model;
    surface.photography = described.photography;
    each_map(first, [&](const std::string& name, auto& map) {
        using Map = std::decay_t<decltype(map)>;
        if (!maps.has(name)) return;
        map = Map(width, height);
        maps.copy(name, map.pixels());
    });
    FitReport& report = first.result.report;
    report.refined = true;
    report.median_rms_residual = j.at("median_residual_sigma");
    report.misfit.best_explained = j.at("best_residual_sigma");
    report.coloured = j.at("specular_colour_pixels");
    report.anisotropic = j.at("anisotropic_pixels");
    report.colour.by_profile = painting.at("colour_by_profile");
    report.colour.white_by_chart = painting.at("white_by_chart");
    report.light_angular_radius.deg = painting.at("light_radius_deg");
    return first;
}

}  // namespace

std::filesystem::path maps_of_plan(const std::filesystem::path& plan) {
    return std::filesystem::path(plan).replace_extension(".maps");
}

void write_plan(const FitPlan& plan, json told, AtomicFile& json_file, AtomicFile& maps_file) {
    BlocksToWrite blocks;
    each_map(plan.first, [&](const std::string& name, const auto& map) {
        if (!map.empty()) blocks.add(name, span_of(map));
    });
    blocks.add("survey.positions", std::span(plan.survey.positions));
    blocks.add("survey.values", std::span(plan.survey.values));
    blocks.add("survey.ranks", std::span(plan.survey.ranks));
    const Stack& stack = plan.stack;
    json numbers = json::array();
    for (const StackPhoto& photo : stack.photos) numbers.push_back(photo.number);
    told["format"] = kFormat;
    told["software"] = version();
    told["width"] = stack.width();
    told["height"] = stack.height();
    told["photographs"] = {{"numbers", numbers},
                           {"bits", stack.bits},
                           {"full_scale", stack.full_scale},
                           {"float_codes", stack.float_codes}};
    told["white_level"] = or_null(plan.white_level);
    told["camera"] = to_json(camera_of(plan));
    told["painting"] = painting_of(plan);
    told["survey"] = survey_of(plan.survey);
    told["first"] = first_of(plan);
    blocks.write({{"maps_of", stack.folder.filename().string()}}, maps_file);
    told["maps_sha256"] = sha256_of_file(maps_file.temporary());
    told["sha256"] = sha256_of(json_line(told));
    json_file.write(json_lines(told));
}

PlanFile::PlanFile(std::filesystem::path path) : path_(std::move(path)) {
    const std::string text = read_text_file(path_);
    json_ = read_json(text, path_.string());
    if (!json_.is_object() || json_.value("format", "") != kFormat)
        fail("{}: is no plan of a fit; make one: tangipaint fit PHOTOS --plan {}", path_.string(),
             path_.string());
    const json stored = json_.value("sha256", json()), by_whom = json_.value("software", json());
    json_.erase("sha256");
    if (stored != sha256_of(json_line(json_)) || !by_whom.is_string())
        fail(
            "{}: is damaged, or was changed: it is not what its hash (sha256) is of; copy it again, or make "
            "the plan again",
            path_.string());
    if (const auto by = by_whom.get<std::string>(); by != version())
        fail(
            "{}: was made by tangipaint {}, this is {}: make the plan again, so that all tiles are of one "
            "program",
            path_.string(), by, version());
    sha256_ = sha256_of(text);
}

int PlanFile::width() const { return json_.at("width"); }
int PlanFile::height() const { return json_.at("height"); }
int PlanFile::tile_pixels() const { return json_.at("tile_pixels"); }

// Those that the plan uses, in its order, as it found them.
void PlanFile::take_photographs(Stack& stack) const {
    const json& known = json_.at("photographs");
    const Photography camera = photography_from_json(json_.at("camera"));
    std::vector<StackPhoto> photos;
    for (std::size_t i = 0; i < camera.photos.size(); ++i) {
        const int number = known.at("numbers").at(i);
        const auto found = std::ranges::find(stack.photos, number, &StackPhoto::number);
        if (found == stack.photos.end() || valid_utf8(found->light.name) != camera.photos[i].light.name)
            fail(
                "{}: photograph {} of the plan, {}, is no longer what it was: make the plan again, or bring "
                "it back",
                stack.folder.string(), number, camera.photos[i].light.name);
        photos.push_back(*found);
        photos.back().homography = camera.photos[i].homography;
    }
    stack.photos = std::move(photos);
    stack.bits = known.at("bits");
    stack.full_scale = known.at("full_scale");
    stack.float_codes = known.at("float_codes");
    if (stack.width() != width() || stack.height() != height())
        fail("{}: the photographs are {} x {}, those of the plan {} were {} x {}; make the plan again",
             stack.folder.string(), stack.width(), stack.height(), path_.string(), width(), height());
}

FitPlan PlanFile::plan(Stack opened) const {
    try {
        const std::filesystem::path file = maps_of_plan(path_);
        if (sha256_of_file(file) != json_.at("maps_sha256").get<std::string>())
            fail("{}: is not of the plan {}; make the plan again", file.string(), path_.string());
        const BlockFile maps(file);
        take_photographs(opened);
        if (!opened.colour) opened.colour = colour_of_profiles(opened);
        const Photography camera = photography_from_json(json_.at("camera"));
        FitPlan plan{.stack = std::move(opened)};
        plan.transfer = camera.transfer;
        plan.lighting = {.lights = {}, .rig = camera.rig, .white_level = camera.white_level};
        for (const Photography::Photo& photo : camera.photos) plan.lighting.lights.push_back(photo.light);
        plan.survey = survey_from(json_.at("survey"), maps);
        plan.described = described_by(json_.at("painting"));
        if (!json_.at("white_level").is_null()) plan.white_level = json_.at("white_level").get<double>();
        plan.first = first_from(json_.at("first"), json_.at("painting"), plan.described, maps);
        for (const StackPhoto& photo : plan.stack.photos)
            plan.first.result.report.photo_names.push_back(photo.light.name);
        return plan;
    } catch (const nlohmann::json::exception& error) {
        fail("{}: {}; make the plan again", path_.string(), why_wrong_field(error));
    }
}

}  // namespace tangi
