#include "app/hardcases/cases/gltf_text.h"

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "app/html_text.h"
#include "core/math/robust.h"

namespace talbot::hardcases {
namespace {

using Json = nlohmann::ordered_json;

template <typename Vector>
Json numbers(const Vector& v) {
    return {v.x, v.y, v.z};
}
Json numbers(const Mat4d& m) {
    Json list = Json::array();
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) list.push_back(m[c][r]);
    }
    return list;
}
Mat4d frame_of(const Camera& camera) {
    return {Vec4d(camera.right, 0), Vec4d(camera.up, 0), Vec4d(camera.backward, 0),
            Vec4d(camera.position, 1)};
}

class Writer {
  public:
    Writer(const SceneDesc& desc, uint32_t width, uint32_t height)
        : desc_(desc), width_(width), height_(height) {}

    std::string write(const Camera& camera) {
        json_["asset"] = {{"version", "2.0"}, {"generator", "talbot hardcases"}};
        json_["scene"] = 0;
        json_["nodes"] = Json::array();
        for (const Material& material : desc_.materials) add_material(material);
        for (const Texture& texture : desc_.textures) add_texture(texture);
        for (const Mesh& mesh : desc_.meshes) add_mesh(mesh);
        for (const MeshInstance& instance : desc_.instances)
            add_node({{"mesh", instance.mesh}, {"matrix", numbers(instance.world_from_object)}});
        for (const Sphere& sphere : desc_.spheres) add_sphere(sphere);
        for (const PunctualLight& light : desc_.lights) add_light(light);
        add_camera(camera);
        Json scene = {{"nodes", Json::array()}};
        for (std::size_t i = 0; i < json_["nodes"].size(); ++i) scene["nodes"].push_back(i);
        scene["extras"]["environment"] = environment();
        json_["scenes"] = Json::array({scene});
        if (!bytes_.empty()) {
            json_["buffers"] =
                Json::array({{{"byteLength", bytes_.size()},
                              {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}});
        }
        if (!extensions_.empty()) json_["extensionsUsed"] = extensions_;
        return json_.dump() + "\n";
    }

  private:
    void uses(const std::string& extension) {
        for (const Json& known : extensions_) {
            if (known == extension) return;
        }
        extensions_.push_back(extension);
    }
    void add_node(const Json& node) { json_["nodes"].push_back(node); }

    static Json extensions_of(const Material& m) {
        Json out = Json::object();
        if (m.is_emissive() && m.emissive_strength != 1)
            out["KHR_materials_emissive_strength"]["emissiveStrength"] = m.emissive_strength;
        if (m.specular_factor != 1)
            out["KHR_materials_specular"]["specularFactor"] = m.specular_factor;
        if (m.ior != 1.5f) out["KHR_materials_ior"]["ior"] = m.ior;
        if (m.transmission_factor > 0)
            out["KHR_materials_transmission"]["transmissionFactor"] = m.transmission_factor;
        if (m.thickness_factor > 0) {
            Json& volume = out["KHR_materials_volume"];
            volume = {{"thicknessFactor", m.thickness_factor},
                      {"attenuationColor", numbers(m.attenuation_color)}};
            if (m.attenuation_distance < kInfinity)
                volume["attenuationDistance"] = m.attenuation_distance;
        }
        if (m.scatters()) {
            out["KHR_materials_volume_scatter"] = {
                {"multiscatterColor", numbers(m.multiscatter_color)},
                {"scatterAnisotropy", m.scatter_anisotropy}};
        }
        return out;
    }

    void add_material(const Material& m) {
        Json out;
        const Vec4f& c = m.base_color_factor;
        Json& base = out["pbrMetallicRoughness"];
        base = {{"baseColorFactor", {c.x, c.y, c.z, c.w}},
                {"metallicFactor", m.metallic_factor},
                {"roughnessFactor", m.roughness_factor}};
        if (m.base_color_texture.used())
            base["baseColorTexture"]["index"] = m.base_color_texture.texture;
        if (m.normal_texture.used())
            out["normalTexture"] = {{"index", m.normal_texture.texture}, {"scale", m.normal_scale}};
        if (m.is_emissive()) out["emissiveFactor"] = numbers(m.emissive_factor);
        out["doubleSided"] = m.double_sided;
        if (m.alpha_mode == AlphaMode::blend) out["alphaMode"] = "BLEND";
        if (m.nested_priority != 0) out["extras"]["nestedPriority"] = m.nested_priority;
        const Json extensions = extensions_of(m);
        for (const auto& [name, value] : extensions.items()) uses(name);
        if (!extensions.empty()) out["extensions"] = extensions;
        json_["materials"].push_back(out);
    }

    void add_texture(const Texture& texture) {
        const Image8& image = *texture.image;
        const Result<std::string> url = png_data_url({image.width, image.height, 4, image.rgba});
        if (!url) throw std::runtime_error(url.error().line());
        json_["textures"].push_back({{"source", json_["images"].size()}});
        json_["images"].push_back({{"uri", *url}});
    }

    template <typename T>
    std::size_t add_accessor(const std::vector<T>& values, Json accessor) {
        const std::size_t size = values.size() * sizeof(T);  // a multiple of 4 for all that is here
        const std::size_t offset = bytes_.size();
        bytes_.resize(offset + size);
        std::memcpy(bytes_.data() + offset, values.data(), size);
        json_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
        accessor["bufferView"] = json_["bufferViews"].size() - 1;
        accessor["count"] = values.size();
        json_["accessors"].push_back(accessor);
        return json_["accessors"].size() - 1;
    }

    void add_mesh(const Mesh& mesh) {
        constexpr int kFloat = 5126;
        constexpr int kUnsignedInt = 5125;
        Vec3f lower(kInfinity);
        Vec3f upper(-kInfinity);
        for (const Vec3f& p : mesh.positions) {
            if (!is_finite(p)) continue;
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
        const Json vectors = {{"componentType", kFloat}, {"type", "VEC3"}};
        Json positions = vectors;
        positions["min"] = numbers(lower);
        positions["max"] = numbers(upper);
        Json primitive;
        Json& attributes = primitive["attributes"];
        attributes["POSITION"] = add_accessor(mesh.positions, positions);
        if (!mesh.normals.empty()) attributes["NORMAL"] = add_accessor(mesh.normals, vectors);
        if (!mesh.uv[0].empty()) {
            attributes["TEXCOORD_0"] =
                add_accessor(mesh.uv[0], {{"componentType", kFloat}, {"type", "VEC2"}});
        }
        primitive["indices"] =
            add_accessor(mesh.indices, {{"componentType", kUnsignedInt}, {"type", "SCALAR"}});
        primitive["material"] = mesh.material;
        json_["meshes"].push_back({{"primitives", Json::array({primitive})}});
    }

    void add_sphere(const Sphere& sphere) {
        uses("KHR_implicit_shapes");
        uses("TALBOT_implicit_surface");
        Json& shapes = json_["extensions"]["KHR_implicit_shapes"]["shapes"];
        shapes.push_back({{"type", "sphere"}, {"sphere", {{"radius", sphere.radius}}}});
        Json node = {{"translation", numbers(sphere.center)}};
        node["extensions"]["TALBOT_implicit_surface"] = {{"shape", shapes.size() - 1},
                                                         {"material", sphere.material}};
        add_node(node);
    }

    void add_light(const PunctualLight& light) {
        uses("KHR_lights_punctual");
        static constexpr const char* kTypes[] = {"point", "spot", "directional"};
        Json& lights = json_["extensions"]["KHR_lights_punctual"]["lights"];
        Json out = {{"type", kTypes[static_cast<int>(light.kind)]},
                    {"color", numbers(light.color)},
                    {"intensity", light.intensity}};
        if (light.kind == PunctualKind::spot) {
            out["spot"] = {{"innerConeAngle", light.inner_cone_angle},
                           {"outerConeAngle", light.outer_cone_angle}};
        }
        lights.push_back(out);
        // Light travels along -Z of the node.
        Camera frame;
        look_at(frame, light.position, light.position + Vec3d(light.direction));
        Json node = {{"matrix", numbers(frame_of(frame))}};
        node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
        add_node(node);
    }

    void add_camera(const Camera& camera) {
        // glTF asks for clip planes; Talbot has no use for them.
        constexpr double kFar = 1e9;
        Json out;
        if (camera.kind == CameraKind::perspective) {
            const double aspect = static_cast<double>(width_) / height_;
            out = {{"type", "perspective"},
                   {"perspective",
                    {{"yfov", camera.yfov}, {"aspectRatio", aspect}, {"znear", 1 / kFar}}}};
        } else {
            out = {{"type", "orthographic"},
                   {"orthographic",
                    {{"xmag", camera.xmag}, {"ymag", camera.ymag}, {"znear", 0}, {"zfar", kFar}}}};
        }
        out["extras"]["resolution"] = {width_, height_};
        json_["cameras"] = Json::array({out});
        add_node({{"camera", 0}, {"matrix", numbers(frame_of(camera))}});
    }

    Json environment() const {
        const Environment& e = desc_.environment;
        if (!e.gradient) return {{"color", numbers(e.color)}};
        return {{"gradient",
                 {{"axis", numbers(e.gradient->axis)},
                  {"from", numbers(e.gradient->from)},
                  {"to", numbers(e.gradient->to)}}}};
    }

    const SceneDesc& desc_;
    const uint32_t width_, height_;
    Json json_;
    Json extensions_ = Json::array();
    std::vector<uint8_t> bytes_;
};

}  // namespace

std::string gltf_text(const SceneDesc& desc, const Camera& camera, uint32_t width,
                      uint32_t height) {
    return Writer(desc, width, height).write(camera);
}

}  // namespace talbot::hardcases
