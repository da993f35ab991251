// What loading decides about geometry: accessors, primitive modes, attributes, quantisation.
// Expected values are written out.
#include <gtest/gtest.h>

#include <cmath>

#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

using Triangle = std::array<Vec3f, 3>;

std::vector<Triangle> triangles(const Mesh& mesh) {
    std::vector<Triangle> out;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        out.push_back({mesh.positions[mesh.indices[i]], mesh.positions[mesh.indices[i + 1]],
                       mesh.positions[mesh.indices[i + 2]]});
    }
    return out;
}

Vec3f point(int i) {
    return Vec3f(static_cast<float>(i), static_cast<float>(i * i), 0);
}

TEST(Modes, StripKeepsTheWindingOfEveryTriangle) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 1, 0, 2, 4, 0, 3, 9, 0, 4, 16, 0}, "VEC3");
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, -1, 5)}});
    TALBOT_LOADED(scene, b.load());
    const std::vector<Triangle> expected{{point(0), point(1), point(2)},
                                         {point(1), point(3), point(2)},
                                         {point(2), point(3), point(4)}};
    EXPECT_EQ(triangles(scene.meshes.at(0)), expected);
}

TEST(Modes, FanTurnsAboutItsFirstVertex) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 1, 0, 2, 4, 0, 3, 9, 0}, "VEC3");
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, -1, 6)}});
    TALBOT_LOADED(scene, b.load());
    const std::vector<Triangle> expected{{point(1), point(2), point(0)},
                                         {point(2), point(3), point(0)}};
    EXPECT_EQ(triangles(scene.meshes.at(0)), expected);
}

TEST(Modes, TrianglesThatJoinStripsAreDropped) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 1, 0, 2, 4, 0, 3, 9, 0}, "VEC3");
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, b.add_indices({0, 1, 2, 2, 3}), 5)}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes.at(0).triangle_count(), 1u);
}

TEST(Modes, WhatHasNoAreaIsNamedAndCounted) {
    GltfBuilder b;
    // On a line that has no exact floats but these, and once more with a vertex named twice.
    const int p = b.add_floats({0, 0, 0, 0.1f, 0.1f, 0.1f, 0.3f, 0.3f, 0.3f, 0, 1, 0}, "VEC3");
    b.push(
        "meshes",
        {{"primitives",
          Json::array(
              {{{"attributes", {{"POSITION", p}}}, {"indices", b.add_indices({0, 1, 3})}},
               {{"attributes", {{"POSITION", p}}},
                {"indices", b.add_indices({0, 1, 2, 2, 1, 0, 0, 0, 3})}},
               {{"attributes", {{"POSITION", p}}}, {"indices", b.add_indices({1, 1, 2, 3, 0, 3})}},
               {{"attributes", {{"POSITION", p}}},
                {"indices", b.add_indices({0, 1, 2, 0, 1, 3})}}})}});
    b.add_node({{"mesh", 0}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes.size(), 2u);
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_EQ(scene.warnings[0],
              "meshes[0].primitives[1]: all 3 triangles are lines or points; it is not drawn");
    EXPECT_EQ(scene.warnings[1],
              "meshes[0].primitives[2]: all 2 triangles are lines or points; it is not drawn");
}

TEST(Modes, PointsAndLinesAreSkippedWithOneWarning) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    Json primitives = Json::array();
    for (int mode = 0; mode <= 4; ++mode) {
        primitives.push_back({{"attributes", {{"POSITION", p}}}, {"mode", mode}});
    }
    b.push("meshes", {{"primitives", primitives}});
    b.add_node({{"mesh", 0}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.instances.size(), 1u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(scene, "4 primitives of points or lines"));
}

TEST(Accessors, NoIndicesMeansVerticesInOrder) {
    GltfBuilder b;
    b.add_triangle();
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].indices, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_TRUE(scene.meshes[0].normals.empty());
    EXPECT_TRUE(scene.meshes[0].tangents.empty());
}

template <typename T>
std::vector<uint32_t> indices_as(int component_type) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 1, 0, 2, 4, 0, 3, 9, 0}, "VEC3");
    const std::vector<T> values{3, 1, 0, 0, 1, 2};
    const int i = b.add_accessor(b.add_view(values), component_type, "SCALAR", values.size());
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, i)}});
    const auto scene = b.load();
    EXPECT_TRUE(scene.ok());
    return scene.ok() ? scene->meshes.at(0).indices : std::vector<uint32_t>();
}

TEST(Accessors, IndicesOfEveryWidth) {
    const std::vector<uint32_t> expected{3, 1, 0, 0, 1, 2};
    EXPECT_EQ(indices_as<uint8_t>(kUnsignedByte), expected);
    EXPECT_EQ(indices_as<uint16_t>(kUnsignedShort), expected);
    EXPECT_EQ(indices_as<uint32_t>(kUnsignedInt), expected);
}

TEST(Accessors, InterleavedWithOffsets) {
    GltfBuilder b;
    std::vector<float> vertices{-1, -1};  // two floats before the first vertex
    for (int i = 0; i < 3; ++i) {
        const Vec3f p = point(i);
        for (const float x : {p.x, p.y, p.z, 0.f, 0.f, 2.f, p.x / 4, p.y / 4})
            vertices.push_back(x);
    }
    const int view = b.add_view(vertices, 32);
    b.root["bufferViews"][0]["byteOffset"] = 0;
    const int p = b.add_accessor(view, kFloat, "VEC3", 3, 8);
    const int n = b.add_accessor(view, kFloat, "VEC3", 3, 20);
    const int t = b.add_accessor(view, kFloat, "VEC2", 3, 32);
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", t}})}});
    TALBOT_LOADED(scene, b.load());
    for (size_t i = 0; i < 3; ++i) {
        const Vec3f expected = point(static_cast<int>(i));
        EXPECT_EQ(scene.meshes[0].positions[i], expected);
        EXPECT_EQ(scene.meshes[0].normals[i], Vec3f(0, 0, 1)) << "normalised";
        EXPECT_EQ(scene.meshes[0].uv[0][i], Vec2f(expected.x / 4, expected.y / 4));
    }
}

Json sparse(int count, int index_view, int index_type, int value_view) {
    return {{"count", count},
            {"indices", {{"bufferView", index_view}, {"componentType", index_type}}},
            {"values", {{"bufferView", value_view}}}};
}

TEST(Accessors, SparseOverridesElements) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const int i = b.add_view(std::vector<uint8_t>{1, 2});
    const int v = b.add_view(std::vector<float>{5, 0, 0, 0, 7, 0});
    b.root["accessors"][p]["sparse"] = sparse(2, i, kUnsignedByte, v);
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}})}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].positions,
              (std::vector<Vec3f>{Vec3f(0), Vec3f(5, 0, 0), Vec3f(0, 7, 0)}));
}

TEST(Accessors, SparseWithoutABufferViewStartsFromZeros) {
    GltfBuilder b;
    const int i = b.add_view(std::vector<uint32_t>{1, 2});
    const int v = b.add_view(std::vector<float>{1, 0, 0, 0, 1, 0});
    const int p = b.add_accessor(-1, kFloat, "VEC3", 3);
    b.root["accessors"][p]["sparse"] = sparse(2, i, kUnsignedInt, v);
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}})}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].positions,
              (std::vector<Vec3f>{Vec3f(0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)}));
}

TEST(Accessors, SparseIndicesWithoutABufferView) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const int where = b.add_view(std::vector<uint8_t>{1, 2});
    const int what = b.add_view(std::vector<uint16_t>{2, 1});
    const int i = b.add_accessor(-1, kUnsignedShort, "SCALAR", 3);
    b.root["accessors"][i]["sparse"] = sparse(2, where, kUnsignedByte, what);
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, i)}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].indices, (std::vector<uint32_t>{0, 2, 1}));
}

TEST(Accessors, SparseWithinASharedVertexRange) {
    // The primitive uses vertices 2 to 4 only; the override of vertex 3 must still land.
    GltfBuilder b;
    const int p = b.add_floats({9, 9, 9, 9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 9, 9, 9}, "VEC3");
    const int i = b.add_view(std::vector<uint8_t>{0, 3});
    const int v = b.add_view(std::vector<float>{8, 8, 8, 2, 0, 0});
    b.root["accessors"][p]["sparse"] = sparse(2, i, kUnsignedByte, v);
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, b.add_indices({2, 3, 4}))}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].positions,
              (std::vector<Vec3f>{Vec3f(0), Vec3f(2, 0, 0), Vec3f(0, 1, 0)}))
        << "unused vertices are left out";
    EXPECT_EQ(scene.meshes[0].indices, (std::vector<uint32_t>{0, 1, 2}));
}

// Three positions given as integers.
template <typename T>
std::vector<Vec3f> quantised(int type, bool normalized, const std::vector<T>& values) {
    GltfBuilder b;
    const size_t padded = (3 * sizeof(T) + 3) / 4 * 4 / sizeof(T);
    std::vector<T> vertices;
    for (size_t i = 0; i < 3; ++i) {
        vertices.insert(vertices.end(), values.begin() + static_cast<ptrdiff_t>(3 * i),
                        values.begin() + static_cast<ptrdiff_t>(3 * i + 3));
        vertices.resize((i + 1) * padded);
    }
    const int view = b.add_view(vertices, static_cast<int>(padded * sizeof(T)));
    const int p = b.add_accessor(view, type, "VEC3", 3, 0, normalized);
    b.use_extension("KHR_mesh_quantization", true);
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}})}});
    const auto scene = b.load();
    EXPECT_TRUE(scene.ok());
    return scene.ok() && !scene->meshes.empty() ? scene->meshes[0].positions : std::vector<Vec3f>();
}

TEST(Quantisation, PlainIntegers) {
    EXPECT_EQ(quantised<int8_t>(kByte, false, {-128, 0, 1, 127, 2, 3, 0, 5, 0}),
              (std::vector<Vec3f>{Vec3f(-128, 0, 1), Vec3f(127, 2, 3), Vec3f(0, 5, 0)}));
    EXPECT_EQ(quantised<uint8_t>(kUnsignedByte, false, {255, 0, 1, 7, 2, 3, 0, 5, 0}),
              (std::vector<Vec3f>{Vec3f(255, 0, 1), Vec3f(7, 2, 3), Vec3f(0, 5, 0)}));
    EXPECT_EQ(quantised<int16_t>(kShort, false, {-32768, 0, 1, 32767, 2, 3, 0, 5, 0}),
              (std::vector<Vec3f>{Vec3f(-32768, 0, 1), Vec3f(32767, 2, 3), Vec3f(0, 5, 0)}));
    EXPECT_EQ(quantised<uint16_t>(kUnsignedShort, false, {65535, 0, 1, 7, 2, 3, 0, 5, 0}),
              (std::vector<Vec3f>{Vec3f(65535, 0, 1), Vec3f(7, 2, 3), Vec3f(0, 5, 0)}));
}

TEST(Quantisation, NormalisedIntegers) {
    EXPECT_EQ(quantised<int8_t>(kByte, true, {-128, -127, 127, 0, 0, 0, 0, 127, 0}),
              (std::vector<Vec3f>{Vec3f(-1, -1, 1), Vec3f(0), Vec3f(0, 1, 0)}))
        << "-128 and -127 are both -1";
    EXPECT_EQ(quantised<uint8_t>(kUnsignedByte, true, {255, 51, 0, 0, 0, 0, 0, 255, 0}),
              (std::vector<Vec3f>{Vec3f(1, 0.2f, 0), Vec3f(0), Vec3f(0, 1, 0)}));
    EXPECT_EQ(quantised<int16_t>(kShort, true, {-32768, -32767, 32767, 0, 0, 0, 0, 32767, 0}),
              (std::vector<Vec3f>{Vec3f(-1, -1, 1), Vec3f(0), Vec3f(0, 1, 0)}));
    EXPECT_EQ(quantised<uint16_t>(kUnsignedShort, true, {65535, 13107, 0, 0, 0, 0, 0, 65535, 0}),
              (std::vector<Vec3f>{Vec3f(1, 0.2f, 0), Vec3f(0), Vec3f(0, 1, 0)}));
}

TEST(Quantisation, NormalsAreMadeUnitAgain) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    const int view =
        b.add_view(std::vector<int8_t>{90, 0, 90, 0, 0, 90, 90, 0, 127, 0, 0, 0, 0, 0, 127, 0}, 4);
    attributes["NORMAL"] = b.add_accessor(view, kByte, "VEC3", 4, 0, true);
    b.add_node({{"mesh", b.add_mesh(attributes, b.quad_indices())}});
    TALBOT_LOADED(scene, b.load());
    const float h = std::sqrt(0.5f);
    EXPECT_NEAR(length(scene.meshes[0].normals[0] - Vec3f(h, 0, h)), 0, 1e-6);
    for (const Vec3f& n : scene.meshes[0].normals) EXPECT_NEAR(length(n), 1, 1e-6);
}

TEST(Attributes, VertexColoursAreLinearAndClamped) {
    const auto colors = [](int type, bool normalized, const char* kind, const auto& values) {
        GltfBuilder b;
        Json attributes = b.quad_attributes();
        const int view =
            b.add_view(values, kind[3] == '3' ? 4 * static_cast<int>(sizeof(values[0])) : 0);
        attributes["COLOR_0"] = b.add_accessor(view, type, kind, 4, 0, normalized);
        b.add_node({{"mesh", b.add_mesh(attributes, b.quad_indices())}});
        const auto scene = b.load();
        EXPECT_TRUE(scene.ok());
        return scene.ok() ? scene->meshes[0].colors : std::vector<Vec4f>();
    };
    const std::vector<float> rgb{0.25f, 2, -1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(colors(kFloat, false, "VEC3", rgb).at(0), Vec4f(0.25f, 1, 0, 1)) << "alpha is 1";
    const std::vector<float> rgba{0.25f, 2, -1, 0.5f, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(colors(kFloat, false, "VEC4", rgba).at(0), Vec4f(0.25f, 1, 0, 0.5f));
    const std::vector<uint8_t> bytes{51, 255, 0, 102, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(colors(kUnsignedByte, true, "VEC4", bytes).at(0), Vec4f(0.2f, 1, 0, 0.4f));
    const std::vector<uint16_t> shorts{13107, 65535, 0, 26214, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(colors(kUnsignedShort, true, "VEC4", shorts).at(0), Vec4f(0.2f, 1, 0, 0.4f));
}

TEST(Attributes, TwoSetsOfTextureCoordinates) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes["TEXCOORD_1"] =
        b.add_accessor(b.add_view(std::vector<uint16_t>{0, 65535, 13107, 0, 0, 0, 0, 0}),
                       kUnsignedShort, "VEC2", 4, 0, true);
    b.add_node({{"mesh", b.add_mesh(attributes, b.quad_indices())}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].uv[0][0], Vec2f(0, 1));
    EXPECT_EQ(scene.meshes[0].uv[1][0], Vec2f(0, 1));
    EXPECT_EQ(scene.meshes[0].uv[1][1], Vec2f(0.2f, 0));
}

TEST(Attributes, TangentsAreIgnoredWithoutNormals) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes.erase("NORMAL");
    attributes["TANGENT"] = b.add_floats({0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}, "VEC4");
    const int material = b.add_material({{"normalTexture", {{"index", b.add_texture()}}}});
    b.add_node({{"mesh", b.add_mesh(attributes, b.quad_indices(), 4, material)}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_TRUE(scene.meshes[0].normals.empty());
    EXPECT_TRUE(scene.meshes[0].tangents.empty());
}

TEST(Repair, TrianglesWithNonFiniteVerticesAreDropped) {
    GltfBuilder b;
    const float nan = std::nanf("");
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0, 0, INFINITY, 0}, "VEC3");
    b.add_node(
        {{"mesh", b.add_mesh({{"POSITION", p}}, b.add_indices({0, 1, 2, 0, 1, 3, 2, 1, 4}))}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].triangle_count(), 1u);
    EXPECT_EQ(scene.meshes[0].positions.size(), 3u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(
        has_warning(scene,
                    "meshes[0].primitives[0]: positions that are not finite or out of range "
                    "(-1e+15 to 1e+15 m): 2 triangles"));
}

// One vertex further out than any world must not take the mesh with it.
TEST(Repair, TrianglesWithVerticesOutOfRangeAreDropped) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 3e38f, 0, 0}, "VEC3");
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, b.add_indices({0, 1, 2, 0, 1, 3}))}});
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.meshes[0].triangle_count(), 1u);
    ASSERT_EQ(scene.warnings.size(), 1u);
}

TEST(Repair, AllTrianglesNonFiniteLeavesNothing) {
    GltfBuilder b;
    const float nan = std::nanf("");
    const int p = b.add_floats({0, 0, 0, 1, nan, 0, 0, 1, 0}, "VEC3");
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}})}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_TRUE(scene.meshes.empty());
    EXPECT_TRUE(scene.instances.empty());
}

TEST(Repair, NormalsThatAreNoDirectionsComeFromTheTriangles) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes["NORMAL"] =
        b.add_floats({0, 0, 0, std::nanf(""), 0, 0, 0, 1, 0, 0, 0, 1e-30f}, "VEC3");
    b.add_node({{"mesh", b.add_mesh(attributes, b.quad_indices())}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].normals,
              (std::vector<Vec3f>{Vec3f(0, 0, 1), Vec3f(0, 0, 1), Vec3f(0, 1, 0), Vec3f(0, 0, 1)}));
    EXPECT_TRUE(has_warning(scene, "2 normals are no directions"));
}

TEST(Repair, LeftOverIndicesAreNotDrawn) {
    GltfBuilder b;
    const int p = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}}, b.add_indices({0, 1, 2, 0, 1}))}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_EQ(scene.meshes[0].triangle_count(), 1u);
    EXPECT_TRUE(has_warning(scene, "not a multiple of three"));
}

TEST(Repair, PrimitiveWithoutPositionsIsNotDrawn) {
    GltfBuilder b;
    const int n = b.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    b.add_node({{"mesh", b.add_mesh({{"NORMAL", n}})}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_TRUE(scene.meshes.empty());
    EXPECT_TRUE(has_warning(scene, "meshes[0].primitives[0]: has no POSITION"));
}

}  // namespace
}  // namespace talbot
