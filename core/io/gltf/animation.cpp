// Channels to JSON pointers to values.
#include "core/io/gltf/animation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "core/io/gltf/animation_sampler.h"

namespace talbot::gltf {

namespace {

using Json = nlohmann::json;

// Where a pointer may lead: what these hold is read after the animations.
constexpr auto kDrivable = std::to_array<std::string_view>(
    {"/nodes/", "/materials/", "/cameras/", "/meshes/", "/extensions/KHR_lights_punctual/lights/"});

// Walks the channels of all animations.
class AnimationReader {
  public:
    AnimationReader(const Document& document, const Json& root)
        : document_(document), root_(root) {}

    // Calls f(animation's name, pointer, sampler, element) for each property that is driven, with
    // the channel that drives it, until an error.
    template <typename F>
    Status visit(const F& f) {
        const auto animations = root_.find("animations");
        for (size_t a = 0; animations != root_.end() && a < animations->size(); ++a) {
            const Json& animation = (*animations)[a];
            const auto channels = animation.find("channels");
            for (size_t c = 0; channels != animation.end() && c < channels->size(); ++c) {
                const std::string element =
                    element_name("animations", a) + ".channels[" + std::to_string(c) + "]";
                const Json& channel = (*channels)[c];
                const std::string pointer = pointer_of(channel);
                if (pointer.empty() || !takes(pointer, a)) continue;
                const Result<AnimationSampler> sampler =
                    sampler_of(animation, channel, pointer, element);
                if (!sampler) return sampler.error();
                f(text(animation, "name"), pointer, *sampler, element);
            }
        }
        return Done{};
    }

    // Channels that drive what an earlier animation drives.
    size_t overruled() const { return overruled_; }

  private:
    // The property that a channel drives; empty when there is none. (tinygltf leaves out channels
    // without a node.)
    static std::string pointer_of(const Json& channel) {
        const Json& target = channel["target"];
        const std::string path = text(target, "path");
        if (path != "pointer") {
            if (path.empty() || !target.contains("node")) return "";
            return "/nodes/" + target["node"].dump() + "/" + path;
        }
        const Json::json_pointer where("/extensions/KHR_animation_pointer/pointer");
        return target.contains(where) && target[where].is_string()
                   ? target[where].get<std::string>()
                   : "";
    }

    static std::string text(const Json& object, const char* key) {
        const auto found = object.find(key);
        return found != object.end() && found->is_string() ? found->get<std::string>() : "";
    }

    // Whether animation `index` is the one that drives it.
    bool takes(const std::string& pointer, size_t index) {
        const auto [owner, is_new] = owners_.emplace(pointer, index);
        if (!is_new && owner->second != index) ++overruled_;
        return is_new;
    }

    Result<AnimationSampler> sampler_of(const Json& animation, const Json& channel,
                                        const std::string& pointer,
                                        const std::string& element) const {
        const auto samplers = animation.find("samplers");
        const size_t count = samplers == animation.end() ? 0 : samplers->size();
        const auto sampler_index = channel["sampler"].get<uint64_t>();
        if (sampler_index >= count) {
            return document_.error(element + ".sampler", std::to_string(sampler_index) +
                                                             " is out of range: there are " +
                                                             std::to_string(count) + " samplers");
        }
        const bool is_node_rotation =
            pointer.starts_with("/nodes/") && pointer.ends_with("/rotation");
        Result<AnimationSampler> sampler =
            open_sampler((*samplers)[sampler_index], is_node_rotation, element);
        if (sampler && is_node_rotation && sampler->width() != size_t{4})
            return document_.error(element, "drives a rotation with values that are no VEC4");
        return sampler;
    }

    Result<AnimationSampler> open_sampler(const Json& in, bool is_rotation,
                                          const std::string& element) const {
        const Result<AccessorView> times = open_accessor(document_, in["input"].get<int>());
        if (!times) return times.error();
        const Result<AccessorView> values = open_accessor(document_, in["output"].get<int>());
        if (!values) return values.error();
        AnimationSampler sampler{*times, *values, Interpolation::linear, is_rotation};
        const std::string interpolation = text(in, "interpolation");
        if (interpolation == "STEP") sampler.interpolation = Interpolation::step;
        if (interpolation == "CUBICSPLINE") sampler.interpolation = Interpolation::cubic_spline;
        if (times->components != 1)
            return document_.error(element, "its sampler's input is not of scalars");
        constexpr size_t kMaxWidth = 1 << 16;
        const std::optional<size_t> width = sampler.width();
        if (!width || *width > kMaxWidth) {
            return document_.error(element, "its sampler has " + std::to_string(times->count) +
                                                " keys, but " + std::to_string(values->count) +
                                                " values");
        }
        return sampler;
    }

    const Document& document_;
    const Json& root_;
    std::map<std::string, size_t> owners_;  // which animation drives a property
    size_t overruled_ = 0;
};

bool is_drivable(const std::string& pointer) {
    return std::any_of(kDrivable.begin(), kDrivable.end(),
                       [&](std::string_view start) { return pointer.starts_with(start); });
}

// Puts values where pointers lead.
class PropertySetter {
  public:
    PropertySetter(Json& root, std::vector<std::string>& warnings)
        : root_(root), warnings_(warnings) {}

    void set(const std::string& pointer, const std::vector<double>& values,
             const std::string& element) {
        if (!is_drivable(pointer)) return warn(element, pointer, "is not supported");
        if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
            return warn(element, pointer, "gets a value that is not finite");
        Json* parent = nullptr;
        const std::string name = pointer.substr(pointer.rfind('/') + 1);
        try {
            const Json::json_pointer path(pointer);
            if (!root_.contains(path.parent_pointer()))
                return warn(element, pointer, "does not exist");
            parent = &root_[path.parent_pointer()];
        } catch (const Json::exception&) {
            return warn(element, pointer, "is no JSON pointer");
        }
        if (!parent->is_object()) return set_element(*parent, name, values, pointer, element);
        const auto found = parent->find(name);
        const bool was_number = found != parent->end() && found->is_number();
        const bool was_array = found != parent->end() && found->is_array();
        const bool was_bool = found != parent->end() && found->is_boolean();
        if (found != parent->end() && !was_number && !was_array && !was_bool)
            return warn(element, pointer, "is neither number nor truth value nor array");
        if ((was_number || was_bool) && values.size() != 1)
            return warn(element, pointer, "is one number, its values have more");
        if (was_array && name != "weights" && found->size() != values.size())
            return warn(element, pointer, "has another number of components");
        if (was_bool || name == "visible") {
            (*parent)[name] = values[0] != 0;
        } else if (was_array || values.size() > 1 || name == "weights") {
            (*parent)[name] = values;
        } else {
            (*parent)[name] = values[0];
        }
    }

  private:
    void warn(const std::string& element, const std::string& pointer, const std::string& why) {
        warnings_.push_back(element + ": its target '" + pointer.substr(0, 100) + "' " + why +
                            "; it keeps its value");
    }

    // One weight of an array of them.
    void set_element(Json& parent, const std::string& name, const std::vector<double>& values,
                     const std::string& pointer, const std::string& element) {
        const bool is_index =
            !name.empty() && name.size() < 9 &&
            std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
        const size_t index = is_index ? std::stoul(name) : 0;
        if (!parent.is_array() || !is_index || index >= parent.size() || values.size() != 1 ||
            !parent[index].is_number())
            return warn(element, pointer, "does not exist");
        parent[index] = values[0];
    }

    Json& root_;
    std::vector<std::string>& warnings_;
};

}  // namespace

Status apply_animations(const Document& document, double seconds, Json& root,
                        std::vector<std::string>& warnings) {
    AnimationReader reader(document, *document.source);
    PropertySetter setter(root, warnings);
    const Status done =
        reader.visit([&](const std::string&, const std::string& pointer,
                         const AnimationSampler& sampler, const std::string& element) {
            setter.set(pointer, sampler.evaluate(seconds), element);
        });
    if (done && reader.overruled() > 0) {
        warnings.push_back(std::to_string(reader.overruled()) +
                           " animation channels drive what an earlier animation drives "
                           "already; they are ignored");
    }
    return done;
}

Result<std::string> moving_property(const Document& document, double from, double to) {
    std::string moving;
    if (!document.source) return moving;
    AnimationReader reader(document, *document.source);
    const Status done = reader.visit([&](const std::string& name, const std::string& pointer,
                                         const AnimationSampler& sampler, const std::string&) {
        if (moving.empty() && is_drivable(pointer) && sampler.changes(from, to))
            moving = "animation '" + name + "' drives " + pointer;
    });
    if (!done) return done.error();
    return moving;
}

double animation_seconds(const Document& document, size_t index) {
    double last = 0;
    for (const tinygltf::AnimationSampler& sampler : document.model.animations[index].samplers) {
        const Result<AccessorView> times = open_accessor(document, sampler.input);
        if (!times || times->components != 1) continue;
        float seconds = 0;
        read_floats(*times, times->count - 1, 1, 1, &seconds);
        if (std::isfinite(seconds)) last = std::max(last, double{seconds});
    }
    return last;
}

}  // namespace talbot::gltf
