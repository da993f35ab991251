#include "core/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/math/robust.h"

namespace talbot {
namespace {

constexpr uint8_t kAbsent = 0xFF;
// From this level on nodes are halved by count, so that a trail fits 64 bits.
constexpr unsigned kLevelsByCost = 30;
constexpr int kBuckets = 12;
// Larger clusters are split along their longest axis, without trying the others.
constexpr std::size_t kAllAxes = 256;
// Still larger ones in halves.
constexpr std::size_t kLargestByCost = 8192;

// Cosine and sine of max(0, a - b) for angles in [0, pi].
struct CosSin {
    float cos = 1;
    float sin = 0;
};
CosSin subtract_clamped(const CosSin& a, const CosSin& b) {
    if (a.cos > b.cos) return {};
    return {a.cos * b.cos + a.sin * b.sin, std::max(a.sin * b.cos - a.cos * b.sin, 0.0f)};
}

double angle_of(float cosine) {
    return std::acos(std::clamp(static_cast<double>(cosine), -1.0, 1.0));
}

// The smallest cone round two cones (Conty Estevez and Kulla 2018, algorithm 1).
void join_cones(const LightBounds& a, const LightBounds& b, LightBounds& out) {
    const bool swapped = a.cos_theta_o > b.cos_theta_o;
    const LightBounds& wide = swapped ? b : a;
    const LightBounds& narrow = swapped ? a : b;
    out.cos_theta_e = std::min(a.cos_theta_e, b.cos_theta_e);
    out.axis = wide.axis;
    out.cos_theta_o = wide.cos_theta_o;
    // Most joins add one direction to a cone that holds it, or anything to all directions.
    if (wide.cos_theta_o <= -1) return;
    const float cos_between = dot(wide.axis, narrow.axis);
    if (narrow.cos_theta_o >= 1 && cos_between >= wide.cos_theta_o) return;
    const double o_wide = angle_of(wide.cos_theta_o);
    const double o_narrow = angle_of(narrow.cos_theta_o);
    const double between = angle_of(cos_between);
    if (std::min(between + o_narrow, std::numbers::pi) <= o_wide) return;
    const double joined = 0.5 * (o_wide + between + o_narrow);
    if (joined >= std::numbers::pi) {
        out.cos_theta_o = -1;
        return;
    }
    out.cos_theta_o = static_cast<float>(std::cos(joined));
    const Vec3d axis(wide.axis);
    const Vec3d side = Vec3d(narrow.axis) - dot(axis, Vec3d(narrow.axis)) * axis;
    const double length_side = length(side);
    if (!(length_side > 0)) {
        // Opposite axes have no plane of their own.
        out.cos_theta_o = -1;
        return;
    }
    const double turn = joined - o_wide;
    out.axis = Vec3f(std::cos(turn) * axis + std::sin(turn) / length_side * side);
}

LightBounds join(const LightBounds& a, const LightBounds& b) {
    if (!(a.power > 0)) return b;
    if (!(b.power > 0)) return a;
    LightBounds out;
    out.lower = glm::min(a.lower, b.lower);
    out.upper = glm::max(a.upper, b.upper);
    out.power = a.power + b.power;
    out.two_sided = a.two_sided || b.two_sided;
    join_cones(a, b, out);
    return out;
}

// The surface area orientation measure times power (Conty Estevez and Kulla 2018, section 4.3).
double cost(const LightBounds& b, double longest_ratio) {
    const double o = angle_of(b.cos_theta_o);
    const double e = angle_of(b.cos_theta_e);
    const double w = std::min(o + e, std::numbers::pi);
    const double sin_o = std::sin(o);
    const double omega = 2 * std::numbers::pi * (1 - std::cos(o)) +
                         0.5 * std::numbers::pi *
                             (2 * w * sin_o - std::cos(o - 2 * w) - 2 * o * sin_o + std::cos(o));
    const Vec3d d = Vec3d(b.upper) - Vec3d(b.lower);
    const double area = 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
    return b.power * omega * area * longest_ratio;
}

}  // namespace

struct LightTree::Builder {
    LightTree& tree;
    std::span<const LightBounds> lights;

    struct Task {
        std::size_t first, last;
        uint32_t parent;  // whose second child this is; kNone for a first child or the root
        uint64_t trail;
        unsigned level;
    };
    static constexpr uint32_t kNone = 0xFFFFFFFFu;

    static Vec3f center_of(const LightBounds& b) { return 0.5f * b.lower + 0.5f * b.upper; }

    void run(std::vector<uint32_t>& order) {
        // First children directly follow their parents: the stack is worked off depth first.
        std::vector<Task> stack{{0, order.size(), kNone, 0, 0}};
        while (!stack.empty()) {
            const Task task = stack.back();
            stack.pop_back();
            const auto index = static_cast<uint32_t>(tree.nodes_.size());
            if (task.parent != kNone) tree.nodes_[task.parent].second = index;
            tree.nodes_.emplace_back();
            if (task.last - task.first == 1) {
                const uint32_t light = order[task.first];
                tree.nodes_[index].leaf = true;
                tree.nodes_[index].second = light;
                tree.trails_[light] = task.trail;
                tree.depths_[light] = static_cast<uint8_t>(task.level);
                continue;
            }
            const std::size_t middle = split(order, task);
            const uint64_t bit = uint64_t{1} << task.level;
            stack.push_back({middle, task.last, index, task.trail | bit, task.level + 1});
            stack.push_back({task.first, middle, kNone, task.trail, task.level + 1});
        }
        bound_nodes();
    }

    // From the leaves up: children have higher indices than their parents.
    void bound_nodes() {
        std::vector<LightBounds> bounds(tree.nodes_.size());
        for (std::size_t i = bounds.size(); i-- > 0;) {
            Node& node = tree.nodes_[i];
            bounds[i] = node.leaf ? lights[node.second] : join(bounds[i + 1], bounds[node.second]);
            const Node links = node;
            node = make_node(bounds[i]);
            node.leaf = links.leaf;
            node.second = links.second;
        }
    }

    static Node make_node(const LightBounds& b) {
        Node node;
        node.center = center_of(b);
        const Vec3f half = 0.5f * b.upper - 0.5f * b.lower;
        node.radius2 = dot(half, half);
        node.axis = b.axis;
        node.cos_theta_o = b.cos_theta_o;
        node.sin_theta_o = safe_sqrt(1 - b.cos_theta_o * b.cos_theta_o);
        node.cos_theta_e = b.cos_theta_e;
        node.power = b.power;
        node.two_sided = b.two_sided;
        return node;
    }

    // Sorts order[first, last) into two parts and returns where the second begins.
    std::size_t split(std::vector<uint32_t>& order, const Task& task) {
        const auto begin = order.begin() + static_cast<std::ptrdiff_t>(task.first);
        const auto end = order.begin() + static_cast<std::ptrdiff_t>(task.last);
        const std::size_t half = (task.first + task.last) / 2;
        if (task.last - task.first == 2) return half;
        Vec3f lower = center_of(lights[*begin]);
        Vec3f upper = lower;
        Vec3f bounds_lower = lights[*begin].lower;
        Vec3f bounds_upper = lights[*begin].upper;
        for (auto i = begin; i != end; ++i) {
            bounds_lower = glm::min(bounds_lower, lights[*i].lower);
            bounds_upper = glm::max(bounds_upper, lights[*i].upper);
            lower = glm::min(lower, center_of(lights[*i]));
            upper = glm::max(upper, center_of(lights[*i]));
        }
        const Vec3f extent = bounds_upper - bounds_lower;
        const float longest = max_component(extent);
        double best = std::numeric_limits<double>::infinity();
        int best_axis = -1;
        int best_bucket = 0;
        const bool by_cost = task.level < kLevelsByCost && task.last - task.first <= kLargestByCost;
        for (int axis = 0; by_cost && axis < 3; ++axis) {
            if (!(upper[axis] > lower[axis])) continue;
            if (task.last - task.first > kAllAxes &&
                upper[axis] - lower[axis] < max_component(upper - lower))
                continue;
            std::array<LightBounds, kBuckets> buckets{};
            for (auto i = begin; i != end; ++i) {
                LightBounds& b = buckets[bucket_of(lights[*i], axis, lower, upper)];
                b = join(b, lights[*i]);
            }
            std::array<LightBounds, kBuckets> above{};
            for (std::size_t k = kBuckets - 1; k > 0; --k)
                above[k - 1] = join(k + 1 < kBuckets ? above[k] : LightBounds{}, buckets[k]);
            LightBounds below;
            for (std::size_t k = 0; k + 1 < kBuckets; ++k) {
                if (!(buckets[k].power > 0)) continue;  // the same parts as at the last bucket
                below = join(below, buckets[k]);
                if (!(below.power > 0) || !(above[k].power > 0)) continue;
                const double ratio = extent[axis] > 0 ? double{longest} / extent[axis] : 1;
                const double total = cost(below, ratio) + cost(above[k], ratio);
                if (total < best) best = total, best_axis = axis, best_bucket = static_cast<int>(k);
            }
        }
        // Lights without extent in a row: no cost tells their splits apart.
        if (best_axis >= 0 && best > 0) {
            const auto middle = std::partition(begin, end, [&](uint32_t light) {
                return bucket_of(lights[light], best_axis, lower, upper) <=
                       static_cast<std::size_t>(best_bucket);
            });
            if (middle != begin && middle != end)
                return static_cast<std::size_t>(middle - order.begin());
        }
        const Vec3f spread = upper - lower;
        const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0
                         : spread.y >= spread.z                       ? 1
                                                                      : 2;
        std::nth_element(begin, order.begin() + static_cast<std::ptrdiff_t>(half), end,
                         [&](uint32_t a, uint32_t b) {
                             const float x = center_of(lights[a])[axis];
                             const float y = center_of(lights[b])[axis];
                             return x < y || (x == y && a < b);
                         });
        return half;
    }

    static std::size_t bucket_of(const LightBounds& light, int axis, const Vec3f& lower,
                                 const Vec3f& upper) {
        const float s = (center_of(light)[axis] - lower[axis]) / (upper[axis] - lower[axis]);
        return static_cast<std::size_t>(
            std::clamp(static_cast<int>(s * kBuckets), 0, kBuckets - 1));
    }
};

LightTree::LightTree(std::span<const LightBounds> lights)
    : trails_(lights.size(), 0), depths_(lights.size(), kAbsent) {
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < lights.size(); ++i) {
        if (lights[i].power > 0) order.push_back(i);
    }
    if (order.empty()) return;
    nodes_.reserve(2 * order.size());
    Builder{*this, lights}.run(order);
}

// Conty Estevez and Kulla 2018, equation 3: power times bounds on both cosines over distance^2.
float LightTree::importance(const Node& node, const Vec3f& p, const Vec3f& n) {
    const Vec3f to_p = p - node.center;
    const float d2 = dot(to_p, to_p);
    const float far2 = std::max(d2, node.radius2);
    if (!(far2 > 0)) return node.power > 0 ? 1.0f : 0.0f;
    const float inv = d2 > 0 ? 1 / std::sqrt(d2) : 0.0f;
    // Half-angle under which p sees the cluster; all round from within.
    CosSin seen{-1, 0};
    if (d2 > node.radius2) {
        const float sin2 = node.radius2 / d2;
        seen = {std::sqrt(1 - sin2), std::sqrt(sin2)};
    }
    float cosine = dot(node.axis, to_p) * inv;
    if (node.two_sided) cosine = std::abs(cosine);
    const CosSin leaving{cosine, safe_sqrt(1 - cosine * cosine)};
    const CosSin beyond =
        subtract_clamped(subtract_clamped(leaving, {node.cos_theta_o, node.sin_theta_o}), seen);
    if (!(beyond.cos > node.cos_theta_e)) return 0;
    float result = node.power * beyond.cos / far2;
    if (n != Vec3f(0)) {
        const float cos_i = -dot(n, to_p) * inv;
        const CosSin arriving = subtract_clamped({cos_i, safe_sqrt(1 - cos_i * cos_i)}, seen);
        if (!(arriving.cos > 0)) return 0;
        result *= arriving.cos;
    }
    return result;
}

std::optional<LightTree::Pick> LightTree::sample(const Vec3f& p, const Vec3f& n, float u) const {
    if (nodes_.empty()) return std::nullopt;
    uint32_t index = 0;
    float probability = 1;
    while (!nodes_[index].leaf) {
        const uint32_t second = nodes_[index].second;
        const float a = importance(nodes_[index + 1], p, n);
        const float b = importance(nodes_[second], p, n);
        const float sum = a + b;
        if (!(sum > 0)) return std::nullopt;
        const float share = a / sum;
        if (u < share) {
            u = std::min(u / share, kOneMinusEpsilon);
            probability *= share;
            index = index + 1;
        } else {
            if (!(b > 0)) return std::nullopt;
            u = std::min((u - share) / (1 - share), kOneMinusEpsilon);
            probability *= 1 - share;
            index = second;
        }
    }
    if (!(probability > 0)) return std::nullopt;
    return Pick{nodes_[index].second, probability};
}

float LightTree::probability(const Vec3f& p, const Vec3f& n, uint32_t light) const {
    if (light >= depths_.size() || depths_[light] == kAbsent) return 0;
    uint32_t index = 0;
    float probability = 1;
    for (unsigned level = 0; level < depths_[light]; ++level) {
        const uint32_t second = nodes_[index].second;
        const float a = importance(nodes_[index + 1], p, n);
        const float b = importance(nodes_[second], p, n);
        const float sum = a + b;
        if (!(sum > 0)) return 0;
        const float share = a / sum;
        const bool into_second = (trails_[light] >> level & 1) != 0;
        probability *= into_second ? 1 - share : share;
        index = into_second ? second : index + 1;
    }
    return probability;
}

}  // namespace talbot
