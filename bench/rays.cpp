// Rays per second, build time and memory of Talbot's structure, built well and built fast, against
// Embree's in its default, its robust and its high-quality mode: same triangles, same rays, one
// process, single-ray calls (and neighbours together, see Search), runs interleaved, medians. Rates
// are per second of each thread's own processor time. Then what the structure is worth beside
// testing everything, and how cost grows with the number of triangles.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>

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
    std::string part;  // empty: all
    int rounds = 5;

    bool wants(const char* name) const { return part.empty() || part == name; }
};

constexpr const char* kParts[] = {"rates", "builds", "growth"};

struct Result {
    std::string scene;
    std::string kind;
    unsigned threads = 1;
    bool is_extra = false;
    std::vector<double> rates;  // one per engine
};

struct Build {
    std::string scene;
    uint64_t triangles = 0;
    std::vector<double> seconds;
    std::vector<double> cpu_seconds;
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
             const std::vector<Ray>& rays, Search search, Result result, Report& report) {
    std::vector<std::vector<double>> rates(engines.size());
    std::vector<uint64_t> hits(engines.size());
    for (int round = 0; round < options.rounds; ++round) {
        for (size_t e = 0; e < engines.size(); ++e)
            rates[e].push_back(rate(engines[e], rays, search, result.threads, hits[e]));
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

void run_rates(const BenchScene& scene, bool is_extra, const Options& options, Report& report) {
    WorkerPool pool(2);
    std::vector<Engine> engines;
    for (const EngineMaker& maker : engine_makers(scene.data)) engines.push_back(maker.make(pool));
    const auto accel = build_accel(scene.data.input(), pool);
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
    for (const unsigned threads : {1u, 2u}) {
        const auto run = [&](const char* kind, const std::vector<Ray>& rays, Search search) {
            measure(engines, options, rays, search, {scene.name, kind, threads, is_extra, {}},
                    report);
        };
        run("primary", sets.primary, Search::closest);
        run("primary, together", sets.primary, Search::together);
        run("ao", sets.ao, Search::any);
        run("diffuse", sets.diffuse, Search::closest);
    }
}

// Geometric means of the ratios against each other engine, by kind and number of threads.
void print_means(const Report& report, bool with_extra) {
    for (size_t other = 1; other < report.engines.size(); ++other) {
        std::map<std::string, std::pair<double, int>> groups;
        for (const Result& r : report.rates) {
            if (r.is_extra && !with_extra) continue;
            auto& [sum, count] = groups[r.kind + ", " + std::to_string(r.threads)];
            sum += std::log(r.rates[0] / r.rates[other]);
            ++count;
        }
        if (groups.empty()) continue;
        std::printf("\nTalbot / %s, geometric means over %s:", report.engines[other].c_str(),
                    with_extra ? "all scenes" : "the main scenes (without hall and cornell)");
        for (const auto& [key, group] : groups)
            std::printf(" %s: %.3f;", key.c_str(), std::exp(group.first / group.second));
        std::printf("\n");
    }
}

struct BuildFigures {
    double seconds = 0;
    double cpu_seconds = 0;
    double bytes = 0;
    double peak_bytes = 0;
};

// Builds in a process of its own, so that no engine uses memory that a build before it has kept.
BuildFigures build_apart(const BenchScene& scene, const EngineMaker& maker) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("there is no pipe");
    BuildFigures figures;
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("there is no process");
    if (child == 0) {
        WorkerPool pool(2);
        const Engine engine = maker.make(pool);
        figures = {engine.build_seconds, engine.build_cpu_seconds, engine.bytes, engine.peak_bytes};
        const bool sent = write(ends[1], &figures, sizeof figures) == sizeof figures;
        _exit(sent ? 0 : 1);
    }
    close(ends[1]);
    const bool is_whole = read(ends[0], &figures, sizeof figures) == sizeof figures;
    close(ends[0]);
    waitpid(child, nullptr, 0);
    if (!is_whole) throw std::runtime_error(maker.name + " could not build " + scene.name);
    return figures;
}

// Build times and memory of all engines, built in turn.
void run_builds(const BenchScene& scene, const Options& options, Report& report) {
    const std::vector<EngineMaker> makers = engine_makers(scene.data);
    std::vector<std::vector<BuildFigures>> figures(makers.size());
    for (int round = 0; round < options.rounds; ++round) {
        for (size_t e = 0; e < makers.size(); ++e)
            figures[e].push_back(build_apart(scene, makers[e]));
    }
    Build build{scene.name, 0, {}, {}, {}, {}};
    for (const AccelMesh& mesh : scene.data.input().meshes)
        build.triangles += mesh.indices.size() / 3;
    const bool is_first = report.builds.empty();
    if (report.engines.empty()) {
        for (const EngineMaker& maker : makers) report.engines.push_back(maker.name);
    }
    for (const auto& rounds : figures) {
        const auto of = [&](double BuildFigures::*member) {
            std::vector<double> values;
            for (const BuildFigures& f : rounds) values.push_back(f.*member);
            return median(values);
        };
        build.seconds.push_back(of(&BuildFigures::seconds));
        build.cpu_seconds.push_back(of(&BuildFigures::cpu_seconds));
        build.bytes.push_back(of(&BuildFigures::bytes));
        build.peak_bytes.push_back(of(&BuildFigures::peak_bytes));
    }
    if (is_first) {
        std::printf(
            "\nBuild with 2 threads: ms, ms of processor time; bytes per triangle of the structure "
            "and, on top of the triangles, at most while it is built\n\n| scene | triangles |");
        for (const std::string& name : report.engines)
            std::printf(" %s | cpu | bytes | peak |", name.c_str());
        std::printf("\n|---|---|");
        for (size_t e = 0; e < report.engines.size(); ++e) std::printf("---|---|---|---|");
        std::printf("\n");
    }
    std::printf("| %s | %llu |", build.scene.c_str(),
                static_cast<unsigned long long>(build.triangles));
    for (size_t e = 0; e < build.seconds.size(); ++e) {
        const auto triangles = static_cast<double>(build.triangles);
        std::printf(" %.1f | %.1f | %.1f | %.0f |", 1e3 * build.seconds[e],
                    1e3 * build.cpu_seconds[e], build.bytes[e] / triangles,
                    build.peak_bytes[e] / triangles);
    }
    std::printf("\n");
    std::fflush(stdout);
    report.builds.push_back(std::move(build));
}

struct SpeedupScene {
    std::string name;
    std::shared_ptr<const Accel> accel;
    std::shared_ptr<const Accel> brute;
    View view;
};

SpeedupScene strewn_spheres(uint32_t count, WorkerPool& pool) {
    test::Rng rng(count);
    test::SceneData data;
    const float radius = 0.25f / std::cbrt(static_cast<float>(count));
    for (uint32_t i = 0; i < count; ++i) data.spheres.push_back({Vec3d(rng.in_box(0, 1)), radius});
    return {std::to_string(count) + " spheres in a cube",
            build_accel(data.input(), pool),
            build_brute_force(data.input()),
            {Vec3f(0.5f, 0.5f, 2), Vec3f(0.5f), 40}};
}

// A built-in scene from its first camera.
SpeedupScene built_in(const std::string& name, WorkerPool& pool) {
    auto desc = load_gltf(TALBOT_SOURCE_DIR "/assets/scenes/" + name);
    if (!desc) throw std::runtime_error(desc.error().line());
    SceneBuildOptions plain;
    plain.brute_force = true;
    const auto slow = Scene::build(*desc, pool, plain);
    const auto scene = Scene::build(std::move(*desc), pool, {});
    const Camera& camera = scene->cameras().front();
    const Vec3d eye = camera.position - scene->geometry().origin;
    return {name + ": " + std::to_string(scene->geometry().objects.size()) + " objects, " +
                std::to_string(scene->geometry().accel->stats().triangles) + " triangles",
            scene->geometry().accel,
            slow->geometry().accel,
            {Vec3f(eye), Vec3f(eye + camera.forward()),
             static_cast<float>(camera.yfov * 180 / std::numbers::pi)}};
}

// What the structure is worth beside testing everything: a dozen objects and a thousand.
void run_speedups(const Options& options, Report& report) {
    std::printf("\nAgainst testing everything (primary rays, 1 thread, Mrays/s)\n\n");
    std::printf("| scene | Talbot | brute force | speed-up |\n|---|---|---|---|\n");
    WorkerPool pool(2);
    for (const SpeedupScene& scene :
         {strewn_spheres(12, pool), strewn_spheres(1000, pool), built_in("spheres.gltf", pool),
          built_in("report-extended.gltf", pool)}) {
        const auto rays = primary_rays(scene.view, 128);
        std::vector<double> fast;
        std::vector<double> slow;
        uint64_t hits = 0;
        for (int round = 0; round < options.rounds; ++round) {
            fast.push_back(rate(talbot_engine("", scene.accel), rays, Search::closest, 1, hits));
            slow.push_back(rate(talbot_engine("", scene.brute), rays, Search::closest, 1, hits));
        }
        std::printf("| %s | %.2f | %.3f | %.1f |\n", scene.name.c_str(), median(fast), median(slow),
                    median(fast) / median(slow));
        report.speedups.push_back({{"scene", scene.name},
                                   {"mrays_per_second", median(fast)},
                                   {"brute_force_mrays_per_second", median(slow)}});
    }
}

// Spheres of more and more triangles: rays per second and build time per triangle.
void run_growth(const Options& options, Report& report) {
    std::printf(
        "\nGrowth (displaced sphere, 1 thread, Mrays/s; builds in processor time of 2 "
        "threads)\n\n");
    std::printf(
        "| triangles | primary | ao | diffuse | fast build, ns per triangle | high | bytes |\n");
    std::printf("|---|---|---|---|---|---|---|\n");
    for (const uint32_t n : {9u, 29u, 91u, 289u, 913u}) {
        if (options.quick && n > 289) break;
        const BenchScene scene{"growth",
                               test::scene_of(test::displaced_sphere(n, 0.1f)),
                               {Vec3f(0.5f, 1, 2.5f), Vec3f(0), 45}};
        WorkerPool pool(2);
        const auto build_ns = [&](BuildQuality quality) {
            std::vector<double> ns;
            for (int round = 0; round < std::min(options.rounds, 3); ++round) {
                const double start = process_seconds();
                const auto built = build_accel(scene.data.input(quality), pool);
                ns.push_back(1e9 * (process_seconds() - start) /
                             static_cast<double>(built->stats().triangles));
            }
            return median(ns);
        };
        const double fast_ns = build_ns(BuildQuality::fast);
        const double ns = build_ns(BuildQuality::high);
        const std::shared_ptr<const Accel> accel = build_accel(scene.data.input(), pool);
        const RaySets sets = make_ray_sets(scene, *accel, 256);
        std::vector<double> primary;
        std::vector<double> ao;
        std::vector<double> diffuse;
        uint64_t hits = 0;
        for (int round = 0; round < options.rounds; ++round) {
            primary.push_back(
                rate(talbot_engine("", accel), sets.primary, Search::closest, 1, hits));
            ao.push_back(rate(talbot_engine("", accel), sets.ao, Search::any, 1, hits));
            diffuse.push_back(
                rate(talbot_engine("", accel), sets.diffuse, Search::closest, 1, hits));
        }
        const auto triangles = static_cast<double>(accel->stats().triangles);
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
            engines[report.engines[e]] = {{"seconds", b.seconds[e]},
                                          {"cpu_seconds", b.cpu_seconds[e]},
                                          {"bytes", b.bytes[e]},
                                          {"peak_bytes", b.peak_bytes[e]}};
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
    const std::vector<SceneMaker> makers = bench_scenes(options.models);
    const auto is_wanted = [&](const SceneMaker& maker) {
        return options.scene.empty() || options.scene == maker.name;
    };
    if (std::none_of(makers.begin(), makers.end(), is_wanted)) {
        std::fprintf(stderr, "bench_rays: there is no scene '%s'\n", options.scene.c_str());
        return 2;
    }
    if (options.wants("rates")) {
        for (const SceneMaker& maker : makers) {
            if (is_wanted(maker)) run_rates(maker.make(), maker.is_extra, options, report);
        }
        print_means(report, false);
        const auto is_extra = [](const Result& r) { return r.is_extra; };
        if (std::any_of(report.rates.begin(), report.rates.end(), is_extra))
            print_means(report, true);
    }
    if (options.wants("builds")) {
        for (const SceneMaker& maker : makers) {
            if (is_wanted(maker)) run_builds(maker.make(), options, report);
        }
    }
    if (options.scene.empty() && options.wants("growth")) {
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
        } else if (word == "--part" && has_value &&
                   std::ranges::count(talbot::bench::kParts, std::string(argv[i + 1])) > 0) {
            options.part = argv[++i];
        } else if (word == "--models" && has_value) {
            options.models = argv[++i];
        } else if (word == "--json" && has_value) {
            options.json = argv[++i];
        } else if (word == "--rounds" && has_value) {
            options.rounds = std::max(1, std::atoi(argv[++i]));
        } else {
            std::fprintf(stderr,
                         "usage: bench_rays [--quick] [--part rates|builds|growth] [--scene NAME] "
                         "[--models DIR] [--rounds N] [--json FILE]\nDIR holds the models of the "
                         "Khronos sample assets that "
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
