// export, import and the relighting residual, run as a user would run them.
#include "fit/exchange/ptm_rti_file.h"
#include "surface/base/json_text.h"
#include "surface/image/metrics.h"
#include "surface/render/relighting_residual.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

TEST(CliExport, PtmAndRtiOfAPaintingAndOfItsPhotographsAreReadBack) {
    const TinyStack stack;
    const auto runs =
        side_by_side({{"export", stack.truth(), "--to", "ptm", "--out", stack.out("a.ptm")},
                      {"export", stack.truth(), "--to", "ptm", "--lrgb", "--out", stack.out("b.ptm")},
                      {"export", stack.truth(), "--to", "rti", "--terms", "16", "--out", stack.out("c.rti")},
                      {"export", stack.truth(), "--to", "rti", "--photos", stack.path(), "--terms", "4",
                       "--out", stack.out("d.rti")}});
    for (const Finished& run : runs) ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(runs[3].json()["from"], "photographs");
    EXPECT_EQ(runs[3].json()["lights"], 12);
    EXPECT_LT(std::filesystem::file_size(stack.out("b.ptm")), std::filesystem::file_size(stack.out("a.ptm")));
    ASSERT_TRUE(ended(tangipaint({"relight", stack.truth(), "--light", "0.3,0.2,0.9", "--encoding", "srgb",
                                  "--out", stack.out("relit.png")}),
                      0));
    const Image<Rgb> relit = read_picture(stack.out("relit.png"));
    for (const char* file : {"a.ptm", "c.rti"})
        EXPECT_GT(
            psnr_db(evaluate(read_rti_file(stack.out(file)), glm::normalize(Vec3(0.3f, 0.2f, 0.9f))), relit),
            24)
            << file;
}

TEST(CliExport, ASnapshotIsTheRelitPicture) {
    const TinyStack stack;
    ASSERT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "snapshot", "--light", "0.3,0.2,0.9",
                                  "--out", stack.out("a.tif")}),
                      0));
    ASSERT_TRUE(ended(tangipaint({"relight", stack.truth(), "--light", "0.3,0.2,0.9", "--encoding", "srgb",
                                  "--out", stack.out("b.tif")}),
                      0));
    EXPECT_TRUE(images_identical(read_picture(stack.out("a.tif")), read_picture(stack.out("b.tif"))));
    const auto refused = [&](std::vector<std::string> flags, const std::string& said) {
        flags.insert(flags.begin(), {"export", stack.truth()});
        EXPECT_TRUE(ended(tangipaint(flags), 2, {said}));
    };
    refused({"--to", "snapshot", "--light", "0,0,-1", "--out", stack.out("c.png")}, "from behind");
    refused({"--to", "ptm", "--light", "0,0,1", "--out", stack.out("c.ptm")},
            "is of pictures: snapshot, iiif, deepzoom; --to ptm is none");
}

TEST(CliExport, MapsGoOutAndComeBack) {
    const TinyStack stack;
    ASSERT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "maps", "--out", stack.out("maps")}), 0));
    ASSERT_TRUE(
        ended(tangipaint({"export", stack.truth(), "--to", "openlime", "--out", stack.out("lime")}), 0));
    ASSERT_TRUE(ended(
        tangipaint({"import", stack.out("maps"), "--mm-per-pixel", "0.5", "--out", stack.out("a.exr")}), 0));
    const Surface truth = read_painting(stack.truth()), back = read_painting(stack.out("a.exr"));
    EXPECT_TRUE(images_near(back.diffuse, truth.diffuse, 1e-6));
    EXPECT_TRUE(images_near(back.normal, truth.normal, 1e-5));
    ASSERT_TRUE(ended(tangipaint({"import", stack.out("maps"), "--out", stack.out("c.exr")}), 0));
    EXPECT_EQ(read_painting(stack.out("c.exr")).mm_per_pixel, truth.mm_per_pixel) << "maps.json says it";
    const Finished lime = tangipaint({"import", stack.out("lime"), "--out", stack.out("b.exr")});
    ASSERT_TRUE(ended(lime, 0));
    EXPECT_EQ(lime.json()["scale_known"], truth.scale_known) << "brdf.json says it, and the encoding";
    EXPECT_TRUE(images_near(read_painting(stack.out("b.exr")).diffuse, truth.diffuse, 0.01));
    EXPECT_TRUE(ended(tangipaint({"info", stack.out("b.exr")}), 0));
}

TEST(CliExport, MapsOfWholeNumbersComeBackByTheirDescription) {
    const TinyStack stack;
    const Surface truth = read_painting(stack.truth());
    const auto [least, most] = std::ranges::minmax(truth.height_mm.pixels());
    for (const std::string format : {"tif", "png"}) {
        const std::string maps = stack.out(format), out = stack.out(format + ".exr");
        ASSERT_TRUE(ended(
            tangipaint({"export", stack.truth(), "--to", "maps", "--maps-format", format, "--out", maps}),
            0));
        ASSERT_TRUE(ended(tangipaint({"import", maps, "--out", out}), 0));
        const Surface back = read_painting(out);
        EXPECT_EQ(back.mm_per_pixel, truth.mm_per_pixel);
        EXPECT_EQ(back.scale_known, truth.scale_known);
        EXPECT_TRUE(images_near(back.height_mm, truth.height_mm, (most - least) / 65535 + 1e-6)) << format;
        EXPECT_TRUE(images_near(back.diffuse, truth.diffuse, 5e-5)) << "sRGB, " << format;
        EXPECT_TRUE(images_near(back.normal, truth.normal, 1e-4)) << format;
        EXPECT_TRUE(images_near(back.specular, truth.specular, 2e-5)) << format;
        EXPECT_TRUE(images_near(back.roughness, truth.roughness, 2e-5)) << format;
    }
    const std::string about = stack.out("png") + "/maps.json";
    nlohmann::json edited = json_or_discarded(read_text_file(about));
    edited["maps"]["height"]["to"] = edited["maps"]["height"]["from"];
    write_bytes(about, json_line(edited));
    EXPECT_TRUE(ended(tangipaint({"import", stack.out("png"), "--out", stack.out("b.exr")}), 1,
                      {"maps.json: maps.height.from", "--height-range-mm"}));
}

TEST(CliExport, LayersAndOpenRasterOfAPaintedPicture) {
    const TinyStack stack;
    const std::string journal = stack.out("a.jsonl"), painted = stack.out("painted.exr");
    write_bytes(
        journal,
        "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
        "{\"event\": \"pile\", \"on\": \"painting\", \"paint\": {\"Bone Black\": 1}, \"x\": 0, \"y\": 0, "
        "\"size_mm\": 20}\n{\"event\": \"dry\", \"layer\": \"a/b\", \"part\": 0.5}\n");
    ASSERT_TRUE(ended(tangipaint({"replay", stack.truth(), journal, "--out", painted}), 0));
    ASSERT_TRUE(ended(tangipaint({"export", painted, "--to", "ora", "--out", stack.out("a.ora")}), 0));
    EXPECT_EQ(bytes_of(stack.out("a.ora")).substr(38, 16), "image/openraster");
    ASSERT_TRUE(ended(tangipaint({"export", painted, "--to", "layers", "--out", stack.out("layers")}), 0));
    for (const char* file : {"dry/normal.exr", "1-a_b/colour.png", "1-a_b/thickness_mm.exr",
                             "2-wet/00000-Bone Black_mm.exr", "painted/height.exr"})
        EXPECT_TRUE(std::filesystem::exists(stack.out("layers/" + std::string(file)))) << file;
    EXPECT_TRUE(
        ended(tangipaint({"export", painted, "--to", "ora", "--out", stack.out("a.png")}), 2, {".ora"}));
    // Another painting in the same folder: nothing of the first stays. The same one: the same bytes.
    const std::string out = stack.out("layers"), colour = out + "/1-a_b/colour.png";
    const std::string first = bytes_of(colour), height = bytes_of(out + "/painted/height.exr");
    ASSERT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "layers", "--out", out}), 0));
    EXPECT_FALSE(std::filesystem::exists(colour));
    const auto bare = everything_in(out);
    const Conditions full{.largest_file = 3000};
    EXPECT_TRUE(ended(tangipaint({"export", painted, "--to", "layers", "--out", out}, full), 1,
                      {out + "/", "cannot be written"}));
    EXPECT_TRUE(
        ended(tangipaint({"export", painted, "--to", "layers", "--out", stack.out("other")}, full), 1));
    EXPECT_FALSE(std::filesystem::exists(stack.out("other")));
    EXPECT_EQ(everything_in(out), bare);
    EXPECT_TRUE(leftovers_in(stack.root()).empty());
    const Finished again = tangipaint({"export", painted, "--to", "layers", "--out", out});
    ASSERT_TRUE(ended(again, 0));
    EXPECT_EQ(bytes_of(colour), first);
    EXPECT_EQ(bytes_of(out + "/painted/height.exr"), height);
    for (const auto& file : again.json()["files"])
        EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
    write_bytes(out + "/mine.txt", "mine");
    EXPECT_TRUE(ended(tangipaint({"export", painted, "--to", "layers", "--out", out}), 1,
                      {out, "mine.txt", "another"}));
}

TEST(CliExport, FoldersOfMapsAreWholeOrNot) {
    const TinyStack stack;
    const Conditions full{.largest_file = 500};
    for (const std::string to : {"maps", "openlime", "layers"}) {
        const std::string out = stack.out(to);
        const std::vector<std::string> command = {"export", stack.truth(), "--to", to, "--out", out};
        EXPECT_TRUE(ended(tangipaint(command, full), 1, {out + "/", "cannot be written"})) << to;
        EXPECT_FALSE(std::filesystem::exists(out)) << to;
        EXPECT_TRUE(leftovers_in(stack.root()).empty()) << to;
        ASSERT_TRUE(ended(tangipaint(command), 0)) << to;
        const auto files = everything_in(out);
        EXPECT_TRUE(ended(tangipaint(command, full), 1));
        EXPECT_EQ(everything_in(out), files) << to;
        write_bytes(out + "/mine.txt", "mine");
        EXPECT_TRUE(ended(tangipaint(command), 1, {out + ": holds mine.txt"})) << to;
        EXPECT_EQ(bytes_of(out + "/mine.txt"), "mine");
        std::filesystem::remove(out + "/mine.txt");
        EXPECT_TRUE(ended(tangipaint(command), 0)) << to;
        EXPECT_EQ(everything_in(out), files) << to;
    }
}

TEST(CliExport, FlagsWithoutEffectAreRefused) {
    const TinyStack stack;
    const auto refused = [&](const std::string& to, std::vector<std::string> flags) {
        std::vector<std::string> words = {
            "export", stack.truth(), "--to",
            to,       "--out",       stack.out(to == "rti" || to == "ptm" ? "a." + to : "folder")};
        words.insert(words.end(), flags.begin(), flags.end());
        EXPECT_TRUE(ended(tangipaint(words), 2, {flags.front() + ": is"})) << to << " " << flags.front();
    };
    for (const std::string to : {"maps", "web"}) {
        refused(to, {"--terms", "9"});
        refused(to, {"--directions", "80"});
        refused(to, {"--lights", stack.lights()});
        refused(to, {"--lrgb"});
        if (to != "web") refused(to, {"--light-azimuth-deg", "90"});
    }
    refused("ptm", {"--terms", "9"});
    refused("rti", {"--lights", stack.lights()});
    refused("rti", {"--directions", "80", "--photos", stack.path()});
    refused("web", {"--largest-page-mb", "20"});
    EXPECT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "maps", "--out", stack.out("maps")}), 0));
    const auto import = [&](std::vector<std::string> flags) {
        std::vector<std::string> words = {"import", stack.out("maps"), "--out", stack.out("a.exr")};
        words.insert(words.end(), flags.begin(), flags.end());
        EXPECT_TRUE(ended(tangipaint(words), 2, {flags.front() + ": "})) << flags.front();
    };
    import({"--alpha-min", "0.02"});
    import({"--height-range-mm", "2"});
    import({"--gloss", stack.photo(0), "--roughness", stack.photo(1)});
    EXPECT_TRUE(ended(
        tangipaint({"import", stack.out("maps"), "--height", stack.truth(), "--out", stack.out("a.exr")}), 1,
        {"truth.exr: is a painting, not a map", "--to maps"}));
    EXPECT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "web", "--out", stack.photo(0)}), 1,
                      {stack.photo(0) + ": is a file"}));
    EXPECT_TRUE(ended(tangipaint({"palette", "--card-px", "200"}), 2, {"--card-px: is of the drawdown"}));
    EXPECT_FALSE(std::filesystem::exists(stack.out("a.exr")));
}

TEST(CliExport, AWebPageIsAFolderOrOneFile) {
    const TinyStack stack;
    const auto runs = side_by_side(
        {{"export", stack.truth(), "--to", "web", "--out", stack.out("page"), "--title", "A <painting>"},
         {"export", stack.truth(), "--to", "web", "--shadow-side", "0", "--out", stack.out("page.html")}});
    for (const Finished& run : runs) ASSERT_TRUE(ended(run, 0));
    EXPECT_EQ(runs[0].json()["files"].size(), 2u);
    EXPECT_NE(read_text_file(stack.out("page/index.html")).find("A \\u003cpainting>"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(stack.out("page/parts/0/0_0.js")));
    EXPECT_FALSE(std::filesystem::exists(stack.out("parts")));
    EXPECT_EQ(runs[1].json()["bytes"], std::filesystem::file_size(stack.out("page.html")));
    EXPECT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "web", "--largest-page-mb", "9999",
                                  "--out", stack.out("page.html")}),
                      2, {"--largest-page-mb"}));
}

TEST(CliExport, WhatMakesNoSenseIsRefused) {
    const TinyStack stack;
    const auto run = [&](std::vector<std::string> words) { return tangipaint(words); };
    EXPECT_TRUE(
        ended(run({"export", stack.truth(), "--to", "rti", "--terms", "7", "--out", stack.out("a.rti")}), 2,
              {"4, 9 or 16"}));
    EXPECT_TRUE(ended(run({"export", stack.truth(), "--to", "rti", "--lrgb", "--out", stack.out("a.rti")}), 2,
                      {"--lrgb"}));
    EXPECT_TRUE(ended(
        run({"export", stack.truth(), "--to", "maps", "--photos", stack.path(), "--out", stack.out("m")}), 2,
        {"--photos"}));
    EXPECT_TRUE(
        ended(run({"export", stack.truth(), "--to", "layers", "--title", "Storm", "--out", stack.out("m")}),
              2, {"--title"}));
    EXPECT_TRUE(
        ended(run({"export", stack.truth(), "--to", "ptm", "--out", stack.out("a.jpg")}), 2, {".ptm"}));
    EXPECT_TRUE(ended(run({"export", stack.truth(), "--to", "rti", "--terms", "16", "--photos", stack.path(),
                           "--out", stack.out("a.rti")}),
                      1, {"12 photographs are too few"}));
    EXPECT_TRUE(ended(run({"import", stack.path(), "--out", stack.out("a.exr")}), 1, {"no diffuse map"}));
    EXPECT_TRUE(ended(run({"import", "--diffuse", stack.photo(0), "--normals", stack.out("none.png"), "--out",
                           stack.out("a.exr")}),
                      1, {"none.png: no such file"}));
    EXPECT_TRUE(
        ended(run({"relight", stack.truth(), "--residual", "--light", "0,0,1", "--out", stack.out("a.png")}),
              1, {"has no part 'residual'", "without --no-residual"}));
    EXPECT_TRUE(leftovers_in(stack.root()).empty());
}

TEST(CliResidual, IsFittedRelitAndComparedWithoutBeingAskedFor) {
    const TinyStack stack([](GeneratorOptions& o) { o.lights = 24; });
    // Further light in every photograph, smooth over its direction, that no surface under one light explains.
    for (int i = 0; i < 24; ++i) {
        Image<Rgb> photo = read_picture(stack.photo(i));
        const Vec3 l = stack.photography().photos[static_cast<std::size_t>(i)].light.direction;
        for (int y = 0; y < photo.height(); ++y)
            for (int x = 0; x < photo.width(); ++x)
                photo(x, y) += Rgb(0.06f * (1 + std::sin(0.8f * static_cast<float>(x)) * l.x * l.x -
                                            std::cos(0.9f * static_cast<float>(y)) * l.x * l.y));
        write_picture(stack.photo(i), photo, Transfer{});
    }
    const Finished fit = tangipaint({"fit", stack.path(), "--transfer", "linear", "--register", "off",
                                     "--lights-as-given", "--out", stack.out("a.exr")});
    ASSERT_TRUE(fit.code == 0 || fit.code == 3) << fit.err;
    ASSERT_EQ(fit.json()["residual"]["used"], true) << fit.out;
    EXPECT_GT(fit.json()["residual"]["bytes"], 0);
    const Finished compare = tangipaint(
        {"compare", stack.out("a.exr"), stack.path(), "--transfer", "linear", "--out", stack.out("report")});
    ASSERT_TRUE(compare.code == 0 || compare.code == 3) << compare.err;
    const nlohmann::json mean = compare.json()["mean"]["fitted"];
    EXPECT_GT(mean["residual_psnr_db"].get<double>(), mean["psnr_db"].get<double>() + 1);
    EXPECT_TRUE(compare.json()["photos"][0].contains("residual_psnr_db"));
    const auto relit = [&](const std::string& painting, std::vector<std::string> more) {
        std::vector<std::string> words = {"relight", stack.out(painting), "--light", "0.5,0.3,0.8",
                                          "--out",   stack.out("r.exr")};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_TRUE(ended(tangipaint(words), 0));
        return read_picture(stack.out("r.exr"));
    };
    const Image<Rgb> whole = relit("a.exr", {}), surface = relit("a.exr", {"--no-residual"});
    EXPECT_FALSE(images_near(whole, surface, 1e-3));
    EXPECT_TRUE(images_identical(relit("a.exr", {"--residual"}), whole));
    // Of what it was not fitted with, it is none.
    EXPECT_TRUE(images_identical(relit("a.exr", {"--no-cast-shadows"}),
                                 relit("a.exr", {"--no-cast-shadows", "--no-residual"})));
    EXPECT_TRUE(ended(tangipaint({"relight", stack.out("a.exr"), "--residual", "--no-cast-shadows", "--light",
                                  "0,0,1", "--out", stack.out("x.png")}),
                      2, {"--residual", "--cast-shadows"}));
    const Finished without =
        tangipaint({"fit", stack.path(), "--no-residual", "--transfer", "linear", "--register", "off",
                    "--lights-as-given", "--out", stack.out("b.exr")});
    ASSERT_TRUE(without.code == 0 || without.code == 3) << without.err;
    EXPECT_FALSE(without.json().contains("residual"));
    EXPECT_TRUE(images_identical(relit("b.exr", {}), surface));
}

}  // namespace
}  // namespace tangi
