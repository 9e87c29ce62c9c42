// transfer_test.cpp: what one step does to paint: nothing is lost, nothing is negative, nothing comes
// from nowhere.
#include "paint/exchange/transfer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "paint/canvas/paint_layer.h"
#include "surface/base/parallel.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A box of random paint, loads, relief and underside.
struct RandomBox {
    static constexpr int kWidth = 37, kHeight = 23, kIngredients = 3;
    std::vector<float> underside, cover, relief, open, total, load_total;
    std::vector<std::vector<float>> paint, load;
    StepBox box;

    // With an upper film there are twice as many planes of paint; sum() is of boxes without.
    explicit RandomBox(std::uint64_t seed, int width = kWidth, int height = kHeight, bool upper = false) {
        Random random(seed);
        const auto pixels = static_cast<std::size_t>(width * height);
        const auto plane = [&](double low, double high) {
            std::vector<float> values(pixels);
            for (float& v : values) v = random.real(low, high);
            return values;
        };
        underside = plane(0, 0.3);
        cover.assign(pixels, 1);
        relief = plane(-0.1, 0.1);
        open = plane(0.5, 1.5);
        total.assign(pixels, 0);
        load_total.assign(pixels, 0);
        const auto add_paint = [&](double most_mm) {
            paint.push_back(plane(0, most_mm));
            for (std::size_t p = 0; p < pixels; ++p) {
                if (random.uniform() < 0.3) paint.back()[p] = 0;
                total[p] += paint.back()[p];
            }
        };
        for (int i = 0; i < kIngredients; ++i) {
            add_paint(0.2);
            if (upper) add_paint(0.9 * kUpper_mm / kIngredients);
            load.push_back(plane(0, 1));
            for (std::size_t p = 0; p < pixels; ++p) load_total[p] += load.back()[p];
        }
        box.laid_above = upper;
        box.width = width;
        box.height = height;
        box.underside_mm = underside.data();
        box.cover = cover.data();
        box.underside_stride = box.canvas_stride = box.load_stride = static_cast<std::size_t>(width);
        box.bristles.assign(static_cast<std::size_t>(height), {0, width});
        box.relief_mm = relief.data();
        box.open = open.data();
        box.total_mm = total.data();
        box.load_total_mm = load_total.data();
        for (auto& p : paint) box.paint.push_back(p.data());
        for (auto& l : load) box.load.push_back(l.data());
    }

    std::vector<double> sums() const {
        std::vector<double> sums;
        for (int i = 0; i < kIngredients; ++i) sums.push_back(sum(i));
        return sums;
    }
    void expect_sums(const std::vector<double>& before) const {
        for (int i = 0; i < kIngredients; ++i)
            EXPECT_NEAR(sum(i) / before[static_cast<std::size_t>(i)], 1, 1e-5) << i;
    }
    double sum(int ingredient) const {
        double sum = 0;
        for (const float v : paint[static_cast<std::size_t>(ingredient)]) sum += v;
        for (const float v : load[static_cast<std::size_t>(ingredient)]) sum += v;
        return sum;
    }
    float smallest() const {
        float smallest = 0;
        for (const auto* planes : {&paint, &load})
            for (const auto& plane : *planes)
                smallest = std::min(smallest, *std::min_element(plane.begin(), plane.end()));
        return smallest;
    }
};

TransferRates some_rates() {
    TransferRates r;
    r.deposit = 0.1f;
    r.pickup = 0.2f;
    r.push = 0.9f;
    r.film_mm = 0.01f;
    r.reach_mm = 0.05f;
    r.load_reach = 0.2f;
    r.spread = 0.6f;
    r.yield_mm = 0.05f;
    r.flow = 0.2f;
    return r;
}

TEST(Transfer, ConservesEachIngredientOverManySteps) {
    RandomBox b(1);
    StepScratch scratch;
    const std::vector<double> before = b.sums();
    for (int step = 0; step < 300; ++step) {
        exchange(b.box, some_rates(), scratch);
        const double turn = step * 0.37;
        push(b.box, some_rates(),
             {static_cast<float>(std::cos(turn)), static_cast<float>(std::sin(turn)), 0.02f, 18, 11},
             scratch);
    }
    b.expect_sums(before);
    EXPECT_GE(b.smallest(), -1e-9f);
}

TEST(Transfer, MovesPaintBothWaysAtOnce) {
    RandomBox b(2);
    // The brush holds only the first ingredient, the canvas only the second.
    for (int i = 0; i < RandomBox::kIngredients; ++i) {
        std::fill(b.paint[static_cast<std::size_t>(i)].begin(), b.paint[static_cast<std::size_t>(i)].end(),
                  i == 1 ? 0.1f : 0);
        std::fill(b.load[static_cast<std::size_t>(i)].begin(), b.load[static_cast<std::size_t>(i)].end(),
                  i == 0 ? 0.5f : 0);
    }
    std::fill(b.total.begin(), b.total.end(), 0.1f);
    std::fill(b.load_total.begin(), b.load_total.end(), 0.5f);
    StepScratch scratch;
    exchange(b.box, some_rates(), scratch);
    const std::size_t middle = 11 * RandomBox::kWidth + 18;
    EXPECT_GT(b.paint[0][middle], 0);
    EXPECT_GT(b.load[1][middle], 0);
    EXPECT_FLOAT_EQ(b.paint[2][middle], 0);
    EXPECT_FLOAT_EQ(b.paint[0][middle] + b.load[0][middle], 0.5f);
    EXPECT_FLOAT_EQ(b.paint[1][middle] + b.load[1][middle], 0.1f);
}

// The rate at its most, lanes at twice the mean, and paint that bridges far more than bristles reach.
TEST(Transfer, GivesNoMoreThanThereIs) {
    RandomBox b(5);
    for (float& mm : b.underside) mm += 0.3f;
    for (auto& plane : b.paint) std::fill(plane.begin(), plane.end(), 0.0f);
    std::fill(b.total.begin(), b.total.end(), 0.0f);
    const std::vector<double> before = b.sums();
    const float twice = 2;
    b.box.lanes.factor = &twice;
    TransferRates rates = some_rates();
    rates.deposit = 0.5f;
    rates.tip_mm = 0.5f;
    rates.pickup = 0;
    rates.reach_mm = 0.001f;
    rates.load_reach = 2;
    StepScratch scratch;
    for (int step = 0; step < 5; ++step) exchange(b.box, rates, scratch);
    EXPECT_GE(b.smallest(), -1e-6f);
    b.expect_sums(before);
}

TEST(Transfer, LeavesAFilm) {
    RandomBox b(3);
    StepScratch scratch;
    TransferRates rates = some_rates();
    rates.deposit = 0;
    rates.reach_mm = 10;
    for (auto& load : b.load) std::fill(load.begin(), load.end(), 0.0f);
    std::fill(b.load_total.begin(), b.load_total.end(), 0.0f);
    const std::vector<float> before = b.total;
    for (int step = 0; step < 400; ++step) exchange(b.box, rates, scratch);
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (before[i] > 0.02f) {
            EXPECT_NEAR(b.total[i], 0.01f, 0.002f) << i;
        }
        EXPECT_GE(b.total[i], std::min(before[i], 0.0099f)) << i;
    }
}

TEST(Transfer, PushesPaintAheadAndKeepsItOnTheCanvas) {
    RandomBox b(4);
    std::fill(b.relief.begin(), b.relief.end(), 0.0f);
    for (auto& plane : b.paint) std::fill(plane.begin(), plane.end(), 0.0f);
    std::fill(b.total.begin(), b.total.end(), 0.0f);
    const std::size_t middle = 11 * RandomBox::kWidth + 18;
    b.paint[0][middle] = b.total[middle] = 0.4f;
    std::fill(b.underside.begin(), b.underside.end(), 0.1f);
    b.open[middle + 1] = 0;  // the canvas ends there
    TransferRates rates = some_rates();
    rates.yield_mm = 10;
    StepScratch scratch;
    push(b.box, rates, {1, 0}, scratch);
    EXPECT_EQ(b.paint[0][middle + 1], 0);
    EXPECT_EQ(b.paint[0][middle], 0.4f);
    push(b.box, rates, {0, 1}, scratch);
    EXPECT_NEAR(b.paint[0][middle + RandomBox::kWidth], 0.9f * 0.3f, 1e-5);
    EXPECT_NEAR(b.paint[0][middle], 0.4f - 0.9f * 0.3f, 1e-5);
}

// Large boxes are moved in bands of rows, small ones row by row; narrow rows in whole vectors all the same.
TEST(Transfer, DoesNotDependOnTheSizeOfTheBox) {
    constexpr int width = 180, height = 140;
    constexpr RowSpan bristles{62, 97}, rows{30, 101};
    const auto painted_in = [&](int x0, int y0, int x1, int y1) {
        Random random(6);
        std::array<std::vector<float>, 5> planes;
        for (auto& plane : planes) {
            plane.resize(width * height);
            for (float& v : plane) v = random.real(0, 0.2);
        }
        auto& [underside, relief, first, second, total] = planes;
        for (std::size_t i = 0; i < total.size(); ++i) total[i] = first[i] + second[i];
        const std::vector<float> open(total.size(), 1.0f);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (x < bristles.begin || x >= bristles.end || y < rows.begin || y >= rows.end)
                    underside[static_cast<std::size_t>(y * width + x)] = kOutside;
        const std::size_t corner = static_cast<std::size_t>(y0 * width + x0);
        StepBox box;
        box.width = x1 - x0;
        box.height = y1 - y0;
        box.underside_mm = underside.data() + corner;
        box.underside_stride = box.canvas_stride = width;
        for (int y = y0; y < y1; ++y)
            box.bristles.push_back(y < rows.begin || y >= rows.end
                                       ? RowSpan{}
                                       : RowSpan{bristles.begin - x0, bristles.end - x0});
        box.relief_mm = relief.data() + corner;
        box.open = open.data() + corner;
        box.total_mm = total.data() + corner;
        box.paint = {first.data() + corner, second.data() + corner};
        StepScratch scratch;
        for (int step = 0; step < 8; ++step)
            push(box, some_rates(),
                 {std::cos(0.8f * static_cast<float>(step)), std::sin(0.8f * static_cast<float>(step)),
                  0.005f, static_cast<float>(80 - x0), static_cast<float>(70 - y0)},
                 scratch);
        return std::array{first, second, total};
    };
    const auto large = painted_in(0, 0, width, height), small = painted_in(50, 20, 110, 110);
    for (std::size_t plane = 0; plane < large.size(); ++plane) EXPECT_TRUE(large[plane] == small[plane]);
    for (std::size_t i = 0; i < large[2].size(); ++i) ASSERT_EQ(large[2][i], large[0][i] + large[1][i]) << i;
}

// Rows exchange just before they flow, in bands, small ones in one.
TEST(Transfer, BothAtOnceAreOneAfterTheOther) {
    for (const auto& [width, height, threads, upper] : {std::tuple{3, 9, 1, false},
                                                        {37, 23, 1, false},
                                                        {37, 5, 2, true},
                                                        {37, 23, 3, true},
                                                        {150, 260, 1, true},
                                                        {150, 260, 2, true},
                                                        {150, 260, 3, false},
                                                        {260, 150, 2, false},
                                                        {260, 150, 3, true}}) {
        RandomBox expected(9, width, height, upper), both(9, width, height, upper);
        for (RandomBox* b : {&expected, &both}) {
            for (int y = 0; y < height; ++y)
                b->box.bristles[static_cast<std::size_t>(y)] = {0, y % 50 == 3 ? 0 : width - y % 3};
            for (int y = 0; y < height; ++y)
                for (int x = b->box.bristles[static_cast<std::size_t>(y)].end; x < width; ++x) {
                    b->underside[static_cast<std::size_t>(y * width + x)] = kOutside;
                    b->cover[static_cast<std::size_t>(y * width + x)] = 0;
                }
        }
        StepScratch scratch, other;
        for (int step = 0; step < 6; ++step) {
            const auto s = static_cast<float>(step);
            const BrushMotion motion{std::cos(2 * s), std::sin(2 * s), 0.01f, 12, 9};
            set_thread_count(1);
            exchange(expected.box, some_rates(), scratch);
            push(expected.box, some_rates(), motion, scratch);
            set_thread_count(threads);
            exchange_and_push(both.box, some_rates(), motion, other);
        }
        set_thread_count(0);
        const std::string at = fmt::format("{} x {}, {} threads, {} film", width, height, threads, upper);
        EXPECT_TRUE(both.paint == expected.paint) << at;
        EXPECT_TRUE(both.load == expected.load) << at;
        EXPECT_TRUE(both.total == expected.total && both.load_total == expected.load_total) << at;
    }
}

TEST(Transfer, SteepStepsFlowDownAndStop) {
    RandomBox b(5);
    std::fill(b.relief.begin(), b.relief.end(), 0.0f);
    std::fill(b.underside.begin(), b.underside.end(), kOutside);
    std::fill(b.open.begin(), b.open.end(), 1.0f);
    for (auto& plane : b.paint) std::fill(plane.begin(), plane.end(), 0.0f);
    std::fill(b.total.begin(), b.total.end(), 0.0f);
    const std::size_t middle = 11 * RandomBox::kWidth + 18;
    b.paint[0][middle] = b.total[middle] = 1;
    StepScratch scratch;
    for (int step = 0; step < 400; ++step) push(b.box, some_rates(), {1, 0}, scratch);
    for (int y = 1; y + 1 < RandomBox::kHeight; ++y)
        for (int x = 1; x + 1 < RandomBox::kWidth; ++x) {
            const auto i = static_cast<std::size_t>(y * RandomBox::kWidth + x);
            EXPECT_LE(std::abs(b.total[i] - b.total[i + 1]), 0.0501f) << x << ' ' << y;
            EXPECT_LE(std::abs(b.total[i] - b.total[i + RandomBox::kWidth]), 0.0501f) << x << ' ' << y;
        }
    EXPECT_GT(b.total[middle], 0.05f);  // it holds its shape: no water
    EXPECT_NEAR(b.total[middle - 1], b.total[middle + 1], 1e-6);
}

TEST(Transfer, SurfaceTensionRoundsWhatIsSmallerThanBristles) {
    // Ripples of two, three and twelve pixels, and a chequerboard.
    const auto left_of = [](auto&& wave) {
        RandomBox b(7);
        std::fill(b.relief.begin(), b.relief.end(), 0.0f);
        std::fill(b.underside.begin(), b.underside.end(), kOutside);
        std::fill(b.open.begin(), b.open.end(), 1.0f);
        for (auto& plane : b.paint) std::fill(plane.begin(), plane.end(), 0.0f);
        for (int y = 0; y < RandomBox::kHeight; ++y)
            for (int x = 0; x < RandomBox::kWidth; ++x) {
                const auto i = static_cast<std::size_t>(y * RandomBox::kWidth + x);
                b.paint[0][i] = b.total[i] = 0.2f + 0.05f * static_cast<float>(wave(x, y));
            }
        const double volume = b.sum(0);
        TransferRates rates = some_rates();
        rates.yield_mm = 10;
        rates.bulge_mm = 0.004f;
        StepScratch scratch;
        for (int step = 0; step < 40; ++step) push(b.box, rates, {}, scratch);
        EXPECT_NEAR(b.sum(0) / volume, 1, 1e-5);
        float low = 1, high = 0;
        for (int y = 8; y < 15; ++y)
            for (int x = 8; x < 29; ++x) {
                low = std::min(low, b.total[static_cast<std::size_t>(y * RandomBox::kWidth + x)]);
                high = std::max(high, b.total[static_cast<std::size_t>(y * RandomBox::kWidth + x)]);
            }
        return high - low;
    };
    const double turn = 2 * std::numbers::pi;
    EXPECT_LT(left_of([&](int x, int y) { return (x + y) % 2 * 2 - 1; }), 0.0045f);
    EXPECT_LT(left_of([&](int x, int) { return x % 2 * 2 - 1; }), 0.0045f);
    EXPECT_LT(left_of([&](int x, int) { return std::cos(turn * x / 3); }), 0.05f);
    EXPECT_GT(left_of([&](int x, int) { return std::cos(turn * x / 12); }), 0.09f);
}

// What closes at once between thick paint stays open where the paint is a film.
TEST(Transfer, SurfaceTensionFillsPitsInThickPaintOnly) {
    const auto pit_in = [](float around) {
        RandomBox b(8);
        std::fill(b.relief.begin(), b.relief.end(), 0.0f);
        std::fill(b.underside.begin(), b.underside.end(), kOutside);
        std::fill(b.open.begin(), b.open.end(), 1.0f);
        for (auto& plane : b.paint) std::fill(plane.begin(), plane.end(), 0.0f);
        std::fill(b.paint[0].begin(), b.paint[0].end(), around);
        const std::size_t pit = 11 * RandomBox::kWidth + 18;
        b.paint[0][pit] = 0;
        b.relief[pit] = -0.02f;
        b.total = b.paint[0];
        const double volume = b.sum(0);
        TransferRates rates = some_rates();
        rates.yield_mm = 10;
        rates.pit_mm = 0.004f;
        rates.still_mm = 0.02f;
        StepScratch scratch;
        for (int step = 0; step < 40; ++step) push(b.box, rates, {}, scratch);
        EXPECT_NEAR(b.sum(0) / volume, 1, 1e-5);
        return b.total[pit];
    };
    EXPECT_GT(pit_in(0.1f), 0.09f);
    EXPECT_EQ(pit_in(0.015f), 0);
}

}  // namespace
}  // namespace tangi
