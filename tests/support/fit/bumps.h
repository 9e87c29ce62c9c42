// bumps.h: a matt relief under lights of unequal strength, as a survey of its photographs sees it.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "capture/stack/survey.h"
#include "tests/support/test_support.h"

namespace tangi {

// A matt relief of bumps and dabs of paint, of slopes of about `steep`, under 16 lights of unequal strength.
struct Bumps {
    static constexpr int kWidth = 320, kHeight = 240;
    std::vector<Light> lights;
    Survey survey;

    // Lights on a spiral, each 2.4 radians on and lower. `same_side`: the second of these stands on the side
    // of the first.
    static std::vector<Light> spiral(std::optional<std::pair<std::size_t, std::size_t>> same_side = {}) {
        std::vector<Light> lights;
        for (int i = 0; i < 16; ++i) {
            const bool moved = same_side && same_side->second == static_cast<std::size_t>(i);
            lights.push_back(
                light(2.4 * (moved ? static_cast<double>(same_side->first) : i), 0.35 + 0.045 * i, i));
        }
        return lights;
    }
    // In two rings, ten low ones and six high ones.
    static std::vector<Light> rings() {
        std::vector<Light> lights;
        for (int i = 0; i < 10; ++i) lights.push_back(light(0.2 + 0.628 * i, 1.0, i));
        for (int i = 10; i < 16; ++i) lights.push_back(light(1.047 * i, 0.5, i));
        return lights;
    }

    // `inverse_distance` [1]: half the picture's width by the lights' distance. `ambient` [1]: light from all
    // around.
    explicit Bumps(double steep, double inverse_distance = 0, double noise = 0.002, double ambient = 0,
                   std::vector<Light> lit_by = spiral())
        : lights(std::move(lit_by)) {
        survey.channels = 1;
        survey.photos.resize(lights.size());
        Random random(11);
        for (int y = 4; y < kHeight; y += 8)
            for (int x = 4; x < kWidth; x += 8) {
                survey.positions.emplace_back(x, y);
                const glm::dvec2 slope =
                    steep * glm::dvec2(std::sin(0.31 * x + 0.17 * y) + 0.3 * random.normal(),
                                       std::cos(0.23 * x - 0.29 * y) + 0.3 * random.normal());
                const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope, 1));
                const double diffuse = random.uniform(0.2, 0.8);
                const glm::dvec3 place((x - kWidth / 2.0) / (kWidth / 2.0),
                                       (kHeight / 2.0 - y) / (kWidth / 2.0), 0);
                for (std::size_t i = 0; i < lights.size(); ++i) {
                    const glm::dvec3 to = glm::dvec3(lights[i].direction) - inverse_distance * place;
                    const double distance = glm::length(to), strength = 0.5 + 0.02 * double(i);
                    const double value =
                        strength * diffuse *
                        (ambient + std::max(0.0, glm::dot(normal, to)) / (distance * distance * distance));
                    survey.values.push_back(static_cast<float>(value + noise * random.normal()));
                }
            }
    }
    void turn(std::size_t photo, double degrees) {
        Vec3& d = lights[photo].direction;
        const float a = static_cast<float>(degrees * std::numbers::pi / 180);
        d = Vec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
    }
    void raise(std::size_t photo, double degrees) {
        Vec3& d = lights[photo].direction;
        const float plane = std::hypot(d.x, d.y);
        const float up = std::atan2(d.z, plane) + static_cast<float>(degrees * std::numbers::pi / 180);
        d = Vec3(std::cos(up) * d.x / plane, std::cos(up) * d.y / plane, std::sin(up));
    }

private:
    static Light light(double angle, double tilt, int number) {
        Light light = distant_light(Vec3(
            glm::dvec3(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt))));
        light.name = fmt::format("photo_{:02}.png", number);
        return light;
    }
};

}  // namespace tangi
