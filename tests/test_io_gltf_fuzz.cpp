// Random damage to small files, from fixed seeds: loading gives a scene or one error, and what
// passes is sound. Worth most in a sanitizer build.
#include <gtest/gtest.h>

#include <random>

#include "core/math/robust.h"
#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

// A small file with something of everything.
GltfBuilder& rich_scene(GltfBuilder& b) {
    Json attributes = b.quad_attributes();
    attributes["COLOR_0"] = b.add_floats({1, 1, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1}, "VEC3");
    attributes["TEXCOORD_1"] = b.add_floats({0, 0, 0, 1, 1, 1, 1, 0}, "VEC2");
    const int i = b.quad_indices();
    const int t =
        b.add_texture(Image8{2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}, ""},
                      {{"wrapS", 33071}});
    const Json slot = {
        {"index", t},
        {"extensions", {{"KHR_texture_transform", {{"rotation", 1.0}, {"texCoord", 1}}}}}};
    b.add_material({{"pbrMetallicRoughness", {{"baseColorTexture", slot}}},
                    {"normalTexture", {{"index", t}}},
                    {"alphaMode", "MASK"},
                    {"extensions",
                     {{"KHR_materials_volume", {{"attenuationDistance", 2}}},
                      {"KHR_materials_ior", {{"ior", 1.4}}}}}});
    b.add_mesh(attributes, i, 4, 0);
    const int sparse_index = b.add_view(std::vector<uint8_t>{1, 2});
    const int sparse_value = b.add_view(std::vector<float>{1, 0, 0, 0, 1, 0});
    const int p = b.add_accessor(-1, kFloat, "VEC3", 4);
    b.root["accessors"][p]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", sparse_index}, {"componentType", 5121}}},
        {"values", {{"bufferView", sparse_value}}}};
    b.add_mesh({{"POSITION", p}}, -1, 5);
    b.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    b.root["extensions"] = {
        {"KHR_lights_punctual", {{"lights", {{{"type", "spot"}, {"spot", Json::object()}}}}}},
        {"KHR_implicit_shapes", {{"shapes", {{{"type", "sphere"}, {"sphere", {{"radius", 1}}}}}}}}};
    const int translations = b.add_floats({0, 0, 0, 1, 1, 1}, "VEC3");
    b.root["scenes"][0] = {{"nodes", {0}}, {"extras", {{"environment", {{"color", {1, 1, 1}}}}}}};
    b.add_node({{"children", {1, 2, 3}}, {"scale", {1, 2, 1}}});
    b.add_node(
        {{"mesh", 0},
         {"extensions",
          {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translations}}}}}}}});
    b.add_node(
        {{"mesh", 1}, {"camera", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}}});
    b.add_node({{"extensions",
                 {{"KHR_lights_punctual", {{"light", 0}}},
                  {"TALBOT_implicit_surface", {{"shape", 0}, {"material", 0}}}}}});
    return b;
}

void expect_sound(const SceneDesc& scene) {
    for (const Mesh& mesh : scene.meshes) {
        for (const uint32_t index : mesh.indices) ASSERT_LT(index, mesh.positions.size());
        ASSERT_LT(mesh.material, scene.materials.size());
        for (const Vec3f& p : mesh.positions) ASSERT_TRUE(is_finite(p));
        for (const Vec3f& n : mesh.normals) ASSERT_TRUE(is_finite(n));
        for (const Vec4f& t : mesh.tangents) ASSERT_TRUE(is_finite(t));
        for (const auto& uv : mesh.uv) {
            for (const Vec2f& t : uv) ASSERT_TRUE(is_finite(t));
        }
    }
    for (const MeshInstance& instance : scene.instances) {
        ASSERT_LT(instance.mesh, scene.meshes.size());
        ASSERT_NE(glm::determinant(Mat3d(instance.world_from_object)), 0);
    }
    for (const Sphere& s : scene.spheres)
        ASSERT_TRUE(s.radius > 0 && is_finite(s.radius) && is_finite(s.center));
    for (const Camera& c : scene.cameras)
        ASSERT_TRUE(is_finite(c.position) && is_finite(c.right) && c.yfov > 0);
    for (const PunctualLight& l : scene.lights) ASSERT_LT(l.inner_cone_angle, l.outer_cone_angle);
}

// Counts what passes, so that a fuzz that never gets past the door shows.
struct Tally {
    int passed = 0;
    int refused = 0;
};

void load_one(const fs::path& file, const std::vector<uint8_t>& bytes, Tally& tally) {
    write_bytes(file, bytes);
    LoadOptions options;
    options.threads = 1;
    options.max_bytes = 64 << 20;
    const auto scene = load_gltf(file, options);
    if (scene.ok()) {
        ++tally.passed;
        expect_sound(*scene);
    } else {
        ++tally.refused;
        ASSERT_EQ(scene.error().line().find('\n'), std::string::npos);
    }
}

uint32_t pick(std::mt19937& random, size_t below) {
    return static_cast<uint32_t>(random() % below);
}

TEST(Fuzz, UndamagedFileLoadsInFull) {
    GltfBuilder b;
    TALBOT_LOADED(scene, rich_scene(b).load());
    EXPECT_EQ(scene.instances.size(), 4u) << "two instances, the strip and the ellipsoid";
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.textures.size(), 1u);
}

TEST(Fuzz, BytesOfAGlb) {
    GltfBuilder b;
    const std::vector<uint8_t> whole = rich_scene(b).glb();
    const fs::path file = b.folder() / "fuzz.glb";
    std::mt19937 random(20240501);
    Tally tally;
    for (int round = 0; round < 1000; ++round) {
        std::vector<uint8_t> bytes = whole;
        const uint32_t flips = 1 + pick(random, 4);
        for (uint32_t k = 0; k < flips; ++k)
            bytes[pick(random, bytes.size())] = static_cast<uint8_t>(random());
        if (round % 5 == 0) bytes.resize(pick(random, bytes.size()));
        load_one(file, bytes, tally);
        if (HasFatalFailure()) FAIL() << "round " << round;
    }
    EXPECT_GT(tally.passed, 10);
    EXPECT_GT(tally.refused, 100);
}

// Numbers, names and brackets of the JSON replaced by others, so that the text mostly stays JSON.
TEST(Fuzz, ValuesOfTheJson) {
    GltfBuilder b;
    const std::string whole = rich_scene(b).embedded().dump();
    const fs::path file = b.folder() / "fuzz.gltf";
    const std::vector<std::string> numbers{"0",
                                           "-1",
                                           "1",
                                           "2",
                                           "3",
                                           "7",
                                           "255",
                                           "5121",
                                           "5126",
                                           "65536",
                                           "4294967295",
                                           "4294967296",
                                           "2147483648",
                                           "9007199254740993",
                                           "18446744073709551615",
                                           "1e300",
                                           "-1e300",
                                           "1e-300",
                                           "0.5",
                                           "null",
                                           "true",
                                           "\"x\"",
                                           "[]",
                                           "{}",
                                           "[1]",
                                           "[0,0,0]",
                                           "{\"index\":0}"};
    std::mt19937 random(20240502);
    Tally tally;
    for (int round = 0; round < 1000; ++round) {
        std::string text = whole;
        const uint32_t edits = 1 + pick(random, 3);
        for (uint32_t k = 0; k < edits; ++k) {
            // The next value after a random place.
            size_t at = text.find_first_of(":[", pick(random, text.size()));
            if (at == std::string::npos) continue;
            size_t end = text.find_first_of(",]}[{", ++at);
            if (end == std::string::npos) continue;
            text.replace(at, end - at, numbers[pick(random, numbers.size())]);
        }
        load_one(file, {text.begin(), text.end()}, tally);
        if (HasFatalFailure()) FAIL() << "round " << round << "\n" << text;
    }
    EXPECT_GT(tally.passed, 10);
    EXPECT_GT(tally.refused, 100);
}

// Structure: members removed, copied to other places, swapped.
void mutate(Json& value, std::mt19937& random, const std::vector<Json>& spare) {
    if (value.is_structured() && !value.empty() && pick(random, 5) != 0) {
        auto it = value.begin();
        std::advance(it, pick(random, value.size()));
        return mutate(*it, random, spare);
    }
    value = spare[pick(random, spare.size())];
}

void collect(const Json& value, std::vector<Json>& out) {
    out.push_back(value);
    if (!value.is_structured()) return;
    for (const Json& child : value) collect(child, out);
}

TEST(Fuzz, StructureOfTheJson) {
    GltfBuilder b;
    const Json whole = rich_scene(b).embedded();
    std::vector<Json> spare;
    collect(whole, spare);
    const fs::path file = b.folder() / "fuzz.gltf";
    std::mt19937 random(20240503);
    Tally tally;
    for (int round = 0; round < 1000; ++round) {
        Json root = whole;
        const uint32_t edits = 1 + pick(random, 2);
        for (uint32_t k = 0; k < edits; ++k) mutate(root, random, spare);
        const std::string text = root.dump();
        load_one(file, {text.begin(), text.end()}, tally);
        if (HasFatalFailure()) FAIL() << "round " << round << "\n" << text;
    }
    EXPECT_GT(tally.passed, 10);
    EXPECT_GT(tally.refused, 100);
}

// The image decoders alone.
TEST(Fuzz, Images) {
    TemporaryFolder folder;
    ImageRgba image{20, 12, {}, {}};
    ImageBytes picture{20, 12, 4, {}};
    for (uint32_t i = 0; i < 240; ++i) {
        image.rgb.push_back(Rgb(static_cast<float>(i % 7)));
        picture.bytes.insert(picture.bytes.end(), {static_cast<uint8_t>(i), 2, 3, 4});
    }
    ASSERT_TRUE(save_png(folder / "a.png", picture).ok() &&
                save_exr(folder / "a.exr", image).ok() && save_hdr(folder / "a.hdr", image).ok() &&
                save_pfm(folder / "a.pfm", image).ok());
    std::mt19937 random(20240504);
    for (const char* name : {"a.png", "a.exr", "a.hdr", "a.pfm"}) {
        const std::vector<uint8_t> whole = read_bytes(folder / name);
        int passed = 0;
        for (int round = 0; round < 200; ++round) {
            std::vector<uint8_t> bytes = whole;
            for (uint32_t k = 1 + pick(random, 4); k > 0; --k)
                bytes[pick(random, bytes.size())] = static_cast<uint8_t>(random());
            if (round % 5 == 0) bytes.resize(pick(random, bytes.size()));
            write_bytes(folder / "damaged", bytes);
            const auto read = load_image(folder / "damaged");
            if (read.ok()) {
                ++passed;
                ASSERT_EQ(read->rgb.size(), size_t{read->width} * read->height);
            }
        }
        EXPECT_GT(passed, 1) << name;
    }
}

}  // namespace
}  // namespace talbot
