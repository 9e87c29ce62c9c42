// photo_misfit_test.cpp: photographs that break the model are named, with the cause; honest ones are not.
#include "fit/light_checks/photo_misfit.h"

#include <gmock/gmock.h>

#include <functional>

#include "fit/light_checks/misfit_terms.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/image_file/image_io.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kMisfitPhotos = 16;

Image<float> gaussian(double sigma) {
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    Image<float> weights(2 * reach + 1, 1);
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
    for (int i = -reach; i <= reach; ++i)
        weights(i + reach, 0) = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum);
    return weights;
}

Image<Rgb> blurred(const Image<Rgb>& picture, double sigma) {
    const Image<float> weights = gaussian(sigma);
    const int reach = weights.width() / 2, w = picture.width(), h = picture.height();
    Image<Rgb> across(w, h, Rgb(0)), result = across;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            for (int i = -reach; i <= reach; ++i)
                across(x, y) += weights(i + reach, 0) * picture(std::clamp(x + i, 0, w - 1), y);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            for (int i = -reach; i <= reach; ++i)
                result(x, y) += weights(i + reach, 0) * across(x, std::clamp(y + i, 0, h - 1));
    return result;
}

using Change = std::function<Image<Rgb>(std::size_t photo, const Image<Rgb>&)>;

// A generated stack, of which photographs are changed before they are fitted.
struct ChangedStack {
    TestDir folder;
    FitReport report;

    explicit ChangedStack(const Change& change, const GeneratorOptions& options = {},
                          const PaintingTruth& truth = painting(120, 96)) {
        GeneratorOptions all = options;
        all.lights = kMisfitPhotos;
        all.held_out = 0;
        all.format = GeneratorFormat::exr;
        write_stack(folder.path(), truth, all);
        const Stack stack = open_stack(folder.path(), {.transfer = Transfer{}});
        for (std::size_t i = 0; change && i < stack.photos.size(); ++i) {
            const fs::path& path = stack.photos[i].path;
            write_picture(path, change(i, read_picture(path)), {});
        }
        report = fit_painting(open_stack(folder.path(), {.transfer = Transfer{}})).report;
    }
    std::vector<std::string> doubts() const { return doubts_of(report.photo_misfits, report.photo_names); }
};

Image<Rgb> with_light(Image<Rgb> picture, const Image<Rgb>& diffuse, float light, float room,
                      float constant) {
    for (std::size_t i = 0; i < picture.size(); ++i)
        picture.pixels()[i] = light * picture.pixels()[i] + room * diffuse.pixels()[i] + constant;
    return picture;
}

TP_LONG TEST(PhotoMisfit, HonestPhotographsAreNotDoubted) {
    EXPECT_THAT(ChangedStack({}).doubts(), IsEmpty());
    EXPECT_THAT(ChangedStack({}, {.ambient = 0.05, .interreflection = 0.1}).doubts(), IsEmpty());
    EXPECT_THAT(ChangedStack({}, {.distance = 2, .gain_min = 0.3, .gain_max = 2, .beam_deg = 30}).doubts(),
                IsEmpty());
}

TP_LONG TEST(PhotoMisfit, HonestMetalIsNotDoubted) {
    const ChangedStack gold({}, {},
                            procedural_painting({.seed = 3,
                                                 .width = 120,
                                                 .height = 96,
                                                 .mm_per_pixel = kMmPerPixel,
                                                 .gilding = true,
                                                 .brushed = 1}));
    EXPECT_THAT(gold.doubts(), IsEmpty());
}

TP_LONG TEST(PhotoMisfit, WhatAllPhotographsLoseIsNoDrift) {
    // As interpolation of a mosaic: the shortest waves, of all photographs.
    const ChangedStack stack([](std::size_t, const Image<Rgb>& picture) { return blurred(picture, 0.5); });
    EXPECT_THAT(stack.doubts(), IsEmpty());
}

TEST(MisfitTerms, AreAgainstTheMiddlingPhotographs) {
    std::vector<PhotoTerms> photos(5);
    for (PhotoTerms& photo : photos) {
        photo.solved = true;
        photo.terms[1] = 0.1;                 // room
        photo.terms[kMisfitTerms - 2] = 0.2;  // blur
        photo.sensitivities.setConstant(10);
        photo.blurs = 100 * Eigen::Matrix2d::Identity();
    }
    photos[3].terms[1] = 0.15;
    photos[4].terms[kMisfitTerms - 2] = 0;
    const std::vector<PhotoMisfit> misfits = relative_misfits(photos);
    EXPECT_NEAR(misfits[0].room.effect, 0, 1e-12);
    EXPECT_NEAR(misfits[0].blur.effect, 0, 1e-12);
    EXPECT_NEAR(misfits[3].room.value, 0.05, 1e-12);
    EXPECT_NEAR(misfits[3].room.effect, 0.5, 1e-12);
    EXPECT_NEAR(misfits[4].blur.value, -0.2, 1e-12);
    EXPECT_NEAR(misfits[4].blur.effect, 2, 1e-12);
}

TEST(MisfitTerms, OfFewOddBlocksAreNotThePhotographs) {
    std::vector<MisfitNormal> blocks;
    for (int k = 0; k < 40; ++k) {
        // Four blocks, as of metal, have a constant of 8; the others differ by 0.1 this way and that.
        const double off = k < 4 ? 8 : k % 2 ? 0.1 : -0.1;
        MisfitNormal& block = blocks.emplace_back();
        for (int i = 0; i < 50; ++i) {
            MisfitTerms terms;
            for (int t = 0; t < kMisfitTerms; ++t) terms[t] = std::cos(t * (0.37 * i + k + 1));
            terms[2] = 1;
            block.matrix += terms * terms.transpose();
            block.right += off * terms;
            block.squares += off * off;
            ++block.count;
        }
    }
    const PhotoTerms terms = solve_photos({blocks})[0];
    ASSERT_TRUE(terms.solved);
    EXPECT_LT(terms.terms.cwiseAbs().maxCoeff(), 0.1);
    EXPECT_GT(terms.rms, 2) << "but the photograph's deviation is that of all";
}

TEST(PhotoMisfit, WhatIsMattAndWhatIsGlossyAreTold) {
    PhotoMisfits misfits;
    misfits.matt = {.rms = 0.3, .part = 0.7};
    misfits.glossy = {.rms = 3, .part = 0.3};
    EXPECT_FALSE(is_in_matt_paint(misfits));
    EXPECT_TRUE(is_in_gloss(misfits));
    misfits.matt.rms = 2;
    EXPECT_TRUE(is_in_matt_paint(misfits));
    EXPECT_FALSE(is_in_gloss(misfits));
    misfits.judged = 8;
    EXPECT_EQ(ruled_out(misfits), "") << "what is not explained on the whole rules nothing out";
    misfits.matt.rms = 0.3;
    misfits.judged = 0;
    EXPECT_EQ(ruled_out(misfits), "") << "nothing could be judged";
    misfits.judged = 8;
    EXPECT_EQ(ruled_out(misfits), "focus and light of the room");
    misfits.veil.error = 0.001;
    EXPECT_EQ(ruled_out(misfits), "focus, light of the room and a veil");
}

// As of a varnished door, of which one pixel in a hundred counts as matt.
TEST(PhotoMisfit, CausesAreToldWhereMostIsMattAndExplained) {
    PhotoMisfits misfits;
    misfits.photos.assign(8, {.rms = 0.5, .strength = 1});
    misfits.photos[2].blur = {1.5, 0.1, 1.2};
    const std::vector<std::string> names = {"a", "b", "c", "d", "e", "f", "g", "h"};
    misfits.matt = {.rms = 0.4, .part = 0.9};
    EXPECT_THAT(doubts_of(misfits, names), ElementsAre(HasSubstr("c 1.22")));
    misfits.matt.part = 0.01;
    EXPECT_THAT(doubts_of(misfits, names), IsEmpty());
    misfits.matt = {.rms = 1.1, .part = 0.9};
    EXPECT_THAT(doubts_of(misfits, names), IsEmpty());
}

TP_LONG TEST(PhotoMisfit, FocusThatDriftsIsMeasured) {
    const ChangedStack stack([](std::size_t i, const Image<Rgb>& picture) {
        return blurred(picture, 0.2 + 0.8 * static_cast<double>(i) / (kMisfitPhotos - 1));
    });
    EXPECT_THAT(stack.doubts(), ElementsAre(AllOf(HasSubstr("sharp"), HasSubstr("focus held"))));
    const auto& photos = stack.report.photo_misfits.photos;
    // Against the middling one, the first are sharper and the last softer.
    EXPECT_LT(photos[1].blur.value, 0);
    EXPECT_GT(photos[kMisfitPhotos - 1].blur.value, 0.1);
}

TP_LONG TEST(PhotoMisfit, LightOfTheRoomIsNamed) {
    const PaintingTruth truth = painting(120, 96);
    const ChangedStack stack([&](std::size_t i, const Image<Rgb>& picture) {
        return with_light(picture, truth.diffuse, 1, i % 4 == 1 ? 0.1f : 0, 0);
    });
    EXPECT_THAT(stack.doubts(), ElementsAre(AllOf(HasSubstr("4 of 16"), HasSubstr("lights of the room"))));
    for (std::size_t i = 0; i < kMisfitPhotos; ++i)
        EXPECT_EQ(stack.report.photo_misfits.photos[i].room.effect > 0.3, i % 4 == 1) << i;
}

TP_LONG TEST(PhotoMisfit, LightThatDidNotFireIsNamed) {
    const PaintingTruth truth = painting(120, 96);
    const ChangedStack stack([&](std::size_t i, const Image<Rgb>& picture) {
        return i == 5 ? with_light(picture, truth.diffuse, 0, 0.12f, 0.002f) : picture;
    });
    EXPECT_THAT(stack.doubts(),
                ElementsAre(AllOf(HasSubstr(stack.report.photo_names[5]), HasSubstr("light of the room"))));
    EXPECT_THAT(worst_of(stack.report.photo_misfits, stack.report.photo_names),
                HasSubstr(stack.report.photo_names[5]));
}

TEST(PhotoMisfit, DarkFrameIsNamed) {
    PhotoMisfits misfits;
    misfits.photos.assign(8, {.rms = 0.5, .strength = 1});
    misfits.photos[3] = {.rms = 4, .gain = {-0.99, 0.01, 3}, .strength = 0.01};
    const std::vector<std::string> names = {"a", "b", "c", "d", "e", "f", "g", "h"};
    EXPECT_THAT(doubts_of(misfits, names), ElementsAre(AllOf(HasSubstr("d: "), HasSubstr("dark frame"))));
    EXPECT_EQ(worst_of(misfits, names), "d 8.0 times as much as others");
    for (const std::size_t i : {1u, 3u, 5u}) misfits.photos[i] = {.rms = 4, .gain = {-0.99, 0.01, 3}};
    EXPECT_THAT(doubts_of(misfits, names),
                ElementsAre(AllOf(HasSubstr("3 of 8 photographs"), HasSubstr("in the order"))));
    misfits.photos[1] = misfits.photos[5] = misfits.photos[0];
    misfits.photos[3] = {.rms = 4, .gain = {-0.95, 0.6, 3}, .strength = 0.05};
    EXPECT_THAT(doubts_of(misfits, names), IsEmpty()) << "what is as uncertain is not told";
    misfits.photos[3] = {.rms = 0.5, .strength = 0.05};
    EXPECT_THAT(doubts_of(misfits, names), IsEmpty()) << "weak lights may be weak";
}

TP_LONG TEST(PhotoMisfit, VeilIsMeasured) {
    const PaintingTruth truth = painting(120, 96);
    const ChangedStack stack([&](std::size_t, const Image<Rgb>& picture) {
        return with_light(picture, truth.diffuse, 0.9f, 0, 0.05f);
    });
    EXPECT_THAT(stack.doubts(), Contains(AllOf(HasSubstr("veil"), HasSubstr("black level"))));
    EXPECT_NEAR(stack.report.photo_misfits.veil.value, 0.05, 0.015);
}

}  // namespace
}  // namespace tangi
