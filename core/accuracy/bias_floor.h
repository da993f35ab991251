// The floor that a biased switch puts under the error of a picture, however long it renders.
#pragma once

#include "core/film/film.h"

namespace talbot {

// What a switch changes about the converged picture, measured with the same random numbers on both
// sides, so that few samples do.
struct BiasFloor {
    double relrmse_percent = 0;     // 0 where it is not significant
    double lo95 = 0;                // lower bound of the floor, each at 95 %
    double hi95 = 0;                // upper bound
    double z = 0;                   // of the squared floor against 0
    double block_p_value = 1;       // of the largest block difference, corrected for their number
    double brightness_percent = 0;  // change of the mean
    bool significant = false;
};

// Compares a film with the base's film of the same samples, seed and size: both as they were at
// half their samples, and now. All zero where there is no half. The metric is taken after an
// exposure.
BiasFloor measure_floor(const Film& half, const Film& now, const Film& base_half,
                        const Film& base_now, double exposure_ev = 0);

}  // namespace talbot
