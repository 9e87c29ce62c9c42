// browser.h: a browser without a screen, driven through a pipe (Chrome DevTools Protocol): pages as a visitor
// has them.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "surface/base/json_reading.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {

// Where one is installed; empty else.
inline std::string browser_program() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        for (const char* name : {"chromium-headless-shell", "chromium"})
            if (::access((folder + "/" + name).c_str(), X_OK) == 0) return folder + "/" + name;
    return {};
}

class Browser {
public:
    explicit Browser(const std::filesystem::path& scratch,
                     const std::vector<std::string>& flags = {"--hide-scrollbars"})
        : scratch_(scratch) {
        int to[2], from[2];
        if (::pipe2(to, O_CLOEXEC) != 0 || ::pipe2(from, O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
        const std::string program = browser_program(),
                          profile = "--user-data-dir=" + (scratch / "profile").string();
        std::vector<std::string> words = {program,
                                          "--headless",
                                          "--no-sandbox",
                                          "--use-gl=angle",
                                          "--use-angle=swiftshader",
                                          "--enable-unsafe-swiftshader",
                                          "--force-color-profile=srgb",
                                          "--disable-background-networking",
                                          "--remote-debugging-pipe",
                                          profile,
                                          "about:blank"};
        words.insert(words.end() - 1, flags.begin(), flags.end());
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        pid_ = ::fork();
        if (pid_ == 0) {
            ::setpgid(0, 0);
            const int in = ::fcntl(to[0], F_DUPFD, 10), out = ::fcntl(from[1], F_DUPFD, 10);
            ::dup2(in, 3);  // where the browser reads, and writes to 4
            ::dup2(out, 4);
            const int nothing = ::open("/dev/null", O_RDWR);
            for (const int fd : {0, 1, 2}) ::dup2(nothing, fd);
            ::execv(program.c_str(), argv.data());
            ::_exit(127);
        }
        ::close(to[0]);
        ::close(from[1]);
        to_ = to[1];
        from_ = from[0];
        const nlohmann::json targets = call("Target.getTargets");
        for (const auto& target : targets["targetInfos"])
            if (target["type"] == "page")
                session_ = call("Target.attachToTarget",
                                {{"targetId", target["targetId"]}, {"flatten", true}})["sessionId"];
        call("Page.enable");
        call("Runtime.enable");
        call("Network.enable");
    }
    ~Browser() {
        ::kill(-pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
        ::close(to_);
        ::close(from_);
    }
    Browser(const Browser&) = delete;
    Browser& operator=(const Browser&) = delete;

    nlohmann::json call(const std::string& method, nlohmann::json parameters = nlohmann::json::object()) {
        nlohmann::json message = {{"id", ++id_}, {"method", method}, {"params", std::move(parameters)}};
        if (!session_.empty()) message["sessionId"] = session_;
        const std::string text = message.dump();
        if (::write(to_, text.c_str(), text.size() + 1) < 0) throw std::runtime_error("the browser is gone");
        for (;;) {
            const nlohmann::json answer = next();
            if (answer.value("id", 0) == id_) return answer.value("result", nlohmann::json::object());
            const std::string event = answer.value("method", "");
            if (event == "Runtime.exceptionThrown") errors += answer["params"].dump() + "\n";
            if (event == "Network.requestWillBeSent") requests.push_back(answer["params"]["request"]["url"]);
        }
    }
    nlohmann::json evaluate(const std::string& expression) {
        const nlohmann::json answer =
            call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}});
        // None while one page is left for another.
        return answer.contains("result") ? answer["result"].value("value", nlohmann::json()) : nullptr;
    }
    void open(const std::string& url, int width, int height) {
        call("Emulation.setDeviceMetricsOverride",
             {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
        call("Page.navigate", {{"url", "about:blank"}});  // so that a new hash is a new page
        call("Page.navigate", {{"url", url}});
    }
    bool becomes_true(const std::string& expression) {
        for (int i = 0; i < 400; ++i) {
            if (evaluate(expression) == true) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        return false;
    }
    void drag(glm::dvec2 from, glm::dvec2 to) {
        const auto mouse = [&](const char* type, const glm::dvec2& at) {
            call("Input.dispatchMouseEvent", {{"type", type},
                                              {"x", at.x},
                                              {"y", at.y},
                                              {"button", "left"},
                                              {"buttons", 1},
                                              {"clickCount", 1}});
        };
        mouse("mousePressed", from);
        for (int i = 1; i <= 4; ++i) mouse("mouseMoved", from + (to - from) * (i / 4.0));
        mouse("mouseReleased", to);
    }
    void click(glm::dvec2 at) { drag(at, at); }
    // A key by its name ("ArrowLeft"), and text that is typed.
    void press(const std::string& key) {
        for (const char* type : {"rawKeyDown", "keyUp"})
            call("Input.dispatchKeyEvent", {{"type", type}, {"key", key}});
    }
    void type(const std::string& text) { call("Input.insertText", {{"text", text}}); }
    Image<Rgb> screenshot() {  // [sRGB, 0..1]
        const std::string text = call("Page.captureScreenshot")["data"];
        const auto path = scratch_ / "screenshot.png";
        std::ofstream(path, std::ios::binary) << bytes_of(text);
        return read_picture(path);
    }

    static std::string bytes_of(const std::string& base64) {
        std::string bytes;
        unsigned value = 0;
        int bits = 0;
        for (const char c : base64) {
            if (c == '=') break;
            const unsigned digit = c >= 'A' && c <= 'Z'   ? unsigned(c - 'A')
                                   : c >= 'a' && c <= 'z' ? unsigned(c - 'a') + 26
                                   : c >= '0' && c <= '9' ? unsigned(c - '0') + 52
                                   : c == '+'             ? 62
                                                          : 63;
            value = value << 6 | digit;
            if ((bits += 6) >= 8) bytes += static_cast<char>(value >> (bits -= 8) & 0xff);
        }
        return bytes;
    }

    std::string errors;                 // uncaught, of pages
    std::vector<std::string> requests;  // what pages fetched

private:
    nlohmann::json next() {
        for (;;) {
            const auto end = arrived_.find('\0');
            if (end != std::string::npos) {
                const std::string text = arrived_.substr(0, end);
                arrived_.erase(0, end + 1);
                return read_json(text, "JSON");
            }
            char buffer[1 << 16];
            const ssize_t size = ::read(from_, buffer, sizeof buffer);
            if (size <= 0) throw std::runtime_error("the browser is gone");
            arrived_.append(buffer, static_cast<std::size_t>(size));
        }
    }
    std::filesystem::path scratch_;
    pid_t pid_ = -1;
    int to_ = -1, from_ = -1, id_ = 0;
    std::string session_, arrived_;
};

}  // namespace tangi
