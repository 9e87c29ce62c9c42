// relief_normals.h: normals of a relief, as fits to lights whose axes are wrong see them.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "fit/light_checks/axis_check_slopes.h"
#include "tests/support/test_support.h"

namespace tangi {

// Normals of bumps of all directions, of slopes of about `steep`, with noise, turned and mirrored afterwards.
struct ReliefNormals {
    Image<Vec3> map{128, 96};
    Image<float> confidence{128, 96, 1};

    ReliefNormals(double steep, double noise, const glm::dmat2& by = glm::dmat2(1)) {
        Random random(7);
        struct Wave {
            double kx, ky, phase;
        };
        std::vector<Wave> waves;
        for (int i = 0; i < 40; ++i) {
            const double k = random.uniform(0.2, 0.9), turn = random.uniform(0, 2 * std::numbers::pi);
            waves.push_back({k * std::cos(turn), k * std::sin(turn), random.uniform(0, 6.28)});
        }
        for (int y = 0; y < map.height(); ++y)
            for (int x = 0; x < map.width(); ++x) {
                glm::dvec2 slope(noise * random.normal(), noise * random.normal());
                for (const Wave& wave : waves) {
                    const double c = steep / 4.5 * std::cos(wave.kx * x - wave.ky * y + wave.phase);
                    slope += c * glm::normalize(glm::dvec2(wave.kx, wave.ky));
                }
                slope = by * slope;
                map(x, y) = glm::normalize(Vec3(glm::dvec3(-slope, 1)));
            }
    }
    SignCheck check() const { return check_signs(map, confidence); }
};

}  // namespace tangi
