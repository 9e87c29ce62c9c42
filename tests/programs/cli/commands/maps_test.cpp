// maps_test.cpp: what exported maps, layers and RTI files say and keep, run as a user would run them.
#include "fit/exchange/ptm_rti_file.h"
#include "surface/base/json_reading.h"
#include "surface/file/atomic_file.h"
#include "surface/image/metrics.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

TEST(CliMaps, TheWholeLawGoesOutAndComesBack) {
    const TinyStack stack;
    Surface s = read_painting(stack.truth());
    s.reflectance_model = {.diffuse_roughness = 0.4, .second_lobe_weight = 0.6};
    write_painting(stack.out("hazy.exr"), s);
    const auto exported = [&](const std::string& to) {
        return tangipaint({"export", stack.out("hazy.exr"), "--to", to, "--out", stack.out(to)});
    };
    ASSERT_TRUE(ended(exported("maps"), 0));
    const Finished back = tangipaint({"import", stack.out("maps"), "--out", stack.out("back.exr")});
    ASSERT_TRUE(ended(back, 0));
    EXPECT_EQ(back.json()["second_lobe_weight"], 0.6);
    EXPECT_EQ(read_painting(stack.out("back.exr")).reflectance_model, s.reflectance_model);
    ASSERT_TRUE(ended(tangipaint({"import", stack.out("maps"), "--second-lobe-weight", "0.1",
                                  "--diffuse-roughness", "0", "--out", stack.out("other.exr")}),
                      0));
    EXPECT_EQ(read_painting(stack.out("other.exr")).reflectance_model,
              (ReflectanceModel{.second_lobe_weight = 0.1}));
    std::vector<Image<Rgb>> pictures;
    for (const char* painting : {"hazy.exr", "back.exr"}) {
        ASSERT_TRUE(ended(tangipaint({"relight", stack.out(painting), "--light", "0.3,0.2,0.9", "--encoding",
                                      "srgb", "--out", stack.out("relit.tif")}),
                          0));
        pictures.push_back(read_picture(stack.out("relit.tif")));
    }
    EXPECT_GT(psnr_db(pictures[0], pictures[1]), 80);
    const auto warnings = exported("openlime").json()["warnings"];
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_NE(warnings[0].get<std::string>().find("second lobe"), std::string::npos);
    EXPECT_NE(warnings[1].get<std::string>().find("diffuse roughness"), std::string::npos);
}

// By name alone, as maps of other programs are called anything.
TEST(CliMaps, MapsOfDrawnOutLobesGoOutAndComeBack) {
    const TinyStack stack;
    Surface s = read_painting(stack.truth());
    s.lobe_axes = Image<LobeAxes>(s.width(), s.height());
    for (std::size_t i = 0; i < s.lobe_axes.size(); ++i)
        s.lobe_axes.pixels()[i] = {0.5f * s.roughness.pixels()[i],
                                   0.01f * static_cast<float>(i % 150) - 0.7f};
    write_painting(stack.out("brushed.exr"), s);
    ASSERT_TRUE(ended(
        tangipaint({"export", stack.out("brushed.exr"), "--to", "maps", "--out", stack.out("maps")}), 0));
    const auto moved = [&](const std::string& map, const std::string& name) {
        std::filesystem::rename(stack.out("maps") + "/" + map + ".exr", stack.out(name));
        return stack.out(name);
    };
    std::vector<std::string> words = {"import",
                                      "--diffuse",
                                      moved("diffuse", "1.exr"),
                                      "--normals",
                                      moved("normal", "2.exr"),
                                      "--roughness",
                                      moved("roughness", "3.exr"),
                                      "--roughness-v",
                                      moved("roughness_v", "4.exr"),
                                      "--out",
                                      stack.out("back.exr")};
    EXPECT_TRUE(ended(tangipaint(words), 1, {"4.exr", "tangent is missing"}));
    words.insert(words.end(), {"--tangent", moved("tangent", "5.exr")});
    const Finished run = tangipaint(words);
    ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(run.json()["maps"]["tangent"], stack.out("5.exr"));
    const Surface back = read_painting(stack.out("back.exr"));
    ASSERT_EQ(back.lobe_axes.region(), s.lobe_axes.region());
    for (std::size_t i = 0; i < s.lobe_axes.size(); ++i) {
        ASSERT_NEAR(back.lobe_axes.pixels()[i].roughness_v, s.lobe_axes.pixels()[i].roughness_v, 1e-6) << i;
        ASSERT_NEAR(back.lobe_axes.pixels()[i].tangent, s.lobe_axes.pixels()[i].tangent, 1e-6) << i;
    }
    words.back() = stack.photo(0);
    EXPECT_TRUE(ended(tangipaint(words), 1, {"a tangent map holds angles in radians", ".exr"}));
}

// Two mixtures of one paint, and a layer whose name is none of a file's.
TEST(CliMaps, LayersSayWhatTheirFilesAre) {
    const TinyStack stack;
    const std::string journal = stack.out("a.jsonl"), painted = stack.out("painted.exr");
    write_bytes(journal,
                "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
                "{\"event\": \"pile\", \"on\": \"painting\", \"paint\": {\"Titanium White\": 1}, \"x\": 0, "
                "\"y\": 0, \"size_mm\": 20}\n"
                "{\"event\": \"pile\", \"on\": \"painting\", \"paint\": {\"Titanium White\": 1}, \"x\": 9, "
                "\"y\": 0, \"size_mm\": 20, \"medium\": 0.5}\n"
                "{\"event\": \"dry\", \"layer\": \"a/b\", \"part\": 0.5}\n");
    ASSERT_TRUE(ended(tangipaint({"replay", stack.truth(), journal, "--out", painted}), 0));
    const std::string out = stack.out("layers");
    ASSERT_TRUE(ended(tangipaint({"export", painted, "--to", "layers", "--out", out}), 0));
    const auto about = read_json(read_text_file(out + "/layers.json"), "JSON");
    EXPECT_EQ(about["mm_per_pixel"], read_painting(stack.truth()).mm_per_pixel);
    EXPECT_EQ(about["height_unit"], "mm");
    EXPECT_EQ(about["bands_nm"].size(), 12u);
    EXPECT_TRUE(about["files"].is_array()) << "for who reads them";
    ASSERT_EQ(about["layers"].size(), 2u);
    const auto &dried = about["layers"][0], &wet = about["layers"][1];
    EXPECT_EQ(dried["name"], "a/b");
    EXPECT_EQ(dried["wet"], false);
    EXPECT_EQ(wet["wet"], true);
    ASSERT_EQ(dried["paints"].size(), 2u);
    const auto &pure = dried["paints"][0], &thinned = dried["paints"][1];
    for (const auto& paint : dried["paints"]) {
        EXPECT_TRUE(std::filesystem::exists(out + "/" + paint["file"].get<std::string>()));
        EXPECT_EQ(paint["paint"], "Titanium White");
        EXPECT_EQ(paint["k"].size(), 12u);
        EXPECT_FALSE(paint["origin"].get<std::string>().empty());
        EXPECT_TRUE(paint["specular"].is_number() && paint["roughness"].is_number());
    }
    EXPECT_EQ(pure["medium"], 0);
    EXPECT_EQ(thinned["medium"], 0.5);
    EXPECT_NEAR(thinned["s"][3].get<double>(), 0.5 * pure["s"][3].get<double>(), 1e-3);
    EXPECT_NEAR(thinned["paint_mm3"].get<double>(), 0.5 * thinned["mm3"].get<double>(), 1e-9);
}

// A painting of unknown scale, painted on with 0.4 mm a pixel: its own heights are in pixels, its paint's in
// mm.
TEST(CliMaps, OneScaleIsToldOfAPaintingThatWasGivenOne) {
    const TinyStack stack;
    Surface s = read_painting(stack.truth());
    s.scale_known = false;
    s.mm_per_pixel = 1;
    const std::string bare = stack.out("bare.exr"), painted = stack.out("painted.exr"),
                      journal = stack.out("a.jsonl");
    write_painting(bare, s);
    write_bytes(
        journal,
        "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
        "{\"event\": \"pile\", \"on\": \"painting\", \"paint\": {\"Bone Black\": 1}, \"x\": 0, \"y\": "
        "0, \"size_mm\": 8}\n");
    ASSERT_TRUE(ended(tangipaint({"replay", bare, journal, "--mm-per-pixel", "0.4", "--out", painted}), 0));
    const std::string layers = stack.out("layers"), maps = stack.out("maps");
    ASSERT_TRUE(ended(tangipaint({"export", painted, "--to", "layers", "--out", layers}), 0));
    ASSERT_TRUE(ended(tangipaint({"export", painted, "--to", "maps", "--out", maps}), 0));
    for (const std::string& file : {layers + "/layers.json", layers + "/dry/maps.json",
                                    layers + "/painted/maps.json", maps + "/maps.json"}) {
        const auto about = read_json(read_text_file(file), "JSON");
        EXPECT_EQ(about["mm_per_pixel"], 0.4) << file;
        EXPECT_EQ(about["height_unit"], "mm") << file;
    }
    const auto map = [&](const std::string& file) { return read_picture(layers + "/" + file); };
    const Image<Rgb> dry = map("dry/height.exr"), with = map("painted/height.exr"),
                     paint = map("1-wet/thickness_mm.exr");
    const auto thickest = std::ranges::max_element(paint.pixels(), {}, &Rgb::r) - paint.pixels().begin();
    const auto i = static_cast<std::size_t>(thickest);
    EXPECT_GT(paint.pixels()[i].r, 0.1f);
    EXPECT_NEAR(with.pixels()[i].r - dry.pixels()[i].r, paint.pixels()[i].r, 1e-5f);
    EXPECT_NEAR(dry.pixels()[i].r, 0.4f * s.height_mm.pixels()[i], 1e-5f);
    const auto info = tangipaint({"info", painted}).json(), before = tangipaint({"info", bare}).json();
    EXPECT_EQ(info["mm_per_pixel"], 0.4);
    EXPECT_EQ(info["scale_from"], "given to paint with");
    EXPECT_EQ(info["height_unit"], "mm");
    EXPECT_EQ(before["height_unit"], "pixel");
    EXPECT_EQ(before["scale_from"], "nothing");
    EXPECT_NEAR(info["maps"]["height_mm"]["maximum"].get<double>(),
                0.4 * before["maps"]["height_px"]["maximum"].get<double>(), 1e-5);
    EXPECT_FALSE(before["maps"].contains("height_mm")) << "nothing is known of millimetres";
    ASSERT_TRUE(ended(tangipaint({"import", maps, "--out", stack.out("back.exr")}), 0));
    EXPECT_EQ(read_painting(stack.out("back.exr")).mm_per_pixel, 0.4);
}

// Viewers show values as they are: linear photographs would be dark.
TEST(CliMaps, PtmOfLinearPhotographsIsEncodedForViewers) {
    const TinyStack stack;
    const Finished run = tangipaint(
        {"export", stack.truth(), "--to", "ptm", "--photos", stack.path(), "--out", stack.out("a.ptm")});
    ASSERT_TRUE(ended(run, 0));
    ASSERT_EQ(read_painting(stack.truth()).photography.transfer.kind, Transfer::Kind::linear);
    EXPECT_EQ(run.json()["encoding"], "srgb");
    const Photography::Photo& photo = stack.photography().photos[3];
    Image<Rgb> wanted = read_picture(stack.photo(3));
    for (Rgb& pixel : wanted.pixels()) pixel = Transfer{Transfer::Kind::srgb}.encode(pixel);
    const Image<Rgb> shown = evaluate(read_rti_file(stack.out("a.ptm")), photo.light.direction);
    EXPECT_GT(psnr_db(shown, wanted), 20);
    EXPECT_GT(psnr_db(shown, wanted), psnr_db(shown, read_picture(stack.photo(3))) + 5);
    const auto info = tangipaint({"info", stack.out("a.ptm")}).json();
    EXPECT_EQ(info["kind"], "rti");
    EXPECT_EQ(info["basis"], "ptm");
    EXPECT_EQ(info["width"], wanted.width());
}

}  // namespace
}  // namespace tangi
