// web_support.h: the web application that script/web has built, run in Node and served to a browser.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "surface/base/json_reading.h"
#include "tests/support/test_support.h"

namespace tangi {

inline std::filesystem::path web_app() { return std::filesystem::path(TP_SOURCE_DIR) / "build/web/app"; }

// Without it these tests say nothing: script/web builds it, and .ci/run has it built (TP_WEB=1).
#define TP_NEEDS_WEB_APP()                                                         \
    if (!std::filesystem::exists(web_app() / "engine.wasm") ||                     \
        !std::filesystem::exists(web_app() / "service_worker.js")) {               \
        ASSERT_EQ(std::getenv("TP_WEB"), nullptr) << web_app() << " is not built"; \
        GTEST_SKIP() << "no web application here: script/web builds it";           \
    }

inline std::string output_of(const std::string& command) {
    FILE* pipe = ::popen(command.c_str(), "r");
    std::string text;
    std::array<char, 4096> part{};
    for (std::size_t size = 0; pipe && (size = std::fread(part.data(), 1, part.size(), pipe)) > 0;)
        text.append(part.data(), size);
    if (!pipe || ::pclose(pipe) != 0) fail("{}: failed: {}", command, text);
    return text;
}

// A journal painted by the web engine (tests/web/replay.mjs).
inline nlohmann::json replayed_in_node(const std::filesystem::path& choice,
                                       const std::filesystem::path& journal, int lines_at_once,
                                       double memory_bytes = 0) {
    return read_json(output_of(fmt::format("node '{}/tests/web/replay.mjs' '{}' '{}' '{}' {} {:.0f}",
                                           TP_SOURCE_DIR, web_app().string(), choice.string(),
                                           journal.string(), lines_at_once, memory_bytes)),
                     "replay.mjs");
}

// web/serve.mjs on a port of its own, until it goes.
class WebServer {
public:
    explicit WebServer(const std::filesystem::path& folder = web_app()) {
        int out[2];
        if (::pipe(out) != 0) throw std::runtime_error("pipe");
        pid_ = ::fork();
        if (pid_ == 0) {
            ::dup2(out[1], 1);
            ::close(out[0]);
            const std::string script = std::string(TP_SOURCE_DIR) + "/web/serve.mjs", app = folder.string();
            ::execlp("node", "node", script.c_str(), app.c_str(), "0", static_cast<char*>(nullptr));
            ::_exit(127);
        }
        ::close(out[1]);
        FILE* words = ::fdopen(out[0], "r");
        std::array<char, 256> line{};
        if (std::fgets(line.data(), line.size(), words)) url_ = line.data();
        std::fclose(words);
        while (!url_.empty() && url_.back() == '\n') url_.pop_back();
    }
    ~WebServer() { stop(); }
    WebServer(const WebServer&) = delete;
    WebServer& operator=(const WebServer&) = delete;

    void stop() {
        if (pid_ <= 0) return;
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
        pid_ = -1;
    }
    const std::string& url() const { return url_; }

private:
    pid_t pid_ = -1;
    std::string url_;
};

}  // namespace tangi
