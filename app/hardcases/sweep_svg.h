// A figure over a parameter as SVG: naive and own curves and the limit.
#pragma once

#include <string>

#include "app/hardcases/hard_case.h"

namespace talbot::hardcases {

// Figures are on a logarithmic axis; zero lies on the lowest line, infinity and NaN on the highest.
std::string sweep_svg(const Sweep& sweep);

}  // namespace talbot::hardcases
