// Where a command cannot write what it made: a disk that is full, a folder that must not be written.
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

// As if the disk had room for `bytes` more in one file.
Conditions nearly_full(std::uintmax_t bytes) {
    Conditions conditions;
    conditions.largest_file = bytes;
    return conditions;
}

TEST(CliFullDisk, PaintingsAndPicturesAreWholeOrNot) {
    const TinyStack stack;
    const std::vector<std::vector<std::string>> commands = {
        {"fit", stack.path(), "--out", stack.out("a.exr")},
        {"relight", stack.truth(), "--light", "1,0,1", "--out", stack.out("a.png")},
        {"relight", stack.truth(), "--light", "1,0,1", "--out", stack.out("a.jpg")},
        {"relight", stack.truth(), "--light", "1,0,1", "--out", stack.out("a.tif")},
        {"relight", stack.truth(), "--light", "1,0,1", "--out", stack.out("b.exr")}};
    for (const auto& command : commands) {
        const std::string& target = command.back();
        SCOPED_TRACE(command.front() + " to " + target);
        ASSERT_TRUE(ended(tangipaint(command), 0));
        const std::uintmax_t whole = fs::file_size(target);
        write_bytes(target, "old");
        const auto before = everything_in(stack.root());
        // A part, and all but the last byte, which is written while the file is closed.
        for (const std::uintmax_t room : {whole / 2, whole - 1}) {
            const Finished run = tangipaint(command, nearly_full(room));
            EXPECT_TRUE(ended(run, 1, {target + ": cannot be written"})) << room << " of " << whole;
            EXPECT_TRUE(bytes_of(target) == "old") << room << " of " << whole;
            EXPECT_EQ(everything_in(stack.root()), before) << room << " of " << whole;
        }
    }
}

TEST(CliFullDisk, ReportsAndStacksAreWholeOrNot) {
    const TinyStack stack;
    const std::string report = stack.out("c"), many = stack.out("d");
    for (const std::uintmax_t room : {0, 1500, 4000}) {
        EXPECT_TRUE(
            ended(tangipaint({"compare", stack.truth(), stack.path(), "--out", report}, nearly_full(room)), 1,
                  {report + "/", "cannot be written"}))
            << room;
        EXPECT_FALSE(fs::exists(report)) << room;
    }
    EXPECT_TRUE(ended(
        tangipaint({"relight", stack.truth(), "--lights", stack.lights(), "--out", many}, nearly_full(1000)),
        1, {many + "/img_000.png: cannot be written"}));
    EXPECT_FALSE(fs::exists(many));
    const std::string made = stack.out("s");
    EXPECT_TRUE(
        ended(tangipaint({"generate", "--out", made, "--width", "32", "--height", "32"}, nearly_full(1000)),
              1, {made + "/", "cannot be written"}));
    EXPECT_FALSE(fs::exists(made + "/lights.lp"));
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
}

// A painting, its palette and its film are of one run: none of them is replaced where one does not fit.
TEST(CliFullDisk, WhatAReplayMakesIsThereAsAWholeOrNot) {
    const TinyStack stack;
    const std::string journal = stack.out("a.jsonl"),
                      points =
                          "{\"event\": \"point\", \"t\": 0, \"x\": -3, \"y\": 0}\n"
                          "{\"event\": \"point\", \"t\": 1, \"x\": 3, \"y\": 0}\n";
    write_bytes(journal,
                "{\"format\": \"tangipaint strokes\", \"version\": 1}\n"
                "{\"event\": \"pile\", \"paint\": {\"Pyrrole Red\": 1}, \"x\": 0, \"y\": 0, \"size_mm\": 8}\n"
                "{\"event\": \"stroke\", \"on\": \"palette\", \"brush\": {\"size_mm\": 4}}\n" +
                    points + "{\"event\": \"stroke\", \"brush\": {\"size_mm\": 4}, \"start\": \"same\"}\n" +
                    points);
    const std::vector<std::string> made = {stack.out("a.exr"), stack.out("board.exr"), stack.out("film.mp4")};
    const std::vector<std::string> command = {
        "replay",     "--substrate", "gesso",          "--width-mm", "20",    "--height-mm", "15",
        "--pixel-mm", "0.25",        journal,          "--out",      made[0], "--board",     made[1],
        "--video",    made[2],       "--frames-width", "32"};
    ASSERT_TRUE(ended(tangipaint(command), 0));
    std::vector<std::uintmax_t> sizes;
    for (const std::string& file : made) sizes.push_back(fs::file_size(file));
    const std::uintmax_t largest = std::ranges::max(sizes);
    ASSERT_EQ(std::ranges::count(sizes, largest), 1);
    for (const std::string& file : made) write_bytes(file, "old");
    const auto before = everything_in(stack.root());
    EXPECT_TRUE(ended(tangipaint(command, nearly_full(largest - 1)), 1, {": cannot be written"}));
    for (const std::string& file : made) EXPECT_TRUE(bytes_of(file) == "old") << file;
    EXPECT_EQ(everything_in(stack.root()), before);
}

TEST(CliReadOnly, WhereNothingCanBeWrittenIsKnownBeforeTheWork) {
    const TinyStack stack;
    const auto before = everything_in(stack.root());
    const auto refused = [&](const std::vector<std::string>& command, const std::vector<std::string>& said) {
        EXPECT_TRUE(ended(tangipaint(command), 1, said)) << testing::PrintToString(command);
        EXPECT_EQ(everything_in(stack.root()), before);
    };
    const std::string in_none = stack.out("none/a.exr"), in_file = stack.photo(0) + "/a.exr",
                      folder = stack.path();
    refused({"fit", folder, "--out", in_none}, {in_none + ": there is no folder " + stack.out("none")});
    refused({"fit", folder, "--out", in_file}, {in_file + ": there is no folder " + stack.photo(0)});
    for (const std::string& wrong : {folder, stack.out("a.png")})
        EXPECT_TRUE(ended(tangipaint({"fit", folder, "--out", wrong}), 2,
                          {"--out " + wrong, "a painting is an .exr file"}));
    refused({"fit", stack.out("nowhere"), "--out", in_none}, {"there is no folder " + stack.out("none")});
    refused({"compare", stack.truth(), folder, "--out", stack.photo(0)},
            {stack.photo(0), "cannot be made a folder"});
    refused({"compare", stack.truth(), folder, "--out", stack.photo(0) + "/c"},
            {stack.photo(0) + "/c", "cannot be made a folder"});
    refused({"relight", stack.truth(), "--lights", stack.lights(), "--out", stack.photo(0)},
            {"cannot be made a folder"});
    refused({"generate", "--out", stack.photo(0), "--width", "16", "--height", "16"},
            {"cannot be made a folder"});
    refused({"demo", "--small", "--out", stack.photo(0)}, {stack.photo(0), "cannot be made a folder"});
}

TEST(CliReadOnly, PermissionsAreRespectedAndNamed) {
    if (::geteuid() == 0 && ::prctl(PR_CAPBSET_READ, 8 /* CAP_SETPCAP */) != 1)
        GTEST_SKIP() << "skipped: permissions do not bind this user, and it cannot give that up";
    const TinyStack stack;
    Conditions bound;
    bound.bound_by_permissions = true;
    const fs::path locked = stack.out("locked");
    fs::create_directory(locked);
    fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
    const auto refused = [&](const std::vector<std::string>& command, const std::vector<std::string>& said) {
        EXPECT_TRUE(ended(tangipaint(command, bound), 1, said)) << testing::PrintToString(command);
    };
    refused({"fit", stack.path(), "--out", locked / "a.exr"},
            {"locked/a.exr: cannot be written: Permission denied"});
    refused({"relight", stack.truth(), "--light", "0,0,1", "--out", locked / "a.png"},
            {"locked/a.png: cannot be written: Permission denied"});
    refused({"compare", stack.truth(), stack.path(), "--out", locked / "c"},
            {"--out " + (locked / "c").string() + ": " + locked.string() + " cannot be written: Permission"});
    EXPECT_EQ(everything_in(locked), std::vector<std::string>());

    fs::permissions(stack.photo(2), fs::perms::none);
    EXPECT_TRUE(ended(tangipaint({"fit", stack.path(), "--out", stack.out("b.exr")}, bound), 0,
                      {stack.name(2), "cannot be read: Permission denied; rejected"}));
    fs::remove(stack.out("b.exr"));
    fs::permissions(stack.lights(), fs::perms::none);
    refused({"fit", stack.path(), "--out", stack.out("a.exr")},
            {"lights.lp: cannot be read: Permission denied"});
    fs::permissions(stack.truth(), fs::perms::none);
    refused({"info", stack.truth()}, {"truth.exr", "Permission denied"});
    fs::permissions(stack.folder(), fs::perms::none);
    refused({"fit", stack.path(), "--out", stack.out("a.exr")}, {stack.path(), "Permission denied"});
    fs::permissions(stack.folder(), fs::perms::owner_all);
    EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
}

}  // namespace
}  // namespace tangi
