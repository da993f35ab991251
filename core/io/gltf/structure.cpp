// The shape of a glTF document's JSON (glTF 2.0 schema, as far as the loader relies on it).
#include "core/io/gltf/structure.h"

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace talbot::gltf {

namespace {

using Json = nlohmann::json;

constexpr uint64_t kMaxInteger = 1ull << 53;
// Of what is kept as an int.
constexpr uint64_t kMaxInt = 0x7FFFFFFF;

// A member that is an index into a top-level array (target) or a plain unsigned integer (target
// empty).
struct IntegerMember {
    const char* array;
    const char* key;
    const char* target;
    bool required;
};

constexpr auto kIntegerMembers = std::to_array<IntegerMember>({
    {"accessors", "bufferView", "bufferViews", false},
    {"accessors", "byteOffset", "", false},
    {"accessors", "componentType", "", true},
    {"accessors", "count", "", true},
    {"buffers", "byteLength", "", true},
    {"bufferViews", "buffer", "buffers", true},
    {"bufferViews", "byteOffset", "", false},
    {"bufferViews", "byteLength", "", true},
    {"bufferViews", "byteStride", "", false},
    {"images", "bufferView", "bufferViews", false},
    {"nodes", "camera", "cameras", false},
    {"nodes", "mesh", "meshes", false},
    {"nodes", "skin", "skins", false},
    {"skins", "inverseBindMatrices", "accessors", false},
    {"skins", "skeleton", "nodes", false},
    {"textures", "sampler", "samplers", false},
    {"textures", "source", "images", false},
});

// Members that are arrays of indices.
constexpr auto kIndexArrays = std::to_array<IntegerMember>({
    {"nodes", "children", "nodes", false},
    {"scenes", "nodes", "nodes", false},
    {"skins", "joints", "nodes", true},
});

constexpr auto kArrays = std::to_array<const char*>(
    {"accessors", "animations", "buffers", "bufferViews", "cameras", "images", "materials",
     "meshes", "nodes", "samplers", "scenes", "skins", "textures"});

class StructureCheck {
  public:
    explicit StructureCheck(const Json& root) : root_(root) {}

    Status run() {
        for (const char* name : kArrays) check_object_array(root_, name, "");
        if (!error_) check_asset();
        if (!error_) check_tables();
        if (!error_) check_meshes();
        if (!error_) check_accessors();
        if (!error_) check_texture_extensions();
        if (!error_) check_materials();
        if (!error_) check_animations();
        if (!error_) check_node_extensions();
        if (error_) return *error_;
        return Done{};
    }

  private:
    void fail(const std::string& element, const std::string& what) {
        if (!error_) error_ = Error{ErrorKind::bad_input, "", element, what};
    }

    size_t size_of(const char* array) const {
        const auto found = root_.find(array);
        return found == root_.end() ? 0 : found->size();
    }

    // An absent member is fine unless required.
    void check_integer(const Json& object, const char* key, const char* target, bool required,
                       const std::string& element) {
        const auto found = object.find(key);
        if (found == object.end()) {
            if (required) fail(element, std::string("lacks ") + key);
            return;
        }
        check_integer_value(*found, target, element + "." + key);
    }

    void check_integer_value(const Json& value, const char* target, const std::string& element) {
        if (!value.is_number_unsigned()) return fail(element, "is not a non-negative integer");
        const auto number = value.get<uint64_t>();
        if (!*target) {
            if (number > kMaxInteger)
                fail(element, std::to_string(number) + " is out of range: at most " +
                                  std::to_string(kMaxInteger));
        } else if (number >= size_of(target)) {
            fail(element, std::to_string(number) + " is out of range: there are " +
                              std::to_string(size_of(target)) + " " + target);
        }
    }

    void check_index_array(const Json& object, const char* key, const char* target,
                           const std::string& element) {
        const auto found = object.find(key);
        if (found == object.end()) return;
        if (!found->is_array()) return fail(element + "." + key, "is not an array");
        for (size_t i = 0; i < found->size() && !error_; ++i) {
            check_integer_value((*found)[i], target,
                                element + "." + key + "[" + std::to_string(i) + "]");
        }
    }

    // Returns the array, or null when it is absent or wrong.
    const Json* check_object_array(const Json& object, const char* key,
                                   const std::string& element) {
        const auto found = object.find(key);
        if (found == object.end()) return nullptr;
        const std::string name = (element.empty() ? "" : element + ".") + key;
        if (!found->is_array()) {
            fail(name, "is not an array");
            return nullptr;
        }
        for (size_t i = 0; i < found->size(); ++i) {
            if (!(*found)[i].is_object())
                fail(name + "[" + std::to_string(i) + "]", "is not an object");
        }
        return error_ ? nullptr : &*found;
    }

    template <typename Visit>
    void for_each(const char* array, const Visit& visit) {
        const auto found = root_.find(array);
        if (found == root_.end()) return;
        for (size_t i = 0; i < found->size() && !error_; ++i) {
            visit((*found)[i], std::string(array) + "[" + std::to_string(i) + "]");
        }
    }

    void check_asset() {
        const auto asset = root_.find("asset");
        if (asset == root_.end() || !asset->is_object())
            return fail("asset", "is missing; is this a glTF file?");
        const std::string version = asset->contains("version") && (*asset)["version"].is_string()
                                        ? (*asset)["version"]
                                        : "";
        if (!version.starts_with("2."))
            fail("asset.version", "'" + version + "' is not supported; only glTF 2 is");
        const auto minimum = asset->find("minVersion");
        if (minimum != asset->end() && *minimum != "2.0")
            fail("asset.minVersion", "only glTF 2.0 is supported");
    }

    void check_tables() {
        for (const IntegerMember& member : kIntegerMembers) {
            for_each(member.array, [&](const Json& object, const std::string& element) {
                check_integer(object, member.key, member.target, member.required, element);
            });
        }
        for (const IntegerMember& member : kIndexArrays) {
            for_each(member.array, [&](const Json& object, const std::string& element) {
                if (member.required && !object.contains(member.key))
                    fail(element, std::string("lacks ") + member.key);
                check_index_array(object, member.key, member.target, element);
            });
        }
        const auto scene = root_.find("scene");
        if (scene != root_.end()) check_integer_value(*scene, "scenes", "scene");
    }

    // A dictionary of attribute names to accessors.
    void check_attributes(const Json& attributes, const std::string& element) {
        if (!attributes.is_object()) return fail(element, "is not an object");
        for (const auto& [name, value] : attributes.items())
            check_integer_value(value, "accessors", element + "." + name);
    }

    void check_meshes() {
        for_each("meshes", [&](const Json& mesh, const std::string& element) {
            const Json* primitives = check_object_array(mesh, "primitives", element);
            if (error_) return;
            if (!primitives || primitives->empty()) return fail(element, "has no primitives");
            for (size_t i = 0; i < primitives->size() && !error_; ++i) {
                check_primitive((*primitives)[i],
                                element + ".primitives[" + std::to_string(i) + "]");
            }
        });
    }

    void check_primitive(const Json& primitive, const std::string& element) {
        if (!primitive.contains("attributes")) return fail(element, "lacks attributes");
        check_attributes(primitive["attributes"], element + ".attributes");
        check_integer(primitive, "indices", "accessors", false, element);
        check_integer(primitive, "material", "materials", false, element);
        check_integer(primitive, "mode", "", false, element);
        const auto mode = primitive.find("mode");
        if (!error_ && mode != primitive.end() && *mode > 6)
            fail(element + ".mode", mode->dump() + " is not a primitive mode");
        check_variants(primitive, element);
        const Json* targets = check_object_array(primitive, "targets", element);
        for (size_t i = 0; targets && i < targets->size() && !error_; ++i) {
            check_attributes((*targets)[i], element + ".targets[" + std::to_string(i) + "]");
        }
    }

    // The materials that KHR_materials_variants maps to.
    void check_variants(const Json& primitive, const std::string& element) {
        const Json::json_pointer where("/extensions/KHR_materials_variants/mappings");
        if (!primitive.contains(where)) return;
        const Json& mappings = primitive[where];
        for (size_t i = 0; mappings.is_array() && i < mappings.size() && !error_; ++i) {
            if (!mappings[i].is_object()) continue;
            check_integer(
                mappings[i], "material", "materials", true,
                element + ".extensions.KHR_materials_variants.mappings[" + std::to_string(i) + "]");
        }
    }

    void check_accessors() {
        for_each("accessors", [&](const Json& accessor, const std::string& element) {
            const auto sparse = accessor.find("sparse");
            if (sparse == accessor.end()) return;
            const std::string name = element + ".sparse";
            if (!sparse->is_object()) return fail(name, "is not an object");
            check_integer(*sparse, "count", "", true, name);
            check_int_range(*sparse, name);
            for (const char* part : {"indices", "values"}) {
                const auto found = sparse->find(part);
                if (found == sparse->end() || !found->is_object())
                    return fail(name, std::string("lacks ") + part);
                check_integer(*found, "bufferView", "bufferViews", true, name + "." + part);
                check_integer(*found, "byteOffset", "", false, name + "." + part);
                check_integer(*found, "componentType", "", part[0] == 'i', name + "." + part);
            }
        });
    }

    // Whatever ends in "Texture" is a texture reference, in extensions too.
    void check_texture_references(const Json& object, const std::string& element) {
        for (const auto& [key, value] : object.items()) {
            if (error_ || key == "extras" || !value.is_object()) continue;
            const std::string name = element + "." + key;
            if (key.ends_with("Texture")) {
                check_integer(value, "index", "textures", true, name);
                check_integer(value, "texCoord", "", false, name);
            }
            check_texture_references(value, name);
        }
    }

    // Images in formats that extensions bring.
    void check_texture_extensions() {
        for_each("textures", [&](const Json& texture, const std::string& element) {
            const auto extensions = texture.find("extensions");
            if (extensions == texture.end() || !extensions->is_object()) return;
            for (const auto& [key, value] : extensions->items()) {
                if (value.is_object())
                    check_integer(value, "source", "images", false, element + ".extensions." + key);
            }
        });
    }

    void check_materials() {
        for_each("materials", [&](const Json& material, const std::string& element) {
            check_texture_references(material, element);
        });
    }

    void check_animations() {
        for_each("animations", [&](const Json& animation, const std::string& element) {
            const Json* samplers = check_object_array(animation, "samplers", element);
            for (size_t i = 0; samplers && i < samplers->size() && !error_; ++i) {
                const std::string name = element + ".samplers[" + std::to_string(i) + "]";
                check_integer((*samplers)[i], "input", "accessors", true, name);
                check_integer((*samplers)[i], "output", "accessors", true, name);
            }
            const Json* channels = check_object_array(animation, "channels", element);
            for (size_t i = 0; channels && i < channels->size() && !error_; ++i) {
                const std::string name = element + ".channels[" + std::to_string(i) + "]";
                check_integer((*channels)[i], "sampler", "", true, name);
                const auto target = (*channels)[i].find("target");
                if (target == (*channels)[i].end() || !target->is_object())
                    return fail(name, "lacks target");
                check_integer(*target, "node", "nodes", false, name + ".target");
            }
        });
    }

    // References of nodes' extensions.
    void check_node_extensions() {
        for_each("nodes", [&](const Json& node, const std::string& element) {
            const auto extensions = node.find("extensions");
            if (extensions != node.end()) check_int_range(*extensions, element + ".extensions");
        });
    }

    void check_int_range(const Json& value, const std::string& element) {
        if (error_) return;
        if (value.is_number_unsigned() && value.get<uint64_t>() > kMaxInt)
            return fail(element,
                        value.dump() + " is out of range: at most " + std::to_string(kMaxInt));
        if (!value.is_object()) return;
        for (const auto& [key, member] : value.items())
            check_int_range(member, element + "." + key);
    }

    const Json& root_;
    std::optional<Error> error_;
};

}  // namespace

bool json_depth_ok(std::string_view text) {
    int depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaxJsonDepth) return false;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return true;
}

Status check_structure(const nlohmann::json& root) {
    if (!root.is_object())
        return Error{ErrorKind::bad_input, "", "", "is JSON, but not a glTF object"};
    return StructureCheck(root).run();
}

}  // namespace talbot::gltf
