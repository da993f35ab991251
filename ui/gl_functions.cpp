#include "ui/gl_functions.h"

namespace talbot {

std::string load_gl_functions(GlFunctions& gl, const std::function<GlProc(const char*)>& load) {
#define TALBOT_GL_LOAD(type, name)                      \
    gl.name = reinterpret_cast<type>(load("gl" #name)); \
    if (!gl.name) return "gl" #name;
    TALBOT_GL_FUNCTIONS(TALBOT_GL_LOAD)
#undef TALBOT_GL_LOAD
    return {};
}

}  // namespace talbot
