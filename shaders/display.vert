#version 330 core
// One triangle over the whole viewport; image_uv runs from the top left corner of the image.
out vec2 image_uv;

void main() {
    vec2 corner = vec2(float((gl_VertexID & 1) << 2), float((gl_VertexID & 2) << 1));
    image_uv = vec2(0.5 * corner.x, 1.0 - 0.5 * corner.y);
    gl_Position = vec4(corner - 1.0, 0.0, 1.0);
}
