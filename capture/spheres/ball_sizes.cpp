#include "capture/spheres/ball_sizes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr double kGross = 1.3;  // a ratio of radii beyond which they are not those of the same balls

constexpr double kForeshortened = 0.7;  // [1] cosine of 45 degrees

}  // namespace

double weight_of(const FoundBall& ball) {
    return ball.outline_coverage * ball.highlights_found() /
           std::max(static_cast<double>(ball.highlights.size()), 1.0);
}

bool is_twin_size(double radius_px, double other_px) {
    return radius_px < kTwinSize * other_px && other_px < kTwinSize * radius_px;
}

bool cannot_both_be(const BallImage& a, const BallImage& b) {
    return glm::length(a.centre_px - b.centre_px) < kForeshortened * (a.radius_px + b.radius_px);
}

bool is_of_size(double radius_px, double expected_px) {
    return radius_px < kGross * expected_px && expected_px < kGross * radius_px;
}

void keep_one_size(BallSearch& search, const std::optional<double>& expected_px) {
    std::vector<FoundBall>& balls = search.balls;
    const auto of_size = [](double radius_px) {
        return [radius_px](const FoundBall& ball) { return is_of_size(ball.image.radius_px, radius_px); };
    };
    std::string known_by = "as the numbers that are given say";
    double kept_px = 0, most = 0;
    if (expected_px && std::any_of(balls.begin(), balls.end(), of_size(*expected_px))) {
        kept_px = *expected_px;
    } else {
        known_by = "as those are of which most is seen";
        for (const FoundBall& ball : balls) {
            double weight = 0;
            for (const FoundBall& other : balls)
                if (of_size(ball.image.radius_px)(other)) weight += weight_of(other);
            if (weight > most) most = weight, kept_px = ball.image.radius_px;
        }
    }
    std::erase_if(balls, [&](const FoundBall& ball) {
        if (of_size(kept_px)(ball)) return false;
        const glm::dvec2 at = ball.image.centre_px;
        search.warnings.push_back(fmt::format(
            "something round at ({:.0f}, {:.0f}), {:.1f} pixels in radius, is taken for no mirror ball: "
            "balls are of one size, about {:.1f} pixels, {}; if it is one, give all balls with --sphere, it "
            "with --sphere {:.0f},{:.0f},{:.0f}",
            at.x, at.y, ball.image.radius_px, kept_px, known_by, at.x, at.y, ball.image.radius_px));
        return true;
    });
}

}  // namespace tangi
