// L02: triangles by solid angle, from huge to tiny, slender, in their own plane and at a corner.
// The sum of three angles less pi cancels.
#include <numbers>

#include "app/hardcases/cases/light_setup.h"
#include "app/hardcases/cases/quad_float.h"
#include "core/lights/spherical_triangle.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::l02 {
namespace {

using Real = long double;
using RealVec = glm::vec<3, Real>;

struct QuadVec {
    Quad x, y, z;
};
QuadVec quad_of(const Vec3d& v) {
    return {v.x, v.y, v.z};
}
QuadVec operator-(const QuadVec& a, const QuadVec& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Quad dot(const QuadVec& a, const QuadVec& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
QuadVec cross(const QuadVec& a, const QuadVec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Van Oosterom and Strackee 1983, the products in 113 bits.
Real reference(const TriangleView& view) {
    const QuadVec a = quad_of(view.a);
    const QuadVec b = quad_of(view.b);
    const QuadVec c = quad_of(view.c);
    const Quad la = square_root(dot(a, a));
    const Quad lb = square_root(dot(b, b));
    const Quad lc = square_root(dot(c, c));
    const Quad triple = dot(a, cross(b - a, c - a));
    const Quad below = la * lb * lc + dot(a, b) * lc + dot(a, c) * lb + dot(b, c) * la;
    const Quad above = triple < 0 ? -triple : triple;
    return 2 * std::atan2(static_cast<Real>(above), static_cast<Real>(below));
}

// The control: angles between planes in float, their sum less pi (Girard).
float girard(const TriangleView& view) {
    const Vec3f a = normalize(Vec3f(view.a));
    const Vec3f b = normalize(Vec3f(view.b));
    const Vec3f c = normalize(Vec3f(view.c));
    const Vec3f ab = normalize(glm::cross(a, b));
    const Vec3f bc = normalize(glm::cross(b, c));
    const Vec3f ca = normalize(glm::cross(c, a));
    const auto angle = [](const Vec3f& x, const Vec3f& y) {
        return std::acos(std::clamp(-glm::dot(x, y), -1.0f, 1.0f));
    };
    return angle(ab, ca) + angle(bc, ab) + angle(ca, bc) - kPi;
}

// How far a point's barycentric weights lie outside [0, 1], the point dropped onto the plane,
// beyond what rounding its coordinates to float moves them: half a unit in the last place of each,
// over the height of the triangle.
Real outside(const Light& light, const Vec3f& point) {
    const RealVec e1(light.e1), e2(light.e2);
    const RealVec v = RealVec(point) - RealVec(light.p0);
    const RealVec n = glm::cross(e1, e2);
    const Real square = glm::dot(n, n);
    const Real b1 = glm::dot(glm::cross(v, e2), n) / square;
    const Real b2 = glm::dot(glm::cross(e1, v), n) / square;
    Real worst = 0;
    for (const Real b : {1 - b1 - b2, b1, b2}) worst = std::max({worst, -b, b - 1});
    const auto moved_by = [&](const RealVec& gradient) {
        return 0x1p-24L * glm::dot(glm::abs(gradient), glm::abs(RealVec(point)));
    };
    const RealVec by_b1 = glm::cross(e2, n) / square;
    const RealVec by_b2 = glm::cross(n, e1) / square;
    return std::max<Real>(
        0, worst - std::max({moved_by(by_b1), moved_by(by_b2), moved_by(by_b1 + by_b2)}));
}

// The numbers that Arvo's map sends to the direction.
glm::vec<2, Real> inverse(const TriangleView& view, Real omega, const Vec3d& d) {
    const auto unit = [](const RealVec& v) { return v / std::sqrt(glm::dot(v, v)); };
    const RealVec a = unit(RealVec(view.a)), b = unit(RealVec(view.b)), c = unit(RealVec(view.c));
    const RealVec w(d);
    // The corner c' lies where the plane of b and w meets the arc from a to c.
    RealVec corner = glm::cross(glm::cross(b, w), glm::cross(c, a));
    if (glm::dot(corner, a + c) < 0) corner = -corner;
    corner = unit(corner);
    TriangleView part;
    const Vec3d ad(a), bd(b), cd(corner);
    part.a = ad;
    part.b = bd;
    part.c = cd;
    const auto one_minus_cos = [](const RealVec& x, const RealVec& y) {
        const RealVec e = x - y;
        return glm::dot(e, e) / 2;
    };
    return {reference(part) / omega, one_minus_cos(w, b) / one_minus_cos(corner, b)};
}

// The control for triangles that are wide: a direction to a point that is even over the area.
Vec3d unit_towards(const TriangleView& view, const Vec2f& u) {
    const double root = std::sqrt(static_cast<double>(u.x));
    const double b1 = 1 - root;
    const double b2 = static_cast<double>(u.y) * root;
    return glm::normalize(view.a + b1 * (view.b - view.a) + b2 * (view.c - view.a));
}

// Directions that are even over the solid angle have numbers that are even over the unit square,
// whatever map made them.
struct Evenness {
    double sum[4] = {};
    double count = 0;

    void add(const glm::vec<2, Real>& number) {
        const double x[2] = {static_cast<double>(number.x), static_cast<double>(number.y)};
        for (int k = 0; k < 2; ++k) {
            sum[k] += x[k] - 0.5;
            sum[2 + k] += x[k] * x[k] - 1.0 / 3;
        }
        ++count;
    }
    // The largest deviation from 1/2 and 1/3 in standard errors: variances 1/12 and 4/45.
    double worst() const {
        double z = 0;
        for (int k = 0; k < 4; ++k) {
            const double variance = k < 2 ? 1.0 / 12 : 4.0 / 45;
            z = std::max(z, std::abs(sum[k]) / std::sqrt(variance * count));
        }
        return z;
    }
};

struct Shape {
    Vec3d p0, e1, e2;
    std::string name;
};

std::vector<Shape> shapes() {
    std::vector<Shape> list;
    for (const double size : {1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
        for (const double aspect : {1.0, 30.0, 1e3, 1e5}) {
            for (const double height : {1.0, 1e-2, 1e-7}) {
                list.push_back({Vec3d(-0.3 * size, height, -0.4 * size / aspect),
                                Vec3d(size, 0, 0.1 * size / aspect),
                                Vec3d(0.2 * size, 0, size / aspect),
                                "size " + exact(size) + " aspect " + exact(aspect) + " height " +
                                    exact(height)});
                list.push_back({Vec3d(0.7, height, 0.2), Vec3d(size, 0.3 * size, 0),
                                Vec3d(0, 0, -size / aspect), list.back().name + " aside"});
            }
        }
    }
    return list;
}

TriangleView view_of(const Shape& s) {
    // Rounded as a scene's floats are.
    const Vec3d a{Vec3f(s.p0)};
    return {a, a + Vec3d(Vec3f(s.e1)), a + Vec3d(Vec3f(s.e2))};
}

SceneBuilder one_triangle(const Shape& s) {
    const Vec3f p0(s.p0), e1(s.e1), e2(s.e2);
    SceneBuilder builder;
    Mesh mesh;
    mesh.positions = {p0, p0 + e1, p0 + e2};
    mesh.indices = {0, 1, 2};
    builder.mesh(mesh, builder.material(lamp_material(true)));
    return builder;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    const int draws = full ? 20000 : 100;
    WorkerPool pool(run_settings().threads);
    WorstError area, naive_area, beyond, naive_beyond, inverted;
    Evenness even, naive_even;
    double bad = 0;
    double naive_bad = 0;
    Sweep sweep{"solid angle", "relative error of the solid angle", true, 1e-5, {}};
    stats::Random random(case_seed(21));
    for (const Shape& s : shapes()) {
        const TriangleView view = view_of(s);
        const Real omega = reference(view);
        const double own = solid_angle(view);
        const float naive = girard(view);
        const auto where = [&] { return s.name; };
        if (!is_finite(naive)) ++naive_bad;
        if (!is_finite(own)) ++bad;
        area.add(relative(own, omega), where);
        const double naive_error = relative(static_cast<double>(naive), omega);
        naive_area.add(naive_error);
        if (is_finite(naive_error))
            sweep.points.push_back(
                {static_cast<double>(omega), std::min(naive_error, 1e3), relative(own, omega)});
        const LampScene lamp(one_triangle(s), pool);
        const Light& light = lamp.light(0);
        const Vec3f p = lamp.local(Vec3d(0));
        for (int i = 0; i < draws; ++i) {
            const Vec2f u = random.pair();
            const auto at = [&] { return s.name + " u " + exact(u.x) + " " + exact(u.y); };
            const auto sample = sample_triangle_light(*lamp.scene, light, p, u);
            if (!sample) continue;
            if (!is_finite(sample->target) || !is_finite(sample->wi)) ++bad;
            beyond.add(static_cast<double>(outside(light, sample->target)), at);
            // The control: the point where a float direction meets the plane.
            const Vec3f n = glm::cross(light.e1, light.e2);
            const Vec3f d = normalize(light.p0 + u.x * light.e1 + (1 - u.x) * u.y * light.e2 - p);
            const Vec3f on = p + d * (glm::dot(light.p0 - p, n) / glm::dot(d, n));
            naive_beyond.add(static_cast<double>(outside(light, on)));
            // By solid angle where it looks large.
            const Vec3d middle = view.a + (Vec3d(Vec3f(s.e1)) + Vec3d(Vec3f(s.e2))) / 3.0;
            if (omega < 1e-4L || !(double{light.area} > 0.1 * glm::dot(middle, middle))) continue;
            const glm::vec<2, Real> back =
                inverse(view, omega, sample_solid_angle(view, own, Vec2d(u)));
            if (is_wide(view)) {
                even.add(back);
                naive_even.add(inverse(view, omega, unit_towards(view, u)));
                continue;
            }
            const auto off = std::max(std::abs(back.x - static_cast<Real>(u.x)),
                                      std::abs(back.y - static_cast<Real>(u.y)));
            inverted.add(static_cast<double>(off), at);
        }
    }
    std::sort(sweep.points.begin(), sweep.points.end(),
              [](const SweepPoint& a, const SweepPoint& b) { return a.parameter < b.parameter; });

    // The light itself, from within its plane, at a corner and just above: nothing or something
    // sound.
    SceneBuilder builder;
    Mesh mesh;
    mesh.positions = {Vec3f(0, 0, 0), Vec3f(0, 0, 1), Vec3f(1, 0, 0)};
    mesh.indices = {0, 1, 2};
    builder.mesh(mesh, builder.material(lamp_material(true)));
    const LampScene lamp(builder, pool);
    for (const Vec3d& world :
         {Vec3d(0.2, 0, 0.2), Vec3d(3, 0, 0), Vec3d(0), Vec3d(1, 0, 0), Vec3d(0.2, 1e-7, 0.2),
          Vec3d(0.2, 1e-38, 0.2), Vec3d(0.5, 1e-20, 0)}) {
        const Vec3f p = lamp.local(world);
        for (int i = 0; i < draws; ++i) {
            const auto s = sample_triangle_light(*lamp.scene, lamp.light(0), p, random.pair());
            if (!s) continue;
            if (!is_finite(s->pdf) || !(s->pdf > 0) || !is_finite(s->wi) || !is_finite(s->target))
                ++bad;
        }
        const Light& l = lamp.light(0);
        const TriangleView view{Vec3d(l.p0) - Vec3d(p), Vec3d(l.p0 + l.e1) - Vec3d(p),
                                Vec3d(l.p0 + l.e2) - Vec3d(p)};
        if (!is_finite(girard(view))) ++naive_bad;
        const float on = pdf_flat_light(l, p, l.p0 + 0.3f * (l.e1 + l.e2));
        if (!is_finite(on)) ++bad;
    }
    CaseResult result;
    result.measures.push_back({"relative error of the solid angle", naive_area.or_infinite(),
                               area.or_infinite(), 1e-5, Gate::at_most, area.where});
    result.measures.push_back({"sampled points outside the triangle, in barycentrics",
                               naive_beyond.value, beyond.or_infinite(), 1e-5, Gate::at_most,
                               beyond.where});
    result.measures.push_back({"numbers found back from a direction, off (from 1e-4 sr on)",
                               std::nan(""), inverted.or_infinite(), 1e-4, Gate::at_most,
                               inverted.where});
    result.measures.push_back(
        {"mean and square of the numbers of triangles that are cut, in "
         "standard errors",
         naive_even.worst(), even.worst(), 5, Gate::at_most,
         "another map than Arvo's, and as even"});
    result.measures.push_back(
        {"results that are not finite", naive_bad, bad, 0, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"L02", Priority::p1, "triangle lights by solid angle", "sum of angles less pi, in float",
     "triple product of edges over a sum (Van Oosterom and Strackee 1983) in double; Arvo 1995",
     "mmp/pbrt-v4#134, #211; MilchRatchet/Luminary#88; Devsh-Graphics-Programming/Nabla#1001",
     run});

}  // namespace
}  // namespace talbot::hardcases::l02
