// Tolerances of ray traversal. All of them are relative (multiples of the unit roundoff) or powers
// of two that only bound the range of coordinates, so that scaling a scene by a power of two
// changes no bit.
#pragma once

namespace talbot {

// A vertex or ray origin beyond this (in metres) is treated as not finite: squares and their
// products stay in range below it.
inline constexpr float kMaxCoordinate = 0x1p50f;

// The largest component of a direction must lie between these for the float kernels; others are
// rescaled by a power of two.
inline constexpr float kMinDirection = 0x1p-16f;
inline constexpr float kMaxDirection = 0x1p16f;
// Those powers of two and their reciprocals are normal floats, for denormals may count as zero.
inline constexpr int kMaxScaleExponent = 126;

// A direction component below this share of the largest one counts as parallel to the slab.
inline constexpr float kParallelShare = 0x1p-60f;
// Its reciprocal is then a power of two, so that the sign of (plane - origin) survives, and the
// slab's pad is this many times the largest t of interest, so that the slab never limits a ray that
// runs inside or on it.
inline constexpr float kParallelReciprocal = 0x1p76f;
inline constexpr float kParallelReach = 0x1p35f;

// Slabs. With r = fl(1 / d) and c = fl(o r), a plane p is met at fl(p r - c). Against (p - o) / d
// that carries at most 3 eps |t| from the reciprocal, a product that may be rounded, and the last
// rounding, and at most 3 eps |c| from c itself and from a rounded product; padding c and scaling
// it for far planes adds two more (after Ize 2013, section 3, for the form with one product).
inline constexpr float kSlabOriginPad = 0x7p-24f;
// Near and far differ by at most 7 eps relative, and the reported t is rounded once more.
inline constexpr float kSlabFarFactor = 1 + 0x10p-24f;

// Beams. Bounds of t carry four roundings; where denormals count as zero, planes and products are
// off by less than the least float and its product with the largest reciprocal. Directions that
// come nearer to no slope along an axis count as having both signs.
inline constexpr float kBeamPad = 0x1p-20f;
inline constexpr float kLeastBeamSlope = 0x1p-60f;
inline constexpr float kLeastBeamTime = 0x1p-64f;

// Edge functions of a triangle sheared along the ray (Woop, Benthin, Wald 2013): with e the largest
// coordinate difference between two vertices and z the depth of one, a computed edge function
// differs from the exact one by at most eps e (40 z + 160 e) whenever the ray meets the triangle
// (first-order terms; the constants below leave a fifth for the rest).
inline constexpr float kEdgeErrorDepth = 48;
inline constexpr float kEdgeErrorExtent = 4;
inline constexpr double kDoubleEpsilon = 0x1p-53;
// Doubled area in units of the error above, below which barycentrics are computed exactly.
inline constexpr double kWellShaped = 0x1p22;
// Depth of a hit in units of the triangle's own depth, below which it is computed exactly.
inline constexpr double kInPlaneShare = 0x1p-28;

// Boxes of parts of a triangle are widened by this share of its extent: four times what the clipped
// point may be off, and more than what rounding shifts a hit (barycentrics are exact to
// 1 / kWellShaped), and by this share of their coordinates, for rounding.
inline constexpr float kSplitPad = 0x1p-20f;
inline constexpr float kSplitRounding = 0x1p-22f;
// Boxes thinner than this are not split by planes: the above would be denormal.
inline constexpr float kMinSplitExtent = 0x1p-60f;

// World bounds of an instance are widened by this share of the largest coordinate, and those of
// all its neighbours by this share of the ray's origin: the ray is rounded once in object space.
inline constexpr double kInstanceBoundsPad = 0x40p-24;

// The boxes of spheres are widened by this share of their radius and coordinates: a root in double
// takes rays for tangents that pass the sphere by a few 2^-53 of its size.
inline constexpr double kSphereBoundsPad = 0x1p-48;

// A point on a ray that lies further than this share of the coordinates short of a surface is not
// taken beyond it by rounding, unless the ray runs within 2^-16 radians of that surface.
inline constexpr float kNearSurface = 0x1p-8f;

}  // namespace talbot
