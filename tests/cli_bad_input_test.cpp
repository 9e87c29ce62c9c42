// Everything that can be wrong with photographs, lights and paintings: the message names the file, the place,
// the remedy.
#include <algorithm>

#include "cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

// fit refuses the stack with exit code 1 and all of `words`, and leaves nothing behind.
void expect_refused(const TinyStack& stack, const std::vector<std::string>& words,
                    std::vector<std::string> flags = {}, const std::string& folder = {}) {
    const auto before = everything_in(stack.root());
    flags.insert(flags.begin(), {"fit", folder.empty() ? stack.path() : folder, "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(tangipaint(flags), 1, words));
    EXPECT_EQ(everything_in(stack.root()), before);
}

// fit goes on, with a warning that says all of `words`, on stderr and in the result.
nlohmann::json expect_warned(const TinyStack& stack, const std::vector<std::string>& words) {
    const Finished run = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")});
    EXPECT_TRUE(ended(run, 0, words));
    const nlohmann::json result = run.json();
    bool told = false;
    for (const auto& warning : result["warnings"])
        told = told || std::all_of(words.begin(), words.end(), [&](const std::string& word) {
                   return warning.get<std::string>().find(word) != std::string::npos;
               });
    EXPECT_TRUE(told) << result["warnings"];
    return result;
}

TEST(CliBadFolder, DoesNotExist) {
    const TinyStack stack;
    expect_refused(stack, {"nowhere: no such folder"}, {}, stack.out("nowhere"));
    expect_refused(stack, {"img_000.png: is not a folder", "give the folder that holds"}, {}, stack.photo(0));
    expect_refused(stack, {"File name too long"}, {}, std::string(300, 'a'));
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

TEST(CliBadFolder, LacksAListedPhotograph) {
    const TinyStack stack;
    fs::remove(stack.photo(3));
    fs::remove(stack.photo(5));
    expect_refused(stack, {"lights.lp: 2 of 12 listed photographs are not in", stack.name(3), stack.name(5),
                           "Put them there, or remove their lines"});
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

TEST(CliBadLights, LineIsNamed) {
    const TinyStack stack;
    const std::vector<WrongLine> all = {
        WrongLine{"Zero", "img_003.png 0 0 0", {"'img_003.png' is a zero vector", "remove the line"}},
        WrongLine{"NotANumber", "img_003.png nan 0 1", {"'img_003.png' is not finite", "remove the line"}},
        WrongLine{"Infinite", "img_003.png 0 -inf 1", {"'img_003.png' is not finite", "remove the line"}},
        WrongLine{"Word", "img_003.png 0 up 1", {"expected 'name x y z'", "'up' is not a number"}},
        WrongLine{"Short", "img_003.png 0 1", {"expected 'name x y z'", "'img_003.png' is not a number"}},
        WrongLine{"Nameless", "0.1 0 1", {"expected 'name x y z'", "name is missing"}},
        WrongLine{"Twice", "img_001.png 0 0 1", {"'img_001.png' has a light in line 3 already"}}};
    for (const WrongLine& wrong : all) {
        SCOPED_TRACE(wrong.name);
        stack.change_lights([&](auto& lines) { lines[4] = wrong.line; });
        std::vector<std::string> said = wrong.said;
        said.push_back("lights.lp, line 5: ");
        expect_refused(stack, said);
    }
}

TEST(CliBadLights, FromBelowAreLeftOut) {
    const TinyStack stack;
    stack.change_lights([&](auto& lines) { lines[3] = stack.name(2) + " 0.6 0 -0.8"; });
    const auto result = expect_warned(
        stack, {"lights.lp: left out 1 photograph lit from below", stack.name(2) + " (z = -0.8000)"});
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

TEST(CliBadLights, TooManyHeldOut) {
    const TinyStack stack;
    expect_refused(stack, {"3 usable photographs; at least 4"}, {"--hold-out", "3:1"});
    expect_refused(stack, {"0 usable photographs; at least 4"}, {"--hold-out", "0:1"});
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

TEST(CliBadPhoto, HasAnotherSize) {
    const TinyStack stack;
    write_picture(stack.photo(4), Image<Rgb>(32, 31, Rgb(0.5f)), Transfer{});
    expect_refused(stack, {stack.name(4) + ": is 32 x 31", "img_000.png is 32 x 32", "the same size"});
}

TEST(CliBadPhoto, IsGreyAmongColour) {
    const TinyStack stack;
    write_map(stack.photo(6), Image<float>(32, 32, 0.5f));
    expect_refused(stack,
                   {stack.name(6) + ": is 32 x 32, grey", "img_000.png is 32 x 32, colour", "convert it"});
}

TEST(CliBadPhoto, HasAnotherDepth) {
    const TinyStack stack;
    write_picture(stack.photo(6), Image<Rgb>(32, 32, Rgb(0.5f)), Transfer{}, {.bits = 8});
    expect_refused(stack, {stack.name(6) + ": has 8 bits a sample, but img_000.png has 16", "stored alike"});
}

TEST(CliBadPhoto, IsATruncatedJpeg) {
    const TinyStack stack([](GeneratorOptions& o) { o.format = PhotoFormat::jpg; });
    const std::string whole = bytes_of(stack.photo(2));
    for (const std::size_t kept : {whole.size() - 2, whole.size() - 100, whole.size() * 9 / 10}) {
        write_bytes(stack.photo(2), whole.substr(0, kept));
        expect_refused(stack, {stack.name(2), "truncated", "copy it again"});
    }
    write_bytes(stack.photo(2), whole.substr(0, 300));  // not even all of its header
    expect_refused(stack, {stack.name(2), "is not a picture", "Premature end"});
    write_bytes(stack.photo(2), "");
    expect_refused(stack, {stack.name(2), "is not a picture"});
}

TEST(CliBadPhoto, IsTruncatedInAnyFormat) {
    for (const PhotoFormat format : {PhotoFormat::png16, PhotoFormat::tif, PhotoFormat::exr}) {
        const TinyStack stack([&](GeneratorOptions& o) { o.format = format; });
        const std::string whole = bytes_of(stack.photo(2));
        write_bytes(stack.photo(2), whole.substr(0, whole.size() * 2 / 3));
        SCOPED_TRACE(name_of(format));
        expect_refused(stack, {stack.name(2)});
    }
}

TEST(CliBadPhoto, IsBlack) {
    const TinyStack stack;
    write_picture(stack.photo(1), Image<Rgb>(32, 32), Transfer{});
    const auto result =
        expect_warned(stack, {stack.path(), "left out 1 photograph that is black", stack.name(1)});
    EXPECT_EQ(result["photographs"]["fitted"], 11);
    for (int i = 0; i < 12; ++i) write_picture(stack.photo(i), Image<Rgb>(32, 32), Transfer{});
    fs::remove(stack.out("a.exr"));
    expect_refused(stack, {"photographs are black"});
}

TEST(CliBadPhoto, IsAFolderOrAText) {
    const TinyStack stack;
    write_bytes(stack.photo(2), "this is no picture");
    expect_refused(stack, {stack.name(2), "is not a picture that can be read"});
    fs::remove(stack.photo(2));
    fs::create_directory(stack.photo(2));
    expect_refused(stack, {stack.name(2)});
}

// Archives from Windows bring names in the code page of their day.
TEST(CliBadPhoto, HasANameThatIsNotUnicode) {
    const TinyStack stack;
    const std::string name = "caf\xe9 1.png";
    fs::rename(stack.photo(2), fs::path(stack.path()) / name);
    stack.change_lights([&](auto& lines) { lines[3].replace(0, stack.name(2).size(), name); });
    const Finished fit = tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--hold-out", "0"});
    ASSERT_TRUE(ended(fit, 0));
    EXPECT_EQ(fit.json()["photographs"]["fitted"], 11);
    const Finished compared =
        tangipaint({"compare", stack.out("a.exr"), stack.path(), "--out", stack.out("c")});
    ASSERT_TRUE(ended(compared, 0));
    EXPECT_EQ(compared.json()["mean"]["fitted"]["count"], 11);  // it is known by its name
    ASSERT_TRUE(ended(tangipaint({"info", stack.out("a.exr")}), 0));
    EXPECT_TRUE(ended(
        tangipaint({"relight", stack.out("a.exr"), "--lights", stack.lights(), "--out", stack.out("d")}), 0));
    EXPECT_TRUE(fs::exists(fs::path(stack.out("d")) / name));
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
