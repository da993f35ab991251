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
    // The tangent that lies nearest to a direction; any, where the direction is the normal or zero.
    static Frame from_normal_and_tangent(const Vec3f& normal, const Vec3f& direction) {
        Frame frame = from_normal(normal);
        frame.t = safe_normalize(direction - dot(direction, normal) * normal, frame.t);
        frame.b = cross(frame.n, frame.t);
        return frame;
    }
    Vec3f to_local(const Vec3f& v) const { return Vec3f(dot(v, t), dot(v, b), dot(v, n)); }
    Vec3f to_world(const Vec3f& v) const { return v.x * t + v.y * b + v.z * n; }
};

}  // namespace talbot
