// S12: a frame about any unit normal, dense near all axes and at signed zeros.
#include <functional>

#include "app/hardcases/cases/shading_setup.h"
#include "oracles/stats/random.h"

namespace talbot::hardcases::s12 {
namespace {

constexpr double kLimit = 4 * 0x1p-24;

// Frisvad 2012: one reciprocal, which breaks at z = -1.
void naive_basis(const Vec3f& n, Vec3f& t, Vec3f& b) {
    const float a = 1 / (1 + n.z);
    const float c = -n.x * n.y * a;
    t = Vec3f(1 - n.x * n.x * a, c, -n.x);
    b = Vec3f(c, 1 - n.y * n.y * a, -n.y);
}

struct Figures {
    WorstError error;
    uint64_t left_handed = 0;
};

template <typename Basis>
void judge(Figures& f, const Basis& basis, const Vec3f& n) {
    Vec3f t;
    Vec3f b;
    basis(n, t, b);
    const Vec3d nd(n);
    const Vec3d td(t);
    const Vec3d bd(b);
    for (const double e : {dot(nd, td), dot(nd, bd), dot(td, bd), length(td) - 1, length(bd) - 1})
        f.error.add(std::abs(e), [&] { return exact(n); });
    if (!(dot(cross(td, bd), nd) > 0)) ++f.left_handed;
}

CaseResult run(Effort effort) {
    const int count = effort == Effort::full ? 10000000 : 500000;
    Figures naive;
    Figures own;
    const auto both = [&](const Vec3f& n) {
        judge(naive, naive_basis, n);
        judge(own, orthonormal_basis, n);
    };
    stats::Random random(case_seed(11));
    for (int i = 0; i < count; ++i) {
        Vec3d v(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
        if (i % 2 == 0) {
            // Close to an axis, over twelve decades.
            const int axis = i / 2 % 3;
            for (int k = 0; k < 3; ++k)
                v[k] *= k == axis ? 1 : std::pow(10.0, random.between(-12, 0));
        }
        const double l = length(v);
        if (l > 1e-20) both(Vec3f(v / l));
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (int signs = 0; signs < 8; ++signs) {
            Vec3f n(0);
            n[axis] = 1;
            for (int k = 0; k < 3; ++k) n[k] = (signs >> k & 1) != 0 ? -n[k] : n[k];
            both(n);
        }
    }
    CaseResult result;
    result.measures.push_back({"largest of |dot| and |length - 1|", naive.error.or_infinite(),
                               own.error.or_infinite(), kLimit, Gate::at_most, own.error.where});
    result.measures.push_back({"frames that are not right-handed",
                               static_cast<double>(naive.left_handed),
                               static_cast<double>(own.left_handed), 0, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case({"S12", Priority::p0, "orthonormal basis", "Frisvad 2012",
                              "Duff et al. 2017: the sign of z is copied, no branch",
                              "mitsuba-renderer/mitsuba#73, tylermorganwall/rayrender#7", run});

}  // namespace
}  // namespace talbot::hardcases::s12
