// picture_geometry_test.cpp: places through lens and rectification, and stacks that are read so.
#include "capture/formats/picture_geometry.h"

#include <gmock/gmock.h>

#include <glm/matrix.hpp>

#include "capture/stack/stack.h"
#include "surface/base/json_reading.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using glm::dvec2;
using nlohmann::json;
using testing::HasSubstr;

const Lens kLens{200, 150, {180, 182}, {101, 73}, {-0.21, 0.06, 0.0012, -0.0008, -0.004}};

// Slowly varying, so that resampling is nearly exact.
double light_at(const dvec2& p) { return 0.5 + 0.2 * std::sin(0.11 * p.x) + 0.2 * std::cos(0.09 * p.y); }

TEST(PictureGeometry, TheLensIsOpenCvs) {
    const std::vector<std::vector<double>> models = {
        {-0.21, 0.06, 0.0012, -0.0008},
        kLens.distortion,
        {-0.2, 0.05, 0.001, -0.001, 0.01, 0.02, -0.03, 0.01},
        {-0.2, 0.05, 0.001, -0.001, 0.01, 0.02, -0.03, 0.01, 0.003, -0.002, 0.001, 0.004},
        {-0.2, 0.05, 0.001, -0.001, 0.01, 0.02, -0.03, 0.01, 0.003, -0.002, 0.001, 0.004, 0.02, -0.03}};
    for (const auto& model : models) {
        Lens lens = kLens;
        lens.distortion = model;
        const Image<glm::vec2> map = undistortion_map(lens, 200, 150);
        for (int y = 0; y < 150; y += 7)
            for (int x = 0; x < 200; x += 9) {
                const dvec2 ours = distorted(lens, {x, y});
                EXPECT_NEAR(ours.x, map(x, y).x, 1e-4) << model.size();
                EXPECT_NEAR(ours.y, map(x, y).y, 1e-4) << model.size();
            }
    }
}

PictureGeometry example() {
    PictureGeometry g{.photo_width = 200, .photo_height = 150, .width = 120, .height = 90, .lens = kLens};
    g.rectification = Homography(1.1, 0.08, 2e-4, -0.05, 1.2, 1e-4, 30, 15, 1);
    g.mm_per_pixel = 0.4;
    g.turn = glm::dmat3(0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8);
    g.camera_mm = {10, -20, 500};
    return g;
}

TEST(PictureGeometry, ThereAndBackIsTheSamePlace) {
    const PictureGeometry g = example();
    for (const dvec2 p : {dvec2(0, 0), dvec2(119, 0), dvec2(60.3, 44.2), dvec2(0, 89), dvec2(119, 89)}) {
        const dvec2 back = g.place_in_picture(g.place_in_photo(p));
        EXPECT_NEAR(back.x, p.x, 1e-4);
        EXPECT_NEAR(back.y, p.y, 1e-4);
    }
}

TEST(PictureGeometry, RoundTripsThroughText) {
    const PictureGeometry g = example(), back = geometry_from_json(read_json(to_json(g).dump(), "JSON"));
    EXPECT_EQ(back.place_in_photo({17, 33}), g.place_in_photo({17, 33}));
    EXPECT_EQ(back.width, 120);
    EXPECT_EQ(back.photo_height, 150);
    EXPECT_EQ(back.turn, g.turn);
    EXPECT_EQ(back.camera_mm, g.camera_mm);
    EXPECT_EQ(back.mm_per_pixel, g.mm_per_pixel);
    const auto refusal = [&](const char* pointer, const json& value) {
        json j = to_json(g);
        j[json::json_pointer(pointer)] = value;
        return error_of([&] { (void)geometry_from_json(j); });
    };
    EXPECT_THAT(refusal("/turn/0/0", 0.9), HasSubstr("no rotation"));
    EXPECT_THAT(refusal("/picture_px/0", 0), HasSubstr("0 pixels"));
    EXPECT_THAT(refusal("/camera_mm/2", -5), HasSubstr("below the painting"));
    EXPECT_THAT(refusal("/mm_per_pixel", 0), HasSubstr("mm_per_pixel"));
    EXPECT_THAT(refusal("/rectification", {{1, 0, 0}, {1, 0, 0}, {0, 0, 1}}), HasSubstr("no inverse"));
}

// Photographs through a lens, from aside and, one of them, from elsewhere; all are read as one picture.
TEST(PictureGeometry, StacksAreReadThroughRegistrationRectificationAndLens) {
    const TestDir dir;
    Stack stack;
    stack.geometry = example();
    stack.crop = {10, 5, 110, 85};
    const Homography moved(1, 0.01, 0, -0.01, 1, 0, 1.3, -0.7, 1);
    for (int i = 0; i < 2; ++i) {
        Image<Rgb> photo(200, 150);
        PictureGeometry seen = *stack.geometry;
        if (i == 1) seen.rectification = *seen.rectification * moved;
        for (int y = 0; y < 150; ++y)
            for (int x = 0; x < 200; ++x)
                photo(x, y) = Rgb(static_cast<float>(light_at(
                    i == 0 ? seen.place_in_picture({x, y})
                           : mapped(glm::inverse(moved), stack.geometry->place_in_picture({x, y})))));
        const auto path = dir / fmt::format("{}.png", i);
        write_picture(path, photo, Transfer{});
        stack.photos.push_back({path, distant_light({0, 0, 1}), i, {}, {}});
    }
    stack.photos[1].homography = moved;
    stack.bits = 16;
    double worst = 0;
    StackReader reader(stack);
    for (int y0 = 0; y0 < stack.height(); y0 += 13) {
        const Band band = reader.read(y0, std::min(y0 + 13, stack.height()), Transfer{});
        for (int i = 0; i < 2; ++i)
            for (int y = band.y0(); y < band.y1(); ++y)
                for (int x = 0; x < band.width(); ++x)
                    worst = std::max(worst, std::abs(band.row(i, 1, y)[x] - light_at({x + 10, y + 5})));
    }
    EXPECT_LT(worst, 2e-3);
}

TEST(PictureGeometry, WhatThePhotographsDoNotShowIsNotANumber) {
    const TestDir dir;
    Stack stack;
    stack.geometry = PictureGeometry{.photo_width = 8, .photo_height = 6, .width = 10, .height = 6};
    stack.geometry->rectification = Homography(1, 0, 0, 0, 1, 0, -1, 0, 1);
    stack.crop = {0, 0, 10, 6};
    write_picture(dir / "a.png", Image<Rgb>(8, 6, Rgb(0.5f)), Transfer{});
    stack.photos = {{dir / "a.png", distant_light({0, 0, 1}), 0, {}, {}}};
    stack.bits = 16;
    const Band band = StackReader(stack).read(0, 6, Transfer{});
    for (int x = 0; x < 10; ++x) EXPECT_EQ(std::isnan(band.row(0, 0, 3)[x]), x == 0 || x == 9) << x;
}

}  // namespace
}  // namespace tangi
