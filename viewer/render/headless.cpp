#include "viewer/render/headless.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <vector>

#include "surface/base/error.h"

namespace tangi::gl {

struct HeadlessContext::Impl {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;

    ~Impl() {
        if (display == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
        // The display belongs to the process: others may use it.
    }

    bool open(EGLDisplay candidate) {
        if (candidate == EGL_NO_DISPLAY || !eglInitialize(candidate, nullptr, nullptr)) return false;
        if (!eglBindAPI(EGL_OPENGL_API)) return false;
        constexpr std::array<EGLint, 3> kAnyConfig = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (!eglChooseConfig(candidate, kAnyConfig.data(), &config, 1, &count) || count == 0)
            config = EGL_NO_CONFIG_KHR;
        constexpr std::array<EGLint, 7> kCore = {EGL_CONTEXT_MAJOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_MINOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                 EGL_NONE};
        const EGLContext made = eglCreateContext(candidate, config, EGL_NO_CONTEXT, kCore.data());
        if (made == EGL_NO_CONTEXT) return false;
        if (!eglMakeCurrent(candidate, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
            eglDestroyContext(candidate, made);
            return false;
        }
        display = candidate;
        context = made;
        return true;
    }
};

namespace {

// Graphics cards first, then whatever draws without a window system.
std::vector<EGLDisplay> candidates() {
    std::vector<EGLDisplay> displays;
    const bool platforms = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base");
    if (platforms && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count))
            for (EGLint i = 0; i < count; ++i)
                displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT,
                                                            devices[static_cast<std::size_t>(i)], nullptr));
    }
    if (platforms && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        displays.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return displays;
}

}  // namespace

HeadlessContext::HeadlessContext() : impl_(std::make_unique<Impl>()) {
    // libepoxy ends the program where a library is missing.
    for (const char* library : {"libEGL.so.1", "libGL.so.1"})
        if (!::dlopen(library, RTLD_LAZY | RTLD_LOCAL))
            fail("OpenGL without a window needs {}, which is not installed (Debian: libegl1 libgl1)",
                 library);
    for (const EGLDisplay display : candidates())
        if (impl_->open(display)) {
            const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
            renderer_ = name ? name : "";
            return;
        }
    fail(
        "no graphics card and no software renderer here draws OpenGL 3.3 without a window (Debian: "
        "libgl1-mesa-dri)");
}

HeadlessContext::~HeadlessContext() = default;

}  // namespace tangi::gl
