// Invariant checks. TALBOT_CHECK is always on and ends the process with file and line;
// TALBOT_DCHECK only in debug and sanitizer builds. They guard the core's own invariants, never
// user input (that is Result's work).
#pragma once

#include <cstdio>
#include <cstdlib>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "Talbot needs IEEE semantics: build without -ffast-math and -ffinite-math-only"
#endif

namespace talbot {

[[noreturn]] inline void check_failed(const char* what, const char* file, int line) {
    std::fprintf(stderr, "talbot: internal check failed: %s (%s:%d)\n", what, file, line);
    std::abort();
}

}  // namespace talbot

#define TALBOT_CHECK(condition) \
    ((condition) ? static_cast<void>(0) : ::talbot::check_failed(#condition, __FILE__, __LINE__))

#ifdef TALBOT_CHECKS
#define TALBOT_DCHECK(condition) TALBOT_CHECK(condition)
#else
#define TALBOT_DCHECK(condition) static_cast<void>(0)
#endif
