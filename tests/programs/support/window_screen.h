// window_screen.h: a screen of its own (Xvfb), with a pointer and a keyboard (xdotool), and what it shows.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include "tests/programs/support/cli_program.h"

namespace tangi {

inline constexpr int kMiddleX = 650, kMiddleY = 350;  // [pixels] of the window's canvas

class Screen {
public:
    static constexpr int kWidth = 1000, kHeight = 700;

    // Null where the programs are missing.
    static std::unique_ptr<Screen> open() {
        for (const char* program : {kXvfb, kXdotool})
            if (!std::filesystem::exists(program)) return nullptr;
        for (int attempt = 0; attempt < 200; ++attempt) {
            const int number = 100 + (::getpid() * 7 + attempt * 37) % 800;
            // Another's, or one that was killed and left it: the server could not be told from it.
            if (std::filesystem::exists(socket_of(number))) continue;
            auto screen = std::unique_ptr<Screen>(new Screen(number));
            if (screen->until([&] {
                    return std::filesystem::exists(screen->socket_) || !screen->server_->running();
                }) &&
                screen->server_->running())
                return screen;
        }
        return nullptr;
    }
    ~Screen() { server_->signal(SIGKILL); }

    Conditions conditions() const {
        Conditions c;
        c.environment = {{"DISPLAY", fmt::format(":{}", number_)},
                         {"LIBGL_ALWAYS_SOFTWARE", "1"},
                         {"WAYLAND_DISPLAY", ""},
                         {"XDG_CONFIG_HOME", (folder_.path() / "config").string()},
                         {"XDG_DATA_HOME", (folder_.path() / "data").string()}};
        c.timeout = std::chrono::seconds(120);
        return c;
    }

    std::filesystem::path settings() const { return folder_ / "config" / "tangipaint"; }

    // Words of xdotool: {"mousemove", "10", "20"}.
    void x(const std::vector<std::string>& words) const {
        const Finished done = Program(words, conditions(), kXdotool).wait();
        EXPECT_EQ(done.code, 0) << done.err;
    }
    // The same, where it does not matter whether there is a window to do it to.
    void x_if_it_can(const std::vector<std::string>& words) const {
        Program(words, conditions(), kXdotool).wait();
    }
    void key(const std::string& name) const { x({"key", name}); }
    // Into what has the keyboard, and Enter.
    void enter(const std::string& text) const {
        if (!text.empty()) x({"type", "--delay", "20", text});
        key("Return");
    }
    void drag(int button, std::pair<int, int> from, std::pair<int, int> to) const {
        const std::string b = std::to_string(button);
        std::vector<std::string> words = {"mousemove", std::to_string(from.first),
                                          std::to_string(from.second), "mousedown", b};
        for (int i = 1; i <= 12; ++i)
            for (const std::string& word :
                 {std::string("mousemove"), std::to_string(from.first + (to.first - from.first) * i / 12),
                  std::to_string(from.second + (to.second - from.second) * i / 12), std::string("sleep"),
                  std::string("0.02")})
                words.push_back(word);
        words.insert(words.end(), {"mouseup", b});
        x(words);
    }

    // What is seen [sRGB, 0..1]. The frame buffer is a file in X's own format (XWD).
    Image<Rgb> picture() const {
        const std::string bytes = bytes_of(folder_ / "Xvfb_screen0");
        const auto word = [&](std::size_t i) {
            std::uint32_t v = 0;
            for (std::size_t b = 0; b < 4; ++b) v = v << 8 | static_cast<unsigned char>(bytes.at(4 * i + b));
            return v;
        };
        const std::size_t begin = word(0) + 12 * word(19), line = word(12);
        Image<Rgb> picture(static_cast<int>(word(4)), static_cast<int>(word(5)));
        for (int y = 0; y < picture.height(); ++y)
            for (int x = 0; x < picture.width(); ++x) {
                const std::size_t at =
                    begin + static_cast<std::size_t>(y) * line + 4 * static_cast<std::size_t>(x);
                const auto channel = [&](std::size_t i) {
                    return static_cast<float>(static_cast<unsigned char>(bytes.at(at + i))) / 255;
                };
                picture(x, y) = {channel(2), channel(1), channel(0)};
            }
        return picture;
    }

    // Mean difference in a region [sRGB, 0..1].
    static double difference(const Image<Rgb>& a, const Image<Rgb>& b, const Region& region) {
        double sum = 0;
        for (int y = region.y0; y < region.y1; ++y)
            for (int x = region.x0; x < region.x1; ++x) {
                const Rgb d = glm::abs(a(x, y) - b(x, y));
                sum += (d.r + d.g + d.b) / 3;
            }
        return sum / (static_cast<double>(region.width()) * region.height());
    }

    // The picture once nothing more comes: it has not changed for a second in which the server and the
    // programs on its screen had nothing to do, or for three whatever they do.
    Image<Rgb> settled() const {
        const std::filesystem::path file = folder_ / "Xvfb_screen0";
        std::string last = bytes_of(file);
        auto since = std::chrono::steady_clock::now(), idle_since = since;
        Work before = work();
        until([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            const auto now = std::chrono::steady_clock::now();
            std::string next = bytes_of(file);
            if (next != last) since = now;
            last = std::move(next);
            const Work sum = work();
            // Those of a program that ends go with it.
            if (sum.runs || sum.ticks > before.ticks + kTicksAtRest || sum.ticks < before.ticks) {
                idle_since = now;
                before = sum;
            }
            return now - since >= std::chrono::seconds(3) ||
                   now - std::max(since, idle_since) >= std::chrono::seconds(1);
        });
        return picture();
    }

    // Waits until a region is this different from a picture, at least or at most.
    bool becomes_different(const Image<Rgb>& from, const Region& region, double by) const {
        return until([&] { return difference(from, picture(), region) > by; });
    }
    bool becomes_alike(const Image<Rgb>& from, const Region& region, double within) const {
        return until([&] { return difference(from, picture(), region) < within; });
    }

    // Waits for something, a minute at most.
    static bool until(const std::function<bool()>& done) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (std::chrono::steady_clock::now() < end) {
            if (done()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return false;
    }

private:
    static constexpr const char* kXvfb = "/usr/bin/Xvfb";
    static constexpr const char* kXdotool = "/usr/bin/xdotool";

    // What a window that waits for input still uses, in a second [1/100 s of a processor].
    static constexpr long kTicksAtRest = 3;

    struct Work {
        long ticks = 0;     // of processor time so far [1/100 s]
        bool runs = false;  // there is a thread that runs, or would if there were a processor for it
    };

    // Of the server and of all programs that were told to draw on its screen.
    Work work() const {
        const std::string display = fmt::format("DISPLAY=:{}", number_) + '\0';
        Work sum;
        std::error_code gone;  // processes and threads end while they are looked at
        for (const auto& process : std::filesystem::directory_iterator("/proc", gone)) {
            const std::string id = process.path().filename().string();
            if (id.find_first_not_of("0123456789") != std::string::npos) continue;
            if (id != std::to_string(server_->pid()) &&
                ('\0' + text_of(process.path() / "environ")).find('\0' + display) == std::string::npos)
                continue;
            for (const auto& thread : std::filesystem::directory_iterator(process.path() / "task", gone)) {
                const std::string stat = text_of(thread.path() / "stat");
                std::istringstream fields(stat.substr(std::min(stat.rfind(')') + 1, stat.size())));
                std::string state, field;
                long user = 0, system = 0;
                fields >> state;
                for (int i = 0; i < 10; ++i) fields >> field;
                fields >> user >> system;
                sum.ticks += user + system;
                sum.runs = sum.runs || state == "R" || state == "D";
            }
        }
        return sum;
    }

    static std::string text_of(const std::filesystem::path& file) {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    static std::string socket_of(int number) { return fmt::format("/tmp/.X11-unix/X{}", number); }

    explicit Screen(int number) : number_(number), socket_(socket_of(number)) {
        Conditions c;
        c.timeout = std::chrono::seconds(600);
        server_ = std::make_unique<Program>(
            std::vector<std::string>{fmt::format(":{}", number), "-screen", "0",
                                     fmt::format("{}x{}x24", kWidth, kHeight), "-fbdir",
                                     folder_.path().string(), "-nolisten", "tcp"},
            c, kXvfb);
    }

    TestDir folder_;
    int number_;
    std::string socket_;
    std::unique_ptr<Program> server_;
};

}  // namespace tangi
