#include "core/base/worker_pool.h"

#include <sched.h>

#include <algorithm>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace talbot {
namespace {

unsigned usable_cores() {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof(set), &set) == 0) {
        return static_cast<unsigned>(std::max(1, CPU_COUNT(&set)));
    }
    return std::max(1u, std::thread::hardware_concurrency());
}

}  // namespace

void enter_worker_float_mode() {
#if defined(__SSE2__)
    constexpr unsigned kFlushToZero = 0x8000u;
    constexpr unsigned kDenormalsAreZero = 0x0040u;
    _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
#endif
}

WorkerPool::WorkerPool(unsigned threads) {
    const unsigned count = threads == 0 ? usable_cores() : threads;
    threads_.reserve(count);
    for (unsigned worker = 0; worker < count; ++worker) {
        threads_.emplace_back([this, worker] { run_worker(worker); });
    }
}

WorkerPool::~WorkerPool() {
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::parallel_for(uint64_t count, const std::function<void(uint64_t, unsigned)>& body,
                              std::stop_token stop) {
    if (count == 0) return;
    std::unique_lock lock(mutex_);
    body_ = &body;
    stop_ = std::move(stop);
    count_ = count;
    next_.store(0);
    busy_ = size();
    failure_ = nullptr;
    ++round_;
    wake_.notify_all();
    idle_.wait(lock, [this] { return busy_ == 0; });
    body_ = nullptr;
    stop_ = {};
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void WorkerPool::run_worker(unsigned worker) {
    enter_worker_float_mode();
    uint64_t seen_round = 0;
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [&] { return quit_ || round_ != seen_round; });
            if (quit_) return;
            seen_round = round_;
        }
        try {
            for (uint64_t i = next_.fetch_add(1); i < count_ && !stop_.stop_requested();
                 i = next_.fetch_add(1)) {
                (*body_)(i, worker);
            }
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            next_.store(count_);
        }
        const std::lock_guard lock(mutex_);
        if (--busy_ == 0) idle_.notify_one();
    }
}

}  // namespace talbot
