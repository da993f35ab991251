#include "ui/panel_renderer.h"

#include <imgui.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace talbot {

PanelRenderer::~PanelRenderer() {
    if (!vertex_array_) return;
    gl_.DeleteTextures(1, &atlas_);
    gl_.DeleteBuffers(1, &vertices_);
    gl_.DeleteBuffers(1, &indices_);
    gl_.DeleteVertexArrays(1, &vertex_array_);
}

Status PanelRenderer::load() {
    if (Status loaded = program_.load("panels"); !loaded) return loaded;
    gl_.GenVertexArrays(1, &vertex_array_);
    gl_.GenBuffers(1, &vertices_);
    gl_.GenBuffers(1, &indices_);
    gl_.GenTextures(1, &atlas_);

    gl_.BindVertexArray(vertex_array_);
    gl_.BindBuffer(GL_ARRAY_BUFFER, vertices_);
    gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    const auto attribute = [&](const char* name, GLint size, GLenum type, std::size_t offset) {
        const GLint location = program_.attribute(name);
        if (location < 0) return;
        const GLuint index = static_cast<GLuint>(location);
        gl_.EnableVertexAttribArray(index);
        gl_.VertexAttribPointer(index, size, type, type == GL_UNSIGNED_BYTE, sizeof(ImDrawVert),
                                reinterpret_cast<const void*>(offset));
    };
    attribute("position", 2, GL_FLOAT, offsetof(ImDrawVert, pos));
    attribute("uv", 2, GL_FLOAT, offsetof(ImDrawVert, uv));
    attribute("color", 4, GL_UNSIGNED_BYTE, offsetof(ImDrawVert, col));
    gl_.BindVertexArray(0);
    return Done{};
}

void PanelRenderer::upload_fonts() {
    unsigned char* texels = nullptr;
    int width = 0;
    int height = 0;
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->GetTexDataAsRGBA32(&texels, &width, &height);
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.BindTexture(GL_TEXTURE_2D, atlas_);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels);
    io.Fonts->SetTexID(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(atlas_)));
    io.Fonts->ClearTexData();
}

void PanelRenderer::draw(const ImDrawData& data, PixelSize framebuffer) {
    gl_.Viewport(0, 0, framebuffer.width, framebuffer.height);
    gl_.Enable(GL_BLEND);
    gl_.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl_.Enable(GL_SCISSOR_TEST);
    program_.use();
    gl_.Uniform1i(program_.location("atlas"), 0);
    gl_.Uniform2f(program_.location("framebuffer_size"), static_cast<float>(framebuffer.width),
                  static_cast<float>(framebuffer.height));
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.BindVertexArray(vertex_array_);
    gl_.BindBuffer(GL_ARRAY_BUFFER, vertices_);

    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        gl_.BufferData(GL_ARRAY_BUFFER, list.VtxBuffer.size_in_bytes(), list.VtxBuffer.Data,
                       GL_STREAM_DRAW);
        gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, list.IdxBuffer.size_in_bytes(), list.IdxBuffer.Data,
                       GL_STREAM_DRAW);
        for (const ImDrawCmd& command : list.CmdBuffer) {
            if (command.UserCallback) {
                if (command.UserCallback != ImDrawCallback_ResetRenderState) {
                    command.UserCallback(&list, &command);
                }
                continue;
            }
            const int left = std::max(0, static_cast<int>(command.ClipRect.x));
            const int top = std::max(0, static_cast<int>(command.ClipRect.y));
            const int right = std::min(framebuffer.width, static_cast<int>(command.ClipRect.z));
            const int bottom = std::min(framebuffer.height, static_cast<int>(command.ClipRect.w));
            if (right <= left || bottom <= top) continue;
            gl_.Scissor(left, framebuffer.height - bottom, right - left, bottom - top);
            gl_.BindTexture(GL_TEXTURE_2D,
                            static_cast<GLuint>(reinterpret_cast<uintptr_t>(command.GetTexID())));
            gl_.DrawElementsBaseVertex(
                GL_TRIANGLES, static_cast<GLsizei>(command.ElemCount),
                sizeof(ImDrawIdx) == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT,
                reinterpret_cast<const void*>(static_cast<uintptr_t>(command.IdxOffset) *
                                              sizeof(ImDrawIdx)),
                static_cast<GLint>(command.VtxOffset));
        }
    }
    gl_.Disable(GL_SCISSOR_TEST);
    gl_.Disable(GL_BLEND);
    gl_.BindVertexArray(0);
}

}  // namespace talbot
