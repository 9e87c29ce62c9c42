// tangipaint calibrate, run as a user would.
#include "ball_pictures.h"
#include "capture/lights_file.h"
#include "cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;

TEST(CliCalibrate, WritesLightsACaptureFileAndAPage) {
    const TestDir dir;
    const auto lights = lights_around(6, 45);
    std::filesystem::create_directory(dir / "photos");
    const auto paths =
        write_ball_photos(dir / "photos", BallScene{}, lights, false, [](int i, BallScene& scene) {
            if (i == 4) scene.strength = 0;
        });
    std::filesystem::copy_file(paths[0], dir / "photos" / "mask.png");
    const Finished run =
        tangipaint({"calibrate", (dir / "photos").string(), "--out", (dir / "lights.lp").string()});
    ASSERT_TRUE(ended(run, 0, {"mask.png: left out", "ball_04.png: left out: ball 1"}));
    const auto result = run.json();
    EXPECT_EQ(result["photographs"]["calibrated"], 5);
    EXPECT_EQ(result["photographs"]["left_out"], nlohmann::json({"ball_04.png"}));
    const LightsFile file = read_lights_file(dir / "lights.lp");
    ASSERT_EQ(file.lights.size(), 5u);
    EXPECT_LT(degrees_between(glm::dvec3(file.lights[0].direction), lights[0]), 1);
    const auto capture = nlohmann::json::parse(bytes_of(dir / "capture.json"));
    EXPECT_EQ(capture["format"], "tangipaint capture 1");
    EXPECT_EQ(capture["lights"].size(), 6u);
    EXPECT_EQ(capture["lights"][4]["highlights"][0]["state"], "absent");
    EXPECT_TRUE(capture["lights"][4]["direction"].is_null());
    EXPECT_GT(capture["lights"][0]["direction_sigma_deg"].get<double>(), 0);
    const std::string page = bytes_of(dir / "capture.html");
    for (const char* part : {"data:image/jpeg;base64,/9j/", "ball_04.png", "left out: ball 1", "</html>"})
        EXPECT_THAT(page, HasSubstr(part));
    EXPECT_EQ(names_in(dir.path()),
              (std::vector<std::string>{"capture.html", "capture.json", "lights.lp", "photos"}));
}

TEST(CliCalibrate, RefusesWhatMakesNoSense) {
    const TestDir dir;
    const auto paths = write_ball_photos(dir.path(), BallScene{}, lights_around(3));
    const std::string folder = dir.path().string(), out = (dir / "a.lp").string();
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder}), 2, {"--out"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", "--out", out}), 2, {"PHOTOS"}));
    EXPECT_TRUE(
        ended(tangipaint({"calibrate", folder, "--out", (dir / "a.txt").string()}), 2, {"ends in .lp, a capture file in .json"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--sphere", "1,2"}), 2,
                      {"--sphere 1,2: expected X,Y,R"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--sphere", "1,2,x"}), 2,
                      {"'x' is not a number"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--ball-radius-mm", "-3"}), 2,
                      {"--ball-radius-mm"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--sphere", "250,60,25"}), 1,
                      {"--sphere 250,60,25: no mirror ball there"}));
    EXPECT_TRUE(
        ended(tangipaint({"calibrate", (dir / "gone").string(), "--out", out}), 1, {"gone: no such folder"}));
    EXPECT_EQ(names_in(dir.path()).size(), 3u);
}

}  // namespace
}  // namespace tangi
