// Twin mode: the samples of a user's scene once more in double.
#pragma once

#include <cstdio>
#include <string>

#include "app/options.h"
#include "core/base/result.h"
#include "oracles/twin/compare_twins.h"

namespace talbot::hardcases {

// Float must stay this far below the Monte Carlo error of the same budget: relMSE as a share of
// its. A tenth adds less than 5 % to the error of a picture.
inline constexpr double kTwinShareOfNoise = 0.1;
// And samples that go the same way, this close: were all of it one-sided, a picture of samples that
// spread by their own mean would show it from 1 / kTwinTogether^2, a million, samples a pixel on.
// No bound of float itself stands behind it: before they count as parted, curved glass may magnify
// a rounding up to twin::kParted.
inline constexpr double kTwinTogether = 1e-3;
// Standard errors that the mean may be off by.
inline constexpr double kTwinBiasErrors = 4.5;

struct TwinReport {
    std::string scene_file;
    twin::Budget budget;
    twin::Comparison comparison;
    bool interrupted = false;
    double seconds = 0;
};

// Empty when the promises are kept, else the one that is broken.
std::string broken_twin(const twin::Comparison& comparison);

Result<TwinReport> run_twin(const Options& options);

// |float - double| by pixel.
ImageRgba twin_difference(const twin::Comparison& comparison);

std::string twin_json(const TwinReport& report);
void print_twin(const TwinReport& report, std::FILE* out);

}  // namespace talbot::hardcases
