// comparison_test.cpp: photographs are read beside the window, what is wanted first; broken ones are
// named. And jobs beside it.
#include "viewer/model/comparison.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>

#include "surface/base/error.h"
#include "viewer/model/background_job.h"

namespace tangi {
namespace {

// Photographs whose numbers tell which one it is; the third cannot be read.
class Book : public PhotoBook {
public:
    explicit Book(std::atomic<int>& reads, std::size_t bytes = 1000) : reads_(reads), bytes_(bytes) {
        for (int i = 0; i < 5; ++i)
            entries_.push_back({fmt::format("{}.png", i), distant_light({0, 0, 1}), i > 0});
    }
    const std::vector<Entry>& entries() const override { return entries_; }
    const std::vector<std::string>& warnings() const override { return warnings_; }
    const ColourScale& difference_scale() const override { return scale_; }
    const ColourScale& delta_e_scale() const override { return scale_; }
    HeldPhoto hold(int index, const Progress& progress) const override {
        ++reads_;
        report(progress, "compare", 0);
        if (index == 2) fail("2.png: is damaged");
        HeldPhoto held;
        held.index = index;
        held.whole.psnr_db = 30 + index;
        held.bytes = bytes_;
        held.measure = [index](const Region& region) {
            return Likeness{static_cast<std::size_t>(region.width()), 10.0 + index, 0, 0, 0};
        };
        return held;
    }
    void write_report(const std::filesystem::path&, const std::vector<int>& rejected,
                      const Progress& progress) const override {
        for (int i = 0; i < 1000; ++i) {
            report(progress, "report", i / 1000.0);
            if (!rejected.empty()) fail("left out {}", rejected.front());
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    }

private:
    std::atomic<int>& reads_;
    std::size_t bytes_;
    std::vector<Entry> entries_;
    std::vector<std::string> warnings_{"lights.lp: a warning"};
    ColourScale scale_;
};

class ComparisonTest : public testing::Test {
protected:
    void open(std::size_t bytes = 1000) {
        comparison_ = std::make_unique<Comparison>(
            "photos", [this, bytes](const Progress&) { return std::make_unique<Book>(reads_, bytes); },
            [] {});
    }
    // What there is once this is so; ten seconds at most.
    Comparison::News once(const std::function<bool(const Comparison::News&)>& so) {
        for (int i = 0; i < 2000; ++i) {
            Comparison::News news = comparison_->fetch();
            messages_.insert(messages_.end(), news.messages.begin(), news.messages.end());
            if (so(news)) return news;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        ADD_FAILURE() << "it did not happen";
        return comparison_->fetch();
    }
    Comparison::News shown(int index) {
        return once([&](const auto& news) { return news.held && news.held->index == index; });
    }
    Comparison::News idle() {
        return once([](const auto& news) { return !news.working; });
    }

    std::atomic<int> reads_ = 0;
    std::vector<std::string> messages_;
    std::unique_ptr<Comparison> comparison_;
};

TEST_F(ComparisonTest, ShowsWhatIsWantedAndMakesTheNextReady) {
    open();
    EXPECT_EQ(shown(0).held->whole.psnr_db, 30);
    idle();
    EXPECT_EQ(reads_, 2) << "the first, and the one after it";
    comparison_->want(1);
    EXPECT_EQ(comparison_->fetch().held->index, 1) << "at once";
    comparison_->want(4);
    shown(4);
    idle();
    const int before = reads_;
    comparison_->want(0);
    shown(0);
    idle();
    EXPECT_EQ(reads_, before) << "both are still there";
    EXPECT_THAT(messages_, testing::Contains("lights.lp: a warning"));
}

TEST_F(ComparisonTest, ABrokenPhotographIsNamedAndLeftOut) {
    open();
    comparison_->want(2);
    const auto news = once([](const auto& n) { return n.broken.contains(2); });
    EXPECT_EQ(news.broken.at(2), "2.png: is damaged");
    idle();
    EXPECT_THAT(messages_, testing::Contains("rejected: 2.png: is damaged"));
    comparison_->write_report("out");
    once([](const auto& n) { return !n.reporting; });
    EXPECT_THAT(messages_, testing::Contains("left out 2")) << "the report knows";
}

TEST_F(ComparisonTest, MeasuresTheRegionOfEachPhotograph) {
    open();
    shown(0);
    comparison_->measure(Region{10, 10, 17, 20});
    auto news = once([](const auto& n) { return n.part.has_value(); });
    EXPECT_EQ(news.part->likeness.pixels, 7u);
    EXPECT_EQ(news.part->likeness.psnr_db, 10);
    comparison_->want(1);
    news = once([](const auto& n) { return n.part && n.part->index == 1; });
    EXPECT_EQ(news.part->likeness.psnr_db, 11) << "the same region of the next one";
    comparison_->measure({});
    EXPECT_FALSE(idle().part);
}

TEST_F(ComparisonTest, KeepsNoMoreThanItsBound) {
    open(Comparison::kMostBytes);
    shown(0);
    idle();
    EXPECT_EQ(reads_, 1) << "the next one would not fit beside it";
    comparison_->want(1);
    shown(1);
    comparison_->want(0);
    shown(0);
    EXPECT_EQ(reads_, 3);
}

TEST_F(ComparisonTest, AReportStops) {
    open();
    shown(0);
    comparison_->write_report("out");
    once([](const auto& n) { return n.stage == "report"; });
    comparison_->stop_report();
    once([](const auto& n) { return !n.reporting; });
    EXPECT_THAT(messages_, testing::Contains("stopped at your request"));
}

TEST_F(ComparisonTest, AFolderThatCannotBeOpenedSaysWhy) {
    comparison_ = std::make_unique<Comparison>(
        "photos", [](const Progress&) -> std::unique_ptr<PhotoBook> { fail("photos: no lights file"); },
        [] {});
    once([](const auto& n) { return n.failed; });
    EXPECT_THAT(messages_, testing::ElementsAre("photos: no lights file"));
}

TEST(Job, StopsWhenAsked) {
    std::atomic<bool> began = false;
    Job job(
        "a long one",
        [&](const Progress& progress) {
            for (;;) {
                report(progress, "stage", 0.5);
                began = true;
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        },
        [] {});
    while (!began) std::this_thread::yield();
    EXPECT_EQ(job.state().stage, "stage");
    job.stop();
    while (!job.state().over) std::this_thread::yield();
    EXPECT_TRUE(job.state().cancelled);
    EXPECT_EQ(job.state().error, "");
}

TEST(Job, TellsWhyItFailed) {
    Job job(
        "a bad one", [](const Progress&) { fail("the disk is full"); }, [] {});
    while (!job.state().over) std::this_thread::yield();
    EXPECT_EQ(job.state().error, "the disk is full");
    EXPECT_FALSE(job.state().cancelled);
}

}  // namespace
}  // namespace tangi
