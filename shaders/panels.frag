#version 330 core
// Vertex colour times the texture: glyphs, and white for everything else.
in vec2 fragment_uv;
in vec4 fragment_color;
out vec4 fragment;

uniform sampler2D atlas;

void main() { fragment = fragment_color * texture(atlas, fragment_uv); }
