// Rays per second of Talbot's structure against Embree's in its default and its robust mode: same
// triangles, same rays, one process, single-ray calls, runs interleaved, medians. Rates are per
// second of each thread's own processor time. usage: bench_rays [--quick] [--scene NAME] [--rounds
// N] [--json FILE]
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#if TALBOT_BENCH_EMBREE
#include <embree3/rtcore.h>
#endif

#include "core/geometry/bvh.h"
#include "ray_sets.h"

namespace talbot::bench {
namespace {

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// One engine with one scene: traces a range of rays and returns how many hit.
struct Engine {
    std::string name;
    std::function<uint64_t(const Ray* rays, size_t count, bool any)> trace;
    double build_seconds = 0;
    double bytes = 0;
};

uint64_t trace_talbot(const Accel& accel, const Ray* rays, size_t count, bool any) {
    uint64_t hits = 0;
    if (any) {
        for (size_t i = 0; i < count; ++i) hits += accel.occluded(rays[i]);
    } else {
        Hit hit;
        for (size_t i = 0; i < count; ++i) hits += accel.closest(rays[i], hit);
    }
    return hits;
}

#if TALBOT_BENCH_EMBREE
class EmbreeScene {
  public:
    EmbreeScene(const test::SceneData& data, RTCSceneFlags flags, RTCBuildQuality quality) {
        device_ = rtcNewDevice("threads=2");
        rtcSetDeviceMemoryMonitorFunction(
            device_,
            [](void* self, ssize_t bytes, bool) {
                static_cast<EmbreeScene*>(self)->bytes_ += bytes;
                return true;
            },
            this);
        scene_ = rtcNewScene(device_);
        rtcSetSceneFlags(scene_, flags);
        rtcSetSceneBuildQuality(scene_, quality);
        for (const AccelInstance& instance : data.instances) {
            const test::MeshData& mesh = data.meshes[instance.mesh];
            RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
            rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       mesh.positions.data(), 0, sizeof(Vec3f),
                                       mesh.positions.size());
            rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                       mesh.indices.data(), 0, 3 * sizeof(uint32_t),
                                       mesh.triangles());
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene_, geometry);
            rtcReleaseGeometry(geometry);
        }
        const int64_t before = bytes_;
        const auto start = std::chrono::steady_clock::now();
        rtcCommitScene(scene_);
        seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        built_bytes_ = static_cast<double>(bytes_ - before);
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    uint64_t trace(const Ray* rays, size_t count, bool any) const {
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
    double build_seconds() const { return seconds_; }
    double bytes() const { return built_bytes_; }

  private:
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::atomic<int64_t> bytes_{0};
    double built_bytes_ = 0;
    double seconds_ = 0;
};
#endif

// Mrays/s over all rays of a set with this many threads.
double rate(const Engine& engine, const std::vector<Ray>& rays, bool any, unsigned threads,
            uint64_t& hits) {
    std::vector<double> rates(threads, 0);
    std::vector<uint64_t> found(threads, 0);
    std::vector<std::thread> workers;
    for (unsigned worker = 0; worker < threads; ++worker) {
        workers.emplace_back([&, worker] {
            const size_t begin = rays.size() * worker / threads;
            const size_t end = rays.size() * (worker + 1) / threads;
            const double start = thread_seconds();
            found[worker] = engine.trace(rays.data() + begin, end - begin, any);
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

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    return n % 2 != 0 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

struct Options {
    bool quick = false;
    std::string scene;
    std::string json;
    int rounds = 5;
};

struct Result {
    std::string scene;
    std::string kind;
    unsigned threads = 1;
    std::vector<double> rates;  // one per engine
};

std::string cpu_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
    }
    return "unknown";
}

std::string heading() {
    std::ostringstream out;
    out << "Machine: " << cpu_name() << ", " << std::thread::hardware_concurrency()
        << " threads. Compiler: " << TALBOT_COMPILER << ", " << TALBOT_BUILD_FLAGS << ". Talbot "
        << TALBOT_VERSION << ", " << traversal_target_name() << ".";
#if TALBOT_BENCH_EMBREE
    out << " Embree " << RTC_VERSION_STRING << ".";
#endif
    return out.str();
}

void run_scene(const BenchScene& scene, const Options& options, std::vector<Engine>& engines,
               std::vector<Result>& results) {
    WorkerPool pool(2);
    const auto fast = build_accel(scene.data.input(BuildQuality::fast), pool);
    const auto accel = build_accel(scene.data.input(BuildQuality::high), pool);
    const RaySets sets = make_ray_sets(scene, *accel, options.quick ? 256 : 1024);
    engines.clear();
    engines.push_back({"Talbot",
                       [&](const Ray* rays, size_t count, bool any) {
                           return trace_talbot(*accel, rays, count, any);
                       },
                       accel->stats().build_seconds, static_cast<double>(accel->stats().bytes)});
    engines.push_back({"Talbot fast",
                       [&](const Ray* rays, size_t count, bool any) {
                           return trace_talbot(*fast, rays, count, any);
                       },
                       fast->stats().build_seconds, static_cast<double>(fast->stats().bytes)});
#if TALBOT_BENCH_EMBREE
    const EmbreeScene plain(scene.data, RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_MEDIUM);
    const EmbreeScene robust(scene.data, RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
    const EmbreeScene high(scene.data, RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH);
    for (const auto& [name, embree] :
         {std::pair{"Embree", &plain}, {"Embree robust", &robust}, {"Embree high", &high}}) {
        engines.push_back({name,
                           [e = embree](const Ray* rays, size_t count, bool any) {
                               return e->trace(rays, count, any);
                           },
                           embree->build_seconds(), embree->bytes()});
    }
#endif
    const size_t triangles = accel->stats().triangles;
    std::printf("\n%s: %zu triangles, depth %u, %llu nodes; build ms / bytes per triangle:",
                scene.name.c_str(), triangles, accel->stats().depth,
                static_cast<unsigned long long>(accel->stats().nodes));
    for (const Engine& engine : engines) {
        std::printf(" %s %.1f / %.0f,", engine.name.c_str(), 1e3 * engine.build_seconds,
                    engine.bytes / static_cast<double>(triangles));
    }
    std::printf("\n");
    for (const auto& [kind, rays, any] :
         {std::tuple{"primary", &sets.primary, false}, std::tuple{"ao", &sets.ao, true},
          std::tuple{"diffuse", &sets.diffuse, false}}) {
        for (const unsigned threads : {1u, 2u}) {
            std::vector<std::vector<double>> rates(engines.size());
            std::vector<uint64_t> hits(engines.size());
            for (int round = 0; round < options.rounds; ++round) {
                for (size_t e = 0; e < engines.size(); ++e) {
                    rates[e].push_back(rate(engines[e], *rays, any, threads, hits[e]));
                }
            }
            Result result{scene.name, kind, threads, {}};
            std::printf("| %s | %s | %u |", scene.name.c_str(), kind, threads);
            for (size_t e = 0; e < engines.size(); ++e) {
                result.rates.push_back(median(rates[e]));
                std::printf(" %.2f |", result.rates.back());
                const double difference =
                    std::abs(static_cast<double>(hits[e]) - static_cast<double>(hits[0]));
                if (difference > 1e-4 * static_cast<double>(rays->size()))
                    std::printf("(hits differ: %.0f) ", difference);
            }
            if (engines.size() > 3) {
                std::printf(" %.2f | %.2f |", result.rates[0] / result.rates[2],
                            result.rates[0] / result.rates[3]);
            }
            std::printf("\n");
            std::fflush(stdout);
            results.push_back(result);
        }
    }
}

// Geometric means of the ratios against engine `other`, by kind and number of threads.
void print_means(const std::vector<Result>& results, size_t other, const std::string& name) {
    std::map<std::string, std::vector<double>> groups;
    for (const Result& r : results) {
        groups[r.kind + ", " + std::to_string(r.threads)].push_back(r.rates[0] / r.rates[other]);
    }
    std::printf("\nTalbot / %s, geometric means over the scenes:", name.c_str());
    for (const auto& [key, ratios] : groups) {
        double sum = 0;
        for (const double ratio : ratios) sum += std::log(ratio);
        std::printf(" %s: %.3f;", key.c_str(), std::exp(sum / static_cast<double>(ratios.size())));
    }
    std::printf("\n");
}

void write_json(const Options& options, const std::vector<Engine>& engines,
                const std::vector<Result>& results) {
    std::ofstream out(options.json);
    out << "{\"schema\": \"talbot-bench-rays/1\", \"about\": \"" << heading() << "\", \"rows\": [";
    for (size_t i = 0; i < results.size(); ++i) {
        const Result& r = results[i];
        out << (i == 0 ? "\n" : ",\n") << "  {\"scene\": \"" << r.scene << "\", \"kind\": \""
            << r.kind << "\", \"threads\": " << r.threads << ", \"mrays_per_second\": {";
        for (size_t e = 0; e < engines.size(); ++e) {
            out << (e == 0 ? "" : ", ") << '"' << engines[e].name << "\": " << r.rates[e];
        }
        out << "}}";
    }
    out << "\n]}\n";
}

int run(const Options& options) {
    std::printf("%s\n", heading().c_str());
    std::vector<Engine> engines;
    std::vector<Result> results;
    std::printf(
        "| scene | rays | threads | Talbot | Talbot fast | Embree | Embree robust | Embree high | "
        "/ Embree | / robust |\n");
    std::printf("|---|---|---|---|---|---|---|---|---|---|\n");
    for (const BenchScene& scene : bench_scenes(options.scene))
        run_scene(scene, options, engines, results);
    if (engines.size() > 3 && !results.empty()) {
        print_means(results, 2, engines[2].name);
        print_means(results, 3, engines[3].name);
    }
    if (!options.json.empty()) write_json(options, engines, results);
    return 0;
}

}  // namespace
}  // namespace talbot::bench

int main(int argc, char** argv) {
    talbot::bench::Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool has_value = i + 1 < argc;
        if (word == "--quick") {
            options.quick = true;
        } else if (word == "--scene" && has_value) {
            options.scene = argv[++i];
        } else if (word == "--json" && has_value) {
            options.json = argv[++i];
        } else if (word == "--rounds" && has_value) {
            options.rounds = std::max(1, std::atoi(argv[++i]));
        } else {
            std::fprintf(stderr,
                         "usage: bench_rays [--quick] [--scene NAME] [--rounds N] [--json FILE]\n");
            return 2;
        }
    }
    return talbot::bench::run(options);
}
