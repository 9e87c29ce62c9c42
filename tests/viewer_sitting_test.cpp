// viewer_sitting_test.cpp: of what was painted, nothing is lost and nothing is painted twice, whenever a
// program dies.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "paint/canvas_file.h"
#include "paint/tools_file.h"
#include "paint_support.h"
#include "surface/noise.h"
#include "surface/painting_file.h"
#include "viewer/painter.h"
#include "viewer_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

TEST(Sitting, SavedJournalsAreNotRecoveredTwice) {
    TestDir folder;
    const SittingFiles files = sitting_files(folder / "a.exr");
    EXPECT_FALSE(left_over(files));
    SittingRecord record(files);
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

TEST(Sitting, WhatWasSavedButNotPutAwayIsNotPaintedTwice) {
    TestDir folder;
    const SittingFiles files = sitting_files(folder / "a.exr");
    const std::string header = "{\"format\": \"tangipaint strokes\", \"version\": 1}\n",
                      old = "{\"event\":\"end\"}\n", undo = "{\"event\":\"undo\"}\n";
    for (const bool in_record_already : {false, true}) {
        write_bytes(files.unsaved, header + undo);
        write_bytes(files.record, header + old + (in_record_already ? undo : ""));
        write_bytes(files.painting, "saved later");
        fs::last_write_time(files.unsaved, fs::last_write_time(files.painting) - std::chrono::seconds(1));
        SittingRecord record(files);
        record.append(RedoEvent{});
        EXPECT_EQ(bytes_of(files.record), header + old + undo);
        const Journal journal = read_journal(files.unsaved);
        ASSERT_EQ(journal.entries.size(), 1u);
        EXPECT_TRUE(std::holds_alternative<RedoEvent>(journal.entries[0].event));
        record.put_away();
    }
}

// A program of its own, for the next test: paints and saves until it is killed, and writes a byte to a pipe
// for each stroke that is painted.
TEST(Sitting, DISABLED_PaintsUntilKilled) {
    const fs::path file = std::getenv("TP_PAINT_FILE");
    const int pipe_end = std::atoi(std::getenv("TP_PAINT_PIPE"));
    Painter painter({read_canvas(file), artist_acrylics(), file, false}, [] {});
    painter.start(std::make_shared<TexelTiles>(painter.surface(), painter.range()));
    if (auto left = left_over(sitting_files(file))) painter.recover(std::move(*left));
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
bool recovered_as_recorded(const SittingFiles& files, const fs::path& ground, int& strokes) {
    Session again(Canvas(std::make_shared<Surface>(read_painting(ground))), artist_acrylics());
    Session recovered(read_canvas(files.painting), artist_acrylics());
    read_tools(files.painting, recovered);
    if (fs::exists(files.record)) replay(again, read_journal(files.record));
    if (fs::exists(files.unsaved)) {
        const Journal last = read_journal(files.unsaved);
        const bool is_left_over = left_over(files).has_value();
        if (is_left_over) replay(recovered, last);
        const std::string text = bytes_of(files.unsaved);
        const bool in_record_already = !is_left_over && fs::exists(files.record) &&
                                       bytes_of(files.record).ends_with(text.substr(text.find('\n') + 1));
        if (!in_record_already) replay(again, last);
    }
    strokes = again.totals().strokes;
    if (recovered.board() && !identical(recovered.board()->wet(), again.board()->wet())) return false;
    return identical(recovered.canvas().wet(), again.canvas().wet()) &&
           recovered.brush()->bristles().total_mm == again.brush()->bristles().total_mm;
}

// TP_KILLS=50 kills as often, TP_RANDOM_SEED=7 at other moments.
TEST(Sitting, KilledAtRandomMomentsItLosesNothing) {
    const TestDir folder;
    const fs::path file = folder / "a.exr", ground = folder / "ground.exr";
    const SittingFiles files = sitting_files(file);
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
        const pid_t child = ::fork();
        if (child == 0) {
            ::setenv("TP_PAINT_FILE", file.c_str(), 1);
            ::setenv("TP_PAINT_PIPE", std::to_string(ends[1]).c_str(), 1);
            ::close(ends[0]);
            ::execl("/proc/self/exe", "viewer_tests", "--gtest_filter=Sitting.DISABLED_PaintsUntilKilled",
                    "--gtest_also_run_disabled_tests", "--gtest_brief=1", nullptr);
            ::_exit(1);
        }
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

        const Canvas saved = read_canvas(file);  // never torn
        EXPECT_EQ(hash_of(saved.dry()), hash_of(read_painting(ground)));
        EXPECT_TRUE(recovered_as_recorded(files, ground, strokes)) << "after kill " << kill;
    }
    EXPECT_GE(strokes, told) << "what was painted is in a journal";
    EXPECT_LE(strokes, told + kills);
}

}  // namespace
}  // namespace tangi
