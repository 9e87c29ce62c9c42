// console.cpp: progress and warnings on stderr, and Ctrl-C.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <mutex>

#include "cli/command.h"
#include "cli/message_length.h"
#include "surface/base/json_text.h"

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

class Console {
public:
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
        }
        const auto pause = is_terminal_ ? milliseconds(100) : milliseconds(5000);
        if (fraction >= 1 || now - shown_ >= pause) {
            if (now - started_ >= (is_terminal_ ? milliseconds(300) : milliseconds(2000)))
                draw(fraction, now);
            shown_ = now;
        }
        return !stop_wanted;
    }

    void say(const std::string& text) {
        const std::lock_guard lock(mutex_);
        finish_line();
        write_stderr(text + "\n");
    }

    ~Console() { finish_line(); }

private:
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
    bool line_open_ = false;
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

void warn(const std::string& text) {
    console().say("warning: " + printable(shortened(text, kMostOfMessage)));
}

void tell(const std::string& text) { console().say(printable(shortened(text, kMostOfMessage))); }

bool stdout_is_terminal() { return ::isatty(STDOUT_FILENO) != 0; }

}  // namespace tangi
