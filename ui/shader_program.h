// A linked shader program from two files of shaders/.
#pragma once

#include <string>

#include "core/base/result.h"
#include "ui/gl_functions.h"

namespace talbot {

class ShaderProgram {
  public:
    explicit ShaderProgram(const GlFunctions& gl) : gl_(gl) {}
    ~ShaderProgram();
    ShaderProgram(const ShaderProgram&) = delete;
    ShaderProgram& operator=(const ShaderProgram&) = delete;

    // Reads shaders/NAME.vert and shaders/NAME.frag; the error holds the driver's message. Defines
    // are lines that follow #version in the fragment shader.
    Status load(const std::string& name, const std::string& defines = {});

    void use() const { gl_.UseProgram(program_); }
    GLint location(const char* uniform) const { return gl_.GetUniformLocation(program_, uniform); }
    GLint attribute(const char* name) const { return gl_.GetAttribLocation(program_, name); }

  private:
    const GlFunctions& gl_;
    GLuint program_ = 0;
};

}  // namespace talbot
