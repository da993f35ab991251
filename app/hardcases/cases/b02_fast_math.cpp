// B02: what -ffast-math takes away: NaN, infinity and the sign of zero; and a rounding that g++
// 12's vectorizer of straight code leaves out at -O2.
#include <bit>
#include <cmath>
#include <vector>

#include "app/hardcases/cases/b02_relaxed.h"
#include "app/hardcases/worst.h"
#include "core/base/float_probe.h"
#include "core/math/robust.h"

namespace talbot::hardcases::b02 {
namespace {

// A vertex normal turned into the world: to double, turned, to float, to double, to unit length, to
// float. The rounding in the middle is the one that goes missing.
[[gnu::noinline]] void turn(const Mat3d& m, std::vector<Vec3f>& normals) {
    for (Vec3f& n : normals) n = safe_normalize(Vec3f(m * Vec3d(n)), n);
}

Vec3f turned_with_rounding(const Mat3d& m, const Vec3f& n) {
    const Vec3d w = m * Vec3d(n);
    volatile float rounded[3] = {static_cast<float>(w.x), static_cast<float>(w.y),
                                 static_cast<float>(w.z)};
    const Vec3f v{rounded[0], rounded[1], rounded[2]};
    return safe_normalize(v, n);
}

Vec3f turned_without_rounding(const Mat3d& m, const Vec3f& n) {
    const Vec3d w = m * Vec3d(n);
    return Vec3f(w / std::sqrt(dot(w, w)));
}

Measure roundings_left_out() {
    const Mat3d m(0.6, 0, 0.8, 0, 1, 0, -0.8, 0, 0.6);
    std::vector<Vec3f> normals;
    for (int i = 0; i < 1000; ++i) {
        const float x = 0.01f * static_cast<float>(i);
        normals.push_back(Vec3f(0.3f + x, 1 - x, 0.7f * x * x));
    }
    std::vector<Vec3f> compiled = normals;
    turn(m, compiled);
    double naive = 0;
    double own = 0;
    for (size_t i = 0; i < normals.size(); ++i) {
        const Vec3f expected = turned_with_rounding(m, normals[i]);
        naive += turned_without_rounding(m, normals[i]) == expected ? 0 : 1;
        own += compiled[i] == expected ? 0 : 1;
    }
    return {"normals of 1000 that lack a rounding to float between doubles",
            naive,
            own,
            0,
            Gate::at_most,
            ""};
}

CaseResult run(Effort effort) {
    double naive = 0;
    double own = 0;
    const auto look = [&](uint32_t bits) {
        const float x = std::bit_cast<float>(bits);
        const bool finite = (bits & 0x7F800000u) != 0x7F800000u;
        naive += relaxed_is_finite(x) == finite ? 0 : 1;
        own += is_finite(x) == finite && is_finite(static_cast<double>(x)) == finite ? 0 : 1;
    };
    // All exponents, both signs, some mantissas; or everything.
    const uint64_t step = effort == Effort::full ? 1 : 4099;
    for (uint64_t bits = 0; bits <= 0xFFFFFFFFull; bits += step) look(static_cast<uint32_t>(bits));
    const FloatProbe probe = probe_floats();
    CaseResult result;
    result.measures.push_back(
        {"bit patterns whose finiteness is not told", naive, own, 0, Gate::at_most, ""});
    result.measures.push_back(
        {"rules of arithmetic that this build lacks (NaN, -0)", kNoControl,
         (probe.nan_is_unequal ? 0.0 : 1.0) + (probe.zero_has_sign ? 0.0 : 1.0), 0, Gate::at_most,
         ""});
    result.measures.push_back(roundings_left_out());
    return result;
}

const bool kAdded = add_case(
    {"B02", Priority::p0, "arithmetic is not relaxed", "std::isfinite under -ffinite-math-only",
     "fast-math is a compile error, finite tests look at bits, a probe at start",
     "google/filament#6558, buddhi1980/mandelbulber2#130", run});

}  // namespace
}  // namespace talbot::hardcases::b02
