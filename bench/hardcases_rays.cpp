// Geometry cases of the catalogue through Embree's own intersectors beside Talbot's: rays from
// inside a closed mesh that slip out (G01, G02, G08), and huge and distant spheres (G11, G12).
// Embree in its default and its robust mode, single rays; where it is not installed, Talbot alone.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/hardcases/cases/exact_oracles.h"
#include "ray_engines.h"

namespace talbot::bench {
namespace {

using namespace hardcases::geometry;
using nlohmann::json;

struct Row {
    std::string name;
    uint64_t rays = 0;
    std::vector<double> wrong;  // one per engine: wrong answers, or the largest relative error
};

std::vector<std::string> engine_names() {
#if TALBOT_BENCH_EMBREE
    return {"Talbot", "Embree default", "Embree robust"};
#else
    return {"Talbot"};
#endif
}

// Rays from `inside` to vertices, points of edges and points of faces of a closed mesh.
std::vector<Ray> rays_to(const MeshData& mesh, const Vec3f& inside, uint64_t count,
                         bool along_axes) {
    std::vector<Ray> rays;
    Rng rng(5);
    for (uint64_t i = 0; i < count; ++i) {
        const auto tri = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.triangles())));
        Ray ray;
        ray.o = inside;
        if (along_axes) {
            // A lattice point straight below, beside or above the middle of the mesh.
            const int axis = rng.between(0, 2);
            ray.d = Vec3f(0);
            ray.d[axis] = rng.below(2) == 0 ? 1.0f : -1.0f;
            for (int k = 0; k < 3; ++k) {
                if (k != axis) ray.o[k] = tri[0][k];
            }
            // On a face of the cube itself nothing lies ahead for certain.
            bool on_face = false;
            for (int k = 0; k < 3; ++k) {
                if (k != axis) on_face = on_face || std::abs(ray.o[k] - inside[k]) >= 7.5f;
            }
            if (on_face) continue;
        } else {
            Vec3f at = tri[0];
            const uint32_t kind = rng.below(3);
            if (kind == 1) at = 0.5f * (tri[0] + tri[1]);
            if (kind == 2) at = (tri[0] + tri[1] + tri[2]) * (1.0f / 3);
            ray.d = at - inside;
        }
        rays.push_back(ray);
    }
    return rays;
}

Row mesh_row(const std::string& name, MeshData mesh, const Vec3f& inside, uint64_t count,
             bool along_axes) {
    const std::vector<Ray> rays = rays_to(mesh, inside, count, along_axes);
    const SceneData scene = scene_of(std::move(mesh));
    Row row{name, rays.size(), {}};
    const auto misses = [&](const Engine& engine) {
        row.wrong.push_back(static_cast<double>(
            rays.size() - engine.trace(rays.data(), rays.size(), Search::closest)));
    };
    const std::shared_ptr<const Accel> accel = build(scene);
    misses(talbot_engine("Talbot", accel));
#if TALBOT_BENCH_EMBREE
    for (const RTCSceneFlags flags : {RTC_SCENE_FLAG_NONE, RTC_SCENE_FLAG_ROBUST}) {
        const auto embree =
            std::make_shared<const EmbreeScene>(scene, flags, RTC_BUILD_QUALITY_MEDIUM);
        misses(EmbreeScene::engine("Embree", embree));
    }
#endif
    return row;
}

MeshData moved(MeshData mesh, const Vec3f& by, float scale) {
    for (Vec3f& p : mesh.positions) p = p * scale + by;
    return mesh;
}

#if TALBOT_BENCH_EMBREE
// One analytic sphere.
class EmbreeSphere {
  public:
    EmbreeSphere(const Vec3f& center, float radius, RTCSceneFlags flags)
        : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        rtcSetSceneFlags(scene_, flags);
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 1));
        v[0] = center.x;
        v[1] = center.y;
        v[2] = center.z;
        v[3] = radius;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~EmbreeSphere() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeSphere(const EmbreeSphere&) = delete;
    EmbreeSphere& operator=(const EmbreeSphere&) = delete;

    bool hit(const Ray& ray, double& t) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        alignas(16) RTCRayHit query{};
        query.ray.org_x = ray.o.x;
        query.ray.org_y = ray.o.y;
        query.ray.org_z = ray.o.z;
        query.ray.dir_x = ray.d.x;
        query.ray.dir_y = ray.d.y;
        query.ray.dir_z = ray.d.z;
        query.ray.tfar = kInfinity;
        query.ray.mask = 0xFFFFFFFFu;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &query);
        t = static_cast<double>(query.ray.tfar);
        return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }

  private:
    RTCDevice device_;
    RTCScene scene_;
};
#endif

using HitTest = std::function<bool(const Ray&, double&)>;

void for_engines(const Vec3f& center, float radius,
                 const std::function<void(const HitTest&)>& with) {
    SceneData scene;
    scene.spheres.push_back({Vec3d(center), static_cast<double>(radius), false});
    const std::shared_ptr<const Accel> accel = build(scene);
    with([&](const Ray& ray, double& t) {
        Hit hit;
        const bool found = accel->closest(ray, hit);
        t = static_cast<double>(hit.t);
        return found;
    });
#if TALBOT_BENCH_EMBREE
    for (const RTCSceneFlags flags : {RTC_SCENE_FLAG_NONE, RTC_SCENE_FLAG_ROBUST}) {
        const EmbreeSphere sphere(center, radius, flags);
        with([&](const Ray& ray, double& t) { return sphere.hit(ray, t); });
    }
#endif
}

// Largest error of t over max(t, height) of rays down to a ground sphere of this radius.
Row ground_row(float radius, uint64_t count) {
    Row row{"ground sphere of radius " + std::to_string(static_cast<int64_t>(radius)) +
                ", worst error of t",
            count,
            {}};
    for_engines(Vec3f(0, -radius, 0), radius, [&](const HitTest& hit) {
        Rng rng(9);
        double worst = 0;
        for (uint64_t i = 0; i < count; ++i) {
            Ray ray;
            const float height = std::pow(10.0f, rng.uniform(-3.0f, 0.5f));
            ray.o = Vec3f(0, height, 0);
            Vec3f d = rng.direction();
            d.y = -std::abs(d.y) - 0.1f;
            ray.d = d;
            const ExactSphere exact = exact_sphere(ray, Vec3d(0, -static_cast<double>(radius), 0),
                                                   static_cast<double>(radius));
            double t = 0;
            if (!hit(ray, t)) {
                worst = std::numeric_limits<double>::infinity();
                continue;
            }
            const double scale = std::max(exact.t[0], static_cast<double>(height));
            worst = std::max(worst, std::abs(t - exact.t[0]) / scale);
        }
        row.wrong.push_back(worst);
    });
    return row;
}

// Hits and misses of a sphere `distance` radii away that exact arithmetic decides otherwise.
Row distant_row(float distance, uint64_t count) {
    Row row{"sphere " + std::to_string(static_cast<int64_t>(distance)) +
                " radii away, wrong hits and misses",
            count,
            {}};
    for_engines(Vec3f(0), 1, [&](const HitTest& hit) {
        Rng rng(11);
        uint64_t wrong = 0;
        for (uint64_t i = 0; i < count; ++i) {
            Ray ray;
            const Vec3f away = rng.direction();
            ray.o = away * distance;
            ray.d = rng.direction() * 1.1f - ray.o;
            const ExactSphere exact = exact_sphere(ray, Vec3d(0), 1);
            // The limb itself is anybody's.
            if (std::abs(exact.inside) < 4 * 0x1p-24 * static_cast<double>(distance)) continue;
            double t = 0;
            wrong += hit(ray, t) != exact.hit;
        }
        row.wrong.push_back(static_cast<double>(wrong));
    });
    return row;
}

int run(int argc, char** argv) {
    uint64_t count = 1000000;
    std::string file;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--quick") == 0) count = 50000;
        if (std::strcmp(argv[i], "--json") == 0 && i + 1 < argc) file = argv[++i];
    }
    std::vector<Row> rows;
    const MeshData ball = displaced_sphere(200, 0.1f);
    rows.push_back(mesh_row("displaced sphere, missed", ball, Vec3f(0), count, false));
    const Vec3f far(148376, 1234, -223423);
    rows.push_back(mesh_row("the same of radius 1000 at (148376, 1234, -223423), missed",
                            moved(ball, far, 1000), far, count, false));
    rows.push_back(
        mesh_row("lattice cube along the axes, missed", grid_cube(16), Vec3f(8), count, true));
    for (const float r : {1e3f, 1e5f, 1e6f}) rows.push_back(ground_row(r, count / 10));
    for (const float d : {1e2f, 1e4f, 1e6f}) rows.push_back(distant_row(d, count / 10));

    const std::vector<std::string> names = engine_names();
    std::printf("| case | rays |");
    for (const std::string& name : names) std::printf(" %s |", name.c_str());
    std::printf("\n|---|---|");
    for (size_t i = 0; i < names.size(); ++i) std::printf("---|");
    json list = json::array();
    for (const Row& row : rows) {
        std::printf("\n| %s | %llu |", row.name.c_str(), static_cast<unsigned long long>(row.rays));
        for (const double wrong : row.wrong) std::printf(" %.3g |", wrong);
        list.push_back({{"case", row.name}, {"rays", row.rays}, {"wrong", row.wrong}});
    }
    std::printf("\n");
    if (!file.empty())
        std::ofstream(file) << json{{"engines", names}, {"rows", list}}.dump(1) << "\n";
    return 0;
}

}  // namespace
}  // namespace talbot::bench

int main(int argc, char** argv) {
    return talbot::bench::run(argc, argv);
}
