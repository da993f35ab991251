#include "core/scene/mesh.h"

#include <algorithm>
#include <cmath>

namespace talbot {

Vec2f sphere_uv(const Vec3f& n) {
    return Vec2f(std::atan2(n.x, n.z) * (0.5f * kInvPi) + 0.5f,
                 std::acos(std::clamp(n.y, -1.0f, 1.0f)) * kInvPi);
}

}  // namespace talbot
