#include "core/session/effect_ledger.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/accuracy/error_estimate.h"
#include "core/base/cpu_clock.h"
#include "core/integrate/kernel.h"

namespace talbot {
namespace {

constexpr uint32_t kTile = 16;  // pixels a side

// One side of the comparisons, rendered tile by tile on this thread.
class Contender {
  public:
    Contender(PreparedView view, const RenderSettings& settings)
        : view_(std::move(view)),
          path_(path_settings(settings)),
          camera_(view_.camera, view_.given->origin(), settings.width, settings.height),
          first_sample_(settings.first_sample),
          film_(settings.width, settings.height) {}

    void clear() { film_.clear(); }
    // Brings a tile to `samples` a pixel and returns the seconds of this thread.
    double render(uint32_t x, uint32_t y, uint64_t samples, const std::stop_token& stop) {
        TileJob job{view_.scene.get(),
                    &camera_,
                    &path_,
                    &film_,
                    first_sample_,
                    samples,
                    x,
                    y,
                    std::min(x + kTile, film_.width()),
                    std::min(y + kTile, film_.height())};
        TileCounts counts;
        const double start = thread_cpu_seconds();
        tile_kernel(view_.tier)(job, stop, counts);
        return thread_cpu_seconds() - start;
    }
    void render_all(uint64_t samples, const std::stop_token& stop) {
        for (uint32_t y = 0; y < film_.height(); y += kTile) {
            for (uint32_t x = 0; x < film_.width(); x += kTile) render(x, y, samples, stop);
        }
    }
    const Film& film() const { return film_; }
    const PreparedView& view() const { return view_; }

    // Sums of the slices' least times: over all rounds, and over every other one.
    std::array<double, 3> seconds{};
    Film half;

  private:
    PreparedView view_;
    PathSettings path_;
    CameraRays camera_;
    uint64_t first_sample_;
    Film film_;
};

void time_in_turn(std::vector<std::unique_ptr<Contender>>& contenders, const PricePolicy& policy,
                  const std::stop_token& stop, const std::function<void(float)>& progress) {
    const Film& film = contenders.front()->film();
    const uint32_t columns = (film.width() + kTile - 1) / kTile;
    const uint32_t tiles = columns * ((film.height() + kTile - 1) / kTile);
    using Least = std::array<double, 3>;
    std::vector<std::vector<Least>> least(
        contenders.size(), std::vector<Least>(tiles, Least{HUGE_VAL, HUGE_VAL, HUGE_VAL}));
    for (int round = 0; round < policy.rounds; ++round) {
        for (const auto& c : contenders) c->clear();
        for (uint32_t tile = 0; tile < tiles; ++tile) {
            for (std::size_t k = 0; k < contenders.size(); ++k) {
                // Nobody always follows the same one.
                const std::size_t i = (k + static_cast<std::size_t>(round)) % contenders.size();
                const double seconds = contenders[i]->render(
                    tile % columns * kTile, tile / columns * kTile, policy.slice_samples, stop);
                if (stop.stop_requested()) return;
                for (const std::size_t set : {std::size_t{0}, std::size_t{1} + round % 2})
                    least[i][tile][set] = std::min(least[i][tile][set], seconds);
            }
        }
        if (progress)
            progress(0.5f +
                     0.5f * static_cast<float>(round + 1) / static_cast<float>(policy.rounds));
    }
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        for (const Least& slice : least[i]) {
            for (std::size_t set = 0; set < 3; ++set) contenders[i]->seconds[set] += slice[set];
        }
    }
}

double mean_of(const FilmPixel& p, int c) {
    return p.samples == 0 ? 0 : p.sum[c].value() / static_cast<double>(p.samples);
}

// Squared distance of the two halves of a film, relative to a picture.
double half_distance(const Contender& c, const Film& picture) {
    double sum = 0;
    for (uint32_t y = 0; y < picture.height(); ++y) {
        for (uint32_t x = 0; x < picture.width(); ++x) {
            for (int k = 0; k < 3; ++k) {
                const double first = mean_of(c.half.pixel(x, y), k);
                const double all = mean_of(c.film().pixel(x, y), k);
                const double r = mean_of(picture.pixel(x, y), k);
                sum += (all - first) * (all - first) / (r * r + metric_constant(0));
            }
        }
    }
    return sum;
}

double share_percent(double with, double without) {
    return with > 0 ? 100 * (with - without) / with : 0;
}

RenderSettings small_image(RenderSettings settings, uint32_t pixels) {
    const double scale =
        std::min(1.0, std::sqrt(pixels / (static_cast<double>(settings.width) * settings.height)));
    const auto scaled = [&](uint32_t side) {
        return std::max(1u, static_cast<uint32_t>(std::lround(side * scale)));
    };
    settings.width = scaled(settings.width);
    settings.height = scaled(settings.height);
    return settings;
}

}  // namespace

EffectState effect_state(const RenderSettings& settings, Effect effect) {
    if (settings.forced_off.has(effect)) return EffectState::off;
    return settings.forced_on.has(effect) ? EffectState::on : EffectState::automatic;
}

void set_effect_state(RenderSettings& settings, Effect effect, EffectState state) {
    settings.forced_on.remove(effect);
    settings.forced_off.remove(effect);
    if (state == EffectState::on) settings.forced_on.add(effect);
    if (state == EffectState::off) settings.forced_off.add(effect);
}

std::string_view effect_state_name(EffectState state) {
    switch (state) {
        case EffectState::automatic:
            return "auto";
        case EffectState::on:
            return "on";
        case EffectState::off:
            return "off";
    }
    return "auto";
}

std::optional<std::vector<EffectPrice>> price_effects(
    const std::shared_ptr<const Scene>& scene, const Camera& camera, const RenderSettings& given,
    const PricePolicy& policy, std::stop_token stop, const std::function<void(float)>& progress) {
    WorkerPool pool(1);
    const RenderSettings settings = small_image(given, policy.pixels);
    std::vector<std::unique_ptr<Contender>> contenders;
    contenders.push_back(
        std::make_unique<Contender>(prepare_view(scene, camera, settings, pool), settings));
    std::vector<Effect> effects;
    const EffectReport detected = contenders.front()->view().effects;
    for (const EffectInfo& info : kEffects) {
        const EffectState state = effect_state(settings, info.effect);
        if (!detected.active.has(info.effect) && state != EffectState::on) continue;
        RenderSettings other = settings;
        set_effect_state(other, info.effect,
                         state == EffectState::off ? EffectState::automatic : EffectState::off);
        const PreparedView& base = contenders.front()->view();
        contenders.push_back(
            std::make_unique<Contender>(prepare_view(scene, camera, other, pool, &base), other));
        effects.push_back(info.effect);
    }
    const auto report = [&](std::size_t done) {
        if (progress)
            progress(0.5f * static_cast<float>(done) / static_cast<float>(contenders.size()));
    };
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        Contender& c = *contenders[i];
        c.render_all(policy.samples / 2, stop);
        c.half = c.film();
        c.render_all(policy.samples, stop);
        if (stop.stop_requested()) return std::nullopt;
        report(i + 1);
    }
    std::vector<EffectPrice> prices;
    for (std::size_t i = 0; i < effects.size(); ++i) {
        const bool is_off = settings.forced_off.has(effects[i]);
        const Contender& with = is_off ? *contenders[i + 1] : *contenders[0];
        const Contender& without = is_off ? *contenders[0] : *contenders[i + 1];
        EffectPrice price;
        price.effect = effects[i];
        price.error_percent =
            share_percent(half_distance(with, with.film()), half_distance(without, with.film()));
        price.change = measure_floor(without.half, without.film(), with.half, with.film());
        prices.push_back(price);
    }
    time_in_turn(contenders, policy, stop, progress);
    if (stop.stop_requested()) return std::nullopt;
    for (std::size_t i = 0; i < effects.size(); ++i) {
        const bool is_off = settings.forced_off.has(effects[i]);
        const Contender& with = is_off ? *contenders[i + 1] : *contenders[0];
        const Contender& without = is_off ? *contenders[0] : *contenders[i + 1];
        prices[i].time_percent = share_percent(with.seconds[0], without.seconds[0]);
        prices[i].time_spread = 0.5 * std::abs(share_percent(with.seconds[1], without.seconds[1]) -
                                               share_percent(with.seconds[2], without.seconds[2]));
    }
    return prices;
}

}  // namespace talbot
