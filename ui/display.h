// The rendered image on the screen: float textures, uploaded only when they are new, and one
// full-screen pass that develops them (shaders/display.frag). Changing how it looks never touches
// the render.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/film/tone_map.h"
#include "core/session/snapshot.h"
#include "ui/gl_context.h"
#include "ui/shader_program.h"

namespace talbot {

// A part of the framebuffer, from its top left corner, in pixels.
struct PixelRect {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    bool contains(float px, float py) const {
        return px >= static_cast<float>(x) && py >= static_cast<float>(y) &&
               px < static_cast<float>(x + width) && py < static_cast<float>(y + height);
    }
    bool operator==(const PixelRect&) const = default;
};

// The largest part of the area, centred, that has the image's shape; not larger than the image
// unless enlarge is set.
PixelRect fit_image(const PixelRect& area, uint32_t image_width, uint32_t image_height,
                    bool enlarge);

struct DisplayOverlay {
    std::optional<uint32_t> selected_object;
    bool false_color = false;
    AovLook look = AovLook::radiance;  // what the values of the image are
    Rgb range_lower{0};                // of them, for looks that are relative
    Rgb range_upper{1};
    float scale = 1;  // of outline and checkerboard: the content scale
};

class Display {
  public:
    explicit Display(const GlFunctions& gl) : gl_(gl) {}
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    Status load();

    // Takes over what is new in the snapshot; returns whether anything was.
    bool update(const Snapshot& snapshot);
    bool update(const std::shared_ptr<const ImageRgba>& image,
                const std::shared_ptr<const std::vector<uint32_t>>& object_ids, uint32_t id_width,
                uint32_t id_height);

    // Into the bound framebuffer; nothing before the first image.
    void draw(const PixelRect& rect, PixelSize framebuffer, const DisplaySettings& settings,
              const DisplayOverlay& overlay);

  private:
    // The shader for a look, compiled when it is first asked for.
    Result<const ShaderProgram*> program_for(const DisplaySettings& settings, bool has_alpha,
                                             bool outlined, const DisplayOverlay& overlay);
    void upload_image();
    void upload_object_ids(uint32_t width, uint32_t height);

    const GlFunctions& gl_;
    std::map<std::string, std::unique_ptr<ShaderProgram>> programs_;  // by their defines
    GLuint vertex_array_ = 0;
    GLuint image_texture_ = 0;
    GLuint alpha_texture_ = 0;
    GLuint object_texture_ = 0;
    PixelSize image_size_;
    PixelSize alpha_size_;
    PixelSize object_size_;
    std::shared_ptr<const ImageRgba> image_;
    std::shared_ptr<const std::vector<uint32_t>> object_ids_;
};

}  // namespace talbot
