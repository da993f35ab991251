// B04: the same bytes on every instruction set of the machine.
#include <hwy/highway.h>

#include <bit>
#include <vector>

#include "app/hardcases/cases/b_traversal_rays.h"
#include "core/math/robust.h"
#include "oracles/scene_builder.h"

namespace talbot::hardcases::b04 {
namespace {

struct Soup {
    std::vector<Vec3f> positions;
    std::vector<uint32_t> indices;

    explicit Soup(Draw& draw, uint32_t triangles) {
        const auto number = [&](double size) {
            return static_cast<float>(draw.between(-size, size));
        };
        for (uint32_t i = 0; i < triangles; ++i) {
            const Vec3f middle(number(1), number(1), number(1));
            for (int k = 0; k < 3; ++k) {
                indices.push_back(static_cast<uint32_t>(positions.size()));
                positions.push_back(middle + Vec3f(number(0.2), number(0.2), number(0.2)));
            }
        }
    }
};

std::vector<Ray> rays_through(Draw& draw, int count) {
    std::vector<Ray> rays(static_cast<std::size_t>(count));
    const auto number = [&] { return static_cast<float>(draw.between(-1, 1)); };
    for (Ray& ray : rays) {
        ray.o = Vec3f(number(), number(), number());
        ray.d = safe_normalize(Vec3f(number(), number(), number()), Vec3f(0, 0, 1));
    }
    return rays;
}

// Möller and Trumbore's distance, with products fused or not: what one source gives on two
// instruction sets.
float naive_distance(const Ray& ray, const Soup& soup, std::size_t triangle, bool fused) {
    const auto difference = [fused](float a, float b, float c, float d) {
        return fused ? std::fma(a, b, -(c * d)) : a * b - c * d;
    };
    const auto cross_of = [&](const Vec3f& a, const Vec3f& b) {
        return Vec3f(difference(a.y, b.z, a.z, b.y), difference(a.z, b.x, a.x, b.z),
                     difference(a.x, b.y, a.y, b.x));
    };
    const Vec3f& p0 = soup.positions[soup.indices[3 * triangle]];
    const Vec3f e1 = soup.positions[soup.indices[3 * triangle + 1]] - p0;
    const Vec3f e2 = soup.positions[soup.indices[3 * triangle + 2]] - p0;
    const float inverse = 1 / dot(e1, cross_of(ray.d, e2));
    return dot(e2, cross_of(ray.o - p0, e1)) * inverse;
}

bool same(const Hit& a, const Hit& b) {
    return std::bit_cast<uint32_t>(a.t) == std::bit_cast<uint32_t>(b.t) &&
           std::bit_cast<uint32_t>(a.u) == std::bit_cast<uint32_t>(b.u) &&
           std::bit_cast<uint32_t>(a.v) == std::bit_cast<uint32_t>(b.v) && a.id == b.id;
}

std::string film_bytes(WorkerPool& pool) {
    SceneBuilder builder;
    Material gold;
    gold.roughness_factor = 0.4f;
    builder.mesh(SceneBuilder::box(Vec3f(-0.5f), Vec3f(0.5f)), builder.material(gold));
    builder.mesh(SceneBuilder::quad(Vec3f(-3, -0.5f, -3), Vec3f(0, 0, 6), Vec3f(6, 0, 0)),
                 builder.material(SceneBuilder::diffuse(0.7f)));
    builder.environment(Rgb(1, 0.8f, 0.6f));
    return render_film(builder.build(pool), camera_at(Vec3d(2, 1.5, 3), Vec3d(0)), {}, 32, 32, 4,
                       pool)
        .hash();
}

CaseResult run(Effort effort) {
    const int count = effort == Effort::full ? 1000000 : 50000;
    Draw draw(0xB04);
    const Soup soup(draw, 2000);
    const std::vector<Ray> rays = rays_through(draw, count);
    WorkerPool pool(run_settings().threads);
    double naive = 0;
    for (const Ray& ray : rays) {
        const std::size_t triangle = draw.bits() % (soup.indices.size() / 3);
        naive +=
            naive_distance(ray, soup, triangle, true) == naive_distance(ray, soup, triangle, false)
                ? 0
                : 1;
    }
    std::vector<Hit> first;
    std::string first_film;
    Worst own;
    double films = 0;
    std::string sets;
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        sets += std::string(sets.empty() ? "" : ", ") + hwy::TargetName(target);
        AccelInput input;
        input.meshes.push_back({soup.positions, soup.indices});
        input.instances.push_back({});
        const auto accel = build_accel(input, pool);
        std::vector<Hit> hits(rays.size());
        for (std::size_t i = 0; i < rays.size(); ++i) accel->closest(rays[i], hits[i]);
        const std::string film = film_bytes(pool);
        if (first.empty()) {
            first = hits;
            first_film = film;
        }
        double differing = 0;
        for (std::size_t i = 0; i < hits.size(); ++i) differing += same(hits[i], first[i]) ? 0 : 1;
        own.add(differing,
                [&] { return std::string("instruction set ") + hwy::TargetName(target); });
        films += film == first_film ? 0 : 1;
    }
    hwy::SetSupportedTargetsForTest(0);
    CaseResult result;
    result.measures.push_back(
        {"hits of " + std::to_string(count) + " rays with other bytes between " + sets, naive,
         own.figure, 0, Gate::at_most, own.where});
    result.measures.push_back(
        {"renders with other bytes", kNoControl, films, 0, Gate::at_most, ""});
    return result;
}

const bool kAdded = add_case({"B04", Priority::p1, "same bytes on every instruction set",
                              "one source, with fused products on one set and without on another",
                              "no fusing, no estimates of reciprocals, own sines", "", run});

}  // namespace
}  // namespace talbot::hardcases::b04
