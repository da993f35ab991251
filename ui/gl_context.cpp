#include "ui/gl_context.h"

#include <algorithm>

#include "ui/gl_offscreen.h"

namespace talbot {

ImageBytes GlContext::read_pixels() {
    const PixelSize extent = size();
    ImageBytes image;
    image.width = static_cast<uint32_t>(extent.width);
    image.height = static_cast<uint32_t>(extent.height);
    image.channels = 3;
    const std::size_t stride = static_cast<std::size_t>(image.width) * 3;
    image.bytes.resize(stride * image.height);
    bind_framebuffer();
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.ReadPixels(0, 0, extent.width, extent.height, GL_RGB, GL_UNSIGNED_BYTE, image.bytes.data());
    // OpenGL's first row is the lowest one.
    for (uint32_t y = 0; y < image.height / 2; ++y) {
        uint8_t* upper = image.bytes.data() + stride * y;
        uint8_t* lower = image.bytes.data() + stride * (image.height - 1 - y);
        std::swap_ranges(upper, upper + stride, lower);
    }
    return image;
}

std::string GlContext::description() const {
    const auto text = [&](GLenum name) {
        const GLubyte* value = gl_.GetString(name);
        return value ? std::string(reinterpret_cast<const char*>(value)) : std::string("unknown");
    };
    return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
}

Result<std::unique_ptr<GlContext>> make_offscreen_context(PixelSize size, OffscreenKind kind) {
    std::string why;
    if (kind != OffscreenKind::osmesa) {
        Result<std::unique_ptr<GlContext>> context = make_egl_context(size);
        if (context) return context;
        why = context.error().what;
    }
    if (kind != OffscreenKind::egl) {
        Result<std::unique_ptr<GlContext>> context = make_osmesa_context(size);
        if (context) return context;
        why += (why.empty() ? "" : "; ") + context.error().what;
    }
    return Error{
        ErrorKind::failed, "", "OpenGL",
        "no offscreen context: " + why + " (install libegl1 and libgl1-mesa-dri, or libosmesa6)"};
}

}  // namespace talbot
