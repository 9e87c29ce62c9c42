// desktop.h: GLFW, a window with OpenGL 3.3 and Dear ImGui in it, as long as the objects live.
#pragma once

#include <memory>
#include <string>

#include "viewer/panels/fonts.h"

struct GLFWwindow;

namespace tangi {

// Throws Error where there is no display.
class Glfw {
public:
    Glfw();
    ~Glfw();
    Glfw(const Glfw&) = delete;
    Glfw& operator=(const Glfw&) = delete;
};

// Its context is current. Throws Error where there is no OpenGL 3.3.
class DesktopWindow {
public:
    DesktopWindow(const std::string& title, int width, int height);
    ~DesktopWindow();
    DesktopWindow(const DesktopWindow&) = delete;
    DesktopWindow& operator=(const DesktopWindow&) = delete;

    GLFWwindow* handle() const { return handle_; }

    // Throws Error where the graphics device was reset, and all that was on it is lost: a driver that
    // crashed, a card that was taken away. Drivers that cannot tell say nothing.
    void require_device() const;

private:
    GLFWwindow* handle_ = nullptr;
};

// Panels take the window's events that its own callbacks, set before, pass on. They are as large as the
// screen's density asks for.
class PanelContext {
public:
    explicit PanelContext(GLFWwindow* window);
    ~PanelContext();
    PanelFonts& fonts() { return *fonts_; }
    float scale() const { return scale_; }  // [1] against a screen of the usual density
    PanelContext(const PanelContext&) = delete;
    PanelContext& operator=(const PanelContext&) = delete;

private:
    float scale_ = 1;
    std::unique_ptr<PanelFonts> fonts_;
};

}  // namespace tangi
