// The two makers of contexts without a window. Both libraries are opened when asked for.
#pragma once

#include "ui/gl_context.h"

namespace talbot {

// EGL on Mesa's surfaceless platform: the GPU where there is one, llvmpipe elsewhere.
Result<std::unique_ptr<GlContext>> make_egl_context(PixelSize size);

// Mesa's off-screen library: software, no device, no EGL.
Result<std::unique_ptr<GlContext>> make_osmesa_context(PixelSize size);

// A context that draws into a renderbuffer of its own.
class OffscreenContext : public GlContext {
  public:
    PixelSize size() const override { return size_; }
    void bind_framebuffer() override;
    void present() override;
    void resize(PixelSize size) override;

  protected:
    // To be called once gl_ is loaded and the context current; what the driver refuses, in words,
    // or nothing.
    std::string make_framebuffer(PixelSize size);
    void delete_framebuffer();

  private:
    PixelSize size_;
    GLuint framebuffer_ = 0;
    GLuint color_ = 0;
};

}  // namespace talbot
