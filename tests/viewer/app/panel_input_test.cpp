// panel_input_test.cpp: whatever pointer and keyboard do within one slow frame reaches the panels,
// each event once and in order.
#include "viewer/app/panel_input.h"

#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <string_view>

namespace tangi {
namespace {

using Kind = InputEvent::Kind;

class PanelInputTest : public testing::Test {
protected:
    static constexpr glm::dvec2 kButton{60, 30}, kField{60, 70}, kElsewhere{300, 250};

    PanelInputTest() {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {400, 300};
        io.KeyMap[ImGuiKey_Backspace] = GLFW_KEY_BACKSPACE;
        io.KeyMap[ImGuiKey_LeftArrow] = GLFW_KEY_LEFT;
        io.KeyMap[ImGuiKey_A] = GLFW_KEY_A;
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
        frame();  // windows can be hovered from their second frame on
        frame();
    }
    ~PanelInputTest() override { ImGui::DestroyContext(); }

    void put(Kind kind, glm::dvec2 at, int code = 0, int mods = 0) {
        InputEvent event{kind, now_s_, at, code, mods};
        event.late_s = late_s_;
        input_.put(event);
    }
    void click(const glm::dvec2& at) {
        put(Kind::move, at);
        put(Kind::press, at, GLFW_MOUSE_BUTTON_LEFT);
        put(Kind::release, at, GLFW_MOUSE_BUTTON_LEFT);
    }
    void key(int code, int mods = 0) {
        put(Kind::key, {}, code, mods);
        put(Kind::key_up, {}, code, mods);
    }
    void type(std::string_view text) {
        for (const char c : text) {
            put(Kind::key, {}, std::toupper(c));
            put(Kind::text, {}, c);
            put(Kind::key_up, {}, std::toupper(c));
        }
    }

    // One frame, however many moments it has.
    int frame(bool ready_to_type = true) {
        int moments = 0;
        do {
            ImGui::GetIO().DeltaTime = frame_s_;
            const auto fed = input_.feed({}, ready_to_type);
            enters_ += fed.enter;
            ImGui::NewFrame();
            ImGui::SetNextWindowPos({0, 0});
            ImGui::SetNextWindowSize({200, 200});
            ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoDecoration);
            ImGui::SetCursorPos({10, 20});
            clicks_ += ImGui::Button("once", {100, 20});
            doubles_ += ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0);
            ImGui::SetCursorPos({10, 60});
            ImGui::InputText("##text", &text_);
            ImGui::SetCursorPos({10, 100});
            ImGui::SetNextItemWidth(100);
            ImGui::SliderFloat("##slider", &slid_, 0, 100);
            ImGui::End();
            wheel_ += ImGui::GetIO().MouseWheel;
            ImGui::Render();
            ++moments;
        } while (input_.waits() && moments < 100);
        return moments;
    }

    PanelInput input_;
    double now_s_ = 0, late_s_ = 0;  // of events
    float frame_s_ = 1e-3f;
    int clicks_ = 0, doubles_ = 0, enters_ = 0;
    float wheel_ = 0, slid_ = 0;
    std::string text_;
};

TEST_F(PanelInputTest, EveryClickOfAFrameCounts) {
    for (int i = 0; i < 3; ++i) click(kButton);
    click(kElsewhere);
    EXPECT_LE(frame(), 12);
    EXPECT_EQ(clicks_, 3);
    EXPECT_EQ(doubles_, 1) << "the third one begins anew";
    EXPECT_EQ(frame(), 1) << "and none is left";
    EXPECT_EQ(clicks_, 3);
}

// Frames may be far apart where clicks are not, and the other way round.
TEST_F(PanelInputTest, ADoubleClickIsOneWhateverFramesTake) {
    const auto click_and_draw = [this](double now_s, double late_s) {
        now_s_ = now_s;
        late_s_ = late_s;
        click(kButton);
        frame();
    };
    frame_s_ = 0.25f;  // and a frame has several moments
    click_and_draw(1, 0);
    click_and_draw(1.5, 0.45);
    EXPECT_EQ(doubles_, 1) << "the second may have come in time: a slow frame was drawn meanwhile";
    frame_s_ = 1e-3f;
    click_and_draw(3, 0);
    click_and_draw(3.5, 0);
    EXPECT_EQ(doubles_, 1) << "half a second, though frames came fast";
    click_and_draw(3.7, 0);
    EXPECT_EQ(doubles_, 2);
    click_and_draw(5, 0);
    click(kElsewhere);
    frame();
    EXPECT_EQ(doubles_, 2) << "two places are no double click";
    EXPECT_EQ(clicks_, 6);
}

TEST_F(PanelInputTest, ATapOfAFingerIsAClick) {
    put(Kind::move, kButton);
    put(Kind::press, kButton, GLFW_MOUSE_BUTTON_LEFT);
    put(Kind::move, kButton + glm::dvec2(2, 0));
    put(Kind::release, kButton + glm::dvec2(2, 0), GLFW_MOUSE_BUTTON_LEFT);
    frame();
    EXPECT_EQ(clicks_, 1);
    put(Kind::press, kButton, GLFW_MOUSE_BUTTON_LEFT);
    put(Kind::lost, kButton);
    frame();
    EXPECT_FALSE(ImGui::GetIO().MouseDown[0]) << "the finger is gone";
}

TEST_F(PanelInputTest, WhatIsDraggedArrivesBeforeItIsLetGo) {
    put(Kind::press, {30, 110}, GLFW_MOUSE_BUTTON_LEFT);
    for (int x = 31; x <= 200; ++x) put(Kind::move, {static_cast<double>(x), 110});
    put(Kind::release, {200, 110}, GLFW_MOUSE_BUTTON_LEFT);
    EXPECT_LE(frame(), 4) << "moves are one moment";
    EXPECT_EQ(slid_, 100);
}

TEST_F(PanelInputTest, TextAndKeysKeepTheirOrder) {
    click(kField);
    frame();
    type("abc");
    key(GLFW_KEY_BACKSPACE);
    key(GLFW_KEY_BACKSPACE);
    type("d");
    key(GLFW_KEY_LEFT);
    type("e");
    key(GLFW_KEY_ENTER);
    frame();
    EXPECT_EQ(text_, "aed");
    EXPECT_EQ(enters_, 1);
    click(kField);
    put(Kind::key, {}, GLFW_KEY_LEFT_CONTROL);
    key(GLFW_KEY_A, GLFW_MOD_CONTROL);
    put(Kind::key_up, {}, GLFW_KEY_LEFT_CONTROL);
    type("x");
    frame();
    EXPECT_EQ(text_, "x") << "in the place of what was selected";
}

TEST_F(PanelInputTest, TypingWaitsUntilThereIsAFieldForIt) {
    click(kField);
    frame();
    type("a");
    frame(false);
    EXPECT_EQ(text_, "");
    EXPECT_TRUE(input_.waits());
    frame();
    EXPECT_EQ(text_, "a");
}

TEST_F(PanelInputTest, AKeyThatRepeatsIsDownOnce) {
    for (int i = 0; i < 50; ++i) put(Kind::key, {}, GLFW_KEY_BACKSPACE);
    EXPECT_EQ(frame(), 1);
    EXPECT_TRUE(ImGui::GetIO().KeysDown[GLFW_KEY_BACKSPACE]);
}

TEST_F(PanelInputTest, StepsOfTheWheelAddUp) {
    put(Kind::move, kButton);
    for (int i = 0; i < 5; ++i) put(Kind::wheel, {0, 1});
    put(Kind::wheel, {0, -1});
    EXPECT_EQ(frame(), 1);
    EXPECT_FLOAT_EQ(wheel_, 4);
}

}  // namespace
}  // namespace tangi
