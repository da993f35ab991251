#include "app/hardcases/run_cases.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>

#include "core/base/cpu_clock.h"

namespace talbot::hardcases {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Shared with the case's thread, which may outlive the wait for it.
struct Pending {
    std::mutex mutex;
    std::condition_variable wake;
    bool done = false;
    CaseResult result;
    Judgement judgement;
};

void run_one(const std::function<CaseResult(Effort)>& run, Effort effort, Pending& pending) {
    CaseResult result;
    Judgement judgement;
    try {
        result = run(effort);
        judgement = judge(result);
    } catch (const std::exception& error) {
        judgement = judge_error(std::string("threw: ") + error.what());
    } catch (...) {
        judgement = judge_error("threw something that is no std::exception");
    }
    const std::lock_guard lock(pending.mutex);
    pending.result = std::move(result);
    pending.judgement = std::move(judgement);
    pending.done = true;
    pending.wake.notify_all();
}

}  // namespace

RunOutcome run_cases(const std::vector<HardCase>& cases, Effort effort, const CaseWatch& watch) {
    RunOutcome outcome;
    const Clock::time_point start = Clock::now();
    const double cpu_start = process_cpu_seconds();
    for (std::size_t i = 0; i < cases.size() && !outcome.interrupted; ++i) {
        const Clock::time_point case_start = Clock::now();
        const double cpu_case_start = process_cpu_seconds();
        const auto pending = std::make_shared<Pending>();
        std::thread thread(
            [pending, run = cases[i].run, effort] { run_one(run, effort, *pending); });
        {
            std::unique_lock lock(pending->mutex);
            while (!pending->wake.wait_for(lock, std::chrono::milliseconds(100),
                                           [&] { return pending->done; })) {
                if (watch.interrupted && watch.interrupted()) {
                    outcome.interrupted = true;
                    break;
                }
                if (watch.waiting) watch.waiting(i, cases[i], seconds_since(case_start));
            }
        }
        if (outcome.interrupted) {
            thread.detach();
            break;
        }
        thread.join();
        outcome.rows.push_back({cases[i], std::move(pending->result), std::move(pending->judgement),
                                seconds_since(case_start), process_cpu_seconds() - cpu_case_start});
        if (watch.done) watch.done(outcome.rows.back());
    }
    outcome.seconds = seconds_since(start);
    outcome.cpu_seconds = process_cpu_seconds() - cpu_start;
    return outcome;
}

Totals total(const std::vector<CaseRow>& rows) {
    Totals totals;
    double least = std::numeric_limits<double>::infinity();
    for (const CaseRow& row : rows) {
        totals.passed += row.judgement.verdict == Verdict::pass ? 1 : 0;
        totals.failed += row.judgement.verdict == Verdict::fail ? 1 : 0;
        totals.blind += row.judgement.verdict == Verdict::blind ? 1 : 0;
        totals.nonfinite += row.result.nonfinite;
        totals.clamped += row.result.clamped;
        if (row.judgement.verdict != Verdict::pass) {
            totals.kept = totals.kept && row.hard_case.priority != Priority::p0;
            continue;
        }
        const double own = margin(*row.shown());
        if (own < least) {
            least = own;
            totals.worst = &row;
        }
    }
    return totals;
}

}  // namespace talbot::hardcases
