// treatment_match_test.cpp: recipes beside the window, from the paints and by the pairs that the user
// has.
#include <gmock/gmock.h>

#include "retouch/colour_match/pigment_pairs.h"
#include "tests/support/viewer/treatment_controllers.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using Controllers = TreatmentControllers;

TEST_F(Controllers, RecipesForAPlaceAndRoundTheDamage) {
    begin();
    TreatmentState& t = state_.treatment_state;
    t.brush_mm = 10;
    draw(80, 80, 80, 80);
    t.ask.keep = true;
    settle();
    t.most_paints = 2;
    t.ask.match_at = glm::dvec2(40, 40);
    settle();
    ASSERT_TRUE(t.match) << testing::PrintToString(said_);
    ASSERT_FALSE(t.match->recipes.empty());
    for (const ShownRecipe& r : t.match->recipes) {
        EXPECT_LE(r.mix.size(), 2u);
        float parts = 0;
        for (const auto& [name, part] : r.mix) {
            EXPECT_GE(artist_acrylics().find(name), 0) << "from one's own box";
            parts += part;
        }
        EXPECT_NEAR(parts, 1, 1e-4);
    }
    t.ask.match_around = true;
    settle();
    EXPECT_THAT(t.match->of, HasSubstr("round the damage"));
    t.illuminants.fill(false);
    t.ask.match_around = true;
    settle();
    EXPECT_THAT(said_.back(), HasSubstr("choose a light"));
}

TEST_F(Controllers, RecipesAreOfThePaintBoxThatWasChosenLast) {
    begin();
    TreatmentState& t = state_.treatment_state;
    Palette two{"Two", "", {artist_acrylics().at("Titanium White"), artist_acrylics().at("Bone Black")}};
    state_.mix = {{"Bone Black", 1}, {"Hansa Yellow Opaque", 2}};
    state_.use_palette(two);
    EXPECT_EQ(state_.mix, (std::map<std::string, float>{{"Bone Black", 1}}));
    EXPECT_EQ(state_.paint_colours.size(), 2u);
    state_.mix = {{"Hansa Yellow Opaque", 2}};
    state_.use_palette(two);
    EXPECT_EQ(state_.mix, (std::map<std::string, float>{{"Titanium White", 1}})) << "there is one at least";
    documents_->use_palette(two);
    t.ask.match_at = glm::dvec2(40, 40);
    settle();
    ASSERT_TRUE(t.match) << testing::PrintToString(said_);
    for (const ShownRecipe& r : t.match->recipes)
        for (const auto& [name, part] : r.mix) EXPECT_GE(two.find(name), 0) << name;
}

TEST_F(Controllers, PairsThatAreKeptApartAreEditedAndStay) {
    begin();
    TreatmentState& t = state_.treatment_state;
    const std::size_t usual = usual_pigment_pairs().size();
    ASSERT_EQ(t.pairs.size(), usual);
    t.new_pair = {"white", " ", "nothing to keep apart"};
    t.ask.add_pair = true;
    settle();
    EXPECT_THAT(said_.back(), HasSubstr("a word at least for both"));
    t.new_pair = {"Titanium White, PW6", "bone black", "a trial"};
    t.ask.add_pair = true;
    settle();
    ASSERT_EQ(t.pairs.size(), usual + 1);
    EXPECT_THAT(t.pairs.back().first, testing::ElementsAre("Titanium White", "PW6"));
    t.ask.drop_pair = 0;
    settle();
    const auto file = folder_ / "settings" / "pigment_pairs.json";
    EXPECT_EQ(read_pigment_pairs(file).size(), usual);
    EXPECT_EQ(read_pigment_pairs(file).back().why, "a trial");

    // Warned of by it, or left out.
    const Palette greys{
        "Greys", "", {artist_acrylics().at("Titanium White"), artist_acrylics().at("Bone Black")}};
    documents_->use_palette(greys);
    const auto mixed = [&] {
        t.ask.match_at = glm::dvec2(40, 40);
        settle();
        return std::any_of(t.match->recipes.begin(), t.match->recipes.end(),
                           [](const ShownRecipe& r) { return r.mix.size() > 1; });
    };
    ASSERT_TRUE(mixed());
    t.avoid_pairs = true;
    EXPECT_FALSE(mixed());

    // Another desk has it too.
    TreatmentController again(
        state_, {{"B. Restorer", "test"}, greys, [] {}, [](const std::string&) {}, folder_ / "settings"});
    EXPECT_EQ(state_.treatment_state.pairs.size(), usual);
    t.ask.usual_pairs = true;
    settle();
    EXPECT_EQ(t.pairs.front().why, usual_pigment_pairs().front().why);
    EXPECT_EQ(t.pairs.size(), usual);
}

}  // namespace
}  // namespace tangi
