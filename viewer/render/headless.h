// headless.h: OpenGL without a window, through EGL: on a graphics card, or Mesa's software renderer.
#pragma once

#include <memory>
#include <string>

namespace tangi::gl {

// Holds a context of OpenGL 3.3 core and makes it current in the calling thread, where it must be destroyed.
class HeadlessContext {
public:
    // Throws Error saying what is missing: no EGL library, no device, no OpenGL 3.3.
    HeadlessContext();
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

    const std::string& renderer() const { return renderer_; }  // the driver's name of the device

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    std::string renderer_;
};

}  // namespace tangi::gl
