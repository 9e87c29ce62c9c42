// main.cpp: the program `tangipaint`: finds the command, runs it, turns what went wrong into an exit code.
#include <fmt/format.h>
#include <glog/logging.h>
#include <sys/resource.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "cli/command.h"
#include "cli/help_pages.h"
#include "cli/message_length.h"
#include "cli/named_inputs.h"
#include "cli/renamed_flags.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/base/memory_error.h"
#include "surface/base/parallel.h"
#include "surface/file/file_name.h"
#include "surface/file/output_set.h"
#include "surface/file/stale_temporaries.h"
#include "surface/file/version.h"
#include "surface/image/image_memory.h"

namespace {

using namespace tangi;

// [MB] Of large images in memory (--memory-mb). With what else a command takes, 2 GB: a laptop of 8 has that
// left.
constexpr double kImageMemory_mb = 1200;

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

// Throws Error where stdout takes less than all of it.
void write_stdout(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        fail("the result cannot be written to standard output: {}", std::strerror(errno));
}

int ended(int code, const std::string& message, double seconds = 0) {
    tell_end(code, message, seconds);
    return code;
}

// Warnings and reasons as long as messages are: they may name what a file that is damaged holds.
void shorten_messages(nlohmann::json& value, bool is_message) {
    if (value.is_string() && is_message) {
        const auto& text = value.get_ref<const std::string&>();
        if (text.size() > kMostOfMessage) value = shortened(text, kMostOfMessage);
    } else if (value.is_object()) {
        for (auto& [name, inner] : value.items())
            shorten_messages(inner, is_message || name == "warnings" || name == "poor" || name == "reason");
    } else if (value.is_array()) {
        for (nlohmann::json& inner : value) shorten_messages(inner, is_message);
    }
}

// Outputs that an earlier command was putting in place when it was stopped come first: the files that are
// named may be among them.
void settle_outputs_named(std::span<char*> words) {
    std::set<std::filesystem::path> folders;
    for (const std::string_view word : words) {
        const std::size_t value = word.starts_with('-') ? word.find('=') + 1 : 0;
        if (word.starts_with('-') && value == 0) continue;
        const std::filesystem::path path = word.substr(value);
        std::error_code missing;
        if (path.has_filename()) folders.insert(path.has_parent_path() ? path.parent_path() : ".");
        if (std::filesystem::is_directory(path, missing)) folders.insert(path);
    }
    for (const std::filesystem::path& folder : folders) settle_outputs(folder);
}

// What went wrong, with the names that files were asked for by.
std::string in_lasting_words(const std::string& message) {
    return printable(shortened(in_lasting_names(message), kMostOfMessage));
}

int run(const Command& command, const ConsoleOptions& console, std::span<char*> words,
        const std::function<nlohmann::json()>& body) {
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const std::string name = command.name;
    const std::string who = "tangipaint " + name + ": ";
    try {
        set_console(console, {words.begin(), words.end()});
        settle_outputs_named(words.subspan(1));
        const NamedInputs inputs(words.subspan(1));
        nlohmann::json result = body();
        shorten_messages(result, false);
        result["command"] = name;
        result["version"] = version();
        if (!result.contains("inputs")) result["inputs"] = inputs.records();
        result["seconds"] = seconds();
        result["peak_memory_mb"] = peak_memory_mb();
        write_stdout(json_lines(result));
        const nlohmann::json poor = result.value("poor", nlohmann::json::array());
        for (const auto& reason : poor) warn("poor result: " + reason.get<std::string>());
        if (command.in_words && stdout_is_terminal())
            for (const std::string& line : command.in_words(result)) tell(line);
        return ended(poor.empty() ? kDone : kPoorNumbers, "", seconds());
    } catch (const Cancelled& stop) {
        return ended(kInterrupted, who + stop.what() + "; nothing half-written is left", seconds());
    } catch (const UsageError& error) {
        return ended(kUsage,
                     who + in_lasting_words(error.what()) + fmt::format("\nSee: tangipaint {} --help", name),
                     seconds());
    } catch (const Error& error) {
        return ended(kWorldIsWrong, who + in_lasting_words(error.what()), seconds());
    } catch (
        const std::filesystem::filesystem_error& error) {  // no permission to look, a name that is too long
        return ended(kWorldIsWrong, who + in_lasting_words(words_of(error)), seconds());
    } catch (const std::exception& bug) {
        const char* remedy = name == "fit" ? "; try a part of the picture with --crop" : "";
        if (says_no_memory(bug)) return ended(kWorldIsWrong, who + kNoMemory + remedy, seconds());
        return ended(kOurBug, who + "internal error, please report it: " + bug.what(), seconds());
    }
}

int show(const std::string& text) {
    try {
        write_stdout(text);
        return kDone;
    } catch (const Error& error) {
        return ended(kWorldIsWrong, std::string("tangipaint: ") + error.what());
    }
}

// How many letters must be put in, taken out, replaced or exchanged with their neighbour to turn one word
// into the other (Damerau 1964; no letter is touched twice).
std::size_t edits(std::string_view from, std::string_view to) {
    std::vector<std::size_t> before_last, last(to.size() + 1), row(to.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= from.size(); ++i) {
        before_last = std::exchange(last, row);
        row[0] = i;
        for (std::size_t j = 1; j < row.size(); ++j) {
            const std::size_t replaced = last[j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
            row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1])
                row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
    }
    return row.back();
}

bool is_command(const std::string& word) {
    return word == "help" || std::any_of(commands().begin(), commands().end(),
                                         [&](const Command& command) { return word == command.name; });
}

// The first flag that a command does not know, and the one that is meant; empty where it knows all.
std::string told_of_unknown_flag(const CLI::App& command) {
    const std::vector<std::string> extras = command.remaining();
    const auto flag = std::find_if(extras.begin(), extras.end(),
                                   [](const std::string& word) { return word.size() > 2 && word[0] == '-'; });
    if (flag == extras.end()) return "";
    const std::string word = flag->substr(0, flag->find('='));
    std::string nearest;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames())
            if (nearest.empty() || edits(word, "--" + name) < edits(word, nearest)) nearest = "--" + name;
    const bool is_near =
        !nearest.empty() && edits(word, nearest) <= std::max<std::size_t>(2, word.size() / 3);
    return fmt::format("{}: {} has no such option{}", word, command.get_name(),
                       is_near ? fmt::format("; did you mean {}?", nearest) : "");
}

// Words that a command does not know, of which the first is told.
std::string told_of_extras(const CLI::App& command) {
    if (std::string flag = told_of_unknown_flag(command); !flag.empty()) return flag;
    const std::vector<std::string> extras = command.remaining();
    return fmt::format("'{}': is more than {} takes", extras.empty() ? "" : extras.front(),
                       command.get_name());
}

// What the parser found wrong with a command's words, in ours where its own speak of what it does.
std::string told_of_usage(const CLI::App* command, const CLI::Error& error) {
    if (command && dynamic_cast<const CLI::ExtrasError*>(&error)) return told_of_extras(*command);
    std::string words = error.what();
    const std::string flag = words.substr(0, words.find(':'));
    if (command && dynamic_cast<const CLI::RequiredError*>(&error)) {  // it may be there, misspelt
        const std::string unknown = told_of_unknown_flag(*command);
        return unknown.empty() ? words : words + "; " + unknown;
    }
    const CLI::Option* option = command && dynamic_cast<const CLI::ArgumentMismatch*>(&error)
                                    ? command->get_option_no_throw(flag)
                                    : nullptr;
    if (!option) return words;
    const auto values = option->results().size();
    if (values == 0) return flag + ": has no value; give one behind it";
    if (option->get_items_expected_max() == 1 && values > 1)
        return fmt::format("{}: is given {} times ({}), and can be one only; give it once", flag, values,
                           fmt::join(option->results(), ", "));
    return words;
}

int no_command(const std::string& word) {
    const char* nearest = "help";
    for (const Command& command : commands())
        if (edits(word, command.name) < edits(word, nearest)) nearest = command.name;
    const bool is_near = edits(word, nearest) <= std::max<std::size_t>(1, std::strlen(nearest) / 2);
    return ended(kUsage, fmt::format("tangipaint: there is no command '{}'{} See: tangipaint help", word,
                                     is_near ? fmt::format("; did you mean '{}'?", nearest) : "."));
}

// The command that was asked for, with the words that it was asked with.
struct Asked {
    const Command* command = nullptr;
    std::function<nlohmann::json()> body;
    int threads = 0;
    double memory_mb = kImageMemory_mb;
    ConsoleOptions console;
};

// Parsing notes in `asked` which of them is there.
void add_commands(CLI::App& app, Asked& asked) {
    for (const Command& command : commands()) {
        CLI::App* sub = app.add_subcommand(command.name, command.summary);
        sub->add_option("--threads", asked.threads, "threads to use; all cores where not given")
            ->check(within(1, 1024));
        sub->add_option(
               "--memory-mb", asked.memory_mb,
               "megabytes of large images that are held in memory, 1200 where not given; more are on "
               "disk, in $TMPDIR or /var/tmp, and read as they are needed")
            ->check(within(64, 1e9));
        Flags flags(*sub);
        flags.option("--progress", asked.console.progress, "auto, or json: each line of stderr is an event")
            .check(one_of({"auto", "json"}));
        flags.flag("--quiet", asked.console.quiet, "nothing on stderr but errors");
        flags.option("--log", asked.console.log, "file that events are added to, one JSON line each");
        const auto action = command.set_up(flags);
        sub->callback([&asked, action, &command] {
            asked.body = action;
            asked.command = &command;
        });
    }
}

std::string told_of_failure(const CLI::App* parsed, const CLI::Error& error) {
    const std::vector<CLI::App*> chosen = parsed->get_subcommands();
    const std::string command = chosen.empty() ? "" : chosen.front()->get_name() + " ";
    return fmt::format("tangipaint: {}\nSee: tangipaint {}--help\n",
                       told_of_usage(chosen.empty() ? nullptr : chosen.front(), error), command);
}

// The code to end with, where the words are wrong or ask for help or the version.
std::optional<int> parse(CLI::App& app, std::vector<std::string> words) {
    try {
        std::reverse(words.begin(), words.end());  // as the parser takes them
        app.parse(words);
        return {};
    } catch (const CLI::ParseError& call) {
        std::ostringstream out, err;
        const int code = app.exit(call, out, err);
        write_stderr(err.str());
        return code == 0 ? show(out.str()) : kUsage;
    }
}

int write_pages(const CLI::App& app, const std::string& folder) {
    try {
        return show(fmt::format("{}\n", fmt::join(write_help_pages(app, folder), "\n")));
    } catch (const Error& error) {
        return ended(kWorldIsWrong, std::string("tangipaint help: --pages: ") + error.what());
    }
}

}  // namespace

int main(int argc, char** argv) {
    prepare_streams();
    google::InitGoogleLogging(argv[0]);      // Ceres logs through it; its numbers are in our reports
    FLAGS_minloglevel = google::GLOG_FATAL;  // and what it cannot solve is told by who asked

    CLI::App app(kAbout, "tangipaint");
    app.set_version_flag("--version", program_name());
    app.require_subcommand(0, 1);
    app.failure_message(told_of_failure);
    Asked asked;
    add_commands(app, asked);
    std::string topic;
    CLI::App* help = app.add_subcommand("help", "show what a command does and takes: tangipaint help fit");
    help->add_option("COMMAND", topic, "the command to explain");
    std::string pages;
    help->add_option("--pages", pages,
                     "write man pages and completions for bash, zsh and fish to this folder");

    if (argc > 1 && argv[1][0] != '-' && !is_command(argv[1])) return no_command(argv[1]);
    RenamedFlags typed = with_present_flags(std::vector<std::string>(argv + std::min(argc, 1), argv + argc));
    for (const std::string& text : typed.notes) write_stderr("tangipaint: note: " + printable(text) + "\n");
    if (!typed.given_twice.empty())
        return ended(kUsage, fmt::format("tangipaint: {}\nSee: tangipaint {} --help",
                                         printable(typed.given_twice), typed.words.front()));
    if (const std::optional<int> code = parse(app, typed.words)) return *code;
    if (!topic.empty() && !is_command(topic)) return no_command(topic);
    if (!topic.empty()) return show(app.get_subcommand(topic)->help("tangipaint"));
    if (!pages.empty()) return write_pages(app, pages);
    if (asked.command) {
        set_thread_count(asked.threads);
        limit_image_memory(static_cast<std::size_t>(asked.memory_mb * 1e6));
        return run(*asked.command, asked.console, std::span(argv, static_cast<std::size_t>(argc)).subspan(1),
                   asked.body);
    }
    // Not app.help(): after `tangipaint help` that would explain the command `help` alone.
    const std::string all = app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
    return help->parsed() ? show(all) : ended(kUsage, all);
}
