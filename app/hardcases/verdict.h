// Whether a case passed, by one rule for all: every own figure meets its limit, and at least one
// control misses it on the same inputs. A gate that no control fails proves nothing.
#pragma once

#include <string>
#include <string_view>

#include "app/hardcases/hard_case.h"

namespace talbot::hardcases {

enum class Verdict { pass, fail, blind };
std::string_view verdict_name(Verdict verdict);

// Whether a figure meets the measure's limit; NaN never does.
bool meets(const Measure& measure, double figure);

// Whether the measure has a control that misses the limit.
bool control_fails(const Measure& measure);

// How far Talbot's figure keeps from the limit, as a ratio: 1 is on the limit, below it fails;
// infinity where the figure is perfect or no ratio can say it.
double margin(const Measure& measure);

struct Judgement {
    Verdict verdict = Verdict::fail;
    std::size_t worst = 0;  // index of the measure that a row shows
    std::string why;        // empty on a pass
};

// A result without measures fails.
Judgement judge(const CaseResult& result);

// What a case that threw comes to.
Judgement judge_error(const std::string& what);

}  // namespace talbot::hardcases
