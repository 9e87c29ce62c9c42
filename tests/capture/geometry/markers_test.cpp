// Markers: drawn by OpenCV's aruco module on a plane, seen in perspective, found again.
#include "capture/geometry/markers.h"

#include <gmock/gmock.h>

#include "tests/support/capture/marker_pictures.h"

namespace tangi {
namespace {

using glm::dvec2;
using testing::HasSubstr;

TEST(Markers, TellTheScaleOfTheirPlane) {
    for (const double tilt : {0.0, 0.25}) {
        const Homography h = view(tilt);
        const MarkerSearch search = find_markers(picture_of(kFour, cv::aruco::DICT_4X4_50, h));
        EXPECT_EQ(search.dictionary, "4x4_50");
        ASSERT_EQ(search.markers.size(), 4u);
        EXPECT_EQ(search.markers[2].id, 11);
        const MarkerPlane plane = marker_plane(search.markers, kSide_mm);
        const double truth = mm_per_pixel_at(h, plane.scale.place_px);
        EXPECT_NEAR(plane.scale.mm_per_pixel / truth, 1, 2e-3) << tilt;
        EXPECT_LT(std::abs(plane.scale.mm_per_pixel - truth), 4 * plane.scale.sigma);
        EXPECT_LT(plane.scale.sigma / truth, 3e-3);
        EXPECT_LT(plane.residual_px, 0.3);
        // Perspective too: the scale elsewhere, and the size of something else on the plane.
        for (const dvec2 mm : {dvec2(-60, 40), dvec2(60, -40)}) {
            const dvec2 px = mapped(h, mm);
            EXPECT_NEAR(mm_per_pixel_at(plane.plane_to_picture, px) / mm_per_pixel_at(h, px), 1, 4e-3)
                << tilt;
        }
        const Corners painting = {mapped(h, {-50, 40}), mapped(h, {50, 40}), mapped(h, {50, -40}),
                                  mapped(h, {-50, -40})};
        const dvec2 size = size_on_plane(plane, painting);
        EXPECT_NEAR(size.x, 100, 0.3);
        EXPECT_NEAR(size.y, 80, 0.3);
    }
}

TEST(Markers, OfExactCornersGiveTheExactPlane) {
    const Homography h = view(0.4);
    std::vector<Marker> markers;
    for (const Placed& p : kFour) {
        const double turn = p.turn_deg * std::numbers::pi / 180;
        Marker marker{p.id, {}};
        const dvec2 corners[4] = {{-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}};
        for (std::size_t k = 0; k < 4; ++k) {
            const dvec2 c = kSide_mm * corners[k];
            marker.corners_px[k] =
                mapped(h, p.middle_mm + dvec2(std::cos(turn) * c.x - std::sin(turn) * c.y,
                                              std::sin(turn) * c.x + std::cos(turn) * c.y));
        }
        markers.push_back(marker);
    }
    for (const std::size_t count : {1u, 4u}) {
        const MarkerPlane plane =
            marker_plane({markers.begin(), markers.begin() + static_cast<std::ptrdiff_t>(count)}, kSide_mm);
        EXPECT_NEAR(plane.scale.mm_per_pixel, mm_per_pixel_at(h, plane.scale.place_px), 1e-7);
        EXPECT_LT(plane.residual_px, 1e-6);
        EXPECT_GT(plane.scale.sigma, 0);
    }
    // More markers, farther apart, are more certain.
    EXPECT_LT(marker_plane(markers, kSide_mm).scale.sigma,
              0.6 * marker_plane({markers[0]}, kSide_mm).scale.sigma);
}

TEST(Markers, OfOtherDictionariesAreRecognised) {
    for (const auto& [number, name] :
         {std::pair(cv::aruco::DICT_6X6_250, "6x6_250"), std::pair(cv::aruco::DICT_5X5_100, "5x5_100"),
          std::pair(cv::aruco::DICT_APRILTAG_36h11, "apriltag_36h11")}) {
        std::vector<Placed> placed = kFour;
        placed[0].id = 80;  // which the smaller dictionaries do not have
        if (number == cv::aruco::DICT_6X6_250) placed[0].id = 180;
        const Image<Rgb> picture = picture_of(placed, number, view(0.1));
        const MarkerSearch search = find_markers(picture);
        EXPECT_EQ(search.dictionary, name);
        EXPECT_EQ(search.markers.size(), 4u) << name;
        EXPECT_EQ(find_markers(picture, std::string(name)).markers.size(), 4u);
    }
}

TEST(Markers, OfAnotherDictionaryThanTheOneAskedForAreNone) {
    const Image<Rgb> picture = picture_of(kFour, cv::aruco::DICT_5X5_50, view(0.1));
    EXPECT_TRUE(find_markers(picture, "4x4_50").markers.empty());
    EXPECT_THAT(error_of([&] { find_markers(picture, "9x9"); }),
                HasSubstr("'9x9' is no dictionary of markers; those known are 4x4_50"));
}

TEST(Markers, OfWhichOneIsThereTwiceAreWarnedOf) {
    std::vector<Placed> twins = kFour;
    twins[1].id = 3;
    const MarkerSearch search = find_markers(picture_of(twins, cv::aruco::DICT_4X4_50, view(0)), "4x4_50");
    EXPECT_EQ(search.markers.size(), 4u);
    EXPECT_THAT(search.warnings,
                testing::ElementsAre(HasSubstr("marker 3 of dictionary 4x4_50 is there more than once")));
}

TEST(Markers, AreNotFoundWhereThereAreNone) {
    const Image<Rgb> picture(300, 200, Rgb(0.4f));
    EXPECT_TRUE(find_markers(picture).markers.empty());
    EXPECT_EQ(find_markers(picture).dictionary, "");
    EXPECT_TRUE(find_markers(picture, "4x4_50").markers.empty());
    EXPECT_THAT(error_of([] { marker_plane({}, 20); }), HasSubstr("there is no marker"));
    EXPECT_THAT(error_of([] { marker_plane({{}}, 0); }), HasSubstr("side is 0 mm; give a positive"));
}

}  // namespace
}  // namespace tangi
