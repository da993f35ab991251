// Rays that enter the structure as a beam meet what they meet from the root, bit for bit, on every
// instruction set; and a beam leaves out what lies beside it.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "geometry_scenes.h"

namespace talbot::test {
namespace {

// Boxes with corners at whole numbers: rays along axes run in their faces.
MeshData blocks() {
    Rng rng(4);
    MeshData mesh;
    for (int i = 0; i < 200; ++i) {
        const Vec3f lo(Vec3d(rng.between(-8, 8), rng.between(-8, 8), rng.between(-8, 8)));
        mesh.add_box(lo, lo + Vec3f(Vec3d(rng.between(0, 2), rng.between(1, 2), 1)));
    }
    return mesh;
}

SceneData mixed() {
    SceneData scene = scene_of(displaced_sphere(20, 0.3f));
    scene.meshes.push_back(soup(300, 0.3f, 7));
    for (int i = 0; i < 5; ++i) {
        Mat4d m(0.3 + 0.1 * i);
        m[3] = Vec4d(0.7 * i - 1, 0.5, 0.3 * i, 1);
        scene.place(1, m);
    }
    for (int i = 0; i < 30; ++i)
        scene.spheres.push_back({Vec3d(0.2 * i - 3, 0.3, 0.1 * i), 0.02 + 0.01 * i, false});
    return scene;
}

std::vector<std::pair<std::string, SceneData>> scenes() {
    return {{"blocks", scene_of(blocks())},
            {"soup", scene_of(soup(3000, 0.05f, 1))},
            {"sphere", scene_of(displaced_sphere(40, 0.2f))},
            {"mixed", mixed()},
            {"far", scene_of(displaced_sphere(30, 0.2f).moved({1e6f, -3e5f, 7}))}};
}

// Whole and half numbers now and then, which lie in faces.
float number(float low, float high, Rng& rng) {
    const float x = rng.uniform(low, high);
    return rng.below(3) == 0 ? std::floor(2 * x) / 2 : x;
}

// A few rays side by side: from one point or from a lens, along axes now and then, of any length.
std::vector<Ray> make_rays(const Bounds& bounds, Rng& rng) {
    const Vec3f extent = bounds.upper - bounds.lower;
    Vec3f eye;
    for (int k = 0; k < 3; ++k)
        eye[k] =
            number(bounds.lower[k] - 0.3f * extent[k], bounds.upper[k] + 0.3f * extent[k], rng);
    Vec3f axis = rng.direction();
    if (rng.below(3) == 0) {
        axis = Vec3f(0);
        axis[rng.between(0, 2)] = rng.below(2) != 0 ? 1.0f : -1.0f;
    }
    const float width = std::exp2(-static_cast<float>(rng.below(12)));
    const float lens = rng.below(2) != 0 ? 0 : std::exp2(-static_cast<float>(rng.below(12)));
    std::vector<Ray> rays(16);
    for (Ray& ray : rays) {
        for (int k = 0; k < 3; ++k) {
            ray.o[k] = eye[k] + lens * number(-1, 1, rng) * extent[k];
            ray.d[k] = axis[k] + width * number(-1, 1, rng);
            if (rng.below(8) == 0) ray.d[k] = rng.below(2) != 0 ? 0.0f : -0.0f;
        }
        ray.d *= std::exp2(static_cast<float>(rng.between(-4, 4)));
        if (rng.below(4) == 0) ray.t_max = rng.uniform(0, 2);
    }
    return rays;
}

Beam beam_of(const std::vector<Ray>& rays) {
    Beam beam;
    for (const Ray& ray : rays) beam.add(ray);
    return beam;
}

struct Outcome {
    uint64_t hits = 0;
    uint64_t wrong = 0;
    uint64_t entered = 0;  // below the root
};

// The rays of `rays` in the structure, entered by a beam of the first `of_beam` of them.
void compare(const Accel& accel, const std::vector<Ray>& rays, size_t of_beam, Outcome& outcome) {
    const BeamEntry entry =
        accel.enter(beam_of({rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(of_beam)}));
    outcome.entered += !entry.is_root;
    for (const Ray& ray : rays) {
        Hit expected;
        Hit hit;
        const bool expect = accel.closest(ray, expected);
        const bool found = accel.closest(ray, hit, entry);
        outcome.hits += expect;
        outcome.wrong += found != expect || !same_hit(hit, expected);
    }
}

TEST(Beams, FindTheSameHits) {
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        for (const auto& [name, scene] : scenes()) {
            for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::high}) {
                const auto accel = build(scene, quality);
                Rng rng(3);
                Outcome outcome;
                const uint64_t beams = 2000 * test_scale();
                for (uint64_t i = 0; i < beams; ++i) {
                    const auto rays = make_rays(accel->bounds(), rng);
                    compare(*accel, rays, rays.size(), outcome);
                }
                EXPECT_EQ(outcome.wrong, 0u) << name << " " << hwy::TargetName(target);
                EXPECT_EQ(outcome.entered, beams) << name;
                EXPECT_GT(outcome.hits, beams) << name;
            }
        }
    }
    hwy::SetSupportedTargetsForTest(0);
}

// Control: rays beside the beam lose hits, or nothing would be left out.
TEST(Beams, LeaveOutWhatLiesBeside) {
    for (const auto& [name, scene] : scenes()) {
        const auto accel = build(scene);
        Rng rng(3);
        Outcome outcome;
        for (int i = 0; i < 2000; ++i) compare(*accel, make_rays(accel->bounds(), rng), 1, outcome);
        EXPECT_GT(outcome.wrong, outcome.hits / 10) << name;
    }
}

// A beam of one ray along an axis, right in the face of a box, and beyond the scene.
TEST(Beams, OfOneRay) {
    const auto accel = build(scene_of(blocks()));
    Outcome outcome;
    Rng rng(9);
    for (int i = 0; i < 20000; ++i) {
        Ray ray;
        for (int k = 0; k < 3; ++k) ray.o[k] = static_cast<float>(rng.between(-20, 20)) / 2;
        ray.d = Vec3f(rng.below(2) != 0 ? 0.0f : -0.0f);
        ray.d[rng.between(0, 2)] = rng.below(2) != 0 ? 1.0f : -1.0f;
        compare(*accel, {ray}, 1, outcome);
    }
    EXPECT_EQ(outcome.wrong, 0u);
    EXPECT_GT(outcome.hits, 1000u);
}

TEST(Beams, OfNothingOrOfBadRaysBeginAtTheRoot) {
    const auto accel = build(scene_of(blocks()));
    EXPECT_TRUE(accel->enter(Beam{}).is_root);
    for (const float bad : {std::numeric_limits<float>::infinity(), 1e30f}) {
        Beam beam;
        beam.add({Vec3f(0), kInfinity, Vec3f(1, 0, 0)});
        beam.add({Vec3f(0), kInfinity, Vec3f(bad, 0, 0)});
        EXPECT_TRUE(accel->enter(beam).is_root);
        Beam far;
        far.add({Vec3f(0, bad, 0), kInfinity, Vec3f(1, 0, 0)});
        EXPECT_TRUE(accel->enter(far).is_root);
    }
    // Rays that are no rays meet nothing, and leave the others alone.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> rays(3);
    rays[0].o = Vec3f(0, 0, -20);
    rays[1].d = Vec3f(nan, 0, 1);
    rays[2].o = Vec3f(0.5f, nan, -20);
    Outcome outcome;
    compare(*accel, rays, 3, outcome);
    EXPECT_EQ(outcome.wrong, 0u);
    EXPECT_EQ(build(SceneData{})->enter(beam_of(rays)).is_root, true);
    MeshData one;
    one.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_TRUE(build(scene_of(one))->enter(beam_of({rays[0]})).is_root);
}

}  // namespace
}  // namespace talbot::test
