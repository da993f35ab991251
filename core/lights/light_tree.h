// A binary tree over finite lights that a shading point descends towards those that may matter most
// to it (Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree
// splitting"). One light a leaf; a child is chosen in proportion to a bound on what it can send:
// power, distance and the cones of its emission. A cluster that certainly sends nothing has
// probability 0.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/math/vec.h"

namespace talbot {

// What a light, or a cluster of lights, may send: its box, power, and the cone of normals round
// axis (half-angle theta_o) from which light leaves within theta_e.
struct LightBounds {
    Vec3f lower{0};
    Vec3f upper{0};
    Vec3f axis{0, 0, 1};
    float cos_theta_o = 1;
    float cos_theta_e = 0;
    float power = 0;         // of all, in proportion to luminous power
    bool two_sided = false;  // emits on both sides of its normals
};

class LightTree {
  public:
    LightTree() = default;
    // Lights with power 0 are never chosen.
    explicit LightTree(std::span<const LightBounds> lights);

    bool is_empty() const { return nodes_.empty(); }

    struct Pick {
        uint32_t index = 0;
        float probability = 0;
    };
    // u in [0, 1). n: unit normal of the side that is lit, zero where both are. Empty when no light
    // can reach p.
    std::optional<Pick> sample(const Vec3f& p, const Vec3f& n, float u) const;
    // Probability with which sample() at p gives that light.
    float probability(const Vec3f& p, const Vec3f& n, uint32_t index) const;

  private:
    struct Node {
        Vec3f center{0};
        float radius2 = 0;  // of the sphere round the box
        Vec3f axis{0, 0, 1};
        float cos_theta_o = 1;
        float sin_theta_o = 0;
        float cos_theta_e = 0;
        float power = 0;
        uint32_t second = 0;  // the other child, or the light of a leaf; the first child follows
        bool leaf = false;
        bool two_sided = false;
    };
    struct Builder;

    static float importance(const Node& node, const Vec3f& p, const Vec3f& n);

    std::vector<Node> nodes_;
    std::vector<uint64_t> trails_;  // per light: which child at each level, lowest bit first
    std::vector<uint8_t> depths_;   // per light: number of levels; kAbsent for those without power
};

}  // namespace talbot
