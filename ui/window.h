// A window of the desktop, through GLFW: OpenGL context, input, drops, clipboard. One at a time, on
// the main thread.
#pragma once

#include <memory>
#include <string>

#include "ui/gl_context.h"
#include "ui/input.h"

struct GLFWwindow;
struct GLFWcursor;

namespace talbot {

class Window final : public GlContext {
  public:
    // The size is in desktop units and is cut to the screen; the error says what the window system
    // refuses.
    static Result<std::unique_ptr<Window>> open(PixelSize size, const std::string& title);
    ~Window() override;

    PixelSize size() const override;
    float content_scale() const override;
    void bind_framebuffer() override;
    void present() override;
    void resize(PixelSize size) override;

    // Sleeps until there is input, wake() is called or the time is over; passes on what happened.
    void wait(InputQueue& queue, double seconds);

    // Ends a wait; from any thread.
    static void wake();

    // Takes over the cursor's shape and the clipboard for the current ImGui context.
    void follow_panels();

    void set_title(const std::string& title);

  private:
    Window() = default;
    void install_callbacks();
    static Window& from(GLFWwindow* window);
    float pixels_per_unit() const;

    GLFWwindow* window_ = nullptr;
    InputQueue* queue_ = nullptr;
    GLFWcursor* cursors_[9] = {};
    int cursor_ = -1;
};

}  // namespace talbot
