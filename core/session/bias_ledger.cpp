#include "core/session/bias_ledger.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/accuracy/error_estimate.h"
#include "core/session/render_pass.h"

namespace talbot {
namespace {

constexpr double kPixels = 4096;
constexpr uint64_t kSamples = 16;

// One side: the film at half of the samples and at all, its error and its cost.
struct Side {
    Film half, film;
    ErrorEstimate error;
    double sample_seconds = 0;  // a pixel of the small image
};

class SmallView {
  public:
    SmallView(const std::shared_ptr<const Scene>& scene, const Camera& camera, double exposure_ev,
              WorkerPool& pool, const std::stop_token& stop)
        : scene_(scene), camera_(camera), exposure_ev_(exposure_ev), pool_(pool), stop_(stop) {}

    // Empty when stopped.
    std::optional<Side> render(const RenderSettings& settings) {
        Side side;
        side.film = Film(settings.width, settings.height);
        ErrorTracker tracker;
        tracker.reset(static_cast<float>(exposure_ev_));
        view_ = ViewMoments(prepare_view(scene_, camera_, settings, pool_, &view_.view()));
        double seconds = 0;
        for (uint64_t n = 1; n <= kSamples; n *= 2) {
            side.half = side.film;
            std::stop_source stop;
            const std::stop_callback ask(stop_, [&stop] { stop.request_stop(); });
            TileCounts counts;
            const auto start = std::chrono::steady_clock::now();
            if (!render_pass(view_, settings, n, side.film, pool_, stop, {}, counts))
                return std::nullopt;
            seconds +=
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            tracker.observe(side.film, n, seconds, &pool_);
        }
        side.error = tracker.estimate();
        side.sample_seconds = seconds / (kSamples * static_cast<double>(side.film.pixels().size()));
        return side;
    }

  private:
    const std::shared_ptr<const Scene> scene_;
    const Camera& camera_;
    ViewMoments view_;
    const double exposure_ev_;
    WorkerPool& pool_;
    const std::stop_token stop_;
};

}  // namespace

std::vector<BiasedSwitch> biased_switches(const RenderSettings& settings) {
    std::vector<BiasedSwitch> list;
    const RenderSettings defaults;
    if (settings.max_depth < defaults.max_depth) {
        BiasedSwitch depth{"max-depth " + std::to_string(settings.max_depth), settings};
        depth.unbiased.max_depth = defaults.max_depth;
        list.push_back(std::move(depth));
    }
    for (const EffectInfo& info : kEffects) {
        if (!settings.forced_off.has(info.effect)) continue;
        BiasedSwitch effect{"effects -" + std::string(info.name), settings};
        effect.unbiased.forced_off.remove(info.effect);
        list.push_back(std::move(effect));
    }
    return list;
}

double loss_after(const ConvergenceFit& biased, double biased_cost, double floor_percent,
                  const ConvergenceFit& unbiased, double unbiased_cost) {
    const double floor = floor_percent * floor_percent / 10000;
    const auto is_loss = [&](double seconds) {
        return floor + biased.smooth(seconds / biased_cost) >=
               unbiased.smooth(seconds / unbiased_cost);
    };
    // From one sample on; the first crossing is looked for among doublings, then bisected.
    constexpr double kMostDoublings = 50;
    const double start = std::max(biased_cost, unbiased_cost);
    if (!(start > 0) || is_loss(start)) return 0;
    double low = 0, high = 0;
    while (!is_loss(start * std::exp2(high))) {
        low = high++;
        if (high > kMostDoublings) return HUGE_VAL;
    }
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (is_loss(start * std::exp2(middle)) ? high : low) = middle;
    }
    return start * std::exp2(high);
}

std::vector<BiasEntry> measure_bias(const std::shared_ptr<const Scene>& scene, const Camera& camera,
                                    const RenderSettings& settings, double exposure_ev,
                                    WorkerPool& pool, const std::stop_token& stop) {
    std::vector<BiasEntry> ledger;
    const double pixels = static_cast<double>(settings.width) * settings.height;
    RenderSettings small = settings;
    const double scale = std::min(1.0, std::sqrt(kPixels / pixels));
    small.width = std::max(1u, static_cast<uint32_t>(std::lround(settings.width * scale)));
    small.height = std::max(1u, static_cast<uint32_t>(std::lround(settings.height * scale)));
    // What the scene does not use is off anyway.
    if (small.forced_off != EffectSet{})
        small.forced_off = small.forced_off & analyse_effects(*scene, camera).active;
    const std::vector<BiasedSwitch> switches = biased_switches(small);
    if (switches.empty()) return ledger;
    SmallView view(scene, camera, exposure_ev, pool, stop);
    const std::optional<Side> own = view.render(small);
    if (!own) return {};
    for (const BiasedSwitch& biased : switches) {
        const std::optional<Side> base = view.render(biased.unbiased);
        if (!base) return {};
        BiasEntry entry{biased.name,
                        measure_floor(own->half, own->film, base->half, base->film, exposure_ev),
                        std::nullopt};
        if (entry.floor.significant) {
            entry.loss_after_seconds = loss_after(own->error.fit, own->sample_seconds * pixels,
                                                  entry.floor.relrmse_percent, base->error.fit,
                                                  base->sample_seconds * pixels);
        }
        ledger.push_back(std::move(entry));
    }
    return ledger;
}

}  // namespace talbot
