// brush_test.cpp: bristles, loads, and turning without loss.
#include "paint/brush/brush.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

double total(const Brush& brush) {
    const auto volumes = brush.volumes_mm3(3);
    return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

std::vector<float> underside(const Brush& brush, const Dab& dab, int half,
                             std::vector<RowSpan>* spans = nullptr, std::vector<float>* covered = nullptr) {
    std::vector<float> out(static_cast<std::size_t>((2 * half + 1) * (2 * half + 1)));
    std::vector<float> cover(out.size());
    std::vector<RowSpan> rows;
    brush.underside_mm(dab, {-half, -half, half + 1, half + 1}, out.data(), cover.data(), rows);
    if (spans) *spans = rows;
    if (covered) *covered = cover;
    return out;
}

int touching(const std::vector<float>& underside, float below_mm = 0.5f) {
    return static_cast<int>(
        std::count_if(underside.begin(), underside.end(), [&](float b) { return b < below_mm; }));
}

TEST(Brush, HoldsItsRecipe) {
    Brush brush(brush_presets().at("round"), kTestPixel, 1);
    brush.load({{0, 3}, {2, 1}}, 1);
    const auto volumes = brush.volumes_mm3(3);
    EXPECT_NEAR(volumes[0] / volumes[2], 3, 1e-4);
    EXPECT_EQ(volumes[1], 0);
    const double full = total(brush);
    EXPECT_GT(full, 20);  // [mm^3] a loaded brush of 8 mm
    EXPECT_NEAR(brush.full_mm3(), full, full * 1e-4);
    brush.load({{0, 1}}, 0.25);
    EXPECT_NEAR(total(brush), full / 4, full * 1e-4);
    brush.clean();
    EXPECT_EQ(total(brush), 0);
    EXPECT_THROW(brush.load({}, 1), Error);
}

TEST(Brush, ADirtyBrushIsFilledUpAndKeepsWhatItHad) {
    Brush brush(even_brush(), kTestPixel, 1);
    brush.load({{0, 1}}, 0.5);
    const double half = total(brush);
    brush.load({{1, 1}}, 1, true);
    const auto volumes = brush.volumes_mm3(3);
    EXPECT_NEAR(volumes[0], half, 1e-3);
    EXPECT_NEAR(volumes[1], half, 1e-3);
    Brush other(even_brush(8), kTestPixel, 2);
    other.take_over(brush);
    const auto taken = other.volumes_mm3(3);
    EXPECT_NEAR(taken[0], half, half * 1e-4);
    EXPECT_NEAR(taken[1], half, half * 1e-4);
}

// Whatever it is loaded with itself, and however small it is.
TEST(Brush, AnyBrushTakesOverAllThatIsOnAnother) {
    for (const auto& [from, settings] : brush_presets()) {
        Brush before(settings, kTestPixel, 1);
        Brush loaded(brush_presets().at("flat"), kTestPixel, 1);
        loaded.load({{0, 1}, {2, 0.01}}, 1);
        before.take_over(loaded);
        const auto there = before.volumes_mm3(3);
        ASSERT_GT(there[2], 0.1) << from;
        for (const auto& [to, preset] : brush_presets())
            for (const double size_mm : {preset.size_mm, 0.5, 60.0}) {
                BrushSettings other = preset;
                other.size_mm = size_mm;
                Brush after(other, kTestPixel, 2);
                after.take_over(before);
                const auto here = after.volumes_mm3(3);
                for (const std::size_t paint : {0u, 2u})
                    EXPECT_NEAR(here[paint] / there[paint], 1, 1e-5)
                        << from << " to " << to << " of " << size_mm << " mm";
                EXPECT_EQ(here[1], 0);
            }
    }
}

TEST(Brush, BristlesDifferInLoadAndLength) {
    Brush brush(brush_presets().at("round"), kTestPixel, 1);
    brush.load({{0, 1}}, 1);
    const float* load = brush.load_total();
    const int size = brush.grid_size(), middle = brush.grid_half();
    float low = 1e9f, high = 0;
    for (int x = middle - 8; x <= middle + 8; ++x) {
        low = std::min(low, load[middle * size + x]);
        high = std::max(high, load[middle * size + x]);
    }
    EXPECT_GT(high, 1.05f * low);
    Dab dab;
    dab.dx = 0;
    dab.pressure = 1;
    const auto one = underside(brush, dab, 8),
               other = underside(Brush(brush.settings(), kTestPixel, 2), dab, 8);
    EXPECT_GT(*std::max_element(one.begin(), one.end()), *std::min_element(one.begin(), one.end()) + 0.02f);
    EXPECT_NE(one, other);
}

TEST(Brush, TurningLosesNothingAndIsUndone) {
    Brush brush(brush_presets().at("flat"), kTestPixel, 3);
    brush.load({{0, 1}, {1, 2}}, 1);
    const auto cells = static_cast<std::ptrdiff_t>(brush.grid_size()) * brush.grid_size();
    brush.turn_to(0);
    const std::vector<float> before(brush.load_total(), brush.load_total() + cells);
    const double volume = total(brush);
    for (const double degrees : {7.0, 45.0, 46.0, 91.0, 180.0, 333.0, 700.0, -50.0}) {
        brush.turn_to(static_cast<float>(degrees * std::numbers::pi / 180));
        double seen = 0;
        for (std::ptrdiff_t i = 0; i < cells; ++i) seen += brush.load_total()[i];
        EXPECT_NEAR(seen * kTestPixel * kTestPixel / volume, 1, 1e-5) << degrees;
        EXPECT_EQ(total(brush), volume) << degrees;
    }
    brush.turn_to(0);
    EXPECT_EQ(before, std::vector<float>(brush.load_total(), brush.load_total() + cells));
    // As a stroke ends and another begins.
    brush.rest();
    brush.turn_to(0);
    EXPECT_EQ(before, std::vector<float>(brush.load_total(), brush.load_total() + cells));
}

// A brush that gives the same part of its paint everywhere keeps its pattern, however often it turns.
TEST(Brush, TurningDoesNotBlurWhatIsOnTheBristles) {
    Brush brush(brush_presets().at("flat"), kTestPixel, 3);
    brush.load({{0, 1}}, 1);
    const auto cells = static_cast<std::ptrdiff_t>(brush.grid_size()) * brush.grid_size();
    const BrushLoad before = brush.bristles();
    const int turns = 60;
    for (int i = 1; i <= turns; ++i) {
        brush.turn_to(static_cast<float>(0.11 * i));
        float* const load = brush.load_plane(0);
        for (std::ptrdiff_t k = 0; k < cells; ++k) load[k] *= 0.98f;
    }
    brush.rest();
    const BrushLoad after = brush.bristles();
    const float left = std::pow(0.98f, static_cast<float>(turns));
    for (std::size_t k = 0; k < before.total_mm.size(); ++k)
        ASSERT_NEAR(after.total_mm[k], left * before.total_mm[k], 1e-3f) << k;
}

// What comes onto a turned brush stays where it touched, and all of it.
TEST(Brush, PaintThatATurnedBrushTakesUpTurnsWithIt) {
    Brush brush(brush_presets().at("flat"), kTestPixel, 3);
    const float quarter = static_cast<float>(std::numbers::pi / 2);
    brush.turn_to(0.4f);
    const int size = brush.grid_size(), half = brush.grid_half(), out = 18;  // pixels along the width
    const int x = half + static_cast<int>(std::lround(out * std::cos(0.4))),
              y = half + static_cast<int>(std::lround(out * std::sin(0.4)));
    brush.load_plane(0)[y * size + x] = 2;
    EXPECT_NEAR(total(brush), 2 * kTestPixel * kTestPixel, 1e-6);
    brush.turn_to(0.4f + 2 * quarter);
    double sum = 0, mean_x = 0, mean_y = 0;
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) {
            const float mm = brush.load_plane(0)[row * size + column];
            sum += mm;
            mean_x += mm * (column - half);
            mean_y += mm * (row - half);
        }
    EXPECT_NEAR(sum, 2, 1e-5);
    EXPECT_NEAR(mean_x / sum, half - x, 1.0);
    EXPECT_NEAR(mean_y / sum, half - y, 1.0);
}

TEST(Brush, PutsBackWhatLiesTurned) {
    const BrushSettings settings = brush_presets().at("flat");
    Brush brush(settings, kTestPixel, 3), other(settings, kTestPixel, 3);
    brush.load({{0, 1}}, 1);
    const double volume = total(brush);
    other.put_back(brush.bristles());
    EXPECT_EQ(other.bristles().mm, brush.bristles().mm);
    // Earlier versions kept the cells as they lay on the canvas.
    BrushLoad turned = brush.bristles();
    brush.turn_to(1.1f);
    turned.rotation_rad = 1.1f;
    const auto cells = static_cast<std::ptrdiff_t>(brush.grid_size()) * brush.grid_size();
    turned.mm[0].assign(brush.load_total(), brush.load_total() + cells);
    other.put_back(turned);
    EXPECT_NEAR(total(other) / volume, 1, 1e-5);
    double difference = 0, sum = 0;
    const BrushLoad one = brush.bristles(), two = other.bristles();
    for (std::size_t i = 0; i < one.total_mm.size(); ++i) {
        difference += std::abs(one.total_mm[i] - two.total_mm[i]);
        sum += one.total_mm[i];
    }
    EXPECT_LT(difference, 0.5 * sum);  // another place would be 2
}

TEST(Brush, LoadsTurnTheWayTheBristlesDo) {
    BrushSettings settings = even_brush(20);
    settings.shape = BrushShape::flat;
    settings.thickness = 0.2;
    for (const double degrees : {0.0, 30.0, 90.0, 135.0}) {
        Brush brush(settings, kTestPixel, 3);
        brush.load({{0, 1}}, 1);
        Dab dab;
        dab.dx = dab.dy = 0;
        dab.pressure = 1;
        dab.rotation_rad = static_cast<float>(degrees * std::numbers::pi / 180);
        brush.turn_to(dab.rotation_rad);
        const int half = brush.grid_half();
        const auto b = underside(brush, dab, half);
        int loaded = 0, both = 0;
        for (std::size_t i = 0; i < b.size(); ++i)
            if (brush.load_total()[i] > 0) ++loaded, both += b[i] < kOutside;
        EXPECT_GT(loaded, 500) << degrees;
        EXPECT_GT(both, 0.9 * loaded) << degrees;
    }
}

TEST(Brush, PressureWidensTheContact) {
    const Brush brush(brush_presets().at("round"), kTestPixel, 1);
    int before = 0;
    for (const float pressure : {0.0f, 0.3f, 0.6f, 1.0f}) {
        Dab dab;
        dab.dx = 0;
        dab.pressure = pressure;
        const int now = touching(underside(brush, dab, brush.grid_half()));
        EXPECT_GT(now, before) << pressure;
        before = now;
    }
    // Of what lies at the rim, as much as the tip covers of it.
    const double area_px = std::numbers::pi * std::pow(8 / kTestPixel / 2, 2);
    Dab dab;
    dab.pressure = 1;
    std::vector<float> cover;
    underside(brush, dab, brush.grid_half(), nullptr, &cover);
    EXPECT_NEAR(std::accumulate(cover.begin(), cover.end(), 0.0), area_px * 1.15 * 1.15, 0.02 * area_px);
}

TEST(Brush, RowSpansHoldAllBristles) {
    for (const char* preset : {"round", "flat", "filbert", "fan", "knife", "rag"})
        for (const double degrees : {0.0, 20.0, 90.0, 200.0}) {
            const Brush brush(brush_presets().at(preset), kTestPixel, 1);
            Dab dab;
            dab.pressure = 0.7f;
            dab.rotation_rad = static_cast<float>(degrees * std::numbers::pi / 180);
            std::vector<RowSpan> spans;
            const int half = brush.grid_half(), width = 2 * half + 1;
            const auto b = underside(brush, dab, half, &spans);
            // The box that reach_px() gives holds all of them too, with its margin.
            int half_x, half_y;
            brush.reach_px(dab, half_x, half_y);
            double cx, cy;
            brush.contact_centre(dab, cx, cy);
            int inside = 0;
            for (int y = 0; y < width; ++y)
                for (int x = 0; x < width; ++x) {
                    if (b[static_cast<std::size_t>(y * width + x)] >= kOutside) continue;
                    ++inside;
                    EXPECT_GE(x, spans[static_cast<std::size_t>(y)].begin);
                    EXPECT_LT(x, spans[static_cast<std::size_t>(y)].end);
                    EXPECT_LT(std::abs(x - half - cx), half_x) << preset << degrees;
                    EXPECT_LT(std::abs(y - half - cy), half_y) << preset << degrees;
                }
            EXPECT_GT(inside, 100) << preset;
        }
}

TEST(Brush, RefusesWhatIsTooWide) {
    BrushSettings settings = even_brush(999);
    EXPECT_NE(error_of([&] { Brush(settings, 0.05, 1); }).find("999 mm"), std::string::npos);
}

}  // namespace
}  // namespace tangi
