// capture_file_test.cpp: capture.json as the fit takes it, and a stack that is opened with one.
#include "capture/formats/capture_file.h"

#include <gmock/gmock.h>

#include <fstream>
#include <glm/geometric.hpp>

#include "capture/stack/stack.h"
#include "datasets/generator.h"
#include "surface/base/error.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

json capture_json() {
    return {{"format", "tangipaint capture 1"},
            {"photographs", {{"count", 3}, {"width", 41}, {"height", 31}}},
            {"camera", {{"position_mm", {2, 3, 600}}, {"mm_per_pixel", 0.5}}},
            {"frame", {{"origin_px", {20, 15}}}},
            {"lights",
             {{{"name", "img_000.png"}, {"direction", {0, 0, 1}}, {"position_mm", {0, 0, 400}}},
              {{"name", "img_001.png"}, {"direction", {0.6, 0, 0.8}}, {"position_mm", {300, 0, 400}}},
              {{"name", "img_002.png"}, {"direction", nullptr}, {"position_mm", nullptr}},
              {{"name", "img_003.png"}, {"direction", {0, 0.6, 0.8}}, {"position_mm", {0, 150, 200}}}}}};
}

std::filesystem::path written(const TestDir& folder, const json& capture) {
    std::ofstream(folder / "capture.json") << capture;
    return folder / "capture.json";
}

std::string refusal(const json& capture) {
    const TestDir folder;
    try {
        (void)read_capture_file(written(folder, capture));
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("capture.json"));
        return error.what();
    }
    return "read";
}

TEST(CaptureFile, HasTheLightsThatWereFoundTheScaleAndTheCamera) {
    const TestDir folder;
    const CaptureFile capture = read_capture_file(written(folder, capture_json()));
    ASSERT_EQ(capture.lights.size(), 3u);
    EXPECT_EQ(capture.lights[1].name, "img_001.png");
    EXPECT_EQ(capture.lights[1].position_mm, Vec3(300, 0, 400));
    EXPECT_LE(glm::length(capture.lights[1].direction - Vec3(0.6f, 0, 0.8f)), 1e-6f);
    EXPECT_EQ(capture.mm_per_pixel, 0.5);
    EXPECT_EQ(capture.camera_mm, Vec3(2, 3, 600));
    EXPECT_THAT(capture.warnings, IsEmpty());
}

TEST(CaptureFile, LightsWithoutAPositionAreAsFarAwayAsTheOthers) {
    const TestDir folder;
    json j = capture_json();
    j["lights"][3]["position_mm"] = nullptr;
    const CaptureFile capture = read_capture_file(written(folder, j));
    ASSERT_TRUE(capture.lights[2].position_mm);
    EXPECT_NEAR(glm::length(*capture.lights[2].position_mm), 500, 1e-3);  // the upper of 400 and 500
    EXPECT_THAT(capture.warnings, testing::ElementsAre(HasSubstr("img_003.png")));
    for (json& light : j["lights"]) light["position_mm"] = nullptr;
    EXPECT_FALSE(read_capture_file(written(folder, j)).lights[0].position_mm);
}

TEST(CaptureFile, SaysWhatIsWrongWithIt) {
    const auto with = [](const char* pointer, const json& value) {
        json j = capture_json();
        j[json::json_pointer(pointer)] = value;
        return refusal(j);
    };
    EXPECT_THAT(with("/format", "tangipaint capture 9"), HasSubstr("tangipaint capture 1"));
    EXPECT_THAT(with("/photographs/width", "wide"), HasSubstr("photographs.width is not a number"));
    EXPECT_THAT(with("/camera/mm_per_pixel", 0), HasSubstr("camera.mm_per_pixel = 0"));
    EXPECT_THAT(with("/camera/position_mm", {0, 0, -5}), HasSubstr("below the painting"));
    EXPECT_THAT(with("/lights/1/position_mm", {1, 2}), HasSubstr("lights[1].position_mm has 2 numbers"));
    EXPECT_THAT(with("/lights/1/position_mm", {1, 2, -3}), HasSubstr("img_001.png"));
    EXPECT_THAT(with("/geometry", json::object()), HasSubstr("calibrate again"));
    json j = capture_json();
    j["lights"][0].erase("name");
    EXPECT_THAT(refusal(j), HasSubstr("lights[0].name is missing"));
    EXPECT_THAT(refusal(json::array()), HasSubstr("not a capture file"));
    const TestDir folder;
    std::ofstream(folder / "cut.json") << capture_json().dump().substr(0, 100);
    EXPECT_THROW((void)read_capture_file(folder / "cut.json"), Error);
    EXPECT_THROW((void)read_capture_file(folder / "gone.json"), Error);
}

TEST(CaptureFile, SaysWhatIsWrongWithItsGeometry) {
    const json geometry = {{"photograph_px", {41, 31}}, {"picture_px", {41, 31}},
                           {"lens", nullptr},           {"rectification", nullptr},
                           {"mm_per_pixel", 0.5},       {"turn", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                           {"camera_mm", nullptr}};
    const auto refused = [&](const char* field, const json& value) {
        json j = capture_json();
        j["geometry"] = geometry;
        if (field) j["geometry"][field] = value;
        const std::string says = refusal(j);
        EXPECT_THAT(says, testing::Not(HasSubstr("[json"))) << says;
        return says;
    };
    EXPECT_EQ(refused(nullptr, {}), "read");
    json j = capture_json();
    j["geometry"] = true;
    EXPECT_THAT(refusal(j), testing::AllOf(HasSubstr("geometry"), testing::Not(HasSubstr("[json"))));
    EXPECT_THAT(refused("mm_per_pixel", "wide"),
                HasSubstr("geometry: a field is a string where a number belongs"));
    // 4 gigapixels of a photograph of 1271
    EXPECT_THAT(refused("picture_px", {65535, 65535}), HasSubstr("far more than the photographs' 41 x 31"));
    const json lens = {{"focal_px", {90, 90}}, {"principal_px", {20, 15}}, {"distortion", {0.1, 0, 0, 0}}};
    EXPECT_EQ(refused("lens", lens), "read");
    json odd = lens;
    odd["distortion"] = json::array({0.1});
    EXPECT_THAT(refused("lens", odd), HasSubstr("distortion has 1 numbers instead of 4"));
    odd = lens;
    odd["focal_px"] = {1e300, 90};
    EXPECT_THAT(refused("lens", odd), HasSubstr("lens has a number beyond"));
    EXPECT_THAT(refused("camera_mm", {0, 0, 1e30}), HasSubstr("farther away than 1 km"));
}

TEST(CaptureFile, OfAnotherKindIsRefusedInAShortMessage) {
    const TestDir folder;
    const std::string deep = "{\"poor\": " + std::string(140'000, '[') + std::string(140'000, ']') + "}";
    write_bytes(folder / "capture.json", deep);
    EXPECT_THAT(error_of([&] { read_capture_file(folder / "capture.json"); }), HasSubstr("deeper than 64"));
    json j = capture_json();
    j["lights"][0]["name"] = std::string(100'000, 'x');
    EXPECT_THAT(refusal(j), HasSubstr("lights[0].name is a text of 100000 bytes"));
    j = capture_json();
    j["poor"] = {std::string(100'000, 'x')};
    EXPECT_LT(read_capture_file(written(folder, j)).poor.at(0).size(), 700u);
}

TEST(CaptureFile, APartOfThePhotographsSeesLightsAndCameraFromItsOwnCentre) {
    const TestDir folder;
    const CaptureFile whole = read_capture_file(written(folder, capture_json()));
    // Its centre is 10 pixels to the right of the origin and 5 below.
    const CaptureFile part = seen_from(whole, Region{20, 10, 41, 31});
    EXPECT_EQ(part.lights[1].position_mm, Vec3(295, 2.5f, 400));
    EXPECT_EQ(part.camera_mm, Vec3(-3, 5.5f, 600));
    EXPECT_LE(glm::length(part.lights[1].direction - glm::normalize(Vec3(295, 2.5f, 400))), 1e-6f);
    // One light, carried around: four times as strong where it is twice as near.
    const CaptureFile same = seen_from(whole, Region{0, 0, 41, 31});
    EXPECT_NEAR(same.lights[0].gain.g, 1, 1e-5);
    EXPECT_NEAR(same.lights[1].gain.g, 400.0 * 400 / (500.0 * 500), 1e-5);
    EXPECT_NEAR(same.lights[2].gain.g, 400.0 * 400 / (250.0 * 250), 1e-5);
}

TEST(CaptureFile, WithoutAScaleOnlyDirectionsAreLeft) {
    const TestDir folder;
    json j = capture_json();
    j["camera"]["mm_per_pixel"] = nullptr;
    const CaptureFile part = seen_from(read_capture_file(written(folder, j)), Region{20, 10, 41, 31});
    EXPECT_FALSE(part.lights[1].position_mm);
    EXPECT_EQ(part.lights[1].gain, Rgb(1));
    EXPECT_LE(glm::length(part.lights[1].direction - Vec3(0.6f, 0, 0.8f)), 1e-6f);
}

TEST(CaptureFile, AStackIsOpenedWithIt) {
    const TestDir folder;
    write_stack(folder.path(), procedural_painting({.width = 41, .height = 31}),
                {.lights = 4, .held_out = 0});
    const auto path = written(folder, capture_json());
    const Stack stack = open_stack(folder.path(), {.lights_file = path, .crop = Region{20, 10, 41, 31}});
    ASSERT_EQ(stack.photos.size(), 3u);
    EXPECT_EQ(stack.photos[1].light.position_mm, Vec3(295, 2.5f, 400));
    EXPECT_EQ(stack.photos[2].path.filename(), "img_003.png");
    EXPECT_EQ(stack.mm_per_pixel, 0.5);
    EXPECT_EQ(stack.camera_mm, Vec3(-3, 5.5f, 600));
    json other = capture_json();
    other["photographs"]["width"] = 6000;
    try {
        (void)open_stack(folder.path(), {.lights_file = written(folder, other)});
        ADD_FAILURE() << "not refused";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("6000 x 31"));
        EXPECT_THAT(error.what(), HasSubstr("41 x 31"));
    }
}

// What spheres leave open of a direction, also where only the lights file beside is given.
TEST(CaptureFile, TellsHowUncertainDirectionsAreWhereSpheresDo) {
    const TestDir folder;
    write_stack(folder.path(), procedural_painting({.width = 41, .height = 31}),
                {.lights = 4, .held_out = 0});
    json j = capture_json();
    j["method"] = "mirror sphere";
    for (json& light : j["lights"]) light["position_mm"] = nullptr;
    j["lights"][1]["direction_sigma_deg"] = 2.5;
    const auto sigmas = [&](const char* lights) {
        std::vector<double> all;
        for (const StackPhoto& photo : open_stack(folder.path(), {.lights_file = folder / lights}).photos)
            all.push_back(photo.direction_sigma_deg);
        return all;
    };
    const std::vector<double> told = {0, 2.5, 0}, none = {0, 0, 0};
    written(folder, j);
    EXPECT_EQ(sigmas("capture.json"), told);
    const std::string lp = "3\nimg_000.png 0 0 1\nimg_001.png 0.6 0 0.8\nimg_003.png 0 0.6 0.8\n";
    write_bytes(folder / "lights.lp", lp);
    EXPECT_EQ(sigmas("lights.lp"), told);
    write_bytes(folder / "other.lp", lp);  // not the name that belongs to capture.json
    EXPECT_EQ(sigmas("other.lp"), none);
    write_bytes(folder / "lights.lp", "3\nimg_000.png 0 0 1\nimg_001.png 0 0 1\nimg_003.png 0 0.6 0.8\n");
    EXPECT_EQ(sigmas("lights.lp"), none);  // changed since
    j["method"] = "uncalibrated";
    written(folder, j);
    EXPECT_EQ(sigmas("capture.json"), none);
}

// As programs for domes write it: where the lights are, instead of unit vectors.
TEST(CaptureFile, TellsTheScaleForALightsFileWithPositions) {
    const TestDir folder;
    write_stack(folder.path(), procedural_painting({.width = 41, .height = 31}),
                {.lights = 4, .held_out = 0});
    const auto lp = folder / "lights.lp";
    write_bytes(
        lp, "4\nimg_000.png 0 0 400\nimg_001.png 300 0 400\nimg_002.png -200 0 210\nimg_003.png 0 150 200\n");
    const auto capture = written(folder, capture_json());
    const Stack plain = open_stack(folder.path(), {.lights_file = lp});
    EXPECT_THAT(plain.warnings,
                testing::ElementsAre(testing::AllOf(HasSubstr("from 250 to 500"), HasSubstr("--lights-mm"))));
    EXPECT_FALSE(plain.photos[1].light.position_mm);
    const Stack near = open_stack(
        folder.path(),
        {.lights_file = lp, .lights_in_mm = true, .capture_file = capture, .crop = Region{20, 10, 41, 31}});
    EXPECT_THAT(near.warnings, IsEmpty());
    ASSERT_EQ(near.photos.size(), 4u);
    EXPECT_EQ(near.photos[1].light.position_mm, Vec3(295, 2.5f, 400));
    EXPECT_EQ(near.mm_per_pixel, 0.5);
    EXPECT_THAT(error_of([&] { open_stack(folder.path(), {.lights_file = lp, .lights_in_mm = true}); }),
                testing::AllOf(HasSubstr("lights.lp"), HasSubstr("how large a pixel is")));
    EXPECT_THAT(error_of([&] { open_stack(folder.path(), {.lights_file = capture, .lights_in_mm = true}); }),
                HasSubstr("capture.json: --lights-mm"));
}

}  // namespace
}  // namespace tangi
