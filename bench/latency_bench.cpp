// latency_bench.cpp: latency_bench TANGIPAINT PAINTING.exr [WIDTHxHEIGHT [BRUSHES.json]]: from input to pixel
// in the real window.
//
// Starts an X server (Xvfb) whose screen is a file in memory, and the window on it; moves the pointer (XTest)
// and waits until pixels away from the pointer have changed. Tilting, then quick strokes with the brush
// `flat`, as large as the presets file says. By the clock, and by how long the window's threads ran and
// waited for a processor meanwhile: on a busy machine, the latter is what another program's work cost.
#include <X11/Xlib.h>
#include <X11/extensions/XTest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void pause_ms(double ms) { std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(ms)); }

class Child {
public:
    Child(std::vector<std::string> words, const fs::path& output) {
        pid_ = ::fork();
        if (pid_ != 0) return;
        const int out = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        ::dup2(out, 1);
        ::dup2(out, 2);
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        ::execvp(arguments.front(), arguments.data());
        ::_exit(127);
    }
    ~Child() {
        ::kill(pid_, SIGTERM);
        ::waitpid(pid_, nullptr, 0);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    struct Times {
        double ran_ms = 0, waited_ms = 0;  // for a processor
    };
    // Of all its threads.
    Times times() const {
        Times sum;
        for (const auto& thread : fs::directory_iterator(fmt::format("/proc/{}/task", pid_))) {
            double ran = 0, waited = 0;
            std::ifstream(thread.path() / "schedstat") >> ran >> waited;
            sum.ran_ms += ran * 1e-6;
            sum.waited_ms += waited * 1e-6;
        }
        return sum;
    }

private:
    pid_t pid_ = -1;
};

// The screen of Xvfb: a file in X's own format (XWD).
class Pixels {
public:
    explicit Pixels(const fs::path& file) {
        const int opened = ::open(file.c_str(), O_RDONLY);
        size_ = static_cast<std::size_t>(fs::file_size(file));
        void* at = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, opened, 0);
        ::close(opened);
        if (at == MAP_FAILED) throw std::runtime_error("the screen cannot be read");
        bytes_ = static_cast<const unsigned char*>(at);
        begin_ = word(0) + 12 * word(19);
        line_ = word(12);
        width = static_cast<int>(word(4));
        height = static_cast<int>(word(5));
    }
    ~Pixels() { ::munmap(const_cast<unsigned char*>(bytes_), size_); }
    Pixels(const Pixels&) = delete;
    Pixels& operator=(const Pixels&) = delete;

    // Of places all over the right part of the screen, where no panels are, but near the pointer.
    std::vector<std::uint32_t> sample(int x, int y) const {
        constexpr int kLeft = 420, kStep = 24, kPointer = 32;
        std::vector<std::uint32_t> values;
        for (int j = kStep; j < height - kStep; j += kStep)
            for (int i = kLeft; i < width - kStep; i += kStep) {
                if (std::abs(i - x) < kPointer && std::abs(j - y) < kPointer) continue;
                std::uint32_t value = 0;
                std::memcpy(
                    &value,
                    bytes_ + begin_ + static_cast<std::size_t>(j) * line_ + 4u * static_cast<unsigned>(i), 4);
                values.push_back(value);
            }
        return values;
    }

    int width = 0, height = 0;

private:
    std::size_t word(std::size_t i) const {
        std::size_t value = 0;
        for (std::size_t b = 0; b < 4; ++b) value = value << 8 | bytes_[4 * i + b];
        return value;
    }
    const unsigned char* bytes_ = nullptr;
    std::size_t size_ = 0, begin_ = 0, line_ = 0;
};

class Pointer {
public:
    explicit Pointer(const std::string& name) {
        for (int i = 0; i < 200 && !(display_ = XOpenDisplay(name.c_str())); ++i) pause_ms(50);
        if (!display_) throw std::runtime_error("no X server: is Xvfb installed?");
    }
    ~Pointer() { XCloseDisplay(display_); }
    Pointer(const Pointer&) = delete;
    Pointer& operator=(const Pointer&) = delete;

    void move(int x, int y) {
        XTestFakeMotionEvent(display_, -1, x, y, 0);
        XFlush(display_);
    }
    void button(bool down) {
        XTestFakeButtonEvent(display_, 1, down, 0);
        XFlush(display_);
    }
    void key(const char* name) {
        const KeyCode code = XKeysymToKeycode(display_, XStringToKeysym(name));
        XTestFakeKeyEvent(display_, code, True, 0);
        XTestFakeKeyEvent(display_, code, False, 0);
        XFlush(display_);
    }

private:
    Display* display_ = nullptr;
};

double part_of(std::vector<double> values, double part) {
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1,
                           static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

// Waits until nothing has changed for a while.
void settle(const Pixels& pixels) {
    auto since = Clock::now();
    const auto start = since;
    for (auto last = pixels.sample(-99, -99); ms_since(since) < 1500 && ms_since(start) < 60000;) {
        pause_ms(50);
        auto now = pixels.sample(-99, -99);
        if (now != last) since = Clock::now();
        last = std::move(now);
    }
}

void tilting(Pointer& pointer, const Pixels& pixels, const Child& window) {
    const int cx = 420 + (pixels.width - 420) / 2, cy = pixels.height / 2;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> phase(20, 60);
    std::vector<double> latency_ms;
    pointer.key("t");
    pointer.move(cx, cy);
    settle(pixels);
    pointer.button(true);
    int missed = 0;
    const Child::Times before = window.times();
    const auto start = Clock::now();
    for (int i = 0; i < 300; ++i) {
        const int x = cx + static_cast<int>(std::lround(120 * std::sin(0.13 * i))),
                  y = cy + static_cast<int>(std::lround(60 * std::sin(0.29 * i)));
        const auto old = pixels.sample(x, y);
        const auto sent = Clock::now();
        pointer.move(x, y);
        bool seen = false;
        while (!seen && ms_since(sent) < 1000) {
            pause_ms(0.2);
            seen = pixels.sample(x, y) != old;
        }
        if (seen)
            latency_ms.push_back(ms_since(sent));
        else
            ++missed;
        pause_ms(phase(random));
    }
    const Child::Times after = window.times();
    const double wall_ms = ms_since(start);
    pointer.button(false);
    pointer.key("r");
    settle(pixels);
    if (latency_ms.empty()) throw std::runtime_error("the window never changed");
    fmt::print(
        "tilting: {} moves, {} of them without a change in a second; to the pixel: median {:.1f} ms, 99 % "
        "{:.1f} ms, "
        "largest {:.1f} ms; a move took {:.1f} ms of processor time, its threads waited {:.1f} ms for a "
        "processor "
        "({:.0f} % of the time)\n",
        latency_ms.size(), missed, part_of(latency_ms, 0.5), part_of(latency_ms, 0.99),
        part_of(latency_ms, 1), (after.ran_ms - before.ran_ms) / 300,
        (after.waited_ms - before.waited_ms) / 300, 100 * (after.waited_ms - before.waited_ms) / wall_ms);
}

void painting(Pointer& pointer, const Pixels& pixels, const Child& window) {
    const int cx = 420 + (pixels.width - 420) / 2, cy = pixels.height / 2;
    pointer.key("b");
    pointer.move(cx, cy);
    settle(pixels);
    std::vector<double> between_ms;
    double strokes_ms = 0;
    const Child::Times before = window.times();
    for (int stroke = 0; stroke < 8; ++stroke) {
        const int y = cy - 160 + 40 * stroke;
        pointer.move(cx - 300, y);
        pointer.button(true);
        const auto start = Clock::now();
        auto changed = start;
        auto last = pixels.sample(-99, -99);
        // Half a second for 600 pixels, a point every 4 ms.
        for (int i = 1; i <= 125; ++i) {
            pointer.move(cx - 300 + 600 * i / 125, y + static_cast<int>(std::lround(15 * std::sin(0.2 * i))));
            while (ms_since(start) < 4 * i) {
                pause_ms(1);
                auto now = pixels.sample(-99, -99);
                if (now == last) continue;
                between_ms.push_back(ms_since(changed));
                changed = Clock::now();
                last = std::move(now);
            }
        }
        pointer.button(false);
        strokes_ms += ms_since(start);
        pause_ms(300);
    }
    const Child::Times after = window.times();
    if (between_ms.empty()) throw std::runtime_error("nothing was painted");
    fmt::print(
        "painting: {:.1f} pictures a second while strokes go on; between two: median {:.1f} ms, 99 % {:.1f} "
        "ms; {:.1f} ms "
        "of processor time for one; threads waited {:.0f} % of the time for a processor\n",
        1000 * static_cast<double>(between_ms.size()) / strokes_ms, part_of(between_ms, 0.5),
        part_of(between_ms, 0.99), (after.ran_ms - before.ran_ms) / static_cast<double>(between_ms.size()),
        100 * (after.waited_ms - before.waited_ms) / (strokes_ms + 8 * 300));
}

void run(const std::string& program, const fs::path& file, const std::string& size,
         const std::string& brushes) {
    const fs::path folder = fs::temp_directory_path() / fmt::format("latency-{}", ::getpid());
    fs::create_directories(folder);
    const fs::path copy = folder / "painting.exr";
    fs::copy_file(file, copy);
    const std::string display = fmt::format(":{}", 100 + ::getpid() % 800);
    std::string screen = size;
    std::replace(screen.begin(), screen.end(), 'x', ' ');
    int width = 0, height = 0;
    if (std::sscanf(screen.c_str(), "%d %d", &width, &height) != 2)
        throw std::runtime_error(size + ": is not a width and a height, as 1920x1080");
    {
        const Child server({"Xvfb", display, "-screen", "0", fmt::format("{}x{}x24", width, height), "-fbdir",
                            folder.string(), "-nolisten", "tcp"},
                           folder / "server.txt");
        Pointer pointer(display);
        ::setenv("DISPLAY", display.c_str(), 1);
        ::setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
        ::unsetenv("WAYLAND_DISPLAY");
        ::setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
        const Pixels pixels(folder / "Xvfb_screen0");
        const auto start = Clock::now();
        const auto empty = pixels.sample(-99, -99);
        std::vector<std::string> words = {program, "paint", copy.string(), "--size", size};
        if (!brushes.empty()) words.insert(words.end(), {"--brushes", brushes});
        const Child window(words, folder / "window.txt");
        while (pixels.sample(-99, -99) == empty && ms_since(start) < 120000) pause_ms(5);
        const Child::Times opened = window.times();
        fmt::print(
            "opening: {:.2f} s to the first picture; {:.2f} s of processor time, threads waited {:.2f} s\n",
            ms_since(start) / 1000, opened.ran_ms / 1000, opened.waited_ms / 1000);
        pause_ms(1000);
        settle(pixels);
        tilting(pointer, pixels, window);
        painting(pointer, pixels, window);
    }
    fs::remove_all(folder);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc > 5) {
        fmt::print(stderr, "usage: latency_bench TANGIPAINT PAINTING.exr [WIDTHxHEIGHT [BRUSHES.json]]\n");
        return 2;
    }
    try {
        run(argv[1], argv[2], argc > 3 ? argv[3] : "1920x1080", argc > 4 ? argv[4] : "");
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
