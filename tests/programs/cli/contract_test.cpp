// What the program promises before any command does its work: help, usage errors, exit codes, where it
// writes.
#include <gmock/gmock.h>

#include "tests/docs/docs_pages.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(CliHelp, ListsEveryCommandOnStdout) {
    for (const std::vector<std::string>& asked : {std::vector<std::string>{"help"}, {"--help"}}) {
        const Finished help = tangipaint(asked);
        EXPECT_TRUE(ended(help, 0));
        EXPECT_EQ(help.err, "");
        EXPECT_THAT(docs::commands_of_help(help.out), testing::IsSupersetOf({"calibrate", "fit", "paint"}));
    }
}

TEST(CliHelp, ExplainsEachCommandTheSameWayByBothSpellings) {
    for (const std::string& command : docs::commands_of_help(tangipaint({"--help"}).out)) {
        if (command == "help") continue;
        const Finished help = tangipaint({"help", command}), flag = tangipaint({command, "--help"});
        EXPECT_TRUE(ended(help, 0)) << command;
        EXPECT_TRUE(ended(flag, 0)) << command;
        EXPECT_THAT(help.out, HasSubstr("Usage: tangipaint " + command));
        EXPECT_THAT(help.out, HasSubstr("--threads"));
        EXPECT_EQ(help.out, flag.out);
    }
    EXPECT_THAT(tangipaint({"help", "fit"}).out, HasSubstr("--hold-out"));
}

TEST(CliHelp, SaysItsVersion) {
    const Finished version = tangipaint({"--version"});
    EXPECT_TRUE(ended(version, 0));
    EXPECT_THAT(version.out, testing::MatchesRegex("tangipaint [0-9]+\\.[0-9]+\\.[0-9]+(-dev)?\n"));
}

TEST(CliUsage, WithoutACommandHelpIsOnStderr) {
    EXPECT_TRUE(ended(tangipaint({}), 2, {"tangipaint fit PHOTOS --out painting.exr"}));
}

TEST(CliUsage, UnknownWordsAreNamedWithTheWayToHelp) {
    for (const std::vector<std::string>& typed :
         {std::vector<std::string>{"fot", "s"}, {"help", "fot"}, {"fot", "--help"}})
        EXPECT_TRUE(ended(tangipaint(typed), 2,
                          {"there is no command 'fot'; did you mean 'fit'?", "tangipaint help"}));
    EXPECT_TRUE(ended(tangipaint({"relihgt"}), 2, {"did you mean 'relight'?"}));
    EXPECT_TRUE(ended(tangipaint({"photographs"}), 2, {"there is no command 'photographs'. See"}));
    for (const char* typed : {"fti", "ift"})  // neighbours exchanged
        EXPECT_TRUE(ended(tangipaint({typed}), 2, {"; did you mean 'fit'? See: tangipaint help"})) << typed;
    EXPECT_TRUE(ended(tangipaint({"fit", "photos", "--out", "a.exr", "--turbo"}), 2, {"--turbo"}));
    EXPECT_TRUE(ended(tangipaint({"relight", "a.exr", "--out", "b.png", "--lihgt", "1,0,1"}), 2,
                      {"--lihgt: relight has no such option; did you mean --light?"}));
    EXPECT_TRUE(ended(tangipaint({"info", "a", "b"}), 2, {"'b': is more than info takes"}));
}

TEST(CliUsage, WhatIsMissingIsNamed) {
    EXPECT_TRUE(ended(tangipaint({"fit"}), 2, {"PHOTOS"}));
    EXPECT_TRUE(ended(tangipaint({"fit", "photos"}), 2, {"--out"}));
    EXPECT_TRUE(ended(tangipaint({"compare", "a.exr", "photos"}), 2, {"--out"}));
    EXPECT_TRUE(ended(tangipaint({"compare", "a.exr", "--out", "dir"}), 2, {"PHOTOS"}));
    EXPECT_TRUE(ended(tangipaint({"relight", "a.exr", "--light", "0,0,1"}), 2, {"--out"}));
    EXPECT_TRUE(ended(tangipaint({"info"}), 2, {"FILE"}));
    EXPECT_TRUE(ended(tangipaint({"generate"}), 2, {"--out"}));
    EXPECT_TRUE(ended(tangipaint({"generate", "--out"}), 2, {"--out: has no value"}));
    EXPECT_TRUE(ended(tangipaint({"compare", "a.exr", "photos", "--ot", "dir"}), 2,
                      {"--out is required; --ot: compare has no such option; did you mean --out?"}));
}

TEST(CliUsage, WhatIsGivenTwiceIsNamedWithBothValues) {
    EXPECT_TRUE(ended(
        tangipaint({"replay", "--substrate", "linen", "--substrate", "paper", "a.jsonl", "--out", "a.exr"}),
        2,
        {"--substrate: is given 2 times (linen, paper), and can be one only; give it once",
         "replay --help"}));
    EXPECT_TRUE(ended(tangipaint({"fit", "photos", "--out", "a.exr", "--out", "b.exr"}), 2,
                      {"--out: is given 2 times (a.exr, b.exr)"}));
}

struct WrongFlag {
    std::vector<std::string> arguments;
    std::vector<std::string> said;
};

// The flag, and what it may be, are in the message; no file needs to exist for it.
const std::vector<WrongFlag>& wrong_flags() {
    static const std::vector<WrongFlag> all = {
        WrongFlag{{"fit", "p", "--out", "a.exr", "--threads", "0"}, {"--threads", "0 is not in [1, 1024]"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--threads", "two"}, {"--threads", "two"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--max-iterations", "0"},
                  {"--max-iterations", "0 is not in ["}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--white-level", "-1"},
                  {"--white-level", "-1 is not in [1e-09, 1000000000]"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--white-level", "nan"},
                  {"--white-level", "nan is not in [1e-09, 1000000000]"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--white-level", "bright"},
                  {"--white-level", "bright is not in ["}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--white-level", "1x"}, {"--white-level", "1x"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--mm-per-pixel", "0"}, {"--mm-per-pixel", "[1e-06, 1000]"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--mm-per-pixel", "0,3"},
                  {"--mm-per-pixel", "0,3 has a decimal comma: write 0.3 with a point"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--mm-per-pixel", "1.234,5"},
                  {"--mm-per-pixel", "1.234,5 has marks between thousands: write 1234.5"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--crop", "0,5,0,8,8"},
                  {"--crop 0,5,0,8,8: expected X,Y,WIDTH,HEIGHT; these are 5 numbers", "with a point"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--white-level", "2,5"}, {"--white-level", "write 2.5"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--crop", "1,2,3"}, {"--crop 1,2,3", "X,Y,WIDTH,HEIGHT"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--crop", "0,0,8.5,8"}, {"--crop", "whole numbers"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--crop", "0,0,8,x"}, {"--crop", "'x' is not a number"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--transfer", "log"},
                  {"--transfer log", "srgb", "[0.2, 5]"}},
        WrongFlag{{"fit", "p", "--out", "a.exr", "--transfer", "9"}, {"--transfer 9", "[0.2, 5]"}},
        WrongFlag{{"generate", "--out", "d", "--width", "1"}, {"--width", "1 is not in [2, 32768]"}},
        WrongFlag{{"generate", "--out", "d", "--seed", "-1"}, {"--seed", "-1"}},
        WrongFlag{{"generate", "--out", "d", "--format", "gif"}, {"--format gif", "png16"}},
        WrongFlag{{"generate", "--out", "d", "--reflectance", "phong"}, {"--reflectance phong", "ggx"}},
        WrongFlag{{"generate", "--out", "d", "--arrangement", "row"}, {"--arrangement row", "spiral"}},
        WrongFlag{{"generate", "--out", "d", "--transfer", "log"}, {"--transfer log", "srgb"}},
        WrongFlag{{"compare", "a.exr", "p", "--out", "d", "--picture-size", "1"},
                  {"--picture-size", "[16, 16384]"}},
        WrongFlag{{"relight", "a.exr", "--light", "0,0,1", "--out", "a.png", "--gain", "-1"},
                  {"--gain", "10000"}},
        WrongFlag{{"relight", "a.exr", "--light", "0,0,1", "--out", "a.png", "--gain", "nan"},
                  {"--gain", "nan is not in [0, 10000]"}},
        WrongFlag{{"relight", "a.exr", "--light", "0,0,1", "--out", "a.png", "--model", "phong"},
                  {"--model phong", "duer"}},
        WrongFlag{{"relight", "a.exr", "--light", "0,0,1", "--out", "a.png", "--ambient", "2"},
                  {"--ambient", "[0, 1]"}},
        WrongFlag{{"relight", "a.exr", "--out", "a.png"}, {"--light X,Y,Z", "--lights FILE.lp"}},
        WrongFlag{{"relight", "a.exr", "--out", "a", "--light", "0,0,1", "--lights", "a.lp"}, {"either"}}};
    return all;
}

TEST(CliUsage, WrongFlagsAreNamedWithTheirRange) {
    std::vector<std::vector<std::string>> commands;
    for (const WrongFlag& wrong : wrong_flags()) commands.push_back(wrong.arguments);
    const std::vector<Finished> runs = side_by_side(commands);
    for (std::size_t i = 0; i < runs.size(); ++i)
        EXPECT_TRUE(ended(runs[i], 2, wrong_flags()[i].said)) << testing::PrintToString(commands[i]);
}

TEST(CliUsage, WrongVectorsOfRelightAreUsageErrors) {
    const TinyStack stack;
    const auto relit = [&](const std::string& flag, const std::string& vector) {
        return tangipaint({"relight", stack.truth(), flag + "=" + vector, "--out", stack.out("a.png")});
    };
    EXPECT_TRUE(ended(relit("--light", "0,0"), 2, {"--light 0,0", "X,Y,Z"}));
    EXPECT_TRUE(ended(relit("--light", "0,0,up"), 2, {"'up' is not a number"}));
    EXPECT_TRUE(ended(relit("--light", "0,0,nan"), 2, {"'nan' is not a number"}));
    EXPECT_TRUE(ended(relit("--light", "0,0,0"), 2, {"--light 0,0,0", "cannot be zero"}));
    EXPECT_TRUE(ended(relit("--light", "0,0,inf"), 2, {"'inf' is not a number"}));
    EXPECT_TRUE(ended(relit("--light", "0,0,1e400"), 2, {"'1e400' is out of range"}));
    for (const char* behind : {"10,0,-5", "0,0,0", "0,0,1e-25"})
        EXPECT_TRUE(ended(relit("--point-light", behind), 2, {behind, "z must be positive", "0.001 mm"}));
    for (const char* far : {"0,0,1e25", "-2e6,0,1"})
        EXPECT_TRUE(ended(relit("--point-light", far), 2, {far, "within 1000000 mm", "--light"}));
    Surface raised = read_painting(stack.truth());
    for (float& height_mm : raised.height_mm.pixels()) height_mm += 5;
    write_painting(stack.truth(), raised);
    EXPECT_TRUE(ended(relit("--point-light", "0,0,3"), 2, {"0,0,3: lies in the painting, which is "}));
    EXPECT_TRUE(ended(relit("--point-light", "1000,0,3"), 0));  // beside it
    std::filesystem::remove(stack.out("a.png"));
    EXPECT_FALSE(std::filesystem::exists(stack.out("a.png")));
}

TEST(CliContract, OneJsonObjectOnStdoutAndTheRestOnStderr) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) { lines[0] = "99"; });  // worth a warning
    const Finished fit = tangipaint(
        {"fit", stack.path(), "--transfer", "linear", "--out", stack.out("a.exr"), "--threads", "2"});
    ASSERT_TRUE(ended(fit, 0, {"warning: ", "says 99 lights, but 12 follow"}));
    const nlohmann::json result = fit.json();
    EXPECT_EQ(result["command"], "fit");
    EXPECT_EQ(result["painting"], stack.out("a.exr"));
    EXPECT_GT(result["seconds"], 0);
    EXPECT_GT(result["peak_memory_mb"], 1);
    ASSERT_EQ(result["warnings"].size(), 1u);
    EXPECT_THAT(result["warnings"][0], HasSubstr("says 99 lights"));
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
    EXPECT_THAT(fit.err, Not(HasSubstr("next:")));  // is for those at a terminal
}

TEST(CliContract, PoorNumbersEndWith3AndSayWhich) {
    const TinyStack stack;
    Surface wrong(32, 32);  // brighter than any photograph
    std::fill(wrong.diffuse.pixels().begin(), wrong.diffuse.pixels().end(), Rgb(5));
    std::fill(wrong.confidence.pixels().begin(), wrong.confidence.pixels().end(), 1.0f);
    wrong.photography = stack.photography();
    write_painting(stack.out("wrong.exr"), wrong);
    const Finished run =
        tangipaint({"compare", stack.out("wrong.exr"), stack.path(), "--out", stack.out("c")});
    ASSERT_TRUE(ended(run, 3, {"warning: poor result: ", "dB on average", "the lights, of this painting?"}));
    ASSERT_EQ(run.json()["poor"].size(), 1u);
    EXPECT_THAT(run.json()["poor"][0], HasSubstr("dB on average"));
    EXPECT_TRUE(std::filesystem::exists(stack.out("c") + "/compare.html"));
}

TEST(CliContract, AFitsPageIsWrittenWhereAskedFor) {
    const TinyStack stack;
    ASSERT_TRUE(
        ended(tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--report", stack.out("a.txt")}),
              2, {"--report", "a.txt: a page is an .html file"}));
    EXPECT_FALSE(std::filesystem::exists(stack.out("a.exr")));
    ASSERT_TRUE(
        ended(tangipaint({"fit", stack.path(), "--out", stack.out("a.exr"), "--report", stack.out("a.html")}),
              0, {}));
    EXPECT_THAT(bytes_of(stack.out("a.html")), HasSubstr("<title>a.exr</title>"));
}

TEST(CliContract, StdoutThatTakesNothingIsAnError) {
    const TinyStack stack;
    Conditions full;
    full.stdout_to = "/dev/full";
    // A short result, and one that is longer than any buffer.
    EXPECT_TRUE(ended(tangipaint({"info", stack.photo(0)}, full), 1, {"standard output"}));
    EXPECT_TRUE(ended(tangipaint({"compare", stack.truth(), stack.path(), "--out", stack.out("c")}, full), 1,
                      {"standard output"}));
    for (const std::vector<std::string>& asked :
         {std::vector<std::string>{"help"}, {"help", "fit"}, {"fit", "--help"}, {"--version"}})
        EXPECT_TRUE(ended(tangipaint(asked, full), 1, {"standard output"}));
}

// Messages are lost, not the work: neither where they cannot be written nor where nobody reads them.
TEST(CliContract, StderrThatTakesNothingIsNoReasonToStop) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) { lines[0] = "99"; });  // worth a warning
    Conditions full, closed, unread;
    full.stderr_to = "/dev/full";
    closed.closed = {STDERR_FILENO};
    unread.stderr_is_unread = true;
    for (const Conditions& conditions : {full, closed, unread}) {
        const std::string target = stack.out("a.exr");
        const Finished fit = tangipaint({"fit", stack.path(), "--out", target}, conditions);
        ASSERT_TRUE(ended(fit, 0));
        EXPECT_EQ(fit.json()["dry_hash"], hash_of(read_painting(target)));
        EXPECT_TRUE(ended(tangipaint({"info", stack.out("none")}, conditions), 1));
        EXPECT_TRUE(ended(tangipaint({"info"}, conditions), 2));
        EXPECT_TRUE(ended(tangipaint({}, conditions), 2));
        std::filesystem::remove(target);
    }
}

// The files that are opened next would take the places of the streams, and hold the messages.
TEST(CliContract, ClosedStreamsWriteIntoNoFile) {
    const TinyStack stack;
    stack.change_lights([](auto& lines) { lines[0] = "99"; });
    Conditions closed;
    closed.closed = {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO};
    EXPECT_TRUE(ended(tangipaint({"fit", stack.path(), "--out", stack.out("a.exr")}, closed), 1));
    EXPECT_NO_THROW(read_painting(stack.out("a.exr")));
    EXPECT_TRUE(ended(tangipaint({"help"}, closed), 1));
}

TEST(CliContract, TooLittleMemoryIsAnErrorThatSaysSo) {
    const TinyStack stack;
    Surface large(4000, 4000);
    large.confidence(0, 0) = 1;
    write_painting(stack.out("large.exr"), large);
    Conditions small;
    small.memory = rlim_t{900} << 20;
    small.environment = {{"OMP_NUM_THREADS", "1"}, {"OPENBLAS_NUM_THREADS", "1"}};
    const Finished run = tangipaint(
        {"export", stack.out("large.exr"), "--to", "maps", "--out", stack.out("maps"), "--threads", "1"},
        small);
    EXPECT_TRUE(ended(run, 1, {"large.exr", "GB of memory", "are left"}));
}

// From where the loader finds room for the libraries on to where there is enough.
TEST(CliContract, WithAnyLimitOfMemoryItIsDoneOrThatIsSaid) {
    const TinyStack stack;
    const std::vector<std::vector<std::string>> commands = {
        {"help"},
        {"info", stack.truth()},
        {"fit", stack.path(), "--out", stack.out("a.exr")},
        {"relight", stack.truth(), "--light", "1,0,1", "--out", stack.out("a.png")}};
    constexpr rlim_t kStep = 24;  // [MB]
    int refused = 0, done = 0;
    for (rlim_t mb = 360; mb <= 720; mb += kStep) {
        Conditions small;
        small.memory = mb << 20;
        const auto& command = commands[static_cast<std::size_t>(mb / kStep) % commands.size()];
        SCOPED_TRACE(fmt::format("{} in {} MB", command.front(), mb));
        const Finished run = tangipaint(command, small);
        if (run.code == 127) continue;  // the loader's, which says why
        ++(run.code == 0 ? done : refused);
        if (run.code != 0) {
            EXPECT_TRUE(ended(run, 1, {"not enough memory"}));
        }
    }
    EXPECT_GT(refused, 0);
    EXPECT_GT(done, 0);
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
}

}  // namespace
}  // namespace tangi
