// Animations, skins, morph targets, visibility, variants and the old specular-glossiness model:
// each a tiny file, with values worked out by hand from the specification.
#include <gtest/gtest.h>

#include <cmath>

#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

LoadOptions at(double seconds) {
    LoadOptions options;
    options.animation_time = seconds;
    return options;
}

// A channel that drives `path` of node 0 with these keys.
void animate(GltfBuilder& b, const char* path, const std::vector<float>& times, int output,
             const char* interpolation = nullptr) {
    Json sampler = {{"input", b.add_floats(times, "SCALAR")}, {"output", output}};
    if (interpolation) sampler["interpolation"] = interpolation;
    b.push("animations",
           {{"samplers", {sampler}},
            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}});
}

Vec3d place_of(const SceneDesc& scene, size_t instance = 0) {
    return Vec3d(scene.instances[instance].world_from_object[3]);
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Animation, LinearStepAndClamping) {
    for (const char* interpolation : {"LINEAR", "STEP"}) {
        GltfBuilder b;
        b.add_triangle();
        animate(b, "translation", {1, 2, 4}, b.add_floats({0, 0, 0, 10, 0, 0, 10, 20, 0}, "VEC3"),
                interpolation);
        const bool is_step = interpolation[0] == 'S';
        const auto place = [&](double seconds) {
            const auto scene = b.load(at(seconds));
            EXPECT_TRUE(scene.ok());
            return place_of(*scene);
        };
        expect_near(place(0), Vec3d(0));
        expect_near(place(1.25), is_step ? Vec3d(0) : Vec3d(2.5, 0, 0));
        expect_near(place(2), Vec3d(10, 0, 0));
        expect_near(place(3.5), is_step ? Vec3d(10, 0, 0) : Vec3d(10, 15, 0));
        expect_near(place(4), Vec3d(10, 20, 0));
        expect_near(place(99), Vec3d(10, 20, 0));
        TALBOT_LOADED(rest, b.load());
        expect_near(place_of(rest), Vec3d(0));
    }
}

// Appendix C: p(t) = (2t3-3t2+1) v0 + (t3-2t2+t) d b0 + (3t2-2t3) v1 + (t3-t2) d a1. The cubic
// x^3 over [0, 2] is its own Hermite curve.
TEST(Animation, CubicSplineReproducesACubic) {
    GltfBuilder b;
    b.add_triangle();
    const std::vector<float> keys{0,  0, 0, 0, 0, 0, 0,  0, 0,   // key 0: in-tangent, value, out
                                  12, 0, 0, 8, 0, 0, 12, 0, 0};  // key 2: slope 3 x^2 = 12
    animate(b, "translation", {0, 2}, b.add_floats(keys, "VEC3"), "CUBICSPLINE");
    for (const double t : {0.0, 0.3, 1.0, 1.7, 2.0}) {
        TALBOT_LOADED(scene, b.load(at(t)));
        expect_near(place_of(scene), Vec3d(t * t * t, 0, 0), 1e-5);
    }
}

TEST(Animation, RotationsTakeTheShorterArcAtConstantSpeed) {
    GltfBuilder b;
    b.add_triangle();
    // From 0 to 120 degrees about Z; the second key has the opposite sign.
    const float c = std::cos(static_cast<float>(M_PI) / 3),
                s = std::sin(static_cast<float>(M_PI) / 3);
    animate(b, "rotation", {0, 1}, b.add_floats({0, 0, 0, 1, 0, 0, -s, -c}, "VEC4"));
    for (const double t : {0.25, 0.5, 0.9}) {
        TALBOT_LOADED(scene, b.load(at(t)));
        const double angle = t * 2 * M_PI / 3;
        expect_near(Vec3d(scene.instances[0].world_from_object[0]),
                    Vec3d(std::cos(angle), std::sin(angle), 0));
    }
}

TEST(Animation, NormalisedIntegersAndScale) {
    GltfBuilder b;
    b.add_triangle();
    const int view = b.add_view(std::vector<int16_t>{0, 0, 0, 32767, 0, 0, 23170, 23170});
    animate(b, "rotation", {0, 1}, b.add_accessor(view, kShort, "VEC4", 2, 0, true));
    TALBOT_LOADED(scene, b.load(at(1)));
    expect_near(Vec3d(scene.instances[0].world_from_object[0]), Vec3d(0, 1, 0));
}

TEST(Animation, TheFirstAnimationOfAPropertyCounts) {
    GltfBuilder b;
    b.add_triangle();
    animate(b, "translation", {0}, b.add_floats({1, 0, 0}, "VEC3"));
    animate(b, "translation", {0}, b.add_floats({2, 0, 0}, "VEC3"));
    animate(b, "scale", {0}, b.add_floats({3, 3, 3}, "VEC3"));
    TALBOT_LOADED(scene, b.load(at(0)));
    expect_near(place_of(scene), Vec3d(1, 0, 0));
    expect_near(Vec3d(scene.instances[0].world_from_object[1]), Vec3d(0, 3, 0));
    EXPECT_TRUE(has_warning(scene, "earlier animation"));
}

TEST(Animation, WrongCountsAreRefusedByName) {
    GltfBuilder b;
    b.add_triangle();
    animate(b, "translation", {0, 1, 2}, b.add_floats({1, 0, 0, 2, 0, 0}, "VEC3"));
    const auto scene = b.load(at(0));
    ASSERT_FALSE(scene.ok());
    EXPECT_EQ(scene.error().element, "animations[0].channels[0]");
    EXPECT_TRUE(b.load().ok()) << "the rest pose does not need it";
    GltfBuilder sampler;
    sampler.add_triangle();
    animate(sampler, "translation", {0}, sampler.add_floats({1, 0, 0}, "VEC3"));
    sampler.root["animations"][0]["channels"][0]["sampler"] = 7;
    const auto other = sampler.load(at(0));
    ASSERT_FALSE(other.ok());
    EXPECT_EQ(other.error().element, "animations[0].channels[0].sampler");
}

// A channel of KHR_animation_pointer with one key at 0.
void point(GltfBuilder& b, const std::string& pointer, int output) {
    const int input = b.add_floats({0}, "SCALAR");
    b.push("animations",
           {{"samplers", {{{"input", input}, {"output", output}}}},
            {"channels",
             {{{"sampler", 0},
               {"target",
                {{"path", "pointer"},
                 {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}}}}});
}

TEST(AnimationPointer, MaterialsLightsCamerasAndVisibility) {
    GltfBuilder b;
    b.add_triangle();
    b.add_material({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}}}});
    b.root["meshes"][0]["primitives"][0]["material"] = 0;
    b.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    b.root["extensions"] = {
        {"KHR_lights_punctual", {{"lights", {{{"type", "point"}, {"intensity", 1}}}}}}};
    b.root["scenes"][0]["nodes"] = {0, 1};
    b.add_node({{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    point(b, "/materials/0/pbrMetallicRoughness/baseColorFactor",
          b.add_floats({0.25f, 0.5f, 0.75f, 1}, "VEC4"));
    point(b, "/materials/0/pbrMetallicRoughness/roughnessFactor", b.add_floats({0.125f}, "SCALAR"));
    point(b, "/cameras/0/perspective/yfov", b.add_floats({0.75f}, "SCALAR"));
    point(b, "/extensions/KHR_lights_punctual/lights/0/intensity", b.add_floats({8}, "SCALAR"));
    point(b, "/nodes/0/translation", b.add_floats({1, 2, 3}, "VEC3"));
    TALBOT_LOADED(scene, b.load(at(0)));
    EXPECT_EQ(scene.materials[1].base_color_factor, Vec4f(0.25f, 0.5f, 0.75f, 1));
    EXPECT_EQ(scene.materials[1].roughness_factor, 0.125f);
    EXPECT_NEAR(scene.cameras[0].yfov, 0.75, 1e-6);
    EXPECT_EQ(scene.lights[0].intensity, 8);
    expect_near(place_of(scene), Vec3d(1, 2, 3));
    EXPECT_TRUE(scene.warnings.empty());
    b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = true;
    point(b, "/nodes/0/extensions/KHR_node_visibility/visible", b.add_floats({0}, "SCALAR"));
    TALBOT_LOADED(hidden, b.load(at(0)));
    EXPECT_TRUE(hidden.instances.empty());
}

TEST(AnimationPointer, CannotReachTheStructure) {
    for (const char* pointer :
         {"/nodes/0/mesh", "/nodes/0/children", "/accessors/0/count", "/bufferViews/0/byteLength",
          "/nodes/9/scale", "nodes", "/materials/~5", "/meshes/0/primitives/0/indices"}) {
        GltfBuilder b;
        b.add_triangle();
        point(b, pointer, b.add_floats({5}, "SCALAR"));
        const auto scene = b.load(at(0));
        if (scene.ok()) {
            EXPECT_TRUE(has_warning(*scene, "keeps its value")) << pointer;
            EXPECT_EQ(scene->instances.size(), 1u) << pointer;
        } else {
            EXPECT_FALSE(scene.error().element.empty()) << pointer;
        }
    }
}

// A triangle with two targets; the second is sparse.
GltfBuilder& morphing(GltfBuilder& b) {
    b.add_triangle();
    const int up = b.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int i = b.add_view(std::vector<uint8_t>{2});
    const int v = b.add_view(std::vector<float>{0, 5, 0});
    const int sparse = b.add_accessor(-1, kFloat, "VEC3", 3);
    b.root["accessors"][sparse]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", i}, {"componentType", kUnsignedByte}}},
        {"values", {{"bufferView", v}}}};
    b.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", sparse}}};
    return b;
}

TEST(Morph, MeshWeightsNodeWeightsAndAnimatedOnes) {
    GltfBuilder b;
    morphing(b);
    const auto corner = [&](const LoadOptions& options, size_t vertex) {
        const auto scene = b.load(options);
        EXPECT_TRUE(scene.ok()) << scene.error().line();
        return Vec3d(scene->meshes[0].positions[vertex]);
    };
    expect_near(corner({}, 2), Vec3d(0, 1, 0));
    b.root["meshes"][0]["weights"] = {0.5, 0.0};
    expect_near(corner({}, 1), Vec3d(1, 0, 0.5));
    b.root["nodes"][0]["weights"] = {0.0, 1.0};
    expect_near(corner({}, 2), Vec3d(0, 6, 0));
    expect_near(corner({}, 1), Vec3d(1, 0, 0));
    animate(b, "weights", {0, 2}, b.add_floats({0, 0, 1, 2}, "SCALAR"));
    expect_near(corner(at(1), 2), Vec3d(0, 6, 0.5));
    expect_near(corner(at(2), 2), Vec3d(0, 11, 1));
}

TEST(Morph, NodesWithOtherWeightsGetTheirOwnMesh) {
    GltfBuilder b;
    morphing(b);
    b.root["scenes"][0]["nodes"] = {0, 1, 2};
    b.add_node({{"mesh", 0}, {"weights", {1, 0}}});
    b.add_node({{"mesh", 0}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes.size(), 2u);
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.instances[0].mesh, scene.instances[2].mesh);
    EXPECT_NE(scene.instances[0].mesh, scene.instances[1].mesh);
}

// Two joints at x = 0 and x = 1; the second is turned by 90 degrees about Z. The node of the mesh
// has a transform, which must not count.
GltfBuilder& skinned(GltfBuilder& b) {
    const int p = b.add_floats({0, 0, 0, 2, 0, 0, 1, 0, 1}, "VEC3");
    const int n = b.add_floats({0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3");
    const int j =
        b.add_accessor(b.add_view(std::vector<uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}),
                       kUnsignedByte, "VEC4", 3);
    const int w = b.add_floats({1, 0, 0, 0, 2, 0, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4");
    std::vector<float> bind(32, 0.0f);
    for (size_t k = 0; k < 2; ++k) {
        for (size_t d = 0; d < 4; ++d) bind[16 * k + 5 * d] = 1;
    }
    bind[16 + 12] = -1;
    const int m = b.add_floats(bind, "MAT4");
    b.root["accessors"][m]["count"] = 2;
    b.add_node(
        {{"mesh", b.add_mesh({{"POSITION", p}, {"NORMAL", n}, {"JOINTS_0", j}, {"WEIGHTS_0", w}})},
         {"skin", 0},
         {"translation", {100, 100, 100}}});
    const double h = std::sqrt(0.5);
    b.add_node({{"children", {2}}, {"translation", {0, 10, 0}}});
    b.add_node({{"translation", {1, 0, 0}}, {"rotation", {0, 0, h, h}}});
    b.root["scenes"][0]["nodes"] = {0, 1};
    b.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", m}}};
    return b;
}

TEST(Skin, VerticesFollowTheirJointsAndNotTheNode) {
    GltfBuilder b;
    TALBOT_LOADED(scene, skinned(b).load());
    ASSERT_EQ(scene.instances.size(), 1u);
    const auto world = [&](size_t v) {
        return Vec3d(scene.instances[0].world_from_object *
                     Vec4d(Vec3d(scene.meshes[0].positions[v]), 1));
    };
    expect_near(world(0), Vec3d(0, 10, 0));
    expect_near(world(1), Vec3d(1, 11, 0));  // weight 2 counts as 1; (2-1, 0) turned is (0, 1)
    expect_near(world(2), Vec3d(1, 10, 1));  // both joints hold (1, 0, 1) in place
    expect_near(Vec3d(scene.meshes[0].normals[0]), Vec3d(0, 1, 0));
    expect_near(Vec3d(scene.meshes[0].normals[1]), Vec3d(-1, 0, 0));
    const double h = std::sqrt(0.5);
    expect_near(Vec3d(scene.meshes[0].normals[2]), Vec3d(-h, h, 0));
}

TEST(Skin, AnimatedJoints) {
    GltfBuilder b;
    skinned(b);
    const int input = b.add_floats({0}, "SCALAR");
    const int output = b.add_floats({0, 20, 0}, "VEC3");
    b.push("animations",
           {{"samplers", {{{"input", input}, {"output", output}}}},
            {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}});
    TALBOT_LOADED(scene, b.load(at(0)));
    const Vec3d p(scene.instances[0].world_from_object *
                  Vec4d(Vec3d(scene.meshes[0].positions[0]), 1));
    expect_near(p, Vec3d(0, 20, 0));
}

TEST(Skin, DefectsAreRefusedByName) {
    const auto refused = [](void (*damage)(GltfBuilder&), const char* element, const char* part) {
        GltfBuilder b;
        damage(skinned(b));
        const auto scene = b.load();
        ASSERT_FALSE(scene.ok()) << part;
        EXPECT_EQ(scene.error().element, element);
        EXPECT_NE(scene.error().what.find(part), std::string::npos) << scene.error().line();
    };
    refused([](GltfBuilder& b) { b.root["skins"][0]["joints"] = {1}; }, "meshes[0].primitives[0]",
            "joint 1 is out of range: its skin has 1 joints");
    refused([](GltfBuilder& b) { b.root["skins"][0]["joints"] = Json::array(); }, "skins[0]",
            "no joints");
    refused(
        [](GltfBuilder& b) {
            b.root["skins"][0]["joints"] = {1, 2, 1};
        },
        "skins[0].inverseBindMatrices", "2 matrices for 3 joints");
    refused(
        [](GltfBuilder& b) {
            b.root["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0");
        },
        "meshes[0].primitives[0]", "no JOINTS_0");
}

TEST(Visibility, HidesTheSubtreeAndItsLightsButNoCamera) {
    GltfBuilder b;
    b.add_triangle();
    b.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    b.root["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
    b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = false;
    b.root["nodes"][0]["children"] = {1};
    b.add_node(
        {{"mesh", 0}, {"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    TALBOT_LOADED(hidden, b.load());
    EXPECT_TRUE(hidden.instances.empty());
    EXPECT_TRUE(hidden.lights.empty());
    EXPECT_EQ(hidden.cameras.size(), 1u);
    b.root["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = true;
    TALBOT_LOADED(shown, b.load());
    EXPECT_EQ(shown.instances.size(), 2u);
    EXPECT_EQ(shown.lights.size(), 1u);
}

TEST(Variants, ByNameAndListed) {
    GltfBuilder b;
    b.add_triangle();
    for (const char* name : {"a", "b", "c"}) b.add_material({{"name", name}});
    Json& primitive = b.root["meshes"][0]["primitives"][0];
    primitive["material"] = 0;
    primitive["extensions"]["KHR_materials_variants"]["mappings"] = {
        {{"material", 1}, {"variants", {0, 2}}}, {{"material", 2}, {"variants", {1}}}};
    b.root["extensions"]["KHR_materials_variants"]["variants"] = {
        {{"name", "day"}}, {{"name", "night"}}, {{"name", "dusk"}}, {{"name", "noon"}}};
    const auto material = [&](const std::string& variant) {
        LoadOptions options;
        options.variant = variant;
        const auto scene = b.load(options);
        EXPECT_TRUE(scene.ok());
        return scene->materials[scene->meshes[0].material].name;
    };
    EXPECT_EQ(material(""), "a");
    EXPECT_EQ(material("day"), "b");
    EXPECT_EQ(material("night"), "c");
    EXPECT_EQ(material("dusk"), "b");
    EXPECT_EQ(material("noon"), "a") << "no mapping: the primitive's own";
    LoadOptions unknown;
    unknown.variant = "dawn";
    const auto refused = b.load(unknown);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
    EXPECT_NE(refused.error().what.find("'day', 'night'"), std::string::npos);
    const auto file = GltfFile::open(b.folder() / "scene.gltf");
    ASSERT_TRUE(file.ok());
    EXPECT_EQ((*file)->choices().variants,
              (std::vector<std::string>{"day", "night", "dusk", "noon"}));
    primitive["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] = 3;
    const auto range = b.load();
    ASSERT_FALSE(range.ok());
    EXPECT_EQ(range.error().element,
              "meshes[0].primitives[0].extensions.KHR_materials_variants.mappings[0].material");
}

// Reflectance at normal incidence is the specular colour, roughness is 1 - glossiness.
TEST(SpecularGlossiness, BecomesMetallicRoughness) {
    GltfBuilder b;
    const Json attributes = b.quad_attributes();
    const int i = b.quad_indices();
    const int t = b.add_texture(Image8{1, 1, {10, 20, 30, 200}, ""});
    b.add_material({{"extensions",
                     {{"KHR_materials_pbrSpecularGlossiness",
                       {{"diffuseFactor", {0.5, 0.25, 0.125, 1}},
                        {"specularFactor", {0.25, 0.5, 0.75}},
                        {"glossinessFactor", 0.5},
                        {"specularGlossinessTexture", {{"index", t}}}}}}}});
    b.add_material(
        {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"glossinessFactor", 0.25}}}}}});
    b.add_node({{"mesh", b.add_mesh(attributes, i, 4, 0)}, {"children", {1}}});
    b.add_node({{"mesh", b.add_mesh(attributes, i, 4, 1)}});
    TALBOT_LOADED(scene, b.load());
    const Material& m = scene.materials[1];
    EXPECT_EQ(m.base_color_factor, Vec4f(0.5f, 0.25f, 0.125f, 1));
    EXPECT_EQ(m.metallic_factor, 0);
    EXPECT_EQ(m.ior, 0);
    EXPECT_EQ(m.specular_color_factor, Rgb(0.25f, 0.5f, 0.75f));
    EXPECT_EQ(m.roughness_factor, 1);
    ASSERT_TRUE(m.metallic_roughness_texture.used() && m.specular_color_texture.used());
    const Image8& roughness = *scene.textures[m.metallic_roughness_texture.texture].image;
    EXPECT_EQ(roughness.rgba[1], 155) << "255 - 0.5 * 200";
    EXPECT_EQ(scene.textures[m.specular_color_texture.texture].image->rgba[2], 30);
    EXPECT_EQ(scene.materials[2].roughness_factor, 0.75f);
    EXPECT_EQ(scene.materials[2].base_color_factor, Vec4f(1));
}

}  // namespace
}  // namespace talbot
