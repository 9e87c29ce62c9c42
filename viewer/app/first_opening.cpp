#include "viewer/app/first_opening.h"

#include <chrono>

namespace tangi {

FirstOpening::FirstOpening(std::function<OpenedPainting(const Progress&)> work, Progress told) {
    opened_ = std::async(std::launch::async, [this, work = std::move(work), told = std::move(told)] {
        return work([&](std::string_view stage, double fraction) {
            {
                const std::lock_guard lock(mutex_);
                state_ = {std::string(stage), fraction};
            }
            return !stop_ && (!told || told(stage, fraction));
        });
    });
}

FirstOpening::~FirstOpening() {
    stop_ = true;
    if (opened_.valid()) opened_.wait();
}

bool FirstOpening::over() const {
    return opened_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

FirstOpening::State FirstOpening::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

}  // namespace tangi
