// light_outlier_vote_test.cpp: gold leaf that was brushed makes no light odd, and hides none that is.
#include "fit/light_checks/light_outlier_vote.h"

#include <gmock/gmock.h>

#include "capture/formats/lights_file.h"
#include "fit/pipeline/fit_painting.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::Gt;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::size_t> photos_of(const LightOutliers& outliers) {
    std::vector<std::size_t> photos;
    for (const LightOutlier& odd : outliers.odd) photos.push_back(odd.photo);
    return photos;
}

TP_LONG TEST(LightOutlierVote, GoldThatWasBrushedMakesNoLightOddAndHidesNone) {
    const TestDir folder;
    PaintingOptions options{
        .width = 120, .height = 120, .mm_per_pixel = 0.4, .gilding = true, .brushed = 0.6};
    write_stack(folder.path(), procedural_painting(options), {.lights = 32, .held_out = 0});
    Stack stack = open_stack(folder.path(), {.transfer = Transfer{}});
    const FitOptions quick{.register_photos = false, .refine = false};
    const Survey surveyed = survey(stack, {});
    EXPECT_THAT(light_outliers(surveyed, Transfer{}, stack.lights(), 120, 120).odd, SizeIs(Gt(0u)))
        << "by matt reflection alone";
    EXPECT_THAT(photos_of(fit_painting(stack, quick).report.light_outliers), IsEmpty());

    Vec3& direction = stack.photos[5].light.direction;
    const float angle = 0.4f;
    direction = Vec3(std::cos(angle) * direction.x - std::sin(angle) * direction.y,
                     std::sin(angle) * direction.x + std::cos(angle) * direction.y, direction.z);
    EXPECT_THAT(photos_of(fit_painting(stack, quick).report.light_outliers), ElementsAre(5u));
}

}  // namespace
}  // namespace tangi
