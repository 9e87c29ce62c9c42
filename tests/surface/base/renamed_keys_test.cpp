// renamed_keys_test.cpp: files of version 0.1 are read by the keys that they have.
#include "surface/base/renamed_keys.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace tangi {
namespace {

using nlohmann::json;

TEST(RenamedKeys, AreReadByEitherName) {
    for (const auto& [before, now] : {std::pair("balls", "spheres"),
                                      {"balls_used", "spheres_used"},
                                      {"faithful", "residual"},
                                      {"haze", "second_lobe_weight"},
                                      {"lamp_distance_mm", "light_distance_mm"},
                                      {"lamp_radius_deg", "light_radius_deg"},
                                      {"lamps", "light_model"},
                                      {"left_out", "cross_validated"}}) {
        EXPECT_EQ(with_present_keys({{before, 7}}), json({{now, 7}}));
        EXPECT_EQ(with_present_keys({{now, 7}}), json({{now, 7}}));
        EXPECT_EQ(with_present_keys({{before, 7}, {now, 8}}), json({{now, 8}})) << "the present name counts";
    }
}

TEST(RenamedKeys, AreFoundAtAnyDepthAndValuesStay) {
    const json before = {{"rig", {{"lamp_radius_deg", 0.5}}}, {"list", {{{"haze", "lamps"}}, 3, nullptr}}};
    const json now = {{"rig", {{"light_radius_deg", 0.5}}},
                      {"list", {{{"second_lobe_weight", "lamps"}}, 3, nullptr}}};
    EXPECT_EQ(with_present_keys(before), now);
    EXPECT_EQ(with_present_keys(3), json(3));
}

}  // namespace
}  // namespace tangi
