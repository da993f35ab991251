// The engines that the ray benchmark compares: Talbot's structure, and Embree with the same
// triangles and instances where it is installed.
#pragma once

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#if TALBOT_BENCH_EMBREE
#include <embree3/rtcore.h>
#endif

#include "geometry_scenes.h"

namespace talbot::bench {

// Processor time of the calling thread, so that other load on the machine hardly counts.
inline double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Bytes of memory that the process holds at the moment, and the most since the last call of
// forget_peak_memory; 0 where the system does not tell.
inline double memory_field(const char* name) {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);) {
        if (line.rfind(name, 0) == 0) return 1024 * std::atof(line.c_str() + line.find(':') + 1);
    }
    return 0;
}
inline void forget_peak_memory() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

// What `build` gives, and how much memory more than before it took at most.
template <class Build>
auto build_watched(double& peak_bytes, const Build& build) {
    malloc_trim(0);
    forget_peak_memory();
    const double before = memory_field("VmRSS");
    auto built = build();
    peak_bytes = std::max(0.0, memory_field("VmHWM") - before);
    return built;
}

// Processor time of all threads.
inline double process_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Together: the closest hits of rays in groups of neighbours, by whatever an engine has for that.
enum class Search { closest, any, together };

// Rays in a group of neighbours, which are consecutive: a tile of pixels.
inline constexpr size_t kNeighbours = 64;

// One engine with one scene: traces a range of rays and returns how many hit.
struct Engine {
    std::string name;
    std::function<uint64_t(const Ray* rays, size_t count, Search search)> trace;
    double build_seconds = 0;
    double build_cpu_seconds = 0;
    double bytes = 0;
    double peak_bytes = 0;  // while it was built
};

inline uint64_t trace_talbot(const Accel& accel, const Ray* rays, size_t count, Search search) {
    uint64_t hits = 0;
    if (search == Search::any) {
        for (size_t i = 0; i < count; ++i) hits += accel.occluded(rays[i]);
    } else if (search == Search::together) {
        Hit hit;
        for (size_t first = 0; first < count; first += kNeighbours) {
            const size_t end = std::min(count, first + kNeighbours);
            Beam beam;
            for (size_t i = first; i < end; ++i) beam.add(rays[i]);
            const BeamEntry entry = accel.enter(beam);
            for (size_t i = first; i < end; ++i) hits += accel.closest(rays[i], hit, entry);
        }
    } else {
        Hit hit;
        for (size_t i = 0; i < count; ++i) hits += accel.closest(rays[i], hit);
    }
    return hits;
}

inline Engine talbot_engine(const std::string& name, std::shared_ptr<const Accel> accel) {
    const double seconds = accel->stats().build_seconds;
    const auto bytes = static_cast<double>(accel->stats().bytes);
    return {name,
            [accel](const Ray* rays, size_t count, Search search) {
                return trace_talbot(*accel, rays, count, search);
            },
            seconds,
            0,
            bytes,
            0};
}

#if TALBOT_BENCH_EMBREE
class EmbreeScene {
  public:
    EmbreeScene(const test::SceneData& data, RTCSceneFlags flags, RTCBuildQuality quality)
        : device_(rtcNewDevice("threads=2")), flags_(flags), quality_(quality) {
        rtcSetDeviceMemoryMonitorFunction(
            device_,
            [](void* self, ssize_t bytes, bool) {
                static_cast<EmbreeScene*>(self)->bytes_ += bytes;
                return true;
            },
            this);
        const auto start = std::chrono::steady_clock::now();
        const double cpu_start = process_seconds();
        scene_ = new_scene();
        std::vector<RTCScene> shared(data.meshes.size(), nullptr);
        for (const AccelInstance& instance : data.instances) {
            RTCGeometry geometry = nullptr;
            if (instance.identity) {
                geometry = mesh_geometry(data.meshes[instance.mesh]);
            } else {
                RTCScene& mesh = shared[instance.mesh];
                if (mesh == nullptr) {
                    mesh = new_scene();
                    attach(mesh, mesh_geometry(data.meshes[instance.mesh]));
                    rtcCommitScene(mesh);
                }
                geometry = instance_geometry(mesh, instance.world_from_object);
            }
            attach(scene_, geometry);
        }
        rtcCommitScene(scene_);
        seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        cpu_seconds_ = process_seconds() - cpu_start;
        built_bytes_ = static_cast<double>(bytes_);
        for (const RTCScene mesh : shared) {
            if (mesh != nullptr) rtcReleaseScene(mesh);
        }
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    uint64_t trace(const Ray* rays, size_t count, Search search) const {
        if (search == Search::together) return trace_packets(rays, count);
        const bool any = search == Search::any;
        uint64_t hits = 0;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (size_t i = 0; i < count; ++i) {
            alignas(16) RTCRayHit query{};
            RTCRay& ray = query.ray;
            ray.org_x = rays[i].o.x;
            ray.org_y = rays[i].o.y;
            ray.org_z = rays[i].o.z;
            ray.dir_x = rays[i].d.x;
            ray.dir_y = rays[i].d.y;
            ray.dir_z = rays[i].d.z;
            ray.tfar = rays[i].t_max;
            ray.mask = 0xFFFFFFFFu;
            if (any) {
                rtcOccluded1(scene_, &context, &ray);
                hits += ray.tfar < 0;
            } else {
                query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
                rtcIntersect1(scene_, &context, &query);
                hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
            }
        }
        return hits;
    }
    static Engine engine(const std::string& name, std::shared_ptr<const EmbreeScene> scene) {
        return {name,
                [scene](const Ray* rays, size_t count, Search search) {
                    return scene->trace(rays, count, search);
                },
                scene->seconds_,
                scene->cpu_seconds_,
                scene->built_bytes_,
                0};
    }

  private:
    // Sixteen rays at a time, told to be coherent.
    uint64_t trace_packets(const Ray* rays, size_t count) const {
        constexpr size_t kSize = 16;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        uint64_t hits = 0;
        for (size_t first = 0; first < count; first += kSize) {
            alignas(64) RTCRayHit16 query{};
            alignas(64) int valid[kSize] = {};
            for (size_t k = 0; k < kSize && first + k < count; ++k) {
                const Ray& ray = rays[first + k];
                valid[k] = -1;
                query.ray.org_x[k] = ray.o.x;
                query.ray.org_y[k] = ray.o.y;
                query.ray.org_z[k] = ray.o.z;
                query.ray.dir_x[k] = ray.d.x;
                query.ray.dir_y[k] = ray.d.y;
                query.ray.dir_z[k] = ray.d.z;
                query.ray.tfar[k] = ray.t_max;
                query.ray.mask[k] = 0xFFFFFFFFu;
                query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect16(valid, scene_, &context, &query);
            for (size_t k = 0; k < kSize; ++k)
                hits += valid[k] != 0 && query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
        }
        return hits;
    }
    RTCScene new_scene() {
        RTCScene scene = rtcNewScene(device_);
        rtcSetSceneFlags(scene, flags_);
        rtcSetSceneBuildQuality(scene, quality_);
        return scene;
    }
    static void attach(RTCScene scene, RTCGeometry geometry) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    RTCGeometry mesh_geometry(const test::MeshData& mesh) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   mesh.positions.data(), 0, sizeof(Vec3f), mesh.positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.indices.data(), 0, 3 * sizeof(uint32_t), mesh.triangles());
        return geometry;
    }
    RTCGeometry instance_geometry(RTCScene mesh, const Mat4d& world_from_object) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, mesh);
        float columns[12];
        for (int column = 0; column < 4; ++column) {
            for (int row = 0; row < 3; ++row)
                columns[3 * column + row] = static_cast<float>(world_from_object[column][row]);
        }
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
        return geometry;
    }

    RTCDevice device_ = nullptr;
    RTCSceneFlags flags_;
    RTCBuildQuality quality_;
    RTCScene scene_ = nullptr;
    std::atomic<int64_t> bytes_{0};
    double built_bytes_ = 0;
    double seconds_ = 0;
    double cpu_seconds_ = 0;
};
#endif

// Builds one engine over a scene, and says what that took.
struct EngineMaker {
    std::string name;
    std::function<Engine(WorkerPool& pool)> make;
};

// Talbot's two qualities, and Embree in its default, its robust and its high-quality mode. The
// scene must outlive what they make.
inline std::vector<EngineMaker> engine_makers(const test::SceneData& scene) {
    std::vector<EngineMaker> makers;
    const auto add_talbot = [&](const char* name, BuildQuality quality) {
        makers.push_back({name, [&scene, name, quality](WorkerPool& pool) {
                              double peak = 0;
                              double cpu_seconds = 0;
                              std::shared_ptr<const Accel> accel = build_watched(peak, [&] {
                                  const double start = process_seconds();
                                  auto built = build_accel(scene.input(quality), pool);
                                  cpu_seconds = process_seconds() - start;
                                  return built;
                              });
                              Engine engine = talbot_engine(name, accel);
                              engine.build_cpu_seconds = cpu_seconds;
                              engine.peak_bytes = peak;
                              return engine;
                          }});
    };
    add_talbot("Talbot", BuildQuality::high);
    add_talbot("Talbot fast", BuildQuality::fast);
#if TALBOT_BENCH_EMBREE
    const auto add_embree = [&](const char* name, RTCSceneFlags flags, RTCBuildQuality quality) {
        makers.push_back({name, [&scene, name, flags, quality](WorkerPool&) {
                              double peak = 0;
                              std::shared_ptr<const EmbreeScene> embree = build_watched(peak, [&] {
                                  return std::make_unique<EmbreeScene>(scene, flags, quality);
                              });
                              Engine engine = EmbreeScene::engine(name, embree);
                              engine.peak_bytes = peak;
                              return engine;
                          }});
    };
    add_embree("Embree", RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_MEDIUM);
    add_embree("Embree robust", RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
    add_embree("Embree high", RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH);
#endif
    return makers;
}

// Mrays/s over all rays of a set with this many threads.
inline double rate(const Engine& engine, const std::vector<Ray>& rays, Search search,
                   unsigned threads, uint64_t& hits) {
    std::vector<double> rates(threads, 0);
    std::vector<uint64_t> found(threads, 0);
    std::vector<std::thread> workers;
    for (unsigned worker = 0; worker < threads; ++worker) {
        workers.emplace_back([&, worker] {
            const size_t begin = rays.size() * worker / threads;
            const size_t end = rays.size() * (worker + 1) / threads;
            const double start = thread_seconds();
            found[worker] = engine.trace(rays.data() + begin, end - begin, search);
            rates[worker] = 1e-6 * static_cast<double>(end - begin) / (thread_seconds() - start);
        });
    }
    double sum = 0;
    hits = 0;
    for (unsigned worker = 0; worker < threads; ++worker) {
        workers[worker].join();
        sum += rates[worker];
        hits += found[worker];
    }
    return sum;
}

}  // namespace talbot::bench
