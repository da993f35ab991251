// Writes tiny glTF files for tests: a JSON document that a test edits freely, and one binary
// buffer.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/io/gltf_loader.h"
#include "core/io/image_io.h"

namespace talbot::test {

using Json = nlohmann::json;
namespace fs = std::filesystem;

inline constexpr int kByte = 5120;
inline constexpr int kUnsignedByte = 5121;
inline constexpr int kShort = 5122;
inline constexpr int kUnsignedShort = 5123;
inline constexpr int kUnsignedInt = 5125;
inline constexpr int kFloat = 5126;

// A folder that is removed with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        static int counter = 0;
        path_ = fs::temp_directory_path() /
                ("talbot_io_" + std::to_string(::getpid()) + "_" + std::to_string(counter++));
        fs::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    fs::path operator/(const std::string& name) const { return path_ / name; }
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

inline void write_bytes(const fs::path& file, const void* data, size_t size) {
    std::ofstream out(file, std::ios::binary);
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

inline void write_bytes(const fs::path& file, const std::vector<uint8_t>& bytes) {
    write_bytes(file, bytes.data(), bytes.size());
}

inline std::vector<uint8_t> read_bytes(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::vector<uint8_t>(std::istreambuf_iterator<char>(in), {});
}

inline std::string base64(const std::vector<uint8_t>& bytes) {
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t v = 0;
        for (size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; ++k) {
            text += i + k < bytes.size() + 1 ? digits[v >> (18 - 6 * k) & 63] : '=';
        }
    }
    return text;
}

class GltfBuilder {
  public:
    GltfBuilder() {
        root["asset"] = {{"version", "2.0"}};
        root["scene"] = 0;
        root["scenes"] = Json::array({{{"nodes", {0}}}});
    }

    // A buffer view of these bytes, aligned to 4.
    template <typename T>
    int add_view(const std::vector<T>& values, int stride = 0) {
        while (bin.size() % 4) bin.push_back(0);
        const size_t offset = bin.size();
        const size_t size = values.size() * sizeof(T);
        bin.resize(offset + size);
        if (size) std::memcpy(bin.data() + offset, values.data(), size);
        Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
        if (stride) view["byteStride"] = stride;
        return push("bufferViews", view);
    }

    int add_accessor(int view, int component_type, const char* type, size_t count,
                     size_t offset = 0, bool normalized = false) {
        Json accessor = {{"componentType", component_type}, {"type", type}, {"count", count}};
        if (view >= 0) accessor["bufferView"] = view;
        if (offset) accessor["byteOffset"] = offset;
        if (normalized) accessor["normalized"] = true;
        return push("accessors", accessor);
    }

    int add_floats(const std::vector<float>& values, const char* type) {
        const size_t width = std::string(type) == "SCALAR" ? 1 : static_cast<size_t>(type[3] - '0');
        return add_accessor(add_view(values), kFloat, type, values.size() / width);
    }

    int add_indices(const std::vector<uint16_t>& values) {
        return add_accessor(add_view(values), kUnsignedShort, "SCALAR", values.size());
    }

    // A primitive as a mesh of its own, and a node that shows it; returns the mesh.
    int add_mesh(const Json& attributes, int indices = -1, int mode = 4, int material = -1) {
        Json primitive = {{"attributes", attributes}};
        if (indices >= 0) primitive["indices"] = indices;
        if (mode != 4) primitive["mode"] = mode;
        if (material >= 0) primitive["material"] = material;
        return push("meshes", {{"primitives", Json::array({primitive})}});
    }

    int add_node(const Json& node) { return push("nodes", node); }
    int add_material(const Json& material) { return push("materials", material); }

    int push(const char* array, const Json& value) {
        root[array].push_back(value);
        return static_cast<int>(root[array].size()) - 1;
    }

    // A texture with a one-texel or larger RGBA image in a buffer view; returns the texture.
    int add_texture(const Image8& image, const Json& sampler = Json()) {
        ImageBytes png{image.width, image.height, 4, image.rgba};
        const fs::path file = folder_ / "texture.png";
        if (!save_png(file, png)) return -1;
        Json texture = {{"source", push("images", {{"bufferView", add_view(read_bytes(file))},
                                                   {"mimeType", "image/png"}})}};
        if (!sampler.is_null()) texture["sampler"] = push("samplers", sampler);
        return push("textures", texture);
    }
    int add_texture() { return add_texture(Image8{1, 1, {128, 128, 255, 255}, ""}); }

    void use_extension(const char* name, bool required = false) {
        root["extensionsUsed"].push_back(name);
        if (required) root["extensionsRequired"].push_back(name);
    }

    // A triangle (0,0,0) (1,0,0) (0,1,0) on node 0.
    void add_triangle() {
        const int p = add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
        add_node({{"mesh", add_mesh({{"POSITION", p}})}});
    }

    // The quad [0,1]^2 in the plane z = 0, facing +Z, upright image: U to the right, V down.
    Json quad_attributes() {
        const int p = add_floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
        const int n = add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        const int t = add_floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
        return {{"POSITION", p}, {"NORMAL", n}, {"TEXCOORD_0", t}};
    }
    int quad_indices() { return add_indices({0, 1, 2, 0, 2, 3}); }

    Json embedded() const {
        Json out = root;
        if (!bin.empty()) {
            out["buffers"] =
                Json::array({{{"byteLength", bin.size()},
                              {"uri", "data:application/octet-stream;base64," + base64(bin)}}});
        }
        return out;
    }

    fs::path write_gltf(const fs::path& file) const {
        const std::string text = embedded().dump();
        write_bytes(file, text.data(), text.size());
        return file;
    }

    std::vector<uint8_t> glb() const {
        Json out = root;
        if (!bin.empty()) out["buffers"] = Json::array({{{"byteLength", bin.size()}}});
        std::string text = out.dump();
        while (text.size() % 4) text += ' ';
        std::vector<uint8_t> padded = bin;
        while (padded.size() % 4) padded.push_back(0);
        std::vector<uint8_t> bytes;
        const auto word = [&](uint32_t v) {
            for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<uint8_t>(v >> (8 * i)));
        };
        word(0x46546C67);
        word(2);
        word(static_cast<uint32_t>(20 + text.size() + (padded.empty() ? 0 : 8 + padded.size())));
        word(static_cast<uint32_t>(text.size()));
        word(0x4E4F534A);
        bytes.insert(bytes.end(), text.begin(), text.end());
        if (!padded.empty()) {
            word(static_cast<uint32_t>(padded.size()));
            word(0x004E4942);
            bytes.insert(bytes.end(), padded.begin(), padded.end());
        }
        return bytes;
    }

    Result<SceneDesc> load(LoadOptions options = {}) const {
        options.threads = options.threads ? options.threads : 2;
        return load_gltf(write_gltf(folder_ / "scene.gltf"), options);
    }

    Json root;
    std::vector<uint8_t> bin;
    const TemporaryFolder& folder() const { return folder_; }

  private:
    TemporaryFolder folder_;
};

inline bool has_warning(const SceneDesc& scene, const std::string& part) {
    for (const std::string& warning : scene.warnings) {
        if (warning.find(part) != std::string::npos) return true;
    }
    return false;
}

}  // namespace talbot::test

// The scene, or a failed test that says why it did not load.
#define TALBOT_LOADED(scene, expression)                               \
    const auto scene##_result = (expression);                          \
    ASSERT_TRUE(scene##_result.ok()) << scene##_result.error().line(); \
    const ::talbot::SceneDesc& scene = *scene##_result
