// tangipaint calibrate, run as a user would.
#include <gmock/gmock.h>

#include "capture/formats/lights_file.h"
#include "surface/base/json_reading.h"
#include "surface/base/median.h"
#include "surface/painting_file/painting_file.h"
#include "tests/programs/support/cli_program.h"
#include "tests/support/capture/chart_pictures.h"
#include "tests/support/capture/sphere_pictures.h"

namespace tangi {
namespace {

using testing::HasSubstr;

TEST(CliCalibrate, WritesLightsACaptureFileAndAPage) {
    const TestDir dir;
    const auto lights = lights_around(6, 45);
    std::filesystem::create_directory(dir / "photos");
    const auto paths =
        write_sphere_photos(dir / "photos", SphereScene{}, lights, false, [](int i, SphereScene& scene) {
            if (i == 4) scene.strength = 0;
        });
    std::filesystem::copy_file(paths[0], dir / "photos" / "mask.png");
    const Finished run =
        tangipaint({"calibrate", (dir / "photos").string(), "--out", (dir / "lights.lp").string()});
    ASSERT_TRUE(ended(run, 0, {"mask.png: rejected", "sphere_04.png: rejected: sphere 1"}));
    const auto result = run.json();
    EXPECT_EQ(result["photographs"]["calibrated"], 5);
    EXPECT_EQ(result["photographs"]["rejected"], nlohmann::json({"sphere_04.png"}));
    const LightsFile file = read_lights_file(dir / "lights.lp");
    ASSERT_EQ(file.lights.size(), 5u);
    EXPECT_LT(degrees_between(glm::dvec3(file.lights[0].direction), lights[0]), 1);
    const auto capture = read_json(bytes_of(dir / "capture.json"), "JSON");
    EXPECT_EQ(capture["format"], "tangipaint capture 1");
    EXPECT_EQ(capture["lights"].size(), 6u);
    EXPECT_EQ(capture["lights"][4]["highlights"][0]["state"], "absent");
    EXPECT_TRUE(capture["lights"][4]["direction"].is_null());
    EXPECT_GT(capture["lights"][0]["direction_sigma_deg"].get<double>(), 0);
    const std::string page = bytes_of(dir / "capture.html");
    for (const char* part : {"data:image/jpeg;base64,/9j/", "sphere_04.png", "rejected: sphere 1", "</html>"})
        EXPECT_THAT(page, HasSubstr(part));
    EXPECT_EQ(names_in(dir.path()),
              (std::vector<std::string>{"capture.html", "capture.json", "lights.lp", "photos"}));
}

// None of its three files is then half new: all are as they were.
TEST(CliCalibrate, OnAFullDiskLeavesWhatWasThere) {
    const TestDir dir;
    std::filesystem::create_directories(dir / "photos");
    std::filesystem::create_directories(dir / "out");
    write_sphere_photos(dir / "photos", SphereScene{}, lights_around(6, 45));
    const std::vector<std::string> words = {"calibrate", (dir / "photos").string(), "--out",
                                            (dir / "out/lights.lp").string()};
    const auto files = [&] {
        std::map<std::string, std::string> bytes;
        for (const std::string& name : everything_in(dir / "out")) bytes[name] = bytes_of(dir / "out" / name);
        return bytes;
    };
    const auto refused = [&](std::uintmax_t room) {
        const Finished run = tangipaint(words, {.largest_file = room});
        EXPECT_TRUE(ended(run, 1, {(dir / "out").string() + "/", "cannot be written"})) << room;
        EXPECT_EQ(run.err.find("/."), std::string::npos) << run.err;  // by the name that was asked for
    };
    for (const std::uintmax_t room : {0, 300, 4000}) refused(room);
    EXPECT_TRUE(files().empty());
    ASSERT_TRUE(ended(tangipaint(words), 0));
    const auto before = files();
    ASSERT_EQ(before.size(), 3u);
    for (const auto& [name, bytes] : before) refused(bytes.size() - 1);
    EXPECT_EQ(files(), before);
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
    const std::string page = bytes_of(dir / "photos/capture.html");
    for (const char* part :
         {"The other reading", "directions of the lights", "± deg", "from the photographs alone"})
        EXPECT_THAT(page, HasSubstr(part));
    EXPECT_EQ(read_json(bytes_of(dir / "photos/capture.json"), "JSON")["method"], "uncalibrated");

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

// Damage that only shows when pixels are decoded, another size, the same photograph twice.
TEST(CliCalibrate, GoesOnWithoutPhotographsThatCannotBeUsed) {
    const TestDir dir;
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(9, 45));
    const std::string name = paths[3].filename().string();
    const auto calibrate = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"calibrate", "--out", (dir / "a.lp").string()});
        return tangipaint(words);
    };
    std::string bytes = bytes_of(paths[3]);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
    write_bytes(paths[3], bytes);
    Finished run = calibrate({dir.path().string()});
    ASSERT_TRUE(ended(run, 0, {name + ": cannot be decoded", "rejected"}));
    EXPECT_EQ(run.json()["photographs"]["unusable"][0]["name"], name);
    EXPECT_EQ(run.json()["photographs"]["calibrated"], 8);
    EXPECT_THAT(bytes_of(dir / "a.html"), HasSubstr(name + ": cannot be decoded"));
    write_picture_8bit(paths[3], Image<Rgb>(20, 20, Rgb(0.5f)));
    run = calibrate({dir.path().string()});
    ASSERT_TRUE(ended(run, 0, {name + ": is 20 x 20", "the same size; rejected"}));
    EXPECT_EQ(run.json()["photographs"]["calibrated"], 8);
    std::vector<std::string> words = {"--photos"};
    for (const int i : {0, 1, 2, 4, 5, 2, 6, 7, 8})
        words.push_back(paths[static_cast<std::size_t>(i)].string());
    run = calibrate(words);
    ASSERT_TRUE(ended(run, 0, {paths[2].filename().string() + ", which is given already; it is used once"}));
    EXPECT_EQ(run.json()["photographs"]["all"], 8);
    for (const std::size_t i : {0u, 1u}) write_bytes(paths[i], bytes);
    EXPECT_TRUE(ended(calibrate({dir.path().string()}), 1, {"cannot be"}));
}

// One picture twice, and one of another scene: what the fit leaves out, calibrate does, too.
TEST(CliCalibrate, LeavesOutCopiesAndPhotographsOfSomethingElse) {
    const TestDir dir;
    std::filesystem::create_directory(dir / "photos");
    const auto paths = write_sphere_photos(dir / "photos", SphereScene{}, lights_around(9, 45));
    std::filesystem::copy_file(paths[2], paths[6], std::filesystem::copy_options::overwrite_existing);
    Image<float> other(300, 220);
    for (int y = 0; y < 220; ++y)
        for (int x = 0; x < 300; ++x) other(x, y) = (x + y) / 15 % 2 == (x + 300 - y) / 17 % 2 ? 0.3f : 0.1f;
    write_map(paths[4], other);
    const Finished run =
        tangipaint({"calibrate", (dir / "photos").string(), "--out", (dir / "lights.lp").string()});
    ASSERT_TRUE(ended(run, 0,
                      {"sphere_02.png, sphere_06.png are the same picture; it is used once",
                       "sphere_04.png: shows something else than the other photographs"}));
    EXPECT_EQ(run.json()["photographs"]["calibrated"], 7);
    EXPECT_EQ(run.json()["photographs"]["unusable"].size(), 2u);
    EXPECT_EQ(run.json()["camera_moved_rms_px"], 0);
}

TEST(CliCalibrate, ReplacesOnlyWhatItWrote) {
    const TestDir dir;
    std::filesystem::create_directory(dir / "photos");
    write_sphere_photos(dir / "photos", SphereScene{}, lights_around(6, 45));
    const auto calibrate = [&](const std::string& out, bool force = false) {
        std::vector<std::string> words = {"calibrate", (dir / "photos").string(), "--out",
                                          (dir / out).string()};
        if (force) words.emplace_back("--force");
        return tangipaint(words);
    };
    EXPECT_TRUE(ended(calibrate("lights.lp"), 0));
    const std::string first = bytes_of(dir / "capture.json");
    EXPECT_TRUE(ended(calibrate("second.lp"), 0));  // beside the first, not over it
    EXPECT_EQ(bytes_of(dir / "capture.json"), first);
    EXPECT_EQ(names_in(dir.path()),
              (std::vector<std::string>{"capture.html", "capture.json", "lights.lp", "photos", "second.html",
                                        "second.json", "second.lp"}));
    EXPECT_TRUE(ended(calibrate("lights.lp"), 0));  // again
    for (const char* name : {"second.lp", "second.json", "second.html"}) {
        const std::string ours = bytes_of(dir / name);
        write_bytes(dir / name,
                    name == std::string("second.lp") ? "1\nsphere_00.png 0 0 1\n" : "{\"mine\": 1}\n");
        const std::string mine = bytes_of(dir / name);
        EXPECT_TRUE(
            ended(calibrate("second.lp"), 1, {name, "which is not as tangipaint wrote it", "--force"}));
        EXPECT_EQ(bytes_of(dir / name), mine);
        EXPECT_TRUE(ended(calibrate("second.lp", true), 0));
        EXPECT_EQ(bytes_of(dir / name).substr(0, 40), ours.substr(0, 40));
    }
}

TEST(CliCalibrate, RefusesWhatMakesNoSense) {
    const TestDir dir;
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(3));
    const std::string folder = dir.path().string(), out = (dir / "a.lp").string();
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder}), 2, {"--out"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", "--out", out}), 2, {"PHOTOS"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", (dir / "a.txt").string()}), 2,
                      {"ends in .lp, a capture file in .json"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--sphere", "1,2"}), 2,
                      {"--sphere 1,2: expected X,Y,R"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--sphere", "1,2,x"}), 2,
                      {"'x' is not a number"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--sphere-radius-mm", "-3"}), 2,
                      {"--sphere-radius-mm"}));
    for (const char* flag : {"--ppi", "--focal-px", "--focal-35mm", "--sphere-radius-mm", "--chart-pitch-mm",
                             "--marker-mm", "--camera-distance-mm", "--sphere-height-mm"})
        for (const char* value : {"nan", "inf", "-inf", "1e-300", "1e300"}) {
            if (flag == std::string("--sphere-height-mm") && value == std::string("1e-300")) continue;
            EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, flag, value}), 2,
                              {flag, value, "is not in [", "See: tangipaint calibrate --help"}));
        }
    EXPECT_TRUE(
        ended(tangipaint({"calibrate", folder, "--out", out, "--painting-mm", "1e-9,3", "--corners",
                          "10,10,90,10,90,90,10,90"}),
              2, {"--painting-mm 1e-9,3: 1e-09 is not in [0.1, 1e+06]", "See: tangipaint calibrate --help"}));
    EXPECT_TRUE(
        ended(tangipaint({"calibrate", folder, "--out", out, "--chart", "off", "--chart-pitch-mm", "10"}), 2,
              {"--chart-pitch-mm: is about a colour chart"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--sphere", "250,60,25"}), 1,
                      {"--sphere 250,60,25: no mirror sphere there"}));
    EXPECT_TRUE(
        ended(tangipaint({"calibrate", (dir / "gone").string(), "--out", out}), 1, {"gone: no such folder"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--inverted"}), 2,
                      {"--inverted: goes with --uncalibrated"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--uncalibrated", "--diffuse-sphere"}),
                      2, {"--uncalibrated: takes no sphere"}));
    EXPECT_TRUE(ended(tangipaint({"calibrate", folder, "--out", out, "--uncalibrated"}), 1,
                      {folder, "3 photographs", "at least 8"}));
    EXPECT_EQ(names_in(dir.path()).size(), 3u);
}

// A stack of a chart without spheres: what else is asked for goes without lights.
TEST(CliCalibrate, FindsScaleAndColoursWithoutSpheres) {
    const TestDir dir;
    std::filesystem::create_directory(dir / "photos");
    for (int i = 0; i < 4; ++i) {
        Image<Rgb> photo(400, 300, Rgb(0.3f));
        draw_chart(photo, chart_map(turned_corners({200, 150}, 300, 3)), classic_chart());
        for (Rgb& value : photo.pixels()) value *= 0.5f + 0.1f * static_cast<float>(i);
        add_noise(photo, 0.005, 0.001, static_cast<std::uint64_t>(i) + 1);
        write_picture(dir / "photos" / fmt::format("p_{}.png", i), photo, Transfer{});
    }
    write_bytes(dir / "photos" / "p_9.nef", "no raw");
    const std::string photos = (dir / "photos").string();
    const std::vector<std::string> all = {"calibrate", photos,       "--out",      (dir / "c.json").string(),
                                          "--ppi",     "300",        "--transfer", "linear",
                                          "--rectify", "--focal-px", "600"};
    const Finished run = tangipaint(all);
    ASSERT_TRUE(ended(
        run, 0, {"p_9.nef: is not a camera raw", "rejected", "no mirror sphere found", "without lights"}));
    const auto result = run.json();
    EXPECT_TRUE(result["lights"].is_null());
    EXPECT_EQ(result["scale"]["method"], "ppi");
    EXPECT_EQ(result["picture"]["rectified_by"], "chart");
    EXPECT_LT(result["colour"]["delta_e_2000"]["corrected"], 1.5);
    EXPECT_EQ(names_in(dir.path()), (std::vector<std::string>{"c.html", "c.json", "photos"}));
    const std::string page = bytes_of(dir / "c.html");
    for (const char* part :
         {"no lights", "Scale and plane", "Rectified by the chart", "ppi (used)", "ΔE2000"})
        EXPECT_THAT(page, HasSubstr(part));
    EXPECT_TRUE(ended(tangipaint({"calibrate", photos, "--out", (dir / "d.json").string(), "--no-spheres",
                                  "--chart", "off"}),
                      1, {"--chart off looks for no colour chart", "nothing else to look for"}));
    const std::string out = (dir / "d.json").string();
    EXPECT_TRUE(ended(tangipaint({"calibrate", photos, "--out", out, "--no-spheres", "--chart", "off"}), 1,
                      {"nothing else to look for"}));
    EXPECT_TRUE(ended(
        tangipaint({"calibrate", photos, "--out", out, "--marker-mm", "20", "--marker-dictionary", "9x9"}), 2,
        {"--marker-dictionary 9x9: is none of auto, 4x4_50"}));
    // This says "sRGB", as everything does: that does not count.
    write_picture(dir / "a.png", Image<Rgb>(40, 30, Rgb(0.5f)), *transfer_named("2.2"));
    const std::string plain = (dir / "a.png").string();
    EXPECT_TRUE(ended(tangipaint({"calibrate", "--photos", plain, "--out", out, "--dark", plain}), 2,
                      {"give --transfer"}));
    EXPECT_FALSE(std::filesystem::exists(dir / "d.json"));
}

TEST(CliCalibrate, TellsOfTwoCharts) {
    const TestDir dir;
    Image<Rgb> photo(640, 300, Rgb(0.3f));
    draw_chart(photo, chart_map(turned_corners({160, 150}, 240, 3)), classic_chart());
    draw_chart(photo, chart_map(turned_corners({480, 150}, 240, -2)), classic_chart());
    add_noise(photo, 0.005, 0.001, 1);
    write_picture(dir / "charts.png", photo, Transfer{});
    const std::string charts = (dir / "charts.png").string(), out = (dir / "c.json").string();
    EXPECT_TRUE(ended(
        tangipaint({"calibrate", "--photos", charts, "--out", out, "--no-spheres", "--transfer", "linear"}),
        0, {"charts.png: there are several colour charts", "(160, 150) is used", "(480, 150) is not"}));
}

// A painting as it was, and photographs of it later: turned by a quarter, and cut off.
TEST(CliCalibrate, LaysPhotographsOnAnEarlierPainting) {
    const TestDir dir;
    const std::string photos = (dir / "photos").string(), before = (dir / "before.exr").string();
    const std::string later = (dir / "later").string(), after = (dir / "after.exr").string();
    const std::string capture = (dir / "after.json").string();
    ASSERT_TRUE(ended(tangipaint({"generate", "--out", photos, "--width", "200", "--height", "170",
                                  "--lights", "8", "--held-out", "0", "--mm-per-pixel", "0.25"}),
                      0));
    ASSERT_TRUE(ended(tangipaint({"fit", photos, "--out", before, "--no-refine"}), 0));
    std::filesystem::create_directory(later);
    LightsFile lights = read_lights_file(photos + "/lights.lp");
    for (Light& light : lights.lights) {
        const Image<Rgb> photo = read_picture(photos + "/" + light.name);
        Image<Rgb> turned(photo.height(), photo.width() - 10);
        for (int y = 0; y < turned.height(); ++y)
            for (int x = 0; x < turned.width(); ++x) turned(x, y) = photo(photo.width() - 1 - y, x);
        write_picture(later + "/" + light.name, turned, {Transfer::Kind::srgb});
        light.direction = {-light.direction.y, light.direction.x, light.direction.z};
    }
    write_lights_file(later + "/lights.lp", lights.lights);
    EXPECT_TRUE(ended(
        tangipaint({"calibrate", later, "--out", capture, "--no-spheres", "--align-to", before, "--rectify"}),
        2, {"--align-to"}));
    const Finished run = tangipaint({"calibrate", later, "--out", capture, "--no-spheres", "--chart", "off",
                                     "--transfer", "srgb", "--align-to", before});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(run.json()["picture"]["rectified_by"], "painting");
    EXPECT_LT(run.json()["picture"]["aligned_sigma_px"], 0.2);
    ASSERT_TRUE(ended(tangipaint({"fit", later, "--capture", capture, "--out", after, "--no-refine"}), 0));
    const Surface then = read_painting(before), now = read_painting(after);
    ASSERT_EQ(now.width(), then.width());
    ASSERT_EQ(now.height(), then.height());
    std::vector<double> angles;
    for (int y = 10; y < now.height() - 10; ++y)
        for (int x = 20; x < now.width() - 10; ++x)
            angles.push_back(degrees_between(glm::dvec3(then.normal(x, y)), glm::dvec3(now.normal(x, y))));
    EXPECT_LT(median(angles), 1);
}

TEST(CliCalibrate, ControlCharactersInNamesAreShownEscaped) {
    const TestDir dir;
    const Finished run =
        tangipaint({"calibrate", (dir / "a\x1b[31mb\nc\xc2\x9b").string(), "--out", (dir / "a.lp").string()});
    EXPECT_TRUE(ended(run, 1, {"a\\x1b[31mb\\nc\\u009b: no such folder"}));
}

}  // namespace
}  // namespace tangi
