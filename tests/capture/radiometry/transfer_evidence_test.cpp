// transfer_evidence_test.cpp: a curve that the photographs leave open is told, with the true one
// among the possible ones; one that they tell is right.
#include "capture/radiometry/transfer_evidence.h"

#include <gmock/gmock.h>

#include "capture/radiometry/transfer_estimate.h"
#include "datasets/generator.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Linear photographs with 16 bits, without metadata, and what was seen of them.
struct LinearStack {
    TestDir dir;
    Stack stack;
    Survey seen;

    explicit LinearStack(GeneratorOptions options, PaintingOptions painting = {}) {
        painting.width = 128, painting.height = 96;
        options.held_out = 0, options.format = GeneratorFormat::tif;
        write_stack(dir.path(), procedural_painting(painting), options);
        stack = open_stack(dir.path());
        seen = survey(stack);
    }
    // As if they had been stored so.
    Survey stored(const Transfer& transfer) const {
        Survey result = seen;
        for (float& value : result.values) value = std::round(transfer.encode(value) * 65535) / 65535;
        return result;
    }
    TransferEstimate estimated(const Transfer& truth) const {
        return estimate_transfer(stack, stored(truth));
    }
    // [deg] By how much slopes are off where this is taken.
    double off_deg(const Transfer& taken, const Transfer& truth) const {
        const Survey survey = stored(truth);
        return slopes_change_deg(try_transfer(stack, survey, taken), try_transfer(stack, survey, truth));
    }
};

GeneratorOptions ring(int lights, Reflectance reflectance, double elevation_deg = 45) {
    GeneratorOptions options{.seed = 5, .lights = lights};
    options.min_elevation_deg = options.max_elevation_deg = elevation_deg;
    options.reflectance = reflectance;
    return options;
}

const std::vector<Transfer> kStored = {
    {}, {Transfer::Kind::srgb}, {Transfer::Kind::gamma, 1.8}, {Transfer::Kind::gamma, 2.2}};

double probability(const TransferEstimate& e, const Transfer& transfer) {
    for (const auto& candidate : e.candidates)
        if (candidate.transfer == transfer) return candidate.probability;
    return 0;
}

// In one ring, or few of them, gloss bends the shading as a curve does.
TP_LONG TEST(TransferEvidence, OfRingsIsRightOrToldWithTheTruthAmongTheRest) {
    int told = 0, quiet = 0;
    for (const int lights : {5, 8, 12, 16})
        for (const Reflectance reflectance : {Reflectance::lambert, Reflectance::ggx}) {
            const LinearStack photographs(ring(lights, reflectance));
            for (const Transfer& truth : kStored) {
                const TransferEstimate e = photographs.estimated(truth);
                const std::string what =
                    fmt::format("{} lights, {}, {}: {} ({})", lights, name_of(reflectance), truth.name(),
                                e.transfer.name(), e.doubt);
                if (e.doubt.empty()) {
                    ++quiet;
                    EXPECT_LT(photographs.off_deg(e.transfer, truth), 2.5) << what;
                    continue;
                }
                ++told;
                EXPECT_GT(probability(e, truth), 0.01) << what;
                if (e.transfer != truth) {
                    EXPECT_THAT(e.doubt, HasSubstr(truth.name() + " (")) << what;
                }
                EXPECT_THAT(e.doubt, HasSubstr("--transfer linear, srgb")) << what;
                EXPECT_EQ(e.warning, e.doubt) << what;
            }
        }
    EXPECT_GT(told, 10);  // glossy ones are open
    EXPECT_GT(quiet, 3);  // some matt ones are not
}

// Lights at many heights tell, glossy paint or gilded.
TP_LONG TEST(TransferEvidence, OfADomeIsRight) {
    for (const bool gilded : {false, true})
        for (const Reflectance reflectance : {Reflectance::lambert, Reflectance::ggx}) {
            if (gilded && reflectance == Reflectance::lambert) continue;
            const LinearStack photographs({.seed = 5, .lights = 24, .reflectance = reflectance},
                                          {.gilding = gilded});
            for (const Transfer& truth : kStored) {
                const TransferEstimate e = photographs.estimated(truth);
                EXPECT_LT(photographs.off_deg(e.transfer, truth), 2.5)
                    << truth.name() << " " << e.transfer.name() << " " << name_of(reflectance);
                EXPECT_THAT(e.doubt, IsEmpty()) << truth.name() << " " << name_of(reflectance);
            }
        }
}

// Metal shines under high lights, which then seem the stronger ones: what a curve makes of equal lights as
// well. Numbers are those of generated photographs of a ground of gold, stored as sRGB.
TEST(TransferEvidence, OfLightsIsNotCertainWhereMetalShines) {
    Stack stack;
    stack.bits = 16;
    for (const double z : {0.3, 0.5, 0.7, 0.9}) {
        stack.photos.emplace_back();
        stack.photos.back().light.direction.z = static_cast<float>(z);
    }
    std::vector<TransferTrial> trials(2);
    trials[0] = {.transfer = {}, .residual = 0.003, .strength_scatter = 0.01, .strength_trend = 0.9};
    trials[1] = {.transfer = {Transfer::Kind::srgb},
                 .residual = 0.0031,
                 .strength_scatter = 0.01,
                 .strength_trend = 1.88};
    weigh(trials, stack);
    EXPECT_GT(trials[1].probability, 0.05);
    EXPECT_GT(trials[0].probability, trials[1].probability);
    // Paint, whose lights seem alike with one of them, is none such.
    trials[0].strength_trend = 0.6, trials[1].strength_trend = 0;
    weigh(trials, stack);
    EXPECT_GT(trials[1].probability, 0.9);
}

// Lights of which the strongest is four times as strong as the weakest are no curve: surfaces are found with
// their strengths, not as if these were equal.
TP_LONG TEST(TransferEvidence, OfUnequalLightsIsNoCurve) {
    GeneratorOptions options{.seed = 5, .lights = 24};
    options.gain_min = 0.5, options.gain_max = 2, options.white_level = 0.4;
    const LinearStack photographs(options);
    for (const Transfer& truth : kStored) {
        const TransferEstimate e = photographs.estimated(truth);
        if (e.doubt.empty()) {
            EXPECT_LT(photographs.off_deg(e.transfer, truth), 2.5)
                << truth.name() << " " << e.transfer.name();
        } else {
            EXPECT_GT(probability(e, truth), 0.01) << truth.name();
        }
        const TransferTrial trial = try_transfer(photographs.stack, photographs.stored(truth), truth);
        EXPECT_LT(trial.residual, 0.6 * trial.equal_residual) << truth.name();
    }
}

// Where all slopes are small, none is another with another curve.
TP_LONG TEST(TransferEvidence, OfAFlatPaintingMakesNothingPoor) {
    const LinearStack photographs(ring(8, Reflectance::lambert),
                                  {.weave_mm = 0, .impasto = 0.02, .craquelure = 0, .losses = false});
    for (const Transfer& truth : kStored)
        EXPECT_THAT(photographs.estimated(truth).doubt, IsEmpty()) << truth.name();
}

// What is likely of files decides where photographs say nothing, and only there.
TEST(TransferEvidence, IsWeighedWithWhatFilesAre) {
    Stack stack;
    stack.bits = 16;
    stack.photos.resize(8);
    std::vector<TransferTrial> trials(2);
    trials[0].transfer = {}, trials[1].transfer = {Transfer::Kind::srgb};
    for (TransferTrial& trial : trials) trial.residual = 0.01;
    weigh(trials, stack);
    EXPECT_GT(trials[0].probability, trials[1].probability);
    EXPECT_NEAR(trials[0].probability + trials[1].probability, 1, 1e-12);
    stack.bits = 8;
    weigh(trials, stack);
    EXPECT_LT(trials[0].probability, trials[1].probability);
    trials[1].residual = 0.03;
    weigh(trials, stack);
    EXPECT_GT(trials[0].probability, 0.99);
    // Photographs that disagree about which is better say less.
    trials[0].partial = {0.01, 0.03, 0.01, 0.03}, trials[1].partial = {0.03, 0.01, 0.03, 0.01};
    weigh(trials, stack);
    EXPECT_LT(trials[0].probability, 0.9);
}

}  // namespace
}  // namespace tangi
