// cli_program.h: runs the real program as a user would: arguments, environment, limits, signals; and small
// stacks.
#pragma once

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "datasets/generator.h"
#include "surface/base/json_reading.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "tests/programs/support/program_server.h"
#include "tests/support/test_support.h"

namespace tangi {

// What a program left behind. `code` is what a shell would show: 128 + the number of a signal that killed it.
struct Finished {
    int code = -1;
    std::string out, err;
    bool timed_out = false;
    long peak_kib = 0;  // of memory

    // The one JSON object on stdout; fails the test where there is anything else.
    nlohmann::json json() const {
        auto value = json_or_discarded(out);
        EXPECT_TRUE(value.is_object()) << "stdout is not one JSON object:\n" << out << "\nstderr:\n" << err;
        return value.is_object() ? value : nlohmann::json::object();
    }
};

// How to run a program, where not as the test itself runs.
struct Conditions {
    std::filesystem::path cwd{};
    std::map<std::string, std::string> environment{};  // beside the test's own
    std::optional<rlim_t> largest_file{};              // [bytes] a write beyond it fails, as on a full disk
    std::optional<rlim_t> memory{};                    // [bytes] of address space
    bool bound_by_permissions = false;                 // as for anyone else, where the test runs as root
    const char* stdout_to = nullptr;                   // a file instead of the test
    const char* stderr_to = nullptr;                   // the same
    bool stderr_is_unread = false;                     // a pipe that nobody reads any more
    std::vector<int> closed{};                         // file descriptors, as after 2>&-
    std::vector<int> ignored_signals{};                // as under nohup
    std::chrono::seconds timeout{60};

    // Whether a process that is loaded already can become it (program_server.h).
    bool takes_a_fork() const {
        return !largest_file && !memory && !bound_by_permissions && !stdout_to && !stderr_to &&
               !stderr_is_unread && closed.empty() && ignored_signals.empty();
    }
};

// A program that runs. Killed where it is neither waited for nor done.
class Program {
public:
    explicit Program(const std::vector<std::string>& arguments, const Conditions& conditions = {},
                     const std::string& program = TP_PROGRAM)
        : timeout_(conditions.timeout) {
        int out[2], err[2];
        if (::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(err, O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
        std::vector<std::string> words = {program}, environment;
        words.insert(words.end(), arguments.begin(), arguments.end());
        for (const auto& [name, value] : conditions.environment) environment.push_back(name + "=" + value);
        for (char** entry = environ; *entry; ++entry) {
            const std::string text = *entry;
            if (!conditions.environment.contains(text.substr(0, text.find('=')))) environment.push_back(text);
        }
        const auto preloaded = conditions.environment.find("LD_PRELOAD");
        const ProgramServer* server =
            program == TP_PROGRAM && conditions.takes_a_fork()
                ? ProgramServer::with_preloaded(preloaded == conditions.environment.end() ? ""
                                                                                          : preloaded->second)
                : nullptr;
        if (server) {
            pid_ = server->start(words, environment, conditions.cwd.string(), out[1], err[1]);
        } else {
            const std::vector<char*> argv = pointers(words), envp = pointers(environment);
            pid_ = ::fork();
            if (pid_ == 0) become(conditions, out[1], err[1], argv, envp);
        }
        ::close(out[1]);
        ::close(err[1]);
        readers_.emplace_back(drain, out[0], &result_.out);
        readers_.emplace_back(drain, err[0], &result_.err);
    }
    ~Program() {
        if (!done_) signal(SIGKILL);
        wait();  // the readers, too
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    void signal(int number) {
        if (!done_) ::kill(pid_, number);
    }

    bool running() { return !reaped(WNOHANG); }
    pid_t pid() const { return pid_; }

    Finished wait() {
        const auto end = std::chrono::steady_clock::now() + timeout_;
        while (!reaped(WNOHANG)) {
            if (std::chrono::steady_clock::now() >= end) {
                result_.timed_out = true;
                ADD_FAILURE() << "the program did not end in " << timeout_.count() << " s and was killed";
                ::kill(pid_, SIGKILL);
                reaped(0);
                break;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        for (std::thread& reader : readers_) reader.join();
        readers_.clear();
        return result_;
    }

private:
    static std::vector<char*> pointers(std::vector<std::string>& words) {
        std::vector<char*> result;
        for (std::string& word : words) result.push_back(word.data());
        result.push_back(nullptr);
        return result;
    }

    // In the child, after fork: only calls that are safe there.
    [[noreturn]] static void become(const Conditions& c, int out, int err, const std::vector<char*>& argv,
                                    const std::vector<char*>& envp) {
        const auto limit = [](auto resource, const std::optional<rlim_t>& value) {
            if (!value) return;
            const rlimit both{*value, *value};
            ::setrlimit(resource, &both);
        };
        limit(RLIMIT_FSIZE, c.largest_file);
        limit(RLIMIT_AS, c.memory);
        if (c.bound_by_permissions) {
            ::prctl(PR_CAPBSET_DROP, 1 /* CAP_DAC_OVERRIDE */);
            ::prctl(PR_CAPBSET_DROP, 2 /* CAP_DAC_READ_SEARCH */);
        }
        if (!c.cwd.empty() && ::chdir(c.cwd.c_str()) != 0) ::_exit(126);
        if (c.stdout_to) out = ::open(c.stdout_to, O_WRONLY);
        if (c.stderr_to) err = ::open(c.stderr_to, O_WRONLY);
        if (int unread[2]; c.stderr_is_unread && ::pipe(unread) == 0) {
            ::close(unread[0]);
            err = unread[1];
        }
        ::dup2(out, STDOUT_FILENO);
        ::dup2(err, STDERR_FILENO);
        for (const int stream : c.closed) ::close(stream);
        ::signal(SIGINT, SIG_DFL);
        for (const int ignored : c.ignored_signals) ::signal(ignored, SIG_IGN);
        ::execve(argv[0], argv.data(), envp.data());
        ::_exit(127);
    }

    static void drain(int pipe, std::string* text) {
        char buffer[65536];
        for (ssize_t count; (count = ::read(pipe, buffer, sizeof buffer)) > 0;)
            text->append(buffer, static_cast<std::size_t>(count));
        ::close(pipe);
    }

    bool reaped(int how) {
        int status = 0;
        rusage usage{};
        if (done_ || ::wait4(pid_, &status, how, &usage) != pid_) return done_;
        result_.peak_kib = usage.ru_maxrss;
        result_.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        return done_ = true;
    }

    std::chrono::seconds timeout_;
    pid_t pid_ = -1;
    bool done_ = false;
    Finished result_;
    std::vector<std::thread> readers_;
};

inline Finished tangipaint(const std::vector<std::string>& arguments, const Conditions& conditions = {}) {
    return Program(arguments, conditions).wait();
}

// Several runs at a time, for those that do not disturb each other; results in the order of the commands.
inline std::vector<Finished> side_by_side(const std::vector<std::vector<std::string>>& commands) {
    constexpr std::size_t at_once = 4;
    std::vector<Finished> results;
    for (std::size_t first = 0; first < commands.size(); first += at_once) {
        std::vector<std::unique_ptr<Program>> programs;
        for (std::size_t i = first; i < std::min(first + at_once, commands.size()); ++i)
            programs.push_back(std::make_unique<Program>(commands[i]));
        for (const auto& program : programs) results.push_back(program->wait());
    }
    return results;
}

// True where a program ended with `code` and said all of `words` on stderr; where it failed, stdout must be
// empty.
inline testing::AssertionResult ended(const Finished& run, int code,
                                      const std::vector<std::string>& words = {}) {
    auto failure = testing::AssertionFailure() << "exit code " << run.code << ", stderr:\n" << run.err;
    if (run.code != code) return failure << "expected exit code " << code;
    for (const std::string& word : words)
        if (run.err.find(word) == std::string::npos) return failure << "does not say '" << word << "'";
    const bool speaks = code == 0 || code == 3;
    if (!speaks && !run.out.empty()) return failure << "a failed run wrote to stdout:\n" << run.out;
    return testing::AssertionSuccess();
}

// Every path in a folder, relative to it, hidden ones included; folders end with '/'.
inline std::vector<std::string> everything_in(const std::filesystem::path& folder) {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        paths.push_back(entry.path().lexically_relative(folder).string() + (entry.is_directory() ? "/" : ""));
    std::sort(paths.begin(), paths.end());
    return paths;
}

// Files that only an unfinished write leaves behind.
inline std::vector<std::string> leftovers_in(const std::filesystem::path& folder) {
    std::vector<std::string> left;
    for (const std::string& path : everything_in(folder))
        if (std::filesystem::path(path).filename().string().starts_with('.')) left.push_back(path);
    return left;
}

// A stack of 32 x 32 photographs of a procedural painting, by the Ward model, with gt/truth.exr as its
// painting: 12 lights in lights.lp, 2 held-out ones in heldout/heldout.lp.
class TinyStack {
public:
    explicit TinyStack(const std::function<void(GeneratorOptions&)>& change = {}, int size = 32) {
        PaintingOptions painting;
        painting.width = painting.height = size;
        painting.supersampling = 1;
        GeneratorOptions options;
        options.lights = 12;
        options.held_out = 2;
        options.reflectance = Reflectance::ward_bounded;
        if (change) change(options);
        photography_ = write_stack(folder(), procedural_painting(painting), options);
    }

    std::filesystem::path folder() const { return dir_ / "photos"; }
    std::string path() const { return folder().string(); }
    std::string photo(int number) const { return (folder() / name(number)).string(); }
    std::string name(int number) const {
        return photography_.photos[static_cast<std::size_t>(number)].light.name;
    }
    std::string truth() const { return (folder() / "gt" / "truth.exr").string(); }
    std::string lights() const { return (folder() / "lights.lp").string(); }
    std::string held_out() const { return (folder() / "heldout").string(); }
    const Photography& photography() const { return photography_; }
    // A place for results, beside the photographs.
    std::string out(const std::string& name) const { return (dir_ / name).string(); }
    const std::filesystem::path& root() const { return dir_.path(); }

    // Rewrites the lights file by a change of its lines (the first is the count).
    void change_lights(const std::function<void(std::vector<std::string>&)>& change) const {
        std::vector<std::string> lines;
        std::istringstream stream(read_text_file(lights()));
        for (std::string line; std::getline(stream, line);) lines.push_back(line);
        change(lines);
        std::string text;
        for (const std::string& line : lines) text += line + "\n";
        write_bytes(lights(), text);
    }

private:
    TestDir dir_;
    Photography photography_;
};

}  // namespace tangi
