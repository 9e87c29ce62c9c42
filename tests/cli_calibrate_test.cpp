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

TEST(CliCalibrate, FindsLightsOfWhichNothingIsWrittenDown) {
    const TestDir dir;
    const std::string photos = (dir / "photos").string(), out = (dir / "photos/lights.lp").string();
    ASSERT_TRUE(ended(tangipaint({"generate", "--out", photos, "--width", "48", "--height", "48", "--lights",
                                  "16", "--held-out", "0", "--reflectance", "lambert"}),
                      0));
    const LightsFile right = read_lights_file(out);
    std::filesystem::remove(out);
    const std::string command = "tangipaint calibrate " + photos + " --out " + out + " --uncalibrated";
    EXPECT_TRUE(ended(tangipaint({"fit", photos, "--out", (dir / "p.exr").string()}), 1, {command}));
    const std::vector<std::string> words = {"calibrate",      photos,       "--out", out,
                                            "--uncalibrated", "--transfer", "linear"};
    const Finished run = tangipaint(words);
    ASSERT_TRUE(run.code == 0 || run.code == 3) << run.err;
    EXPECT_EQ(run.json()["method"], "uncalibrated");
    EXPECT_EQ(run.json()["uncalibrated"]["transfer"], "linear");
    const LightsFile found = read_lights_file(out);
    ASSERT_EQ(found.lights.size(), right.lights.size());
    EXPECT_THAT(bytes_of(dir / "photos/capture.html"), HasSubstr("The other reading"));
    EXPECT_EQ(nlohmann::json::parse(bytes_of(dir / "photos/capture.json"))["method"], "uncalibrated");

    std::vector<std::string> inverted = words;
    inverted.push_back("--inverted");
    const Finished again = tangipaint(inverted);
    ASSERT_TRUE(again.code == 0 || again.code == 3) << again.err;
    const LightsFile other = read_lights_file(out);
    for (std::size_t i = 0; i < right.lights.size(); ++i) {
        const Vec3 &a = found.lights[i].direction, &b = other.lights[i].direction;
        EXPECT_LE(glm::length(Vec3(-a.x, -a.y, a.z) - b), 1e-5f);
        EXPECT_EQ(found.lights[i].name, right.lights[i].name);
    }
}

TEST(CliCalibrate, RefusesWhatMakesNoSense) {
    const TestDir dir;
    const auto paths = write_ball_photos(dir.path(), BallScene{}, lights_around(3));
    const std::string folder = dir.path().string(), out = (dir / "a.lp").string();
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder}), 2, {"--out"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", "--out", out}), 2, {"PHOTOS"}));
    EXPECT_TRUE(
        ended(tangipaint({"calibrate", folder, "--out", (dir / "a.txt").string()}), 2, {"ends in .lp"}));
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
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--inverted"}), 2,
                      {"--inverted: goes with --uncalibrated"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--uncalibrated", "--matt-ball"}), 2,
                      {"--uncalibrated: takes no ball"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--uncalibrated"}), 1,
                      {folder, "3 photographs", "at least 8"}));
    EXPECT_EQ(names_in(dir.path()).size(), 3u);
}

}  // namespace
}  // namespace tangi
