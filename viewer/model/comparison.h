// comparison.h: photographs held against the painting, read and measured on a thread of their own.
//
// The window says which photograph it wants, and draws what is there; the next one is made ready meanwhile.
// What was looked at last is kept, within a bound of memory. No OpenGL.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "viewer/model/photo_source.h"

namespace tangi {

class Comparison {
public:
    static constexpr std::size_t kMostBytes = std::size_t(1) << 30;  // of pictures kept beside the shown one

    // `open` is called on the comparison's thread; `wake`, from there, when there is news.
    using Open = std::function<std::unique_ptr<PhotoBook>(const Progress&)>;
    Comparison(std::string folder, Open open, std::function<void()> wake);
    ~Comparison();  // waits for the photograph that is being measured

    const std::string& folder() const { return folder_; }

    void want(int index);  // this one from now on; what else was wanted is forgotten
    void measure(const std::optional<Region>& region);  // of this and every photograph that is wanted later
    void write_report(const std::filesystem::path& folder);
    void stop_report() { stop_report_ = true; }

    struct News {
        const PhotoBook* book = nullptr;  // null until it is open; lives as long as this
        std::shared_ptr<const HeldPhoto> held;
        int wanted = 0;
        bool busy = false;     // with what is wanted
        bool working = false;  // at all
        std::string stage;     // of what takes long
        double fraction = 0;
        std::map<int, std::string> broken;  // photographs that cannot be read, and why
        struct Part {
            int index;
            Region region;
            Likeness likeness;
        };
        std::optional<Part> part;  // the region that was measured last
        bool reporting = false;
        std::vector<std::string> messages;  // since the last call
        bool failed = false;                // the book cannot be opened: the messages say why
    };
    News fetch();

private:
    void work();
    void next(std::unique_lock<std::mutex>& lock);
    void hold(int index, std::unique_lock<std::mutex>& lock);
    void report_to(const std::filesystem::path& folder, std::unique_lock<std::mutex>& lock);
    void keep(std::shared_ptr<const HeldPhoto> held);
    std::shared_ptr<const HeldPhoto> kept(int index) const;
    std::optional<int> missing() const;
    bool measured() const;
    Progress progress(const std::function<bool()>& stopped);

    std::string folder_;
    Open open_;
    std::function<void()> wake_;
    std::unique_ptr<PhotoBook> book_;  // set once, under the mutex

    std::mutex mutex_;
    std::condition_variable something_;
    News news_;
    std::deque<std::shared_ptr<const HeldPhoto>> kept_;  // the one used last is in front
    std::optional<Region> region_;                       // that is to be measured
    std::optional<std::filesystem::path> report_;        // to be written
    std::atomic<bool> stop_ = false, stop_report_ = false;
    std::thread thread_;
};

}  // namespace tangi
