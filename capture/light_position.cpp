#include "capture/light_position.h"

#include <ceres/ceres.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "capture/mirror_reflection.h"
#include "surface/error.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

using Vector = std::array<double, 3>;

struct Projection {
    bool perspective = false;
    double focal_px = 1;  // without perspective: pixels for a mm
    dvec2 principal_px{0, 0};

    template <class T>
    void project(const T point[3], T pixel[2]) const {
        const T scale = perspective ? T(focal_px) / -point[2] : T(focal_px);
        pixel[0] = principal_px.x + scale * point[0];
        pixel[1] = principal_px.y - scale * point[1];
    }
};

// Where the highlight is seen less where it should be, in standard errors.
struct HighlightError {
    Projection camera;
    double radius_mm;
    MeasuredHighlight seen;

    template <class T>
    bool operator()(const T* lamp, const T* ball, T* error) const {
        T normal[3], point[3], pixel[2];
        if (!mirror_normal(ball, T(radius_mm), lamp, camera.perspective, normal)) return false;
        for (int i = 0; i < 3; ++i) point[i] = ball[i] + radius_mm * normal[i];
        camera.project(point, pixel);
        error[0] = (pixel[0] - seen.place_px.x) / seen.sigma_px;
        error[1] = (pixel[1] - seen.place_px.y) / seen.sigma_px;
        return true;
    }
};

// What the outline says of the ball, in standard errors.
struct OutlineError {
    Projection camera;
    double radius_mm;
    BallImage seen;
    double depth_mm, depth_sigma_mm;  // sigma 0: not known

    template <class T>
    bool operator()(const T* ball, T* error) const {
        T pixel[2];
        camera.project(ball, pixel);
        const double sigma = std::max(seen.centre_sigma_px, 0.02);
        error[0] = (pixel[0] - seen.centre_px.x) / sigma;
        error[1] = (pixel[1] - seen.centre_px.y) / sigma;
        error[2] = camera.perspective ? (camera.focal_px * radius_mm / -ball[2] - seen.radius_px) /
                                            std::max(seen.radius_sigma_px, 0.02)
                                      : T(0);
        error[3] = depth_sigma_mm > 0 ? (ball[2] - depth_mm) / depth_sigma_mm : T(0);
        return true;
    }
};

Projection projection_of(const PositionInput& input) {
    if (input.camera.focal_px) return {true, *input.camera.focal_px, input.camera.principal_px};
    double radius = 0;
    for (const BallImage& ball : input.balls)
        radius += ball.radius_px / static_cast<double>(input.balls.size());
    return {false, radius / input.ball_radius_mm, input.camera.principal_px};
}

std::vector<Vector> first_centres(const PositionInput& input, const Projection& projection) {
    std::vector<Vector> centres;
    for (const BallImage& ball : input.balls) {
        const dvec3 in_px = centre_in_radius_units(ball, input.camera);
        const double scale =
            projection.perspective ? input.ball_radius_mm / ball.radius_px : 1 / projection.focal_px;
        dvec3 centre = scale * in_px;
        if (projection.perspective && input.depth_mm) centre *= *input.depth_mm / centre.z;
        centres.push_back({centre.x, centre.y, centre.z});
    }
    return centres;
}

std::optional<dvec3> first_position(const PositionInput& input, const std::vector<Vector>& centres,
                                    std::size_t photo) {
    std::vector<LightRay> rays;
    for (std::size_t b = 0; b < input.balls.size(); ++b) {
        const auto& seen = input.highlights[photo][b];
        if (!seen) continue;
        const auto point = ball_point(input.balls[b], input.camera, seen->place_px);
        if (!point) continue;
        const dvec3 centre(centres[b][0], centres[b][1], centres[b][2]);
        rays.push_back({centre + input.ball_radius_mm * point->normal, point->mirrored(),
                        direction_sigma(input.balls[b], input.camera, seen->place_px, seen->sigma_px)});
    }
    return rays.size() < 2 ? std::nullopt : nearest_point(rays);
}

// Covariances of the lamps, and residuals, of a solved problem.
void judge(ceres::Problem& problem, const PositionInput& input, const Projection& projection,
           std::vector<Vector>& lamps, std::vector<Vector>& centres, PositionResult& result) {
    double weighted = 0, plain = 0;
    int values = 0, unknowns = 0;
    std::vector<std::pair<const double*, const double*>> blocks;
    for (std::size_t photo = 0; photo < lamps.size(); ++photo) {
        if (!result.lamps[photo]) continue;
        LampPosition& lamp = *result.lamps[photo];
        double squares = 0;
        int seen_in = 0;
        for (std::size_t b = 0; b < centres.size(); ++b) {
            const auto& seen = input.highlights[photo][b];
            if (!seen) continue;
            double error[2] = {};
            HighlightError{projection, input.ball_radius_mm, *seen}(lamps[photo].data(), centres[b].data(),
                                                                    error);
            const double in_sigma = error[0] * error[0] + error[1] * error[1];
            weighted += in_sigma;
            squares += in_sigma * seen->sigma_px * seen->sigma_px;
            ++seen_in;
        }
        values += 2 * seen_in;
        unknowns += 3;
        plain += squares;
        lamp.position_mm = {lamps[photo][0], lamps[photo][1], lamps[photo][2]};
        lamp.residual_px = std::sqrt(squares / (2 * seen_in));
        blocks.emplace_back(lamps[photo].data(), lamps[photo].data());
    }
    if (values == 0) return;
    result.residual_px = std::sqrt(plain / values);
    result.residual_sigma = std::sqrt(weighted / std::max(values - unknowns, 1));
    const double enlarge = std::max(1.0, result.residual_sigma * result.residual_sigma);
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::DENSE_SVD;
    options.null_space_rank = -1;
    ceres::Covariance covariance(options);
    if (!covariance.Compute(blocks, &problem)) return;
    for (std::size_t photo = 0; photo < lamps.size(); ++photo) {
        if (!result.lamps[photo]) continue;
        double block[9] = {};
        covariance.GetCovarianceBlock(lamps[photo].data(), lamps[photo].data(), block);
        for (int i = 0; i < 9; ++i) result.lamps[photo]->covariance_mm2[i / 3][i % 3] = enlarge * block[i];
    }
}

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

PositionResult lamp_positions(const PositionInput& input) {
    TP_REQUIRE(input.balls.size() >= 2, "there are two balls or more");
    const Projection projection = projection_of(input);
    std::vector<Vector> centres = first_centres(input, projection), lamps(input.highlights.size());
    PositionResult result;
    result.lamps.resize(lamps.size());
    ceres::Problem problem;
    for (std::size_t photo = 0; photo < lamps.size(); ++photo) {
        const auto start = first_position(input, centres, photo);
        if (!start) continue;
        lamps[photo] = {start->x, start->y, start->z};
        result.lamps[photo].emplace();
        for (std::size_t b = 0; b < centres.size(); ++b)
            if (const auto& seen = input.highlights[photo][b])
                problem.AddResidualBlock(new ceres::AutoDiffCostFunction<HighlightError, 2, 3, 3>(
                                             new HighlightError{projection, input.ball_radius_mm, *seen}),
                                         new ceres::HuberLoss(2.5), lamps[photo].data(), centres[b].data());
    }
    if (problem.NumResidualBlocks() > 0) {
        for (std::size_t b = 0; b < centres.size(); ++b) {
            // Without perspective nothing says how deep a ball lies, but that it lies as the others do.
            const bool deep = input.depth_mm.has_value() || !projection.perspective;
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OutlineError, 4, 3>(new OutlineError{
                                         projection, input.ball_radius_mm, input.balls[b],
                                         projection.perspective ? input.depth_mm.value_or(0) : 0,
                                         !deep                    ? 0
                                         : projection.perspective ? input.depth_sigma_mm
                                                                  : 0.02 * input.ball_radius_mm}),
                                     nullptr, centres[b].data());
        }
        ceres::Solver::Options options;
        options.max_num_iterations = 100;
        options.function_tolerance = 1e-10;
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        result.converged = summary.termination_type == ceres::CONVERGENCE;
        judge(problem, input, projection, lamps, centres, result);
    }
    for (const Vector& centre : centres) result.ball_centres_mm.push_back({centre[0], centre[1], centre[2]});
    return result;
}

}  // namespace tangi
