// Files from strangers: every defect gives one clear line that names the file and the element,
// never a crash or a big allocation.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "io_gltf_builder.h"

namespace talbot {
namespace {

using namespace test;

// The error of a load that must fail as bad input, with this element and this in its text.
void expect_refused(const Result<SceneDesc>& result, const std::string& element,
                    const std::string& part) {
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().kind, ErrorKind::bad_input);
    EXPECT_EQ(result.error().element, element) << result.error().line();
    EXPECT_NE(result.error().what.find(part), std::string::npos) << result.error().line();
    EXPECT_EQ(result.error().line().find('\n'), std::string::npos) << "one line";
    EXPECT_FALSE(result.error().file.empty());
    EXPECT_LT(result.error().line().size(), 600u);
}

Result<SceneDesc> load_bytes(const std::vector<uint8_t>& bytes, const char* name = "scene.glb",
                             LoadOptions options = {}) {
    TemporaryFolder folder;
    write_bytes(folder / name, bytes);
    options.threads = 1;
    return load_gltf(folder / name, options);
}

Result<SceneDesc> load_text(const std::string& text) {
    return load_bytes(std::vector<uint8_t>(text.begin(), text.end()), "scene.gltf");
}

TEST(BadFiles, EmptyMissingAndNotGltf) {
    expect_refused(load_bytes({}), "", "is empty");
    expect_refused(load_gltf("/nowhere/at/all.gltf"), "", "cannot open");
    expect_refused(load_gltf("/tmp"), "", "not a regular file");
    expect_refused(load_text("hello"), "", "not valid JSON");
    expect_refused(load_text("[1, 2]"), "", "not a glTF object");
    expect_refused(load_text("{}"), "asset", "missing");
    expect_refused(load_text(R"({"asset": {"version": "1.0"}})"), "asset.version", "only glTF 2");
    expect_refused(load_text(R"({"asset": {"version": "2.0", "minVersion": "2.9"}})"),
                   "asset.minVersion", "2.0");
    expect_refused(load_text("{\"asset\": {\"version\": \"2.0\"}, \"x\": \"\xFF\xFE\"}"), "",
                   "not valid JSON");
    expect_refused(load_text(R"({"asset": {"version": "2.0"}, "x": 1e999})"), "", "not valid JSON");
}

TEST(BadFiles, NestingBombs) {
    const std::string deep =
        R"({"asset": {"version": "2.0"}, "extras": )" + std::string(1000000, '[');
    expect_refused(load_text(deep), "", "nested more than");
    const std::string closed = R"({"asset": {"version": "2.0"}, "extras": )" +
                               std::string(150, '[') + std::string(150, ']') + "}";
    EXPECT_TRUE(load_text(closed).ok()) << "brackets in reason are fine";
    const std::string quoted =
        R"({"asset": {"version": "2.0"}, "extras": ")" + std::string(1000, '[') + "\\\"[\"}";
    EXPECT_TRUE(load_text(quoted).ok()) << "brackets within strings do not count";
}

TEST(BadFiles, TruncatedGlb) {
    GltfBuilder b;
    b.add_triangle();
    const std::vector<uint8_t> whole = b.glb();
    ASSERT_TRUE(load_bytes(whole).ok());
    for (const size_t size :
         {size_t{5}, size_t{12}, size_t{19}, size_t{20}, whole.size() / 2, whole.size() - 1}) {
        expect_refused(load_bytes({whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size)}),
                       "", "truncated");
    }
    std::vector<uint8_t> version = whole;
    version[4] = 1;
    expect_refused(load_bytes(version), "", "version 1");
    std::vector<uint8_t> chunk = whole;
    chunk[15] = 0x7F;
    expect_refused(load_bytes(chunk), "", "chunk runs over");
    std::vector<uint8_t> kind = whole;
    kind[16] = 'X';
    expect_refused(load_bytes(kind), "", "no JSON chunk");
}

TEST(GoodFiles, GlbWithAndWithoutABinaryChunk) {
    GltfBuilder empty;
    empty.root.erase("scene");
    empty.root.erase("scenes");
    TALBOT_LOADED(nothing, load_bytes(empty.glb()));
    EXPECT_TRUE(nothing.instances.empty());
    GltfBuilder b;
    b.add_triangle();
    // A .glb is known by its content, and so is a .gltf.
    TALBOT_LOADED(scene, load_bytes(b.glb(), "scene.gltf"));
    EXPECT_EQ(scene.instances.size(), 1u);
}

TEST(GoodFiles, ExternalBufferLongerThanDeclared) {
    GltfBuilder b;
    b.add_triangle();
    std::vector<uint8_t> longer = b.bin;
    longer.resize(longer.size() + 100);
    write_bytes(b.folder() / "my data.bin", longer);
    Json root = b.root;
    root["buffers"] = {{{"byteLength", b.bin.size()}, {"uri", "my%20data.bin"}}};
    const std::string text = root.dump();
    write_bytes(b.folder() / "s.gltf", text.data(), text.size());
    EXPECT_TRUE(load_gltf(b.folder() / "s.gltf").ok());
}

// What a test does to a sound file, and what must be said.
struct Defect {
    const char* name;
    void (*break_it)(GltfBuilder&);
    const char* element;
    const char* part;
};

void node(GltfBuilder& b, const char* key, const Json& value) {
    b.root["nodes"][0][key] = value;
}

const Defect kDefects[] = {
    {"missing_bin",
     [](GltfBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 36}, {"uri", "none.bin"}}};
         b.bin.clear();
     },
     "buffers[0]", "none.bin: cannot open"},
    {"absolute_uri",
     [](GltfBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 9}, {"uri", "/etc/passwd"}}};
         b.bin.clear();
     },
     "buffers[0]", "leaves the scene's folder"},
    {"escaping_uri",
     [](GltfBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 9}, {"uri", "a/%2e%2E/../x"}}};
         b.bin.clear();
     },
     "buffers[0]", "leaves the scene's folder"},
    {"remote_uri",
     [](GltfBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 9}, {"uri", "http://x/y"}}};
         b.bin.clear();
     },
     "buffers[0]", "not a relative path"},
    {"bad_base64",
     [](GltfBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 3}, {"uri", "data:x/y;base64,A!BC"}}};
         b.bin.clear();
     },
     "buffers[0]", "malformed"},
    {"short_data",
     [](GltfBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 3000000000}, {"uri", "data:x/y;base64,AAAA"}}};
         b.bin.clear();
     },
     "buffers[0]", "declares 3000000000 bytes, its data has 3"},
    {"no_uri",
     [](GltfBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 36}}};
         b.bin.clear();
     },
     "buffers[0]", "no uri"},
    {"view_overrun", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteLength"] = 4000; },
     "bufferViews[0]", "4000"},
    {"view_offset",
     [](GltfBuilder& b) { b.root["bufferViews"][0]["byteOffset"] = 9007199254740991; },
     "bufferViews[0]", "of a buffer of 36"},
    {"view_buffer", [](GltfBuilder& b) { b.root["bufferViews"][0]["buffer"] = 3; },
     "bufferViews[0].buffer", "3 is out of range"},
    {"accessor_overrun", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 4; },
     "accessors[0]", "needs 4 elements of 12"},
    {"accessor_huge", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 9007199254740991; },
     "accessors[0]", "needs"},
    {"accessor_offset", [](GltfBuilder& b) { b.root["accessors"][0]["byteOffset"] = 4; },
     "accessors[0]", "from byte 4 on"},
    {"accessor_negative", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = -1; },
     "accessors[0].count", "non-negative"},
    {"accessor_fraction", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 2.5; },
     "accessors[0].count", "integer"},
    {"accessor_wraps", [](GltfBuilder& b) { b.root["accessors"][0]["bufferView"] = 4294967296; },
     "accessors[0].bufferView", "out of range"},
    {"accessor_type", [](GltfBuilder& b) { b.root["accessors"][0]["componentType"] = 5124; },
     "accessors[0]", "5124"},
    {"accessor_empty", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 0; }, "accessors[0]",
     "no elements"},
    {"accessor_lacks_count", [](GltfBuilder& b) { b.root["accessors"][0].erase("count"); },
     "accessors[0]", "lacks count"},
    {"stride_short", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 8; },
     "accessors[0]", "stride"},
    {"position_type", [](GltfBuilder& b) { b.root["accessors"][0]["type"] = "VEC2"; },
     "meshes[0].primitives[0]", "POSITION"},
    {"attribute_index",
     [](GltfBuilder& b) { b.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 7; },
     "meshes[0].primitives[0].attributes.NORMAL", "7 is out of range: there are 1 accessors"},
    {"attribute_count",
     [](GltfBuilder& b) {
         b.root["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
             b.add_floats({0, 0, 1}, "VEC3");
     },
     "meshes[0].primitives[0]", "NORMAL has 1 elements, POSITION has 3"},
    {"index_range",
     [](GltfBuilder& b) {
         b.root["meshes"][0]["primitives"][0]["indices"] = b.add_indices({0, 1, 3});
     },
     "meshes[0].primitives[0]", "index 3 is out of range: there are 3 vertices"},
    {"index_restart",
     [](GltfBuilder& b) {
         b.root["meshes"][0]["primitives"][0]["indices"] = b.add_indices({0, 1, 65535});
     },
     "meshes[0].primitives[0]", "65535 is out of range"},
    {"index_floats",
     [](GltfBuilder& b) {
         b.root["meshes"][0]["primitives"][0]["indices"] = b.add_floats({0, 1, 2}, "SCALAR");
     },
     "meshes[0].primitives[0]", "not unsigned integers"},
    {"primitive_material",
     [](GltfBuilder& b) { b.root["meshes"][0]["primitives"][0]["material"] = 0; },
     "meshes[0].primitives[0].material", "0 is out of range: there are 0 materials"},
    {"primitive_mode", [](GltfBuilder& b) { b.root["meshes"][0]["primitives"][0]["mode"] = 7; },
     "meshes[0].primitives[0].mode", "7"},
    {"primitive_none", [](GltfBuilder& b) { b.root["meshes"][0]["primitives"] = Json::array(); },
     "meshes[0]", "no primitives"},
    {"primitive_bare",
     [](GltfBuilder& b) { b.root["meshes"][0]["primitives"][0].erase("attributes"); },
     "meshes[0].primitives[0]", "lacks attributes"},
    {"sparse_range",
     [](GltfBuilder& b) {
         const int i = b.add_view(std::vector<uint8_t>{3});
         const int v = b.add_view(std::vector<float>{0, 0, 0});
         b.root["accessors"][0]["sparse"] = {
             {"count", 1},
             {"indices", {{"bufferView", i}, {"componentType", 5121}}},
             {"values", {{"bufferView", v}}}};
     },
     "accessors[0].sparse.indices", "3 is out of range"},
    {"sparse_overrun",
     [](GltfBuilder& b) {
         const int i = b.add_view(std::vector<uint8_t>{0});
         b.root["accessors"][0]["sparse"] = {
             {"count", 1},
             {"indices", {{"bufferView", i}, {"componentType", 5121}}},
             {"values", {{"bufferView", i}}}};
     },
     "accessors[0].sparse.values", "needs 1 elements of 12"},
    {"sparse_signed",
     [](GltfBuilder& b) {
         b.root["accessors"][0]["sparse"] = {
             {"count", 1},
             {"indices", {{"bufferView", 0}, {"componentType", 5120}}},
             {"values", {{"bufferView", 0}}}};
     },
     "accessors[0].sparse.indices", "unsigned"},
    {"cycle",
     [](GltfBuilder& b) {
         b.add_node({{"children", {2}}});
         b.add_node({{"children", {1}}});
     },
     "nodes[1]", "cycle"},
    {"self_cycle", [](GltfBuilder& b) { node(b, "children", {0}); }, "nodes[0]", "cycle"},
    {"two_parents",
     [](GltfBuilder& b) {
         node(b, "children", {1, 2});
         b.add_node({{"children", {3}}});
         b.add_node({{"children", {3}}});
         b.add_node(Json::object());
     },
     "nodes[3]", "child of both nodes[1] and nodes[2]"},
    {"depth",
     [](GltfBuilder& b) {
         for (int i = 0; i < 20000; ++i)
             b.root["nodes"][static_cast<size_t>(i)]["children"] = {i + 1};
         b.add_node(Json::object());
     },
     "nodes[1025]", "levels deep"},
    {"child_range", [](GltfBuilder& b) { node(b, "children", {5}); }, "nodes[0].children[0]",
     "5 is out of range"},
    {"mesh_range", [](GltfBuilder& b) { node(b, "mesh", 5); }, "nodes[0].mesh",
     "5 is out of range"},
    {"camera_range", [](GltfBuilder& b) { node(b, "camera", 0); }, "nodes[0].camera",
     "0 is out of range"},
    {"scene_range", [](GltfBuilder& b) { b.root["scene"] = 3; }, "scene", "3 is out of range"},
    {"scene_node_range", [](GltfBuilder& b) { b.root["scenes"][0]["nodes"] = {9}; },
     "scenes[0].nodes[0]", "9 is out of range"},
    {"light_range",
     [](GltfBuilder& b) {
         node(b, "extensions", {{"KHR_lights_punctual", {{"light", 0}}}});
     },
     "nodes[0].extensions.KHR_lights_punctual", "there are 0 lights"},
    {"instancing_range",
     [](GltfBuilder& b) {
         node(b, "extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"SCALE", 9}}}}}});
     },
     "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.SCALE", "out of range"},
    {"instancing_counts",
     [](GltfBuilder& b) {
         const int one = b.add_floats({1, 1, 1}, "VEC3");
         node(
             b, "extensions",
             {{"EXT_mesh_gpu_instancing", {{"attributes", {{"SCALE", one}, {"TRANSLATION", 0}}}}}});
     },
     "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.SCALE",
     "has 1 elements, another attribute has 3"},
    {"instancing_type",
     [](GltfBuilder& b) {
         node(b, "extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"ROTATION", 0}}}}}});
     },
     "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.ROTATION", "wrong type"},
    {"shape_range",
     [](GltfBuilder& b) {
         node(b, "extensions", {{"TALBOT_implicit_surface", {{"shape", 0}}}});
     },
     "nodes[0].extensions.TALBOT_implicit_surface", "not a sphere"},
    {"texture_range",
     [](GltfBuilder& b) {
         b.add_material({{"normalTexture", {{"index", 1}}}});
     },
     "materials[0].normalTexture.index", "1 is out of range"},
    {"extension_texture_range",
     [](GltfBuilder& b) {
         b.add_material(
             {{"extensions", {{"KHR_materials_specular", {{"specularTexture", {{"index", 4}}}}}}}});
     },
     "materials[0].extensions.KHR_materials_specular.specularTexture.index", "4 is out of range"},
    {"image_both",
     [](GltfBuilder& b) {
         b.push("images", {{"uri", "x"}, {"bufferView", 0}});
     },
     "images[0]", "either"},
    {"image_neither", [](GltfBuilder& b) { b.push("images", Json::object()); }, "images[0]",
     "either"},
    {"required_extension", [](GltfBuilder& b) { b.use_extension("EXT_nobody_knows", true); },
     "extensionsRequired", "EXT_nobody_knows"},
    {"not_an_array", [](GltfBuilder& b) { b.root["materials"] = 3; }, "materials",
     "is not an array"},
    {"not_an_object", [](GltfBuilder& b) { b.root["materials"] = {1}; }, "materials[0]",
     "is not an object"},
};

class Defects : public testing::TestWithParam<Defect> {};

TEST_P(Defects, AreRefusedByName) {
    GltfBuilder b;
    b.add_triangle();
    ASSERT_TRUE(b.load().ok());
    GetParam().break_it(b);
    expect_refused(b.load(), GetParam().element, GetParam().part);
}

INSTANTIATE_TEST_SUITE_P(All, Defects, testing::ValuesIn(kDefects),
                         [](const auto& defect) { return std::string(defect.param.name); });

// A quad with a base colour texture whose image is broken in some way.
Result<SceneDesc> load_with_image(const std::vector<uint8_t>& bytes, LoadOptions options = {}) {
    GltfBuilder b;
    const Json attributes = b.quad_attributes();
    const int i = b.quad_indices();
    b.push("images", {{"uri", "picture.png"}});
    b.push("textures", {{"source", 0}});
    const int m = b.add_material({{"emissiveTexture", {{"index", 0}}}});
    b.add_node({{"mesh", b.add_mesh(attributes, i, 4, m)}});
    if (!bytes.empty()) write_bytes(b.folder() / "picture.png", bytes);
    return b.load(options);
}

TEST(BadImages, AreRefusedByName) {
    GltfBuilder b;
    Image8 image{32, 32, {}, ""};
    std::mt19937 random(1);
    for (int k = 0; k < 32 * 32 * 4; ++k) image.rgba.push_back(static_cast<uint8_t>(random()));
    b.add_texture(image);
    const std::vector<uint8_t> png = read_bytes(b.folder() / "texture.png");
    ASSERT_TRUE(load_with_image(png).ok());
    expect_refused(load_with_image({}), "images[0]", "picture.png: cannot open");
    expect_refused(load_with_image({1, 2, 3}), "images[0]", "none of PNG, JPEG, WebP and KTX2");
    expect_refused(load_with_image({png.begin(), png.begin() + 20}), "images[0]", "ends too early");
    expect_refused(
        load_with_image({png.begin(), png.begin() + static_cast<ptrdiff_t>(png.size() / 2)}),
        "images[0]", "broken PNG");
    const auto with_size = [&](uint32_t width, uint32_t height) {
        std::vector<uint8_t> lying = png;
        for (size_t k = 0; k < 4; ++k) {
            lying[16 + k] = static_cast<uint8_t>(width >> (24 - 8 * k));
            lying[20 + k] = static_cast<uint8_t>(height >> (24 - 8 * k));
        }
        return lying;
    };
    expect_refused(load_with_image(with_size(100000, 100000)), "images[0]", "100000x100000");
    expect_refused(load_with_image(with_size(16384, 16384)), "images[0]", "more than its");
    expect_refused(load_with_image(with_size(0, 32)), "images[0]", "empty image");
    expect_refused(load_with_image(with_size(32, 64)), "images[0]", "broken PNG");
}

TEST(Memory, DeclaredSizesAreSummedBeforeAllocation) {
    GltfBuilder b;
    // No bytes in the file stand behind these: sparse accessors of zeros.
    const int i = b.add_view(std::vector<uint8_t>{0});
    const int v = b.add_view(std::vector<float>{1, 0, 0});
    const int p = b.add_accessor(-1, kFloat, "VEC3", 3000000000u);
    b.root["accessors"][p]["sparse"] = {{"count", 1},
                                        {"indices", {{"bufferView", i}, {"componentType", 5121}}},
                                        {"values", {{"bufferView", v}}}};
    b.add_node({{"mesh", b.add_mesh({{"POSITION", p}})}});
    expect_refused(b.load(), "accessors[0]", "without a buffer view");

    // Many primitives that share one small accessor each: their sum counts.
    GltfBuilder many;
    const int q =
        many.add_accessor(many.add_view(std::vector<float>(3 * 3000, 1.0f)), kFloat, "VEC3", 3000);
    Json primitives = Json::array();
    for (int k = 0; k < 100; ++k) primitives.push_back({{"attributes", {{"POSITION", q}}}});
    many.push("meshes", {{"primitives", primitives}});
    many.add_node({{"mesh", 0}});
    LoadOptions options;
    options.max_bytes = 1 << 20;
    expect_refused(many.load(options), "", "MiB when decoded");
    options.max_bytes = 16 << 20;
    EXPECT_TRUE(many.load(options).ok());
}

TEST(Memory, InstancesCount) {
    GltfBuilder b;
    b.add_triangle();
    const int i = b.add_view(std::vector<uint8_t>{0});
    const int v = b.add_view(std::vector<float>{1, 0, 0});
    const int t = b.add_accessor(-1, kFloat, "VEC3", 2000000000u);
    b.root["accessors"][t]["sparse"] = {{"count", 1},
                                        {"indices", {{"bufferView", i}, {"componentType", 5121}}},
                                        {"values", {{"bufferView", v}}}};
    b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", t}};
    expect_refused(b.load(), "accessors[1]", "without a buffer view");
}

TEST(Extensions, UnknownOnesAreReported) {
    GltfBuilder b;
    b.add_triangle();
    b.use_extension("EXT_nobody_knows");
    b.use_extension("KHR_animation_pointer");
    b.use_extension("KHR_xmp_json_ld");
    TALBOT_LOADED(scene, b.load());
    ASSERT_EQ(scene.extensions.size(), 3u);
    EXPECT_FALSE(scene.extensions[0].supported);
    EXPECT_FALSE(scene.extensions[0].required);
    EXPECT_TRUE(scene.extensions[2].supported) << "changes no pixel";
    EXPECT_TRUE(has_warning(scene, "EXT_nobody_knows is not supported"));
    EXPECT_FALSE(has_warning(scene, "xmp"));
}

}  // namespace
}  // namespace talbot
