// fault_scene.h: a command of which a call that changes a file fails, or a call that reads one, or for which
// there is no memory, or which is killed: what was is there as a whole, or what is to be, and the next
// command leaves nothing behind.
//
// A sample of the faults; all of them with TP_FAULTS=all (before a release), those of one kind with
// TP_FAULT_KIND=calls, kills, memory or reads, of some scenes with TP_FAULT_SCENES=undo,report.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <set>

#include "tests/programs/support/cli_program.h"

namespace tangi {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using State = std::map<std::string, std::string>;

inline constexpr const char* kTime =
    "1700000000";  // [s] so that what tells when it was made is the same each time

// What other programs see: names that are hidden are looked at elsewhere.
inline State visible(const fs::path& folder) {
    State all;
    for (const std::string& path : everything_in(folder))
        if (!path.starts_with('.') && path.find("/.") == std::string::npos)
            all[path] = path.ends_with('/') ? "" : bytes_of(folder / path);
    return all;
}

inline Words left_in(const fs::path& folder) {
    Words left;
    for (const std::string& path : everything_in(folder))
        if (path.starts_with('.') || path.find("/.") != std::string::npos ||
            path.find("/pending/") != std::string::npos)
            left.push_back(path);
    return left;
}

inline Words names_that_differ(const State& one, const State& other) {
    Words names;
    for (const auto& [name, bytes] : one)
        if (const auto found = other.find(name); found == other.end() || found->second != bytes)
            names.push_back(name);
    for (const auto& [name, bytes] : other)
        if (!one.contains(name)) names.push_back(name);
    return names;
}

struct Scene {
    std::string name;
    std::vector<Words> before;   // commands that make what is there before
    Words command;               // what is tried
    Words reads;                 // a command that reads some of what it writes
    std::vector<Words> again{};  // what is done after it; the command itself where nothing is given
};

struct Fault {
    long at = 0;
    int reason = EIO;  // 0: killed
    bool stays = false;
    bool torn = false;  // half of what was to be written is
};

inline std::string words_of(const Fault& fault) {
    return fmt::format("{}{}{}", fault.reason == 0 ? "killed" : std::strerror(fault.reason),
                       fault.stays ? " from there on" : "", fault.torn ? ", half-way" : "");
}

inline bool tries_all_faults() {
    const char* text = std::getenv("TP_FAULTS");
    return text && std::string(text) == "all";
}

inline bool tries_faults_of(const std::string& kind) {
    const char* text = std::getenv("TP_FAULT_KIND");
    return !text || kind == text;
}

inline bool tries_scene(const std::string& name) {
    const char* text = std::getenv("TP_FAULT_SCENES");
    return !text || ("," + std::string(text) + ",").find("," + name + ",") != std::string::npos;
}

class CliFaults : public testing::Test {
protected:
    CliFaults() : stack_([](GeneratorOptions& options) { options.lights = 8; }, 24) {
        fs::create_directory(root());
        fs::create_directory(given());
        fs::copy(stack_.folder(), given() / "photos", fs::copy_options::recursive);
        fs::copy_file(stack_.truth(), given() / "p.exr");
    }
    fs::path root() const { return fs::canonical(stack_.root()) / "run"; }
    fs::path given() const { return fs::canonical(stack_.root()) / "given"; }

    void start_from(const fs::path& folder) const {
        fs::remove_all(root());
        fs::copy(folder, root(), fs::copy_options::recursive | fs::copy_options::copy_symlinks);
        // What is written holds the times of what it was made of.
        const auto then = std::chrono::file_clock::from_sys(
            std::chrono::sys_seconds(std::chrono::seconds(std::stol(kTime))));
        for (const auto& entry : fs::recursive_directory_iterator(root()))
            if (entry.is_regular_file() && !entry.is_symlink()) fs::last_write_time(entry.path(), then);
    }

    Conditions conditions(const std::map<std::string, std::string>& faults) const {
        Conditions all;
        all.cwd = root();
        all.environment = {{"LD_PRELOAD", TP_FAULT_INJECTOR},
                           {"TP_FAULT_UNDER", root().string()},
                           {"TP_FAULT_TIME", kTime},
                           {"USER", "A. Restorer"}};
        for (const auto& [name, value] : faults) all.environment[name] = value;
        return all;
    }

    // So that calls come in one order.
    static Words with_threads(Words command) {
        command.insert(command.end(), {"--threads", "1"});
        return command;
    }

    Finished run(const Words& command, const std::map<std::string, std::string>& faults = {}) const {
        return tangipaint(with_threads(command), conditions(faults));
    }

    static bool is_done(const Finished& run) { return run.code == 0 || run.code == 3; }

    void try_scene(const Scene& scene) {
        if (!tries_scene(scene.name)) return;
        SCOPED_TRACE(scene.name);
        prepare(scene);
        if (HasFatalFailure()) return;
        if (tries_faults_of("calls")) try_calls(scene);
        if (tries_faults_of("kills") && tries_all_faults()) try_kills(scene);
        if (tries_faults_of("memory")) try_memory(scene);
        if (tries_faults_of("reads")) try_reads(scene);
    }

    // The calls that count, where the command is done.
    Words traced(const Words& command, std::map<std::string, std::string> which) const {
        const fs::path trace = fs::path(stack_.root()) / "trace";
        which["TP_FAULT_TRACE"] = trace.string();
        const Finished done = run(command, which);
        EXPECT_TRUE(is_done(done)) << testing::PrintToString(command) << done.err;
        Words lines;
        std::istringstream text(bytes_of(trace));
        for (std::string line; std::getline(text, line);) lines.push_back(line);
        fs::remove(trace);
        return lines;
    }

private:
    // What is there before, what after, and that it is the same each time.
    void prepare(const Scene& scene) {
        start_from(given());
        for (const Words& command : scene.before) {
            const Finished made = run(command);
            ASSERT_TRUE(is_done(made)) << testing::PrintToString(command) << made.err;
        }
        prepared_ = fs::path(stack_.root()) / ("before-" + scene.name);
        fs::copy(root(), prepared_, fs::copy_options::recursive);
        before_ = visible(root());
        const auto start = std::chrono::steady_clock::now();
        calls_ = traced(scene, {});
        whole_ = std::chrono::steady_clock::now() - start;
        after_ = visible(root());
        ASSERT_FALSE(before_ == after_) << "it changes nothing";
        ASSERT_EQ(left_in(root()), Words());
        ASSERT_GT(calls_.size(), 3u) << "is the injector loaded?";
        start_from(prepared_);
        ASSERT_TRUE(is_done(run(scene.command)));
        ASSERT_EQ(names_that_differ(visible(root()), after_), Words()) << "not the same each time";
    }

    Words traced(const Scene& scene, const std::map<std::string, std::string>& which) const {
        start_from(prepared_);
        return traced(scene.command, which);
    }

    void try_calls(const Scene& scene) const {
        const std::vector<Fault> faults = chosen();
        for (const Fault& fault : faults) {
            start_from(prepared_);
            try_fault(scene, fault);
        }
        fmt::print("{}: {} calls that change files, {} faults\n", scene.name, calls_.size(), faults.size());
    }

    // What is on the disk changes at calls alone, and a kill before each of them is among the others. Beside
    // them, as many as a hundred at any time.
    void try_kills(const Scene& scene) const {
        constexpr int kKills = 100;
        int killed = 0;
        for (int i = 0; i < kKills; ++i) {
            const auto after = whole_ * (i + 0.5) / kKills;
            SCOPED_TRACE(fmt::format("killed after {:.4f} s", after.count()));
            start_from(prepared_);
            Program program(with_threads(scene.command), conditions({}));
            std::this_thread::sleep_for(after);
            program.signal(SIGKILL);
            const Finished ended = program.wait();
            killed += ended.code == 128 + SIGKILL;
            expect_one_or_the_other(scene, ended);
            expect_goes_on(scene, ended);
        }
        fmt::print("{}: {} times killed of {}\n", scene.name, killed, kKills);
    }

    // The allocations of 64 KiB and more: there is an Error, or a library does without.
    void try_memory(const Scene& scene) const {
        const auto count = static_cast<long>(traced(scene, {{"TP_FAULT_MEMORY_AT", "0"}}).size());
        const std::vector<long> places = some_of(count, kSampledAllocations);
        for (const long at : places) {
            SCOPED_TRACE(fmt::format("allocation {} of {} fails", at, count));
            start_from(prepared_);
            const Finished ended = run(scene.command, {{"TP_FAULT_MEMORY_AT", std::to_string(at)}});
            EXPECT_TRUE(is_done(ended) || ended.code == 1) << ended.code << ended.err;
            if (!is_done(ended)) {
                EXPECT_THAT(ended.err, testing::HasSubstr("not enough memory"));
                EXPECT_EQ(ended.out, "");
            }
            const State now = visible(root());
            if (is_done(ended) || now != before_) {
                EXPECT_EQ(names_that_differ(now, after_), Words()) << ended.err;
            }
            EXPECT_EQ(left_in(root()), Words()) << ended.err;
        }
        fmt::print("{}: {} allocations, {} faults\n", scene.name, count, places.size());
    }

    // A disk that cannot be read: there is an Error, or what cannot be read is named and left out.
    void try_reads(const Scene& scene) const {
        const Words reads = traced(scene, {{"TP_FAULT_READS", "1"}});
        const std::vector<long> places = some_of(static_cast<long>(reads.size()), kSampledReads);
        for (const long at : places) {
            SCOPED_TRACE(fmt::format("call {} ({}) fails", at, reads[static_cast<std::size_t>(at - 1)]));
            start_from(prepared_);
            const Finished ended =
                run(scene.command, {{"TP_FAULT_READS", "1"}, {"TP_FAULT_AT", std::to_string(at)}});
            EXPECT_TRUE(is_done(ended) || ended.code == 1) << ended.code << ended.err;
            if (is_done(ended)) {  // as if nothing were, or it says what is left out
                if (ended.err.empty()) {
                    EXPECT_EQ(names_that_differ(visible(root()), after_), Words());
                }
                continue;
            }
            EXPECT_EQ(ended.out, "");
            EXPECT_THAT(ended.err, testing::HasSubstr(std::strerror(EIO)));
            expect_one_or_the_other(scene, ended);
            expect_goes_on(scene, ended);
        }
        fmt::print("{}: {} calls that read, {} faults\n", scene.name, reads.size(), places.size());
    }

    // All of 1 to `count`, or so many of them, evenly spread.
    static std::vector<long> some_of(long count, long sampled) {
        std::vector<long> places;
        if (tries_all_faults()) sampled = count;
        sampled = std::min(sampled, count);
        for (long i = 0; i < sampled; ++i) places.push_back(1 + (2 * i + 1) * count / (2 * sampled));
        return places;
    }

    // Of many writes to one file, neither the first nor the last, nor each 32nd.
    bool is_one_of_many(long at) const {
        const auto call = [&](long place) {
            return place >= 1 && place <= static_cast<long>(calls_.size())
                       ? calls_[static_cast<std::size_t>(place - 1)]
                       : std::string();
        };
        return call(at - 1) == call(at) && call(at + 1) == call(at) && at % 32 != 0;
    }

    // Faults at all calls or, in a small part of the time, at some from the first to the last, and at those
    // where names are changed.
    std::vector<Fault> chosen() const {
        const bool all = tries_all_faults();
        const long count = static_cast<long>(calls_.size());
        std::set<long> places;
        for (long at = 1; at <= count; ++at) {
            const std::string& call = calls_[static_cast<std::size_t>(at - 1)];
            const bool commits = call.find(".outputs.") != std::string::npos ||
                                 (call.starts_with("rename") && call.find(".tmp") == std::string::npos) ||
                                 call.find("log.jsonl") != std::string::npos;
            if ((all && !is_one_of_many(at)) || commits) places.insert(at);
        }
        constexpr std::size_t kSampled = 4;  // of each scene; the others before a release
        if (!all) {
            std::vector<long> some(places.begin(), places.end());
            places.clear();
            for (std::size_t i = 0; i < kSampled && !some.empty(); ++i)
                places.insert(some[(i * some.size() + some.size() / 2) / kSampled % some.size()]);
            for (long i = 0; i < 2; ++i) places.insert(1 + (2 * i + 1) * count / 4);
        }
        std::vector<Fault> faults;
        std::size_t turn = 0;
        for (const long at : places) {
            std::vector<Fault> kinds = {{at, 0}, {at, EIO}, {at, ENOSPC, true, true}};
            if (calls_[static_cast<std::size_t>(at - 1)].starts_with("write"))
                kinds.push_back({at, 0, false, true});
            if (all)
                faults.insert(faults.end(), kinds.begin(), kinds.end());
            else
                faults.push_back(kinds[turn++ % kinds.size()]);
        }
        return faults;
    }

    void try_fault(const Scene& scene, const Fault& fault) const {
        SCOPED_TRACE(fmt::format("call {} ({}) {}", fault.at, calls_[static_cast<std::size_t>(fault.at - 1)],
                                 words_of(fault)));
        const Finished ended = run(scene.command, {{"TP_FAULT_AT", std::to_string(fault.at)},
                                                   {"TP_FAULT_ERRNO", std::to_string(fault.reason)},
                                                   {"TP_FAULT_STAYS", fault.stays ? "1" : "0"},
                                                   {"TP_FAULT_TORN", fault.torn ? "1" : "0"}});
        if (fault.reason == 0) {
            EXPECT_EQ(ended.code, 128 + SIGKILL) << ended.err;
        } else if (is_done(ended)) {
            EXPECT_EQ(names_that_differ(visible(root()), after_), Words());
        } else {
            expect_told(ended, fault);
        }
        expect_one_or_the_other(scene, ended);
        expect_goes_on(scene, ended);
    }

    // Whoever reads it by this program finds the one or the other.
    void expect_one_or_the_other(const Scene& scene, const Finished& ended) const {
        const Finished read = run(scene.reads);
        const State now = visible(root());
        EXPECT_TRUE(now == before_ || now == after_)
            << "neither, by " << testing::PrintToString(names_that_differ(now, before_)) << "\nnor "
            << testing::PrintToString(names_that_differ(now, after_)) << "\n"
            << ended.err << read.err;
    }

    // What comes next is done as if nothing had been, and leaves nothing that is hidden.
    void expect_goes_on(const Scene& scene, const Finished& ended) const {
        for (const Words& next : scene.again) {
            const Finished done = run(next);
            EXPECT_TRUE(is_done(done)) << testing::PrintToString(next) << "\n" << ended.err << done.err;
        }
        if (scene.again.empty()) {
            const Finished done = run(scene.command);
            EXPECT_TRUE(is_done(done)) << ended.err << done.err;
            EXPECT_EQ(names_that_differ(visible(root()), after_), Words());
        }
        EXPECT_EQ(left_in(root()), Words()) << ended.err;
    }

    static void expect_told(const Finished& ended, const Fault& fault) {
        EXPECT_EQ(ended.code, 1) << ended.err;
        EXPECT_EQ(ended.out, "");
        EXPECT_THAT(ended.err, testing::HasSubstr(std::strerror(fault.reason)));
        EXPECT_THAT(ended.err, testing::Not(testing::HasSubstr(".tmp")));
        EXPECT_THAT(ended.err, testing::Not(testing::HasSubstr(".outputs.")));
        EXPECT_LT(ended.err.size(), 700u) << ended.err;
    }

    static constexpr long kSampledAllocations = 3, kSampledReads = 2;  // of each scene: some seconds

    TinyStack stack_;
    State before_, after_;
    Words calls_;
    fs::path prepared_;                      // a copy of what is there before
    std::chrono::duration<double> whole_{};  // what the command takes
};

}  // namespace tangi
