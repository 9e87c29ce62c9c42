// fit_doubts_test.cpp: what a fit had doubts about is read back from the painting's provenance.
#include "surface/provenance/fit_doubts.h"
#include "surface/base/json_reading.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace tangi {
namespace {

TEST(FitDoubts, AreReadBackWithTheRestOfTheProvenance) {
    Surface surface;
    surface.provenance =
        with_doubts(R"({"program": "tangipaint"})", {"poor lights"}, {"a tilt", "poor lights"});
    EXPECT_EQ(read_json(surface.provenance, "JSON")["program"], "tangipaint");
    EXPECT_THAT(doubts_of(surface), testing::ElementsAre("poor lights", "a tilt"))
        << "each once, the worst first";
    EXPECT_THAT(poor_of(surface), testing::ElementsAre("poor lights"));
    surface.provenance = with_doubts(surface.provenance, {}, {});
    EXPECT_THAT(doubts_of(surface), testing::IsEmpty());
}

TEST(FitDoubts, OfOtherPaintingsAreNone) {
    Surface surface;
    for (const char* provenance :
         {"", "by hand", "[1, 2]", R"({"warnings": "one"})", R"({"poor": [1, null]})"}) {
        surface.provenance = provenance;
        EXPECT_THAT(doubts_of(surface), testing::IsEmpty()) << provenance;
    }
    surface.provenance = with_doubts("by hand", {}, {"\xff"});
    EXPECT_EQ(read_json(surface.provenance, "JSON")["made_of"], "by hand");
    EXPECT_EQ(doubts_of(surface).size(), 1u) << "names may hold any bytes";
}

}  // namespace
}  // namespace tangi
