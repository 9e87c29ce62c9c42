#include "viewer/video/video_recorder.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>

#include "viewer/video/video_writer.h"

namespace tangi {

struct Recorder::Impl {
    static constexpr std::size_t kWaiting = 2;

    mutable std::mutex mutex;
    std::condition_variable news;
    std::deque<Image<Rgb>> waiting;
    int given = 0, pictures = 0;
    std::function<void()> wake;
    std::optional<Job> job;  // last: its thread uses the others

    // Waits for one; looks now and then whether it should stop.
    Image<Rgb> take(const std::function<void()>& look) {
        std::unique_lock lock(mutex);
        while (!news.wait_for(lock, std::chrono::milliseconds(100), [this] { return !waiting.empty(); })) {
            lock.unlock();
            look();
            lock.lock();
        }
        Image<Rgb> picture = std::move(waiting.front());
        waiting.pop_front();
        return picture;
    }

    void write(const std::filesystem::path& out, double frames_per_s, const Progress& progress) {
        const std::unique_ptr<Film> film = make_film(out, frames_per_s);
        for (int i = 0; i < pictures; ++i) {
            const auto look = [&] { report(progress, "film", static_cast<double>(i) / pictures); };
            look();
            film->add(take(look));
            wake();
        }
        film->finish();
    }
};

Recorder::Recorder(const std::filesystem::path& out, double frames_per_s, int pictures,
                   std::function<void()> wake)
    : impl_(std::make_unique<Impl>()) {
    impl_->pictures = pictures;
    impl_->wake = wake;
    impl_->job.emplace(
        "film",
        [impl = impl_.get(), out, frames_per_s](const Progress& progress) {
            impl->write(out, frames_per_s, progress);
        },
        std::move(wake));
}

Recorder::~Recorder() = default;

int Recorder::next() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->waiting.size() < Impl::kWaiting && impl_->given < impl_->pictures ? impl_->given : -1;
}

void Recorder::add(Image<Rgb> encoded_srgb) {
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->waiting.push_back(std::move(encoded_srgb));
        ++impl_->given;
    }
    impl_->news.notify_one();
}

void Recorder::stop() { impl_->job->stop(); }
Job::State Recorder::state() const { return impl_->job->state(); }

}  // namespace tangi
