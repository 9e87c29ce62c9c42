// Everything that can be wrong with folders, lights and paintings: the message names the file, the place,
// the remedy.
#include "surface/base/json_reading.h"
#include "tests/programs/support/bad_stack.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

TEST(CliBadFolder, DoesNotExist) {
    const TinyStack stack;
    expect_refused(stack, {"nowhere: no such folder"}, {}, stack.out("nowhere"));
    expect_refused(stack, {"img_000.png: is not a folder", "give the folder that holds"}, {}, stack.photo(0));
    expect_refused(stack, {"the name is too long"}, {}, std::string(300, 'a'));
}

TEST(CliBadFolder, HasNoLightsFile) {
    const TinyStack stack;
    fs::rename(stack.lights(), stack.out("lights.txt"));
    expect_refused(stack, {stack.path(), "no lights file (.lp", "--lights FILE.lp"});
    expect_refused(stack, {"gone.lp: no such lights file"}, {"--lights", stack.out("gone.lp")});
}

TEST(CliBadFolder, HasTwoLightsFiles) {
    const TinyStack stack;
    fs::copy_file(stack.lights(), stack.path() + "/other.LP");
    expect_refused(stack, {stack.path(), "2 lights files", "lights.lp", "other.LP", "--lights FILE.lp"});
    const Finished chosen =
        tangipaint({"fit", stack.path(), "--lights", stack.lights(), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(chosen, 0));
}

TEST(CliBadFolder, LacksListedPhotographs) {
    const TinyStack stack;
    fs::remove(stack.photo(3));
    fs::remove(stack.photo(5));
    const auto result =
        expect_warned(stack, {"lights.lp: 2 of 12 listed photographs are not in", stack.name(3),
                              stack.name(5), "Put them there, or remove their lines; rejected"});
    EXPECT_EQ(result["photographs"]["fitted"], 10);
    EXPECT_EQ(names_rejected(result), (std::vector<std::string>{stack.name(3), stack.name(5)}));
    fs::remove(stack.out("a.exr"));
    fs::remove(stack.photo(0));
    fs::remove(stack.photo(1));  // a third
    expect_refused(stack, {"lights.lp: 4 of 12 listed photographs are not in", "too many to go on without"});
}

TEST(CliBadFolder, HoldsAMask) {
    const TinyStack stack;
    Image<Rgb> mask(32, 32, Rgb(0));
    for (int y = 8; y < 24; ++y)
        for (int x = 8; x < 24; ++x) mask(x, y) = Rgb(1);
    const std::string path = stack.path() + "/the_mask.png";
    write_picture_8bit(path, mask);
    EXPECT_EQ(expect_warned(stack, {path, "taken for the mask", "--mask none"})["pixels"]["fitted"], 256);
    // Names that match nothing: the mask counts as no photograph.
    stack.change_lights([](auto& lines) {
        for (std::size_t i = 1; i < lines.size(); ++i) lines[i].replace(0, 3, "DSC");
    });
    EXPECT_EQ(expect_warned(stack, {"none of its names", "in the order"})["photographs"]["fitted"], 12);
    const Finished whole = tangipaint({"fit", stack.path(), "--mask", "none", "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(whole, 0));
    EXPECT_GT(whole.json()["pixels"]["fitted"], 1000);
    for (Rgb& pixel : mask.pixels()) pixel = Rgb(0.5f);  // its name says so, it is none
    write_picture_8bit(path, mask);
    EXPECT_GT(expect_warned(stack, {path, "rejected, since its name"})["pixels"]["fitted"], 1000);
}

TEST(CliBadFolder, HoldsAnUnlistedPhotograph) {
    const TinyStack stack;
    fs::copy_file(stack.photo(0), stack.path() + "/spare.png");
    write_bytes(stack.path() + "/.hidden.png", "not a photograph");
    write_bytes(stack.path() + "/notes.txt", "not a photograph");
    const auto result = expect_warned(stack, {"1 photographs are not listed in lights.lp", "spare.png"});
    EXPECT_EQ(result["photographs"]["fitted"], 12);
}

TEST(CliBadLights, CountDisagrees) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) { lines[0] = "11"; });
    expect_warned(stack, {"lights.lp: its first line says 11 lights, but 12 follow; all 12 are used"});
}

TEST(CliBadLights, NamesMatchNothing) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) {
        for (std::size_t i = 1; i < lines.size(); ++i) lines[i].replace(0, 3, "DSC");
    });
    expect_warned(stack, {"none of its names", "DSC_000.png", "in the order of the file names"});
}

struct WrongLine {
    std::string name, line;
    std::vector<std::string> said;
};

// Goes on without the photograph, and says where the file is wrong.
TEST(CliBadLights, LineIsNamed) {
    const TinyStack stack;
    const std::vector<WrongLine> all = {
        WrongLine{"Zero", "img_003.png 0 0 0", {"'img_003.png' is a zero vector", "remove the line"}},
        WrongLine{"NotANumber", "img_003.png nan 0 1", {"'img_003.png' is not finite", "remove the line"}},
        WrongLine{"Infinite", "img_003.png 0 -inf 1", {"'img_003.png' is not finite", "remove the line"}},
        WrongLine{"Word", "img_003.png 0 up 1", {"expected 'name x y z'", "'up' is not a number"}},
        WrongLine{"Short", "img_003.png 0 1", {"expected 'name x y z'", "'img_003.png' is not a number"}},
        WrongLine{"Nameless", "0.1 0 1", {"expected 'name x y z'", "name is missing"}},
        WrongLine{"Twice", "img_001.png 0 1 1", {"'img_001.png' has a light in line 3 already"}}};
    for (const WrongLine& wrong : all) {
        SCOPED_TRACE(wrong.name);
        stack.change_lights([&](auto& lines) { lines[4] = wrong.line; });
        std::vector<std::string> said = wrong.said;
        said.push_back("lights.lp, line 5: ");
        said.push_back("rejected");
        const bool twice = wrong.name == "Twice";  // and two photographs have no light then
        EXPECT_EQ(expect_warned(stack, said)["photographs"]["fitted"], twice ? 10 : 11);
    }
    // The same again is no contradiction.
    stack.change_lights([&](auto& lines) { lines[4] = lines[2]; });
    EXPECT_EQ(expect_warned(stack,
                            {"line 5", "line 3 already, the same; it is used once"})["photographs"]["fitted"],
              11);
    fs::remove(stack.out("a.exr"));
    stack.change_lights([&](auto& lines) {
        for (const std::size_t line : {4u, 6u, 8u, 10u}) lines[line] = "img_009.png nan 0 1";
    });
    expect_refused(stack, {"lights.lp, line 5: ", "not finite", "4 of 12", "too many to go on without"});
}

TEST(CliBadLights, FromBelowAreLeftOut) {
    const TinyStack stack;
    stack.change_lights([&](auto& lines) { lines[3] = stack.name(2) + " 0.6 0 -0.8"; });
    const auto result = expect_warned(
        stack, {"lights.lp: rejected 1 photograph lit from below", stack.name(2) + " (z = -0.8000)"});
    EXPECT_EQ(result["photographs"]["fitted"], 11);
}

TEST(CliBadLights, AllFromBelowHaveTheOppositeSign) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) {
        for (std::size_t i = 1; i < lines.size(); ++i) lines[i].insert(lines[i].rfind(' ') + 1, "-");
    });
    expect_refused(stack, {"lights.lp: 12 of 12 lights come from below", "the opposite sign"});
}

TEST(CliBadLights, FewerThanFour) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) { lines = {"3", lines[1], lines[4], lines[8]}; });
    expect_refused(stack, {stack.path(), "3 usable photographs; at least 4"});
    stack.change_lights([](auto& lines) { lines = {"0"}; });
    expect_refused(stack, {"lights.lp: holds no lights", "name x y z"});
    write_bytes(stack.lights(), "");
    expect_refused(stack, {"lights.lp: holds no lights", "name x y z"});
}

// Order that is not the photographs' shows in what the model leaves over.
TEST(CliBadLights, NamesMatchNothingAndTheOrderIsAnother) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) {
        for (std::size_t i = 1; i < lines.size(); ++i) lines[i].replace(0, 3, "DSC");
        std::rotate(lines.begin() + 1, lines.begin() + 6, lines.end());
    });
    const Finished run = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(run, 3, {"none of its names", "poor result", "order of the file names"}));
}

// y downwards, as the rows of a picture.
TEST(CliBadLights, AxisIsMirrored) {
    const TinyStack stack({}, 80);
    const auto fit = [&](std::vector<std::string> flags) {
        flags.insert(flags.begin(), {"fit", stack.path(), "--out", stack.out("a.exr")});
        return tangipaint(flags);
    };
    const Finished right = fit({});
    ASSERT_TRUE(ended(right, 0));
    const std::string dry = right.json()["dry_hash"];
    stack.change_lights([](auto& lines) {
        for (std::size_t i = 1; i < lines.size(); ++i) {
            std::istringstream words(lines[i]);
            std::string name;
            double x = 0, y = 0, z = 0;
            words >> name >> x >> y >> z;
            lines[i] = fmt::format("{} {:.6f} {:.6f} {:.6f}", name, x, -y, z);
        }
    });
    const Finished wrong = fit({});
    EXPECT_TRUE(ended(wrong, 3, {"poor result", "curl", "it is y", ": give --light-axes x,-y,z\n"}));
    EXPECT_EQ(wrong.json()["light_axes_check"]["mirrored"], true);
    const Finished flipped = fit({"--light-axes", "x,-y,z"});
    EXPECT_TRUE(ended(flipped, 0));
    EXPECT_EQ(flipped.json()["dry_hash"], dry);
    // A hill is a valley, which is a surface, but casts other shadows.
    EXPECT_TRUE(ended(fit({"--light-axes=-x,y,z"}), 3, {"cast shadows lie", ": give --light-axes x,-y,z\n"}));
}

// Photographs that were turned, or taken with the camera turned, after the lights were noted.
TEST(CliBadLights, AllAreTurned) {
    const TinyStack stack({}, 80);
    const auto fit = [&](std::vector<std::string> flags) {
        flags.insert(flags.begin(), {"fit", stack.path(), "--out", stack.out("a.exr")});
        return tangipaint(flags);
    };
    stack.change_lights([](auto& lines) {
        for (std::size_t i = 1; i < lines.size(); ++i) {
            std::istringstream words(lines[i]);
            std::string name;
            double x = 0, y = 0, z = 0;
            words >> name >> x >> y >> z;
            lines[i] = fmt::format("{} {:.6f} {:.6f} {:.6f}", name, -y, x, z);
        }
    });
    const Finished wrong = fit({});
    EXPECT_TRUE(ended(wrong, 3,
                      {"poor result", "were all lights turned by -90 degrees", "cast shadows tell",
                       ": give --light-rotation-deg -90\n"}));
    EXPECT_EQ(wrong.json()["light_axes_check"]["turned"]["wrong"], true);
    EXPECT_TRUE(ended(fit({"--light-rotation-deg", "-90"}), 0));
    EXPECT_TRUE(ended(fit({"--light-rotation-deg", "90"}), 3,
                      {"cast shadows lie", "give --light-rotation-deg -90\n"}));
}

// What rests on a calibration that was called poor is poor, whatever else it looks like.
TEST(CliBadLights, AreOfAPoorCalibration) {
    const TinyStack stack({}, 80);
    const std::string capture = stack.out("c.json"), painting = stack.out("a.exr");
    ASSERT_TRUE(ended(tangipaint({"calibrate", stack.path(), "--out", capture, "--no-spheres", "--chart",
                                  "off", "--ppi", "300"}),
                      0));
    const std::vector<std::string> with = {stack.path(), "--lights", stack.lights(),
                                           "--capture",  capture,    "--out"};
    const auto run = [&](std::vector<std::string> words, const std::string& out) {
        words.insert(words.end(), with.begin(), with.end());
        words.push_back(out);
        return tangipaint(words);
    };
    ASSERT_TRUE(ended(run({"fit"}, painting), 0));
    nlohmann::json about = read_json(bytes_of(capture), "JSON");
    about["poor"] = {"the sphere is an egg"};
    write_bytes(capture, about.dump());
    const std::vector<std::string> told = {"poor result",
                                           "c.json: calibrate called it poor: the sphere is an egg"};
    EXPECT_TRUE(ended(run({"fit"}, painting), 3, told));
    EXPECT_TRUE(fs::exists(painting));
    EXPECT_TRUE(ended(run({"compare", painting}, stack.out("compared")), 3, told));
}

// The lights file that calibrate wrote has its capture file beside it, whatever else is given.
TEST(CliBadLights, AreWhatAPoorCalibrationWrote) {
    const TinyStack stack({}, 80);
    nlohmann::json capture = {{"format", "tangipaint capture 1"},
                              {"method", "mirror sphere"},
                              {"photographs", {{"count", 16}, {"width", 80}, {"height", 80}}},
                              {"camera", {{"mm_per_pixel", nullptr}, {"position_mm", nullptr}}},
                              {"frame", {{"origin_px", {39.5, 39.5}}}},
                              {"lights", nlohmann::json::array()},
                              {"poor", {"the sphere is an egg"}}};
    std::string lp = bytes_of(stack.lights());
    std::istringstream lines(lp);
    std::string count, name;
    std::getline(lines, count);
    for (double x = 0, y = 0, z = 0; lines >> name >> x >> y >> z;)
        capture["lights"].push_back(
            {{"name", name}, {"direction", {x, y, z}}, {"position_mm", nullptr}, {"direction_sigma_deg", 1}});
    write_bytes(stack.out("mine.lp"), lp);
    write_bytes(stack.out("mine.json"), capture.dump());
    const auto fit = [&] {
        return tangipaint({"fit", stack.path(), "--lights", stack.out("mine.lp"), "--out", stack.out("a.exr"),
                           "--no-refine"});
    };
    EXPECT_TRUE(ended(fit(), 3, {"mine.json: calibrate called it poor: the sphere is an egg"}));
    capture["lights"][2]["direction"] = {0, 0, 1};  // of another lights file
    write_bytes(stack.out("mine.json"), capture.dump());
    EXPECT_TRUE(ended(fit(), 0));
}

// Half a turn leaves a surface, with hills for valleys: shadows tell, also where nothing is refined.
TEST(CliBadLights, AllAreTurnedByHalfATurn) {
    const TinyStack stack({}, 80);
    const auto fit = [&](std::vector<std::string> flags) {
        flags.insert(flags.begin(), {"fit", stack.path(), "--out", stack.out("a.exr"), "--no-refine"});
        return tangipaint(flags);
    };
    EXPECT_TRUE(ended(fit({}), 0));
    EXPECT_TRUE(ended(fit({"--light-rotation-deg", "180"}), 3,
                      {"cast shadows lie", ": leave out --light-rotation-deg\n"}));
}

TEST(CliBadLights, NumbersMakeNoSense) {
    const TinyStack stack;
    const std::vector<std::string> fit = {"fit", stack.path(), "--out", stack.out("a.exr")};
    const auto with = [&](const char* flag, const char* value) {
        std::vector<std::string> words = fit;
        words.insert(words.end(), {flag, value});
        return tangipaint(words);
    };
    for (const char* value : {"nan", "inf", "1e300"})
        for (const char* flag : {"--noise", "--mm-per-pixel", "--white-level", "--light-rotation-deg"})
            EXPECT_TRUE(ended(with(flag, value), 2, {flag, value, "See: tangipaint fit --help"}));
    for (const char* crop : {"0,0,0,5", "0,0,-3,-3", "-9,0,5,5", "nan,0,5,5", "0,0,1e300,5"})
        EXPECT_TRUE(ended(with("--crop", crop), 2, {"--crop", crop, "See: tangipaint fit --help"}));
}

TEST(CliBadLights, TwoAreExchanged) {
    const TinyStack stack({}, 80);
    stack.change_lights([](auto& lines) {
        const auto direction = [](const std::string& line) { return line.substr(line.find(' ')); };
        const std::string third = direction(lines[3]);
        lines[3] = lines[3].substr(0, lines[3].find(' ')) + direction(lines[8]);
        lines[8] = lines[8].substr(0, lines[8].find(' ')) + third;
    });
    const Finished run = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(run, 3,
                      {"poor result", stack.name(2) + " and " + stack.name(7), "shaded by the other's light",
                       "exchange their lights"}));
    EXPECT_EQ(run.json()["light_outliers"]["odd"].size(), 2u);
}

TEST(CliBadLights, TooManyHeldOut) {
    const TinyStack stack;
    expect_refused(stack, {"3 usable photographs; at least 4"}, {"--hold-out", "3:1"});
    expect_refused(stack, {"0 usable photographs; at least 4"}, {"--hold-out", "0:1"});
    expect_refused(stack, {"--hold-out 0:1: all 12 photographs are held out"}, {"--hold-out", "0:1"});
}

TEST(CliBadLights, AllInALine) {
    const TinyStack stack;
    stack.change_lights([&](auto& lines) {
        for (std::size_t i = 1; i < lines.size(); ++i) {
            const double x = -0.9 + 0.15 * static_cast<double>(i);
            lines[i] = fmt::format("{} {} {} 1", stack.name(static_cast<int>(i) - 1), x, x / 2);
        }
    });
    expect_refused(stack, {stack.path(), "all lights lie in one plane", "lit from other sides"});
}

// A painting file cut anywhere, or with a byte changed anywhere, is refused by every command that reads it.
TEST(CliBadPainting, IsRefusedByEveryCommand) {
    const TinyStack stack;
    const std::string whole = bytes_of(stack.truth()), bad = stack.out("bad.exr");
    const auto expect_damaged = [&](const std::string& what) {
        for (const Finished& run :
             side_by_side({{"relight", bad, "--light", "0,0,1", "--out", stack.out("a.png")},
                           {"compare", bad, stack.path(), "--out", stack.out("c")},
                           {"info", bad}}))
            EXPECT_TRUE(ended(run, 1, {"bad.exr"})) << what;
        EXPECT_FALSE(fs::exists(stack.out("a.png"))) << what;
        EXPECT_FALSE(fs::exists(stack.out("c") + "/compare.html")) << what;
    };
    for (const double part : {0.0, 0.02, 0.999}) {
        write_bytes(bad, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
        expect_damaged(fmt::format("cut at {}", part));
    }
    for (const double part : {0.5, 0.95}) {
        std::string changed = whole;
        changed[static_cast<std::size_t>(part * static_cast<double>(whole.size()))] ^= 0x55;
        write_bytes(bad, changed);
        expect_damaged(fmt::format("changed at {}", part));
    }
    // A value that is valid, but not the one that was saved.
    Surface s = read_painting(stack.truth());
    s.diffuse(3, 4).r += 0.25f;
    write_painting(bad, s);
    std::string forged = bytes_of(bad);
    const std::string now = hash_of(s), saved = hash_of(read_painting(stack.truth()));
    ASSERT_NE(forged.find(now), std::string::npos);
    forged.replace(forged.find(now), now.size(), saved);
    write_bytes(bad, forged);
    const Finished run = tangipaint({"info", bad});
    EXPECT_TRUE(ended(run, 1, {"bad.exr: the dry layer is not the one that was saved"}));
}

TEST(CliDemo, FindsOutThatTheSampleIsNotThere) {
    const TinyStack stack;
    Conditions elsewhere;
    elsewhere.environment["TANGIPAINT_DATASETS"] = stack.path();
    elsewhere.cwd = stack.root();
    EXPECT_TRUE(ended(tangipaint({"demo", "--small"}, elsewhere), 1, {stack.path(), "TANGIPAINT_DATASETS"}));
}

}  // namespace
}  // namespace tangi
