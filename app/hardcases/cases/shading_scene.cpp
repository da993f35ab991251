#include "app/hardcases/cases/shading_scene.h"

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <span>

namespace talbot::hardcases {
namespace {

std::string base64(std::span<const uint8_t> bytes) {
    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = (group << 8) | (k < left ? uint32_t{bytes[i + k]} : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= left ? kDigits[(group >> (18 - 6 * k)) & 63] : '=';
    }
    return text;
}

void put_big_endian(std::vector<uint8_t>& out, uint32_t x) {
    for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(x >> shift));
}

uint32_t crc32(std::span<const uint8_t> bytes) {
    uint32_t crc = 0xFFFFFFFFu;
    for (const uint8_t byte : bytes) {
        crc ^= byte;
        for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
    }
    return ~crc;
}

void put_chunk(std::vector<uint8_t>& png, const char* type, const std::vector<uint8_t>& data) {
    put_big_endian(png, static_cast<uint32_t>(data.size()));
    std::vector<uint8_t> body(type, type + 4);
    body.insert(body.end(), data.begin(), data.end());
    png.insert(png.end(), body.begin(), body.end());
    put_big_endian(png, crc32(body));
}

// Stored, not compressed: rows of at most 65535 bytes, one block each.
std::vector<uint8_t> png_of(const Image8& image) {
    std::vector<uint8_t> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    std::vector<uint8_t> header;
    put_big_endian(header, image.width);
    put_big_endian(header, image.height);
    header.insert(header.end(), {8, 6, 0, 0, 0});
    put_chunk(png, "IHDR", header);
    std::vector<uint8_t> data{0x78, 0x01};
    uint32_t a = 1;
    uint32_t b = 0;
    const std::size_t row = std::size_t{4} * image.width;
    for (uint32_t y = 0; y < image.height; ++y) {
        const auto length = static_cast<uint16_t>(row + 1);
        data.push_back(y + 1 == image.height ? 1 : 0);
        for (const uint16_t x : {length, static_cast<uint16_t>(~length)}) {
            data.push_back(static_cast<uint8_t>(x & 0xFF));
            data.push_back(static_cast<uint8_t>(x >> 8));
        }
        const auto put = [&](uint8_t byte) {
            data.push_back(byte);
            a = (a + byte) % 65521;
            b = (b + a) % 65521;
        };
        put(0);  // no filter
        for (std::size_t i = 0; i < row; ++i) put(image.rgba[y * row + i]);
    }
    put_big_endian(data, (b << 16) | a);
    put_chunk(png, "IDAT", data);
    put_chunk(png, "IEND", {});
    return png;
}

std::string number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", x);
    return text;
}
std::string list(std::initializer_list<double> values) {
    std::string text = "[";
    for (const double x : values) text += (text.size() > 1 ? "," : "") + number(x);
    return text + "]";
}
std::string list(const Vec3d& v) {
    return list({v.x, v.y, v.z});
}
std::string list(const Vec3f& v) {
    return list(Vec3d(v));
}

// A comma between the parts of an array or object.
class Joined {
  public:
    void add(const std::string& part) { text_ += (text_.empty() ? "" : ",\n") + part; }
    const std::string& text() const { return text_; }
    bool empty() const { return text_.empty(); }

  private:
    std::string text_;
};

class Writer {
  public:
    Writer(const SceneDesc& desc, const Camera& camera, uint32_t side_px)
        : desc_(desc), camera_(camera), side_px_(side_px) {}

    std::string text() {
        for (const Material& m : desc_.materials) materials_.add(material(m));
        for (const Texture& t : desc_.textures) {
            const std::string at = std::to_string(textures_count_++);
            images_.add("{\"uri\":\"data:image/png;base64," + base64(png_of(*t.image)) + "\"}");
            textures_.add("{\"source\":" + at + "}");
        }
        for (const Mesh& m : desc_.meshes) meshes_.add(mesh(m));
        for (const MeshInstance& instance : desc_.instances) add_instance(instance);
        for (const Sphere& sphere : desc_.spheres) add_sphere(sphere);
        for (const PunctualLight& light : desc_.lights) add_light(light);
        add_camera();
        return join();
    }

  private:
    template <typename T>
    std::size_t accessor(const std::vector<T>& values, const char* type, int component,
                         const std::string& bounds = "") {
        const std::size_t size = values.size() * sizeof(T);
        const std::size_t at = buffer_.size();
        buffer_.resize(at + size);
        std::memcpy(buffer_.data() + at, values.data(), size);
        views_.add("{\"buffer\":0,\"byteOffset\":" + std::to_string(at) +
                   ",\"byteLength\":" + std::to_string(size) + "}");
        accessors_.add("{\"bufferView\":" + std::to_string(accessor_count_) +
                       ",\"componentType\":" + std::to_string(component) + ",\"count\":" +
                       std::to_string(values.size()) + ",\"type\":\"" + type + "\"" + bounds + "}");
        return accessor_count_++;
    }

    std::string mesh(const Mesh& m) {
        constexpr int kFloat = 5126;
        constexpr int kUnsigned = 5125;
        Vec3f lower = m.positions[0];
        Vec3f upper = lower;
        for (const Vec3f& p : m.positions) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
        std::string text =
            "{\"primitives\":[{\"attributes\":{\"POSITION\":" +
            std::to_string(accessor(m.positions, "VEC3", kFloat,
                                    ",\"min\":" + list(lower) + ",\"max\":" + list(upper)));
        if (!m.normals.empty())
            text += ",\"NORMAL\":" + std::to_string(accessor(m.normals, "VEC3", kFloat));
        if (!m.uv[0].empty())
            text += ",\"TEXCOORD_0\":" + std::to_string(accessor(m.uv[0], "VEC2", kFloat));
        return text + "},\"indices\":" + std::to_string(accessor(m.indices, "SCALAR", kUnsigned)) +
               ",\"material\":" + std::to_string(m.material) + "}]}";
    }

    void use(const std::string& extension) {
        const std::string quoted = "\"" + extension + "\"";
        if (used_.text().find(quoted) == std::string::npos) used_.add(quoted);
    }

    std::string texture(const TextureSlot& slot, const std::string& name) const {
        return slot.used() ? ",\"" + name + "\":{\"index\":" + std::to_string(slot.texture) + "}"
                           : "";
    }

    std::string material(const Material& m) {
        Joined extensions;
        const auto extend = [&](const std::string& name, const std::string& body) {
            use(name);
            extensions.add("\"" + name + "\":{" + body + "}");
        };
        if (m.ior != 1.5f) extend("KHR_materials_ior", "\"ior\":" + number(double{m.ior}));
        if (m.specular_factor != 1)
            extend("KHR_materials_specular",
                   "\"specularFactor\":" + number(double{m.specular_factor}));
        if (m.emissive_strength != 1)
            extend("KHR_materials_emissive_strength",
                   "\"emissiveStrength\":" + number(double{m.emissive_strength}));
        if (m.transmission_factor > 0)
            extend("KHR_materials_transmission",
                   "\"transmissionFactor\":" + number(double{m.transmission_factor}));
        if (m.thickness_factor > 0) {
            std::string body = "\"thicknessFactor\":" + number(double{m.thickness_factor});
            if (std::isfinite(m.attenuation_distance))
                body += ",\"attenuationDistance\":" + number(double{m.attenuation_distance}) +
                        ",\"attenuationColor\":" + list(m.attenuation_color);
            extend("KHR_materials_volume", body);
        }
        if (m.scatters())
            extend("KHR_materials_volume_scatter",
                   "\"multiscatterColor\":" + list(m.multiscatter_color) +
                       ",\"scatterAnisotropy\":" + number(double{m.scatter_anisotropy}));
        const Vec4f& c = m.base_color_factor;
        std::string text = "{\"pbrMetallicRoughness\":{\"baseColorFactor\":" +
                           list({double{c.x}, double{c.y}, double{c.z}, double{c.w}}) +
                           ",\"metallicFactor\":" + number(double{m.metallic_factor}) +
                           ",\"roughnessFactor\":" + number(double{m.roughness_factor}) +
                           texture(m.base_color_texture, "baseColorTexture") + "}" +
                           texture(m.normal_texture, "normalTexture");
        if (m.is_emissive()) text += ",\"emissiveFactor\":" + list(m.emissive_factor);
        if (m.double_sided) text += ",\"doubleSided\":true";
        if (!extensions.empty()) text += ",\"extensions\":{" + extensions.text() + "}";
        if (m.nested_priority != 0)
            text += ",\"extras\":{\"nestedPriority\":" + number(double{m.nested_priority}) + "}";
        return text + "}";
    }

    void add_node(const std::string& body) {
        nodes_.add("{" + body + "}");
        roots_.add(std::to_string(node_count_++));
    }

    void add_instance(const MeshInstance& instance) {
        std::string matrix;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                matrix +=
                    (matrix.empty() ? "" : ",") + number(instance.world_from_object[column][row]);
        add_node("\"mesh\":" + std::to_string(instance.mesh) + ",\"matrix\":[" + matrix + "]");
    }

    void add_sphere(const Sphere& sphere) {
        use("KHR_implicit_shapes");
        use("TALBOT_implicit_surface");
        shapes_.add("{\"type\":\"sphere\",\"sphere\":{\"radius\":" + number(sphere.radius) + "}}");
        add_node("\"translation\":" + list(sphere.center) +
                 ",\"extensions\":{\"TALBOT_implicit_surface\":{\"shape\":" +
                 std::to_string(shape_count_++) +
                 ",\"material\":" + std::to_string(sphere.material) + "}}");
    }

    // A rotation whose -z is the direction.
    static std::string rotation_towards(const Vec3d& d) {
        const Vec3d axis = cross(Vec3d(0, 0, -1), d);
        const double w = 1 - d.z;  // 1 + cos of the turn
        if (!(w > 0)) return list({0.0, 1.0, 0.0, 0.0});
        const double scale = 1 / std::sqrt(dot(axis, axis) + w * w);
        return list({axis.x * scale, axis.y * scale, axis.z * scale, w * scale});
    }

    void add_light(const PunctualLight& light) {
        use("KHR_lights_punctual");
        static constexpr const char* kTypes[] = {"point", "spot", "directional"};
        std::string text = "{\"type\":\"" + std::string(kTypes[static_cast<int>(light.kind)]) +
                           "\",\"intensity\":" + number(double{light.intensity}) +
                           ",\"color\":" + list(light.color);
        if (light.kind == PunctualKind::spot)
            text += ",\"spot\":{\"innerConeAngle\":" + number(double{light.inner_cone_angle}) +
                    ",\"outerConeAngle\":" + number(double{light.outer_cone_angle}) + "}";
        lights_.add(text + "}");
        add_node("\"translation\":" + list(light.position) +
                 ",\"rotation\":" + rotation_towards(Vec3d(light.direction)) +
                 ",\"extensions\":{\"KHR_lights_punctual\":{\"light\":" +
                 std::to_string(light_count_++) + "}}");
    }

    void add_camera() {
        const Vec3d& x = camera_.right;
        const Vec3d& y = camera_.up;
        const Vec3d& z = camera_.backward;
        const Vec3d& p = camera_.position;
        add_node("\"camera\":0,\"matrix\":" +
                 list({x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, p.x, p.y, p.z, 1}));
    }

    std::string environment() const {
        const Environment& e = desc_.environment;
        if (e.gradient) {
            return "{\"gradient\":{\"axis\":" + list(e.gradient->axis) +
                   ",\"from\":" + list(e.gradient->from) + ",\"to\":" + list(e.gradient->to) + "}}";
        }
        return "{\"color\":" + list(e.color) + "}";
    }

    std::string join() const {
        std::string text = "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Talbot hardcases\"}";
        const auto part = [&](const char* name, const Joined& items) {
            if (!items.empty()) text += ",\n\"" + std::string(name) + "\":[" + items.text() + "]";
        };
        part("extensionsUsed", used_);
        Joined extensions;
        if (!shapes_.empty())
            extensions.add("\"KHR_implicit_shapes\":{\"shapes\":[" + shapes_.text() + "]}");
        if (!lights_.empty())
            extensions.add("\"KHR_lights_punctual\":{\"lights\":[" + lights_.text() + "]}");
        if (!extensions.empty()) text += ",\n\"extensions\":{" + extensions.text() + "}";
        part("materials", materials_);
        part("images", images_);
        part("textures", textures_);
        part("meshes", meshes_);
        part("accessors", accessors_);
        part("bufferViews", views_);
        if (!buffer_.empty())
            text += ",\n\"buffers\":[{\"byteLength\":" + std::to_string(buffer_.size()) +
                    ",\"uri\":\"data:application/octet-stream;base64," + base64(buffer_) + "\"}]";
        part("nodes", nodes_);
        text += ",\n\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":" +
                number(camera_.yfov) + ",\"znear\":0.01},\"extras\":{\"resolution\":[" +
                std::to_string(side_px_) + "," + std::to_string(side_px_) + "]}}]";
        text += ",\n\"scenes\":[{\"nodes\":[" + roots_.text() +
                "],\"extras\":{\"environment\":" + environment() + "}}],\"scene\":0}\n";
        return text;
    }

    const SceneDesc& desc_;
    const Camera& camera_;
    const uint32_t side_px_;
    std::vector<uint8_t> buffer_;
    Joined used_, materials_, images_, textures_, meshes_, accessors_, views_, nodes_, roots_;
    Joined shapes_, lights_;
    std::size_t accessor_count_ = 0, node_count_ = 0, shape_count_ = 0, light_count_ = 0;
    std::size_t textures_count_ = 0;
};

}  // namespace

std::string gltf_text(const SceneBuilder& builder, const Camera& camera, uint32_t side_px) {
    return Writer(builder.desc(), camera, side_px).text();
}

}  // namespace talbot::hardcases
