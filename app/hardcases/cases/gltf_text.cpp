// A scene in code as one glTF text with its buffers as data URIs.
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/hardcases/cases/case_scenes.h"
#include "core/math/robust.h"

namespace talbot::hardcases::geometry {
namespace {

using Json = nlohmann::ordered_json;

std::string base64(const std::vector<uint8_t>& bytes) {
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t v = 0;
        for (size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += i + k < bytes.size() + 1 ? digits[v >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

Json numbers(const Vec3f& v) {
    return {v.x, v.y, v.z};
}
Json numbers(const Mat4d& m) {
    Json list = Json::array();
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) list.push_back(m[c][r]);
    }
    return list;
}

class Writer {
  public:
    std::string write(const SceneDesc& desc, const Camera& camera, const RenderWith& with) {
        json_["asset"] = {{"version", "2.0"}, {"generator", "talbot hardcases"}};
        json_["scene"] = 0;
        json_["nodes"] = Json::array();
        for (const Material& material : desc.materials) add_material(material);
        for (const Mesh& mesh : desc.meshes) add_mesh(mesh);
        for (const MeshInstance& instance : desc.instances)
            add_node({{"mesh", instance.mesh}, {"matrix", numbers(instance.world_from_object)}});
        for (const Sphere& sphere : desc.spheres) add_sphere(sphere);
        for (const PunctualLight& light : desc.lights) add_light(light);
        add_camera(camera, with);
        Json scene = {{"nodes", Json::array()}};
        for (size_t i = 0; i < json_["nodes"].size(); ++i) scene["nodes"].push_back(i);
        scene["extras"]["environment"]["color"] = numbers(desc.environment.color);
        json_["scenes"] = Json::array({scene});
        if (!bytes_.empty()) {
            json_["buffers"] = Json::array(
                {{{"byteLength", bytes_.size()},
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

    void add_material(const Material& m) {
        Json out;
        const Vec4f& c = m.base_color_factor;
        out["pbrMetallicRoughness"] = {{"baseColorFactor", {c.x, c.y, c.z, c.w}},
                                       {"metallicFactor", m.metallic_factor},
                                       {"roughnessFactor", m.roughness_factor}};
        out["doubleSided"] = m.double_sided;
        if (m.alpha_mode == AlphaMode::blend) out["alphaMode"] = "BLEND";
        Json extensions = Json::object();
        if (m.is_emissive()) {
            out["emissiveFactor"] = numbers(m.emissive_factor);
            extensions["KHR_materials_emissive_strength"] = {
                {"emissiveStrength", m.emissive_strength}};
        }
        if (m.specular_factor != 1)
            extensions["KHR_materials_specular"] = {{"specularFactor", m.specular_factor}};
        if (m.ior != 1.5f) extensions["KHR_materials_ior"] = {{"ior", m.ior}};
        if (m.transmission_factor > 0) {
            extensions["KHR_materials_transmission"] = {
                {"transmissionFactor", m.transmission_factor}};
        }
        if (m.thickness_factor > 0) {
            Json volume = {{"thicknessFactor", m.thickness_factor},
                           {"attenuationColor", numbers(m.attenuation_color)}};
            if (m.attenuation_distance < kInfinity)
                volume["attenuationDistance"] = m.attenuation_distance;
            extensions["KHR_materials_volume"] = volume;
        }
        for (const auto& [name, value] : extensions.items()) uses(name);
        if (!extensions.empty()) out["extensions"] = extensions;
        json_["materials"].push_back(out);
    }

    size_t add_accessor(const void* data, size_t count, size_t bytes, const Json& what) {
        const size_t offset = bytes_.size();
        bytes_.resize(offset + (bytes + 3) / 4 * 4);
        std::memcpy(bytes_.data() + offset, data, bytes);
        json_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
        Json accessor = what;
        accessor["bufferView"] = json_["bufferViews"].size() - 1;
        accessor["count"] = count;
        json_["accessors"].push_back(accessor);
        return json_["accessors"].size() - 1;
    }
    size_t add_vectors(const std::vector<Vec3f>& list, bool with_bounds) {
        constexpr int kFloat = 5126;
        Json what = {{"componentType", kFloat}, {"type", "VEC3"}};
        if (with_bounds) {
            Vec3f lower(kInfinity);
            Vec3f upper(-kInfinity);
            for (const Vec3f& p : list) {
                if (!is_finite(p)) continue;
                lower = glm::min(lower, p);
                upper = glm::max(upper, p);
            }
            what["min"] = numbers(lower);
            what["max"] = numbers(upper);
        }
        return add_accessor(list.data(), list.size(), list.size() * sizeof(Vec3f), what);
    }

    void add_mesh(const Mesh& mesh) {
        constexpr int kUnsignedInt = 5125;
        Json primitive;
        primitive["attributes"]["POSITION"] = add_vectors(mesh.positions, true);
        if (!mesh.normals.empty())
            primitive["attributes"]["NORMAL"] = add_vectors(mesh.normals, false);
        primitive["indices"] = add_accessor(
            mesh.indices.data(), mesh.indices.size(), mesh.indices.size() * sizeof(uint32_t),
            {{"componentType", kUnsignedInt}, {"type", "SCALAR"}});
        primitive["material"] = mesh.material;
        json_["meshes"].push_back({{"primitives", Json::array({primitive})}});
    }

    void add_sphere(const Sphere& sphere) {
        uses("KHR_implicit_shapes");
        uses("TALBOT_implicit_surface");
        Json& shapes = json_["extensions"]["KHR_implicit_shapes"]["shapes"];
        shapes.push_back({{"type", "sphere"}, {"sphere", {{"radius", sphere.radius}}}});
        Json node;
        node["translation"] = {sphere.center.x, sphere.center.y, sphere.center.z};
        node["extensions"]["TALBOT_implicit_surface"] = {{"shape", shapes.size() - 1},
                                                         {"material", sphere.material}};
        add_node(node);
    }

    void add_light(const PunctualLight& light) {
        uses("KHR_lights_punctual");
        Json& lights = json_["extensions"]["KHR_lights_punctual"]["lights"];
        const bool sun = light.kind == PunctualKind::directional;
        lights.push_back({{"type", sun ? "directional" : "point"},
                          {"color", numbers(light.color)},
                          {"intensity", light.intensity}});
        // Light travels along -Z of the node.
        Camera frame;
        look_at(frame, light.position, light.position + Vec3d(light.direction));
        Json node = {{"matrix", numbers(frame_matrix(frame))}};
        node["extensions"]["KHR_lights_punctual"]["light"] = lights.size() - 1;
        add_node(node);
    }

    static Mat4d frame_matrix(const Camera& camera) {
        Mat4d m(1.0);
        m[0] = Vec4d(camera.right, 0);
        m[1] = Vec4d(camera.up, 0);
        m[2] = Vec4d(camera.backward, 0);
        m[3] = Vec4d(camera.position, 1);
        return m;
    }

    void add_camera(const Camera& camera, const RenderWith& with) {
        // glTF asks for clip planes; Talbot has no use for them.
        constexpr double kFar = 1e9;
        Json out;
        const double aspect = static_cast<double>(with.width) / with.height;
        if (camera.kind == CameraKind::perspective) {
            out = {{"type", "perspective"},
                   {"perspective",
                    {{"yfov", camera.yfov}, {"aspectRatio", aspect}, {"znear", 1 / kFar}}}};
        } else {
            out = {{"type", "orthographic"},
                   {"orthographic",
                    {{"xmag", camera.xmag},
                     {"ymag", camera.ymag},
                     {"znear", 0},
                     {"zfar", kFar}}}};
        }
        out["extras"]["resolution"] = {with.width, with.height};
        json_["cameras"] = Json::array({out});
        add_node({{"camera", 0}, {"matrix", numbers(frame_matrix(camera))}});
    }

    Json json_;
    Json extensions_ = Json::array();
    std::vector<uint8_t> bytes_;
};

}  // namespace

std::string gltf_text(const SceneDesc& desc, const Camera& camera, const RenderWith& with) {
    return Writer().write(desc, camera, with);
}

}  // namespace talbot::hardcases::geometry
