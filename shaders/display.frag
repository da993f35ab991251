#version 330 core
// From scene-linear radiance to the screen: channel, exposure, tone curve, sRGB, checkerboard, outline of the selection.
// The tone curves are the twin of core/film/tone_map.cpp; the numbers of tone maps and channels are its enumerators.
// Compiled for each look with HAS_ALPHA, HAS_OUTLINE, FALSE_COLOR (0 or 1), TONE_MAP, CHANNEL and LOOK, for software
// rasterisers pay for both sides of every branch. LOOK is an enumerator of AovLook in core/film/aov.h.
in vec2 image_uv;
out vec4 fragment;

uniform sampler2D image;        // RGB, premultiplied where has_alpha is set
uniform sampler2D coverage;     // R: alpha
uniform usampler2D object_ids;  // R
uniform float exposure_ev;
uniform uint selected_object;
uniform vec2 outline_uv;        // thickness of the outline in image_uv
uniform float checker_px;
uniform vec3 range_lower;       // of the values, for looks that are relative
uniform vec3 range_upper;

const float kLargestExposed = 1048576.0;

vec3 tone_map_aces(vec3 c) {
    vec3 v = vec3(0.59719 * c.x + 0.35458 * c.y + 0.04823 * c.z,
                  0.07600 * c.x + 0.90834 * c.y + 0.01566 * c.z,
                  0.02840 * c.x + 0.13383 * c.y + 0.83777 * c.z);
    vec3 a = v * (v + 0.0245786) - 0.000090537;
    vec3 b = v * (0.983729 * v + 0.4329510) + 0.238081;
    vec3 f = a / b;
    return vec3(1.60475 * f.x - 0.53108 * f.y - 0.07367 * f.z,
                -0.10208 * f.x + 1.10813 * f.y - 0.00605 * f.z,
                -0.00327 * f.x - 0.07276 * f.y + 1.07602 * f.z);
}

vec3 agx_contrast(vec3 x) {
    vec3 x2 = x * x;
    vec3 x4 = x2 * x2;
    return 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
}

vec3 tone_map_agx(vec3 c) {
    const float kMinEv = -12.47393;
    const float kMaxEv = 4.026069;
    vec3 inset = vec3(0.842479062 * c.x + 0.0784336 * c.y + 0.0792237451 * c.z,
                      0.0423282423 * c.x + 0.878468636 * c.y + 0.0791661275 * c.z,
                      0.0423756549 * c.x + 0.0784336 * c.y + 0.879142974 * c.z);
    vec3 ev = log2(max(inset, vec3(exp2(kMinEv))));
    vec3 v = agx_contrast(clamp((ev - kMinEv) / (kMaxEv - kMinEv), 0.0, 1.0));
    vec3 outset = vec3(1.196879005 * v.x - 0.0980208811 * v.y - 0.0990297441 * v.z,
                       -0.0528968518 * v.x + 1.15190313 * v.y - 0.0989611768 * v.z,
                       -0.0529716355 * v.x - 0.0980434501 * v.y + 1.151073673 * v.z);
    return pow(clamp(outset, 0.0, 1.0), vec3(2.2));
}

vec3 tone_map_neutral(vec3 c) {
    const float kStartCompression = 0.8 - 0.04;
    const float kDesaturation = 0.15;
    float x = min(c.x, min(c.y, c.z));
    float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
    vec3 v = c - offset;
    float peak = max(v.x, max(v.y, v.z));
    if (peak < kStartCompression) return v;
    float d = 1.0 - kStartCompression;
    float new_peak = 1.0 - d * d / (peak + d - kStartCompression);
    vec3 compressed = v * (new_peak / peak);
    float g = 1.0 - 1.0 / (kDesaturation * (peak - new_peak) + 1.0);
    return compressed + g * (vec3(new_peak) - compressed);
}

// On the bits: comparisons with NaN do not survive every shader compiler.
bool is_finite(vec3 v) {
    const uint kExponent = 0x7F800000u;
    uvec3 exponent = floatBitsToUint(v) & kExponent;
    return exponent.x != kExponent && exponent.y != kExponent && exponent.z != kExponent;
}

vec3 apply_tone_map(vec3 exposed) {
    if (!is_finite(exposed)) return vec3(1.0, 0.0, 1.0);
    vec3 c = clamp(exposed, 0.0, kLargestExposed);
    vec3 mapped = c;
    if (TONE_MAP == 1) mapped = tone_map_aces(c);
    if (TONE_MAP == 2) mapped = tone_map_agx(c);
    if (TONE_MAP == 3) mapped = tone_map_neutral(c);
    return clamp(mapped, 0.0, 1.0);
}

float srgb_from_linear(float linear) {
    if (linear <= 0.0031308) return 12.92 * linear;
    return 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

float luminance(vec3 c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

vec3 select_channel(vec3 exposed) {
    if (CHANNEL == 1) return vec3(exposed.x);
    if (CHANNEL == 2) return vec3(exposed.y);
    if (CHANNEL == 3) return vec3(exposed.z);
    if (CHANNEL == 5) return vec3(luminance(exposed));
    return exposed;
}

// Sixteen stops of luminance as bands of colour, from -8 EV (violet) over 0 EV (green) to +7 EV (red); display-encoded.
vec3 false_color_of(vec3 exposed) {
    float ev = floor(log2(max(luminance(exposed), exp2(-16.0))));
    float hue = 4.7 * (1.0 - clamp((ev + 8.0) / 15.0, 0.0, 1.0));
    vec3 color = clamp(vec3(abs(hue - 3.0) - 1.0, 2.0 - abs(hue - 2.0), 2.0 - abs(hue - 4.0)), 0.0, 1.0);
    return color * (mod(ev, 2.0) < 1.0 ? 1.0 : 0.86);
}

// From dark blue over green to yellow, evenly brighter; display-encoded. The twin of ui/false_color.h.
vec3 scale_color(float t) {
    const vec3 c0 = vec3(0.2777273, 0.0054073, 0.3340998);
    const vec3 c1 = vec3(0.1050930, 1.4046135, 1.3845902);
    const vec3 c2 = vec3(-0.3308618, 0.2148476, 0.0950952);
    const vec3 c3 = vec3(-4.6342305, -5.7991010, -19.3324410);
    const vec3 c4 = vec3(6.2282699, 14.1799334, 56.6905526);
    const vec3 c5 = vec3(4.7763850, -13.7451454, -65.3530326);
    const vec3 c6 = vec3(-5.4354559, 4.6458526, 26.3124352);
    return clamp(c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6))))), 0.0, 1.0);
}

// A colour of its own for every number.
vec3 id_color(float id) {
    if (id < 0.0) return vec3(0.05);
    float hue = fract(id * 0.61803399) * 6.0;
    vec3 color = clamp(vec3(abs(hue - 3.0) - 1.0, 2.0 - abs(hue - 2.0), 2.0 - abs(hue - 4.0)), 0.0, 1.0);
    return mix(vec3(0.25 + 0.5 * fract(id * 0.7548777)), color, 0.65);
}

// Values that are no light; display-encoded.
vec3 look_at_value(vec3 value) {
    if (!is_finite(value)) return vec3(0.0);
    if (LOOK == 1) {
        vec3 c = clamp(value, 0.0, 1.0);
        return vec3(srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z));
    }
    if (LOOK == 2) return 0.5 + 0.5 * value;
    if (LOOK == 4) return id_color(floor(value.x + 0.5));
    vec3 span = max(range_upper - range_lower, vec3(1e-30));
    vec3 t = clamp((value - range_lower) / span, 0.0, 1.0);
    if (LOOK == 5) return scale_color(t.x);
    return t;
}

vec3 checkerboard() {
    vec2 cell = floor(gl_FragCoord.xy / checker_px);
    return mod(cell.x + cell.y, 2.0) < 1.0 ? vec3(0.32) : vec3(0.42);
}

bool is_selected(vec2 uv) {
    ivec2 extent = textureSize(object_ids, 0);
    ivec2 texel = clamp(ivec2(floor(uv * vec2(extent))), ivec2(0), extent - 1);
    return texelFetch(object_ids, texel, 0).r == selected_object;
}

// On the rim just outside the selected object.
bool is_on_outline(vec2 uv) {
    if (is_selected(uv)) return false;
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            float reach = x != 0 && y != 0 ? 0.7071 : 1.0;
            if (is_selected(uv + reach * outline_uv * vec2(float(x), float(y)))) return true;
        }
    }
    return false;
}

void main() {
    float alpha = HAS_ALPHA != 0 ? texture(coverage, image_uv).r : 1.0;
    vec3 encoded;
    if (LOOK != 0) {
        vec3 value = texture(image, image_uv).rgb;
        if (LOOK == 4) {
            ivec2 extent = textureSize(image, 0);
            value = texelFetch(image, clamp(ivec2(floor(image_uv * vec2(extent))), ivec2(0), extent - 1), 0).rgb;
        }
        encoded = look_at_value(value);
    } else if (CHANNEL == 4) {
        encoded = vec3(clamp(alpha, 0.0, 1.0));
    } else {
        vec3 exposed = texture(image, image_uv).rgb * exp2(exposure_ev);
        bool straight_alpha = HAS_ALPHA != 0 && CHANNEL == 0;
        if (straight_alpha) exposed = alpha > 0.0 ? exposed / alpha : vec3(0.0);
        vec3 mapped = apply_tone_map(select_channel(exposed));
        encoded = vec3(srgb_from_linear(mapped.x), srgb_from_linear(mapped.y), srgb_from_linear(mapped.z));
        if (FALSE_COLOR != 0 && is_finite(exposed)) encoded = false_color_of(exposed);
        if (straight_alpha) encoded = mix(checkerboard(), encoded, clamp(alpha, 0.0, 1.0));
    }
    if (HAS_OUTLINE != 0 && is_on_outline(image_uv)) encoded = vec3(1.0, 0.58, 0.1);
    fragment = vec4(encoded, 1.0);
}
