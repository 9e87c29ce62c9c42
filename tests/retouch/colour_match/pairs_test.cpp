// pairs_test.cpp: pairs of pigments that are kept apart: the list, its files, what is warned of.
#include "retouch/colour_match/pigment_pairs.h"

#include <gmock/gmock.h>

#include "paint/optics/palette.h"
#include "retouch/inpaint/recipe_json.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(PigmentPairs, AreFoundByNameAndColourIndex) {
    Pigment copper, sulphide, harmless;
    copper.name = "Azurite (P.B. 30)", sulphide.name = "CADMIUM Yellow Light", harmless.name = "Cobalt Blue";
    const auto found = pairs_to_avoid({harmless, copper, sulphide}, usual_pigment_pairs());
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].a, 1);
    EXPECT_EQ(found[0].b, 2);
    EXPECT_NE(found[0].pair->why.find("copper sulphide"), std::string::npos);
    Pigment numbered;
    numbered.name = "Mountain blue", numbered.source = "PB 30, maker";
    EXPECT_TRUE(is_named(numbered, {"PB30"}));
    EXPECT_FALSE(is_named(numbered, {"PB3"})) << "whole words only";
    EXPECT_TRUE(pairs_to_avoid(artist_acrylics().paints, usual_pigment_pairs()).empty());
}

TEST(PigmentPairs, WordsOfAPalettesCommonSourceNameNoPaint) {
    const std::vector<PigmentPair> pairs = parse_pigment_pairs(
        R"({"format": "tangipaint pigment pairs", "version": 1,
            "pairs": [{"first": ["azurite"], "second": ["masstones"]}]})",
        "my.json");
    Pigment copper, other, own;
    copper.name = "Azurite", other.name = "Chalk", own.name = "Old tube";
    copper.source = other.source = "K and S from masstones and tints";
    own.source = "masstones, 1911";
    const std::vector<Pigment> paints = {copper, other, own};
    const auto found = pairs_to_avoid(paints, pairs);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].b, 2);
    Mixture both;
    both.count = 2, both.paints = {0, 2}, both.volumes = {0.5, 0.5};
    const nlohmann::json said = warnings_of(both, paints, found);
    ASSERT_GE(said.size(), 1u);
    EXPECT_EQ(said[0], "Azurite with Old tube is a pair of the list to be avoided");
}

TEST(PigmentPairs, AreReadAsTheyWereWritten) {
    const TestDir dir;
    std::vector<PigmentPair> pairs = usual_pigment_pairs();
    pairs.push_back({{"a \"b\""}, {"ü"}, "because", ""});
    write_pigment_pairs(dir / "pairs.json", pairs);
    const std::vector<PigmentPair> again = read_pigment_pairs(dir / "pairs.json");
    ASSERT_EQ(again.size(), pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        EXPECT_EQ(again[i].first, pairs[i].first);
        EXPECT_EQ(again[i].second, pairs[i].second);
        EXPECT_EQ(again[i].why, pairs[i].why);
        EXPECT_EQ(again[i].source, pairs[i].source);
    }
}

TEST(PigmentPairs, SayWhereAFileIsWrong) {
    const auto wrong = [](const char* pairs) {
        return error_of([&] {
            parse_pigment_pairs(
                fmt::format(R"({{"format": "tangipaint pigment pairs", "version": 1, "pairs": {}}})", pairs),
                "my.json");
        });
    };
    EXPECT_NE(wrong(R"([{"first": "x", "second": ["y"]}])").find("my.json: /pairs/0/first"),
              std::string::npos);
    EXPECT_NE(wrong(R"([{"first": ["x"], "second": ["y"], "reason": "z"}])").find("/pairs/0/reason"),
              std::string::npos);
    EXPECT_NE(wrong(R"([{"first": ["x"], "second": ["y", 3]}])").find("/pairs/0/second/1"),
              std::string::npos);
    EXPECT_NE(error_of([] { parse_pigment_pairs("[", "my.json"); }).find("my.json: line 1: is not JSON"),
              std::string::npos);
    EXPECT_NE(error_of([] { parse_pigment_pairs("[]", "my.json"); }).find("--save-pairs"), std::string::npos);
}

}  // namespace
}  // namespace tangi
