// crash_recovery_test.cpp: of what was painted, nothing is lost and nothing is painted twice, whenever a
// program dies.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "paint/canvas/canvas_hash.h"
#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "surface/base/noise.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/viewer/viewer_support.h"
#include "viewer/model/painter.h"

namespace {
// Of a program that dies before the n-th name that it gives a file; 0: of none.
long names_until_killed() {
    static const char* const text = std::getenv("TP_KILL_AT_NAME");
    return text ? std::atol(text) : 0;
}
}  // namespace

// In place of the C library's.
extern "C" int rename(const char* from, const char* to) {
    static std::atomic<long> names = 0;
    if (++names == names_until_killed()) ::raise(SIGKILL);
    return ::renameat(AT_FDCWD, from, AT_FDCWD, to);
}

namespace tangi {
namespace {

namespace fs = std::filesystem;

TEST(Sitting, SavedJournalsAreNotRecoveredTwice) {
    TestDir folder;
    const RecoveryFiles files = recovery_files(folder / "a.exr");
    EXPECT_FALSE(left_over(files));
    RecoveryRecord record(files);
    record.append(UndoEvent{});
    EXPECT_TRUE(left_over(files)) << "a painting that is not there";
    write_bytes(files.painting, "saved later");
    fs::last_write_time(files.unsaved, fs::last_write_time(files.painting) - std::chrono::seconds(1));
    EXPECT_FALSE(left_over(files));
    fs::last_write_time(files.unsaved, fs::last_write_time(files.painting) + std::chrono::seconds(1));
    EXPECT_TRUE(left_over(files));
    record.discard();
    EXPECT_FALSE(left_over(files));
    EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("a.discarded.jsonl", "a.exr"));
}

const std::string kHeader = "{\"format\": \"tangipaint strokes\", \"version\": 1}\n",
                  kUndo = "{\"event\":\"undo\"}\n", kRedo = "{\"event\":\"redo\"}\n";

std::string header_of(const std::string& on, const std::string& makes = "") {
    return journal_text({on, makes}, {});
}

// Whatever name leads to a painting, it has one journal; and no two paintings have one.
TEST(Sitting, FilesAreThoseOfThePaintingsFile) {
    TestDir folder;
    fs::create_directory(folder / "real");
    write_bytes(folder / "real" / "b.exr", "a painting");
    fs::create_symlink("real/b.exr", folder / "a.exr");
    EXPECT_EQ(recovery_files(folder / "a.exr").unsaved, folder / "real" / "b.unsaved.jsonl");
    EXPECT_EQ(recovery_files(folder / "a.exr").painting, folder / "a.exr");
    EXPECT_NE(recovery_files(folder / "c.EXR").record, recovery_files(folder / "c.exr").record);
    EXPECT_EQ(recovery_files(folder / "c.2.exr").record, folder / "c.2.strokes.jsonl");
}

// Of an earlier version, which did not say what a journal is of: nobody knows whether it was saved.
TEST(Sitting, AnOlderJournalIsNeverTheRecordUnasked) {
    TestDir folder;
    const RecoveryFiles files = recovery_files(folder / "a.exr");
    write_bytes(files.unsaved, kHeader + kUndo);
    write_bytes(files.painting, "put here later");
    fs::last_write_time(files.unsaved, fs::last_write_time(files.painting) - std::chrono::seconds(1));
    RecoveryRecord record(files);
    record.painting_is("a");
    record.append(RedoEvent{});
    EXPECT_THAT(record.take_note(), testing::HasSubstr("a.unread.jsonl"));
    EXPECT_EQ(bytes_of(folder / "a.unread.jsonl"), kHeader + kUndo);
    EXPECT_EQ(bytes_of(files.unsaved), header_of("a") + kRedo);
    record.put_away();
    EXPECT_EQ(bytes_of(files.record), header_of("a", "a") + kRedo);
}

TEST(Sitting, AJournalOfAnotherPaintingIsNeitherRecordedNorGoneOnWith) {
    TestDir folder;
    const RecoveryFiles files = recovery_files(folder / "a.exr");
    write_bytes(files.painting, "another");
    write_bytes(files.unsaved, header_of("a") + kUndo);
    fs::last_write_time(files.painting, fs::last_write_time(files.unsaved) + std::chrono::hours(1));
    const auto journal = left_over(files);
    ASSERT_TRUE(journal) << "times say nothing: it was not saved, or it would be gone";
    EXPECT_TRUE(is_of(*journal, "a"));
    EXPECT_FALSE(is_of(*journal, "b"));
    RecoveryRecord record(files);
    record.painting_is("b");
    record.append(RedoEvent{});
    EXPECT_EQ(bytes_of(folder / "a.other.jsonl"), header_of("a") + kUndo);
    EXPECT_THAT(record.take_note(), testing::HasSubstr("of another painting"));
    EXPECT_EQ(bytes_of(files.unsaved), header_of("b") + kRedo);
    record.discard();

    // Chosen all the same, it is written anew, as of this one.
    fs::remove(files.unsaved);
    fs::rename(folder / "a.other.jsonl", files.unsaved);
    RecoveryRecord chosen(files);
    chosen.painting_is("b");
    chosen.take_over(journal->entries, false);
    EXPECT_EQ(bytes_of(files.unsaved), header_of("b") + kUndo);
    EXPECT_EQ(bytes_of(folder / "a.other.jsonl"), header_of("a") + kUndo);
}

TEST(Sitting, ARecordOfAnotherPaintingIsKeptAndNotGoneOnWith) {
    TestDir folder;
    const RecoveryFiles files = recovery_files(folder / "a.exr");
    for (const std::string& theirs :
         {header_of("ground", "a") + kUndo, std::string("no journal\n"), kHeader + kUndo}) {
        write_bytes(files.record, theirs);
        RecoveryRecord record(files);
        record.painting_is("b");
        record.append(RedoEvent{});
        record.put_away();
        const bool unknown = theirs == kHeader + kUndo;  // of an earlier version
        const std::string events = unknown ? kUndo + kRedo : kRedo;
        EXPECT_EQ(bytes_of(files.record), header_of(unknown ? "" : "b", "b") + events);
        EXPECT_EQ(fs::exists(folder / "a.other-strokes.jsonl"), !unknown);
        if (!unknown) {
            EXPECT_EQ(bytes_of(folder / "a.other-strokes.jsonl"), theirs);
        }
        fs::remove(folder / "a.other-strokes.jsonl");
        record.append(UndoEvent{});
        record.put_away();
        EXPECT_EQ(bytes_of(files.record), header_of(unknown ? "" : "b", "b") + events + kUndo) << "its own";
    }
}

// As of a painting that was fitted anew, in the place of one that was painted on.
TEST(Sitting, AnOldRecordIsNotOfAPaintingThatWasNeverPaintedOn) {
    TestDir folder;
    const RecoveryFiles files = recovery_files(folder / "a.exr");
    write_bytes(files.record, kHeader + kUndo);
    RecoveryRecord record(files);
    record.painting_is("b", true);
    record.append(RedoEvent{});
    record.put_away();
    EXPECT_EQ(bytes_of(files.record), header_of("b", "b") + kRedo);
    EXPECT_EQ(bytes_of(folder / "a.other-strokes.jsonl"), kHeader + kUndo);
}

// A program of its own, for the next test: paints and saves until it is killed, and writes a byte to a pipe
// for each stroke that is painted.
TEST(Sitting, DISABLED_PaintsUntilKilled) {
    const fs::path file = std::getenv("TP_PAINT_FILE");
    const int pipe_end = std::atoi(std::getenv("TP_PAINT_PIPE"));
    settle_outputs_at(file);
    Painter painter({read_canvas(file), artist_acrylics(), file, false}, [] {});
    painter.start(std::make_shared<TexelTiles>(painter.surface(), painter.range()));
    if (auto left = left_over(recovery_files(file))) painter.recover(std::move(*left));
    const std::vector<std::string> paints = {"Titanium White", "Ultramarine Blue", "Pyrrole Red"};
    for (int i = 0;; ++i) {
        if (i % 7 == 0) {
            PaletteEvent piles;
            piles.paints = paints;
            piles.width_mm = piles.height_mm = 30;
            painter.send(piles);
        }
        StrokeEvent event;
        event.brush = even_brush();
        event.paint = {{paints[static_cast<std::size_t>(i) % 3], 1}};
        event.seed =
            static_cast<std::uint64_t>(::getpid()) * 1000 + static_cast<std::uint64_t>(i);  // no two alike
        // What is on the palette and on the brush counts, too.
        event.on = i % 4 == 1 ? Place::palette : Place::painting;
        event.start = i % 5 == 0 ? BrushStart::clean : i % 5 == 1 ? BrushStart::dirty : BrushStart::same;
        painter.send(event);
        for (int k = 0; k <= 8; ++k)
            painter.send(PointEvent{{.time_s = 0.01 * k, .x_mm = 2.0 * k - 8, .y_mm = i % 20 - 10.0}});
        painter.send(EndEvent{});
        if (i % 3 == 2) painter.save();
        painter.wait();
        if (::write(pipe_end, "x", 1) != 1) break;
    }
}

// Whether the painting with what is left over is what the journals say, and their strokes.
bool recovered_as_recorded(const RecoveryFiles& files, const fs::path& ground, int& strokes) {
    Session again(Canvas(std::make_shared<Surface>(read_painting(ground))), artist_acrylics());
    Session recovered(read_canvas(files.painting), artist_acrylics());
    read_tools(files.painting, recovered);
    if (fs::exists(files.record)) replay(again, read_journal(files.record));
    if (fs::exists(files.unsaved)) {
        const Journal last = recovered_journal(files.unsaved);
        if (!is_of(last, hash_of(recovered.canvas(), hash_of(recovered.canvas().dry())))) return false;
        replay(recovered, last);
        replay(again, last);
    }
    strokes = again.totals().strokes;
    if (recovered.board() && !identical(recovered.board()->wet(), again.board()->wet())) return false;
    return identical(recovered.canvas().wet(), again.canvas().wet()) &&
           recovered.brush()->bristles().total_mm == again.brush()->bristles().total_mm;
}

// Starts the program, which is to write to a pipe's end.
pid_t start_painting(const fs::path& file, const int (&ends)[2], long kill_at_name = 0) {
    const pid_t child = ::fork();
    if (child != 0) return child;
    ::setenv("TP_PAINT_FILE", file.c_str(), 1);
    ::setenv("TP_PAINT_PIPE", std::to_string(ends[1]).c_str(), 1);
    if (kill_at_name > 0) ::setenv("TP_KILL_AT_NAME", std::to_string(kill_at_name).c_str(), 1);
    ::close(ends[0]);
    ::execl("/proc/self/exe", "viewer_tests", "--gtest_filter=Sitting.DISABLED_PaintsUntilKilled",
            "--gtest_also_run_disabled_tests", "--gtest_brief=1", nullptr);
    ::_exit(1);
}

// Saving gives names to the painting, its record and what is written down of both: killed before any of them,
// painting and record are of one state, and what is recovered comes after it.
TEST(Sitting, KilledBetweenTheNamesOfASaveItLosesNothing) {
    int saves = 0;
    for (long name = 1; name <= 9; ++name) {
        const TestDir folder;
        const fs::path file = folder / "a.exr", ground = folder / "ground.exr";
        const RecoveryFiles files = recovery_files(file);
        write_painting(file, *flat_surface(60, 50));
        write_painting(ground, *flat_surface(60, 50));
        int ends[2], told = 0, strokes = 0, status = 0;
        ASSERT_EQ(::pipe(ends), 0);
        const pid_t child = start_painting(file, ends, name);
        ::close(ends[1]);
        for (char painted; ::read(ends[0], &painted, 1) == 1;) ++told;
        ::close(ends[0]);
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status));
        settle_outputs_at(file);  // as the next program does
        const Canvas saved = read_canvas(file);
        if (fs::exists(files.record)) {
            ++saves;
            EXPECT_EQ(read_journal(files.record).head.makes, hash_of(saved, hash_of(saved.dry()))) << name;
        } else {
            EXPECT_TRUE(saved.wet().empty()) << name;
        }
        EXPECT_TRUE(recovered_as_recorded(files, ground, strokes)) << name;
        EXPECT_GE(strokes, told) << name;
    }
    EXPECT_GT(saves, 3) << "names were those of saving";
}

// TP_KILLS=50 kills as often, TP_RANDOM_SEED=7 at other moments.
TEST(Sitting, KilledAtRandomMomentsItLosesNothing) {
    const TestDir folder;
    const fs::path file = folder / "a.exr", ground = folder / "ground.exr";
    const RecoveryFiles files = recovery_files(file);
    write_painting(file, *flat_surface(120, 100));
    write_painting(ground, *flat_surface(120, 100));
    const char* wanted = std::getenv("TP_KILLS");
    const int kills = wanted ? std::atoi(wanted) : 10;
    const char* seed_wanted = std::getenv("TP_RANDOM_SEED");
    const auto seed = static_cast<std::uint64_t>(seed_wanted ? std::atoi(seed_wanted) : 5);
    int told = 0, strokes = 0;
    for (int kill = 0; kill < kills; ++kill) {
        int ends[2];
        ASSERT_EQ(::pipe(ends), 0);
        const pid_t child = start_painting(file, ends);
        ::close(ends[1]);
        // A stroke at least, and then at any time of stroke or saving.
        char painted;
        ASSERT_EQ(::read(ends[0], &painted, 1), 1) << "the painter stopped by itself, kill " << kill;
        ++told;
        std::this_thread::sleep_for(std::chrono::microseconds(procedural::hash(seed, kill) % 60000));
        ::kill(child, SIGKILL);
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status));
        while (::read(ends[0], &painted, 1) == 1) ++told;
        ::close(ends[0]);

        settle_outputs_at(file);                 // as the next program does
        const Canvas saved = read_canvas(file);  // never torn
        EXPECT_TRUE(!fs::exists(files.record) ||
                    read_journal(files.record).head.makes == hash_of(saved, hash_of(saved.dry())));
        EXPECT_EQ(hash_of(saved.dry()), hash_of(read_painting(ground)));
        EXPECT_TRUE(recovered_as_recorded(files, ground, strokes)) << "after kill " << kill;
    }
    EXPECT_GE(strokes, told) << "what was painted is in a journal";
    EXPECT_LE(strokes, told + kills);
}

}  // namespace
}  // namespace tangi
