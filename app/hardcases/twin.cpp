#include "app/hardcases/twin.h"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/exit_code.h"
#include "app/hardcases/report.h"
#include "app/interrupt.h"
#include "app/scene_setup.h"

namespace talbot::hardcases {
namespace {

using nlohmann::ordered_json;

constexpr Resolution kTwinSize{96, 96};
constexpr uint64_t kTwinSamples = 16;

Result<twin::Comparison> compare(const Options& options, const SceneDesc& desc,
                                 twin::Budget& budget) {
    WorkerPool pool(options.threads);
    const auto scene = Scene::build(desc, pool);
    const Result<Camera> camera = choose_camera(options, *scene);
    if (!camera) return camera.error();
    const Resolution size = options.size.value_or(kTwinSize);
    budget = {size.width, size.height, options.frames.value_or(kTwinSamples)};
    const PathSettings settings = path_settings(options.render);
    const LightSampling sampling = light_sampling(options.render);
    PathSettings other = settings;
    ++other.seed;
    const auto own =
        twin::make_float_tracer(desc, *camera, settings, size.width, size.height, pool, sampling);
    const auto twin =
        twin::make_double_tracer(desc, *camera, settings, size.width, size.height, sampling);
    const auto again =
        twin::make_double_tracer(desc, *camera, other, size.width, size.height, sampling);
    return twin::compare_twins(*own, *twin, *again, budget, pool, is_interrupted);
}

}  // namespace

std::string broken_twin(const twin::Comparison& c) {
    if (c.nonfinite > 0) return "samples are no numbers";
    if (!(c.share_of_noise() <= kTwinShareOfNoise)) return "too large beside the Monte Carlo error";
    if (!(c.together <= kTwinTogether)) return "samples that go the same way differ by too much";
    if (!(std::abs(c.bias) <= kTwinBiasErrors * c.bias_error + kTwinTogether))
        return "the picture's mean is off";
    return "";
}

Result<TwinReport> run_twin(const Options& options) {
    if (options.render.forced_on != EffectSet{} || options.render.forced_off != EffectSet{})
        return usage_error("--effects", "the twin calculates every effect; leave this out");
    const auto start = std::chrono::steady_clock::now();
    leave_on_interrupt();
    const Result<SceneDesc> desc = load_scene(options);
    if (!desc) return desc.error();
    note_interrupts();
    TwinReport report;
    report.scene_file = desc->file;
    Result<twin::Comparison> comparison = compare(options, *desc, report.budget);
    if (!comparison) return comparison.error();
    report.comparison = std::move(*comparison);
    report.interrupted = is_interrupted();
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

ImageRgba twin_difference(const twin::Comparison& comparison) {
    ImageRgba image = comparison.own;
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        image.rgb[i] = glm::abs(image.rgb[i] - comparison.twin.rgb[i]);
    return image;
}

std::string twin_json(const TwinReport& report) {
    const twin::Comparison& c = report.comparison;
    ordered_json reasons;
    for (std::size_t i = 0; i < twin::kPartings; ++i)
        reasons[std::string(twin::kPartingNames[i])] = c.by_reason[i];
    ordered_json worst = ordered_json::array();
    for (const twin::PartedSample& s : c.worst) {
        worst.push_back({{"pixel", {s.x, s.y}},
                         {"sample", s.sample},
                         {"vertex", s.vertex},
                         {"why", twin::kPartingNames[static_cast<std::size_t>(s.why)]},
                         {"change", s.change}});
    }
    const std::string broken = broken_twin(c);
    const ordered_json j{{"schema", "talbot-twin/1"},
                         {"version", TALBOT_VERSION},
                         {"scene", report.scene_file},
                         {"size", {report.budget.width, report.budget.height}},
                         {"samples_per_pixel", report.budget.samples},
                         {"samples", c.samples},
                         {"parted", c.parted},
                         {"parted_by_reason", reasons},
                         {"parted_by_vertex", c.by_vertex},
                         {"together_relative_rms", c.together},
                         {"relmse", c.relmse},
                         {"noise_relmse", c.noise},
                         {"share_of_noise", c.share_of_noise()},
                         {"bias", c.bias},
                         {"bias_standard_error", c.bias_error},
                         {"nonfinite", c.nonfinite},
                         {"worst", std::move(worst)},
                         {"seconds", report.seconds},
                         {"interrupted", report.interrupted},
                         {"kept", broken.empty() && c.samples > 0 && !report.interrupted},
                         {"why", broken}};
    return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

void print_twin(const TwinReport& report, std::FILE* out) {
    const twin::Comparison& c = report.comparison;
    const auto share = [&](uint64_t count) {
        return c.samples > 0 ? 100 * static_cast<double>(count) / static_cast<double>(c.samples)
                             : 0.0;
    };
    std::fprintf(out, "%ux%u pixels, %llu samples each, in float and in double\n",
                 report.budget.width, report.budget.height,
                 static_cast<unsigned long long>(report.budget.samples));
    std::fprintf(out, "relMSE of float against double   %.3g\n", c.relmse);
    std::fprintf(out,
                 "relMSE of the noise              %.3g   float's share of it %.3g (at most %g)\n",
                 c.noise, c.share_of_noise(), kTwinShareOfNoise);
    std::fprintf(out, "samples that part                %.3g %%\n", share(c.parted));
    for (std::size_t i = 0; i < twin::kPartings; ++i) {
        if (c.by_reason[i] == 0) continue;
        std::fprintf(out, "  by %-10s                  %.3g %%\n", twin::kPartingNames[i].data(),
                     share(c.by_reason[i]));
    }
    std::fprintf(out, "  at vertex 1, 2, ...           ");
    for (const uint64_t count : c.by_vertex) std::fprintf(out, " %.2g", share(count));
    std::fprintf(out,
                 " %%\nsamples that do not: differ by   %.3g of their radiance, RMS (at most %g)\n",
                 c.together, kTwinTogether);
    std::fprintf(out, "mean of the picture off by       %.2g +- %.2g\n", c.bias, c.bias_error);
    for (const twin::PartedSample& s : c.worst) {
        std::fprintf(
            out, "  --pixel %u,%u --sample %llu: %s at vertex %u, changes its pixel by %.2g\n", s.x,
            s.y, static_cast<unsigned long long>(s.sample),
            twin::kPartingNames[static_cast<std::size_t>(s.why)].data(), s.vertex + 1, s.change);
    }
    const std::string broken = broken_twin(c);
    const std::string verdict = report.interrupted ? "interrupted: no verdict"
                                : c.samples == 0   ? "no samples"
                                : !broken.empty()  ? "BROKEN: " + broken
                                                   : "KEPT";
    std::fprintf(out, "%s; %.1f s\n", verdict.c_str(), report.seconds);
}

}  // namespace talbot::hardcases
