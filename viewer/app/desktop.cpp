#include "viewer/app/desktop.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "surface/base/error.h"

namespace tangi {

namespace {

std::string glfw_reason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "unknown reason";
}

GLFWcursorenterfun heard_enter_before = nullptr;  // what the window had called before there were panels

// Dear ImGui's, too, wants to know whether the pointer is in the window.
void hear_enter(GLFWwindow* window, int entered) {
    ImGui_ImplGlfw_CursorEnterCallback(window, entered);
    if (heard_enter_before) heard_enter_before(window, entered);
}

}  // namespace

Glfw::Glfw() {
    if (!glfwInit())
        fail(
            "no window can be opened: {}; a display is needed (DISPLAY or WAYLAND_DISPLAY); without one, use "
            "`relight`",
            glfw_reason());
}

Glfw::~Glfw() { glfwTerminate(); }

DesktopWindow::DesktopWindow(const std::string& title, int width, int height) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);  // so that it can be told
    handle_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!handle_)
        fail(
            "no window with OpenGL 3.3 can be opened: {}; a graphics driver is needed (Debian: "
            "libgl1-mesa-dri draws without a graphics card); `relight` works without one",
            glfw_reason());
    glfwMakeContextCurrent(handle_);
    glfwSwapInterval(1);
}

void DesktopWindow::require_device() const {
    static const bool tells = epoxy_has_gl_extension("GL_ARB_robustness");
    if (tells && glGetGraphicsResetStatusARB() != GL_NO_ERROR)
        fail(
            "the graphics device was reset, and the window with it; strokes are recorded: open the painting "
            "again "
            "to recover them");
}

DesktopWindow::~DesktopWindow() { glfwDestroyWindow(handle_); }

PanelContext::PanelContext(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsDark();
    float x = 1, y = 1;
    glfwGetWindowContentScale(window, &x, &y);
    scale_ = std::clamp(std::max(x, y), 1.0f, 4.0f);
    ImGui::GetStyle().ScaleAllSizes(scale_);
    fonts_ = std::make_unique<PanelFonts>(scale_);
    // Pointer and keyboard come through PanelInput.
    ImGui_ImplGlfw_InitForOpenGL(window, false);
    glfwSetWindowFocusCallback(window, ImGui_ImplGlfw_WindowFocusCallback);
    heard_enter_before = glfwSetCursorEnterCallback(window, hear_enter);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

PanelContext::~PanelContext() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

}  // namespace tangi
