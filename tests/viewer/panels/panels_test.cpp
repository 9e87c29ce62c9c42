// panels_test.cpp: panels drawn without a window: what can be reached, and that nothing lies over
// another.
#include "viewer/panels/panels.h"

#include <gmock/gmock.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <set>
#include <utility>

#include "viewer/panels/number_field.h"

namespace tangi {
namespace {

class ManyPhotographs : public PhotoBook {
public:
    ManyPhotographs() {
        for (int i = 0; i < 40; ++i)
            entries_.push_back({fmt::format("{}.png", i), distant_light({0, 0, 1}), true});
    }
    const std::vector<Entry>& entries() const override { return entries_; }
    const std::vector<std::string>& warnings() const override { return warnings_; }
    const ColourScale& difference_scale() const override { return scale_; }
    const ColourScale& delta_e_scale() const override { return scale_; }
    HeldPhoto hold(int, const Progress&) const override { return {}; }
    void write_report(const std::filesystem::path&, const std::vector<int>&, const Progress&) const override {
    }

private:
    std::vector<Entry> entries_;
    std::vector<std::string> warnings_;
    ColourScale scale_;
};

class Panels : public testing::Test {
protected:
    Panels() {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {1280, 720};
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
    }
    ~Panels() override { ImGui::DestroyContext(); }

    void frames(void (*panel)(WindowState&), float height = 720) {
        for (int i = 0; i < 3; ++i) {
            ImGui::NewFrame();
            ImGui::SetNextWindowPos({0, 0});
            ImGui::SetNextWindowSize({300, height});
            ImGui::Begin("column");
            panel(state_);
            ImGui::End();
            ImGui::Render();
            ImGui::GetIO().MouseWheel = 0;
        }
    }
    // The photograph that the list shows at this height.
    int photo_at(float y) {
        ImGuiIO& io = ImGui::GetIO();
        io.MousePos = {60, y};
        frames(panels::photographs);
        io.MouseDown[0] = true;
        frames(panels::photographs);
        io.MouseDown[0] = false;
        frames(panels::photographs);
        return std::exchange(state_.ask, {}).photo.value_or(-1);
    }

    WindowState state_;
};

TEST_F(Panels, TheListOfPhotographsCanBeScrolledAwayFromTheOneShown) {
    Comparing& c = state_.comparing;
    c.loaded = true;
    const ManyPhotographs book;
    c.news.book = &book;
    c.news.wanted = 0;
    constexpr float kList = 90;
    const int first = photo_at(kList);
    EXPECT_GE(first, 0);
    EXPECT_LT(first, 6);
    for (int i = 0; i < 4; ++i) {
        ImGui::GetIO().MouseWheel = -1;
        frames(panels::photographs);
    }
    const int scrolled = photo_at(kList);
    EXPECT_GT(scrolled, 6);
    // The next one that is chosen is brought into sight.
    c.news.wanted = 35;
    frames(panels::photographs);
    EXPECT_NEAR(photo_at(kList), 35, 4);
}

// A button may be called as the part of the panel that it is in.
TEST_F(Panels, EveryButtonOfTheStepsCanBeClicked) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {1280, 1600};
    std::set<std::string> clicked;
    for (int pass = 0; pass < 2; ++pass)  // parts that were folded are open then
        for (float y = 30; y < 1400; y += 6) {
            io.MousePos = {40, y};
            frames(panels::steps, 1600);
            io.MouseDown[0] = true;
            frames(panels::steps, 1600);
            io.MouseDown[0] = false;
            frames(panels::steps, 1600);
            const auto ask = std::exchange(state_.treatment_state.ask, {});
            if (ask.fill) clicked.insert("fill");
            if (ask.isolate) clicked.insert("isolate");
            if (ask.varnish) clicked.insert("varnish");
        }
    EXPECT_EQ(clicked, (std::set<std::string>{"fill", "isolate", "varnish"}));
}

// The row below moves up when a layer goes: the second click of a double click was not meant for it.
TEST_F(Panels, ADoubleClickTakesOneLayerOff) {
    TreatmentState& t = state_.treatment_state;
    ImGuiIO& io = ImGui::GetIO();
    const auto click = [&](float y) {
        io.MousePos = {30, y};
        frames(panels::treatment_layers);
        io.MouseDown[0] = true;
        frames(panels::treatment_layers);
        io.MouseDown[0] = false;
        frames(panels::treatment_layers);
        return std::exchange(t.ask, {});
    };
    const auto has = [&](const std::vector<std::string>& names, const std::string& undo) {
        t.layers.clear();
        for (const std::string& name : names) t.layers.push_back({name, LayerRole::varnish, {}});
        t.next_undo = {undo, ""};
        t.layers_moved = true;
        frames(panels::treatment_layers);
    };
    const auto wait = [&] {
        for (double until = ImGui::GetTime() + 1; ImGui::GetTime() < until;) frames(panels::treatment_layers);
    };
    has({"fill 1", "retouch 1", "varnish 1"}, "lay varnish 1");
    wait();
    float top = 30, undo = 0;
    for (; top < 300; top += 4) {
        const auto ask = click(top);
        if (ask.undo_step && undo == 0) undo = top;
        if (!ask.remove.empty()) break;
    }
    ASSERT_LT(top, 300);
    ASSERT_GT(undo, 0) << "above the rows";
    EXPECT_EQ(click(top).remove, "varnish 1");
    has({"fill 1", "retouch 1"}, "take off varnish 1");
    EXPECT_EQ(click(top), TreatmentState::Ask{});
    wait();
    EXPECT_EQ(click(top).remove, "retouch 1");
    has({"fill 1"}, "take off retouch 1");
    EXPECT_FALSE(click(undo).undo_step) << "it does something else than a moment ago";
    wait();
    EXPECT_TRUE(click(undo).undo_step) << "and stays where it is";
    t.next_undo.refused = "nothing was kept";
    EXPECT_FALSE(click(undo).undo_step);
}

// What is compared is lit as the photograph was: dome and sliders would move, and no picture with them.
TEST_F(Panels, NothingIsLitWhilePhotographsAreHeldAgainstThePainting) {
    ImGuiIO& io = ImGui::GetIO();
    const auto hand_at = [&](float x, float y) {
        io.MousePos = {x, y};
        frames(panels::light);
        io.MouseDown[0] = true;
        frames(panels::light);
        io.MouseDown[0] = false;
        frames(panels::light);
    };
    const auto everywhere = [&] {
        for (float y = 40; y < 420; y += 7)
            for (const float x : {30.0f, 60.0f, 170.0f}) hand_at(x, y);
    };
    state_.comparing.on = true;
    const ViewLight before = state_.lights[0];
    everywhere();
    ASSERT_EQ(state_.lights.size(), 1u);
    EXPECT_EQ(state_.lights[0].angles.azimuth_deg, before.angles.azimuth_deg);
    EXPECT_EQ(state_.lights[0].angles.elevation_deg, before.angles.elevation_deg);
    EXPECT_EQ(state_.lights[0].gain, before.gain);
    EXPECT_TRUE(state_.shadows && !state_.sweeping);
    state_.comparing.on = false;
    everywhere();
    EXPECT_NE(state_.lights[0].angles.azimuth_deg, before.angles.azimuth_deg) << "and it is otherwise";
}

// Typed as a user does: Ctrl-click into a slider.
TEST_F(Panels, ADecimalCommaIsOneInASliderToo) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyMap[ImGuiKey_Enter] = 1;
    float y = 0;
    // Of the slider Ambient, the last of the panel.
    const float before = state_.ambient;
    for (float at = 40; at < 420 && y == 0; at += 5) {
        state_.ambient = before;
        io.MousePos = {30, at};
        frames(panels::light);
        io.MouseDown[0] = true;
        frames(panels::light);
        io.MouseDown[0] = false;
        frames(panels::light);
        if (state_.ambient != before) y = at;
    }
    ASSERT_GT(y, 0);
    const auto type = [&](const char* text) {
        state_.ambient = 0.1f;
        io.MousePos = {30, y};
        frames(panels::light);
        io.KeyCtrl = io.MouseDown[0] = true;
        frames(panels::light);
        io.KeyCtrl = io.MouseDown[0] = false;
        frames(panels::light);
        for (const char* c = text; *c; ++c) io.AddInputCharacter(static_cast<unsigned>(*c));
        frames(panels::light);
        EXPECT_EQ(state_.ambient, 0.1f) << "not before it is entered";
        io.KeysDown[1] = true;
        frames(panels::light);
        io.KeysDown[1] = false;
        frames(panels::light);
        return state_.ambient;
    };
    EXPECT_FLOAT_EQ(type("0,25"), 0.25f);
    EXPECT_FLOAT_EQ(type("0.25"), 0.25f);
    EXPECT_FALSE(panels::number_complaint());
    for (const auto& [text, why] : {std::pair("1.234,5", "between thousands"),
                                    {"1,234", "may be"},
                                    {"2,5", "is not between 0 and 0.5"},
                                    {"abc", "not a number"}}) {
        EXPECT_EQ(type(text), 0.1f) << text;
        const auto complaint = panels::number_complaint();
        ASSERT_TRUE(complaint) << text;
        EXPECT_NE(complaint->find(why), std::string::npos) << *complaint;
        EXPECT_EQ(complaint->find("Ambient: "), 0u) << *complaint;
    }
}

TEST_F(Panels, AFieldTakesTheUnitThatItShows) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyMap[ImGuiKey_Enter] = 1;
    static float value = 0;
    const auto type = [&](void (*panel)(WindowState&), const char* text) {
        value = 1;
        for (const bool down : {false, true, false}) {
            io.MousePos = {30, 35};
            io.MouseDown[0] = down;
            frames(panel);
        }
        for (const char* c = text; *c; ++c) io.AddInputCharacter(static_cast<unsigned char>(*c));
        frames(panel);
        for (const bool down : {true, false}) {
            io.KeysDown[1] = down;
            frames(panel);
        }
        return value;
    };
    const auto in_label = [](WindowState&) { panels::type_number("Width, mm", value, 1, 1e5, "%.1f"); };
    const auto in_format = [](WindowState&) { panels::type_number("Width", value, 1, 1e5, "%.1f mm"); };
    const auto none = [](WindowState&) { panels::type_number("Width", value, 1, 1e5, "%.1f"); };
    for (void (*panel)(WindowState&) : {+in_label, +in_format}) {
        EXPECT_EQ(type(panel, "120 mm"), 120);
        EXPECT_EQ(type(panel, "120,5mm"), 120.5f);
        EXPECT_FALSE(panels::number_complaint());
        EXPECT_EQ(type(panel, "12 cm"), 1);
        EXPECT_THAT(panels::number_complaint().value_or(""), testing::HasSubstr("give it in mm"));
    }
    EXPECT_EQ(type(+none, "120 mm"), 1);
    EXPECT_THAT(panels::number_complaint().value_or(""), testing::HasSubstr("is not a number"));
}

TEST_F(Panels, ProfileAndStatisticsLieBesideEachOther) {
    for (const bool ruler_first : {true, false}) {
        state_.profile.reset();
        state_.statistics.reset();
        frames(panels::measurements);
        for (const bool ruler : {ruler_first, !ruler_first}) {
            if (ruler) {
                state_.profile.emplace();
                state_.profile->height_mm = {0, 1, 0};
            } else {
                state_.region = Region{0, 0, 10, 10};
                state_.statistics.emplace();
                state_.statistics->region = *state_.region;
                state_.statistics->pixels = 100;
            }
            frames(panels::measurements);
        }
        const ImRect profile = ImGui::FindWindowByName("Height along the ruler")->Rect(),
                     region = ImGui::FindWindowByName("Region")->Rect();
        EXPECT_FALSE(profile.Overlaps(region)) << (ruler_first ? "ruler" : "region") << " first";
        EXPECT_GE(std::min(profile.Min.y, region.Min.y), 0);
        EXPECT_LE(std::max(profile.Max.y, region.Max.y), 720);
    }
}

// A message covers two lines of the painting, however long it is; all of it comes when one asks for it.
TEST_F(Panels, ALongMessageIsCutToTwoLines) {
    const std::string sentence = "a.exr: was replaced by another program, and nothing was overwritten. ";
    state_.painting = {400, 300};
    state_.canvas_left = 300;
    const Extent screen{980, 720};
    const auto covered = [&] {  // [lines] above the status line
        float top = 720;
        for (int i = 0; i < 3; ++i) {
            ImGui::NewFrame();
            panels::overlay(state_, Placement(fitted({400, 300}, screen), {}, {400, 300}, screen, 1), screen,
                            {0, 0}, false);
            top = 720;
            for (const ImDrawVert& v : ImGui::GetBackgroundDrawList()->VtxBuffer)
                top = std::min(top, v.pos.y);
            ImGui::Render();
        }
        return (720 - 22 * state_.scale - 8 - top) / ImGui::GetFontSize();
    };
    for (const int sentences : {1, 3, 40}) {
        state_.message.clear();
        for (int i = 0; i < sentences; ++i) state_.message += sentence;
        EXPECT_LE(covered(), 2.01f) << sentences;
    }
    state_.message = "said before\n" + sentence + "\nsaid last";
    EXPECT_NEAR(covered(), 2, 0.01);
    state_.message = sentence;
    for (int i = 0; i < 40; ++i) state_.message += sentence;
    state_.whole_message = true;
    EXPECT_GT(covered(), 10);
}

}  // namespace
}  // namespace tangi
