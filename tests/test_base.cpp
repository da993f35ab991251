// The worker pool: every index once, exceptions carried to the caller, stop honoured.
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "core/base/worker_pool.h"

namespace talbot {
namespace {

TEST(WorkerPool, RunsEveryIndexOnce) {
    for (unsigned threads : {1u, 2u, 3u, 7u}) {
        WorkerPool pool(threads);
        std::vector<std::atomic<int>> hits(1000);
        pool.parallel_for(hits.size(), [&](uint64_t i, unsigned worker) {
            EXPECT_LT(worker, threads);
            ++hits[i];
        });
        for (const auto& hit : hits) EXPECT_EQ(hit.load(), 1);
    }
}

TEST(WorkerPool, CarriesTheFirstExceptionAndStaysUsable) {
    WorkerPool pool(2);
    EXPECT_THROW(pool.parallel_for(100,
                                   [](uint64_t i, unsigned) {
                                       if (i == 50) throw std::runtime_error("planted");
                                   }),
                 std::runtime_error);
    std::atomic<int> count{0};
    pool.parallel_for(10, [&](uint64_t, unsigned) { ++count; });
    EXPECT_EQ(count.load(), 10);
}

TEST(WorkerPool, StopEndsTheLoopEarly) {
    WorkerPool pool(2);
    std::stop_source stop;
    std::atomic<int> count{0};
    pool.parallel_for(
        1000000,
        [&](uint64_t, unsigned) {
            if (++count == 10) stop.request_stop();
        },
        stop.get_token());
    EXPECT_LT(count.load(), 1000);
}

}  // namespace
}  // namespace talbot
