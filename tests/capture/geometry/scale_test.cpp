// Scales and rectification: laws of perspective, errors that are honest, and corners that cannot be.
#include "capture/geometry/scale.h"

#include <gmock/gmock.h>

#include "capture/colour_chart/colour_chart.h"
#include "surface/base/json_reading.h"
#include "tests/support/capture/chart_pictures.h"

namespace tangi {
namespace {

using glm::dvec2;
using testing::HasSubstr;

// A plane in mm, y up, seen in perspective.
Homography tilted_view() {
    const double angle = 0.3, focal = 1500, distance = 700;
    const double c = std::cos(angle), s = std::sin(angle);
    // Columns: x and y of the plane, and its origin, in the camera's frame (y down, z away), times the camera
    // matrix.
    const glm::dmat3 pose(c, 0.02, s, 0.01, -1, 0.05, 4, -3, distance);
    const glm::dmat3 camera(focal, 0, 0, 0, focal, 0, 400, 300, 1);
    return camera * pose;
}

Corners corners_of(const Homography& h, double width, double height) {
    return {mapped(h, {-width / 2, height / 2}), mapped(h, {width / 2, height / 2}),
            mapped(h, {width / 2, -height / 2}), mapped(h, {-width / 2, -height / 2})};
}

TEST(Scale, OfABarIsItsLengthByItsPixels) {
    const Scale scale = scale_from_bar({10, 20}, {13, 24 + 396}, 100, 0.5);
    const double length = std::hypot(3, 400);
    EXPECT_DOUBLE_EQ(scale.mm_per_pixel, 100 / length);
    EXPECT_NEAR(scale.sigma / scale.mm_per_pixel, std::sqrt(0.5) / length, 1e-12);
    EXPECT_EQ(scale.place_px, dvec2(11.5, 220));
}

TEST(Scale, OfPixelsPerInch) {
    EXPECT_DOUBLE_EQ(scale_from_ppi(300).mm_per_pixel, 25.4 / 300);
    EXPECT_DOUBLE_EQ(scale_from_ppi(254).mm_per_pixel, 0.1);
    EXPECT_LT(scale_from_ppi(300).sigma / scale_from_ppi(300).mm_per_pixel, 1e-3);
}

TEST(Scale, OfCornersIsThatOfThePlane) {
    const Homography h = tilted_view();
    const Scale scale = scale_from_corners(corners_of(h, 200, 150), 200, 150);
    EXPECT_NEAR(scale.mm_per_pixel, mm_per_pixel_at(h, mapped(h, {0, 0})), 1e-7);
    EXPECT_NEAR(glm::length(scale.place_px - mapped(h, {0, 0})), 0, 1e-4);
    // The scale by differences: areas of a small square.
    const double e = 0.01;
    const dvec2 right = mapped(h, {e, 0}) - mapped(h, {0, 0}), up = mapped(h, {0, e}) - mapped(h, {0, 0});
    const double area = std::abs(right.x * up.y - right.y * up.x);
    EXPECT_NEAR(scale.mm_per_pixel, e / std::sqrt(area), 1e-5);
    EXPECT_THAT(scale.warnings, testing::IsEmpty());
}

TEST(Scale, OfCornersHasAnHonestError) {
    const Corners truth = corners_of(tilted_view(), 200, 150);
    const Scale exact = scale_from_corners(truth, 200, 150, 1.5);
    Random random(5);
    double square = 0;
    constexpr int kTrials = 400;
    for (int i = 0; i < kTrials; ++i) {
        Corners corners = truth;
        for (dvec2& c : corners) c += 1.5 * dvec2(random.normal(), random.normal());
        const double off = scale_from_corners(corners, 200, 150).mm_per_pixel - exact.mm_per_pixel;
        square += off * off / kTrials;
    }
    EXPECT_NEAR(std::sqrt(square) / exact.sigma, 1, 0.15);
}

TEST(Scale, OfSwappedSidesIsWarnedOf) {
    const Scale scale = scale_from_corners(corners_of(tilted_view(), 200, 120), 120, 200);
    ASSERT_EQ(scale.warnings.size(), 1u);
    EXPECT_THAT(scale.warnings[0], HasSubstr("width and height may be swapped"));
    EXPECT_THAT(scale_from_corners(corners_of(tilted_view(), 200, 120), 200, 200).warnings[0],
                HasSubstr("check the size"));
}

TEST(Scale, OfSomethingHigherIsLargerOnThePlane) {
    Scale measured = scale_from_bar({0, 0}, {200, 0}, 100);
    // A bar on a 30 mm high book under a camera at 600 mm: similar triangles, 600 / 570.
    EXPECT_NEAR(at_plane(measured, 30, 600).mm_per_pixel, 0.5 * 600 / 570, 1e-12);
    EXPECT_EQ(at_plane(measured, 0, 600).mm_per_pixel, measured.mm_per_pixel);
    EXPECT_THAT(error_of([&] { at_plane(measured, 700, 600); }), HasSubstr("behind the camera"));
}

TEST(Scale, OfNothingIsAnError) {
    EXPECT_THAT(error_of([] { scale_from_bar({5, 5}, {5, 6}, 100); }), HasSubstr("are 1.0 pixels apart"));
    EXPECT_THAT(error_of([] {
                    scale_from_bar({5, 5}, {500, 6}, -1);
                }),
                HasSubstr("length in mm is -1; give a positive"));
    EXPECT_THAT(error_of([] { scale_from_bar({5, 5}, {std::nan(""), 6}, 1); }), HasSubstr("pixels apart"));
    EXPECT_THAT(error_of([] { scale_from_ppi(0); }), HasSubstr("pixels per inch is 0"));
    const Corners good = {dvec2(10, 10), dvec2(90, 12), dvec2(88, 70), dvec2(9, 72)};
    EXPECT_THAT(error_of([&] { scale_from_corners(good, 0, 10); }), HasSubstr("width in mm is 0"));
}

TEST(Rectification, OfImpossibleCornersIsAnError) {
    const auto error = [](const Corners& c) { return error_of([&] { rectification(c, 80, 60); }); };
    EXPECT_THAT(error({dvec2(10, 10), dvec2(88, 70), dvec2(90, 12), dvec2(9, 72)}), HasSubstr("sides cross"));
    EXPECT_THAT(error({dvec2(10, 10), dvec2(9, 72), dvec2(88, 70), dvec2(90, 12)}),
                HasSubstr("anticlockwise"));
    EXPECT_THAT(error({dvec2(10, 10), dvec2(50, 10), dvec2(90, 10), dvec2(50, 70)}), HasSubstr("on a line"));
    EXPECT_THAT(error({dvec2(10, 10), dvec2(90, 10), dvec2(30, 20), dvec2(10, 90)}),
                HasSubstr("within the others"));
    EXPECT_THAT(error({dvec2(10, 10), dvec2(10, 10), dvec2(10, 10), dvec2(10, 10)}), HasSubstr("on a line"));
    const Corners good = {dvec2(10, 10), dvec2(90, 10), dvec2(90, 70), dvec2(10, 70)};
    EXPECT_THAT(error_of([&] { rectification(good, 80, 60, 1e-4); }),
                HasSubstr("would be 800000 x 600000 pixels"));
}

TEST(Rectification, TakesCornersToTheRectangle) {
    const Homography h = tilted_view();
    const Corners corners = corners_of(h, 200, 150);
    const Rectification r = rectification(corners, 200, 150, 0.5);
    EXPECT_EQ(r.width, 400);
    EXPECT_EQ(r.height, 300);
    for (int trial = 0; trial < 20; ++trial) {
        Random random(static_cast<std::uint64_t>(trial) + 1);
        const dvec2 mm(random.uniform(-100, 100), random.uniform(-75, 75));
        const dvec2 px = mapped(h, mm);
        EXPECT_LT(glm::length(mapped(r.picture_to_plane_mm, px) - mm), 1e-4);
        const dvec2 output(mm.x / 0.5 + 199.5, -mm.y / 0.5 + 149.5);
        EXPECT_LT(glm::length(mapped(r.output_to_picture, output) - px), 1e-4);
    }
    // Its own scale is the finest of the picture.
    const Rectification own = rectification(corners, 200, 150);
    double finest = 1e9;
    for (const dvec2& c : corners) finest = std::min(finest, mm_per_pixel_at(h, c));
    EXPECT_NEAR(own.mm_per_pixel, finest, 1e-6);
    EXPECT_EQ(to_json(r)["size_px"][1], 300);
}

TEST(Rectification, MakesThePictureUpright) {
    // A smooth pattern on the plane, photographed and rectified, at its own scale and at a much coarser one.
    const Homography h = tilted_view(), inverse = glm::inverse(h);
    const auto pattern = [](const dvec2& mm) {
        return Rgb(static_cast<float>(0.5 + 0.3 * std::sin(mm.x / 12)),
                   static_cast<float>(0.5 + 0.3 * std::cos(mm.y / 9)), static_cast<float>(0.5 + mm.x / 400));
    };
    Image<Rgb> picture(800, 600);
    for (int y = 0; y < 600; ++y)
        for (int x = 0; x < 800; ++x) picture(x, y) = pattern(mapped(inverse, dvec2(x, y)));
    for (const double scale : {0.0, 2.0}) {
        const Rectification r = rectification(corners_of(h, 200, 150), 200, 150, scale);
        const Image<Rgb> upright = rectified(picture, r);
        double worst = 0;
        for (int y = 2; y < r.height - 2; ++y)
            for (int x = 2; x < r.width - 2; ++x) {
                const dvec2 mm((x - (r.width - 1) / 2.0) * r.mm_per_pixel,
                               -(y - (r.height - 1) / 2.0) * r.mm_per_pixel);
                worst = std::max(worst, double(glm::length(upright(x, y) - pattern(mm))));
            }
        EXPECT_LT(worst, scale > 0 ? 0.01 : 0.003) << scale;
    }
}

TEST(DataScale, OfHandheldIsRightToThreeInAThousand) {
    TP_DATA(folder, "handheld");
    constexpr double kTruth = 0.42613636363636365;  // meta.json, at z = 0
    const auto props = read_json(bytes_of(folder / "gt/props.json"), "JSON");
    const auto point = [](const nlohmann::json& j) { return dvec2(j[0].get<double>(), j[1].get<double>()); };
    const auto& bar = props["scale_bar"];
    const Scale by_bar =
        at_plane(scale_from_bar(point(bar["px_ref"][0]), point(bar["px_ref"][1]), 100), 0.02, 600);
    EXPECT_NEAR(by_bar.mm_per_pixel / kTruth, 1, 3e-3);
    const auto& c = props["painting_corners_px_ref_tl_tr_br_bl"];
    const Scale by_corners =
        scale_from_corners({point(c[0]), point(c[1]), point(c[2]), point(c[3])}, 200, 200);
    EXPECT_NEAR(by_corners.mm_per_pixel / kTruth, 1, 3e-3);
    // Patches 1 and 2, 1 and 7: the pitch along the rows and across them.
    const auto middle = [&](std::size_t i) {
        const auto& p = props["chart"][i];
        return dvec2((p["x0"].get<double>() + p["x1"].get<double>()) / 2,
                     (p["y0"].get<double>() + p["y1"].get<double>()) / 2);
    };
    const dvec2 pitch(glm::length(middle(1) - middle(0)), glm::length(middle(6) - middle(0)));
    double worst = 0, sum = 0;
    for (int i = 0; i < 24; ++i) {
        const auto chart = find_chart(read_picture(folder / fmt::format("png16/img_{:03}.png", i)));
        ASSERT_TRUE(chart) << i;
        const Scale by_chart = at_plane(scale_from_chart(*chart, pitch), 0.02, 600);
        const double off = by_chart.mm_per_pixel / kTruth - 1;
        worst = std::max(worst, std::abs(off));
        sum += off / 24;
        EXPECT_LT(std::abs(off), 4 * by_chart.sigma / by_chart.mm_per_pixel) << i;
    }
    fmt::print("scale of handheld: bar {:+.4f} %, chart {:+.4f} % on average, {:.4f} % at worst\n",
               100 * (by_bar.mm_per_pixel / kTruth - 1), 100 * sum, 100 * worst);
    EXPECT_LT(worst, 3e-3);
}

}  // namespace
}  // namespace tangi
