// A fixed set of worker threads that run one parallel loop at a time. Deterministic work must not
// depend on which worker runs which index. Workers run with denormals flushed to zero (see
// enter_worker_float_mode).
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace talbot {

// Sets flush-to-zero and denormals-are-zero for the calling thread.
void enter_worker_float_mode();

class WorkerPool {
  public:
    // threads = 0 takes every core that the process may use.
    explicit WorkerPool(unsigned threads = 0);
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    unsigned size() const { return static_cast<unsigned>(threads_.size()); }

    // Calls body(index, worker) for every index in [0, count), in rising order of start, and
    // returns when all are done or stop was requested (then some indices were not started).
    // Rethrows the first exception of a body. One caller at a time.
    void parallel_for(uint64_t count,
                      const std::function<void(uint64_t index, unsigned worker)>& body,
                      std::stop_token stop = {});

  private:
    void run_worker(unsigned worker);

    std::vector<std::thread> threads_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::condition_variable idle_;
    const std::function<void(uint64_t, unsigned)>* body_ = nullptr;
    std::stop_token stop_;
    std::atomic<uint64_t> next_{0};
    uint64_t count_ = 0;
    uint64_t round_ = 0;
    unsigned busy_ = 0;
    bool quit_ = false;
    std::exception_ptr failure_;
};

}  // namespace talbot
