// Student's test of one mean and Welch's test of two, for few samples.
#pragma once

#include "oracles/stats/ztest.h"

namespace talbot::stats {

inline double t_test(const Moments& m, double expected) {
    if (!(m.variance() > 0)) return m.mean() == expected ? 1 : 0;
    return student_two_sided((m.mean() - expected) / m.standard_error(), m.n() - 1);
}

// p that both streams have one mean; variances may differ (Welch 1947).
inline double welch_test(const Moments& a, const Moments& b) {
    const double va = a.variance() / a.n();
    const double vb = b.variance() / b.n();
    if (!(va + vb > 0)) return a.mean() == b.mean() ? 1 : 0;
    const double degrees = (va + vb) * (va + vb) / (va * va / (a.n() - 1) + vb * vb / (b.n() - 1));
    return student_two_sided((a.mean() - b.mean()) / std::sqrt(va + vb), degrees);
}

}  // namespace talbot::stats
