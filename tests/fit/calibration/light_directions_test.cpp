// light_directions_test.cpp: lights whose directions a lights file gets wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <iostream>

#include "capture/formats/lights_file.h"
#include "datasets/generator.h"
#include "fit/calibration/light_calibration.h"
#include "fit/calibration/light_direction_field.h"
#include "surface/base/json_reading.h"
#include "surface/maps/photography_json.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / kDegree;
}

// [deg] Mean over the lights.
double told_error_deg(const std::vector<glm::dvec3>& found, const std::vector<glm::dvec3>& right,
                      bool strengths_known) {
    const DirectionField field(right, strengths_known);
    const auto motions = static_cast<Eigen::Index>(field.untold({0, 0, 1}).size());
    const auto rows = static_cast<Eigen::Index>(2 * right.size());
    Eigen::MatrixXd motion(rows, motions);
    Eigen::VectorXd error(rows);
    for (std::size_t i = 0; i < right.size(); ++i) {
        const TangentFrame frame = tangent_frame(right[i]);
        const auto row = static_cast<Eigen::Index>(2 * i);
        const double along = glm::dot(found[i], right[i]);
        error[row] = glm::dot(found[i], frame.a) / along;
        error[row + 1] = glm::dot(found[i], frame.b) / along;
        const std::vector<glm::dvec2> untold = field.untold(right[i]);
        for (Eigen::Index k = 0; k < motions; ++k) {
            motion(row, k) = untold[static_cast<std::size_t>(k)].x;
            motion(row + 1, k) = untold[static_cast<std::size_t>(k)].y;
        }
    }
    error -= motion * motion.colPivHouseholderQr().solve(error);
    double sum = 0;
    for (Eigen::Index i = 0; i < rows; i += 2) sum += std::hypot(error[i], error[i + 1]);
    return sum / static_cast<double>(right.size()) / kDegree;
}

struct DirectionErrors {
    double before = 0, after = 0;  // [deg] mean
};

struct WrongLights {
    TestDir folder;
    Stack stack;
    Photography truth;
    LightCalibration found;
    // `error` of a true direction, as a turn.
    WrongLights(GeneratorOptions options, const std::function<glm::dvec2(const glm::dvec3&)>& error,
                bool refine = false, double sigma_deg = 0) {
        options.held_out = 0;
        const PaintingTruth painting =
            procedural_painting({.seed = 5, .width = 80, .height = 80, .mm_per_pixel = kMmPerPixel});
        write_stack(folder.path(), painting, options);
        truth = photography_from_json(read_json(bytes_of(folder / "gt/lights.json"), "JSON"));
        if (error) {
            std::vector<Light> listed;
            for (const Photography::Photo& photo : truth.photos) {
                listed.push_back(photo.light);
                const glm::dvec3 d(photo.light.direction);
                listed.back().direction = Vec3(turned(d, error(d)));
            }
            write_lights_file(folder / "lights.lp", listed);
        }
        stack = open_stack(folder.path(), {.transfer = Transfer{}});
        found = calibrate_lights(
            {stack, survey(stack), Transfer{}, NoiseModel(Transfer{}, 0.006, true), kMmPerPixel},
            {stack.lights(),
             {},
             0.75,
             std::vector<double>(sigma_deg > 0 ? stack.photos.size() : 0, sigma_deg)},
            {}, {.samples = 250, .refine_directions = refine});
        for (const auto& trial : found.trials)
            std::cout << fmt::format("{}: {:.2f} dB; ", name_of(trial.model), trial.cv_psnr_db);
        const DirectionErrors e = errors();
        std::cout << fmt::format("\n{}: {:.2f} deg before, {:.2f} after\n", name_of(found.model), e.before,
                                 e.after);
    }
    // Of the directions, without what all of them have of the motions that photographs cannot tell.
    DirectionErrors errors() const {
        std::vector<glm::dvec3> listed, after, right;
        for (std::size_t i = 0; i < stack.photos.size(); ++i) {
            listed.emplace_back(stack.photos[i].light.direction);
            after.emplace_back(found.lighting.lights[i].direction);
            for (const Photography::Photo& photo : truth.photos)
                if (photo.light.name == stack.photos[i].light.name) right.emplace_back(photo.light.direction);
        }
        const bool strengths_known = found.model.lights != LightFreedom::rig_and_gains;
        return {told_error_deg(listed, right, strengths_known),
                told_error_deg(after, right, strengths_known)};
    }
};

std::vector<glm::dvec3> some_lights() {
    Random random(3);
    std::vector<glm::dvec3> lights;
    for (int i = 0; i < 30; ++i) lights.emplace_back(random.direction(0.2));
    return lights;
}

TEST(DirectionField, TurnsBySmallAngles) {
    for (const glm::dvec3& d : some_lights()) {
        const TangentFrame frame = tangent_frame(d);
        EXPECT_NEAR(glm::length(frame.a), 1, 1e-6);
        EXPECT_NEAR(glm::dot(frame.a, frame.b), 0, 1e-6);
        EXPECT_NEAR(glm::dot(frame.a, d), 0, 1e-6);
        EXPECT_NEAR(glm::dot(glm::cross(frame.a, frame.b), d), 1, 1e-6);
        EXPECT_NEAR(angle_deg(turned(d, {0.03, 0.04}), d), std::atan(0.05) / kDegree, 1e-5);
    }
}

TEST(DirectionField, HasNothingOfWhatPhotographsCannotTell) {
    const std::vector<glm::dvec3> lights = some_lights();
    for (const bool strengths_known : {false, true}) {
        const DirectionField field(lights, strengths_known);
        ASSERT_GE(field.modes(), 3);
        const auto modes = static_cast<std::size_t>(field.modes());
        const std::size_t motions = field.untold(lights[0]).size();
        EXPECT_EQ(motions, strengths_known ? 3u : 8u);
        for (std::size_t k = 0; k < modes; ++k) {
            std::vector<double> products(modes), along(motions);
            for (const glm::dvec3& d : lights) {
                const auto turns = field.at(d), untold = field.untold(d);
                for (std::size_t i = 0; i < modes; ++i)
                    products[i] += glm::dot(turns[k], turns[i]) / static_cast<double>(lights.size());
                for (std::size_t i = 0; i < motions; ++i) along[i] += glm::dot(turns[k], untold[i]);
            }
            for (std::size_t i = 0; i < modes; ++i) EXPECT_NEAR(products[i], i == k ? 1 : 0, 1e-6);
            for (const double part : along) EXPECT_NEAR(part, 0, 1e-3);
        }
    }
}

// A turn of all lights together is a motion that photographs cannot tell.
TEST(DirectionField, KnowsRotationsForWhatTheyAre) {
    const glm::dvec3 omega(0.001, -0.002, 0.003);
    for (const glm::dvec3& d : some_lights()) {
        const std::vector<glm::dvec2> untold = DirectionField({d}, true).untold(d);
        const glm::dvec2 t = omega.x * untold[0] + omega.y * untold[1] + omega.z * untold[2];
        EXPECT_LE(glm::length(turned(d, t) - glm::normalize(d + glm::cross(omega, d))), 1e-6);
    }
}

TP_LONG TEST(LightDirections, RandomErrorsOfSixDegreesAreFound) {
    const WrongLights lights({.lights = 36, .nominal_direction_error_deg = 6}, {});
    EXPECT_EQ(lights.found.model.directions, DirectionFreedom::own);
    EXPECT_GE(lights.errors().before, 2);
    EXPECT_LE(lights.errors().after, 1.2);
    // Each light's standard error is of the size of its error.
    double sigmas = 0, changes = 0;
    ASSERT_EQ(lights.found.turns.size(), lights.stack.photos.size());
    for (const LightCalibration::Turn& turn : lights.found.turns) {
        EXPECT_GT(turn.sigma_deg, 0);
        sigmas += turn.sigma_deg / static_cast<double>(lights.found.turns.size());
        changes += turn.changed_deg / static_cast<double>(lights.found.turns.size());
    }
    EXPECT_LE(sigmas, 2);
    EXPECT_NEAR(changes, 4.4, 1);
    const nlohmann::json written = to_json(lights.found);
    EXPECT_EQ(written["calibrated"], "as given, own directions");
    EXPECT_EQ(written["directions"].size(), lights.found.turns.size());
}

// A light that is left out is then as far off itself, and predicted badly with any surface.
TP_LONG TEST(LightDirections, RandomErrorsOfTenDegreesAreFound) {
    const WrongLights lights({.lights = 30, .nominal_direction_error_deg = 10}, {});
    EXPECT_EQ(lights.found.model.directions, DirectionFreedom::own);
    EXPECT_GE(lights.errors().before, 3);
    EXPECT_LE(lights.errors().after, 2);
}

TP_LONG TEST(LightDirections, AFieldOfErrorsIsFound) {
    // Lights are tilted the more the further they are to the right.
    const WrongLights lights({.lights = 36}, [](const glm::dvec3& d) {
        return glm::dvec2(6 * kDegree * d.y * d.y, 6 * kDegree * d.x * d.y);
    });
    EXPECT_NE(lights.found.model.directions, DirectionFreedom::listed);
    EXPECT_GE(lights.errors().before, 2);
    EXPECT_LE(lights.errors().after, 0.6);
    // And so does a light that no photograph had.
    const Vec3 listed = glm::normalize(Vec3(0.3f, 0.5f, 0.7f));
    std::vector<Vec3> all_listed;
    for (const Light& light : lights.stack.lights()) all_listed.push_back(light.direction);
    const Vec3 found = predicted_direction(lights.found.directions.value(), all_listed, listed);
    EXPECT_GE(angle_deg(glm::dvec3(found), glm::dvec3(listed)), 0.2);
    EXPECT_THAT(warning_of(lights.found, "folder"),
                testing::AnyOf("", testing::HasSubstr("folder: the photographs")));
}

TP_LONG TEST(LightDirections, ThatAreRightAreLeftAlone) {
    const WrongLights lights({.lights = 36}, {});
    EXPECT_EQ(lights.found.model.directions, DirectionFreedom::listed);
}

// Of 14 photographs none can be spared to judge by; where the user knows that the file is off, they still
// tell.
TP_LONG TEST(LightDirections, OfFewLightsAreCorrectedWhereTheUserSaysSo) {
    const auto error = [](const glm::dvec3& d) {
        const double angle = 40 * d.x + 17 * d.y;
        return 4 * kDegree * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    const GeneratorOptions options{.lights = 14, .reflectance = Reflectance::lambert, .cast_shadows = false};
    EXPECT_EQ(WrongLights(options, error).found.model.directions, DirectionFreedom::listed);
    const WrongLights refined(options, error, true);
    EXPECT_EQ(refined.found.model.directions, DirectionFreedom::own);
    EXPECT_EQ(refined.found.turns.size(), 14u);
    const DirectionErrors e = refined.errors();
    EXPECT_GT(e.before, 2);
    EXPECT_LT(e.after, 0.4 * e.before);
    // Right directions stay, also where the user doubts them.
    const DirectionErrors right = WrongLights(options, {}, true).errors();
    EXPECT_LT(right.after, 1);
}

// As a sphere leaves them: no photograph is left out to judge by, the standard errors say how far to go.
TP_LONG TEST(LightDirections, ThatWereMeasuredAreCorrectedAsFarAsTheirErrorsAllow) {
    const auto error = [](const glm::dvec3& d) {
        const double angle = 40 * d.x + 17 * d.y;
        return 2 * kDegree * glm::dvec2(std::cos(angle), std::sin(angle));
    };
    const GeneratorOptions options{.lights = 14, .reflectance = Reflectance::lambert, .cast_shadows = false};
    const WrongLights measured(options, error, false, 1.5);
    EXPECT_EQ(measured.found.model.directions, DirectionFreedom::measured);
    EXPECT_EQ(to_json(measured.found)["calibrated"].get<std::string>().find("measured directions") ==
                  std::string::npos,
              false);
    const DirectionErrors e = measured.errors();
    EXPECT_GT(e.before, 1);
    EXPECT_LT(e.after, 0.65 * e.before);  // what all share is a motion that photographs cannot tell
    // Lambert's paint is not taken for rough.
    ASSERT_TRUE(measured.found.diffuse_roughness);
    EXPECT_LT(*measured.found.diffuse_roughness, 0.1);
    // What is measured well stays where it is, whatever the photographs seem to say.
    const DirectionErrors sure = WrongLights(options, error, false, 0.02).errors();
    EXPECT_NEAR(sure.after, sure.before, 0.1);
    EXPECT_LT(WrongLights(options, {}, false, 1.5).errors().after, 0.7);
}

}  // namespace
}  // namespace tangi
