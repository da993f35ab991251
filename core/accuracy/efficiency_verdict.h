// Which of two renders of one view gives less error for its time, and how sure that is. The
// efficiency of a render is 1 / (relMSE x seconds); B's over A's is what is stated.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace talbot {

enum class Winner : uint8_t { none, a, b };

struct EfficiencyVerdict {
    bool valid = false;  // there is something to compare
    Winner winner = Winner::none;
    // Efficiency of B over that of A, and the interval that holds at 95 % over all looks together.
    double ratio = 1;
    double lo95 = 0;
    double hi95 = 0;
    double error_ratio = 1;  // of it, relMSE of A over that of B at as many samples
    double time_ratio = 1;   // of it, seconds a sample of A over those of B
    uint64_t samples = 0;    // a pixel, of the renders that were compared
    uint64_t renders = 0;    // of so many samples, on the side that has fewer
    // Both converge to different pictures: then efficiency alone is no reason to choose.
    bool different = false;
    double brightness_percent = 0;  // mean of B over mean of A, minus 1
    std::string text;  // one sentence, "B is 2.3x (2.1 to 2.6) more efficient on this view"
};

// Of one block of pixels: the sum over pixels and channels of variance / (r^2 + constant) of the
// mean of one render, for each side; r is the same for both.
struct BlockVariances {
    double a = 0;
    double b = 0;
};

// Seconds a sample of both sides, measured at about the same time.
struct TimePair {
    double a = 0;
    double b = 0;
};

// Of an error probability that holds for any number of looks together, the part that look k = 1, 2,
// ... may use.
double level_of_look(double level, uint64_t k);

// |t| that Student's t with so many degrees of freedom (> 0, infinite for a Gaussian) exceeds with
// a probability (Hill 1970, algorithm 396).
double student_quantile(double probability, double freedom);

// `looks` is how many verdicts the comparison has asked for so far, this one included: the more,
// the wider the interval. Paired bootstrap over blocks, and scatter of the time pairs.
EfficiencyVerdict compare_efficiency(std::span<const BlockVariances> blocks,
                                     std::span<const TimePair> times, uint64_t looks);

}  // namespace talbot
