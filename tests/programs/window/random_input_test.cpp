// random_input_test.cpp: the real window under a hand that does anything at all: it neither dies nor
// complains, and the record of each painting that it saved makes that painting.
//
// Short here. TP_RANDOM_S=3600 lets it go on for an hour, TP_RANDOM_SEED=7 is another hand; under the
// sanitizers (preset asan, random_tests) it is tests/programs/support/window_program.cpp, which is the window
// without the other commands.
#include "surface/base/json_reading.h"
#include "tests/programs/support/random_hand.h"

#include <gmock/gmock.h>

#include <fstream>

#include "retouch/treatment/treatment_strokes.h"
#include "tests/support/paint/record_support.h"
#include "tests/support/viewer/viewer_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

double number_of(const char* variable, double otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atof(text) : otherwise;
}

// Of all paintings that the hand saved: what their records make. Those of treatments are in their logs.
void expect_records_of_what_was_saved(const fs::path& folder) {
    int records = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const fs::path& painting = entry.path();
        if (painting.extension() != ".exr" || !fs::exists(recovery_files(painting).record) ||
            fs::exists(painting.parent_path() / "log.jsonl"))
            continue;
        ++records;
        EXPECT_TRUE(recorded_as_saved(painting)) << painting;
    }
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().filename() == "log.jsonl" &&
            fs::exists(entry.path().parent_path() / "painting.exr")) {
            const Treatment treatment = Treatment::open(entry.path().parent_path());
            EXPECT_THAT(treatment.check(), testing::IsEmpty());
            EXPECT_THAT(strokes_that_cannot_be_repeated(treatment), testing::IsEmpty());
        }
    testing::Test::RecordProperty("records", records);
}

// The hand may give "close" another key in the window's list of keys, and press that.
bool gave_close_another_key(const Screen& screen) {
    const fs::path keys = screen.settings() / "keys.json";
    if (!fs::exists(keys)) return false;
    const auto changed = json_or_discarded(bytes_of(keys));
    return changed.is_object() && changed.contains("close");
}

// `first` is pressed before anything else, `further` among the hand's keys.
void expect_to_go_on(const std::string& first, const std::string& further) {
    const auto screen = Screen::open();
    if (!screen) GTEST_SKIP() << "no Xvfb and xdotool here";
    const TestDir folder;
    // So deep that no hand climbs to what is not the test's.
    fs::path deep = folder.path();
    for (int i = 0; i < 12; ++i) deep /= "d";
    fs::create_directories(deep);
    for (const char* name : {"a.exr", "b.exr"}) {
        Surface painting = painted_surface(160, 120, name[0] == 'a' ? 1 : 2);
        painting.mm_per_pixel = 0.5;
        write_painting(deep / name, painting);
    }
    write_bytes(deep / "broken.exr", "no painting");
    Conditions conditions = screen->conditions();
    const double seconds = number_of("TP_RANDOM_S", 10);
    // Strokes that wait are painted before it closes, which takes the sanitizers a while.
    conditions.timeout = std::chrono::seconds(static_cast<int>(3 * seconds) + 300);
    conditions.cwd = deep;
    const auto seed = static_cast<std::uint64_t>(number_of("TP_RANDOM_SEED", 1));
    std::unique_ptr<Program> window;
    const auto open = [&] {
        const auto before = screen->picture();
        window = std::make_unique<Program>(
            std::vector<std::string>{"paint", "a.exr", "--size",
                                     fmt::format("{}x{}", Screen::kWidth, Screen::kHeight), "--camera",
                                     "/nowhere"},
            conditions);
        if (!screen->becomes_different(before, {0, 0, Screen::kWidth, Screen::kHeight}, 0.02)) return false;
        screen->settled();
        if (!first.empty()) screen->key(first);
        return true;
    };
    ASSERT_TRUE(open());
    RandomHand hand(*screen, seed,
                    {(deep / "a.exr").string(), "b.exr", "broken.exr", "new", "../d", "\\\\ ?*", "3.5"},
                    further);
    std::string log;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    int rounds = 0;
    for (; std::chrono::steady_clock::now() < end; ++rounds) {
        if (!window->running()) {
            const Finished ended = window->wait();
            if (ended.code != 0 || !gave_close_another_key(*screen))
                FAIL() << "seed " << seed << ", round " << rounds << ": ended with code " << ended.code
                       << ":\n"
                       << ended.err << ended.out << "\nwhat the hand did:\n"
                       << (log.size() > 20'000 ? log.substr(log.size() - 20'000) : log);
            fs::remove(screen->settings() / "keys.json");
            ASSERT_TRUE(open()) << "again in round " << rounds << ": " << window->wait().err;
            log += "closed by a key of the hand's, and opened again\n";
        }
        log += hand.act() + '\n';
    }
    EXPECT_GT(rounds, 0);
    window->signal(SIGTERM);
    const Finished done = window->wait();
    EXPECT_EQ(done.code, 0) << "seed " << seed << ", round " << rounds << ":\n" << done.err << "\n" << log;
    expect_records_of_what_was_saved(deep);
    if (testing::Test::HasFailure()) fmt::print("seed {}:\n{}\n", seed, log);
}

TEST(RandomHand, TheWindowGoesOn) { expect_to_go_on("", ""); }

TEST(RandomHand, TheTreatmentGoesOn) {
    expect_to_go_on("ctrl+t",
                    "k k p ctrl+t ctrl+g ctrl+g ctrl+Return ctrl+Return ctrl+k ctrl+k ctrl+f ctrl+f ctrl+i "
                    "ctrl+shift+i n ctrl+e ctrl+shift+x ctrl+shift+r");
}

}  // namespace
}  // namespace tangi
