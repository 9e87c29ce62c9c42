// What stops a command on its way: Ctrl-C, a kill.
#include <sys/resource.h>
#include <algorithm>

#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;
namespace fs = std::filesystem;

// Waits until the program would hear Ctrl-C (or another signal): it says so in /proc. False where it was done
// before.
bool listens(Program& program, int signal = SIGINT) {
    const fs::path status = fmt::format("/proc/{}/status", program.pid());
    while (program.running()) {
        const std::string text = bytes_of(status);
        const auto at = text.find("SigCgt:\t");
        if (at != std::string::npos &&
            (std::stoull(text.substr(at + 8, 16), nullptr, 16) & (1u << (signal - 1))))
            return true;
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return false;
}

// [s] of the processor, which count on a machine that is shared: all that a running program has had, and what
// programs that ended had.
double processor_s(pid_t running) {
    clockid_t clock;
    timespec time{};
    if (::clock_getcpuclockid(running, &clock) == 0) ::clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
double processor_s_of_ended() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void sleep_for(double seconds) { std::this_thread::sleep_for(duration<double>(seconds)); }

// Runs a command `times` times and sends it `signal` at moments spread over the time that it takes; calls
// `check` after each. Returns how often it was stopped.
int interrupt(const std::vector<std::string>& arguments, int signal, int times,
              const std::function<void(const Finished&)>& check) {
    double takes = 0;
    {
        Program whole(arguments);
        EXPECT_TRUE(listens(whole));
        const auto start = steady_clock::now();
        const Finished run = whole.wait();
        takes = duration<double>(steady_clock::now() - start).count();
        EXPECT_TRUE(ended(run, 0));
        check(run);
    }
    Random random(11);
    int stopped = 0;
    for (int i = 0; i < times; ++i) {
        Program program(arguments);
        EXPECT_TRUE(listens(program));
        const double moment = takes * (i + random.uniform()) / (times + 1);
        sleep_for(moment);
        program.signal(signal);
        const Finished run = program.wait();
        if (run.code != 0) {
            ++stopped;
            EXPECT_TRUE(ended(run, 130, {"stopped at your request; nothing half-written is left"}));
        } else {
            takes = std::min(takes, moment);  // the machine had been busier when it was measured
        }
        check(run);
    }
    return stopped;
}

void expect_whole_pictures(const fs::path& folder) {
    if (!fs::exists(folder)) return;
    for (const std::string& path : everything_in(folder))
        if (fs::path(path).extension() == ".png") {
            EXPECT_EQ(read_picture(folder / path).width(), 48) << path;
        }
}

TEST(CliInterrupt, FitLeavesTheOldPaintingAndNothingElse) {
    const TinyStack stack({}, 48);
    const std::string target = stack.out("a.exr"), old = bytes_of(stack.truth());
    const std::vector<std::string> fit = {"fit", stack.path(), "--out", target, "--threads", "2"};
    write_bytes(target, old);
    const auto before = everything_in(stack.root());
    const int stopped = interrupt(fit, SIGINT, 7, [&](const Finished& run) {
        EXPECT_EQ(everything_in(stack.root()), before);
        EXPECT_EQ(bytes_of(target) == old, run.code != 0);  // the old one, or the new one as a whole
        EXPECT_TRUE(read_painting(target).width() == 48);
        write_bytes(target, old);
    });
    EXPECT_GE(stopped, 3);
}

std::string journal_of_strokes(int count) {
    std::string text = "{\"format\": \"tangipaint strokes\", \"version\": 1}\n";
    for (int i = 0; i < count; ++i)
        text += fmt::format(
            "{{\"event\": \"stroke\", \"paint\": {{\"Bone Black\": 1}}, \"seed\": {}}}\n{{\"event\": "
            "\"point\", \"x\": -20, \"y\": {}}}\n{{\"event\": \"point\", \"x\": 20, \"y\": "
            "{}}}\n{{\"event\": \"end\"}}\n",
            i, 2 * (i % 12) - 12, i % 12);
    return text;
}

// `timeout -s INT` signals the program, and then all of its group.
TEST(CliInterrupt, TwoSignalsInOneMomentAreOneRequest) {
    const TestDir dir;
    const std::string journal = (dir / "a.jsonl").string();
    write_bytes(journal, journal_of_strokes(600));
    Program program({"replay", "--substrate", "linen", "--width-mm", "60", "--height-mm", "40", "--pixel-mm",
                     "0.1", journal, "--out", (dir / "a.exr").string()});
    ASSERT_TRUE(listens(program));
    sleep_for(0.2);
    program.signal(SIGINT);
    sleep_for(0.002);
    program.signal(SIGINT);
    EXPECT_TRUE(ended(program.wait(), 130, {"stopped at your request; nothing half-written is left"}));
    EXPECT_EQ(everything_in(dir.path()), std::vector<std::string>{"a.jsonl"});
}

// A long fit stops soon, wherever it is.
TEST(CliInterrupt, FitOfTheSampleStopsWithinSeconds) {
    const TestDir dir;
    const std::string photos = std::string(TP_SOURCE_DIR) + "/datasets/impasto/jpg";
    for (const auto& [seconds, signal] :
         {std::pair{0.05, SIGINT}, {0.6, SIGINT}, {1.5, SIGTERM}, {0.6, SIGHUP}}) {
        const double earlier_s = processor_s_of_ended();
        Program program({"fit", photos, "--lights", photos + "/lights.lp", "--out", (dir / "a.exr").string(),
                         "--threads", "1"});
        ASSERT_TRUE(listens(program));
        sleep_for(seconds);
        const double asked_s = processor_s(program.pid());
        program.signal(signal);
        EXPECT_TRUE(ended(program.wait(), 130, {"stopped at your request"}));
        EXPECT_LT(processor_s_of_ended() - earlier_s - asked_s, 5);
        EXPECT_EQ(everything_in(dir.path()), std::vector<std::string>());
    }
}

// nohup, and a shell that ignores Ctrl-C for what it starts, mean it.
TEST(CliInterrupt, SignalsThatWereIgnoredStayIgnored) {
    const TinyStack stack({}, 48);
    Conditions ignoring;
    ignoring.ignored_signals = {SIGINT, SIGHUP};
    Program program({"fit", stack.path(), "--out", stack.out("a.exr"), "--threads", "1"}, ignoring);
    ASSERT_TRUE(listens(program, SIGTERM));
    program.signal(SIGHUP);
    program.signal(SIGINT);
    EXPECT_TRUE(ended(program.wait(), 0));
    EXPECT_EQ(read_painting(stack.out("a.exr")).width(), 48);
}

TEST(CliInterrupt, CompareLeavesTheOldReportAsItWas) {
    const TinyStack stack({}, 48);
    const std::string out = stack.out("c");
    const std::vector<std::string> compare = {"compare", stack.truth(), stack.path(), "--out", out};
    // What was there: the report of another painting, and a file of the user's.
    Surface other = read_painting(stack.truth());
    for (Rgb& rho : other.diffuse.pixels()) rho *= 0.7f;
    write_painting(stack.out("other.exr"), other);
    ASSERT_TRUE(
        ended(tangipaint({"compare", stack.out("other.exr"), stack.path(), "--out", stack.out("old")}), 0));
    write_bytes(stack.out("old/pictures/mine.txt"), "mine");
    const auto contents = [](const fs::path& folder) {
        std::map<std::string, std::string> all;
        for (const std::string& path : everything_in(folder))
            all[path] = path.ends_with('/') ? "" : bytes_of(folder / path);
        return all;
    };
    const auto old = contents(stack.out("old"));
    const auto put_old = [&] {
        fs::remove_all(out);
        fs::copy(stack.out("old"), out, fs::copy_options::recursive);
    };
    put_old();
    const int stopped = interrupt(compare, SIGINT, 5, [&](const Finished& run) {
        const auto now = contents(out);
        EXPECT_EQ(now == old, run.code != 0);
        EXPECT_EQ(now.at("pictures/mine.txt"), "mine");
        EXPECT_EQ(now.size(), old.size());
        put_old();
    });
    EXPECT_GE(stopped, 2);
    // and where there was none, there is none
    const int again = interrupt(compare, SIGINT, 2, [&](const Finished& run) {
        EXPECT_EQ(fs::exists(out), run.code == 0);
        fs::remove_all(out);
    });
    EXPECT_GE(again, 1);
}

TEST(CliInterrupt, RelightLeavesWholePictures) {
    const TinyStack stack({}, 48);
    const std::string out = stack.out("d");
    const std::vector<std::string> relight = {"relight",      stack.truth(), "--lights",
                                              stack.lights(), "--out",       out};
    const int stopped = interrupt(relight, SIGINT, 5, [&](const Finished& run) {
        expect_whole_pictures(out);
        EXPECT_EQ(leftovers_in(stack.root()), std::vector<std::string>());
        EXPECT_TRUE(run.code != 0 || everything_in(out).size() == 12);
        fs::remove_all(out);
    });
    EXPECT_GE(stopped, 2);
}

TEST(CliInterrupt, GenerateLeavesWholePhotographsAndNoLightsFile) {
    const TestDir dir;
    const std::string out = (dir / "s").string();
    const std::vector<std::string> generate = {
        "generate",        "--out", out,        "--width", "48",         "--height", "48",
        "--supersampling", "1",     "--lights", "40",      "--held-out", "0"};
    const int stopped = interrupt(generate, SIGINT, 4, [&](const Finished& run) {
        if (fs::exists(out + "/gt")) fs::remove_all(out + "/gt");
        expect_whole_pictures(out);
        EXPECT_EQ(leftovers_in(dir.path()), std::vector<std::string>());
        EXPECT_EQ(fs::exists(out + "/lights.lp"), run.code == 0);
        fs::remove_all(out);
    });
    EXPECT_GE(stopped, 1);
}

TEST(CliInterrupt, AKillLeavesTheOldPainting) {
    const TinyStack stack({}, 48);
    const std::string target = stack.out("a.exr"), old = bytes_of(stack.truth());
    write_bytes(target, old);
    for (const double seconds : {0.0, 0.03, 0.08}) {
        Program program({"fit", stack.path(), "--out", target, "--threads", "1", "--max-iterations", "1000"});
        ASSERT_TRUE(listens(program));
        sleep_for(seconds);
        program.signal(SIGKILL);
        const Finished run = program.wait();
        if (run.code == 0) continue;  // it was faster
        EXPECT_EQ(run.code, 128 + SIGKILL);
        EXPECT_TRUE(bytes_of(target) == old);
    }
    // What was left behind is in nobody's way.
    EXPECT_TRUE(ended(tangipaint({"fit", stack.path(), "--out", target}), 0));
}

// TP_KILLS=50 kills as often, TP_RANDOM_SEED=7 at other moments.
int number_of(const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : otherwise;
}

// Kills a command at moments spread over the time that it takes, also while it saves; what `state` gives is
// the one that was there before or the one of a whole run, and what it left behind is gone after the next
// run.
void kill_at_random(const std::vector<std::string>& command, const fs::path& root,
                    const std::function<void()>& put_old, const std::function<std::string()>& state) {
    put_old();
    const std::string old = state();
    const auto start = steady_clock::now();
    ASSERT_TRUE(ended(tangipaint(command), 0));
    const double takes = duration<double>(steady_clock::now() - start).count();
    const std::string whole = state();
    ASSERT_NE(whole, old);
    const auto files = everything_in(root);
    Random random(static_cast<std::uint64_t>(number_of("TP_RANDOM_SEED", 1)));
    const int kills = number_of("TP_KILLS", 5);
    int killed = 0;
    for (int i = 0; i < kills; ++i) {
        put_old();
        Program program(command);
        sleep_for(takes * (i + random.uniform()) / kills);
        program.signal(SIGKILL);
        const bool done = program.wait().code == 0;
        killed += !done;
        EXPECT_TRUE(state() == whole || (!done && state() == old)) << "kill " << i;
    }
    EXPECT_GE(killed, kills / 4);
    put_old();
    ASSERT_TRUE(ended(tangipaint(command), 0));
    EXPECT_EQ(everything_in(root), files);
    EXPECT_EQ(state(), whole);
}

TEST(CliInterrupt, AKillInReplayAndExportLeavesTheOldOneOrTheNewOne) {
    const TestDir dir;
    const std::string journal = (dir / "a.jsonl").string(), painting = (dir / "a.exr").string(),
                      out = (dir / "out").string();
    write_bytes(journal, journal_of_strokes(12));
    const std::vector<std::string> replay = {"replay", "--substrate", "linen", "--width-mm",
                                             "60",     "--height-mm", "40",    "--pixel-mm",
                                             "0.1",    journal,       "--out", painting};
    kill_at_random(
        replay, dir.path(), [&] { write_bytes(painting, "old"); }, [&] { return bytes_of(painting); });
    const auto put_old = [&] {
        fs::remove_all(out);
        fs::create_directory(out);
    };
    const auto state = [&] {
        std::string all;
        for (const std::string& file : everything_in(out))
            all += file + (file.ends_with('/') ? "" : bytes_of(fs::path(out) / file));
        return all;
    };
    kill_at_random({"export", painting, "--to", "layers", "--out", out}, dir.path(), put_old, state);
}

}  // namespace
}  // namespace tangi
