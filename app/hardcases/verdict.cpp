#include "app/hardcases/verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace talbot::hardcases {

std::string_view verdict_name(Verdict verdict) {
    switch (verdict) {
        case Verdict::pass:
            return "PASS";
        case Verdict::fail:
            return "FAIL";
        case Verdict::blind:
            return "BLIND";
    }
    return "FAIL";
}

bool meets(const Measure& measure, double figure) {
    return measure.gate == Gate::at_most ? figure <= measure.limit : figure >= measure.limit;
}

bool control_fails(const Measure& measure) {
    return !std::isnan(measure.naive) && !meets(measure, measure.naive);
}

double margin(const Measure& measure) {
    const bool met = meets(measure, measure.own);
    const bool has_ratio = measure.limit > 0 && measure.own > 0;
    if (!has_ratio) return met ? std::numeric_limits<double>::infinity() : 0;
    return measure.gate == Gate::at_most ? measure.limit / measure.own
                                         : measure.own / measure.limit;
}

Judgement judge(const CaseResult& result) {
    Judgement judgement;
    const std::vector<Measure>& measures = result.measures;
    if (measures.empty()) return judge_error("measured nothing");
    // The least margin; where that is equal, a measure whose control shows the defect.
    const auto rank = [](const Measure& m) {
        return std::pair(meets(m, m.own) ? margin(m) : -1, !control_fails(m));
    };
    for (std::size_t i = 1; i < measures.size(); ++i) {
        if (rank(measures[i]) < rank(measures[judgement.worst])) judgement.worst = i;
    }
    const Measure& worst = measures[judgement.worst];
    if (!meets(worst, worst.own)) {
        judgement.why = "misses the limit";
        if (!worst.where.empty()) judgement.why += ": " + worst.where;
        return judgement;
    }
    if (std::none_of(measures.begin(), measures.end(), control_fails)) {
        judgement.verdict = Verdict::blind;
        judgement.why = "no control misses its limit: the case cannot see the defect";
        return judgement;
    }
    judgement.verdict = Verdict::pass;
    return judgement;
}

Judgement judge_error(const std::string& what) {
    return {Verdict::fail, 0, what};
}

}  // namespace talbot::hardcases
