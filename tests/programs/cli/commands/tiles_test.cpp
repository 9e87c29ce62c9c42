// tiles_test.cpp: a painting as a folder of tiles, with the commands that a user has for it.
#include "surface/painting_file/painting_tiles.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

void export_to(const std::string& format, const std::string& painting, const std::string& out) {
    ASSERT_TRUE(ended(tangipaint({"export", painting, "--to", format, "--out", out}), 0));
}

TEST(CliTiles, APaintingGoesOutAndComesBackByteForByte) {
    const TinyStack stack;
    export_to("tiles", stack.truth(), stack.out("a.tangi"));
    export_to("painting", stack.out("a.tangi"), stack.out("back.exr"));
    EXPECT_EQ(bytes_of(stack.out("back.exr")), bytes_of(stack.truth()));
    EXPECT_THAT(names_in(stack.out("a.tangi")), ElementsAre("0", "painting.json"));
}

// Layers of paint, what is wet, the palette's masses: in the order in which the file has them.
TEST(CliTiles, APaintedPaintingGoesOutAndComesBackByteForByte) {
    const TinyStack stack;
    const std::string journal = stack.out("a.jsonl"), painted = stack.out("painted.exr");
    write_bytes(journal,
                "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
                "{\"event\": \"pile\", \"on\": \"painting\", \"paint\": {\"Bone Black\": 1}, \"x\": 0, "
                "\"y\": 0, \"size_mm\": 20}\n{\"event\": \"dry\", \"layer\": \"ground\", \"part\": 0.5}\n");
    ASSERT_TRUE(ended(tangipaint({"replay", stack.truth(), journal, "--out", painted}), 0));
    export_to("tiles", painted, stack.out("a.tangi"));
    export_to("painting", stack.out("a.tangi"), stack.out("back.exr"));
    EXPECT_EQ(bytes_of(stack.out("back.exr")), bytes_of(painted));
}

TEST(CliTiles, CommandsTakeAFolderAsTheyTakeAFile) {
    const TinyStack stack;
    export_to("tiles", stack.truth(), stack.out("a.tangi"));
    nlohmann::json of_file = tangipaint({"info", stack.truth()}).json(),
                   of_tiles = tangipaint({"info", stack.out("a.tangi")}).json();
    for (const char* of_the_run : {"inputs", "peak_memory_mb", "seconds"})
        of_file.erase(of_the_run), of_tiles.erase(of_the_run);
    EXPECT_EQ(of_tiles, of_file);
    const auto same_picture = [&](const std::vector<std::string>& words, const std::string& name) {
        const auto draw = [&](const std::string& painting, const std::string& out) {
            std::vector<std::string> all = {words[0], painting};
            all.insert(all.end(), words.begin() + 1, words.end());
            all.insert(all.end(), {"--out", stack.out(out + name)});
            EXPECT_TRUE(ended(tangipaint(all), 0));
            return read_picture(stack.out(out + name));
        };
        EXPECT_TRUE(images_identical(draw(stack.out("a.tangi"), "tiles"), draw(stack.truth(), "file")))
            << words[0];
    };
    const nlohmann::json inputs =
        tangipaint({"relight", stack.out("a.tangi") + "/", "--light=0,0,1", "--out", stack.out("a.png")})
            .json()["inputs"];
    ASSERT_EQ(inputs.size(), 1u) << inputs;
    EXPECT_EQ(inputs[0]["file"], "a.tangi");
    same_picture({"relight", "--light=-0.9,0.1,0.3"}, ".png");
    same_picture({"export", "--to", "snapshot"}, ".tif");
    export_to("iiif", stack.out("a.tangi"), stack.out("iiif"));
    EXPECT_TRUE(fs::exists(fs::path(stack.out("iiif")) / "manifest.json"));
    ASSERT_TRUE(
        ended(tangipaint({"compare", stack.out("a.tangi"), stack.path(), "--out", stack.out("cmp")}), 0));
}

TEST(CliTiles, ATornFolderIsNamedAndMadeWholeByTheSameCommand) {
    const TinyStack stack;
    const std::string folder = stack.out("a.tangi");
    export_to("tiles", stack.truth(), folder);
    const fs::path tile = fs::path(folder) / "0" / "0_0.exr";
    const std::string sound = bytes_of(tile);
    const auto relit = [&] {
        return tangipaint({"relight", folder, "--light", "0,0,1", "--out", stack.out("a.png")});
    };
    fs::remove(tile);
    EXPECT_TRUE(ended(relit(), 1, {"0_0.exr", "is missing", "same command"}));
    export_to("tiles", stack.truth(), folder);
    EXPECT_EQ(bytes_of(tile), sound);
    std::string flipped = sound;
    flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 4);
    write_bytes(tile, flipped);
    EXPECT_TRUE(ended(relit(), 1, {"0_0.exr", "same command"}));
    export_to("tiles", stack.truth(), folder);
    EXPECT_TRUE(ended(relit(), 0));
    fs::remove(fs::path(folder) / "painting.json");
    EXPECT_TRUE(ended(relit(), 1, {"painting.json is missing", "same command"}));
}

TEST(CliTiles, AFullDiskLeavesTheOlderPainting) {
    const TinyStack stack;
    const TinyStack other({}, 33);
    const std::string folder = stack.out("a.tangi");
    export_to("tiles", stack.truth(), folder);
    const std::string before = read_text_file(folder + "/painting.json");
    EXPECT_TRUE(
        ended(tangipaint({"export", other.truth(), "--to", "tiles", "--out", folder}, {.largest_file = 4000}),
              1, {"cannot be written"}));
    EXPECT_EQ(read_text_file(folder + "/painting.json"), before);
    export_to("tiles", other.truth(), folder);
    EXPECT_EQ(tangipaint({"info", folder}).json()["width"], 33);
}

TEST(CliTiles, ATreatmentKeepsACopyThatIsOneFile) {
    const TinyStack stack;
    const std::string folder = stack.out("a.tangi"), treatment = stack.out("a.treatment");
    export_to("tiles", stack.truth(), folder);
    const std::vector<std::string> damage = {
        "damage",  folder,           "--treatment", treatment,
        "--class", "loss_to_ground", "--polygon",   "-2,-2;2,-2;2,2;-2,2"};
    ASSERT_TRUE(ended(tangipaint(damage), 0));
    EXPECT_EQ(hash_of(read_painting(treatment + "/painting.exr")), hash_of(read_painting(stack.truth())));
    EXPECT_TRUE(ended(tangipaint(damage), 0)) << "it is found to be of this painting again";
    EXPECT_TRUE(
        ended(tangipaint({"treatment", "earlier", treatment, "--painting", folder, "--by", "A. B."}), 0));
    EXPECT_TRUE(ended(tangipaint({"treatment", "check", treatment}), 0));
}

TEST(CliTiles, TwoThatWriteOneFolderWriteItOneAfterTheOther) {
    const TinyStack stack;
    const std::string folder = stack.out("a.tangi");
    const std::vector<std::string> command = {"export", stack.truth(), "--to", "tiles", "--out", folder};
    {
        const HeldFile another = PaintingTilesWriter::claim(folder);
        Program waits(command);
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        EXPECT_TRUE(waits.running());
        EXPECT_FALSE(fs::exists(PaintingTilesWriter::partial_of(folder)));
        waits.signal(SIGINT);
        EXPECT_TRUE(ended(waits.wait(), 130));
    }
    for (const Finished& run : side_by_side({command, command, command, command})) EXPECT_TRUE(ended(run, 0));
    EXPECT_THAT(names_in(stack.root()), ElementsAre("a.tangi", "photos"));
    EXPECT_THAT(names_in(folder), ElementsAre("0", "painting.json"));
    export_to("painting", folder, stack.out("back.exr"));
    EXPECT_EQ(bytes_of(stack.out("back.exr")), bytes_of(stack.truth()));
}

TEST(CliTiles, NamesAndFoldersThatAreSomethingElseAreRefused) {
    const TinyStack stack;
    EXPECT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "tiles", "--out", stack.out("a.exr")}), 2,
                      {"--to tiles writes a .tangi"}));
    EXPECT_TRUE(ended(tangipaint({"info", stack.out("none.tangi")}), 1, {"no such file or folder"}));
    fs::create_directory(stack.out("b.tangi"));
    write_bytes(stack.out("b.tangi") + "/diary.txt", "mine");
    EXPECT_TRUE(ended(tangipaint({"export", stack.truth(), "--to", "tiles", "--out", stack.out("b.tangi")}),
                      1, {"is no painting of tiles"}));
    EXPECT_EQ(bytes_of(stack.out("b.tangi") + "/diary.txt"), "mine");
}

}  // namespace
}  // namespace tangi
