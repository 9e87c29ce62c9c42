// background_job.h: one long piece of work beside the window, which goes on being looked at: opening,
// fitting.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "surface/base/progress.h"

namespace tangi {

class Job {
public:
    // `work` runs on a thread of its own; `wake`, from there, says that there is news.
    Job(std::string title, std::function<void(const Progress&)> work, std::function<void()> wake);
    ~Job();  // asks it to stop, and waits
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    const std::string& title() const { return title_; }
    void stop() { stop_ = true; }

    struct State {
        std::string stage;
        double fraction = 0;
        bool over = false, stopping = false, cancelled = false;
        std::string error;  // why it failed; empty where it did not
    };
    State state() const;

private:
    void run(const std::function<void(const Progress&)>& work);

    std::string title_;
    std::function<void()> wake_;
    mutable std::mutex mutex_;
    State state_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

}  // namespace tangi
