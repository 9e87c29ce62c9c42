// What a command writes never replaces what it reads: photographs cannot be taken again.
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

// Runs a command that must end with exit code 1 and say all of `words`; no file may have changed.
void expect_not_overwritten(const TinyStack& stack, const std::vector<std::string>& command,
                            std::vector<std::string> words) {
    const auto contents = [&] {
        std::map<std::string, std::string> all;
        for (const std::string& path : everything_in(stack.root()))
            all[path] = path.ends_with('/') ? "" : bytes_of(stack.root() / path);
        return all;
    };
    const auto before = contents();
    words.push_back("--out");
    words.push_back("choose another");
    EXPECT_TRUE(ended(tangipaint(command), 1, words)) << testing::PrintToString(command);
    EXPECT_TRUE(contents() == before) << testing::PrintToString(command);
}

TEST(CliOverwrite, FitDoesNotReplaceItsPhotographs) {
    const TinyStack stack([](GeneratorOptions& o) { o.format = GeneratorFormat::exr; });
    const std::string folder = stack.path();
    write_map(stack.out("mask.exr"), Image<float>(32, 32, 1));
    fs::copy_file(stack.photo(1), folder + "/spare.exr");  // a photograph that is not listed
    fs::create_directory_symlink(folder, stack.out("link"));
    stack.change_lights([&](auto& lines) { lines[12].insert(lines[12].rfind(' ') + 1, "-"); });  // from below
    expect_not_overwritten(stack, {"fit", folder, "--out", stack.photo(0)},
                           {"would overwrite " + stack.photo(0)});
    expect_not_overwritten(stack, {"fit", folder, "--out", stack.out("link/" + stack.name(3))},
                           {stack.photo(3)});
    expect_not_overwritten(stack, {"fit", folder, "--out", stack.photo(4), "--hold-out", "4"},
                           {stack.photo(4)});
    expect_not_overwritten(stack, {"fit", folder, "--out", folder + "/spare.exr"}, {folder + "/spare.exr"});
    expect_not_overwritten(stack, {"fit", folder, "--out", stack.photo(11)}, {stack.photo(11)});
    expect_not_overwritten(stack,
                           {"fit", folder, "--mask", stack.out("mask.exr"), "--out", stack.out("mask.exr")},
                           {"mask.exr"});
    // A painting beside the photographs may be made again.
    for (int run = 0; run < 2; ++run)
        EXPECT_TRUE(ended(tangipaint({"fit", folder, "--out", folder + "/painting.exr"}), 0));
}

TEST(CliOverwrite, RelightDoesNotReplaceThePainting) {
    const TinyStack stack;
    expect_not_overwritten(stack, {"relight", stack.truth(), "--light", "1,0,1", "--out", stack.truth()},
                           {"would overwrite " + stack.truth()});
    fs::create_hard_link(stack.truth(), stack.out("img_000.png"));
    expect_not_overwritten(
        stack, {"relight", stack.truth(), "--lights", stack.lights(), "--out", stack.root().string()},
        {"would overwrite " + stack.truth()});
}

TEST(CliOverwrite, RelightDoesNotReplaceThePhotographsBesideTheLightsFile) {
    const TinyStack stack;
    const auto relight = [&](const std::string& lights, const std::string& out) {
        return std::vector<std::string>{"relight", stack.truth(), "--lights", lights, "--out", out};
    };
    expect_not_overwritten(stack, relight(stack.lights(), stack.path()),
                           {"the photograph " + stack.photo(0)});
    expect_not_overwritten(stack, relight(stack.lights(), stack.path() + "/heldout/.."), {"img_000.png"});
    // Names with folders, and those that open_stack() takes loosely.
    write_bytes(stack.out("above.lp"), "1\nphotos/img_002.png 0 0 1\n");
    expect_not_overwritten(stack, relight(stack.out("above.lp"), stack.path()), {stack.photo(2)});
    for (const char* loose : {"C:\\of may\\img_003.png", "img_003.jpg", "img_003.PNG"}) {
        write_bytes(stack.path() + "/loose.lp", fmt::format("1\n{} 0 0 1\n", loose));
        expect_not_overwritten(stack, relight(stack.path() + "/loose.lp", stack.path()), {stack.photo(3)});
    }
    fs::remove(stack.path() + "/loose.lp");
    // A second run replaces what the first one made, also beside photographs of another format.
    for (int run = 0; run < 2; ++run)
        EXPECT_TRUE(ended(tangipaint(relight(stack.lights(), stack.out("relit"))), 0));
    const TinyStack jpegs([](GeneratorOptions& o) { o.format = GeneratorFormat::jpg; });
    for (int run = 0; run < 2; ++run)
        EXPECT_TRUE(ended(tangipaint(relight(jpegs.lights(), jpegs.path())), 0));
    EXPECT_TRUE(fs::exists(jpegs.photo(0)));
}

TEST(CliOverwrite, CompareDoesNotReplaceWhatItCompares) {
    const TinyStack stack;
    fs::copy_file(stack.truth(), stack.out("compare.json"));
    expect_not_overwritten(
        stack, {"compare", stack.out("compare.json"), stack.path(), "--out", stack.root().string()},
        {"would overwrite " + stack.out("compare.json")});
    fs::remove(stack.out("compare.json"));
    const std::string pictures = stack.out("pictures");
    fs::rename(stack.folder(), pictures);
    expect_not_overwritten(stack,
                           {"compare", pictures + "/gt/truth.exr", pictures, "--out", stack.root().string()},
                           {"among the photographs", pictures + "/img_000.png"});
    for (int run = 0; run < 2; ++run)
        EXPECT_TRUE(
            ended(tangipaint({"compare", pictures + "/gt/truth.exr", pictures, "--out", stack.out("c")}), 0));
}

TEST(CliOverwrite, GenerateDoesNotReplacePhotographsThatItDidNotMake) {
    const TinyStack stack;
    const std::vector<std::string> generate = {"generate", "--out", stack.path(),      "--width", "32",
                                               "--height", "32",    "--supersampling", "1"};
    for (int run = 0; run < 2; ++run) EXPECT_TRUE(ended(tangipaint(generate), 0));  // these it made
    EXPECT_FALSE(fs::exists(stack.path() + "/gt/truth.exr")) << "of the stack before";
    fs::remove_all(stack.path() + "/gt");
    expect_not_overwritten(stack, generate, {"would overwrite " + stack.path(), "not a generated stack's"});
    fs::remove(stack.lights());
    expect_not_overwritten(stack, generate, {"would overwrite " + stack.path() + "/img_0"});
}

TEST(CliOverwrite, GenerateLeavesNothingOfAnEarlierStack) {
    const TestDir dir;
    const std::string out = (dir / "s").string();
    const auto generate = [&](const std::string& lights, const std::string& held_out,
                              const std::string& format) {
        return tangipaint({"generate", "--out", out, "--width", "16", "--height", "16", "--supersampling",
                           "1", "--lights", lights, "--held-out", held_out, "--format", format});
    };
    ASSERT_TRUE(ended(generate("8", "3", "png16"), 0));
    write_bytes(out + "/notes.png", "mine");
    ASSERT_TRUE(ended(generate("5", "0", "tif"), 0));
    std::vector<std::string> pictures;
    for (const auto& entry : fs::directory_iterator(out))
        if (entry.path().filename().string().starts_with("img_"))
            pictures.push_back(entry.path().extension().string());
    EXPECT_EQ(pictures, std::vector<std::string>(5, ".tif"));
    EXPECT_FALSE(fs::exists(out + "/heldout"));
    EXPECT_EQ(bytes_of(out + "/notes.png"), "mine");
}

}  // namespace
}  // namespace tangi
