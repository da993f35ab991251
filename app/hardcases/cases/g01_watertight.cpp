// G01: no ray slips between triangles that share a vertex or an edge, on any instruction set.
#include <cmath>
#include <cstdint>
#include <vector>

#include "app/hardcases/cases/case_run.h"
#include "app/hardcases/cases/instruction_sets.h"
#include "app/hardcases/cases/mesh_shapes.h"

namespace talbot::hardcases::g01 {
namespace {

using namespace geometry;

bool is_lost(const Accel& accel, const Ray& ray) {
    Hit hit;
    return !accel.closest(ray, hit) || !accel.occluded(ray);
}

// One mesh, its structures by instruction set, and the triangles round each vertex.
class Subject {
  public:
    explicit Subject(MeshData mesh) : mesh_(std::move(mesh)), around_(mesh_.positions.size()) {
        const SceneData scene = scene_of(mesh_);
        for (const int64_t target : instruction_sets()) {
            const UseInstructionSet use(target);
            accels_.push_back(build_here(scene));
        }
        for (uint32_t i = 0; i < mesh_.indices.size(); ++i)
            around_[mesh_.indices[i]].push_back(i / 3);
    }
    const MeshData& mesh() const { return mesh_; }

    // The ray is aimed at a point of the triangles round `vertex`: the control looks at these
    // alone.
    void aim(const Ray& ray, uint32_t vertex, bool with_control, Failures& failures) const {
        // Rays take the instruction sets in turn.
        const bool own = is_lost(*accels_[failures.inputs % accels_.size()], ray);
        bool naive = with_control;
        for (const uint32_t i : around_[vertex]) {
            if (!naive) break;
            naive = !moeller_trumbore(ray, mesh_.triangle(i));
        }
        failures.see(naive, own, [&] { return hex(ray); });
    }

  private:
    MeshData mesh_;
    std::vector<std::vector<uint32_t>> around_;
    std::vector<std::unique_ptr<const Accel>> accels_;
};

// Fans of 3 to 64 triangles, every `step`th size.
Failures fans(float stretch, const Vec3f& at, uint32_t step, uint64_t seed, uint64_t rays) {
    Rng shapes(seed);
    Failures all;
    for (uint32_t n = 3; n <= 64; n += step) {
        const Subject subject(triangle_fan(n, stretch, at, shapes));
        const std::vector<Vec3f>& p = subject.mesh().positions;
        all.merge(over_inputs<Failures>(
            seed * 64 + n, rays * step / 62, [&](Rng& rng, Failures& failures) {
                Ray ray;
                // Seen from where no spoke is hidden behind the rim's outline.
                ray.o = at + Vec3f(rng.uniform(-0.2f, 0.2f), rng.uniform(-0.2f, 0.2f),
                                   rng.uniform(3, 30));
                const Vec3f rim = p[1 + rng.below(n)];
                const float s = rng.below(2) != 0 ? 0.0f : 0.9f * rng.uniform();
                ray.d = p[0] + s * (rim - p[0]) - ray.o;
                subject.aim(ray, 0, true, failures);
            }));
    }
    return all;
}

// From inside a closed mesh at its vertices, edge points and face points.
Failures closed_sphere(const MeshData& unit, const Vec3f& at, float radius, uint64_t seed,
                       uint64_t rays) {
    MeshData mesh = unit;
    for (Vec3f& p : mesh.positions) p = at + radius * p;
    const Subject subject(std::move(mesh));
    const auto triangles = static_cast<uint32_t>(subject.mesh().triangles());
    return over_inputs<Failures>(seed, rays, [&](Rng& rng, Failures& failures) {
        const uint32_t i = rng.below(triangles);
        const auto tri = subject.mesh().triangle(i);
        const uint32_t kind = rng.below(3);
        Vec3f target = tri[0];
        if (kind > 0) target += rng.uniform() * (tri[1] - tri[0]);
        if (kind > 1) target += rng.uniform() * (tri[2] - target);
        Ray ray;
        ray.o = at + rng.in_box(-0.3f * radius, 0.3f * radius);
        ray.d = target - ray.o;
        // An edge point lies on triangles round its first vertex; a face point inside one of them.
        subject.aim(ray, subject.mesh().indices[3 * size_t{i}], true, failures);
    });
}

Failures integer_grid(const Vec3f& offset, uint64_t seed, uint64_t rays) {
    constexpr int kSize = 12;
    const Subject subject(grid_cube(kSize).moved(offset));
    const auto vertices = static_cast<uint32_t>(subject.mesh().positions.size());
    return over_inputs<Failures>(seed, rays, [&](Rng& rng, Failures& failures) {
        Ray ray;
        ray.o = offset;
        for (int k = 0; k < 3; ++k)
            ray.o[k] += static_cast<float>(rng.between(2, 2 * kSize - 2)) / 2;
        ray.d = Vec3f(rng.below(2) != 0 ? 0.0f : -0.0f);
        ray.d[rng.between(0, 2)] = rng.below(2) != 0 ? 1.0f : -1.0f;
        if (rng.below(4) == 0) ray.d[rng.between(0, 2)] += rng.below(2) != 0 ? 1.0f : -1.0f;
        if (ray.d == Vec3f(0)) return;
        subject.aim(ray, rng.below(vertices), false, failures);
    });
}

CaseResult run(Effort effort) {
    CaseResult result;
    Failures all_fans;
    Sweep by_offset{"distance of the fan from the origin", "rays lost, share", true, 0, {}};
    uint64_t seed = 1;
    const uint32_t step = effort == Effort::full ? 1 : 6;
    for (const float at : {1.0f, 100.0f, 1e4f, 1e6f}) {
        const Failures f = fans(1, Vec3f(at, -at, at), step, ++seed, inputs(effort, 8e3, 4e5));
        const auto n = static_cast<double>(f.inputs);
        by_offset.points.push_back(
            {at, static_cast<double>(f.naive) / n, static_cast<double>(f.own) / n});
        all_fans.merge(f);
    }
    result.measures.push_back(all_fans.measure("rays lost at hubs and spokes of fans"));
    Failures needles;
    Sweep by_stretch{"length of a needle over its width", "rays lost, share", true, 0, {}};
    for (const float stretch : {1e1f, 1e3f, 1e5f, 1e7f}) {
        const Failures f = fans(stretch, Vec3f(0), step, ++seed, inputs(effort, 8e3, 4e5));
        const auto n = static_cast<double>(f.inputs);
        by_stretch.points.push_back(
            {stretch, static_cast<double>(f.naive) / n, static_cast<double>(f.own) / n});
        needles.merge(f);
    }
    result.measures.push_back(needles.measure("rays lost at fans of needles"));
    Failures closed;
    const MeshData unit = displaced_sphere(effort == Effort::full ? 82 : 30, 0.15f);
    for (const Vec3f& at : {Vec3f(0), Vec3f(148376, 1234, -223423), Vec3f(1e6f)}) {
        // A unit sphere at 1e6 is a few hundred lattice points, not a sphere.
        for (const float radius : {1.0f, 100.0f}) {
            if (radius == 1.0f && at.x > 1e5f) continue;
            closed.merge(closed_sphere(unit, at, radius, ++seed, inputs(effort, 1.6e4, 4e5)));
        }
    }
    result.measures.push_back(closed.measure("rays that leave a closed bumpy sphere"));
    Failures grid;
    for (const Vec3f& at : {Vec3f(0), Vec3f(-6), Vec3f(1000, -3000, 70000)})
        grid.merge(integer_grid(at, ++seed, inputs(effort, 2.4e4, 4e5)));
    Measure along = grid.measure("rays that leave an integer grid along its edges");
    along.naive = NAN;
    result.measures.push_back(along);
    result.sweeps = {by_offset, by_stretch};
    return result;
}

const bool kAdded = add_case({"G01", Priority::p0, "shared edges and vertices are watertight",
                              "Moeller-Trumbore in float",
                              "edge functions in double, exact where rounding could decide "
                              "(Woop, Benthin, Wald 2013; Shewchuk 1997)",
                              "jbikker/tinybvh#168, RenderKit/embree#174, RenderKit/embree#188, "
                              "mitsuba-renderer/mitsuba3#1149",
                              run});

}  // namespace
}  // namespace talbot::hardcases::g01
