// photography_json_test.cpp: what is known of the photographs as JSON and back, and JSON that is not
// that.
#include "surface/maps/photography_json.h"
#include "surface/base/json_reading.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using nlohmann::json;

TEST(PhotographyJson, OfNothingIsEmptyAndBack) {
    const Photography none = photography_from_json(json::object());
    EXPECT_TRUE(none.photos.empty());
    EXPECT_EQ(none.white_level, 1);
    EXPECT_TRUE(photography_from_json(to_json(Photography{})).photos.empty());
}

TEST(PhotographyJson, RoundTripsThroughText) {
    Random random(1);
    Photography p;
    p.transfer = {Transfer::Kind::srgb};
    p.white_level = 0.7234567890123;
    for (int i = 0; i < 50; ++i) {
        Light light = i % 2 ? near_light(random.direction(0.1) * 777.0f, fmt::format("ä\\\"{}\n.jpg", i))
                            : distant_light(random.direction(0.1));
        light.gain = {random.real(0.1, 3), random.real(0.1, 3), random.real(0.1, 3)};
        p.photos.push_back({light, i % 3 != 0, {}});
        if (i % 5 == 2) p.photos.back().listed_direction = random.direction(0.1);
        if (i % 4 == 1)
            p.photos.back().homography = Homography(1, 0.1 / 3, 1e-7, -0.2, 1.1, 2e-7, 3.3, -4, 1);
    }
    const Photography back = photography_from_json(read_json(to_json(p).dump(), "JSON"));
    EXPECT_EQ(back.transfer, p.transfer);
    EXPECT_EQ(back.white_level, p.white_level);
    ASSERT_EQ(back.photos.size(), p.photos.size());
    for (std::size_t i = 0; i < p.photos.size(); ++i) {
        EXPECT_EQ(back.photos[i].light.name, p.photos[i].light.name);
        EXPECT_EQ(back.photos[i].light.direction, p.photos[i].light.direction);  // floats survive as doubles
        EXPECT_EQ(back.photos[i].light.position_mm, p.photos[i].light.position_mm);
        EXPECT_EQ(back.photos[i].light.gain, p.photos[i].light.gain);
        EXPECT_EQ(back.photos[i].fitted, p.photos[i].fitted);
        EXPECT_EQ(back.photos[i].homography, p.photos[i].homography);
        EXPECT_EQ(back.photos[i].listed_direction, p.photos[i].listed_direction);
    }
}

TEST(PhotographyJson, WithAnUnknownTransferIsAnError) {
    json j = to_json(Photography{});
    j["transfer"] = "rec709";
    EXPECT_EQ(error_of([&] { photography_from_json(j); }), "unknown transfer curve 'rec709'");
}

TEST(PhotographyJson, WithASurfaceAboveTheLightsIsAnError) {
    Photography p;
    p.rig = {.light_distance_mm = 70, .surface_above_mm = 70};
    EXPECT_THAT(error_of([&] { photography_from_json(to_json(p)); }),
                testing::HasSubstr("surface_above_mm = 70"));
}

TEST(PhotographyJson, WithAFieldMissingOrOfAnotherTypeThrows) {
    Photography one;
    one.photos = {{distant_light({0, 0, 1}, "a"), true}};
    for (const char* field : {"transfer", "white_level", "photos"}) {
        json j = to_json(one);
        j.erase(field);
        EXPECT_THROW(photography_from_json(j), json::exception) << field;
    }
    for (const char* field : {"name", "direction", "gain", "fitted"}) {
        json j = to_json(one);
        j["photos"][0].erase(field);
        EXPECT_THROW(photography_from_json(j), json::exception) << field;
        j["photos"][0][field] = json::object();
        EXPECT_THROW(photography_from_json(j), json::exception) << field;
    }
}

TEST(PhotographyJson, RoundTripsRigAndLights) {
    Photography p;
    p.photos.emplace_back().light.beam.terms = {0.5f, -0.25f, 0.125f, 0, 1e-3f};
    p.photos.back().fitted = true;
    p.beams = BeamModel{.radius_mm = 120.5};
    p.beams->terms[3] = {0.25, {{0.4, {-3}}}};
    p.directions = DirectionModel{{{{0.02, {}}, {-0.01, {{1.6, {0.5}}}}}}};
    p.rig = {.ambient = 0.0625f,
             .camera_distance_mm = 612.5f,
             .light_distance_mm = {},
             .surface_above_mm = 3.5f,
             .bend_per_mm = -1e-4f,
             .light_radius_deg = 2.5f};
    p.light_model = LightModel{{0.1, {{0.2, {0.5}}, {3.2, {-0.6}}}}};
    p.light_model->log_colours.emplace()[1] = {0.3, {{0.8, {1e-9}}}};
    const Photography back = photography_from_json(read_json(to_json(p).dump(), "JSON"));
    EXPECT_EQ(back.rig, p.rig);
    EXPECT_EQ(back.light_model, p.light_model);
    EXPECT_EQ(back.beams, p.beams);
    EXPECT_EQ(back.directions, p.directions);
    EXPECT_EQ(back.photos.at(0).light.beam, p.photos[0].light.beam);
}

// Files of version 0.1 say where each light is listed, and no more.
TEST(PhotographyJson, HasAModelOfDirectionsWhereTheyWereCorrected) {
    Photography p;
    for (const Light& light : dome_lights(12)) p.photos.push_back({light, true});
    EXPECT_FALSE(photography_from_json(to_json(p)).directions);
    for (Photography::Photo& photo : p.photos)
        photo.listed_direction = glm::normalize(photo.light.direction + Vec3(0.05f, 0, 0));
    const Photography back = photography_from_json(to_json(p));
    EXPECT_EQ(back.directions, fit_direction_model(directions_as_listed(p), fitted_lights(p)));
    const Vec3 found =
        predicted_direction(back.directions.value(), directions_as_listed(p), *p.photos[3].listed_direction);
    EXPECT_LT(glm::distance(found, p.photos[3].light.direction), 0.01f);
}

Photography with_strengths() {
    Photography p;
    for (const Light& light : dome_lights(12)) {
        p.photos.push_back({light, true});
        p.photos.back().light.gain = Rgb(std::exp(0.3f * light.direction.x));
    }
    p.photos.push_back({distant_light({0, 0, 1}, "held out"), false});
    p.light_model = fit_light_model(fitted_lights(p));
    return p;
}

TEST(PhotographyJson, HasAWeightForEachFittedLight) {
    json j = to_json(with_strengths());
    EXPECT_EQ(photography_from_json(j).light_model, with_strengths().light_model);
    j["light_model"]["parts"][0]["weights"].push_back(0.5);
    EXPECT_EQ(error_of([&] { photography_from_json(j); }), "a light model has 13 weights for 12 lights");
}

// A trend with leftovers, from the same lights.
TEST(PhotographyJson, OfVersion01HasItsLightModelsMadeAnew) {
    Photography p = with_strengths();
    p.beams = fit_beam_model(fitted_lights(p), 100);
    json j = to_json(p);
    const json trend = {{"trend", {0, 0.3, 0, 0, 0, 0}}, {"reach", 0.2}, {"shrink", 1}};
    j["light_model"] = trend;
    j["beams"]["terms"] = {trend, trend, trend, trend, trend};
    const Photography back = photography_from_json(j);
    EXPECT_EQ(back.light_model, p.light_model);
    EXPECT_EQ(back.beams, p.beams);
}

TEST(PhotographyJson, HasLightsOfAPossibleSize) {
    json j = to_json(Photography{});
    j["rig"].erase("light_radius_deg");  // as before it was looked for
    EXPECT_EQ(photography_from_json(j).rig.light_radius_deg, Rig::kPointLight_deg);
    for (const double deg : {-1.0, 46.0}) {
        j["rig"]["light_radius_deg"] = deg;
        EXPECT_EQ(error_of([&] { photography_from_json(j); }),
                  fmt::format("rig.light_radius_deg = {} is outside [0, 45] deg", deg));
    }
}

TEST(PhotographyJson, OfVersion01HasADistantRig) {
    json j = to_json(Photography{});
    j.erase("rig");
    const Photography back = photography_from_json(j);
    EXPECT_EQ(back.rig, Rig{});
    EXPECT_FALSE(back.light_model);
}

}  // namespace
}  // namespace tangi
