// Rays per second, build time and memory of Talbot's structure, built well and built fast, against
// Embree's in its default, its robust and its high-quality mode: same triangles, same rays, one
// process, single-ray calls, runs interleaved, medians. Rates are per second of each thread's own
// processor time. Then what the structure is worth beside testing everything, and how cost grows
// with the number of triangles.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/geometry/bvh.h"
#include "ray_engines.h"
#include "ray_sets.h"

namespace talbot::bench {
namespace {

using nlohmann::json;

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    return n % 2 != 0 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

struct Options {
    bool quick = false;
    std::string scene;
    std::string models;
    std::string json;
    int rounds = 5;
};

struct Result {
    std::string scene;
    std::string kind;
    unsigned threads = 1;
    std::vector<double> rates;  // one per engine
};

struct Build {
    std::string scene;
    uint64_t triangles = 0;
    std::vector<double> seconds;
    std::vector<double> bytes;
    std::vector<double> peak_bytes;
};

struct Report {
    std::vector<std::string> engines;
    std::vector<Result> rates;
    std::vector<Build> builds;
    json speedups = json::array();
    json growth = json::array();
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

// The rates of all engines with one set of rays.
void measure(const std::vector<Engine>& engines, const Options& options,
             const std::vector<Ray>& rays, bool any, Result result, Report& report) {
    std::vector<std::vector<double>> rates(engines.size());
    std::vector<uint64_t> hits(engines.size());
    for (int round = 0; round < options.rounds; ++round) {
        for (size_t e = 0; e < engines.size(); ++e)
            rates[e].push_back(rate(engines[e], rays, any, result.threads, hits[e]));
    }
    std::printf("| %s | %s | %u |", result.scene.c_str(), result.kind.c_str(), result.threads);
    for (const auto& of_engine : rates) {
        result.rates.push_back(median(of_engine));
        std::printf(" %.2f |", result.rates.back());
    }
    for (size_t e = 1; e < engines.size(); ++e)
        std::printf(" %.2f |", result.rates[0] / result.rates[e]);
    std::printf("\n");
    std::fflush(stdout);
    for (size_t e = 1; e < engines.size(); ++e) {
        const double difference =
            std::abs(static_cast<double>(hits[e]) - static_cast<double>(hits[0]));
        if (difference > 1e-4 * static_cast<double>(rays.size())) {
            std::fprintf(stderr, "bench_rays: %s, %s: %s differs in %.0f hits of %zu rays\n",
                         result.scene.c_str(), result.kind.c_str(), engines[e].name.c_str(),
                         difference, rays.size());
        }
    }
    report.rates.push_back(std::move(result));
}

void run_scene(const BenchScene& scene, const Options& options, Report& report) {
    WorkerPool pool(2);
    std::vector<Engine> engines;
    const auto build_talbot = [&](const char* name, BuildQuality quality) {
        double peak = 0;
        auto built =
            build_watched(peak, [&] { return build_accel(scene.data.input(quality), pool); });
        engines.push_back(talbot_engine(name, *built));
        engines.back().peak_bytes = peak;
        return built;
    };
    const auto accel = build_talbot("Talbot", BuildQuality::high);
    const auto fast = build_talbot("Talbot fast", BuildQuality::fast);
#if TALBOT_BENCH_EMBREE
    const auto build_embree = [&](const char* name, RTCSceneFlags flags, RTCBuildQuality quality) {
        double peak = 0;
        auto built = build_watched(
            peak, [&] { return std::make_unique<EmbreeScene>(scene.data, flags, quality); });
        engines.push_back(built->engine(name));
        engines.back().peak_bytes = peak;
        return built;
    };
    const auto plain = build_embree("Embree", RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_MEDIUM);
    const auto robust =
        build_embree("Embree robust", RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
    const auto high = build_embree("Embree high", RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH);
#endif
    const RaySets sets = make_ray_sets(scene, *accel, options.quick ? 256 : 1024);
    if (report.engines.empty()) {
        for (const Engine& engine : engines) report.engines.push_back(engine.name);
        std::string head = "| scene | rays | threads |";
        std::string rule = "|---|---|---|";
        for (const std::string& name : report.engines) head += " " + name + " |";
        for (size_t e = 1; e < engines.size(); ++e) head += " / " + report.engines[e] + " |";
        for (size_t e = 0; e < 2 * engines.size() - 1; ++e) rule += "---|";
        std::printf("\nMrays/s\n\n%s\n%s\n", head.c_str(), rule.c_str());
    }
    Build build{scene.name, accel->stats().triangles, {}, {}, {}};
    for (const Engine& engine : engines) {
        build.seconds.push_back(engine.build_seconds);
        build.bytes.push_back(engine.bytes);
        build.peak_bytes.push_back(engine.peak_bytes);
    }
    report.builds.push_back(std::move(build));
    for (const unsigned threads : {1u, 2u}) {
        measure(engines, options, sets.primary, false, {scene.name, "primary", threads, {}},
                report);
        measure(engines, options, sets.ao, true, {scene.name, "ao", threads, {}}, report);
        measure(engines, options, sets.diffuse, false, {scene.name, "diffuse", threads, {}},
                report);
    }
}

// Geometric means of the ratios against each other engine, by kind and number of threads.
void print_means(const Report& report) {
    for (size_t other = 1; other < report.engines.size(); ++other) {
        std::map<std::string, std::pair<double, int>> groups;
        for (const Result& r : report.rates) {
            auto& [sum, count] = groups[r.kind + ", " + std::to_string(r.threads)];
            sum += std::log(r.rates[0] / r.rates[other]);
            ++count;
        }
        std::printf("\nTalbot / %s, geometric means over the scenes:",
                    report.engines[other].c_str());
        for (const auto& [key, group] : groups)
            std::printf(" %s: %.3f;", key.c_str(), std::exp(group.first / group.second));
        std::printf("\n");
    }
}

void print_builds(const Report& report) {
    std::printf(
        "\nBuild with 2 threads, ms; bytes per triangle of the structure and, on top of the "
        "triangles, at most while it is built\n\n");
    std::printf("| scene | triangles |");
    for (const std::string& name : report.engines)
        std::printf(" %s | bytes | peak |", name.c_str());
    std::printf("\n|---|---|");
    for (size_t e = 0; e < report.engines.size(); ++e) std::printf("---|---|---|");
    for (const Build& build : report.builds) {
        std::printf("\n| %s | %llu |", build.scene.c_str(),
                    static_cast<unsigned long long>(build.triangles));
        for (size_t e = 0; e < build.seconds.size(); ++e) {
            const auto triangles = static_cast<double>(build.triangles);
            std::printf(" %.1f | %.0f | %.0f |", 1e3 * build.seconds[e], build.bytes[e] / triangles,
                        build.peak_bytes[e] / triangles);
        }
    }
    std::printf("\n");
}

// What the structure is worth beside testing every object: spheres strewn in a cube.
void run_speedups(const Options& options, Report& report) {
    std::printf("\nAgainst testing every object (spheres, primary rays, 1 thread, Mrays/s)\n\n");
    std::printf("| objects | Talbot | brute force | speed-up |\n|---|---|---|---|\n");
    for (const uint32_t count : {12u, 1000u}) {
        test::Rng rng(count);
        test::SceneData data;
        const float radius = 0.25f / std::cbrt(static_cast<float>(count));
        for (uint32_t i = 0; i < count; ++i)
            data.spheres.push_back({Vec3d(rng.in_box(0, 1)), radius});
        WorkerPool pool(2);
        const auto accel = build_accel(data.input(), pool);
        const auto brute = build_brute_force(data.input());
        const auto rays = primary_rays({Vec3f(0.5f, 0.5f, 2), Vec3f(0.5f), 40}, 128);
        std::vector<double> fast;
        std::vector<double> slow;
        uint64_t hits = 0;
        for (int round = 0; round < options.rounds; ++round) {
            fast.push_back(rate(talbot_engine("", *accel), rays, false, 1, hits));
            slow.push_back(rate(talbot_engine("", *brute), rays, false, 1, hits));
        }
        std::printf("| %u | %.2f | %.3f | %.1f |\n", count, median(fast), median(slow),
                    median(fast) / median(slow));
        report.speedups.push_back({{"objects", count},
                                   {"mrays_per_second", median(fast)},
                                   {"brute_force_mrays_per_second", median(slow)}});
    }
}

// Spheres of more and more triangles: rays per second and build time per triangle.
void run_growth(const Options& options, Report& report) {
    std::printf("\nGrowth (displaced sphere, 1 thread, Mrays/s; build with 2 threads)\n\n");
    std::printf(
        "| triangles | primary | ao | diffuse | fast build, ns per triangle | high | bytes |\n");
    std::printf("|---|---|---|---|---|---|---|\n");
    for (const uint32_t n : {9u, 29u, 91u, 289u, 913u}) {
        if (options.quick && n > 289) break;
        const BenchScene scene{"growth",
                               test::scene_of(test::displaced_sphere(n, 0.1f)),
                               {Vec3f(0.5f, 1, 2.5f), Vec3f(0), 45}};
        WorkerPool pool(2);
        const double fast_seconds =
            build_accel(scene.data.input(BuildQuality::fast), pool)->stats().build_seconds;
        const auto accel = build_accel(scene.data.input(), pool);
        const RaySets sets = make_ray_sets(scene, *accel, 256);
        std::vector<double> primary;
        std::vector<double> ao;
        std::vector<double> diffuse;
        uint64_t hits = 0;
        for (int round = 0; round < options.rounds; ++round) {
            primary.push_back(rate(talbot_engine("", *accel), sets.primary, false, 1, hits));
            ao.push_back(rate(talbot_engine("", *accel), sets.ao, true, 1, hits));
            diffuse.push_back(rate(talbot_engine("", *accel), sets.diffuse, false, 1, hits));
        }
        const auto triangles = static_cast<double>(accel->stats().triangles);
        const double fast_ns = 1e9 * fast_seconds / triangles;
        const double ns = 1e9 * accel->stats().build_seconds / triangles;
        const double bytes = static_cast<double>(accel->stats().bytes) / triangles;
        std::printf("| %.0f | %.2f | %.2f | %.2f | %.0f | %.0f | %.0f |\n", triangles,
                    median(primary), median(ao), median(diffuse), fast_ns, ns, bytes);
        std::fflush(stdout);
        report.growth.push_back({{"triangles", accel->stats().triangles},
                                 {"primary_mrays_per_second", median(primary)},
                                 {"ao_mrays_per_second", median(ao)},
                                 {"diffuse_mrays_per_second", median(diffuse)},
                                 {"fast_build_ns_per_triangle", fast_ns},
                                 {"build_ns_per_triangle", ns},
                                 {"bytes_per_triangle", bytes}});
    }
}

bool write_json(const std::string& file, const Report& report) {
    json out = {{"schema", "talbot-bench-rays/1"}, {"about", heading()},
                {"rates", json::array()},          {"builds", json::array()},
                {"brute_force", report.speedups},  {"growth", report.growth}};
    for (const Result& r : report.rates) {
        json rates;
        for (size_t e = 0; e < r.rates.size(); ++e) rates[report.engines[e]] = r.rates[e];
        out["rates"].push_back({{"scene", r.scene},
                                {"kind", r.kind},
                                {"threads", r.threads},
                                {"mrays_per_second", rates}});
    }
    for (const Build& b : report.builds) {
        json engines;
        for (size_t e = 0; e < b.seconds.size(); ++e)
            engines[report.engines[e]] = {
                {"seconds", b.seconds[e]}, {"bytes", b.bytes[e]}, {"peak_bytes", b.peak_bytes[e]}};
        out["builds"].push_back(
            {{"scene", b.scene}, {"triangles", b.triangles}, {"engines", engines}});
    }
    std::ofstream stream(file);
    stream << out.dump(1) << "\n";
    stream.close();
    if (!stream) std::fprintf(stderr, "bench_rays: cannot write %s\n", file.c_str());
    return static_cast<bool>(stream);
}

int run(const Options& options) {
    std::printf("%s\n", heading().c_str());
    Report report;
    for (const auto& [name, make] : bench_scenes(options.models)) {
        if (options.scene.empty() || options.scene == name) run_scene(make(), options, report);
    }
    if (report.rates.empty()) {
        std::fprintf(stderr, "bench_rays: there is no scene '%s'\n", options.scene.c_str());
        return 2;
    }
    print_means(report);
    print_builds(report);
    if (options.scene.empty()) {
        run_speedups(options, report);
        run_growth(options, report);
    }
    return options.json.empty() || write_json(options.json, report) ? 0 : 4;
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
        } else if (word == "--models" && has_value) {
            options.models = argv[++i];
        } else if (word == "--json" && has_value) {
            options.json = argv[++i];
        } else if (word == "--rounds" && has_value) {
            options.rounds = std::max(1, std::atoi(argv[++i]));
        } else {
            std::fprintf(stderr,
                         "usage: bench_rays [--quick] [--scene NAME] [--models DIR] [--rounds N] "
                         "[--json FILE]\nDIR holds the models of the Khronos sample assets that "
                         "are measured too, one folder each.\n");
            return 2;
        }
    }
    try {
        return talbot::bench::run(options);
    } catch (const std::exception& failure) {
        std::fprintf(stderr, "bench_rays: %s\n", failure.what());
        return 3;
    }
}
