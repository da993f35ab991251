// Triangles of an index list, three to one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace talbot::gltf {

// Leaves those whose three vertices `keep` wants, in their order; returns how many went.
template <typename Keep>
std::size_t keep_triangles(std::vector<uint32_t>& indices, const Keep& keep) {
    std::size_t out = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        if (!keep(indices[i], indices[i + 1], indices[i + 2])) continue;
        std::copy_n(indices.begin() + static_cast<std::ptrdiff_t>(i), 3,
                    indices.begin() + static_cast<std::ptrdiff_t>(out));
        out += 3;
    }
    const std::size_t dropped = (indices.size() - out) / 3;
    indices.resize(out);
    return dropped;
}

}  // namespace talbot::gltf
