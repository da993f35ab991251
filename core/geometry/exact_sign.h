// The exact sign of a scalar triple product of float vectors, for the few cases that rounded
// arithmetic cannot decide.
#pragma once

#include "core/math/vec.h"

namespace talbot {

// d . ((p - o) x (q - o)) with its exact sign and an error below one part in 2^50. Zero means
// exactly zero.
double exact_triple_product(const Vec3f& d, const Vec3f& o, const Vec3f& p, const Vec3f& q);

// (p - o) . ((q - o) x (r - o)), likewise.
double exact_volume(const Vec3f& o, const Vec3f& p, const Vec3f& q, const Vec3f& r);

// Whether the three points lie on one line (coincident points included), decided exactly.
bool exactly_collinear(const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace talbot
