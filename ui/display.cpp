#include "ui/display.h"

#include <algorithm>
#include <cmath>

#include "core/base/log.h"
#include "core/math/ray.h"

namespace talbot {
namespace {

// Texels of one texture; keeps the storage while the size stays.
void upload(const GlFunctions& gl, GLuint texture, PixelSize& stored, PixelSize size,
            GLint internal_format, GLenum format, GLenum type, const void* texels) {
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (stored == size) {
        gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size.width, size.height, format, type, texels);
    } else {
        gl.TexImage2D(GL_TEXTURE_2D, 0, internal_format, size.width, size.height, 0, format, type,
                      texels);
        stored = size;
    }
}

void set_sampling(const GlFunctions& gl, GLenum unit, GLuint texture, GLint filter) {
    gl.ActiveTexture(unit);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

}  // namespace

PixelRect fit_image(const PixelRect& area, uint32_t image_width, uint32_t image_height,
                    bool enlarge) {
    if (image_width == 0 || image_height == 0 || area.width <= 0 || area.height <= 0) return area;
    double scale = std::min(static_cast<double>(area.width) / image_width,
                            static_cast<double>(area.height) / image_height);
    if (!enlarge) scale = std::min(scale, 1.0);
    PixelRect rect;
    rect.width = std::max(1, static_cast<int>(std::lround(image_width * scale)));
    rect.height = std::max(1, static_cast<int>(std::lround(image_height * scale)));
    rect.x = area.x + (area.width - rect.width) / 2;
    rect.y = area.y + (area.height - rect.height) / 2;
    return rect;
}

Display::~Display() {
    if (!vertex_array_) return;
    const GLuint textures[] = {image_texture_, alpha_texture_, object_texture_};
    gl_.DeleteTextures(3, textures);
    gl_.DeleteVertexArrays(1, &vertex_array_);
}

Status Display::load() {
    if (const auto loaded = program_for({}, false, false, {}); !loaded) return loaded.error();
    gl_.GenVertexArrays(1, &vertex_array_);
    GLuint textures[3] = {};
    gl_.GenTextures(3, textures);
    image_texture_ = textures[0];
    alpha_texture_ = textures[1];
    object_texture_ = textures[2];

    // Textures that a draw does not need must still be complete.
    const float black[3] = {0, 0, 0};
    const uint32_t no_object = kNoId;
    upload(gl_, image_texture_, image_size_, {1, 1}, GL_RGB32F, GL_RGB, GL_FLOAT, black);
    upload(gl_, alpha_texture_, alpha_size_, {1, 1}, GL_R32F, GL_RED, GL_FLOAT, black);
    upload(gl_, object_texture_, object_size_, {1, 1}, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT,
           &no_object);
    return Done{};
}

Result<const ShaderProgram*> Display::program_for(const DisplaySettings& settings, bool has_alpha,
                                                  bool outlined, const DisplayOverlay& overlay) {
    std::string defines;
    const auto define = [&](const char* name, int value) {
        defines += std::string("#define ") + name + ' ' + std::to_string(value) + '\n';
    };
    define("HAS_ALPHA", has_alpha);
    define("HAS_OUTLINE", outlined);
    define("FALSE_COLOR", overlay.false_color);
    define("TONE_MAP", static_cast<int>(settings.tone_map));
    define("CHANNEL", static_cast<int>(settings.channel));
    define("LOOK", static_cast<int>(overlay.look));
    std::unique_ptr<ShaderProgram>& program = programs_[defines];
    if (!program) {
        auto compiled = std::make_unique<ShaderProgram>(gl_);
        if (Status loaded = compiled->load("display", defines); !loaded) return loaded.error();
        program = std::move(compiled);
    }
    return program.get();
}

bool Display::update(const Snapshot& snapshot) {
    return update(snapshot.image, snapshot.object_ids, snapshot.full_width, snapshot.full_height);
}

bool Display::update(const std::shared_ptr<const ImageRgba>& image,
                     const std::shared_ptr<const std::vector<uint32_t>>& object_ids,
                     uint32_t id_width, uint32_t id_height) {
    bool changed = false;
    if (image && image != image_ && image->width > 0 && image->height > 0) {
        image_ = image;
        upload_image();
        changed = true;
    }
    if (object_ids != object_ids_) {
        object_ids_ = object_ids;
        const std::size_t expected = static_cast<std::size_t>(id_width) * id_height;
        if (object_ids_ && (expected == 0 || object_ids_->size() != expected)) object_ids_.reset();
        if (object_ids_) upload_object_ids(id_width, id_height);
        changed = true;
    }
    return changed;
}

void Display::upload_image() {
    const PixelSize size{static_cast<int>(image_->width), static_cast<int>(image_->height)};
    gl_.ActiveTexture(GL_TEXTURE0);
    upload(gl_, image_texture_, image_size_, size, GL_RGB32F, GL_RGB, GL_FLOAT, image_->rgb.data());
    if (!image_->alpha.empty()) {
        upload(gl_, alpha_texture_, alpha_size_, size, GL_R32F, GL_RED, GL_FLOAT,
               image_->alpha.data());
    }
}

void Display::upload_object_ids(uint32_t width, uint32_t height) {
    gl_.ActiveTexture(GL_TEXTURE0);
    upload(gl_, object_texture_, object_size_, {static_cast<int>(width), static_cast<int>(height)},
           GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, object_ids_->data());
}

void Display::draw(const PixelRect& rect, PixelSize framebuffer, const DisplaySettings& settings,
                   const DisplayOverlay& overlay) {
    if (!image_ || rect.width <= 0 || rect.height <= 0) return;
    const bool outlined = overlay.selected_object && object_ids_;

    // Pixels stay crisp where the image is shown in its own size or enlarged by a whole number.
    const bool whole = rect.width % image_size_.width == 0 && rect.height % image_size_.height == 0;
    const bool preview = rect.width > image_size_.width;
    set_sampling(gl_, GL_TEXTURE0, image_texture_, whole && !preview ? GL_NEAREST : GL_LINEAR);
    set_sampling(gl_, GL_TEXTURE1, alpha_texture_, whole && !preview ? GL_NEAREST : GL_LINEAR);
    set_sampling(gl_, GL_TEXTURE2, object_texture_, GL_NEAREST);

    const Result<const ShaderProgram*> found =
        program_for(settings, !image_->alpha.empty(), outlined, overlay);
    if (!found) {
        log_error(found.error().line());
        return;
    }
    const ShaderProgram& program = **found;
    program.use();
    gl_.Uniform1i(program.location("image"), 0);
    gl_.Uniform1i(program.location("coverage"), 1);
    gl_.Uniform1i(program.location("object_ids"), 2);
    gl_.Uniform1f(program.location("exposure_ev"), settings.exposure_ev);
    gl_.Uniform1ui(program.location("selected_object"), overlay.selected_object.value_or(kNoId));
    const float thickness = 2 * overlay.scale;
    gl_.Uniform2f(program.location("outline_uv"), thickness / static_cast<float>(rect.width),
                  thickness / static_cast<float>(rect.height));
    const Rgb& lower = overlay.range_lower;
    const Rgb& upper = overlay.range_upper;
    gl_.Uniform3f(program.location("range_lower"), lower.x, lower.y, lower.z);
    gl_.Uniform3f(program.location("range_upper"), upper.x, upper.y, upper.z);
    gl_.Uniform1f(program.location("checker_px"), 8 * overlay.scale);

    gl_.Viewport(rect.x, framebuffer.height - rect.y - rect.height, rect.width, rect.height);
    gl_.BindVertexArray(vertex_array_);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    gl_.BindVertexArray(0);
    gl_.ActiveTexture(GL_TEXTURE0);
}

}  // namespace talbot
