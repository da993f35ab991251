// B01: fused multiply-add. What compilers make of a b - c d by default is no longer antisymmetric,
// and shared edges leak.
#include <hwy/highway.h>

#include <array>

#include "app/hardcases/cases/b_traversal_rays.h"
#include "core/base/float_probe.h"
#include "core/base/worker_pool.h"

namespace talbot::hardcases::b01 {
namespace {

// a b - c d as a compiler contracts it.
float contracted(float a, float b, float c, float d) {
    return std::fma(a, b, -(c * d));
}

// Edge functions in float (Woop, Benthin, Wald 2013) in contracted code, without their fallback.
bool naive_hit(const Ray& ray, const Vec3f& p0, const Vec3f& p1, const Vec3f& p2) {
    int kz = 0;
    for (int i = 1; i < 3; ++i) {
        if (std::abs(ray.d[i]) > std::abs(ray.d[kz])) kz = i;
    }
    const int kx = (kz + 1) % 3;
    const int ky = (kz + 2) % 3;
    const float sx = ray.d[kx] / ray.d[kz];
    const float sy = ray.d[ky] / ray.d[kz];
    std::array<Vec2f, 3> q;
    const std::array<Vec3f, 3> p{p0 - ray.o, p1 - ray.o, p2 - ray.o};
    for (std::size_t i = 0; i < 3; ++i) {
        q[i] = Vec2f(std::fma(-sx, p[i][kz], p[i][kx]), std::fma(-sy, p[i][kz], p[i][ky]));
    }
    const float u = contracted(q[2].x, q[1].y, q[2].y, q[1].x);
    const float v = contracted(q[0].x, q[2].y, q[0].y, q[2].x);
    const float w = contracted(q[1].x, q[0].y, q[1].y, q[0].x);
    return !((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0));
}

bool naive_hit(const Ray& ray, const Fan& fan) {
    for (std::size_t i = 0; i < fan.indices.size(); i += 3) {
        if (naive_hit(ray, fan.positions[fan.indices[i]], fan.positions[fan.indices[i + 1]],
                      fan.positions[fan.indices[i + 2]]))
            return true;
    }
    return false;
}

CaseResult run(Effort effort) {
    const int fans = effort == Effort::full ? 400 : 20;
    constexpr int kRays = 2000;
    WorkerPool pool(1);
    CaseResult result;
    Worst own;
    double naive = 0;
    std::string sets;
    const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
    for (const int64_t target : targets) {
        hwy::SetSupportedTargetsForTest(target);
        sets += std::string(sets.empty() ? "" : ", ") + hwy::TargetName(target);
        double missed = 0;
        naive = 0;
        Draw draw(0xB01);
        for (int f = 0; f < fans; ++f) {
            const Fan fan(f % 2 == 0 ? 0.0f : 1e6f, draw);
            const auto accel = fan.build(pool);
            for (int i = 0; i < kRays; ++i) {
                const Ray ray = fan.edge_ray(draw);
                Hit hit;
                missed += accel->closest(ray, hit) ? 0 : 1;
                naive += naive_hit(ray, fan) ? 0 : 1;
            }
        }
        own.add(missed, [&] { return std::string("instruction set ") + hwy::TargetName(target); });
    }
    hwy::SetSupportedTargetsForTest(0);
    result.measures.push_back({"rays at edges and vertices that slip through, of " +
                                   std::to_string(fans * kRays) + " in each of " + sets,
                               naive, own.figure, 0, Gate::at_most, own.where});
    result.measures.push_back({"products that this build contracts", kNoControl,
                               probe_floats().contracts ? 1.0 : 0.0, 0, Gate::at_most, ""});
    return result;
}

const bool kAdded =
    add_case({"B01", Priority::p0, "no leaks by fused multiply-add",
              "float edge functions as compilers contract them",
              "contraction off, edge functions in double, exact where it matters",
              "Nearly every header-only intersector inherits its user's flags", run});

}  // namespace
}  // namespace talbot::hardcases::b01
