// console.cpp: progress, warnings and errors on stderr, for people or as events; the log; and Ctrl-C.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>

#include "cli/command.h"
#include "cli/message_length.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/append_file.h"
#include "surface/file/file_bytes.h"
#include "surface/file/version.h"

namespace tangi {

namespace {

std::atomic<bool> stop_wanted = false;
std::atomic<std::int64_t> asked_ms = 0;  // when

// `timeout -s INT` signals the program and then its group: that is one request.
constexpr std::int64_t kOneRequest_ms = 500;

// The first Ctrl-C asks for an orderly stop, a second one kills.
extern "C" void on_interrupt(int signal) {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    const std::int64_t ms = std::int64_t(now.tv_sec) * 1000 + now.tv_nsec / 1000000 + 1;
    std::int64_t first = 0;
    if (asked_ms.compare_exchange_strong(first, ms)) {
        stop_wanted = true;
    } else if (ms - first >= kOneRequest_ms) {
        std::signal(signal, SIG_DFL);
        ::raise(signal);
    }
}

// A signal that was ignored when the program started stays so: whoever started it (nohup, a shell's trap)
// wants it to go on.
void stop_at(int signal) {
    struct sigaction now {};
    if (::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN) return;
    std::signal(signal, on_interrupt);
}

// Where our own messages go. Libraries write to the stream of this number by themselves ("libpng error: …",
// OpenCV's log), whatever they are told; what they found is in our message, in our words, and theirs go
// nowhere.
int own_stderr = STDERR_FILENO;

void keep_stderr_for_us() {
#ifndef __SANITIZE_ADDRESS__  // which has something to say
    // For who looks for a fault of a library.
    if (std::getenv("TANGIPAINT_LIBRARY_WORDS")) return;
    const int own = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    const int nowhere = own < 0 ? -1 : ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0 || ::dup2(nowhere, STDERR_FILENO) < 0) return;
    ::close(nowhere);
    own_stderr = own;
#endif
}

// "2026-03-01T12:34:56Z"
std::string time_now() {
    const std::time_t seconds = std::time(nullptr);
    std::tm utc{};
    ::gmtime_r(&seconds, &utc);
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%FT%TZ", &utc);
    return text.data();
}

// A log may be added to; a photograph, or whatever else has that name, may not.
void require_log(const std::string& path) {
    constexpr std::uint64_t longest_line = 1 << 20;
    std::error_code missing;
    if (std::filesystem::exists(path, missing)) {
        const std::string begins = FileBytes(path).bytes(0, longest_line);
        const nlohmann::json first = json_or_discarded(begins.substr(0, begins.find('\n')));
        if (!begins.empty() && !(first.is_object() && first.value("event", nlohmann::json()) == "start"))
            fail("--log {}: is no log of this program, and would be added to; give another name", path);
    }
}

class Console {
public:
    void set(const ConsoleOptions& options, const std::vector<std::string>& words) {
        const std::lock_guard lock(mutex_);
        is_json_ = options.progress == "json", is_quiet_ = options.quiet;
        if (options.log.empty()) return;
        require_log(options.log);
        log_.emplace(options.log);
        log({{"event", "start"}, {"version", version()}, {"arguments", words}});
    }

    bool show(std::string_view stage, double fraction) {
        using namespace std::chrono;
        const std::lock_guard lock(mutex_);
        const auto now = steady_clock::now();
        const bool new_stage = stage != stage_;
        if (new_stage) {
            finish_line();
            stage_ = stage;
            started_ = now;
            shown_ = now;
            log({{"event", "stage"}, {"stage", stage_}});
        }
        if (is_json_) {
            const bool is_due = new_stage || now - shown_ >= milliseconds(100);
            if (!is_quiet_ && (is_due || (fraction >= 1 && last_fraction_ < 1))) {
                write_event({{"event", "progress"}, {"stage", stage_}, {"fraction", fraction}});
                shown_ = now;
            }
            last_fraction_ = fraction;
            return !stop_wanted;
        }
        if (is_quiet_) return !stop_wanted;
        const auto pause = is_terminal_ ? milliseconds(100) : milliseconds(5000);
        if (fraction >= 1 || now - shown_ >= pause) {
            if (now - started_ >= (is_terminal_ ? milliseconds(300) : milliseconds(2000)))
                draw(fraction, now);
            shown_ = now;
        }
        return !stop_wanted;
    }

    // `kind` of event; for people `lead` comes before the text.
    void say(const char* kind, const char* lead, const std::string& text) {
        const std::lock_guard lock(mutex_);
        finish_line();
        log({{"event", kind}, {"text", text}});
        if (is_quiet_) return;
        if (is_json_)
            write_event({{"event", kind}, {"text", text}});
        else
            write_stderr(lead + text + "\n");
    }

    void end(int code, const std::string& message, double seconds) {
        const std::lock_guard lock(mutex_);
        if (stop_wanted && is_terminal_) write_stderr("\n");  // behind ^C
        finish_line();
        nlohmann::json event = {{"event", "end"}, {"exit_code", code}, {"seconds", seconds}};
        if (!message.empty()) event["text"] = message;
        log(event);
        if (is_json_ && !(is_quiet_ && message.empty()))
            write_event(event);
        else if (!is_json_ && !message.empty())
            write_stderr(message + "\n");
    }

    ~Console() { finish_line(); }

private:
    static void write_event(const nlohmann::json& event) { write_stderr(json_line(event) + "\n"); }

    // A log that cannot be written any more is no reason to lose the work.
    void log(nlohmann::json event) {
        if (!log_) return;
        event["time"] = time_now();
        try {
            log_->append(json_line(event) + "\n");
        } catch (const Error& error) {
            log_.reset();
            write_stderr(fmt::format("warning: the log ends here: {}\n", error.what()));
        }
    }

    void draw(double fraction, std::chrono::steady_clock::time_point now) {
        const double elapsed = std::chrono::duration<double>(now - started_).count();
        const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
        if (!is_terminal_) {
            write_stderr(fmt::format("{}: {} %\n", stage_, percent));
            return;
        }
        const std::string left = fraction > 0.05 && fraction < 1
                                     ? fmt::format(", {:.0f} s left", elapsed * (1 - fraction) / fraction)
                                     : "";
        constexpr int width = 30;
        const int filled = width * percent / 100;
        write_stderr(fmt::format("\r\033[K{:<15} [{}{}] {:3} %{}", stage_, std::string(filled, '#'),
                                 std::string(width - filled, '.'), percent, left));
        line_open_ = true;
    }

    void finish_line() {
        if (line_open_) write_stderr("\n");
        line_open_ = false;
    }

    std::mutex mutex_;
    std::string stage_;
    std::chrono::steady_clock::time_point started_, shown_;
    bool line_open_ = false, is_json_ = false, is_quiet_ = false;
    double last_fraction_ = 0;
    std::optional<AppendFile> log_;
    const bool is_terminal_ = ::isatty(own_stderr) != 0;
};

Console& console() {
    static Console instance;
    return instance;
}

}  // namespace

std::string printable(std::string_view text) { return shortened(text, text.size()); }

void write_stderr(std::string_view text) {
    while (!text.empty()) {
        const ssize_t count = ::write(own_stderr, text.data(), text.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return;
        text.remove_prefix(static_cast<std::size_t>(count));
    }
}

void prepare_streams() {
    // A disk or quota that is full, and a pipe that nobody reads, show as a failed write instead of a signal.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    // A stream that was closed (2>&-) would be the number of the next file that is opened, and messages would
    // end up in a painting. What takes its place refuses to be written, or read.
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    keep_stderr_for_us();
}

Progress console_progress() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) stop_at(signal);
    return [](std::string_view stage, double fraction) { return console().show(stage, fraction); };
}

bool interrupted() { return stop_wanted; }

void set_console(const ConsoleOptions& options, const std::vector<std::string>& words) {
    console().set(options, words);
}

void warn(const std::string& text) {
    console().say("warning", "warning: ", printable(shortened(text, kMostOfMessage)));
}

void tell(const std::string& text) { console().say("note", "", printable(shortened(text, kMostOfMessage))); }

void tell_lines(const std::string& text) { console().say("note", "", text); }

void tell_end(int code, const std::string& message, double seconds) { console().end(code, message, seconds); }

bool stdout_is_terminal() { return ::isatty(STDOUT_FILENO) != 0; }

}  // namespace tangi
