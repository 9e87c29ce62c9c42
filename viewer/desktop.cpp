#include "viewer/desktop.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fontconfig/fontconfig.h>
#include <imgui.h>
#include <imgui_freetype.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "surface/error.h"

namespace tangi {

namespace {

std::string glfw_reason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "unknown reason";
}

// The file of a typeface, or of what comes nearest to it; empty where there is none.
std::string font_file(const char* family) {
    const std::unique_ptr<FcPattern, void (*)(FcPattern*)> wanted(FcPatternCreate(), &FcPatternDestroy);
    FcPatternAddString(wanted.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>(family));
    FcPatternAddInteger(wanted.get(), FC_WEIGHT, FC_WEIGHT_REGULAR);
    FcPatternAddInteger(wanted.get(), FC_SLANT, FC_SLANT_ROMAN);
    FcPatternAddBool(wanted.get(), FC_SCALABLE, FcTrue);
    FcConfigSubstitute(nullptr, wanted.get(), FcMatchPattern);
    FcDefaultSubstitute(wanted.get());
    FcResult result = FcResultNoMatch;
    const std::unique_ptr<FcPattern, void (*)(FcPattern*)> found(FcFontMatch(nullptr, wanted.get(), &result),
                                                                 &FcPatternDestroy);
    FcChar8* file = nullptr;
    if (!found || FcPatternGetString(found.get(), FC_FILE, 0, &file) != FcResultMatch) return {};
    return reinterpret_cast<const char*>(file);
}

// Latin, Greek and Cyrillic, for the names of files, and the signs of our own texts.
constexpr ImWchar kGlyphs[] = {0x20,   0x17f,  0x370,  0x3ff,  0x400,  0x45f,  0x2010, 0x2033, 0x2070,
                               0x2094, 0x2190, 0x2199, 0x2202, 0x221e, 0x2248, 0x2265, 0};

// DejaVu Sans; where there is no font at all, the small one of Dear ImGui.
void add_font(float scale) {
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    const std::string file = font_file("DejaVu Sans");
    ImFontConfig config;
    if (std::error_code gone; !std::filesystem::is_regular_file(file, gone)) {
        config.SizePixels = std::floor(13 * scale);
        fonts.AddFontDefault(&config);
        return;
    }
    fonts.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
    fonts.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
    fonts.AddFontFromFileTTF(file.c_str(), std::floor(15 * scale), &config, kGlyphs);
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
    add_font(scale_);
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
