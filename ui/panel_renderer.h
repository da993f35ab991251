// Draws what Dear ImGui has laid out, with any context's functions (ImGui's own backend knows only
// the system's libGL, which does not work with OSMesa).
#pragma once

#include "core/base/result.h"
#include "ui/gl_context.h"
#include "ui/shader_program.h"

struct ImDrawData;

namespace talbot {

class PanelRenderer {
  public:
    explicit PanelRenderer(const GlFunctions& gl) : gl_(gl), program_(gl) {}
    ~PanelRenderer();
    PanelRenderer(const PanelRenderer&) = delete;
    PanelRenderer& operator=(const PanelRenderer&) = delete;

    Status load();

    // Uploads the glyphs of the current ImGui context's fonts; to be called again when they change.
    void upload_fonts();

    // Into the bound framebuffer. Leaves blending and the scissor test off.
    void draw(const ImDrawData& data, PixelSize framebuffer);

  private:
    const GlFunctions& gl_;
    ShaderProgram program_;
    GLuint vertex_array_ = 0;
    GLuint vertices_ = 0;
    GLuint indices_ = 0;
    GLuint atlas_ = 0;
};

}  // namespace talbot
