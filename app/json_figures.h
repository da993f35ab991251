// Figures of an error as the program's JSON files state them.
#pragma once

#include <nlohmann/json.hpp>

#include "core/accuracy/error_estimate.h"

namespace talbot {

// JSON has neither infinity nor NaN; null stands for both.
nlohmann::ordered_json json_number(double x);
// Null, too, for what is not known.
nlohmann::ordered_json json_number_if(bool known, double x);

// The error with its interval, exponent, exposure and trust; its figures are null where no two
// samples differed. Null before there are two samples.
nlohmann::ordered_json error_json(const ErrorEstimate& error);

}  // namespace talbot
