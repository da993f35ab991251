// A local frame: z along the normal.
#pragma once

#include "core/math/robust.h"
#include "core/math/vec.h"

namespace talbot {

struct Frame {
    Vec3f t{1, 0, 0};
    Vec3f b{0, 1, 0};
    Vec3f n{0, 0, 1};

    // Any tangent.
    static Frame from_normal(const Vec3f& normal) {
        Frame frame;
        frame.n = normal;
        orthonormal_basis(normal, frame.t, frame.b);
        return frame;
    }
    Vec3f to_local(const Vec3f& v) const { return Vec3f(dot(v, t), dot(v, b), dot(v, n)); }
    Vec3f to_world(const Vec3f& v) const { return v.x * t + v.y * b + v.z * n; }
};

}  // namespace talbot
