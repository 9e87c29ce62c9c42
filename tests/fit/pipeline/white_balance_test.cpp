// white_balance_test.cpp: photographs whose white balance changes, fitted and compared.
#include <gmock/gmock.h>

#include "fit/pipeline/fit_painting.h"
#include "surface/image_file/image_io.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

const Rgb kCast(1.25f, 1, 0.7f);

// Photographs of a folder, those that are chosen with the cast.
template <class Chosen>
void cast(const fs::path& folder, const Stack& stack, const Chosen& chosen) {
    for (std::size_t i = 0; i < stack.photos.size(); ++i) {
        if (!chosen(i)) continue;
        Image<Rgb> picture = read_picture(stack.photos[i].path);
        for (Rgb& pixel : picture.pixels()) pixel = glm::min(pixel * kCast, Rgb(1));
        write_picture(folder / stack.photos[i].path.filename(), picture, {});
    }
}

struct GeneratedStack {
    TestDir folder;
    PaintingTruth truth = painting(64, 48);
    GeneratedStack() {
        write_stack(folder.path(), truth, {.lights = 16, .held_out = 4, .format = GeneratorFormat::exr});
    }
    Stack open() const { return open_stack(folder.path(), {.transfer = Transfer{}}); }
    Stack held_out() const { return open_stack(folder.path() / "heldout", {.transfer = Transfer{}}); }
};

TP_LONG TEST(FitWhiteBalance, ThatChangesIsUndone) {
    const GeneratedStack steady, changing;
    cast(changing.folder.path(), changing.open(), [](std::size_t i) { return i % 2 == 1; });
    const FitResult plain = fit_painting(steady.open()), fit = fit_painting(changing.open());
    EXPECT_EQ(plain.report.white_balances.differing(), 0);
    EXPECT_THAT(plain.report.warnings, Each(Not(HasSubstr("white balance"))));
    EXPECT_EQ(fit.report.white_balances.differing(), 8);
    EXPECT_THAT(fit.report.warnings,
                Contains(AllOf(HasSubstr("8 of 16 differ"), HasSubstr("red × 1.25"), HasSubstr("undone"))));
    EXPECT_THAT(fit.report.warnings, Each(Not(HasSubstr("metal and glass"))));
    // The painting is the same.
    const CompareReport good = compare(plain.surface, steady.held_out()),
                        same = compare(fit.surface, changing.held_out());
    EXPECT_LT(same.held_out.delta_e_2000, good.held_out.delta_e_2000 + 0.2);
    EXPECT_GT(same.held_out.psnr_db, good.held_out.psnr_db - 0.3);
    EXPECT_LT(mean_normal_error_deg(fit.surface, changing.truth),
              mean_normal_error_deg(plain.surface, steady.truth) + 0.2);
    // Photographs that were fitted are predicted as they are, cast and all.
    const CompareReport fitted = compare(fit.surface, changing.open());
    EXPECT_LT(fitted.held_out.count, 1);
    EXPECT_LT(fitted.fitted.delta_e_2000, good.held_out.delta_e_2000 + 0.5);
    for (const Photography::Photo& photo : fit.surface.photography.photos)
        EXPECT_GT(photo.light.gain.g, 0.5f);
}

TP_LONG TEST(FitWhiteBalance, OfPhotographsThatAreComparedIsTold) {
    const GeneratedStack stack;
    const FitResult fit = fit_painting(stack.open());
    const CompareReport before = compare(fit.surface, stack.held_out());
    EXPECT_THAT(before.warnings, Each(Not(HasSubstr("white balance"))));
    cast(stack.folder.path() / "heldout", stack.held_out(), [](std::size_t i) { return i == 2; });
    const CompareReport after = compare(fit.surface, stack.held_out());
    EXPECT_THAT(after.warnings, Contains(AllOf(HasSubstr("1 of the photographs that were not fitted"),
                                               HasSubstr("red × 1.2"), HasSubstr("blue × 0.7"))));
    EXPECT_GT(after.held_out.delta_e_2000, before.held_out.delta_e_2000 + 1) << "no figure is flattered";
    int told = 0;
    for (const PhotoComparison& photo : after.photos) told += photo.white_balance.has_value();
    EXPECT_EQ(told, 1);
}

}  // namespace
}  // namespace tangi
