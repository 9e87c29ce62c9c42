// Colour charts: found whatever their place, turn and light; and nothing else taken for one.
#include "capture/colour_chart/colour_chart.h"

#include <gmock/gmock.h>

#include "surface/base/json_reading.h"
#include "tests/support/capture/chart_pictures.h"

namespace tangi {
namespace {

using glm::dvec2;
using testing::HasSubstr;

double farthest(const ChartCorners& a, const ChartCorners& b) {
    double most = 0;
    for (std::size_t i = 0; i < 4; ++i) most = std::max(most, glm::length(a[i] - b[i]));
    return most;
}

Image<Rgb> picture_of(const ChartCorners& corners, std::uint64_t seed = 1) {
    Image<Rgb> picture = busy_background(420, 320, seed);
    draw_chart(picture, chart_map(corners), classic_chart());
    return picture;
}

TEST(ColourChart, IsFoundWhateverItsTurnAndTilt) {
    for (const double turn : {0.0, 90.0, 180.0, 270.0, 20.0, 45.0, 137.0, 300.0})
        for (const double tilt : {0.0, 0.35}) {
            const ChartCorners truth = turned_corners({210, 160}, 200, turn, tilt);
            Image<Rgb> picture = picture_of(truth);
            add_noise(picture, 0.02, 0.002, 7);
            const auto found = find_chart(picture);
            ASSERT_TRUE(found) << turn << " " << tilt;
            EXPECT_LT(farthest(chart_corners(*found), truth), 0.8) << turn << " " << tilt;
            EXPECT_LT(found->misfit, 0.05);
            EXPECT_THAT(found->warnings, testing::IsEmpty());
            EXPECT_EQ(read_chart(picture, *found).good(), 24) << turn << " " << tilt;
        }
}

TEST(ColourChart, IsFoundInLargePicturesAndSmall) {
    for (const double scale : {0.6, 2.5, 8.0}) {
        const ChartCorners truth = turned_corners(scale * dvec2(160, 120), scale * 200, 12);
        Image<Rgb> picture(static_cast<int>(320 * scale), static_cast<int>(240 * scale),
                           Rgb(0.2f, 0.15f, 0.1f));
        draw_chart(picture, chart_map(truth), classic_chart());
        const auto found = find_chart(picture);
        ASSERT_TRUE(found) << scale;
        EXPECT_LT(farthest(chart_corners(*found), truth), 0.6 * std::max(1.0, scale / 2)) << scale;
    }
}

TEST(ColourChart, IsFoundInUnevenLight) {
    const ChartCorners truth = turned_corners({210, 160}, 200, 90);
    Image<Rgb> picture = picture_of(truth);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x)
            picture(x, y) *= 0.2f + 0.8f * static_cast<float>(x + y) / 740;
    const auto found = find_chart(picture);
    ASSERT_TRUE(found);
    EXPECT_LT(farthest(chart_corners(*found), truth), 0.8);
}

TEST(ColourChart, IsNotFoundWhereThereIsNone) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        EXPECT_FALSE(find_chart(busy_background(420, 320, seed))) << seed;
    EXPECT_FALSE(find_chart(Image<Rgb>(300, 200, Rgb(0.5f))));
    EXPECT_FALSE(find_chart(Image<Rgb>(300, 200, Rgb(0))));
    EXPECT_FALSE(find_chart(Image<Rgb>(3, 2, Rgb(0.5f))));
}

TEST(ColourChart, IsNotAnyGridOfColours) {
    Random random(3);
    for (int trial = 0; trial < 10; ++trial) {
        ChartReference shuffled = classic_chart();
        for (std::size_t i = 23; i > 0; --i)
            std::swap(shuffled.patches[i],
                      shuffled.patches[static_cast<std::size_t>(random.below(static_cast<int>(i) + 1))]);
        Image<Rgb> picture = busy_background(420, 320, 1);
        draw_chart(picture, chart_map(turned_corners({210, 160}, 200, 10)), shuffled);
        EXPECT_FALSE(find_chart(picture)) << trial;
    }
}

TEST(ColourChart, IsNotFoundMirrored) {
    ChartCorners corners = turned_corners({210, 160}, 200, 0);
    std::swap(corners[0], corners[1]);
    std::swap(corners[2], corners[3]);
    EXPECT_FALSE(find_chart(picture_of(corners)));
}

TEST(ColourChart, OfWhichThereAreTwoIsWarnedOf) {
    Image<Rgb> picture = busy_background(500, 320, 1);
    draw_chart(picture, chart_map(turned_corners({120, 160}, 160, 90)), classic_chart());
    draw_chart(picture, chart_map(turned_corners({360, 170}, 180, 5)), classic_chart());
    const auto found = find_chart(picture);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->warnings.size(), 1u);
    EXPECT_THAT(found->warnings[0], HasSubstr("several colour charts"));
    EXPECT_THAT(found->warnings[0], HasSubstr("(120, 160)"));
    EXPECT_THAT(found->warnings[0], HasSubstr("(360, 170)"));
}

TEST(ColourChart, PartlyInShadowIsFound) {
    const ChartCorners truth = turned_corners({210, 160}, 200, 0);
    Image<Rgb> picture = picture_of(truth);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < 162; ++x) picture(x, y) *= 0.1f;  // the first column and a part of the second
    const auto found = find_chart(picture);
    ASSERT_TRUE(found);
    EXPECT_LT(farthest(chart_corners(*found), truth), 0.8);
    const ChartReading reading = read_chart(picture, *found, "a.png");
    for (const std::size_t i : {1, 7, 13, 19}) EXPECT_EQ(reading.patches[i].state, PatchState::uneven) << i;
    ASSERT_EQ(reading.warnings.size(), 1u);
    EXPECT_THAT(reading.warnings[0],
                HasSubstr("a.png: the chart's patch 2, 8, 14, 20 has the edge of a shadow"));
}

TEST(ColourChart, GivenByItsCornersMayBeginAnywhere) {
    const ChartCorners truth = turned_corners({210, 160}, 200, 200, 0.2);
    const Image<Rgb> picture = picture_of(truth);
    for (std::size_t first = 0; first < 4; ++first) {
        ChartCorners given;
        for (std::size_t i = 0; i < 4; ++i) given[i] = truth[(i + first) % 4];
        const FoundChart chart = chart_at(picture, given);
        EXPECT_LT(farthest(chart_corners(chart), truth), 1e-3) << first;
        EXPECT_THAT(chart.warnings, testing::IsEmpty());
    }
}

TEST(ColourChart, GivenWhereThereIsNoneIsWarnedOf) {
    const FoundChart chart = chart_at(busy_background(420, 320, 1), turned_corners({210, 160}, 200, 0));
    ASSERT_EQ(chart.warnings.size(), 1u);
    EXPECT_THAT(chart.warnings[0], HasSubstr("does not have the colours of the classic chart"));
}

TEST(ColourChart, GivenByImpossibleCornersIsAnError) {
    const Image<Rgb> picture(420, 320, Rgb(0.2f));
    const auto error = [&](const ChartCorners& c) { return error_of([&] { chart_at(picture, c); }); };
    EXPECT_THAT(
        error({dvec2(10, 10), dvec2(500, 10), dvec2(400, 300), dvec2(10, 300)}),
        HasSubstr("corner 2 of the chart, (500.0, 10.0), lies outside the picture of 420 x 320 pixels"));
    EXPECT_THAT(error({dvec2(10, 10), dvec2(400, 300), dvec2(400, 10), dvec2(10, 300)}), HasSubstr("cross"));
    EXPECT_THAT(error({dvec2(10, 10), dvec2(10, 300), dvec2(400, 300), dvec2(400, 10)}),
                HasSubstr("anticlockwise"));
    EXPECT_THAT(error({dvec2(10, 10), dvec2(200, 10), dvec2(400, 10), dvec2(200, 12)}),
                HasSubstr("on a line"));
}

TEST(ColourChart, ReadsMeansWithTheirStandardErrors) {
    const ChartCorners truth = turned_corners({210, 160}, 260, 3);
    const Image<Rgb> clean = picture_of(truth);
    const FoundChart chart = chart_at(clean, truth);
    const double noise = 0.01;
    std::vector<double> offs;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        Image<Rgb> picture = clean;
        add_noise(picture, 0, noise, seed);
        const ChartReading reading = read_chart(picture, chart);
        for (std::size_t i = 0; i < 24; ++i) {
            const PatchReading& p = reading.patches[i];
            ASSERT_GT(p.pixels, 300);
            EXPECT_NEAR(p.sigma.g, noise / std::sqrt(p.pixels), 0.25 * noise / std::sqrt(p.pixels));
            const glm::dvec3 value = kTestCamera * glm::dvec3(classic_chart().patches[i].linear);
            offs.push_back((p.mean.g - value.g) / p.sigma.g);
        }
    }
    double square = 0;
    for (const double off : offs) square += off * off / static_cast<double>(offs.size());
    EXPECT_NEAR(std::sqrt(square), 1, 0.2);
}

TEST(ColourChart, IsNotReadWhereItIsClippedOrOutside) {
    const ChartCorners truth = turned_corners({210, 160}, 260, 0);
    Image<Rgb> picture = picture_of(truth);
    const FoundChart chart = chart_at(picture, truth);
    for (int y = 0; y < 320; ++y)
        for (int x = 0; x < 420; ++x) picture(x, y) = glm::min(picture(x, y) * 1.2f, Rgb(1));
    const ChartReading bright = read_chart(picture, chart, "b.png");
    EXPECT_EQ(bright.patches[18].state, PatchState::clipped);
    EXPECT_EQ(bright.good(), 23);
    EXPECT_THAT(bright.warnings, testing::ElementsAre(HasSubstr("b.png: the chart's patch 19 is clipped")));

    Image<Rgb> part(300, 320);  // the last column is cut
    for (int y = 0; y < 320; ++y)
        for (int x = 0; x < 300; ++x) part(x, y) = 0.5f * picture(x, y);
    const ChartReading cut = read_chart(part, chart);
    EXPECT_EQ(cut.good(), 20);
    EXPECT_THAT(cut.warnings,
                testing::ElementsAre(HasSubstr("patch 6, 12, 18, 24 is not wholly in the picture")));
}

TEST(ColourChart, IsReadPastDustAndHotPixels) {
    const ChartCorners truth = turned_corners({210, 160}, 260, 0);
    Image<Rgb> picture = picture_of(truth);
    add_noise(picture, 0.01, 0.001, 2);
    const FoundChart chart = chart_at(picture, truth);
    const Rgb before = read_chart(picture, chart).patches[22].mean;
    const dvec2 middle = mapped(chart.chart_to_picture, {4.5, 3.5});
    picture(static_cast<int>(middle.x), static_cast<int>(middle.y)) = Rgb(0.9f);
    picture(static_cast<int>(middle.x) + 3, static_cast<int>(middle.y)) = Rgb(0);
    EXPECT_NEAR(read_chart(picture, chart).patches[22].mean.g, before.g, 2e-3 * before.g);
}

TEST(ChartReferenceFile, IsReadFromCsvAndJson) {
    const TestDir dir;
    std::string lab = "name,L,a,b\n", linear = "name,R,G,B\r\n", list;
    const ChartReference classic = classic_chart();
    for (int i = 0; i < 24; ++i) {
        lab += fmt::format("patch {},{},{},{}\n", i + 1, 10 + i, i, -i);
        const Rgb c = classic.patches[static_cast<std::size_t>(i)].linear;
        linear += fmt::format("\"p {}\", {:.9g}, {:.9g}, {:.9g}\r\n", i + 1, c.r, c.g, c.b);
        // In reverse order, with numbers.
        const Rgb d = classic.patches[static_cast<std::size_t>(23 - i)].linear;
        list += fmt::format("{}{{\"n\": {}, \"name\": \"x\", \"linear_srgb\": [{}, {}, {}]}}", i ? "," : "",
                            24 - i, d.r, d.g, d.b);
    }
    write_bytes(dir / "lab.csv", lab);
    write_bytes(dir / "linear.csv", linear);
    write_bytes(dir / "list.json", "[" + list + "]");
    EXPECT_EQ(read_chart_reference(dir / "lab.csv").patches[3].name, "patch 4");
    EXPECT_EQ(read_chart_reference(dir / "lab.csv").patches[3].linear, linear_from_lab_d50({13, 3, -3}));
    EXPECT_EQ(read_chart_reference(dir / "linear.csv").patches[0].name, "p 1");
    for (std::size_t i = 0; i < 24; ++i) {
        EXPECT_EQ(read_chart_reference(dir / "linear.csv").patches[i].linear, classic.patches[i].linear);
        EXPECT_LT(glm::length(read_chart_reference(dir / "list.json").patches[i].linear -
                              classic.patches[i].linear),
                  1e-6);
    }
}

TEST(ChartReferenceFile, ThatIsWrongIsAnErrorWithThePlace) {
    const TestDir dir;
    const auto error = [&](const std::string& name, const std::string& text) {
        write_bytes(dir / name, text);
        return error_of([&] { read_chart_reference(dir / name); });
    };
    EXPECT_THAT(error("a.csv", "L,a,b\n"), HasSubstr("a.csv:1: begins with 'L,a,b'; the first line must be"));
    EXPECT_THAT(error("b.csv", "name,L,a,b\nx,1,2\n"), HasSubstr("b.csv:2: has 3 fields"));
    EXPECT_THAT(error("c.csv", "name,L,a,b\nx,1,two,3\n"), HasSubstr("c.csv:2: 'two' is not a number"));
    EXPECT_THAT(error("d.csv", "name,L,a,b\nx,50,2,3\n"),
                HasSubstr("d.csv: ends after 1 patches; the chart has 24"));
    EXPECT_THAT(error("e.csv", "name,R,G,B\nx,50,40,30\n"),
                HasSubstr("e.csv:2: (50, 40, 30) is no linear reflectance"));
    EXPECT_THAT(error("f.json", "[{\"name\": 1}]"), HasSubstr("f.json: is not a JSON list of 24 patches"));
    EXPECT_THAT(error("g.txt", ""), HasSubstr("are read from .csv or .json"));
    EXPECT_THAT(error_of([&] { read_chart_reference(dir / "none.csv"); }),
                HasSubstr("none.csv: cannot be read"));
    std::string list;
    for (int i = 0; i < 24; ++i) list += fmt::format("{}{{\"name\": \"x\"}}", i ? "," : "");
    EXPECT_THAT(error("h.json", "[" + list + "]"), HasSubstr("patch 1: has neither linear_srgb nor lab_d50"));
}

TEST(ChartReference, OfTheClassicChartIsNearItsPublishedSrgb) {
    // sRGB of the same edition, as published with it: dark skin 115 82 68, blue 56 61 150, white 243 243 242.
    const auto near = [](std::size_t i, double r, double g, double b) {
        const Rgb c = Transfer{Transfer::Kind::srgb}.encode(classic_chart().patches[i].linear) * 255.0f;
        EXPECT_NEAR(c.r, r, 3) << i;
        EXPECT_NEAR(c.g, g, 3) << i;
        EXPECT_NEAR(c.b, b, 3) << i;
    };
    near(0, 115, 82, 68);
    near(21, 122, 122, 121);
    near(18, 243, 243, 242);
}

TEST(DataColourChart, IsFoundInAllHandheldPhotographs) {
    TP_DATA(folder, "handheld");
    const auto props = read_json(bytes_of(folder / "gt/props.json"), "JSON");
    const auto cameras = read_json(bytes_of(folder / "gt/cameras.json"), "JSON");
    const auto corner = [&](std::size_t patch, std::size_t which) {
        const auto& c = props["chart"][patch]["px_ref_corners_tl_tr_br_bl"][which];
        return dvec2(c[0].get<double>(), c[1].get<double>());
    };
    // The chart lies turned: patches 1 to 6 run down its right side in the picture.
    const ChartCorners reference = {corner(0, 1), corner(5, 2), corner(23, 3), corner(18, 0)};
    double worst = 0;
    for (std::size_t i = 0; i < 24; ++i) {
        Homography to_reference;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                to_reference[column][row] =
                    cameras[i]["H_image_to_reference_z0"][static_cast<std::size_t>(row)]
                           [static_cast<std::size_t>(column)];
        ChartCorners truth;
        for (std::size_t k = 0; k < 4; ++k) truth[k] = mapped(glm::inverse(to_reference), reference[k]);
        const auto found = find_chart(read_picture(folder / fmt::format("png16/img_{:03}.png", i)));
        ASSERT_TRUE(found) << i;
        worst = std::max(worst, farthest(chart_corners(*found), truth));
        EXPECT_LT(farthest(chart_corners(*found), truth), 0.8) << i;
        EXPECT_LT(found->misfit, 0.03) << i;
        EXPECT_THAT(found->warnings, testing::IsEmpty()) << i;
    }
    fmt::print("chart of handheld: corners within {:.2f} pixels\n", worst);
}

}  // namespace
}  // namespace tangi
