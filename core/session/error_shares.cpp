// With c_k the part k of a pixel and T their sum, var T = sum of cov(c_k, T): what cov(c_k, T) is
// of it is the share of k. Variances are those between renders with seeds of their own, as in a
// scrambled sequence single samples are no measure.
#include "core/session/error_shares.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "core/accuracy/error_estimate.h"
#include "core/integrate/path_kinds.h"
#include "core/session/prepared_view.h"

namespace talbot {
namespace {

constexpr uint64_t kShareSamples = 8;  // a pixel and render
constexpr uint64_t kLeastRenders = 4, kMostRenders = 64;
constexpr std::size_t kNamedLights = 8;
constexpr uint32_t kRadius = 3;  // of the window that r is the mean over
constexpr double kWorthwhile = 1.1;

// Which slot of a pixel's accumulators a part goes to: kinds first, then lights.
class Slots {
  public:
    explicit Slots(const RenderScene& scene) : scene_(scene) {
        std::map<uint32_t, double> power;
        const LightTable& lights = scene.lights();
        for (const Light& light : lights.lights()) {
            if (light.kind == LightKind::triangle || light.kind == LightKind::quad ||
                light.kind == LightKind::sphere)
                power[scene.scene().object_of(light.id)] += light.power;
        }
        std::vector<std::pair<double, uint32_t>> order;
        for (const auto& [object, p] : power) order.push_back({-p, object});
        std::sort(order.begin(), order.end());
        for (const auto& [p, object] : order) {
            if (objects_.size() < kNamedLights) objects_.push_back(object);
        }
    }

    std::size_t count() const { return kPathKinds + objects_.size() + 3; }
    std::size_t of_kind(PathKind kind) const { return static_cast<std::size_t>(kind); }
    std::size_t of_source(uint32_t source) const {
        if (source == kEnvironmentSource) return kPathKinds;
        if (source == kPunctualSource) return kPathKinds + 1;
        const auto found = std::find(objects_.begin(), objects_.end(), source);
        return found == objects_.end()
                   ? count() - 1
                   : kPathKinds + 2 + static_cast<std::size_t>(found - objects_.begin());
    }
    std::string name(std::size_t slot) const {
        if (slot < kPathKinds) return std::string(kPathKindTable[slot].name);
        if (slot == kPathKinds) return "environment";
        if (slot == kPathKinds + 1) return "punctual lights";
        if (slot == count() - 1) return "other surfaces";
        return scene_.scene().objects()[objects_[slot - kPathKinds - 2]].name;
    }
    std::string label(std::size_t slot) const {
        return slot < kPathKinds ? std::string(kPathKindTable[slot].label) : name(slot);
    }

  private:
    const RenderScene& scene_;
    std::vector<uint32_t> objects_;
};

struct Part {
    double relmse = 0;  // of one render
    double share = 0;
    double share_sd = 0;
    double light = 0;  // sum
};

// What one configuration shows.
struct Measurement {
    std::vector<Part> parts;  // by slot
    double relmse = 0;        // of one render
    double light = 0;
    double rays = 0;  // a sample
    uint64_t renders = 0;
};

class Diagnosis {
  public:
    Diagnosis(const RenderScene& scene, const Camera& camera, const RenderSettings& settings,
              const Slots& slots)
        : scene_(scene),
          settings_(settings),
          path_(path_settings(settings)),
          camera_(camera, scene.scene().origin(), settings.width, settings.height,
                  scene.scene().geometry().bounds),
          slots_(slots),
          pixels_(std::size_t{settings.width} * settings.height),
          cells_(pixels_ * 3 * (slots.count() + 1)) {}

    // One more render; false when stopped within.
    bool render(WorkerPool& pool, const std::stop_token& stop) {
        constexpr uint64_t kSeedStep = 0x9E3779B97F4A7C15;
        PathSettings own = path_;
        own.seed = settings_.seed + kSeedStep * (renders_ + 1);
        std::vector<uint64_t> rays(settings_.height);
        pool.parallel_for(
            settings_.height,
            [&](uint64_t row, unsigned) {
                PathSorter sorter(scene_, camera_, own);
                std::vector<double> sums(3 * (slots_.count() + 1));
                const uint32_t y = static_cast<uint32_t>(row);
                for (uint32_t x = 0; x < settings_.width; ++x) {
                    if (stop.stop_requested()) return;
                    std::fill(sums.begin(), sums.end(), 0.0);
                    for (uint64_t s = 0; s < kShareSamples; ++s)
                        rays[row] += sample(sorter, x, y, s, sums);
                    keep(std::size_t{y} * settings_.width + x, sums);
                }
            },
            stop);
        if (stop.stop_requested()) return false;
        ++renders_;
        for (const uint64_t r : rays) rays_ += r;
        return true;
    }

    uint64_t renders() const { return renders_; }

    Measurement result(double constant) const {
        Measurement m;
        m.renders = renders_;
        m.rays = static_cast<double>(rays_) /
                 (static_cast<double>(renders_ * kShareSamples) * static_cast<double>(pixels_));
        m.parts.resize(slots_.count());
        const std::vector<double> r = window_means();
        const std::size_t total = slots_.count();
        std::vector<double> pixel_parts(slots_.count() * pixels_);
        std::vector<double> pixel_total(pixels_);
        for (std::size_t p = 0; p < pixels_; ++p) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double weight = 1 / (r[3 * p + c] * r[3 * p + c] + constant);
                pixel_total[p] += weight * covariance(p, c, total);
                m.light += cell(p, c, total).sum;
                for (std::size_t k = 0; k < total; ++k) {
                    pixel_parts[k * pixels_ + p] += weight * covariance(p, c, k);
                    m.parts[k].light += cell(p, c, k).sum;
                }
            }
            m.relmse += pixel_total[p];
        }
        if (!(m.relmse > 0)) return m;
        for (std::size_t k = 0; k < total; ++k) {
            double sum = 0, square = 0;
            for (std::size_t p = 0; p < pixels_; ++p) sum += pixel_parts[k * pixels_ + p];
            const double share = sum / m.relmse;
            for (std::size_t p = 0; p < pixels_; ++p) {
                const double off = pixel_parts[k * pixels_ + p] - share * pixel_total[p];
                square += off * off;
            }
            const double n = 3 * static_cast<double>(pixels_);
            m.parts[k] = {sum / n, share, std::sqrt(square) / m.relmse, m.parts[k].light};
        }
        m.relmse /= 3 * static_cast<double>(pixels_);
        return m;
    }

  private:
    // Over renders, of a part's mean: its sum, and that of its product with the whole.
    struct Cell {
        double sum = 0;
        double product = 0;
    };
    const Cell& cell(std::size_t pixel, std::size_t c, std::size_t slot) const {
        return cells_[(pixel * 3 + c) * (slots_.count() + 1) + slot];
    }

    uint64_t sample(PathSorter& sorter, uint32_t x, uint32_t y, uint64_t s,
                    std::vector<double>& sums) const {
        const PathSample path = sorter.trace(x, y, s);
        if (!is_finite(path.Li)) return path.rays;
        const auto add = [&](std::size_t slot, const Rgb& radiance) {
            for (std::size_t c = 0; c < 3; ++c)
                sums[3 * slot + c] += static_cast<double>(radiance[static_cast<int>(c)]);
        };
        for (const PathSorter::Part& part : sorter.parts()) {
            add(slots_.of_kind(part.kind), part.radiance);
            add(slots_.of_source(part.source), part.radiance);
            add(slots_.count(), part.radiance);
        }
        return path.rays;
    }

    void keep(std::size_t pixel, const std::vector<double>& sums) {
        const std::size_t stride = slots_.count() + 1;
        for (std::size_t c = 0; c < 3; ++c) {
            const double whole = sums[3 * (stride - 1) + c] / static_cast<double>(kShareSamples);
            for (std::size_t k = 0; k < stride; ++k) {
                Cell& to = cells_[(pixel * 3 + c) * stride + k];
                const double mean = sums[3 * k + c] / static_cast<double>(kShareSamples);
                to.sum += mean;
                to.product += mean * whole;
            }
        }
    }

    double covariance(std::size_t pixel, std::size_t c, std::size_t slot) const {
        const double n = static_cast<double>(renders_);
        const Cell& part = cell(pixel, c, slot);
        return (part.product - part.sum * cell(pixel, c, slots_.count()).sum / n) / (n - 1);
    }

    std::vector<double> window_means() const {
        const uint32_t w = settings_.width, h = settings_.height;
        std::vector<double> means(3 * pixels_);
        for (uint32_t y = 0; y < h; ++y) {
            for (uint32_t x = 0; x < w; ++x) {
                double sum[3] = {0, 0, 0}, count = 0;
                for (uint32_t v = y > kRadius ? y - kRadius : 0; v <= std::min(y + kRadius, h - 1);
                     ++v) {
                    for (uint32_t u = x > kRadius ? x - kRadius : 0;
                         u <= std::min(x + kRadius, w - 1); ++u) {
                        count += 1;
                        for (std::size_t c = 0; c < 3; ++c)
                            sum[c] += cell(std::size_t{v} * w + u, c, slots_.count()).sum;
                    }
                }
                for (std::size_t c = 0; c < 3; ++c)
                    means[3 * (std::size_t{y} * w + x) + c] =
                        sum[c] / (count * static_cast<double>(renders_));
            }
        }
        return means;
    }

    const RenderScene& scene_;
    const RenderSettings settings_;
    const PathSettings path_;
    const CameraRays camera_;
    const Slots& slots_;
    const std::size_t pixels_;
    std::vector<Cell> cells_;  // by pixel, channel and slot, the whole last
    uint64_t renders_ = 0;
    uint64_t rays_ = 0;
};

// Unbiased settings that might do better.
struct Candidate {
    std::string flag;
    RenderSettings settings;
};
std::vector<Candidate> candidates(const RenderSettings& settings) {
    std::vector<Candidate> list;
    const auto add = [&](const std::string& flag, const auto& change) {
        list.push_back({flag, settings});
        change(list.back().settings);
    };
    if (settings.sampler != SamplerKind::sobol)
        add("--sampler sobol", [](RenderSettings& s) { s.sampler = SamplerKind::sobol; });
    if (settings.lights != LightSelection::tree)
        add("--lights tree", [](RenderSettings& s) { s.lights = LightSelection::tree; });
    if (settings.environment_sampling != EnvironmentSampling::compensated)
        add("--environment-sampling compensated",
            [](RenderSettings& s) { s.environment_sampling = EnvironmentSampling::compensated; });
    if (settings.next_event_estimation)
        add("--no-nee", [](RenderSettings& s) { s.next_event_estimation = false; });
    else
        add("without --no-nee", [](RenderSettings& s) { s.next_event_estimation = true; });
    if (settings.russian_roulette)
        add("--no-roulette", [](RenderSettings& s) { s.russian_roulette = false; });
    else
        add("without --no-roulette", [](RenderSettings& s) { s.russian_roulette = true; });
    return list;
}

void note_help(const std::string& flag, double base, double base_rays, double other,
               double other_rays, std::string& help, double& factor) {
    if (!(base > 0) || !(other > 0)) return;
    const double gain = base * base_rays / (other * other_rays);
    if (gain < std::max(factor, kWorthwhile)) return;
    help = flag;
    factor = gain;
}

}  // namespace

ErrorShares measure_error_shares(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                                 const RenderSettings& settings, const ErrorSharePolicy& policy,
                                 WorkerPool& pool, const std::stop_token& stop) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    const auto spent = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    ErrorShares shares;
    const PreparedView view = prepare_view(scene, camera, settings, pool);
    const RenderScene& render_scene = *view.scene;
    const Slots slots(render_scene);
    RenderSettings small = settings;
    const double all = static_cast<double>(settings.width) * settings.height;
    const double scale = std::min(1.0, std::sqrt(policy.pixels / std::max(all, 1.0)));
    small.width = std::max(1u, static_cast<uint32_t>(std::lround(settings.width * scale)));
    small.height = std::max(1u, static_cast<uint32_t>(std::lround(settings.height * scale)));
    const double constant = metric_constant(static_cast<double>(policy.exposure_ev));

    const std::vector<Candidate> others = candidates(small);
    // Half of the time for the settings as given.
    const auto measure = [&](const RenderSettings& s, double until) -> Measurement {
        Diagnosis diagnosis(render_scene, view.camera, s, slots);
        while (diagnosis.renders() < kMostRenders &&
               (diagnosis.renders() < kLeastRenders || spent() < until)) {
            if (!diagnosis.render(pool, stop)) return {};
        }
        return diagnosis.result(constant);
    };
    const Measurement base = measure(small, 0.5 * policy.budget_seconds);
    if (!(base.relmse > 0)) return shares;

    std::vector<ErrorShare> list(slots.count());
    for (std::size_t k = 0; k < list.size(); ++k) {
        list[k].name = slots.name(k);
        list[k].label = slots.label(k);
        list[k].error = base.parts[k].share;
        list[k].error_sd = base.parts[k].share_sd;
        list[k].light = base.light > 0 ? base.parts[k].light / base.light : 0;
    }
    const double each = 0.5 * policy.budget_seconds / static_cast<double>(others.size());
    for (const Candidate& candidate : others) {
        const Measurement other = measure(candidate.settings, spent() + each);
        if (!(other.relmse > 0)) continue;
        for (std::size_t k = 0; k < list.size(); ++k) {
            note_help(candidate.flag, base.parts[k].relmse, base.rays, other.parts[k].relmse,
                      other.rays, list[k].help, list[k].help_factor);
        }
        note_help(candidate.flag, base.relmse, base.rays, other.relmse, other.rays, shares.help,
                  shares.help_factor);
    }
    const auto by_error = [](const ErrorShare& a, const ErrorShare& b) {
        return a.error > b.error;
    };
    const auto split = list.begin() + kPathKinds;
    constexpr double kNothing = 0.05 / 100, kHardly = 0.01;
    for (ErrorShare& row : list) {
        if (row.error < kHardly) {
            row.help.clear();
            row.help_factor = 1;
        }
    }
    shares.kinds.assign(list.begin(), split);
    for (auto row = split; row != list.end(); ++row) {
        if (row->error > kNothing || row->light > kNothing) shares.lights.push_back(*row);
    }
    std::stable_sort(shares.kinds.begin(), shares.kinds.end(), by_error);
    std::stable_sort(shares.lights.begin(), shares.lights.end(), by_error);
    shares.valid = true;
    shares.samples = kShareSamples;
    shares.renders = base.renders;
    shares.width = small.width;
    shares.height = small.height;
    shares.seconds = spent();
    return shares;
}

}  // namespace talbot
