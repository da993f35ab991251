// KHR_draco_mesh_compression: streams made by Draco's encoder (lossless settings) give back what
// went in, and what a stream or its file declares is not believed.
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

#include "core/math/robust.h"
#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

constexpr uint32_t kSide = 12;

// A bumpy grid with normals, texture coordinates and byte colours.
struct Grid {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;
    std::vector<Vec2f> uvs;
    std::vector<std::array<uint8_t, 4>> colors;
    std::vector<std::array<uint32_t, 3>> triangles;
};

Grid make_grid() {
    Grid grid;
    std::mt19937 random(9);
    const auto any = [&] { return static_cast<float>(random() % 1024) / 1024; };
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            grid.positions.push_back(Vec3f(static_cast<float>(x), static_cast<float>(y), any()));
            grid.normals.push_back(normalize(Vec3f(any() - 0.5f, any() - 0.5f, 1)));
            grid.uvs.push_back(Vec2f(any(), any()));
            const auto byte = [&] { return static_cast<uint8_t>(random()); };
            grid.colors.push_back({byte(), byte(), byte(), byte()});
        }
    }
    for (uint32_t y = 0; y + 1 < kSide; ++y) {
        for (uint32_t x = 0; x + 1 < kSide; ++x) {
            const uint32_t a = y * kSide + x;
            grid.triangles.push_back({a, a + 1, a + kSide});
            grid.triangles.push_back({a + kSide, a + 1, a + kSide + 1});
        }
    }
    return grid;
}

template <typename T>
uint32_t add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type kind, draco::DataType type,
                       int8_t width, bool normalized, const std::vector<T>& values) {
    draco::GeometryAttribute attribute;
    attribute.Init(kind, nullptr, width, type, normalized, sizeof(T), 0);
    const int id = mesh.AddAttribute(
        attribute, true, static_cast<draco::AttributeValueIndex::ValueType>(values.size()));
    for (uint32_t i = 0; i < values.size(); ++i) {
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &values[i]);
    }
    return mesh.attribute(id)->unique_id();
}

std::vector<uint8_t> encode(const Grid& grid, int method) {
    draco::Mesh mesh;
    mesh.set_num_points(static_cast<uint32_t>(grid.positions.size()));
    using Kind = draco::GeometryAttribute;
    add_attribute(mesh, Kind::POSITION, draco::DT_FLOAT32, 3, false, grid.positions);
    add_attribute(mesh, Kind::NORMAL, draco::DT_FLOAT32, 3, false, grid.normals);
    add_attribute(mesh, Kind::TEX_COORD, draco::DT_FLOAT32, 2, false, grid.uvs);
    add_attribute(mesh, Kind::COLOR, draco::DT_UINT8, 4, true, grid.colors);
    for (const auto& t : grid.triangles) {
        draco::Mesh::Face face;
        for (size_t k = 0; k < 3; ++k) face[k] = draco::PointIndex(t[k]);
        mesh.AddFace(face);
    }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetSpeedOptions(5, 5);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
    return {buffer.data(), buffer.data() + buffer.size()};
}

// Primitive 0 of mesh 0 with its stream in view 0.
void add_draco(GltfBuilder& b, const std::vector<uint8_t>& stream) {
    const int view = b.add_view(stream);
    const size_t vertices = kSide * kSide;
    const int p = b.add_accessor(-1, kFloat, "VEC3", vertices);
    const int n = b.add_accessor(-1, kFloat, "VEC3", vertices);
    const int t = b.add_accessor(-1, kFloat, "VEC2", vertices);
    const int c = b.add_accessor(-1, kUnsignedByte, "VEC4", vertices, 0, true);
    const int i = b.add_accessor(-1, kUnsignedShort, "SCALAR", (kSide - 1) * (kSide - 1) * 6);
    b.add_node(
        {{"mesh",
          b.add_mesh({{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", t}, {"COLOR_0", c}}, i)}});
    b.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", view},
        {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}, {"COLOR_0", 3}}}};
    b.use_extension("KHR_draco_mesh_compression", true);
}

Json& extension_of(GltfBuilder& b) {
    return b.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
}

// A corner by value, for the codec reorders vertices and triangles. Bit patterns of all attributes.
using Corner = std::vector<float>;
Corner corner(const Vec3f& p, const Vec3f& n, const Vec2f& t, const Vec4f& c) {
    return {p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y, c.x, c.y, c.z, c.w};
}

std::multiset<std::array<Corner, 3>> turned(std::vector<std::array<Corner, 3>> triangles) {
    for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return {triangles.begin(), triangles.end()};
}

TEST(Draco, BothMethodsGiveBackWhatWentIn) {
    const Grid grid = make_grid();
    std::vector<std::array<Corner, 3>> expected;
    for (const auto& t : grid.triangles) {
        std::array<Corner, 3> triangle;
        for (size_t k = 0; k < 3; ++k) {
            Vec4f color;
            for (int c = 0; c < 4; ++c)
                color[c] = static_cast<float>(grid.colors[t[k]][static_cast<size_t>(c)]) / 255.0f;
            // Normals are brought to unit length by the loader.
            triangle[k] = corner(grid.positions[t[k]], safe_normalize(grid.normals[t[k]], Vec3f(0)),
                                 grid.uvs[t[k]], color);
        }
        expected.push_back(triangle);
    }
    for (const int method : {0, 1}) {
        GltfBuilder b;
        add_draco(b, encode(grid, method));
        TALBOT_LOADED(scene, b.load());
        ASSERT_EQ(scene.meshes.size(), 1u);
        const Mesh& mesh = scene.meshes[0];
        std::vector<std::array<Corner, 3>> decoded;
        for (size_t i = 0; i < mesh.indices.size(); i += 3) {
            std::array<Corner, 3> triangle;
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = mesh.indices[i + k];
                triangle[k] =
                    corner(mesh.positions[v], mesh.normals[v], mesh.uv[0][v], mesh.colors[v]);
            }
            decoded.push_back(triangle);
        }
        EXPECT_EQ(turned(decoded), turned(expected)) << "method " << method;
        EXPECT_TRUE(scene.warnings.empty());
    }
}

struct Lie {
    const char* name;
    void (*tell)(GltfBuilder&);
    const char* part;
};

const Lie kLies[] = {
    {"fewer_triangles", [](GltfBuilder& b) { b.root["accessors"][4]["count"] = 9; },
     "has 242 triangles, its accessor of indices 3"},
    {"more_vertices", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 1000000000; },
     "has 144 vertices, its accessor of POSITION 1000000000"},
    {"view", [](GltfBuilder& b) { extension_of(b)["bufferView"] = 5; }, "out of range"},
    {"no_view", [](GltfBuilder& b) { extension_of(b).erase("bufferView"); }, "missing"},
    {"no_attributes", [](GltfBuilder& b) { extension_of(b).erase("attributes"); },
     "lacks attributes"},
    {"unknown_id", [](GltfBuilder& b) { extension_of(b)["attributes"]["NORMAL"] = 77; },
     "NORMAL is not in the Draco stream"},
    {"stranger", [](GltfBuilder& b) { extension_of(b)["attributes"]["_X"] = 1; },
     "_X is not one of the primitive's"},
    {"wrong_width", [](GltfBuilder& b) { extension_of(b)["attributes"]["NORMAL"] = 2; },
     "has 2 components in the Draco stream, 3 in its accessor"},
    {"mode", [](GltfBuilder& b) { b.root["meshes"][0]["primitives"][0]["mode"] = 6; }, "mode"},
    {"cut", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteLength"] = 300; }, "broken"},
    {"no_stream", [](GltfBuilder& b) { b.bin[0] = 'X'; }, "no Draco stream"},
    {"version", [](GltfBuilder& b) { b.bin[5] = 1; }, "version 1.2"},
    {"points_only", [](GltfBuilder& b) { b.bin[7] = 0; }, "not of triangles"},
    {"declared_triangles",
     [](GltfBuilder& b) {
         // The varint of the triangles' count, 242, made 2^31: in the sequential layout it follows
         // the header of 11 bytes.
         const std::array<uint8_t, 5> huge{0x88, 0x80, 0x80, 0x80, 0x00};
         std::copy(huge.begin(), huge.end(), b.bin.begin() + 11);
         b.root["accessors"][4]["count"] = 6442450944;
     },
     "triangles"},
};

class Lies : public testing::TestWithParam<Lie> {};

TEST_P(Lies, AreRefusedByName) {
    GltfBuilder b;
    add_draco(b, encode(make_grid(), 0));
    ASSERT_TRUE(b.load().ok());
    GetParam().tell(b);
    const auto scene = b.load();
    ASSERT_FALSE(scene.ok());
    EXPECT_EQ(scene.error().element,
              "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression")
        << scene.error().line();
    EXPECT_NE(scene.error().what.find(GetParam().part), std::string::npos) << scene.error().line();
}

INSTANTIATE_TEST_SUITE_P(All, Lies, testing::ValuesIn(kLies),
                         [](const auto& lie) { return std::string(lie.param.name); });

TEST(Draco, CountsAgainstTheMemory) {
    GltfBuilder b;
    add_draco(b, encode(make_grid(), 1));
    LoadOptions options;
    options.max_bytes = 40000;
    const auto scene = b.load(options);
    ASSERT_FALSE(scene.ok());
    EXPECT_NE(scene.error().what.find("MiB when decoded"), std::string::npos)
        << scene.error().line();
}

TEST(Draco, DamagedStreamsNeverCrash) {
    std::mt19937 random(20240602);
    int passed = 0, refused = 0;
    for (const int method : {0, 1}) {
        GltfBuilder whole;
        add_draco(whole, encode(make_grid(), method));
        for (int round = 0; round < 150; ++round) {
            GltfBuilder b;
            b.root = whole.root;
            b.bin = whole.bin;
            for (int k = 0; k < 2; ++k)
                b.bin[random() % b.bin.size()] = static_cast<uint8_t>(random());
            LoadOptions options;
            options.max_bytes = 64 << 20;
            const auto scene = b.load(options);
            ++(scene.ok() ? passed : refused);
            for (size_t m = 0; scene.ok() && m < scene->meshes.size(); ++m) {
                for (const uint32_t i : scene->meshes[m].indices)
                    ASSERT_LT(i, scene->meshes[m].positions.size());
            }
        }
    }
    EXPECT_GT(passed, 20);
    EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace talbot
