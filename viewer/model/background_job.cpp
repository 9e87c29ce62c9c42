#include "viewer/model/background_job.h"

#include <chrono>

#include "surface/file/error_message.h"
#include "surface/file/stale_temporaries.h"

namespace tangi {

Job::Job(std::string title, std::function<void(const Progress&)> work, std::function<void()> wake)
    : title_(std::move(title)), wake_(std::move(wake)) {
    thread_ = std::thread([this, work = std::move(work)] { run(work); });
}

Job::~Job() {
    stop_ = true;
    thread_.join();
}

Job::State Job::state() const {
    const std::lock_guard lock(mutex_);
    State state = state_;
    state.stopping = stop_ && !state.over;
    return state;
}

void Job::run(const std::function<void(const Progress&)>& work) {
    using Clock = std::chrono::steady_clock;
    Clock::time_point shown{};
    State end;
    try {
        work([&](std::string_view stage, double fraction) {
            bool tell = false;
            {
                const std::lock_guard lock(mutex_);
                tell = stage != state_.stage || Clock::now() - shown > std::chrono::milliseconds(200);
                if (tell) shown = Clock::now();
                state_.stage = stage;
                state_.fraction = fraction;
            }
            if (tell) wake_();  // a frame for each call would be slower than the work
            return !stop_;
        });
    } catch (const Cancelled&) {
        end.cancelled = true;
    } catch (const std::exception& error) {
        end.error = message_of(error);
    }
    {
        const std::lock_guard lock(mutex_);
        state_.over = true;
        state_.cancelled = end.cancelled;
        state_.error = end.error;
    }
    wake_();
}

}  // namespace tangi
