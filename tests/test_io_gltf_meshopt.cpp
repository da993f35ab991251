// EXT_meshopt_compression: streams made by the library's encoder give back what went in, filters
// give what the extension's formulas say, and declared sizes are not believed.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <random>

#include "core/io/gltf/accessor.h"
#include "core/io/gltf/document.h"
#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

// Points view `view` of the builder at the stream, within a fallback buffer that has no bytes.
void compress_view(GltfBuilder& b, int view, const std::vector<uint8_t>& stream, const char* mode,
                   size_t stride, size_t count, const char* filter = nullptr) {
    const int packed = b.add_view(stream);
    Json extension = {{"buffer", 0},
                      {"byteOffset", b.root["bufferViews"][packed]["byteOffset"]},
                      {"byteLength", stream.size()},
                      {"byteStride", stride},
                      {"count", count},
                      {"mode", mode}};
    if (filter) extension["filter"] = filter;
    b.root["bufferViews"].erase(b.root["bufferViews"].size() - 1);
    Json& target = b.root["bufferViews"][view];
    target["buffer"] = 1;
    target["byteOffset"] = 0;
    target["byteLength"] = stride * count;
    target["extensions"]["EXT_meshopt_compression"] = extension;
}

Json& extension_of(GltfBuilder& b, int view) {
    return b.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
}

// The builder's own buffer, and the fallback buffer behind it.
Json with_fallback(const GltfBuilder& b) {
    Json root = b.embedded();
    root["buffers"].push_back(
        {{"byteLength", 1000000},
         {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    return root;
}

fs::path write(const GltfBuilder& b) {
    const std::string text = with_fallback(b).dump();
    write_bytes(b.folder() / "s.gltf", text.data(), text.size());
    return b.folder() / "s.gltf";
}

std::vector<uint8_t> encode_vertices(const void* data, size_t count, size_t stride) {
    std::vector<uint8_t> out(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), data, count, stride));
    return out;
}

std::vector<uint8_t> encode_triangles(const std::vector<uint32_t>& indices, size_t vertices) {
    std::vector<uint8_t> out(meshopt_encodeIndexBufferBound(indices.size(), vertices));
    out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
    return out;
}

std::vector<uint8_t> encode_sequence(const std::vector<uint32_t>& indices, size_t vertices) {
    std::vector<uint8_t> out(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
    out.resize(meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), indices.size()));
    return out;
}

struct Grid {
    std::vector<float> positions;
    std::vector<uint32_t> indices;
};

// A bumpy 20 x 20 grid: enough vertices for more than one block.
Grid make_grid() {
    Grid grid;
    std::mt19937 random(5);
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
            const float z = static_cast<float>(random() % 1000) / 1000;
            grid.positions.insert(grid.positions.end(),
                                  {static_cast<float>(x), static_cast<float>(y), z});
        }
    }
    for (uint32_t y = 0; y < 19; ++y) {
        for (uint32_t x = 0; x < 19; ++x) {
            const uint32_t a = y * 20 + x;
            for (const uint32_t i : {a, a + 1, a + 20, a + 20, a + 1, a + 21})
                grid.indices.push_back(i);
        }
    }
    return grid;
}

// The grid with both streams compressed; views 0 and 1.
void add_grid(GltfBuilder& b, const Grid& grid, bool sequence) {
    const size_t vertices = grid.positions.size() / 3;
    const int p = b.push("bufferViews", {{"buffer", 1}});
    const int i = b.push("bufferViews", {{"buffer", 1}});
    compress_view(b, p, encode_vertices(grid.positions.data(), vertices, 12), "ATTRIBUTES", 12,
                  vertices);
    compress_view(b, i,
                  sequence ? encode_sequence(grid.indices, vertices)
                           : encode_triangles(grid.indices, vertices),
                  sequence ? "INDICES" : "TRIANGLES", 4, grid.indices.size());
    const int pa = b.add_accessor(p, kFloat, "VEC3", vertices);
    const int ia = b.add_accessor(i, kUnsignedInt, "SCALAR", grid.indices.size());
    b.add_node({{"mesh", b.add_mesh({{"POSITION", pa}}, ia)}});
    b.use_extension("EXT_meshopt_compression", true);
}

// Corners of all triangles, each turned so that its least corner comes first (the codec may turn
// triangles).
std::vector<std::array<uint32_t, 3>> turned(const std::vector<uint32_t>& indices) {
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t i = 0; i < indices.size(); i += 3) {
        std::array<uint32_t, 3> t{indices[i], indices[i + 1], indices[i + 2]};
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        triangles.push_back(t);
    }
    return triangles;
}

TEST(Meshopt, LosslessModesGiveBackWhatWentIn) {
    const Grid grid = make_grid();
    for (const bool sequence : {false, true}) {
        GltfBuilder b;
        add_grid(b, grid, sequence);
        TALBOT_LOADED(scene, load_gltf(write(b)));
        ASSERT_EQ(scene.meshes.size(), 1u);
        const Mesh& mesh = scene.meshes[0];
        ASSERT_EQ(mesh.positions.size(), 400u);
        EXPECT_EQ(turned(mesh.indices), turned(grid.indices));
        EXPECT_EQ(std::memcmp(mesh.positions.data(), grid.positions.data(), 4800), 0);
        EXPECT_TRUE(scene.warnings.empty());
        EXPECT_TRUE(scene.extensions[0].supported);
    }
}

TEST(Meshopt, ShortIndices) {
    const Grid grid = make_grid();
    GltfBuilder b;
    add_grid(b, grid, false);
    extension_of(b, 1)["byteStride"] = 2;
    b.root["bufferViews"][1]["byteLength"] = grid.indices.size() * 2;
    b.root["accessors"][1]["componentType"] = kUnsignedShort;
    TALBOT_LOADED(scene, load_gltf(write(b)));
    EXPECT_EQ(turned(scene.meshes[0].indices), turned(grid.indices));
}

// The floats of accessor 0 over one filtered view.
template <typename T>
std::vector<float> decode_filtered(const std::vector<T>& raw, size_t stride, const char* filter,
                                   int component_type, const char* type) {
    GltfBuilder b;
    const size_t count = raw.size() * sizeof(T) / stride;
    const int view = b.push("bufferViews", {{"buffer", 1}, {"byteStride", stride}});
    compress_view(b, view, encode_vertices(raw.data(), count, stride), "ATTRIBUTES", stride, count,
                  filter);
    b.add_accessor(view, component_type, type, count, 0, component_type != kFloat);
    b.add_node(Json::object());
    const auto document = gltf::read_document(write(b), 1 << 20);
    EXPECT_TRUE(document.ok()) << document.error().line();
    const auto accessor = gltf::open_accessor(*document, 0);
    EXPECT_TRUE(accessor.ok()) << accessor.error().line();
    std::vector<float> out(count * accessor->components);
    gltf::read_floats(*accessor, 0, count, accessor->components, out.data());
    return out;
}

// The extension's text: x and y over one, z = 1 - |x| - |y|, folded over below, normalised.
TEST(MeshoptFilters, Octahedral) {
    std::mt19937 random(11);
    std::vector<int8_t> bytes;
    std::vector<int16_t> shorts;
    for (int i = 0; i < 37; ++i) {
        const auto at = [&](int one) { return static_cast<int>(random() % (2u * one + 1)) - one; };
        for (const int v : {at(127), at(127), 127, at(127)})
            bytes.push_back(static_cast<int8_t>(v));
        for (const int v : {at(2047), at(2047), 2047, at(2047)})
            shorts.push_back(static_cast<int16_t>(v));
    }
    const auto expect_unfolded = [](const auto& raw, const std::vector<float>& out, double step) {
        for (size_t i = 0; i < raw.size(); i += 4) {
            double x = static_cast<double>(raw[i]) / raw[i + 2];
            double y = static_cast<double>(raw[i + 1]) / raw[i + 2];
            const double z = 1 - std::abs(x) - std::abs(y);
            const double t = std::max(-z, 0.0);
            x += x >= 0 ? -t : t;
            y += y >= 0 ? -t : t;
            const double size = std::sqrt(x * x + y * y + z * z);
            EXPECT_NEAR(out[i], x / size, step) << i;
            EXPECT_NEAR(out[i + 1], y / size, step) << i;
            EXPECT_NEAR(out[i + 2], z / size, step) << i;
        }
    };
    expect_unfolded(bytes, decode_filtered(bytes, 4, "OCTAHEDRAL", kByte, "VEC4"), 0.51 / 127);
    expect_unfolded(shorts, decode_filtered(shorts, 8, "OCTAHEDRAL", kShort, "VEC4"), 0.51 / 32767);
}

// Three components over sqrt(2); the low two bits of the fourth name the largest, which is made
// positive.
TEST(MeshoptFilters, Quaternion) {
    std::mt19937 random(12);
    std::vector<int16_t> raw;
    const int one = 1023;
    for (int i = 0; i < 37; ++i) {
        for (int k = 0; k < 3; ++k)
            raw.push_back(static_cast<int16_t>(static_cast<int>(random() % 1400) - 700));
        raw.push_back(static_cast<int16_t>((one & ~3) | (i & 3)));
    }
    const std::vector<float> out = decode_filtered(raw, 8, "QUATERNION", kShort, "VEC4");
    for (size_t i = 0; i < raw.size(); i += 4) {
        const double scale = 1 / (static_cast<double>(raw[i + 3] | 3) * std::sqrt(2.0));
        const double x = raw[i] * scale, y = raw[i + 1] * scale, z = raw[i + 2] * scale;
        const double w = std::sqrt(std::max(0.0, 1 - x * x - y * y - z * z));
        const size_t largest = static_cast<size_t>(raw[i + 3] & 3);
        EXPECT_NEAR(out[i + (largest + 1) % 4], x, 0.51 / 32767);
        EXPECT_NEAR(out[i + (largest + 2) % 4], y, 0.51 / 32767);
        EXPECT_NEAR(out[i + (largest + 3) % 4], z, 0.51 / 32767);
        EXPECT_NEAR(out[i + largest], w, 0.51 / 32767);
    }
}

// Eight bits of exponent over 24 of mantissa, both signed.
TEST(MeshoptFilters, Exponential) {
    std::mt19937 random(13);
    std::vector<uint32_t> raw;
    std::vector<double> expected;
    for (int i = 0; i < 60; ++i) {
        const int exponent = static_cast<int>(random() % 60) - 40;
        const int mantissa = static_cast<int>(random() % (1u << 24)) - (1 << 23);
        raw.push_back(static_cast<uint32_t>(exponent) << 24 |
                      (static_cast<uint32_t>(mantissa) & 0xFFFFFFu));
        expected.push_back(std::ldexp(mantissa, exponent));
    }
    const std::vector<float> out = decode_filtered(raw, 12, "EXPONENTIAL", kFloat, "VEC3");
    for (size_t i = 0; i < raw.size(); ++i) EXPECT_EQ(out[i], static_cast<float>(expected[i])) << i;
}

struct Lie {
    const char* name;
    void (*tell)(GltfBuilder&);
    const char* element;
    const char* part;
};

constexpr const char* kFirst = "bufferViews[0].extensions.EXT_meshopt_compression";
constexpr const char* kSecond = "bufferViews[1].extensions.EXT_meshopt_compression";

const Lie kLies[] = {
    {"count",
     [](GltfBuilder& b) {
         extension_of(b, 0)["count"] = 900000000;
         b.root["bufferViews"][0]["byteLength"] = 10800000000;
     },
     kFirst, "compressed bytes can hold"},
    {"more_vertices", [](GltfBuilder& b) { extension_of(b, 0)["count"] = 800; }, kFirst,
     "stream is broken"},
    {"more_triangles", [](GltfBuilder& b) { extension_of(b, 1)["count"] = 3000; }, kSecond,
     "compressed"},
    {"huge_count", [](GltfBuilder& b) { extension_of(b, 0)["count"] = 9007199254740991; }, kFirst,
     "out of range"},
    {"negative_count", [](GltfBuilder& b) { extension_of(b, 0)["count"] = -1; }, kFirst,
     "non-negative"},
    {"no_length", [](GltfBuilder& b) { extension_of(b, 0).erase("byteLength"); }, kFirst,
     "non-negative"},
    {"length", [](GltfBuilder& b) { extension_of(b, 0)["byteLength"] = 100000; }, kFirst,
     "of a buffer of"},
    {"cut", [](GltfBuilder& b) { extension_of(b, 0)["byteLength"] = 200; }, kFirst, "compressed"},
    {"buffer", [](GltfBuilder& b) { extension_of(b, 0)["buffer"] = 2; }, kFirst, "out of range"},
    {"from_fallback", [](GltfBuilder& b) { extension_of(b, 0)["buffer"] = 1; }, "buffers[1]",
     "no uri"},
    {"mode", [](GltfBuilder& b) { extension_of(b, 0)["mode"] = "POINTS"; }, kFirst,
     "mode 'POINTS' is unknown"},
    {"filter", [](GltfBuilder& b) { extension_of(b, 0)["filter"] = "COLOR"; }, kFirst,
     "filter 'COLOR' is unknown"},
    {"filter_stride", [](GltfBuilder& b) { extension_of(b, 0)["filter"] = "OCTAHEDRAL"; }, kFirst,
     "must be 4 or 8"},
    {"filter_of_indices", [](GltfBuilder& b) { extension_of(b, 1)["filter"] = "EXPONENTIAL"; },
     kSecond, "only ATTRIBUTES"},
    {"stride", [](GltfBuilder& b) { extension_of(b, 0)["byteStride"] = 10; }, kFirst,
     "multiple of 4"},
    {"two_strides", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 16; }, kFirst,
     "16 in the buffer view"},
    {"view_length", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteLength"] = 4801; }, kFirst,
     "declares 4801 bytes, the stream 4800"},
    {"plain_view_in_fallback",
     [](GltfBuilder& b) {
         b.push("bufferViews", {{"buffer", 1}, {"byteLength", 4}});
     },
     "buffers[1]", "no uri"},
};

class Lies : public testing::TestWithParam<Lie> {};

TEST_P(Lies, AreRefusedByName) {
    GltfBuilder b;
    add_grid(b, make_grid(), false);
    ASSERT_TRUE(load_gltf(write(b)).ok());
    GetParam().tell(b);
    const auto scene = load_gltf(write(b));
    ASSERT_FALSE(scene.ok());
    EXPECT_EQ(scene.error().element, GetParam().element) << scene.error().line();
    EXPECT_NE(scene.error().what.find(GetParam().part), std::string::npos) << scene.error().line();
}

INSTANTIATE_TEST_SUITE_P(All, Lies, testing::ValuesIn(kLies),
                         [](const auto& lie) { return std::string(lie.param.name); });

TEST(Meshopt, CountsAgainstTheMemory) {
    GltfBuilder b;
    const std::vector<float> zeros(3 * 100000, 0.0f);
    const int view = b.push("bufferViews", {{"buffer", 1}});
    compress_view(b, view, encode_vertices(zeros.data(), 100000, 12), "ATTRIBUTES", 12, 100000);
    b.add_accessor(view, kFloat, "VEC3", 100000);
    b.add_node(Json::object());
    LoadOptions options;
    options.max_bytes = 1 << 20;
    const auto scene = load_gltf(write(b), options);
    ASSERT_FALSE(scene.ok());
    EXPECT_NE(scene.error().what.find("MiB when decoded"), std::string::npos);
    options.max_bytes = 4 << 20;
    EXPECT_TRUE(load_gltf(write(b), options).ok());
}

TEST(Meshopt, DamagedStreamsNeverCrash) {
    const Grid grid = make_grid();
    GltfBuilder b;
    add_grid(b, grid, false);
    std::mt19937 random(20240601);
    int passed = 0, refused = 0;
    for (int round = 0; round < 400; ++round) {
        GltfBuilder damaged;
        damaged.root = b.root;
        damaged.bin = b.bin;
        for (int k = 0; k < 3; ++k)
            damaged.bin[random() % damaged.bin.size()] = static_cast<uint8_t>(random());
        const auto scene = load_gltf(write(damaged));
        ++(scene.ok() ? passed : refused);
        for (size_t m = 0; scene.ok() && m < scene->meshes.size(); ++m) {
            for (const uint32_t i : scene->meshes[m].indices)
                ASSERT_LT(i, scene->meshes[m].positions.size());
        }
    }
    EXPECT_GT(passed, 20);
    EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace talbot
