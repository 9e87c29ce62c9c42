// fonts_test.cpp: what the first typeface of the panels has not comes from others on the machine.
#include "viewer/panels/fonts.h"

#include <fontconfig/fontconfig.h>
#include <gmock/gmock.h>
#include <imgui.h>

#include "viewer/panels/shown_texts.h"

namespace tangi {
namespace {

class Fonts : public testing::Test {
protected:
    void SetUp() override { ImGui::CreateContext(); }
    void TearDown() override { ImGui::DestroyContext(); }
    static bool drawn(ImWchar character) {
        return ImGui::GetIO().Fonts->Fonts[0]->FindGlyphNoFallback(character) != nullptr;
    }
    // Some font of the machine has it.
    static bool is_here(FcChar32 character) {
        FcCharSet* wanted = FcCharSetCreate();
        FcCharSetAddChar(wanted, character);
        FcPattern* pattern = FcPatternBuild(nullptr, FC_CHARSET, FcTypeCharSet, wanted, nullptr);
        FcObjectSet* nothing = FcObjectSetBuild(FC_FILE, nullptr);
        FcFontSet* fonts = FcFontList(nullptr, pattern, nothing);
        const bool here = fonts->nfont > 0;
        FcFontSetDestroy(fonts);
        FcObjectSetDestroy(nothing);
        FcPatternDestroy(pattern);
        FcCharSetDestroy(wanted);
        return here;
    }
};

TEST_F(Fonts, HaveWhatIsNeeded) {
    PanelFonts fonts(1);
    EXPECT_FALSE(drawn(0x2116));
    EXPECT_FALSE(fonts.complete()) << "nothing was asked for";
    fonts.need("plain, ä, Ж");
    EXPECT_FALSE(fonts.complete()) << "those are there";
    for (const auto& [text, character] : {std::pair("№ 7", 0x2116),
                                          {"静物", 0x9759},
                                          {"ひ", 0x3072},
                                          {"한", 0xd55c},
                                          {"א", 0x5d0},
                                          {"♀", 0x2640}}) {
        fonts.need(text);
        const bool made = fonts.complete();
        EXPECT_EQ(made, is_here(static_cast<FcChar32>(character))) << text;
        EXPECT_EQ(drawn(static_cast<ImWchar>(character)), made) << text;
        EXPECT_FALSE(fonts.complete()) << "sought once: " << text;
    }
    ASSERT_TRUE(is_here(0x2116)) << "DejaVu Sans has it";
    EXPECT_TRUE(drawn('a'));
    EXPECT_TRUE(drawn(0x416)) << "what was there is still there";
}

TEST_F(Fonts, AreAskedForEveryNameThatIsShown) {
    WindowState state;
    state.title = "a";
    state.recent = {"b/c.exr"};
    state.said = {"d"};
    state.doubts = {"e"};
    state.treatment_state.log = {{1, "", "f", "g", ""}};
    state.treatment_state.layers = {{"h", LayerRole::fill, {}}};
    state.comparing.folder = "i";
    state.painter.layers = {"j"};
    state.new_canvas.name = "k";
    state.job_title = "l";
    std::vector<std::string> seen;
    each_shown_text(state, [&](std::string_view text) { seen.emplace_back(text); });
    for (const char* text : {"a", "b/c.exr", "d", "e", "f", "g", "h", "i", "j", "k", "l"})
        EXPECT_THAT(seen, testing::Contains(text));
}

}  // namespace
}  // namespace tangi
