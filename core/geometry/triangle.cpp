// The exact parts of the triangle test, for the few rays that need them.
#include "core/geometry/triangle.h"

namespace talbot::triangle_detail {
namespace {

struct Vectors {
    Vec3f o;
    Vec3f d;
};

Vectors vectors(const ShearedRay& ray) {
    return {Vec3f(ray.o[0], ray.o[1], ray.o[2]), Vec3f(ray.d[0], ray.d[1], ray.d[2])};
}

}  // namespace

bool exact_edges(const ShearedRay& ray, const Vec3f& a, const Vec3f& b, const Vec3f& c, double& u,
                 double& v, double& w) {
    const auto [o, d] = vectors(ray);
    u = exact_triple_product(d, o, c, b);
    v = exact_triple_product(d, o, a, c);
    w = exact_triple_product(d, o, b, a);
    const double least = std::min(u, std::min(v, w));
    const double most = std::max(u, std::max(v, w));
    if (least < 0 && most > 0) return false;
    u = std::abs(u);
    v = std::abs(v);
    w = std::abs(w);
    return least < 0 || most > 0;
}

double exact_depth(const ShearedRay& ray, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const auto [o, d] = vectors(ray);
    const double area = exact_triple_product(d, o, c, b) + exact_triple_product(d, o, a, c) +
                        exact_triple_product(d, o, b, a);
    return exact_volume(o, a, c, b) / area * ray.d[ray.kz];
}

}  // namespace talbot::triangle_detail
