// output_set_test.cpp: files that belong together are put in place together.
#include "surface/file/output_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/stale_temporaries.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using Names = std::vector<std::string>;

// Hidden ones, too.
Names all_names_in(const fs::path& folder) {
    Names names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        names.push_back(entry.path().lexically_relative(folder).string());
    std::sort(names.begin(), names.end());
    return names;
}

// Ends as a killed program does, without tidying up.
void in_a_program_that_is_killed(const std::function<void()>& work) {
    const pid_t child = ::fork();
    if (child == 0) {
        work();
        ::_exit(0);
    }
    ::waitpid(child, nullptr, 0);
}

TEST(OutputSet, IsInPlaceAsAWhole) {
    const TestDir dir;
    fs::create_directories(dir / "sub");
    for (const char* name : {"a", "sub/b", "old"}) write_bytes(dir / name, "before");
    AtomicFile a(dir / "a"), b(dir / "sub/b"), c(dir / "c");
    for (AtomicFile* file : {&a, &b, &c}) file->write("new");
    OutputSet set;
    for (AtomicFile* file : {&a, &b, &c}) set.add(*file);
    set.withdraw(dir.path(), "old");
    set.withdraw(dir.path(), "none");
    set.commit();
    EXPECT_EQ(all_names_in(dir.path()), (Names{"a", "c", "sub", "sub/b"}));
    EXPECT_EQ(bytes_of(dir / "a") + bytes_of(dir / "sub/b") + bytes_of(dir / "c"), "newnewnew");
}

TEST(OutputSet, OfWhichOneCannotBePlacedIsTakenBack) {
    const TestDir dir;
    for (const char* name : {"a", "old"}) write_bytes(dir / name, "before");
    {
        AtomicFile a(dir / "a"), b(dir / "b"), c(dir / "c");
        for (AtomicFile* file : {&a, &b, &c}) file->write("new");
        fs::create_directories(dir / "c/in the way");
        OutputSet set;
        set.withdraw(dir.path(), "old");
        for (AtomicFile* file : {&a, &b, &c}) set.add(*file);
        EXPECT_THAT(error_of([&] { set.commit(); }),
                    StartsWith((dir / "c").string() + ": cannot be put in place: "));
    }
    EXPECT_EQ(all_names_in(dir.path()), (Names{"a", "c", "c/in the way", "old"}));
    EXPECT_EQ(bytes_of(dir / "a") + bytes_of(dir / "old"), "beforebefore");
}

TEST(OutputSet, AFolderTakesThePlaceOfOne) {
    const TestDir dir;
    for (const bool fails : {true, false}) {
        fs::remove_all(dir / "page");
        fs::create_directories(dir / "parts");
        write_bytes(dir / "parts/old", "old");
        const fs::path hidden = dir / temporary_name("parts", "");
        fs::create_directory(hidden);
        write_bytes(hidden / "new", "new");
        if (fails) fs::create_directories(dir / "page.d/in the way");
        AtomicFile page(dir / (fails ? "page.d/in the way/../x" : "page"));
        page.write("new");
        if (fails) fs::create_directories(dir / "page.d/x/in the way");
        OutputSet set;
        bool placed = false;
        set.add_folder(hidden, dir / "parts", [&](bool cleaned) { placed = cleaned; });
        set.add(page);
        if (fails)
            EXPECT_THAT(error_of([&] { set.commit(); }), HasSubstr("cannot be put in place"));
        else
            set.commit();
        EXPECT_EQ(placed, !fails);
        EXPECT_EQ(names_in(dir / "parts"), Names{fails ? "old" : "new"});
        EXPECT_EQ(fs::exists(hidden), fails);
        fs::remove_all(hidden);
        fs::remove_all(dir / "page.d");
    }
    EXPECT_EQ(all_names_in(dir.path()), (Names{"page", "parts", "parts/new"}));
}

// The record of a set of three files in two folders, of which `moved` have their names when the program is
// killed; `first`: whether the record that counts was there.
void leave_interrupted(const fs::path& dir, std::size_t moved, bool first) {
    in_a_program_that_is_killed([&] {
        const auto move = [](const char* name) {
            return OutputMove{OutputMove::Kind::put, temporary_name(name, ""), name};
        };
        const OutputMove gone{OutputMove::Kind::withdraw, temporary_name("old-withdrawn", ""), "old"};
        const std::vector<std::pair<fs::path, OutputMove>> moves = {
            {dir, gone}, {dir, move("a")}, {dir / "sub", move("b")}, {dir, move("c")}};
        for (const auto& [folder, put] : moves)
            if (put.kind == OutputMove::Kind::put) write_bytes(folder / put.from, "new");
        const std::string name = new_record_name();
        RecordFile second(dir / "sub" / name, {{moves[2].second}, "..", {}}, "b");
        RecordFile record(dir / name, {{gone, moves[1].second, moves[3].second}, {}, {"sub"}}, "a");
        for (const auto& [folder, put] : moves) put.prepare(folder);
        second.place();
        if (first) record.place();
        for (std::size_t i = 0; i < moved; ++i) moves[i].second.forward(moves[i].first);
        ::_exit(0);
    });
}

TEST(OutputSet, ThatWasInterruptedIsFinishedByWhoComesNext) {
    for (const char* seen_from : {"", "sub"})
        for (std::size_t moved = 0; moved <= 4; ++moved) {
            const TestDir dir;
            fs::create_directory(dir / "sub");
            for (const char* name : {"a", "sub/b", "old"}) write_bytes(dir / name, "before");
            leave_interrupted(dir.path(), moved, true);
            settle_outputs(dir / seen_from);
            EXPECT_EQ(all_names_in(dir.path()), (Names{"a", "c", "sub", "sub/b"})) << moved << seen_from;
            EXPECT_EQ(bytes_of(dir / "a") + bytes_of(dir / "sub/b") + bytes_of(dir / "c"), "newnewnew");
        }
}

TEST(OutputSet, ThatWasInterruptedBeforeItCountedHasNotHappened) {
    for (const char* seen_from : {"", "sub"}) {
        const TestDir dir;
        fs::create_directory(dir / "sub");
        for (const char* name : {"a", "sub/b", "old"}) write_bytes(dir / name, "before");
        leave_interrupted(dir.path(), 0, false);
        settle_outputs(dir / seen_from);
        for (const char* name : {"a", "sub/b", "old"}) EXPECT_EQ(bytes_of(dir / name), "before") << name;
        write_text_file(dir / "x", "");  // who writes in a folder removes what was left there
        write_text_file(dir / "sub/x", "");
        EXPECT_EQ(all_names_in(dir.path()), (Names{"a", "old", "sub", "sub/b", "sub/x", "x"}));
    }
}

TEST(OutputSet, RecordsThatReachBeyondTheirFolderAreNone) {
    const std::string from = temporary_name("a", "");
    for (const OutputMove& move : {OutputMove{OutputMove::Kind::put, from, "../a"},
                                   {OutputMove::Kind::put, "../" + from, "a"},
                                   {OutputMove::Kind::put, "/tmp/" + from, "a"},
                                   {OutputMove::Kind::withdraw, "mine.txt", "a"},
                                   {OutputMove::Kind::put, from, ""}})
        EXPECT_FALSE(record_in(OutputRecord{{move}, {}, {}}.text())) << move.from << " " << move.to;
    const OutputRecord good{{{OutputMove::Kind::put, from, "sub/a"}}, "../x", {"b", "c"}};
    const auto read = record_in(good.text());
    ASSERT_TRUE(read);
    EXPECT_EQ(read->text(), good.text());
    for (std::size_t length = 0; length < good.text().size(); ++length)
        EXPECT_FALSE(record_in(good.text().substr(0, length))) << "cut off at " << length;
}

// As in an archive that somebody else packed.
TEST(OutputSet, RecordsReachBeyondTheirFolderByNoLink) {
    const TestDir dir;
    fs::create_directories(dir / "stack/within");
    fs::create_directory(dir / "mine");
    write_bytes(dir / "mine/a", "mine");
    fs::create_directory_symlink("../mine", dir / "stack/out");
    fs::create_directory_symlink("within", dir / "stack/in");
    const std::string record = new_record_name();
    for (const char* to : {"out", "in"}) {
        const std::string from = temporary_name("a", "");
        write_bytes(dir / "stack" / from, "theirs");
        const OutputRecord of{{{OutputMove::Kind::put, from, fs::path(to) / "a"}}, {}, {}};
        write_bytes(dir / "stack" / record, of.text());
        settle_outputs(dir / "stack");
    }
    EXPECT_EQ(bytes_of(dir / "mine/a"), "mine");
    EXPECT_EQ(bytes_of(dir / "stack/within/a"), "theirs");
}

TEST(FolderFiles, OfANewFolderAreThereWithIt) {
    const TestDir dir;
    {
        FolderFiles files(dir / "a/b/new");
        write_bytes(files.temporary() / "x", "x");
        EXPECT_FALSE(fs::exists(dir / "a/b/new"));
        files.place();
        EXPECT_EQ(names_in(dir / "a/b/new"), Names{"x"});
    }
    { FolderFiles none(dir / "c/d"); }
    EXPECT_EQ(all_names_in(dir.path()), (Names{"a", "a/b", "a/b/new", "a/b/new/x"}));
}

// Whatever file it was of, and while nobody has asked what became of it.
TEST(StaleTemporaries, OfAKilledProgramGoWhenAnythingIsWrittenThere) {
    const TestDir dir;
    const pid_t child = ::fork();
    if (child == 0) {
        for (const fs::path& file :
             {dir / temporary_name("a", ".exr"), dir / temporary_name("." + temporary_name("b", ""), ".jpg")})
            write_bytes(file, "half");
        fs::create_directories(dir / temporary_name("c", "") / "sub");
        ::raise(SIGKILL);
    }
    siginfo_t ended;
    ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
    EXPECT_EQ(all_names_in(dir.path()).size(), 4u);
    write_text_file(dir / "x", "");
    EXPECT_EQ(all_names_in(dir.path()), Names{"x"});
    ::waitpid(child, nullptr, 0);
}

TEST(TemporaryNames, AreNotToldOf) {
    const std::string file = temporary_name("my.painting", ".exr"), folder = temporary_name("c", ""),
                      within = temporary_name(kWithinFolder, "");
    EXPECT_EQ(in_lasting_names("/d/" + file + ": cannot"), "/d/my.painting.exr: cannot");
    EXPECT_EQ(in_lasting_names("x: /d/" + folder + "/" + file + " and ./" + file),
              "x: /d/c/my.painting.exr and ./my.painting.exr");
    EXPECT_EQ(in_lasting_names("/d/" + within + "/sub/a.png: no"), "/d/sub/a.png: no");
    EXPECT_EQ(in_lasting_names("/d/" + within + ": no"), "/d: no");
    for (const char* other :
         {"/d/.a.tmp.exr: no", "/d/.a.12.tmp.exr: no", "my.tmp", "", "/d/a.12-0123abcd.tmp"})
        EXPECT_EQ(in_lasting_names(other), other);
}

}  // namespace
}  // namespace tangi
