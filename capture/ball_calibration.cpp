#include "capture/ball_calibration.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <tuple>

#include "capture/ball_outline.h"
#include "surface/error.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kFarthest = 0.5;       // [1] standard error / distance from which on a position is none
constexpr double kWorstDirection = 10;  // [deg] standard error from which on a light is left out
constexpr double kMostBelow = 0.1;      // [1] of a ball's highlights that may come from behind the painting
constexpr double kPoorDirection = 3;    // [deg] median standard error that makes the result poor

BallCamera camera_of(const BallCalibrationOptions& options, int width, int height) {
    BallCamera camera;
    camera.principal_px = options.principal_px.value_or(dvec2((width - 1) / 2.0, (height - 1) / 2.0));
    if (options.focal_px && options.focal_35mm) fail("give either --focal-px or --focal-35mm, not both");
    camera.focal_px = options.focal_px;
    if (options.focal_35mm)
        camera.focal_px = *options.focal_35mm / std::hypot(36.0, 24.0) * std::hypot(width, height);
    return camera;
}

double median_of(std::vector<double> values) {
    if (values.empty()) return 0;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

// From the camera frame to the surface frame: the camera looks straight down on the painting.
struct Frame {
    dvec3 offset{0};  // of the camera frame's origin
    dvec3 to_surface(const dvec3& point) const { return point + offset; }
};

// Needs the balls in mm: with perspective the camera's distance is given, or follows from how deep the balls
// lie and how high they stand.
Frame frame_of(const BallCalibration& c, const BallCalibrationOptions& options,
               const std::vector<dvec3>& centres_mm, double radius_mm, double px_per_mm) {
    const double ball_height = options.ball_height_mm.value_or(radius_mm);
    const dvec2 origin = (c.origin_px - c.camera.principal_px) * dvec2(1, -1);
    if (!c.camera.focal_px) return {dvec3(-origin / px_per_mm, ball_height)};
    double depth = 0;
    for (const dvec3& centre : centres_mm) depth += centre.z / static_cast<double>(centres_mm.size());
    const double distance = options.camera_distance_mm.value_or(ball_height - depth);
    return {dvec3(-origin * (distance / *c.camera.focal_px), distance)};
}

void keep_direction(CalibratedLight& light, const dvec3& direction, double sigma_rad) {
    light.direction_sigma_deg = sigma_rad * kDegrees;
    if (!(direction.z > 0)) {
        light.reason =
            fmt::format("its light comes from below the painting's plane (z = {:.3f})", direction.z);
    } else if (light.direction_sigma_deg > kWorstDirection) {
        light.reason =
            fmt::format("its light's direction is uncertain by {:.0f} degrees", light.direction_sigma_deg);
    } else {
        light.direction = glm::normalize(direction);
        light.reason.clear();
    }
}

// The directions that single balls say, averaged with their weights.
void directions_from_balls(BallCalibration& c) {
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        dvec3 sum(0);
        double weights = 0;
        std::string reasons;
        CalibratedLight& light = c.lights[i];
        for (const FoundBall& ball : c.balls) {
            const Highlight& highlight = ball.highlights[i];
            const auto point = highlight.state == HighlightState::found
                                   ? ball_point(ball.image, c.camera, highlight.place_px)
                                   : std::nullopt;
            if (!point) {
                reasons +=
                    fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", ball.name, reason_of(highlight));
                continue;
            }
            const double sigma =
                direction_sigma(ball.image, c.camera, highlight.place_px, highlight.sigma_px);
            sum += point->mirrored() / (sigma * sigma);
            weights += 1 / (sigma * sigma);
            ++light.balls_used;
        }
        light.reason = reasons;
        if (light.balls_used > 0) keep_direction(light, sum, std::sqrt(1 / weights));
        if (!light.direction)
            c.warnings.push_back(fmt::format("{}: left out: {}", light.name, light.reason));
        else if (!reasons.empty())
            c.warnings.push_back(fmt::format("{}: {}; its light comes from the other ball{} alone",
                                             light.name, reasons, light.balls_used > 1 ? "s" : ""));
    }
}

PositionInput position_input(const BallCalibration& c, const BallCalibrationOptions& options,
                             double radius_mm) {
    PositionInput input{.camera = c.camera, .ball_radius_mm = radius_mm, .balls = {}, .highlights = {}};
    for (const FoundBall& ball : c.balls) input.balls.push_back(ball.image);
    input.highlights.resize(c.lights.size());
    for (std::size_t i = 0; i < c.lights.size(); ++i)
        for (const FoundBall& ball : c.balls) {
            const Highlight& h = ball.highlights[i];
            input.highlights[i].push_back(h.state == HighlightState::found && c.lights[i].direction
                                              ? std::optional(MeasuredHighlight{h.place_px, h.sigma_px})
                                              : std::nullopt);
        }
    // Both known, they say how deep the balls lie, to a tenth of a ball.
    if (options.camera_distance_mm && options.ball_height_mm) {
        input.depth_mm = *options.ball_height_mm - *options.camera_distance_mm;
        input.depth_sigma_mm = 0.05 * radius_mm;
    }
    return input;
}

// Standard error of a direction from that of the position, across it.
double across_sigma(const glm::dmat3& covariance, const dvec3& position) {
    const dvec3 d = glm::normalize(position);
    const double across =
        covariance[0][0] + covariance[1][1] + covariance[2][2] - glm::dot(d, covariance * d);
    return std::sqrt(std::max(across, 0.0) / 2) / glm::length(position);
}

// Lights that one ball alone shows lie on its ray, as far from the origin as the others do.
void directions_at_distance(BallCalibration& c, const Frame& frame, const PositionResult& result,
                            double distance_mm, double radius_mm) {
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        CalibratedLight& light = c.lights[i];
        if (!light.direction || result.lamps[i]) continue;
        for (std::size_t b = 0; b < c.balls.size(); ++b) {
            const Highlight& h = c.balls[b].highlights[i];
            if (h.state != HighlightState::found) continue;
            const auto point = ball_point(c.balls[b].image, c.camera, h.place_px);
            const dvec3 from = frame.to_surface(result.ball_centres_mm[b]) + radius_mm * point->normal,
                        d = point->mirrored();
            const double along = -glm::dot(from, d), across = glm::dot(from, from) - along * along;
            if (distance_mm * distance_mm <= across) continue;
            light.direction =
                glm::normalize(from + (along + std::sqrt(distance_mm * distance_mm - across)) * d);
            // A third of the distance either way.
            light.direction_sigma_deg = std::hypot(
                light.direction_sigma_deg, kDegrees * glm::length(glm::cross(from, d)) / (3 * distance_mm));
            break;
        }
    }
}

// Positions from two balls or more, and directions seen from the origin. Without a known radius all is in
// radii.
void positions_from_balls(BallCalibration& c, const BallCalibrationOptions& options) {
    const double radius_mm = options.ball_radius_mm.value_or(1);
    const PositionResult result = lamp_positions(position_input(c, options, radius_mm));
    double mean_radius_px = 0;
    for (const FoundBall& ball : c.balls)
        mean_radius_px += ball.image.radius_px / static_cast<double>(c.balls.size());
    const double px_per_mm = mean_radius_px / radius_mm;
    const Frame frame = frame_of(c, options, result.ball_centres_mm, radius_mm, px_per_mm);
    if (options.ball_radius_mm) {
        for (const dvec3& centre : result.ball_centres_mm)
            c.ball_centres_mm.push_back(frame.to_surface(centre));
        if (c.camera.focal_px) c.camera_position_mm = frame.offset;
        c.mm_per_pixel = c.camera.focal_px ? frame.offset.z / *c.camera.focal_px : 1 / px_per_mm;
    }
    c.residual_px = result.residual_px;
    c.residual_sigma = result.residual_sigma;
    std::vector<double> distances;
    std::vector<std::string> distant;
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        CalibratedLight& light = c.lights[i];
        if (!light.direction || !result.lamps[i]) {
            if (light.direction && light.balls_used > 1) distant.push_back(light.name);
            continue;
        }
        const LampPosition& lamp = *result.lamps[i];
        const dvec3 position = frame.to_surface(lamp.position_mm);
        keep_direction(light, position, across_sigma(lamp.covariance_mm2, position));
        if (!light.direction) {
            c.warnings.push_back(fmt::format("{}: left out: {}", light.name, light.reason));
            continue;
        }
        for (int k = 0; k < 3; ++k)
            light.position_sigma_mm[k] = std::sqrt(std::max(lamp.covariance_mm2[k][k], 0.0));
        if (glm::length(light.position_sigma_mm) > kFarthest * glm::length(position)) {
            distant.push_back(light.name);
            continue;
        }
        distances.push_back(glm::length(position));
        if (options.ball_radius_mm) light.position_mm = position;
    }
    if (!distances.empty()) directions_at_distance(c, frame, result, median_of(distances), radius_mm);
    if (!distant.empty())
        c.warnings.push_back(
            fmt::format("{} of {} lamps are too far away for the balls to tell how far (the first: {}); "
                        "they have a direction only",
                        distant.size(), c.lights.size(), distant.front()));
    if (!result.converged) c.poor.push_back("the lamps' positions did not converge");
}

// What is no ball, or has another outline, shows bright spots anywhere; lamps stand before the painting, and
// so within 0.71 radii of a ball's middle.
void doubt(BallCalibration& c, const FoundBall& ball) {
    int below = 0;
    for (const Highlight& highlight : ball.highlights) {
        if (highlight.state != HighlightState::found) continue;
        const auto point = ball_point(ball.image, c.camera, highlight.place_px);
        below += point && !(point->mirrored().z > 0);
    }
    if (below >= 2 && below > kMostBelow * ball.highlights_found())
        c.poor.push_back(fmt::format(
            "{}: {} of {} highlights would come from lamps behind the painting; is it a mirror ball, "
            "and is that its outline?",
            ball.name, below, ball.highlights_found()));
}

// Outline and highlights where an ideal camera would have seen them. A ball is small against the picture: the
// distortion moves and enlarges it.
void undistort(FoundBall& ball, const Lens& lens) {
    constexpr double step = 0.5;
    const dvec2 at = ball.image.centre_px;
    const dvec2 across = undistorted(lens, at + dvec2(step, 0)) - undistorted(lens, at - dvec2(step, 0));
    const dvec2 down = undistorted(lens, at + dvec2(0, step)) - undistorted(lens, at - dvec2(0, step));
    const double scale = std::sqrt(std::abs(across.x * down.y - across.y * down.x)) / (2 * step);
    ball.image.centre_px = undistorted(lens, at);
    ball.image.radius_px *= scale;
    ball.image.centre_sigma_px *= scale;
    ball.image.radius_sigma_px *= scale;
    for (Highlight& highlight : ball.highlights) {
        if (highlight.state != HighlightState::found) continue;
        highlight.place_px = undistorted(lens, highlight.place_px);
        highlight.sigma_px *= scale;
    }
}

void calibrate_mirror(BallCalibration& c, const PhotoSet& set, const GreyPhotos& photos,
                      const BallCalibrationOptions& options, const Progress& progress) {
    BallSearch search = find_mirror_balls(set, photos, c.drifts, c.camera, options.balls, progress);
    c.balls = std::move(search.balls);
    c.warnings.insert(c.warnings.end(), search.warnings.begin(), search.warnings.end());
    c.method = c.balls.size() > 1 ? "mirror balls" : "mirror ball";
    for (const FoundBall& ball : c.balls) doubt(c, ball);
    // Balls are told in the photographs' own pixels, whatever lights are found from.
    std::vector<std::pair<BallImage, std::vector<Highlight>>> seen;
    for (FoundBall& ball : c.balls) {
        seen.emplace_back(ball.image, ball.highlights);
        if (options.lens) undistort(ball, *options.lens);
    }
    directions_from_balls(c);
    report(progress, "positions", 0);
    if (c.balls.size() > 1) positions_from_balls(c, options);
    for (std::size_t i = 0; i < seen.size(); ++i) std::tie(c.balls[i].image, c.balls[i].highlights) = seen[i];
    report(progress, "positions", 1);
    if (c.balls.size() == 1 && options.ball_radius_mm)
        c.warnings.push_back("one ball tells directions, not positions; --ball-radius-mm says nothing here");
    if (c.residual_sigma > 4)
        c.warnings.push_back(
            fmt::format("the balls disagree: their highlights lie {:.1f} pixels from where the lamps should "
                        "show, {:.0f} times what was expected; are all balls of the same radius, and is "
                        "the focal length right?",
                        c.residual_px, c.residual_sigma));
}

// What a matt ball shows of the lamps to an ideal camera that never moved. It is shaded all over, so that,
// unlike a mirror's, its whole outline must be right; it is told in the photographs' own pixels all the same.
std::vector<std::optional<MattShading>> shaded_without(const Lens& lens, const MattBall& matt,
                                                       const BallCamera& camera) {
    FoundBall ideal{.image = matt.ball.image, .name = {}, .given = false, .crops = {}};
    undistort(ideal, lens);
    const BallCrops& seen = matt.ball.crops;
    const double reach = 1.4 * ideal.image.radius_px;
    const dvec2 low = ideal.image.centre_px - reach, high = ideal.image.centre_px + reach;
    BallCrops crops{.region = {static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(high.x) + 1,
                               static_cast<int>(high.y) + 1},
                    .photos = {},
                    .drift = std::vector<CameraShake>(seen.photos.size()),
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
    if (const auto outline = refine_outline(crops, ideal.image, camera)) ideal.image = outline->ball;
    std::vector<std::optional<MattShading>> shadings;
    for (std::size_t i = 0; i < seen.photos.size(); ++i)
        shadings.push_back(shading_of(crops, i, ideal.image, camera, matt.transfer));
    return shadings;
}

void calibrate_matt(BallCalibration& c, const PhotoSet& set, const GreyPhotos& photos,
                    const BallCalibrationOptions& options, const Progress& progress) {
    MattBall matt =
        find_matt_ball(set, photos, c.drifts, c.camera, options.balls, options.transfer, progress);
    c.method = "matt ball";
    c.matt_transfer = matt.transfer;
    c.warnings.insert(c.warnings.end(), matt.warnings.begin(), matt.warnings.end());
    if (options.lens) matt.photos = shaded_without(*options.lens, matt, c.camera);
    c.balls.push_back(std::move(matt.ball));
    c.shadings = std::move(matt.photos);
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        CalibratedLight& light = c.lights[i];
        if (c.shadings[i]) {
            light.balls_used = 1;
            keep_direction(light, c.shadings[i]->direction, c.shadings[i]->sigma_rad);
        } else {
            light.reason = "too little of the matt ball is lit";
        }
        if (!light.direction) c.warnings.push_back(fmt::format("{}: left out: {}", light.name, light.reason));
    }
}

}  // namespace

int BallCalibration::calibrated() const {
    return static_cast<int>(
        std::count_if(lights.begin(), lights.end(), [](const auto& l) { return l.direction.has_value(); }));
}

std::vector<Light> BallCalibration::usable_lights() const {
    std::vector<Light> result;
    for (const CalibratedLight& light : lights) {
        if (!light.direction) continue;
        result.push_back(light.position_mm ? near_light(Vec3(*light.position_mm), light.name)
                                           : distant_light(Vec3(*light.direction), light.name));
    }
    return result;
}

BallCalibration without_balls(const PhotoSet& set, const BallCalibrationOptions& options) {
    BallCalibration c;
    const PhotoHeader header = set.open(0).header();
    c.width = header.width;
    c.height = header.height;
    c.camera = camera_of(options, c.width, c.height);
    c.origin_px = options.origin_px.value_or(dvec2((c.width - 1) / 2.0, (c.height - 1) / 2.0));
    for (std::size_t i = 0; i < set.size(); ++i)
        c.lights.push_back({.path = set.path(i), .name = set.name(i), .reason = "no ball was looked for"});
    c.drifts.photos.resize(set.size());
    c.method = "none";
    if (c.camera.focal_px && options.camera_distance_mm) {
        c.mm_per_pixel = *options.camera_distance_mm / *c.camera.focal_px;
        const dvec2 axis = (c.camera.principal_px - c.origin_px) * dvec2(1, -1) * *c.mm_per_pixel;
        c.camera_position_mm = dvec3(axis, *options.camera_distance_mm);
    }
    return c;
}

BallCalibration calibrate_from_balls(const PhotoSet& set, const BallCalibrationOptions& options,
                                     const Progress& progress) {
    const GreyPhotos photos = read_grey_photos(set, progress);
    BallCalibration c;
    c.width = photos.width;
    c.height = photos.height;
    c.camera = camera_of(options, c.width, c.height);
    c.ball_radius_mm = options.ball_radius_mm;
    c.origin_px = options.origin_px.value_or(dvec2((c.width - 1) / 2.0, (c.height - 1) / 2.0));
    for (std::size_t i = 0; i < set.size(); ++i)
        c.lights.push_back({.path = set.path(i), .name = set.name(i)});
    c.drifts.photos.resize(set.size());
    if (!options.fixed_camera) c.drifts = camera_shakes(photos, progress);
    if (c.drifts.moved)
        c.warnings.push_back(
            fmt::format("the camera moved by {:.2f} pixels (rms) from photograph to photograph; places of "
                        "highlights are corrected for it",
                        c.drifts.rms_px));
    if (options.matt)
        calibrate_matt(c, set, photos, options, progress);
    else
        calibrate_mirror(c, set, photos, options, progress);
    if (c.calibrated() == 0)
        fail("{}: the ball{} in the photographs tell{} no light: {}", set.folder().string(),
             c.balls.size() > 1 ? "s" : "", c.balls.size() > 1 ? "" : "s", c.lights.front().reason);
    std::vector<double> sigmas;
    for (const CalibratedLight& light : c.lights)
        if (light.direction) sigmas.push_back(light.direction_sigma_deg);
    if (median_of(sigmas) > kPoorDirection)
        c.poor.push_back(
            fmt::format("the directions are uncertain by {:.1f} degrees (median)", median_of(sigmas)));
    if (2 * c.calibrated() < static_cast<int>(set.size()))
        c.poor.push_back(fmt::format("only {} of {} photographs have a light", c.calibrated(), set.size()));
    return c;
}

}  // namespace tangi
