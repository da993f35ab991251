#include "core/session/effect_ledger.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/accuracy/error_estimate.h"
#include "core/base/cpu_clock.h"
#include "core/integrate/kernel.h"
#include "core/session/render_pass.h"

namespace talbot {
namespace {

constexpr uint32_t kTile = 16;  // pixels a side

// One side of the comparisons, rendered tile by tile on this thread.
class Contender {
  public:
    Contender(PreparedView view, const RenderSettings& settings)
        : view_(std::move(view)), settings_(settings), film_(settings.width, settings.height) {}

    void clear() { film_.clear(); }
    // Brings a tile to `samples` a pixel, as seen where the shutter opens, and returns the seconds
    // of this thread.
    double render(uint32_t x, uint32_t y, uint64_t samples, const std::stop_token& stop) {
        const PreparedView& view = view_.view();
        const CameraRays camera(view.camera, view.given->origin(), film_.width(), film_.height(),
                                view.given->geometry().bounds);
        const PathSettings path = path_settings(settings_);
        TileJob job{view.scene.get(),
                    &camera,
                    &path,
                    &film_,
                    settings_.first_sample,
                    samples,
                    x,
                    y,
                    std::min(x + kTile, film_.width()),
                    std::min(y + kTile, film_.height())};
        TileCounts counts;
        const double start = thread_cpu_seconds();
        tile_kernel(view.tier)(job, stop, counts);
        return thread_cpu_seconds() - start;
    }
    // The whole picture, at all its moments.
    void render_all(uint64_t samples, WorkerPool& pool, const std::stop_token& asked) {
        std::stop_source stop;
        const std::stop_callback pass_on(asked, [&stop] { stop.request_stop(); });
        TileCounts counts;
        render_pass(view_, settings_, samples, film_, pool, stop, {}, counts);
    }
    const Film& film() const { return film_; }
    const PreparedView& view() const { return view_.view(); }
    double seconds_a_moment() const { return view_.least_seconds(); }

    Film half;

  private:
    ViewMoments view_;
    RenderSettings settings_;
    Film film_;
};

double share_percent(double with, double without) {
    return with > 0 ? 100 * (with - without) / with : 0;
}

// Which two contenders an effect's price compares.
struct Pair {
    Effect effect;
    std::size_t with, without;
};

// Least times of slices that take turns, on this thread.
class Race {
  public:
    Race(std::vector<std::unique_ptr<Contender>>& contenders, const PricePolicy& policy)
        : contenders_(contenders), policy_(policy) {
        const Film& film = contenders.front()->film();
        columns_ = (film.width() + kTile - 1) / kTile;
        tiles_ = columns_ * ((film.height() + kTile - 1) / kTile);
        least_.assign(contenders.size(),
                      std::vector<Least>(tiles_, Least{HUGE_VAL, HUGE_VAL, HUGE_VAL}));
    }

    void run_round(const std::stop_token& stop) {
        for (const auto& c : contenders_) c->clear();
        for (uint32_t tile = 0; tile < tiles_; ++tile) {
            for (std::size_t k = 0; k < contenders_.size(); ++k) {
                // Nobody always follows the same one.
                const std::size_t i = (k + rounds_) % contenders_.size();
                const double seconds = contenders_[i]->render(
                    tile % columns_ * kTile, tile / columns_ * kTile, policy_.slice_samples, stop);
                if (stop.stop_requested()) return;
                for (const std::size_t set : {std::size_t{0}, 1 + rounds_ % 2})
                    least_[i][tile][set] = std::min(least_[i][tile][set], seconds);
            }
        }
        ++rounds_;
    }

    // Of one sample of the whole image.
    double seconds_a_sample(std::size_t contender) const {
        return seconds(contender, 0) / static_cast<double>(policy_.slice_samples);
    }
    // Of the time: by all rounds, and half the distance of the figures by every other one.
    double share(const Pair& pair) const { return share(pair, 0); }
    double spread(const Pair& pair) const {
        return 0.5 * std::abs(share(pair, 1) - share(pair, 2));
    }
    bool resolves(const std::vector<Pair>& pairs) const {
        return std::all_of(pairs.begin(), pairs.end(), [&](const Pair& pair) {
            return spread(pair) <= policy_.resolution * std::max(std::abs(share(pair)), 1.0);
        });
    }

  private:
    using Least = std::array<double, 3>;  // over all rounds, and over every other one

    double share(const Pair& pair, std::size_t set) const {
        return share_percent(seconds(pair.with, set), seconds(pair.without, set));
    }
    double seconds(std::size_t contender, std::size_t set) const {
        double sum = 0;
        for (const Least& slice : least_[contender]) sum += slice[set];
        return sum;
    }

    std::vector<std::unique_ptr<Contender>>& contenders_;
    const PricePolicy& policy_;
    uint32_t columns_ = 0, tiles_ = 0;
    std::size_t rounds_ = 0;
    std::vector<std::vector<Least>> least_;
};

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
    std::vector<Pair> pairs;
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
        const std::size_t own = contenders.size() - 1;
        pairs.push_back(state == EffectState::off ? Pair{info.effect, own, 0}
                                                  : Pair{info.effect, 0, own});
    }
    const auto report = [&](std::size_t done) {
        if (progress)
            progress(0.5f * static_cast<float>(done) / static_cast<float>(contenders.size()));
    };
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        Contender& c = *contenders[i];
        c.render_all(policy.samples / 2, pool, stop);
        c.half = c.film();
        c.render_all(policy.samples, pool, stop);
        if (stop.stop_requested()) return std::nullopt;
        report(i + 1);
    }
    std::vector<EffectPrice> prices;
    for (const Pair& pair : pairs) {
        const Contender& with = *contenders[pair.with];
        const Contender& without = *contenders[pair.without];
        EffectPrice price;
        price.effect = pair.effect;
        price.error_percent =
            share_percent(half_distance(with, with.film()), half_distance(without, with.film()));
        price.change = measure_floor(without.half, without.film(), with.half, with.film());
        prices.push_back(price);
    }
    // From here on the films hold slices only.
    Race race(contenders, policy);
    const int most = std::max(policy.rounds, policy.most_rounds);
    for (int round = 0; round < most; ++round) {
        // Both halves have as many rounds when they are compared.
        if (round >= policy.rounds && round % 2 == 0 && race.resolves(pairs)) break;
        race.run_round(stop);
        if (stop.stop_requested()) return std::nullopt;
        if (progress)
            progress(0.5f + 0.5f * static_cast<float>(round + 1) / static_cast<float>(most));
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        prices[i].time_percent = race.share(pairs[i]);
        prices[i].time_spread = race.spread(pairs[i]);
        if (pairs[i].effect != Effect::motion) continue;
        // A pass of the whole image is seen at one moment.
        const double growth = static_cast<double>(given.width) * given.height /
                              (static_cast<double>(settings.width) * settings.height);
        const double moment = contenders[pairs[i].with]->seconds_a_moment();
        const double pass = growth * race.seconds_a_sample(pairs[i].with);
        prices[i].time_percent = share_percent(pass + moment, pass);
    }
    return prices;
}

}  // namespace talbot
