// Meshes, rays and scenes for the tests and benchmarks of the ray engine: the shapes of the hard
// cases, and how much a test run may take.
#pragma once

#include <cstdint>
#include <cstdlib>

#include "app/hardcases/cases/mesh_shapes.h"

namespace talbot::test {

using namespace hardcases::geometry;

// Ray counts are multiplied by this; the long runs behind the ctest configuration `Full` set it.
inline uint64_t test_scale() {
    const char* text = std::getenv("TALBOT_TEST_SCALE");
    const long long scale = text == nullptr ? 1 : std::atoll(text);
    return scale < 1 ? 1 : static_cast<uint64_t>(scale);
}

// Rays whose closest hit a structure finds as its oracle does, and those that it does not.
struct HitComparison {
    const Accel& accel;
    const Accel& oracle;
    uint64_t hits = 0;
    uint64_t wrong = 0;

    // Whether the oracle has a hit, which `expected` gets.
    bool see(const Ray& ray, Hit& expected) {
        Hit hit;
        const bool expect = oracle.closest(ray, expected);
        wrong += accel.closest(ray, hit) != expect || (expect && !same_hit(hit, expected));
        hits += expect;
        return expect;
    }
};

}  // namespace talbot::test
