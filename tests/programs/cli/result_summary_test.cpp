// result_summary_test.cpp: what is told after a result, and to whom.
#include "cli/result_summary.h"

#include <gmock/gmock.h>
#include <stdlib.h>

#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

json fitted() {
    return {{"painting", "a.exr"},
            {"width", 640},
            {"height", 480},
            {"mm_per_pixel", 0.390625},
            {"scale_known", true},
            {"photographs", {{"fitted", 42}, {"held_out", 6}, {"rejected", json::array()}}},
            {"median_confidence", 0.914},
            {"seconds", 51.3},
            {"warnings", json::array()},
            {"poor", json::array()}};
}

TEST(ResultWords, OfAFitSayWhatItMadeHowGoodItIsAndWhatIsNext) {
    EXPECT_THAT(
        fit_in_words(fitted()),
        ElementsAre("a.exr: 640 × 480 pixels of 0.391 mm, from 42 photographs (6 more held out), in 51 s",
                    "median confidence 0.91: good", "next: tangipaint compare a.exr PHOTOS --out report"));
    json poor = fitted();
    poor["scale_known"] = false;
    poor["seconds"] = 2.25;
    poor["photographs"] = {{"fitted", 1}, {"held_out", 0}, {"rejected", {"b.jpg", "c.jpg"}}};
    poor["warnings"] = {"one"};
    poor["poor"] = {"dark", "blurred"};
    EXPECT_THAT(
        fit_in_words(poor),
        ElementsAre("a.exr: 640 × 480 pixels, scale unknown, from 1 photograph (2 rejected), in 2.2 s",
                    "median confidence 0.91: poor, for the 2 reasons above, with 1 warning "
                    "(\"warnings\" in the result)",
                    "next: tangipaint compare a.exr PHOTOS --out report"));
}

TEST(ResultWords, OfAComparisonAreThoseOfTheGroupsThatHavePhotographs) {
    const json none = {{"count", 0}, {"psnr_db", nullptr}, {"ssim", nullptr}, {"delta_e_2000", nullptr}};
    const json held = {{"count", 6}, {"psnr_db", 34.14}, {"ssim", 0.9512}, {"delta_e_2000", 1.88}};
    json result = {{"mean", {{"held_out", held}, {"fitted", none}}},
                   {"page", "report/compare.html"},
                   {"warnings", json::array()},
                   {"poor", json::array()}};
    const std::string numbers = ": 6 photographs, 34.1 dB PSNR, SSIM 0.951, ΔE2000 1.9 on average";
    EXPECT_THAT(compare_in_words(result), ElementsAre("held out" + numbers, "look at report/compare.html"));
    result["mean"] = {{"held_out", none}, {"fitted", held}};
    result["poor"] = {"another painting"};
    EXPECT_THAT(compare_in_words(result),
                ElementsAre("fitted" + numbers, "the result is poor, for the reason above",
                            "look at report/compare.html"));
}

// A terminal that somebody looks at, and what was written to it.
class Terminal {
public:
    Terminal() {
        if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0)
            throw std::runtime_error("no terminal");
        name_ = ::ptsname(master_);
        // Held open, so that what is read does not end before a program has opened it.
        slave_ = ::open(name_.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
        reader_ = std::thread([this] {
            char buffer[4096];
            for (ssize_t count; (count = ::read(master_, buffer, sizeof buffer)) > 0;)
                text_.append(buffer, static_cast<std::size_t>(count));
        });
    }
    ~Terminal() { hang_up(); }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    const char* name() const { return name_.c_str(); }
    const std::string& hang_up() {
        if (reader_.joinable()) {
            ::close(slave_);
            reader_.join();
            ::close(master_);
        }
        return text_;
    }

private:
    const int master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    int slave_ = -1;
    std::string name_, text_;
    std::thread reader_;
};

TEST(ResultWords, AreToldOnStderrWhereStandardOutputIsATerminal) {
    const TinyStack stack;
    const auto at_terminal = [](const std::vector<std::string>& command) {
        Terminal terminal;
        Conditions conditions;
        conditions.stdout_to = terminal.name();
        Finished run = tangipaint(command, conditions);
        run.out = terminal.hang_up();
        return run;
    };
    const std::string painting = stack.out("a.exr"), report = stack.out("report");
    const Finished fit = at_terminal({"fit", stack.path(), "--out", painting, "--hold-out", "3:6"});
    ASSERT_TRUE(ended(fit, 0, {painting + ": 32 × 32 pixels", "from 10 photographs (2 more held out)"}));
    EXPECT_THAT(fit.err, HasSubstr("next: tangipaint compare " + painting));
    EXPECT_THAT(fit.out, Not(HasSubstr("next:")));  // the JSON is as without a terminal
    EXPECT_EQ(fit.json()["painting"], painting);
    const std::vector<std::string> compare = {"compare", painting, stack.path(), "--out", report};
    EXPECT_THAT(at_terminal(compare).err, AllOf(HasSubstr("held out: 2 photographs, "),
                                                HasSubstr("look at " + report + "/compare.html")));
    EXPECT_THAT(tangipaint(compare).err, Not(HasSubstr("look at")));
}

}  // namespace
}  // namespace tangi
