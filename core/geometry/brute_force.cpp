// The oracle: every primitive is tested with the same scalar tests that traversal uses, in order,
// without any culling.
#include <algorithm>

#include "core/geometry/accel.h"
#include "core/geometry/local_ray.h"
#include "core/geometry/scene_input.h"
#include "core/geometry/sphere.h"
#include "core/geometry/triangle.h"

namespace talbot {
namespace {

struct MeshTriangle {
    StoredTriangle shape;
    PrimitiveId id;
};

class BruteForceAccel final : public Accel {
  public:
    explicit BruteForceAccel(const AccelInput& input) {
        std::vector<Tree> trees;
        objects_ = make_objects(input, trees);
        for (const AccelInstance& instance : input.instances)
            filtered_.push_back(instance.filtered);
        const std::vector<uint32_t> meshes = shared_meshes(input);
        shared_.resize(meshes.size());
        for (size_t i = 0; i < meshes.size(); ++i) load(input.meshes[meshes[i]], kNoId, shared_[i]);
        for (size_t i = 0; i < input.instances.size(); ++i) {
            const AccelInstance& instance = input.instances[i];
            if (instance.identity)
                load(input.meshes[instance.mesh], static_cast<uint32_t>(i), top_);
        }
        stats_.triangles = top_.size();
        for (const auto& triangles : shared_) stats_.triangles += triangles.size();
        stats_.instances = input.instances.size();
        stats_.spheres = input.spheres.size();
        stats_.bytes = stats_.triangles * sizeof(MeshTriangle);
        set_bounds(input);
    }

    bool closest(const Ray& ray, Hit& hit) const override { return search(ray, nullptr, hit); }
    BeamEntry enter(const Beam&) const override { return {}; }
    bool closest(const Ray& ray, Hit& hit, const BeamEntry&) const override {
        return closest(ray, hit);
    }
    bool closest(const Ray& ray, Hit& hit, const HitFilter& filter) const override {
        return search(ray, &filter, hit);
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
        steps = static_cast<uint32_t>(std::min<uint64_t>(stats_.triangles + stats_.spheres, kNoId));
        return search(ray, nullptr, hit);
    }
    bool find_leaf(const Ray&, const Hit&, LeafPlace&) const override { return false; }
    const AccelStats& stats() const override { return stats_; }
    Bounds bounds() const override { return bounds_; }

  private:
    struct Search {
        const Ray& ray;
        const HitFilter* filter;
        Hit best;
        bool found = false;
    };

    void load(const AccelMesh& mesh, uint32_t instance, std::vector<MeshTriangle>& out) {
        for (size_t i = 0; i < mesh.indices.size() / 3; ++i) {
            MeshTriangle triangle;
            if (load_triangle(mesh, i, triangle.shape)) {
                triangle.id = {instance, static_cast<uint32_t>(i)};
                out.push_back(triangle);
            } else {
                ++stats_.dropped_triangles;
            }
        }
    }

    void set_bounds(const AccelInput& input) {
        for (const MeshTriangle& t : top_) add_corners(t, Mat4d(1.0));
        for (const SceneObject& object : objects_) {
            if (object.is_sphere) {
                bounds_.add(Vec3f(object.center - object.radius));
                bounds_.add(Vec3f(object.center + object.radius));
            } else {
                for (const MeshTriangle& t : shared_[object.tree]) {
                    add_corners(t, input.instances[object.id].world_from_object);
                }
            }
        }
    }

    void add_corners(const MeshTriangle& t, const Mat4d& world_from_object) {
        for (const Vec3f* p : {&t.shape.a, &t.shape.b, &t.shape.c}) {
            bounds_.add(Vec3f(Vec3d(world_from_object * Vec4d(Vec3d(*p), 1))));
        }
    }

    static void accept(Search& search, const Hit& hit, bool filtered) {
        if (!(hit.t > 0) || !(hit.t <= search.best.t)) return;
        if (hit.t == search.best.t && !comes_before(hit.id, search.best.id)) return;
        if (filtered && search.filter != nullptr &&
            !search.filter->accepts(search.filter->context, search.ray, hit)) {
            return;
        }
        search.best = hit;
        search.found = true;
    }

    void test(Search& search, const LocalRay& ray,
              const std::vector<MeshTriangle>& triangles) const {
        for (const MeshTriangle& t : triangles) {
            const PrimitiveId id{ray.instance == kNoId ? t.id.instance : ray.instance,
                                 t.id.primitive};
            if (id == search.ray.skip_from || id == search.ray.skip_to) continue;
            TriangleHit hit;
            if (!intersect_triangle(ray.sheared, t.shape.a, t.shape.b, t.shape.c, t.shape.extent,
                                    hit))
                continue;
            accept(search, {hit.t * ray.t_scale, hit.u, hit.v, id}, filtered_[id.instance]);
        }
    }

    bool search(const Ray& ray, const HitFilter* filter, Hit& hit) const {
        Search search{ray, filter, {ray.t_max, 0, 0, {0, 0}}};
        LocalRay world;
        if (!to_world_kernel(ray, world)) return false;
        test(search, world, top_);
        for (const SceneObject& object : objects_) {
            if (object.is_sphere) {
                const PrimitiveId id{kSphereInstance, object.id};
                float t[2];
                const int count = sphere_hits(ray, id == ray.skip_from, id == ray.skip_to,
                                              object.center, object.radius, t);
                for (int k = 0; k < count; ++k) accept(search, {t[k], 0, 0, id}, object.filtered);
            } else {
                LocalRay local;
                if (to_object_space(ray, object, local)) test(search, local, shared_[object.tree]);
            }
        }
        if (search.found) hit = search.best;
        return search.found;
    }

    std::vector<MeshTriangle> top_;
    std::vector<std::vector<MeshTriangle>> shared_;
    std::vector<SceneObject> objects_;
    std::vector<bool> filtered_;
    AccelStats stats_;
    Bounds bounds_;
};

}  // namespace

std::unique_ptr<const Accel> build_brute_force(const AccelInput& input) {
    return std::make_unique<BruteForceAccel>(input);
}

}  // namespace talbot
