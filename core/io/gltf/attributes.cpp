// Attributes by name, with the checks that all of them share.
#include "core/io/gltf/attributes.h"

namespace talbot::gltf {

Status AttributeSource::decompress(MemoryBudget& budget, uint64_t max_bytes) {
    if (!is_draco(primitive_)) return Done{};
    Result<DracoMesh> draco = decode_draco(document_, primitive_, element_, budget, max_bytes);
    if (!draco) return draco.error();
    draco_ = std::move(draco.value());
    return Done{};
}

bool AttributeSource::has(const std::string& name) const {
    return primitive_.attributes.contains(name);
}

Result<AccessorView> AttributeSource::open(const std::string& name) const {
    if (draco_) {
        const auto found = draco_->attributes.find(name);
        if (found != draco_->attributes.end()) return found->second.view;
    }
    return open_accessor(document_, primitive_.attributes.at(name));
}

Result<AccessorView> AttributeSource::checked(const Result<AccessorView>& view,
                                              const std::string& name, size_t count,
                                              size_t width_min, size_t width_max) const {
    if (!view) return view.error();
    if (view->count != count) {
        return fail("attribute " + name + " has " + std::to_string(view->count) +
                    " elements, POSITION has " + std::to_string(count));
    }
    if (view->components < width_min || view->components > width_max)
        return fail("attribute " + name + " has the wrong type");
    return *view;
}

Result<AccessorView> AttributeSource::open(const std::string& name, size_t count, size_t width_min,
                                           size_t width_max) const {
    return checked(open(name), name, count, width_min, width_max);
}

Result<AccessorView> AttributeSource::open_target(size_t target, const std::string& name,
                                                  size_t count, size_t width) const {
    const int accessor = primitive_.targets[target].at(name);
    return checked(open_accessor(document_, accessor),
                   "targets[" + std::to_string(target) + "]." + name, count, width, width);
}

}  // namespace talbot::gltf
