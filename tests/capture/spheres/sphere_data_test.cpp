// sphere_data_test.cpp: spheres in real photographs, and in stacks that have none.
#include "capture/sphere_lights/sphere_calibration.h"

#include <gmock/gmock.h>

#include <fstream>

#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"
#include "tests/support/capture/sphere_pictures.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;
using testing::Contains;
using testing::HasSubstr;

// Mean angle to the lights of the University of Washington, whose photographs are <sphere>.<number>.tga.
double mean_error_deg(const SphereCalibration& calibration, const std::filesystem::path& lights,
                      const std::string& sphere) {
    std::ifstream file(lights);
    int count = 0;
    file >> count;
    double sum = 0;
    int found = 0;
    for (int i = 0; i < count; ++i) {
        dvec3 truth;
        file >> truth.x >> truth.y >> truth.z;
        for (const CalibratedLight& light : calibration.lights)
            if (light.name == fmt::format("{}.{}.tga", sphere, i)) {
                sum += degrees_between(light.direction.value_or(dvec3(0, 0, -1)), truth);
                ++found;
            }
    }
    EXPECT_EQ(found, count);
    return sum / count;
}

// The real spheres of the University of Washington, and of the handheld set.

TEST(DataMirrorSphere, ChromeAgreesWithItsLights) {
    TP_DATA(folder, "spheres");
    std::vector<std::string> warnings;
    const SphereCalibration c = calibrate_from_spheres(pictures_in(folder / "chrome", warnings), {});
    EXPECT_THAT(warnings, Contains(HasSubstr("mask")));
    EXPECT_LE(mean_error_deg(c, folder / "lights.txt", "chrome"), 3.5);
}

// Around the sphere it is as dark as what a code is worth, which tells nothing of lights.
TEST(DataMirrorSphere, ChromeIsFoundInParts) {
    TP_DATA(folder, "spheres");
    std::vector<std::string> warnings;
    const std::vector<std::filesystem::path> all = pictures_in(folder / "chrome", warnings);
    Random random(5);
    for (std::size_t turn = 0; turn < 4; ++turn) {
        std::vector<std::filesystem::path> part = all;
        while (part.size() > (turn < 2 ? 11u : 8u))  // without chrome.0, without chrome.4, and at random
            part.erase(part.begin() + static_cast<std::ptrdiff_t>(
                                          turn == 0 ? 0
                                          : turn == 1
                                              ? 6
                                              : random.uniform(0, static_cast<double>(part.size()) - 1e-9)));
        const SphereCalibration c = calibrate_from_spheres(part, {});
        ASSERT_EQ(c.spheres.size(), 1u);
        EXPECT_NEAR(c.spheres[0].image.radius_px, 118.9, 1);
    }
}

// Half of the photographs, in which a bump of the painting glitters as a sphere would.
TEST(DataMirrorSpheres, HandheldAreFoundBesideABump) {
    TP_DATA(folder, "handheld");
    std::vector<std::string> warnings;
    std::vector<std::filesystem::path> half = pictures_in(folder / "png16", warnings);
    half.resize(12);
    const SphereCalibration c = calibrate_from_spheres(half, {});
    ASSERT_EQ(c.spheres.size(), 2u);
    for (const FoundSphere& sphere : c.spheres) EXPECT_NEAR(sphere.image.radius_px, 28.4, 1);
    EXPECT_THAT(c.warnings, Contains(HasSubstr("spheres are of one size")));
}

TEST(DataMattSphere, GrayAgreesWithItsLights) {
    TP_DATA(folder, "spheres");
    std::vector<std::string> warnings;
    const SphereCalibration c =
        calibrate_from_spheres(pictures_in(folder / "gray", warnings), {.matt = true});
    EXPECT_EQ(c.matt_transfer->name(), "linear");
    EXPECT_LE(mean_error_deg(c, folder / "lights.txt", "gray"),
              4.5);  // lights.txt is itself some 3 degrees from the chrome sphere's highlights
}

TEST(DataMirrorSpheres, HandheldLightsAreWhereTheyWere) {
    TP_DATA(folder, "handheld");
    std::vector<std::string> warnings;
    const SphereCalibration c = calibrate_from_spheres(pictures_in(folder / "png16", warnings),
                                                       {.sphere_radius_mm = 12,
                                                        .focal_px = 1408,
                                                        .principal_px = dvec2(351.5, 263.5),
                                                        .origin_px = dvec2(351.5 - 17 * 1408 / 600.0, 263.5),
                                                        .camera_distance_mm = 600,
                                                        .sphere_height_mm = 6});
    ASSERT_EQ(c.spheres.size(), 2u);
    EXPECT_EQ(c.calibrated(), 24);
    const auto truth = read_json(read_text_file(folder / "gt" / "lights.json"), "JSON");
    double millimetres = 0, degrees = 0;
    int positions = 0;
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        const auto& p = truth["lights"][i]["pos_mm"];
        const dvec3 light(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
        if (c.lights[i].position_mm) {
            ++positions;
            millimetres += glm::length(*c.lights[i].position_mm - light);
        }
        degrees += degrees_between(c.lights[i].direction.value_or(dvec3(0, 0, -1)), light) / 24;
    }
    EXPECT_EQ(positions, 24);
    EXPECT_LE(millimetres / positions, 15);
    EXPECT_LE(degrees, 1);
}

// Real stacks without spheres: what glitters in them is not taken for one.
TEST(DataMirrorSphere, IsNotFoundInPaintings) {
    for (const char* name : {"real/icon", "real/coin"}) {
        TP_DATA(folder, name);
        std::vector<std::string> warnings;
        EXPECT_THAT(
            error_of([&] { calibrate_from_spheres(pictures_in(folder, warnings), {.fixed_camera = true}); }),
            HasSubstr("no mirror sphere found"));
    }
}

// All of the background is the same, so that a good part of its edges are where the others have theirs.
TEST(DataSphereCalibration, NamesARockAmongPicturesOfASphere) {
    TP_DATA(folder, "spheres");
    for (const std::string sphere : {"chrome", "gray"}) {
        const TestDir dir;
        std::vector<std::filesystem::path> paths;
        for (int i = 0; i < 12; ++i) {
            paths.push_back(dir / fmt::format("{:02}.tga", i));
            const std::string shown = i == 4 ? "rock" : sphere;
            std::filesystem::copy_file(folder / shown / fmt::format("{}.{}.tga", shown, i), paths.back());
        }
        const SphereCalibrationOptions options{.matt = sphere == "gray"};
        EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, options); }),
                    testing::AllOf(HasSubstr("04.tga"),
                                   HasSubstr("shows something else than the other photographs")));
        paths.erase(paths.begin() + 4);
        EXPECT_GE(calibrate_from_spheres(paths, options).calibrated(), 10) << sphere;
    }
}

}  // namespace
}  // namespace tangi
