// dome_file_test.cpp: the lights in other programs' projects (.dome, .relight), alone and with
// photographs.
#include "capture/formats/dome_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/formats/relight_file.h"
#include "capture/stack/stack.h"
#include "surface/file/atomic_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

json points(const std::vector<Vec3>& vectors) {
    json list = json::array();
    for (const Vec3& v : vectors) list.push_back({{"x", v.x}, {"y", v.y}, {"z", v.z}});
    return list;
}

const std::vector<Vec3> kDirections = {
    {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}, {-0.6f, 0, 0.8f}, {0, -0.28f, 0.96f}};

json dome_of(const std::string& kind) {
    return {{"label", "d"},
            {"imageWidth", 0},
            {"domeDiameter", 0},
            {"verticalOffset", 0},
            {"ledAdjust", json::array()},
            {"lightConfiguration", kind},
            {"directions", points(kDirections)}};
}

std::string error_in_dome(const std::string& text) {
    return error_of([&] { parse_dome(text, "x.dome"); });
}
std::string error_in_project(const json& project) {
    return error_of([&] { parse_relight(project.dump(), "x.relight"); });
}

TEST(DomeFile, HoldsDirectionsInOrder) {
    const DomeFile dome = parse_dome(dome_of("directional").dump(1), "x.dome");
    ASSERT_EQ(dome.lights.size(), kDirections.size());
    for (std::size_t i = 0; i < kDirections.size(); ++i) {
        EXPECT_LE(glm::length(dome.lights[i].direction - kDirections[i]), 1e-6f);
        EXPECT_EQ(dome.lights[i].name, "");
        EXPECT_FALSE(dome.lights[i].position_mm);
    }
    EXPECT_THAT(dome.warnings, IsEmpty());
}

TEST(DomeFile, OfLightsOnADomeHasTheirPositions) {
    json j = dome_of("spherical");
    j["imageWidth"] = 200;
    j["domeDiameter"] = 1000;
    j["verticalOffset"] = -50;
    const DomeFile computed = parse_dome(j.dump(), "x.dome");
    ASSERT_EQ(computed.picture_width_mm, 200);
    ASSERT_TRUE(computed.lights[0].position_mm);
    EXPECT_LE(glm::length(*computed.lights[0].position_mm - Vec3(300, 0, 350)), 1e-3f);
    EXPECT_LE(glm::length(computed.lights[0].direction - glm::normalize(Vec3(300, 0, 350))), 1e-6f);
    j["positionsSphere"] = points({{1, 2, 300}, {2, 3, 300}, {3, 4, 300}, {4, 5, 300}});
    EXPECT_EQ(parse_dome(j.dump(), "x.dome").lights[3].position_mm, Vec3(4, 5, 300));
    j["lightConfiguration"] = "lights3d";
    j["positions3d"] = points({{7, 2, 300}, {8, 3, 300}, {9, 4, 300}, {10, 5, 300}});
    EXPECT_EQ(parse_dome(j.dump(), "x.dome").lights[3].position_mm, Vec3(10, 5, 300));
}

TEST(DomeFile, WithPositionsWithoutAScaleGivesDirections) {
    json j = dome_of("lights3d");
    j["positions3d"] = points({{3, 0, 4}, {0, 3, 4}, {1, 1, 4}, {2, 2, 4}});
    const DomeFile dome = parse_dome(j.dump(), "x.dome");
    EXPECT_FALSE(dome.lights[0].position_mm);
    EXPECT_LE(glm::length(dome.lights[0].direction - Vec3(0.6f, 0, 0.8f)), 1e-6f);
    ASSERT_EQ(dome.warnings.size(), 1u);
    EXPECT_THAT(dome.warnings[0], HasSubstr("imageWidth"));
}

TEST(DomeFile, ThatIsNoneSaysWhere) {
    EXPECT_EQ(error_in_dome("{\n \"directions\": [\n  {\"x\": 1,, }"),
              "x.dome, line 3, column 11: is no JSON from here on; is the file whole?");
    EXPECT_THAT(error_in_dome(""), HasSubstr("x.dome, line 1, column 1: is no JSON"));
    EXPECT_THAT(error_in_dome("[]"), HasSubstr("x.dome: is no dome"));
    EXPECT_THAT(error_in_dome("{}"), HasSubstr("x.dome: holds no lights"));
    json j = dome_of("directional");
    j["directions"][2].erase("y");
    EXPECT_EQ(error_in_dome(j.dump()), "x.dome: directions[2].y is missing");
    j["directions"][2]["y"] = "up";
    EXPECT_EQ(error_in_dome(j.dump()), "x.dome: directions[2].y is not a number");
    j["directions"][2] = {{"x", 0}, {"y", 0}, {"z", 0}};
    EXPECT_THAT(error_in_dome(j.dump()), HasSubstr("x.dome: directions[2] is a zero vector"));
    j["directions"] = 3;
    EXPECT_EQ(error_in_dome(j.dump()), "x.dome: directions is not a list");
    EXPECT_THAT(error_in_dome(dome_of("magic").dump()), HasSubstr("lightConfiguration 'magic'"));
    j["directions"] = points({Vec3(0.1f), Vec3(-0.4f)});
    EXPECT_THAT(error_in_dome(j.dump()), HasSubstr("the same: an early version"));
}

json project_of(const std::vector<std::string>& names) {
    json images = json::array();
    for (const std::string& name : names) images.push_back({{"filename", name}, {"skip", false}});
    return {{"application", "Relight"}, {"images", images}, {"dome", dome_of("directional")}};
}

TEST(RelightFile, NamesLightsAfterItsPhotographs) {
    const RelightFile file = parse_relight(project_of({"b", "a", "d", "c"}).dump(), "x.relight");
    ASSERT_EQ(file.lights.size(), 4u);
    EXPECT_EQ(file.lights[2].name, "d");
    EXPECT_LE(glm::length(file.lights[2].direction - kDirections[2]), 1e-6f);
    EXPECT_FALSE(file.mm_per_pixel);
}

TEST(RelightFile, PassesOverSkippedPhotographs) {
    json project = project_of({"a", "b", "skipped", "c", "d"});
    project["images"][2]["skip"] = true;
    const RelightFile file = parse_relight(project.dump(), "x.relight");
    ASSERT_EQ(file.lights.size(), 4u);
    EXPECT_EQ(file.lights[2].name, "c");
    EXPECT_LE(glm::length(file.lights[2].direction - kDirections[2]), 1e-6f);
}

TEST(RelightFile, TakesTheMeanOfItsSpheresWhereItHasNoDome) {
    json project = project_of({"a", "b", "c"});
    project["dome"]["directions"] = json::array();
    project["pixelSize"] = 0.25;
    project["spheres"] = {{{"directions", {{0.6, 0, 0.8}, {0, 0, 1}, {0, 0, 0}}}},
                          {{"directions", {{0, 0.6, 0.8}, {0, 0, 0}, {0, 0, 0}}}}};
    const RelightFile file = parse_relight(project.dump(), "x.relight");
    ASSERT_EQ(file.lights.size(), 2u);
    EXPECT_LE(glm::length(file.lights[0].direction - glm::normalize(Vec3(0.3f, 0.3f, 0.8f))), 1e-6f);
    EXPECT_EQ(file.lights[1].name, "b");
    EXPECT_EQ(file.mm_per_pixel, 0.25);
    ASSERT_EQ(file.warnings.size(), 1u);
    EXPECT_THAT(file.warnings[0], HasSubstr("no light for c"));
}

TEST(RelightFile, ThatIsNoneOrIncompleteSaysWhere) {
    EXPECT_THAT(error_in_project(json::object()), HasSubstr("x.relight: is no project of Relight"));
    json project = project_of({"a", "b", "c"});
    EXPECT_THAT(error_in_project(project), HasSubstr("4 lights for 3 photographs"));
    project["images"][1].erase("filename");
    EXPECT_EQ(error_in_project(project), "x.relight: images[1].filename is missing");
    project = project_of({"a"});
    project["dome"]["directions"][1]["z"] = nullptr;
    EXPECT_EQ(error_in_project(project), "x.relight: dome.directions[1].z is missing");
    project.erase("dome");
    EXPECT_THAT(error_in_project(project), HasSubstr("x.relight: holds no lights"));
    project["spheres"] = {{{"directions", {{1, 2}}}}};
    EXPECT_EQ(error_in_project(project),
              "x.relight: spheres[0].directions[0] is not a direction of three numbers");
}

struct Photos {
    TestDir folder;
    Photos() {
        std::vector<Light> lights;
        for (const char* name : {"b.png", "a.png", "c.png", "d.png"})
            lights.push_back(distant_light({0.1f, 0, 1}, name));
        write_test_stack(folder, lights);
        std::filesystem::remove(folder / "lights.lp");
    }
};

TEST(DomeFile, AloneInTheFolderGoesByTheOrderOfNamesAndSaysSo) {
    const Photos photos;
    json j = dome_of("spherical");
    j["imageWidth"] = 16;  // of 8 pixels
    j["domeDiameter"] = 100;
    write_text_file(photos.folder / "rig.dome", j.dump());
    const Stack stack = open_stack(photos.folder.path());
    ASSERT_EQ(stack.photos.size(), 4u);
    EXPECT_EQ(stack.photos[1].light.name, "b.png");
    EXPECT_LE(glm::length(stack.photos[1].light.direction - kDirections[1]), 1e-6f);
    EXPECT_TRUE(stack.photos[1].light.position_mm);
    EXPECT_EQ(stack.mm_per_pixel, 2);
    ASSERT_EQ(stack.warnings.size(), 1u);
    EXPECT_THAT(stack.warnings[0],
                HasSubstr("rig.dome: does not name photographs; its lights are taken in the order"));
}

TEST(DomeFile, OfAnotherNumberOfLightsIsAnError) {
    const Photos photos;
    json j = dome_of("directional");
    j["directions"].erase(0);
    write_text_file(photos.folder / "rig.dome", j.dump());
    EXPECT_THAT(error_of([&] { open_stack(photos.folder.path()); }), HasSubstr("has 3 lights"));
}

TEST(RelightFile, IsMatchedByName) {
    const Photos photos;
    write_text_file(photos.folder / "p.relight", project_of({"b.png", "c.PNG", "x/a.png", "d.png"}).dump());
    const Stack stack = open_stack(photos.folder.path(), {.lights_file = photos.folder / "p.relight"});
    EXPECT_THAT(stack.warnings, IsEmpty());
    ASSERT_EQ(stack.photos.size(), 4u);
    EXPECT_EQ(stack.photos[2].path.filename(), "a.png");
    EXPECT_LE(glm::length(stack.photos[2].light.direction - kDirections[2]), 1e-6f);
}

}  // namespace
}  // namespace tangi
