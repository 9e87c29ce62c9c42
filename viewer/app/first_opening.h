// first_opening.h: the painting that the window is opened with, read beside it.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <mutex>
#include <string>

#include "surface/base/progress.h"
#include "viewer/app/document_controller.h"

namespace tangi {

class FirstOpening {
public:
    // `work` runs on a thread of its own; `told` hears of its progress, too, and may ask for a stop.
    FirstOpening(std::function<OpenedPainting(const Progress&)> work, Progress told);
    ~FirstOpening();  // asks it to stop, and waits
    FirstOpening(const FirstOpening&) = delete;
    FirstOpening& operator=(const FirstOpening&) = delete;

    bool over() const;
    // The painting, once; waits for it. What was thrown is thrown here.
    OpenedPainting take() { return opened_.get(); }

    struct State {
        std::string stage;
        double fraction = 0;  // [1]
    };
    State state() const;

private:
    mutable std::mutex mutex_;
    State state_;
    std::atomic<bool> stop_ = false;
    std::future<OpenedPainting> opened_;
};

}  // namespace tangi
