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
    EXPECT_NE(result.error().what.find("out of range"), std::string::npos);
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
