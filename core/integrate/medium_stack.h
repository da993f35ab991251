// Which volumes a path is inside of. Where they overlap, the one of highest priority fills the
// space, of equals the one entered last; the boundaries of the others are no surfaces there
// (Schmidt and Budge 2002, "Simple nested dielectrics in ray traced images").
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/scene/material.h"

namespace talbot {

inline constexpr uint32_t kVacuum = 0xFFFFFFFFu;

class MediumStack {
  public:
    // More volumes than this, one in the other, are not told apart: the innermost are not noted.
    static constexpr uint32_t kCapacity = 6;

    // The material that fills the space; kVacuum outside of all.
    uint32_t top(std::span<const Material> materials) const {
        uint32_t best = kVacuum;
        for (uint32_t i = 0; i < count_; ++i) {
            if (best == kVacuum ||
                materials[inside_[i]].nested_priority >= materials[best].nested_priority)
                best = inside_[i];
        }
        return best;
    }

    void enter(uint32_t material) {
        leave(material);
        if (count_ < kCapacity) inside_[count_++] = material;
    }
    void leave(uint32_t material) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < count_; ++i) {
            if (inside_[i] != material) inside_[kept++] = inside_[i];
        }
        count_ = kept;
    }

    bool contains(uint32_t material) const {
        for (uint32_t i = 0; i < count_; ++i) {
            if (inside_[i] == material) return true;
        }
        return false;
    }

  private:
    std::array<uint32_t, kCapacity> inside_{};
    uint32_t count_ = 0;
};

// A path at the boundary of a volume.
struct Crossing {
    bool real = true;          // false: another volume fills both sides
    uint32_t other = kVacuum;  // what lies on the boundary's outer side
    MediumStack after;         // for a path that goes through
};

// entering: the path meets the boundary's front. A body that is met from a side where it should not
// be (an open mesh, a camera inside) counts as alone.
inline Crossing cross_boundary(const MediumStack& media, std::span<const Material> materials,
                               uint32_t material, bool entering) {
    Crossing c;
    c.after = media;
    c.after.leave(material);
    c.other = c.after.top(materials);
    if (entering) {
        c.real = c.other == kVacuum ||
                 materials[material].nested_priority >= materials[c.other].nested_priority;
        c.after.enter(material);
    } else {
        c.real = !media.contains(material) || media.top(materials) == material;
    }
    return c;
}

}  // namespace talbot
