// Vectors, matrices and colours: the only file that includes GLM. Right-handed, +Y up, column
// vectors, metres.
#pragma once

#ifndef GLM_FORCE_EXPLICIT_CTOR
#define GLM_FORCE_EXPLICIT_CTOR
#endif
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#pragma GCC diagnostic pop

#include <numbers>

namespace talbot {

using Vec2f = glm::vec2;
using Vec3f = glm::vec3;
using Vec4f = glm::vec4;
using Vec2d = glm::dvec2;
using Vec3d = glm::dvec3;
using Vec4d = glm::dvec4;
using Mat3f = glm::mat3;
using Mat3d = glm::dmat3;
using Mat4d = glm::dmat4;
using Quatd = glm::dquat;

// Linear RGB with Rec. 709 primaries: radiance, reflectance or throughput.
using Rgb = glm::vec3;

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;
inline constexpr float kInfinity = __builtin_huge_valf();

using glm::cross;
using glm::dot;
using glm::length;
using glm::normalize;

inline float max_component(const Vec3f& v) {
    return glm::max(v.x, glm::max(v.y, v.z));
}
inline double max_component(const Vec3d& v) {
    return glm::max(v.x, glm::max(v.y, v.z));
}
inline float min_component(const Vec3f& v) {
    return glm::min(v.x, glm::min(v.y, v.z));
}

// Rec. 709 relative luminance.
inline float luminance(const Rgb& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

inline bool is_black(const Rgb& c) {
    return c.x == 0 && c.y == 0 && c.z == 0;
}

}  // namespace talbot
