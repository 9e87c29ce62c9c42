#include "capture/sphere_lights/sphere_calibration.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x3.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <tuple>

#include "capture/photo/rejected_photo.h"
#include "capture/sphere_lights/sphere_lights.h"
#include "capture/spheres/sphere_outline.h"
#include "capture/spheres/sphere_sizes.h"
#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

static SphereCalibration calibrated(const PhotoSet& set, const SphereCalibrationOptions& options, bool shaded,
                                    const Progress& progress);

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kPoorDirection = 3;  // [deg] median standard error that makes the result poor
// [px] rms motion from which on a camera that is said to be fixed makes the result poor: a highlight of a
// sphere of 60 pixels radius then tells a direction that is off by a degree.
constexpr double kPoorMotion_px = 0.5;

// [1] From which on explained_by_lights() says that no camera moved: of 16 photographs and a motion that has
// nothing to do with lights it is 0.13 on average.
constexpr double kShading = 0.7;

SphereCamera camera_of(const SphereCalibrationOptions& options, int width, int height) {
    SphereCamera camera;
    camera.principal_px = options.principal_px.value_or(dvec2((width - 1) / 2.0, (height - 1) / 2.0));
    if (options.focal_px && options.focal_35mm) fail("give either --focal-px or --focal-35mm, not both");
    camera.focal_px = options.focal_px;
    if (options.focal_35mm)
        camera.focal_px = *options.focal_35mm / std::hypot(36.0, 24.0) * std::hypot(width, height);
    return camera;
}

// What is said where no mirror sphere is found, but something round is shaded as a matt one is.
std::string matt_hint(const SphereCalibration& c, const PhotoSet& set, const GreyPhotos& photos,
                      const SphereCalibrationOptions& options) {
    const std::optional<DiffuseSphere> matt =
        clear_diffuse_sphere({set, photos, c.drifts, c.camera, options.spheres}, options.transfer);
    if (!matt) return {};
    const SphereImage& at = matt->sphere.image;
    return fmt::format(
        "; something round at ({:.0f}, {:.0f}), {:.0f} pixels in radius, is shaded as a matt (grey or white) "
        "sphere is: "
        "add --diffuse-sphere if it is one",
        at.centre_px.x, at.centre_px.y, at.radius_px);
}

// With a hint at what else may be in the photographs.
SphereSearch find_spheres(SphereCalibration& c, const PhotoSet& set, const GreyPhotos& photos,
                          const SphereCalibrationOptions& options, const Progress& progress) {
    try {
        return find_mirror_spheres({set, photos, c.drifts, c.camera, options.spheres},
                                   expected_radius_px(options, c.width, c.height), progress);
    } catch (const NoSphereError& error) {
        throw NoSphereError(error.what() + matt_hint(c, set, photos, options));
    } catch (const Error& error) {
        throw Error(error.what() + matt_hint(c, set, photos, options));
    }
}

void calibrate_mirror(SphereCalibration& c, const PhotoSet& set, const GreyPhotos& photos,
                      const SphereCalibrationOptions& options, const Progress& progress) {
    SphereSearch search = find_spheres(c, set, photos, options, progress);
    c.spheres = std::move(search.spheres);
    c.warnings.insert(c.warnings.end(), search.warnings.begin(), search.warnings.end());
    c.poor.insert(c.poor.end(), search.poor.begin(), search.poor.end());
    c.method = c.spheres.size() > 1 ? "mirror spheres" : "mirror sphere";
    report(progress, "positions", 0);
    const FocalVerdict verdict = find_focal_length(c, options);
    lights_from_spheres(c, options, verdict);
    report(progress, "positions", 1);
    if (c.spheres.size() == 1 && options.sphere_radius_mm && !options.camera_distance_mm)
        c.warnings.push_back(
            "one sphere tells directions, not positions; --sphere-radius-mm says nothing here");
    if (c.residual_sigma > 4)
        c.warnings.push_back(fmt::format(
            "the spheres disagree: their highlights lie {:.1f} pixels from where the lights should "
            "show, {:.0f} times what was expected; are all spheres of the same radius?",
            c.residual_px, c.residual_sigma));
}

// What a diffuse sphere shows of the lights to an ideal camera that never moved. It is shaded all over, so
// that, unlike a mirror's, its whole outline must be right; it is told in the photographs' own pixels all the
// same.
std::vector<std::optional<MattShading>> shaded_without(const Lens& lens, const DiffuseSphere& matt,
                                                       const SphereCamera& camera) {
    SphereView ideal = view_of(matt.sphere, lens);
    const SphereCrops& seen = matt.sphere.crops;
    const double reach = 1.4 * ideal.image.radius_px;
    const dvec2 low = ideal.image.centre_px - reach, high = ideal.image.centre_px + reach;
    SphereCrops crops{.region = {static_cast<int>(low.x), static_cast<int>(low.y),
                                 static_cast<int>(high.x) + 1, static_cast<int>(high.y) + 1},
                      .photos = {},
                      .drift = std::vector<CameraMotion>(seen.photos.size()),
                      .picture_centre = seen.picture_centre,
                      .step = seen.step};
    const int width = crops.region.x1 - crops.region.x0, height = crops.region.y1 - crops.region.y0;
    crops.photos.assign(seen.photos.size(), Image<float>(width, height));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const dvec2 place = distorted(lens, dvec2(crops.region.x0 + x, crops.region.y0 + y));
            for (std::size_t i = 0; i < seen.photos.size(); ++i)
                crops.photos[i](x, y) = seen.value(i, seen.to_photo(i, place));
        }
    const auto outline =
        matt.sphere.outline_coverage > 0 ? refine_outline(crops, ideal.image, camera) : std::nullopt;
    if (outline) ideal.image = outline->sphere;
    std::vector<std::optional<MattShading>> shadings;
    for (std::size_t i = 0; i < seen.photos.size(); ++i)
        shadings.push_back(shading_of(crops, i, ideal.image, camera, matt.transfer));
    return shadings;
}

void calibrate_diffuse(SphereCalibration& c, const PhotoSet& set, const GreyPhotos& photos,
                       const SphereCalibrationOptions& options, const Progress& progress) {
    DiffuseSphere matt =
        find_diffuse_sphere({set, photos, c.drifts, c.camera, options.spheres}, options.transfer, progress);
    c.method = "diffuse sphere";
    c.matt_transfer = matt.transfer;
    c.warnings.insert(c.warnings.end(), matt.warnings.begin(), matt.warnings.end());
    c.poor.insert(c.poor.end(), matt.poor.begin(), matt.poor.end());
    c.spheres.push_back(matt.sphere);
    const FocalVerdict verdict = find_focal_length(c, options);
    matt.sphere = c.spheres.front();
    if (options.lens)
        matt.photos = shaded_without(*options.lens, matt, c.camera);
    else
        for (std::size_t i = 0; i < set.size(); ++i)
            matt.photos[i] = shading_of(matt.sphere.crops, i, matt.sphere.image, c.camera, matt.transfer);
    c.shadings = std::move(matt.photos);
    const SphereView view = view_of(c.spheres.front(), options.lens);
    tell_of_focal_length(c, {view}, verdict);
    const double turned_deg = 180 / std::numbers::pi * turned_by_focal_length(view, c.camera, verdict);
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        CalibratedLight& light = c.lights[i];
        if (c.shadings[i]) {
            light.spheres_used = 1;
            keep_direction(light, c.shadings[i]->direction, c.shadings[i]->sigma_rad);
            light.direction_sigma_deg = std::hypot(light.direction_sigma_deg, turned_deg);
        } else {
            light.reason = "too little of the diffuse sphere is lit";
        }
        if (!light.direction) c.warnings.push_back(fmt::format("{}: rejected: {}", light.name, light.reason));
    }
    add_parallax(c, view);
}

// What the user says of the camera is measured all the same. Photographs are then taken as they are.
void check_fixed_camera(SphereCalibration& c, const PhotoSet& set) {
    const CameraMotions measured = c.drifts;
    c.drifts = {.photos = std::vector<CameraMotion>(set.size())};
    if (!measured.moved) return;
    const dvec2 centre((c.width - 1) / 2.0, (c.height - 1) / 2.0);
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < set.size(); ++i)
        if (measured.photos[i].displacement_px(centre) > measured.photos[farthest].displacement_px(centre))
            farthest = i;
    std::string doubt = fmt::format(
        "--fixed-camera says that the camera stood still, but the photographs' edges moved by {:.2f} pixels "
        "(rms), those of {} by {:.2f} from the first: leave --fixed-camera out, and places of highlights are "
        "corrected for it",
        measured.rms_px, set.name(farthest), measured.photos[farthest].displacement_px(centre));
    (measured.rms_px > kPoorMotion_px ? c.poor : c.warnings).push_back(std::move(doubt));
}

}  // namespace

void require_same_subject(const PhotoSet& photos, const CameraMotions& drifts) {
    std::vector<double> agreements;
    for (const CameraMotion& drift : drifts.photos) agreements.push_back(drift.agreement);
    for (std::size_t i = 0; i < drifts.photos.size(); ++i)
        if (drifts.photos[i].strange)
            fail_photo(photos.path(i),
                       "shows something else than the other photographs: of the edges that these agree on "
                       "(correlation {:.2f}) it has no more than by chance ({:.2f})",
                       median(agreements), drifts.photos[i].agreement);
}

int SphereCalibration::calibrated() const {
    return static_cast<int>(
        std::count_if(lights.begin(), lights.end(), [](const auto& l) { return l.direction.has_value(); }));
}

std::vector<Light> SphereCalibration::usable_lights() const {
    std::vector<Light> result;
    for (const CalibratedLight& light : lights) {
        if (!light.direction) continue;
        result.push_back(light.position_mm ? near_light(Vec3(*light.position_mm), light.name)
                                           : distant_light(Vec3(*light.direction), light.name));
    }
    return result;
}

std::optional<double> expected_radius_px(const SphereCalibrationOptions& options, int width, int height) {
    if (!options.sphere_radius_mm) return std::nullopt;
    const double radius_mm = *options.sphere_radius_mm;
    std::optional<double> focal_px = options.focal_px;
    if (options.focal_35mm)
        focal_px = *options.focal_35mm / std::hypot(36.0, 24.0) * std::hypot(width, height);
    if (focal_px && options.camera_distance_mm) {
        const double depth_mm = *options.camera_distance_mm - options.sphere_height_mm.value_or(radius_mm);
        if (depth_mm > radius_mm) return *focal_px * radius_mm / depth_mm;
    }
    if (options.mm_per_pixel) return radius_mm / *options.mm_per_pixel;
    return std::nullopt;
}

SphereCalibration without_spheres(const PhotoSet& set, const SphereCalibrationOptions& options) {
    SphereCalibration c;
    const PhotoHeader header = set.open(0).header();
    c.width = header.width;
    c.height = header.height;
    c.camera = camera_of(options, c.width, c.height);
    c.origin_px = options.origin_px.value_or(dvec2((c.width - 1) / 2.0, (c.height - 1) / 2.0));
    for (std::size_t i = 0; i < set.size(); ++i)
        c.lights.push_back({.path = set.path(i), .name = set.name(i), .reason = "no sphere was looked for"});
    c.drifts.photos.resize(set.size());
    c.method = "none";
    if (c.camera.focal_px && options.camera_distance_mm) {
        c.mm_per_pixel = *options.camera_distance_mm / *c.camera.focal_px;
        const dvec2 axis = (c.camera.principal_px - c.origin_px) * dvec2(1, -1) * *c.mm_per_pixel;
        c.camera_position_mm = dvec3(axis, *options.camera_distance_mm);
    }
    return c;
}

namespace {

// [1] Part of what photographs moved by that is a linear function of (l.x, l.y) of their lights: a relief
// shades its edges on the side that is away from the light, and so they wander with it, which a hand-held
// camera does not. 0 of fewer than 8.
double explained_by_lights(const SphereCalibration& c) {
    constexpr int fewest = 8;
    std::vector<dvec3> rows;
    std::vector<dvec2> shifts;
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        if (!c.lights[i].direction) continue;
        rows.emplace_back(1, dvec2(*c.lights[i].direction));
        shifts.push_back(c.drifts.photos[i].shift_px);
    }
    if (static_cast<int>(rows.size()) < fewest) return 0;
    glm::dmat3 normal(0);
    glm::dmat2x3 right(0);  // a column for each coordinate
    dvec2 mean(0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        normal += glm::outerProduct(rows[i], rows[i]);
        right[0] += shifts[i].x * rows[i];
        right[1] += shifts[i].y * rows[i];
        mean += shifts[i] / static_cast<double>(rows.size());
    }
    if (!(glm::determinant(normal) > 1e-9)) return 0;
    const glm::dmat3 inverse = glm::inverse(normal);
    const dvec3 x = inverse * right[0], y = inverse * right[1];
    double all = 0, left = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const dvec2 off = shifts[i] - dvec2(glm::dot(rows[i], x), glm::dot(rows[i], y)),
                    from = shifts[i] - mean;
        all += glm::dot(from, from);
        left += glm::dot(off, off);
    }
    return all > 0 ? 1 - left / all : 0;
}

}  // namespace

SphereCalibration calibrate_from_spheres(const PhotoSet& set, const SphereCalibrationOptions& options,
                                         const Progress& progress) {
    SphereCalibration c = calibrated(set, options, false, progress);
    if (options.fixed_camera || !c.drifts.moved || explained_by_lights(c) < kShading) return c;
    return calibrated(set, options, true, progress);
}

// `shaded`: the camera stood still, and edges move with the lights.
static SphereCalibration calibrated(const PhotoSet& set, const SphereCalibrationOptions& options, bool shaded,
                                    const Progress& progress) {
    const GreyPhotos photos = read_grey_photos(set, progress);
    SphereCalibration c;
    c.width = photos.width;
    c.height = photos.height;
    c.camera = camera_of(options, c.width, c.height);
    c.sphere_radius_mm = options.sphere_radius_mm;
    c.origin_px = options.origin_px.value_or(dvec2((c.width - 1) / 2.0, (c.height - 1) / 2.0));
    for (std::size_t i = 0; i < set.size(); ++i)
        c.lights.push_back({.path = set.path(i), .name = set.name(i)});
    c.drifts.photos.resize(set.size());
    c.drifts = find_camera_motions(photos, progress);
    require_same_subject(set, c.drifts);
    if (options.fixed_camera)
        check_fixed_camera(c, set);
    else if (shaded)
        c.drifts = {.photos = std::vector<CameraMotion>(set.size())};
    else if (c.drifts.moved)
        c.warnings.push_back(
            fmt::format("the camera moved by {:.2f} pixels (rms) from photograph to photograph; places of "
                        "highlights are corrected for it",
                        c.drifts.rms_px));
    if (options.matt)
        calibrate_diffuse(c, set, photos, options, progress);
    else
        calibrate_mirror(c, set, photos, options, progress);
    if (c.calibrated() == 0) {
        std::string doubts;
        for (const std::string& doubt : c.poor) doubts += "; " + doubt;
        fail("{}: the sphere{} in the photographs tell{} no light: {}{}", set.folder().string(),
             c.spheres.size() > 1 ? "s" : "", c.spheres.size() > 1 ? "" : "s", c.lights.front().reason,
             doubts);
    }
    std::vector<double> sigmas;
    for (const CalibratedLight& light : c.lights)
        if (light.direction) sigmas.push_back(light.direction_sigma_deg);
    if (median(sigmas) > kPoorDirection)
        c.poor.push_back(
            fmt::format("the directions are uncertain by {:.1f} degrees (median)", median(sigmas)));
    if (2 * c.calibrated() < static_cast<int>(set.size()))
        c.poor.push_back(fmt::format("only {} of {} photographs have a light", c.calibrated(), set.size()));
    return c;
}

}  // namespace tangi
