#include "ui/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>

namespace talbot {
namespace {

static_assert(static_cast<int>(Key::a) == GLFW_KEY_A &&
              static_cast<int>(Key::space) == GLFW_KEY_SPACE);
static_assert(static_cast<int>(Key::escape) == GLFW_KEY_ESCAPE &&
              static_cast<int>(Key::end) == GLFW_KEY_END);
static_assert(static_cast<int>(Key::f1) == GLFW_KEY_F1 &&
              static_cast<int>(Key::right_alt) == GLFW_KEY_RIGHT_ALT);

// What GLFW said last; its callback has no other place to put it.
std::string& last_error() {
    static std::string text;
    return text;
}

}  // namespace

Window& Window::from(GLFWwindow* window) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

Result<std::unique_ptr<Window>> Window::open(PixelSize size, const std::string& title) {
    last_error().clear();
    glfwSetErrorCallback([](int, const char* text) { last_error() = text; });
    const auto failed = [](const std::string& what) {
        return Error{ErrorKind::failed, "", "window",
                     what + (last_error().empty() ? "" : " (" + last_error() + ")") +
                         "; without a display, render headless with --frames N --output FILE"};
    };
    if (!glfwInit()) return failed("no display to open a window on");
    std::unique_ptr<Window> window(new Window());
    if (GLFWmonitor* monitor = glfwGetPrimaryMonitor()) {
        int x = 0, y = 0, width = 0, height = 0;
        glfwGetMonitorWorkarea(monitor, &x, &y, &width, &height);
        // The window grows by the monitor's scale.
        float scale_x = 1, scale_y = 1;
        glfwGetMonitorContentScale(monitor, &scale_x, &scale_y);
        const auto fitting = [](int wanted, int room, float scale) {
            return std::min(wanted, static_cast<int>(static_cast<float>(room) / scale));
        };
        if (width > 0 && height > 0 && scale_x > 0 && scale_y > 0)
            size = {fitting(size.width, width, scale_x), fitting(size.height, height, scale_y)};
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "talbot");
    window->window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
    if (!window->window_) return failed("the window or its OpenGL 3.3 context cannot be made");
    glfwMakeContextCurrent(window->window_);
    glfwSwapInterval(1);
    const std::string missing =
        load_gl_functions(window->gl_, [](const char* name) { return glfwGetProcAddress(name); });
    if (!missing.empty()) return failed("the graphics driver lacks " + missing);
    window->install_callbacks();
    return window;
}

Window::~Window() {
    for (GLFWcursor* cursor : cursors_) {
        if (cursor) glfwDestroyCursor(cursor);
    }
    if (window_) glfwDestroyWindow(window_);
    glfwTerminate();
}

PixelSize Window::size() const {
    PixelSize pixels;
    glfwGetFramebufferSize(window_, &pixels.width, &pixels.height);
    return {std::max(pixels.width, 1), std::max(pixels.height, 1)};
}

float Window::content_scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return std::clamp(std::max(x, y), 0.5f, 8.0f);
}

float Window::pixels_per_unit() const {
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    return width > 0 ? static_cast<float>(size().width) / static_cast<float>(width) : 1.0f;
}

void Window::bind_framebuffer() {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

void Window::present() {
    glfwSwapBuffers(window_);
}

void Window::resize(PixelSize size) {
    const float scale = pixels_per_unit();
    glfwSetWindowSize(window_, static_cast<int>(static_cast<float>(size.width) / scale),
                      static_cast<int>(static_cast<float>(size.height) / scale));
}

void Window::wait(InputQueue& queue, double seconds) {
    queue_ = &queue;
    if (seconds > 0) {
        glfwWaitEventsTimeout(seconds);
    } else {
        glfwPollEvents();
    }
    queue_ = nullptr;
}

void Window::wake() {
    glfwPostEmptyEvent();
}

void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(window_, title.c_str());
}

void Window::install_callbacks() {
    glfwSetWindowUserPointer(window_, this);
    const auto push = [](GLFWwindow* window, InputEvent event) {
        if (InputQueue* queue = from(window).queue_) queue->push(std::move(event));
    };
    static const auto forward = push;
    glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
        const float scale = from(window).pixels_per_unit();
        forward(window, InputEvent::pointer_at(static_cast<float>(x) * scale,
                                               static_cast<float>(y) * scale));
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
        if (button < GLFW_MOUSE_BUTTON_LEFT || button > GLFW_MOUSE_BUTTON_MIDDLE) return;
        forward(window,
                InputEvent::button_at(static_cast<MouseButton>(button), action == GLFW_PRESS));
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) {
        forward(window, InputEvent::wheel_by(static_cast<float>(x), static_cast<float>(y)));
    });
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
        if (key < 0 || key >= kKeyLimit || action == GLFW_REPEAT) return;
        forward(window, InputEvent::key_at(static_cast<Key>(key), action == GLFW_PRESS));
    });
    glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned codepoint) {
        forward(window, InputEvent::character_of(codepoint));
    });
    glfwSetWindowFocusCallback(window_, [](GLFWwindow* window, int focused) {
        if (focused) return;
        InputEvent event;
        event.kind = InputEvent::Kind::focus_lost;
        forward(window, event);
    });
    glfwSetWindowCloseCallback(window_, [](GLFWwindow* window) {
        InputEvent event;
        event.kind = InputEvent::Kind::close;
        forward(window, event);
    });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
        InputEvent event;
        event.kind = InputEvent::Kind::drop;
        event.files.assign(paths, paths + count);
        forward(window, event);
    });
}

void Window::follow_panels() {
    ImGuiIO& io = ImGui::GetIO();
    if (!io.SetClipboardTextFn || io.ClipboardUserData != window_) {
        io.ClipboardUserData = window_;
        io.SetClipboardTextFn = [](void* window, const char* text) {
            glfwSetClipboardString(static_cast<GLFWwindow*>(window), text);
        };
        io.GetClipboardTextFn = [](void* window) {
            return glfwGetClipboardString(static_cast<GLFWwindow*>(window));
        };
    }
    const int wanted = ImGui::GetMouseCursor();
    if (wanted == cursor_ || wanted < 0) return;
    cursor_ = wanted;
    const auto shape_of = [](int cursor) {
        switch (cursor) {
            case ImGuiMouseCursor_TextInput:
                return GLFW_IBEAM_CURSOR;
            case ImGuiMouseCursor_ResizeNS:
                return GLFW_VRESIZE_CURSOR;
            case ImGuiMouseCursor_ResizeEW:
                return GLFW_HRESIZE_CURSOR;
            case ImGuiMouseCursor_Hand:
                return GLFW_HAND_CURSOR;
            default:
                return GLFW_ARROW_CURSOR;
        }
    };
    if (wanted >= 9) return;
    if (!cursors_[wanted]) cursors_[wanted] = glfwCreateStandardCursor(shape_of(wanted));
    glfwSetCursor(window_, cursors_[wanted]);
}

}  // namespace talbot
