// Runs cases one after the other on a thread of their own, so that a case that throws is a failed
// row and an interrupt does not wait for it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/hardcases/verdict.h"

namespace talbot::hardcases {

struct CaseRow {
    HardCase hard_case;
    CaseResult result;
    Judgement judgement;
    double seconds = 0;
    double cpu_seconds = 0;  // of all threads: other programs do not stretch it

    // The measure that the row shows; null when the case has none.
    const Measure* shown() const {
        return result.measures.empty() ? nullptr : &result.measures[judgement.worst];
    }
};

struct CaseWatch {
    std::function<bool()> interrupted;  // asked several times a second
    std::function<void(std::size_t index, const HardCase&, double seconds)> waiting;
    std::function<void(const CaseRow&)> done;
};

struct RunOutcome {
    std::vector<CaseRow> rows;
    double seconds = 0;
    double cpu_seconds = 0;
    // Then the case at hand is still running, and the process must end without destructors.
    bool interrupted = false;
};

RunOutcome run_cases(const std::vector<HardCase>& cases, Effort effort, const CaseWatch& watch);

// Sums over rows.
struct Totals {
    std::size_t passed = 0, failed = 0, blind = 0;
    uint64_t nonfinite = 0, clamped = 0;
    const CaseRow* worst = nullptr;  // of the rows that passed, with the least finite margin
    bool kept = true;                // every P0 row passed
};
Totals total(const std::vector<CaseRow>& rows);

}  // namespace talbot::hardcases
