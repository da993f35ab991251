// Tangents made at loading, against closed forms and against the tangents that came with a model of
// another author.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "io_gltf_builder.h"
#include "tests/shared_scenes.h"

namespace talbot {
namespace {

using namespace test;

// A mesh with a normal map, so that tangents are wanted.
Result<SceneDesc> load_mapped(GltfBuilder& b, const Json& attributes, int indices, int uv_set = 0) {
    const Json map = {{"index", b.add_texture()}, {"texCoord", uv_set}};
    const int material = b.add_material({{"normalTexture", map}});
    b.add_node({{"mesh", b.add_mesh(attributes, indices, 4, material)}});
    return b.load();
}

TEST(Tangents, NoneWithoutANormalMap) {
    GltfBuilder b;
    const Json attributes = b.quad_attributes();
    b.add_node({{"mesh", b.add_mesh(attributes, b.quad_indices())}});
    TALBOT_LOADED(scene, b.load());
    EXPECT_TRUE(scene.meshes[0].tangents.empty());
}

TEST(Tangents, SuppliedOnesAreKept) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes["TANGENT"] =
        b.add_floats({0, 2, 0, -1, 0, 2, 0, -1, 0, 2, 0, -1, 0, 2, 0, -1}, "VEC4");
    const int i = b.quad_indices();
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    EXPECT_EQ(scene.meshes[0].tangents, (std::vector<Vec4f>(4, Vec4f(0, 1, 0, -1))));
}

TEST(Tangents, UprightImage) {
    // U runs along +X; the bitangent points up the image, which is +Y: w = +1.
    GltfBuilder b;
    const Json attributes = b.quad_attributes();
    const int i = b.quad_indices();
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    EXPECT_EQ(scene.meshes[0].tangents, (std::vector<Vec4f>(4, Vec4f(1, 0, 0, 1))));
}

TEST(Tangents, MirroredImage) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes["TEXCOORD_0"] = b.add_floats({1, 1, 0, 1, 0, 0, 1, 0}, "VEC2");
    const int i = b.quad_indices();
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    EXPECT_EQ(scene.meshes[0].tangents, (std::vector<Vec4f>(4, Vec4f(-1, 0, 0, -1))));
}

TEST(Tangents, RotatedImage) {
    // The image lies on its side: U runs along +Y, up the image is -X.
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes["TEXCOORD_0"] = b.add_floats({0, 0, 0, 1, 1, 1, 1, 0}, "VEC2");
    const int i = b.quad_indices();
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    EXPECT_EQ(scene.meshes[0].tangents, (std::vector<Vec4f>(4, Vec4f(0, 1, 0, 1))));
}

TEST(Tangents, SecondSet) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes["TEXCOORD_1"] = b.add_floats({0, 0, 0, 1, 1, 1, 1, 0}, "VEC2");
    const int i = b.quad_indices();
    TALBOT_LOADED(scene, load_mapped(b, attributes, i, 1));
    EXPECT_EQ(scene.meshes[0].tangents.at(0), Vec4f(0, 1, 0, 1));
}

TEST(Tangents, SeamOfMirroredChartsIsSplit) {
    // Two triangles share the edge x = 0 and mirror their texture about it.
    GltfBuilder b;
    Json attributes;
    attributes["POSITION"] = b.add_floats({0, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0, 0}, "VEC3");
    attributes["NORMAL"] = b.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    attributes["TEXCOORD_0"] = b.add_floats({0, 1, 0, 0, 1, 1, 1, 1}, "VEC2");
    const int i = b.add_indices({0, 1, 2, 0, 3, 1});
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 6u) << "both vertices of the seam are doubled";
    ASSERT_EQ(mesh.tangents.size(), 6u);
    ASSERT_EQ(mesh.normals.size(), 6u);
    ASSERT_EQ(mesh.uv[0].size(), 6u);
    for (size_t k = 0; k < 6; ++k) {
        const Vec4f t = mesh.tangents[mesh.indices[k]];
        EXPECT_EQ(t, k < 3 ? Vec4f(-1, 0, 0, -1) : Vec4f(1, 0, 0, 1)) << k;
    }
    const std::vector<Vec3f> corners{Vec3f(0), Vec3f(0, 1, 0), Vec3f(-1, 0, 0),
                                     Vec3f(0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)};
    for (size_t k = 0; k < 6; ++k) EXPECT_EQ(mesh.positions[mesh.indices[k]], corners[k]) << k;
}

TEST(Tangents, WeightedByTheAngleOfTheCorner) {
    // At the origin a right angle whose tangent is +X meets an angle of 45 degrees whose tangent is
    // turned by 30 degrees.
    const double turn = std::numbers::pi / 6;
    const double c = std::cos(turn), s = std::sin(turn);
    // Second triangle: (0,0), (0,1), (-1,1); texture coordinates chosen so that dP/du = (c, s): u =
    // p . (c, s), v free.
    GltfBuilder b;
    const auto u2 = [&](double x, double y) { return static_cast<float>(x * c + y * s); };
    const auto v2 = [&](double x, double y) { return static_cast<float>(-(-x * s + y * c)); };
    Json attributes;
    attributes["POSITION"] = b.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 1, 0}, "VEC3");
    attributes["NORMAL"] = b.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    // On the first triangle u = x + s y and v = -c y, so that dP/du is +X there.
    attributes["TEXCOORD_0"] =
        b.add_floats({0, 0, 1, 0, u2(0, 1), v2(0, 1), u2(-1, 1), v2(-1, 1)}, "VEC2");
    const int i = b.add_indices({0, 1, 2, 0, 2, 3});
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 4u);
    // At the origin: angles 90 and 45 degrees.
    const double a1 = std::numbers::pi / 2, a2 = std::numbers::pi / 4;
    const Vec3d expected = normalize(Vec3d(a1 + a2 * c, a2 * s, 0));
    EXPECT_NEAR(length(Vec3d(Vec3f(mesh.tangents[0])) - expected), 0, 1e-6);
    // At (0, 1): 45 and 90 degrees.
    const Vec3d other = normalize(Vec3d(a2 + a1 * c, a1 * s, 0));
    EXPECT_NEAR(length(Vec3d(Vec3f(mesh.tangents[2])) - other), 0, 1e-6);
    // A plain mean would differ: the control of this test.
    EXPECT_GT(length(normalize(Vec3d(1 + c, s, 0)) - expected), 0.01);
}

TEST(Tangents, LieInThePlaneOfTheNormal) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    const float h = std::sqrt(0.5f);
    attributes["NORMAL"] = b.add_floats({h, 0, h, h, 0, h, h, 0, h, h, 0, h}, "VEC3");
    const int i = b.quad_indices();
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    for (const Vec4f& t : scene.meshes[0].tangents)
        EXPECT_NEAR(length(Vec3f(t) - Vec3f(h, 0, -h)), 0, 1e-6);
}

TEST(Tangents, DegenerateTextureCoordinatesStillGiveAFrame) {
    GltfBuilder b;
    Json attributes = b.quad_attributes();
    attributes["TEXCOORD_0"] = b.add_floats({0, 0, 0, 0, 0, 0, 0, 0}, "VEC2");
    const int i = b.quad_indices();
    TALBOT_LOADED(scene, load_mapped(b, attributes, i));
    for (const Vec4f& t : scene.meshes[0].tangents) {
        EXPECT_NEAR(length(Vec3f(t)), 1, 1e-6);
        EXPECT_NEAR(t.z, 0, 1e-6);
        EXPECT_EQ(std::abs(t.w), 1);
    }
}

// The tangents of a model by another author's tool are the oracle: the same file without them must
// come out alike.
TEST(Tangents, AgreeWithASharedModel) {
    const fs::path folder = shared_folder() / "models";
    const fs::path file = folder / "NormalTangentMirrorTest/NormalTangentMirrorTest.glb";
    if (!fs::exists(file))
        GTEST_SKIP() << "no shared models in " << folder << "; set TALBOT_SHARED_DIR";
    TALBOT_LOADED(supplied, load_gltf(file));
    std::vector<uint8_t> bytes = read_bytes(file);
    // The attribute is renamed in place, which hides it.
    const std::string text(bytes.begin(), bytes.end());
    const size_t at = text.find("\"TANGENT\"");
    ASSERT_NE(at, std::string::npos);
    bytes[at + 1] = '_';
    TemporaryFolder temporary;
    write_bytes(temporary / "bare.glb", bytes);
    TALBOT_LOADED(made, load_gltf(temporary / "bare.glb"));
    const Mesh& a = supplied.meshes.at(0);
    const Mesh& b = made.meshes.at(0);
    ASSERT_EQ(a.indices.size(), b.indices.size());
    size_t alike = 0;
    size_t same_sign = 0;
    for (size_t i = 0; i < a.indices.size(); ++i) {
        const Vec4f ta = a.tangents[a.indices[i]];
        const Vec4f tb = b.tangents[b.indices[i]];
        same_sign += ta.w == tb.w;
        alike += dot(Vec3f(ta), Vec3f(tb)) > 0.999f;
    }
    EXPECT_EQ(same_sign, a.indices.size());
    EXPECT_GT(static_cast<double>(alike) / static_cast<double>(a.indices.size()), 0.99);
}

}  // namespace
}  // namespace talbot
