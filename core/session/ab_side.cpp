#include "core/session/ab_side.h"

#include <algorithm>
#include <atomic>
#include <chrono>

#include "core/base/check.h"
#include "core/base/cpu_clock.h"

namespace talbot {
namespace {

double clock_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

AbRender::AbRender(PreparedView view, const RenderSettings& settings, TileKernel kernel,
                   WorkerPool& pool)
    : view_(std::move(view)),
      at_(&view_.view()),
      settings_(settings),
      path_(path_settings(settings)),
      kernel_(kernel),
      columns_((settings.width + settings.tile_size - 1) / settings.tile_size),
      rows_((settings.height + settings.tile_size - 1) / settings.tile_size),
      film_(settings.width, settings.height),
      tile_done_(std::size_t{columns_} * rows_),
      total_(3 * film_.pixels().size()),
      mean_(total_.size()),
      square_(total_.size()) {
    begin_render();
    begin_pass(pool);
}

void AbRender::run_slice(double seconds, WorkerPool& pool, const std::stop_token& stop) {
    const double deadline = clock_seconds() + seconds;
    threads_ = pool.size();
    do {
        run_tiles(deadline, pool, stop);
    } while (!stop.stop_requested() && clock_seconds() < deadline);
}

// What is left of the pass at hand, as far as time allows; the first tile always.
void AbRender::run_tiles(double deadline, WorkerPool& pool, const std::stop_token& stop) {
    struct alignas(64) Worker {
        TileCounts counts;
        double cpu_seconds = 0;
    };
    std::vector<Worker> workers(pool.size());
    std::vector<uint32_t> open;
    for (uint32_t i = 0; i < tile_done_.size(); ++i) {
        if (tile_done_[i] == 0) open.push_back(i);
    }
    const Scene& scene = *at_->given;
    const CameraRays camera(at_->camera, scene.origin(), film_.width(), film_.height(),
                            scene.geometry().bounds);
    const TileKernel kernel = kernel_ ? kernel_ : tile_kernel(at_->tier);
    pool.parallel_for(
        open.size(),
        [&](uint64_t i, unsigned worker) {
            if (i > 0 && clock_seconds() > deadline) return;
            const double start = thread_cpu_seconds();
            TileJob job{at_->scene.get(), &camera, &path_, &film_, settings_.first_sample,
                        passes_ + 1,      0,       0,      0,      0};
            job.x0 = open[i] % columns_ * settings_.tile_size;
            job.y0 = open[i] / columns_ * settings_.tile_size;
            job.x1 = std::min(job.x0 + settings_.tile_size, film_.width());
            job.y1 = std::min(job.y0 + settings_.tile_size, film_.height());
            kernel(job, stop, workers[worker].counts);
            workers[worker].cpu_seconds += thread_cpu_seconds() - start;
            if (!stop.stop_requested()) tile_done_[open[i]] = 1;
        },
        stop);
    for (const Worker& worker : workers) {
        cpu_seconds_ += worker.cpu_seconds;
        rays_ += worker.counts.rays;
    }
    const auto done = [](uint8_t d) { return d != 0; };
    if (!std::all_of(tile_done_.begin(), tile_done_.end(), done)) return;
    finish_pass();
    begin_pass(pool);
}

// The time that a moving scene takes to get there counts as every thread's.
void AbRender::begin_pass(WorkerPool& pool) {
    RenderSettings settings = settings_;
    settings.seed = path_.seed;
    const double before = view_.seconds();
    at_ = view_.at(settings_.first_sample + passes_, settings, pool);
    cpu_seconds_ += pool.size() * (view_.seconds() - before);
}

void AbRender::finish_pass() {
    std::fill(tile_done_.begin(), tile_done_.end(), uint8_t{0});
    ++passes_;
    ++samples_;
    ++ended_passes_;
    ended_seconds_ += cpu_seconds_ - pass_start_;
    pass_start_ = cpu_seconds_;
    if (passes_ >= level_samples_) finish_render();
}

void AbRender::finish_render() {
    ++renders_;
    ++all_renders_;
    total_samples_ += passes_;
    const double n = static_cast<double>(passes_), count = static_cast<double>(renders_);
    const std::vector<FilmPixel>& pixels = film_.pixels();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double sum = pixels[i].sum[c].value(), x = sum / n;
            double& mean = mean_[3 * i + c];
            const double off = x - mean;
            total_[3 * i + c] += sum;
            mean += off / count;
            square_[3 * i + c] += off * (x - mean);
        }
    }
    begin_render();
}

// With random numbers of its own, which both sides share where their settings have one seed.
void AbRender::begin_render() {
    constexpr uint64_t kSeedStep = 0x9E3779B97F4A7C15;
    film_.clear();
    passes_ = 0;
    path_.seed = settings_.seed + kSeedStep * all_renders_;
}

void AbRender::start_level(uint64_t samples) {
    TALBOT_CHECK(samples > 0);
    earlier_levels_.push_back(renders_);
    level_samples_ = samples;
    renders_ = 0;
    std::fill(mean_.begin(), mean_.end(), 0.0);
    std::fill(square_.begin(), square_.end(), 0.0);
}

std::vector<uint64_t> AbRender::level_renders() const {
    std::vector<uint64_t> renders = earlier_levels_;
    renders.push_back(renders_);
    return renders;
}

double AbRender::take_sample_seconds() {
    if (ended_passes_ == 0) return 0;
    const double samples =
        static_cast<double>(ended_passes_) * static_cast<double>(film_.pixels().size());
    const double seconds = ended_seconds_ / samples;
    ended_passes_ = 0;
    ended_seconds_ = 0;
    return seconds;
}

ImageRgba AbRender::image() const {
    ImageRgba image;
    image.width = film_.width();
    image.height = film_.height();
    image.rgb.resize(film_.pixels().size());
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const FilmPixel& p = film_.pixels()[i];
        const double n = static_cast<double>(total_samples_ + p.samples);
        for (std::size_t c = 0; c < 3; ++c) {
            const double sum = total_[3 * i + c] + p.sum[c].value();
            image.rgb[i][static_cast<int>(c)] = n > 0 ? static_cast<float>(sum / n) : 0.0f;
        }
    }
    return image;
}

}  // namespace talbot
