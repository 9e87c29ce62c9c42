// make_mosaic_test.cpp: positions of a known painting become the painting again, and what cannot be joined is
// named.
#include "fit/mosaic/make_mosaic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "fit/mosaic/mosaic_report.h"
#include "surface/maps/surface_part.h"
#include "surface/provenance/fit_doubts.h"
#include "tests/fit/mosaic/mosaic_support.h"

namespace tangi {
namespace {

using glm::dvec2;
using testing::HasSubstr;

const MosaicScene& wall_scene() {
    static const MosaicScene scene = mosaic_scene(small_wall(), {});
    return scene;
}
const Mosaic& wall_mosaic() {
    static const Mosaic mosaic = make_mosaic(wall_scene().positions);
    return mosaic;
}

// Turned by 180 degrees in its plane.
Surface turned(const Surface& s) {
    Surface t = s;
    std::ranges::reverse(t.normal.pixels());
    std::ranges::reverse(t.diffuse.pixels());
    std::ranges::reverse(t.specular.pixels());
    std::ranges::reverse(t.roughness.pixels());
    std::ranges::reverse(t.confidence.pixels());
    std::ranges::reverse(t.height_mm.pixels());
    for (Vec3& n : t.normal.pixels()) n.x = -n.x, n.y = -n.y;
    return t;
}

Surface whole_of(const MosaicPosition& position) { return position.read(position.region()).surface; }

TEST(MakeMosaic, PlacesPositionsToAThirdOfAPixel) {
    const Mosaic& m = wall_mosaic();
    EXPECT_LT(placement_rms(wall_scene(), m.report), 0.3);
    EXPECT_LT(m.report.layout.rms_px, 0.3);
    EXPECT_TRUE(m.report.left_out.empty());
    EXPECT_THAT(m.report.poor, testing::IsEmpty());
    for (const PlacedPosition& p : m.report.layout.positions) EXPECT_TRUE(p.joined);
}

TEST(MakeMosaic, BringsReflectanceToOneScale) {
    const MosaicScene& scene = wall_scene();
    const MosaicScales& scales = wall_mosaic().report.scales;
    for (std::size_t i = 1; i < scene.cameras.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double gain = scales.positions[i].diffuse[c] * scene.cameras[i].exposure,
                         first = scales.positions[0].diffuse[c] * scene.cameras[0].exposure;
            EXPECT_NEAR(gain / first, 1, 0.005) << scene.cameras[i].name;
        }
}

// The wall's frame is its own mean plane, so turns of cameras are known against each other.
TEST(MakeMosaic, BringsSlopesToOneFrame) {
    const MosaicScene& scene = wall_scene();
    const MosaicScales& scales = wall_mosaic().report.scales;
    const auto wall_up = [&](std::size_t i) {
        return scales.positions[i].frame * scene.cameras[i].view.rotation[2];  // the painting's z
    };
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const double apart =
            std::acos(std::min(glm::dot(wall_up(i), wall_up(0)), 1.0)) * 180 / std::numbers::pi;
        EXPECT_LT(apart, 0.1) << scene.cameras[i].name;
        EXPECT_GT(wall_up(i).z, std::cos(0.3 * std::numbers::pi / 180)) << scene.cameras[i].name;
    }
}

// What resampling and blending cost where the fits are perfect.
TEST(MakeMosaic, HasTheNormalsAndColoursOfThePainting) {
    const Mosaic& m = wall_mosaic();
    const MosaicScene& scene = wall_scene();
    double angle = 0, colour = 0, count = 0;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const Surface truth = truth_of(scene, m.report, i);
        const Rgb gain = m.report.scales.positions[i].diffuse * static_cast<float>(scene.cameras[i].exposure);
        for (int y = 2; y < truth.height() - 2; ++y)
            for (int x = 2; x < truth.width() - 2; ++x) {
                if (!(m.surface.confidence(x, y) > 0) || !(truth.confidence(x, y) > 0)) continue;
                if (shown_by(scene, m.report, {x, y}) != i) continue;
                angle += std::acos(std::min(glm::dot(m.surface.normal(x, y), truth.normal(x, y)), 1.0f));
                colour += delta_e_2000(lab_from_linear(glm::dvec3(m.surface.diffuse(x, y))),
                                       lab_from_linear(glm::dvec3(gain * truth.diffuse(x, y))));
                ++count;
            }
    }
    ASSERT_GT(count, 0.8 * static_cast<double>(m.surface.height_mm.size()));
    EXPECT_LT(angle / count * 180 / std::numbers::pi, 1.5);
    EXPECT_LT(colour / count, 1);
}

TEST(MakeMosaic, HasNoStepsAtSeams) {
    const MosaicReport& report = wall_mosaic().report;
    ASSERT_GE(report.seams.size(), 5u);
    for (const SeamSteps& seam : report.seams) {
        EXPECT_LT(seam.delta_e_2000, 0.5);
        EXPECT_LT(seam.height_rms, 0.2);  // [pixels]
    }
}

TEST(MakeMosaic, SaysAllOfItInJsonAndOnAPage) {
    const Mosaic& m = wall_mosaic();
    const std::vector<MosaicPosition>& positions = wall_scene().positions;
    const nlohmann::json json = to_json(positions, m.report);
    EXPECT_EQ(json["positions"].size(), 6u);
    EXPECT_EQ(json["width"], m.surface.width());
    EXPECT_GT(json["overlaps"].size(), 6u);
    EXPECT_EQ(json["overlaps"][0]["first"], "r0_c0");
    const std::string page = mosaic_page(positions, m.report, {}, "a <wall>");
    EXPECT_THAT(page, HasSubstr("a &lt;wall&gt;"));
    EXPECT_THAT(page, HasSubstr("<polygon"));
    EXPECT_THAT(page, HasSubstr("r1_c2"));
}

TEST(MakeMosaic, JoinsAPositionThatIsUpsideDown) {
    const MosaicScene& scene = wall_scene();
    std::vector<MosaicPosition> positions = scene.positions;
    positions[1] = position_of("upside_down", turned(whole_of(positions[1])));
    const Mosaic m = make_mosaic(positions);
    EXPECT_NEAR(std::abs(m.report.layout.positions[1].turn_rad), std::numbers::pi, 0.05);
    EXPECT_THAT(m.report.poor, testing::IsEmpty());
    for (const SeamSteps& seam : m.report.seams) EXPECT_LT(seam.height_rms, 0.2);
}

TEST(MakeMosaic, JoinsAPositionOfAnotherSize) {
    const MosaicScene& scene = wall_scene();
    CameraPosition nearer = scene.cameras[1];
    nearer.view.to_mm = nearer.view.to_mm * Homography(1 / 1.3, 0, 0, 0, 1 / 1.3, 0, 0, 0, 1);
    nearer.view.width = static_cast<int>(nearer.view.width * 1.3);
    nearer.view.height = static_cast<int>(nearer.view.height * 1.3);
    nearer.view.mm_per_pixel /= 1.3;
    const std::vector<MosaicPosition> positions = {scene.positions[0],
                                                   position_of("nearer", seen_by(nearer, scene.painting))};
    const Mosaic m = make_mosaic(positions);
    EXPECT_NEAR(m.report.layout.positions[1].pixel, 1 / 1.3, 0.02);
    EXPECT_THAT(m.report.poor, testing::IsEmpty());
}

TEST(MakeMosaic, SaysWhichScaleIsWrong) {
    const MosaicScene& scene = wall_scene();
    Surface wrong = whole_of(scene.positions[1]);
    wrong.mm_per_pixel *= 1.5;
    const std::string stated = fmt::format("wrong: states {:.4g} mm", wrong.mm_per_pixel);
    const Mosaic m = make_mosaic({scene.positions[0], position_of("wrong", std::move(wrong))});
    EXPECT_THAT(m.report.poor, testing::Contains(HasSubstr(stated)));
}

TEST(MakeMosaic, IsPoorWhereAPositionIs) {
    const MosaicScene& scene = wall_scene();
    Surface doubtful = whole_of(scene.positions[1]);
    doubtful.provenance = with_doubts("", {"its lights are nominal"}, {"it is dark"});
    doubtful.photography.white_level = 0.5;
    const Mosaic m = make_mosaic({position_of("doubtful", std::move(doubtful)), scene.positions[0]});
    EXPECT_THAT(m.report.poor, testing::ElementsAre("doubtful: its fit is poor: its lights are nominal"));
    EXPECT_EQ(m.surface.photography.white_level, 0.5);
}

TEST(MakeMosaic, LeavesOutThatWhichIsThereTwice) {
    const MosaicScene& scene = wall_scene();
    MosaicPosition again = scene.positions[1];
    again.name = "again";
    const Mosaic m = make_mosaic({scene.positions[0], scene.positions[1], again});
    ASSERT_EQ(m.report.left_out.size(), 1u);
    EXPECT_EQ(m.report.left_out[0].position, 2u);
    EXPECT_THAT(m.report.left_out[0].why, HasSubstr("the same as r0_c1"));
    EXPECT_THAT(m.report.poor, testing::Contains(HasSubstr("again: is left out")));
}

TEST(MakeMosaic, LeavesOutThatWhichOverlapsNothing) {
    const MosaicScene& scene = wall_scene();
    PaintingOptions other = scene.painting;
    other.seed = 77;
    const MosaicPosition stranger = position_of("stranger", seen_by(scene.cameras[2], other));
    const Mosaic m = make_mosaic({scene.positions[0], scene.positions[1], stranger});
    ASSERT_EQ(m.report.left_out.size(), 1u);
    EXPECT_THAT(m.report.left_out[0].why, HasSubstr("overlaps no other"));
    EXPECT_THAT(m.report.left_out[0].why, HasSubstr("leave it out"));
}

TEST(MakeMosaic, RefusesWhereNothingCanBeJoined) {
    const MosaicScene& scene = wall_scene();
    const auto refusal = [](const std::vector<MosaicPosition>& positions) {
        try {
            make_mosaic(positions);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_THAT(refusal({scene.positions[0], scene.positions[2]}),
                HasSubstr("nothing can be joined to r0_c0"));
    MosaicPosition again = scene.positions[0];
    again.name = "again";
    EXPECT_THAT(refusal({scene.positions[0], again}), HasSubstr("that are not the same"));
    EXPECT_THAT(refusal({scene.positions[0]}), HasSubstr("two positions or more"));
}

}  // namespace
}  // namespace tangi
