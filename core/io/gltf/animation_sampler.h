// One animation sampler at one time (glTF 2.0, section 3.11 and appendix C).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/io/gltf/accessor.h"

namespace talbot::gltf {

enum class Interpolation { step, linear, cubic_spline };

struct AnimationSampler {
    AccessorView times;   // scalars, rising
    AccessorView values;  // one element or more a key, three times as many for cubic_spline
    Interpolation interpolation = Interpolation::linear;
    bool is_rotation = false;  // interpolate as a unit quaternion

    // Floats of a value; empty when the counts of keys and values do not go together.
    std::optional<size_t> width() const;

    // The value at `seconds`; width() of them. Reads the two keys beside it and no more.
    std::vector<double> evaluate(double seconds) const;

    // Whether the value changes from one second to a later one.
    bool changes(double from, double to) const;
};

}  // namespace talbot::gltf
