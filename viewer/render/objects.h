// objects.h: OpenGL objects that delete themselves. All need the context current that they were made in.
#pragma once

#include <epoxy/gl.h>

#include <string>
#include <string_view>
#include <utility>

namespace tangi::gl {

// An object of OpenGL and how it is deleted; moves, does not copy.
template <void (*Delete)(GLuint)>
class Object {
public:
    Object() = default;
    explicit Object(GLuint id) : id_(id) {}
    ~Object() { reset(); }
    Object(Object&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    Object& operator=(Object&& other) noexcept {
        if (this != &other) {
            reset();
            id_ = std::exchange(other.id_, 0);
        }
        return *this;
    }
    GLuint id() const { return id_; }
    explicit operator bool() const { return id_ != 0; }

private:
    void reset() {
        if (id_ != 0) Delete(std::exchange(id_, 0));
    }
    GLuint id_ = 0;
};

inline void delete_texture(GLuint id) { glDeleteTextures(1, &id); }
inline void delete_framebuffer(GLuint id) { glDeleteFramebuffers(1, &id); }
inline void delete_vertex_array(GLuint id) { glDeleteVertexArrays(1, &id); }
inline void delete_program(GLuint id) { glDeleteProgram(id); }
inline void delete_shader(GLuint id) { glDeleteShader(id); }

using Texture = Object<delete_texture>;
using Framebuffer = Object<delete_framebuffer>;
using VertexArray = Object<delete_vertex_array>;
using Program = Object<delete_program>;
using Shader = Object<delete_shader>;

Texture make_texture();
Framebuffer make_framebuffer();
VertexArray make_vertex_array();

// Throws ContractError with the driver's log where a shader does not compile or link: they are ours.
Program make_program(std::string_view vertex, std::string_view fragment);

// A picture to draw into: RGBA, 32-bit float, or 8 bits that hold sRGB: Renderer draws linear values into
// these, which the device encodes.
class Target {
public:
    Target() = default;
    // Throws Error where the driver cannot make one of this size.
    Target(int width, int height, bool floats);

    int width() const { return width_; }
    int height() const { return height_; }
    GLuint framebuffer() const { return framebuffer_.id(); }
    GLuint texture() const { return texture_.id(); }

private:
    int width_ = 0, height_ = 0;
    Texture texture_;
    Framebuffer framebuffer_;
};

// Throws Error where the device has no memory for what was asked of it since the last time ("not enough
// memory WHAT"), ContractError where OpenGL says that it was asked for something wrong.
void require_no_error(const char* what);

}  // namespace tangi::gl
