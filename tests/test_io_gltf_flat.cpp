// Instances that a scale of zero flattens to a plane, or to a line or a point.
#include <gtest/gtest.h>

#include <cmath>

#include "core/integrate/surface_interaction.h"
#include "core/integrate/tiers.h"
#include "core/io/scene_motion.h"
#include "core/math/robust.h"
#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

WorkerPool& workers() {
    static WorkerPool pool(2);
    return pool;
}

// Mesh 0: a roof over the quad [0,1]^2 of z = 0, its ridge at z = 1 above y = 1/2, with normals of
// no sense along x.
GltfBuilder& with_roof(GltfBuilder& b, const Json& nodes) {
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 1, 0.5, 1, 0, 0.5, 1, 1, 1, 0, 0, 1, 0}, "VEC3");
    const int n = b.add_floats({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
    const int order = b.add_indices({0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 4, 5});
    b.add_mesh({{"POSITION", p}, {"NORMAL", n}}, order);
    b.root["nodes"] = nodes;
    return b;
}

// A shadow-free look along -z at (x, y).
std::optional<SurfaceInteraction> look_down(const Scene& scene, double x, double y) {
    Ray ray;
    ray.o = Vec3f(Vec3d(x, y, 100) - scene.origin());
    ray.d = Vec3f(0, 0, -1);
    Hit hit;
    if (!scene.accel().closest(ray, hit)) return std::nullopt;
    return make_surface_interaction<kMatteTier>(scene, ray, hit);
}

TEST(Flat, AScaleOfZeroOnOneAxisLeavesAPicture) {
    GltfBuilder b;
    with_roof(b, {{{"mesh", 0}, {"translation", {5, 6, 7}}, {"scale", {2, 2, 0}}}});
    TALBOT_LOADED(desc, b.load());
    EXPECT_TRUE(desc.warnings.empty());
    const auto scene = Scene::build(desc, workers());
    EXPECT_EQ(scene->accel().stats().triangles, 4u);
    for (const double y : {6.5, 7.5}) {
        const auto seen = look_down(*scene, 5.75, y);
        ASSERT_TRUE(seen);
        EXPECT_NEAR(seen->p.z + scene->origin().z, 7, kFlatLayerShare);
        EXPECT_GT(seen->n_geometric.z, 0.999f);
        EXPECT_EQ(seen->shading.n, Vec3f(0, 0, 1)) << "the plane's, whatever the file's normals";
        EXPECT_TRUE(seen->front);
    }
    EXPECT_FALSE(look_down(*scene, 7.1, 7));
}

TEST(Flat, LiesInItsPlaneUnderAnyParent) {
    GltfBuilder b;
    with_roof(b, {{{"children", {1}},
                   {"rotation", {0.1, 0.2, 0.3, 0.9}},
                   {"scale", {1, 0, 3}},
                   {"translation", {1e6, 0, 0}}},
                  {{"mesh", 0}, {"rotation", {0.5, 0.1, 0.3, 0.8}}, {"scale", {2, 1, -1}}}});
    TALBOT_LOADED(desc, b.load());
    ASSERT_EQ(desc.instances.size(), 1u);
    const MeshInstance& instance = desc.instances[0];
    EXPECT_EQ(glm::determinant(Mat3d(instance.world_from_object)), 1);
    EXPECT_EQ(Vec3d(instance.world_from_object[3]), Vec3d(1e6, 0, 0));
    // The parent's y, turned.
    const Quatd q = glm::normalize(Quatd(0.9, 0.1, 0.2, 0.3));
    const Vec3d plane = glm::mat3_cast(q)[1];
    const Mesh& mesh = desc.meshes[instance.mesh];
    ASSERT_EQ(mesh.positions.size(), 6u);
    ASSERT_EQ(mesh.normals.size(), 6u);
    double extent = 0;
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        EXPECT_NEAR(std::abs(dot(Vec3d(mesh.normals[v]), plane)), 1, 1e-7);
        EXPECT_NEAR(dot(Vec3d(mesh.positions[v]), plane), 0, 6 * kFlatLayerShare);
        extent = std::max(extent, length(Vec3d(mesh.positions[v])));
    }
    EXPECT_GT(extent, 1);
}

// Two quads, of which the second is the upper one.
TEST(Flat, WhatWasInFrontStaysInFront) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0,  //
                                0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1},
                               "VEC3");
    b.add_mesh({{"POSITION", p}}, b.add_indices({0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7}));
    b.root["nodes"] = {{{"mesh", 0}, {"scale", {2, 2, 0}}, {"translation", {9, 0, 0}}}};
    TALBOT_LOADED(desc, b.load());
    const auto scene = Scene::build(desc, workers());
    for (const bool above : {true, false}) {
        Ray ray;
        ray.o = Vec3f(Vec3d(9.5, 0.25, above ? 3 : -3) - scene->origin());
        ray.d = Vec3f(0, 0, above ? -1 : 1);
        Hit hit;
        ASSERT_TRUE(scene->accel().closest(ray, hit));
        EXPECT_EQ(hit.id.primitive >= 2, above);
        EXPECT_TRUE(make_surface_interaction<kMatteTier>(*scene, ray, hit).front);
    }
}

TEST(Flat, TwoAxesOfZeroHideANodeWithoutAWord) {
    GltfBuilder b;
    with_roof(b, {{{"children", {1, 2, 3, 4}}, {"rotation", {0.1, 0.3, 0.3, 0.9}}},
                  {{"mesh", 0}, {"scale", {0, 0, 0}}},
                  {{"mesh", 0}, {"scale", {0, 0, 2}}, {"rotation", {0.5, 0.1, 0.7, 0.5}}},
                  {{"mesh", 0}, {"scale", {1e-200, 1e-200, 1e-200}}},
                  {{"mesh", 0}, {"name", "seen"}}});
    TALBOT_LOADED(desc, b.load());
    ASSERT_EQ(desc.instances.size(), 1u);
    EXPECT_EQ(desc.objects.at(desc.instances[0].object).name, "seen");
    EXPECT_TRUE(desc.warnings.empty()) << desc.warnings[0];
}

TEST(Flat, WhatIsNotFiniteIsNamed) {
    GltfBuilder b;
    with_roof(b, {{{"children", {1, 2}}, {"scale", {1e200, 1e200, 1e200}}},
                  {{"mesh", 0}, {"scale", {1e200, 1, 1}}},
                  {{"mesh", 0}}});
    TALBOT_LOADED(desc, b.load());
    EXPECT_TRUE(desc.instances.empty());
    EXPECT_TRUE(has_warning(desc, "nodes[1]: 2 instances of infinite size or place"));
}

TEST(Flat, AQuadSeenFromTheSideVanishes) {
    GltfBuilder b;
    b.add_mesh(b.quad_attributes(), b.quad_indices());
    b.root["nodes"] = {{{"mesh", 0}, {"scale", {0, 1, 1}}}};
    TALBOT_LOADED(desc, b.load());
    EXPECT_TRUE(desc.instances.empty());
}

TEST(Flat, InstancesOfAnExtensionAreFlattenedEach) {
    GltfBuilder b;
    with_roof(b, {{{"mesh", 0}}});
    const int s = b.add_floats({1, 1, 0, 1, 0, 1, 1, 1, 1, 0, 1, 0}, "VEC3");
    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"SCALE", s}};
    b.use_extension("EXT_mesh_gpu_instancing", true);
    TALBOT_LOADED(desc, b.load());
    ASSERT_EQ(desc.instances.size(), 3u);
    EXPECT_EQ(desc.meshes.size(), 3u);
    EXPECT_EQ(desc.instances[2].mesh, 0u) << "the regular one shares the file's mesh";
}

TEST(Flat, CopiesCountAgainstTheLimitOfMemory) {
    constexpr size_t kInstances = 200;
    const auto loads = [&](float z, uint64_t max_bytes) {
        GltfBuilder b;
        with_roof(b, {{{"mesh", 0}}});
        std::vector<float> scales(3 * kInstances, 1);
        for (size_t i = 2; i < scales.size(); i += 3) scales[i] = z;
        b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
            {"SCALE", b.add_floats(scales, "VEC3")}};
        b.use_extension("EXT_mesh_gpu_instancing", true);
        LoadOptions options;
        options.max_bytes = max_bytes;
        return b.load(options).ok();
    };
    const uint64_t regular = kInstances * (3 * sizeof(float) + sizeof(Mat4d)) + 4096;
    EXPECT_TRUE(loads(1, regular));
    EXPECT_FALSE(loads(0, regular));
    const uint64_t copy = 6 * 2 * sizeof(Vec3f) + 12 * sizeof(uint32_t);
    EXPECT_TRUE(loads(0, regular + kInstances * copy));
}

TEST(Flat, ASphereBecomesADisc) {
    GltfBuilder b;
    b.use_extension("KHR_implicit_shapes");
    b.use_extension("TALBOT_implicit_surface");
    b.root["extensions"]["KHR_implicit_shapes"]["shapes"] = {
        {{"type", "sphere"}, {"sphere", {{"radius", 1.5}}}}};
    Json node = {{"name", "coin"}, {"translation", {0, 0, 4}}, {"scale", {1, 1, 0}}};
    node["extensions"]["TALBOT_implicit_surface"] = {{"shape", 0}};
    b.add_node(node);
    TALBOT_LOADED(desc, b.load());
    EXPECT_TRUE(desc.spheres.empty());
    EXPECT_TRUE(has_warning(desc, "coin: a sphere under non-uniform scale"));
    const auto scene = Scene::build(desc, workers());
    const auto seen = look_down(*scene, 1, 1);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->p.z + scene->origin().z, 4, 1.5 * kFlatLayerShare);
    EXPECT_EQ(std::abs(seen->shading.n.z), 1);
    EXPECT_FALSE(look_down(*scene, 1.1, 1.1));
}

// A scale that goes from 1 through 0 at second 1 to -1 on these axes.
GltfBuilder& passing_zero(GltfBuilder& b, const Vec3f& axes) {
    const auto keys = [&](float s) { return Vec3f(1) + (s - 1) * axes; };
    std::vector<float> values;
    for (const float s : {1.0f, -1.0f}) {
        for (int i = 0; i < 3; ++i) values.push_back(keys(s)[i]);
    }
    with_roof(b, {{{"mesh", 0}}, {{"mesh", 0}, {"name", "other"}}});
    b.root["scenes"][0]["nodes"] = {0, 1};
    b.push("animations",
           {{"samplers", Json::array({{{"input", b.add_floats({0, 2}, "SCALAR")},
                                       {"output", b.add_floats(values, "VEC3")}}})},
            {"channels",
             Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})}});
    return b;
}

TEST(Flat, AnAnimatedScaleMayPassZero) {
    for (const Vec3f& axes : {Vec3f(0, 0, 1), Vec3f(0, 1, 1), Vec3f(1)}) {
        GltfBuilder b;
        passing_zero(b, axes);
        const bool is_flat = axes == Vec3f(0, 0, 1);
        LoadOptions options;
        options.animation_time = 0.5;
        options.shutter_seconds = 1;
        const auto file = GltfFile::open(b.write_gltf(b.folder() / "passing.gltf"), options);
        ASSERT_TRUE(file.ok());
        const auto before = (*file)->read(options);
        ASSERT_TRUE(before.ok());
        const auto moving = set_in_motion(Scene::build(*before, workers()), *file, options);
        ASSERT_TRUE(moving.ok());
        ASSERT_TRUE((*moving)->motion());
        std::shared_ptr<const Scene> previous = *moving;
        for (const double seconds : {0.5, 0.75, 1.0, 1.25}) {
            previous = scene_at(**moving, seconds, workers(), previous, {});
            ASSERT_TRUE(previous);
            const bool is_hidden = seconds == 1.0 && !is_flat;
            EXPECT_EQ(previous->geometry().instances.size(), is_hidden ? 1u : 2u);
            ASSERT_EQ(previous->objects().size(), 2u);
            EXPECT_EQ(previous->objects()[previous->geometry().instances.back().object].name,
                      "other");
            EXPECT_TRUE(look_down(*previous, 0.5, 0.25));
        }
    }
}

}  // namespace
}  // namespace talbot
