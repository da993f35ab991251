// An OpenGL 3.3 core context with something to draw on: a window (ui/window.h), or a framebuffer
// without any display through EGL (surfaceless) or OSMesa. Sizes are in framebuffer pixels
// everywhere.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/film/image.h"
#include "ui/gl_functions.h"

namespace talbot {

struct PixelSize {
    int width = 0;
    int height = 0;

    bool operator==(const PixelSize&) const = default;
};

class GlContext {
  public:
    virtual ~GlContext() = default;
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    const GlFunctions& gl() const { return gl_; }

    virtual PixelSize size() const = 0;

    // How many pixels a length of 1 of the desktop takes: 1 on ordinary screens, 2 on dense ones.
    virtual float content_scale() const { return 1; }

    // Makes the framebuffer the target of what is drawn next.
    virtual void bind_framebuffer() = 0;

    // Shows what was drawn; offscreen it only flushes.
    virtual void present() = 0;

    // Offscreen framebuffers take the new size at once; a window asks its system for it.
    virtual void resize(PixelSize size) = 0;

    // What was drawn since the last present (offscreen: also after it), RGB, row 0 on top.
    ImageBytes read_pixels();

    // Renderer and version, for the report.
    std::string description() const;

  protected:
    GlContext() = default;

    GlFunctions gl_;
};

enum class OffscreenKind { any, egl, osmesa };

// A context without a window. `any` tries EGL, then OSMesa; the error says why each of them failed.
Result<std::unique_ptr<GlContext>> make_offscreen_context(PixelSize size,
                                                          OffscreenKind kind = OffscreenKind::any);

}  // namespace talbot
