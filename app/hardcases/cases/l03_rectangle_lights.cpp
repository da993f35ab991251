// L03: rectangles of light (two triangles in glTF) at distances of 1e-7 to 1e7 of their size,
// slender ones, from behind and from within their plane.
#include <array>
#include <numbers>

#include "app/hardcases/cases/light_setup.h"

namespace talbot::hardcases::l03 {
namespace {

using Real = long double;
using RealVec = glm::vec<3, Real>;

// Lambert's formula: the sum over edges of their angle times how they face the normal.
Real irradiance(const std::array<RealVec, 4>& corner, const RealVec& n) {
    Real sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const RealVec& a = corner[i];
        const RealVec& b = corner[(i + 1) % 4];
        const RealVec c = glm::cross(a, b);
        const Real l = std::sqrt(glm::dot(c, c));
        if (l > 0) sum += std::atan2(l, glm::dot(a, b)) / l * glm::dot(c, n);
    }
    return std::abs(sum) / 2;
}

// The control: a spherical rectangle in float (Urena, Fajardo and King 2013).
struct SphericalRectangle {
    float x0, x1, y0, y0sq, y1, y1sq, z0, z0sq, b0, b1, b0sq, k, solid_angle;

    // Corner relative to the point in the rectangle's frame, z towards the point.
    SphericalRectangle(const Vec3f& corner, float width, float height)
        : x0(corner.x), x1(corner.x + width), y0(corner.y), y1(corner.y + height), z0(corner.z) {
        if (z0 > 0) z0 = -z0;
        z0sq = z0 * z0;
        y0sq = y0 * y0;
        y1sq = y1 * y1;
        const Vec3f v00(x0, y0, z0), v01(x0, y1, z0), v10(x1, y0, z0), v11(x1, y1, z0);
        const Vec3f n0 = normalize(cross(v00, v10)), n1 = normalize(cross(v10, v11));
        const Vec3f n2 = normalize(cross(v11, v01)), n3 = normalize(cross(v01, v00));
        const float g0 = std::acos(-dot(n0, n1)), g1 = std::acos(-dot(n1, n2));
        const float g2 = std::acos(-dot(n2, n3)), g3 = std::acos(-dot(n3, n0));
        b0 = n0.z;
        b1 = n2.z;
        b0sq = b0 * b0;
        k = 2 * kPi - g2 - g3;
        solid_angle = g0 + g1 - k;
    }
    Vec3f sample(const Vec2f& u) const {
        const float au = u.x * solid_angle + k;
        const float fu = (std::cos(au) * b0 - b1) / std::sin(au);
        float cu = (fu > 0 ? 1.0f : -1.0f) / std::sqrt(fu * fu + b0sq);
        cu = std::clamp(cu, -1.0f, 1.0f);
        float xu = -(cu * z0) / std::sqrt(1 - cu * cu);
        xu = std::clamp(xu, x0, x1);
        const float d = std::sqrt(xu * xu + z0sq);
        const float h0 = y0 / std::sqrt(d * d + y0sq);
        const float h1 = y1 / std::sqrt(d * d + y1sq);
        const float hv = h0 + u.y * (h1 - h0);
        const float yv = hv * hv < 1 - 1e-6f ? hv * d / std::sqrt(1 - hv * hv) : y1;
        return Vec3f(xu, yv, z0);
    }
};

// A rectangle in the plane z = 0, its front towards +z.
struct Setup {
    double width, height;
    Vec3d at;  // where light is received
    Vec3d n;   // normal there
    std::string where;
};

struct Figures {
    double naive = 0, own = 0;
    double naive_bad = 0, own_bad = 0;
};

Figures estimate(const Setup& s, const LampScene& lamp, const Vec3f& p, int steps) {
    Figures f;
    const Vec3f corner = lamp.light(0).p0 - p;
    const SphericalRectangle naive(Vec3f(corner.x, corner.y, -std::abs(corner.z)),
                                   static_cast<float>(s.width), static_cast<float>(s.height));
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const Vec2f u = grid_point(i, j, steps);
            if (const auto l = sample_quad_light(*lamp.scene, lamp.light(0), p, u)) {
                if (!is_finite(l->pdf) || !is_finite(l->wi) || !(l->pdf > 0)) ++f.own_bad;
                f.own += std::max(0.0, dot(Vec3d(l->wi), s.n)) / static_cast<double>(l->pdf);
            }
            const Vec3f to = naive.sample(u);
            const double value = std::max(0.0, dot(normalize(Vec3d(to)), s.n)) *
                                 static_cast<double>(naive.solid_angle);
            if (is_finite(value)) {
                f.naive += value;
            } else {
                ++f.naive_bad;
            }
        }
    }
    f.own /= static_cast<double>(steps) * steps;
    f.naive /= static_cast<double>(steps) * steps;
    return f;
}

std::vector<Setup> setups() {
    std::vector<Setup> list;
    const Vec3d down(0, 0, -1);
    for (const double aspect : {1.0, 10.0, 1e3, 1e6}) {
        for (int e = -7; e <= 7; ++e) {
            const double distance = std::pow(10.0, e);
            for (const Vec3d& place : {Vec3d(0, 0, 1), Vec3d(0.31, -0.22, 1)}) {
                // Distances in units of the short side.
                const double short_side = 1;
                list.push_back({aspect, short_side, Vec3d(place.x * aspect, place.y, distance),
                                down,
                                "aspect " + exact(aspect) + " distance " + exact(distance) +
                                    " at " + exact(place.x) + " " + exact(place.y)});
            }
        }
    }
    return list;
}

CaseResult run(Effort effort) {
    const bool full = effort == Effort::full;
    WorkerPool pool(run_settings().threads);
    WorstError error;
    WorstError naive_error;
    WorstError contact;
    WorstError naive_contact;
    double naive_bad = 0;
    double own_bad = 0;
    Sweep sweep{"distance over the short side", "relative error of the irradiance", true, 1e-4, {}};
    constexpr int steps = 300;
    for (const Setup& s : setups()) {
        if (!full &&
            (s.at.x == 0 || s.width == 10 || std::abs(std::lround(std::log10(s.at.z))) % 2 == 0))
            continue;
        SceneBuilder builder;
        builder.mesh(SceneBuilder::quad(Vec3f(Vec3d(-s.width / 2, -s.height / 2, 0)),
                                        Vec3f(Vec3d(s.width, 0, 0)), Vec3f(Vec3d(0, s.height, 0))),
                     builder.material(lamp_material()));
        const LampScene lamp(builder, pool);
        const Vec3f p = lamp.local(s.at);
        std::array<RealVec, 4> corner;
        const Light& l = lamp.light(0);
        corner[0] = RealVec(l.p0) - RealVec(p);
        corner[1] = corner[0] + RealVec(l.e1);
        corner[2] = corner[1] + RealVec(l.e2);
        corner[3] = corner[0] + RealVec(l.e2);
        const Real expected = irradiance(corner, RealVec(s.n));
        const Figures f = estimate(s, lamp, p, steps);
        own_bad += f.own_bad;
        naive_bad += f.naive_bad;
        const bool near = s.at.z < 1e-5;
        (near ? contact : error).add(relative(f.own, expected), [&] { return s.where; });
        (near ? naive_contact : naive_error).add(relative(f.naive, expected));
        if (s.width == 1 && s.at.x != 0)
            sweep.points.push_back(
                {s.at.z, std::min(relative(f.naive, expected), 1e3), relative(f.own, expected)});
    }
    // From within the plane and from behind: nothing.
    double leaked = 0;
    double naive_leaked = 0;
    SceneBuilder builder;
    builder.mesh(SceneBuilder::quad(Vec3f(-1, -1, 0), Vec3f(2, 0, 0), Vec3f(0, 2, 0)),
                 builder.material(lamp_material()));
    const LampScene lamp(builder, pool);
    for (const Vec3d& at : {Vec3d(0.3, 0.2, 0), Vec3d(4, 0, 0), Vec3d(1, 1, 0),
                            Vec3d(0.3, 0.2, -1e-6), Vec3d(0, 0, -5)}) {
        const Setup s{2, 2, at, Vec3d(0.6, 0, 0.8), ""};
        const Figures f = estimate(s, lamp, lamp.local(at), 16);
        own_bad += f.own_bad;
        naive_bad += f.naive_bad;
        leaked += f.own;
        naive_leaked += f.naive;
    }
    CaseResult result;
    result.measures.push_back({"relative error of the irradiance", naive_error.or_infinite(),
                               error.or_infinite(), 1e-4, Gate::at_most, error.where});
    result.measures.push_back({"the same within 1e-5 of the short side",
                               naive_contact.or_infinite(), contact.or_infinite(), 1e-3,
                               Gate::at_most, contact.where});
    result.measures.push_back(
        {"samples that are not finite", naive_bad, own_bad, 0, Gate::at_most, ""});
    result.measures.push_back(
        {"irradiance in the plane and behind", naive_leaked, leaked, 0, Gate::at_most, ""});
    result.sweeps.push_back(sweep);
    return result;
}

const bool kAdded = add_case(
    {"L03", Priority::p1, "rectangle lights", "spherical rectangle in float (Urena et al. 2013)",
     "both halves as one: by solid angle in double where it looks large, else by area",
     "Devsh-Graphics-Programming/Nabla#340, gkjohnson/three-gpu-pathtracer#174", run});

}  // namespace
}  // namespace talbot::hardcases::l03
