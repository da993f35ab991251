// The control of B02: compiled with -ffinite-math-only, as -ffast-math has it.
#include "app/hardcases/cases/b02_relaxed.h"

#include <cmath>

namespace talbot::hardcases::b02 {

bool relaxed_is_finite(float x) {
    return std::isfinite(x);
}

}  // namespace talbot::hardcases::b02
