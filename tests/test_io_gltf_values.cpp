// Values of the wrong type or size: the default is used and a warning names the element; integers
// that do not fit are refused.
#include <gtest/gtest.h>

#include <algorithm>

#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

void expect_out_of_range(GltfBuilder& builder, const std::string& element) {
    const auto result = builder.load();
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().element, element);
    EXPECT_NE(result.error().what.find("out of range: at most 2147483647"), std::string::npos)
        << result.error().what;
}

TEST(Values, OfTheWrongKindAreReported) {
    GltfBuilder b;
    b.add_triangle();
    b.root["nodes"][0]["translation"] = {1, "0", 0};
    b.root["nodes"][0]["scale"] = 2;
    b.push("materials",
           {{"pbrMetallicRoughness", {{"baseColorFactor", {0.8, 0, 0}}, {"roughnessFactor", "x"}}},
            {"emissiveFactor", {1, 2, 3}},
            {"extensions", {{"KHR_materials_sheen", "x"}}}});
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"intensity", "x"}, {"color", {1, 1, 1, 1}}}};
    TALBOT_LOADED(scene, b.load());
    EXPECT_TRUE(has_warning(scene, "nodes[0].translation: is not 3 numbers"));
    EXPECT_TRUE(has_warning(scene, "nodes[0].scale: is not 3 numbers"));
    EXPECT_TRUE(
        has_warning(scene, "materials[0].pbrMetallicRoughness.baseColorFactor: is not 4 numbers"));
    EXPECT_TRUE(
        has_warning(scene, "materials[0].pbrMetallicRoughness.roughnessFactor: is not a number"));
    EXPECT_TRUE(
        has_warning(scene, "materials[0].extensions.KHR_materials_sheen: is not an object"));
    EXPECT_TRUE(
        has_warning(scene, "extensions.KHR_lights_punctual.lights[0].intensity: is not a number"));
    EXPECT_TRUE(
        has_warning(scene, "extensions.KHR_lights_punctual.lights[0].color: is not 3 numbers"));
    EXPECT_FALSE(has_warning(scene, "emissiveFactor"));
    EXPECT_EQ(std::count_if(scene.warnings.begin(), scene.warnings.end(),
                            [](const std::string& w) { return w.find("sheen:") != w.npos; }),
              1);
}

TEST(Values, TransformsThatAreNoneAreReported) {
    GltfBuilder b;
    b.add_triangle();
    const auto add = [&](const char* key, const Json& value) {
        b.root["scenes"][0]["nodes"].push_back(b.add_node({{"mesh", 0}, {key, value}}));
    };
    add("rotation", {0, 0, 0, 0});
    add("rotation", {0, 0, 0, 2.5});
    add("rotation", {0, 0, 0.7071, 0.7071});
    add("matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 2});
    add("matrix", {1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1});
    add("matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.instances.size(), 7u);
    const std::vector<std::string> expected{
        "nodes[1].rotation: is 0, 0, 0, 0, which is no rotation; none is made",
        "nodes[2].rotation: has length 2.5 instead of 1; it is taken at length 1",
        "nodes[4].matrix: has the last row 0, 0, 0, 2 instead of 0, 0, 0, 1, which is taken",
        "nodes[5].matrix: has the last row 4, 5, 6, 1 instead of 0, 0, 0, 1, which is taken; is it "
        "written by rows? It must be by columns"};
    EXPECT_EQ(scene.warnings, expected);
}

TEST(Values, InstancesWithoutARotationAreCounted) {
    GltfBuilder b;
    b.add_triangle();
    const int r = b.add_floats({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0}, "VEC4");
    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"ROTATION", r}};
    b.use_extension("EXT_mesh_gpu_instancing", true);
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.instances.size(), 3u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0],
              "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.ROTATION: 2 are 0, 0, 0, 0, "
              "which is no rotation; none is made");
}

TEST(Values, OfExtrasAreReportedWhereTheyAreOurs) {
    GltfBuilder b;
    b.add_triangle();
    for (const Json& extras : {Json{{"lens", {{"apertureRadius", "wide"}, {"focusDistance", 3}}}},
                               Json("a string is fine"), Json{{"resolution", {640, 480, 3}}},
                               Json{{"lens", 7}}, Json{{"other", "program's"}}}) {
        b.push("cameras", {{"type", "perspective"},
                           {"perspective", {{"yfov", 1}, {"znear", 0.1}}},
                           {"extras", extras}});
    }
    b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"extras", {{"angularDiameter", "0.5 degrees"}}}}};
    b.root["extensions"]["KHR_implicit_shapes"]["shapes"] = {
        {{"type", "sphere"}, {"sphere", {{"radius", "1"}}}}};
    TALBOT_LOADED(scene, b.load());
    EXPECT_TRUE(
        has_warning(scene, "cameras[0].extras.lens.apertureRadius: is not a number; the default"));
    EXPECT_TRUE(has_warning(scene, "cameras[2].extras.resolution: is not 2 numbers"));
    EXPECT_TRUE(has_warning(scene, "cameras[3].extras.lens: is not an object"));
    EXPECT_TRUE(has_warning(scene, "lights[0].extras.angularDiameter: is not a number"));
    EXPECT_TRUE(has_warning(scene, "shapes[0].sphere.radius: is not a number"));
    EXPECT_EQ(scene.warnings.size(), 5u);
}

TEST(Values, WarningsHaveAnEnd) {
    GltfBuilder b;
    b.add_triangle();
    for (int i = 0; i < 1000; ++i) b.push("materials", {{"alphaCutoff", "x"}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_LT(scene.warnings.size(), 30u);
    EXPECT_TRUE(has_warning(scene, "980 more"));
}

TEST(Values, IntegersThatDoNotFitAreRefused) {
    GltfBuilder b;
    b.add_triangle();
    b.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 4294967296ull;
    expect_out_of_range(b, "nodes[0].extensions.KHR_lights_punctual.light");
    GltfBuilder sparse;
    sparse.add_triangle();
    sparse.root["accessors"][0]["sparse"] = {
        {"count", 4294967297ull},
        {"indices", {{"bufferView", 0}, {"componentType", 5121}}},
        {"values", {{"bufferView", 0}}}};
    expect_out_of_range(sparse, "accessors[0].sparse.count");
}

}  // namespace
}  // namespace talbot
