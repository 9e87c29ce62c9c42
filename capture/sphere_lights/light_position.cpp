// light_position.cpp: see light_position.h.
#include "capture/sphere_lights/light_position.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "capture/spheres/alhazen.h"
#include "surface/base/error.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

using Vector = std::array<double, 3>;

constexpr double kOnePlane = 0.05;    // [radii] standard error of how deep a sphere lies among the others
constexpr double kSharedError = 0.9;  // [1] of the smallest error of a radius, which all have in common
constexpr double kFarAway = 30;  // [1] of the spheres' distance, where lights start whose rays do not meet
constexpr double kInverseFocal = 1e3;  // the unit of 1 / focal length is 1 / 1000 px

// A camera that looks down the z axis: [0] pixels for a mm at z = 0; [1] / 1000 px is 1 / focal length, with
// 0 it is far away; [2] pixels by which all outlines are seen too large, in standard errors of that.
template <class T>
T inverse_distance(const T* camera) {
    return camera[0] * camera[1] / kInverseFocal;
}

template <class T>
void project(const T* camera, const dvec2& principal_px, const T point[3], T pixel[2]) {
    const T scale = camera[0] / (T(1) - inverse_distance(camera) * point[2]);
    pixel[0] = principal_px.x + scale * point[0];
    pixel[1] = principal_px.y - scale * point[1];
}

// Where the highlight is seen less where it should be, in standard errors.
struct HighlightError {
    dvec2 principal_px;
    double radius_mm;
    MeasuredHighlight seen;

    template <class T>
    bool operator()(const T* light, const T* sphere, const T* camera, T* error) const {
        T normal[3], point[3], pixel[2];
        if (!mirror_normal(sphere, T(radius_mm), light, inverse_distance(camera), normal)) return false;
        for (int i = 0; i < 3; ++i) point[i] = sphere[i] + radius_mm * normal[i];
        project(camera, principal_px, point, pixel);
        error[0] = (pixel[0] - seen.place_px.x) / seen.sigma_px;
        error[1] = (pixel[1] - seen.place_px.y) / seen.sigma_px;
        return true;
    }
};

// What outline and depth say of the sphere, in standard errors.
struct OutlineError {
    dvec2 principal_px;
    double radius_mm;
    SphereImage seen;
    double shared_sigma_px;  // of the radius, the same for all spheres: how a limb fades
    std::optional<Known> depth_mm;

    template <class T>
    bool operator()(const T* sphere, const T* camera, T* error) const {
        T pixel[2];
        project(camera, principal_px, sphere, pixel);
        const double sigma = std::max(seen.centre_sigma_px, 0.02);
        const T relative_inverse_depth = T(1) - inverse_distance(camera) * sphere[2];
        error[0] = (pixel[0] - seen.centre_px.x) / sigma;
        error[1] = (pixel[1] - seen.centre_px.y) / sigma;
        error[2] = (camera[0] * radius_mm / relative_inverse_depth - seen.radius_px) /
                   std::max(seen.radius_sigma_px, 0.02);
        error[3] = sphere[2] / (kOnePlane * radius_mm);
        // 1 / inverse_distance - z - depth, to first order, but finite for a camera far away
        error[4] = depth_mm ? (relative_inverse_depth - inverse_distance(camera) * depth_mm->value) *
                                  depth_mm->value / depth_mm->sigma
                            : T(0);
        return true;
    }
};

struct CameraError {
    Known inverse_focal;  // in units of 1 / kInverseFocal

    template <class T>
    bool operator()(const T* camera, T* error) const {
        error[0] = (camera[1] - inverse_focal.value) / inverse_focal.sigma;
        error[1] = camera[2];
        return true;
    }
};

double mean_radius_px(const PositionInput& input) {
    double radius = 0;
    for (const SphereImage& sphere : input.spheres)
        radius += sphere.radius_px / static_cast<double>(input.spheres.size());
    return radius;
}

// Lights, spheres and camera while they are moved.
struct Scene {
    std::vector<Vector> lights, centres;
    Vector camera{1, 0, 0};
};

// Where the rays of a photograph meet for the camera as it is; far away along them where they do not.
std::optional<dvec3> first_position(const PositionInput& input, const Scene& scene, std::size_t photo) {
    SphereCamera camera = input.camera;
    camera.focal_px.reset();
    if (scene.camera[1] > 0) camera.focal_px = kInverseFocal / scene.camera[1];
    std::vector<LightRay> rays;
    dvec3 origin(0), direction(0);
    for (std::size_t b = 0; b < input.spheres.size(); ++b) {
        const auto& seen = input.highlights[photo][b];
        if (!seen) continue;
        const auto point = sphere_point(input.spheres[b], camera, seen->place_px);
        if (!point) continue;
        const dvec3 centre(scene.centres[b][0], scene.centres[b][1], scene.centres[b][2]);
        rays.push_back({centre + input.sphere_radius_mm * point->normal, point->mirrored(),
                        direction_sigma(input.spheres[b], camera, seen->place_px, seen->sigma_px)});
        origin += rays.back().origin;
        direction += rays.back().direction;
    }
    if (rays.size() < 2 || !(glm::length(direction) > 1e-6)) return std::nullopt;
    if (const auto meet = nearest_point(rays)) return meet;
    double apart = input.sphere_radius_mm;
    for (const LightRay& ray : rays) apart = std::max(apart, glm::length(ray.origin - rays[0].origin));
    return origin / static_cast<double>(rays.size()) + kFarAway * apart * glm::normalize(direction);
}

Scene first_scene(const PositionInput& input, double inverse_focal) {
    Scene scene;
    scene.camera = {mean_radius_px(input) / input.sphere_radius_mm, kInverseFocal * inverse_focal, 0};
    for (const SphereImage& sphere : input.spheres) {
        const dvec2 from = (sphere.centre_px - input.camera.principal_px) / scene.camera[0];
        scene.centres.push_back({from.x, -from.y, 0});
    }
    for (std::size_t photo = 0; photo < input.highlights.size(); ++photo) {
        const dvec3 at = first_position(input, scene, photo).value_or(dvec3(0));
        scene.lights.push_back({at.x, at.y, at.z});
    }
    return scene;
}

// The solver's problem on a scene, which must stay where it is.
class Bundle {
public:
    Bundle(const PositionInput& input, Scene& scene, const Known& inverse_focal, PositionResult& result)
        : input_(input), scene_(scene), result_(result) {
        double* camera = scene.camera.data();
        result.lights.resize(scene.lights.size());
        for (std::size_t photo = 0; photo < scene.lights.size(); ++photo) {
            if (!first_position(input, scene, photo)) continue;
            result.lights[photo].emplace();
            for (std::size_t b = 0; b < input.spheres.size(); ++b)
                if (const auto& seen = input.highlights[photo][b])
                    problem_.AddResidualBlock(
                        new ceres::AutoDiffCostFunction<HighlightError, 2, 3, 3, 3>(
                            new HighlightError{input.camera.principal_px, input.sphere_radius_mm, *seen}),
                        new ceres::HuberLoss(2.5), scene.lights[photo].data(), scene.centres[b].data(),
                        camera);
        }
        if (problem_.NumResidualBlocks() == 0) return;
        double shared_px = 1e9;
        for (const SphereImage& sphere : input.spheres)
            shared_px = std::min(shared_px, kSharedError * sphere.radius_sigma_px);
        for (std::size_t b = 0; b < input.spheres.size(); ++b)
            problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<OutlineError, 5, 3, 3>(
                                          new OutlineError{input.camera.principal_px, input.sphere_radius_mm,
                                                           input.spheres[b], shared_px, input.depth_mm}),
                                      nullptr, scene.centres[b].data(), camera);
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<CameraError, 2, 3>(
                new CameraError{{kInverseFocal * inverse_focal.value, kInverseFocal * inverse_focal.sigma}}),
            nullptr, camera);
        problem_.SetParameterLowerBound(camera, 0, 1e-3 * camera[0]);
        problem_.SetParameterLowerBound(camera, 1, 0);
    }

    void solve() {
        if (problem_.NumResidualBlocks() == 0) return;
        ceres::Solver::Options options;
        options.max_num_iterations = 200;
        options.function_tolerance = 1e-10;
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem_, &summary);
        result_.converged = summary.termination_type == ceres::CONVERGENCE;
        result_.cost = summary.final_cost;
        result_.px_per_mm = scene_.camera[0];
        result_.inverse_focal.value = scene_.camera[1] / kInverseFocal;
    }

    // Covariances of lights and camera, and residuals.
    void judge() {
        if (problem_.NumResidualBlocks() == 0) return;
        const double enlarge = judge_residuals();
        const double* camera = scene_.camera.data();
        std::vector<std::pair<const double*, const double*>> blocks = {{camera, camera}};
        for (std::size_t photo = 0; photo < scene_.lights.size(); ++photo)
            if (result_.lights[photo])
                blocks.emplace_back(scene_.lights[photo].data(), scene_.lights[photo].data());
        ceres::Covariance::Options options;
        options.algorithm_type = ceres::DENSE_SVD;
        options.null_space_rank = -1;
        ceres::Covariance covariance(options);
        result_.converged = result_.converged && covariance.Compute(blocks, &problem_);
        if (!result_.converged) return;
        double of_camera[9] = {};
        covariance.GetCovarianceBlock(camera, camera, of_camera);
        result_.inverse_focal.sigma = std::sqrt(std::max(enlarge * of_camera[4], 0.0)) / kInverseFocal;
        for (std::size_t photo = 0; photo < scene_.lights.size(); ++photo) {
            if (!result_.lights[photo]) continue;
            double block[9] = {};
            const double* light = scene_.lights[photo].data();
            covariance.GetCovarianceBlock(light, light, block);
            for (int i = 0; i < 9; ++i)
                result_.lights[photo]->covariance_mm2[i / 3][i % 3] = enlarge * block[i];
        }
    }

private:
    // Fills the residuals; the factor by which variances are larger than expected.
    double judge_residuals() {
        double weighted = 0, plain = 0;
        int values = 0, unknowns = 0;
        for (std::size_t photo = 0; photo < scene_.lights.size(); ++photo) {
            if (!result_.lights[photo]) continue;
            LocatedLight& light = *result_.lights[photo];
            const Vector& at = scene_.lights[photo];
            double squares = 0;
            int seen_in = 0;
            for (std::size_t b = 0; b < scene_.centres.size(); ++b) {
                const auto& seen = input_.highlights[photo][b];
                if (!seen) continue;
                double error[2] = {};
                HighlightError{input_.camera.principal_px, input_.sphere_radius_mm, *seen}(
                    at.data(), scene_.centres[b].data(), scene_.camera.data(), error);
                const double in_sigma = error[0] * error[0] + error[1] * error[1];
                weighted += in_sigma;
                squares += in_sigma * seen->sigma_px * seen->sigma_px;
                ++seen_in;
            }
            values += 2 * seen_in;
            unknowns += 3;
            plain += squares;
            light.position_mm = {at[0], at[1], at[2]};
            light.residual_px = std::sqrt(squares / (2 * seen_in));
        }
        result_.residual_px = std::sqrt(plain / std::max(values, 1));
        result_.residual_sigma = std::sqrt(weighted / std::max(values - unknowns, 1));
        return std::max(1.0, result_.residual_sigma * result_.residual_sigma);
    }

    const PositionInput& input_;
    Scene& scene_;
    PositionResult& result_;
    ceres::Problem problem_;
};

}  // namespace

std::optional<dvec3> nearest_point(std::span<const LightRay> rays) {
    std::vector<double> weights;
    for (const LightRay& ray : rays) weights.push_back(1 / (ray.sigma_rad * ray.sigma_rad));
    std::optional<dvec3> point;
    for (int turn = 0; turn < 3; ++turn) {
        glm::dmat3 normal(0);
        dvec3 right(0);
        double sum = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const dvec3 d = glm::normalize(rays[i].direction);
            const glm::dmat3 across = weights[i] * (glm::dmat3(1) - glm::outerProduct(d, d));
            normal += across;
            right += across * rays[i].origin;
            sum += weights[i];
        }
        if (!(glm::determinant(normal) > 1e-8 * sum * sum * sum)) return std::nullopt;  // parallel
        point = glm::inverse(normal) * right;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const double distance = glm::dot(*point - rays[i].origin, glm::normalize(rays[i].direction));
            if (!(distance > 0)) return std::nullopt;
            weights[i] = 1 / std::pow(rays[i].sigma_rad * distance, 2);
        }
    }
    return point;
}

PositionResult light_positions(const PositionInput& input) {
    TP_REQUIRE(input.spheres.size() >= 2, "there are two spheres or more");
    const double as_measured = input.camera.focal_px ? 1 / *input.camera.focal_px : 0;
    const Known inverse_focal = input.inverse_focal.value_or(Known{as_measured, 1e-9});
    // Where little is known, the least of several starts: rays of a camera that sees far too narrow do not
    // meet.
    std::vector<double> starts = {inverse_focal.value};
    if (input.inverse_focal)
        for (const double part : {0.5, 1.0, 2.0})
            starts.push_back(inverse_focal.value + part * inverse_focal.sigma);
    std::optional<PositionResult> best;
    for (const double start : starts) {
        Scene scene = first_scene(input, start);
        PositionResult result;
        Bundle bundle(input, scene, inverse_focal, result);
        bundle.solve();
        if (best && !(result.cost < 0.999 * best->cost)) continue;
        bundle.judge();
        for (const Vector& centre : scene.centres)
            result.sphere_centres_mm.push_back({centre[0], centre[1], centre[2]});
        best = std::move(result);
    }
    return *best;
}

}  // namespace tangi
