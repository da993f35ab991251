#include "ui/gl_offscreen.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <vector>

namespace talbot {
namespace {

Error no_context(const std::string& what) {
    return {ErrorKind::failed, "", "OpenGL", what};
}

// A shared library for as long as the process runs: drivers do not survive being closed.
class Library {
  public:
    explicit Library(const std::vector<const char*>& names) {
        for (const char* name : names) {
            if ((handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL))) return;
        }
    }
    bool is_open() const { return handle_ != nullptr; }
    template <typename F>
    F find(const char* name) const {
        return reinterpret_cast<F>(dlsym(handle_, name));
    }

  private:
    void* handle_ = nullptr;
};

struct Egl {
    Library library{{"libEGL.so.1", "libEGL.so"}};
    using GetProcAddress = GlProc (*)(const char*);
    GetProcAddress get_proc_address = nullptr;
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
    PFNEGLINITIALIZEPROC initialize = nullptr;
    PFNEGLTERMINATEPROC terminate = nullptr;
    PFNEGLBINDAPIPROC bind_api = nullptr;
    PFNEGLCHOOSECONFIGPROC choose_config = nullptr;
    PFNEGLCREATECONTEXTPROC create_context = nullptr;
    PFNEGLDESTROYCONTEXTPROC destroy_context = nullptr;
    PFNEGLMAKECURRENTPROC make_current = nullptr;

    bool load() {
        if (!library.is_open()) return false;
        get_proc_address = library.find<GetProcAddress>("eglGetProcAddress");
        initialize = library.find<PFNEGLINITIALIZEPROC>("eglInitialize");
        terminate = library.find<PFNEGLTERMINATEPROC>("eglTerminate");
        bind_api = library.find<PFNEGLBINDAPIPROC>("eglBindAPI");
        choose_config = library.find<PFNEGLCHOOSECONFIGPROC>("eglChooseConfig");
        create_context = library.find<PFNEGLCREATECONTEXTPROC>("eglCreateContext");
        destroy_context = library.find<PFNEGLDESTROYCONTEXTPROC>("eglDestroyContext");
        make_current = library.find<PFNEGLMAKECURRENTPROC>("eglMakeCurrent");
        if (!get_proc_address) return false;
        get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
            get_proc_address("eglGetPlatformDisplayEXT"));
        return get_platform_display && initialize && terminate && bind_api && choose_config &&
               create_context && destroy_context && make_current;
    }
};

class EglContext final : public OffscreenContext {
  public:
    ~EglContext() override {
        if (context_ != EGL_NO_CONTEXT) {
            if (gl_.DeleteFramebuffers) delete_framebuffer();
            egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
            egl_.destroy_context(display_, context_);
        }
        if (display_ != EGL_NO_DISPLAY) egl_.terminate(display_);
    }

    // What failed, in words, or nothing.
    std::string open(PixelSize size) {
        if (!egl_.load()) return "libEGL.so.1 is missing or too old";
        display_ = egl_.get_platform_display(EGL_PLATFORM_SURFACELESS_MESA,
                                             reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr);
        if (display_ == EGL_NO_DISPLAY) return "EGL has no surfaceless platform";
        if (!egl_.initialize(display_, nullptr, nullptr)) {
            display_ = EGL_NO_DISPLAY;
            return "EGL does not initialise without a display";
        }
        if (!egl_.bind_api(EGL_OPENGL_API)) return "EGL has no desktop OpenGL";
        const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                 EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (!egl_.choose_config(display_, wanted, &config, 1, &count) || count < 1) {
            config = nullptr;  // EGL_KHR_no_config_context
        }
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     3,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     3,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
        context_ = egl_.create_context(display_, config, EGL_NO_CONTEXT, attributes);
        if (context_ == EGL_NO_CONTEXT) return "EGL gives no OpenGL 3.3 core context";
        if (!egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
            return "the EGL context needs a surface";
        }
        const std::string missing =
            load_gl_functions(gl_, [&](const char* name) { return egl_.get_proc_address(name); });
        if (!missing.empty()) return "EGL's OpenGL lacks " + missing;
        return make_framebuffer(size);
    }

  private:
    Egl egl_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    ::EGLContext context_ = EGL_NO_CONTEXT;
};

// From GL/osmesa.h, whose inclusion of GL/gl.h does not go together with the core profile's header.
struct OsMesa {
    static constexpr int kFormat = 0x22;
    static constexpr int kProfile = 0x33;
    static constexpr int kCoreProfile = 0x34;
    static constexpr int kMajorVersion = 0x36;
    static constexpr int kMinorVersion = 0x37;
    using Context = void*;

    Library library{{"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}};
    Context (*create_context)(const int* attributes, Context share) = nullptr;
    void (*destroy_context)(Context) = nullptr;
    GLboolean (*make_current)(Context, void* buffer, GLenum type, GLsizei width,
                              GLsizei height) = nullptr;
    GlProc (*get_proc_address)(const char*) = nullptr;

    bool load() {
        if (!library.is_open()) return false;
        create_context = library.find<decltype(create_context)>("OSMesaCreateContextAttribs");
        destroy_context = library.find<decltype(destroy_context)>("OSMesaDestroyContext");
        make_current = library.find<decltype(make_current)>("OSMesaMakeCurrent");
        get_proc_address = library.find<decltype(get_proc_address)>("OSMesaGetProcAddress");
        return create_context && destroy_context && make_current && get_proc_address;
    }
};

class OsMesaContext final : public OffscreenContext {
  public:
    ~OsMesaContext() override {
        if (!context_) return;
        if (gl_.DeleteFramebuffers) delete_framebuffer();
        mesa_.destroy_context(context_);
    }

    std::string open(PixelSize size) {
        if (!mesa_.load()) return "libOSMesa.so.8 is missing or too old";
        const int attributes[] = {OsMesa::kFormat,
                                  GL_RGBA,
                                  OsMesa::kProfile,
                                  OsMesa::kCoreProfile,
                                  OsMesa::kMajorVersion,
                                  3,
                                  OsMesa::kMinorVersion,
                                  3,
                                  0};
        context_ = mesa_.create_context(attributes, nullptr);
        if (!context_) return "OSMesa gives no OpenGL 3.3 core context";
        // Drawing goes to an own framebuffer; the context's one is a single pixel.
        if (!mesa_.make_current(context_, pixel_, GL_UNSIGNED_BYTE, 1, 1)) {
            return "OSMesa's context does not become current";
        }
        const std::string missing =
            load_gl_functions(gl_, [&](const char* name) { return mesa_.get_proc_address(name); });
        if (!missing.empty()) return "OSMesa's OpenGL lacks " + missing;
        return make_framebuffer(size);
    }

  private:
    OsMesa mesa_;
    OsMesa::Context context_ = nullptr;
    uint8_t pixel_[4] = {};
};

template <typename Context>
Result<std::unique_ptr<GlContext>> open_context(PixelSize size) {
    auto context = std::make_unique<Context>();
    const std::string failure = context->open(size);
    if (!failure.empty()) return no_context(failure);
    return std::unique_ptr<GlContext>(std::move(context));
}

}  // namespace

void OffscreenContext::bind_framebuffer() {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
}

void OffscreenContext::present() {
    gl_.Finish();
}

void OffscreenContext::resize(PixelSize size) {
    size_ = size;
    gl_.BindRenderbuffer(GL_RENDERBUFFER, color_);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size.width, size.height);
}

std::string OffscreenContext::make_framebuffer(PixelSize size) {
    gl_.GenFramebuffers(1, &framebuffer_);
    gl_.GenRenderbuffers(1, &color_);
    resize(size);
    bind_framebuffer();
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
    if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        return "the framebuffer of " + std::to_string(size.width) + "x" +
               std::to_string(size.height) + " pixels is refused";
    }
    return {};
}

void OffscreenContext::delete_framebuffer() {
    gl_.DeleteFramebuffers(1, &framebuffer_);
    gl_.DeleteRenderbuffers(1, &color_);
}

Result<std::unique_ptr<GlContext>> make_egl_context(PixelSize size) {
    return open_context<EglContext>(size);
}

Result<std::unique_ptr<GlContext>> make_osmesa_context(PixelSize size) {
    return open_context<OsMesaContext>(size);
}

}  // namespace talbot
