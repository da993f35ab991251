#version 330 core
// Panels in framebuffer pixels, from the top left corner.
in vec2 position;
in vec2 uv;
in vec4 color;
out vec2 fragment_uv;
out vec4 fragment_color;

uniform vec2 framebuffer_size;

void main() {
    fragment_uv = uv;
    fragment_color = color;
    gl_Position = vec4(2.0 * position.x / framebuffer_size.x - 1.0, 1.0 - 2.0 * position.y / framebuffer_size.y, 0.0, 1.0);
}
