#include "core/io/gltf/value_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

namespace talbot::gltf {

namespace {

using Json = nlohmann::json;

// Numbers of the elements of an array at `array`, both as words with slashes; 0 numbers are an
// object. Extras may be anything, their members may not.
struct NumberMember {
    std::string_view array, member;
    size_t count;
};

constexpr std::string_view kLights = "extensions/KHR_lights_punctual/lights";

constexpr auto kNumbers = std::to_array<NumberMember>({
    {"nodes", "translation", 3},
    {"nodes", "rotation", 4},
    {"nodes", "scale", 3},
    {"nodes", "matrix", 16},
    {"nodes", "extensions/EXT_mesh_gpu_instancing/attributes", 0},
    {"cameras", "perspective/yfov", 1},
    {"cameras", "perspective/aspectRatio", 1},
    {"cameras", "orthographic/xmag", 1},
    {"cameras", "orthographic/ymag", 1},
    {"cameras", "extras/resolution", 2},
    {"cameras", "extras/lens/apertureRadius", 1},
    {"cameras", "extras/lens/focusDistance", 1},
    {"cameras", "extras/lensShift", 2},
    {"materials", "extras/nestedPriority", 1},
    {"materials", "alphaCutoff", 1},
    {"materials", "emissiveFactor", 3},
    {"materials", "normalTexture/scale", 1},
    {"materials", "pbrMetallicRoughness/baseColorFactor", 4},
    {"materials", "pbrMetallicRoughness/metallicFactor", 1},
    {"materials", "pbrMetallicRoughness/roughnessFactor", 1},
    {"materials", "extensions/KHR_materials_anisotropy/anisotropyStrength", 1},
    {"materials", "extensions/KHR_materials_anisotropy/anisotropyRotation", 1},
    {"materials", "extensions/KHR_materials_clearcoat/clearcoatFactor", 1},
    {"materials", "extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", 1},
    {"materials", "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", 1},
    {"materials", "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor",
     3},
    {"materials", "extensions/KHR_materials_dispersion/dispersion", 1},
    {"materials", "extensions/KHR_materials_emissive_strength/emissiveStrength", 1},
    {"materials", "extensions/KHR_materials_ior/ior", 1},
    {"materials", "extensions/KHR_materials_iridescence/iridescenceFactor", 1},
    {"materials", "extensions/KHR_materials_iridescence/iridescenceIor", 1},
    {"materials", "extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", 1},
    {"materials", "extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", 1},
    {"materials", "extensions/KHR_materials_pbrSpecularGlossiness/diffuseFactor", 4},
    {"materials", "extensions/KHR_materials_pbrSpecularGlossiness/specularFactor", 3},
    {"materials", "extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor", 1},
    {"materials", "extensions/KHR_materials_sheen/sheenColorFactor", 3},
    {"materials", "extensions/KHR_materials_sheen/sheenRoughnessFactor", 1},
    {"materials", "extensions/KHR_materials_specular/specularFactor", 1},
    {"materials", "extensions/KHR_materials_specular/specularColorFactor", 3},
    {"materials", "extensions/KHR_materials_transmission/transmissionFactor", 1},
    {"materials", "extensions/KHR_materials_volume/thicknessFactor", 1},
    {"materials", "extensions/KHR_materials_volume/attenuationDistance", 1},
    {"materials", "extensions/KHR_materials_volume/attenuationColor", 3},
    {kLights, "color", 3},
    {kLights, "intensity", 1},
    {kLights, "range", 1},
    {kLights, "extras/angularDiameter", 1},
    {kLights, "spot/innerConeAngle", 1},
    {kLights, "spot/outerConeAngle", 1},
    {"extensions/KHR_implicit_shapes/shapes", "sphere/radius", 1},
    {"scenes", "extras/environment/color", 3},
});

constexpr size_t kMostWarnings = 20;

// By how much the length of a rotation may differ from 1 without a word.
constexpr double kUnitLengthSlack = 0.01;

std::string rounded(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

std::string listed(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ", ") + rounded(value);
    return text;
}

// Empty for a unit quaternion.
std::string wrong_rotation(const std::vector<double>& q) {
    const double size = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    if (!(size > 0)) return "is 0, 0, 0, 0, which is no rotation; none is made";
    if (!(std::abs(size - 1) > kUnitLengthSlack)) return "";
    return "has length " + rounded(size) + " instead of 1; it is taken at length 1";
}

// Empty for an affine matrix.
std::string wrong_matrix(const std::vector<double>& m) {
    const std::vector<double> last{m[3], m[7], m[11], m[15]};
    if (last == std::vector<double>{0, 0, 0, 1}) return "";
    const bool by_rows = m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1;
    return "has the last row " + listed(last) + " instead of 0, 0, 0, 1, which is taken" +
           (by_rows ? "; is it written by rows? It must be by columns" : "");
}

class ValueCheck {
  public:
    ValueCheck(const Json& root, std::vector<std::string>& warnings)
        : root_(root), warnings_(warnings) {}

    void run() {
        for (const NumberMember& wanted : kNumbers) check(wanted);
        check_transforms();
        if (left_out_ > 0) {
            warnings_.push_back("values of the wrong kind: " + std::to_string(left_out_) +
                                " more are not listed");
        }
    }

  private:
    // The array, or null where there is none.
    const Json* array_at(std::string_view path) const {
        std::string words(1, '/');
        words += path;
        const Json::json_pointer where(words);
        if (!root_.contains(where)) return nullptr;
        const Json& found = root_[where];
        return found.is_array() ? &found : nullptr;
    }

    static std::string dotted(std::string_view path) {
        std::string text(path);
        std::replace(text.begin(), text.end(), '/', '.');
        return text;
    }

    void check(const NumberMember& wanted) {
        const Json* array = array_at(wanted.array);
        if (!array) return;
        for (size_t i = 0; i < array->size(); ++i) check_element((*array)[i], wanted, i);
    }

    void check_element(const Json& element, const NumberMember& wanted, size_t index) {
        const Json* value = &element;
        // Of the path, with the slash behind: what leads to `value`.
        size_t taken = 0;
        const auto wrong = [&](const std::string& what) {
            std::string name = dotted(wanted.array) + "[" + std::to_string(index) + "]";
            if (taken > 0) name += "." + dotted(wanted.member.substr(0, taken - 1));
            note(name, what);
        };
        while (taken <= wanted.member.size()) {
            if (!value->is_object()) {
                if (!is_extras(wanted.member.substr(0, taken))) wrong("is not an object");
                return;
            }
            const size_t slash = std::min(wanted.member.find('/', taken), wanted.member.size());
            const auto found = value->find(std::string(wanted.member.substr(taken, slash - taken)));
            if (found == value->end()) return;
            value = &*found;
            taken = slash + 1;
        }
        if (wanted.count == 0 && !value->is_object()) return wrong("is not an object");
        if (wanted.count == 1 && !value->is_number()) return wrong("is not a number");
        if (wanted.count > 1 && !is_numbers(*value, wanted.count))
            wrong("is not " + std::to_string(wanted.count) + " numbers");
    }

    // Of a path with the slash behind.
    static bool is_extras(std::string_view path) { return path == "extras/"; }

    void check_transforms() {
        const Json* nodes = array_at("nodes");
        for (size_t i = 0; nodes && i < nodes->size(); ++i) {
            check_transform((*nodes)[i], i, "rotation", 4, wrong_rotation);
            check_transform((*nodes)[i], i, "matrix", 16, wrong_matrix);
        }
    }

    void check_transform(const Json& node, size_t index, const char* key, size_t count,
                         std::string (*problem)(const std::vector<double>&)) {
        const auto found = node.find(key);
        if (found == node.end() || !is_numbers(*found, count)) return;
        const std::string what = problem(found->get<std::vector<double>>());
        if (!what.empty()) note("nodes[" + std::to_string(index) + "]." + key, what, "");
    }

    static bool is_numbers(const Json& value, size_t count) {
        return value.is_array() && value.size() == count &&
               std::all_of(value.begin(), value.end(), [](const Json& n) { return n.is_number(); });
    }

    // Several members may lead through the same wrong value.
    void note(const std::string& element, const std::string& what,
              const char* then = "; the default is used") {
        if (std::find(noted_.begin(), noted_.end(), element) != noted_.end()) return;
        if (noted_.size() == kMostWarnings) {
            ++left_out_;
            return;
        }
        noted_.push_back(element);
        warnings_.push_back(element + ": " + what + then);
    }

    const Json& root_;
    std::vector<std::string>& warnings_;
    std::vector<std::string> noted_;
    size_t left_out_ = 0;
};

}  // namespace

void note_wrong_values(const nlohmann::json& root, std::vector<std::string>& warnings) {
    ValueCheck(root, warnings).run();
}

}  // namespace talbot::gltf
