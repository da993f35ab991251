// The intersector of the double build: a plain binary tree over every triangle and sphere in world
// space. It shares nothing with the core's traversal but the interface and the sphere.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "double/core/geometry/accel.h"
#include "double/core/geometry/sphere.h"

namespace talbot_double {
namespace {

struct Primitive {
    std::array<Vec3d, 3> corner{};  // of a triangle
    Vec3d center{0};                // of a sphere
    double radius = 0;              // > 0 for spheres
    PrimitiveId id{};
    bool filtered = false;
};

struct Box {
    Vec3d lower{std::numeric_limits<double>::infinity()};
    Vec3d upper{-std::numeric_limits<double>::infinity()};

    void add(const Vec3d& p) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    void add(const Box& box) {
        lower = glm::min(lower, box.lower);
        upper = glm::max(upper, box.upper);
    }
    // Wider than rounding on the way to it.
    Box padded() const {
        constexpr double kPad = 0x1p-40;
        const Vec3d pad = kPad * (glm::abs(lower) + glm::abs(upper) + (upper - lower));
        return {lower - pad, upper + pad};
    }
};

Box box_of(const Primitive& primitive) {
    Box box;
    if (primitive.radius > 0) {
        box.add(primitive.center - primitive.radius);
        box.add(primitive.center + primitive.radius);
    } else {
        for (const Vec3d& p : primitive.corner) box.add(p);
    }
    return box;
}

struct Node {
    Box box;
    uint32_t first = 0;  // of its primitives, or its left child
    uint32_t right = 0;
    uint32_t count = 0;  // 0: an inner node
};

struct LineRay {
    Vec3d o, d;
};

bool meets(const Box& box, const LineRay& ray, double t_max) {
    double enter = 0;
    double leave = t_max;
    for (int i = 0; i < 3; ++i) {
        if (ray.d[i] == 0) {
            if (ray.o[i] < box.lower[i] || ray.o[i] > box.upper[i]) return false;
            continue;
        }
        const double a = (box.lower[i] - ray.o[i]) / ray.d[i];
        const double b = (box.upper[i] - ray.o[i]) / ray.d[i];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    constexpr double kPad = 1 + 0x1p-40;
    return enter <= leave * kPad;
}

// Edge functions in the space sheared along the ray (Woop, Benthin, Wald 2013).
bool meets(const std::array<Vec3d, 3>& corner, const LineRay& ray, Hit& hit) {
    const Vec3d size = glm::abs(ray.d);
    const int kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const int kx = (kz + 1) % 3;
    const int ky = (kz + 2) % 3;
    const double sx = ray.d[kx] / ray.d[kz];
    const double sy = ray.d[ky] / ray.d[kz];
    std::array<double, 3> x, y, z;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d p = corner[i] - ray.o;
        x[i] = p[kx] - sx * p[kz];
        y[i] = p[ky] - sy * p[kz];
        z[i] = p[kz];
    }
    const double u = x[2] * y[1] - y[2] * x[1];
    const double v = x[0] * y[2] - y[0] * x[2];
    const double w = x[1] * y[0] - y[1] * x[0];
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
    const double sum = u + v + w;
    if (sum == 0) return false;
    hit.t = (u * z[0] + v * z[1] + w * z[2]) / sum / ray.d[kz];
    hit.u = v / sum;
    hit.v = w / sum;
    return true;
}

bool comes_before(const PrimitiveId& a, const PrimitiveId& b) {
    return a.instance != b.instance ? a.instance < b.instance : a.primitive < b.primitive;
}

class DoubleAccel final : public Accel {
  public:
    explicit DoubleAccel(const AccelInput& input) {
        for (uint32_t i = 0; i < input.instances.size(); ++i) add_instance(input, i);
        for (uint32_t i = 0; i < input.spheres.size(); ++i) {
            Primitive primitive;
            primitive.center = input.spheres[i].center;
            primitive.radius = input.spheres[i].radius;
            primitive.id = {kSphereInstance, i};
            primitive.filtered = input.spheres[i].filtered;
            primitives_.push_back(primitive);
        }
        stats_.spheres = input.spheres.size();
        stats_.instances = input.instances.size();
        if (!primitives_.empty()) build(0, static_cast<uint32_t>(primitives_.size()));
        stats_.nodes = nodes_.size();
        stats_.bytes = nodes_.size() * sizeof(Node) + primitives_.size() * sizeof(Primitive);
    }

    bool closest(const Ray& ray, Hit& hit) const override { return search(ray, nullptr, hit); }
    bool closest(const Ray& ray, Hit& hit, const HitFilter& filter) const override {
        return search(ray, &filter, hit);
    }
    BeamEntry enter(const Beam&) const override { return {}; }
    bool closest(const Ray& ray, Hit& hit, const BeamEntry&) const override {
        return closest(ray, hit);
    }
    bool occluded(const Ray& ray) const override {
        Hit hit;
        return search(ray, nullptr, hit);
    }
    bool occluded(const Ray& ray, const HitFilter& filter) const override {
        Hit hit;
        return search(ray, &filter, hit);
    }
    bool closest_counting(const Ray& ray, Hit& hit, uint32_t& steps) const override {
        return search(ray, nullptr, hit, &steps);
    }
    bool find_leaf(const Ray&, const Hit&, LeafPlace&) const override { return false; }
    const AccelStats& stats() const override { return stats_; }
    Bounds bounds() const override {
        Bounds bounds;
        if (nodes_.empty()) return bounds;
        bounds.add(Vec3f(nodes_[0].box.lower));
        bounds.add(Vec3f(nodes_[0].box.upper));
        return bounds;
    }

  private:
    void add_instance(const AccelInput& input, uint32_t index) {
        const AccelInstance& instance = input.instances[index];
        const AccelMesh& mesh = input.meshes[instance.mesh];
        for (uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
            Primitive primitive;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3d p(mesh.positions[mesh.indices[std::size_t{3} * t + k]]);
                primitive.corner[k] =
                    instance.identity ? p : Vec3d(instance.world_from_object * Vec4d(p, 1.0));
            }
            const Vec3d& a = primitive.corner[0];
            const Vec3d n = cross(primitive.corner[1] - a, primitive.corner[2] - a);
            if (!(dot(n, n) > 0)) {
                ++stats_.dropped_triangles;
                continue;
            }
            primitive.id = {index, t};
            primitive.filtered = instance.filtered;
            primitives_.push_back(primitive);
            ++stats_.triangles;
        }
    }

    // Halves the primitives by their middles along the longest axis.
    uint32_t build(uint32_t first, uint32_t last) {
        constexpr uint32_t kLeaf = 4;
        const auto index = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        Box box;
        Box middles;
        for (uint32_t i = first; i < last; ++i) {
            const Box own = box_of(primitives_[i]);
            box.add(own);
            middles.add(0.5 * (own.lower + own.upper));
        }
        nodes_[index].box = box.padded();
        nodes_[index].first = first;
        nodes_[index].count = last - first;
        if (last - first <= kLeaf) return index;
        const Vec3d size = middles.upper - middles.lower;
        const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        const uint32_t middle = first + (last - first) / 2;
        std::nth_element(primitives_.begin() + first, primitives_.begin() + middle,
                         primitives_.begin() + last,
                         [axis](const Primitive& a, const Primitive& b) {
                             const Box box_a = box_of(a);
                             const Box box_b = box_of(b);
                             return box_a.lower[axis] + box_a.upper[axis] <
                                    box_b.lower[axis] + box_b.upper[axis];
                         });
        const uint32_t left = build(first, middle);
        const uint32_t right = build(middle, last);
        nodes_[index].first = left;
        nodes_[index].right = right;
        nodes_[index].count = 0;
        return index;
    }

    struct Search {
        const Ray& ray;
        const HitFilter* filter;
        Hit best;
        bool found = false;
    };

    void accept(Search& search, const Hit& hit, bool filtered) const {
        if (!(hit.t > 0) || !(hit.t <= search.best.t)) return;
        if (hit.t == search.best.t && !comes_before(hit.id, search.best.id)) return;
        if (filtered && search.filter != nullptr &&
            !search.filter->accepts(search.filter->context, search.ray, hit))
            return;
        search.best = hit;
        search.found = true;
    }

    void test(Search& search, const LineRay& line, const Primitive& primitive) const {
        const bool skip_from = primitive.id == search.ray.skip_from;
        const bool skip_to = primitive.id == search.ray.skip_to;
        if (primitive.radius > 0) {
            double t[2];
            const int count =
                sphere_hits(search.ray, skip_from, skip_to, primitive.center, primitive.radius, t);
            for (int k = 0; k < count; ++k)
                accept(search, {t[k], 0, 0, primitive.id}, primitive.filtered);
            return;
        }
        if (skip_from || skip_to) return;
        Hit hit;
        hit.id = primitive.id;
        if (meets(primitive.corner, line, hit)) accept(search, hit, primitive.filtered);
    }

    bool search(const Ray& ray, const HitFilter* filter, Hit& hit,
                uint32_t* steps = nullptr) const {
        Search search{ray, filter, {ray.t_max, 0, 0, {0, 0}}};
        const LineRay line{Vec3d(ray.o), Vec3d(ray.d)};
        std::vector<uint32_t> stack;
        if (!nodes_.empty()) stack.push_back(0);
        uint32_t visited = 0;
        while (!stack.empty()) {
            const Node& node = nodes_[stack.back()];
            stack.pop_back();
            ++visited;
            if (!meets(node.box, line, search.best.t)) continue;
            if (node.count == 0) {
                stack.push_back(node.right);
                stack.push_back(node.first);
                continue;
            }
            for (uint32_t i = node.first; i < node.first + node.count; ++i)
                test(search, line, primitives_[i]);
        }
        if (steps) *steps = visited;
        if (search.found) hit = search.best;
        return search.found;
    }

    std::vector<Primitive> primitives_;
    std::vector<Node> nodes_;
    AccelStats stats_;
};

}  // namespace

std::unique_ptr<const Accel> build_accel(const AccelInput& input, WorkerPool& /*pool*/,
                                         std::stop_token /*stop*/,
                                         const std::function<void(double)>& /*progress*/) {
    return std::make_unique<DoubleAccel>(input);
}

// Always built anew.
std::unique_ptr<const Accel> refit_accel(const Accel& /*previous*/, const AccelInput& /*input*/,
                                         WorkerPool& /*pool*/, std::stop_token /*stop*/) {
    return nullptr;
}

std::unique_ptr<const Accel> build_brute_force(const AccelInput& input) {
    return std::make_unique<DoubleAccel>(input);
}

}  // namespace talbot_double
