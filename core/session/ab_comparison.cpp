#include "core/session/ab_comparison.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <optional>
#include <thread>

#include "core/accuracy/error_estimate.h"
#include "core/accuracy/metrics.h"
#include "core/integrate/tiers.h"
#include "core/session/ab_side.h"
#include "core/session/prepared_view.h"

namespace talbot {
namespace {

// Renders have 1, 4, 16 and 64 samples a pixel; the last level goes on for ever. A verdict is asked
// for at the numbers of renders given, and whenever they double at the last level.
constexpr uint64_t kMostSamples = 64;
constexpr uint64_t kLevelGrowth = 4;
constexpr uint64_t kFirstLook = 8;
constexpr uint64_t kLevelRenders = 16;
constexpr std::size_t kMostPairs = 512;
constexpr uint32_t kBlock = 8;            // pixels a side, of the bootstrap
constexpr uint32_t kFewBlocks = 64;       // fewer make blocks of half the size
constexpr uint32_t kRadius = 3;           // of the window that r is the mean over
constexpr double kDifferentLevel = 0.01;  // over all looks together
constexpr double kNormal95 = 1.96;

// Mean over the window inside the image, one channel after the other.
std::vector<double> window_means(const ImageRgba& image) {
    const uint32_t w = image.width, h = image.height;
    const std::size_t stride = std::size_t{w} + 1;
    std::vector<double> means(3 * std::size_t{w} * h), table(stride * (h + 1));
    for (int c = 0; c < 3; ++c) {
        for (uint32_t y = 0; y < h; ++y) {
            double row = 0;
            for (uint32_t x = 0; x < w; ++x) {
                row += static_cast<double>(image.rgb[std::size_t{y} * w + x][c]);
                table[(y + 1) * stride + x + 1] = table[y * stride + x + 1] + row;
            }
        }
        for (uint32_t y = 0; y < h; ++y) {
            const uint32_t y0 = y > kRadius ? y - kRadius : 0, y1 = std::min(y + kRadius + 1, h);
            for (uint32_t x = 0; x < w; ++x) {
                const uint32_t x0 = x > kRadius ? x - kRadius : 0;
                const uint32_t x1 = std::min(x + kRadius + 1, w);
                const double sum = table[y1 * stride + x1] - table[y0 * stride + x1] -
                                   table[y1 * stride + x0] + table[y0 * stride + x0];
                means[3 * (std::size_t{y} * w + x) + static_cast<std::size_t>(c)] =
                    sum / (static_cast<double>(x1 - x0) * (y1 - y0));
            }
        }
    }
    return means;
}

// relMSE of one render, and its relative variance from pixels whose variances are estimates.
struct RenderError {
    double relmse = 0;
    double relative_variance = 0;
};

struct Comparison {
    std::vector<BlockVariances> blocks;
    RenderError a, b;
};

Comparison compare_sides(const AbRender& a, const AbRender& b, const ImageRgba& image_a,
                         const ImageRgba& image_b, double constant) {
    const uint32_t w = image_a.width, h = image_a.height;
    ImageRgba both = image_a;
    for (std::size_t i = 0; i < both.rgb.size(); ++i)
        both.rgb[i] = 0.5f * (image_a.rgb[i] + image_b.rgb[i]);
    const std::vector<double> r = window_means(both);
    const auto count = [&](uint32_t side) {
        return ((w + side - 1) / side) * ((h + side - 1) / side);
    };
    const uint32_t side = count(kBlock) < kFewBlocks ? kBlock / 2 : kBlock;
    const uint32_t columns = (w + side - 1) / side;
    Comparison result;
    result.blocks.resize(count(side));
    double square_a = 0, square_b = 0;
    for (uint32_t y = 0; y < h; ++y) {
        for (uint32_t x = 0; x < w; ++x) {
            const std::size_t i = 3 * (std::size_t{y} * w + x);
            double pixel_a = 0, pixel_b = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double weight = 1 / (r[i + c] * r[i + c] + constant);
                pixel_a += weight * a.variance(i + c);
                pixel_b += weight * b.variance(i + c);
            }
            BlockVariances& block = result.blocks[std::size_t{y / side} * columns + x / side];
            block.a += pixel_a;
            block.b += pixel_b;
            result.a.relmse += pixel_a;
            result.b.relmse += pixel_b;
            square_a += pixel_a * pixel_a;
            square_b += pixel_b * pixel_b;
        }
    }
    const auto finish = [&](RenderError& e, double square, const AbRender& render) {
        if (!(e.relmse > 0)) return;
        // A Gaussian pixel's squared error, and its variance from a few renders.
        const double freedom = static_cast<double>(render.renders() - 1);
        e.relative_variance = 2 * square / (e.relmse * e.relmse) * (1 + 1 / freedom);
        e.relmse /= 3 * static_cast<double>(w) * h;
    };
    finish(result.a, square_a, a);
    finish(result.b, square_b, b);
    return result;
}

MeasuredImage measured(const AbRender& render, ImageRgba& image) {
    const double n = static_cast<double>(render.renders());
    MeasuredImage result{&image, std::vector<Rgb>(image.rgb.size())};
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            image.rgb[i][static_cast<int>(c)] = static_cast<float>(render.means()[3 * i + c]);
            result.variance[i][static_cast<int>(c)] =
                static_cast<float>(render.variance(3 * i + c) / n);
        }
    }
    return result;
}

double sum_of(const ImageRgba& image) {
    double sum = 0;
    for (const Rgb& c : image.rgb)
        sum += static_cast<double>(c.x) + static_cast<double>(c.y) + static_cast<double>(c.z);
    return sum;
}

// relMSE of the mean of all that a side has rendered. Renders are independent of each other.
class SideError {
  public:
    void set_level(std::size_t level, uint64_t samples, const RenderError& error) {
        if (levels_.size() <= level) levels_.resize(level + 1);
        levels_[level] = {static_cast<double>(samples), error};
    }

    // Samples that no level has measured yet count as renders of the size before.
    void write(AbSide& side, const std::vector<uint64_t>& renders) const {
        if (levels_.empty()) return;
        double measured = 0, square = 0;
        for (std::size_t i = 0; i < levels_.size() && i < renders.size(); ++i) {
            const double n = levels_[i].samples * static_cast<double>(renders[i]);
            measured += n;
            square += n * levels_[i].samples * levels_[i].error.relmse;
        }
        const Level& last = levels_.back();
        const double samples = std::max(static_cast<double>(side.samples), measured);
        square += (samples - measured) * last.samples * last.error.relmse;
        if (!(square > 0)) return;
        side.relrmse_percent = 100 * std::sqrt(square) / samples;
        const double factor = std::exp(0.5 * kNormal95 * std::sqrt(last.error.relative_variance));
        side.lo95 = side.relrmse_percent / factor;
        side.hi95 = side.relrmse_percent * factor;
    }

  private:
    struct Level {
        double samples = 0;
        RenderError error;
    };
    std::vector<Level> levels_;
};

}  // namespace

class AbComparison::Impl {
  public:
    ~Impl() { join(); }

    void start(std::shared_ptr<const Scene> scene, const Camera& camera, const AbConfig& a,
               const AbConfig& b, const AbPolicy& policy) {
        join();
        {
            const std::lock_guard lock(mutex_);
            latest_.reset();
            running_ = true;
        }
        stop_ = std::stop_source();
        thread_ = std::thread([this, scene = std::move(scene), camera, a, b, policy] {
            Run(*this, camera, a, b, policy).go(scene);
            const std::lock_guard lock(mutex_);
            running_ = false;
            ended_.notify_all();
        });
    }

    std::shared_ptr<const AbSnapshot> latest() const {
        const std::lock_guard lock(mutex_);
        return latest_;
    }

    void stop() { stop_.request_stop(); }

    bool wait(double seconds) const {
        std::unique_lock lock(mutex_);
        const auto over = [this] { return !running_; };
        if (seconds < 0) {
            ended_.wait(lock, over);
            return true;
        }
        return ended_.wait_for(lock, std::chrono::duration<double>(seconds), over);
    }

  private:
    void join() {
        stop_.request_stop();
        if (thread_.joinable()) thread_.join();
    }

    // One comparison from its start to its end, on the thread of its own.
    class Run {
      public:
        Run(Impl& owner, const Camera& camera, const AbConfig& a, const AbConfig& b,
            const AbPolicy& policy)
            : owner_(owner), camera_(camera), configs_{a, b}, policy_(policy) {
            for (AbConfig& config : configs_) {
                config.settings.width = std::max(1u, a.settings.width);
                config.settings.height = std::max(1u, a.settings.height);
                config.settings.tile_size = std::max(1u, config.settings.tile_size);
            }
        }

        void go(const std::shared_ptr<const Scene>& scene) {
            WorkerPool pool(policy_.threads);
            PreparedView view;
            for (std::size_t i = 0; i < 2; ++i) {
                const AbConfig& config = configs_[i];
                view = prepare_view(scene, camera_, config.settings, pool, &view);
                if (config.kernel == nullptr) kernel_names_[i] = kTiers[view.tier].name;
                sides_[i].emplace(view, config.settings, config.kernel, pool);
            }
            AbRender &a = *sides_[0], &b = *sides_[1];
            const Clock::time_point begin = Clock::now();
            const std::stop_token stop = owner_.stop_.get_token();
            bool finished = false;
            while (!finished) {
                // Whoever has had less time.
                AbRender& next = b.seconds() < a.seconds() ? b : a;
                next.run_slice(policy_.slice_seconds, pool, stop);
                measure_times();
                look();
                seconds_ = std::chrono::duration<double>(Clock::now() - begin).count();
                const auto is_over = [](double seconds, double limit) {
                    return limit > 0 && seconds >= limit;
                };
                finished =
                    stop.stop_requested() || is_over(seconds_, policy_.limit_seconds) ||
                    is_over(std::min(a.seconds(), b.seconds()), policy_.limit_side_seconds) ||
                    (policy_.stop_when_decided && verdict_.winner != Winner::none);
                publish(finished);
            }
        }

      private:
        using Clock = std::chrono::steady_clock;

        // A pair for each window of time in which both sides ended a pass.
        void measure_times() {
            for (std::size_t i = 0; i < 2; ++i) {
                if (const double t = sides_[i]->take_sample_seconds(); t > 0) {
                    window_[i] += t;
                    window_count_[i] += 1;
                }
            }
            if (window_count_[0] == 0 || window_count_[1] == 0) return;
            pairs_.push_back({window_[0] / window_count_[0], window_[1] / window_count_[1]});
            window_ = {};
            window_count_ = {};
            if (pairs_.size() < kMostPairs) return;
            for (std::size_t i = 0; i < kMostPairs / 2; ++i) {
                const TimePair &p = pairs_[2 * i], &q = pairs_[2 * i + 1];
                pairs_[i] = {0.5 * (p.a + q.a), 0.5 * (p.b + q.b)};
            }
            pairs_.resize(kMostPairs / 2);
        }

        void look() {
            const AbRender &a = *sides_[0], &b = *sides_[1];
            if (std::min(a.renders(), b.renders()) < next_look_) return;
            const ImageRgba image_a = a.image(), image_b = b.image();
            const double constant = metric_constant(static_cast<double>(policy_.exposure_ev));
            const Comparison c = compare_sides(a, b, image_a, image_b, constant);
            ++looks_;
            verdict_ = compare_efficiency(c.blocks, pairs_, looks_);
            verdict_.samples = a.level_samples();
            verdict_.renders = std::min(a.renders(), b.renders());
            errors_[0].set_level(level_, a.level_samples(), c.a);
            errors_[1].set_level(level_, b.level_samples(), c.b);
            compare_pictures();
            next_look_ = std::max(2 * next_look_, kLevelRenders);
            if (verdict_.renders < kLevelRenders || a.level_samples() >= kMostSamples) return;
            ++level_;
            next_look_ = kLevelRenders;
            for (std::optional<AbRender>& side : sides_)
                side->start_level(side->level_samples() * kLevelGrowth);
        }

        // Whether both sides converge to one picture.
        void compare_pictures() {
            ImageRgba a = sides_[0]->image(), b = a;
            const MeasuredImage measured_a = measured(*sides_[0], a);
            const MeasuredImage measured_b = measured(*sides_[1], b);
            const BlockTest test = test_blocks(measured_a, measured_b);
            verdict_.different = test.p_value < level_of_look(kDifferentLevel, looks_);
            const double sum_a = sum_of(a), sum_b = sum_of(b);
            if (sum_a > 0) verdict_.brightness_percent = 100 * (sum_b / sum_a - 1);
            if (!verdict_.different) return;
            char text[96];
            std::snprintf(text, sizeof(text), "; but the pictures differ (B is %s by %.2f %%)",
                          verdict_.brightness_percent < 0 ? "darker" : "brighter",
                          std::abs(verdict_.brightness_percent));
            verdict_.text += text;
        }

        void publish(bool finished) {
            const double now = seconds_;
            const bool shown = sides_[0]->samples() > 0 && sides_[1]->samples() > 0;
            if (!shown || (!finished && now - last_publish_ < policy_.publish_seconds)) return;
            last_publish_ = now;
            auto snapshot = std::make_shared<AbSnapshot>();
            for (std::size_t i = 0; i < 2; ++i) {
                AbSide& side = i == 0 ? snapshot->a : snapshot->b;
                const AbRender& render = *sides_[i];
                side.image = std::make_shared<const ImageRgba>(render.image());
                side.samples = render.samples();
                side.seconds = render.seconds();
                side.rays = render.rays();
                side.kernel = kernel_names_[i];
                errors_[i].write(side, render.level_renders());
            }
            snapshot->verdict = verdict_;
            snapshot->seconds = seconds_;
            snapshot->finished = finished;
            const std::lock_guard lock(owner_.mutex_);
            owner_.latest_ = std::move(snapshot);
        }

        Impl& owner_;
        Camera camera_;
        std::array<AbConfig, 2> configs_;
        const AbPolicy policy_;
        std::array<std::optional<AbRender>, 2> sides_;
        std::array<std::string, 2> kernel_names_;
        std::array<SideError, 2> errors_;
        std::vector<TimePair> pairs_;
        std::array<double, 2> window_{}, window_count_{};
        EfficiencyVerdict verdict_;
        uint64_t looks_ = 0;
        uint64_t next_look_ = kFirstLook;
        std::size_t level_ = 0;
        double seconds_ = 0;
        double last_publish_ = -1;
    };

    mutable std::mutex mutex_;
    mutable std::condition_variable ended_;
    std::shared_ptr<const AbSnapshot> latest_;
    bool running_ = false;
    std::stop_source stop_;
    std::thread thread_;
};

AbComparison::AbComparison() : impl_(std::make_unique<Impl>()) {}
AbComparison::~AbComparison() = default;

void AbComparison::start(std::shared_ptr<const Scene> scene, const Camera& camera,
                         const AbConfig& a, const AbConfig& b, const AbPolicy& policy) {
    impl_->start(std::move(scene), camera, a, b, policy);
}
std::shared_ptr<const AbSnapshot> AbComparison::latest() const {
    return impl_->latest();
}
void AbComparison::stop() {
    impl_->stop();
}
bool AbComparison::wait(double seconds) const {
    return impl_->wait(seconds);
}

}  // namespace talbot
