#include "viewer/render/objects.h"

#include "surface/base/error.h"

namespace tangi::gl {

namespace {

// What the driver says of a shader or a program.
template <class Get>
std::string log_of(Get get, GLuint id) {
    std::string log(4096, '\0');
    GLsizei size = 0;
    get(id, static_cast<GLsizei>(log.size()), &size, log.data());
    log.resize(static_cast<std::size_t>(size));
    return log;
}

Shader compiled(GLenum kind, std::string_view text) {
    Shader shader(glCreateShader(kind));
    const char* begin = text.data();
    const auto length = static_cast<GLint>(text.size());
    glShaderSource(shader.id(), 1, &begin, &length);
    glCompileShader(shader.id());
    GLint done = 0;
    glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &done);
    if (!done) {
        throw ContractError(
            fmt::format("a shader does not compile:\n{}", log_of(glGetShaderInfoLog, shader.id())));
    }
    return shader;
}

}  // namespace

Texture make_texture() {
    GLuint id = 0;
    glGenTextures(1, &id);
    return Texture(id);
}

Framebuffer make_framebuffer() {
    GLuint id = 0;
    glGenFramebuffers(1, &id);
    return Framebuffer(id);
}

VertexArray make_vertex_array() {
    GLuint id = 0;
    glGenVertexArrays(1, &id);
    return VertexArray(id);
}

Program make_program(std::string_view vertex, std::string_view fragment) {
    const Shader v = compiled(GL_VERTEX_SHADER, vertex), f = compiled(GL_FRAGMENT_SHADER, fragment);
    Program program(glCreateProgram());
    glAttachShader(program.id(), v.id());
    glAttachShader(program.id(), f.id());
    glLinkProgram(program.id());
    GLint done = 0;
    glGetProgramiv(program.id(), GL_LINK_STATUS, &done);
    if (!done) {
        throw ContractError(
            fmt::format("a shader does not link:\n{}", log_of(glGetProgramInfoLog, program.id())));
    }
    return program;
}

Target::Target(int width, int height, bool floats)
    : width_(width), height_(height), texture_(make_texture()), framebuffer_(make_framebuffer()) {
    glBindTexture(GL_TEXTURE_2D, texture_.id());
    glTexImage2D(GL_TEXTURE_2D, 0, floats ? GL_RGBA32F : GL_SRGB8_ALPHA8, width, height, 0, GL_RGBA,
                 floats ? GL_FLOAT : GL_UNSIGNED_BYTE, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_.id(), 0);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        fail("the graphics driver cannot draw a picture of {} x {} pixels", width, height);
}

void require_no_error(const char* what) {
    GLenum error = GL_NO_ERROR;
    for (GLenum next = glGetError(); next != GL_NO_ERROR; next = glGetError()) error = next;
    if (error == GL_OUT_OF_MEMORY) fail("the graphics device has not enough memory {}", what);
    TP_REQUIRE(error == GL_NO_ERROR, fmt::format("OpenGL error {:#x} {}", error, what));
}

}  // namespace tangi::gl
