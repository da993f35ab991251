// What loading decides about nodes, instances, cameras, lights, the environment and analytic
// spheres.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

Vec3d transformed(const Mat4d& m, const Vec3d& p) {
    return Vec3d(m * Vec4d(p, 1));
}

// A triangle mesh 0 and these nodes.
GltfBuilder& with_nodes(GltfBuilder& b, const Json& nodes) {
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    b.add_mesh({{"POSITION", p}});
    b.root["nodes"] = nodes;
    return b;
}

TEST(Nodes, ScaleThenRotateThenTranslate) {
    GltfBuilder b;
    const double h = std::sqrt(0.5);
    with_nodes(b, {{{"mesh", 0},
                    {"translation", {1, 2, 3}},
                    {"rotation", {0, 0, h, h}},  // 90 degrees about +Z
                    {"scale", {2, 3, 4}}}});
    TALBOT_LOADED(scene, b.load());
    const Mat4d& m = scene.instances.at(0).world_from_object;
    EXPECT_NEAR(length(transformed(m, Vec3d(1, 0, 0)) - Vec3d(1, 4, 3)), 0, 1e-12);
    EXPECT_NEAR(length(transformed(m, Vec3d(0, 1, 0)) - Vec3d(-2, 2, 3)), 0, 1e-12);
    EXPECT_NEAR(length(transformed(m, Vec3d(0, 0, 1)) - Vec3d(1, 2, 7)), 0, 1e-12);
}

TEST(Nodes, MatricesAreColumnMajorAndComposeWithParents) {
    GltfBuilder b;
    with_nodes(
        b, {{{"children", {1}}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}},
            {{"mesh", 0}, {"translation", {1, 0, 0}}}});
    TALBOT_LOADED(scene, b.load());
    const Mat4d& m = scene.instances.at(0).world_from_object;
    EXPECT_EQ(transformed(m, Vec3d(0)), Vec3d(10, 21, 30));
    EXPECT_EQ(transformed(m, Vec3d(0, 1, 0)), Vec3d(9, 21, 30));
}

TEST(Nodes, TransformsAreComposedInDouble) {
    GltfBuilder b;
    with_nodes(b, {{{"children", {1}}, {"translation", {1e9, 0, 0}}},
                   {{"mesh", 0}, {"translation", {0.125, 0, 0}}}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.instances.at(0).world_from_object[3].x, 1e9 + 0.125);
}

TEST(Nodes, NegativeScaleKeepsItsSign) {
    GltfBuilder b;
    with_nodes(b, {{{"mesh", 0}, {"scale", {-1, 1, 1}}}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_LT(glm::determinant(Mat3d(scene.instances.at(0).world_from_object)), 0);
}

TEST(Nodes, InstancesTooFarOutAreDropped) {
    GltfBuilder b;
    with_nodes(b, {{{"children", {1, 2}}},
                   {{"mesh", 0}, {"translation", {1e30, 0, 0}}},
                   {{"mesh", 0}, {"translation", {1e10, 0, 0}}}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_TRUE(has_warning(scene,
                            "node 1: 1 instances, of which this is the first, reach out of range "
                            "(-1e+15 to 1e+15 m)"));
}

TEST(Nodes, WithoutScenesAllRootsAreShown) {
    GltfBuilder b;
    with_nodes(b, {{{"mesh", 0}}, {{"children", {2}}}, {{"mesh", 0}}});
    b.root.erase("scene");
    b.root.erase("scenes");
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.instances.size(), 2u);
}

TEST(Nodes, WithoutADefaultTheFirstSceneIsShown) {
    GltfBuilder b;
    with_nodes(b, {{{"mesh", 0}}, {{"mesh", 0}, {"name", "second"}}});
    b.root["scenes"] = {{{"nodes", {1}}}, {{"nodes", {0, 1}}}};
    b.root.erase("scene");
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "second");
}

TEST(Nodes, SceneByNameOrIndex) {
    GltfBuilder b;
    with_nodes(b, {{{"mesh", 0}}, {{"mesh", 0}}, {{"mesh", 0}}});
    b.root["scenes"] = {
        {{"nodes", {0}}}, {{"nodes", {0, 1}}, {"name", "pair"}}, {{"nodes", {0, 1, 2}}}};
    LoadOptions options;
    options.scene = "pair";
    TALBOT_LOADED(pair, b.load(options));
    EXPECT_EQ(pair.instances.size(), 2u);
    EXPECT_EQ(pair.name, "pair");
    options.scene = "2";
    TALBOT_LOADED(third, b.load(options));
    EXPECT_EQ(third.instances.size(), 3u);
    options.scene = "nothing";
    const auto missing = b.load(options);
    ASSERT_FALSE(missing.ok());
    EXPECT_EQ(missing.error().kind, ErrorKind::usage);
    EXPECT_NE(missing.error().what.find("1 'pair'"), std::string::npos) << missing.error().line();
}

TEST(Nodes, ObjectsAreNamedAfterNodes) {
    GltfBuilder b;
    with_nodes(b, {{{"mesh", 0}, {"name", "left"}, {"children", {1}}}, {{"mesh", 0}}});
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[scene.instances[0].object].name, "left");
    EXPECT_EQ(scene.objects[scene.instances[1].object].name, "node 1");
    EXPECT_EQ(scene.instances[0].mesh, scene.instances[1].mesh) << "shared";
}

TEST(Instancing, WorldIsNodeTimesInstance) {
    GltfBuilder b;
    with_nodes(b, {{{"mesh", 0}, {"translation", {100, 0, 0}}, {"scale", {2, 2, 2}}}});
    const int t = b.add_floats({1, 0, 0, 0, 5, 0}, "VEC3");
    const int r = b.add_accessor(b.add_view(std::vector<int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}),
                                 kShort, "VEC4", 2, 0, true);
    const int s = b.add_floats({1, 1, 1, -1, 1, 1}, "VEC3");
    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", t}, {"ROTATION", r}, {"SCALE", s}, {"_ID", t}};
    b.use_extension("EXT_mesh_gpu_instancing", true);
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.instances.size(), 2u) << "the plain mesh is not drawn";
    EXPECT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(transformed(scene.instances[0].world_from_object, Vec3d(1, 0, 0)), Vec3d(104, 0, 0));
    // Mirrored in x, turned by 180 degrees about z: (1, 2, 0) -> (-1, 2, 0) -> (1, -2, 0) -> +(0,
    // 5, 0).
    const Vec3d p = transformed(scene.instances[1].world_from_object, Vec3d(1, 2, 0));
    EXPECT_NEAR(length(p - Vec3d(102, 6, 0)), 0, 1e-9);
    EXPECT_LT(glm::determinant(Mat3d(scene.instances[1].world_from_object)), 0);
}

TEST(Cameras, NodeScaleIsIgnored) {
    GltfBuilder b;
    const double h = std::sqrt(0.5);
    b.root["cameras"] = {{{"type", "perspective"},
                          {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 2.0}}}}};
    with_nodes(b, {{{"children", {1}}, {"scale", {5, 5, 5}}},
                   {{"camera", 0},
                    {"name", "eye"},
                    {"translation", {1, 2, 3}},
                    {"rotation", {0, h, 0, h}},
                    {"scale", {1, 1, -3}}}});
    TALBOT_LOADED(scene, b.load());
    const Camera& camera = scene.cameras.at(0);
    EXPECT_EQ(camera.name, "eye");
    EXPECT_EQ(camera.kind, CameraKind::perspective);
    EXPECT_EQ(camera.yfov, 0.5);
    EXPECT_EQ(camera.aspect_ratio, 2.0);
    EXPECT_EQ(camera.position, Vec3d(5, 10, 15)) << "the parent's scale moves it";
    EXPECT_NEAR(length(camera.backward - Vec3d(1, 0, 0)), 0, 1e-12);
    EXPECT_NEAR(length(camera.up - Vec3d(0, 1, 0)), 0, 1e-12);
    EXPECT_NEAR(length(camera.right - Vec3d(0, 0, -1)), 0, 1e-12);
}

TEST(Cameras, OrthographicAndExtras) {
    GltfBuilder b;
    b.root["cameras"] = {
        {{"type", "orthographic"},
         {"name", "plan"},
         {"orthographic", {{"xmag", 3.0}, {"ymag", 2.0}, {"znear", 0.0}, {"zfar", 9.0}}},
         {"extras",
          {{"resolution", {640, 360}},
           {"lens", {{"apertureRadius", 0.05}, {"focusDistance", 4.5}}},
           {"lensShift", {0.25, -0.5}}}}}};
    with_nodes(b, {{{"camera", 0}}});
    TALBOT_LOADED(scene, b.load());
    const Camera& camera = scene.cameras.at(0);
    EXPECT_EQ(camera.name, "plan");
    EXPECT_EQ(camera.kind, CameraKind::orthographic);
    EXPECT_EQ(camera.xmag, 3.0);
    EXPECT_EQ(camera.ymag, 2.0);
    EXPECT_EQ(camera.resolution, (Resolution{640, 360}));
    EXPECT_EQ(camera.aperture_radius, 0.05);
    EXPECT_EQ(camera.focus_distance, 4.5);
    EXPECT_EQ(camera.lens_shift, Vec2d(0.25, -0.5));
}

TEST(Cameras, BadOnesAreLeftOutAndNonsenseExtrasIgnored) {
    GltfBuilder b;
    b.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 4.0}, {"znear", 0.1}}}},
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 0}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}},
        {{"type", "perspective"},
         {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", -1}}},
         {"extras", {{"resolution", {0, 1e9}}, {"lens", 7}, {"lensShift", "left"}}}}};
    with_nodes(b, {{{"children", {1, 2}}, {"camera", 0}}, {{"camera", 1}}, {{"camera", 2}}});
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_FALSE(scene.cameras[0].resolution.has_value());
    EXPECT_FALSE(scene.cameras[0].aspect_ratio.has_value());
    EXPECT_TRUE(has_warning(scene, "cameras[0]: yfov"));
    EXPECT_TRUE(has_warning(scene, "cameras[1]: xmag"));
}

TEST(Lights, UnitsAndSunAngleAreAsAskedFor) {
    GltfBuilder b;
    b.use_extension("KHR_lights_punctual");
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"intensity", 2}, {"extras", {{"angularDiameter", 0.5}}}},
        {{"type", "directional"}, {"intensity", 3}, {"extras", {{"angularDiameter", 0.01}}}},
        {{"type", "directional"}}};
    const auto light = [](int i) { return Json{{"KHR_lights_punctual", {{"light", i}}}}; };
    with_nodes(b, {{{"children", {1, 2}}, {"extensions", light(0)}},
                   {{"extensions", light(1)}},
                   {{"extensions", light(2)}}});
    TALBOT_LOADED(as_specified, b.load());
    ASSERT_EQ(as_specified.lights.size(), 3u);
    EXPECT_EQ(as_specified.lights[0].intensity, 2);
    EXPECT_EQ(as_specified.lights[0].angular_diameter, 0) << "a point light is none";
    EXPECT_EQ(as_specified.lights[1].intensity, 3);
    EXPECT_EQ(as_specified.lights[1].angular_diameter, 0.01f);
    EXPECT_FALSE(as_specified.lights[2].is_disc());
    LoadOptions options;
    options.lights.units = LightUnits::radiometric;
    options.lights.sun_degrees = 90;
    TALBOT_LOADED(watts, b.load(options));
    ASSERT_EQ(watts.lights.size(), 3u);
    EXPECT_EQ(watts.lights[0].intensity, 2 * 683.0f);
    EXPECT_EQ(watts.lights[1].intensity, 3 * 683.0f);
    EXPECT_FLOAT_EQ(watts.lights[1].angular_diameter, 0.5f * kPi);
    EXPECT_FLOAT_EQ(watts.lights[2].angular_diameter, 0.5f * kPi);
    EXPECT_FALSE(watts.lights[0].is_disc());
}

TEST(Lights, PlacedWithoutScale) {
    GltfBuilder b;
    const double h = std::sqrt(0.5);
    b.use_extension("KHR_lights_punctual");
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"},
         {"intensity", 20},
         {"color", {1, 0.5, 0.25}},
         {"range", 7},
         {"name", "bulb"}},
        {{"type", "directional"}},
        {{"type", "spot"},
         {"intensity", 5},
         {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}}};
    const auto light = [](int i) { return Json{{"KHR_lights_punctual", {{"light", i}}}}; };
    with_nodes(b, {{{"children", {1, 2, 3}},
                    {"scale", {10, 10, 10}},
                    {"extensions", light(0)},
                    {"translation", {1, 2, 3}}},
                   {{"extensions", light(1)}, {"rotation", {-h, 0, 0, h}}},
                   {{"extensions", light(2)}, {"translation", {0, 1, 0}}, {"name", "lamp"}},
                   {{"extensions", light(3)}}});
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.lights.size(), 4u);
    const PunctualLight& point = scene.lights[0];
    EXPECT_EQ(point.kind, PunctualKind::point);
    EXPECT_EQ(point.name, "bulb");
    EXPECT_EQ(point.intensity, 20);
    EXPECT_EQ(point.range, 7);
    EXPECT_EQ(point.color, Rgb(1, 0.5f, 0.25f));
    EXPECT_EQ(point.position, Vec3d(1, 2, 3));
    const PunctualLight& sun = scene.lights[1];
    EXPECT_EQ(sun.kind, PunctualKind::directional);
    EXPECT_NEAR(length(sun.direction - Vec3f(0, -1, 0)), 0, 1e-6)
        << "-Z turned by -90 degrees about X";
    EXPECT_EQ(sun.range, kInfinity);
    const PunctualLight& spot = scene.lights[2];
    EXPECT_EQ(spot.name, "lamp");
    EXPECT_EQ(spot.position, Vec3d(1, 12, 3));
    EXPECT_EQ(spot.intensity, 5) << "scale does not change it";
    EXPECT_EQ(spot.inner_cone_angle, 0.2f);
    EXPECT_EQ(spot.outer_cone_angle, 0.6f);
    EXPECT_LT(scene.lights[3].inner_cone_angle, scene.lights[3].outer_cone_angle)
        << "equal angles occur";
    EXPECT_EQ(scene.lights[3].outer_cone_angle, 0.5f);
}

TEST(Environment, ColourAndGradient) {
    GltfBuilder b;
    b.add_triangle();
    TALBOT_LOADED(black, b.load());
    EXPECT_EQ(black.environment.color, Rgb(0));
    b.root["scenes"][0]["extras"]["environment"] = {{"color", {0.3, 0.36, 2.5}}};
    TALBOT_LOADED(uniform, b.load());
    EXPECT_EQ(uniform.environment.color, Rgb(0.3f, 0.36f, 2.5f));
    EXPECT_FALSE(uniform.environment.gradient.has_value());
    b.root["scenes"][0]["extras"]["environment"] = {
        {"gradient", {{"axis", {2, 0, 0}}, {"from", {1, 1, 1}}, {"to", {1, 0, 0}}}}};
    TALBOT_LOADED(gradient, b.load());
    ASSERT_TRUE(gradient.environment.gradient.has_value());
    EXPECT_EQ(gradient.environment.gradient->axis, Vec3f(1, 0, 0));
    EXPECT_EQ(gradient.environment.gradient->from, Rgb(1));
    EXPECT_EQ(gradient.environment.gradient->to, Rgb(1, 0, 0));
}

GltfBuilder& with_sphere(GltfBuilder& b, const Json& node) {
    b.use_extension("KHR_implicit_shapes");
    b.use_extension("TALBOT_implicit_surface");
    b.root["extensions"]["KHR_implicit_shapes"]["shapes"] = {
        {{"type", "box"}}, {{"type", "sphere"}, {"sphere", {{"radius", 1.5}}}}};
    b.add_material({{"name", "red"}});
    Json placed = node;
    placed["extensions"]["TALBOT_implicit_surface"] = {{"shape", 1}, {"material", 0}};
    b.add_node(placed);
    return b;
}

TEST(Spheres, UniformScaleStaysExact) {
    GltfBuilder b;
    with_sphere(b, {{"translation", {1, 2, 3}},
                    {"rotation", {0.1, 0.3, 0.3, 0.9}},
                    {"scale", {-2, 2, 2}},
                    {"name", "ball"}});
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_EQ(scene.spheres[0].center, Vec3d(1, 2, 3));
    EXPECT_NEAR(scene.spheres[0].radius, 3, 1e-12);
    EXPECT_EQ(scene.spheres[0].material, 1u);
    EXPECT_EQ(scene.objects.at(scene.spheres[0].object).name, "ball");
    EXPECT_TRUE(scene.meshes.empty());
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Spheres, NonUniformScaleBecomesAnEllipsoid) {
    GltfBuilder b;
    with_sphere(b, {{"scale", {1, 2, 1}}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_TRUE(scene.spheres.empty());
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_TRUE(has_warning(scene, "sphere under non-uniform scale"));
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.material, 1u);
    double volume = 0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto p = [&](size_t k) {
            return transformed(scene.instances[0].world_from_object,
                               Vec3d(mesh.positions[mesh.indices[i + k]]));
        };
        volume += dot(p(0), cross(p(1), p(2))) / 6;
    }
    const double exact = 4.0 / 3 * std::numbers::pi * 1.5 * 1.5 * 3.0;
    EXPECT_NEAR(volume / exact, 1, 0.005) << "outward winding, and closed";
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        EXPECT_NEAR(length(mesh.positions[v]), 1, 1e-5) << "the radius is in the transform";
        EXPECT_NEAR(dot(mesh.normals[v], mesh.positions[v]), 1, 1e-5);
    }
}

TEST(Progress, RisesFromNoughtToOneAndStops) {
    GltfBuilder b;
    b.add_triangle();
    LoadOptions options;
    std::vector<float> seen;
    options.progress = [&](float fraction, const char*) { seen.push_back(fraction); };
    TALBOT_LOADED(scene, b.load(options));
    ASSERT_GE(seen.size(), 3u);
    EXPECT_EQ(seen.front(), 0);
    EXPECT_EQ(seen.back(), 1);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_EQ(scene.sha256.size(), 64u);

    std::stop_source source;
    options.stop = source.get_token();
    options.progress = [&](float fraction, const char*) {
        if (fraction > 0) source.request_stop();
    };
    const auto stopped = b.load(options);
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().kind, ErrorKind::cancelled);
}

TEST(Determinism, ThreadsDoNotChangeTheScene) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    const int material = b.add_material({{"normalTexture", {{"index", b.add_texture()}}}});
    const int i = b.quad_indices();
    Json nodes = Json::array({Json{{"children", Json::array()}}});
    for (int k = 1; k < 40; ++k) {
        b.add_mesh(attributes, i, 4, material);
        nodes[0]["children"].push_back(k);
        nodes.push_back({{"mesh", k - 1}});
    }
    b.root["nodes"] = nodes;
    LoadOptions one, three;
    one.threads = 1;
    three.threads = 3;
    TALBOT_LOADED(a, b.load(one));
    TALBOT_LOADED(c, b.load(three));
    ASSERT_EQ(a.meshes.size(), c.meshes.size());
    for (size_t m = 0; m < a.meshes.size(); ++m) {
        EXPECT_EQ(a.meshes[m].name, c.meshes[m].name);
        EXPECT_EQ(a.meshes[m].tangents, c.meshes[m].tangents);
    }
}

}  // namespace
}  // namespace talbot
