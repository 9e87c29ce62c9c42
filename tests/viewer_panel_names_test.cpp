// viewer_panel_names_test.cpp: no two things in a panel have one name. Dear ImGui tells them apart by it, and
// ends the program where it takes a slider that is dragged for a button.
//
// Linked so (--wrap, tests/CMakeLists.txt) that what Dear ImGui adds to a window comes by here.
#include <gmock/gmock.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <set>

#include "paint/brush_settings.h"
#include "viewer/panels/panels.h"
#include "viewer_support.h"

namespace {

// Of the frame that is drawn.
struct Names {
    std::map<ImGuiID, std::string> of;
    std::map<ImGuiID, int> times;
    std::set<std::string> twice;
} names;

}  // namespace

extern "C" {
bool __real__ZN5ImGui7ItemAddERK6ImRectjPS1_i(const ImRect&, ImGuiID, const ImRect*, ImGuiItemFlags);
bool __wrap__ZN5ImGui7ItemAddERK6ImRectjPS1_i(const ImRect& box, ImGuiID id, const ImRect* navigated,
                                              ImGuiItemFlags flags) {
    if (id != 0 && ++names.times[id] == 2) names.twice.insert(names.of[id]);
    return __real__ZN5ImGui7ItemAddERK6ImRectjPS1_i(box, id, navigated, flags);
}
ImGuiID __real__ZN11ImGuiWindow5GetIDEPKcS1_(ImGuiWindow*, const char*, const char*);
ImGuiID __wrap__ZN11ImGuiWindow5GetIDEPKcS1_(ImGuiWindow* window, const char* begin, const char* end) {
    const ImGuiID id = __real__ZN11ImGuiWindow5GetIDEPKcS1_(window, begin, end);
    names.of[id] = std::string(window->Name) + ": " + (end ? std::string(begin, end) : begin);
    if (window->DC.StateStorage) window->DC.StateStorage->SetInt(id, 1);  // what folds is unfolded
    return id;
}
}

namespace tangi {
namespace {

class PanelNames : public testing::Test {
protected:
    void SetUp() override {
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {1600, 3000};
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
        state_.painting = {400, 300};
        state_.scale_known = state_.treating.scale_known = true;
        state_.brushes = brush_presets();
        state_.use_brush("flat");
        state_.use_palette(artist_acrylics());
        for (const Pigment& paint : state_.palette.paints) state_.mix[paint.name] = 1;
        state_.paint_colours.assign(state_.palette.paints.size(), Rgb(0.5f));
        state_.help = state_.board.open = state_.new_canvas.open = true;
    }
    void TearDown() override { ImGui::DestroyContext(); }

    // All panels as they are in this state. A tab that is asked for is seen some frames later.
    void draw() {
        for (int i = 0; i < 3; ++i) {
            names = {};
            ImGui::NewFrame();
            panels::column(state_, 2900);
            if (state_.treating.on) panels::treatment_column(state_, 2900);
            panels::measurements(state_);
            panels::board(state_);
            panels::new_canvas(state_);
            panels::help(state_);
            ImGui::Render();
        }
        ASSERT_GT(names.times.size(), 50u);
        EXPECT_THAT(names.twice, testing::IsEmpty());
    }

    WindowState state_;
};

TEST_F(PanelNames, AreSeenTwice) {
    ImGui::NewFrame();
    ImGui::RadioButton("Brush", true);
    float size = 1;
    ImGui::SliderFloat("Brush", &size, 0, 2);
    ImGui::Render();
    EXPECT_THAT(names.twice, testing::ElementsAre(testing::EndsWith("Brush")));
}

TEST_F(PanelNames, OfAPaintingDiffer) {
    draw();
    state_.comparing.loaded = true;
    state_.board.size = {420, 315};
    state_.painter.has_board = true;
    state_.board.texture = 1;
    state_.job = state_.film = Job::State();
    state_.left_over_strokes = 3;
    state_.closing = true;
    state_.lamps.resize(4);
    for (const Tool tool : {Tool::tilt, Tool::light, Tool::paint, Tool::ruler}) {
        state_.tool = tool;
        draw();
    }
    for (const LookMode mode : {LookMode::specular_enhancement, LookMode::height, LookMode::curvature}) {
        state_.mode = mode;
        draw();
    }
    for (const CompareWay way : {CompareWay::aside, CompareWay::blink}) {
        state_.comparing.way = way;
        draw();
    }
}

TEST_F(PanelNames, OfATreatmentDiffer) {
    Treating& t = state_.treating;
    t.on = t.usable = true;
    t.edits = 2;
    t.job = Job::State();
    t.suggestion.emplace();
    t.preview.emplace();
    t.match.emplace();
    t.match->recipes.resize(3);
    t.pairs.resize(2);
    t.layers.resize(2);
    t.layers[0].name = "fill-1";
    t.layers[1].name = "retouch-1";
    t.log.resize(4);
    t.faults = {"a", "b"};
    for (std::size_t i = 0; i < kDamageClasses.size(); ++i) {
        t.damage[i].damage = kDamageClasses[i];
        t.damage[i].there = true;
        t.where.insert(kDamageClasses[i]);
    }
    for (const char* tab : {"Damage", "Steps", "Colour", "Record"})
        for (const MaskTool tool : {MaskTool::brush, MaskTool::polygon, MaskTool::wand, MaskTool::area})
            for (const Suggesting what : {Suggesting::loss, Suggesting::craquelure, Suggesting::gloss,
                                          Suggesting::old_fill, Suggesting::abrasion})
                for (const RetouchMode mode :
                     {RetouchMode::mimetic, RetouchMode::tratteggio, RetouchMode::neutral}) {
                    t.forward = tab;
                    t.mask_tool = tool;
                    t.suggesting = what;
                    t.mode = mode;
                    SCOPED_TRACE(tab);
                    draw();
                }
}

}  // namespace
}  // namespace tangi
