#include "core/session/session.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <future>
#include <utility>
#include <variant>

#include "core/integrate/tiers.h"
#include "core/session/render_pass.h"
#include "core/session/scheduler.h"
#include "core/session/view_layers.h"

namespace talbot {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

// Everything below `// session thread` is touched by that thread alone; the rest is guarded by
// mutex_.
class RenderSession::Impl {
  public:
    Impl(const SessionPolicy& policy, std::shared_ptr<WorkerPool> pool)
        : policy_(policy), pool_(std::move(pool)), thread_([this] { run(); }) {}

    ~Impl() { stop(); }

    uint64_t submit(Change change) {
        const std::lock_guard lock(mutex_);
        const bool harmless = std::holds_alternative<SetPassLimit>(change) ||
                              std::holds_alternative<SetErrorExposure>(change);
        changes_.push_back(std::move(change));
        if (work_is_interruptible_ && !harmless) work_stop_.request_stop();
        wake_.notify_all();
        return ++submitted_;
    }

    std::shared_ptr<const Snapshot> latest() const {
        const std::lock_guard lock(mutex_);
        return latest_;
    }

    bool wait_for(uint64_t generation, uint64_t passes, double seconds) const {
        std::unique_lock lock(mutex_);
        const auto shown = [&] {
            return latest_ && latest_->generation >= generation &&
                   (latest_->finished || (!latest_->preview && latest_->passes >= passes));
        };
        const auto reached = [&] { return stopped_ || shown(); };
        if (seconds < 0)
            published_.wait(lock, reached);
        else
            published_.wait_for(lock, std::chrono::duration<double>(seconds), reached);
        return shown();
    }

    void stop() {
        {
            const std::lock_guard lock(mutex_);
            quit_ = true;
            work_stop_.request_stop();
        }
        wake_.notify_all();
        if (thread_.joinable()) thread_.join();
    }

    void on_snapshot(std::function<void()> callback) {
        const std::lock_guard lock(mutex_);
        callback_ = std::move(callback);
    }

    void with_film(const std::function<void(const FilmView&)>& f) {
        if (std::unique_lock lock(mutex_); !stopped_) {
            std::promise<void> done;
            film_requests_.push_back({&f, &done});
            wake_.notify_all();
            lock.unlock();
            done.get_future().wait();
            return;
        }
        f(film_view());
    }

    unsigned threads() const { return pool_->size(); }

  private:
    struct FilmRequest {
        const std::function<void(const FilmView&)>* f;
        std::promise<void>* done;
    };

    // session thread
    void run() {
        for (;;) {
            Work work;
            {
                std::unique_lock lock(mutex_);
                work = next_work(schedule_state());
                if (work.kind == WorkKind::idle && !layers_are_wanted() && changes_.empty() &&
                    film_requests_.empty() && !quit_) {
                    wake_.wait(lock, [this] {
                        return quit_ || !changes_.empty() || !film_requests_.empty();
                    });
                }
                if (quit_) break;
                if (take_requests(lock)) continue;
                work_stop_ = std::stop_source();
                work_is_interruptible_ = work.interruptible;
            }
            carry_out(work);
            const std::lock_guard lock(mutex_);
            work_is_interruptible_ = false;
        }
        finish();
    }

    // Applies queued changes and serves film requests; true when there were any.
    bool take_requests(std::unique_lock<std::mutex>& lock) {
        if (changes_.empty() && film_requests_.empty()) return false;
        std::deque<Change> changes;
        std::vector<FilmRequest> requests;
        changes.swap(changes_);
        requests.swap(film_requests_);
        const uint64_t generation = submitted_;
        lock.unlock();
        for (Change& change : changes) std::visit([this](auto& c) { apply(c); }, change);
        if (!changes.empty()) {
            generation_ = generation;
            after_changes();
        }
        serve(requests);
        lock.lock();
        return true;
    }

    void serve(const std::vector<FilmRequest>& requests) {
        for (const FilmRequest& request : requests) {
            (*request.f)(film_view());
            request.done->set_value();
        }
    }

    ScheduleState schedule_state() const {
        ScheduleState state;
        state.has_scene = source_ != nullptr;
        state.interactive = policy_.interactive;
        state.paused = paused_;
        state.passes = passes_;
        state.pass_limit = pass_limit_;
        state.stop_reached = stop_reached_;
        state.previews_done = previews_done_;
        state.last_preview_divisor = last_divisor_;
        state.samples_per_second = measured_rate_;
        state.preview_seconds = policy_.preview_seconds;
        state.pixels = uint64_t{settings_.width} * settings_.height;
        return state;
    }

    void apply(SetScene& change) {
        source_ = std::move(change.scene);
        camera_ = change.camera;
        if (!change.same_objects) {
            measured_rate_ = 0;
            layers_.select(std::nullopt);
        }
        restart_ = true;
    }
    void apply(SetCamera& change) {
        camera_ = std::move(change.camera);
        restart_ = true;
    }
    void apply(SetMaterial& change) {
        if (!source_ || change.index >= source_->materials().size()) return;
        replace_scene(source_->with_material(change.index, std::move(change.material)));
    }
    void apply(SetPunctualLight& change) {
        if (!source_ || change.index >= source_->punctual_lights().size()) return;
        replace_scene(source_->with_punctual_light(change.index, std::move(change.light)));
    }
    void apply(SetEnvironment& change) {
        if (!source_) return;
        replace_scene(source_->with_environment(std::move(change.environment)));
    }
    void apply(SetSettings& change) {
        if (settings_ == change.settings) return;
        settings_ = change.settings;
        settings_.width = std::max(1u, settings_.width);
        settings_.height = std::max(1u, settings_.height);
        settings_.tile_size = std::max(1u, settings_.tile_size);
        restart_ = true;
    }
    void apply(SetPaused& change) { paused_ = change.paused; }
    void apply(SetPassLimit& change) { pass_limit_ = change.passes; }
    void apply(SetSelection& change) { layers_.select(change.object); }
    void apply(SetAov& change) { layers_.show(change.aov); }
    void apply(SetErrorExposure& change) { error_exposure_ = change.ev; }
    void apply(SetFilm& change) { pending_film_ = std::move(change.state); }
    void apply(Restart&) { restart_ = true; }

    FilmView film_view() {
        renew_film();
        return {film_, tracker_.state(), render_seconds_, rays_, nonfinite_};
    }

    void replace_scene(std::shared_ptr<const Scene> scene) {
        source_ = std::move(scene);
        restart_ = true;
    }

    void after_changes() {
        if (restart_ && source_) {
            restart_ = false;
            film_is_stale_ = true;
            view_ = ViewMoments(prepare_view(source_, camera_, settings_, *pool_, &view_.view()));
            passes_ = 0;
            samples_ = rays_ = 0;
            render_seconds_ = resumed_seconds_ = 0;
            nonfinite_ = {};
            notes_ = {};
            stop_reached_ = false;
            previews_done_ = 0;
            last_divisor_ = 0;
            layers_.restart();
            tracker_.reset(error_exposure_, settings_.first_sample,
                           settings_.adaptive && !view_.moves());
            shown_image_.reset();
            take_pending_film();
        } else if (source_ && shown_image_) {
            tracker_.set_exposure(error_exposure_, film_.width(), pool_.get());
            if (passes_ > 0 && target_met()) stop_reached_ = true;
            layers_.glimpse(layered(), measured_rate_, policy_.preview_seconds);
            if (passes_ > 0) layers_.update_from(film_, tracker_.block_errors());
            publish(shown_image_, shown_is_preview_);
        }
    }

    void take_pending_film() {
        const std::shared_ptr<FilmState> state = std::exchange(pending_film_, nullptr);
        if (!state || state->film.width() != settings_.width ||
            state->film.height() != settings_.height)
            return;
        film_ = std::move(state->film);
        film_is_stale_ = false;
        passes_ = state->error.adaptive ? state->error.passes : film_.min_samples();
        samples_ = film_.total_samples();
        rays_ = state->rays;
        render_seconds_ = state->render_seconds;
        resumed_seconds_ = state->render_seconds;
        nonfinite_ = state->nonfinite;
        tracker_.restore(std::move(state->error));
        tracker_.set_exposure(error_exposure_, film_.width(), pool_.get());
        if (passes_ == 0) return;
        stop_reached_ = target_met();
        publish_film();
    }

    void publish_film() {
        publish(std::make_shared<const ImageRgba>(film_.image(settings_.transparent_background)),
                false);
    }

    bool target_met() const {
        if (!(policy_.target_error_percent > 0)) return false;
        return tracker_.at(passes_, render_seconds_)
            .ends_render(policy_.target_error_percent, passes_, samples_);
    }

    double spent_seconds() const { return render_seconds_ - resumed_seconds_; }

    void carry_out(const Work& work) {
        if (work.kind == WorkKind::preview) {
            render_preview(work.preview_divisor);
        } else if (layers_are_wanted()) {
            update_layers(work_stop_.get_token());
            publish(shown_image_, shown_is_preview_);
        } else if (work.kind == WorkKind::pass) {
            render_pass();
        }
    }

    // One pass over a film; returns whether every tile was finished.
    bool render(Film& film, uint64_t target, const SamplingPlan* plan, TileCounts& counts) {
        std::function<bool()> out_of_time;
        if (policy_.time_limit_seconds > 0 && passes_ > 0) {
            out_of_time = [this, start = Clock::now()] {
                return spent_seconds() + seconds_since(start) > policy_.time_limit_seconds;
            };
        }
        return talbot::render_pass(view_, settings_, target, film, *pool_, work_stop_, out_of_time,
                                   counts, plan);
    }

    void render_preview(uint32_t divisor) {
        const uint32_t width = std::max(1u, settings_.width / divisor);
        const uint32_t height = std::max(1u, settings_.height / divisor);
        Film film(width, height);
        TileCounts counts;
        const Clock::time_point start = Clock::now();
        const bool complete = render(film, 1, nullptr, counts);
        measured_rate_ = blended_rate(measured_rate_, counts.samples, seconds_since(start));
        if (!complete) return;
        ++previews_done_;
        last_divisor_ = divisor;
        layers_.preview(layered(), width, height);
        publish(std::make_shared<const ImageRgba>(film.image(settings_.transparent_background)),
                true);
    }

    // Clearing the film waits until it is needed, for a preview should not wait for it.
    void renew_film() {
        if (!film_is_stale_ || !source_) return;
        film_is_stale_ = false;
        if (film_.width() == settings_.width && film_.height() == settings_.height) {
            film_.clear();
        } else {
            film_ = Film(settings_.width, settings_.height);
        }
    }

    void render_pass() {
        renew_film();
        const Clock::time_point start = Clock::now();
        TileCounts counts;
        counts.log = notes_.fork();
        const bool complete = render(film_, passes_ + 1, &tracker_.plan(), counts);
        const double seconds = seconds_since(start);
        samples_ += counts.samples;
        rays_ += counts.rays;
        nonfinite_.merge(counts.nonfinite);
        notes_.merge(counts.log);
        render_seconds_ += seconds;
        measured_rate_ = blended_rate(measured_rate_, counts.samples, seconds);
        if (complete) {
            ++passes_;
            tracker_.observe(film_, passes_, render_seconds_, pool_.get());
            notes_.observe(film_, tracker_);
        }
        const bool out_of_time =
            policy_.time_limit_seconds > 0 && spent_seconds() >= policy_.time_limit_seconds;
        if (out_of_time && passes_ > 0) stop_reached_ = true;
        if (complete && target_met()) stop_reached_ = true;
        if (complete || stop_reached_) publish_pass();
    }

    // Snapshots cost a copy of the image, so a batch run makes them at powers of two and twice a
    // second only.
    void publish_pass() {
        const bool last = stop_reached_ || (pass_limit_ != 0 && passes_ >= pass_limit_);
        if (!policy_.interactive && !last && !std::has_single_bit(passes_) &&
            seconds_since(last_publish_) < 0.5)
            return;
        update_layers(work_stop_.get_token());
        publish_film();
    }

    ViewLayers::View layered() const {
        return {*view_.view().scene, view_.view().camera, settings_, *pool_};
    }
    bool layers_are_wanted() const { return shown_image_ && layers_.are_missing(); }
    void update_layers(const std::stop_token& stop) {
        layers_.update(layered(), stop);
        if (passes_ > 0) layers_.update_from(film_, tracker_.block_errors());
    }

    void publish(std::shared_ptr<const ImageRgba> image, bool preview) {
        auto snapshot = std::make_shared<Snapshot>();
        snapshot->generation = generation_;
        snapshot->preview = preview;
        snapshot->finished =
            !preview && (stop_reached_ || (pass_limit_ != 0 && passes_ >= pass_limit_));
        snapshot->paused = paused_;
        snapshot->passes = passes_;
        snapshot->render_seconds = render_seconds_;
        snapshot->samples = samples_;
        snapshot->rays = rays_;
        snapshot->samples_per_second =
            render_seconds_ > 0 ? static_cast<double>(samples_) / render_seconds_ : measured_rate_;
        snapshot->full_width = settings_.width;
        snapshot->full_height = settings_.height;
        snapshot->image = std::move(image);
        snapshot->object_ids = layers_.object_ids();
        snapshot->aov = layers_.aov();
        snapshot->nonfinite = nonfinite_;
        snapshot->notes = notes_.latest();
        snapshot->error = tracker_.at(passes_, render_seconds_);
        snapshot->scene = source_;
        snapshot->camera = camera_;
        snapshot->settings = settings_;
        snapshot->effects = view_.view().effects;
        snapshot->kernel = kTiers[view_.view().tier].name;
        shown_image_ = snapshot->image;
        shown_is_preview_ = preview;
        last_publish_ = Clock::now();
        std::function<void()> callback;
        {
            const std::lock_guard lock(mutex_);
            latest_ = std::move(snapshot);
            callback = callback_;
        }
        published_.notify_all();
        if (callback) callback();
    }

    // The last snapshot of a stopped session holds whatever was sampled.
    void finish() {
        if (source_ && samples_ > 0) {
            if (!tracker_.state().adaptive) passes_ = film_.min_samples();
            publish_film();
        }
        std::vector<FilmRequest> requests;
        {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
            requests.swap(film_requests_);
        }
        serve(requests);
        published_.notify_all();
    }

    const SessionPolicy policy_;
    std::shared_ptr<WorkerPool> pool_;

    mutable std::mutex mutex_;
    std::condition_variable wake_;
    mutable std::condition_variable published_;
    std::deque<Change> changes_;
    std::vector<FilmRequest> film_requests_;
    std::shared_ptr<const Snapshot> latest_;
    std::function<void()> callback_;
    std::stop_source work_stop_;
    bool work_is_interruptible_ = false;
    uint64_t submitted_ = 0;
    bool quit_ = false, stopped_ = false;

    // session thread
    std::shared_ptr<const Scene> source_;  // with all edits
    ViewMoments view_;                     // of it, since the last restart
    Camera camera_;
    RenderSettings settings_;
    Film film_;
    bool film_is_stale_ = false;  // it holds another state's samples
    ErrorTracker tracker_;
    NonFiniteCount nonfinite_;
    uint64_t generation_ = 0;
    uint64_t passes_ = 0, samples_ = 0, rays_ = 0, pass_limit_ = 0;
    double render_seconds_ = 0;
    double resumed_seconds_ = 0;  // of render_seconds_, spent before this session
    std::shared_ptr<FilmState> pending_film_;
    double measured_rate_ = 0;
    float error_exposure_ = 0;
    bool paused_ = false, stop_reached_ = false, restart_ = false;
    uint32_t previews_done_ = 0, last_divisor_ = 0;
    ViewLayers layers_;
    NoteKeeper notes_;
    std::shared_ptr<const ImageRgba> shown_image_;
    bool shown_is_preview_ = false;
    Clock::time_point last_publish_{};

    std::thread thread_;
};

RenderSession::RenderSession(const SessionPolicy& policy)
    : RenderSession(policy, std::make_shared<WorkerPool>(policy.threads)) {}

RenderSession::RenderSession(const SessionPolicy& policy, std::shared_ptr<WorkerPool> pool)
    : impl_(std::make_unique<Impl>(policy, std::move(pool))) {}

RenderSession::~RenderSession() = default;

uint64_t RenderSession::submit(Change change) {
    return impl_->submit(std::move(change));
}
std::shared_ptr<const Snapshot> RenderSession::latest() const {
    return impl_->latest();
}
bool RenderSession::wait_for(uint64_t generation, uint64_t passes, double seconds) const {
    return impl_->wait_for(generation, passes, seconds);
}
void RenderSession::stop() {
    impl_->stop();
}
void RenderSession::on_snapshot(std::function<void()> callback) {
    impl_->on_snapshot(std::move(callback));
}
void RenderSession::with_film(const std::function<void(const FilmView&)>& f) {
    impl_->with_film(f);
}
unsigned RenderSession::threads() const {
    return impl_->threads();
}

}  // namespace talbot
