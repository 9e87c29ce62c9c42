// fit, info, generate and demo, run as a user would run them.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "surface/base/json_reading.h"
#include "surface/painting_file/painting_parts.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

TEST(CliFit, WritesThePaintingThatItDescribes) {
    const TinyStack stack;
    const Finished run = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--mm-per-pixel",
                                     "0.25", "--white-level", "0.75", "--transfer", "linear"});
    ASSERT_TRUE(ended(run, 0));
    const nlohmann::json said = run.json();
    const Surface s = read_painting(stack.out("a.exr"));
    EXPECT_EQ(said["width"], 32);
    EXPECT_EQ(said["height"], 32);
    EXPECT_EQ(said["photographs"]["fitted"], 12);
    EXPECT_EQ(said["photographs"]["held_out"], 0);
    EXPECT_EQ(said["transfer"]["name"], "linear");
    EXPECT_EQ(said["transfer"]["source"], "given");
    EXPECT_EQ(said["dry_hash"], hash_of(s));
    EXPECT_TRUE(said["scale_known"]);
    EXPECT_DOUBLE_EQ(s.mm_per_pixel, 0.25);
    EXPECT_DOUBLE_EQ(s.photography.white_level, 0.75);
    const nlohmann::json provenance = read_json(s.provenance, "JSON");
    EXPECT_EQ(provenance["inputs"].size(), 13u);  // with the list of lights
    EXPECT_EQ(provenance["options"]["white_level"], 0.75);
    EXPECT_THAT(everything_in(stack.root()), testing::Contains("a.exr"));
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
    // The truth is known: at least the mean colour must be near it.
    const Surface truth = read_painting(stack.truth());
    double fitted = 0, expected = 0;
    for (std::size_t i = 0; i < s.diffuse.size(); ++i)
        if (s.confidence.pixels()[i] > 0.5f && truth.confidence.pixels()[i] > 0) {
            fitted += luminance(s.diffuse.pixels()[i]);
            expected += luminance(truth.diffuse.pixels()[i]);
        }
    EXPECT_NEAR(fitted / expected, 1, 0.1);
}

TEST(CliFit, HoldsOutWhatItIsTold) {
    const TinyStack stack;
    const auto held_out = [&](const std::string& which) {
        const Finished run =
            tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--hold-out", which});
        EXPECT_TRUE(ended(run, 0));
        std::vector<std::string> names;
        for (const auto& photo : read_painting(stack.out("a.exr")).photography.photos)
            if (!photo.fitted) names.push_back(photo.light.name);
        EXPECT_EQ(run.json()["photographs"]["held_out"], names.size());
        EXPECT_EQ(run.json()["photographs"]["fitted"], 12 - names.size());
        return names;
    };
    EXPECT_THAT(held_out("2:4"), ElementsAre(stack.name(2), stack.name(6), stack.name(10)));
    EXPECT_THAT(held_out("5," + stack.name(1)), ElementsAre(stack.name(1), stack.name(5)));
    EXPECT_THAT(held_out(" 5, 1 "), ElementsAre(stack.name(1), stack.name(5)));
    const auto refused = [&](const std::string& which, const std::string& said) {
        const Finished run =
            tangipaint({"fit", stack.path(), "--out", stack.out("b.exr"), "--hold-out", which});
        EXPECT_TRUE(ended(run, 1, {"--hold-out " + which, said}));
        EXPECT_FALSE(fs::exists(stack.out("b.exr")));
    };
    refused("12", "photographs 0 to 11");
    refused("nobody.png", "there is no photograph nobody.png");
    refused("2:0", "a step of at least 1");
}

TEST(CliFit, CropsToTheRegion) {
    const TinyStack stack;
    ASSERT_TRUE(
        ended(tangipaint({"fit", stack.path(), "--out", stack.out("all.exr"), "--transfer", "linear"}), 0));
    const Finished run = tangipaint(
        {"fit", stack.path(), "--out", stack.out("part.exr"), "--transfer", "linear", "--crop", "8,4,16,10"});
    ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(run.json()["width"], 16);
    EXPECT_EQ(run.json()["height"], 10);
    const Surface all = read_painting(stack.out("all.exr")), part = read_painting(stack.out("part.exr"));
    // The same place: the strength of the lights is estimated from less, so not quite the same numbers.
    const auto distance_if_at = [&](int x0, int y0) {
        double sum = 0;
        for (int y = 0; y < 10; ++y)
            for (int x = 0; x < 16; ++x)
                sum += glm::distance(part.diffuse(x, y), all.diffuse(x + x0, y + y0)) +
                       glm::distance(part.normal(x, y), all.normal(x + x0, y + y0));
        return sum / 160;
    };
    const double here = distance_if_at(8, 4);
    EXPECT_LT(here, 0.1);
    for (const auto& [x0, y0] : {std::pair{0, 0}, {7, 4}, {9, 4}, {8, 3}, {8, 5}, {4, 8}})
        EXPECT_GT(distance_if_at(x0, y0), 3 * here) << x0 << ", " << y0;
    const auto cropped = [&](const std::string& to) {
        return tangipaint({"fit", stack.path(), "--out", stack.out("b.exr"), "--crop=" + to});
    };
    EXPECT_TRUE(ended(cropped("20,0,16,16"), 1, {"does not lie in the photographs", "32 x 32"}));
    for (const std::string none : {"-1,0,8,8", "0,0,0,8", "0,0,8,-8"})
        EXPECT_TRUE(ended(cropped(none), 2, {"is no part of a picture", "See: tangipaint fit --help"}))
            << none;
}

TEST(CliFit, LeavesOutWhatTheMaskBlackens) {
    const TinyStack stack;
    Image<float> mask(32, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 10; x < 32; ++x) mask(x, y) = 1;
    write_map(stack.out("mask.png"), mask);
    ASSERT_TRUE(ended(
        tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--mask", stack.out("mask.png")}), 0));
    const Surface s = read_painting(stack.out("a.exr"));
    int measured_inside = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            ASSERT_TRUE(x >= 10 || s.confidence(x, y) == 0) << x << ", " << y;
            measured_inside += x >= 10 && s.confidence(x, y) > 0;
        }
    EXPECT_GT(measured_inside, 600);

    const auto refused = [&](const std::string& file, const std::vector<std::string>& said) {
        EXPECT_TRUE(
            ended(tangipaint({"fit", stack.path(), "--out", stack.out("b.exr"), "--mask", file}), 1, said));
    };
    write_map(stack.out("small.png"), Image<float>(16, 16, 1));
    refused(stack.out("small.png"), {"small.png", "16 x 16", "32 x 32"});
    write_map(stack.out("black.png"), Image<float>(32, 32));
    refused(stack.out("black.png"), {"black.png", "leaves nothing", "white marks"});
    refused(stack.out("none.png"), {"none.png"});
}

TEST(CliFit, TakesAQuestionMarkInAnyPath) {
    const TinyStack stack;
    const std::string folder = stack.out("which? one");
    fs::rename(stack.folder(), folder);
    fs::rename(folder + "/img_003.png", folder + "/img_003?.png");
    std::string lights = read_text_file(folder + "/lights.lp");
    write_bytes(folder + "/lights.lp", lights.replace(lights.find("img_003"), 7, "img_003?"));
    ASSERT_TRUE(ended(tangipaint({"fit", folder, "--out", folder + "/a?.exr"}), 0));
    const std::string held_out = folder + "/heldout";
    EXPECT_TRUE(
        ended(tangipaint({"compare", folder + "/a?.exr", held_out, "--out", stack.out("report?")}), 0));
    EXPECT_TRUE(ended(tangipaint({"relight", folder + "/a?.exr", "--lights", folder + "/lights.lp", "--out",
                                  stack.out("relit?")}),
                      0));
    EXPECT_EQ(read_picture(stack.out("relit?") + "/img_003?.png").width(), 32);
}

TEST(CliFit, DoesNotDependOnTheNumberOfThreads) {
    const TinyStack stack;
    std::vector<std::string> hashes;
    for (const char* threads : {"1", "2", "5"}) {
        const Finished run =
            tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--threads", threads});
        ASSERT_TRUE(ended(run, 0));
        hashes.push_back(run.json()["dry_hash"]);
    }
    EXPECT_EQ(hashes[0].size(), 16u);
    EXPECT_THAT(hashes, testing::Each(hashes[0]));
}

TEST(CliFit, TheOrderOfTheLightsFileDoesNotMatter) {
    const TinyStack stack;
    const auto fit = [&](const std::string& to) {
        const Finished run = tangipaint({"fit", stack.path(), "--out", to});
        EXPECT_TRUE(ended(run, 0));
    };
    fit(stack.out("a.exr"));
    stack.change_lights([](auto& lines) {
        Random random(7);
        for (std::size_t i = lines.size() - 1; i > 1; --i)
            std::swap(lines[i], lines[1 + static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    });
    fit(stack.out("b.exr"));
    EXPECT_EQ(hash_of(read_painting(stack.out("a.exr"))), hash_of(read_painting(stack.out("b.exr"))));
}

TEST(CliInfo, SaysWhatAPaintingHolds) {
    const TinyStack stack;
    const nlohmann::json said = tangipaint({"info", stack.truth()}).json();
    EXPECT_EQ(said["kind"], "painting");
    EXPECT_EQ(said["width"], 32);
    EXPECT_EQ(said["dry_hash"], hash_of(read_painting(stack.truth())));
    EXPECT_EQ(said["photographs"]["fitted"], 12);
    EXPECT_EQ(said["photographs"]["held_out"], 2);
    EXPECT_EQ(said["photographs"]["transfer"], "linear");
    EXPECT_EQ(said["provenance"]["generator"]["reflectance"], "ward_bounded");
    const nlohmann::json height = said["maps"]["height_mm"];
    EXPECT_LE(height["minimum"], height["median"]);
    EXPECT_LT(height["minimum"], height["maximum"]);
}

TEST(CliInfo, SaysWhatLightsAndPicturesHold) {
    const TinyStack stack;
    write_bytes(stack.out("two.lp"), "3\na.png 0 0 2\nb.png 1 0 1\n");
    const Finished lights = tangipaint({"info", stack.out("two.lp")});
    ASSERT_TRUE(ended(lights, 0, {"says 3 lights, but 2 follow"}));
    const nlohmann::json said = lights.json();
    EXPECT_EQ(said["kind"], "lights");
    ASSERT_EQ(said["lights"].size(), 2u);
    EXPECT_NEAR(said["lights"][0]["elevation_deg"].get<double>(), 90, 1e-3);
    EXPECT_NEAR(said["lights"][1]["elevation_deg"].get<double>(), 45, 1e-3);
    EXPECT_EQ(said["lights"][1]["name"], "b.png");
    EXPECT_EQ(said["warnings"].size(), 1u);

    const nlohmann::json photo = tangipaint({"info", stack.photo(0)}).json();
    EXPECT_EQ(photo["kind"], "picture");
    EXPECT_EQ(photo["bits"], 16);
    EXPECT_EQ(photo["channels"], 3);
    const nlohmann::json map = tangipaint({"info", stack.path() + "/gt/height.exr"}).json();
    EXPECT_EQ(map["kind"], "picture");  // an EXR, but no painting
    EXPECT_TRUE(map["float"]);
}

TEST(CliInfo, TellsFilesApartByExtensionsInAnyCase) {
    const TinyStack stack;
    ASSERT_TRUE(ended(tangipaint({"fit", stack.path(), "--out", stack.out("A.EXR")}), 0));
    EXPECT_EQ(tangipaint({"info", stack.out("A.EXR")}).json()["kind"], "painting");
    fs::rename(stack.lights(), stack.path() + "/LIGHTS.Lp");
    EXPECT_EQ(tangipaint({"info", stack.path() + "/LIGHTS.Lp"}).json()["kind"], "lights");
}

// It would wait for somebody to write into the pipe.
TEST(CliInfo, RefusesWhatIsNoRegularFile) {
    const TinyStack stack;
    for (const std::string name : {"a.exr", "a.lp", "a.png"}) {
        ASSERT_EQ(::mkfifo(stack.out(name).c_str(), 0600), 0);
        EXPECT_TRUE(ended(tangipaint({"info", stack.out(name)}), 1, {name + ": is a pipe or a device"}));
    }
    EXPECT_TRUE(
        ended(tangipaint({"relight", stack.out("a.exr"), "--light", "0,0,1", "--out", stack.out("b.png")}), 1,
              {"a.exr: is a pipe or a device"}));
}

TEST(CliInfo, TellsOfAPaintingThatWasCutOffInAPartThatItDoesNotRead) {
    const TinyStack stack;
    const PartToWrite further{
        {"of another program", 8, 8, {"a"}, {}, false},
        [](int, int rows, std::span<float* const> planes) { std::fill_n(planes[0], rows * 8, 2.0f); }};
    {
        AtomicFile file(stack.out("a.exr"));
        write_painting(file, Surface(8, 8), {&further, 1});
    }
    const std::string whole = bytes_of(stack.out("a.exr"));
    ASSERT_TRUE(ended(tangipaint({"info", stack.out("a.exr")}), 0));
    write_bytes(stack.out("a.exr"), whole.substr(0, whole.size() - 1));
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"info", stack.out("a.exr")},
          {"relight", stack.out("a.exr"), "--light", "0,0,1", "--out", stack.out("b.png")},
          {"export", stack.out("a.exr"), "--to", "maps", "--out", stack.out("maps")}})
        EXPECT_TRUE(
            ended(tangipaint(words), 1, {"a.exr: is damaged: it ends before the last of its pixels"}));
}

TEST(CliInfo, RefusesWhatItDoesNotKnow) {
    const TinyStack stack;
    write_bytes(stack.out("junk.exr"), "not an EXR at all");
    write_bytes(stack.out("junk.txt"), "hello");
    write_bytes(stack.out("junk.lp"), "\x89JPEG\r\n");
    write_bytes(stack.out("picture.lp"), "\x89PNG\r\n");
    EXPECT_TRUE(
        ended(tangipaint({"info", stack.out("junk.exr")}), 1, {"junk.exr", "is not a painting file"}));
    EXPECT_TRUE(ended(tangipaint({"info", stack.out("junk.txt")}), 1, {"junk.txt", "is not a picture"}));
    EXPECT_TRUE(ended(tangipaint({"info", stack.out("junk.lp")}), 1, {"junk.lp, line 1"}));
    EXPECT_TRUE(ended(tangipaint({"info", stack.out("picture.lp")}), 1, {"picture.lp: is a picture"}));
    EXPECT_TRUE(ended(tangipaint({"info", stack.out("none")}), 1, {"none: no such file"}));
    EXPECT_TRUE(
        ended(tangipaint({"info", stack.path()}), 1, {"is a folder", "name a painting (.exr, .tangi)"}));
    EXPECT_TRUE(ended(tangipaint({"info", std::string(300, 'a')}), 1, {"the name is too long"}));
}

TEST(CliGenerate, WritesWhatFitReads) {
    const TestDir dir;
    const std::string out = (dir / "deep/er/stack").string();
    const std::vector<std::string> small = {
        "generate",        "--out", out,        "--width", "24",         "--height", "20",
        "--supersampling", "1",     "--lights", "9",       "--held-out", "1"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), small.begin(), small.end());
        fs::remove_all(dir / "deep");
        const Finished run = tangipaint(more);
        EXPECT_TRUE(ended(run, 0)) << testing::PrintToString(more);
        return run.json();
    };
    const nlohmann::json said = with({"--seed", "5", "--no-losses", "--no-cast-shadows"});
    EXPECT_EQ(said["photographs"], 10);
    EXPECT_EQ(said["width"], 24);
    EXPECT_EQ(said["height"], 20);
    EXPECT_EQ(said["options"]["seed"], 5);
    EXPECT_EQ(said["options"]["cast_shadows"], false);
    const std::string first = bytes_of(dir / "deep/er/stack/img_000.png");
    with({"--seed", "5", "--no-losses", "--no-cast-shadows"});
    EXPECT_EQ(bytes_of(dir / "deep/er/stack/img_000.png"), first);  // the seed is all that chance has
    with({"--seed", "6", "--no-losses", "--no-cast-shadows"});
    EXPECT_NE(bytes_of(dir / "deep/er/stack/img_000.png"), first);

    const std::vector<std::pair<std::vector<std::string>, std::string>> kinds = {
        {{"--format", "jpg", "--transfer", "srgb", "--reflectance", "lambert"}, "img_008.jpg"},
        {{"--format", "exr", "--arrangement", "spiral", "--reflectance", "ward_bounded"}, "img_008.exr"},
        {{"--format", "tif", "--transfer", "2.2", "--distance", "3"}, "img_008.tif"},
        {{"--format", "png8", "--gain-min", "0.5", "--gain-max", "1"}, "img_008.png"}};
    for (const auto& [flags, last] : kinds) {
        with(flags);
        EXPECT_TRUE(fs::exists(dir / "deep/er/stack" / last)) << last;
        const Finished fit = tangipaint({"fit", out, "--out", (dir / "a.exr").string()});
        EXPECT_THAT(fit.code, testing::AnyOf(0, 3)) << fit.err;
        EXPECT_EQ(fit.json()["width"], 24);
    }
}

TEST(CliGenerate, RefusesWhatContradictsItself) {
    const TestDir dir;
    const auto refused = [&](std::vector<std::string> flags, const std::vector<std::string>& said) {
        flags.insert(flags.begin(),
                     {"generate", "--out", (dir / "s").string(), "--width", "16", "--height", "16"});
        EXPECT_TRUE(ended(tangipaint(flags), 1, said));
        EXPECT_FALSE(fs::exists(dir / "s"));
    };
    refused({"--format", "exr", "--transfer", "srgb"}, {"exr", "linear light", "srgb"});
    refused({"--min-elevation-deg", "60", "--max-elevation-deg", "30"}, {"max_elevation_deg = 30", "60"});
    refused({"--gain-min", "2"}, {"gain_max = 1", "2"});
}

TEST(CliDemo, ShowsTheWholePath) {
    const TestDir dir;
    const fs::path out = dir / "new/demo";
    const Finished run = tangipaint({"demo", "--small", "--out", out.string()});
    ASSERT_TRUE(
        ended(run, 0, {"dB PSNR", (out / "contact_sheet.png").string(), (out / "painting.exr").string()}));
    EXPECT_EQ(run.json()["held_out"]["count"], 6);
    EXPECT_GT(run.json()["held_out"]["psnr_db"], 30);
    const Region size = read_painting(out / "painting.exr").height_mm.region();
    EXPECT_GE(size.width(), 64);
    for (const char* name : {"relit_raking_left.png", "relit_raking_top.png", "relit_gallery.png"})
        EXPECT_EQ(read_picture(out / name).region(), size) << name;
    EXPECT_GT(read_picture(out / "contact_sheet.png").width(), size.width());
    EXPECT_TRUE(fs::exists(out / "compare/compare.html"));
    EXPECT_EQ(leftovers_in(dir.path()), std::vector<std::string>());
}

}  // namespace
}  // namespace tangi
