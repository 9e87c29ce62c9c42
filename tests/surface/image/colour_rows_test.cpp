#include "surface/image/colour_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "surface/base/instruction_sets.h"

namespace tangi {
namespace {

// Colours of all kinds: bright, dark, nearly grey, and what lies outside 0..1.
std::vector<Rgb> any_colours(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> part(0, 1);
    std::vector<Rgb> colours;
    for (std::size_t i = 0; i < count; ++i) {
        const float level = std::pow(part(random), 3.0f), colourful = i % 3 ? part(random) : 1e-3f;
        Rgb colour(0);
        for (int c = 0; c < 3; ++c) colour[c] = level * (1 + colourful * (part(random) - 0.5f));
        colours.push_back(i % 7 ? colour : 1.6f * colour - 0.2f);
    }
    return colours;
}

// Runs a test on every instruction set that the machine has.
template <class Test>
void on_every_instruction_set(const Test& test) {
    for (const std::string& name : instruction_sets()) {
        SCOPED_TRACE(name);
        use_instruction_set(name);
        test();
    }
    use_instruction_set("");
}

TEST(TransferRow, SaysWhatTransferSaysOfEachPixel) {
    const std::vector<Rgb> colours = any_colours(1003, 1);
    on_every_instruction_set([&] {
        for (const char* name : {"linear", "srgb", "gamma 2.2", "gamma 1.8", "curve 2.2 -0.5 0.1"}) {
            const Transfer transfer = *transfer_named(name);
            std::vector<Rgb> stored(colours.size()), linear(colours.size());
            encode_row(transfer, colours, stored);
            decode_row(transfer, colours, linear);
            for (std::size_t i = 0; i < colours.size(); ++i)
                for (int c = 0; c < 3; ++c) {
                    const float value = colours[i][c];
                    EXPECT_NEAR(stored[i][c], std::min(transfer.encode(value), 1.0f), 1e-6) << name << value;
                    EXPECT_NEAR(linear[i][c], transfer.decode(std::min(value, 1.0f)), 1e-6) << name << value;
                }
        }
    });
}

TEST(TransferRow, KeepsBlackAndWhiteAndMayOverwrite) {
    for (const char* name : {"linear", "srgb", "gamma 2.2"}) {
        std::vector<Rgb> row = {Rgb(0), Rgb(1), Rgb(-1), Rgb(2)};
        encode_row(*transfer_named(name), row, row);
        EXPECT_EQ(row[0], Rgb(0));
        EXPECT_NEAR(row[1].g, 1, 1e-6);
        EXPECT_EQ(row[2], Rgb(0));
        EXPECT_LE(row[3].g, 1);
    }
}

TEST(DeltaERow, SaysWhatDeltaE2000SaysOfEachPair) {
    const std::vector<Rgb> a = any_colours(20011, 1);
    std::vector<Rgb> b = any_colours(a.size(), 2);
    for (std::size_t i = 0; i < b.size(); i += 2)
        b[i] = a[i] * 0.97f + 0.01f * b[i];  // nearly equal, as photographs
    const auto lab = [](const Rgb& c) {
        return lab_from_linear(glm::dvec3(std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f),
                                          std::clamp(c.b, 0.0f, 1.0f)));
    };
    on_every_instruction_set([&] {
        std::vector<float> difference(a.size());
        delta_e_2000_row(a, b, difference);
        for (std::size_t i = 0; i < a.size(); ++i)
            ASSERT_NEAR(difference[i], delta_e_2000(lab(a[i]), lab(b[i])), 2e-6 * (1 + difference[i])) << i;
    });
}

TEST(DeltaERow, OfEqualColoursIsNothingAndOfOppositeOnesWhatItIs) {
    const std::vector<Rgb> colours = any_colours(301, 3);
    std::vector<float> difference(colours.size());
    on_every_instruction_set([&] {
        delta_e_2000_row(colours, colours, difference);
        for (const float value : difference) EXPECT_EQ(value, 0);
        // Black and grey, of no hue; and hues that lie opposite each other, or nearly.
        const std::vector<Rgb> one = {Rgb(0), Rgb(0.2f), Rgb(0.3f, 0.2f, 0.2f), Rgb(0.2f, 0.3f, 0.3f),
                                      Rgb(0.1f, 0.1f, 0.4f)};
        const std::vector<Rgb> other = {Rgb(0.3f, 0, 0), Rgb(0.5f), Rgb(0.2f, 0.3f, 0.3f),
                                        Rgb(0.3f, 0.2f, 0.2f), Rgb(0.4f, 0.4f, 0.1f)};
        std::vector<float> found(one.size());
        delta_e_2000_row(one, other, found);
        for (std::size_t i = 0; i < one.size(); ++i)
            EXPECT_NEAR(found[i], delta_e_2000(lab_from_linear(one[i]), lab_from_linear(other[i])), 1e-4)
                << i;
    });
}

}  // namespace
}  // namespace tangi
