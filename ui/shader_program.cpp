#include "ui/shader_program.h"

#include <fstream>
#include <iterator>

#include "ui/data_path.h"

namespace talbot {
namespace {

// The shader's id, or 0 and the driver's message.
GLuint compile(const GlFunctions& gl, GLenum type, const std::string& source,
               std::string& message) {
    const GLuint shader = gl.CreateShader(type);
    const char* text = source.c_str();
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    GLint compiled = 0;
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;
    char log[1024] = {};
    gl.GetShaderInfoLog(shader, sizeof log, nullptr, log);
    message = log;
    gl.DeleteShader(shader);
    return 0;
}

Result<GLuint> compile_file(const GlFunctions& gl, GLenum type, const std::string& relative,
                            const std::string& defines) {
    const std::filesystem::path path = find_data(relative);
    std::ifstream in(path, std::ios::binary);
    if (!in) {
        return Error{ErrorKind::failed, path.string(), "",
                     "shader not found (set TALBOT_DATA_DIR to the folder that holds shaders/)"};
    }
    std::string source((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    source.insert(source.find('\n') + 1, defines);
    std::string message;
    const GLuint shader = compile(gl, type, source, message);
    if (!shader) return Error{ErrorKind::failed, path.string(), "", message};
    return shader;
}

}  // namespace

ShaderProgram::~ShaderProgram() {
    if (program_) gl_.DeleteProgram(program_);
}

Status ShaderProgram::load(const std::string& name, const std::string& defines) {
    const Result<GLuint> vertex =
        compile_file(gl_, GL_VERTEX_SHADER, "shaders/" + name + ".vert", "");
    if (!vertex) return vertex.error();
    const Result<GLuint> fragment =
        compile_file(gl_, GL_FRAGMENT_SHADER, "shaders/" + name + ".frag", defines);
    if (!fragment) {
        gl_.DeleteShader(*vertex);
        return fragment.error();
    }
    program_ = gl_.CreateProgram();
    gl_.AttachShader(program_, *vertex);
    gl_.AttachShader(program_, *fragment);
    gl_.LinkProgram(program_);
    gl_.DeleteShader(*vertex);
    gl_.DeleteShader(*fragment);
    GLint linked = 0;
    gl_.GetProgramiv(program_, GL_LINK_STATUS, &linked);
    if (linked) return Done{};
    char log[1024] = {};
    gl_.GetProgramInfoLog(program_, sizeof log, nullptr, log);
    return Error{ErrorKind::failed, "shaders/" + name, "", log};
}

}  // namespace talbot
