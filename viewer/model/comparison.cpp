#include "viewer/model/comparison.h"

#include <algorithm>

#include "surface/base/error.h"
#include "surface/file/error_message.h"

namespace tangi {

Comparison::Comparison(std::string folder, Open open, std::function<void()> wake)
    : folder_(std::move(folder)), open_(std::move(open)), wake_(std::move(wake)) {
    news_.busy = news_.working = true;
    thread_ = std::thread([this] { work(); });
}

Comparison::~Comparison() {
    stop_ = true;
    stop_report_ = true;
    {
        const std::lock_guard lock(mutex_);  // not between its look at stop_ and its waiting
    }
    something_.notify_all();
    thread_.join();
}

Progress Comparison::progress(const std::function<bool()>& stopped) {
    return [this, stopped](std::string_view stage, double fraction) {
        {
            const std::lock_guard lock(mutex_);
            news_.stage = stage;
            news_.fraction = fraction;
        }
        wake_();
        return !stopped();
    };
}

void Comparison::want(int index) {
    const std::lock_guard lock(mutex_);
    news_.wanted = index;
    if (auto held = kept(index)) {
        keep(held);
        news_.held = held;
    }
    something_.notify_all();
}

void Comparison::measure(const std::optional<Region>& region) {
    const std::lock_guard lock(mutex_);
    region_ = region;
    if (!region) news_.part.reset();
    something_.notify_all();
}

void Comparison::write_report(const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex_);
    stop_report_ = false;
    report_ = folder;
    news_.reporting = true;
    something_.notify_all();
}

Comparison::News Comparison::fetch() {
    const std::lock_guard lock(mutex_);
    News news = news_;
    news_.messages.clear();
    return news;
}

std::shared_ptr<const HeldPhoto> Comparison::kept(int index) const {
    for (const auto& held : kept_)
        if (held->index == index) return held;
    return nullptr;
}

// To the front; what was used longest ago goes where there is too much.
void Comparison::keep(std::shared_ptr<const HeldPhoto> held) {
    std::erase(kept_, held);
    kept_.push_front(std::move(held));
    std::size_t bytes = 0, count = 0;
    for (const auto& one : kept_) {
        bytes += one->bytes;
        if (count > 0 && bytes > kMostBytes) break;
        ++count;
    }
    kept_.resize(count);
}

// The photograph to be made ready: the one that is wanted, else the one after it.
std::optional<int> Comparison::missing() const {
    if (!book_ || book_->entries().empty()) return {};
    const int count = static_cast<int>(book_->entries().size());
    for (const int index : {news_.wanted, (news_.wanted + 1) % count}) {
        if (news_.broken.contains(index) || kept(index)) continue;
        // Not where keeping both is too much: it would be made again and again.
        if (index != news_.wanted && !kept_.empty() && 2 * kept_.front()->bytes > kMostBytes) continue;
        return index;
    }
    return {};
}

bool Comparison::measured() const {
    return !region_ || !news_.held ||
           (news_.part && news_.part->index == news_.held->index && news_.part->region == *region_);
}

void Comparison::work() {
    try {
        auto book = open_(progress([this] { return stop_.load(); }));
        const std::lock_guard lock(mutex_);
        book_ = std::move(book);
        news_.book = book_.get();
        for (const std::string& warning : book_->warnings()) news_.messages.push_back(warning);
    } catch (const Cancelled&) {
        return;
    } catch (const std::exception& error) {
        const std::lock_guard lock(mutex_);
        news_.messages.emplace_back(message_of(error));
        news_.failed = true;
        news_.busy = news_.working = false;
        wake_();
        return;
    }
    wake_();
    std::unique_lock lock(mutex_);
    while (!stop_) next(lock);
}

// Does what is most urgent, or waits; `lock` is held when it is called and when it returns.
void Comparison::next(std::unique_lock<std::mutex>& lock) {
    const std::optional<int> index = missing();
    news_.busy = index == news_.wanted;
    if (news_.busy) {
        hold(*index, lock);
    } else if (!measured()) {
        const Region region = *region_;
        const auto held = news_.held;
        lock.unlock();
        const Likeness likeness = held->measure(region);
        lock.lock();
        if (region_) news_.part = {held->index, region, likeness};
        wake_();
    } else if (report_) {
        const std::filesystem::path folder = *report_;
        report_.reset();
        report_to(folder, lock);
    } else if (index) {
        hold(*index, lock);
    } else {
        news_.working = false;
        wake_();
        something_.wait(lock);
        news_.working = true;
    }
}

void Comparison::hold(int index, std::unique_lock<std::mutex>& lock) {
    lock.unlock();
    std::shared_ptr<const HeldPhoto> held;
    std::string broken;
    try {
        held = std::make_shared<HeldPhoto>(book_->hold(index, progress([this] { return stop_.load(); })));
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
        broken = message_of(error);
    }
    lock.lock();
    const auto shown = kept(news_.wanted);
    if (held) keep(held);
    if (held && shown) keep(shown);  // what was made ready ahead comes after it
    if (held && index == news_.wanted) news_.held = std::move(held);
    if (!broken.empty()) {
        news_.broken[index] = broken;
        news_.messages.push_back("rejected: " + broken);
    }
    wake_();
}

void Comparison::report_to(const std::filesystem::path& folder, std::unique_lock<std::mutex>& lock) {
    std::vector<int> rejected;
    for (const auto& [index, why] : news_.broken) rejected.push_back(index);
    lock.unlock();
    std::string message;
    try {
        book_->write_report(folder, rejected, progress([this] { return stop_ || stop_report_; }));
        message = "wrote " + (folder / "compare.html").string();
    } catch (const std::exception& error) {
        message = message_of(error);
    }
    lock.lock();
    news_.reporting = false;
    news_.messages.push_back(message);
    wake_();
}

}  // namespace tangi
