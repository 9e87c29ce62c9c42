// main.cpp: the program `tangipaint`: finds the command, runs it, turns what went wrong into an exit code.
#include <fmt/format.h>
#include <glog/logging.h>
#include <sys/resource.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "cli/command.h"
#include "surface/error.h"
#include "surface/parallel.h"

namespace {

using namespace tangi;

constexpr const char* kAbout =
    "TangiPaint: photographs of a painting under many lights in, a relightable digital twin out.\n"
    "Typical use:\n"
    "  tangipaint fit PHOTOS --out painting.exr\n"
    "  tangipaint compare painting.exr PHOTOS --out report\n"
    "  tangipaint relight painting.exr --light 1,0,0.3 --out raking.png\n";

double peak_memory_mb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

int run(const std::string& name, const std::function<nlohmann::json()>& body) {
    const auto start = std::chrono::steady_clock::now();
    try {
        nlohmann::json result = body();
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        result["command"] = name;
        result["seconds"] = seconds.count();
        result["peak_memory_mb"] = peak_memory_mb();
        const std::string text = result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
        if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
            fail("the result cannot be written to standard output: {}", std::strerror(errno));
        if (!result.contains("poor") || result["poor"].empty()) return kDone;
        for (const auto& reason : result["poor"]) warn("poor result: " + reason.get<std::string>());
        return kPoorNumbers;
    } catch (const Cancelled& stop) {
        fmt::print(stderr, "\ntangipaint {}: {}; nothing half-written is left\n", name, stop.what());
        return kInterrupted;
    } catch (const UsageError& error) {
        fmt::print(stderr, "tangipaint {}: {}\nSee: tangipaint help {}\n", name, error.what(), name);
        return kUsage;
    } catch (const Error& error) {
        fmt::print(stderr, "tangipaint {}: {}\n", name, error.what());
        return kWorldIsWrong;
    } catch (
        const std::filesystem::filesystem_error& error) {  // no permission to look, a name that is too long
        fmt::print(stderr, "tangipaint {}: {}: {}\n", name, error.path1().string(), error.code().message());
        return kWorldIsWrong;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "tangipaint {}: not enough memory{}\n", name,
                   name == "fit" ? "; try a part of the picture with --crop" : "");
        return kWorldIsWrong;
    } catch (const std::exception& bug) {
        fmt::print(stderr, "tangipaint {}: internal error, please report it: {}\n", name, bug.what());
        return kOurBug;
    }
}

}  // namespace

int main(int argc, char** argv) {
    google::InitGoogleLogging(argv[0]);  // Ceres logs through it; its numbers are in our reports
    // A disk or quota that is full shows as a failed write, with a message, instead of a signal.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);

    CLI::App app(kAbout, "tangipaint");
    app.set_version_flag("--version", "tangipaint " TP_VERSION);
    app.require_subcommand(0, 1);
    app.failure_message([](const CLI::App*, const CLI::Error& error) {
        return fmt::format("tangipaint: {}\nSee: tangipaint help\n", error.what());
    });
    int threads = 0;
    std::function<nlohmann::json()> body;
    std::string name;
    for (const Command& command : commands()) {
        CLI::App* sub = app.add_subcommand(command.name, command.summary);
        sub->add_option("--threads", threads, "threads to use; all cores where not given")
            ->check(CLI::Range(1, 1024));
        const auto action = command.set_up(*sub);
        sub->callback([&body, &name, action, n = command.name] {
            body = action;
            name = n;
        });
    }
    std::string topic;
    CLI::App* help = app.add_subcommand("help", "show what a command does and takes: tangipaint help fit");
    help->add_option("COMMAND", topic, "the command to explain");

    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp& call) {
        return app.exit(call);
    } catch (const CLI::CallForVersion& call) {
        return app.exit(call);
    } catch (const CLI::ParseError& error) {
        app.exit(error);
        return kUsage;
    }
    if (help->parsed() || !body) {
        if (topic.empty()) {
            // Not app.help(): after `tangipaint help` that would explain the command `help` alone.
            fmt::print(help->parsed() ? stdout : stderr, "{}",
                       app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal));
            return help->parsed() ? kDone : kUsage;
        }
        try {
            fmt::print("{}", app.get_subcommand(topic)->help("tangipaint"));
            return kDone;
        } catch (const CLI::OptionNotFound&) {
            fmt::print(stderr, "tangipaint: there is no command '{}'. See: tangipaint help\n", topic);
            return kUsage;
        }
    }
    set_thread_count(threads);
    return run(name, body);
}
