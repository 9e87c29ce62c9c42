// atomic_folder_test.cpp: folders that appear whole or not at all, and what killed programs leave.
#include "surface/file/atomic_folder.h"
#include "surface/base/json_reading.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "surface/file/atomic_file.h"
#include "surface/file/stale_temporaries.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using Names = std::vector<std::string>;

void put(const fs::path& folder, const std::string& name, const std::string& text) {
    fs::create_directories((folder / name).parent_path());
    write_bytes(folder / name, text);
}

Names write(const fs::path& target, const Names& files, const std::string& text) {
    AtomicFolder folder(target, "list.json");
    for (const std::string& file : files) put(folder.temporary(), file, text);
    return folder.commit();
}

TEST(AtomicFolder, AppearsWholeAndReplacesItsLikeAsAWhole) {
    const TestDir dir;
    EXPECT_THAT(write(dir / "new/out/", {"a", "sub/b"}, "one"), ElementsAre("a", "sub/b"));
    EXPECT_EQ(bytes_of(dir / "new/out/sub/b"), "one");
    write(dir / "new/out", {"a", "c"}, "two");
    EXPECT_EQ(names_in(dir / "new/out"), (Names{"a", "c", "list.json"}));
    EXPECT_EQ(bytes_of(dir / "new/out/a"), "two");
    EXPECT_EQ(names_in(dir / "new"), Names{"out"});
    // An empty folder is as good as none, and a link means the folder.
    fs::create_directory(dir / "empty");
    fs::create_directory_symlink(dir / "empty", dir / "link");
    write(dir / "link", {"a"}, "three");
    EXPECT_EQ(bytes_of(dir / "empty/a"), "three");
    EXPECT_TRUE(fs::is_symlink(dir / "link"));
}

TEST(AtomicFolder, NotCommittedItLeavesWhatWasThere) {
    const TestDir dir;
    write(dir / "out", {"a"}, "old");
    {
        AtomicFolder folder(dir / "out", "list.json");
        put(folder.temporary(), "b", "half");
        AtomicFolder other(dir / "none", "list.json");
    }
    EXPECT_EQ(names_in(dir.path()), Names{"out"});
    EXPECT_EQ(names_in(dir / "out"), (Names{"a", "list.json"}));
    {
        AtomicFolder folder(dir / "out", "list.json");
        put(folder.temporary(), "b", "new");
        const FullDisk full(0);
        EXPECT_THAT(error_of([&] { folder.commit(); }),
                    HasSubstr((dir / "out/list.json").string() + ": cannot be"));
    }
    EXPECT_EQ(bytes_of(dir / "out/a"), "old");
    EXPECT_EQ(names_in(dir.path()), Names{"out"});
}

TEST(AtomicFolder, RefusesAFolderWithWhatIsNotItsOwn) {
    const TestDir dir;
    write(dir / "out", {"a"}, "old");
    const auto error = [&](const fs::path& target) {
        return error_of([&] { AtomicFolder(target, "list.json"); });
    };
    put(dir / "out", "sub/mine.txt", "mine");
    EXPECT_EQ(error(dir / "out"), (dir / "out").string() +
                                      ": holds sub/mine.txt, which is not of an earlier export; name another "
                                      "folder, or an empty one");
    fs::remove(dir / "out/sub/mine.txt");
    EXPECT_THAT(error(dir / "out"), HasSubstr("holds sub/, which")) << "an empty folder is somebody's, too";
    fs::remove_all(dir / "out/sub");
    EXPECT_NO_THROW(AtomicFolder(dir / "out", "list.json"));
    {
        AtomicFolder folder(dir / "out", "list.json");
        put(dir / "out", "late.txt", "mine");
        EXPECT_THAT(error_of([&] { folder.commit(); }), HasSubstr("late.txt"));
    }
    EXPECT_EQ(bytes_of(dir / "out/late.txt"), "mine");
    write_bytes(dir / "file", "");
    EXPECT_THAT(error(dir / "file"), HasSubstr("is a file; give the name of a folder"));
    EXPECT_THAT(error(dir / "file/out"), HasSubstr("file"));
    EXPECT_THAT(error(""), HasSubstr("is not the name of a folder"));
    EXPECT_THAT(error("/"), HasSubstr("is not the name of a folder"));
    EXPECT_EQ(names_in(dir.path()), (Names{"file", "out"}));
}

TEST(AtomicFolder, AddsTheListToItsFile) {
    const TestDir dir;
    put(dir / "out", "list.json", "{\"width\": 3}");
    EXPECT_THAT(error_of([&] { AtomicFolder(dir / "out", "list.json"); }),
                HasSubstr("holds list.json, which"))
        << "of somebody else: it has no list";
    fs::remove(dir / "out/list.json");
    {
        AtomicFolder folder(dir / "out", "list.json");
        put(folder.temporary(), "b", "new");
        put(folder.temporary(), "list.json", "{\"width\": 4}");
        EXPECT_THAT(folder.commit(), ElementsAre("b", "list.json"));
    }
    EXPECT_EQ(names_in(dir / "out"), (Names{"b", "list.json"}));
    const auto list = read_json(bytes_of(dir / "out/list.json"), "JSON");
    EXPECT_EQ(list["width"], 4);
    EXPECT_EQ(list["files"], (Names{"b", "list.json"}));
    EXPECT_NO_THROW(AtomicFolder(dir / "out", "list.json")) << "it lists what it holds";
}

TEST(FolderFiles, JoinWhatIsThereAllTogether) {
    const TestDir dir;
    put(dir / "out", "mine", "mine");
    put(dir / "out", "sub/a", "old");
    {
        FolderFiles files(dir / "out");
        put(files.temporary(), "b", "half");
        FolderFiles none(dir / "none");
    }
    EXPECT_EQ(names_in(dir.path()), Names{"out"});
    EXPECT_EQ(names_in(dir / "out"), (Names{"mine", "sub"}));
    EXPECT_EQ(bytes_of(dir / "out/sub/a"), "old");
    {
        FolderFiles files(dir / "out");
        put(files.temporary(), "b", "new");
        put(files.temporary(), "sub/a", "new");
        files.place();
    }
    EXPECT_EQ(names_in(dir / "out"), (Names{"b", "mine", "sub"}));
    EXPECT_EQ(bytes_of(dir / "out/sub/a") + bytes_of(dir / "out/b"), "newnew");
    {
        FolderFiles files(dir / "new");
        put(files.temporary(), "a", "new");
        EXPECT_EQ(error_of([&] {
                      told_of(files.temporary(), dir / "new",
                              [&] { fail("{}: cannot", (files.temporary() / "a").string()); });
                  }),
                  (dir / "new/a").string() + ": cannot");
        files.place();
    }
    EXPECT_EQ(names_in(dir / "new"), Names{"a"});
}

// The number of a process that is over.
pid_t dead_process() {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ::waitpid(child, nullptr, 0);
    return child;
}

TEST(StaleTemporaries, OfADeadProgramGoWhenTheFileIsWrittenAgain) {
    const TestDir dir;
    const auto leave = [&](const std::string& name, const std::string& text, std::chrono::minutes age) {
        write_bytes(dir / name, text);
        fs::last_write_time(dir / name, fs::file_time_type::clock::now() - age);
        return name;
    };
    const std::chrono::minutes hour(60);
    const pid_t dead = dead_process();
    const auto named = [](const std::string& stem, pid_t process, const std::string& ending) {
        return fmt::format(".{}.{}.tmp{}", stem, process, ending);
    };
    leave(named("a", dead, ".exr"), "half", hour);
    leave(named("a", dead, ".exr.x1Yz"), "what a library wrote beside it", hour);
    leave(named("a", dead, ".ora"), "", 25 * hour);
    Names others = {leave(named("a", ::getppid(), ".exr"), "its program lives", hour),
                    leave(named("b", dead, ".exr"), "of another file", hour),
                    leave(named("a", dead, ".png"), "the same", hour),
                    leave(fmt::format(".a.{}.tmp", dead), "", hour),
                    leave(".a.x.tmp.exr", "not ours", hour),
                    leave(named("a.b", dead, ".exr"), "of a.b", hour)};
    write_text_file(dir / "a.exr", "whole");
    { const AtomicFile of_another_kind(dir / "a.ora"); }
    std::sort(others.begin(), others.end());
    others.emplace_back("a.exr");
    Names left;
    for (const auto& entry : fs::directory_iterator(dir.path()))
        left.push_back(entry.path().filename().string());
    std::sort(left.begin(), left.end());
    EXPECT_EQ(left, others);
}

TEST(StaleTemporaries, OfADeadProgramOfThisMachineGoAtOnce) {
    const TestDir dir;
    const auto named = [](pid_t process, bool here) {
        std::string name = temporary_name("a", ".exr");
        name.replace(3, std::to_string(::getpid()).size(), std::to_string(process));
        char& last = name[name.find(".tmp") - 1];
        if (!here) last = last == '0' ? '1' : '0';
        return name;
    };
    const pid_t dead = dead_process();
    const std::string elsewhere = named(dead, false), alive = named(::getppid(), true);
    for (const std::string& name : {named(dead, true), elsewhere, alive}) write_bytes(dir / name, "half");
    write_text_file(dir / "a.exr", "whole");
    EXPECT_FALSE(fs::exists(dir / named(dead, true)));
    EXPECT_TRUE(fs::exists(dir / elsewhere)) << "its program may live";
    EXPECT_TRUE(fs::exists(dir / alive));
    // Folders, too, with all that is in them.
    std::string folder = temporary_name("out", "");
    folder.replace(5, std::to_string(::getpid()).size(), std::to_string(dead));
    const TestDir other;
    put(other / folder, "sub/a", "half");
    write(other / "out", {"a"}, "new");
    EXPECT_FALSE(fs::exists(other / folder));
}

TEST(StaleTemporaries, OfLateMayBeOfAnotherMachine) {
    const TestDir dir;
    const std::string name = fmt::format(".a.{}.tmp.exr", dead_process());
    write_bytes(dir / name, "half");
    write_text_file(dir / "a.exr", "whole");
    EXPECT_TRUE(fs::exists(dir / name));
    // One that is empty waits for the end of a long work.
    const TestDir other;
    write_bytes(other / name, "");
    fs::last_write_time(other / name, fs::file_time_type::clock::now() - std::chrono::hours(5));
    write_text_file(other / "a.exr", "whole");
    EXPECT_TRUE(fs::exists(other / name));
}

}  // namespace
}  // namespace tangi
