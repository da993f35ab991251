// Light leaves from the round surface that vertex normals describe (G14), and from nowhere else.
#include <gtest/gtest.h>

#include <cmath>

#include "app/hardcases/cases/mesh_shapes.h"
#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"
#include "scene_builder.h"

namespace talbot {
namespace {

using hardcases::geometry::MeshData;
using hardcases::geometry::Rng;

// A ball of radius 1 whose normals are those of the sphere, times `sign`.
Mesh ball(float sign) {
    const MeshData shape = hardcases::geometry::displaced_sphere(5, 0);
    Mesh mesh;
    mesh.positions = shape.positions;
    mesh.indices = shape.indices;
    for (const Vec3f& p : shape.positions) mesh.normals.push_back(sign * normalize(p));
    return mesh;
}

std::shared_ptr<const Scene> scene_of(Mesh mesh, const Mat4d& world = Mat4d(1.0)) {
    WorkerPool pool(1);
    SceneBuilder builder;
    builder.mesh(std::move(mesh), 0, world);
    return builder.build(pool);
}

// Calls f(interaction, ray) for rays that hit, from outside or from the middle.
template <class F>
void for_hits(const Scene& scene, bool from_inside, const F& f) {
    Rng rng(1);
    int hits = 0;
    for (int i = 0; i < 5000; ++i) {
        Ray ray;
        ray.o = from_inside ? 0.2f * rng.direction() : 3.0f * rng.direction();
        ray.d = 0.7f * rng.direction() - ray.o;
        Hit hit;
        if (!scene.accel().closest(ray, hit)) continue;
        ++hits;
        f(make_surface_interaction<kMatteTier>(scene, ray, hit), ray);
    }
    EXPECT_GT(hits, 4000);
}

TEST(RoundSurface, LiftedPointsLieNearTheSphere) {
    for (const float sign : {1.0f, -1.0f}) {
        const auto scene = scene_of(ball(sign));
        int lifted = 0;
        for_hits(*scene, false, [&](const SurfaceInteraction& si, const Ray&) {
            const double flat = 1 - static_cast<double>(length(si.p));
            const double round = std::abs(1 - static_cast<double>(length(si.lit_point())));
            if (flat < 1e-3) return;
            ++lifted;
            EXPECT_TRUE(si.is_lifted());
            EXPECT_LT(round, 1.01 * flat);
            EXPECT_GT(length(si.lit_point()), length(si.p));
            EXPECT_GT(dot(si.n_surface(), normalize(si.p)), 0.999f);
        });
        EXPECT_GT(lifted, 1000) << "the facets must differ from the sphere";
    }
}

// Rays along the horizon of the round surface escape; from the facets a part of them does not.
TEST(RoundSurface, HorizonIsOpen) {
    const auto scene = scene_of(ball(1));
    Rng rng(2);
    int closed = 0;
    int control = 0;
    for_hits(*scene, false, [&](const SurfaceInteraction& si, const Ray&) {
        if (!si.is_lifted()) return;
        const Vec3f n = normalize(si.p);
        const Vec3f d = normalize(normalize(cross(n, rng.direction())) + 0.02f * n);
        closed += scene->accel().occluded(si.spawn(d));
        Ray flat;
        flat.o = offset_ray_origin(si.p, si.p_error, si.n_geometric, d);
        flat.d = d;
        flat.skip_from = si.id;
        control += scene->accel().occluded(flat);
    });
    EXPECT_EQ(closed, 0);
    EXPECT_GT(control, 500);
}

TEST(RoundSurface, HollowsAndFlatNormalsStayWhereTheyAre) {
    const auto scene = scene_of(ball(1));
    for_hits(*scene, true, [](const SurfaceInteraction& si, const Ray&) {
        EXPECT_FALSE(si.is_lifted());
        EXPECT_EQ(si.lit_point(), si.p);
    });
    const Mesh shared = ball(1);
    Mesh flat;
    for (const uint32_t i : shared.indices) {
        flat.positions.push_back(shared.positions[i]);
        flat.indices.push_back(static_cast<uint32_t>(flat.indices.size()));
    }
    for (std::size_t i = 0; i < flat.positions.size(); i += 3) {
        const Vec3f n = safe_normalize(stable_cross(flat.positions[i + 1] - flat.positions[i],
                                                    flat.positions[i + 2] - flat.positions[i]),
                                       Vec3f(0, 0, 1));
        flat.normals.insert(flat.normals.end(), 3, n);
    }
    for_hits(*scene_of(flat), false,
             [](const SurfaceInteraction& si, const Ray&) { EXPECT_FALSE(si.is_lifted()); });
}

// Normals that lean far over, as of a box shaded as one smooth body, describe no surface nearby.
TEST(RoundSurface, LeaningNormalsAreLeftOut) {
    Mesh mesh = SceneBuilder::box(Vec3f(-1), Vec3f(1));
    for (const Vec3f& p : mesh.positions) mesh.normals.push_back(normalize(p));
    for_hits(*scene_of(mesh), false,
             [](const SurfaceInteraction& si, const Ray&) { EXPECT_FALSE(si.is_lifted()); });
}

// Power-of-two scaling and mirrored, stretched instances keep it right.
TEST(RoundSurface, FollowsTheInstance) {
    Mat4d stretch(1.0);
    stretch[0][0] = -2;
    stretch[1][1] = 0.5;
    const auto plain = scene_of(ball(1));
    const auto scene = scene_of(ball(1), stretch);
    Rng rng(3);
    int lifted = 0;
    for (int i = 0; i < 3000; ++i) {
        Ray ray;
        ray.o = 3.0f * rng.direction();
        ray.d = 0.6f * rng.direction() - ray.o;
        Hit hit;
        if (!plain->accel().closest(ray, hit)) continue;
        const auto si = make_surface_interaction<kMatteTier>(*plain, ray, hit);
        const auto through = [&](const Vec3f& v) { return Vec3f(Mat3d(stretch) * Vec3d(v)); };
        Ray other;
        other.o = through(ray.o);
        other.d = through(ray.d);
        Hit other_hit;
        ASSERT_TRUE(scene->accel().closest(other, other_hit));
        const auto there = make_surface_interaction<kMatteTier>(*scene, other, other_hit);
        if (!si.is_lifted() || !there.is_lifted()) continue;
        ++lifted;
        // Both leave the body to the same side by a like amount.
        EXPECT_GT(dot(there.lift, there.n_geometric), 0);
        EXPECT_LT(length(there.lift), 4 * length(si.lift) + 1e-6f);
    }
    EXPECT_GT(lifted, 500);
}

}  // namespace
}  // namespace talbot
