#pragma once

namespace talbot::hardcases::b02 {

// std::isfinite in a file whose build promises the compiler that there is neither NaN nor infinity.
bool relaxed_is_finite(float x);

}  // namespace talbot::hardcases::b02
